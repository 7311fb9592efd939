//! Bodies with elastic coordinates whose numbers are in files of other codes.

use super::flexible::Deformation;
use crate::quantity::Quantity;
use flexbody_mechanics::structures::modal::imported::{ImportedBody, ImportedPoint};
use flexbody_mechanics::structures::modal::loaded::Loaded;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// A body by the matrices or by the modes that another code has written. Its axes are those of the files.
/// Its strain energy is quadratic: rotation does not stiffen it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Modal {
    /// The files. Paths are relative to the directory of the problem file.
    pub source: Source,
    /// Nodes that joints, loads and functions hold, by name; each name is a point of the body.
    /// Those of "standard_input" are in its file.
    #[serde(default)]
    pub interfaces: IndexMap<String, InterfaceNodes>,
    /// What holds the axes of a body of matrices; default: clamped at the first interface.
    pub frame: Option<ModalFrame>,
    /// Fixed-interface modes of a body of matrices, default 10.
    #[schemars(extend(
        "maximum" = 200,
        "design_variable" = "a number of modes is a count, not a physical number"
    ))]
    pub modes: Option<u32>,
    /// Factor of the stiffness matrix, default 1.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub young_factor: Option<Quantity>,
    /// Factor of the mass matrix, default 1.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub density_factor: Option<Quantity>,
    /// Factor of all lengths, those of sections included, default 1: a similar body of the same material.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0))]
    pub scale: Option<Quantity>,
    /// Damping, default none.
    pub damping: Option<ModalDamping>,
    /// Elastic coordinates at the start, by ascending frequency, default 0.
    pub start: Option<Deformation>,
    /// Data of the files.
    #[serde(skip)]
    #[schemars(skip)]
    pub loaded: Option<Arc<Loaded>>,
}

impl Modal {
    /// Its numbers, whose files are read before a scene is made.
    pub fn body(&self) -> &ImportedBody {
        let loaded = self.loaded.as_ref();
        &loaded.expect("a checked document has its files").body
    }

    /// A point of it by name, if its files are read.
    pub fn point(&self, name: &str) -> Option<&ImportedPoint> {
        let loaded = self.loaded.as_ref()?;
        loaded.body.points.iter().find(|point| point.name == name)
    }

    /// Names of its points.
    pub fn point_names(&self) -> impl Iterator<Item = &str> {
        let written = self.interfaces.keys();
        let loaded = self.loaded.iter().flat_map(|loaded| &loaded.body.points);
        let others = loaded.filter(|point| !self.interfaces.contains_key(&point.name));
        written
            .chain(others.map(|point| &point.name))
            .map(String::as_str)
    }
}

/// Where the numbers of a body are.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Source {
    /// Stiffness and mass matrix in the coordinate format of Matrix Market.
    MatrixMarket {
        /// Table of the nodes: number, x, y, z, and the components of its unknowns if they are not the
        /// same at all nodes (such as 123456).
        nodes: String,
        /// Stiffness matrix.
        stiffness: String,
        /// Mass matrix.
        mass: String,
        /// Units of the files, default SI.
        #[serde(default)]
        units: Units,
    },
    /// Stiffness and mass matrix as DMIG text (a punch file of Nastran).
    Dmig {
        /// Table of the nodes: number, x, y, z.
        nodes: String,
        /// The file with both matrices.
        file: String,
        /// Name of the stiffness matrix, default "KAAX".
        stiffness: Option<String>,
        /// Name of the mass matrix, default "MAAX".
        mass: Option<String>,
        /// Units of the files, default SI.
        #[serde(default)]
        units: Units,
    },
    /// Modes, integrals of inertia, stiffness and points in a JSON file: standard input data.
    StandardInput(String),
}

/// Units of the files of a body in SI units.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Unit of length in metres, default 1 (millimetres: 0.001).
    #[serde(default = "one")]
    #[schemars(extend(
        "unit" = "m",
        "exclusiveMinimum" = 0,
        "design_variable" = "a unit is none; \"scale\" makes a body larger"
    ))]
    pub length: f64,
    /// Unit of mass in kilograms, default 1 (tonnes: 1000).
    #[serde(default = "one")]
    #[schemars(extend(
        "unit" = "kg",
        "exclusiveMinimum" = 0,
        "design_variable" = "a unit is none; \"density_factor\" makes a body heavier"
    ))]
    pub mass: f64,
    /// Unit of time in seconds, default 1.
    #[serde(default = "one")]
    #[schemars(extend(
        "unit" = "s",
        "exclusiveMinimum" = 0,
        "design_variable" = "a unit is none; \"young_factor\" makes a body stiffer"
    ))]
    pub time: f64,
}

fn one() -> f64 {
    1.0
}

impl Default for Units {
    fn default() -> Self {
        Self {
            length: 1.0,
            mass: 1.0,
            time: 1.0,
        }
    }
}

/// Nodes of an interface.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum InterfaceNodes {
    /// Number of a node.
    One(u64),
    /// Numbers of nodes that move as one rigid body; the interface is in their middle.
    Several(Vec<u64>),
}

impl InterfaceNodes {
    /// The numbers of the nodes.
    pub fn list(&self) -> &[u64] {
        match self {
            Self::One(node) => std::slice::from_ref(node),
            Self::Several(nodes) => nodes,
        }
    }
}

/// What holds the axes of a body of matrices.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ModalFrame {
    /// They move and turn with this interface.
    Clamped(String),
    /// They move with the first interface, a line of them runs through the second, and the third, if
    /// there is one, or else the rotation of the first says how they turn about this line.
    Chord(Vec<String>),
}

/// Damping of the elastic coordinates in addition to that of the file.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModalDamping {
    /// Part of critical damping of all modes, default 0.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub ratio: Option<Quantity>,
    /// α of α M + β K, default 0.
    #[schemars(extend("unit" = "1/s", "minimum" = 0))]
    pub mass: Option<Quantity>,
    /// β of α M + β K, default 0.
    #[schemars(extend("unit" = "s", "minimum" = 0))]
    pub stiffness: Option<Quantity>,
}
