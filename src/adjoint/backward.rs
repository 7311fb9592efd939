//! The backward march: one transposed solve a step and function, one factorisation a step for all.
//!
//! Let step k solve F(y_k, v_k, λ_k, μ_k; q̇_k, v̇_k) = 0 with q̇_k = (1/h) Σ a_i q_{k−i} and
//! v̇_k = (1/h) Σ a_i v_{k−i}, where the coefficients a_i are those of step k. For k = N … 1
//!
//! ```text
//! J_kᵀ ψ_k = −[ g_y + T_kᵀ q̃_k ;  g_v + ṽ_k + (a_0/h) g_a ;  0 ;  0 ]
//! q̇̄ = P_kᵀ ψ_1,   v̇̄ = M ψ_2 + g_a
//! q̃_{k−i} += (a_i/h) q̇̄,   ṽ_{k−i} += (a_i/h) v̇̄            i = 1 … m
//! df/dh += −(q̇̄ · q̇_k + v̇̄ · v̇_k) / h,   df/dx += ψ_kᵀ ∂F_k/∂x
//! ```
//!
//! with (g_y, g_v, g_a) the partial derivatives of the function at instant k. At k = 0 the
//! cotangents go back through the initial conditions (Kennedy & Boopathy, eq. 6 and 7, with the
//! coefficients of the later steps and the initial conditions that the paper leaves out).

use crate::functions::evaluate::Linearised;
use crate::functions::measure::{Snapshot, SnapshotCotangent};
use crate::functions::{Function, Scene};
use crate::integrate::bdf::{coefficients, order_of_step};
use crate::integrate::ggl::{Equations, Instant};
use crate::integrate::{IntegrationFailure, Method, Trajectory, WorkCounts};
use crate::linalg::{SparseLu, SparseMatrix};
use crate::system::kkt::SaddlePoint;
use crate::system::{bodies, initial};
use std::collections::VecDeque;

/// Gradients and the work that they took.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// For each function asked for, its derivative in every parameter of the scene (a cotangent
    /// of the scene).
    pub gradients: Vec<Scene<f64>>,
    /// Work of the backward march.
    pub counts: WorkCounts,
}

/// Cotangents of one instant that later steps have left: of q (position numbering) and v.
#[derive(Clone)]
struct Pending {
    q: Vec<f64>,
    v: Vec<f64>,
}

/// One function on its way back.
struct Sweep<'a> {
    linearised: Linearised<'a>,
    cot: Scene<f64>,
    own: usize,
    /// Pending cotangents of the instants k, k − 1, …, k − m.
    pending: VecDeque<Pending>,
    by_h: f64,
}

/// Exact derivatives of the functions `which` (indices into the scene's) over `run`.
///
/// # Errors
/// If the iteration matrix of a step is singular.
pub fn gradients(
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
    which: &[usize],
) -> Result<AdjointRun, IntegrationFailure> {
    let Method::Bdf { order } = run.method;
    let (model, numbering) = (&scene.model, &run.numbering);
    let (nq, nv) = (numbering.positions(), numbering.velocities());
    let nothing = Pending {
        q: vec![0.0; nq],
        v: vec![0.0; nv],
    };
    let mut sweeps: Vec<Sweep> = which
        .iter()
        .map(|&own| Sweep {
            linearised: Linearised::new(&scene.functions[own], model, run),
            cot: scene.zero_cotangent(),
            own,
            pending: vec![nothing.clone(); order + 1].into(),
            by_h: 0.0,
        })
        .collect();
    let mut counts = WorkCounts::default();
    let mut equations = Equations::new(model, numbering);
    let mut plan: Option<(SparseMatrix<f64>, SparseLu<f64>)> = None;
    let mut qdot = vec![0.0; nq];
    let (mut qdot_bar, mut vdot_bar) = (vec![0.0; nq], vec![0.0; nv]);
    let mut partials = Partials::new(nv);
    let h = run.h;
    for k in (1..=run.steps).rev() {
        let a = coefficients(order_of_step(order, k));
        difference(&mut qdot, a, h, |i| run.q(k - i));
        let at = Instant {
            q: run.q(k),
            v: run.v(k),
            lambda: run.lambda(k),
            mu: run.mu(k),
            qdot: &qdot,
            vdot: run.a(k),
        };
        let (matrix, factors) = plan.get_or_insert_with(|| {
            let pattern = equations.pattern(&at);
            let factors = SparseLu::new(&pattern);
            (SparseMatrix::new(pattern), factors)
        });
        matrix.assemble(|emit| equations.jacobian(&at, h, a[0] / h, emit));
        factors
            .factorise(matrix)
            .map_err(|singular| IntegrationFailure::Singular {
                time: run.time(k),
                step: k,
                place: equations.describe(singular.column),
            })?;
        counts.steps += 1;
        counts.factorisations += 1;
        for sweep in &mut sweeps {
            partials.linearise(sweep, scene, run, k);
            let mut psi = vec![0.0; equations.order()];
            for i in 0..nv {
                psi[i] = -partials.y[i];
                psi[nv + i] = -(partials.v[i] + a[0] / h * partials.a[i]);
            }
            equations.scale_columns(h, &mut psi);
            factors.solve_transposed_refined(matrix, &mut psi);
            equations.scale_rows(h, &mut psi);
            counts.solves += 2;
            let cot = &mut sweep.cot.model;
            equations.pull_back(&at, &psi, cot, (&mut qdot_bar, &mut vdot_bar));
            for (bar, g) in vdot_bar.iter_mut().zip(&partials.a) {
                *bar += g;
            }
            for (i, &a) in a.iter().enumerate().skip(1) {
                let earlier = &mut sweep.pending[i];
                add_scaled(&mut earlier.q, a / h, &qdot_bar);
                add_scaled(&mut earlier.v, a / h, &vdot_bar);
            }
            sweep.by_h -= (dot(&qdot_bar, &qdot) + dot(&vdot_bar, run.a(k))) / h;
            sweep.pending.rotate_left(1);
            sweep.pending[order].q.fill(0.0);
            sweep.pending[order].v.fill(0.0);
        }
    }
    let mut saddle = SaddlePoint::new(model, numbering);
    for sweep in &mut sweeps {
        partials.linearise(sweep, scene, run, 0);
        let bars = (&partials.y[..], &partials.v[..], &partials.a[..]);
        let cot = &mut sweep.cot;
        initial::pull_back(
            model,
            numbering,
            &mut saddle,
            &run.initial,
            bars,
            &mut cot.model,
        )?;
        cot.duration = sweep.by_h / run.steps as f64 + sweep.linearised.by_duration;
        sweep
            .linearised
            .pull_back_parameters(&mut cot.functions[sweep.own]);
    }
    counts.factorisations += saddle.factorisations;
    counts.solves += saddle.factorisations;
    Ok(AdjointRun {
        gradients: sweeps.into_iter().map(|sweep| sweep.cot).collect(),
        counts,
    })
}

/// Cotangents of one instant: partial derivatives of the function plus what is pending.
struct Partials {
    y: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

impl Partials {
    fn new(nv: usize) -> Self {
        Self {
            y: vec![0.0; nv],
            v: vec![0.0; nv],
            a: vec![0.0; nv],
        }
    }

    fn linearise(
        &mut self,
        sweep: &mut Sweep,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        k: usize,
    ) {
        let pending = &sweep.pending[0];
        bodies::tangent_of_cotangent(&run.numbering, run.q(k), &pending.q, &mut self.y);
        self.v.copy_from_slice(&pending.v);
        self.a.fill(0.0);
        let mut out = SnapshotCotangent {
            y: &mut self.y,
            v: &mut self.v,
            a: &mut self.a,
            model: &mut sweep.cot.model,
        };
        let own: &mut Function<f64> = &mut sweep.cot.functions[sweep.own];
        let at = Snapshot::of(&scene.model, run, k);
        sweep.linearised.pull_back(k, &at, &mut out, own);
    }
}

/// (1/h) Σ a_i x_{k−i}.
fn difference<'a>(out: &mut [f64], a: &[f64], h: f64, x: impl Fn(usize) -> &'a [f64]) {
    out.fill(0.0);
    for (i, &a) in a.iter().enumerate() {
        add_scaled(out, a / h, x(i));
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
