//! Cases of a machine in a file: analyses with some of its numbers replaced, and functions over several of them.

use super::Analysis;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// An analysis of the machine of the file with some values replaced.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What is computed, default what the file says.
    pub analysis: Option<Analysis>,
    /// Values that replace those of the file, by their JSON Pointer: {"/loads/wind/force/magnitude": 12}. The number of a
    /// design variable cannot be replaced.
    #[serde(default)]
    pub set: IndexMap<String, Value>,
}

/// One number from the values of a function in several cases.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OverCases {
    /// Name of a function of the machine, which has a value in each case.
    pub function: String,
    /// "all" (default), a list of names, or the weight of each case by its name.
    pub cases: Option<WhichCases>,
    /// What is taken of the values.
    pub by: CaseCombination,
}

/// The cases of a function over cases.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum WhichCases {
    /// "all".
    All(AllCases),
    /// Some, by name, with equal weights.
    Named(Vec<String>),
    /// Weights by name.
    Weighted(
        #[schemars(extend(
            "unit" = "1",
            "design_variable" = "a weight says what is asked, not what is built"
        ))]
        IndexMap<String, f64>,
    ),
}

/// All cases.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AllCases {
    /// All of the file.
    All,
}

/// What is taken of the values f_c of a function in several cases, with weights w_c.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CaseCombination {
    /// Their sum Σ w_c f_c. A weight may be negative: 1 and −1 give a difference of two cases.
    Sum,
    /// Their mean m = Σ w_c f_c / Σ w_c.
    Mean,
    /// Their standard deviation √(Σ w_c (f_c − m)² / Σ w_c). It has no derivative where all are equal.
    Deviation,
    /// A smooth bound of the largest or the smallest, without weights.
    Ks(KsOverCases),
}

/// Kreisselmeier–Steinhauser function over cases, (1/ρ) ln Σ e^{ρ f_c}: never below the largest value, and above it by ln n/ρ
/// at most.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KsOverCases {
    /// Aggregation parameter in 1/unit of the function; larger is closer to the largest. Default: chosen at the start.
    #[schemars(extend(
        "unit" = "1/unit of the function",
        "exclusiveMinimum" = 0,
        "design_variable" = "an aggregation parameter says what is asked, not what is built"
    ))]
    pub rho: Option<f64>,
    /// The largest value (default), or the smallest, which is bounded from below.
    pub of: Option<Extreme>,
}

/// A largest or smallest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Extreme {
    /// The largest.
    #[default]
    Largest,
    /// The smallest.
    Smallest,
}

impl OverCases {
    /// The cases that are meant, of those `all` of the file, with their weights.
    pub fn weights<'a>(&'a self, all: impl Iterator<Item = &'a str>) -> Vec<(&'a str, f64)> {
        match &self.cases {
            None | Some(WhichCases::All(_)) => all.map(|name| (name, 1.0)).collect(),
            Some(WhichCases::Named(names)) => {
                names.iter().map(|name| (name.as_str(), 1.0)).collect()
            }
            Some(WhichCases::Weighted(weights)) => { weights.iter() }
                .map(|(name, weight)| (name.as_str(), *weight))
                .collect(),
        }
    }
}
