//! Von Mises stresses of an element, at both faces of its Gauss points.
//!
//! σ = C (e ± h/2 κ), σ_v² = σ_11² + σ_22² − σ_11 σ_22 + 3 σ_12² (plane stress), divided by the yield
//! stress. Transverse shear stresses vanish at the faces. Curvatures κ are those of the motion, not the tied
//! ones of the energy.

use super::basis::{GAUSS_POINTS, TYING_POINTS};
use super::energy::{Motion, Shell, ShellCotangent};
use super::field::{Field, sum};
use super::frame::Frame;
use super::strain::{Curvature, ElementStrain, Strain, Terms};
use super::tying::carry;
use crate::math::Scalar;
use crate::model::shell_kind::ShellKind;
use crate::structures::material::Material;

/// Places of an element whose stress is evaluated, at most: (Gauss point, face), the face z = +h/2 first.
pub const STRESS_POINTS: usize = 2 * GAUSS_POINTS;

impl ShellKind {
    /// Places whose stress is evaluated.
    pub fn stress_points(self) -> usize {
        2 * self.tables().gauss.len()
    }
}

/// Strains or curvatures at the Gauss points, three of each after one another; zero where a kind has none.
pub type AtGaussPoints<S> = [S; 3 * GAUSS_POINTS];

/// Plane von Mises stress; its derivative at no stress counts as none.
fn von_mises<S: Scalar>(stress: &[S; 3]) -> S {
    let [x, y, xy] = *stress;
    let square = x * x + y * y - x * y + xy * xy * 3.0;
    if square.re() > 0.0 {
        square.sqrt()
    } else {
        S::zero()
    }
}

/// Derivatives of [`von_mises`] by the stresses.
fn von_mises_slope<S: Scalar>(stress: &[S; 3], value: S) -> [S; 3] {
    let [x, y, xy] = *stress;
    if value.re() == 0.0 {
        return [S::zero(); 3];
    }
    let by = value * 2.0;
    [(x * 2.0 - y) / by, (y * 2.0 - x) / by, xy * 6.0 / by]
}

/// Strain at a face of a Gauss point, and the distance of the face from the middle surface.
fn at_face<S: Scalar>(
    thickness: S,
    (membrane, curvature): (&AtGaussPoints<S>, &AtGaussPoints<S>),
    k: usize,
) -> ([S; 3], S) {
    let z = thickness * if k.is_multiple_of(2) { 0.5 } else { -0.5 };
    let at = 3 * (k / 2);
    let e = std::array::from_fn(|c| membrane[at + c] + z * curvature[at + c]);
    (e, z)
}

/// σ_v / σ_yield of strains of the middle surface and curvatures at the Gauss points, face +h/2 and face −h/2 of each
/// after one another.
pub fn stress_ratios_of<S: Scalar>(
    material: &Material<S>,
    thickness: S,
    of: (&AtGaussPoints<S>, &AtGaussPoints<S>),
) -> [S; STRESS_POINTS] {
    std::array::from_fn(|k| {
        let (e, _) = at_face(thickness, of, k);
        von_mises(&material.plane_stress(&e)) / material.yield_stress
    })
}

/// Cotangents of what [`stress_ratios_of`] depends on.
pub struct StressCotangent<S> {
    pub membrane: AtGaussPoints<S>,
    pub curvature: AtGaussPoints<S>,
    pub thickness: S,
    pub material: Material<S>,
}

/// Transpose of the derivative of [`stress_ratios_of`].
pub fn pull_stress_ratios_of<S: Scalar>(
    material: &Material<S>,
    thickness: S,
    of: (&AtGaussPoints<S>, &AtGaussPoints<S>),
    bar: &[S; STRESS_POINTS],
) -> StressCotangent<S> {
    let mut out = StressCotangent {
        membrane: [S::zero(); 3 * GAUSS_POINTS],
        curvature: [S::zero(); 3 * GAUSS_POINTS],
        thickness: S::zero(),
        material: Material::zeros(),
    };
    let yield_stress = material.yield_stress;
    for (k, &bar) in bar.iter().enumerate() {
        let (e, z) = at_face(thickness, of, k);
        let stress = material.plane_stress(&e);
        let value = von_mises(&stress);
        out.material.yield_stress -= bar * value / (yield_stress * yield_stress);
        let slope = von_mises_slope(&stress, value).map(|x| x * bar / yield_stress);
        material.add_plane_stress_transpose(&e, &slope, &mut out.material);
        let e_bar = material.plane_stress(&slope);
        let sign = if k.is_multiple_of(2) { 0.5 } else { -0.5 };
        let at = 3 * (k / 2);
        for c in 0..3 {
            out.membrane[at + c] += e_bar[c];
            out.curvature[at + c] += z * e_bar[c];
            out.thickness += e_bar[c] * of.1[at + c] * sign;
        }
    }
    out
}

/// Strains of the middle surface at the Gauss points by components at the tying points, and the mean that the
/// correction adds.
pub fn membrane_strains(
    (kind, geometry): (ShellKind, &Field<f64>),
    tied: &[f64; TYING_POINTS],
    mean: &[f64; 3],
) -> AtGaussPoints<f64> {
    let tables = kind.tables();
    let reference = sum(&tables.middle.by[0], &geometry.points);
    let mut out = [0.0; 3 * GAUSS_POINTS];
    let points = tables.gauss.iter().zip(&tables.tied);
    for ((basis, of_point), out) in points.zip(out.as_chunks_mut::<3>().0) {
        let tangents = [0, 1].map(|d| sum(&basis.by[d], &geometry.points));
        let own = Frame::of(&tangents, &reference).strain(&carry(of_point, tied));
        *out = std::array::from_fn(|c| own[c] + mean[c]);
    }
    out
}

/// Curvatures of a motion at the Gauss points, which stresses have.
pub fn curvatures(
    (kind, geometry): (ShellKind, &Field<f64>),
    motion: &Field<f64>,
) -> AtGaussPoints<f64> {
    let terms = Terms {
        von_karman: false,
        patch_correction: false,
    };
    let strain = ElementStrain::new(kind, (geometry, motion), terms, Curvature::OfMotion);
    flat(&strain)[1]
}

/// Strains of the middle surface and curvatures of an element.
fn flat<S: Scalar>(strain: &ElementStrain<S>) -> [AtGaussPoints<S>; 2] {
    let mut all = [[S::zero(); 3 * GAUSS_POINTS]; 2];
    for (k, point) in strain.points().iter().enumerate() {
        all[0][3 * k..][..3].copy_from_slice(&point.membrane);
        all[1][3 * k..][..3].copy_from_slice(&point.bending);
    }
    all
}

impl<S: Scalar> Shell<S> {
    /// σ_v / σ_yield at the Gauss points, face +h/2 and face −h/2 of each after one another, and zeros where the kind
    /// has none.
    pub fn stress_ratios(&self, motion: &Motion<S>, terms: Terms) -> [S; STRESS_POINTS] {
        let field = motion.field(&self.geometry);
        let strain = self.strain(&field, terms, Curvature::OfMotion);
        let [membrane, curvature] = flat(&strain);
        stress_ratios_of(&self.material, self.thickness, (&membrane, &curvature))
    }

    /// Transpose of the derivative of [`Shell::stress_ratios`]: by the motion to `force`, by
    /// everything else to `to`.
    pub fn add_stress_ratios_transpose(
        &self,
        motion: &Motion<S>,
        terms: Terms,
        bar: &[S; STRESS_POINTS],
        force: &mut Motion<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let field = motion.field(&self.geometry);
        let strain = self.strain(&field, terms, Curvature::OfMotion);
        let [membrane, curvature] = flat(&strain);
        let of = (&membrane, &curvature);
        let by = pull_stress_ratios_of(&self.material, self.thickness, of, bar);
        to.thickness += by.thickness;
        to.material.add(&by.material);
        let strain_bar = std::array::from_fn(|k| Strain {
            membrane: std::array::from_fn(|c| by.membrane[3 * k + c]),
            bending: std::array::from_fn(|c| by.curvature[3 * k + c]),
            ..Strain::zeros()
        });
        let mut motion_bar = Field::zeros();
        strain.add_transpose(&strain_bar, &mut to.geometry, &mut motion_bar);
        motion.add_field_transpose(&self.geometry, &motion_bar, force, &mut to.geometry);
    }
}
