//! The backward march through DOP853 and its projections.
//!
//! Let k_i = (q̇_i, v̇_i) be the derivatives at the stages, let a bar denote the derivative of the
//! function, and let F map the state of a stage to its derivatives. Step n backwards is
//!
//! ```text
//! ȳ*  += Fᵀ k̄_0(n+1)                           Sweep::node: the node's own derivatives
//! ȳ~   = (projection)ᵀ ȳ*                       projection::pull_back
//! k̄_i += h b_i ȳ~,     ȳ_n = ȳ~                 Sweep::end
//! i = 11 … 1:   ȳ_i = Fᵀ k̄_i                    Sweep::stage
//!               k̄_j += h a_ij ȳ_i,  ȳ_n += ȳ_i  Sweep::spread
//! df/dh = Σ k̄_j · k_j / h                       Sweep::leave_step
//! ```
//!
//! Times and step sizes depend on the duration by [`Grid::rate`](crate::integrate::Grid) and `growth`.
//!
//! (Hager 2000; Sandu 2006.) It needs one symmetric solve per stage and function. All functions
//! share the factors of a stage. If a sample lies inside the step, the stages 15 to 13 of the dense
//! output come first. Test: tests/dynamics/gradients_match_complex_step.rs.

mod projection;
mod sweep;

use super::sensitivity::Sensitivity;
use super::{AdjointRun, Target};
use crate::functions::Scene;
use crate::integrate::explicit::march::failed;
use crate::integrate::explicit::step::StepFailure;
use crate::integrate::explicit::tableau::{A, ALL, C, END, STAGES};
use crate::integrate::explicit::{NodeView, Replayer, Tape};
use crate::integrate::replay::Replay;
use crate::integrate::{IntegrationFailure, Trajectory, WorkCounts, has_kinks, stage_time};
use crate::system::accelerations::Accelerations;
use crate::system::kkt::SaddlePoint;
use sweep::Sweep;

/// See [`super::gradients`].
pub(super) fn gradients(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    tape: &Tape<f64>,
    targets: &[Target],
) -> Result<AdjointRun, IntegrationFailure> {
    let (model, numbering) = (&scene.model, &run.numbering);
    let new = |target: &Target| Sweep::new(Sensitivity::new(scene, run, target), numbering);
    let mut sweeps: Vec<Sweep> = targets.iter().map(new).collect();
    let mut field = Accelerations::new(model, numbering);
    let mut scratch = scene.zero_cotangent().model;
    let mut replay = Replay::new(tape, run.grid.steps(), || Replayer::new(model, run));
    let mut sample = run.last();
    let mut counts = WorkCounts::default();
    let kinks = has_kinks(model);
    for n in (1..=run.grid.steps()).rev() {
        if run.limits.is_over() {
            return Err(IntegrationFailure::Interrupted);
        }
        let h = run.duration * run.grid.width(n);
        let (begin, end) = (run.grid.ends()[n - 1], run.grid.ends()[n]);
        let (growth, rate) = (run.grid.growth(begin), run.grid.rate(end));
        let first = first_sample(run, n, sample);
        let samples = first..=sample;
        sample = first - 1;
        counts.steps += 1;
        // No function may depend on the end of the motion.
        let concerns =
            |sweep: &Sweep| sweep.begun || samples.clone().any(|k| sweep.of.depends_on(run, k));
        if !sweeps.iter().any(concerns) {
            continue;
        }
        let failed = |failure| failed(failure, (model, numbering), (n, run.duration * end));
        let singular = |singular| failed(StepFailure::Singular(singular));
        if let Some(rows) = run.grid.left_out(n) {
            field.leave_out(rows);
        }
        let block = replay.block(n)?;
        let (from, to, data) = (block.node(n - 1), block.node(n), block.step(n));
        for k in samples.rev() {
            for sweep in &mut sweeps {
                sweep.sample(scene, run, k, Some((data, from)));
            }
        }
        let stage = |i: usize, field: &mut Accelerations<f64>, sweeps: &mut [Sweep]| {
            if sweeps.iter().all(|sweep| !sweep.touched[i]) {
                return Ok(());
            }
            let (nq, nv, nc) = (from.q.len(), from.v.len(), from.lambda.len());
            let (q, v) = (row(data.q, nq, i), row(data.v, nv, i));
            let rate = run.grid.rate(begin) + run.grid.width(n) * growth * C[i];
            let time = stage_time((run.duration * begin, h), C[i], kinks);
            field.set_state(q, v, time);
            field.factorise()?;
            let found = (row(data.a, nv, i), row(data.lambda, nc, i));
            for sweep in sweeps.iter_mut().filter(|sweep| sweep.touched[i]) {
                let (q, v) = sweep.stage(i, field, (q, v, rate), found);
                sweep.spread(A[i], (&q, &v), h);
                sweep.workspace.back([q, v]);
            }
            Ok(())
        };
        if data.dense {
            for i in (END + 1..ALL).rev() {
                stage(i, &mut field, &mut sweeps).map_err(singular)?;
            }
        }
        field.set_state(to.q, to.v, run.duration * end);
        field.factorise().map_err(singular)?;
        for sweep in sweeps.iter_mut().filter(|sweep| sweep.begun) {
            sweep.node(&mut field, to, rate);
            projection::pull_back(sweep, &mut field, data, to, (&mut scratch, rate));
            sweep.end(h);
        }
        for i in (1..STAGES).rev() {
            stage(i, &mut field, &mut sweeps).map_err(singular)?;
        }
        for sweep in &mut sweeps {
            sweep.leave_step(data, (run.duration, growth));
        }
    }
    counts.factorisations += field.factorisations;
    counts.solves += field.solves;
    if let Some(again) = replay.march() {
        counts.factorisations += again.stepper.field.factorisations;
        counts.solves += again.stepper.field.solves;
    }
    counts.recomputed += replay.again;
    let start = NodeView {
        q: &run.initial.q,
        v: &run.initial.v,
        a: &run.initial.a,
        lambda: &run.initial.lambda,
    };
    let mut saddle = SaddlePoint::new(model, numbering);
    for sweep in &mut sweeps {
        sweep.sample(scene, run, 0, None);
        sweep.node_rates(numbering, start);
        let Sweep { of, node, .. } = sweep;
        of.finish(scene, run, &mut saddle, &node.1, &mut counts)?;
    }
    let both = |sweep: Sweep| (sweep.of.cot, sweep.of.modes);
    let (gradients, modes) = sweeps.into_iter().map(both).unzip();
    Ok(AdjointRun {
        gradients,
        modes,
        counts,
    })
}

/// The first sample, among those up to `last`, that lies in step n.
fn first_sample(run: &Trajectory<f64>, n: usize, last: usize) -> usize {
    let earlier = run.places[..=last].iter().rev();
    last + 1 - earlier.take_while(|place| place.step() == n).count()
}

fn row(rows: &[f64], width: usize, i: usize) -> &[f64] {
    &rows[i * width..(i + 1) * width]
}
