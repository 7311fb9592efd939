//! `optimize PROBLEM` from one start: progress, history and page while it runs.

use super::progress::show;
use super::{Failure, tell};
use crate::driver::ranks::Ranks;
use crate::driver::{self, Optimisation, WarmStart};
use crate::figures::report_page::so_far;
use crate::library::logs::{Logs, Start, changed};
use crate::library::written::{PARTIAL, REPORT};
use crate::problem::Problem;
use crate::report::{History, HistoryLog, ReportError, atomic_write};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Shortest time between two pages of a run that goes on.
const SHORTEST_WATCH: Duration = Duration::from_secs(1);

/// One optimisation, which writes its evaluations and iterations to the disk as they happen. The
/// first failure to write ends it and is returned with the best design so far.
pub(super) fn one(
    problem: &Problem,
    (file, directory): (&str, &Path),
    state: Option<&WarmStart>,
    records: &Logs,
    stopped: &dyn Fn() -> bool,
    (quiet, watch): (bool, bool),
    (ranks, share_bodies): (Option<&dyn Ranks>, bool),
) -> Result<(Optimisation, Option<ReportError>), Failure> {
    let opened = records.open(Start::Only, problem)?;
    if !quiet {
        tell(&records.resumed(opened.known));
        tell(&changed(&opened.changes));
    }
    let mut log = HistoryLog::new(&directory.join(PARTIAL));
    let unwritable: RefCell<Option<ReportError>> = RefCell::new(None);
    let fault = Mutex::new(None);
    let has_failed = || fault.lock().is_ok_and(|error| error.is_some());
    let mut last: Option<Instant> = None;
    let mut renew_page = |history: &History| -> Result<(), ReportError> {
        if !watch || last.is_some_and(|at| at.elapsed() < SHORTEST_WATCH) {
            return Ok(());
        }
        last = Some(Instant::now());
        match so_far(problem, history) {
            Ok(text) => atomic_write(&directory.join(REPORT), text.as_bytes()),
            // A number that is not finite has no text: the page before stays.
            Err(_) => Ok(()),
        }
    };
    let mut progress = |history: &History| {
        if !quiet {
            show(history);
        }
        if let Err(error) = log.append(history).and_then(|()| renew_page(history)) {
            unwritable.borrow_mut().get_or_insert(error);
        }
        if stopped() || has_failed() || unwritable.borrow().is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let state = state.map(|warm| &warm.state);
    let shared =
        ranks.and_then(|ranks| ranks.share(problem, share_bodies, state, opened.earlier()));
    if let (Some(_), None, false) = (ranks, &shared, quiet) {
        tell(
            "one start and no cases: there is nothing to spread over ranks, unless --share-bodies asks for it\n",
        );
    }
    let known = opened.known_evaluations(&fault, (!quiet).then_some(tell));
    let done = driver::optimise_over(problem, file, state, known, shared, &mut progress);
    let lost = unwritable
        .into_inner()
        .or(fault.into_inner().ok().flatten());
    match done {
        Some(done) => Ok((done, lost)),
        None => Err(Failure::bad_input("nothing to optimise")),
    }
}
