//! What counts as exact, and how far a run is from it.

use crate::integrate::Trajectory;
use crate::report::positions::Positions;

/// Positions at the end and a gradient that count as exact.
pub(crate) struct Reference {
    /// Centres of mass at the end by body (m).
    pub positions: Positions,
    /// Gradient of the function in question.
    pub gradient: Option<Vec<f64>>,
    /// Distance of the positions from those of an independent run (m); NaN if there is none.
    pub difference: f64,
    /// The same of the gradient, relative.
    pub gradient_difference: f64,
    /// Where positions and gradient come from and how far they are from an independent run.
    pub description: String,
}

/// Centres of mass at the end of a run (m).
pub(crate) fn positions(run: &Trajectory<f64>) -> Vec<[f64; 3]> {
    let q = run.q(run.last());
    let place = |body: usize| {
        let at = run.numbering.position(body);
        [q[at], q[at + 1], q[at + 2]]
    };
    (0..run.numbering.bodies()).map(place).collect()
}

/// Largest distance of a body from where it should be (m); NaN if one is nowhere.
pub(crate) fn distance(exact: &[(usize, [f64; 3])], found: &[[f64; 3]]) -> f64 {
    let away = |(body, exact): &(usize, [f64; 3])| -> f64 {
        let found = &found[*body];
        let square: f64 = exact.iter().zip(found).map(|(a, b)| (a - b).powi(2)).sum();
        square.sqrt()
    };
    largest(exact.iter().map(away))
}

/// Largest difference of two gradients relative to the largest component of the exact one.
pub(crate) fn gradient_error(found: &[f64], exact: &[f64]) -> f64 {
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
