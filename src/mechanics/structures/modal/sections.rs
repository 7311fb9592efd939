//! Section forces, moments and fibre stresses of a beam as quadratic forms of its coordinates.

use super::beam::{FlexibleBeam, SectionMode, StrainMeasure};
use crate::math::Scalar;
use crate::math::legendre::gauss;
use crate::model::flexible::{BeamSection, Quadratic};
use crate::structures::beam::Section;
use std::f64::consts::PI;

/// Ratio of the bending stiffnesses of a section below which a beam does not buckle laterally.
const UNLIKE: f64 = 1.5;
/// Number of sections that show how far a beam is turned.
const SECTIONS: usize = 8;

/// A force or moment in a section, in the axes of the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionForce {
    /// Axial force N, positive in tension \[N\].
    Axial,
    /// Shear force along y \[N\].
    ShearY,
    /// Shear force along z \[N\].
    ShearZ,
    /// Torsion moment [N m].
    Torsion,
    /// Bending moment about y [N m].
    BendingY,
    /// Bending moment about z [N m].
    BendingZ,
}

impl<S: Scalar> FlexibleBeam<S> {
    /// A section force at ξ.
    pub fn section_force(&self, force: SectionForce, xi: S) -> Quadratic<S> {
        let [ea, _, _, gj, ei2, ei3] = self.values().stiffness;
        let modes = self.section_modes(xi);
        if force == SectionForce::Axial {
            let strain = self.line_strain(&modes);
            return scaled(&strain, ea);
        }
        // The axis of the moment, its stiffness, and what to take of each coordinate.
        let (axis, stiffness) = match force {
            SectionForce::Axial | SectionForce::Torsion => (0, gj),
            SectionForce::ShearY | SectionForce::BendingZ => (2, ei3),
            SectionForce::ShearZ | SectionForce::BendingY => (1, ei2),
        };
        let of = |i: usize| match force {
            SectionForce::ShearY => modes[i].moment_slopes[0],
            SectionForce::ShearZ => modes[i].moment_slopes[1],
            _ => modes[i].curvature[axis],
        };
        let form = Quadratic {
            linear: (0..modes.len()).map(of).collect(),
            squares: self.products_at(axis, of),
        };
        scaled(&form, stiffness)
    }

    /// Strain ε − y κ3 + z κ2 along the fibre at (y, z) of the section at ξ.
    pub fn fibre_strain(&self, xi: S, [y, z]: [S; 2]) -> Quadratic<S> {
        let modes = self.section_modes(xi);
        let mut strain = self.line_strain(&modes);
        for (axis, arm) in [(1, z), (2, -y)] {
            for (x, mode) in strain.linear.iter_mut().zip(&modes) {
                *x += mode.curvature[axis] * arm;
            }
            let squares = self.products_at(axis, |i| modes[i].curvature[axis]);
            let squares = squares.into_iter().map(|(c, g)| (c * arm, g));
            strain.squares.extend(squares);
        }
        strain
    }

    /// Stress E ε along a fibre \[Pa\].
    pub fn fibre_stress(&self, xi: S, fibre: [S; 2]) -> Quadratic<S> {
        scaled(&self.fibre_strain(xi, fibre), self.material.young)
    }

    /// See [`BeamSection::lateral`]. Given stiffnesses of what has no functions are not known.
    fn lateral(&self) -> Option<(usize, f64)> {
        let [_, _, _, gj, ei2, ei3] = self.values().stiffness.map(|x| x.re());
        let whole = self.modes.torsion > 0 && self.modes.bending.iter().all(|&n| n > 0);
        let known = whole || !matches!(self.section, Section::Given(_));
        let (strong, weak) = if ei2 > ei3 { (2, ei3) } else { (3, ei2) };
        let critical = PI * (weak * gj).sqrt() / self.length.re();
        (known && !self.couples() && ei2.max(ei3) > UNLIKE * weak).then_some((strong, critical))
    }

    /// Sections that show how far the beam is turned.
    pub fn sections(&self) -> Vec<BeamSection> {
        let [ea, _, _, gj, ei2, ei3] = self.values().stiffness.map(|x| x.re());
        let one = |(xi, weight): (f64, f64)| {
            let modes = self.section_modes(S::from(xi));
            let row =
                |of: &dyn Fn(&SectionMode<S>) -> S| modes.iter().map(|m| of(m).re()).collect();
            BeamSection {
                size: self.length.re() * weight,
                von_karman: self.strain == StrainMeasure::VonKarman,
                lateral: self.lateral(),
                stiffness: [ea, gj, ei2, ei3],
                slopes: [row(&|m| m.slopes[0]), row(&|m| m.slopes[1])],
                twist: row(&|m| m.rotation[0]),
                strains: [
                    row(&|m| m.stretch),
                    row(&|m| m.curvature[0]),
                    row(&|m| m.curvature[1]),
                    row(&|m| m.curvature[2]),
                ],
            }
        };
        gauss(SECTIONS).into_iter().map(one).collect()
    }

    /// Half the size of the section along y and z; none for given stiffnesses.
    pub fn half_sizes(&self) -> Option<[S; 2]> {
        match self.section {
            Section::Rectangle { width, height } | Section::I { width, height, .. } => {
                Some([height * 0.5, width * 0.5])
            }
            Section::Tube { radius, .. } => Some([radius, radius]),
            Section::Given(_) => None,
        }
    }
}

/// A quadratic form times a factor.
fn scaled<S: Scalar>(form: &Quadratic<S>, by: S) -> Quadratic<S> {
    Quadratic {
        linear: form.linear.iter().map(|&x| x * by).collect(),
        squares: (form.squares.iter())
            .map(|(c, g)| (*c * by, g.clone()))
            .collect(),
    }
}
