//! Relative quantities and powers, in a file.

use super::mechanics::Point;
use crate::quantity::Vector;
use schemars::JsonSchema;
use serde::Deserialize;

/// A component of a point's motion as seen from another body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Relative {
    /// The body that is seen.
    pub body: String,
    /// Its point, by name or in body axes; default the centre of mass.
    pub point: Option<Point>,
    /// The body that sees it, or "ground".
    pub relative_to: String,
    /// The point of that body from which it is seen, by name or in its axes; default its centre of mass, on ground the origin.
    pub from: Option<Point>,
    /// Direction in the axes of the body that sees. It is not normalised; a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// Two points whose distance is measured.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Distance {
    /// The first body.
    pub body: String,
    /// Its point, by name or in body axes; default the centre of mass.
    pub point: Option<Point>,
    /// The other body, or "ground".
    pub relative_to: String,
    /// Its point, by name or in its axes; default its centre of mass, on ground the origin.
    pub from: Option<Point>,
}

/// What gives or takes power: a load, or the drive of a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum PowerOf {
    /// Name of a force, torque, spring, damper or friction. Positive where it gives energy to the bodies.
    Load(String),
    /// Name of a drive. Positive where it gives energy to the machine.
    Drive(String),
}
