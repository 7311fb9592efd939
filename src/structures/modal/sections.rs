//! Section forces, moments and fibre stresses of a beam as quadratic forms of its coordinates.

use super::beam::FlexibleBeam;
use crate::math::Scalar;
use crate::model::flexible::Quadratic;
use crate::structures::beam::Section;

/// A force or moment in a section, in the axes of the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SectionForce {
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
    pub(crate) fn section_force(&self, force: SectionForce, xi: S) -> Quadratic<S> {
        let [ea, _, _, gj, ei2, ei3] = self.values().stiffness;
        let modes = self.section_modes(xi);
        if force == SectionForce::Axial {
            let strain = self.line_strain(&modes);
            return scaled(&strain, ea);
        }
        let linear = modes.iter().map(|mode| match force {
            SectionForce::Axial => mode.stretch * ea,
            SectionForce::ShearY => mode.moment_slopes[0] * ei3,
            SectionForce::ShearZ => mode.moment_slopes[1] * ei2,
            SectionForce::Torsion => mode.curvature[0] * gj,
            SectionForce::BendingY => mode.curvature[1] * ei2,
            SectionForce::BendingZ => mode.curvature[2] * ei3,
        });
        Quadratic {
            linear: linear.collect(),
            squares: Vec::new(),
        }
    }

    /// Strain ε − y κ3 + z κ2 along the fibre at (y, z) of the section at ξ.
    pub(crate) fn fibre_strain(&self, xi: S, [y, z]: [S; 2]) -> Quadratic<S> {
        let modes = self.section_modes(xi);
        let mut strain = self.line_strain(&modes);
        for (x, mode) in strain.linear.iter_mut().zip(&modes) {
            *x += mode.curvature[1] * z - mode.curvature[2] * y;
        }
        strain
    }

    /// Stress E ε along a fibre \[Pa\].
    pub(crate) fn fibre_stress(&self, xi: S, fibre: [S; 2]) -> Quadratic<S> {
        scaled(&self.fibre_strain(xi, fibre), self.material.young)
    }

    /// Half the size of the section along y and z; none for given stiffnesses.
    pub(crate) fn half_sizes(&self) -> Option<[S; 2]> {
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
