//! Magnitudes in time and motions of joints, of loads and controllers in a file.

use crate::quantity::{Quantity, nothing};
use flexbody_mechanics::model;
use schemars::JsonSchema;
use serde::Deserialize;

/// Interpolation between the values of a table.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
    Linear,
    /// Smooth without overshoot.
    Monotone,
    /// As smooth as the values. It may overshoot.
    Spline,
}

impl Interpolation {
    /// The same interpolation in the model; default monotone.
    pub fn of(written: Option<Self>) -> model::Interpolation {
        match written {
            Some(Self::Linear) => model::Interpolation::Linear,
            Some(Self::Spline) => model::Interpolation::Spline,
            Some(Self::Monotone) | None => model::Interpolation::Monotone,
        }
    }
}

/// A magnitude in its unit, and how it may vary with time.
macro_rules! time_functions {
    ($course:ident, $varying:ident, $what:literal, $unit:literal) => {
        #[doc = concat!("Magnitude of a ", $what, ".")]
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[serde(untagged)]
        pub enum $course {
            /// The same at all times.
            #[schemars(extend("unit" = $unit))]
            Constant(Quantity),
            /// A function of time.
            Varying($varying),
        }

        #[doc = concat!("Function of time: a ", $what, ".")]
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        pub enum $varying {
            /// amplitude · sin(2π frequency t + phase).
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
            },
            /// Interpolation between values, constant beyond both ends.
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
        }

        impl $course {
            /// The time function without its unit.
            pub fn parts(&self) -> TimeFunction<'_> {
                match self {
                    $course::Constant(value) => TimeFunction::Constant(value),
                    $course::Varying($varying::Harmonic {
                        amplitude,
                        frequency,
                        phase,
                    }) => TimeFunction::Harmonic([amplitude, frequency, phase]),
                    $course::Varying($varying::Table {
                        times,
                        values,
                        interpolation,
                    }) => TimeFunction::Table(times, values, *interpolation),
                }
            }
        }
    };
}

time_functions!(ForceInTime, VaryingForce, "force", "N");
time_functions!(TorqueInTime, VaryingTorque, "torque", "N m");
time_functions!(PressureInTime, VaryingPressure, "pressure", "Pa");
time_functions!(EffortInTime, VaryingEffort, "force or torque", "N or N m");
time_functions!(LineForceInTime, VaryingLineForce, "force per length", "N/m");

/// A time function without its unit.
pub enum TimeFunction<'a> {
    /// The same at all times.
    Constant(&'a Quantity),
    /// Amplitude, frequency and phase.
    Harmonic([&'a Quantity; 3]),
    /// Instants and values.
    Table(&'a [f64], &'a [Quantity], Option<Interpolation>),
}

/// A degree of freedom of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Rotation about its axis.
    Turn,
    /// Displacement along its axis.
    Slide,
}
