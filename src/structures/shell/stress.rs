//! Von Mises stresses of an element, at both faces of its Gauss points.
//!
//! σ = C (e ± h/2 κ), σ_v² = σ_11² + σ_22² − σ_11 σ_22 + 3 σ_12² (plane stress), divided by the yield
//! stress. Transverse shear stresses vanish at the faces. Curvatures κ are those of the motion, not the tied
//! ones of the energy.

use super::basis::GAUSS_POINTS;
use super::energy::{Motion, Shell, ShellCotangent};
use super::field::Field;
use super::strain::{Curvature, ElementStrain, Strain, Terms};
use crate::math::Scalar;

/// Places of an element whose stress is evaluated: (Gauss point, face), the face z = +h/2 first.
pub(crate) const STRESS_POINTS: usize = 2 * GAUSS_POINTS;

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

/// Strain at a face, and the distance of the face from the middle surface.
fn at_face<S: Scalar>(shell: &Shell<S>, strain: &Strain<S>, face: usize) -> ([S; 3], S) {
    let z = shell.thickness * if face == 0 { 0.5 } else { -0.5 };
    let e = std::array::from_fn(|c| strain.membrane[c] + z * strain.bending[c]);
    (e, z)
}

impl<S: Scalar> Shell<S> {
    /// σ_v / σ_yield at the Gauss points, face +h/2 and face −h/2 of each after one another.
    pub(crate) fn stress_ratios(&self, motion: &Motion<S>, terms: Terms) -> [S; STRESS_POINTS] {
        self.field_stress_ratios(&motion.field(&self.geometry), terms)
    }

    /// As [`Shell::stress_ratios`], of the motion of points and directors.
    pub(crate) fn field_stress_ratios(&self, field: &Field<S>, terms: Terms) -> [S; STRESS_POINTS] {
        let strain = ElementStrain::new(&self.geometry, field, terms, Curvature::OfMotion);
        std::array::from_fn(|k| {
            let (e, _) = at_face(self, &strain.points[k / 2], k % 2);
            von_mises(&self.material.plane_stress(&e)) / self.material.yield_stress
        })
    }

    /// Transpose of the derivative of [`Shell::stress_ratios`]: by the motion to `force`, by
    /// everything else to `to`.
    pub(crate) fn add_stress_ratios_transpose(
        &self,
        motion: &Motion<S>,
        terms: Terms,
        bar: &[S; STRESS_POINTS],
        force: &mut Motion<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let field = motion.field(&self.geometry);
        let mut motion_bar = Field::zeros();
        self.add_field_stress_ratios_transpose(&field, terms, bar, &mut motion_bar, to);
        motion.add_field_transpose(&self.geometry, &motion_bar, force, &mut to.geometry);
    }

    /// Transpose of the derivative of [`Shell::field_stress_ratios`].
    pub(crate) fn add_field_stress_ratios_transpose(
        &self,
        field: &Field<S>,
        terms: Terms,
        bar: &[S; STRESS_POINTS],
        motion_bar: &mut Field<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let strain = ElementStrain::new(&self.geometry, field, terms, Curvature::OfMotion);
        let mut strain_bar = [Strain::zeros(); GAUSS_POINTS];
        let yield_stress = self.material.yield_stress;
        for (k, &bar) in bar.iter().enumerate() {
            let (point, point_bar) = (&strain.points[k / 2], &mut strain_bar[k / 2]);
            let (e, z) = at_face(self, point, k % 2);
            let stress = self.material.plane_stress(&e);
            let value = von_mises(&stress);
            to.material.yield_stress -= bar * value / (yield_stress * yield_stress);
            let slope = von_mises_slope(&stress, value).map(|x| x * bar / yield_stress);
            self.material
                .add_plane_stress_transpose(&e, &slope, &mut to.material);
            let e_bar = self.material.plane_stress(&slope);
            let sign = if k % 2 == 0 { 0.5 } else { -0.5 };
            for c in 0..3 {
                point_bar.membrane[c] += e_bar[c];
                point_bar.bending[c] += z * e_bar[c];
                to.thickness += e_bar[c] * point.bending[c] * sign;
            }
        }
        strain.add_transpose(&strain_bar, &mut to.geometry, motion_bar);
    }
}
