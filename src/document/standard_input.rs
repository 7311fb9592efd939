//! The document of standard input data of a body.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// A vector and a 3 × 3 matrix by rows.
pub type Triple = [f64; 3];
pub type Square = [[f64; 3]; 3];

/// A body whose point X is at X + Σ q_I X_I(X) in its axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StandardInput {
    /// Version of the format, 1.
    #[schemars(extend("const" = 1))]
    #[allow(dead_code)]
    pub version: u32,
    /// ∫ dm.
    #[schemars(extend("unit" = "kg", "exclusiveMinimum" = 0))]
    pub mass: f64,
    /// ∫ X dm / mass.
    #[schemars(extend("unit" = "m"))]
    pub centre_of_mass: Triple,
    /// Inertia of the undeformed body about the origin of its axes, by rows.
    #[schemars(extend("unit" = "kg m²"))]
    pub inertia: Square,
    /// By mode: p_I = ∫ X_I dm.
    #[schemars(extend("unit" = "kg m"))]
    pub static_moments: Vec<Triple>,
    /// By mode: S_0I = ∫ X X_Iᵀ dm, by rows.
    #[schemars(extend("unit" = "kg m²"))]
    pub with_position: Vec<Square>,
    /// By mode I: S_IJ = ∫ X_I X_Jᵀ dm, by rows, for J = I and all later modes.
    #[schemars(extend("unit" = "kg m²"))]
    pub products: Vec<Vec<Square>>,
    /// Stiffness matrix, by rows.
    #[schemars(extend("unit" = "N/m"))]
    pub stiffness: Vec<Vec<f64>>,
    /// Damping matrix, by rows, default 0.
    #[schemars(extend("unit" = "N s/m"))]
    pub damping: Option<Vec<Vec<f64>>>,
    /// Points that joints, loads and functions can hold.
    pub points: IndexMap<String, StandardPoint>,
}

/// A point of the body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StandardPoint {
    /// Where it is in the undeformed body.
    #[schemars(extend("unit" = "m"))]
    pub position: Triple,
    /// By mode: its displacement.
    #[schemars(extend("unit" = "1"))]
    pub displacement: Vec<Triple>,
    /// By mode: its rotation; none if it is not known, then only forces act there.
    #[schemars(extend("unit" = "1/m"))]
    pub rotation: Option<Vec<Triple>>,
}

impl StandardInput {
    /// The JSON Schema of the document.
    pub fn schema() -> Value {
        schemars::schema_for!(Self).to_value()
    }

    /// Reads the document.
    ///
    /// # Errors
    /// What is wrong in it.
    pub fn read(json: Value) -> Result<Self, String> {
        serde_json::from_value(json).map_err(|error| error.to_string())
    }
}
