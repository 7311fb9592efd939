//! Symmetric positive definite matrices in envelope storage: each row from its first entry to the
//! diagonal.

use super::dense::SINGULAR;
use crate::math::Scalar;
use crate::math::slices::dot;

/// A = L D Lᵀ in its envelope (Jennings 1966): L below the diagonal, D⁻¹ on the diagonal.
#[derive(Clone)]
pub(super) struct Envelope<S> {
    /// Column of the first entry of each row.
    first: Vec<usize>,
    /// Index of the first entry of each row.
    start: Vec<usize>,
    entries: Vec<S>,
    /// By row: size of the terms whose difference is the diagonal entry.
    sizes: Vec<f64>,
}

impl<S: Scalar> Envelope<S> {
    /// A matrix whose row i starts in column `first[i]`.
    pub fn new(first: Vec<usize>) -> Self {
        let mut start = vec![0];
        for (row, first) in first.iter().enumerate() {
            start.push(start[row] + row + 1 - first);
        }
        Self {
            entries: vec![S::zero(); start[first.len()]],
            sizes: vec![0.0; first.len()],
            start,
            first,
        }
    }

    /// Number of operations of a decomposition.
    pub fn operations(&self) -> usize {
        let row = |(row, &first): (usize, &usize)| {
            let column = |column: usize| 2 * (column - first.max(self.first[column]));
            (first..=row).map(column).sum::<usize>()
        };
        self.first.iter().enumerate().map(row).sum()
    }

    /// Sets all entries to zero.
    pub fn clear(&mut self) {
        self.entries.fill(S::zero());
    }

    /// Sets an entry of the lower triangle. For a diagonal entry, `size` is the size of the terms
    /// whose difference it is.
    pub fn set(&mut self, row: usize, column: usize, value: S, size: f64) {
        self.entries[self.start[row] + column - self.first[row]] = value;
        if row == column {
            self.sizes[row] = size;
        }
    }

    /// Decomposes in place.
    ///
    /// # Errors
    /// The row whose pivot has lost too many digits.
    pub fn decompose(&mut self) -> Result<(), usize> {
        for i in 0..self.first.len() {
            let first = self.first[i];
            let (above, rest) = self.entries.split_at_mut(self.start[i]);
            let row = &mut rest[..=i - first];
            // row[j] = L_ij D_j after its reduction.
            for j in first..i {
                let other = &above[self.start[j]..self.start[j + 1]];
                let from = first.max(self.first[j]);
                let l = &other[from - self.first[j]..j - self.first[j]];
                let sum = dot(&row[from - first..j - first], l);
                row[j - first] -= sum;
            }
            let mut pivot = row[i - first];
            for j in first..i {
                let scaled = row[j - first];
                let l = scaled * above[self.start[j + 1] - 1];
                pivot -= scaled * l;
                row[j - first] = l;
            }
            if pivot.re() <= SINGULAR * self.sizes[i] || !pivot.is_finite() {
                return Err(i);
            }
            row[i - first] = S::one() / pivot;
        }
        Ok(())
    }

    /// Solves A x = b in place.
    pub fn solve(&self, b: &mut [S]) {
        let row = |i: usize| &self.entries[self.start[i]..self.start[i + 1]];
        for i in 0..b.len() {
            let (known, rest) = b.split_at_mut(i);
            rest[0] -= dot(&known[self.first[i]..], row(i));
        }
        for (i, b) in b.iter_mut().enumerate() {
            *b *= self.entries[self.start[i + 1] - 1];
        }
        for i in (0..b.len()).rev() {
            let (rest, known) = b.split_at_mut(i);
            for (x, &l) in rest[self.first[i]..].iter_mut().zip(row(i)) {
                *x -= l * known[0];
            }
        }
    }
}
