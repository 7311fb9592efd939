//! The tests that a line search puts to a point: progress from the last point, and the filter, pairs
//! of infeasibility and merit that must not be dominated.

use crate::constants::SUFFICIENT;

/// Share of the infeasibility by which a step must improve on a filter entry (Wächter & Biegler 2006, as all
/// constants of the filter).
pub const MARGIN: f64 = 1e-5;

/// Exponents of the switching condition, of the directional derivative and of the infeasibility.
pub const SLOPE_POWER: f64 = 2.3;
pub const THETA_POWER: f64 = 1.1;

/// The point from which a search starts.
pub struct Measure {
    pub theta: f64,
    pub phi: f64,
    /// Derivative of φ along the step.
    pub slope: f64,
    /// Infeasibility below which φ may decide.
    pub theta_small: f64,
}

impl Measure {
    /// Whether (θ, φ) at step length `alpha` improves on this point: by the decrease of φ if that
    /// decides (Wächter & Biegler 2006, eq. 20), otherwise of either (eq. 18).
    pub fn accepts(&self, theta: f64, phi: f64, alpha: f64) -> bool {
        let rounding = 10.0 * f64::EPSILON * self.phi.abs();
        if self.decides_by_objective(alpha) {
            return phi - self.phi - rounding <= SUFFICIENT * alpha * self.slope;
        }
        theta <= (1.0 - MARGIN) * self.theta || phi - rounding <= self.phi - MARGIN * self.theta
    }

    /// Switching condition (eq. 19).
    pub fn decides_by_objective(&self, alpha: f64) -> bool {
        self.slope < 0.0
            && self.theta <= self.theta_small
            && alpha * (-self.slope).powf(SLOPE_POWER) > self.theta.powf(THETA_POWER)
    }
}

/// Entries (θ, φ); a point is acceptable if it improves on one of the two for every entry
/// (Wächter & Biegler 2006, eq. 18 and 22).
#[derive(Clone, Debug, Default)]
pub struct Filter {
    largest: f64,
    entries: Vec<(f64, f64)>,
}

impl Filter {
    /// A filter that refuses every infeasibility above `largest`.
    pub fn new(largest: f64) -> Filter {
        Filter {
            largest,
            entries: Vec::new(),
        }
    }

    /// Forgets all entries. The largest infeasibility stays refused.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether (θ, φ) is acceptable to every entry.
    pub fn accepts(&self, theta: f64, phi: f64) -> bool {
        theta <= self.largest && self.entries.iter().all(|&(t, p)| theta < t || phi < p)
    }

    /// Adds the point `here`, which a step of length `alpha` leaves, unless φ decided on the step
    /// (Wächter & Biegler 2006, step A-7).
    pub fn leave(&mut self, here: &Measure, alpha: f64) {
        if !here.decides_by_objective(alpha) {
            self.add(here.theta, here.phi);
        }
    }

    /// Adds the entry of the point just left, with its margin, and drops the entries it dominates.
    pub fn add(&mut self, theta: f64, phi: f64) {
        let (t, p) = ((1.0 - MARGIN) * theta, phi - MARGIN * theta);
        self.entries.retain(|&(a, b)| a < t || b < p);
        self.entries.push((t, p));
    }
}
