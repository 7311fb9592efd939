//! The cotangents of one function during the backward march through a step.

use super::row;
use crate::adjoint::sensitivity::Sensitivity;
use crate::adjoint::workspace::Workspace;
use crate::functions::Scene;
use crate::integrate::Trajectory;
use crate::integrate::explicit::tableau::{ALL, B, END, dense_weights};
use crate::integrate::explicit::{NodeView, StepView, add_rows};
use crate::integrate::grid::SamplePlace;
use crate::math::slices::{add_scaled, dot};
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;
use crate::system::bodies;
use std::ops::Range;

/// One function with the cotangents of the stages.
pub(super) struct Sweep<'a> {
    /// Cotangents of the node after the step and of the parameters.
    pub of: Sensitivity<'a>,
    /// Cotangents of q̇ and v̇ at the node after the step, from the next step.
    pub node: (Vec<f64>, Vec<f64>),
    /// Whether the march has reached an instant on which the function depends. Until then every
    /// cotangent is zero.
    pub begun: bool,
    /// By stage: whether it has cotangents.
    pub touched: [bool; ALL],
    /// Cotangents of q̇ and v̇ at the stages: one row per stage.
    qdot: Vec<f64>,
    a: Vec<f64>,
    /// Contributions of the step to the cotangents of the node before it.
    before: (Vec<f64>, Vec<f64>),
    /// Unused vectors.
    pub workspace: Workspace,
}

impl<'a> Sweep<'a> {
    pub fn new(of: Sensitivity<'a>, numbering: &Numbering) -> Self {
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        Self {
            of,
            node: (vec![0.0; nq], vec![0.0; nv]),
            begun: false,
            touched: [false; ALL],
            qdot: vec![0.0; ALL * nq],
            a: vec![0.0; ALL * nv],
            before: (vec![0.0; nq], vec![0.0; nv]),
            workspace: Workspace::default(),
        }
    }

    /// Adds the derivatives of the function at sample k. `inside` is the step of the sample and the
    /// node from which it starts.
    pub fn sample(
        &mut self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        k: usize,
        inside: Option<(StepView<f64>, NodeView<f64>)>,
    ) {
        if !self.of.linearise(scene, run, k) {
            return;
        }
        self.begun = true;
        let numbering = &run.numbering;
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let [y, v, a] = &self.of.sample;
        let mut q = self.workspace.zeros(nq);
        match (run.places[k], inside) {
            (SamplePlace::Inside { step, theta }, Some((data, from))) => {
                let width = run.grid.width(step);
                let h = run.duration * width;
                let growth = run.grid.growth(run.grid.ends()[step - 1]);
                // A function depends on few bodies. Only the range from the first to the last is
                // processed.
                let bodies = touched_bodies(numbering, [y, v, a]);
                let (from_q, to_q) = (
                    numbering.position(bodies.start),
                    numbering.position(bodies.end),
                );
                let (from_v, to_v) = (
                    numbering.velocity(bodies.start),
                    numbering.velocity(bodies.end),
                );
                let (in_q, in_v) = (from_q..to_q, from_v..to_v);
                let (w, rate) = dense_weights(theta);
                let mut raw = self.workspace.zeros(nq);
                raw[in_q.clone()].copy_from_slice(&from.q[in_q.clone()]);
                let at = (nq, in_q.start);
                add_rows(&mut raw[in_q.clone()], h, &w, data.qdot, at);
                bodies::add_unit_cotangent(numbering, &raw, y, &mut q);
                self.workspace.back([raw]);
                let (q, v, a) = (&q[in_q.clone()], &v[in_v.clone()], &a[in_v.clone()]);
                let accelerated = a.iter().any(|&x| x != 0.0);
                for ((i, w), (_, rate)) in w.into_iter().zip(rate) {
                    self.touched[i] = true;
                    let by_q = &mut row_mut(&mut self.qdot, nq, i)[in_q.clone()];
                    add_scaled(by_q, h * w, q);
                    let by_a = &mut row_mut(&mut self.a, nv, i)[in_v.clone()];
                    add_scaled(by_a, h * w, v);
                    if accelerated {
                        add_scaled(by_a, rate, a);
                        // Accelerations are not multiplied by h, which `leave_step` assumes.
                        let slope = dot(a, &row(data.a, nv, i)[in_v.clone()]);
                        self.of.by_duration -= rate * slope / run.duration * growth;
                    }
                }
                add_scaled(&mut self.before.0[in_q], 1.0, q);
                add_scaled(&mut self.before.1[in_v], 1.0, v);
            }
            _ => {
                bodies::rates_cotangent(numbering, run.q(k), y, &mut q);
                self.of.q.add(1.0, &q);
                self.of.v.add(1.0, v);
                add_scaled(&mut self.node.1, 1.0, a);
            }
        }
        self.workspace.back([q]);
    }

    /// Pulls the cotangents of the derivatives at stage i back to its state, at which `field` is
    /// evaluated; its time has this `rate` in the duration. Returns the cotangents (q, v) of this state.
    pub fn stage(
        &mut self,
        i: usize,
        field: &mut Accelerations<f64>,
        (q, v, rate): (&[f64], &[f64], f64),
        found: (&[f64], &[f64]),
    ) -> (Vec<f64>, Vec<f64>) {
        let numbering = field.numbering;
        let (nq, nv) = (q.len(), v.len());
        let (qdot_bar, a_bar) = (row(&self.qdot, nq, i), row(&self.a, nv, i));
        let workspace = &mut self.workspace;
        let (mut q_bar, mut v_bar, mut y) = (
            workspace.zeros(nq),
            workspace.zeros(nv),
            workspace.zeros(nv),
        );
        bodies::pull_rates(numbering, (q, v), qdot_bar, (&mut q_bar, &mut v_bar));
        let cot = &mut self.of.cot.model;
        let by_time = field.pull_back(found, a_bar, (&mut y, &mut v_bar), cot);
        self.of.by_duration += rate * by_time;
        bodies::add_unit_cotangent(numbering, q, &y, &mut q_bar);
        self.workspace.back([y]);
        (q_bar, v_bar)
    }

    /// Adds the cotangents of a stage's state to those of the earlier stages and of the node before
    /// the step.
    pub fn spread(&mut self, weights: &[(usize, f64)], (q, v): (&[f64], &[f64]), h: f64) {
        add_scaled(&mut self.before.0, 1.0, q);
        add_scaled(&mut self.before.1, 1.0, v);
        self.hand_on(weights, (q, v), h);
    }

    fn hand_on(&mut self, weights: &[(usize, f64)], (q, v): (&[f64], &[f64]), h: f64) {
        for &(j, weight) in weights {
            self.touched[j] = true;
            add_scaled(row_mut(&mut self.qdot, q.len(), j), h * weight, q);
            add_scaled(row_mut(&mut self.a, v.len(), j), h * weight, v);
        }
    }

    /// Pulls the cotangents of the derivatives at the node after the step back to its state, at
    /// which `field` is evaluated; its time has this `rate` in the duration.
    pub fn node(&mut self, field: &mut Accelerations<f64>, to: NodeView<f64>, rate: f64) {
        let (nq, nv) = (to.q.len(), to.v.len());
        if self.touched[END] {
            add_scaled(&mut self.node.0, 1.0, row(&self.qdot, nq, END));
            add_scaled(&mut self.node.1, 1.0, row(&self.a, nv, END));
        }
        self.node_rates(field.numbering, to);
        if self.node.1.iter().any(|&x| x != 0.0) {
            let workspace = &mut self.workspace;
            let (mut q, mut v, mut y) = (
                workspace.zeros(nq),
                workspace.zeros(nv),
                workspace.zeros(nv),
            );
            let found = (to.a, to.lambda);
            let cot = &mut self.of.cot.model;
            let by_time = field.pull_back(found, &self.node.1, (&mut y, &mut v), cot);
            self.of.by_duration += rate * by_time;
            bodies::add_unit_cotangent(field.numbering, to.q, &y, &mut q);
            self.of.q.add(1.0, &q);
            self.of.v.add(1.0, &v);
            self.workspace.back([q, v, y]);
        }
    }

    /// Pulls the cotangent of q̇ at the node back to its state.
    pub fn node_rates(&mut self, numbering: &Numbering, to: NodeView<f64>) {
        let (mut q, mut v) = (
            self.workspace.zeros(to.q.len()),
            self.workspace.zeros(to.v.len()),
        );
        let bars = (&mut q[..], &mut v[..]);
        bodies::pull_rates(numbering, (to.q, to.v), &self.node.0, bars);
        self.of.q.add(1.0, &q);
        self.of.v.add(1.0, &v);
        self.workspace.back([q, v]);
    }

    /// Adds the cotangents of the unprojected end to those of the stages and of the node before.
    pub fn end(&mut self, h: f64) {
        let q = self.workspace.copy(&self.of.q.value);
        let v = self.workspace.copy(&self.of.v.value);
        self.hand_on(B, (&q, &v), h);
        self.workspace.back([q, v]);
    }

    /// Moves to the node before a step of a run with this duration T, whose size h has the derivative
    /// dh/dT = h `growth` / T. The derivatives k_i of the stages always have weights proportional to the step size h,
    /// so h df/dh = Σ k̄_i · k_i.
    pub fn leave_step(&mut self, data: StepView<f64>, (duration, growth): (f64, f64)) {
        let (nq, nv) = (self.before.0.len(), self.before.1.len());
        for i in (0..ALL).filter(|&i| self.touched[i]) {
            let slope = dot(row(&self.qdot, nq, i), row(data.qdot, nq, i))
                + dot(row(&self.a, nv, i), row(data.a, nv, i));
            self.of.by_duration += slope / duration * growth;
        }
        self.of.q.add(1.0, &self.before.0);
        self.of.v.add(1.0, &self.before.1);
        self.before.0.fill(0.0);
        self.before.1.fill(0.0);
        self.node.0.copy_from_slice(&self.qdot[..nq]);
        self.node.1.copy_from_slice(&self.a[..nv]);
        self.qdot.fill(0.0);
        self.a.fill(0.0);
        self.touched = [false; ALL];
    }
}

/// Range from the first to the last body with a cotangent.
fn touched_bodies(numbering: &Numbering, cotangents: [&[f64]; 3]) -> Range<usize> {
    let touched = |body: &usize| {
        let o = numbering.velocity(*body);
        cotangents
            .iter()
            .any(|all| all[o..o + 6].iter().any(|&x| x != 0.0))
    };
    let first = (0..numbering.bodies()).find(touched).unwrap_or(0);
    let last = (first..numbering.bodies()).rfind(touched);
    first..last.map_or(first, |last| last + 1)
}

fn row_mut(rows: &mut [f64], width: usize, i: usize) -> &mut [f64] {
    &mut rows[i * width..(i + 1) * width]
}
