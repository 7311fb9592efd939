//! The clock of work-precision measurements.

/// CPU time of this process \[s\].
#[cfg(unix)]
pub fn cpu_seconds() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Wall time since the first call \[s\], if CPU time is not available.
#[cfg(not(unix))]
pub fn cpu_seconds() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// A longer run is not repeated \[s\].
const LONG: f64 = 2.0;

/// Least CPU time of `runs` runs \[s\] after one that does not count. If that one is long, it is
/// the only one.
///
/// # Errors
/// The error of the first run that fails.
pub fn fastest<E>(runs: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let mut timed = || {
        let start = cpu_seconds();
        work().map(|()| cpu_seconds() - start)
    };
    let first = timed()?;
    if first > LONG {
        return Ok(first);
    }
    let mut least = f64::INFINITY;
    for _ in 0..runs.max(1) {
        least = least.min(timed()?);
    }
    Ok(least)
}
