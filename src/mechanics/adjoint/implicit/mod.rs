//! The backward march through the implicit methods.
//!
//! Let κ be the cotangent of the rates ẏ of a stage, and m̄ those of a formula's memory. Step k of
//! a formula backwards is
//!
//! ```text
//! Jᵀ ψ  = −[ Tᵀ(ȳ_k + (c/h) κ⁰ + Σ f_i m̄_i') ; 0 ; 0 ]
//! κ     = κ⁰ + F_ẏᵀ ψ,            m̄_j = (e_j/h) κ + Σ_i F_ij m̄_i'
//! ȳ_k−1 = −(c/h) κ − Σ f_i m̄_i'
//! df/dh = −κ · ẏ / h,             df/dx += ψᵀ ∂F/∂x
//! ```
//!
//! For Radau IIA with the increments Z_j and Ẏ_i = Σ_j D_ij Z_j / h, let Z̄_j be the cotangents of
//! Z_j from the dense output. A step backwards is
//!
//! ```text
//! Σ_i [δ_ij F_y + (D_ij/h) F_ẏ]_iᵀ ψ_i = −Tᵀ( δ_js ȳ_n+1 + Z̄_j + Σ_i (D_ij/h) κ⁰_i )
//! κ_i = κ⁰_i + F_ẏ,iᵀ ψ_i,        ȳ_n = −Σ_j ( Z̄_j + Σ_i (D_ij/h) κ_i )
//! ```
//!
//! All functions share one factorisation per step. (Kennedy & Boopathy, eq. 6 and 7, in increments
//! instead of values, and with the initial conditions, which the paper omits.)

mod formula;
mod radau;
mod step;
mod sweep;

use super::sensitivity::Sensitivity;
use super::{AdjointRun, Target};
use crate::functions::Scene;
use crate::integrate::implicit::formula::{Formula, remembers_start};
use crate::integrate::implicit::radau::Scheme;
use crate::integrate::implicit::solver::starting_stage;
use crate::integrate::implicit::{Replayer, Tape};
use crate::integrate::replay::Replay;
use crate::integrate::{IntegrationFailure, Trajectory, WorkCounts};
use crate::system::flexible;
use crate::system::kkt::SaddlePoint;
use rayon::prelude::*;
use step::Step;
use sweep::Sweep;

/// See [`super::gradients`].
pub(super) fn gradients(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    tape: &Tape<f64>,
    targets: &[Target],
) -> Result<AdjointRun, IntegrationFailure> {
    let (model, numbering) = (&scene.model, &run.numbering);
    let scheme = Scheme::of(run.method);
    let stages = scheme.stages();
    let new = |target: &Target| {
        let of = Sensitivity::new(scene, run, target);
        Sweep::new(of, numbering, (run.method, stages))
    };
    let mut sweeps: Vec<Sweep> = targets.iter().map(new).collect();
    let mut one = None;
    let mut coupled = None;
    let shells = flexible::has_shells(model);
    let side_by_side = shells && flexible::team(model).is_alone();
    let mut counts = WorkCounts::default();
    let mut replay = Replay::new(tape, run.grid.steps(), || {
        Replayer::new(model, run, &scheme)
    });
    let start = starting_stage(numbering, &run.initial);
    let mut sample = run.last();
    let [mut step, mut before] = [0, 1].map(|_| Step::new(numbering, stages));
    for k in (1..=run.grid.steps()).rev() {
        if run.limits.is_over() {
            return Err(IntegrationFailure::Interrupted);
        }
        if before.number == k {
            std::mem::swap(&mut step, &mut before);
        } else {
            step.read(run, replay.block(k)?, k);
        }
        while run.places[sample].step() == k {
            let own = (&scheme, &step.from, step.stages());
            let size = (step.size, step.growth);
            let add = |sweep: &mut Sweep| sweep.sample(scene, run, sample, own, size);
            match side_by_side {
                true => sweeps.par_iter_mut().for_each(add),
                false => sweeps.iter_mut().for_each(add),
            }
            sample -= 1;
        }
        let found = match Formula::of_step(run.method, step.in_part) {
            Some(formula) => {
                let known = shells && k > 1;
                let before_it = || Formula::of_step(run.method, run.grid.in_part(k - 1));
                let ahead = known.then(before_it).flatten();
                if ahead.is_some() {
                    before.read(run, replay.block(k - 1)?, k - 1);
                }
                let ahead = ahead.as_ref().map(|formula| (formula, &before));
                one.get_or_insert_with(|| {
                    formula::BackwardStage::new(model, numbering, run.solver.linear)
                })
                .step((&formula, &step), ahead, &mut sweeps, &mut counts)
            }
            None => {
                // Matrices of shells are large, and the first steps of a formula are the last ones here.
                if shells {
                    one = None;
                }
                coupled
                    .get_or_insert_with(|| radau::BackwardStage::new(model, numbering, &scheme))
                    .step(&step, &mut sweeps, &mut counts)
            }
        };
        found.map_err(|place| IntegrationFailure::Singular {
            time: run.duration * run.grid.ends()[k],
            step: k,
            place,
        })?;
        if step.in_part == 1 && remembers_start(run.method) {
            for sweep in &mut sweeps {
                sweep.starting_memory(&step.from, (step.size, step.growth));
            }
        }
        counts.steps += 1;
    }
    if let Some(again) = replay.march() {
        counts += again.counts;
    }
    counts.recomputed += replay.again;
    drop((one, coupled));
    let mut saddle = SaddlePoint::new(model, numbering);
    let start = &start;
    for sweep in &mut sweeps {
        sweep.sample(scene, run, 0, (&scheme, start, &[]), (0.0, 0.0));
        sweep.pull_starting_rates(numbering, start);
        let Sweep { of, rates, .. } = sweep;
        of.finish(scene, run, &mut saddle, &rates.1, &mut counts)?;
    }
    let both = |sweep: Sweep| (sweep.of.cot, sweep.of.modes);
    let (gradients, modes) = sweeps.into_iter().map(both).unzip();
    Ok(AdjointRun {
        gradients,
        modes,
        counts,
    })
}
