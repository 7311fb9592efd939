//! A derivative that is computed twice, and how the two values compare.

use super::evaluate::Derivative;
use crate::problem::Problem;

/// A derivative below this part of its terms has lost digits by cancellation.
const SMALL: f64 = 1e-3;
/// Relative noise of a derivative up to which it counts as exact.
const LITTLE: f64 = 1e-8;
/// A derivative below this part of its terms is zero if it is uncertain by more than that part of it.
const NOTHING: f64 = 1e-10;
const UNCERTAIN: f64 = 1e-2;
/// Largest part of its terms by which round-off of the motion may change a small derivative, and how many times the change
/// between two motions that is.
const MOVED: f64 = 1e-12;
const SEVERAL: f64 = 8.0;
/// The least change of a variable, over its scale, to which round-off of a function is related.
const LEAST: f64 = 1e-4;

/// One derivative, computed twice.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedDerivative {
    /// Function, by index.
    pub function: usize,
    /// Variable, by index.
    pub variable: usize,
    /// By the discrete adjoint, on the motion of the complex step.
    pub adjoint: f64,
    /// By the complex step.
    pub complex_step: f64,
    /// Sum of the sizes of the terms of the adjoint's derivative. Or, if larger, the function's
    /// largest derivative (each variable in its scale), or the function's size by a change of the variable
    /// to which its round-off belongs.
    pub terms: f64,
    /// By the discrete adjoint, on the motion that an optimisation would see. The two motions
    /// differ by round-off, which a sensitive motion magnifies. None at rest, where both are the same solution.
    pub in_use: Option<f64>,
}

/// How the two values of a derivative compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Both are zero but for round-off.
    Nothing,
    /// They agree to the tolerance.
    Agree,
    /// They differ by round-off of larger terms, and the derivative itself is small.
    RoundOff,
    /// They differ by what Newton's method leaves.
    Noise,
    /// They differ.
    Differ,
}

impl CheckedDerivative {
    /// How its values compare, by a relative tolerance.
    pub fn verdict(&self, tolerance: f64) -> Verdict {
        if self.is_round_off() {
            Verdict::Nothing
        } else if self.relative_difference() <= tolerance {
            Verdict::Agree
        } else if self.differs_by_round_off() {
            Verdict::RoundOff
        } else if self.differs_by_noise() {
            Verdict::Noise
        } else {
            Verdict::Differ
        }
    }

    /// |adjoint − complex step| relative to the complex step; to the terms if that is zero.
    pub fn relative_difference(&self) -> f64 {
        self.relative(self.adjoint, self.complex_step)
    }

    fn relative(&self, x: f64, exact: f64) -> f64 {
        let size = match exact == 0.0 {
            true => self.terms,
            false => exact.abs(),
        };
        match (x - exact).abs() {
            0.0 => 0.0,
            difference => difference / size,
        }
    }

    /// Whether the derivative is only the round-off of cancelling terms: both values are below 64 ε
    /// times the terms. Or they are below 1e-10 of these, and motions that differ by round-off change more than a hundredth
    /// of the derivative, or the adjoint is exactly zero, as of a motion that drives and welds determine.
    pub fn is_round_off(&self) -> bool {
        // Comparisons with NaN are false.
        let below = |most: f64| self.adjoint.abs() <= most && self.complex_step.abs() <= most;
        let nothing = self.adjoint == 0.0 && self.in_use.is_none_or(|x| x == 0.0);
        let is_moved = || self.moved().is_some_and(|moved| below(moved / UNCERTAIN));
        below(self.round_off()) || below(NOTHING * self.terms) && (nothing || is_moved())
    }

    /// Whether the derivative is below 1e-3 of its terms and its two values differ by at most their
    /// round-off: 64 ε times the terms, and what round-off of the motion changes, up to 1e-12 of the terms. At rest, where
    /// nothing tells how much that is, 1e-12 of the terms.
    pub fn differs_by_round_off(&self) -> bool {
        let small = self.complex_step.abs() <= SMALL * self.terms;
        let largest = MOVED * self.terms;
        let by_motion = self.moved().map_or(largest, |x| largest.min(SEVERAL * x));
        small && (self.adjoint - self.complex_step).abs() <= self.round_off() + by_motion
    }

    /// Whether its two values differ by no more than what Newton's method leaves, and that is little.
    fn differs_by_noise(&self) -> bool {
        let noise = self.noise();
        self.complex_step != 0.0 && self.relative_difference() <= noise && noise <= LITTLE
    }

    fn round_off(&self) -> f64 {
        64.0 * f64::EPSILON * self.terms
    }

    /// What round-off of the motion changes.
    fn moved(&self) -> Option<f64> {
        Some((self.in_use? - self.adjoint).abs())
    }

    /// Relative change of the derivative by round-off in the motion.
    pub fn noise(&self) -> f64 {
        (self.in_use).map_or(0.0, |in_use| self.relative(in_use, self.adjoint))
    }
}

/// The derivatives of the function f, of this size, in all variables at the design x. `others` are the complex step and the
/// adjoint in use, by variable.
///
/// Round-off reaches small derivatives from three sides: their terms, the largest derivatives of the function, from which that
/// of the motion comes, and the last digits of the function itself.
pub(super) fn checked_row(
    (problem, x): (&Problem, &[f64]),
    (function, size): (usize, f64),
    adjoint: &[Derivative],
    others: impl Fn(usize) -> (f64, Option<f64>),
) -> Vec<CheckedDerivative> {
    let scaled = adjoint.iter().zip(&problem.variables);
    let largest = scaled.fold(0.0_f64, |m, (d, own)| m.max((d.value * own.scale).abs()));
    let one = |(variable, d): (usize, &Derivative)| {
        let scale = problem.variables[variable].scale;
        let by_size = size / change_of(x[variable], scale);
        let (complex_step, in_use) = others(variable);
        CheckedDerivative {
            function,
            variable,
            adjoint: d.value,
            complex_step,
            terms: d.terms.max(largest / scale).max(by_size),
            in_use,
        }
    };
    adjoint.iter().enumerate().map(one).collect()
}

/// The change of a variable to which the round-off of a function belongs: the variable's own size, as terms that cancel are in
/// proportion to powers of it, and between 1e-4 of its scale and the scale.
fn change_of(x: f64, scale: f64) -> f64 {
    match x.abs() {
        0.0 => scale,
        x => x.clamp(LEAST * scale, scale),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small derivative may differ by the last digits of large ones, and by no more.
    #[test]
    fn a_difference_is_judged_by_the_terms() {
        let pair = |adjoint: f64, complex_step: f64| CheckedDerivative {
            function: 0,
            variable: 0,
            adjoint,
            complex_step,
            terms: 1.0,
            in_use: Some(adjoint),
        };
        let noisy = |in_use: f64| CheckedDerivative {
            in_use: Some(in_use),
            ..pair(1.0 + 1e-10, 1.0)
        };
        assert!(noisy(1.0 + 3e-10).differs_by_noise());
        assert!(!noisy(1.0 + 1e-10).differs_by_noise() && !noisy(1.1).differs_by_noise());
        // Less than round-off of the terms could leave, and not the same in two motions.
        let nearly = |in_use: f64| CheckedDerivative {
            in_use: Some(in_use),
            ..pair(3e-12, 1e-30)
        };
        assert!(nearly(2e-12).is_round_off());
        assert!(!nearly(3e-12).is_round_off() && nearly(3e-12).verdict(1e-10) == Verdict::Differ);
        // A zero is related to the terms, whatever their units.
        for size in [1e-9, 1.0, 1e9] {
            let zero = |part: f64| CheckedDerivative {
                terms: size,
                ..pair(part * size, 0.0)
            };
            assert_eq!(zero(1e-11).verdict(1e-10), Verdict::Agree);
            assert_eq!(zero(1e-2).verdict(1e-10), Verdict::Differ);
        }
        for (a, b) in [(f64::NAN, 0.0), (0.0, f64::NAN)] {
            assert_eq!(pair(a, b).verdict(1e-10), Verdict::Differ);
        }
        let of_nothing = CheckedDerivative {
            in_use: Some(1e-9),
            ..pair(1e-9 + 1e-18, 0.0)
        };
        assert!(!of_nothing.differs_by_noise());
        let small = pair(1e-12 + 5e-15, 1e-12);
        assert!(!small.is_round_off() && small.differs_by_round_off());
        assert!(small.relative_difference() > 1e-3);
        let wrong = pair(1e-12 + 5e-14, 1e-12);
        assert!(!wrong.is_round_off() && !wrong.differs_by_round_off());
        // What two motions differ by is no fault, if little is left of large terms.
        let settled = |difference: f64| CheckedDerivative {
            in_use: Some(1e-8 + 5e-14),
            ..pair(1e-8 + difference, 1e-8)
        };
        assert!(settled(1e-13).differs_by_round_off() && !settled(2e-12).differs_by_round_off());
        // At rest there is no other motion.
        let at_rest = |difference: f64| CheckedDerivative {
            in_use: None,
            ..pair(1e-8 + difference, 1e-8)
        };
        assert!(at_rest(8e-13).differs_by_round_off() && !at_rest(2e-12).differs_by_round_off());
        let nothing = pair(1e-15, -1e-15);
        assert!(nothing.is_round_off() && nothing.differs_by_round_off());
        assert!(!pair(f64::NAN, 0.0).differs_by_round_off());
        // A derivative that is not small has all its digits.
        assert!(!pair(0.1 + 5e-15, 0.1).differs_by_round_off());
    }
}
