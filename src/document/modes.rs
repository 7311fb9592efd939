//! Vibrations of machines: tables of modes, steady rotation, and functions of damped and turning machines.

use crate::quantity::{Quantity, Vector};
use schemars::JsonSchema;
use serde::Deserialize;

/// Steady rotation of a whole machine about an axis. Its rest is that in a frame which turns with it, its vibrations are those
/// about that rest, and drives hold their joints as that frame sees them. Turned about the axis, the machine must be the same:
/// gravity is along the axis or zero, and what joins bodies to ground does so alike in all directions across the axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteadyRotation {
    /// Direction of the axis, of any length; the machine turns about it by the right hand.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "the axis of rotation says what is asked, not what is built"
    ))]
    pub axis: [f64; 3],
    /// A point of the axis, default the origin.
    #[schemars(extend("unit" = "m"))]
    pub at: Option<Vector>,
    /// Speed of rotation.
    #[schemars(extend("unit" = "rad/s", "minimum" = 0))]
    pub speed: Quantity,
}

/// Which modes are told and drawn.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModeTable {
    /// Number of modes, the lowest first, default 6.
    #[serde(default = "ModeTable::count")]
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 150,
        "design_variable" = "the number of modes is a count, not a physical number"
    ))]
    pub count: usize,
    /// Speeds of rotation of a Campbell diagram.
    #[serde(default)]
    #[schemars(extend(
        "unit" = "rad/s",
        "design_variable" = "the speeds of a diagram say what is asked, not what is built"
    ))]
    pub speeds: Vec<f64>,
}

impl ModeTable {
    fn count() -> usize {
        6
    }
}

impl Default for ModeTable {
    fn default() -> Self {
        Self {
            count: Self::count(),
            speeds: Vec::new(),
        }
    }
}

/// The damping ratio of a mode.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DampingRatio {
    /// Number of the damped mode from 1, by its rate |s|: that of "frequency" with "damped". Motions that do not oscillate,
    /// being free or damped beyond ζ = 1, are not counted.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 150,
        "design_variable" = "the number of a mode is a count, not a physical number"
    ))]
    pub mode: usize,
    /// Whether the mode is followed by its shape while the design changes: "mode" is its number at the start of the file.
    /// Default: modes are counted by |s| at each design.
    #[serde(default)]
    pub follow: bool,
}

/// A critical speed of a machine that turns.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CriticalSpeed {
    /// Its number from 1, the lowest first. The two planes of a round shaft count as one.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 50,
        "design_variable" = "the number of a speed is a count, not a physical number"
    ))]
    pub number: usize,
}
