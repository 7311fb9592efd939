//! Quantities at an instant, and combinations of them, in a file.

use super::combined::{Distance, PowerOf, Relative};
use super::couplings::OfCoupling;
use super::measured::{
    AngularMomentum, JointReaction, JointSlide, LargestFibreStress, LargestSectionForce,
    OfController, OfSpring, OfStop, SectionComponent, SectionPlace,
};
use super::mechanics::Point;
use crate::quantity::{Quantity, Vector};
use schemars::JsonSchema;
use serde::Deserialize;

/// A quantity at an instant.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Instant {
    /// Component of a point's position \[m\].
    Position(Component),
    /// Component of a point's velocity [m/s].
    Velocity(Component),
    /// Component of a point's acceleration [m/s²].
    Acceleration(Component),
    /// Speed of a point [m/s].
    Speed(Moving),
    /// Square of the speed of a point [m²/s²], which is smooth at rest too.
    SpeedSquared(Moving),
    /// Component of the angular velocity of a body [rad/s]; of a beam, that of its frame.
    AngularVelocity(Spinning),
    /// Component of the linear momentum of the whole scene [kg m/s].
    Momentum(Momentum),
    /// Component of the angular momentum of the whole scene about a fixed point [kg m²/s].
    AngularMomentum(AngularMomentum),
    /// Energy of the whole scene \[J\].
    Energy(Energy),
    /// Component of the rate of change of a point's acceleration [m/s³].
    Jerk(Component),
    /// Component of a point's acceleration in the axes of its body [m/s²], as a sensor on it measures but for gravity.
    SensorAcceleration(Component),
    /// Component of a point's position as seen from another body \[m\].
    RelativePosition(Relative),
    /// Component of a point's velocity as seen from another body [m/s].
    RelativeVelocity(Relative),
    /// Distance of points of two bodies \[m\].
    Distance(Distance),
    /// Power of a load or drive \[W\]; its integral is the work.
    Power(PowerOf),
    /// Rate of the angle of a joint [rad/s].
    AngleRate(JointAngle),
    /// Rate of the displacement of a joint along its axis [m/s].
    SlideRate(JointSlide),
    /// Sum of quantities of one unit.
    Sum(#[schemars(length(min = 2))] Vec<Instant>),
    /// The first quantity minus the second, of one unit.
    Difference([Box<Instant>; 2]),
    /// Product of quantities.
    Product(#[schemars(length(min = 2))] Vec<Instant>),
    /// The first quantity by the second.
    Quotient([Box<Instant>; 2]),
    /// Square of a quantity.
    Square(Box<Instant>),
    /// Absolute value of a quantity, smooth at zero.
    Absolute(Absolute),
    /// Rate of change of a quantity in time, by polynomials between the samples.
    Rate(Box<Instant>),
    /// Rotation of a body about an axis \[rad\], counted over whole turns.
    Rotation(Rotation),
    /// Angle of a joint \[rad\] as in drives and torsion springs, counted over whole turns.
    Angle(JointAngle),
    /// Displacement of a joint along its axis \[m\].
    Slide(JointSlide),
    /// Component of the force by which a joint acts on a body \[N\].
    JointForce(JointReaction),
    /// Component of the moment by which a joint acts on a body [N m], that of its drive included.
    JointMoment(JointReaction),
    /// Torque of a coupling on one of its wheels about its axis [N m], or force on its rack along the slide \[N\]; of a screw
    /// or relation on the first body of a joint (the one that is not ground).
    CouplingReaction(OfCoupling),
    /// Distance of the points of a spring \[m\].
    SpringLength(OfSpring),
    /// Force by which a spring pulls its points together \[N\], damping included.
    SpringForce(OfSpring),
    /// Torque by which a torsion spring turns its joint back [N m], damping included.
    SpringTorque(OfSpring),
    /// A natural frequency of the machine about its state at the instant, drives held \[Hz\].
    Frequency(OfMode),
    /// The damping ratio of such a vibration.
    DampingRatio(OfMode),
    /// Normal force of a stop or contact \[N\], or the torque of a stop of an angle [N m]; never negative.
    ContactForce(OfStop),
    /// Size of the friction of a contact \[N\].
    ContactFriction(OfStop),
    /// Power that the friction of a contact takes \[W\]; never negative.
    SlipPower(OfStop),
    /// How deep a stop or contact is entered [m or rad]; negative before it, to the nearer limit.
    Penetration(OfStop),
    /// Force \[N\] or torque [N m] of a controller; positive where it increases its coordinate.
    Effort(OfController),
    /// What the coordinate of a controller lacks to its reference [m or rad].
    TrackingError(OfController),
    /// Range of a projectile that is released at this instant \[m\].
    Range(Range),
    /// Von Mises stress by yield stress of a body of shells, aggregated over both faces of their Gauss points.
    VonMises(ShellStress),
    /// Displacement of a point of a beam or of shells from where it is in the undeformed body \[m\].
    ElasticDisplacement(ElasticDisplacement),
    /// Strain energy of a beam or of shells \[J\].
    StrainEnergy(OfBeam),
    /// Force \[N\] or moment \[N m\] in a section of a beam.
    SectionForce(SectionForce),
    /// Stress of bending and stretch along a fibre of a beam \[Pa\].
    FibreStress(FibreStress),
    /// Largest force \[N\] or moment \[N m\] of several sections of a beam, by a smooth maximum.
    LargestSectionForce(LargestSectionForce),
    /// Largest stress of bending and stretch of several sections and fibres of a beam, by a smooth maximum \[Pa\].
    LargestFibreStress(LargestFibreStress),
}

/// A vibration about the state at an instant.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfMode {
    /// Number of the damped mode from 1, by its rate |s|. Motions that do not oscillate, being free or damped beyond ζ = 1,
    /// are not counted.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 150,
        "design_variable" = "the number of a mode is a count, not a physical number"
    ))]
    pub mode: usize,
}

/// Stress of a body of shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShellStress {
    /// The body.
    pub body: String,
    /// Aggregation parameter over the points; larger is closer to the maximum.
    #[schemars(extend(
        "unit" = "1",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// Name of a set of elements of its structure, default all.
    pub elements: Option<String>,
}

/// A beam.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfBeam {
    /// The beam.
    pub body: String,
}

/// A point of a beam and a direction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElasticDisplacement {
    /// The beam.
    pub body: String,
    /// Its point, by name or in body axes.
    pub point: Point,
    /// Direction in body axes, used as it is given: a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// A force or moment in a section.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionForce {
    /// The beam, or a body of elements that has beams.
    pub body: String,
    /// Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
    pub beams: Option<String>,
    /// Where the section is.
    pub station: SectionPlace,
    /// Which of its forces and moments.
    pub component: SectionComponent,
}

/// Stress along a fibre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FibreStress {
    /// The beam, or a body of elements that has beams.
    pub body: String,
    /// Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
    pub beams: Option<String>,
    /// Where the section is.
    pub station: SectionPlace,
    /// Where the fibre is in it along y and z, in parts of half the section's size: [1, 0] is outermost
    /// along y.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a fibre says what is asked, not what is built"
    ))]
    pub fibre: [f64; 2],
}

/// A point of a body and a direction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// The body.
    pub body: String,
    /// Its point, by name or in body axes; default the centre of mass.
    pub point: Option<Point>,
    /// Direction in ground axes. It is not normalised; a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// A body and a direction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spinning {
    /// The body.
    pub body: String,
    /// Direction in ground axes. It is not normalised; a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// A direction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Momentum {
    /// Direction in ground axes. It is not normalised; a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// A point of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Moving {
    /// The body.
    pub body: String,
    /// Its point, by name or in body axes; default the centre of mass.
    pub point: Option<Point>,
}

/// Kind of energy.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Energy {
    /// Kinetic energy.
    Kinetic,
    /// Potential energy, zero with the centre of mass at the origin.
    Potential,
    /// Their sum.
    Total,
}

/// A body and an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// The body.
    pub body: String,
    /// Axis in ground axes as the bodies are placed, of any length but zero. It is fixed in the
    /// body that the rotation is relative to.
    #[schemars(extend("unit" = "1"))]
    pub axis: Vector,
    /// The body that the rotation is relative to, default "ground".
    pub relative_to: Option<String>,
    /// Zero of the rotation, default "axes".
    pub from: Option<CountedFrom>,
}

/// Zero of a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CountedFrom {
    /// The axes of the body are parallel to those of the other body, or of ground.
    #[default]
    Axes,
    /// The bodies are as placed.
    Placement,
}

/// A joint whose angle is measured.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointAngle {
    /// Name of a revolute, planar or cylindrical joint. The angle is that of its first body
    /// relative to the second (ground counts as the second) about the axis, from the placement.
    pub joint: String,
}

/// A projectile and how its range is measured. Up is against gravity.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The body that is thrown.
    pub body: String,
    /// Its point that flies, by name or in body axes; default the centre of mass.
    pub point: Option<Point>,
    /// Horizontal direction of the throw in ground axes, default [1, 0, 0].
    #[schemars(extend("unit" = "1"))]
    pub direction: Option<Vector>,
    /// Height of the ground where the projectile lands, default 0.
    #[schemars(extend("unit" = "m"))]
    pub ground: Option<Quantity>,
    /// Gate that excludes later turns of a sling from the range.
    pub gate: Option<Gate>,
}

/// A smooth gate on a rotation: the range counts only while the rotation is above (or below) a
/// limit. Give `body` and `axis`, or `joint`; and one of `above` and `below`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gate {
    /// The body of the rotation.
    pub body: Option<String>,
    /// Axis of the rotation in ground axes as the bodies are placed, of any length but zero.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a gate says what is asked, not what is built"
    ))]
    pub axis: Option<[f64; 3]>,
    /// The body that the rotation is relative to, default "ground".
    pub relative_to: Option<String>,
    /// Zero of the rotation, default "axes".
    pub from: Option<CountedFrom>,
    /// Name of a revolute, planar or cylindrical joint whose angle is used instead of the rotation
    /// of a body.
    pub joint: Option<String>,
    /// The gate is open above this rotation.
    #[schemars(extend(
        "unit" = "rad",
        "design_variable" = "a gate says what is asked, not what is built"
    ))]
    pub above: Option<f64>,
    /// The gate is open below this rotation.
    #[schemars(extend(
        "unit" = "rad",
        "design_variable" = "a gate says what is asked, not what is built"
    ))]
    pub below: Option<f64>,
    /// Width of the transition.
    #[schemars(extend(
        "unit" = "rad",
        "exclusiveMinimum" = 0,
        "design_variable" = "a gate says what is asked, not what is built"
    ))]
    pub width: f64,
}

/// A smooth absolute value.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Absolute {
    /// The quantity x.
    pub of: Box<Instant>,
    /// Width w of the rounded corner at zero: √(x² + w²) − w, at most w below |x|.
    #[schemars(extend(
        "unit" = "unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "a width says what is asked, not what is built"
    ))]
    pub width: f64,
}
