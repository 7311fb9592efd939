//! Interrupts: Ctrl-C, and the signals INT, TERM and HUP.

use super::INTERRUPTED;
use super::progress::progress;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whether the present work checks [`asked`] and ends by itself.
static HEEDED: AtomicBool = AtomicBool::new(false);
/// Whether an interrupt has occurred.
static ASKED: AtomicBool = AtomicBool::new(false);

/// Makes an interrupt end the program with its exit code. The first one during [heeding](heed) work
/// only sets [`asked`] and ends the simulations under way, so that the results are written first.
pub(crate) fn listen() {
    // If no handler can be set, the system ends the program.
    let _ = ctrlc::set_handler(|| {
        let first = !ASKED.swap(true, Ordering::Relaxed);
        if !(first && HEEDED.load(Ordering::Relaxed)) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        progress().end_by(Instant::now());
    });
}

/// Declares that the work checks [`asked`] from now on.
pub(crate) fn heed() {
    HEEDED.store(true, Ordering::Relaxed);
}

/// Makes the work end as an interrupt does.
#[cfg(feature = "mpi")]
pub(crate) fn ask() {
    ASKED.store(true, Ordering::Relaxed);
    progress().end_by(Instant::now());
}

/// Whether the work must end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
