//! The cotangents of one function during the backward march through implicit steps.

use crate::adjoint::sensitivity::Sensitivity;
use crate::functions::Scene;
use crate::integrate::grid::SamplePlace;
use crate::integrate::implicit::Stage;
use crate::integrate::implicit::formula::memory_size;
use crate::integrate::implicit::predict::dense;
use crate::integrate::implicit::radau::Scheme;
use crate::integrate::{Method, Trajectory};
use crate::math::slices::{add_scaled, dot};
use crate::system::Numbering;
use crate::system::bodies;
use crate::system::flexible;

/// Cotangents of positions (seven coordinates per body) and velocities, or of their increments or
/// rates.
pub(super) type Pair = (Vec<f64>, Vec<f64>);

/// One function with the cotangents that pass from step to step.
pub(super) struct Sweep<'a> {
    /// Cotangents of the state at the step's end and of the parameters.
    pub of: Sensitivity<'a>,
    /// Cotangents of the rates at the step's end (finally of the initial rates).
    pub rates: Pair,
    /// Cotangents of the formula's memory after the step, for q and v.
    pub memory: [Vec<Vec<f64>>; 2],
    /// Cotangents of the increments of the stages, from the dense output.
    pub increments: Vec<Pair>,
    /// Cotangents of the state at the step's start, from the dense output.
    pub before: Pair,
    /// Cotangent of the positions at a sample, and the motion there.
    q: Vec<f64>,
    at: Stage<f64>,
}

impl<'a> Sweep<'a> {
    pub fn new(
        of: Sensitivity<'a>,
        numbering: &Numbering,
        (method, stages): (Method, usize),
    ) -> Self {
        let lengths = [numbering.positions(), numbering.velocities()];
        Self {
            rates: pair(numbering),
            memory: lengths.map(|n| vec![vec![0.0; n]; memory_size(method)]),
            increments: vec![pair(numbering); stages],
            before: pair(numbering),
            of,
            q: vec![0.0; numbering.positions()],
            at: Stage::zero(numbering),
        }
    }

    /// Adds the derivatives of the function at sample k. `step` has the coefficients, the state at
    /// the start of the step, and its stages; (h, dh/dT) its size.
    pub fn sample(
        &mut self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        k: usize,
        (scheme, from, stages): (&Scheme, &Stage<f64>, &[Stage<f64>]),
        (h, growth): (f64, f64),
    ) {
        if !self.of.linearise(scene, run, k) {
            return;
        }
        let numbering = &run.numbering;
        let [y, v, a] = &self.of.sample;
        let q = &mut self.q;
        q.fill(0.0);
        match run.places[k] {
            SamplePlace::Inside { theta, .. } => {
                dense(scheme, from, stages, h, theta, &mut self.at);
                bodies::add_unit_cotangent(numbering, &self.at.q, y, q);
                let (w, rate) = scheme.dense_weights(theta);
                for (i, (by_q, by_v)) in self.increments.iter_mut().enumerate() {
                    add_scaled(by_q, w[i], q);
                    add_scaled(by_v, w[i], v);
                    add_scaled(by_v, rate[i] / h, a);
                }
                self.of.by_duration -= growth * dot(a, &self.at.vdot) / h;
                add_scaled(&mut self.before.0, 1.0, q);
                add_scaled(&mut self.before.1, 1.0, v);
            }
            SamplePlace::Node(_) => {
                bodies::rates_cotangent(numbering, run.q(k), y, q);
                self.of.q.add(1.0, q);
                self.of.v.add(1.0, v);
                add_scaled(&mut self.rates.1, 1.0, a);
            }
        }
    }

    /// Pulls the cotangents of a memory that starts as h times the rates at `start` back to these;
    /// `growth` is dh/dT.
    pub fn starting_memory(&mut self, start: &Stage<f64>, (h, growth): (f64, f64)) {
        let [by_q, by_v] = &mut self.memory;
        for (q, v) in by_q.iter().zip(&*by_v) {
            add_scaled(&mut self.rates.0, h, q);
            add_scaled(&mut self.rates.1, h, v);
            self.of.by_duration += growth * (dot(q, &start.qdot) + dot(v, &start.vdot));
        }
        by_q.iter_mut()
            .chain(by_v)
            .for_each(|memory| memory.fill(0.0));
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

/// Moves the cotangent of a state from the end of a step to its start. The derivative F_yᵀψ of the
/// equations of a stage (`change`, in tangent positions and velocities) is as small as the step and
/// is added. The equations do not depend on the Euler parameters along themselves: that part is
/// taken from `total`, the cotangent of the stage's positions with those of its increment and
/// rates.
pub(super) fn move_back(
    sweep: &mut Sweep,
    numbering: &Numbering,
    stage: &Stage<f64>,
    change: &[f64],
    total: &[f64],
) {
    let nv = numbering.velocities();
    let (of, q) = (&mut sweep.of, &mut sweep.q);
    bodies::rates_cotangent(numbering, &stage.q, &change[..nv], q);
    for body in 0..numbering.bodies() {
        let o = numbering.position(body) + 3;
        let (p, along) = (&stage.q[o..o + 4], &total[o..o + 4]);
        let radial = dot(p, along);
        for k in 0..4 {
            q[o + k] -= radial * p[k];
        }
    }
    of.q.add(1.0, q);
    of.v.add(1.0, &change[nv..2 * nv]);
}

/// Cotangents of the rates of a stage from its adjoint: (P(q)ᵀ ψ_1, Mᵀ ψ_2).
pub(super) fn rates_of(
    model: &crate::model::Model<f64>,
    numbering: &Numbering,
    q: &[f64],
    psi: &[f64],
    by: &mut Pair,
) {
    let nv = numbering.velocities();
    bodies::rates_cotangent(numbering, q, &psi[..nv], &mut by.0);
    bodies::mass_product(model, numbering, &psi[nv..2 * nv], &mut by.1);
    flexible::add_mass_product_at(model, numbering, q, &psi[nv..2 * nv], &mut by.1);
}

/// Adds `scale` times a pair.
pub(super) fn add(out: &mut Pair, scale: f64, x: &Pair) {
    add_scaled(&mut out.0, scale, &x.0);
    add_scaled(&mut out.1, scale, &x.1);
}

/// Adds the cotangents of a state.
pub(super) fn add_state(out: &mut Pair, of: &Sensitivity) {
    add_scaled(&mut out.0, 1.0, &of.q.value);
    add_scaled(&mut out.1, 1.0, &of.v.value);
}

/// A pair of zeros, of lengths n_q and n_v.
pub(super) fn pair(numbering: &Numbering) -> Pair {
    (
        vec![0.0; numbering.positions()],
        vec![0.0; numbering.velocities()],
    )
}

/// Sets a pair to zero.
pub(super) fn clear(x: &mut Pair) {
    x.0.fill(0.0);
    x.1.fill(0.0);
}

/// Copies a pair.
pub(super) fn copy(out: &mut Pair, x: &Pair) {
    out.0.copy_from_slice(&x.0);
    out.1.copy_from_slice(&x.1);
}

/// κ · ẏ.
pub(super) fn work(kappa: &Pair, stage: &Stage<f64>) -> f64 {
    dot(&kappa.0, &stage.qdot) + dot(&kappa.1, &stage.vdot)
}
