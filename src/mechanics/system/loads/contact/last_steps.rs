//! The last steps of Newton's method, which are in the scalar.
//!
//! A step that changes the solution by e leaves an error of O(e²), and its infinitesimal part one of O(e). So the last step must be
//! round-off, which takes more than two where the matrix is nearly singular.

/// Fewest and most steps.
const FEWEST: usize = 2;
const MOST: usize = 8;
/// A step below this part of the unknown is round-off.
const ROUND_OFF: f64 = 1e-13;
/// Steps that do not fall by this are round-off too.
const FALLS: f64 = 0.5;

/// Improves `x` by `next`, which gives another x and the size of its step relative to that of x; `None` where it is not finite.
pub(super) fn last_steps<X>(mut x: X, next: impl Fn(&X) -> Option<(X, f64)>) -> X {
    let mut before = f64::INFINITY;
    for step in 1..=MOST {
        let Some((better, size)) = next(&x) else {
            break;
        };
        if step > FEWEST && size > FALLS * before {
            break;
        }
        x = better;
        if step >= FEWEST && size <= ROUND_OFF {
            break;
        }
        before = size;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::last_steps;
    use crate::math::Dual;
    use std::cell::Cell;

    /// x² = a near its double root has the derivative 1 / 2x, also where the search has left an error.
    #[test]
    fn derivatives_near_a_double_root_are_exact() {
        for root in [1.0, 1e-3, 1e-6] {
            let a = Dual::new(root * root, 1.0);
            let steps = Cell::new(0);
            let next = |x: &Dual| {
                steps.set(steps.get() + 1);
                let by = (a - *x * *x) / (*x * 2.0);
                Some((*x + by, (by.re / x.re).abs()))
            };
            let x = last_steps(Dual::from(root + 1e-3 * root), next);
            assert!((x.re - root).abs() <= 1e-15 * root);
            assert!((x.du * 2.0 * root - 1.0).abs() < 1e-12, "{root}");
            assert!(steps.get() <= 5);
        }
    }

    #[test]
    fn steps_that_are_not_finite_or_do_not_fall_end() {
        assert_eq!(last_steps(1.0, |_| None), 1.0);
        // Two steps always count.
        assert_eq!(last_steps(0.0, |x| Some((x + 1.0, 1.0))), 2.0);
    }
}
