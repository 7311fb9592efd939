//! Samples of explicit steps.

use super::record::{Node, NodeView};
use super::step::{StepFailure, Stepper};
use super::tape::{Block, Tape};
use crate::integrate::grid::{Grid, SamplePlace, place};
use crate::integrate::quadrature::{self, Intervals, Samples};
use crate::integrate::replay::Block as _;
use crate::integrate::trajectory::Trajectory;
use crate::linalg::SolveScalar;
use crate::model::Model;

/// Adds the samples of the last step of the grid.
///
/// # Errors
/// The stages of the dense output are not found.
pub fn sample<S: SolveScalar>(
    run: &mut Trajectory<S>,
    stepper: &mut Stepper<S>,
    (from, to): (NodeView<S>, NodeView<S>),
    samples: Samples,
    next: (&mut usize, &Intervals),
) -> Result<(), StepFailure> {
    let k = run.grid.steps();
    let start = run.grid.ends()[k - 1];
    let h = run.grid.size(run.duration, run.grid.width(k), start);
    let step = run.grid.step(k);
    if let Samples::Quadrature(_) = samples {
        run.weigh_start(&step);
    }
    for due in quadrature::due(samples, next, step) {
        let place = place(&run.grid, k, due.at);
        match place {
            SamplePlace::Node(_) => run.push(due, place, [to.q, to.v, to.a, &[]]),
            SamplePlace::Inside { theta, .. } => {
                if !stepper.data.dense {
                    let start = run.grid.time(run.duration, start);
                    stepper.dense_stages((from, to), (start, h))?;
                    run.counts.evaluations += super::tableau::ALL - super::tableau::END - 1;
                }
                let [q, v, a] = stepper.inside(from, h, theta);
                run.push(due, place, [q, v, a, &[]]);
            }
        }
    }
    Ok(())
}

/// Samples the steps of `tape` anew, to which the grid of `run` grows from its start alone. Returns them with the
/// stages of the dense output where samples need them.
///
/// # Errors
/// As [`sample`].
pub fn sample_again(
    (model, run): (&Model<f64>, &mut Trajectory<f64>),
    (tape, whole): (&Tape<f64>, &Grid),
    (samples, intervals): (Samples, &Intervals),
) -> Result<Block<f64>, StepFailure> {
    let numbering = run.numbering.clone();
    let mut stepper = Stepper::new(model, &numbering);
    let mut block = Block::new(&numbering, samples, true);
    let steps = tape.block.steps();
    block.restart(0);
    block.reserve(steps.len());
    let mut next = 1;
    for k in steps {
        if let Some(rows) = whole.left_out(k) {
            stepper.field.leave_out(rows);
        }
        stepper.data.set(tape.block.step(k));
        let ends: [Node<&[f64]>; 2] = [tape.block.node(k - 1), tape.block.node(k)];
        let before = run.places.len();
        run.grid.push(whole.ends()[k]);
        sample(
            run,
            &mut stepper,
            (ends[0], ends[1]),
            samples,
            (&mut next, intervals),
        )?;
        let inside = |place: &SamplePlace| matches!(place, SamplePlace::Inside { .. });
        stepper.data.dense = run.places[before..].iter().any(inside);
        block.push(ends, stepper.data.view());
    }
    run.counts.factorisations += stepper.field.factorisations;
    run.counts.solves += stepper.field.solves;
    Ok(block)
}
