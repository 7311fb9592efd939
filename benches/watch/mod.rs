//! Duration of a call: the least processor time of several.

use std::time::{Duration, Instant};

/// Duration of the fastest of `repeats` calls [s] after one that does not count, and the last
/// result.
pub fn fastest<T>(repeats: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut last = work();
    let mut least = Duration::MAX;
    for _ in 0..repeats {
        let start = Watch::start();
        last = work();
        least = least.min(start.elapsed());
    }
    (least.as_secs_f64(), last)
}

/// A clock of this thread.
struct Watch {
    wall: Instant,
    used: Option<Duration>,
}

impl Watch {
    fn start() -> Self {
        Self {
            used: processor_time(),
            wall: Instant::now(),
        }
    }

    fn elapsed(&self) -> Duration {
        let wall = self.wall.elapsed();
        match (processor_time(), self.used) {
            (Some(now), Some(then)) => now.saturating_sub(then),
            _ => wall,
        }
    }
}

/// Processor time of this thread, the first number of its `schedstat`; `None` if the system does
/// not provide it.
fn processor_time() -> Option<Duration> {
    // The kernel updates the number when it schedules.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
