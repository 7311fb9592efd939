//! Runs that end at an event: the duration T at which a quantity reaches its value, g(T) = c.
//!
//! The steps stretch with T (after the last kink of loads and drives), so the whole discrete motion,
//! with g at its end, is a smooth function of T and of the design. The secant method finds the root to round-off. The last
//! step then ends exactly there, and
//!
//! ```text
//! dT/dx = −(∂g/∂x − ∂c/∂x) / (∂g/∂T),      df/dx = ∂f/∂x + ∂f/∂T dT/dx
//! ```
//!
//! with all partial derivatives by the adjoint of one run.

use crate::functions::peak::crossing;
use crate::functions::{Scene, TerminalEvent};
use crate::integrate::{IntegrationFailure, Settings, Trajectory, WorkCounts, simulate};
use crate::math::scalar::COMPLEX_STEP;
use crate::math::{Complex64, Parameters};

/// Largest number of runs to a root.
const RUNS: usize = 40;
/// Change of the duration, relative to it, that is round-off.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;
/// A change below this that no longer shrinks is round-off as well.
const SETTLED: f64 = 1e-11;
/// Round-off of the quantity, relative to its largest distance from its value.
const NOISE: f64 = 64.0 * f64::EPSILON;
/// It touches its value if it comes so near and turns back, relative to that distance; and if it changes
/// so slowly, relative to that distance in the time of the run.
const TOUCH: f64 = 1e-9;
const FLAT: f64 = 1e-6;
/// Events nearer than this part of the run are one.
const SAME: f64 = 1e-9;
/// An event on kept steps must not turn back within this part of the longest duration.
const CLOSE: f64 = 1e-3;
/// A motion that fails is repeated up to these parts of the time that it reached.
const BEFORE: [f64; 3] = [0.99, 0.8, 0.4];
/// Longest step of the secant method, relative to the duration.
const LONGEST: f64 = 0.2;

/// The events that end a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Admit {
    /// Also those a little after the scene's duration.
    Late,
    /// Those within it.
    InTime,
    /// Those that come before its end by this part of it, and are no touch that other steps would
    /// miss: steps chosen for this design alone must find the event too.
    Certain {
        /// The part.
        margin: f64,
    },
}

/// Time of the event: the first change of sign of g − c in a run over the longest duration, between
/// its samples too.
///
/// # Errors
/// [`IntegrationFailure::NotReached`], or [`IntegrationFailure::Touches`].
pub fn first(
    until: &TerminalEvent<f64>,
    run: &Trajectory<f64>,
    gaps: &[f64],
) -> Result<f64, IntegrationFailure> {
    let noise = noise(gaps);
    match crossing(run, gaps, (side(gaps, noise), noise)) {
        Ok(at) => Ok(run.duration * at),
        // It comes at the very end.
        Err((nearest, at)) if nearest <= noise && at >= 1.0 => Ok(run.duration),
        Err((nearest, at)) if nearest <= TOUCH * largest(gaps) && at < 1.0 => {
            Err(IntegrationFailure::Touches {
                quantity: until.describe(),
                value: until.value,
                time: run.duration * at,
            })
        }
        Err((nearest, _)) => Err(IntegrationFailure::NotReached {
            quantity: until.describe(),
            value: until.value,
            nearest,
            waited: run.duration,
        }),
    }
}

/// Time of the first event in a motion of at most `waited`, which `run` gives up to any duration. A motion that fails
/// later than its event has one all the same.
///
/// # Errors
/// As of [`first`], or the failure of the motion.
pub fn sought(
    scene: &Scene<f64>,
    until: &TerminalEvent<f64>,
    waited: f64,
    run: impl Fn(f64) -> Result<Trajectory<f64>, IntegrationFailure>,
) -> Result<f64, IntegrationFailure> {
    let within = |duration: f64| {
        let all = run(duration)?;
        first(until, &all, &until.gaps(&scene.model, &all))
    };
    let failure = match within(waited) {
        Err(failure) if failure.time().is_some() => failure,
        found => return found,
    };
    let reached = failure.time().unwrap_or(waited);
    let found = BEFORE.iter().find_map(|part| within(part * reached).ok());
    found.ok_or(failure)
}

/// The largest |g − c|.
fn largest(gaps: &[f64]) -> f64 {
    gaps.iter().fold(0.0, |m, g| m.max(g.abs()))
}

/// Round-off of g − c.
fn noise(gaps: &[f64]) -> f64 {
    NOISE * largest(gaps)
}

/// The sign of g − c at the start, or just after it.
fn side(gaps: &[f64], noise: f64) -> f64 {
    gaps.iter()
        .find(|g| g.abs() > noise)
        .map_or(1.0, |g| g.signum())
}

/// Fails if the run of `scene` ends where the quantity of its event only touches its value: at the
/// rate ∂g/∂T = `rate` it would take many times the run to change as much as it did.
///
/// # Errors
/// [`IntegrationFailure::Touches`].
pub fn refuse_touch(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    rate: f64,
) -> Result<(), IntegrationFailure> {
    let Some(until) = &scene.until else {
        return Ok(());
    };
    let change = largest(&until.gaps(&scene.model, run));
    match rate.abs() * run.duration > FLAT * change {
        true => Ok(()),
        false => Err(IntegrationFailure::Touches {
            quantity: until.describe(),
            value: until.value,
            time: run.duration,
        }),
    }
}

/// The run of `scene` that ends at its event, with steps that keep their fractions. Starts near
/// `guess` \[s\]. Sets the scene's duration.
///
/// # Errors
/// If a run fails, or the event is not found, or not admitted.
pub fn settle(
    scene: &mut Scene<f64>,
    settings: &Settings,
    guess: f64,
    admit: Admit,
) -> Result<Trajectory<f64>, IntegrationFailure> {
    let Some(until) = scene.until.clone() else {
        return simulate(&scene.model, scene.duration, settings);
    };
    let waited = scene.duration;
    let lost = |nearest: f64| IntegrationFailure::NotReached {
        quantity: until.describe(),
        value: until.value,
        nearest,
        waited,
    };
    let mut counts = WorkCounts::default();
    let mut duration = guess;
    let mut known: Option<(f64, f64)> = None;
    let (mut change, mut best) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        let mut run = simulate(&scene.model, duration, settings)?;
        counts += run.counts;
        let gaps = until.gaps(&scene.model, &run);
        let last = gaps.len() - 1;
        let gap = gaps[last];
        if !gap.is_finite() {
            return Err(lost(f64::NAN));
        }
        best = best.min(gap.abs());
        let slope = match known {
            Some((t, g)) if t != duration && g != gap => (gap - g) / (duration - t),
            _ => (gap - gaps[last - 1]) / (run.time(last) - run.time(last - 1)),
        };
        let next = -gap / slope;
        let done = gap == 0.0
            || next.abs() <= ROUND_OFF * duration
            || (next.abs() <= SETTLED * duration && next.abs() >= 0.5 * change);
        if done {
            let noise = noise(&gaps);
            if let Ok(at) = crossing(&run, &gaps, (side(&gaps, noise), noise))
                && at < 1.0 - SAME
            {
                // It also came earlier.
                duration *= at;
                (known, change) = (None, f64::INFINITY);
                continue;
            }
            let admitted = match admit {
                Admit::Late => true,
                Admit::InTime => duration <= waited,
                Admit::Certain { margin } => {
                    duration <= waited * (1.0 - margin) && !touches(&gaps, &run, waited)
                }
            };
            if !admitted {
                return Err(lost(best));
            }
            run.counts = counts;
            scene.duration = duration;
            return Ok(run);
        }
        change = next.abs();
        known = Some((duration, gap));
        duration += next.clamp(-LONGEST * duration, LONGEST * duration);
        if !duration.is_finite() || duration > waited * (1.0 + LONGEST) {
            return Err(lost(best));
        }
    }
    Err(lost(best))
}

/// Whether g − c, zero at the end, would turn back within one sample of a run over the longest
/// duration.
fn touches(gaps: &[f64], run: &Trajectory<f64>, waited: f64) -> bool {
    let [.., a, b, c] = gaps else {
        return false;
    };
    let last = gaps.len() - 1;
    let [first, second] = [last - 1, last].map(|k| run.time(k) - run.time(k - 1));
    let (before, now) = ((b - a) / first, (c - b) / second);
    // The slope changes at a constant rate from the middle of the last interval on.
    let bend = 2.0 * (before - now) / (first + second);
    let spacing = match run.has_cells {
        true => waited * CLOSE,
        false => waited / last as f64,
    };
    now * bend > 0.0 && now.abs() < spacing * bend.abs()
}

/// ∂g/∂T of a scene's event at the duration `duration`, by the complex step.
///
/// # Errors
/// If the run fails.
pub fn rate(
    scene: &Scene<f64>,
    settings: &Settings,
    duration: f64,
) -> Result<f64, IntegrationFailure> {
    let lifted = scene.map(&mut Complex64::from);
    let moved = Complex64::new(duration, COMPLEX_STEP);
    let run = simulate(&lifted.model, moved, settings)?;
    let until = lifted.until.as_ref();
    Ok(until.map_or(f64::NAN, |until| {
        until.gap(&lifted.model, &run).im / COMPLEX_STEP
    }))
}

/// The duration of a scene with an infinitesimal part, whose real part ends at `duration`; `rate`
/// is ∂g/∂T. Without an event, the scene's own.
///
/// # Errors
/// If the run fails.
pub fn complex_duration(
    scene: &Scene<Complex64>,
    settings: &Settings,
    (duration, rate): (f64, f64),
) -> Result<Complex64, IntegrationFailure> {
    let Some(until) = &scene.until else {
        return Ok(scene.duration);
    };
    let run = simulate(&scene.model, duration.into(), settings)?;
    let gap = until.gap(&scene.model, &run).im;
    Ok(Complex64::new(duration, -gap / rate))
}
