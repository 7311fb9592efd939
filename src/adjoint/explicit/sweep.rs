//! One function on its way back through the stages of a step.

use super::row;
use crate::adjoint::sensitivity::{Sensitivity, add_scaled, dot};
use crate::adjoint::workspace::Workspace;
use crate::functions::Scene;
use crate::integrate::Trajectory;
use crate::integrate::explicit::tableau::{ALL, B, END, dense_weights};
use crate::integrate::explicit::{NodeView, StepView, add_rows};
use crate::integrate::grid::SamplePlace;
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;
use crate::system::bodies;
use std::ops::Range;

/// One function with its cotangents of the stages.
pub(super) struct Sweep<'a> {
    /// Cotangents of the node after the step, and of the parameters.
    pub of: Sensitivity<'a>,
    /// Cotangents of q̇ and v̇ at the node after the step, as the step after it uses them.
    pub node: (Vec<f64>, Vec<f64>),
    /// Whether the march has come to an instant that the function depends on: before, every cotangent
    /// is zero.
    pub begun: bool,
    /// Which stages have cotangents.
    pub touched: [bool; ALL],
    /// Cotangents of q̇ and v̇ at the stages.
    qdot: Vec<f64>,
    a: Vec<f64>,
    /// What the step adds to the cotangents on the way to the node before it.
    before: (Vec<f64>, Vec<f64>),
    /// Vectors that are not in use.
    pub workspace: Workspace,
}

impl<'a> Sweep<'a> {
    pub(crate) fn new(of: Sensitivity<'a>, numbering: &Numbering) -> Self {
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

    /// Adds the function's own derivatives at sample k; `inside` is the step that it stands in and
    /// the node that this starts from.
    pub(crate) fn sample(
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
                // A function looks at few bodies: what lies between the first and the last.
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
                        // Accelerations do not scale with the step, as `leave_step` takes it.
                        let slope = dot(a, &row(data.a, nv, i)[in_v.clone()]);
                        self.of.by_duration -= rate * slope / run.duration;
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

    /// Pulls the cotangents of the derivatives at stage i back to its state (returned), where `field`
    /// stands.
    pub(crate) fn stage(
        &mut self,
        i: usize,
        field: &mut Accelerations<f64>,
        (q, v, fraction): (&[f64], &[f64], f64),
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
        self.of.by_duration += fraction * by_time;
        bodies::add_unit_cotangent(numbering, q, &y, &mut q_bar);
        self.workspace.back([y]);
        (q_bar, v_bar)
    }

    /// Hands the cotangents of a stage's state on to the stages that it was made of and to the node
    /// before the step.
    pub(crate) fn spread(&mut self, weights: &[(usize, f64)], (q, v): (&[f64], &[f64]), h: f64) {
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

    /// Pulls the cotangents of the derivatives at the node after the step back to its state, where
    /// `field` stands.
    pub(crate) fn node(
        &mut self,
        field: &mut Accelerations<f64>,
        to: NodeView<f64>,
        fraction: f64,
    ) {
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
            self.of.by_duration += fraction * by_time;
            bodies::add_unit_cotangent(field.numbering, to.q, &y, &mut q);
            self.of.q.add(1.0, &q);
            self.of.v.add(1.0, &v);
            self.workspace.back([q, v, y]);
        }
    }

    /// Pulls the cotangent of q̇ at the node back to its state.
    pub(crate) fn node_rates(&mut self, numbering: &Numbering, to: NodeView<f64>) {
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

    /// Hands the cotangents of the unprojected end on to the stages and to the node before.
    pub(crate) fn end(&mut self, h: f64) {
        let q = self.workspace.copy(&self.of.q.value);
        let v = self.workspace.copy(&self.of.v.value);
        self.hand_on(B, (&q, &v), h);
        self.workspace.back([q, v]);
    }

    /// Moves to the node before a step of a run of this duration. Whatever the derivatives k_i of the
    /// stages were used for, it was with weights that are proportional to the step's size h, and so
    /// h df/dh = Σ k̄_i · k_i.
    pub(crate) fn leave_step(&mut self, data: StepView<f64>, duration: f64) {
        let (nq, nv) = (self.before.0.len(), self.before.1.len());
        for i in (0..ALL).filter(|&i| self.touched[i]) {
            let slope = dot(row(&self.qdot, nq, i), row(data.qdot, nq, i))
                + dot(row(&self.a, nv, i), row(data.a, nv, i));
            self.of.by_duration += slope / duration;
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

/// Bodies from the first to the last that have a cotangent.
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
