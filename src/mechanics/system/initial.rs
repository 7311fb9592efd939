//! Consistent initial conditions: nearest assembled positions, projected velocities, accelerations
//! and multipliers; and their pull-back for the adjoint.
//!
//! ```text
//! positions       E_y(q, q_g) + Gᵀ s = 0,          Φ(q, 0) = 0
//! velocities      M (v − v_g) + Gᵀ σ = 0,          G v + Φ_t = 0
//! accelerations   M a − f(q, v, 0) + Gᵀ λ = 0,     G a + bias(q, v) = 0
//! ```
//! E is the mean square displacement of the mass (see [`super::assembly`]). Its metric is M for
//! small displacements, so the start does not depend on the units of length, mass and angle. The
//! velocity projection is the effect of an impulse of the joints on the given velocities.

use super::assembly::{assemble, displacement_metric, finite, second_moment, turned_by};
use super::bodies::{self, BodyMotion, all_force_balances, positions_of, velocities_of};
use super::failure::AssemblyFailure;
use super::flexible::{self, StateCotangent};
use super::in_motion::InMotion;
use super::joints::{self, JointCotangent, RowCotangents};
use super::kkt::{BodyBlocks, Metric, SaddlePoint};
use super::loads::{self, LoadCotangent};
use super::numbering::Numbering;
use super::placement::guess;
use super::reduce;
use super::redundant_rows::{EXCHANGE_WEIGHT, RedundantRows, RowWeights};
use crate::linalg::{SingularMatrix, SolveScalar};
use crate::math::{Mat3, Scalar, rotation};
use crate::model::Model;

/// Consistent state at t = 0.
#[derive(Clone, Debug)]
pub struct InitialState<S> {
    /// Positions q.
    pub q: Vec<S>,
    /// Velocities v.
    pub v: Vec<S>,
    /// Accelerations v̇.
    pub a: Vec<S>,
    /// Multipliers λ.
    pub lambda: Vec<S>,
    /// Multipliers s of the position projection.
    pub s: Vec<S>,
    /// Multipliers σ of the velocity projection.
    pub sigma: Vec<S>,
    /// Redundant rows, which are not imposed on velocities and accelerations.
    pub left_out: RedundantRows,
    /// Number of Newton iterations of the assembly.
    pub iterations: usize,
}

/// [`solve`] of a model in real numbers.
///
/// # Errors
/// As there.
pub fn consistent(
    model: &Model<f64>,
    numbering: &Numbering,
) -> Result<InitialState<f64>, AssemblyFailure> {
    solve(model, numbering, &mut SaddlePoint::new(model, numbering))
}

/// Finds the consistent state nearest to the model's placement.
///
/// # Errors
/// [`AssemblyFailure`] names the joint that cannot be closed, or the singular part.
pub fn solve<S: SolveScalar>(
    model: &Model<S>,
    numbering: &Numbering,
    saddle: &mut SaddlePoint<S>,
) -> Result<InitialState<S>, AssemblyFailure> {
    let (nv, nc) = (numbering.velocities(), numbering.constraints());
    let (q_guess, v_guess) = guess(model);
    let mut motions = Vec::new();
    saddle.leave_out(&RedundantRows::of(model, numbering));
    let (q, s, iterations) = assemble(model, numbering, saddle, &q_guess, &v_guess)?;
    choose_left_out(model, numbering, saddle, (&q, &v_guess));

    // The projection changes only the part of the velocities that the mobilities admit, so that a
    // velocity that satisfies the joints stays the same. The other part also has momentum.
    let mut v = v_guess.clone();
    reduce::project(numbering, &mut v);
    let held: Vec<S> = v_guess.iter().zip(&v).map(|(&g, &v)| g - v).collect();
    BodyMotion::all(numbering, &q, &v, &mut motions);
    let at = InMotion::new(model, numbering, &motions, S::zero());
    let zeros = vec![S::zero(); nc];
    let singular = |_| super::rank::explain(model, &q);
    saddle
        .factorise(&at, &zeros, mass(model), Metric::Mass)
        .map_err(singular)?;
    let mut rates = vec![S::zero(); nc];
    joints::rates(&at, &mut rates);
    let mut rhs = vec![S::zero(); nv];
    bodies::mass_product(model, numbering, &held, &mut rhs);
    flexible::add_mass_product(model, numbering, &motions, &held, &mut rhs);
    rhs.extend(rates.into_iter().map(|rate| -rate));
    saddle.solve(&mut rhs);
    let sigma = rhs.split_off(nv);
    for (v, &change) in v.iter_mut().zip(&rhs) {
        *v += change;
    }

    BodyMotion::all(numbering, &q, &v, &mut motions);
    let at = InMotion::new(model, numbering, &motions, S::zero());
    let mut balance = vec![S::zero(); nv];
    all_force_balances(
        model,
        numbering,
        &motions,
        &vec![S::zero(); nv],
        &mut balance,
    );
    let still = vec![S::zero(); nv];
    flexible::add_force_balances(model, numbering, &motions, &still, &mut balance);
    let mut forces = vec![S::zero(); nv];
    loads::add_forces(&at, &mut forces);
    for (balance, &force) in balance.iter_mut().zip(&forces) {
        *balance -= force;
    }
    let mut bias = vec![S::zero(); nc];
    joints::accelerations(&at, &mut bias);
    let mut rhs: Vec<S> = balance.into_iter().chain(bias).map(|x| -x).collect();
    saddle.solve(&mut rhs);
    let lambda = rhs.split_off(nv);
    if [&v, &rhs, &lambda].iter().any(|x| !finite(x)) {
        return Err(singular(SingularMatrix { column: 0 }));
    }
    Ok(InitialState {
        q,
        v,
        a: rhs,
        lambda,
        s,
        sigma,
        left_out: saddle.left_out().clone(),
        iterations,
    })
}

/// Chooses the redundant rows by their weights, if the joints are closed. Otherwise no row is
/// redundant.
fn choose_left_out<S: SolveScalar>(
    model: &Model<S>,
    numbering: &Numbering,
    saddle: &mut SaddlePoint<S>,
    (q, v): (&[S], &[S]),
) {
    if saddle.left_out().is_empty() {
        return;
    }
    let mut left_out = saddle.left_out().clone();
    let (mut motions, mut weighing) = (Vec::new(), RowWeights::default());
    BodyMotion::all(numbering, q, v, &mut motions);
    let zeros = vec![S::zero(); numbering.constraints()];
    let at = InMotion::new(model, numbering, &motions, S::zero());
    for _ in 0..numbering.constraints() {
        let factorised = saddle.factorise(&at, &zeros, mass(model), Metric::Mass);
        if factorised.is_err() {
            return;
        }
        let solve = |rhs: &mut [S]| saddle.solve(rhs);
        match left_out.exchanged(&at, EXCHANGE_WEIGHT, &mut weighing, solve) {
            Some(other) => left_out = other,
            None => return,
        }
        saddle.leave_out(&left_out);
    }
}

/// Mass and inertia of each body.
pub fn mass<S: Scalar>(model: &Model<S>) -> impl Fn(usize) -> BodyBlocks<S> + '_ {
    |body| {
        let body = &model.bodies[body];
        BodyBlocks {
            linear: body.mass,
            angular: body.inertia,
        }
    }
}

/// Pulls cotangents (ȳ of q0 in its tangent, v̄ of v0, ā of the initial accelerations) back through
/// the three solutions to the parameters in `cot`.
///
/// # Errors
/// [`AssemblyFailure`] if a matrix is singular now that was regular in the forward computation.
pub fn pull_back(
    model: &Model<f64>,
    numbering: &Numbering,
    saddle: &mut SaddlePoint<f64>,
    state: &InitialState<f64>,
    (y_bar, v_bar, a_bar): (&[f64], &[f64], &[f64]),
    cot: &mut Model<f64>,
) -> Result<(), AssemblyFailure> {
    let (nv, nc) = (numbering.velocities(), numbering.constraints());
    saddle.leave_out(&state.left_out);
    let singular = |_| super::rank::explain(model, &state.q);
    let mut motions = Vec::new();
    BodyMotion::all(numbering, &state.q, &state.v, &mut motions);
    let at = InMotion::new(model, numbering, &motions, 0.0);
    let zeros = vec![0.0; nc];
    let mut v_bar = v_bar.to_vec();
    let mut y_bar = y_bar.to_vec();

    let transposed = |saddle: &mut SaddlePoint<f64>, cotangent: &[f64]| {
        let mut psi: Vec<f64> = cotangent.iter().map(|x| -x).collect();
        psi.resize(nv + nc, 0.0);
        saddle.solve_transposed(&mut psi);
        let chi = psi.split_off(nv);
        (psi, chi)
    };
    // The start is at t = 0 for every design: derivatives in time are not needed.
    let pull = |motions: &[BodyMotion<f64>],
                cotangents: &RowCotangents,
                y: &mut [f64],
                cot: &mut Model<f64>| {
        let mut out = JointCotangent {
            y: Some(y),
            v: None,
            model: cot,
        };
        let at = InMotion::new(model, numbering, motions, 0.0);
        joints::pull_back(&at, cotangents, &mut out);
    };
    // Pulls λᵀ G(q) w, which is linear in w, back to positions and joint frames.
    let pull_rate = |w: &[f64], lambda: &[f64], y: &mut [f64], cot: &mut Model<f64>| {
        let at =
            |(i, motion): (usize, &BodyMotion<f64>)| motion.virtually(&w[numbering.velocity(i)..]);
        let moving: Vec<BodyMotion<f64>> = motions.iter().enumerate().map(at).collect();
        let cotangents = RowCotangents {
            virtual_rate: Some(lambda),
            ..Default::default()
        };
        pull(&moving, &cotangents, y, cot);
    };

    saddle
        .factorise(&at, &zeros, mass(model), Metric::Mass)
        .map_err(singular)?;
    if a_bar.iter().any(|&x| x != 0.0) {
        let (psi, chi) = transposed(saddle, a_bar);
        let (of, here) = ((model, numbering), (&motions[..], &state.a[..]));
        bodies::pull_force_balances(of, here, &psi, Some(&mut v_bar), cot);
        let mut bars = StateCotangent {
            y: Some(&mut y_bar),
            v: Some(&mut v_bar),
        };
        flexible::pull_force_balances(of, here, &psi, &mut bars, cot);
        let minus: Vec<f64> = psi.iter().map(|x| -x).collect();
        let mut out = LoadCotangent {
            y: Some(&mut y_bar),
            v: Some(&mut v_bar),
            time: &mut 0.0,
            model: cot,
        };
        loads::pull_back(&at, &minus, &mut out);
        pull_rate(&psi, &state.lambda, &mut y_bar, cot);
        pull_rate(&state.a, &chi, &mut y_bar, cot);
        let mut out = JointCotangent {
            y: Some(&mut y_bar),
            v: Some(&mut v_bar),
            model: cot,
        };
        let cotangents = RowCotangents {
            acceleration: Some(&chi),
            ..Default::default()
        };
        joints::pull_back(&at, &cotangents, &mut out);
    }

    let (psi, chi) = transposed(saddle, &v_bar);
    pull_rate(&psi, &state.sigma, &mut y_bar, cot);
    let cotangents = RowCotangents {
        rate: Some(&chi),
        ..Default::default()
    };
    pull(&motions, &cotangents, &mut y_bar, cot);
    // M ψ = −v̄ − Gᵀχ; the cotangent of v_g is −M ψ.
    let mut v_guess_bar = vec![0.0; nv];
    for (i, body) in model.bodies.iter().enumerate() {
        let o = numbering.velocity(i);
        let (psi_r, psi_theta) = velocities_of(&psi[o..]);
        let (v, omega) = velocities_of(&state.v[o..]);
        let cot = &mut cot.bodies[i];
        cot.mass += psi_r.dot(&(v - body.velocity));
        cot.inertia += psi_theta * (omega - body.angular_velocity).transpose();
        bodies::add6(
            &mut v_guess_bar[o..],
            &(psi_r * -body.mass),
            &-body.inertia.tr_mul(&psi_theta),
        );
    }

    if !model.flexible.is_empty() {
        let (_, guess) = guess(model);
        let by: Vec<f64> = state.v.iter().zip(&guess).map(|(v, g)| v - g).collect();
        let at = (model, numbering);
        flexible::pull_mass_product(at, &motions, (&psi, &by), &mut y_bar, cot);
        let mut product = vec![0.0; nv];
        flexible::add_mass_product(model, numbering, &motions, &psi, &mut product);
        v_guess_bar
            .iter_mut()
            .zip(&product)
            .for_each(|(v, x)| *v -= x);
    }

    // The assembly leaves out the redundant rows of the joints.
    saddle.leave_out(&RedundantRows::of(model, numbering));
    let metric = displacement_metric(model, numbering, &state.q);
    saddle
        .factorise(&at, &state.s, metric, Metric::Displacement)
        .map_err(singular)?;
    let (psi, chi) = transposed(saddle, &y_bar);
    // Part through the positions that stay as placed.
    pull_rate(&psi, &state.s, &mut y_bar, cot);
    let cotangents = RowCotangents {
        value: Some(&chi),
        ..Default::default()
    };
    pull(&motions, &cotangents, &mut y_bar, cot);
    reduce::constrain_cotangent(numbering, &mut y_bar);
    flexible::pull_displacement(model, numbering, (&state.q, &psi), cot);

    for (i, body) in cot.bodies.iter_mut().enumerate() {
        let o = numbering.velocity(i);
        let (psi_r, psi_theta) = velocities_of(&psi[o..]);
        let (r, theta) = velocities_of(&y_bar[o..]);
        let given = &model.bodies[i];
        let (position, p) = positions_of(&state.q[numbering.position(i)..]);
        body.mass += psi_r.dot(&(position - given.position));
        body.position += r - psi_r * given.mass;
        // ψ · w(S R_gᵀ R) = −tr(ψ̃ S R_gᵀ R).
        let turned = turned_by(&given.orientation, &p);
        let (tilde, moment) = (psi_theta.cross_matrix(), second_moment(&given.inertia));
        let by_moment = -(turned * tilde).transpose();
        body.inertia += Mat3::identity() * (0.5 * by_moment.trace()) - by_moment;
        let by_rotation = -(rotation::matrix(&p) * tilde * moment);
        let by_placed = rotation::pull_matrix(&given.orientation, &by_rotation);
        // T(p)ᵀ T(p) = 1/4.
        let mut by_p = rotation::rates(&motions[i].orientation, &(theta * 4.0));
        by_p.iter_mut().zip(by_placed).for_each(|(x, y)| *x += y);
        for k in 0..4 {
            body.orientation[k] += by_p[k];
        }
        let (velocity, omega) = velocities_of(&v_guess_bar[o..]);
        body.velocity += velocity;
        body.angular_velocity += omega;
    }
    Ok(())
}

/// Largest change of a velocity coordinate by the projection, relative to the largest velocity.
pub fn velocity_correction<S: Scalar>(model: &Model<S>, state: &InitialState<S>) -> f64 {
    let (_, guess) = guess(model);
    let largest = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0_f64, |m, x| m.max(x.abs()));
    let change = largest(&mut state.v.iter().zip(&guess).map(|(v, g)| v.re() - g.re()));
    let size = largest(&mut guess.iter().map(|g| g.re()));
    if size > 0.0 { change / size } else { change }
}
