//! Runs that end at an event: the duration T at which a quantity reaches its value, g(T) = c.
//!
//! The steps keep their fractions of T, so the whole discrete motion, with g at its end, is a
//! smooth function of T and of the design. The secant method finds the root to round-off. The last
//! step then ends exactly there, and
//!
//! ```text
//! dT/dx = −(∂g/∂x − ∂c/∂x) / (∂g/∂T),      df/dx = ∂f/∂x + ∂f/∂T dT/dx
//! ```
//!
//! with all partial derivatives by the adjoint of one run.

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
/// Longest step of the secant method, relative to the duration.
const LONGEST: f64 = 0.2;

/// The events that end a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Admit {
    /// Also those a little after the scene's duration.
    Late,
    /// Those within it.
    InTime,
    /// Those that come before its end by this part of it. A touch that other samples would miss
    /// does not count: steps chosen for this design alone must find the event too.
    Certain {
        /// The part.
        margin: f64,
    },
}

/// Approximate time of the event: the first change of sign of g − c in a run over the longest
/// duration, interpolated.
///
/// # Errors
/// [`IntegrationFailure::NotReached`].
pub(crate) fn first(
    until: &TerminalEvent<f64>,
    run: &Trajectory<f64>,
    gaps: &[f64],
) -> Result<f64, IntegrationFailure> {
    let start = side(gaps);
    let crossed = (1..gaps.len()).find(|&k| gaps[k] * start <= 0.0 && gaps[k - 1] != 0.0);
    let Some(k) = crossed else {
        let nearest = gaps.iter().fold(f64::INFINITY, |m: f64, g| m.min(g.abs()));
        return Err(IntegrationFailure::NotReached {
            quantity: until.describe(),
            value: until.value,
            nearest,
            waited: run.duration,
        });
    };
    let (before, after) = (gaps[k - 1], gaps[k]);
    let (t0, t1) = (run.time(k - 1), run.time(k));
    Ok(t0 + (t1 - t0) * before / (before - after))
}

/// The sign of g − c at the start, or just after it.
fn side(gaps: &[f64]) -> f64 {
    gaps.iter().find(|g| **g != 0.0).map_or(1.0, |g| g.signum())
}

/// The run of `scene` that ends at its event, with steps that keep their fractions. Starts near
/// `guess` \[s\]. Sets the scene's duration.
///
/// # Errors
/// If a run fails, or the event is not found, or not admitted.
pub(crate) fn settle(
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
            let start = side(&gaps);
            if gaps[..last].iter().any(|g| g * start < 0.0) {
                // It also came earlier, as finer samples show.
                duration = first(&until, &run, &gaps)?;
                (known, change) = (None, f64::INFINITY);
                continue;
            }
            let admitted = match admit {
                Admit::Late => true,
                Admit::InTime => duration <= waited,
                // The first search uses the samples of the whole time.
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
    let spacing = waited / (run.shown().len() - 1).max(1) as f64;
    now * bend > 0.0 && now.abs() < spacing * bend.abs()
}

/// ∂g/∂T of a scene's event at the duration `duration`, by the complex step.
///
/// # Errors
/// If the run fails.
pub(crate) fn rate(
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
pub(crate) fn complex_duration(
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
