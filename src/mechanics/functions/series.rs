//! Quantities with measured values.

use super::quantity::Quantity;
use crate::math::parameters;
use std::sync::Arc;

/// Measured values of a quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Name of the series.
    pub name: String,
    /// Times t_i, ascending \[s\].
    pub times: Vec<f64>,
    /// Values d_i, in the unit of the quantity.
    pub values: Vec<f64>,
    /// √w_i: one by the standard deviation of the value.
    pub weights: Vec<f64>,
    /// Whether these are those of the data, and not only in proportion to them.
    pub has_deviations: bool,
}

/// A quantity and its measured values.
#[derive(Clone, Debug)]
pub struct Series<S> {
    /// The quantity y.
    pub of: Quantity<S>,
    /// Its measured values.
    pub data: Arc<Measured>,
    /// Offset τ of the clock of the motion from that of the data \[s\].
    pub offset: S,
}

parameters!(struct Series { data; of, offset });
