//! Bodies of finite elements as they are written in a file.

use super::structures::{Direction, Section, Structure};
use crate::prepared::Prepared;
use crate::quantity::Quantity;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, OnceLock};

/// Why no design variable moves the settings of a basis.
const FROZEN: &str = "the basis is that of the design in the file, and no design changes it";

/// Shells or beams that move: a structure in the axes of the body, in which it deforms.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elements {
    /// Mesh, material, thickness or sections, masses at nodes, damping.
    pub structure: Structure,
    /// Beams along lines of nodes of shells, by name.
    #[serde(default)]
    pub stiffeners: IndexMap<String, Stiffener>,
    /// What holds the axes.
    pub frame: ElementFrame,
    /// Which coordinates the body has, default all of its nodes.
    #[serde(default)]
    pub basis: ElementBasis,
    /// Which inertia the body has, default that of the deformed body.
    #[serde(default)]
    pub inertia: ElementInertia,
    /// Nodes and edges by the names that joints, loads and functions use as points of the body.
    #[serde(default)]
    pub points: IndexMap<String, Held>,
    /// Names of the points that welds hold (see `problem::holds`).
    #[serde(skip)]
    #[schemars(skip)]
    pub welded: Vec<String>,
    /// The design of a reduced basis, if it is not that of the file.
    #[serde(skip)]
    #[schemars(skip)]
    pub design: Option<Vec<f64>>,
    /// Data that no design changes, once computed.
    #[serde(skip)]
    #[schemars(skip)]
    pub prepared: OnceLock<Arc<Prepared>>,
}

impl Elements {
    /// The sections of the beams.
    pub fn sections(&self) -> impl Iterator<Item = &Section> {
        let varied = self.structure.sections.as_ref();
        let several = varied.and_then(|varied| varied.values.as_deref());
        (self.structure.section.iter())
            .chain(varied.and_then(|varied| varied.value.as_ref()))
            .chain(several.unwrap_or(&[]))
            .chain(self.stiffeners.values().map(|own| &own.section))
    }
}

/// Beams along the line of nodes of a panel between its elements that is nearest to a place, of the
/// material of the structure. Axis 2 of their section is along the normal of the surface.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stiffener {
    /// The direction of the panel along which the line runs.
    pub along: Direction,
    /// Its place in the other direction, from 0 to 1.
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 0,
        "maximum" = 1,
        "design_variable" = "the nodes of a line are chosen once, for all designs"
    ))]
    pub at: f64,
    /// Cross section.
    pub section: Section,
    /// Offset of the centre of the section from the nodes, along its axes 2 and 3, default 0.
    #[schemars(extend("unit" = "m"))]
    pub offset: Option<[Quantity; 2]>,
    /// Non-structural mass per length, default 0.
    #[schemars(extend("unit" = "kg/m", "minimum" = 0))]
    pub line_mass: Option<Quantity>,
}

/// What holds the axes of shells. It only says from where deformations count; forces and stresses do not
/// depend on it as long as rotations are small.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ElementFrame {
    /// Three sets of one node: the first does not move, the second moves along the axis of the mesh that is nearest to the
    /// line from the first, the third does not move along the axis that is nearest to the normal of their plane.
    Chord([String; 3]),
    /// A set of nodes that do not move, or the name of an edge.
    Clamped(String),
}

/// Which inertia shells have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementInertia {
    /// That of the deformed body, with all Coriolis and centrifugal forces.
    #[default]
    Full,
    /// That of Kennedy & Boopathy (2016), equations 13 and 14, which leaves out products of places and deformations and
    /// depends on the velocity of the observer. It is here for comparison.
    Paper,
}

/// Which coordinates shells have.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ElementBasis {
    /// Displacements and rotations of all nodes.
    #[default]
    Full,
    /// None: the body is rigid.
    Rigid,
    /// Factors of the vectors of a reduced basis, which is that of the design in the file.
    Reduced(ReducedKeys),
}

/// What a reduced basis is made of.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReducedKeys {
    /// Points that get boundary modes, as joints and loads hold them; default: all points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interfaces: Option<Vec<String>>,
    /// Number of fixed-interface modes, default 6.
    #[schemars(extend(
        "maximum" = 200,
        "design_variable" = "a number of modes is a count, not a physical number"
    ))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<u32>,
    /// All fixed-interface modes up to this frequency, instead of a number.
    #[schemars(extend(
        "unit" = "Hz",
        "exclusiveMinimum" = 0,
        "design_variable" = FROZEN
    ))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highest_frequency: Option<f64>,
    /// Whether the basis has the membrane displacements that bending needs, default true. Without them bent
    /// shells lock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub companions: Option<bool>,
    /// Deflection up to which shells are solved for with von Karman's strains, as a part of the body's size;
    /// default 0, no such solutions.
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 0,
        "maximum" = 0.2,
        "design_variable" = FROZEN
    ))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deflection: Option<f64>,
    /// Part of the amplitude of the first below which companions and static solutions are left out, default
    /// 1e-4.
    #[schemars(extend(
        "unit" = "1",
        "exclusiveMinimum" = 0,
        "maximum" = 1,
        "design_variable" = FROZEN
    ))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

/// Where something holds on to shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Held {
    /// A set of one node.
    Node(String),
    /// An edge, as `rigid` if a weld holds it, else as `mean`.
    Edge(String),
    /// An edge all of whose nodes follow: it moves as a rigid body.
    Rigid(String),
    /// An edge whose average follows: its mean place, and the rotation that fits its displacements best.
    Mean(String),
}

impl Held {
    /// The name of the set.
    pub fn set(&self) -> &String {
        match self {
            Self::Node(set) | Self::Edge(set) | Self::Rigid(set) | Self::Mean(set) => set,
        }
    }

    /// Its key in the file.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Node(_) => "node",
            Self::Edge(_) => "edge",
            Self::Rigid(_) => "rigid",
            Self::Mean(_) => "mean",
        }
    }
}
