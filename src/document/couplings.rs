//! Couplings in a file.

use super::loads::{Interpolation, Motion};
use super::mechanics::Location;
use crate::quantity::Quantity;
use schemars::JsonSchema;
use serde::Deserialize;

/// A linear relation between the motions of joints, over any number of turns: gears, a rack, a screw, a belt, or any other.
/// It holds as the bodies are placed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Coupling {
    /// Two gears with parallel axes.
    Gear(Gear),
    /// Two gears whose axes meet.
    Bevel(Bevel),
    /// A rack that a pinion drives.
    RackAndPinion(RackAndPinion),
    /// A screw: a cylindrical joint that moves by its lead in a turn.
    Screw(Screw),
    /// A belt or chain, or a rope without slip, about two pulleys with parallel axes.
    Belt(Belt),
    /// Σ factor · motion = constant.
    Relation(Relation),
    /// A motion that is a function of another.
    Cam(Cam),
}

/// Two gears with parallel axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// The two bodies.
    pub gears: [String; 2],
    /// The body that holds the axes, or "ground"; default the one to which both are hinged.
    pub carrier: Option<String>,
    /// Numbers of teeth.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub teeth: Option<[Quantity; 2]>,
    /// Pitch radii, instead of `teeth`.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub radii: Option<[Quantity; 2]>,
    /// Turns of the first gear for one of the second, instead of `teeth`.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub ratio: Option<Quantity>,
    /// Whether one of them has inner teeth, so that both turn the same way, default false.
    #[serde(default)]
    pub inner: bool,
}

/// Two gears whose axes meet.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bevel {
    /// The two bodies.
    pub gears: [String; 2],
    /// The body that holds the axes, or "ground"; default the one to which both are hinged.
    pub carrier: Option<String>,
    /// A place in the placement at which the teeth meet, in the plane of both axes. Its distances from them are the radii.
    pub at: Location,
    /// Numbers of teeth, instead of these radii.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub teeth: Option<[Quantity; 2]>,
    /// Turns of the first gear for one of the second, instead of these radii.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub ratio: Option<Quantity>,
}

/// A rack that a pinion drives.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RackAndPinion {
    /// The body that slides.
    pub rack: String,
    /// The gear.
    pub pinion: String,
    /// The body on which they move, or "ground"; default the one to which both are joined.
    pub carrier: Option<String>,
    /// A place in the placement at which the teeth meet: the point of the rack's pitch line that is nearest to the axis.
    pub at: Location,
    /// Pitch radius, default the distance of `at` from the axis.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub radius: Option<Quantity>,
}

/// A cylindrical joint that moves by its lead in a turn.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Screw {
    /// Name of the cylindrical joint.
    pub joint: String,
    /// Displacement in a turn; negative of a left-hand thread.
    #[schemars(extend("unit" = "m"))]
    pub lead: Quantity,
}

/// A belt about two pulleys with parallel axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Belt {
    /// The two bodies.
    pub pulleys: [String; 2],
    /// The body that holds the axes, or "ground"; default the one to which both are hinged.
    pub carrier: Option<String>,
    /// Radii.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub radii: Option<[Quantity; 2]>,
    /// Numbers of teeth, instead of `radii`.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub teeth: Option<[Quantity; 2]>,
    /// Turns of the first pulley for one of the second, instead of `radii`.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub ratio: Option<Quantity>,
    /// Whether the belt crosses, so that the pulleys turn in opposite directions, default false.
    #[serde(default)]
    pub crossed: bool,
}

/// Σ factor · motion = constant.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Relation {
    /// The motions. The factor of the last is not zero in any design.
    #[schemars(length(min = 2))]
    pub terms: Vec<Term>,
    /// The constant, with motions counted from the placement as functions measure them; default its value at the start.
    #[schemars(extend("unit" = "that of the terms"))]
    pub constant: Option<Quantity>,
}

/// A motion of a joint with its factor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// Name of a revolute, planar, prismatic or cylindrical joint. Its motion is that of its first body against the second
    /// (ground counts as the second).
    pub joint: String,
    /// Factor of the angle about the axis.
    #[schemars(extend("unit" = "that of the terms per rad"))]
    pub turn: Option<Quantity>,
    /// Factor of the displacement along the axis, instead of `turn`.
    #[schemars(extend("unit" = "that of the terms per m"))]
    pub slide: Option<Quantity>,
}

/// A motion that is a function of another: a follower on a cam, a bead on a curve. Both are measured as functions measure them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cam {
    /// The motion on which the profile depends.
    pub cam: JointMotion,
    /// The motion that follows it.
    pub follower: JointMotion,
    /// The motion of the follower by that of the cam.
    pub profile: Profile,
}

/// A motion of a joint: that of its first body against the second (ground counts as the second).
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum JointMotion {
    /// The angle of this revolute, planar or cylindrical joint.
    Turn(String),
    /// The displacement of this prismatic or cylindrical joint.
    Slide(String),
}

impl JointMotion {
    /// The joint.
    pub fn joint(&self) -> &String {
        match self {
            Self::Turn(joint) | Self::Slide(joint) => joint,
        }
    }

    /// How it moves.
    pub fn motion(&self) -> Motion {
        match self {
            Self::Turn(_) => Motion::Turn,
            Self::Slide(_) => Motion::Slide,
        }
    }
}

/// A function that is twice continuously differentiable, level at both ends and constant beyond.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Values of the motion of the cam, ascending.
    #[schemars(extend(
        "unit" = "m or rad",
        "design_variable" = "the places of a profile keep their order; design its values"
    ), length(min = 2))]
    pub at: Vec<f64>,
    /// The motion of the follower at each.
    #[schemars(extend("unit" = "m or rad"), length(min = 2))]
    pub values: Vec<Quantity>,
    /// Interpolation between them, default spline.
    pub interpolation: Option<Interpolation>,
}

/// How a coupling acts on a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfCoupling {
    /// Name of the coupling.
    pub coupling: String,
    /// One of its wheels, its rack, or a joint of a screw or relation; default the first.
    pub on: Option<String>,
    /// The motion of a joint, default its first in the coupling.
    pub motion: Option<Motion>,
}

/// Two wheels with parallel axes: what gears and belts have in common.
pub struct Wheels<'a> {
    /// The two bodies.
    pub bodies: &'a [String; 2],
    /// The key of the bodies.
    pub key: &'static str,
    /// The body that holds the axes, if it is given.
    pub carrier: Option<&'a String>,
    /// Numbers of teeth.
    pub teeth: Option<[Quantity; 2]>,
    /// Pitch radii.
    pub radii: Option<[Quantity; 2]>,
    /// Turns of the first for one of the second.
    pub ratio: Option<Quantity>,
}

impl Coupling {
    /// Its key in the file.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Gear(_) => "gear",
            Self::Bevel(_) => "bevel",
            Self::RackAndPinion(_) => "rack_and_pinion",
            Self::Screw(_) => "screw",
            Self::Belt(_) => "belt",
            Self::Relation(_) => "relation",
            Self::Cam(_) => "cam",
        }
    }

    /// The wheels of a gear, a bevel gear or a belt.
    pub fn wheels(&self) -> Option<Wheels<'_>> {
        match self {
            Self::Gear(own) => Some(Wheels {
                bodies: &own.gears,
                key: "gears",
                carrier: own.carrier.as_ref(),
                teeth: own.teeth,
                radii: own.radii,
                ratio: own.ratio,
            }),
            Self::Bevel(own) => Some(Wheels {
                bodies: &own.gears,
                key: "gears",
                carrier: own.carrier.as_ref(),
                teeth: own.teeth,
                radii: None,
                ratio: own.ratio,
            }),
            Self::Belt(own) => Some(Wheels {
                bodies: &own.pulleys,
                key: "pulleys",
                carrier: own.carrier.as_ref(),
                teeth: own.teeth,
                radii: own.radii,
                ratio: own.ratio,
            }),
            Self::RackAndPinion(_) | Self::Screw(_) | Self::Relation(_) | Self::Cam(_) => None,
        }
    }
}
