//! Places of the non-zeros of matrices. Those of large matrices are kept: a new design changes the values of an assembly and not
//! its places.

use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Places of the non-zeros of a square matrix in compressed columns.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Places {
    /// First entry of each column, and the number of entries.
    pub starts: Vec<usize>,
    /// Row of each entry.
    pub rows: Vec<usize>,
}

/// Emitted entries from which on work is divided among processors, and places are kept.
const LARGE: usize = 1 << 16;
/// Most emitted entries whose places are kept: 4 bytes each, and 8 for each place.
const MOST: usize = 1 << 27;

/// Places with the slots of an assembly.
type Recorded = (Arc<Places>, Arc<[u32]>);

/// Those that are kept, and whether the assembly emits all of the places.
struct Kept {
    recorded: Recorded,
    whole: bool,
}

/// Those that were used last, the latest at the end.
static KEPT: Mutex<VecDeque<Kept>> = Mutex::new(VecDeque::new());

impl Places {
    /// The places (column, row) of an assembly of order `n`, and the slot of each of its entries.
    pub(super) fn record(n: usize, emitted: &[[u32; 2]]) -> Recorded {
        let of_order = |own: &Kept| own.whole && own.recorded.0.order() == n;
        kept(of_order, emitted).unwrap_or_else(|| {
            let places = Arc::new(Self::of(n, emitted));
            let slots = places.slots(emitted).into();
            keep((places, slots), true)
        })
    }

    /// The slots of an assembly that emits some of these places.
    pub(super) fn slots_of(self: &Arc<Self>, emitted: &[[u32; 2]]) -> Arc<[u32]> {
        let of_these = |own: &Kept| Arc::ptr_eq(&own.recorded.0, self);
        let new = || keep((self.clone(), self.slots(emitted).into()), false);
        kept(of_these, emitted).unwrap_or_else(new).1
    }

    /// Order of the matrix.
    pub(super) fn order(&self) -> usize {
        self.starts.len() - 1
    }

    fn of(n: usize, emitted: &[[u32; 2]]) -> Self {
        // Sorted by columns, then within each column.
        let mut starts = vec![0; n + 1];
        for &[column, _] in emitted {
            starts[column as usize + 1] += 1;
        }
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let (mut next, mut sorted) = (starts.clone(), vec![0_u32; emitted.len()]);
        for &[column, row] in emitted {
            let at = &mut next[column as usize];
            sorted[*at] = row;
            *at += 1;
        }
        let (mut column_starts, mut rows) = (vec![0], Vec::new());
        for j in 0..n {
            let own = &mut sorted[starts[j]..starts[j + 1]];
            own.sort_unstable();
            let mut last = None;
            for &row in &*own {
                if last.replace(row) != Some(row) {
                    rows.push(row as usize);
                }
            }
            column_starts.push(rows.len());
        }
        rows.shrink_to_fit();
        Self {
            starts: column_starts,
            rows,
        }
    }

    fn slots(&self, emitted: &[[u32; 2]]) -> Vec<u32> {
        match emitted.len() < LARGE {
            true => emitted.iter().map(|place| self.slot(place)).collect(),
            false => emitted.par_iter().map(|place| self.slot(place)).collect(),
        }
    }

    /// Index of a place (column, row).
    fn slot(&self, &[column, row]: &[u32; 2]) -> u32 {
        let own = self.column(column);
        let found = self.rows[own.clone()].binary_search(&(row as usize));
        let slot = own.start + found.expect("every place was recorded");
        u32::try_from(slot).expect("fewer than 2^32 entries")
    }

    fn column(&self, column: u32) -> std::ops::Range<usize> {
        self.starts[column as usize]..self.starts[column as usize + 1]
    }

    /// Whether these are the slots of the emitted places.
    fn are_at(&self, slots: &[u32], emitted: &[[u32; 2]]) -> bool {
        let is_at = |(&slot, &[column, row]): (&u32, &[u32; 2])| {
            let slot = slot as usize;
            self.column(column).contains(&slot) && self.rows[slot] == row as usize
        };
        slots.len() == emitted.len() && slots.par_iter().zip(emitted).all(is_at)
    }
}

/// Kept places of this kind that are those of an assembly.
fn kept(kind: impl Fn(&Kept) -> bool, emitted: &[[u32; 2]]) -> Option<Recorded> {
    if emitted.len() < LARGE {
        return None;
    }
    let may_be = |own: &&Kept| kind(own) && own.recorded.1.len() == emitted.len();
    // Compared without the lock: others may record meanwhile.
    let all: Vec<Recorded> = (lock().iter().filter(may_be))
        .map(|own| own.recorded.clone())
        .collect();
    let found = (all.into_iter().rev()).find(|(places, slots)| places.are_at(slots, emitted))?;
    let mut all = lock();
    let is_found = |own: &Kept| Arc::ptr_eq(&own.recorded.1, &found.1);
    if let Some(at) = all.iter().position(is_found) {
        let own = all.remove(at);
        all.extend(own);
    }
    Some(found)
}

fn keep(recorded: Recorded, whole: bool) -> Recorded {
    if (LARGE..=MOST).contains(&recorded.1.len()) {
        let mut all = lock();
        all.push_back(Kept {
            recorded: recorded.clone(),
            whole,
        });
        let count = |own: &Kept| own.recorded.1.len();
        while all.iter().map(count).sum::<usize>() > MOST {
            all.pop_front();
        }
    }
    recorded
}

fn lock() -> std::sync::MutexGuard<'static, VecDeque<Kept>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band of n unknowns and its width.
    fn band(n: u32, width: u32) -> Vec<[u32; 2]> {
        let column = |j: u32| (0..width).map(move |k| [j, (j + k) % n]);
        (0..n).flat_map(column).collect()
    }

    #[test]
    fn places_of_an_assembly_are_recorded_once() {
        let (n, width) = (LARGE / 4, 8);
        let emitted = band(n as u32, width);
        let first = Places::record(n, &emitted);
        let again = Places::record(n, &emitted);
        assert!(Arc::ptr_eq(&first.0, &again.0) && Arc::ptr_eq(&first.1, &again.1));
        // As many entries elsewhere, and in another order.
        let mut other = emitted.clone();
        other[5] = [0, 77];
        let other = Places::record(n, &other);
        assert!(!Arc::ptr_eq(&first.0, &other.0));
        let turned: Vec<[u32; 2]> = emitted.iter().rev().copied().collect();
        let slots = first.0.slots_of(&turned);
        assert!(first.0.are_at(&slots, &turned));
        assert!(Arc::ptr_eq(&slots, &first.0.slots_of(&turned)));
        // A part of the places is not recorded as all of them.
        let part = &emitted[..LARGE];
        first.0.slots_of(part);
        assert_eq!(Places::record(n, part).0.rows.len(), LARGE);
        let backwards: Vec<u32> = first.1.iter().rev().copied().collect();
        assert_eq!(*slots, backwards[..]);
    }
}
