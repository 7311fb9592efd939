//! The mechanical model: bodies, joints, loads and gravity with their parameters, without state.
//!
//! Parameters are generic in the scalar: a model has values (`f64`), complex steps or dual numbers.
//! A model of zeros in `f64` also serves as a cotangent: it holds the derivative of a function in
//! each parameter.

pub(crate) mod drive;
pub(crate) mod joint;
pub(crate) mod load;
pub(crate) mod mobility;
pub(crate) mod rigid_body;
pub(crate) mod table;
pub(crate) mod time_function;

pub(crate) use drive::{DegreeOfFreedom, Drive};
pub(crate) use joint::{ConstraintRow, Joint, JointFrame, JointKind};
pub(crate) use load::{Axes, Load, LoadKind};
pub(crate) use mobility::Mobility;
pub(crate) use rigid_body::RigidBody;
pub(crate) use table::{Interpolation, Smoothness};
pub(crate) use time_function::TimeFunction;

use crate::math::{Scalar, Vec3, parameters};

/// Bodies, joints, loads and gravity of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Model<S> {
    /// Gravitational acceleration in ground axes \[m/s²\].
    pub gravity: Vec3<S>,
    /// Bodies in the order of the problem file.
    pub bodies: Vec<RigidBody<S>>,
    /// Joints in the order of the problem file.
    pub joints: Vec<Joint<S>>,
    /// Loads in the order of the problem file.
    pub loads: Vec<Load<S>>,
}

parameters!(struct Model {; gravity, bodies, joints, loads });

impl<S: Scalar> Model<S> {
    /// Whether energy is conserved: only springs and gravity do work.
    pub(crate) fn conserves_energy(&self) -> bool {
        let conserves = |load: &Load<S>| match &load.kind {
            LoadKind::Spring { damping, .. } | LoadKind::TorsionSpring { damping, .. } => {
                damping.re() == 0.0
            }
            LoadKind::Damping { coefficient, .. } | LoadKind::BallDamping { coefficient, .. } => {
                coefficient.re() == 0.0
            }
            LoadKind::Friction { size, .. } => size.re() == 0.0,
            LoadKind::Force { .. } | LoadKind::Torque { .. } => false,
        };
        let driven = self.joints.iter().any(|joint| !joint.drives.is_empty());
        !driven && self.loads.iter().all(conserves)
    }
}
