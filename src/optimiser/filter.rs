//! The filter of a line search: pairs of infeasibility and merit that must not be dominated.

/// Share of the infeasibility by which a step must improve on a filter entry.
pub(super) const MARGIN: f64 = 1e-5;

/// Growth of the infeasibility allowed after the filter was cleared.
const GROWTH: f64 = 100.0;

/// Entries (θ, φ); a point is acceptable if it improves on one of the two for every entry
/// (Wächter & Biegler 2006, eq. 18 and 22).
#[derive(Clone, Debug, Default)]
pub(super) struct Filter {
    largest: f64,
    entries: Vec<(f64, f64)>,
}

impl Filter {
    /// A filter that refuses every infeasibility above `largest`.
    pub(crate) fn new(largest: f64) -> Filter {
        Filter {
            largest,
            entries: Vec::new(),
        }
    }

    /// Clears the filter at a point of infeasibility `theta`. It may then grow a hundredfold.
    pub(crate) fn clear(&mut self, theta: f64) {
        self.entries.clear();
        self.largest = self.largest.min(GROWTH * theta.max(10.0));
    }

    /// Whether (θ, φ) is acceptable to every entry.
    pub(crate) fn accepts(&self, theta: f64, phi: f64) -> bool {
        theta <= self.largest && self.entries.iter().all(|&(t, p)| theta < t || phi < p)
    }

    /// Adds the entry of the point just left, with its margin, and drops the entries it dominates.
    pub(crate) fn add(&mut self, theta: f64, phi: f64) {
        let (t, p) = ((1.0 - MARGIN) * theta, phi - MARGIN * theta);
        self.entries.retain(|&(a, b)| a < t || b < p);
        self.entries.push((t, p));
    }
}
