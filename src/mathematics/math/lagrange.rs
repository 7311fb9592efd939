//! Polynomials through nodes, by Lagrange's formula.

use super::Scalar;

/// Weight of the value at node j in the value at `at` of the polynomial through `count` nodes at `place`.
pub fn weight<S: Scalar>(count: usize, place: impl Fn(usize) -> f64, at: S, j: usize) -> S {
    let others = (0..count).filter(|&i| i != j);
    others.fold(S::one(), |w, i| w * (at - place(i)) / (place(j) - place(i)))
}

/// Weight of the value at node j in the derivative at `at` of that polynomial.
pub fn slope(count: usize, place: impl Fn(usize) -> f64, at: f64, j: usize) -> f64 {
    let one = |m: usize| {
        let others = (0..count).filter(|&i| i != j && i != m);
        let factor = 1.0 / (place(j) - place(m));
        others.fold(factor, |w, i| w * (at - place(i)) / (place(j) - place(i)))
    };
    (0..count).filter(|&m| m != j).map(one).sum()
}

#[cfg(test)]
mod tests {
    use super::{slope, weight};

    #[test]
    fn a_cubic_is_exact() {
        let nodes = [-0.3, 0.1, 0.4, 1.1];
        let (at, cubic) = (0.27, |x: f64| 2.0 * x * x * x - x + 0.5);
        let place = |i: usize| nodes[i];
        let value: f64 = (0..4)
            .map(|j| weight(4, place, at, j) * cubic(nodes[j]))
            .sum();
        let rate: f64 = (0..4)
            .map(|j| slope(4, place, at, j) * cubic(nodes[j]))
            .sum();
        assert!((value - cubic(at)).abs() < 1e-15);
        assert!((rate - (6.0 * at * at - 1.0)).abs() < 1e-14);
    }
}
