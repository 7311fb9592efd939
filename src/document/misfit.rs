//! Measured values in a file, to which a motion or numbers are fitted.

use super::functions::Instant;
use crate::quantity::Quantity;
use flexbody_mechanics::functions::series::Measured;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// Mean square of the distances of quantities from measured values, each divided by its standard deviation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Misfit {
    /// Of a motion: quantities measured at several times, by name.
    #[serde(default)]
    pub series: IndexMap<String, Series>,
    /// Of structures: measured values of other functions.
    #[serde(default)]
    pub numbers: Vec<MeasuredNumber>,
    /// Where the covariance of fitted numbers gets its scale from; default "given" if all data have standard deviations,
    /// else "estimated".
    pub variance: Option<Variance>,
}

/// The scale of the covariance of fitted numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Variance {
    /// The standard deviations of the data are right.
    Given,
    /// Only their ratios are: the size follows from the residuals.
    Estimated,
}

/// A measured value of a function.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredNumber {
    /// Name of the function.
    pub function: String,
    /// The measured value.
    #[schemars(extend(
        "unit" = "that of the function",
        "design_variable" = "a measured value is no part of the design"
    ))]
    pub value: f64,
    /// Its standard deviation, default 1 in the unit of the function.
    #[schemars(extend(
        "unit" = "that of the function",
        "exclusiveMinimum" = 0,
        "design_variable" = "a standard deviation is no part of the design"
    ))]
    pub standard_deviation: Option<f64>,
}

/// A quantity measured at several times. Give "table" or "file".
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// The quantity.
    pub of: Instant,
    /// Rows [time, value] or [time, value, standard deviation], in the order of time.
    #[schemars(extend("design_variable" = "measured values are no part of the design"))]
    pub table: Option<Vec<Vec<f64>>>,
    /// A file of values separated by commas, whose first line names its columns.
    pub file: Option<DataFile>,
    /// Standard deviation of every value that has none of its own, in the unit of the quantity; default 1 of it.
    #[schemars(extend(
        "unit" = "that of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "a standard deviation is no part of the design"
    ))]
    pub standard_deviation: Option<f64>,
    /// What one unit of the values and standard deviations of table or file is in the SI unit of the quantity, default
    /// 1: 0.017453292519943295 for degrees.
    #[schemars(extend(
        "unit" = "1",
        "design_variable" = "a unit of the data is no part of the design"
    ))]
    pub scale: Option<f64>,
    /// The datum of the time t belongs to the time t + offset of the motion, default 0.
    #[schemars(extend("unit" = "s"))]
    pub offset: Option<Quantity>,
    /// The data.
    #[serde(skip)]
    #[schemars(skip)]
    pub loaded: Option<Arc<Measured>>,
}

/// A file of values separated by commas.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DataFile {
    /// Its path, relative to the directory of the problem file.
    pub path: String,
    /// Name of the column of the times, default "time".
    pub time: Option<String>,
    /// Name of the column of the values, default "value".
    pub value: Option<String>,
    /// Name of a column of standard deviations; default "standard_deviation" if there is one.
    pub standard_deviation: Option<String>,
    /// Name of a column of weights: the squares of the residuals are multiplied by them; default "weight" if there is
    /// one and no standard deviations.
    pub weight: Option<String>,
}

impl Misfit {
    /// The scale of the covariance.
    pub fn variance(&self) -> Variance {
        let given = |own: &Series| own.loaded.as_ref().is_some_and(|data| data.has_deviations);
        let known = |own: &MeasuredNumber| own.standard_deviation.is_some();
        let all = self.series.values().all(given) && self.numbers.iter().all(known);
        self.variance.unwrap_or(match all {
            true => Variance::Given,
            false => Variance::Estimated,
        })
    }
}
