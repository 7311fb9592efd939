//! Prescribed motions of joints.
//!
//! A drive rotates or shifts the joint's frame on body B by a function of time, about or along e3.
//! It adds a row that makes body A follow (see [`super::joint`]):
//!
//! ```text
//! turn    e1(t) = e1 cos φ(t) + e2 sin φ(t),   e2(t) = e2 cos φ(t) − e1 sin φ(t)
//! slide   s(t)  = s + σ(t) e3
//! ```
//!
//! φ is the angle and σ the displacement of body A relative to body B, from the placement. Both are
//! twice continuously differentiable [functions of time](TimeFunction).

use super::TimeFunction;
use crate::math::parameters;

/// A degree of freedom of a joint along or about its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DegreeOfFreedom {
    /// Rotation about the axis e: the rate is φ̇ = e · (ω_A − ω_B).
    Rotation,
    /// Displacement along the axis e: the rate is that of e · (P_A − P_B).
    Translation,
}

/// The prescribed motion of a joint along or about its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive<S> {
    /// The degree of freedom.
    pub dof: DegreeOfFreedom,
    /// Angle \[rad\] or displacement \[m\] as a function of time.
    pub course: TimeFunction<S>,
}

parameters!(struct Drive { dof; course });
