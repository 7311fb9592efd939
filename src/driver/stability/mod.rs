//! The stability suite: extreme scenes. Each is compared with a source that is independent of the
//! tested method, so that no number is wrong without a warning.
//!
//! A case is *accurate* if every function agrees with its judge. It is *degraded* if one does not
//! and the program says so (by a warning, the printed energy drift or the estimate of `--error`).
//! It is *refused* if the program gives a reason instead of numbers. Otherwise it is *wrong and
//! silent*.

mod case;
mod cases;
mod elastic;
mod exact;
mod flexible;
mod loops;
mod reference;
mod run;
mod scenes;
mod shells;

use crate::report::{StabilityFamily, StabilityOutcome, StabilityRow, StabilityTable};
use case::Case;
pub use loops::in_units;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// Time limit of a case \[s\].
pub const LIMIT: f64 = 300.0;

/// Names of all cases in the order of the table; `fast` omits those that take seconds.
pub fn names(fast: bool) -> Vec<String> {
    let wanted = |case: &&Case| !(fast && case.slow);
    let all = cases::all();
    all.iter().filter(wanted).map(Case::name).collect()
}

/// Runs the cases whose names `wanted` accepts, several in parallel. Calls `seen` for every row as
/// soon as it is known. The table has its own order.
pub fn stability(
    wanted: impl Fn(&str) -> bool,
    seconds: f64,
    seen: &(dyn Fn(&StabilityRow) + Sync),
) -> StabilityTable {
    let mut chosen = cases::all();
    chosen.retain(|case| wanted(&case.name()));
    let next = AtomicUsize::new(0);
    let rows: Mutex<Vec<(usize, StabilityRow)>> = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    // Separate threads: a worker waits for its case and must not block computing threads.
    std::thread::scope(|scope| {
        for _ in 0..workers.min(chosen.len()) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = chosen.get(k) else { return };
                    let row = limited(case, seconds);
                    seen(&row);
                    if let Ok(mut rows) = rows.lock() {
                        rows.push((k, row));
                    }
                }
            });
        }
    });
    let mut rows = rows.into_inner().unwrap_or_default();
    rows.sort_by_key(|(k, _)| *k);
    let families = scenes::FAMILIES.map(|(name, about)| StabilityFamily {
        name: name.into(),
        about: about.into(),
    });
    let rows: Vec<StabilityRow> = rows.into_iter().map(|(_, row)| row).collect();
    let tried = |family: &StabilityFamily| rows.iter().any(|row| row.family == family.name);
    StabilityTable {
        families: families.into_iter().filter(tried).collect(),
        rows,
    }
}

/// Whether `only` is a case or the beginning of its name, in whole parts.
pub fn is_named(case: &str, only: &str) -> bool {
    let rest = case.strip_prefix(only.trim_end_matches('/'));
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The row of a case, which may panic or exceed the time limit.
fn limited(case: &Case, seconds: f64) -> StabilityRow {
    let (send, receive) = mpsc::channel();
    let own = case.clone();
    // A case that does not end cannot be stopped. It runs until the program ends.
    let started = std::thread::Builder::new().spawn(move || {
        let row = catch_unwind(AssertUnwindSafe(|| run::run(&own)));
        let _ = send.send(row);
    });
    let mut row = run::blank(case);
    row.outcome = match started {
        Err(error) => StabilityOutcome::Panicked {
            message: error.to_string(),
        },
        Ok(_) => match receive.recv_timeout(Duration::from_secs_f64(seconds)) {
            Ok(Ok(row)) => return row,
            Ok(Err(panic)) => StabilityOutcome::Panicked {
                message: words(panic.as_ref()),
            },
            Err(_) => StabilityOutcome::TimeLimit { seconds },
        },
    };
    row
}

fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|&text| text.into()))
        .unwrap_or_else(|| "a panic without words".into())
}
