//! Scaling of the rows and columns of a matrix before elimination.

use super::matrix::SparseMatrix;
use super::pattern::Pattern;
use crate::math::Scalar;

/// Largest exponent of a scale, and largest exponent that needs no scale.
const MOST: i64 = 500;
const MODERATE: i64 = 8;

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
}

impl Equilibration {
    /// The identity.
    pub fn new(pattern: &Pattern) -> Self {
        Self {
            rows: vec![1.0; pattern.order()],
            columns: vec![1.0; pattern.order()],
        }
    }

    /// Copies another scaling of the same pattern.
    pub fn set(&mut self, other: &Self) {
        self.rows.copy_from_slice(&other.rows);
        self.columns.copy_from_slice(&other.columns);
    }

    /// Scales for a matrix: first its rows, then the columns of the result. `scaled` becomes the values of R A C.
    pub fn fit<S: Scalar>(&mut self, matrix: &SparseMatrix<S>, scaled: &mut [S]) {
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
            let entries = pattern.rows()[own.clone()]
                .iter()
                .zip(&matrix.values[own.clone()]);
            let scaled = &mut scaled[own];
            for ((&row, &value), scaled) in entries.zip(&mut *scaled) {
                *scaled = value * self.rows[row];
                largest = largest.max(size(*scaled));
            }
            *column = scale(largest);
            if *column != 1.0 {
                scaled.iter_mut().for_each(|x| *x *= S::from(*column));
            }
        }
    }
}

/// Size of a number in pivoting, |Re x| + |Im x|; NaN for NaN.
pub(super) fn size<S: Scalar>(x: S) -> f64 {
    x.re().abs() + x.infinitesimal().abs()
}

impl<S: Scalar> SparseMatrix<S> {
    /// The sizes of all entries: with those of x, their product is the size of the terms of A x.
    pub fn sizes(&self) -> SparseMatrix<f64> {
        let mut out = SparseMatrix::new(self.pattern.clone());
        out.values = self.values.iter().map(|&x| size(x)).collect();
        out
    }
}

/// The power of two that brings `largest` to [1/2, 1]; 1 if this is not needed or not possible.
fn scale(largest: f64) -> f64 {
    if !(largest > 0.0 && largest.is_finite()) {
        return 1.0;
    }
    // A double is 2^(its exponent bits − 1023) times a number from 1 to 2.
    let exponent = (largest.to_bits() >> 52) as i64 - 1022;
    if exponent.abs() <= MODERATE {
        return 1.0;
    }
    let scale = (-exponent).clamp(-MOST, MOST);
    f64::from_bits(((1023 + scale) as u64) << 52)
}
