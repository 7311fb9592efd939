//! Load cases of structures and functions of their solutions, as they are written in a file.

use crate::quantity::{Quantity, Vector};
use schemars::JsonSchema;
use serde::Deserialize;

/// How structures are analysed.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Statics {
    /// The strains, default linear.
    #[serde(default)]
    pub strains: Strains,
    /// Unknowns of a node on a smooth surface, default five.
    #[serde(default)]
    pub node_unknowns: Unknowns,
}

/// Strains of structures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Strains {
    /// Linear in the displacements.
    #[default]
    Linear,
    /// With von Karman's terms: membrane forces of moderate rotations.
    VonKarman,
}

/// Unknowns of a node on a smooth surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unknowns {
    /// Three displacements and two rotations.
    #[default]
    Five,
    /// Also the rotation about the normal, with a small drilling stiffness.
    Six,
}

/// A load of a load case. Sets have the name of their structure before a dot, or their own if there is one
/// structure.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CaseLoad {
    /// A force and a moment on each node of a set.
    Point {
        /// Name of the set of nodes.
        nodes: String,
        /// Force on each node, default none.
        #[schemars(extend("unit" = "N"))]
        force: Option<Vector>,
        /// Moment on each node, default none.
        #[schemars(extend("unit" = "N m"))]
        moment: Option<Vector>,
    },
    /// A force per length on an edge.
    Edge {
        /// Name of the set of edges.
        edges: String,
        /// Force per length.
        #[schemars(extend("unit" = "N/m"))]
        force: Vector,
    },
    /// A force per length on beams.
    Line {
        /// Name of the set of beams.
        beams: String,
        /// Force per length.
        #[schemars(extend("unit" = "N/m"))]
        force: Vector,
    },
    /// A pressure on shells, positive along their normals.
    Pressure {
        /// Name of the set of faces.
        faces: String,
        /// The pressure.
        #[schemars(extend("unit" = "Pa"))]
        pressure: Quantity,
    },
    /// A force per area on shells, in a fixed direction.
    Area {
        /// Name of the set of faces.
        faces: String,
        /// Force per area.
        #[schemars(extend("unit" = "Pa"))]
        force: Vector,
    },
    /// Weight.
    Gravity {
        /// Acceleration.
        #[schemars(extend("unit" = "m/s²"))]
        acceleration: Vector,
    },
}

/// A smooth aggregate of stress ratios.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressAggregate {
    /// Kreisselmeier-Steinhauser: never below the largest ratio.
    #[default]
    Ks,
    /// Induced exponential: never above it.
    InducedExponential,
}

/// Von Mises stress by yield stress, aggregated over both faces of the Gauss points of shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stress {
    /// Aggregation parameter; larger is closer to the maximum.
    #[schemars(extend(
        "unit" = "1",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// Which aggregate, default ks.
    #[serde(default)]
    pub aggregate: StressAggregate,
    /// Names of the load cases, default all.
    pub cases: Option<Vec<String>>,
    /// Name of the set of elements, default all.
    pub elements: Option<String>,
    /// "thickness": an aggregate for each thickness of the structures; a constraint then limits each.
    pub per: Option<StressPer>,
}

/// What has an aggregate of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressPer {
    /// All elements of one thickness: of an element, band, patch or group that the file names so, or of a structure.
    Thickness,
}

/// A quantity of a load case.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OfCase {
    /// Name of the load case.
    pub case: String,
}

/// Mean displacement of the nodes of a set.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Displacement {
    /// Name of the load case.
    pub case: String,
    /// Name of the set of nodes.
    pub nodes: String,
    /// Direction, used as it is given.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub direction: [f64; 3],
}

/// Force of the supports on a set of nodes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StaticReaction {
    /// Name of the load case.
    pub case: String,
    /// Name of the set of nodes.
    pub nodes: String,
    /// Direction, used as it is given.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub direction: [f64; 3],
}

/// Moment of the supports on a set of nodes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionMoment {
    /// Name of the load case.
    pub case: String,
    /// Name of the set of nodes.
    pub nodes: String,
    /// Direction of the axis, used as it is given.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub axis: [f64; 3],
    /// A point of the axis, default the origin.
    #[schemars(extend(
        "unit" = "m",
        "design_variable" = "a point of a function says what is asked, not what is built"
    ))]
    pub about: Option<[f64; 3]>,
}

/// A coordinate of the centre of mass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CentreOfMass {
    /// Direction, used as it is given.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub direction: [f64; 3],
}

/// Moment of inertia about an axis through the centre of mass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MomentOfInertia {
    /// Direction of the axis, used as it is given.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub axis: [f64; 3],
    /// A second axis, for a product of inertia; default the first.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a direction of a function says what is asked, not what is built"
    ))]
    pub other: Option<[f64; 3]>,
}

/// A natural frequency.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frequency {
    /// Number of the mode from 1, rigid motions left out. Two equal frequencies have no derivatives.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 150,
        "design_variable" = "the number of a mode is a count, not a physical number"
    ))]
    pub mode: usize,
    /// Whether the frequency is that of the damped oscillation of a machine, |Im s| / 2π, numbered as "damping_ratio" does.
    /// Default: the natural frequency without damping. In steady rotation all frequencies are damped ones.
    #[serde(default)]
    pub damped: bool,
    /// Whether the mode is followed by its shape while the design changes: "mode" is its number at the start of the file.
    /// Default: modes are counted by frequency at each design.
    #[serde(default)]
    pub follow: bool,
}

/// A smooth lower bound of all natural frequencies, also where they meet.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LowestFrequency {
    /// Aggregation parameter; larger is closer to the lowest frequency.
    #[schemars(extend(
        "unit" = "s",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
}
