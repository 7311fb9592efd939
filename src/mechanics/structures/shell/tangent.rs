//! The tangent stiffness of an element, in closed form.
//!
//! The energy is quadratic in parameters of strain: of MITC9 16 tied membrane components and the 3 of the
//! patch correction, as many of bending, and 12 of shear; of MITC4 8, as many, and 4,
//!
//! ```text
//! U = ½ eᵀ K_m e + ½ kᵀ K_b k + ½ γᵀ K_s γ,   K_m = Σ_g dA h P_gᵀ C P_g and so on,
//! e_p = b_p·v + ½ (g1_p·v)(g2_p·v),   n = K_m e
//! K_T = Bᵀ K_m B + Σ_p n_p sym(g1_p g2_pᵀ) + B_bᵀ K_b B_b + B_sᵀ K_s B_s
//! ```
//!
//! with B_p = b_p + ½ (g1_p (g2_p·v) + g2_p (g1_p·v)). The columns are the displacements u_a and the
//! unknowns φ of the rotations: θ_a = Σ_k axis_k φ_k, so the director moves by axis_k × D_a.

use super::basis::{COMPONENTS, NODES, SHEAR_POINTS, TYING_POINTS, component};
use super::correction::correction;
use super::energy::{DRILLING, Motion, SHEAR_FACTOR, Shell};
use super::field::{AtPoint, Field, add_interpolate_transpose, interpolate, sum};
use super::frame::{self, Frame};
use super::matrix::{ElementMatrix, MOST_UNKNOWNS, RotationAxes};
use super::strain::Terms;
use crate::math::slices::add_scaled;
use crate::math::{Scalar, Vec3};
use nalgebra::SMatrix;

/// Strain parameters of membrane and of bending, at most; those that a kind does not have are zero.
const PARAMETERS: usize = TYING_POINTS + 3;
/// Displacements of the nodes, at most.
const DISPLACEMENTS: usize = 3 * NODES;

/// Rows of one kind of strain.
type Rows<S, const N: usize> = [[S; MOST_UNKNOWNS]; N];

/// Directors as the unknown rotations move them: axis_k × D_a.
struct Columns<S> {
    moved: [[Vec3<S>; 3]; NODES],
    count: [usize; NODES],
    nodes: usize,
    total: usize,
}

impl<S: Scalar> Columns<S> {
    fn new(axes: &RotationAxes<S>, shell: &Shell<S>) -> Self {
        let (directors, nodes) = (&shell.geometry.directors, shell.nodes());
        let moved = std::array::from_fn(|a| axes.axes[a].map(|x| x.cross(&directors[a])));
        Self {
            moved,
            count: axes.count,
            nodes,
            total: 3 * nodes + axes.total(nodes),
        }
    }

    /// Displacements of the nodes, which come first.
    fn displacements(&self) -> usize {
        3 * self.nodes
    }

    /// Writes the row whose product with (u, q) is that of `field`.
    #[inline]
    fn write(&self, field: &Field<S>, row: &mut [S; MOST_UNKNOWNS]) {
        let mut at = self.displacements();
        for a in 0..self.nodes {
            for i in 0..3 {
                row[3 * a + i] = field.points[a][i];
            }
            for k in 0..self.count[a] {
                row[at] = self.moved[a][k].dot(&field.directors[a]);
                at += 1;
            }
        }
    }
}

/// Gradient of a membrane component by the motion at its point.
#[inline]
fn membrane_gradient<S: Scalar>(
    g: &AtPoint<S>,
    u: Option<&AtPoint<S>>,
    [a, b]: [usize; 2],
) -> AtPoint<S> {
    let half = S::from(0.5);
    let tangent = |k: usize| match u {
        Some(u) => g.by[k] + g.director * g.director.dot(&u.by[k]),
        None => g.by[k],
    };
    let mut gradient = AtPoint::zeros();
    gradient.by[a] += tangent(b) * half;
    gradient.by[b] += tangent(a) * half;
    gradient
}

/// Gradient of a bending component by the motion at its point.
#[inline]
fn bending_gradient<S: Scalar>(g: &AtPoint<S>, [a, b]: [usize; 2]) -> AtPoint<S> {
    let half = S::from(0.5);
    let mut gradient = AtPoint::zeros();
    gradient.director_by[a] += g.by[b] * half;
    gradient.director_by[b] += g.by[a] * half;
    gradient.by[a] += g.director_by[b] * half;
    gradient.by[b] += g.director_by[a] * half;
    gradient
}

/// Everything between the geometry and the tangent.
struct Parameters<S> {
    membrane: Rows<S, PARAMETERS>,
    bending: Rows<S, PARAMETERS>,
    shear: Rows<S, SHEAR_POINTS>,
    /// K_m / h and K_b / (h³/12).
    plane: [[S; PARAMETERS]; PARAMETERS],
    /// K_s.
    shear_stiffness: [[S; SHEAR_POINTS]; SHEAR_POINTS],
    /// Membrane parameters e.
    strain: [S; PARAMETERS],
}

/// The numbers of the strain energy of an element for E = h = 1: those of the membrane parameters
/// e_p, K_m / (E h), and K_b / (E h³) and K_s / (E h) between the unknowns.
pub struct Operators {
    /// b_p over the displacements.
    pub membrane: Vec<[f64; DISPLACEMENTS]>,
    /// g1_p and g2_p.
    pub slopes: Vec<[[f64; DISPLACEMENTS]; 2]>,
    /// K_m.
    pub plane: [[f64; PARAMETERS]; PARAMETERS],
    /// K_b and K_s, by rows.
    pub linear: [Vec<f64>; 2],
    /// S with K_s = Sᵀ S.
    pub shear: Rows<f64, SHEAR_POINTS>,
}

impl Shell<f64> {
    /// The operators of an element whose unknown rotations are about `axes`.
    pub fn operators(&self, axes: &RotationAxes<f64>) -> Operators {
        let mut unit = *self;
        (unit.thickness, unit.material.young) = (1.0, 1.0);
        let columns = Columns::new(axes, &unit);
        let all = unit.parameters(&columns, None, Terms::VON_KARMAN);
        let mut matrix = ElementMatrix::new();
        let n = columns.total;
        let mut rows = |add: &dyn Fn(&mut ElementMatrix<f64>)| {
            matrix.clear(n);
            add(&mut matrix);
            let entry = |k: usize| matrix.rows[(k / n).max(k % n)][(k / n).min(k % n)];
            (0..n * n).map(entry).collect::<Vec<f64>>()
        };
        let bending = rows(&|matrix| {
            let scaled = multiply(&all.plane, &all.bending, 1.0 / 12.0, n);
            matrix.add_products(&all.bending, &scaled, n);
        });
        let shear = rows(&|matrix| {
            let scaled = multiply(&all.shear_stiffness, &all.shear, 1.0, n);
            matrix.add_products(&all.shear, &scaled, n);
        });
        let mut slopes = vec![[[0.0; DISPLACEMENTS]; 2]; TYING_POINTS];
        for point in self.kind.tables().tying.iter().filter(|own| own.in_plane) {
            let basis = &point.basis;
            let d = sum(&basis.n, &unit.geometry.directors);
            let slope = |k: usize| {
                let by = basis.by[k].places();
                std::array::from_fn(|i| d[i % 3] * by[i / 3])
            };
            slopes[point.index] = COMPONENTS[component(point.index)].map(slope);
        }
        Operators {
            membrane: (all.membrane.iter())
                .map(|row| std::array::from_fn(|i| row[i]))
                .collect(),
            slopes,
            plane: std::array::from_fn(|p| std::array::from_fn(|q| all.plane[p.max(q)][p.min(q)])),
            linear: [bending, shear],
            shear: root_rows(&all.shear_stiffness, &all.shear),
        }
    }
}

/// D^½ Vᵀ B for a stiffness V D Vᵀ, of which the lower part is given, between the rows B.
fn root_rows(
    stiffness: &[[f64; SHEAR_POINTS]; SHEAR_POINTS],
    rows: &Rows<f64, SHEAR_POINTS>,
) -> Rows<f64, SHEAR_POINTS> {
    let entry = |p: usize, q: usize| stiffness[p.max(q)][p.min(q)];
    let eigen = SMatrix::<f64, SHEAR_POINTS, SHEAR_POINTS>::from_fn(entry).symmetric_eigen();
    std::array::from_fn(|p| {
        let root = eigen.eigenvalues[p].max(0.0).sqrt();
        let mut out = [0.0; MOST_UNKNOWNS];
        for (q, row) in rows.iter().enumerate() {
            add_scaled(&mut out, root * eigen.eigenvectors[(q, p)], row);
        }
        out
    })
}

impl<S: Scalar> Shell<S> {
    /// Writes the tangent stiffness at a motion, lower part, into `matrix` [N/m, N, N m].
    pub fn tangent(
        &self,
        axes: &RotationAxes<S>,
        motion: &Motion<S>,
        terms: Terms,
        matrix: &mut ElementMatrix<S>,
    ) {
        let columns = Columns::new(axes, self);
        let state = terms.von_karman.then(|| motion.field(&self.geometry));
        let all = self.parameters(&columns, state.as_ref(), terms);
        matrix.clear(columns.total);
        let h = self.thickness;
        let cube = h * h * h / 12.0;
        let displacements = columns.displacements();
        let scaled = multiply(&all.plane, &all.membrane, h, displacements);
        matrix.add_products(&all.membrane, &scaled, displacements);
        let scaled = multiply(&all.plane, &all.bending, cube, columns.total);
        matrix.add_products(&all.bending, &scaled, columns.total);
        let scaled = multiply(&all.shear_stiffness, &all.shear, S::one(), columns.total);
        matrix.add_products(&all.shear, &scaled, columns.total);
        if terms.von_karman {
            self.add_geometric(&all, matrix);
        }
        if self.drilling {
            self.add_drilling(axes, &columns, matrix);
        }
    }

    fn parameters(
        &self,
        columns: &Columns<S>,
        state: Option<&Field<S>>,
        terms: Terms,
    ) -> Parameters<S> {
        let zero = S::zero();
        let mut all = Parameters {
            membrane: [[zero; MOST_UNKNOWNS]; PARAMETERS],
            bending: [[zero; MOST_UNKNOWNS]; PARAMETERS],
            shear: [[zero; MOST_UNKNOWNS]; SHEAR_POINTS],
            plane: [[zero; PARAMETERS]; PARAMETERS],
            shear_stiffness: [[zero; SHEAR_POINTS]; SHEAR_POINTS],
            strain: [zero; PARAMETERS],
        };
        for point in &self.kind.tables().tying {
            let (p, basis) = (point.index, &point.basis);
            let g = interpolate(basis, &self.geometry);
            let u = state.map(|state| interpolate(basis, state));
            let pair = COMPONENTS[component(p)];
            let write = |gradient: &AtPoint<S>, row: &mut [S; MOST_UNKNOWNS]| {
                let mut field = Field::zeros();
                add_interpolate_transpose(basis, gradient, &mut field);
                columns.write(&field, row);
            };
            if point.in_plane {
                if let Some(u) = &u {
                    let [a, b] = pair;
                    let quadratic = g.director.dot(&u.by[a]) * g.director.dot(&u.by[b]);
                    all.strain[p] =
                        (g.by[a].dot(&u.by[b]) + g.by[b].dot(&u.by[a]) + quadratic) * 0.5;
                }
                write(
                    &membrane_gradient(&g, u.as_ref(), pair),
                    &mut all.membrane[p],
                );
                write(&bending_gradient(&g, pair), &mut all.bending[p]);
            }
            if point.shear {
                let mut gradient = AtPoint::zeros();
                gradient.director = g.by[pair[0]];
                gradient.by[pair[0]] = g.director;
                write(&gradient, &mut all.shear[p]);
            }
        }
        self.add_gauss_points(columns, state, terms, &mut all);
        all
    }

    /// Stiffness of the parameters, and the rows of the patch correction.
    fn add_gauss_points(
        &self,
        columns: &Columns<S>,
        state: Option<&Field<S>>,
        terms: Terms,
        all: &mut Parameters<S>,
    ) {
        let tables = self.kind.tables();
        let reference = sum(&tables.middle.by[0], &self.geometry.points);
        let shear = self.material.shear_modulus() * self.thickness * SHEAR_FACTOR;
        for (k, tied) in tables.tied.iter().enumerate() {
            let by = &tables.gauss[k].by;
            let tangents = [0, 1].map(|d| sum(&by[d], &self.geometry.points));
            let frame = Frame::of(&tangents, &reference);
            let area = frame.area * tables.weights[k];
            add_plane(&frame, &self.material, area, tied, &mut all.plane);
            add_shear(&frame, shear * area, tied, &mut all.shear_stiffness);
        }
        if terms.patch_correction && tables.corrected {
            self.add_correction(columns, state, all);
        }
    }

    /// The rows of the patch correction.
    fn add_correction(
        &self,
        columns: &Columns<S>,
        state: Option<&Field<S>>,
        all: &mut Parameters<S>,
    ) {
        let vectors = correction(&self.geometry);
        for c in 0..3 {
            let mut field = Field::zeros();
            field.points = vectors.strain[c];
            columns.write(&field, &mut all.membrane[TYING_POINTS + c]);
            field.points = vectors.bending[c];
            field.directors = vectors.turning[c];
            columns.write(&field, &mut all.bending[TYING_POINTS + c]);
            if let Some(state) = state {
                let work = |sum: S, a: usize| sum + vectors.strain[c][a].dot(&state.points[a]);
                all.strain[TYING_POINTS + c] = (0..NODES).fold(S::zero(), work);
            }
        }
    }

    /// Σ_p n_p sym(g1_p g2_pᵀ): d dᵀ times products of slopes of the shape functions.
    fn add_geometric(&self, all: &Parameters<S>, matrix: &mut ElementMatrix<S>) {
        for point in self.kind.tables().tying.iter().filter(|own| own.in_plane) {
            let (p, basis) = (point.index, &point.basis);
            let force = (0..PARAMETERS).fold(S::zero(), |sum, q| {
                sum + all.plane[p.max(q)][p.min(q)] * all.strain[q]
            }) * self.thickness;
            let d = sum(&basis.n, &self.geometry.directors);
            let [r, s] = COMPONENTS[component(p)].map(|k| &basis.by[k]);
            let outer: [[S; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| d[i] * d[j] * force));
            for a in 0..basis.n.len() {
                for b in 0..=a {
                    let slope = 0.5 * (r[a] * s[b] + r[b] * s[a]);
                    for i in 0..3 {
                        let row = &mut matrix.rows[3 * a + i];
                        for j in 0..3 {
                            row[3 * b + j] += outer[i][j] * slope;
                        }
                    }
                }
            }
        }
    }

    fn add_drilling(
        &self,
        axes: &RotationAxes<S>,
        columns: &Columns<S>,
        matrix: &mut ElementMatrix<S>,
    ) {
        let stiffness = self.material.shear_modulus() * self.thickness * DRILLING;
        let mut row = [S::zero(); MOST_UNKNOWNS];
        for (basis, weight) in self.points() {
            let [ar, as_] = interpolate(basis, &self.geometry).by;
            let normal = ar.cross(&as_);
            let area = frame::area(&[ar, as_]);
            let mut at = columns.displacements();
            for a in 0..columns.nodes {
                for i in 0..3 {
                    row[3 * a + i] =
                        (ar[i] * basis.by[1][a] - as_[i] * basis.by[0][a]) * 0.5 / area;
                }
                for axis in &axes.axes[a][..axes.count[a]] {
                    row[at] = normal.dot(axis) * basis.n[a] / area;
                    at += 1;
                }
            }
            let weight = stiffness * area * weight;
            let mut scaled = row;
            for x in &mut scaled {
                *x *= weight;
            }
            matrix.add_products(&[row], &[scaled], columns.total);
        }
    }
}

/// Adds dA P_gᵀ C P_g, lower part. P_g has few columns that are not empty: those of the tying
/// points that the Gauss point takes, and the three of the correction. Those without weight are left out.
fn add_plane<S: Scalar>(
    frame: &Frame<S>,
    material: &crate::structures::material::Material<S>,
    area: S,
    tied: &super::basis::Tied,
    to: &mut [[S; PARAMETERS]; PARAMETERS],
) {
    let zero = S::zero();
    let mut columns = [(0_usize, [zero; 3]); 11];
    let lists: [(usize, &[(usize, f64)]); 3] = [(0, &tied.rr), (1, &tied.ss), (2, &tied.rs)];
    let mut at = 0;
    for (c, list) in lists {
        for &(p, w) in list.iter().filter(|(_, w)| *w != 0.0) {
            let mut covariant = [zero; 3];
            covariant[c] = S::from(w);
            columns[at] = (p, frame.strain(&covariant));
            at += 1;
        }
    }
    for c in 0..3 {
        let mut unit = [zero; 3];
        unit[c] = S::one();
        columns[at] = (TYING_POINTS + c, unit);
        at += 1;
    }
    let columns = &columns[..at];
    for (p, strain) in columns {
        let stress = material.plane_stress(strain).map(|x| x * area);
        for (q, other) in columns {
            if q <= p {
                to[*p][*q] += stress[0] * other[0] + stress[1] * other[1] + stress[2] * other[2];
            }
        }
    }
}

fn add_shear<S: Scalar>(
    frame: &Frame<S>,
    stiffness: S,
    tied: &super::basis::Tied,
    to: &mut [[S; SHEAR_POINTS]; SHEAR_POINTS],
) {
    let zero = S::zero();
    let mut columns = [(0_usize, [zero; 2]); 4];
    let [along_r, along_s] = &tied.shear;
    for k in 0..2 {
        columns[k] = (along_r[k].0, frame.shear(&[S::from(along_r[k].1), zero]));
        columns[2 + k] = (along_s[k].0, frame.shear(&[zero, S::from(along_s[k].1)]));
    }
    for (p, strain) in &columns {
        for (q, other) in &columns {
            if q <= p {
                to[*p][*q] += stiffness * (strain[0] * other[0] + strain[1] * other[1]);
            }
        }
    }
}

/// `factor` K B for a symmetric K given by its lower part.
fn multiply<S: Scalar, const N: usize>(
    k: &[[S; N]; N],
    b: &Rows<S, N>,
    factor: S,
    width: usize,
) -> Rows<S, N> {
    let mut product = [[S::zero(); MOST_UNKNOWNS]; N];
    for p in 0..N {
        for q in 0..N {
            let x = k[p.max(q)][p.min(q)] * factor;
            if x.re() != 0.0 || x.infinitesimal() != 0.0 {
                for (sum, &y) in product[p][..width].iter_mut().zip(&b[q]) {
                    *sum += x * y;
                }
            }
        }
    }
    product
}
