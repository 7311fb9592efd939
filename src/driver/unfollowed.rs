//! Vibrations that given steps do not follow.
//!
//! A flexible body that is loaded suddenly vibrates about its equilibrium. Implicit methods with longer steps damp these
//! vibrations away, with halved steps too: the results agree with each other and not with the motion, so no error is
//! known. Steps that follow the vibrations change their velocities v̇_0 h in the first step by about v̇_0 h, others by much less.

use super::evaluate::Evaluated;
use crate::integrate::{Method, Samples, Settings, Spacing, Trajectory, simulate};
use crate::model::Model;
use crate::problem::Problem;
use crate::system::flexible::MeanSquare;

/// Part of v̇_0 h by which the change of the velocities may differ from it.
const FOLLOWED: f64 = 0.5;
/// Elastic accelerations below this part of those of the whole scene do not excite vibrations that matter.
const EXCITED: f64 = 1e-3;
/// An equilibrium moves by at most this part of its deformation.
const BALANCED: f64 = 1e-8;
/// Vibrations that fall to this part of themselves within so many first steps leave the rest of the motion alone.
const DEAD: f64 = 0.1;
const FIRST: usize = 8;
/// Tolerance of steps that follow vibrations, and their largest number for each step of the motion.
const TOLERANCE: f64 = 1e-6;
const PER_STEP: usize = 8;
/// Samples of these vibrations for each step of the motion.
const SAMPLES: usize = 16;

/// Why the estimated errors of a motion with given steps say little, if so.
pub fn unfollowed(problem: &Problem, at: &Evaluated) -> Option<String> {
    let Spacing::Steps(_) = problem.simulation.spacing else {
        return None;
    };
    let (run, model) = (&at.run, &at.scene.model);
    if model.flexible.is_empty() || run.method == Method::Dop853 || run.grid.steps() == 0 {
        return None;
    }
    let numbering = &run.numbering;
    let bodies = MeanSquare::all(model);
    // Root of the mean square of the displacements by elastic coordinates.
    let size = |x: &[f64]| -> f64 {
        let all = bodies.iter();
        let squares = all.map(|own| own.value(|body, k| x[numbering.velocity(body) + k]));
        squares.sum::<f64>().sqrt()
    };
    let a = &run.initial.a;
    let whole = a
        .iter()
        .chain(run.a(run.last()))
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    if size(a) <= EXCITED * whole.max(model.gravity.norm()) {
        return None;
    }
    let h = run.duration * run.grid.width(1);
    let settings = Settings {
        solver: run.solver,
        samples: Samples::Uniform(1),
        limits: problem.simulation.limits.clone(),
        ..Settings::steps(run.method, 1)
    };
    let first = simulate(model, h, &settings).ok()?;
    let change = |i: usize| first.v(1)[i] - first.v(0)[i];
    let missed: Vec<f64> = (0..a.len()).map(|i| change(i) - h * a[i]).collect();
    if size(&missed) <= FOLLOWED * h * size(a) {
        return None;
    }
    // What remains of an equilibrium's round-off.
    let place = |body, k| numbering.position(body) + k;
    let (before, after) = (first.q(0), first.q(1));
    let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
        let all = bodies.iter();
        all.map(|own| own.value(|body, k| of(place(body, k)))).sum()
    };
    let moved = sum(&|i| after[i] - before[i]);
    if moved <= BALANCED.powi(2) * sum(&|i| before[i]) || die_out(model, run, size) {
        return None;
    }
    Some(
        "the steps do not follow vibrations that the start excites, so the errors are not known: they are at least those \
         estimated; \"start\": \"equilibrium\", a gradual load, damping of the material or a \"tolerance\" may help"
            .into(),
    )
}

/// Whether damping ends the vibrations within the first steps: after half of these, the elastic velocities are those of
/// steps that follow the vibrations, to a part of their largest.
fn die_out(model: &Model<f64>, run: &Trajectory<f64>, size: impl Fn(&[f64]) -> f64) -> bool {
    let steps = FIRST.min(run.grid.steps());
    let end = run.duration * run.grid.width(1) * steps as f64;
    let coarse = Settings {
        solver: run.solver,
        samples: Samples::Uniform(steps),
        ..Settings::steps(run.method, steps)
    };
    let mut fine = coarse.clone();
    fine.method = Method::Radau { stages: 3 };
    fine.spacing = Spacing::Tolerance(TOLERANCE);
    fine.samples = Samples::Uniform(SAMPLES * steps);
    fine.limits.steps = Some(PER_STEP * run.grid.steps());
    let (Ok(coarse), Ok(fine)) = (simulate(model, end, &coarse), simulate(model, end, &fine))
    else {
        return false;
    };
    let largest = (0..=fine.last()).fold(0.0_f64, |most, k| most.max(size(fine.v(k))));
    (steps / 2..=steps).all(|k| {
        let both = coarse.v(k).iter().zip(fine.v(SAMPLES * k));
        let apart: Vec<f64> = both.map(|(a, b)| a - b).collect();
        size(&apart) <= DEAD * largest
    })
}
