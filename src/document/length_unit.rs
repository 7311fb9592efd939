//! Units of the coordinates of other files.

use schemars::JsonSchema;
use serde::Deserialize;

/// A unit of length.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    /// Metres.
    #[default]
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Inches.
    Inch,
}

impl LengthUnit {
    /// Its length \[m\].
    pub fn metres(self) -> f64 {
        match self {
            Self::M => 1.0,
            Self::Cm => 0.01,
            Self::Mm => 0.001,
            Self::Inch => 0.0254,
        }
    }
}
