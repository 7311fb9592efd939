//! Rows of few entries that are eliminated before all fronts: their part of a solution.

use super::elimination::SolveScalar;
use super::front::{Run, Short, System};
use super::pattern::Pattern;
use crate::math::slices::{dot_at, vectorised};
use rayon::prelude::*;
use std::ops::Range;

/// Entries from which on sums are divided among processors, and the rows that are one piece of them.
const SIDE_BY_SIDE: usize = 1 << 16;
const PIECE: usize = 512;

/// Short rows, in the order of their elimination.
pub(super) struct ShortRows {
    /// Row and column of the pivot of each.
    places: Vec<[usize; 2]>,
    /// Slots of the pivots.
    pub pivots: Vec<usize>,
    /// All entries beside the pivots: number of the short row, slot, column.
    pub beside: Vec<[u32; 3]>,
    /// Where the entries below each pivot begin among all, and the end.
    starts: Vec<usize>,
    /// Entries below the pivots: from slots to unknowns. Those of a branch have the numbers of the branch.
    below: Vec<Run>,
    /// Slots of the column of each pivot, where their rows begin among all, and the rows.
    columns: Vec<Range<usize>>,
    row_starts: Vec<usize>,
    rows: Vec<usize>,
}

impl ShortRows {
    /// The rows of an analysis.
    pub(super) fn new(rows: &[Short], pattern: &Pattern) -> Self {
        let starts = pattern.column_starts();
        let column = |row: &Short| starts[row.column]..starts[row.column + 1];
        let mut own = Self {
            columns: rows.iter().map(column).collect(),
            row_starts: Vec::new(),
            rows: Vec::new(),
            places: rows.iter().map(|row| [row.row, row.column]).collect(),
            pivots: rows.iter().map(|row| row.pivot).collect(),
            beside: Vec::new(),
            starts: vec![0],
            below: Vec::new(),
        };
        for (k, row) in rows.iter().enumerate() {
            let beside = row.beside.iter();
            own.beside
                .extend(beside.map(|&[column, slot]| [k as u32, slot, column]));
            let mut runs = Vec::new();
            for &[unknown, slot] in &row.below {
                Run::one(slot as usize, unknown).push(&mut runs);
            }
            own.below.extend(runs);
            own.starts.push(own.below.len());
            own.row_starts.push(own.rows.len());
            own.rows.extend_from_slice(&pattern.rows()[column(row)]);
        }
        own
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// The column of a row's pivot.
    pub(super) fn column(&self, k: usize) -> usize {
        self.places[k][1]
    }

    /// Divides the right-hand sides b by the pivots, into t. `inverse` are the inverse pivots, `beside` the entries
    /// beside pivots divided by them.
    pub(super) fn eliminate<S: SolveScalar>(
        &self,
        system: System,
        (inverse, beside): (&[S], &[S]),
        (b, t): (&mut [S], &mut [S]),
    ) {
        let (side, _) = sides(system);
        for ((t, places), &inverse) in t.iter_mut().zip(&self.places).zip(inverse) {
            *t = b[places[side]] * inverse;
        }
        if system == System::Transposed {
            for (&by, &[k, _, column]) in beside.iter().zip(&self.beside) {
                let own = b[self.places[k as usize][side]];
                b[column as usize] -= by * own;
            }
        }
    }

    /// Writes the unknowns of the rows from t and the other unknowns in b.
    pub(super) fn substitute_back<S: SolveScalar>(
        &self,
        system: System,
        beside: &[S],
        t: &[S],
        b: &mut [S],
    ) {
        let (_, side) = sides(system);
        for (&t, places) in t.iter().zip(&self.places) {
            b[places[side]] = t;
        }
        if system == System::Plain {
            for (&by, &[k, _, column]) in beside.iter().zip(&self.beside) {
                let known = b[column as usize];
                b[self.places[k as usize][side]] -= by * known;
            }
        }
    }

    fn runs(&self, k: usize) -> &[Run] {
        &self.below[self.starts[k]..self.starts[k + 1]]
    }

    /// Subtracts the entries below some pivots, each times its t. The kinematics of nodes hold after one
    /// iteration: then t is zero.
    pub(super) fn subtract_below<S: SolveScalar>(
        &self,
        rows: &[usize],
        scaled: &[S],
        t: &[S],
        x: &mut [S],
    ) {
        vectorised(
            #[inline(always)]
            || {
                for &k in rows {
                    let t = t[k];
                    if t == S::zero() {
                        continue;
                    }
                    for run in self.runs(k) {
                        let own = &scaled[run.from as usize..][..run.length as usize];
                        let x = &mut x[run.targets()];
                        x.iter_mut().zip(own).for_each(|(x, &a)| *x -= a * t);
                    }
                }
            },
        );
    }

    /// Subtracts from each t the sum of the entries below its pivot, each times its place in b, over the pivot. The
    /// places of the pivots in b become zero.
    pub(super) fn subtract_sums<S: SolveScalar>(
        &self,
        (inverse, scaled): (&[S], &[S]),
        b: &mut [S],
        t: &mut [S],
    ) {
        for places in &self.places {
            b[places[0]] = S::zero();
        }
        let b = &*b;
        let one = |(k, (t, &inverse)): (usize, (&mut S, &S))| {
            let own = self.columns[k].clone();
            let rows = &self.rows[self.row_starts[k]..][..own.len()];
            *t -= dot_at(&scaled[own], rows, b) * inverse;
        };
        match self.rows.len() < SIDE_BY_SIDE {
            true => t.iter_mut().zip(inverse).enumerate().for_each(one),
            false => {
                let all = t.par_iter_mut().zip(inverse).with_min_len(PIECE);
                all.enumerate().for_each(one);
            }
        }
    }
}

/// On which side of the pivots the right-hand sides of a system stand, and its unknowns: 0 by row, 1 by column.
fn sides(system: System) -> (usize, usize) {
    match system {
        System::Plain => (0, 1),
        System::Transposed => (1, 0),
    }
}
