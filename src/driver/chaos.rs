//! Chaotic motions: they magnify perturbations until derivatives lose their meaning.
//!
//! A change Δx of a variable, of the variable's own size, moves the bodies by T(t) in units of the
//! scene's length, to first order. Errors of relative size ε, made in every step, grow in the same
//! way. If ε T(t) reaches one, the computed motion differs from the true one, and its derivatives
//! are meaningless. T is computed by one complex step, and only if a derivative is so large that ε
//! Δx df/dx reaches the size of its function.

use super::evaluate::Evaluated;
use super::integration::Integration;
use super::size::function_size;
use crate::integrate::{Samples, Settings, Spacing, Trajectory, simulate};
use crate::math::scalar::COMPLEX_STEP;
use crate::math::{Complex64, Scalar};
use crate::problem::Problem;
use crate::system::placement::length_scale;

/// Least relative error of a step, by round-off.
const ROUND_OFF: f64 = 1e-14;
/// Number of instants at which the growth is evaluated.
const SAMPLES: usize = 1000;
/// The duration is marched in this number of parts, one after the other.
const PARTS: [f64; 5] = [0.0625, 0.125, 0.25, 0.5, 1.0];

/// A chaotic motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Chaos {
    /// Time from which on derivatives are meaningless \[s\].
    pub from: f64,
    /// Duration of the motion \[s\].
    pub duration: f64,
    /// Relative error of a step.
    pub error: f64,
    /// Growth T of a perturbation until then.
    pub growth: f64,
}

impl std::fmt::Display for Chaos {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "the motion is chaotic: by t = {:.4} s of {} s it magnifies perturbations {:.0e} times, and with \
             them the errors of the steps (relative {:.0e}); functions that look at later times, and \
             their derivatives, mean nothing; shorten the duration",
            self.from, self.duration, self.growth, self.error
        )
    }
}

/// Whether the motion of the design `x` is chaotic, judged by all functions. `None` also if it
/// cannot be simulated.
pub fn chaos(problem: &Problem, x: &[f64]) -> Option<Chaos> {
    let scene = problem.scene(x);
    let which: Vec<usize> = (0..scene.functions.len()).collect();
    let mut integration = Integration::new(problem, &scene, Some(&which), true);
    let (at, _) = Evaluated::with(&mut integration, problem, x).ok()?;
    of_motion(problem, &at, &which)
}

/// As [`chaos`], of a design that was simulated, judged by the functions `which`.
pub fn of_motion(problem: &Problem, at: &Evaluated, which: &[usize]) -> Option<Chaos> {
    if at.x.is_empty() || which.is_empty() || at.is_rest() {
        return None;
    }
    // Gradients that cannot be computed are suspicious too.
    let gradients = match at.gradients(problem, which) {
        Ok((gradients, _)) => gradients,
        Err(_) => vec![vec![f64::NAN; at.x.len()]; which.len()],
    };
    let error = match problem.simulation.spacing {
        Spacing::Tolerance(tolerance) => tolerance.max(ROUND_OFF),
        Spacing::Steps(_) | Spacing::Frozen(_) => ROUND_OFF,
    };
    let change = |i: usize| match at.x[i] {
        0.0 => problem.variables[i].scale,
        x => x.abs(),
    };
    let mut suspicious: Vec<(f64, usize)> = Vec::new();
    for (&f, gradient) in which.iter().zip(&gradients) {
        let size = function_size(at, f);
        let ratio = |(i, d): (usize, &f64)| (error * (d * change(i)).abs() / size, i);
        suspicious.extend(gradient.iter().enumerate().map(ratio));
    }
    // A derivative that is NaN counts as larger than any.
    let worst =
        (suspicious.into_iter()).reduce(|a, b| if b.0 > a.0 || b.0.is_nan() { b } else { a });
    let (_, i) = worst.filter(|(ratio, _)| ratio.is_nan() || *ratio >= 1.0)?;
    confirm(problem, at, (i, change(i)), error)
}

/// Integrates again with an infinitesimal change of variable i, and finds the time at which it has
/// grown to the size of the scene.
fn confirm(
    problem: &Problem,
    at: &Evaluated,
    (i, change): (usize, f64),
    error: f64,
) -> Option<Chaos> {
    let mut x: Vec<Complex64> = at.x.iter().map(|&x| x.into()).collect();
    x[i].im = COMPLEX_STEP;
    let scene = problem.scene(&x);
    let settings = Settings {
        // This run chooses its own steps: those of another run do not suit it once the two differ.
        spacing: problem.simulation.spacing.clone(),
        samples: Samples::Uniform(SAMPLES),
        limits: problem.simulation.limits.clone(),
        derivatives: true,
        ..Settings::steps(at.run.method, 1)
    };
    let duration = at.run.duration;
    let length = length_scale(&at.scene.model);
    // The motion after the growth does not matter and may fail.
    for part in PARTS {
        let run = simulate(&scene.model, (part * duration).into(), &settings).ok()?;
        let growth = |k: usize| moved(&run, k, length) * change / COMPLEX_STEP;
        let apart = |growth: f64| growth.is_nan() || error * growth >= 1.0;
        if let Some(k) = (0..=run.last()).find(|&k| apart(growth(k))) {
            return Some(Chaos {
                from: run.time(k).re(),
                duration,
                error,
                growth: growth(k),
            });
        }
    }
    None
}

/// Largest infinitesimal motion of a body at instant k, in units of the scene's length.
fn moved(run: &Trajectory<Complex64>, k: usize, length: f64) -> f64 {
    let part = |x: &[Complex64]| x.iter().map(|x| x.im * x.im).sum::<f64>().sqrt();
    let of = |body: &[Complex64]| part(&body[..3]) / length + part(&body[3..]);
    run.q(k).chunks_exact(7).map(of).fold(0.0, f64::max)
}
