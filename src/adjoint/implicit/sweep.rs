//! One function on its way back through implicit steps.

use crate::adjoint::sensitivity::{Sensitivity, add_scaled, dot};
use crate::functions::Scene;
use crate::integrate::grid::Place;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::formula::memory_size;
use crate::integrate::implicit::predict::dense;
use crate::integrate::implicit::radau::Scheme;
use crate::integrate::{Method, Trajectory};
use crate::system::Numbering;
use crate::system::bodies;

/// Cotangents of positions (seven coordinates a body) and velocities, or of their increments or
/// rates.
pub(super) type Pair = (Vec<f64>, Vec<f64>);

/// One function with the cotangents that the steps hand on.
pub(super) struct Sweep<'a> {
    /// Cotangents of the state at the step's end, and of the parameters.
    pub of: Sensitivity<'a>,
    /// Cotangents of the rates at the step's end (at the start of all steps: of the initial rates).
    pub rates: Pair,
    /// Cotangents of the formula's memory after the step.
    pub memory: Vec<Pair>,
    /// Cotangents of the increments of the stages, by the dense output.
    pub increments: Vec<Pair>,
    /// Cotangents of the state at the step's start, by the dense output.
    pub before: Pair,
}

impl<'a> Sweep<'a> {
    pub fn new(of: Sensitivity<'a>, method: Method, stages: usize) -> Self {
        let zero = || (vec![0.0; of.q.value.len()], vec![0.0; of.v.value.len()]);
        Self {
            rates: zero(),
            memory: (0..memory_size(method)).map(|_| zero()).collect(),
            increments: (0..stages).map(|_| zero()).collect(),
            before: zero(),
            of,
        }
    }

    /// Adds the function's own derivatives at sample k; `step` are the coefficients, the state that
    /// the step starts from and its stages.
    pub fn sample(
        &mut self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        k: usize,
        (scheme, from, stages): (&Scheme, &Stage<f64>, &[Stage<f64>]),
        width: f64,
    ) {
        if !self.of.linearise(scene, run, k) {
            return;
        }
        let numbering = &run.numbering;
        let [y, v, a] = &self.of.sample;
        let mut q = vec![0.0; numbering.positions()];
        match run.places[k] {
            Place::Inside { theta, .. } => {
                let h = run.duration * width;
                let at = dense(scheme, from, stages, h, theta);
                bodies::add_unit_cotangent(numbering, &at.q, y, &mut q);
                let (w, rate) = scheme.dense_weights(theta);
                for (i, (by_q, by_v)) in self.increments.iter_mut().enumerate() {
                    add_scaled(by_q, w[i], &q);
                    add_scaled(by_v, w[i], v);
                    add_scaled(by_v, rate[i] / h, a);
                }
                self.of.by_duration -= width * dot(a, &at.vdot) / h;
                add_scaled(&mut self.before.0, 1.0, &q);
                add_scaled(&mut self.before.1, 1.0, v);
            }
            Place::Node(_) => {
                bodies::rates_cotangent(numbering, run.q(k), y, &mut q);
                self.of.q.add(1.0, &q);
                self.of.v.add(1.0, v);
                add_scaled(&mut self.rates.1, 1.0, a);
            }
        }
    }

    /// Hands the cotangents of a memory that started as h times the initial rates on to these.
    pub fn starting_memory(&mut self, start: &Stage<f64>, h: f64, width: f64) {
        for (q, v) in std::mem::take(&mut self.memory) {
            add_scaled(&mut self.rates.0, h, &q);
            add_scaled(&mut self.rates.1, h, &v);
            self.of.by_duration += width * (dot(&q, &start.qdot) + dot(&v, &start.vdot));
        }
    }

    /// Pulls the cotangent of the initial q̇ = T(q) v back to the initial state.
    pub fn pull_starting_rates(&mut self, numbering: &Numbering, start: &Stage<f64>) {
        let (q_bar, v_bar) = (&mut self.of.q.value, &mut self.of.v.value);
        bodies::pull_rates(
            numbering,
            (&start.q, &start.v),
            &self.rates.0,
            (q_bar, v_bar),
        );
    }
}

/// Moves the cotangent of a state from the end of a step to its start. What the equations of a
/// stage say of it, F_yᵀψ (`change`, tangent positions and velocities), is as small as the step and
/// is added as such; the part of `total` (the cotangent of the stage's positions, with those of
/// its increment and rates) along the Euler parameters, which the equations do not see, is taken
/// from it directly.
pub(super) fn move_back(
    of: &mut Sensitivity,
    numbering: &Numbering,
    stage: &Stage<f64>,
    change: &[f64],
    total: &[f64],
) {
    let nv = numbering.velocities();
    let mut q = vec![0.0; stage.q.len()];
    bodies::rates_cotangent(numbering, &stage.q, &change[..nv], &mut q);
    for body in 0..numbering.bodies() {
        let o = numbering.position(body) + 3;
        let (p, along) = (&stage.q[o..o + 4], &total[o..o + 4]);
        let radial = dot(p, along);
        for k in 0..4 {
            q[o + k] -= radial * p[k];
        }
    }
    of.q.add(1.0, &q);
    of.v.add(1.0, &change[nv..2 * nv]);
}

/// Cotangents of the rates of a stage from its adjoint: (P(q)ᵀ ψ_1, Mᵀ ψ_2).
pub(super) fn rates_of(
    model: &crate::model::Model<f64>,
    numbering: &Numbering,
    q: &[f64],
    psi: &[f64],
) -> Pair {
    let nv = numbering.velocities();
    let mut by = (vec![0.0; q.len()], vec![0.0; nv]);
    bodies::rates_cotangent(numbering, q, &psi[..nv], &mut by.0);
    bodies::mass_product(model, numbering, &psi[nv..2 * nv], &mut by.1);
    by
}

/// Adds `scale` times a pair.
pub(super) fn add(out: &mut Pair, scale: f64, x: &Pair) {
    add_scaled(&mut out.0, scale, &x.0);
    add_scaled(&mut out.1, scale, &x.1);
}

/// All zero, as large as `like`.
pub(super) fn zero(like: &Pair) -> Pair {
    (vec![0.0; like.0.len()], vec![0.0; like.1.len()])
}

/// κ · ẏ.
pub(super) fn work(kappa: &Pair, stage: &Stage<f64>) -> f64 {
    dot(&kappa.0, &stage.qdot) + dot(&kappa.1, &stage.vdot)
}
