//! One function on its way back: its adjoint, and the cotangents of rates that it leaves behind.

use crate::functions::evaluate::Linearised;
use crate::functions::measure::{Snapshot, SnapshotCotangent};
use crate::functions::{Function, Scene};
use crate::integrate::Trajectory;
use crate::math::rotation;
use crate::system::bodies::{self, positions_of, velocities_of};
use std::collections::VecDeque;

/// Cotangents of the rates of one step, and their increments from the step after it.
#[derive(Clone)]
struct RateCotangents {
    qdot: Vec<f64>,
    qdot_increment: Vec<f64>,
    vdot: Vec<f64>,
    vdot_increment: Vec<f64>,
}

/// One function on its way back.
pub(super) struct Sweep<'a> {
    linearised: Linearised<'a>,
    own: usize,
    /// Derivatives in the parameters of the scene so far.
    pub cot: Scene<f64>,
    /// ψ of the latest step, unscaled.
    pub psi: Vec<f64>,
    /// Right-hand side by tangent positions.
    pub y: Vec<f64>,
    /// Right-hand side by velocities.
    pub v: Vec<f64>,
    /// Partial derivatives by accelerations at this instant.
    pub a: Vec<f64>,
    /// The same at the instant after it.
    a_later: Vec<f64>,
    /// Steps k + 1, k + 2, …, k + m.
    later: VecDeque<RateCotangents>,
    by_h: f64,
}

impl<'a> Sweep<'a> {
    /// Function `own` of the scene at the end of `run`, for a formula of order m.
    pub fn new(scene: &'a Scene<f64>, run: &Trajectory<f64>, own: usize, m: usize) -> Self {
        let numbering = &run.numbering;
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nothing = RateCotangents {
            qdot: vec![0.0; nq],
            qdot_increment: vec![0.0; nq],
            vdot: vec![0.0; nv],
            vdot_increment: vec![0.0; nv],
        };
        Self {
            linearised: Linearised::new(&scene.functions[own], &scene.model, run),
            own,
            cot: scene.zero_cotangent(),
            psi: vec![0.0; 2 * (nv + numbering.constraints())],
            y: vec![0.0; nv],
            v: vec![0.0; nv],
            a: vec![0.0; nv],
            a_later: vec![0.0; nv],
            later: vec![nothing; m].into(),
            by_h: 0.0,
        }
    }

    /// Partial derivatives of the function at instant k.
    pub fn linearise(&mut self, scene: &Scene<f64>, run: &Trajectory<f64>, k: usize) {
        std::mem::swap(&mut self.a, &mut self.a_later);
        self.y.fill(0.0);
        self.v.fill(0.0);
        self.a.fill(0.0);
        let mut out = SnapshotCotangent {
            y: &mut self.y,
            v: &mut self.v,
            a: &mut self.a,
            model: &mut self.cot.model,
        };
        let own: &mut Function<f64> = &mut self.cot.functions[self.own];
        self.linearised
            .pull_back(k, &Snapshot::of(&scene.model, run, k), &mut out, own);
    }

    /// Adds what later steps leave through their rates, coefficient a_i of step k + i given by
    /// `a`, and the own acceleration's (a_0/h) g_a.
    pub fn rates_by_values(
        &mut self,
        run: &Trajectory<f64>,
        k: usize,
        a0: f64,
        a: impl Fn(usize) -> Option<f64>,
    ) {
        let mut q = vec![0.0; run.numbering.positions()];
        for (i, later) in self.later.iter().enumerate() {
            let Some(a) = a(i + 1) else { continue };
            add_scaled(&mut q, a / run.h, &later.qdot);
            add_scaled(&mut self.v, a / run.h, &later.vdot);
        }
        self.add_position_cotangent(run, k, &q);
        add_scaled(&mut self.v, a0 / run.h, &self.a);
    }

    /// Adds what later steps leave through their rates, and (a_0/h) times the rates' cotangents
    /// that ψ_{k+1} would make at this instant, from increments: with b_i the partial sums of a_i,
    /// Σ a_i X_{k+i} = Σ b_i (X_{k+i} − X_{k+i+1}).
    pub fn rates_by_increments(&mut self, run: &Trajectory<f64>, k: usize, b: &[f64]) {
        let numbering = &run.numbering;
        let mut q = vec![0.0; numbering.positions()];
        self.turn_increment(run, k, &mut q);
        for q in &mut q {
            *q *= b[0] / run.h;
        }
        add_scaled(&mut self.v, b[0] / run.h, &self.a);
        add_scaled(&mut self.v, -b[0] / run.h, &self.a_later);
        for (later, b) in self.later.iter().zip(&b[1..]) {
            add_scaled(&mut q, b / run.h, &later.qdot_increment);
            add_scaled(&mut self.v, b / run.h, &later.vdot_increment);
        }
        self.add_position_cotangent(run, k, &q);
    }

    /// (P_k − P_{k+1})ᵀ ψ_1 of the step after k: the rate map turns with the body.
    fn turn_increment(&self, run: &Trajectory<f64>, k: usize, out: &mut [f64]) {
        out.fill(0.0);
        if k == run.steps {
            return;
        }
        let numbering = &run.numbering;
        for body in 0..numbering.bodies() {
            let o = numbering.position(body);
            let (_, dp) = positions_of(&run.dq(k + 1)[o..]);
            let (_, psi) = velocities_of(&self.psi[numbering.velocity(body)..]);
            let turned = rotation::rate_transposed(&dp, &(psi * -2.0));
            out[o + 3..o + 7].copy_from_slice(&turned);
        }
    }

    fn add_position_cotangent(&mut self, run: &Trajectory<f64>, k: usize, q: &[f64]) {
        let mut tangent = vec![0.0; self.y.len()];
        bodies::tangent_of_cotangent(&run.numbering, run.q(k), q, &mut tangent);
        add_scaled(&mut self.y, 1.0, &tangent);
    }

    /// Moves ψ on by the increment of this step.
    pub fn advance(&mut self, increment: &[f64]) {
        add_scaled(&mut self.psi, 1.0, increment);
    }

    /// Remembers the cotangents of this step's rates and their increments, and adds what they say
    /// of the step size. `increment` is that of ψ.
    pub fn record_rates(
        &mut self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        k: usize,
        increment: &[f64],
        qdot: &[f64],
    ) {
        let numbering = &run.numbering;
        let nv = numbering.velocities();
        let mut now = match self.later.pop_back() {
            Some(oldest) => oldest,
            None => return,
        };
        let q = run.q(k);
        // ψ has moved on already: take the turn with ψ_{k+1} = ψ_k − increment.
        add_scaled(&mut self.psi, -1.0, increment);
        let mut turn = vec![0.0; q.len()];
        self.turn_increment(run, k, &mut turn);
        add_scaled(&mut self.psi, 1.0, increment);
        bodies::rates_cotangent(numbering, q, &increment[..nv], &mut now.qdot_increment);
        add_scaled(&mut now.qdot_increment, 1.0, &turn);
        bodies::rates_cotangent(numbering, q, &self.psi[..nv], &mut now.qdot);
        let model = &scene.model;
        bodies::mass_product(
            model,
            numbering,
            &increment[nv..2 * nv],
            &mut now.vdot_increment,
        );
        add_scaled(&mut now.vdot_increment, 1.0, &self.a);
        add_scaled(&mut now.vdot_increment, -1.0, &self.a_later);
        bodies::mass_product(model, numbering, &self.psi[nv..2 * nv], &mut now.vdot);
        add_scaled(&mut now.vdot, 1.0, &self.a);
        self.by_h -= (dot(&now.qdot, qdot) + dot(&now.vdot, run.a(k))) / run.h;
        self.later.push_front(now);
    }

    /// Adds what instant k = t_k / h says of the step size through its time.
    pub fn record_time(&mut self, k: usize, by_time: f64) {
        self.by_h += by_time * k as f64;
    }

    /// Adds what is left once the march has reached t = 0: derivatives in the duration and in
    /// parameters that no instant depends on.
    pub fn finish(&mut self, run: &Trajectory<f64>) {
        self.cot.duration = self.by_h / run.steps as f64 + self.linearised.by_duration;
        self.linearised
            .pull_back_parameters(&mut self.cot.functions[self.own]);
    }
}

fn add_scaled(out: &mut [f64], scale: f64, x: &[f64]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
