//! Broyden's method with kept factors (Broyden 1965; Kelley 1995, section 7.3): the steps of an iteration
//! correct the inverse of the iteration matrix.
//!
//! With z = −B⁻¹ F by the factors B and the steps s_0 … s_n so far, the next step is
//!
//! ```text
//! z ← z + s_j+1 (s_j · z) / (s_j · s_j),  j = 0 … n − 1,        s_n+1 = z / (1 − (s_n · z) / (s_n · s_n))
//! ```

use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};

/// Largest correction of a step by the next one, relative to it.
const MOST: f64 = 0.7;

/// The steps of an iteration. Their memory is kept.
#[derive(Debug)]
pub(super) struct Broyden<S> {
    steps: Vec<Vec<S>>,
    squares: Vec<S>,
    count: usize,
}

impl<S: Scalar> Broyden<S> {
    /// No steps yet.
    pub(super) fn new() -> Self {
        Self {
            steps: Vec::new(),
            squares: Vec::new(),
            count: 0,
        }
    }

    /// Forgets all steps.
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Turns the step z by the kept factors, in parts, into the next step.
    pub(super) fn correct(&mut self, z: &mut [Vec<S>]) {
        let known = self.steps[..self.count].iter().zip(&self.squares);
        for (j, (step, &square)) in known.enumerate() {
            if square.re() == 0.0 {
                continue;
            }
            let part = inner(step, z) / square;
            if j + 1 < self.count {
                let mut next = &self.steps[j + 1][..];
                for z in &mut *z {
                    let (own, rest) = next.split_at(z.len());
                    add_scaled(z, part, own);
                    next = rest;
                }
            } else {
                let missing = part.re().clamp(-MOST, MOST);
                let by = S::from(1.0 / (1.0 - missing));
                z.iter_mut().flatten().for_each(|z| *z *= by);
            }
        }
        if self.count == self.steps.len() {
            self.steps.push(Vec::new());
            self.squares.push(S::zero());
        }
        let own = &mut self.steps[self.count];
        own.clear();
        z.iter().for_each(|z| own.extend_from_slice(z));
        self.squares[self.count] = inner(own, z);
        self.count += 1;
    }
}

/// The work since the factors were made, by which they are renewed when that is cheaper.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// Number of steps.
    steps: usize,
    /// Iterations of these steps.
    iterations: usize,
}

impl Pace {
    /// Counts a step.
    pub fn count(&mut self, iterations: usize) {
        self.steps += 1;
        self.iterations += iterations;
    }

    /// Counts a step. Returns whether its iterations were more than the mean cost of a step, with that of the
    /// factors, which is that of `factors` iterations: then the next steps are cheaper with new ones.
    pub fn is_lost(&mut self, iterations: usize, factors: usize) -> bool {
        self.count(iterations);
        iterations * self.steps > factors + self.iterations
    }
}

/// The inner product of a vector with the parts of another.
fn inner<S: Scalar>(mut x: &[S], parts: &[Vec<S>]) -> S {
    let mut sum = S::zero();
    for part in parts {
        let (own, rest) = x.split_at(part.len());
        sum += dot(own, part);
        x = rest;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F(x) = A x − b of order n: the method ends after at most 2 n steps (Gay 1979), and much earlier than
    /// the kept matrix alone.
    #[test]
    fn linear_equations_end_after_few_steps() {
        let a = [
            [2.0, 0.3, -0.4, 0.1],
            [0.2, 1.5, 0.5, -0.3],
            [-0.1, 0.4, 1.2, 0.2],
            [0.3, -0.2, 0.1, 1.8],
        ];
        let b = [1.0, -2.0, 0.5, 3.0];
        let iterate = |corrected: bool| {
            let (mut x, mut broyden) = ([0.0_f64; 4], Broyden::new());
            for count in 1..=200 {
                let by_kept = |i: usize| {
                    let ax: f64 = a[i].iter().zip(&x).map(|(a, x)| a * x).sum();
                    // The kept matrix is 1.4 times the identity.
                    (b[i] - ax) / 1.4
                };
                let mut z = [(0..3).map(by_kept).collect(), vec![by_kept(3)]];
                if corrected {
                    broyden.correct(&mut z);
                }
                let all = || z.iter().flatten();
                x.iter_mut().zip(all()).for_each(|(x, z)| *x += z);
                if all().all(|z| z.abs() < 1e-13) {
                    return count;
                }
            }
            200
        };
        let (corrected, plain) = (iterate(true), iterate(false));
        assert!(corrected <= 10 && plain > 30, "{corrected} {plain}");
    }
}
