//! When motions end at their events.

use serde::{Deserialize, Serialize};

/// When motions end at an event, if they do \[s\].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Events {
    /// That of the scene.
    pub own: Option<f64>,
    /// Of a problem with cases: that of each, or of each of its phases.
    pub cases: Vec<Option<f64>>,
}
