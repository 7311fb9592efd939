//! Bodies in a file.

use super::elements::Elements;
use super::flexible::Beam;
use super::modal::Modal;
use crate::quantity::{Quantity, Vector};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

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
    /// Mass.
    #[schemars(extend("unit" = "kg", "exclusiveMinimum" = 0))]
    pub mass: Option<Quantity>,
    /// Centre of mass of a body without a shape, from the origin of the body's axes; default 0.
    #[schemars(extend("unit" = "m"))]
    pub centre_of_mass: Option<Vector>,
    /// Inertia of a body without a shape.
    pub inertia: Option<Inertia>,
    /// A beam with elastic coordinates, instead of all above.
    pub beam: Option<Box<Beam>>,
    /// Shells with elastic coordinates at all their nodes, instead of all above.
    pub elements: Option<Box<Elements>>,
    /// A body with elastic coordinates from files of other codes, instead of all above.
    pub modal: Option<Box<Modal>>,
    /// Named points in body axes from their origin (the centre of the shape, the start of a beam).
    #[serde(default)]
    #[schemars(extend("unit" = "m"))]
    pub points: IndexMap<String, Vector>,
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

/// The quantity 0.
fn nothing() -> Quantity {
    Quantity::fixed(0.0)
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
    One(Turn),
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

/// A rotation by an angle about an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Axis of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub axis: Vector,
    /// Angle by the right-hand rule.
    #[schemars(extend("unit" = "rad"))]
    pub angle: Quantity,
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
