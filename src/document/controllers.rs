//! Controllers and their motors in a file.

use super::drives::Following;
use super::joints::Ends;
use super::magnitudes::{EffortInTime, Motion};
use super::mechanics::Point;
use crate::quantity::{Quantity, nothing};
use schemars::JsonSchema;
use serde::Deserialize;

/// A controller with its motor, which makes a joint or a distance follow a reference: the effort (force or torque) is
/// p e + d ė + k ∫e dt and more, within the limits of the motor. It is positive where it increases the coordinate. Give `joint`,
/// or `between` and `at`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// Name of a revolute, prismatic, cylindrical or planar joint. Its angle or displacement is that of the first body
    /// relative to the second (ground counts as the second), from the placement.
    pub joint: Option<String>,
    /// Motion of a cylindrical joint, default rotation.
    pub motion: Option<Motion>,
    /// Two bodies, the distance of whose points is controlled; one of them may be "ground".
    pub between: Option<[String; 2]>,
    /// Their points.
    pub at: Option<Ends>,
    /// What the coordinate follows, default 0: a number, or a function of time. The error e is the reference minus the
    /// coordinate.
    pub reference: Option<Reference>,
    /// Gain p of the error, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N/m or N m/rad"))]
    pub proportional: Quantity,
    /// Gain d of the rate of the error, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N s/m or N m s/rad"))]
    pub derivative: Quantity,
    /// Gain k of the integral of the error, which is a state; default none.
    #[schemars(extend("unit" = "N/(m s) or N m/(rad s)"))]
    pub integral: Option<Quantity>,
    /// Time in which the integral follows the limits of the motor, so that it does not wind up; default none.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0))]
    pub anti_windup: Option<Quantity>,
    /// Effort that is added, default 0: a number, or a function of time.
    pub feed_forward: Option<EffortInTime>,
    /// Feedback of other joints: with p and d, a row of the matrix of a state feedback.
    #[serde(default)]
    pub feedback: Vec<Feedback>,
    /// Masses whose weight the effort balances where they are. They move with the first body of the joint.
    #[serde(default)]
    pub gravity_compensation: Vec<Balanced>,
    /// The motor, default without limits.
    pub motor: Option<Motor>,
}

/// What a coordinate follows.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Reference {
    /// The same at all times.
    #[schemars(extend("unit" = "m or rad"))]
    Constant(Quantity),
    /// A function of time.
    Varying(Following),
}

/// Feedback of another joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Feedback {
    /// Name of a revolute, prismatic, cylindrical or planar joint.
    pub joint: String,
    /// Motion of a cylindrical joint, default rotation.
    pub motion: Option<Motion>,
    /// Reference of its angle or displacement, default 0.
    pub reference: Option<Reference>,
    /// Effort per error of this joint, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N/m, N/rad, N m/m, N m/rad"))]
    pub proportional: Quantity,
    /// Effort per rate of this error, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N s/m, N s/rad, N m s/m, N m s/rad"))]
    pub derivative: Quantity,
}

/// A mass whose weight is balanced.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Balanced {
    /// The body that has it.
    pub body: String,
    /// Where it is, by name or in body axes; default as of a force.
    pub point: Option<Point>,
    /// The mass that the controller reckons with.
    #[schemars(extend("unit" = "kg", "minimum" = 0))]
    pub mass: Quantity,
}

/// A motor behind a gear. A limit z of a demand u leaves u (1 + (u/z)⁸)^(−1/8), which is off by less than 0.1 % up to half of
/// the limit.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Turns of the motor for one of the joint, default 1; of a slide or distance the angle of the motor for a metre, 1 of a
    /// linear motor.
    #[serde(default = "one")]
    #[schemars(extend("unit" = "rad/m or 1", "exclusiveMinimum" = 0))]
    pub gear_ratio: Quantity,
    /// Inertia of what turns with the motor, default none. Through the gear the joint feels its product with the square of
    /// `gear_ratio`; that the motor also turns with the body on which it sits is left out.
    #[schemars(extend("unit" = "kg m² (kg of a linear motor)", "minimum" = 0))]
    pub rotor_inertia: Option<Quantity>,
    /// Largest torque of the motor (force of a linear motor), as by its current; default none.
    #[schemars(extend("unit" = "N m", "exclusiveMinimum" = 0))]
    pub torque: Option<Quantity>,
    /// Torque by speed, as by the voltage of a motor of direct current; default none.
    pub curve: Option<Curve>,
    /// Largest power, default none.
    #[schemars(extend("unit" = "W", "exclusiveMinimum" = 0))]
    pub power: Option<Quantity>,
    /// Time constant with which the torque follows what is demanded, a lag of first order; default none.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0))]
    pub lag: Option<Quantity>,
}

/// Torque of a motor by its speed: between −A (1 + ω/W) and A (1 − ω/W).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Torque A of the motor at speed zero.
    #[schemars(extend("unit" = "N m", "exclusiveMinimum" = 0))]
    pub stall_torque: Quantity,
    /// Speed W of the motor at which it has no torque.
    #[schemars(extend("unit" = "rad/s", "exclusiveMinimum" = 0))]
    pub no_load_speed: Quantity,
}

/// The quantity 1.
fn one() -> Quantity {
    Quantity::fixed(1.0)
}
