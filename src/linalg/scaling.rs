//! Scaling of the rows and columns of a matrix before elimination.

use super::matrix::SparseMatrix;
use super::pattern::Pattern;
use crate::math::Scalar;

/// Largest exponent of a scale, and largest exponent that needs no scale.
const MOST: f64 = 500.0;
const MODERATE: f64 = 8.0;

/// Diagonal matrices R and C of powers of two. R A C has rows and columns with similar largest
/// entries, so pivoting does not depend on units (Golub & Van Loan 2013, section 3.5.2). Powers of
/// two cause no round-off. Largest entries from 2⁻⁸ to 2⁸ are not scaled, others are brought to
/// [1/2, 1].
#[derive(Clone, Debug)]
pub(super) struct Equilibration {
    /// R.
    pub rows: Vec<f64>,
    /// C.
    pub columns: Vec<f64>,
    /// Factor of each entry.
    pub entries: Vec<f64>,
}

impl Equilibration {
    /// The identity.
    pub(crate) fn new(pattern: &Pattern) -> Self {
        Self {
            rows: vec![1.0; pattern.order()],
            columns: vec![1.0; pattern.order()],
            entries: vec![1.0; pattern.entries()],
        }
    }

    /// Copies another scaling of the same pattern.
    pub(crate) fn set(&mut self, other: &Self) {
        self.rows.copy_from_slice(&other.rows);
        self.columns.copy_from_slice(&other.columns);
        self.entries.copy_from_slice(&other.entries);
    }

    /// Scales for a matrix: first its rows, then the columns of the result.
    pub(crate) fn fit<S: Scalar>(&mut self, matrix: &SparseMatrix<S>) {
        let pattern = &matrix.pattern;
        self.rows.fill(0.0);
        for (&row, &value) in pattern.rows().iter().zip(&matrix.values) {
            self.rows[row] = self.rows[row].max(size(value));
        }
        for row in &mut self.rows {
            *row = scale(*row);
        }
        let starts = pattern.column_starts().windows(2);
        for (column, own) in self.columns.iter_mut().zip(starts) {
            let own = own[0]..own[1];
            let mut largest = 0.0_f64;
            for k in own.clone() {
                self.entries[k] = self.rows[pattern.rows()[k]];
                largest = largest.max(size(matrix.values[k]) * self.entries[k]);
            }
            *column = scale(largest);
            for entry in &mut self.entries[own] {
                *entry *= *column;
            }
        }
    }
}

/// Size of a number in pivoting, |Re x| + |Im x|; NaN for NaN.
pub(super) fn size<S: Scalar>(x: S) -> f64 {
    x.re().abs() + x.infinitesimal().abs()
}

/// The power of two that brings `largest` to [1/2, 1]; 1 if this is not needed or not possible.
fn scale(largest: f64) -> f64 {
    if !(largest > 0.0 && largest.is_finite()) {
        return 1.0;
    }
    let exponent = largest.log2().floor() + 1.0;
    if exponent.abs() <= MODERATE {
        1.0
    } else {
        (-exponent).clamp(-MOST, MOST).exp2()
    }
}
