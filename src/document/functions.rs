//! Functions of interest in a file.

use super::cases::OverCases;
pub use super::instants::{
    Absolute, Component, CountedFrom, ElasticDisplacement, Energy, FibreStress, Gate, Instant,
    JointAngle, Momentum, Moving, OfBeam, Range, Rotation, SectionForce, ShellStress, Spinning,
};
use super::measured::Bound;
use super::misfit::Misfit;
use super::modes::{CriticalSpeed, DampingRatio};
use super::statics::{
    CentreOfMass, Displacement, Frequency, LowestFrequency, MomentOfInertia, OfCase,
    ReactionMoment, StaticReaction, Stress,
};
use super::windows::{During, Edge, FatigueDamage, MeanAbsolute, Over, ValueAt};
use crate::quantity::Quantity;
use schemars::JsonSchema;
use serde::Deserialize;

/// A function of interest: a quantity at an instant, reduced over the run, or a clearance.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Function {
    /// Kreisselmeier–Steinhauser function, a smooth bound of the maximum over the run.
    Ks(Ks),
    /// Induced exponential, a smooth mean near the maximum over the run.
    InducedExponential(Aggregate),
    /// Integral over the run, or over a window of time.
    Integral(Over),
    /// Value at the end of the run, or of a window of time.
    Final(Over),
    /// Mean over the run, or over a window of time.
    Mean(Over),
    /// Mean of the square over the run, or over a window of time.
    MeanSquare(Over),
    /// Smooth mean of the absolute value over the run, or over a window of time.
    MeanAbsolute(MeanAbsolute),
    /// Damage by Basquin's law and the crossings of a stress about zero: one at the end of life.
    FatigueDamage(FatigueDamage),
    /// Value at a time, or where a quantity first reaches a value.
    Value(ValueAt),
    /// Mean square of the distances of quantities from measured values, each divided by its standard deviation.
    Misfit(Misfit),
    /// Height of a flight path above the top of a barrier \[m\].
    Clearance(Clearance),
    /// Duration of the run; with `until`, the time of the event \[s\].
    Duration,
    /// Time at which an event of the file comes \[s\], by its name.
    EventTime(String),
    /// Mass of all bodies, or of all structures \[kg\].
    Mass,
    /// Coordinate of the centre of mass of all structures \[m\].
    CentreOfMass(CentreOfMass),
    /// Moment of inertia of all structures about an axis through their centre of mass [kg m²].
    MomentOfInertia(MomentOfInertia),
    /// Strain energy of a load case \[J\].
    StrainEnergy(OfCase),
    /// Work of the loads of a case in its displacements \[J\].
    Compliance(OfCase),
    /// Mean displacement of a set of nodes \[m\].
    Displacement(Displacement),
    /// Force of the supports on a set of nodes \[N\].
    Reaction(StaticReaction),
    /// Moment of the supports on a set of nodes [N m].
    ReactionMoment(ReactionMoment),
    /// Aggregate of von Mises stress by yield stress.
    VonMises(Stress),
    /// A natural frequency \[Hz\].
    Frequency(Frequency),
    /// Smooth lower bound of the natural frequencies \[Hz\].
    LowestFrequency(LowestFrequency),
    /// Sum, mean, deviation or extreme of the values of a function in several cases.
    OverCases(OverCases),
    /// Damping ratio of a mode of a machine: 0 without damping, 1 where no oscillation is left, below 0 if it grows.
    DampingRatio(DampingRatio),
    /// Critical speed of a machine that turns \[rad/s\]: there a whirl turns with it, without damping.
    CriticalSpeed(CriticalSpeed),
    /// An expression of other functions and of parameters, such as `2*mass + work/duration`. Names that are no words
    /// stand between single quotes or backquotes.
    Expression(String),
}

/// A function: its name, or an expression of functions.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum WhichFunction {
    /// Name of a function.
    Named(String),
    /// An expression in this place.
    Written(ExpressionOfFunctions),
}

/// An expression of functions.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExpressionOfFunctions {
    /// Of functions and parameters by name, as that of a function.
    pub expression: String,
}

/// A function of a motion, or of a machine at rest.
pub enum OfMotion<'a> {
    Ks(&'a Ks),
    InducedExponential(&'a Aggregate),
    Integral(&'a Over),
    Final(&'a Over),
    Mean(&'a Over),
    MeanSquare(&'a Over),
    MeanAbsolute(&'a MeanAbsolute),
    FatigueDamage(&'a FatigueDamage),
    Value(&'a ValueAt),
    Misfit(&'a Misfit),
    Clearance(&'a Clearance),
    Duration,
    Mass,
    Frequency(&'a Frequency),
    LowestFrequency(&'a LowestFrequency),
    DampingRatio(&'a DampingRatio),
    CriticalSpeed(&'a CriticalSpeed),
}

impl Function {
    /// The stress of structures, if it is one.
    pub fn stress(&self) -> Option<&Stress> {
        match self {
            Self::VonMises(stress) => Some(stress),
            _ => None,
        }
    }

    /// The ends of its window, if it has one; a value at a time ends there.
    pub fn window(&self) -> [Option<&Edge>; 2] {
        let during = match self {
            Self::Value(own) => return [None, Some(&own.at)],
            Self::Ks(own) => own.during.as_ref(),
            Self::InducedExponential(own) => own.during.as_ref(),
            Self::MeanAbsolute(own) => own.during.as_ref(),
            Self::FatigueDamage(own) => own.during.as_ref(),
            Self::Integral(over)
            | Self::Final(over)
            | Self::Mean(over)
            | Self::MeanSquare(over) => over.during(),
            _ => None,
        };
        match during {
            Some(During::Between(own)) => [own.from.as_ref(), own.to.as_ref()],
            Some(During::Times(_)) | None => [None, None],
        }
    }

    /// The function, if it is one of a motion and not of structures.
    pub fn of_motion(&self) -> Option<OfMotion<'_>> {
        match self {
            Self::Ks(own) => Some(OfMotion::Ks(own)),
            Self::InducedExponential(own) => Some(OfMotion::InducedExponential(own)),
            Self::Integral(own) => Some(OfMotion::Integral(own)),
            Self::Final(own) => Some(OfMotion::Final(own)),
            Self::Mean(own) => Some(OfMotion::Mean(own)),
            Self::MeanSquare(own) => Some(OfMotion::MeanSquare(own)),
            Self::MeanAbsolute(own) => Some(OfMotion::MeanAbsolute(own)),
            Self::FatigueDamage(own) => Some(OfMotion::FatigueDamage(own)),
            Self::Value(own) => Some(OfMotion::Value(own)),
            Self::Misfit(own) => Some(OfMotion::Misfit(own)),
            Self::Clearance(own) => Some(OfMotion::Clearance(own)),
            // The duration of the phases until then.
            Self::Duration | Self::EventTime(_) => Some(OfMotion::Duration),
            Self::Mass => Some(OfMotion::Mass),
            Self::Frequency(own) => Some(OfMotion::Frequency(own)),
            Self::LowestFrequency(own) => Some(OfMotion::LowestFrequency(own)),
            Self::DampingRatio(own) => Some(OfMotion::DampingRatio(own)),
            Self::CriticalSpeed(own) => Some(OfMotion::CriticalSpeed(own)),
            Self::CentreOfMass(_)
            | Self::MomentOfInertia(_)
            | Self::StrainEnergy(_)
            | Self::Compliance(_)
            | Self::Displacement(_)
            | Self::Reaction(_)
            | Self::ReactionMoment(_)
            | Self::VonMises(_)
            | Self::OverCases(_)
            | Self::Expression(_) => None,
        }
    }
}

/// Aggregated quantity, sharpness, and side of the maximum.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ks {
    /// Aggregation parameter in 1/unit of the quantity; larger is closer to the maximum.
    #[schemars(extend(
        "unit" = "1/unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// "below" (default): never above the true maximum. "above": never below it, as an upper limit
    /// needs.
    pub bound: Option<Bound>,
    /// The quantity.
    pub of: Instant,
    /// The window of time, default the whole run.
    pub during: Option<During>,
}

/// Aggregated quantity and sharpness.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Aggregate {
    /// Aggregation parameter in 1/unit of the quantity; larger is closer to the maximum.
    #[schemars(extend(
        "unit" = "1/unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// The quantity.
    pub of: Instant,
    /// The window of time, default the whole run.
    pub during: Option<During>,
}

/// Height of a projectile's flight path above the top of a barrier.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clearance {
    /// Name of the range function with the release: the final state of a `final` one, the weighted
    /// mean state of a `ks` or an `induced_exponential` one.
    pub release: String,
    /// The barrier.
    pub barrier: Barrier,
}

/// A barrier across the direction of flight.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Barrier {
    /// Position along the direction of flight, from the origin.
    #[schemars(extend("unit" = "m"))]
    pub distance: Quantity,
    /// Height of its top above the origin.
    #[schemars(extend("unit" = "m"))]
    pub top: Quantity,
}
