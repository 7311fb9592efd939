//! Bodies with elastic coordinates: their numbers, in any scalar, for the model of the motion.

pub mod beam;
pub mod craig_bampton;
pub mod damping;
pub mod free_body;
pub mod frequencies;
pub mod imported;
pub mod interfaces;
pub mod loaded;
mod mass_integrals;
mod second_moments;
pub mod sections;
mod shapes;
mod twist;
pub mod written;

pub use beam::{BeamDamping, BeamModes, FlexibleBeam, StrainMeasure};
pub use shapes::{BeamFrame, BendingFunctions};

use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::{ModalInertia, ModalStiffness};

/// The numbers of a body with elastic coordinates for its motion.
#[derive(Clone, Debug)]
pub struct ModalNumbers<S> {
    /// ∫ dm \[kg\].
    pub mass: S,
    /// Inertia of the undeformed body about the origin of its axes [kg m²].
    pub inertia: Mat3<S>,
    /// Integrals of the shapes.
    pub shapes: ModalInertia<S>,
    /// Strain energy.
    pub stiffness: ModalStiffness<S>,
    /// Damping matrix, by rows.
    pub damping: Vec<S>,
    /// β of strains that are damped in proportion to their stiffness \[s\]; `None` without.
    pub viscosity: Option<S>,
}

/// How a point of a body moves with each elastic coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct PointModes<S> {
    /// Where the point is in the undeformed body \[m\].
    pub position: Vec3<S>,
    /// Displacement N_I.
    pub displacement: Vec<Vec3<S>>,
    /// Rotation Θ_I.
    pub rotation: Vec<Vec3<S>>,
}

impl<S: Scalar> ModalNumbers<S> {
    /// Number of elastic coordinates.
    pub fn modes(&self) -> usize {
        self.shapes.static_moments.len()
    }

    /// K of small motions, with the linear part of the strains: K + Σ k_p b_p b_pᵀ, by rows.
    pub fn linear_stiffness(&self) -> Vec<S> {
        let m = self.modes();
        let mut k = self.stiffness.linear.clone();
        for strain in &self.stiffness.strains {
            let b = &strain.strain.linear;
            for i in 0..m {
                for j in 0..m {
                    k[i * m + j] += strain.weight * b[i] * b[j];
                }
            }
        }
        k
    }

    /// Mass of the elastic coordinates with the axes at rest, M_IJ = tr S_IJ, by rows.
    pub fn elastic_mass(&self) -> Vec<S> {
        let m = self.modes();
        let mut mass = vec![S::zero(); m * m];
        for i in 0..m {
            for j in 0..m {
                mass[i * m + j] = self.shapes.products[self.shapes.place(i, j).0].trace();
            }
        }
        mass
    }
}
