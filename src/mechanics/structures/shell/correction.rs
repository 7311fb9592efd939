//! The correction that lets distorted flat elements MITC9 pass the patch test.
//!
//! Tying changes the strains of a distorted element, and with them the forces of a constant strain.
//! The mean of what it changed is added to the strains at all Gauss points,
//!
//! ```text
//! E^ = Ē + (1/A) ∫ T (E − Ē) dA
//! ```
//!
//! for the linear membrane strains of the displacements and, with the same formula, for the
//! curvatures of the directors' motion. E and Ē in the mean are those of the element laid into the
//! plane of its middle, ã_α = (I − n nᵀ) a_α: tying removes the locking strains of a curved
//! element, which must not return. For parallelograms the correction vanishes.
//!
//! A curved element in a plane does not know its rigid rotations. So displacements −ω × r_a (r_a from
//! the centre of the nodes) are added to the vectors c_a that make the means, such that
//!
//! ```text
//! Σ l_a × c_a = (Σ r_a·r_a I − r_a r_aᵀ) ω,   l_a = r_a for strains, D_a for curvatures
//! ```
//!
//! and a rotation has no mean. For flat elements ω vanishes.

use super::basis::{COMPONENTS, GAUSS_POINTS, NODES, TYING_POINTS, Tables, component};
use super::field::{Field, add_sum_transpose, sum};
use super::frame::Frame;
use super::tying::{add_carry_transpose, carry};
use crate::math::{Mat3, Scalar, Vec3, scalar::length};
use crate::model::shell_kind::{PerNode, ShellKind};

/// Vectors of the means k = 11, 22, 12: strains Σ_a strain_ka·u_a, curvatures
/// Σ_a bending_ka·u_a + turning_ka·q_a.
#[derive(Clone, Copy, Debug)]
pub struct Correction<S> {
    pub strain: Vectors<S>,
    pub bending: Vectors<S>,
    pub turning: Vectors<S>,
}

impl<S: Scalar> Correction<S> {
    pub fn zeros() -> Self {
        let zero = [[Vec3::zeros(); NODES]; 3];
        Self {
            strain: zero,
            bending: zero,
            turning: zero,
        }
    }
}

type Vectors<S> = [[Vec3<S>; NODES]; 3];
type Tangents<S> = [Vec3<S>; 2];

/// The shape functions of the kind of element that is corrected.
fn tables() -> &'static Tables {
    ShellKind::Mitc9.tables()
}

/// The element in the plane of its middle.
struct Flat<S> {
    tables: &'static Tables,
    normal: Vec3<S>,
    middle: Tangents<S>,
    tying: [Tangents<S>; TYING_POINTS],
    gauss: [Tangents<S>; GAUSS_POINTS],
    frames: [Frame<S>; GAUSS_POINTS],
    area: S,
}

fn tangents<S: Scalar>(by: &[PerNode<f64>; 2], nodes: &[Vec3<S>; NODES]) -> Tangents<S> {
    [sum(&by[0], nodes), sum(&by[1], nodes)]
}

/// ½(a_α·v,β + a_β·v,α).
fn strain<S: Scalar>(a: &Tangents<S>, v: &Tangents<S>, [i, j]: [usize; 2]) -> S {
    (a[i].dot(&v[j]) + a[j].dot(&v[i])) * 0.5
}

/// Transpose of [`strain`] in one of its two arguments, the other being `a`.
fn add_strain_transpose<S: Scalar>(
    a: &Tangents<S>,
    [i, j]: [usize; 2],
    bar: S,
    to: &mut Tangents<S>,
) {
    let half = bar * 0.5;
    to[j] += a[i] * half;
    to[i] += a[j] * half;
}

impl<S: Scalar> Flat<S> {
    fn new(nodes: &[Vec3<S>; NODES]) -> Self {
        let tables = tables();
        let middle = tangents(&tables.middle.by, nodes);
        let normal = middle[0].cross(&middle[1]);
        let normal = normal / length(&normal);
        let flatten = |by| tangents(by, nodes).map(|a| a - normal * normal.dot(&a));
        let gauss = std::array::from_fn(|k| flatten(&tables.gauss[k].by));
        let mut area = S::zero();
        let frames = std::array::from_fn(|k| {
            let frame = Frame::of(&gauss[k], &middle[0]);
            area += frame.area * tables.weights[k];
            frame
        });
        Self {
            tables,
            normal,
            middle,
            tying: std::array::from_fn(|p| flatten(&tables.tying[p].basis.by)),
            gauss,
            frames,
            area,
        }
    }

    /// Share of a Gauss point in the area.
    fn share(&self, k: usize) -> S {
        self.frames[k].area * self.tables.weights[k] / self.area
    }
}

/// Places of the nodes from their centre, and the inverse of Σ r·r I − r rᵀ.
struct Levers<S> {
    from_centre: [Vec3<S>; NODES],
    inverse: Mat3<S>,
}

impl<S: Scalar> Levers<S> {
    fn new(nodes: &[Vec3<S>; NODES]) -> Self {
        let centre = nodes.iter().fold(Vec3::zeros(), |sum, x| sum + x) / S::from(NODES as f64);
        let from_centre = nodes.map(|x| x - centre);
        let mut m = Mat3::zeros();
        for r in &from_centre {
            m += Mat3::from_diagonal_element(r.dot(r)) - r * r.transpose();
        }
        let column = |k: usize| m.column(k).into_owned();
        let (a, b, c) = (column(0), column(1), column(2));
        let determinant = a.dot(&b.cross(&c));
        // The matrix is symmetric, and so is its inverse.
        let inverse = Mat3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)]) / determinant;
        Self {
            from_centre,
            inverse,
        }
    }

    /// Displacement vectors that balance the moment Σ l × c.
    fn balance(&self, levers: &[Vec3<S>; NODES], vectors: &[Vec3<S>; NODES]) -> [Vec3<S>; NODES] {
        let omega = self.inverse * moment(levers, vectors);
        self.from_centre.map(|r| r.cross(&omega))
    }

    /// Transpose of the derivative of [`Levers::balance`], by the levers, the vectors and r.
    fn add_balance_transpose(
        &self,
        levers: &[Vec3<S>; NODES],
        vectors: &[Vec3<S>; NODES],
        bar: &[Vec3<S>; NODES],
        levers_to: &mut [Vec3<S>; NODES],
        vectors_to: &mut [Vec3<S>; NODES],
        from_centre_to: &mut [Vec3<S>; NODES],
    ) {
        let omega = self.inverse * moment(levers, vectors);
        let omega_bar = -moment(&self.from_centre, bar);
        let m = self.inverse * omega_bar;
        let two = S::from(2.0);
        for a in 0..NODES {
            let r = &self.from_centre[a];
            from_centre_to[a] += omega.cross(&bar[a]) - r * (two * m.dot(&omega))
                + m * r.dot(&omega)
                + omega * m.dot(r);
            levers_to[a] += vectors[a].cross(&m);
            vectors_to[a] += m.cross(&levers[a]);
        }
    }
}

/// Σ l × c.
fn moment<S: Scalar>(levers: &[Vec3<S>; NODES], vectors: &[Vec3<S>; NODES]) -> Vec3<S> {
    let pairs = levers.iter().zip(vectors);
    pairs.fold(Vec3::zeros(), |sum, (l, c)| sum + l.cross(c))
}

/// The correction of an element.
pub fn correction<S: Scalar>(geometry: &Field<S>) -> Correction<S> {
    let raw = flat_vectors(&geometry.points);
    let levers = Levers::new(&geometry.points);
    let mut all = Correction::zeros();
    for (c, vectors) in raw.iter().enumerate() {
        let balance = levers.balance(&levers.from_centre, vectors);
        all.strain[c] = std::array::from_fn(|a| vectors[a] + balance[a]);
        all.bending[c] = levers.balance(&geometry.directors, vectors);
        all.turning[c] = *vectors;
    }
    all
}

/// Transpose of the derivative of [`correction`].
pub fn add_correction_transpose<S: Scalar>(
    geometry: &Field<S>,
    bar: &Correction<S>,
    to: &mut Field<S>,
) {
    let raw = flat_vectors(&geometry.points);
    let levers = Levers::new(&geometry.points);
    let mut raw_bar = bar.turning;
    let mut from_centre = [Vec3::zeros(); NODES];
    for (c, vectors) in raw.iter().enumerate() {
        for a in 0..NODES {
            raw_bar[c][a] += bar.strain[c][a];
        }
        let mut as_lever = [Vec3::zeros(); NODES];
        levers.add_balance_transpose(
            &levers.from_centre,
            vectors,
            &bar.strain[c],
            &mut as_lever,
            &mut raw_bar[c],
            &mut from_centre,
        );
        for a in 0..NODES {
            from_centre[a] += as_lever[a];
        }
        levers.add_balance_transpose(
            &geometry.directors,
            vectors,
            &bar.bending[c],
            &mut to.directors,
            &mut raw_bar[c],
            &mut from_centre,
        );
    }
    let mean = from_centre.iter().fold(Vec3::zeros(), |sum, x| sum + x) / S::from(NODES as f64);
    for a in 0..NODES {
        to.points[a] += from_centre[a] - mean;
    }
    add_flat_vectors_transpose(&geometry.points, &raw_bar, &mut to.points);
}

/// The vectors of the flat element.
fn flat_vectors<S: Scalar>(nodes: &[Vec3<S>; NODES]) -> Vectors<S> {
    let flat = Flat::new(nodes);
    let zero = Vec3::zeros();
    std::array::from_fn(|c| {
        let mut vectors = [zero; NODES];
        let mut tied = [S::zero(); TYING_POINTS];
        for k in 0..GAUSS_POINTS {
            let mut unit = [S::zero(); 3];
            unit[c] = flat.share(k);
            let covariant = flat.frames[k].strain_transpose(&unit);
            add_carry_transpose(&flat.tables.tied[k], &covariant.map(|x| -x), &mut tied);
            let mut by = [zero; 2];
            for (pair, &x) in COMPONENTS.into_iter().zip(&covariant) {
                add_strain_transpose(&flat.gauss[k], pair, x, &mut by);
            }
            for (basis, by) in flat.tables.gauss[k].by.iter().zip(&by) {
                add_sum_transpose(basis, by, &mut vectors);
            }
        }
        for p in 0..TYING_POINTS {
            let mut by = [zero; 2];
            add_strain_transpose(&flat.tying[p], COMPONENTS[component(p)], tied[p], &mut by);
            for (basis, by) in flat.tables.tying[p].basis.by.iter().zip(&by) {
                add_sum_transpose(basis, by, &mut vectors);
            }
        }
        vectors
    })
}

/// Transpose of the derivative of [`flat_vectors`].
fn add_flat_vectors_transpose<S: Scalar>(
    nodes: &[Vec3<S>; NODES],
    bar: &Vectors<S>,
    to: &mut [Vec3<S>; NODES],
) {
    let flat = Flat::new(nodes);
    let zero = [Vec3::zeros(); 2];
    let mut tying_bar = [zero; TYING_POINTS];
    let mut gauss_bar = [zero; GAUSS_POINTS];
    let mut frames_bar = [Frame::zeros(); GAUSS_POINTS];
    // The correction is linear in a motion: its cotangent takes the place of one.
    for (c, bar) in bar.iter().enumerate() {
        let at_tying: [Tangents<S>; TYING_POINTS] =
            std::array::from_fn(|p| tangents(&flat.tables.tying[p].basis.by, bar));
        let tied: [S; TYING_POINTS] =
            std::array::from_fn(|p| strain(&flat.tying[p], &at_tying[p], COMPONENTS[component(p)]));
        let mut tied_bar = [S::zero(); TYING_POINTS];
        let mut mean = S::zero();
        let mut changes = [S::zero(); GAUSS_POINTS];
        for k in 0..GAUSS_POINTS {
            let (frame, share) = (&flat.frames[k], flat.share(k));
            let at = tangents(&flat.tables.gauss[k].by, bar);
            let carried = carry(&flat.tables.tied[k], &tied);
            let defect = [0, 1, 2].map(|i| strain(&flat.gauss[k], &at, COMPONENTS[i]) - carried[i]);
            changes[k] = frame.strain(&defect)[c];
            mean += changes[k] * share;
            let mut unit = [S::zero(); 3];
            unit[c] = share;
            frame.add_strain_frame_transpose(&defect, &unit, &mut frames_bar[k]);
            let covariant = frame.strain_transpose(&unit);
            add_carry_transpose(&flat.tables.tied[k], &covariant.map(|x| -x), &mut tied_bar);
            for (pair, &x) in COMPONENTS.into_iter().zip(&covariant) {
                add_strain_transpose(&at, pair, x, &mut gauss_bar[k]);
            }
        }
        for k in 0..GAUSS_POINTS {
            frames_bar[k].area += (changes[k] - mean) * flat.tables.weights[k] / flat.area;
        }
        for p in 0..TYING_POINTS {
            let pair = COMPONENTS[component(p)];
            add_strain_transpose(&at_tying[p], pair, tied_bar[p], &mut tying_bar[p]);
        }
    }
    let mut middle_bar = zero;
    for k in 0..GAUSS_POINTS {
        let [reference_bar, _] = &mut middle_bar;
        flat.frames[k].add_of_transpose(
            &frames_bar[k],
            &flat.gauss[k],
            &flat.middle[0],
            &mut gauss_bar[k],
            reference_bar,
        );
    }
    let mut normal_bar = Vec3::zeros();
    let tying = flat.tables.tying.iter().map(|own| &own.basis);
    let tying = tying.zip(&tying_bar);
    for (basis, bars) in tying.chain(flat.tables.gauss.iter().zip(&gauss_bar)) {
        let a = tangents(&basis.by, nodes);
        for d in 0..2 {
            let (along, work) = (flat.normal.dot(&a[d]), flat.normal.dot(&bars[d]));
            normal_bar -= bars[d] * along + a[d] * work;
            add_sum_transpose(&basis.by[d], &(bars[d] - flat.normal * work), to);
        }
    }
    let size = length(&flat.middle[0].cross(&flat.middle[1]));
    let product = (normal_bar - flat.normal * flat.normal.dot(&normal_bar)) / size;
    middle_bar[0] += flat.middle[1].cross(&product);
    middle_bar[1] += product.cross(&flat.middle[0]);
    for d in 0..2 {
        add_sum_transpose(&flat.tables.middle.by[d], &middle_bar[d], to);
    }
}
