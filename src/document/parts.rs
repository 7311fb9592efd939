//! Groups of bodies, joints, loads, drives and couplings that a file defines once and uses several times, and keys that
//! several entries share. They are written out before the rest of a document is read.

use super::couplings::Coupling;
use super::drives::Drive;
use super::joints::{Axis, Joint, JointPlace, JointStart};
use super::loads::Load;
use super::mechanics::{Body, Turns};
use crate::quantity::{Quantity, Vector};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

/// A group of bodies, joints, loads, drives and couplings in axes of its own, or the file that has it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// Path of a JSON file with the keys below, relative to the directory of the problem file; instead of them.
    #[serde(rename = "file")]
    pub _file: Option<String>,
    /// Numbers by name that expressions of the part use before those of the machine. A use may give others.
    #[serde(default, rename = "parameters")]
    #[schemars(extend("unit" = super::OF_PARAMETERS))]
    pub _parameters: IndexMap<String, Quantity>,
    /// Bodies by name.
    #[serde(default, rename = "bodies")]
    pub _bodies: IndexMap<String, Body>,
    /// Joints by name.
    #[serde(default, rename = "joints")]
    pub _joints: IndexMap<String, Joint>,
    /// Loads by name.
    #[serde(default, rename = "loads")]
    pub _loads: IndexMap<String, Load>,
    /// Drives by name.
    #[serde(default, rename = "drives")]
    pub _drives: IndexMap<String, Drive>,
    /// Couplings by name.
    #[serde(default, rename = "couplings")]
    pub _couplings: IndexMap<String, Coupling>,
}

/// A use of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Use {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// Name of the part.
    #[serde(rename = "part")]
    pub _part: String,
    /// Place of the origin of the part's axes, default the origin.
    #[serde(rename = "at")]
    #[schemars(extend("unit" = "m"))]
    pub _at: Option<Vector>,
    /// Rotation from ground axes to those of the part, or a list of rotations about ground axes, applied in order;
    /// default none.
    #[serde(rename = "turn")]
    pub _turn: Option<Turns>,
    /// Parameters of the part that have other values here; expressions are of the machine's parameters.
    #[serde(default, rename = "parameters")]
    #[schemars(extend("unit" = super::OF_PARAMETERS))]
    pub _parameters: IndexMap<String, Quantity>,
    /// By name in the part: the body of the machine, or "ground", that it stands for.
    #[serde(default, rename = "connect")]
    pub _connect: IndexMap<String, String>,
}

/// Keys that entries have unless they give their own.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Defaults {
    /// Of bodies.
    #[serde(rename = "bodies")]
    pub _bodies: Option<Box<Body>>,
    /// Of joints; a key that a kind of joint does not have is not for it.
    #[serde(rename = "joints")]
    pub _joints: Option<JointDefaults>,
}

/// Keys of joints.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointDefaults {
    /// The two bodies; one of them may be "ground".
    #[serde(rename = "between")]
    pub _between: Option<[String; 2]>,
    /// Position of the joint at the start.
    #[serde(rename = "at")]
    pub _at: Option<JointPlace>,
    /// The joint's axis at the start, of any length but zero.
    #[serde(rename = "axis")]
    pub _axis: Option<Axis>,
    /// Axis of the second body of a universal joint at the start.
    #[serde(rename = "cross")]
    pub _cross: Option<Axis>,
    /// Initial position and rate of its motion.
    #[serde(rename = "start")]
    pub _start: Option<JointStart>,
    /// Length of a rod.
    #[serde(rename = "length")]
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub _length: Option<Quantity>,
}
