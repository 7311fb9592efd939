//! The backward error of an iterate: its residuals relative to the round-off of their terms (Oettli & Prager
//! 1964),
//!
//! ```text
//! ω = max_i |F_i| / Σ_j |K_ij| |x_j|
//! ```
//!
//! with the scaled unknowns x and the iteration matrix K where the factors were made. The forces of
//! stiff structures are small differences of large terms. An iterate whose ω is some units of
//! round-off solves the equations with rounded terms; more iterations only change the round-off.

use super::Stage;
use super::ggl::Equations;
use super::scales::largest;
use crate::linalg::SparseMatrix;
use crate::math::Scalar;
use crate::system::Numbering;

/// Below this an iterate is a solution.
const SOLVED: f64 = 2.0 * f64::EPSILON;
/// Below this iterates that approach no further are solutions.
const STANDING: f64 = 64.0 * f64::EPSILON;

/// Number of steps for which a noise floor holds, the part of it that is negligible, and the largest error that is.
const STEPS: usize = 8;
const NEGLIGIBLE: f64 = 0.5;
const LARGEST: f64 = 1e-9;

/// The size of updates that are round-off, from a step whose iterations stood still.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NoiseFloor {
    size: f64,
    /// Number of steps for which it holds, the present one included.
    steps: usize,
}

impl NoiseFloor {
    /// Takes the last update of a step that stood still. It holds for the next steps.
    pub(super) fn set(&mut self, size: f64) {
        (self.size, self.steps) = (size, STEPS + 1);
    }

    /// Begins a step.
    pub(super) fn begin(&mut self) {
        self.steps = self.steps.saturating_sub(1);
    }

    /// The largest error of an update that is negligible beside round-off.
    pub(super) fn negligible(self) -> f64 {
        match self.steps {
            0 => 0.0,
            _ => (NEGLIGIBLE * self.size).min(LARGEST),
        }
    }
}

/// The backward errors of an iteration.
#[derive(Debug)]
pub(super) struct BackwardError {
    /// Σ_j |K_ij| |x_j|, in the unknowns of the bodies.
    terms: Vec<f64>,
    /// A vector in velocity numbering.
    all: Vec<f64>,
    /// ω of the latest iterate.
    latest: f64,
    /// ω relative to that of the iterate before, for the latest two.
    declines: [f64; 2],
}

impl BackwardError {
    /// For vectors of this length.
    pub(super) fn new(length: usize) -> Self {
        Self {
            terms: Vec::new(),
            all: vec![0.0; length],
            latest: f64::INFINITY,
            declines: [1.0; 2],
        }
    }

    /// Sets the terms at a stage of a step of size h, where the matrix is Σ s K over the `parts` (s, K).
    pub(super) fn fit<S: Scalar>(
        &mut self,
        equations: &Equations<S>,
        numbering: &Numbering,
        (at, h): (&Stage<S>, f64),
        parts: &[(f64, &SparseMatrix<S>)],
    ) {
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        let (y, rest) = self.all.split_at_mut(nv);
        let (v, rest) = rest.split_at_mut(nv);
        let (lambda, mu) = rest.split_at_mut(nc);
        let model = equations.model();
        let gravity = largest(model.gravity.as_slice());
        let moving = |v: f64, a: f64| h * (v + h * a);
        // Lengths of all bodies have one size, and so have their velocities: joints take differences of points.
        let [mut place, mut speed, mut turning, mut rates] = [0.0_f64; 4];
        for body in 0..numbering.bodies() {
            let (o, u) = (numbering.position(body), numbering.velocity(body));
            place = place.max(largest(&at.q[o..o + 3]));
            speed = speed.max(largest(&at.v[u..u + 3]));
            turning = turning.max(largest(&at.v[u + 3..u + 6]));
            rates = rates.max(largest(&at.vdot[u + 3..u + 6]));
        }
        for body in 0..numbering.bodies() {
            let u = numbering.velocity(body);
            y[u..u + 3].fill(place);
            y[u + 3..u + 6].fill(1.0);
            let rate = largest(&at.vdot[u..u + 3]);
            v[u..u + 3].fill(moving(speed, rate + gravity));
            v[u + 3..u + 6].fill(moving(turning, rates));
        }
        // Coordinates of a body have one size: small ones have the round-off of the large ones.
        for body in &model.flexible {
            let [mut place, mut speed, mut rate] = [0.0_f64; 3];
            for (carrier, k) in body.places() {
                let (o, u) = (
                    numbering.position(carrier) + k,
                    numbering.velocity(carrier) + k,
                );
                place = place.max(at.q[o].re().abs());
                speed = speed.max(at.v[u].re().abs());
                rate = rate.max(at.vdot[u].re().abs());
            }
            for (carrier, k) in body.places() {
                let u = numbering.velocity(carrier) + k;
                (y[u], v[u]) = (place, moving(speed, rate + gravity));
            }
        }
        // Multipliers of rows that are left out are zero: only round-off of the others.
        lambda.fill(h * h / equations.mass() * largest(&at.lambda));
        mu.fill(v.iter().fold(0.0, |m, &x| m.max(x)));
        equations.compress(&mut self.all);
        self.terms.clear();
        self.terms.resize(equations.order(), 0.0);
        for (scale, matrix) in parts {
            add_sizes(matrix, *scale, &self.all, &mut self.terms);
        }
    }

    /// Begins an iteration.
    pub(super) fn begin(&mut self) {
        (self.latest, self.declines) = (f64::INFINITY, [1.0; 2]);
    }

    /// Takes the residuals of the next iterate.
    pub(super) fn take<'r, S: Scalar>(
        &mut self,
        equations: &Equations<S>,
        residuals: impl IntoIterator<Item = &'r Vec<S>>,
    ) {
        let mut largest = 0.0_f64;
        for residual in residuals {
            for (out, x) in self.all.iter_mut().zip(residual) {
                *out = x.re();
            }
            equations.compress(&mut self.all);
            for (x, &terms) in self.all.iter().zip(&self.terms) {
                largest = largest.max(relative(*x, terms));
            }
        }
        let decline = match self.latest.is_finite() {
            true => (largest / self.latest).min(1.0),
            false => 1.0,
        };
        self.declines = [decline, self.declines[0]];
        self.latest = largest;
    }

    /// The part of the latest residual at which the iterate would be a solution.
    pub(super) fn part(&self) -> f64 {
        SOLVED / self.latest
    }

    /// Whether the latest iterate is a solution.
    pub(super) fn is_solved(&self) -> bool {
        self.latest <= SOLVED
    }

    /// ω of the next iterate, if it declines by the slower of the latest two rates.
    fn next(&self) -> f64 {
        self.latest * self.declines[0].max(self.declines[1])
    }

    /// Whether the next iterate will be a solution.
    pub(super) fn will_be_solved(&self) -> bool {
        self.next() <= SOLVED
    }

    /// Whether the next iterate will be a solution if it approaches no further.
    pub(super) fn will_stand(&self) -> bool {
        self.next() <= STANDING
    }

    /// Whether the latest iterate is a solution if the iterates approach no further.
    pub(super) fn is_standing(&self) -> bool {
        self.latest <= STANDING
    }
}

/// A residual relative to its terms; infinite if it is no number.
fn relative(residual: f64, terms: f64) -> f64 {
    match residual.abs() / terms {
        _ if residual == 0.0 => 0.0,
        part if part.is_nan() => f64::INFINITY,
        part => part,
    }
}

/// Adds s |K| x, x without negative entries.
fn add_sizes<S: Scalar>(matrix: &SparseMatrix<S>, scale: f64, x: &[f64], out: &mut [f64]) {
    let starts = matrix.pattern.column_starts();
    for (column, &x) in x.iter().take(matrix.pattern.order()).enumerate() {
        for slot in starts[column]..starts[column + 1] {
            let size = matrix.values[slot].re().abs();
            out[matrix.pattern.rows()[slot]] += scale * size * x.abs();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noise_floor_holds_for_eight_steps_and_is_small() {
        let mut floor = NoiseFloor::default();
        floor.begin();
        assert_eq!(floor.negligible(), 0.0);
        floor.set(1e-11);
        for _ in 0..8 {
            floor.begin();
            assert_eq!(floor.negligible(), 5e-12);
        }
        floor.begin();
        assert_eq!(floor.negligible(), 0.0);
        floor.set(1.0);
        floor.begin();
        assert_eq!(floor.negligible(), 1e-9);
    }

    #[test]
    fn a_residual_that_is_no_number_is_no_solution() {
        assert_eq!(relative(f64::NAN, 1.0), f64::INFINITY);
        assert_eq!(relative(1.0, f64::NAN), f64::INFINITY);
        assert_eq!((relative(0.0, 0.0), relative(-1.0, 4.0)), (0.0, 0.25));
    }
}
