//! Vectors and matrices of scenes that are turned, as problem files write them.

use nalgebra::{Rotation3, Vector3};
use serde_json::Value;

/// A vector, turned.
pub fn turned(turn: &Rotation3<f64>, x: [f64; 3]) -> Value {
    let x = turn * Vector3::from(x);
    json!([x.x, x.y, x.z])
}

/// The rows of the matrix of a rotation.
pub fn rows_of(turn: &Rotation3<f64>) -> Value {
    let row = |i: usize| [turn[(i, 0)], turn[(i, 1)], turn[(i, 2)]];
    json!([row(0), row(1), row(2)])
}
