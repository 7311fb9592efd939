//! Matrices as files write them: entries with a number of digits. Rounding changes an entry by up
//! to half a unit of its last digit. Entries of slender bodies cancel in slow motions, so a
//! relative error of 1e-5 in each may be one of 1 in the stiffness of a mode. The effect of
//! rounding on a quadratic form is its standard deviation,
//!
//! ```text
//! s² = ⅓ Σ_ij (δ_ij x_i x_j)²,     δ_ij half a unit of the last digit of K_ij,
//! ```
//!
//! if errors are independent and spread evenly over ±δ.

use crate::linalg::cholesky::SymmetricPattern;

/// An entry of a symmetric matrix: the keys 6 × node + component of row and column, and its value.
/// Each pair of keys occurs once.
pub type Entry = (usize, usize, f64);

/// A symmetric matrix of a file.
#[derive(Clone, Debug, Default)]
pub struct WrittenMatrix {
    /// Each pair of keys once.
    pub entries: Vec<Entry>,
    /// By entry: largest change by rounding.
    pub rounding: Vec<f64>,
}

impl WrittenMatrix {
    /// Multiplies entries by factors that depend on the keys.
    pub fn scale(&mut self, factor: impl Fn(usize, usize) -> f64) {
        for ((i, j, value), rounding) in self.entries.iter_mut().zip(&mut self.rounding) {
            let factor = factor(*i, *j);
            *value *= factor;
            *rounding *= factor;
        }
    }

    /// The roundings of entries that are not zero, as entries.
    pub fn roundings(&self) -> Vec<Entry> {
        let both = self.entries.iter().zip(&self.rounding);
        both.filter(|(entry, _)| entry.2 != 0.0)
            .map(|(&(i, j, _), &rounding)| (i, j, rounding))
            .collect()
    }
}

/// Standard deviation of xᵀ K x by the rounding of K.
pub fn deviation(pattern: &SymmetricPattern, rounding: &[f64], x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (j, &xj) in x.iter().enumerate() {
        for (slot, i) in pattern.column(j) {
            let twice = if i == j { 1.0 } else { 2.0 };
            sum += (twice * rounding[slot] * x[i] * xj).powi(2);
        }
    }
    (sum / 3.0).sqrt()
}
