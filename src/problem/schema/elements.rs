//! Bodies of finite elements as they are written in a file.

use super::structures::Structure;
use crate::problem::prepared::Prepared;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::{Arc, OnceLock};

/// Shells that move: a structure in the axes of the body, in which it deforms.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Elements {
    /// Mesh, material and thickness.
    pub structure: Structure,
    /// What holds the axes.
    pub frame: ElementFrame,
    /// Nodes and edges by the names that joints, loads and functions use as points of the body.
    #[serde(default)]
    pub points: IndexMap<String, Held>,
    /// What no design changes, once it is worked out.
    #[serde(skip)]
    #[schemars(skip)]
    pub prepared: OnceLock<Arc<Prepared>>,
}

/// What holds the axes of shells. It only says from where deformations count; forces and stresses do not
/// depend on it as long as rotations are small.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum ElementFrame {
    /// Three sets of one node: the first does not move, the second stays on the line from the first, the
    /// third in the plane of all.
    Chord([String; 3]),
    /// A set of nodes that do not move, or the name of an edge.
    Clamped(String),
}

/// Where something holds on to shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Held {
    /// A set of one node.
    Node(String),
    /// A straight edge: its mean place, and the rotation of its line.
    Edge(String),
}
