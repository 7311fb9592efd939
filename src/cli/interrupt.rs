//! Interrupts: Ctrl-C, and the signals INT, TERM and HUP.

use super::INTERRUPTED;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the work under way looks at [`asked`] and ends by itself.
static HEEDED: AtomicBool = AtomicBool::new(false);
/// Whether it has been asked to.
static ASKED: AtomicBool = AtomicBool::new(false);

/// Makes an interrupt end the program with its exit code: at once, or, the first time while it is
/// [heeded](heed), when the results are written.
pub(crate) fn listen() {
    // Where no handler can be set, the system ends the program.
    let _ = ctrlc::set_handler(|| {
        let first = !ASKED.swap(true, Ordering::Relaxed);
        if !(first && HEEDED.load(Ordering::Relaxed)) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
}

/// From now on the work looks at [`asked`].
pub(crate) fn heed() {
    HEEDED.store(true, Ordering::Relaxed);
}

/// Whether the work shall end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
