//! Contacts that come and go within a step.
//!
//! The error of a step knows nothing of a force that no stage has met. So the penetration δ of each stop or contact is
//! followed over the step by the cubic through its values and rates at both ends, which errs by h⁴/384 max |d⁴δ/dt⁴|. A
//! step that begins and ends apart and touches between is repeated, and then ends at the deepest place of the cubic.

use crate::math::Scalar;
use crate::model::Model;
use crate::system::BodyMotion;
use crate::system::loads::gaps::{Gap, gaps, may_touch};

/// A contact that a step passes over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// The load.
    pub load: usize,
    /// The part of the step after which it is deepest.
    pub part: f64,
}

/// The gaps at the start of a step and at its end.
pub struct Touches {
    before: Vec<Gap>,
    after: Vec<Gap>,
}

impl Touches {
    /// Watches the stops of a model from its start; `None` if it has none.
    pub fn open<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>]) -> Option<Self> {
        if !model.loads.iter().any(|load| may_touch(&load.kind)) {
            return None;
        }
        let mut before = Vec::new();
        gaps(model, motions, &mut before);
        Some(Self {
            before,
            after: Vec::new(),
        })
    }

    /// The contact that comes first of those which a step of size h passes over; `motions` are those of its end.
    pub fn missed<S: Scalar>(
        &mut self,
        model: &Model<S>,
        motions: &[BodyMotion<S>],
        h: f64,
    ) -> Option<Missed> {
        gaps(model, motions, &mut self.after);
        let pairs = self.before.iter().zip(&self.after);
        let all = pairs.filter_map(|(before, after)| {
            let part = deepest([before, after], h)?;
            Some(Missed {
                load: before.load,
                part,
            })
        });
        all.min_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// Goes on from the end of the step that was looked at last.
    pub fn go_on(&mut self) {
        std::mem::swap(&mut self.before, &mut self.after);
    }
}

/// The part of a step of size h at which the penetration is largest, if it begins and ends apart and touches between.
fn deepest([before, after]: [&Gap; 2], h: f64) -> Option<f64> {
    let apart = |gap: &Gap| gap.penetration < gap.onset;
    // It comes nearer at first and goes away in the end.
    if !(apart(before) && apart(after) && before.rate > 0.0 && after.rate < 0.0) {
        return None;
    }
    let (a, b) = (before.rate * h, after.rate * h);
    let rise = after.penetration - before.penetration;
    // δ' = a + 2 (3 rise − 2 a − b) s + 3 (a + b − 2 rise) s², with one root from plus to minus.
    let (half, square) = (3.0 * rise - 2.0 * a - b, 3.0 * (a + b - 2.0 * rise));
    let root = (half * half - square * a).max(0.0).sqrt();
    let part = a / (root - half);
    let depth = before.penetration + part * (a + part * (half + part * square / 3.0));
    (depth > before.onset.max(after.onset)).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(penetration: f64, rate: f64) -> Gap {
        Gap {
            load: 0,
            penetration,
            rate,
            onset: 0.0,
        }
    }

    /// A parabola δ = c − (s − s0)² and a cubic with the root of its rate inside.
    #[test]
    fn finds_the_deepest_place() {
        let cubic = |s: f64| {
            [
                0.3 - (s - 0.4).powi(2) * (1.0 + s),
                -2.0 * (s - 0.4) * (1.0 + s) - (s - 0.4).powi(2),
            ]
        };
        let [before, after] = [0.0, 1.0].map(|s| {
            let [x, rate] = cubic(s);
            gap(x - 0.2, rate / 0.5)
        });
        let part = deepest([&before, &after], 0.5).expect("a contact");
        assert!((part - 0.4).abs() < 1e-14, "{part}");
        let [before, after] = [gap(-0.2, 1.0), gap(-0.2, -1.0)];
        assert_eq!(deepest([&before, &after], 1.0), Some(0.5));
        // It comes as near as −0.05 only, or moves one way.
        let [before, after] = [gap(-0.2, 0.6), gap(-0.2, -0.6)];
        assert_eq!(deepest([&before, &after], 1.0), None);
        assert_eq!(deepest([&gap(-0.5, 0.3), &gap(-0.2, 0.3)], 1.0), None);
    }
}
