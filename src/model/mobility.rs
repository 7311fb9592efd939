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
    /// Translation in a plane without rotation: two unknowns.
    PlanarPoint {
        /// Two orthonormal directions of the plane, ground axes.
        along: [Vec3<f64>; 2],
        /// The unit normal in body axes.
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
            Mobility::PlanarPoint { .. } => 2,
            Mobility::Fixed => 0,
        }
    }

    /// This mobility without rotation.
    pub fn unturned(self) -> Self {
        match self {
            Mobility::Planar { along, normal } => Mobility::PlanarPoint { along, normal },
            Mobility::Spatial => Mobility::Point,
            Mobility::PlanarPoint { .. } | Mobility::Point | Mobility::Fixed => self,
        }
    }

    /// Whether it has rotation.
    pub fn turns(&self) -> bool {
        matches!(self, Mobility::Spatial | Mobility::Planar { .. })
    }
}
