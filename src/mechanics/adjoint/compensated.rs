//! Compensated sums of many small changes.

/// A vector as an unevaluated sum of two vectors. Small changes keep all their digits (Kahan 1965;
/// Knuth's two-sum).
#[derive(Clone, Debug)]
pub(super) struct Compensated {
    /// The vector to working precision.
    pub value: Vec<f64>,
    rest: Vec<f64>,
}

impl Compensated {
    /// A vector of zeros.
    pub fn zero(n: usize) -> Self {
        Self {
            value: vec![0.0; n],
            rest: vec![0.0; n],
        }
    }

    /// Adds `scale` times `x`.
    pub fn add(&mut self, scale: f64, x: &[f64]) {
        for ((value, rest), &x) in self.value.iter_mut().zip(&mut self.rest).zip(x) {
            let change = scale * x + *rest;
            let sum = *value + change;
            let back = sum - *value;
            *rest = (*value - (sum - back)) + (change - back);
            *value = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_changes_add_up() {
        let mut sum = Compensated::zero(1);
        sum.add(1.0, &[1.0]);
        for _ in 0..1_000_000 {
            sum.add(1e-7, &[1e-10]);
        }
        sum.add(-1.0, &[1.0]);
        assert!(
            (sum.value[0] / 1e-11 - 1.0).abs() < 1e-6,
            "{:e}",
            sum.value[0]
        );
    }
}
