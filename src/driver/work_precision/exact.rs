//! Exact results, and the distance of a run from them.

use crate::integrate::Trajectory;
use crate::report::positions::Positions;

/// Final positions and a gradient that count as exact.
pub struct Reference {
    /// Centres of mass at the end, by body \[m\].
    pub positions: Positions,
    /// Gradient of the measured function.
    pub gradient: Option<Vec<f64>>,
    /// Distance of the positions from those of an independent run \[m\]; NaN if there is none.
    pub difference: f64,
    /// Relative difference of the gradient; NaN if there is none.
    pub gradient_difference: f64,
    /// Origin of positions and gradient, and their difference from an independent run.
    pub description: String,
}

/// Centres of mass at the end of a run \[m\].
pub fn positions(run: &Trajectory<f64>) -> Vec<[f64; 3]> {
    let q = run.q(run.last());
    let place = |body: usize| {
        let at = run.numbering.position(body);
        [q[at], q[at + 1], q[at + 2]]
    };
    (0..run.numbering.bodies()).map(place).collect()
}

/// Largest distance of a body from its exact position \[m\]; NaN if a position is NaN.
pub fn distance(exact: &[(usize, [f64; 3])], found: &[[f64; 3]]) -> f64 {
    let away = |(body, exact): &(usize, [f64; 3])| -> f64 {
        let found = &found[*body];
        let square: f64 = exact.iter().zip(found).map(|(a, b)| (a - b).powi(2)).sum();
        square.sqrt()
    };
    largest(exact.iter().map(away))
}

/// Largest difference of two gradients relative to the largest component of the exact one.
pub fn gradient_error(found: &[f64], exact: &[f64]) -> f64 {
    let size = largest(exact.iter().map(|x| x.abs()));
    largest(exact.iter().zip(found).map(|(a, b)| (a - b).abs())) / size
}

/// The largest number; NaN if there is one.
fn largest(all: impl Iterator<Item = f64>) -> f64 {
    all.fold(0.0, |m, x| {
        if x.is_nan() || m.is_nan() {
            f64::NAN
        } else {
            m.max(x)
        }
    })
}
