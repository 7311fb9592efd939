//! Limits of a simulation, and its progress for observers.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Limits of a simulation, and the observer of its progress. The number of steps is limited, too
/// (see [`Headway`](super::headway::Headway)).
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Number of steps after which an implicit run is given up.
    pub steps: Option<usize>,
    /// Longest wall time of one simulation \[s\].
    pub seconds: Option<f64>,
    /// Observer of the progress.
    pub progress: Option<Arc<Progress>>,
    /// Where several processes compute a motion together: whether they must end, as all know it at the same step. The
    /// clock of one then ends nothing.
    pub agreed: Option<Arc<AtomicBool>>,
}

impl Limits {
    /// Whether simulations must end now.
    pub fn is_over(&self) -> bool {
        is_over(self.agreed.as_ref(), self.progress.as_ref())
    }

    /// If simulations must end, allows them so much time more, for the results.
    pub fn allow(&self, time: Duration) {
        if let Some(progress) = &self.progress
            && progress.is_over()
        {
            progress.end_by(Instant::now() + time);
        }
    }
}

fn is_over(agreed: Option<&Arc<AtomicBool>>, progress: Option<&Arc<Progress>>) -> bool {
    match agreed {
        Some(agreed) => agreed.load(Relaxed),
        None => progress.is_some_and(|progress| progress.is_over()),
    }
}

/// Limits are equal if they allow the same. The observer does not matter.
impl PartialEq for Limits {
    fn eq(&self, other: &Self) -> bool {
        self.seconds == other.seconds
    }
}

/// The running simulations, on any number of threads, and when they must end.
#[derive(Debug, Default)]
pub struct Progress {
    running: Mutex<Vec<Arc<Run>>>,
    /// Whether there is a deadline. It is read at every step, so without the lock.
    ends: AtomicBool,
    deadline: Mutex<Option<Instant>>,
}

/// One running simulation. The march writes its counters, observers read them.
#[derive(Debug)]
struct Run {
    since: Instant,
    duration: f64,
    /// The bits of the fraction of the duration that has been reached.
    reached: AtomicU64,
    tries: AtomicU64,
    rejected: AtomicU64,
}

/// Progress of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Wall time since it began \[s\].
    pub seconds: f64,
    /// Simulated time reached \[s\].
    pub time: f64,
    /// Simulated duration \[s\].
    pub duration: f64,
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of rejected steps.
    pub rejected: u64,
}

impl Progress {
    /// Makes all simulations fail from `deadline` on, as interrupted.
    pub fn end_by(&self, deadline: Instant) {
        if let Ok(mut own) = self.deadline.lock() {
            *own = Some(deadline);
        }
        self.ends.store(true, Relaxed);
    }

    /// Lets simulations run again after a deadline.
    pub fn go_on(&self) {
        self.ends.store(false, Relaxed);
        if let Ok(mut own) = self.deadline.lock() {
            *own = None;
        }
    }

    /// Whether simulations must end now.
    pub fn is_over(&self) -> bool {
        let passed = |deadline: &Instant| Instant::now() >= *deadline;
        self.ends.load(Relaxed)
            && (self.deadline.lock()).is_ok_and(|own| own.as_ref().is_some_and(passed))
    }

    /// The simulation that has been running longest, if any.
    pub fn longest(&self) -> Option<View> {
        let running = self.running.lock().ok()?;
        let run = running.iter().min_by_key(|run| run.since)?;
        let (tries, rejected) = (run.tries.load(Relaxed), run.rejected.load(Relaxed));
        Some(View {
            seconds: run.since.elapsed().as_secs_f64(),
            time: f64::from_bits(run.reached.load(Relaxed)) * run.duration,
            duration: run.duration,
            steps: tries.saturating_sub(rejected),
            rejected,
        })
    }
}

/// Number of tries between two checks of the clock.
const LOOKS: usize = 16;

/// Monitors one march. When it is dropped, the run leaves the list of running simulations.
#[derive(Debug)]
pub(super) struct Clock {
    since: Instant,
    seconds: Option<f64>,
    told: Option<(Arc<Progress>, Arc<Run>)>,
    agreed: Option<Arc<AtomicBool>>,
}

impl Clock {
    /// A clock that starts now, for a motion of `duration` [s]; `None` if it is not needed.
    pub fn start(limits: &Limits, duration: f64) -> Option<Self> {
        if limits.seconds.is_none() && limits.progress.is_none() && limits.agreed.is_none() {
            return None;
        }
        let since = Instant::now();
        let told = limits.progress.as_ref().map(|progress| {
            let run = Arc::new(Run {
                since,
                duration,
                reached: AtomicU64::new(0),
                tries: AtomicU64::new(0),
                rejected: AtomicU64::new(0),
            });
            if let Ok(mut running) = progress.running.lock() {
                running.push(Arc::clone(&run));
            }
            (Arc::clone(progress), run)
        });
        Some(Self {
            since,
            seconds: limits.seconds,
            told,
            agreed: limits.agreed.clone(),
        })
    }

    /// Whether the march must end now.
    pub fn is_over(&self) -> bool {
        let progress = self.told.as_ref().map(|(progress, _)| progress);
        is_over(self.agreed.as_ref(), progress)
    }

    /// Reports the progress of the march; returns the limit [s] if it is exceeded.
    pub fn look(&self, reached: f64, tries: usize, rejected: usize) -> Option<f64> {
        if !tries.is_multiple_of(LOOKS) {
            return None;
        }
        if let Some((_, run)) = &self.told {
            run.reached.store(reached.to_bits(), Relaxed);
            run.tries.store(tries as u64, Relaxed);
            run.rejected.store(rejected as u64, Relaxed);
        }
        let over = |seconds: &f64| self.since.elapsed().as_secs_f64() > *seconds;
        self.seconds.filter(over)
    }
}

impl Drop for Clock {
    fn drop(&mut self) {
        if let Some((progress, run)) = &self.told
            && let Ok(mut running) = progress.running.lock()
        {
            running.retain(|other| !Arc::ptr_eq(other, run));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the deadline on, and not before, simulations must end.
    #[test]
    fn a_deadline_ends_simulations() {
        let limits = Limits {
            progress: Some(Arc::default()),
            ..Limits::default()
        };
        let clock = Clock::start(&limits, 1.0).expect("a clock");
        assert!(!limits.is_over() && !clock.is_over());
        limits.allow(Duration::ZERO);
        assert!(!limits.is_over(), "nothing was to end");
        let progress = limits.progress.clone().expect("it was given");
        progress.end_by(Instant::now());
        assert!(limits.is_over() && clock.is_over());
        limits.allow(Duration::from_secs(1000));
        assert!(!limits.is_over() && !clock.is_over());
        assert!(!Limits::default().is_over());
    }

    /// The simulation that began first is reported while it runs.
    #[test]
    fn the_longest_simulation_is_told() {
        let limits = Limits {
            progress: Some(Arc::default()),
            ..Limits::default()
        };
        let progress = limits.progress.clone().expect("it was given");
        assert_eq!(progress.longest(), None);
        let first = Clock::start(&limits, 4.0).expect("a clock");
        let second = Clock::start(&limits, 8.0).expect("a clock");
        assert_eq!(first.look(0.25, 3 * LOOKS, 5), None);
        assert_eq!(second.look(0.5, 2 * LOOKS, 0), None);
        let seen = progress.longest().expect("two are under way");
        assert_eq!((seen.time, seen.duration), (1.0, 4.0));
        assert_eq!((seen.steps, seen.rejected), (3 * LOOKS as u64 - 5, 5));
        drop(first);
        assert_eq!(progress.longest().map(|seen| seen.time), Some(4.0));
        drop(second);
        assert_eq!(progress.longest(), None);
        assert!(Clock::start(&Limits::default(), 1.0).is_none());
    }
}
