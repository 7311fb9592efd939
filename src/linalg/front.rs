//! The parts of a multifrontal elimination: rows that are eliminated first, and fronts (Duff & Reid 1983).

/// Which of two systems is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum System {
    /// A x = b.
    Plain,
    /// Aᵀ x = b.
    Transposed,
}

impl System {
    /// Where a short row stands: its right-hand side and its unknown.
    pub(super) fn places(self, short: &Short) -> (usize, usize) {
        match self {
            System::Plain => (short.row, short.column),
            System::Transposed => (short.column, short.row),
        }
    }
}

/// A short row that is eliminated first: its pivot, the other entries of its column and of its row.
pub(super) struct Short {
    pub row: usize,
    pub column: usize,
    /// Slot of the pivot.
    pub pivot: usize,
    /// The first unknown in its row; the unknowns if there is none.
    pub first: usize,
    /// (unknown of the row, slot), the unknown numbered in the branch of the first.
    pub below: Vec<[u32; 2]>,
    /// (column, slot).
    pub beside: Vec<[u32; 2]>,
}

/// Parts of a front: the columns of the pivots, the other columns of their rows, the remainder.
pub(super) const PARTS: usize = 3;

/// A front: a dense matrix of pivots and of what they touch.
pub(super) struct Front {
    /// Its pivots among the unknowns.
    pub pivots: std::ops::Range<usize>,
    /// The later unknowns that it touches, in order.
    pub rest: Vec<usize>,
    /// Fronts whose remainders are added.
    pub children: Vec<Child>,
    /// Slots of entries of the matrix, and their places in the front, by parts of the front.
    pub entries: [Vec<[u32; 2]>; PARTS],
    /// Products of short rows: slot below, number of the entry beside, place, by parts of the front.
    pub products: [Vec<[u32; 3]>; PARTS],
}

/// A front whose remainder is added to another.
pub(super) struct Child {
    pub front: usize,
    /// Where its unknowns stand in the other front, ascending.
    pub places: Vec<u32>,
    /// Number of those that are pivots there.
    pub pivots: usize,
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

    /// The part in which an entry stands, and its place there.
    pub(super) fn place(&self, row: usize, column: usize) -> (usize, u32) {
        let (row, column) = (self.number(row), self.number(column));
        let (p, r) = (self.pivots.len(), self.rest.len());
        let (part, place) = match (column < p, row < p) {
            (true, _) => (0, column * (p + r) + row),
            (false, true) => (1, (column - p) * p + row),
            (false, false) => (2, (column - p) * r + row - p),
        };
        (part, place as u32)
    }
}
