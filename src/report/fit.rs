//! What fitted numbers are worth, in the record of an optimisation.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// The fit of numbers to measured values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    /// Number of measured values.
    pub data: u64,
    /// Number of measured values less that of the directions that they determine.
    pub freedom: u64,
    /// Sum of the squares of the residuals in standard deviations by `freedom`; one is expected if these are right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduced_chi_square: Option<f64>,
    /// Where the covariance has its scale from.
    pub variance: VarianceFrom,
    /// Standard deviation of each variable in its unit; 0 at a bound, none if the data do not determine it.
    pub standard_deviations: IndexMap<String, Option<f64>>,
    /// Covariance of each pair of determined variables, in their units.
    pub covariance: IndexMap<String, IndexMap<String, f64>>,
    /// Correlation of each pair of determined variables.
    pub correlation: IndexMap<String, IndexMap<String, f64>>,
    /// Changes of the variables that the data do not see.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub undetermined: Vec<IndexMap<String, f64>>,
    /// The fit beside the measured values, by series.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub series: IndexMap<String, FittedSeries>,
    /// Fitted functions of structures beside their measured values.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub numbers: IndexMap<String, FittedNumber>,
}

/// A measured value of a function and the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedNumber {
    /// Unit of the values, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Measured value.
    pub measured: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
    /// Fitted value.
    pub fitted: f64,
}

/// Where a covariance has its scale from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VarianceFrom {
    /// From the standard deviations of the data.
    Given,
    /// From the residuals.
    Estimated,
}

/// A series of measured values and the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedSeries {
    /// Unit of the values, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What is added to the times of the data for those of the motion \[s\].
    pub offset: f64,
    /// Times of the data \[s\].
    pub time: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Their standard deviations.
    pub standard_deviation: Vec<f64>,
    /// Fitted values.
    pub fitted: Vec<f64>,
}
