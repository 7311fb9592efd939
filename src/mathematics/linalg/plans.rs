//! Plans of eliminations that are kept. A new design changes the values of a matrix and not its pattern, and the
//! steps forwards and backwards have one pattern.

use super::fronts::Plan;
use super::pattern::{KnownPivots, Pattern};
use super::places::Places;
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of entries of all patterns whose plans are kept. Factors take far more memory than their plan.
const ENTRIES: usize = 1 << 26;

/// A pattern with its plan.
struct Planned {
    places: Arc<Places>,
    pivots: KnownPivots,
    plan: Arc<Plan>,
}

/// Those that were used last, the latest at the end.
static PLANNED: Mutex<Vec<Planned>> = Mutex::new(Vec::new());

impl Planned {
    fn is_of(&self, pattern: &Pattern, pivots: &KnownPivots) -> bool {
        let same = Arc::ptr_eq(&self.places, &pattern.places);
        (same || self.places == pattern.places) && self.pivots == *pivots
    }
}

/// The plan of a pattern with these pivots.
pub(super) fn plan(pattern: &Pattern, pivots: &KnownPivots) -> Arc<Plan> {
    if let Some(plan) = find(pattern, pivots) {
        return plan;
    }
    // Without the lock: others may plan meanwhile.
    let plan = Arc::new(Plan::new(pattern, pivots));
    if pattern.entries() <= ENTRIES && find(pattern, pivots).is_none() {
        let mut all = PLANNED.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(Planned {
            places: pattern.places.clone(),
            pivots: pivots.clone(),
            plan: plan.clone(),
        });
        let count = |all: &[Planned]| all.iter().map(|own| own.places.rows.len()).sum::<usize>();
        while count(&all) > ENTRIES {
            all.remove(0);
        }
    }
    plan
}

fn find(pattern: &Pattern, pivots: &KnownPivots) -> Option<Arc<Plan>> {
    let mut all = PLANNED.lock().unwrap_or_else(PoisonError::into_inner);
    let at = all.iter().position(|own| own.is_of(pattern, pivots))?;
    let found = all.remove(at);
    let plan = found.plan.clone();
    all.push(found);
    Some(plan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::pattern::Emit;

    /// A ring of n unknowns.
    fn ring(n: usize) -> Pattern {
        let pattern = Pattern::record(n, |emit: &mut dyn Emit<f64>| {
            for i in 0..n {
                emit.add(i, i, 1.0);
                emit.add(i, (i + 1) % n, 1.0);
                emit.add((i + 1) % n, i, 1.0);
            }
        });
        pattern.with_pivots(KnownPivots {
            short: Vec::new(),
            inner: (0..n - 1).map(|i| (i, i)).collect(),
        })
    }

    #[test]
    fn a_pattern_is_planned_once() {
        let planned = |pattern: &Pattern| {
            let pivots = pattern.known_pivots().expect("known pivots");
            plan(pattern, pivots)
        };
        let first = planned(&ring(31));
        assert!(Arc::ptr_eq(&first, &planned(&ring(31))));
        assert!(!Arc::ptr_eq(&first, &planned(&ring(32))));
        assert!(Arc::ptr_eq(&first, &planned(&ring(31))));
    }
}
