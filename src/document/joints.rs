//! Joints in a file.

use super::mechanics::Point;
use crate::quantity::{Degrees, Quantity, Vector};
use flexbody_mechanics::model::DegreeOfFreedom;
use schemars::JsonSchema;
use serde::Deserialize;

/// A joint between two bodies, or a body and "ground".
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Joint {
    /// A ball joint: the points coincide.
    Spherical(Ball),
    /// A hinge: the points coincide and the bodies turn about the axis.
    Revolute(Axial),
    /// A slider: the second body moves along the axis of the first without turning.
    Prismatic(Axial),
    /// The second body moves in the plane through the first body's point across its axis and
    /// turns about the axis.
    Planar(Axial),
    /// The bodies slide along the axis and turn about it.
    Cylindrical(Axial),
    /// A universal (Cardan) joint: the points coincide. The bodies turn about an axis of the first
    /// and a cross axis of the second, which stay perpendicular.
    Universal(Crossed),
    /// A rod without mass: two points keep their distance.
    Rod(Rod),
    /// A weld: the bodies move as one.
    Weld(Ball),
    /// No constraint: the place and axes of a bushing.
    Free(Free),
}

/// Bodies and place of a bushing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Free {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Position at the start.
    pub at: JointPlace,
    /// Its third axis e3 at the start, of any length but zero; default [0, 0, 1].
    pub axis: Option<Axis>,
    /// Its first axis e1 at the start, of any length but zero, across `axis`; default the projection of the ground axis that is farthest from that.
    pub cross: Option<Axis>,
}

/// Bodies and place of a joint without an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Position of the joint at the start.
    pub at: JointPlace,
}

/// Bodies, place and axis of a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Axial {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Position of the joint at the start.
    pub at: JointPlace,
    /// The joint's axis at the start, of any length but zero.
    pub axis: Axis,
    /// Initial position and rate of its motion, default those of the bodies as placed.
    pub start: Option<JointStart>,
}

/// Initial position and rate of the motion of a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointStart {
    /// Rotation about the axis.
    pub turn: Option<TurnStart>,
    /// Displacement along the axis.
    pub slide: Option<SlideStart>,
}

/// Initial angle and rate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnStart {
    /// Angle of the first body relative to the second, from the placement; default 0.
    #[schemars(extend("unit" = "rad"))]
    pub angle: Option<Quantity>,
    /// Its rate, default that of the bodies' velocities.
    #[schemars(extend("unit" = "rad/s"))]
    pub rate: Option<Quantity>,
    /// The angle in degrees, instead of `angle`.
    #[schemars(extend("unit" = "°"))]
    pub degrees: Option<Degrees>,
    /// The rate in degrees per second, instead of `rate`.
    #[schemars(extend("unit" = "°/s"))]
    pub degrees_per_second: Option<Degrees>,
}

impl TurnStart {
    /// The angle \[rad\], if it is given.
    pub fn angle(&self) -> Option<Quantity> {
        self.angle.or(self.degrees.map(|degrees| degrees.0))
    }

    /// The rate \[rad/s\], if it is given.
    pub fn rate(&self) -> Option<Quantity> {
        self.rate.or(self.degrees_per_second.map(|rate| rate.0))
    }
}

/// Initial displacement and rate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlideStart {
    /// Displacement of the first body relative to the second, from the placement; default 0.
    #[schemars(extend("unit" = "m"))]
    pub displacement: Option<Quantity>,
    /// Its rate, default that of the bodies' velocities.
    #[schemars(extend("unit" = "m/s"))]
    pub rate: Option<Quantity>,
}

impl JointStart {
    /// Position and rate of a degree of freedom; `None` if the start does not name it.
    pub fn of(&self, dof: DegreeOfFreedom) -> Option<[Option<Quantity>; 2]> {
        match dof {
            DegreeOfFreedom::Rotation => self.turn.as_ref().map(|turn| [turn.angle(), turn.rate()]),
            DegreeOfFreedom::Translation => {
                let slide = self.slide.as_ref();
                slide.map(|slide| [slide.displacement, slide.rate])
            }
        }
    }
}

/// Bodies, place and axes of a universal joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crossed {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Position of the joint at the start.
    pub at: JointPlace,
    /// Axis of the first body at the start, of any length but zero.
    pub axis: Axis,
    /// Axis of the second body at the start, perpendicular to the first.
    pub cross: Axis,
}

/// A rod between points of two bodies.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rod {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Its ends.
    pub at: Ends,
    /// Length, default the distance of its ends in the placement.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub length: Option<Quantity>,
}

/// Ends of a rod or spring.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Ends {
    // This variant is first because a pair of points could be read from a list, too.
    /// Ground coordinates of both at the start, in the order of the bodies.
    #[schemars(extend("unit" = "m"))]
    Ground([Vector; 2]),
    /// One point on each body.
    Each(PointPair),
}

/// Position of a joint at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum JointPlace {
    /// `"body.point"`, or `"body"` for the origin of its axes.
    Named(String),
    /// Ground coordinates.
    #[schemars(extend("unit" = "m"))]
    Coordinates(Vector),
    /// One point on each body; assembly brings them together.
    Each(PointPair),
}

/// One point on each body of a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointPair {
    /// Point of the first body, by name or in its axes (ground coordinates if it is ground).
    pub a: Point,
    /// Point of the second body, by name or in its axes (ground coordinates if it is ground).
    pub b: Point,
}

/// Direction of a joint's axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Axis {
    /// In ground axes.
    #[schemars(extend("unit" = "1"))]
    Ground(Vector),
    /// In the axes of a body.
    OfBody(BodyAxis),
}

/// An axis fixed in a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyAxis {
    /// The body.
    pub body: String,
    /// Direction in its axes.
    #[schemars(extend("unit" = "1"))]
    pub axis: Vector,
}

impl Joint {
    /// Its bodies.
    pub fn between(&self) -> &[String; 2] {
        match self {
            Joint::Spherical(ball) | Joint::Weld(ball) => &ball.between,
            Joint::Revolute(axial)
            | Joint::Prismatic(axial)
            | Joint::Planar(axial)
            | Joint::Cylindrical(axial) => &axial.between,
            Joint::Universal(crossed) => &crossed.between,
            Joint::Free(free) => &free.between,
            Joint::Rod(rod) => &rod.between,
        }
    }

    /// Its position; `None` for a rod, which has two ends.
    pub fn place(&self) -> Option<&JointPlace> {
        match self {
            Joint::Spherical(ball) | Joint::Weld(ball) => Some(&ball.at),
            Joint::Revolute(axial)
            | Joint::Prismatic(axial)
            | Joint::Planar(axial)
            | Joint::Cylindrical(axial) => Some(&axial.at),
            Joint::Universal(crossed) => Some(&crossed.at),
            Joint::Free(free) => Some(&free.at),
            Joint::Rod(_) => None,
        }
    }

    /// Initial position and rate of its motion, if the file gives them.
    pub fn start(&self) -> Option<&JointStart> {
        match self {
            Joint::Revolute(axial)
            | Joint::Prismatic(axial)
            | Joint::Planar(axial)
            | Joint::Cylindrical(axial) => axial.start.as_ref(),
            Joint::Spherical(_)
            | Joint::Universal(_)
            | Joint::Rod(_)
            | Joint::Weld(_)
            | Joint::Free(_) => None,
        }
    }

    /// Its axis and cross axis.
    pub fn axes(&self) -> [Option<&Axis>; 2] {
        match self {
            Joint::Spherical(_) | Joint::Weld(_) | Joint::Rod(_) => [None, None],
            Joint::Revolute(axial)
            | Joint::Prismatic(axial)
            | Joint::Planar(axial)
            | Joint::Cylindrical(axial) => [Some(&axial.axis), None],
            Joint::Universal(crossed) => [Some(&crossed.axis), Some(&crossed.cross)],
            Joint::Free(free) => [free.axis.as_ref(), free.cross.as_ref()],
        }
    }

    /// Its key in the file.
    pub fn kind(&self) -> flexbody_mechanics::model::JointKind {
        use flexbody_mechanics::model::JointKind;
        match self {
            Joint::Spherical(_) => JointKind::Spherical,
            Joint::Revolute(_) => JointKind::Revolute,
            Joint::Prismatic(_) => JointKind::Prismatic,
            Joint::Planar(_) => JointKind::Planar,
            Joint::Cylindrical(_) => JointKind::Cylindrical,
            Joint::Universal(_) => JointKind::Universal,
            Joint::Rod(_) => JointKind::Rod,
            Joint::Weld(_) => JointKind::Weld,
            Joint::Free(_) => JointKind::Free,
        }
    }
}
