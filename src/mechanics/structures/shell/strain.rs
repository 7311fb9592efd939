//! Strains of the element at its Gauss points, and the transpose.
//!
//! At a point, with the geometry (a_α, d) and the motion (u, q):
//!
//! ```text
//! ε_αβ = ½(a_α·u,β + a_β·u,α) + ½(d·u,α)(d·u,β)
//! κ_αβ = ½(a_α·q,β + a_β·q,α + d,α·u,β + d,β·u,α)
//! γ_α  = a_α·q + d·u,α
//! ```
//!
//! Each component is taken at the points where it is tied (`basis`) and carried to the Gauss
//! points, there to the orthonormal frame; `correction` adds a mean to the linear membrane and bending
//! strains of MITC9. Stresses take the curvatures of the motion itself. Rotations may be as large as the von Karman
//! strain admits.

use super::basis::{
    Basis, COMPONENTS, GAUSS_POINTS, NODES, SHEAR_POINTS, TYING_POINTS, Tables, component,
};
use super::correction::{Correction, add_correction_transpose, correction};
use super::field::{
    AtPoint, Field, add_interpolate_transpose, add_sum_transpose, interpolate, sum,
};
use super::frame::Frame;
use super::tying::{add_carry_shear_transpose, add_carry_transpose, carry, carry_shear};
use crate::math::{Scalar, Vec3};
use crate::model::shell_kind::ShellKind;

/// Which terms of the strain are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// The von Karman term of the membrane strain.
    pub von_karman: bool,
    /// The correction that lets distorted elements pass the patch test.
    pub patch_correction: bool,
}

impl Terms {
    /// Linear strains with the correction.
    pub const LINEAR: Self = Self {
        von_karman: false,
        patch_correction: true,
    };
    /// Von Karman's strains with the correction.
    pub const VON_KARMAN: Self = Self {
        von_karman: true,
        patch_correction: true,
    };
}

/// Which curvatures are taken at the Gauss points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// Those carried from where they are tied, with the correction: the energy has them.
    Tied,
    /// Those of the motion there. Their twist has half the error of the tied one, so stresses have them.
    OfMotion,
}

/// Strains at a Gauss point in its frame, and the area that it stands for; or their cotangents.
#[derive(Clone, Copy, Debug)]
pub struct Strain<S> {
    /// (e_11, e_22, 2 e_12) of the middle surface [-].
    pub membrane: [S; 3],
    /// (κ_11, κ_22, 2 κ_12) [1/m].
    pub bending: [S; 3],
    /// (γ_1, γ_2) [-].
    pub shear: [S; 2],
    /// Area of the point, weight times J [m²].
    pub area: S,
}

impl<S: Scalar> Strain<S> {
    pub fn zeros() -> Self {
        let zero = S::zero();
        Self {
            membrane: [zero; 3],
            bending: [zero; 3],
            shear: [zero; 2],
            area: zero,
        }
    }
}

/// Covariant strain components at a point.
fn membrane<S: Scalar>(g: &AtPoint<S>, u: &AtPoint<S>, [a, b]: [usize; 2]) -> S {
    (g.by[a].dot(&u.by[b]) + g.by[b].dot(&u.by[a])) * 0.5
}

fn membrane_quadratic<S: Scalar>(g: &AtPoint<S>, u: &AtPoint<S>, [a, b]: [usize; 2]) -> S {
    g.director.dot(&u.by[a]) * g.director.dot(&u.by[b]) * 0.5
}

fn bending<S: Scalar>(g: &AtPoint<S>, u: &AtPoint<S>, [a, b]: [usize; 2]) -> S {
    (g.by[a].dot(&u.director_by[b])
        + g.by[b].dot(&u.director_by[a])
        + g.director_by[a].dot(&u.by[b])
        + g.director_by[b].dot(&u.by[a]))
        * 0.5
}

fn shear<S: Scalar>(g: &AtPoint<S>, u: &AtPoint<S>, a: usize) -> S {
    g.by[a].dot(&u.director) + g.director.dot(&u.by[a])
}

/// Cotangents at a point: of the geometry and of the motion.
struct Pair<S> {
    geometry: AtPoint<S>,
    motion: AtPoint<S>,
}

impl<S: Scalar> Pair<S> {
    fn zeros() -> Self {
        Self {
            geometry: AtPoint::zeros(),
            motion: AtPoint::zeros(),
        }
    }

    fn add_membrane_transpose(&mut self, g: &AtPoint<S>, u: &AtPoint<S>, c: usize, bar: S) {
        let (half, [a, b]) = (bar * 0.5, COMPONENTS[c]);
        self.geometry.by[a] += u.by[b] * half;
        self.geometry.by[b] += u.by[a] * half;
        self.motion.by[a] += g.by[b] * half;
        self.motion.by[b] += g.by[a] * half;
    }

    fn add_quadratic_transpose(&mut self, g: &AtPoint<S>, u: &AtPoint<S>, c: usize, bar: S) {
        let (half, [a, b]) = (bar * 0.5, COMPONENTS[c]);
        let (da, db) = (g.director.dot(&u.by[a]), g.director.dot(&u.by[b]));
        self.geometry.director += (u.by[a] * db + u.by[b] * da) * half;
        self.motion.by[a] += g.director * (db * half);
        self.motion.by[b] += g.director * (da * half);
    }

    fn add_bending_transpose(&mut self, g: &AtPoint<S>, u: &AtPoint<S>, c: usize, bar: S) {
        let (half, [a, b]) = (bar * 0.5, COMPONENTS[c]);
        self.geometry.by[a] += u.director_by[b] * half;
        self.geometry.by[b] += u.director_by[a] * half;
        self.geometry.director_by[a] += u.by[b] * half;
        self.geometry.director_by[b] += u.by[a] * half;
        self.motion.director_by[b] += g.by[a] * half;
        self.motion.director_by[a] += g.by[b] * half;
        self.motion.by[b] += g.director_by[a] * half;
        self.motion.by[a] += g.director_by[b] * half;
    }

    fn add_shear_transpose(&mut self, g: &AtPoint<S>, u: &AtPoint<S>, a: usize, bar: S) {
        self.geometry.by[a] += u.director * bar;
        self.geometry.director += u.by[a] * bar;
        self.motion.director += g.by[a] * bar;
        self.motion.by[a] += g.director * bar;
    }
}

/// Components at the tying points.
struct TiedStrain<S> {
    membrane: [S; TYING_POINTS],
    quadratic: [S; TYING_POINTS],
    bending: [S; TYING_POINTS],
    shear: [S; SHEAR_POINTS],
}

impl<S: Scalar> TiedStrain<S> {
    fn zeros() -> Self {
        let zero = S::zero();
        Self {
            membrane: [zero; TYING_POINTS],
            quadratic: [zero; TYING_POINTS],
            bending: [zero; TYING_POINTS],
            shear: [zero; SHEAR_POINTS],
        }
    }
}

/// The state of an element between [`ElementStrain::new`] and [`ElementStrain::add_transpose`].
pub struct ElementStrain<'a, S> {
    tables: &'static Tables,
    geometry: &'a Field<S>,
    motion: &'a Field<S>,
    terms: Terms,
    curvature: Curvature,
    frames: [Frame<S>; GAUSS_POINTS],
    /// Direction of the first axes: a_r in the middle.
    reference: Vec3<S>,
    tied: TiedStrain<S>,
    correction: Option<Correction<S>>,
    /// The strains at the Gauss points; zero where the kind has none.
    points: [Strain<S>; GAUSS_POINTS],
}

impl<'a, S: Scalar> ElementStrain<'a, S> {
    /// Strains of a motion of a geometry.
    pub fn new(
        kind: ShellKind,
        (geometry, motion): (&'a Field<S>, &'a Field<S>),
        terms: Terms,
        curvature: Curvature,
    ) -> Self {
        let tables = kind.tables();
        let corrected = terms.patch_correction && tables.corrected;
        let mut all = Self {
            tables,
            geometry,
            motion,
            terms,
            curvature,
            frames: [Frame::zeros(); GAUSS_POINTS],
            reference: sum(&tables.middle.by[0], &geometry.points),
            tied: TiedStrain::zeros(),
            correction: corrected.then(|| correction(geometry)),
            points: [Strain::zeros(); GAUSS_POINTS],
        };
        all.tie();
        all.measure_gauss_points();
        all.gather();
        all
    }

    /// The strains at the Gauss points.
    pub fn points(&self) -> &[Strain<S>] {
        &self.points[..self.tables.gauss.len()]
    }

    /// Components at the tying points.
    fn tie(&mut self) {
        for point in &self.tables.tying {
            let (p, basis) = (point.index, &point.basis);
            let g = interpolate(basis, self.geometry);
            let u = interpolate(basis, self.motion);
            let c = COMPONENTS[component(p)];
            if point.in_plane {
                self.tied.membrane[p] = membrane(&g, &u, c);
                self.tied.bending[p] = bending(&g, &u, c);
                if self.terms.von_karman {
                    self.tied.quadratic[p] = membrane_quadratic(&g, &u, c);
                }
            }
            if point.shear {
                self.tied.shear[p] = shear(&g, &u, c[0]);
            }
        }
    }

    /// Frames and areas of the Gauss points.
    fn measure_gauss_points(&mut self) {
        for (k, Basis { by, .. }) in self.tables.gauss.iter().enumerate() {
            let tangents = [0, 1].map(|d| sum(&by[d], &self.geometry.points));
            self.frames[k] = Frame::of(&tangents, &self.reference);
            self.points[k].area = self.frames[k].area * self.tables.weights[k];
        }
    }

    /// Mean membrane strains and curvatures that the correction adds.
    fn mean(&self) -> [[S; 3]; 2] {
        let Some(vectors) = &self.correction else {
            return [[S::zero(); 3]; 2];
        };
        let work = |vectors: &[Vec3<S>; NODES], motion: &[Vec3<S>; NODES]| {
            let pairs = vectors.iter().zip(motion);
            pairs.fold(S::zero(), |sum, (c, v)| sum + c.dot(v))
        };
        let (u, q) = (&self.motion.points, &self.motion.directors);
        [
            std::array::from_fn(|c| work(&vectors.strain[c], u)),
            std::array::from_fn(|c| work(&vectors.bending[c], u) + work(&vectors.turning[c], q)),
        ]
    }

    /// Transpose of the derivative of [`ElementStrain::mean`].
    fn add_mean_transpose(
        &self,
        bar: &[[S; 3]; 2],
        geometry: &mut Field<S>,
        motion: &mut Field<S>,
    ) {
        let Some(vectors) = &self.correction else {
            return;
        };
        let mut vectors_bar = Correction::zeros();
        for c in 0..3 {
            for a in 0..NODES {
                let (u, q) = (&self.motion.points[a], &self.motion.directors[a]);
                motion.points[a] +=
                    vectors.strain[c][a] * bar[0][c] + vectors.bending[c][a] * bar[1][c];
                motion.directors[a] += vectors.turning[c][a] * bar[1][c];
                vectors_bar.strain[c][a] = u * bar[0][c];
                vectors_bar.bending[c][a] = u * bar[1][c];
                vectors_bar.turning[c][a] = q * bar[1][c];
            }
        }
        add_correction_transpose(self.geometry, &vectors_bar, geometry);
    }

    /// Membrane components of all terms at the tying points.
    fn all_membrane(&self) -> [S; TYING_POINTS] {
        std::array::from_fn(|p| self.tied.membrane[p] + self.tied.quadratic[p])
    }

    /// Covariant curvatures at a Gauss point.
    fn curvatures(&self, k: usize) -> [S; 3] {
        match self.curvature {
            Curvature::Tied => carry(&self.tables.tied[k], &self.tied.bending),
            Curvature::OfMotion => {
                let g = interpolate(&self.tables.gauss[k], self.geometry);
                let u = interpolate(&self.tables.gauss[k], self.motion);
                COMPONENTS.map(|c| bending(&g, &u, c))
            }
        }
    }

    /// Transpose of the derivative of [`ElementStrain::curvatures`] where they are those of the motion.
    fn add_curvatures_of_motion_transpose(
        &self,
        k: usize,
        bar: &[S; 3],
        geometry: &mut Field<S>,
        motion: &mut Field<S>,
    ) {
        let g = interpolate(&self.tables.gauss[k], self.geometry);
        let u = interpolate(&self.tables.gauss[k], self.motion);
        let mut pair = Pair::zeros();
        for (c, &bar) in bar.iter().enumerate() {
            pair.add_bending_transpose(&g, &u, c, bar);
        }
        add_interpolate_transpose(&self.tables.gauss[k], &pair.geometry, geometry);
        add_interpolate_transpose(&self.tables.gauss[k], &pair.motion, motion);
    }

    /// Strains in the frames of the Gauss points.
    fn gather(&mut self) {
        let (total, mean) = (self.all_membrane(), self.mean());
        for (k, tied) in self.tables.tied.iter().enumerate() {
            let frame = &self.frames[k];
            let m = frame.strain(&carry(tied, &total));
            let b = frame.strain(&self.curvatures(k));
            let point = &mut self.points[k];
            point.membrane = std::array::from_fn(|c| m[c] + mean[0][c]);
            point.bending = match self.curvature {
                Curvature::Tied => std::array::from_fn(|c| b[c] + mean[1][c]),
                Curvature::OfMotion => b,
            };
            point.shear = frame.shear(&carry_shear(tied, &self.tied.shear));
        }
    }

    /// Transpose of the derivative of [`ElementStrain::new`]: adds the contributions of the
    /// cotangents of strains and areas to those of geometry and motion.
    pub fn add_transpose(
        &self,
        bar: &[Strain<S>; GAUSS_POINTS],
        geometry: &mut Field<S>,
        motion: &mut Field<S>,
    ) {
        let zero = S::zero();
        let total = self.all_membrane();
        let mut tied = TiedStrain::zeros();
        let mut mean_bar = [[zero; 3]; 2];
        let mut reference_bar = Vec3::zeros();
        let count = self.tables.gauss.len();
        for point in &bar[..count] {
            for c in 0..3 {
                mean_bar[0][c] += point.membrane[c];
                if self.curvature == Curvature::Tied {
                    mean_bar[1][c] += point.bending[c];
                }
            }
        }
        for k in 0..count {
            let (frame, point) = (&self.frames[k], &bar[k]);
            let own = &self.tables.tied[k];
            let mut frame_bar = Frame::zeros();
            frame.add_strain_frame_transpose(&carry(own, &total), &point.membrane, &mut frame_bar);
            let curvatures = self.curvatures(k);
            frame.add_strain_frame_transpose(&curvatures, &point.bending, &mut frame_bar);
            frame.add_shear_frame_transpose(
                &carry_shear(own, &self.tied.shear),
                &point.shear,
                &mut frame_bar,
            );
            let m = frame.strain_transpose(&point.membrane);
            add_carry_transpose(own, &m, &mut tied.membrane);
            add_carry_transpose(own, &m, &mut tied.quadratic);
            let b = frame.strain_transpose(&point.bending);
            match self.curvature {
                Curvature::Tied => add_carry_transpose(own, &b, &mut tied.bending),
                Curvature::OfMotion => {
                    self.add_curvatures_of_motion_transpose(k, &b, geometry, motion);
                }
            }
            let s = frame.shear_transpose(&point.shear);
            add_carry_shear_transpose(own, &s, &mut tied.shear);

            frame_bar.area += point.area * self.tables.weights[k];
            let basis = &self.tables.gauss[k];
            let tangents = [0, 1].map(|d| sum(&basis.by[d], &self.geometry.points));
            let mut tangents_bar = [Vec3::zeros(); 2];
            frame.add_of_transpose(
                &frame_bar,
                &tangents,
                &self.reference,
                &mut tangents_bar,
                &mut reference_bar,
            );
            for d in 0..2 {
                add_sum_transpose(&basis.by[d], &tangents_bar[d], &mut geometry.points);
            }
        }
        self.add_mean_transpose(&mean_bar, geometry, motion);
        let middle = &self.tables.middle.by[0];
        add_sum_transpose(middle, &reference_bar, &mut geometry.points);
        self.add_tie_transpose(&tied, geometry, motion);
    }

    /// Transpose of the derivative of [`ElementStrain::tie`].
    fn add_tie_transpose(
        &self,
        bar: &TiedStrain<S>,
        geometry: &mut Field<S>,
        motion: &mut Field<S>,
    ) {
        for point in &self.tables.tying {
            let (p, basis) = (point.index, &point.basis);
            let g = interpolate(basis, self.geometry);
            let u = interpolate(basis, self.motion);
            let c = component(p);
            let mut pair = Pair::zeros();
            if point.in_plane {
                pair.add_membrane_transpose(&g, &u, c, bar.membrane[p]);
                pair.add_bending_transpose(&g, &u, c, bar.bending[p]);
                if self.terms.von_karman {
                    pair.add_quadratic_transpose(&g, &u, c, bar.quadratic[p]);
                }
            }
            if point.shear {
                pair.add_shear_transpose(&g, &u, COMPONENTS[c][0], bar.shear[p]);
            }
            add_interpolate_transpose(basis, &pair.geometry, geometry);
            add_interpolate_transpose(basis, &pair.motion, motion);
        }
    }
}
