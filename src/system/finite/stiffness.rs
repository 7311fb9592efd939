//! Elastic forces of a body of finite elements, its strain energy, and their derivatives.

use super::element::{Local, gather, scatter};
use super::parts;
use crate::math::Scalar;
use crate::model::finite::{
    DISPLACEMENTS, FiniteElements, NODES, QUADRATIC, STRAINS, ShellElement, UNKNOWNS,
};

/// Membrane strains, their gradients along the displacements, and products with slopes.
pub(super) struct Strained<S> {
    /// e_p.
    pub strain: [S; STRAINS],
    /// r_p·u and s_p·u.
    slopes: [[S; 2]; QUADRATIC],
}

/// Σ a_j x_j over displacements.
fn product<S: Scalar>(row: &[f64; DISPLACEMENTS], x: &Local<S>) -> S {
    let mut sum = S::zero();
    for (&a, &x) in row.iter().zip(x) {
        sum += x * a;
    }
    sum
}

/// Adds `scale` times a row.
fn add_row<S: Scalar>(row: &[f64; DISPLACEMENTS], scale: S, out: &mut [S]) {
    for (out, &a) in out.iter_mut().zip(row) {
        *out += scale * a;
    }
}

impl<S: Scalar> Strained<S> {
    pub(super) fn of(element: &ShellElement, x: &Local<S>) -> Self {
        let mut out = Self {
            strain: [S::zero(); STRAINS],
            slopes: [[S::zero(); 2]; QUADRATIC],
        };
        for (e, row) in out.strain.iter_mut().zip(&element.membrane) {
            *e = product(row, x);
        }
        for (p, [r, s]) in element.slopes.iter().enumerate() {
            out.slopes[p] = [product(r, x), product(s, x)];
            out.strain[p] += out.slopes[p][0] * out.slopes[p][1] * 0.5;
        }
        out
    }

    /// Derivatives of the strains along y.
    pub(super) fn along(&self, element: &ShellElement, y: &Local<S>) -> [S; STRAINS] {
        let mut out = [S::zero(); STRAINS];
        for (e, row) in out.iter_mut().zip(&element.membrane) {
            *e = product(row, y);
        }
        for (p, [r, s]) in element.slopes.iter().enumerate() {
            let [ru, su] = self.slopes[p];
            out[p] += (product(r, y) * su + product(s, y) * ru) * 0.5;
        }
        out
    }

    /// The rows ∂/∂u of the derivatives of the strains along r.
    pub(super) fn turned_rows(
        &self,
        element: &ShellElement,
        r: &Local<S>,
    ) -> [[S; DISPLACEMENTS]; STRAINS] {
        let mut rows = [[S::zero(); DISPLACEMENTS]; STRAINS];
        for (row, [left, right]) in rows.iter_mut().zip(&element.slopes) {
            add_row(right, product(left, r) * 0.5, row);
            add_row(left, product(right, r) * 0.5, row);
        }
        rows
    }

    /// Adds Σ n_p ∂e_p/∂u.
    pub(super) fn add_transpose(
        &self,
        element: &ShellElement,
        n: &[S; STRAINS],
        out: &mut Local<S>,
    ) {
        for (row, &n) in element.membrane.iter().zip(n) {
            add_row(row, n, out);
        }
        for (p, [r, s]) in element.slopes.iter().enumerate() {
            let [ru, su] = self.slopes[p];
            add_row(r, n[p] * su * 0.5, out);
            add_row(s, n[p] * ru * 0.5, out);
        }
    }

    /// The rows ∂e_p/∂u.
    pub(super) fn rows(&self, element: &ShellElement) -> [[S; DISPLACEMENTS]; STRAINS] {
        let mut rows = [[S::zero(); DISPLACEMENTS]; STRAINS];
        for (to, row) in rows.iter_mut().zip(&element.membrane) {
            add_row(row, S::one(), to);
        }
        for (p, [r, s]) in element.slopes.iter().enumerate() {
            let [ru, su] = self.slopes[p];
            add_row(r, su * 0.5, &mut rows[p]);
            add_row(s, ru * 0.5, &mut rows[p]);
        }
        rows
    }
}

/// P e.
pub(super) fn stresses<S: Scalar>(element: &ShellElement, e: &[S; STRAINS]) -> [S; STRAINS] {
    std::array::from_fn(|p| {
        let row = element.plane[p].iter().zip(e);
        row.fold(S::zero(), |sum, (&a, &e)| sum + e * a)
    })
}

/// K x for one of the linear stiffnesses.
pub(super) fn linear<S: Scalar>(matrix: &[f64], x: &Local<S>, n: usize) -> Local<S> {
    let mut out = [S::zero(); UNKNOWNS];
    // The matrix is symmetric: its rows are its columns.
    for (row, &x) in matrix.chunks_exact(n).zip(x) {
        for (out, &a) in out.iter_mut().zip(row) {
            *out += x * a;
        }
    }
    out
}

pub(super) fn inner<S: Scalar>(x: &[S], y: &[S]) -> S {
    crate::math::slices::dot(x, y)
}

/// E h and E h³ of an element.
pub(crate) fn factors<S: Scalar>(finite: &FiniteElements<S>, i: usize) -> [S; 2] {
    let (h, young) = (finite.thickness[i], finite.young[i]);
    [young * h, young * h * h * h]
}

/// Transpose of the derivative of [`factors`].
pub(super) fn pull_factors(
    finite: &FiniteElements<f64>,
    i: usize,
    by: [f64; 2],
    cot: &mut FiniteElements<f64>,
) {
    let (h, young) = (finite.thickness[i], finite.young[i]);
    cot.young[i] += by[0] * h + by[1] * h * h * h;
    cot.thickness[i] += by[0] * young + by[1] * young * 3.0 * h * h;
}

/// Strain energy U \[J\].
pub(crate) fn energy<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> S {
    let mut sum = S::zero();
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let ([thin, thick], by) = (factors(finite, i), energies(element, &gather(element, q)));
        sum += thin * by[0] + thick * by[1];
    }
    sum + parts::energy(finite, q)
}

/// Energies for E h = 1 and E h³ = 1.
fn energies<S: Scalar>(element: &ShellElement, x: &Local<S>) -> [S; 2] {
    let n = element.coordinates.len();
    let e = Strained::of(element, x).strain;
    let [bending, shear] = [0, 1].map(|k| inner(&linear(&element.linear[k], x, n), x));
    [
        (inner(&stresses(element, &e), &e) + shear) * 0.5,
        bending * 0.5,
    ]
}

/// Adds ∂U/∂q.
pub(crate) fn add_forces<S: Scalar>(finite: &FiniteElements<S>, q: &[S], out: &mut [S]) {
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let [thin, thick] = factors(finite, i);
        let (x, n) = (gather(element, q), element.coordinates.len());
        let strained = Strained::of(element, &x);
        let mut force = linear(&element.linear[1], &x, n);
        let stress = stresses(element, &strained.strain);
        strained.add_transpose(element, &stress, &mut force);
        let bending = linear(&element.linear[0], &x, n);
        for (f, &b) in force.iter_mut().zip(&bending) {
            *f = *f * thin + b * thick;
        }
        scatter(element, &force, out);
    }
    parts::add_forces(finite, q, out);
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub(crate) fn pull_energy(
    finite: &FiniteElements<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    let mut force = vec![0.0; q.len()];
    add_forces(finite, q, &mut force);
    crate::math::slices::add_scaled(by_q, scale, &force);
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let by = energies(element, &gather(element, q)).map(|u| u * scale);
        pull_factors(finite, i, by, cot);
    }
    parts::pull_energy(finite, (q, scale), cot);
}

/// Pulls the cotangent ψ of [`add_forces`] back to q (added) and to the parameters (added to `cot`).
pub(crate) fn pull_forces(
    finite: &FiniteElements<f64>,
    (q, psi): (&[f64], &[f64]),
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let [thin, thick] = factors(finite, i);
        let (x, y) = (gather(element, q), gather(element, psi));
        let n = element.coordinates.len();
        let strained = Strained::of(element, &x);
        let along = strained.along(element, &y);
        let stress = stresses(element, &strained.strain);
        let shear = linear(&element.linear[1], &y, n);
        let bending = linear(&element.linear[0], &y, n);
        let by = [
            inner(&along, &stress) + inner(&shear, &x),
            inner(&bending, &x),
        ];
        pull_factors(finite, i, by, cot);
        let mut force = shear;
        strained.add_transpose(element, &stresses(element, &along), &mut force);
        for (p, [r, s]) in element.slopes.iter().enumerate() {
            add_row(r, stress[p] * product(s, &y) * 0.5, &mut force);
            add_row(s, stress[p] * product(r, &y) * 0.5, &mut force);
        }
        for (f, &b) in force.iter_mut().zip(&bending) {
            *f = *f * thin + b * thick;
        }
        scatter(element, &force, by_q);
    }
    parts::pull_forces(finite, (q, psi), by_q, cot);
}

/// Adds left ⊗ right to a matrix of displacements, rows up to the diagonal's block of nine.
fn add_product<S: Scalar>(
    left: &[S; DISPLACEMENTS],
    right: &[S; DISPLACEMENTS],
    out: &mut [[S; DISPLACEMENTS]; DISPLACEMENTS],
) {
    for (k, (row, &factor)) in out.iter_mut().zip(left).enumerate() {
        let end = NODES * (k / NODES + 1);
        for (out, &x) in row[..end].iter_mut().zip(&right[..end]) {
            *out += factor * x;
        }
    }
}

/// The tangent stiffness of an element, by rows of its unknowns.
pub(crate) fn tangent<S: Scalar>(
    finite: &FiniteElements<S>,
    i: usize,
    x: &Local<S>,
    out: &mut [S],
) {
    let element = &finite.mesh.elements[i];
    let [thin, thick] = factors(finite, i);
    let n = element.coordinates.len();
    let [bending, shear] = &element.linear;
    for (out, (&b, &s)) in out.iter_mut().zip(bending.iter().zip(shear)) {
        *out = thick * b + thin * s;
    }
    let strained = Strained::of(element, x);
    let rows = strained.rows(element);
    let mut scaled = [[S::zero(); DISPLACEMENTS]; STRAINS];
    for (to, plane) in scaled.iter_mut().zip(&element.plane) {
        for (row, &a) in rows.iter().zip(plane) {
            if a != 0.0 {
                let factor = thin * a;
                for (to, &x) in to.iter_mut().zip(row) {
                    *to += factor * x;
                }
            }
        }
    }
    let mut lower = [[S::zero(); DISPLACEMENTS]; DISPLACEMENTS];
    for (left, right) in rows.iter().zip(&scaled) {
        add_product(left, right, &mut lower);
    }
    let stress = stresses(element, &strained.strain);
    for ([r, s], &n) in element.slopes.iter().zip(&stress) {
        let half = thin * n * 0.5;
        let mut by_r = [S::zero(); DISPLACEMENTS];
        add_row(r, half, &mut by_r);
        if r == s {
            add_row(r, half, &mut by_r);
            add_product(&r.map(S::from), &by_r, &mut lower);
            continue;
        }
        let mut by_s = [S::zero(); DISPLACEMENTS];
        add_row(s, half, &mut by_s);
        add_product(&r.map(S::from), &by_s, &mut lower);
        add_product(&s.map(S::from), &by_r, &mut lower);
    }
    for k in 0..DISPLACEMENTS {
        for l in 0..k {
            out[k * n + l] += lower[k][l];
            out[l * n + k] += lower[k][l];
        }
        out[k * n + k] += lower[k][k];
    }
}

/// The diagonal of the linear stiffness.
pub(crate) fn diagonal<S: Scalar>(finite: &FiniteElements<S>) -> Vec<S> {
    let mut out = vec![S::zero(); finite.mesh.coordinates];
    let mut matrix = [S::zero(); UNKNOWNS * UNKNOWNS];
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let n = element.coordinates.len();
        tangent(finite, i, &[S::zero(); UNKNOWNS], &mut matrix);
        for (k, coordinate) in element.coordinates.iter().enumerate() {
            if let Some(j) = coordinate {
                out[*j] += matrix[k * (n + 1)];
            }
        }
    }
    for (part, coordinates) in parts::all(finite) {
        let n = coordinates.len();
        let matrix = parts::part_tangent(part, &vec![S::zero(); n]);
        for (k, &j) in coordinates.iter().enumerate() {
            out[j] += matrix[k * (n + 1)];
        }
    }
    out
}
