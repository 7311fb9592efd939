//! Bodies in a file.

use super::elements::Elements;
use super::flexible::Beam;
use super::modal::Modal;
use crate::length_unit::LengthUnit;
use crate::quantity::{Degrees, Quantity, Vector, nothing};
use flexbody_mathematics::math::{Mat3, Vec3};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// A body: a shape with its mass or density, or an explicit mass, centre of mass and inertia, or a beam
/// or a body of files with elastic coordinates.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// A homogeneous solid, centred at the origin of the body's axes; it gives the inertia.
    pub shape: Option<Shape>,
    /// Density of the shape, instead of a mass.
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0))]
    pub density: Option<Quantity>,
    /// Mass. A body of mass 0 needs joints that, with the inertia of other bodies, determine its motion.
    #[schemars(extend("unit" = "kg", "minimum" = 0, "designed" = "positive"))]
    pub mass: Option<Quantity>,
    /// Centre of mass of a body without a shape, from the origin of the body's axes; default 0.
    #[schemars(extend("unit" = "m"))]
    pub centre_of_mass: Option<Vector>,
    /// Inertia of a body without a shape; 0 by default if its mass is 0.
    pub inertia: Option<Inertia>,
    /// A beam with elastic coordinates, instead of all above.
    pub beam: Option<Box<Beam>>,
    /// Shells with elastic coordinates at all their nodes, instead of all above.
    pub elements: Option<Box<Elements>>,
    /// A body with elastic coordinates from files of other codes, instead of all above.
    pub modal: Option<Box<Modal>>,
    /// Mass, centre of mass and inertia of a solid from its surface, instead of all above.
    pub mass_properties: Option<Box<Surface>>,
    /// Named points in body axes from their origin (the centre of the shape, the start of a beam).
    #[serde(default)]
    pub points: IndexMap<String, BodyPoint>,
    /// Placement at the start; by default its axes are those of ground.
    #[serde(default)]
    pub place: Place,
    /// Its velocity at the start, instead of that of the assembly.
    pub velocity: Option<BodyVelocity>,
}

impl Body {
    /// Whether it has elastic coordinates.
    pub fn is_flexible(&self) -> bool {
        self.beam.is_some() || self.elements.is_some() || self.modal.is_some()
    }
}

/// A homogeneous solid inside a closed surface of triangles. Its axes are those of the file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// Path of an STL file, relative to the directory of the problem file.
    pub stl: String,
    /// Density.
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0))]
    pub density: Quantity,
    /// Unit of the coordinates of the file, default "m".
    #[serde(default)]
    pub unit: LengthUnit,
    /// What the file gives for the density 1 kg/m³, once it is read.
    #[serde(skip)]
    #[schemars(skip)]
    pub solid: Option<Arc<Solid>>,
}

/// A solid of the density 1 kg/m³.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Volume \[m³\].
    pub volume: f64,
    /// Its centre from the origin \[m\].
    pub centre: Vec3<f64>,
    /// Inertia about the centre \[m⁵\].
    pub inertia: Mat3<f64>,
    /// The outermost vertices of its surface in several directions \[m\].
    pub outermost: Vec<Vec3<f64>>,
    /// Whether the file orders the vertices of its triangles as seen from inside.
    pub inwards: bool,
}

/// A named point of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum BodyPoint {
    /// Coordinates in body axes from their origin.
    #[schemars(extend("unit" = "m"))]
    Coordinates(Vector),
    /// A point on the line through two others.
    Between(Between),
}

impl BodyPoint {
    /// Its coordinates, if the file gives them.
    pub fn coordinates(&self) -> Option<&Vector> {
        match self {
            Self::Coordinates(own) => Some(own),
            Self::Between(_) => None,
        }
    }
}

/// A point on the line through two named points of the same body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Between {
    /// Names of both points.
    pub between: [String; 2],
    /// Where it is: 0 at the first, 1 at the second; other numbers are on the line beyond them.
    #[schemars(extend("unit" = "1"))]
    pub fraction: Quantity,
}

/// A homogeneous solid, centred at the origin of the body's axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A box with edges along the body's axes.
    Box {
        /// Edges along x, y and z.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        size: Vector,
    },
    /// A cylinder about the body's z axis.
    Cylinder {
        /// Radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
        /// Length along z.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        length: Quantity,
    },
    /// A sphere.
    Sphere {
        /// Radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
    },
    /// A rod along the body's x axis.
    Rod {
        /// Length along x.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        length: Quantity,
        /// Radius; a rod without one (the default) has no inertia about its own axis.
        #[serde(default = "nothing")]
        #[schemars(extend("unit" = "m", "minimum" = 0))]
        radius: Quantity,
    },
    /// A mass without extent and rotation. Ball joints and rods act at its position.
    Point,
}

/// Entries of the symmetric inertia matrix about the centre of mass in body axes. The entry xy is
/// minus the integral of x y over the mass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    /// Moment about x.
    #[schemars(extend("unit" = "kg m²", "minimum" = 0))]
    pub xx: Quantity,
    /// Moment about y.
    #[schemars(extend("unit" = "kg m²", "minimum" = 0))]
    pub yy: Quantity,
    /// Moment about z.
    #[schemars(extend("unit" = "kg m²", "minimum" = 0))]
    pub zz: Quantity,
    /// Entry xy, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "kg m²"))]
    pub xy: Quantity,
    /// Entry xz, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "kg m²"))]
    pub xz: Quantity,
    /// Entry yz, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "kg m²"))]
    pub yz: Quantity,
}

/// Placement of a body: `put` this point of the body `at` that place, with this `turn`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Point of this body, by name or in body axes; default the origin of its axes.
    pub put: Option<Point>,
    /// Place of that point: `"body.point"`, `"body"` for the origin of its axes, or ground
    /// coordinates; default the origin.
    pub at: Option<Location>,
    /// Rotation from the axes of ground (or of `relative_to`) to those of the body, or a list of
    /// rotations about the fixed ground axes, applied in order; default none.
    pub turn: Option<Turns>,
    /// Body from whose axes the turn starts; default ground.
    pub relative_to: Option<String>,
}

/// A point of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Point {
    /// Name of one of the body's points.
    Named(String),
    /// Coordinates in body axes from their origin.
    #[schemars(extend("unit" = "m"))]
    Coordinates(Vector),
}

/// A place in space.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Location {
    /// `"body.point"`, or `"body"` for the origin of its axes.
    Named(String),
    /// Ground coordinates.
    #[schemars(extend("unit" = "m"))]
    Coordinates(Vector),
}

/// One rotation or several.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Turns {
    /// One rotation.
    One(Box<Turn>),
    /// Several, applied in order.
    Several(Vec<Turn>),
}

impl Turns {
    /// The rotations in order.
    pub fn list(&self) -> &[Turn] {
        match self {
            Turns::One(turn) => std::slice::from_ref(turn),
            Turns::Several(turns) => turns,
        }
    }
}

/// A rotation in one of its forms: an axis with an angle, an axis of the ground with an angle, a sequence of
/// angles about the body's own axes, a quaternion, or a matrix.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Axis of any length but zero, with `angle` or `degrees`.
    #[schemars(extend("unit" = "1"))]
    pub axis: Option<Vector>,
    /// Angle by the right-hand rule.
    #[schemars(extend("unit" = "rad"))]
    pub angle: Option<Quantity>,
    /// The angle in degrees instead, or with `sequence` its three angles.
    pub degrees: Option<InDegrees>,
    /// Rotation about x.
    #[schemars(extend("unit" = "°"))]
    pub x: Option<Degrees>,
    /// Rotation about y.
    #[schemars(extend("unit" = "°"))]
    pub y: Option<Degrees>,
    /// Rotation about z.
    #[schemars(extend("unit" = "°"))]
    pub z: Option<Degrees>,
    /// Three of x, y and z: rotations about these axes of the body, each as those before it have turned them;
    /// "zyx" are yaw, pitch and roll. With `angles` or `degrees`.
    pub sequence: Option<String>,
    /// Angles of `sequence` in radians.
    #[schemars(extend("unit" = "rad"))]
    pub angles: Option<[Quantity; 3]>,
    /// Unit quaternion w, x, y, z: cos(angle/2), then the unit axis times sin(angle/2). It is normalised.
    #[schemars(extend("unit" = "1"))]
    pub quaternion: Option<[Quantity; 4]>,
    /// Rows of the rotation matrix; its columns are the axes of the turned body.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "the entries of a rotation matrix depend on each other; design an angle"
    ))]
    pub matrix: Option<[[f64; 3]; 3]>,
}

/// One angle or three, in degrees.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum InDegrees {
    /// One.
    #[schemars(extend("unit" = "°"))]
    One(Degrees),
    /// Three.
    #[schemars(extend("unit" = "°"))]
    Three([Degrees; 3]),
}

/// Velocity of one body at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyVelocity {
    /// Velocity of the centre of mass (of a beam's start) in ground axes, default 0.
    #[schemars(extend("unit" = "m/s"))]
    pub linear: Option<Vector>,
    /// Angular velocity in ground axes, default 0.
    #[schemars(extend("unit" = "rad/s"))]
    pub angular: Option<Vector>,
}

/// Velocity of the whole assembly at the start. It moves as one rigid body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AssemblyVelocity {
    /// Velocity of the point `about` in ground axes, default 0.
    #[schemars(extend("unit" = "m/s"))]
    pub linear: Option<Vector>,
    /// Angular velocity in ground axes, default 0.
    #[schemars(extend("unit" = "rad/s"))]
    pub angular: Option<Vector>,
    /// Point of the axis of rotation in ground coordinates, default the origin.
    #[schemars(extend("unit" = "m"))]
    pub about: Option<Vector>,
}
