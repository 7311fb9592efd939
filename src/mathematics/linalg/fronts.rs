//! The analysis of a multifrontal elimination: which pivots are eliminated together, and where the entries
//! of the matrix go (Duff & Reid 1983).

use super::border::Border;
use super::branches::{Branch, divide, postorder, work};
use super::front::{Child, Front, Run, Short};
use super::pattern::{KnownPivots, Pattern};
use super::short_rows::ShortRows;

/// Columns by which a front may exceed what its pivots need, and the part of its size.
const EXCESS: usize = 12;
const EXCESS_PART: usize = 8;

/// The plan of an elimination. Unknowns are numbered: known pivots in their order, then the others, which
/// the last front has all.
pub(super) struct Plan {
    pub short: ShortRows,
    /// Row and column of each unknown.
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
    /// Fronts, children before parents, each after its subtree. The last one has no pivots if the border is sparse.
    pub fronts: Vec<Front>,
    /// Parts of the fronts that are eliminated side by side, ascending.
    pub branches: Vec<Branch>,
    /// The other fronts, and the short rows beside the branches.
    pub trunk: Vec<usize>,
    pub trunk_short: Vec<usize>,
    /// The border, if it is sparse.
    pub border: Option<Border>,
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
                first: usize::MAX,
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
                    (false, true) => short[c].below.push([row_of[row], slot].map(|x| x as u32)),
                    (false, false) => entries.push((row_of[row], column_of[column], slot)),
                }
            }
        }
        let later = later(inner, &column_of, &short, &entries);
        let order = postorder(&later);
        if !order.is_sorted() {
            let again = KnownPivots {
                short: known.short.clone(),
                inner: order.iter().map(|&k| known.inner[k]).collect(),
            };
            return Self::new(pattern, &again);
        }
        let mut fronts = fronts(later, rows.len());
        let end = fronts.len() - 1;
        let own = (&short[..], &column_of[..]);
        let border = Border::new((inner, rows.len()), &entries, own, &fronts[end].children);
        if border.is_some() {
            fronts[end].pivots = inner..inner;
            entries.retain(|&(r, c, _)| r.min(c) < inner);
        }
        let mut front_of = vec![end; rows.len()];
        for (k, front) in fronts.iter().enumerate() {
            front.pivots.clone().for_each(|i| front_of[i] = k);
        }
        let mut last = [0; 2];
        for (r, c, slot) in &entries {
            let front = &mut fronts[front_of[*r.min(c)]];
            let (part, place) = front.place(*r, *c, &mut last);
            Run::one(*slot, place).push(&mut front.entries[part]);
        }
        // Entries beside short pivots, numbered as in [`ShortRows`].
        let mut number = 0;
        for own in &short {
            for &[column, _] in &own.beside {
                for &[row, below] in &own.below {
                    let (r, c) = (row as usize, column_of[column as usize]);
                    if border.is_some() && r.min(c) >= inner {
                        continue;
                    }
                    let front = &mut fronts[front_of[r.min(c)]];
                    let (part, place) = front.place(r, c, &mut last);
                    let (all, next) = (&mut front.products[part], Run::one(below as usize, place));
                    let last = all.last_mut().filter(|(own, _)| *own == number);
                    if !last.is_some_and(|(_, last)| last.join(next)) {
                        all.push((number, next));
                    }
                }
                number += 1;
            }
        }
        for front in &mut fronts {
            front.entries.iter_mut().for_each(Vec::shrink_to_fit);
            front.products.iter_mut().for_each(Vec::shrink_to_fit);
        }
        for own in &mut short {
            let columns = own
                .beside
                .iter()
                .map(|&[column, _]| column_of[column as usize]);
            let first = columns.min();
            own.first = first.unwrap_or(rows.len());
        }
        let branches = divide(&mut fronts, &mut short);
        let in_trunk = |k: &usize| !branches.iter().any(|own| own.fronts.contains(k));
        let count = fronts.len() - usize::from(border.is_some());
        let trunk = (0..count).filter(in_trunk).collect();
        let in_trunk = |k: &usize| {
            !branches
                .iter()
                .any(|own| own.own.contains(&short[*k].first))
        };
        let trunk_short = (0..short.len()).filter(in_trunk).collect();
        Self {
            short: ShortRows::new(&short, pattern),
            rows,
            columns,
            fronts,
            branches,
            trunk,
            trunk_short,
            border,
        }
    }
}

impl Plan {
    /// The first unknown whose pivot is searched.
    pub(super) fn first_of_border(&self) -> usize {
        self.fronts.last().map_or(0, |front| front.pivots.start)
    }

    /// Operations of the elimination of a branch.
    pub(super) fn work_of(&self, branch: &Branch) -> usize {
        self.fronts[branch.fronts.clone()].iter().map(work).sum()
    }

    /// Whether a front is the last of a branch.
    pub(super) fn ends_branch(&self, k: usize) -> bool {
        self.branches.iter().any(|own| own.fronts.end == k + 1)
    }
}

/// By inner unknown: the later unknowns that it touches, through an entry or a short row; some are there twice.
fn later(
    inner: usize,
    column_of: &[usize],
    short: &[Short],
    entries: &[(usize, usize, usize)],
) -> Vec<Vec<usize>> {
    let mut out = vec![Vec::new(); inner];
    let mut add = |r: usize, c: usize| {
        let (low, high) = (r.min(c), r.max(c));
        if low < inner && low < high {
            out[low].push(high);
        }
    };
    // By unknown: the short rows beside which its column stands.
    let mut beside = vec![Vec::new(); column_of.len()];
    for (k, own) in short.iter().enumerate() {
        for &[column, _] in &own.beside {
            beside[column_of[column as usize]].push(k);
        }
    }
    // Many products stand at one place.
    let mut seen = vec![usize::MAX; column_of.len()];
    for &(r, c, _) in entries {
        add(r, c);
    }
    for (c, rows) in beside.iter().enumerate() {
        for &[r, _] in rows.iter().flat_map(|&k| &short[k].below) {
            if std::mem::replace(&mut seen[r as usize], c) != c {
                add(r as usize, c);
            }
        }
    }
    out
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
            entries: Default::default(),
            products: Default::default(),
        });
        start = end;
    }
    all.push(Front {
        pivots: inner..count,
        rest: Vec::new(),
        children: Vec::new(),
        entries: Default::default(),
        products: Default::default(),
    });
    let last = all.len() - 1;
    for k in 0..last {
        let Some(&first) = all[k].rest.first() else {
            continue;
        };
        let to = if first < inner { front_of[first] } else { last };
        let places: Vec<u32> = (all[k].rest.iter())
            .map(|&i| all[to].number(i) as u32)
            .collect();
        let own = all[to].pivots.len() as u32;
        let (inside, outside) = places.split_at(places.partition_point(|&place| place < own));
        let child = Child {
            front: k,
            order: places.len(),
            inside: Run::of(inside.iter().copied()),
            outside: Run::of(outside.iter().map(|place| place - own)),
        };
        all[to].children.push(child);
    }
    all
}
