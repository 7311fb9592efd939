//! Which velocities a body can have in the scene that it is part of.

use crate::math::Vec3;

/// Velocities of a body, (ṙ in ground axes, ω in body axes) = B u with a constant basis B of
/// orthonormal columns. A body that cannot leave a subspace has its equations solved in it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mobility {
    /// Any velocity: six unknowns.
    Spatial,
    /// Translation in a plane and rotation about its normal: three unknowns.
    Planar {
        /// Two orthonormal directions of the plane, ground axes.
        along: [Vec3<f64>; 2],
        /// The unit normal in body axes, which a motion in the plane does not change.
        normal: Vec3<f64>,
    },
    /// Translation without rotation: three unknowns.
    Point,
    /// None: no unknowns.
    Fixed,
}

impl Mobility {
    /// Number of unknowns u.
    pub fn unknowns(&self) -> usize {
        match self {
            Mobility::Spatial => 6,
            Mobility::Planar { .. } | Mobility::Point => 3,
            Mobility::Fixed => 0,
        }
    }
}
