//! Distance of the ends of steps from singular positions, where rows of the constraints that are
//! independent elsewhere become dependent.
//!
//! At a distance x from such a position, errors of positions, velocities and accelerations are
//! round-off divided by x, x² and x³. So no step may end too close. If the motion passes a singular
//! position, a step leaps over it.

use super::scale::{Scale, Speeds};
use crate::linalg::SolveScalar;
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;

/// Number of right sides. A single one may be nearly orthogonal to the dependent combination of
/// rows.
const PROBES: usize = 4;
/// Below this ratio of steadiness to its largest value, its zero is estimated.
const NEAR: f64 = 0.6;
/// Smallest distance of a step's end from a singular position, as a fraction of the step.
const AWAY: f64 = 0.33;
/// Largest error of accelerations by round-off at the ends of steps, relative to the tolerance, and
/// the smallest tolerance for this.
const NOISE: f64 = 3.0;
const LEAST: f64 = 1e-11;
/// Largest magnification at the end of steps: for any tolerance, and for given steps.
const MOST: f64 = 1e3;
const MOST_GIVEN: f64 = 3e3;
/// Largest magnification for implicit methods, which do not use accelerations.
pub const MOST_IMPLICIT: f64 = 1e4;
/// Above this magnification a given step fails if its error exceeds `ERROR` and `MORE_ERROR` times
/// the largest error before.
const SUSPICIOUS: f64 = 3.0;
const ERROR: f64 = 1e-6;
const MORE_ERROR: f64 = 100.0;

/// Steadiness of the ends of steps: the reciprocal of the factor by which the index-1 equations
/// magnify errors of the constraints' rates. It is zero where rows become dependent.
pub struct Steadiness<S> {
    largest: f64,
    /// The last two ends (fraction, steadiness), the latest first.
    last: [Option<(f64, f64)>; 2],
    /// Right side and solution; positions that do not change.
    rhs: Vec<S>,
    still: Vec<S>,
}

impl<S: SolveScalar> Steadiness<S> {
    /// No end yet.
    pub fn new(numbering: &Numbering) -> Self {
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        Self {
            largest: 0.0,
            last: [None, None],
            rhs: vec![S::zero(); nv + nc],
            still: vec![S::zero(); numbering.positions()],
        }
    }

    /// The steadiness where `field` is evaluated and factorised, for errors that move the bodies of each joint by about the scene's
    /// scale. So a slide far from where it began does not count as a singular position.
    pub fn of(&mut self, field: &mut Accelerations<S>, scale: &Scale) -> f64 {
        let nv = field.numbering.velocities();
        let speeds = Speeds::without_states([scale.length, 1.0]);
        let mut sum = 0.0;
        for probe in 0..PROBES {
            let (upper, lower) = self.rhs.split_at_mut(nv);
            upper.fill(S::zero());
            field.rates_of_joints(scale.length, |k| irregular(PROBES * k + probe), lower);
            field.solve(&mut self.rhs);
            sum += scale.square(field.numbering, &self.still, &self.rhs[..nv], &speeds);
        }
        (PROBES as f64 / sum).sqrt()
    }

    /// Factor by which a steadiness `s` magnifies errors, relative to the best end so far.
    pub fn magnified(&self, s: f64) -> f64 {
        (self.largest / s).max(1.0)
    }

    /// Records the steadiness `s` at the fraction `at` of the duration.
    pub fn see(&mut self, at: f64, s: f64) {
        self.largest = self.largest.max(s);
        self.last = [Some((at, s)), self.last[0]];
    }

    /// The zero of the steadiness, if it is `s` at the fraction `at` and the motion approaches a
    /// zero; from the parabola through the last three ends.
    pub fn foresee(&self, at: f64, s: f64) -> Option<f64> {
        let (t1, s1) = self.last[0].filter(|(_, s1)| s < *s1 && s < NEAR * self.largest)?;
        let slope = (s - s1) / (at - t1);
        let bent = self.last[1].map_or(0.0, |(t0, s0)| {
            ((slope - (s1 - s0) / (t1 - t0)) / (at - t0)).min(0.0)
        });
        let slope = slope + bent * (at - t1);
        Some(at + 2.0 * s / (-slope + (slope * slope - 4.0 * bent * s).sqrt()))
    }

    /// Whether a step from the last end to `at` ends too close to the zero of the steadiness.
    pub fn too_close(&self, at: f64, vanishes: f64) -> bool {
        let from = self.last[0].map_or(0.0, |(t1, _)| t1);
        vanishes - at < AWAY * (at - from)
    }

    /// Whether a given step to an end with steadiness `s` fails: it is near a singular position,
    /// and its error is much larger than the `largest` before.
    pub fn errs(&self, s: f64, error: f64, largest: f64) -> bool {
        let from = self.last[0].map_or(s, |(_, s1)| s1);
        self.magnified(s.min(from)) > SUSPICIOUS && error > ERROR.max(MORE_ERROR * largest)
    }
}

/// A number of either sign with absolute value from 0.5 to 1.5, a function of `n` without linear
/// relations: the finaliser of SplitMix64 (Steele, Lea & Flood 2014). Multiples of an irrational
/// number have relations: u₁ − u₃ − u₅ + u₇ = 0 is the dependent combination of rows where the bars
/// of a parallelogram are in line.
pub fn irregular(n: usize) -> f64 {
    let mut x = (n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    let fraction = (x >> 11) as f64 / (1_u64 << 53) as f64;
    let sign = if x & 1 == 0 { 1.0 } else { -1.0 };
    sign * (0.5 + fraction)
}

/// Largest magnification at the end of a step, by the tolerance of adaptive steps.
pub fn most(tolerance: Option<f64>) -> f64 {
    match tolerance {
        Some(tolerance) => {
            let noise = NOISE * tolerance.max(LEAST);
            (noise / f64::EPSILON).cbrt().min(MOST)
        }
        None => MOST_GIVEN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_of_the_steadiness_is_foreseen() {
        let mut seen: Steadiness<f64> = Steadiness {
            largest: 0.0,
            last: [None, None],
            rhs: Vec::new(),
            still: Vec::new(),
        };
        // The zero is at 1, for a line and for a parabola.
        for bent in [0.0, 0.3] {
            seen.last = [None, None];
            let s = |t: f64| (1.0 - t) * (1.0 + bent * t);
            seen.see(0.0, s(0.0));
            assert_eq!(seen.foresee(0.1, s(0.1)), None);
            seen.see(0.5, s(0.5));
            let foreseen = seen.foresee(0.75, s(0.75)).expect("close");
            assert!((foreseen - 1.0).abs() < 1e-14, "{foreseen}");
            assert!(!seen.too_close(0.75, foreseen) && seen.too_close(0.95, foreseen));
            seen.see(0.75, s(0.75));
            // An increasing steadiness has no zero ahead.
            assert_eq!(seen.foresee(1.25, 0.4), None);
        }
        assert_eq!(seen.magnified(0.1), 10.0);
    }

    #[test]
    fn small_tolerances_keep_away_further() {
        assert!(most(Some(1e-13)) < most(Some(1e-9)));
        assert_eq!(most(Some(1e-3)), MOST);
    }
}
