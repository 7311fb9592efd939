//! Elastic forces of a body of finite elements, its strain energy, and their derivatives.

use super::each::each_over;
use super::element::{Deformed, Local, scatter};
use super::parts;
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot, dot_by_four, vectorised};
use crate::model::finite::{
    DISPLACEMENTS, FiniteElements, QUADRATIC, SLOPES, STRAINS, ShellElement, UNKNOWNS, other_slope,
};
use std::ops::Mul;

/// Derivatives of the strains by the displacements, by columns; zero beyond those that the element has.
pub(super) type Gradients<S> = [[S; STRAINS]; DISPLACEMENTS];

/// Membrane strains of an element, and its slopes.
pub(super) struct Strained<S> {
    /// e_p.
    pub strain: [S; STRAINS],
    /// r_p·u and s_p·u.
    slopes: [S; SLOPES],
}

impl<S: Scalar> Strained<S> {
    pub(super) fn of(element: &ShellElement, x: &Deformed<S>) -> Self {
        let mut strain = element.membrane.times(&x.deformation);
        let slopes = element.slopes.times(&x.all);
        for (p, e) in strain.iter_mut().enumerate().take(QUADRATIC) {
            *e += slopes[p] * slopes[other_slope(p)] * 0.5;
        }
        Self { strain, slopes }
    }

    /// Derivatives of the strains along y.
    pub(super) fn along(&self, element: &ShellElement, y: &Deformed<S>) -> [S; STRAINS] {
        let mut out = element.membrane.times(&y.deformation);
        let slopes = element.slopes.times(&y.all);
        for (p, e) in out.iter_mut().enumerate().take(QUADRATIC) {
            let q = other_slope(p);
            *e += (slopes[p] * self.slopes[q] + slopes[q] * self.slopes[p]) * 0.5;
        }
        out
    }

    /// Adds Σ n_p ∂e_p/∂u.
    pub(super) fn add_transpose(
        &self,
        element: &ShellElement,
        n: &[S; STRAINS],
        out: &mut Local<S>,
    ) {
        element.membrane.add_transposed(n, out);
        add_curved(element, n, &self.slopes, out);
    }

    /// ∂e_p/∂u.
    pub(super) fn gradients(&self, element: &ShellElement) -> Gradients<S> {
        let mut out = [[S::zero(); STRAINS]; DISPLACEMENTS];
        for (i, column) in element.membrane.iter() {
            for (out, &b) in out[i].iter_mut().zip(column) {
                *out = S::from(b);
            }
        }
        add_gradients(element, &self.slopes, &mut out);
        out
    }

    /// yᵀ (∂²e_p/∂u²) z.
    pub(super) fn curvature(
        element: &ShellElement,
        y: &Deformed<S>,
        z: &Deformed<S>,
    ) -> [S; STRAINS] {
        let [y, z] = [y, z].map(|x| element.slopes.times(&x.all));
        let mut out = [S::zero(); STRAINS];
        for (p, out) in out.iter_mut().enumerate().take(QUADRATIC) {
            let q = other_slope(p);
            *out = (y[p] * z[q] + z[p] * y[q]) * 0.5;
        }
        out
    }

    /// ∂/∂u of the derivatives of the strains along r.
    pub(super) fn turned_gradients(element: &ShellElement, r: &Deformed<S>) -> Gradients<S> {
        let mut out = [[S::zero(); STRAINS]; DISPLACEMENTS];
        add_gradients(element, &element.slopes.times(&r.all), &mut out);
        out
    }
}

/// Adds ½ (r_p (s_p·y) + s_p (r_p·y)) for the slopes of y.
fn add_gradients<S: Scalar>(element: &ShellElement, slopes: &[S; SLOPES], out: &mut Gradients<S>) {
    for (i, column) in element.slopes.iter() {
        for (p, out) in out[i].iter_mut().enumerate().take(QUADRATIC) {
            let q = other_slope(p);
            *out += (slopes[q] * column[p] + slopes[p] * column[q]) * 0.5;
        }
    }
}

/// Adds ½ Σ n_p (r_p (s_p·y) + s_p (r_p·y)) for the slopes of y.
pub(super) fn add_curved<S: Scalar>(
    element: &ShellElement,
    n: &[S; STRAINS],
    slopes: &[S; SLOPES],
    out: &mut Local<S>,
) {
    element.slopes.add_transposed(&by_slopes(n, slopes), out);
}

/// Derivatives of Σ n_p r_p s_p / 2 by the slopes r_p and s_p.
fn by_slopes<S, T>(n: &[S; STRAINS], slopes: &[T; SLOPES]) -> [S; SLOPES]
where
    S: Scalar + Mul<T, Output = S>,
    T: Copy,
{
    let mut by = [S::zero(); SLOPES];
    for (p, &n) in n.iter().enumerate().take(QUADRATIC) {
        let (q, half) = (other_slope(p), n * 0.5);
        by[p] += half * slopes[q];
        by[q] += half * slopes[p];
    }
    by
}

/// P e.
#[inline(always)]
pub(super) fn stresses<S: Scalar>(element: &ShellElement, e: &[S; STRAINS]) -> [S; STRAINS] {
    // P is symmetric: its rows are its columns.
    let mut out = [S::zero(); STRAINS];
    for (row, &e) in element.plane.iter().zip(e) {
        for (out, &a) in out.iter_mut().zip(row) {
            *out += e * a;
        }
    }
    out
}

/// Adds `thin` and `thick` times the linear forces of E h = 1 and E h³ = 1.
pub(super) fn add_linear<S: Scalar>(
    element: &ShellElement,
    [thin, thick]: [S; 2],
    x: &Deformed<S>,
    out: &mut Local<S>,
) {
    element.linear[0].add_product(thick, &x.deformation, out);
    let shear = element.shear.times(&x.deformation).map(|s| s * thin);
    element.shear.add_transposed(&shear, out);
}

/// Twice the linear energies of E h³ = 1 and E h = 1, for two motions.
pub(super) fn linear_products<S: Scalar>(
    element: &ShellElement,
    x: &Deformed<S>,
    y: &Deformed<S>,
) -> [S; 2] {
    let (x, y) = (&x.deformation, &y.deformation);
    let [shear, other] = [x, y].map(|x| element.shear.times(x));
    [element.linear[0].inner(x, y), dot(&shear, &other)]
}

/// E h and E h³ of an element.
pub fn factors<S: Scalar>(finite: &FiniteElements<S>, i: usize) -> [S; 2] {
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
pub fn energy<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> S {
    let mut sum = S::zero();
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let ([thin, thick], by) = (
            factors(finite, i),
            energies(element, &Deformed::of(element, q)),
        );
        sum += thin * by[0] + thick * by[1];
    }
    sum + parts::energy(finite, q)
}

/// Energies for E h = 1 and E h³ = 1.
fn energies<S: Scalar>(element: &ShellElement, x: &Deformed<S>) -> [S; 2] {
    let e = Strained::of(element, x).strain;
    let [bending, shear] = linear_products(element, x, x);
    [
        (dot(&stresses(element, &e), &e) + shear) * 0.5,
        bending * 0.5,
    ]
}

/// Energies of the membrane of an element, and of its bending and shear \[J\].
pub(super) fn split_energy(finite: &FiniteElements<f64>, i: usize, q: &[f64]) -> [f64; 2] {
    let element = &finite.mesh.elements[i];
    let ([thin, thick], x) = (factors(finite, i), Deformed::of(element, q));
    let e = Strained::of(element, &x).strain;
    let [bending, shear] = linear_products(element, &x, &x);
    [
        0.5 * thin * dot(&stresses(element, &e), &e),
        0.5 * (thick * bending + thin * shear),
    ]
}

/// The elastic forces of an element.
fn forces<S: Scalar>(finite: &FiniteElements<S>, i: usize, q: &[S]) -> Local<S> {
    let element = &finite.mesh.elements[i];
    let both = factors(finite, i);
    let x = Deformed::of(element, q);
    let strained = Strained::of(element, &x);
    let stress = stresses(element, &strained.strain).map(|n| n * both[0]);
    let mut out = [S::zero(); UNKNOWNS];
    strained.add_transpose(element, &stress, &mut out);
    add_linear(element, both, &x, &mut out);
    out
}

/// Adds ∂U/∂q.
pub fn add_forces<S: Scalar>(finite: &FiniteElements<S>, q: &[S], out: &mut [S]) {
    let elements = &finite.mesh.elements;
    let add = |i: usize, force: Local<S>| scatter(&elements[i], &force, out);
    each_over(&finite.team, elements.len(), |i| forces(finite, i, q), add);
    parts::add_forces(finite, q, out);
}

/// Pulls U times `scale` back to q (added to `by_q`) and to the parameters (added to `cot`).
pub fn pull_energy(
    finite: &FiniteElements<f64>,
    q: &[f64],
    scale: f64,
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    let mut force = vec![0.0; q.len()];
    add_forces(finite, q, &mut force);
    add_scaled(by_q, scale, &force);
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let by = energies(element, &Deformed::of(element, q)).map(|u| u * scale);
        pull_factors(finite, i, by, cot);
    }
    parts::pull_energy(finite, (q, scale), cot);
}

/// Pulls the cotangent ψ of [`add_forces`] back to q (added, if wanted) and to the parameters (added to `cot`).
pub fn pull_forces(
    finite: &FiniteElements<f64>,
    (q, psi): (&[f64], &[f64]),
    mut by_q: Option<&mut [f64]>,
    cot: &mut FiniteElements<f64>,
) {
    let (elements, wanted) = (&finite.mesh.elements, by_q.is_some());
    let work = |i: usize| {
        let (element, both) = (&elements[i], factors(finite, i));
        let (x, y) = (Deformed::of(element, q), Deformed::of(element, psi));
        let strained = Strained::of(element, &x);
        let along = strained.along(element, &y);
        let stress = stresses(element, &strained.strain);
        let [bending, shear] = linear_products(element, &x, &y);
        let mut force = [0.0; UNKNOWNS];
        if wanted {
            let by_strain = stresses(element, &along).map(|n| n * both[0]);
            strained.add_transpose(element, &by_strain, &mut force);
            let curved = stress.map(|n| n * both[0]);
            add_curved(element, &curved, &element.slopes.times(&y.all), &mut force);
            add_linear(element, both, &y, &mut force);
        }
        ([dot(&along, &stress) + shear, bending], force)
    };
    each_over(&finite.team, elements.len(), work, |i, (by, force)| {
        pull_factors(finite, i, by, cot);
        if let Some(by_q) = by_q.as_deref_mut() {
            scatter(&elements[i], &force, by_q);
        }
    });
    let mut unused = Vec::new();
    let by_q = by_q.unwrap_or_else(|| {
        unused.resize(if finite.parts.is_empty() { 0 } else { q.len() }, 0.0);
        &mut unused
    });
    parts::pull_forces(finite, (q, psi), by_q, cot);
}

/// Adds Gᵀ H for two matrices by columns to the displacements' part of a matrix of the unknowns of an element; what stands right of
/// the diagonal is taken from the left if `symmetric`.
pub(super) fn add_products<S: Scalar>(
    element: &ShellElement,
    (left, right): (&Gradients<S>, &Gradients<S>),
    symmetric: bool,
    out: &mut [S],
) {
    let (count, n) = (element.displacements(), element.moves.len());
    vectorised(
        #[inline(always)]
        || {
            for (k, left) in left.iter().enumerate().take(count) {
                let end = if symmetric { k + 1 } else { count };
                for (l, right) in right.iter().enumerate().take(end) {
                    let x = dot_by_four(left, right);
                    out[k * n + l] += x;
                    if symmetric && l < k {
                        out[l * n + k] += x;
                    }
                }
            }
        },
    );
}

/// Adds ½ Σ n_p (r_p s_pᵀ + s_p r_pᵀ) to the displacements' part of a matrix of order n.
pub(super) fn add_curvature<S: Scalar>(
    element: &ShellElement,
    n_p: &[S; STRAINS],
    n: usize,
    out: &mut [S],
) {
    for (k, own) in element.slopes.iter() {
        let by = by_slopes(n_p, own);
        for (l, other) in element.slopes.iter() {
            let sum = by.iter().zip(other);
            out[k * n + l] += sum.fold(S::zero(), |sum, (&by, &a)| sum + by * a);
        }
    }
}

/// The tangent stiffness of an element, by rows of its unknowns.
pub fn tangent<S: Scalar>(finite: &FiniteElements<S>, i: usize, x: &Local<S>, out: &mut [S]) {
    let element = &finite.mesh.elements[i];
    let [thin, thick] = factors(finite, i);
    let n = element.coordinates.len();
    out.fill(S::zero());
    let [bending, shear] = &element.linear;
    bending.add_to(thick, n, out);
    shear.add_to(thin, n, out);
    let strained = Strained::of(element, &Deformed::new(element, *x));
    let own = strained.gradients(element);
    let scaled = vectorised(
        #[inline(always)]
        || own.map(|column| stresses(element, &column).map(|n| n * thin)),
    );
    add_products(element, (&own, &scaled), true, out);
    let stress = stresses(element, &strained.strain).map(|n| n * thin);
    add_curvature(element, &stress, n, out);
}

/// The diagonal of the linear stiffness.
pub fn diagonal<S: Scalar>(finite: &FiniteElements<S>) -> Vec<S> {
    let mut out = vec![S::zero(); finite.mesh.coordinates];
    let mut matrix = [S::zero(); UNKNOWNS * UNKNOWNS];
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let n = element.coordinates.len();
        tangent(finite, i, &[S::zero(); UNKNOWNS], &mut matrix[..n * n]);
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
