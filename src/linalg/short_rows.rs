//! Rows of few entries that are eliminated before all fronts: their part of a solution.

use super::front::{Run, Short, System};
use super::sparse_lu::SolveScalar;
use crate::math::slices::vectorised;

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
}

impl ShortRows {
    /// The rows of an analysis.
    pub(super) fn new(rows: &[Short]) -> Self {
        let mut own = Self {
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

    /// Passes the sums of the entries below some pivots, each times its unknown.
    pub(super) fn sums_below<S: SolveScalar>(
        &self,
        rows: &[usize],
        scaled: &[S],
        x: &[S],
        mut take: impl FnMut(usize, S),
    ) {
        vectorised(
            #[inline(always)]
            || {
                for (i, &k) in rows.iter().enumerate() {
                    // Four sums, because an addition waits for the one before.
                    let mut sums = [S::zero(); 4];
                    for run in self.runs(k) {
                        let own = &scaled[run.from as usize..][..run.length as usize];
                        let (fours, rest) = own.as_chunks::<4>();
                        let (x4, x) = x[run.targets()].as_chunks::<4>();
                        for (own, x) in fours.iter().zip(x4) {
                            (0..4).for_each(|j| sums[j] += own[j] * x[j]);
                        }
                        let rest = rest.iter().zip(x);
                        let sums = sums.iter_mut();
                        sums.zip(rest).for_each(|(sum, (&a, &x))| *sum += a * x);
                    }
                    take(i, (sums[0] + sums[1]) + (sums[2] + sums[3]));
                }
            },
        );
    }
}

/// On which side of the pivots the right-hand sides of a system stand, and its unknowns: 0 by row, 1 by column.
fn sides(system: System) -> (usize, usize) {
    match system {
        System::Plain => (0, 1),
        System::Transposed => (1, 0),
    }
}
