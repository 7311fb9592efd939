//! Records of vectors in contiguous memory.

use crate::math::{Complex64, Packed, Team};
use std::borrow::Cow;
use std::ops::Range;

/// Records of N vectors each. All records have the same lengths.
#[derive(Clone, Debug)]
pub struct Rows<S, const N: usize> {
    lengths: [usize; N],
    team: Team,
    data: Vec<S>,
}

impl<S: Copy, const N: usize> Rows<S, N> {
    /// No records, to be kept whole.
    pub fn new(lengths: [usize; N]) -> Self {
        Self::over(&Team::default(), lengths)
    }

    /// No records, of which each rank of a team keeps its share.
    pub fn over(team: &Team, lengths: [usize; N]) -> Self {
        Self {
            lengths,
            team: team.clone(),
            data: Vec::new(),
        }
    }

    /// The numbers of a record that are kept here.
    fn kept(&self) -> Range<usize> {
        self.team.share(0..self.width())
    }

    /// How many numbers of a record a rank keeps at most.
    pub fn most_kept(&self) -> usize {
        self.width().div_ceil(self.team.ranks())
    }

    /// The ranks that keep them.
    pub fn team(&self) -> &Team {
        &self.team
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
        self.data.reserve_exact(count * self.kept().len());
    }

    /// Adds a record.
    ///
    /// # Panics
    /// A vector has another length.
    pub fn push(&mut self, record: [&[S]; N]) {
        assert_eq!(record.map(<[S]>::len), self.lengths);
        let kept = self.kept();
        let mut before = 0;
        for part in record {
            let inside = |at: usize| at.clamp(before, before + part.len()) - before;
            self.data
                .extend_from_slice(&part[inside(kept.start)..inside(kept.end)]);
            before += part.len();
        }
    }

    /// Removes all records and keeps their memory.
    pub fn restart(&mut self) {
        self.data.clear();
    }

    /// How many numbers are kept.
    pub fn numbers(&self) -> usize {
        self.data.len()
    }

    /// Record k of those that are kept whole.
    ///
    /// # Panics
    /// There is no record k, or it is spread.
    pub fn get(&self, k: usize) -> [&[S]; N] {
        self.vectors(&self.data[k * self.width()..(k + 1) * self.width()])
    }

    /// The vectors of a record.
    pub fn vectors<'a>(&self, record: &'a [S]) -> [&'a [S]; N] {
        let mut rest = record;
        self.lengths.map(|length| {
            let (part, after) = rest.split_at(length);
            rest = after;
            part
        })
    }
}

impl<S: Copy + Packed, const N: usize> Rows<S, N> {
    /// Record k. All ranks of the team ask for the same.
    ///
    /// # Panics
    /// There is no record k.
    pub fn record(&self, k: usize) -> Cow<'_, [S]> {
        let length = self.kept().len();
        let own = &self.data[k * length..(k + 1) * length];
        match self.team.is_alone() {
            true => Cow::Borrowed(own),
            false => Cow::Owned(self.team.gather(own.iter().copied())),
        }
    }
}

impl<const N: usize> Rows<Complex64, N> {
    /// The real part.
    pub fn real(&self) -> Rows<f64, N> {
        Rows {
            lengths: self.lengths,
            team: self.team.clone(),
            data: real(&self.data),
        }
    }
}

/// Real parts.
pub(super) fn real(all: &[Complex64]) -> Vec<f64> {
    all.iter().map(|x| x.re).collect()
}
