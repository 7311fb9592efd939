//! Aggregates beside what they stand for, in the text and in the JSON of `optimize simulate`.

use crate::math::soft_max::Smoothed;
use serde_json::{Value, json};

/// Adds the true value of an aggregate to its entry, unless that is `told` before, and parameters that bring the
/// aggregate near it.
pub(super) fn add_smoothed(own: &mut Value, smoothed: &Smoothed, told: bool) {
    if !told {
        own["true_value"] = json!(smoothed.value);
    }
    if let Some(far) = &smoothed.far {
        own["difference"] = json!(far.part);
        own["rho_within_1_percent"] = json!(far.rho);
    }
}

/// The true value of an aggregate in words, unless that is `told` before, and how far the aggregate is from it.
pub(super) fn told(smoothed: Option<Smoothed>, told: bool) -> String {
    let Some(Smoothed { value, far }) = smoothed else {
        return String::new();
    };
    let value = match told {
        true => String::new(),
        false => format!("  true value {value:.9e}"),
    };
    let far = far.map_or_else(String::new, |far| format!("; {far}"));
    value + &far
}
