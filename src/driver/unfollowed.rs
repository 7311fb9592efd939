//! Vibrations that given steps do not follow.
//!
//! A flexible body that is loaded suddenly vibrates about its equilibrium. Implicit methods with longer steps damp these
//! vibrations away, with halved steps too: the results agree with each other and not with the motion, so no error is
//! known. Steps that follow the vibrations change their velocities v̇_0 h in the first step by about v̇_0 h, others by much less.

use super::evaluate::Evaluated;
use crate::integrate::{Method, Samples, Settings, Spacing, simulate};
use crate::problem::Problem;
use crate::system::flexible::MeanSquare;

/// Part of v̇_0 h by which the change of the velocities may differ from it.
const FOLLOWED: f64 = 0.5;
/// Elastic accelerations below this part of those of the whole scene do not excite vibrations that matter.
const EXCITED: f64 = 1e-3;

/// Why the estimated errors of a motion with given steps say little, if so.
pub(crate) fn unfollowed(problem: &Problem, at: &Evaluated) -> Option<String> {
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
    (size(&missed) > FOLLOWED * h * size(a)).then(|| {
        "the steps do not follow vibrations that the start excites, so the errors are not known: they are at least those \
         estimated; \"start\": \"equilibrium\", a gradual load, damping of the material or a \"tolerance\" may help"
            .into()
    })
}
