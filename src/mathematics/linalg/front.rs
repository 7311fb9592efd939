//! The parts of a multifrontal elimination: rows that are eliminated first, and fronts (Duff & Reid 1983).

use std::ops::Range;

/// Which of two systems is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// A x = b.
    Plain,
    /// Aᵀ x = b.
    Transposed,
}

/// A short row that is eliminated first: its pivot, the other entries of its column and of its row.
pub(super) struct Short {
    pub row: usize,
    pub column: usize,
    /// Slot of the pivot.
    pub pivot: usize,
    /// The first unknown in its row; the unknowns if there is none.
    pub first: usize,
    /// (unknown of the row, slot), the unknown numbered in the branch of the first once there are branches.
    pub below: Vec<[u32; 2]>,
    /// (column, slot).
    pub beside: Vec<[u32; 2]>,
}

/// Parts of a front: the columns of the pivots, the other columns of their rows, the remainder.
pub(super) const PARTS: usize = 3;

/// A front: a dense matrix of pivots and of what they touch.
pub(super) struct Front {
    /// Its pivots among the unknowns.
    pub pivots: Range<usize>,
    /// The later unknowns that it touches, in order.
    pub rest: Vec<usize>,
    /// Fronts whose remainders are added.
    pub children: Vec<Child>,
    /// From slots of entries of the matrix to their places in the front, by parts of the front.
    pub entries: [Vec<Run>; PARTS],
    /// Products of short rows: number of the entry beside, and from slots below to places, by parts of the front.
    pub products: [Vec<(u32, Run)>; PARTS],
}

/// Neighbours that move together, in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub from: u32,
    pub to: u32,
    pub length: u32,
}

impl Run {
    /// One that moves.
    pub(super) fn one(from: usize, to: u32) -> Self {
        Self {
            from: from as u32,
            to,
            length: 1,
        }
    }

    /// Adds a run to some, joined with the last one if it continues that.
    pub(super) fn push(self, all: &mut Vec<Self>) {
        if !all.last_mut().is_some_and(|last| last.join(self)) {
            all.push(self);
        }
    }

    /// Joins a run that continues this one; returns whether it does.
    pub(super) fn join(&mut self, next: Self) -> bool {
        let continues = next.from == self.from + self.length && next.to == self.to + self.length;
        if continues {
            self.length += next.length;
        }
        continues
    }

    /// The places, in order.
    pub(super) fn targets(&self) -> Range<usize> {
        self.to as usize..(self.to + self.length) as usize
    }

    /// Runs of all numbers 0 … to these places.
    pub(super) fn of(places: impl IntoIterator<Item = u32>) -> Vec<Self> {
        let mut out: Vec<Self> = Vec::new();
        for (from, to) in places.into_iter().enumerate() {
            Self::one(from, to).push(&mut out);
        }
        out
    }
}

/// A front whose remainder is added to another.
pub(super) struct Child {
    pub front: usize,
    /// Number of its unknowns.
    pub order: usize,
    /// Where its unknowns that are pivots of the other front stand among these, and the others among the rest.
    pub inside: Vec<Run>,
    pub outside: Vec<Run>,
}

impl Front {
    /// Order of the front.
    pub(super) fn order(&self) -> usize {
        self.pivots.len() + self.rest.len()
    }

    /// Number of entries in the columns of the pivots, and in the other columns of their rows.
    pub(super) fn sizes(&self) -> (usize, usize) {
        let (p, r) = (self.pivots.len(), self.rest.len());
        (p * (p + r), p * r)
    }

    pub(super) fn number(&self, unknown: usize) -> usize {
        match self.pivots.contains(&unknown) {
            true => unknown - self.pivots.start,
            false => {
                let found = self.rest.binary_search(&unknown);
                self.pivots.len() + found.expect("a front has all that its pivots touch")
            }
        }
    }

    /// As [`Front::number`]. `last` is the latest place found among the rest: neighbours follow each other.
    fn number_after(&self, unknown: usize, last: &mut usize) -> usize {
        let near = |at: usize| self.rest.get(at) == Some(&unknown);
        let found = match (near(*last), near(*last + 1)) {
            (true, _) => *last,
            (_, true) => *last + 1,
            _ => {
                let number = self.number(unknown);
                match number.checked_sub(self.pivots.len()) {
                    Some(found) => found,
                    None => return number,
                }
            }
        };
        *last = found;
        self.pivots.len() + found
    }

    /// The part in which an entry stands, and its place there. `last` are the latest places of its row and column.
    pub(super) fn place(&self, row: usize, column: usize, last: &mut [usize; 2]) -> (usize, u32) {
        let row = self.number_after(row, &mut last[0]);
        let column = self.number_after(column, &mut last[1]);
        let (p, r) = (self.pivots.len(), self.rest.len());
        let (part, place) = match (column < p, row < p) {
            (true, _) => (0, column * (p + r) + row),
            (false, true) => (1, (column - p) * p + row),
            (false, false) => (2, (column - p) * r + row - p),
        };
        (part, place as u32)
    }
}
