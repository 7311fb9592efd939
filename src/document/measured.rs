//! Quantities of joints, springs, the whole scene and several sections, in a file.

use crate::quantity::{Quantity, Vector};
use schemars::JsonSchema;
use serde::Deserialize;

/// A component of the force or moment by which a joint acts on a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointReaction {
    /// The joint.
    pub joint: String,
    /// The body that it acts on, one of the two or "ground"; default the first that is not ground. A moment is
    /// about the joint's point on this body.
    pub on: Option<String>,
    /// Axes of the direction, default "ground".
    pub axes: Option<ReactionAxes>,
    /// Direction, used as it is given: a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
}

/// Axes of the direction of a reaction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReactionAxes {
    /// Those of ground.
    #[default]
    Ground,
    /// e1, e2, e3 of the joint on its first body (the one that is not ground); e3 is the joint's axis.
    Joint,
}

/// A joint whose displacement is measured.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointSlide {
    /// Name of a prismatic or cylindrical joint. The displacement is that of its first body against the second
    /// (ground counts as the second) along the axis, from the placement.
    pub joint: String,
}

/// A spring.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfSpring {
    /// Name of the load.
    pub load: String,
}

/// A stop or contact.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfStop {
    /// Name of the load.
    pub load: String,
}

/// A controller.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfController {
    /// Name of the load.
    pub load: String,
}

/// A direction and a point.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AngularMomentum {
    /// Direction in ground axes. It is not normalised; a unit vector gives a component.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// The fixed point that it is about, default the origin.
    #[schemars(extend("unit" = "m"))]
    pub about: Option<Vector>,
}

/// Several sections of a beam.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SectionPlaces {
    /// So many at equal distances from start to end.
    #[schemars(extend(
        "design_variable" = "a number of sections says what is asked, not what is built"
    ))]
    Count(usize),
    /// These.
    List(Vec<SectionPlace>),
}

/// Sign of the values of which the largest counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sign {
    /// The values.
    #[default]
    Positive,
    /// Their negatives.
    Negative,
    /// Both, so the size counts.
    Both,
}

impl Sign {
    /// The factors.
    pub fn factors(self) -> &'static [f64] {
        match self {
            Sign::Positive => &[1.0],
            Sign::Negative => &[-1.0],
            Sign::Both => &[1.0, -1.0],
        }
    }
}

/// The largest force or moment of several sections.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargestSectionForce {
    /// The beam, or a body of elements that has beams.
    pub body: String,
    /// Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
    pub beams: Option<String>,
    /// Where the sections are: a list of stations or fractions of the length, or a number of sections at equal
    /// distances.
    pub stations: SectionPlaces,
    /// Which of their forces and moments.
    pub component: SectionComponent,
    /// Sign of the values, default "positive".
    pub sign: Option<Sign>,
    /// Aggregation parameter over the sections; larger is closer to the largest. That of a `ks` over time, if it
    /// shall be one function of both.
    #[schemars(extend(
        "unit" = "1/unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// "below" (default): never above the largest. "above": never below it.
    pub bound: Option<Bound>,
}

/// The largest stress along several fibres of several sections.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargestFibreStress {
    /// The beam, or a body of elements that has beams.
    pub body: String,
    /// Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
    pub beams: Option<String>,
    /// Where the sections are: a list of stations or fractions of the length, or a number of sections at equal
    /// distances.
    pub stations: SectionPlaces,
    /// Where the fibres are along y and z, in parts of half the section's size; default the four corners.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a fibre says what is asked, not what is built"
    ))]
    pub fibres: Option<Vec<[f64; 2]>>,
    /// Sign of the values, default "positive": tension.
    pub sign: Option<Sign>,
    /// Aggregation parameter over sections and fibres; larger is closer to the largest. That of a `ks` over time,
    /// if it shall be one function of both.
    #[schemars(extend(
        "unit" = "1/Pa",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// "below" (default): never above the largest. "above": never below it.
    pub bound: Option<Bound>,
}

/// A section of a beam.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SectionPlace {
    /// Name of a station, "start" or "end".
    Named(String),
    /// Fraction of the length.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    Fraction(Quantity),
}

/// A force or moment in a section, by the beam's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionComponent {
    /// Axial force, positive in tension.
    Axial,
    /// Shear force along y.
    ShearY,
    /// Shear force along z.
    ShearZ,
    /// Torsion moment.
    Torsion,
    /// Bending moment about y.
    BendingY,
    /// Bending moment about z.
    BendingZ,
}

/// A side of the true maximum.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Never above it.
    Below,
    /// Never below it.
    Above,
}
