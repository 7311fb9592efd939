//! The analysis of a multifrontal elimination: which pivots are eliminated together, and where the entries
//! of the matrix go (Duff & Reid 1983).

use super::pattern::{KnownPivots, Pattern};

/// Columns by which a front may exceed what its pivots need, and the part of its size.
const EXCESS: usize = 12;
const EXCESS_PART: usize = 8;

/// A short row that is eliminated first: its pivot, the other entries of its column and of its row.
pub(super) struct Short {
    pub row: usize,
    pub column: usize,
    /// Slot of the pivot.
    pub pivot: usize,
    /// (row, slot).
    pub below: Vec<[u32; 2]>,
    /// (column, slot).
    pub beside: Vec<[u32; 2]>,
}

/// A front: a dense matrix of pivots and of what they touch.
pub(super) struct Front {
    /// Its pivots among the unknowns.
    pub pivots: std::ops::Range<usize>,
    /// The later unknowns that it touches, in order.
    pub rest: Vec<usize>,
    /// Fronts whose remainders are added.
    pub children: Vec<Child>,
    /// Slots of entries of the matrix, and their places in the front.
    pub entries: Vec<(u32, u32)>,
    /// Products of short rows: number, slot below, slot beside, place.
    pub products: Vec<[u32; 4]>,
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

    fn number(&self, unknown: usize) -> usize {
        match self.pivots.contains(&unknown) {
            true => unknown - self.pivots.start,
            false => {
                let found = self.rest.binary_search(&unknown);
                self.pivots.len() + found.expect("a front has all that its pivots touch")
            }
        }
    }

    /// Where an entry stands among the columns of the pivots, then the other columns of their rows, then
    /// the remainder.
    fn place(&self, row: usize, column: usize) -> usize {
        let (row, column) = (self.number(row), self.number(column));
        let (p, r) = (self.pivots.len(), self.rest.len());
        let (left, upper) = self.sizes();
        match (column < p, row < p) {
            (true, _) => column * (p + r) + row,
            (false, true) => left + (column - p) * p + row,
            (false, false) => left + upper + (column - p) * r + row - p,
        }
    }
}

/// The plan of an elimination. Unknowns are numbered: known pivots in their order, then the others, which
/// the last front has all.
pub(super) struct Plan {
    pub short: Vec<Short>,
    /// Row and column of each unknown.
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
    /// Fronts, children before parents.
    pub fronts: Vec<Front>,
}

impl Plan {
    pub(super) fn new(pattern: &Pattern, known: &KnownPivots) -> Self {
        let n = pattern.order();
        let (mut row_of, mut column_of) = (vec![usize::MAX; n], vec![usize::MAX; n]);
        let (mut short_row, mut short_column) = (vec![usize::MAX; n], vec![usize::MAX; n]);
        for (k, &(row, column)) in known.short.iter().enumerate() {
            (short_row[row], short_column[column]) = (k, k);
        }
        let (mut rows, mut columns) = (Vec::new(), Vec::new());
        for &(row, column) in &known.inner {
            (row_of[row], column_of[column]) = (rows.len(), rows.len());
            rows.push(row);
            columns.push(column);
        }
        let inner = rows.len();
        for i in 0..n {
            if short_row[i] == usize::MAX && row_of[i] == usize::MAX {
                row_of[i] = rows.len();
                rows.push(i);
            }
            if short_column[i] == usize::MAX && column_of[i] == usize::MAX {
                column_of[i] = columns.len();
                columns.push(i);
            }
        }
        let mut short: Vec<Short> = (known.short.iter())
            .map(|&(row, column)| Short {
                row,
                column,
                pivot: usize::MAX,
                below: Vec::new(),
                beside: Vec::new(),
            })
            .collect();
        // Entries among the unknowns: (row, column, slot).
        let mut entries = Vec::with_capacity(pattern.entries());
        let starts = pattern.column_starts();
        for column in 0..n {
            for slot in starts[column]..starts[column + 1] {
                let row = pattern.rows()[slot];
                let (r, c) = (short_row[row], short_column[column]);
                match (r != usize::MAX, c != usize::MAX) {
                    (true, true) => {
                        assert_eq!(r, c, "short rows and columns share no entry");
                        short[r].pivot = slot;
                    }
                    (true, false) => short[r].beside.push([column, slot].map(|x| x as u32)),
                    (false, true) => short[c].below.push([row, slot].map(|x| x as u32)),
                    (false, false) => entries.push((row_of[row], column_of[column], slot)),
                }
            }
        }
        let touching = |f: &mut dyn FnMut(usize, usize)| {
            entries.iter().for_each(|&(r, c, _)| f(r, c));
            for own in &short {
                for &[row, _] in &own.below {
                    for &[column, _] in &own.beside {
                        f(row_of[row as usize], column_of[column as usize]);
                    }
                }
            }
        };
        let mut later = vec![Vec::new(); inner];
        touching(&mut |r, c| {
            let (low, high) = (r.min(c), r.max(c));
            if low < inner && low < high {
                later[low].push(high);
                // Many entries stand at one place.
                if later[low].len() > 2000 {
                    later[low].sort_unstable();
                    later[low].dedup();
                }
            }
        });
        let mut fronts = fronts(later, rows.len());
        let mut front_of = vec![fronts.len() - 1; rows.len()];
        for (k, front) in fronts.iter().enumerate() {
            front.pivots.clone().for_each(|i| front_of[i] = k);
        }
        for (r, c, slot) in &entries {
            let front = &mut fronts[front_of[*r.min(c)]];
            let place = front.place(*r, *c);
            front.entries.push((*slot as u32, place as u32));
        }
        for (k, own) in short.iter().enumerate() {
            for &[row, below] in &own.below {
                for &[column, beside] in &own.beside {
                    let (r, c) = (row_of[row as usize], column_of[column as usize]);
                    let front = &mut fronts[front_of[r.min(c)]];
                    let place = front.place(r, c) as u32;
                    front.products.push([k as u32, below, beside, place]);
                }
            }
        }
        Self {
            short,
            rows,
            columns,
            fronts,
        }
    }
}

/// Fronts of the inner unknowns, each with the `later` ones that it touches, and the last front of all
/// `count − inner` others.
fn fronts(mut later: Vec<Vec<usize>>, count: usize) -> Vec<Front> {
    let inner = later.len();
    let mut parent = vec![usize::MAX; inner];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); inner];
    for j in 0..inner {
        let mut own = std::mem::take(&mut later[j]);
        for &child in &children[j] {
            own.extend(later[child].iter().copied().filter(|&i| i != j));
        }
        own.sort_unstable();
        own.dedup();
        if let Some(&first) = own.first().filter(|&&first| first < inner) {
            parent[j] = first;
            children[first].push(j);
        }
        later[j] = own;
    }
    let mut all: Vec<Front> = Vec::new();
    let mut front_of = vec![usize::MAX; inner];
    let mut start = 0;
    while start < inner {
        let mut end = start + 1;
        // The next pivot joins if it is the parent and adds few zeros.
        while end < inner && parent[end - 1] == end {
            let excess = later[end].len() + 1 - later[end - 1].len();
            if excess > EXCESS.max(later[end].len() / EXCESS_PART) {
                break;
            }
            end += 1;
        }
        front_of[start..end].fill(all.len());
        all.push(Front {
            pivots: start..end,
            rest: later[end - 1].clone(),
            children: Vec::new(),
            entries: Vec::new(),
            products: Vec::new(),
        });
        start = end;
    }
    all.push(Front {
        pivots: inner..count,
        rest: Vec::new(),
        children: Vec::new(),
        entries: Vec::new(),
        products: Vec::new(),
    });
    let last = all.len() - 1;
    for k in 0..last {
        let Some(&first) = all[k].rest.first() else {
            continue;
        };
        let to = if first < inner { front_of[first] } else { last };
        let places = (all[k].rest.iter()).map(|&i| all[to].number(i) as u32);
        let places: Vec<u32> = places.collect();
        let own = all[to].pivots.len();
        all[to].children.push(Child {
            front: k,
            pivots: places.partition_point(|&place| (place as usize) < own),
            places,
        });
    }
    all
}
