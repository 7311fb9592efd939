//! A rigid body: its mass properties and its initial state.

use super::Mobility;
use crate::math::rotation::Quat;
use crate::math::{Mat3, Scalar, Vec3, parameters};

/// A violation of the conditions of a solid up to this fraction of the largest moment is round-off.
pub const ROUNDING: f64 = 1e-12;

/// What a body of a model stands for. Only solids are in the problem file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A body.
    Solid,
    /// A point of a flexible body.
    Interface,
    /// Elastic coordinates of a flexible body.
    Elastic,
    /// The turns of a joint that a load counts.
    Counter,
    /// The coordinate of a coupling; its mass is the inertia of a rotor.
    Coordinate,
    /// The state of a controller, which is a velocity.
    State,
}

impl Role {
    /// Whether the position of such a body is an angle, in most cases, and its mass an inertia.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Counter | Self::Coordinate)
    }

    /// Whether the position of such a body is no place: its mass has neither weight nor momentum.
    pub fn is_abstract(self) -> bool {
        matches!(self, Self::Counter | Self::Coordinate | Self::State)
    }
}

/// A rigid body. Its reference point is the centre of mass. Its axes are those of the body in the
/// problem file.
#[derive(Clone, Debug)]
pub struct RigidBody<S> {
    /// Name in the problem file.
    pub name: String,
    /// Mass \[kg\].
    pub mass: S,
    /// Inertia about the centre of mass, body axes, symmetric \[kg m²\].
    pub inertia: Mat3<S>,
    /// Guess of the centre of mass at t = 0 in ground axes \[m\].
    pub position: Vec3<S>,
    /// Guess of the Euler parameters at t = 0, from body axes to ground; unit length.
    pub orientation: Quat<S>,
    /// Guess of the velocity of the centre of mass at t = 0 in ground axes \[m/s\].
    pub velocity: Vec3<S>,
    /// Guess of the angular velocity at t = 0 in body axes \[rad/s\].
    pub angular_velocity: Vec3<S>,
    /// The velocities that the body can have, for all designs.
    pub mobility: Mobility,
    /// What it stands for.
    pub role: Role,
}

parameters!(struct RigidBody {
    name, mobility, role;
    mass, inertia, position, orientation, velocity, angular_velocity
});

impl<S: Scalar> RigidBody<S> {
    /// A body without mass at rest in the origin.
    pub fn massless(name: String) -> Self {
        let (zero, one) = (S::zero(), S::one());
        RigidBody {
            name,
            mass: zero,
            inertia: Mat3::zeros(),
            position: Vec3::zeros(),
            orientation: [one, zero, zero, zero],
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            mobility: Mobility::spatial(),
            role: Role::Solid,
        }
    }

    /// Whether it is a point mass, which does not rotate: a mass without inertia. Joints do turn links without mass.
    pub fn is_point(&self) -> bool {
        self.mass.re() > 0.0 && self.inertia.iter().all(|x| x.re() == 0.0)
    }
}

impl RigidBody<f64> {
    /// Whether mass and inertia are those of a solid, or zero: no negative mass, and [`is_inertia_of_solid`].
    pub fn is_solid(&self, tolerance: f64) -> bool {
        self.mass >= 0.0 && is_inertia_of_solid(&self.inertia, tolerance)
    }
}

/// Whether an inertia is that of a solid. Principal moments are integrals of squares: none is
/// negative but for round-off, and none exceeds the sum of the other two by more than `tolerance`
/// times the largest.
pub fn is_inertia_of_solid(inertia: &Mat3<f64>, tolerance: f64) -> bool {
    let moments = inertia.symmetric_eigenvalues();
    moments.min() >= -ROUNDING * moments.amax()
        && excess_of_inertia(inertia) <= tolerance.max(ROUNDING)
}

/// By how much the largest principal moment exceeds the sum of the other two, relative to itself; zero or
/// negative for a solid.
pub fn excess_of_inertia(inertia: &Mat3<f64>) -> f64 {
    let moments = inertia.symmetric_eigenvalues();
    let (largest, sum) = (moments.amax(), moments.iter().sum::<f64>());
    match largest > 0.0 {
        true => (2.0 * moments.max() - sum) / largest,
        false => 0.0,
    }
}
