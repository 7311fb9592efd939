//! Samples of implicit steps.

use super::Stage;
use super::predict::dense;
use super::radau::Scheme;
use super::tape::Tape;
use crate::integrate::grid::{Grid, SamplePlace, place};
use crate::integrate::quadrature::{self, Due, Intervals, Samples};
use crate::integrate::replay::Block as _;
use crate::integrate::trajectory::Trajectory;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::{bodies, turns};

/// Adds the samples of the last step of the grid, from its start and its stages.
pub fn sample<S: SolveScalar>(
    run: &mut Trajectory<S>,
    scheme: &Scheme,
    (from, stages): (&Stage<S>, &[Stage<S>]),
    (samples, due): (Samples, impl Iterator<Item = Due>),
    inside: &mut Stage<S>,
) {
    let k = run.grid.steps();
    let h = run
        .grid
        .size(run.duration, run.grid.width(k), run.grid.ends()[k - 1]);
    let last = &stages[stages.len() - 1];
    let step = run.grid.step(k);
    if let Samples::Quadrature(_) = samples {
        run.weigh_start(&step);
    }
    for due in due {
        let place = place(&run.grid, k, due.at);
        match place {
            SamplePlace::Node(_) => {
                run.push(due, place, [&last.q, &last.v, &last.vdot, &last.lambda])
            }
            SamplePlace::Inside { theta, .. } => {
                dense(scheme, from, stages, h, theta, inside);
                bodies::bring_to_unit(&run.numbering, &mut inside.q);
                let Stage {
                    q, v, vdot, lambda, ..
                } = &*inside;
                run.push(due, place, [q, v, vdot, lambda]);
            }
        }
    }
}

/// Samples the steps of `tape` anew, to which the grid of `run` grows from its start alone.
pub fn sample_again(
    (model, run): (&Model<f64>, &mut Trajectory<f64>),
    (tape, whole): (&Tape<f64>, &Grid),
    (samples, intervals): (Samples, &Intervals),
) {
    let numbering = run.numbering.clone();
    let scheme = Scheme::of(run.method);
    let new = || Stage::zero(&numbering);
    let (mut from, mut inside) = (new(), new());
    let mut stages: Vec<Stage<f64>> = (0..scheme.stages()).map(|_| new()).collect();
    let mut next = 1;
    for k in tape.block.steps() {
        tape.block.read_end(k - 1, &mut from);
        turns::count(model, &numbering, &mut from.q);
        let count = tape.block.read(k, &mut stages);
        run.grid.push(whole.ends()[k]);
        let due = quadrature::due(samples, (&mut next, intervals), run.grid.step(k));
        let all = (&from, &stages[..count]);
        sample(run, &scheme, all, (samples, due), &mut inside);
    }
}
