//! Loads in a file.

use super::contacts::Contact;
use super::controllers::Controller;
use super::drives::Sliding;
use super::joints::Ends;
pub use super::magnitudes::{
    ForceInTime, Interpolation, LineForceInTime, Motion, PressureInTime, TimeFunction, TorqueInTime,
};
use super::mechanics::Point;
use crate::quantity::{Quantity, Vector, nothing};
use schemars::JsonSchema;
use serde::Deserialize;

/// The exponent 1.
fn linear() -> f64 {
    1.0
}

/// A force, torque, spring, damper, bushing, friction, drag, stop, contact, cable or controller.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Load {
    /// A force at a point of a body.
    Force(Force),
    /// A torque on a body.
    Torque(Torque),
    /// A spring with a damper between points of two bodies. The tension is k x + k3 x³ + c l̇ and that of tables, with
    /// x = l − l0.
    Spring(Spring),
    /// A spring with a damper about the axis of a revolute or planar joint.
    TorsionSpring(TorsionSpring),
    /// Viscous damping in a joint.
    Damping(Damping),
    /// Linear elastic forces and torques of all relative motion in a joint, with damping.
    Bushing(Bushing),
    /// Coulomb friction in a joint: size times tanh(rate / width).
    Friction(Friction),
    /// Quadratic drag on a point of a body: c |u|² u / √(|u|² + w²) against its velocity u.
    Drag(Drag),
    /// Stops of a joint or of the distance of two points, which press back smoothly.
    Stop(Stop),
    /// A contact of a sphere, point, wheel or capsule of a body with a surface, with friction.
    Contact(Box<Contact>),
    /// A cable over frictionless pulleys, or a winch. It pulls and never presses.
    Cable(Cable),
    /// A pressure on shells of a body of `elements`, along the normals of the deformed surface.
    Pressure(Pressure),
    /// A force per area on shells of a body of `elements`, in a fixed direction.
    Area(AreaForce),
    /// A force per length on edges of shells of a body of `elements`, in a fixed direction.
    Edge(EdgeForce),
    /// A force per length on beams of a body of `elements`, in a fixed direction.
    Line(LineForce),
    /// A controller with its motor, which makes a joint or a distance follow a reference.
    Controller(Box<Controller>),
}

/// A force at a point of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// The body.
    pub body: String,
    /// Point of application, by name or in body axes; default the centre of mass, of a beam its middle; bodies of `elements` and `modal` ones need one.
    pub point: Option<Point>,
    /// Point of application in ground coordinates at the start, instead of `point`.
    #[schemars(extend("unit" = "m"))]
    pub at: Option<Vector>,
    /// Direction, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Axes in which the direction is given and fixed, default ground.
    #[serde(default)]
    pub axes: Axes,
    /// Magnitude: a number, or a function of time.
    pub magnitude: ForceInTime,
}

/// A torque on a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Torque {
    /// The body.
    pub body: String,
    /// Of a beam: the point whose section it turns, by name or in body axes.
    pub point: Option<Point>,
    /// Direction, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Axes in which the direction is given and fixed, default ground.
    #[serde(default)]
    pub axes: Axes,
    /// Magnitude: a number, or a function of time.
    pub magnitude: TorqueInTime,
}

/// Axes in which a direction is fixed.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// Ground axes.
    #[default]
    Ground,
    /// Axes of the loaded body.
    Body,
}

/// A spring with a damper between points of two bodies.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// The two bodies; one of them may be "ground".
    pub between: [String; 2],
    /// Its ends.
    pub at: Ends,
    /// Length at zero force.
    #[schemars(extend("unit" = "m", "minimum" = 0))]
    pub rest_length: Quantity,
    /// Stiffness k, default 0 with a table.
    #[schemars(extend("unit" = "N/m", "minimum" = 0))]
    pub stiffness: Option<Quantity>,
    /// Cubic stiffness k3, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N/m³"))]
    pub cubic: Quantity,
    /// Damping c, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N s/m", "minimum" = 0))]
    pub damping: Quantity,
    /// Tension over the stretch x, besides that of the stiffness; default none.
    pub table: Option<ForceTable>,
    /// Tension over the rate l̇, besides that of the damping; default none.
    pub damping_table: Option<ForceTable>,
}

/// Forces or torques over a stretch, an angle or a rate. It goes on straight beyond both ends.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceTable {
    /// Stretches, angles or rates, increasing.
    #[schemars(extend(
        "unit" = "m, rad, m/s or rad/s",
        "design_variable" = "the places of a table keep their order; design its forces"
    ))]
    pub places: Vec<f64>,
    /// Force or torque at each.
    #[schemars(extend("unit" = "N or N m"))]
    pub forces: Vec<Quantity>,
    /// Interpolation between the forces, default monotone.
    pub interpolation: Option<Interpolation>,
}

/// A spring with a damper about the axis of a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorsionSpring {
    /// Name of a revolute, planar or cylindrical joint.
    pub joint: String,
    /// Angle at zero torque: of the first body relative to the second (ground counts as the second)
    /// about the axis, from the placement; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "rad"))]
    pub rest_angle: Quantity,
    /// Stiffness, default 0 with a table.
    #[schemars(extend("unit" = "N m/rad", "minimum" = 0))]
    pub stiffness: Option<Quantity>,
    /// Cubic stiffness k3 of the torque k x + k3 x³, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N m/rad³"))]
    pub cubic: Quantity,
    /// Damping, default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N m s/rad", "minimum" = 0))]
    pub damping: Quantity,
    /// Torque over the angle from rest, besides that of the stiffness; default none.
    pub table: Option<ForceTable>,
    /// Torque over the rate of the angle, besides that of the damping; default none.
    pub damping_table: Option<ForceTable>,
}

/// Viscous damping in a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// Name of a revolute, prismatic, cylindrical, planar, spherical or universal joint.
    pub joint: String,
    /// Motion of a cylindrical joint, default rotation.
    pub motion: Option<Motion>,
    /// Force or torque per unit of rate, default 0 with a table.
    #[schemars(extend("unit" = "N s/m or N m s/rad", "minimum" = 0))]
    pub coefficient: Option<Quantity>,
    /// Force or torque over the rate, besides that of the coefficient; default none. Not of a spherical or universal joint.
    pub table: Option<ForceTable>,
}

/// Linear elastic forces and torques of all relative motion in a joint, with damping: −(K x + C ẋ), x the displacement of its
/// bodies against each other along e1, e2, e3 and the rotation about them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bushing {
    /// Name of a joint: a free one, or one that leaves some of the motion, such as a spherical or universal joint.
    pub joint: String,
    /// K.
    pub stiffness: BushingStiffness,
    /// C, default zero.
    pub damping: Option<BushingDamping>,
    /// The body of the joint with which e1, e2, e3 turn: `first` or `second` of its `between`. The force acts at the joint's point on the
    /// other. Default: ground if a `free` joint has it and the bushing neither resists the turn about e3 nor has friction against a slide,
    /// as a bearing of a shaft; else the body that is not ground, or the first.
    pub axes: Option<BushingAxes>,
    /// Friction of a bearing or guide by the force of the bushing across e3, default none.
    pub friction: Option<BearingFriction>,
}

/// A body of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BushingAxes {
    /// The first of `between`.
    First,
    /// The second.
    Second,
}

/// Friction of a bearing or guide: μ ρ N tanh(ω / w) against the rate ω of the turn about e3 or of the slide along it, with N =
/// √(f² + n²) − n by the force f of the bushing across e3.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BearingFriction {
    /// The motion with friction: `turn` (default) or `slide`.
    #[serde(default = "turn")]
    pub motion: Motion,
    /// Coefficient of friction μ.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub coefficient: Quantity,
    /// Radius ρ of the bearing; not of a guide that slides.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub radius: Option<Quantity>,
    /// Rate w, at which 76 % of the friction acts.
    #[schemars(extend("unit" = "rad/s or m/s", "exclusiveMinimum" = 0))]
    pub width: Quantity,
    /// Force n, well above which N is the force across; it makes N smooth where the force vanishes.
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0))]
    pub load_width: Quantity,
}

/// A turn.
fn turn() -> Motion {
    Motion::Turn
}

/// Stiffness of a bushing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BushingStiffness {
    /// Its diagonal: three numbers of displacements along e1, e2, e3 and three of rotations about them.
    Diagonal(#[schemars(extend("unit" = "N/m, N m/rad"))] [Quantity; 6]),
    /// Its rows; symmetric.
    Rows(#[schemars(extend("unit" = "N/m, N, N m/rad"))] Box<[[Quantity; 6]; 6]>),
}

/// Damping of a bushing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BushingDamping {
    /// Its diagonal: three numbers of displacements along e1, e2, e3 and three of rotations about them.
    Diagonal(#[schemars(extend("unit" = "N s/m, N m s/rad"))] [Quantity; 6]),
    /// Its rows; symmetric.
    Rows(#[schemars(extend("unit" = "N s/m, N s, N m s/rad"))] Box<[[Quantity; 6]; 6]>),
}

/// The 36 entries of a matrix of a bushing, by rows; `None` beside a diagonal.
pub type BushingEntries<'a> = [[Option<&'a Quantity>; 6]; 6];

fn diagonal(all: &[Quantity; 6]) -> BushingEntries<'_> {
    std::array::from_fn(|i| std::array::from_fn(|k| (i == k).then_some(&all[i])))
}

fn rows(all: &[[Quantity; 6]; 6]) -> BushingEntries<'_> {
    all.each_ref().map(|row| row.each_ref().map(Some))
}

impl BushingStiffness {
    /// Its entries.
    pub fn entries(&self) -> BushingEntries<'_> {
        match self {
            Self::Diagonal(all) => diagonal(all),
            Self::Rows(all) => rows(all),
        }
    }
}

impl BushingDamping {
    /// Its entries.
    pub fn entries(&self) -> BushingEntries<'_> {
        match self {
            Self::Diagonal(all) => diagonal(all),
            Self::Rows(all) => rows(all),
        }
    }
}

/// Coulomb friction in a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Name of a revolute, prismatic, cylindrical or planar joint.
    pub joint: String,
    /// Motion of a cylindrical joint, default rotation.
    pub motion: Option<Motion>,
    /// Force or torque at rates well above the width.
    #[schemars(extend("unit" = "N or N m", "minimum" = 0))]
    pub size: Quantity,
    /// Rate at which 76 % of it acts. A smaller width is sharper and needs finer steps.
    #[schemars(extend("unit" = "m/s or rad/s", "exclusiveMinimum" = 0))]
    pub width: Quantity,
}

/// Quadratic drag on a point of a body in a fluid at rest.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// The body.
    pub body: String,
    /// Where it acts, by name or in body axes; default as of a force.
    pub point: Option<Point>,
    /// Name of the set of shells on which it acts, of a body of elements. The coefficients are then those of an area.
    pub faces: Option<String>,
    /// Half the density times the drag coefficient times the area: force against the velocity by the square of the speed; for shells
    /// without the area.
    #[schemars(extend("unit" = "N s²/m² or N s²/m⁴", "minimum" = 0))]
    pub coefficient: Quantity,
    /// The same of the force along the normal of a plate or wing at the angle α, by the square of the speed times sin α, default 0. Its
    /// part across the velocity is lift.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "N s²/m² or N s²/m⁴", "minimum" = 0))]
    pub normal_coefficient: Quantity,
    /// Normal of the plate, in ground axes at the start and fixed in the body. Shells have theirs.
    #[schemars(extend("unit" = "1"))]
    pub normal: Option<Vector>,
    /// Speed w below which the drag goes smoothly to zero, default 0.001 m/s. Above it the drag is off by ½ w²/u².
    #[serde(default = "slow")]
    #[schemars(extend("unit" = "m/s", "exclusiveMinimum" = 0))]
    pub width: Quantity,
}

/// The default width of drag \[m/s\].
fn slow() -> Quantity {
    Quantity::fixed(1e-3)
}

/// Stops of a joint or of a distance: N = k ρⁿ ρ' (1 + ³⁄₂ c δ̇), never negative, with the penetration δ and its smooth ramp ρ.
/// Give `joint`, or `between` and `at`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Name of a revolute, prismatic, cylindrical or planar joint.
    pub joint: Option<String>,
    /// Motion of a cylindrical joint, default rotation.
    pub motion: Option<Motion>,
    /// Two bodies whose points are stopped; one of them may be "ground".
    pub between: Option<[String; 2]>,
    /// Their points.
    pub at: Option<Ends>,
    /// The angle, displacement or distance may not fall below this. An angle or displacement is that of the first body
    /// relative to the second (ground counts as the second), from the placement.
    #[schemars(extend("unit" = "m or rad"))]
    pub lower: Option<Quantity>,
    /// It may not rise above this.
    #[schemars(extend("unit" = "m or rad"))]
    pub upper: Option<Quantity>,
    /// Stiffness k: force or torque per penetration, to the power of the exponent if there is one.
    #[schemars(extend("unit" = "N/m or N m/rad", "exclusiveMinimum" = 0))]
    pub stiffness: Quantity,
    /// Dissipation c: at small speeds v of impact the rebound has 1 − c v of it; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "s/m or s/rad", "minimum" = 0))]
    pub dissipation: Quantity,
    /// Width w of the onset, from w/2 before the limit to w/2 behind it. A smaller width is sharper and needs finer steps.
    #[schemars(extend("unit" = "m or rad", "exclusiveMinimum" = 0))]
    pub width: Quantity,
    /// Exponent n of the penetration, default 1. A rubber buffer has 1.5 to 3.
    #[serde(default = "linear")]
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 1,
        "design_variable" = "the exponent says which law the numbers of a stop have"
    ))]
    pub exponent: f64,
}

/// A cable that runs straight from point to point over pulleys without friction and radius. Its tension is the normal force of
/// a stop: k ρ ρ' (1 + ³⁄₂ c δ̇), never negative, with the stretch δ = L − L0 and its smooth ramp ρ.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cable {
    /// Its points in order: two ends with pulleys between them.
    pub points: Vec<CablePoint>,
    /// Length L0 at which it is just slack: a number, or a function of time that a winch follows.
    pub length: CableLength,
    /// Stiffness k of the whole cable: force per stretch.
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0))]
    pub stiffness: Quantity,
    /// Dissipation c: the tension grows by ³⁄₂ c times the rate of the stretch; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "s/m", "minimum" = 0))]
    pub dissipation: Quantity,
    /// Width w of the onset, from w/2 before the cable is taut to w/2 behind it. A smaller width is sharper and needs finer steps.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub width: Quantity,
}

/// A point of a cable.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CablePoint {
    /// Its body, which may be "ground".
    pub body: String,
    /// The point, by name or in body axes (ground coordinates if it is ground); default the centre of mass.
    pub point: Option<Point>,
}

/// Length of a cable.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum CableLength {
    /// The same at all times.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    Constant(Quantity),
    /// A function of time.
    Varying(Sliding),
}

/// A pressure on shells of a body of elements.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pressure {
    /// The body.
    pub body: String,
    /// Name of the set of faces.
    pub faces: String,
    /// Pressure, positive along the normal of the shells: a number, or a function of time.
    pub pressure: PressureInTime,
}

/// A force per area on shells of a body of elements.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AreaForce {
    /// The body.
    pub body: String,
    /// Name of the set of faces.
    pub faces: String,
    /// Direction, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Axes in which the direction is given and fixed, default ground.
    #[serde(default)]
    pub axes: Axes,
    /// Force per area of the undeformed shells: a number, or a function of time.
    pub magnitude: PressureInTime,
}

/// A force per length on edges of shells of a body of elements.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EdgeForce {
    /// The body.
    pub body: String,
    /// Name of the set of edges.
    pub edges: String,
    /// Direction, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Axes in which the direction is given and fixed, default ground.
    #[serde(default)]
    pub axes: Axes,
    /// Force per length of the undeformed edges: a number, or a function of time.
    pub magnitude: LineForceInTime,
}

/// A force per length on beams of a body of elements, at their nodes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineForce {
    /// The body.
    pub body: String,
    /// Name of the set of beams.
    pub beams: String,
    /// Direction, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Axes in which the direction is given and fixed, default ground.
    #[serde(default)]
    pub axes: Axes,
    /// Force per length of the undeformed beams: a number, or a function of time.
    pub magnitude: LineForceInTime,
}

impl Load {
    /// Its key in the file.
    pub fn key(&self) -> &'static str {
        match self {
            Load::Force(_) => "force",
            Load::Torque(_) => "torque",
            Load::Spring(_) => "spring",
            Load::TorsionSpring(_) => "torsion_spring",
            Load::Damping(_) => "damping",
            Load::Bushing(_) => "bushing",
            Load::Friction(_) => "friction",
            Load::Drag(_) => "drag",
            Load::Stop(_) => "stop",
            Load::Contact(_) => "contact",
            Load::Cable(_) => "cable",
            Load::Pressure(_) => "pressure",
            Load::Area(_) => "area",
            Load::Edge(_) => "edge",
            Load::Line(_) => "line",
            Load::Controller(_) => "controller",
        }
    }
}
