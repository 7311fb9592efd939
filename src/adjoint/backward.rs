//! The backward march: one transposed solve a step and function, one factorisation a step for all.
//!
//! Let step k solve F(y_k, v_k, λ_k, μ_k; q̇_k, v̇_k) = 0 with q̇_k = (1/h) Σ a_i q_{k−i} and
//! v̇_k = (1/h) Σ a_i v_{k−i}, where the coefficients a_i are those of step k. For k = N … 1
//!
//! ```text
//! J_kᵀ ψ_k = −[ g_y + T_kᵀ q̃_k ;  g_v + ṽ_k + (a_0/h) g_a ;  0 ;  0 ]
//! q̇̄_k = P_kᵀ ψ_1,   v̇̄_k = M ψ_2 + g_a
//! q̃_k = (1/h) Σ_{i≥1} a_i^{(k+i)} q̇̄_{k+i},   ṽ_k likewise
//! df/dh += −(q̇̄ · q̇_k + v̇̄ · v̇_k) / h,   df/dx += ψ_kᵀ ∂F_k/∂x
//! ```
//!
//! with (g_y, g_v, g_a) the partial derivatives of the function at instant k. At k = 0 the
//! cotangents go back through the initial conditions (Kennedy & Boopathy, eq. 6 and 7, with the
//! coefficients of the later steps and the initial conditions that the paper leaves out).
//!
//! The march solves for the increment ψ_k − ψ_{k+1}, and the sums with a_i become sums of
//! increments of q̇̄ and v̇̄ with partial sums of a_i. Without that, the round-off of ψ comes back
//! divided by h², as it does forwards.

use super::sweep::Sweep;
use crate::functions::Scene;
use crate::integrate::bdf::{coefficients, increment_coefficients, order_of_step};
use crate::integrate::ggl::{Equations, Instant};
use crate::integrate::{IntegrationFailure, Method, Trajectory, WorkCounts};
use crate::linalg::{REFINED_SOLVES, SparseLu, SparseMatrix};
use crate::system::initial;
use crate::system::kkt::SaddlePoint;

/// Gradients and the work that they took.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// For each function asked for, its derivative in every parameter of the scene (a cotangent
    /// of the scene).
    pub gradients: Vec<Scene<f64>>,
    /// Work of the backward march.
    pub counts: WorkCounts,
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
    let nv = numbering.velocities();
    let mut sweeps: Vec<Sweep> = which
        .iter()
        .map(|&own| Sweep::new(scene, run, own, order))
        .collect();
    let mut counts = WorkCounts::default();
    let mut equations = Equations::new(model, numbering);
    let mut plan: Option<Plan> = None;
    let mut qdot = vec![0.0; numbering.positions()];
    let mut psi = vec![0.0; equations.order()];
    let h = run.h;
    for k in (1..=run.steps).rev() {
        let order_here = order_of_step(order, k);
        rates(&mut qdot, run, k, order_here);
        let at = Instant {
            q: run.q(k),
            v: run.v(k),
            lambda: run.lambda(k),
            mu: run.mu(k),
            qdot: &qdot,
            vdot: run.a(k),
            time: run.time(k),
        };
        let plan = plan.get_or_insert_with(|| Plan::new(&mut equations, &at));
        let a = coefficients(order_here);
        // Steps near the start depend on coefficients that change from step to step.
        let incremental = k >= order;
        if incremental {
            plan.held
                .assemble(|emit| equations.jacobian(&at, h, 0.0, emit));
        }
        plan.matrix
            .assemble(|emit| equations.jacobian(&at, h, a[0] / h, emit));
        plan.factors
            .factorise(&plan.matrix)
            .map_err(|singular| IntegrationFailure::Singular {
                time: run.time(k),
                step: k,
                place: equations.describe(singular.column),
            })?;
        counts.steps += 1;
        counts.factorisations += 1;
        for sweep in &mut sweeps {
            sweep.linearise(scene, run, k);
            psi.fill(0.0);
            if incremental {
                sweep.rates_by_increments(run, k, &increment_coefficients(order));
            } else {
                sweep.rates_by_values(run, k, a[0], |i| {
                    let later = order_of_step(order, k + i);
                    coefficients(later).get(i).copied()
                });
            }
            for i in 0..nv {
                psi[i] = -sweep.y[i];
                psi[nv + i] = -sweep.v[i];
            }
            equations.scale_columns(h, &mut psi);
            if incremental {
                let mut later = sweep.psi.clone();
                equations.unscale_rows(h, &mut later);
                let held = plan.held.multiply_transposed(&later);
                psi.iter_mut()
                    .zip(&held)
                    .for_each(|(psi, held)| *psi -= held);
            } else {
                sweep.psi.fill(0.0);
            }
            plan.factors
                .solve_transposed_refined(&plan.matrix, &mut psi);
            equations.scale_rows(h, &mut psi);
            counts.solves += REFINED_SOLVES;
            sweep.advance(&psi);
            let cot = &mut sweep.cot.model;
            let by_time = equations.pull_back(&at, &sweep.psi, cot);
            sweep.record_time(k, by_time);
            sweep.record_rates(scene, run, k, &psi, &qdot);
        }
    }
    let mut saddle = SaddlePoint::new(model, numbering);
    for sweep in &mut sweeps {
        sweep.linearise(scene, run, 0);
        sweep.rates_by_values(run, 0, 0.0, |i| {
            coefficients(order_of_step(order, i)).get(i).copied()
        });
        let bars = (&sweep.y[..], &sweep.v[..], &sweep.a[..]);
        let cot = &mut sweep.cot;
        initial::pull_back(
            model,
            numbering,
            &mut saddle,
            &run.initial,
            bars,
            &mut cot.model,
        )?;
        sweep.finish(run);
    }
    counts.factorisations += saddle.factorisations;
    counts.solves += REFINED_SOLVES * saddle.factorisations;
    Ok(AdjointRun {
        gradients: sweeps.into_iter().map(|sweep| sweep.cot).collect(),
        counts,
    })
}

/// Matrices that every step fills again.
struct Plan {
    /// The iteration matrix.
    matrix: SparseMatrix<f64>,
    /// Its part with q̇ and v̇ held.
    held: SparseMatrix<f64>,
    factors: SparseLu<f64>,
}

impl Plan {
    fn new(equations: &mut Equations<f64>, at: &Instant<f64>) -> Self {
        let pattern = equations.pattern(at);
        Self {
            factors: SparseLu::new(&pattern),
            held: SparseMatrix::new(pattern.clone()),
            matrix: SparseMatrix::new(pattern),
        }
    }
}

/// q̇_k from the increments of the steps k, k − 1, ….
fn rates(out: &mut [f64], run: &Trajectory<f64>, k: usize, order: usize) {
    out.fill(0.0);
    for (i, b) in increment_coefficients(order).iter().enumerate() {
        for (out, d) in out.iter_mut().zip(run.dq(k - i)) {
            *out += b / run.h * d;
        }
    }
}
