//! Records of vectors in contiguous memory.

use crate::math::Complex64;

/// Records of N vectors each. All records have the same lengths.
#[derive(Clone, Debug)]
pub struct Rows<S, const N: usize> {
    lengths: [usize; N],
    data: Vec<S>,
    count: usize,
}

impl<S: Copy, const N: usize> Rows<S, N> {
    /// No records.
    pub fn new(lengths: [usize; N]) -> Self {
        Self {
            lengths,
            data: Vec::new(),
            count: 0,
        }
    }

    /// Lengths of the vectors of a record.
    pub fn lengths(&self) -> [usize; N] {
        self.lengths
    }

    /// Total length of a record.
    pub fn width(&self) -> usize {
        self.lengths.iter().sum()
    }

    /// Reserves memory for `count` more records.
    pub fn reserve(&mut self, count: usize) {
        self.data.reserve_exact(count * self.width());
    }

    /// Adds a record.
    ///
    /// # Panics
    /// A vector has another length.
    pub fn push(&mut self, record: [&[S]; N]) {
        assert_eq!(record.map(<[S]>::len), self.lengths);
        for part in record {
            self.data.extend_from_slice(part);
        }
        self.count += 1;
    }

    /// Removes all records and keeps their memory.
    pub fn restart(&mut self) {
        self.data.clear();
        self.count = 0;
    }

    /// Total length of all records.
    pub fn numbers(&self) -> usize {
        self.data.len()
    }

    /// Record k.
    ///
    /// # Panics
    /// There is no record k.
    pub fn get(&self, k: usize) -> [&[S]; N] {
        let mut rest = &self.data[k * self.width()..(k + 1) * self.width()];
        self.lengths.map(|length| {
            let (part, after) = rest.split_at(length);
            rest = after;
            part
        })
    }
}

impl<const N: usize> Rows<Complex64, N> {
    /// The real part.
    pub fn real(&self) -> Rows<f64, N> {
        Rows {
            lengths: self.lengths,
            data: real(&self.data),
            count: self.count,
        }
    }
}

/// Real parts.
pub(super) fn real(all: &[Complex64]) -> Vec<f64> {
    all.iter().map(|x| x.re).collect()
}
