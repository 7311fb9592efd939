//! Rayleigh damping of finite elements, without forces on rigid motions:
//!
//! ```text
//! −α M_ee q̇ − β Σ_p k_p ∇e_p ė_p
//! ```
//!
//! over all strains e_p of [`super::stiffness`], von Karman's among them. For small motions this is
//! α M + β K with the axes held. So a shell that bends far without stretching is not damped by
//! linear membrane strains.

use super::element::{
    Deformed, motion, motion_transpose, per_area, pull_per_area, scatter, share, weigh,
};
use super::parts;
use super::stiffness::{
    Strained, add_curvature, add_curved, add_linear, add_products, factors, linear_products,
    pull_factors, stresses,
};
use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};
use crate::model::finite::{FiniteElements, NODES, UNKNOWNS};

/// M_ee q̇ and Σ k_p ∇e_p ė_p.
fn both<S: Scalar>(finite: &FiniteElements<S>, (q, rate): (&[S], &[S])) -> [Vec<S>; 2] {
    let (mut heavy, mut viscous) = (vec![S::zero(); q.len()], vec![S::zero(); q.len()]);
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let (x, r) = (Deformed::of(element, q), Deformed::of(element, rate));
        let forces = weigh(element, per_area(finite, i), &motion(element, &r.all));
        scatter(element, &motion_transpose(element, &forces), &mut heavy);
        let both = factors(finite, i);
        let strained = Strained::of(element, &x);
        let mut force = [S::zero(); UNKNOWNS];
        let stress = stresses(element, &strained.along(element, &r)).map(|n| n * both[0]);
        strained.add_transpose(element, &stress, &mut force);
        add_linear(element, both, &r, &mut force);
        scatter(element, &force, &mut viscous);
    }
    parts::add_heavy(finite, rate, &mut heavy);
    parts::add_viscous(finite, (q, rate), &mut viscous);
    [heavy, viscous]
}

/// Adds the forces of damping, with the sign of ∂U/∂q.
pub fn add_damping<S: Scalar>(finite: &FiniteElements<S>, motion: (&[S], &[S]), out: &mut [S]) {
    let Some(factors) = finite.damping else {
        return;
    };
    for (force, factor) in both(finite, motion).iter().zip(factors) {
        add_scaled(out, factor, force);
    }
}

/// The derivatives of the forces of damping of a shell in its unknowns x and their rates r, by rows.
pub(super) fn matrices<S: Scalar>(
    finite: &FiniteElements<S>,
    i: usize,
    [alpha, beta]: [S; 2],
    (q, rate): (&[S], &[S]),
) -> [Vec<S>; 2] {
    let element = &finite.mesh.elements[i];
    let (x, r) = (Deformed::of(element, q), Deformed::of(element, rate));
    let [thin, thick] = factors(finite, i).map(|factor| beta * factor);
    let n = element.coordinates.len();
    let (mut in_x, mut in_r) = (vec![S::zero(); n * n], vec![S::zero(); n * n]);
    let [bending, shear] = &element.linear;
    bending.add_to(thick, n, &mut in_r);
    shear.add_to(thin, n, &mut in_r);
    let strained = Strained::of(element, &x);
    let own = strained.gradients(element);
    let turned = Strained::turned_gradients(element, &r);
    // P ∂e/∂u and P ∂ė/∂u.
    let [scaled, scaled_rates] =
        [&own, &turned].map(|all| all.map(|column| stresses(element, &column).map(|n| n * thin)));
    add_products(element, (&own, &scaled), true, &mut in_r);
    add_products(element, (&own, &scaled_rates), false, &mut in_x);
    let stress = stresses(element, &strained.along(element, &r)).map(|n| n * thin);
    add_curvature(element, &stress, n, &mut in_x);
    let weights = per_area(finite, i).map(|weight| alpha * weight);
    for (k, (a, along)) in element.moves.iter().enumerate() {
        for (l, (b, other)) in element.moves.iter().enumerate() {
            if a / NODES == b / NODES {
                let share = element.shares[a % NODES][b % NODES] * along.dot(other);
                in_r[k * n + l] += weights[a / NODES] * share;
            }
        }
    }
    [in_x, in_r]
}

/// Pulls the cotangent ψ of [`add_damping`] back to q and q̇ (added) and to the parameters (added to `cot`).
pub fn pull_damping(
    finite: &FiniteElements<f64>,
    (q, rate, psi): (&[f64], &[f64], &[f64]),
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut FiniteElements<f64>,
) {
    let Some([alpha, beta]) = finite.damping else {
        return;
    };
    let forces = both(finite, (q, rate));
    if let Some(by) = &mut cot.damping {
        for (by, force) in by.iter_mut().zip(&forces) {
            *by += dot(psi, force);
        }
    }
    // Both matrices are symmetric in q̇ and ψ.
    for (force, factor) in both(finite, (q, psi)).iter().zip([alpha, beta]) {
        add_scaled(by_rate, factor, force);
    }
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let [x, r, y] = [q, rate, psi].map(|x| Deformed::of(element, x));
        let shared = share(element, &motion(element, &y.all));
        let mut by_weight = [0.0; 2];
        for (k, (own, v)) in shared.iter().zip(&motion(element, &r.all)).enumerate() {
            by_weight[k / NODES] += alpha * own.dot(v);
        }
        pull_per_area(finite, i, by_weight, cot);
        let strained = Strained::of(element, &x);
        let [speed, virtually] = [&r, &y].map(|x| strained.along(element, x));
        let [stress, virtual_stress] = [&speed, &virtually].map(|e| stresses(element, e));
        let [bending, shear] = linear_products(element, &r, &y);
        let thin = dot(&virtually, &stress) + shear;
        pull_factors(finite, i, [beta * thin, beta * bending], cot);
        let scale = beta * factors(finite, i)[0];
        let mut force = [0.0; UNKNOWNS];
        for (moved, stress) in [(&r, &virtual_stress), (&y, &stress)] {
            let scaled = stress.map(|n| n * scale);
            add_curved(
                element,
                &scaled,
                &element.slopes.times(&moved.all),
                &mut force,
            );
        }
        scatter(element, &force, by_q);
    }
    parts::pull_heavy(finite, (rate, psi), alpha, cot);
    // The part by the rates is added above.
    let mut unused = vec![0.0; q.len()];
    parts::pull_viscous(finite, (q, rate, psi), beta, (by_q, &mut unused), cot);
}
