//! Drives in a file.

use super::magnitudes::Interpolation;
use crate::quantity::{Quantity, nothing};
use schemars::JsonSchema;
use serde::Deserialize;

/// Prescribed motion of a joint about its axis, along it, or both. It is the motion of the first
/// body relative to the second (ground counts as the second), from the placement.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Name of a revolute, planar, prismatic or cylindrical joint.
    pub joint: String,
    /// Angle about the axis as a function of time.
    pub turn: Option<Turning>,
    /// Displacement along the axis as a function of time.
    pub slide: Option<Sliding>,
}

/// A motion in its unit.
macro_rules! time_functions {
    ($course:ident, $what:literal, $unit:literal, $rate:literal, $faster:literal, $powers:literal) => {
        #[doc = concat!("Function of time: ", $what, ".")]
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        pub enum $course {
            /// Constant rate, starting at zero.
            Rate(#[schemars(extend("unit" = $rate))] Quantity),
            /// Coefficients c0, c1, c2, … of c0 + c1 t + c2 t² + …
            Polynomial(#[schemars(extend("unit" = $powers))] Vec<Quantity>),
            /// mean + amplitude · sin(2π frequency t + phase).
            Harmonic {
                /// Amplitude.
                #[schemars(extend("unit" = $unit))]
                amplitude: Quantity,
                /// Frequency.
                #[schemars(extend("unit" = "Hz"))]
                frequency: Quantity,
                /// Phase at t = 0, default 0.
                #[serde(default = "nothing")]
                #[schemars(extend("unit" = "rad"))]
                phase: Quantity,
                /// Mean, default 0.
                #[serde(default = "nothing")]
                #[schemars(extend("unit" = $unit))]
                mean: Quantity,
            },
            /// Interpolation with continuous acceleration. It is at rest at both ends and constant
            /// beyond.
            Table {
                /// Instants, increasing.
                #[schemars(extend(
                    "unit" = "s",
                    "design_variable" = "the instants of a table keep their order; design its values"
                ))]
                times: Vec<f64>,
                /// Value at each instant.
                #[schemars(extend("unit" = $unit))]
                values: Vec<Quantity>,
                /// Interpolation between the values, default monotone.
                interpolation: Option<Interpolation>,
            },
            /// A way from one value to another within a speed and an acceleration, at rest before and after it. Its jerk is
            /// continuous.
            SCurve {
                /// Value before it, default 0.
                #[serde(default = "nothing")]
                #[schemars(extend("unit" = $unit))]
                from: Quantity,
                /// Value behind it, another one.
                #[schemars(extend("unit" = $unit))]
                to: Quantity,
                /// Instant at which it starts, default 0.
                #[serde(default = "nothing")]
                #[schemars(extend("unit" = "s"))]
                start: Quantity,
                /// Largest speed. A short way does not reach it.
                #[schemars(extend("unit" = $rate, "exclusiveMinimum" = 0))]
                speed: Quantity,
                /// Largest acceleration.
                #[schemars(extend("unit" = $faster, "exclusiveMinimum" = 0))]
                acceleration: Quantity,
            },
        }

        impl $course {
            /// The time function without its unit.
            pub fn parts(&self) -> TimeFunction<'_> {
                match self {
                    Self::Rate(rate) => TimeFunction::Rate(rate),
                    Self::Polynomial(coefficients) => TimeFunction::Polynomial(coefficients),
                    Self::Harmonic {
                        amplitude,
                        frequency,
                        phase,
                        mean,
                    } => TimeFunction::Harmonic([mean, amplitude, frequency, phase]),
                    Self::Table {
                        times,
                        values,
                        interpolation,
                    } => TimeFunction::Table(times, values, *interpolation),
                    Self::SCurve {
                        from,
                        to,
                        start,
                        speed,
                        acceleration,
                    } => TimeFunction::SCurve([from, to, start, speed, acceleration]),
                }
            }
        }
    };
}

time_functions!(
    Turning,
    "an angle",
    "rad",
    "rad/s",
    "rad/s²",
    "rad, rad/s, rad/s², …"
);
time_functions!(
    Sliding,
    "a displacement",
    "m",
    "m/s",
    "m/s²",
    "m, m/s, m/s², …"
);
time_functions!(
    Following,
    "an angle, displacement or distance",
    "m or rad",
    "m/s or rad/s",
    "m/s² or rad/s²",
    "m, m/s, m/s², … or rad, rad/s, rad/s², …"
);

/// A time function without its unit.
pub enum TimeFunction<'a> {
    /// Constant rate.
    Rate(&'a Quantity),
    /// Coefficients.
    Polynomial(&'a [Quantity]),
    /// Mean, amplitude, frequency and phase.
    Harmonic([&'a Quantity; 4]),
    /// Instants and values.
    Table(&'a [f64], &'a [Quantity], Option<Interpolation>),
    /// From, to, start, speed and acceleration.
    SCurve([&'a Quantity; 5]),
}
