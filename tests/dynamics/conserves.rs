//! Conserved quantities: energy, linear and angular momentum of free bodies, and the spin of a free
//! top.
//!
//! Two bodies with full inertias, connected by each kind of joint about a skew axis, float without
//! gravity for 2 s. Their given velocities do not fit the joint and are projected first. BDF
//! conserves linear momentum, which is linear in the velocities, to round-off at any step. Energy
//! and angular momentum are quadratic: the equations conserve them, BDF only up to its order.

use crate::reference;

use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::model::{JointKind, Mobility, Model, RigidBody, Role};
use flexbody_mechanics::system::initial::velocity_correction;
use flexbody_mechanics::system::observe::{Observation, observe};
use reference::models::{KINDS, free_pair};
use reference::{bdf, observed_order};

const DURATION: f64 = 2.0;

/// Observations at every instant of a run with steps of size `h`.
fn observations(model: &Model<f64>, h: f64, order: usize) -> Vec<Observation> {
    let run = bdf(model, DURATION, h, order);
    assert!(velocity_correction(model, &run.initial) > 0.1);
    (0..=run.last())
        .map(|k| observe(model, &run.numbering, (run.q(k), run.v(k)), run.time(k)))
        .collect()
}

/// Largest changes over a run, relative to the start.
#[derive(Debug)]
struct Drift {
    energy: f64,
    momentum: f64,
    angular_momentum: f64,
}

fn drift(model: &Model<f64>, h: f64, order: usize) -> Drift {
    let seen = observations(model, h, order);
    let start = seen[0];
    let largest =
        |change: &dyn Fn(&Observation) -> f64| seen.iter().map(change).fold(0.0, f64::max);
    let relative = |a: Vec3<f64>, b: Vec3<f64>| (a - b).norm() / b.norm();
    Drift {
        energy: largest(&|o| (o.kinetic - start.kinetic).abs() / start.kinetic),
        momentum: largest(&|o| relative(o.momentum, start.momentum)),
        angular_momentum: largest(&|o| relative(o.angular_momentum, start.angular_momentum)),
    }
}

/// The kinds of joint whose free pairs rotate about equally fast. Two bodies on a rod whirl several
/// times as fast and have other bounds.
fn kinds() -> impl Iterator<Item = JointKind> {
    KINDS.into_iter().filter(|kind| *kind != JointKind::Rod)
}

/// Linear momentum to 1e-12 at every step size; energy and angular momentum with the order of the
/// formula, within 0.1, and below 5e-6 (BDF2, 1 ms; measured 2.5e-7 … 3.2e-6).
#[test]
fn energy_and_momentum_drift_with_the_order_of_the_formula() {
    for kind in kinds() {
        for seed in [1, 2] {
            let model = free_pair(kind, seed);
            for order in [1, 2] {
                let [coarse, fine] = [2e-3, 1e-3].map(|h| drift(&model, h, order));
                for (coarse, fine) in [
                    (coarse.energy, fine.energy),
                    (coarse.angular_momentum, fine.angular_momentum),
                ] {
                    let observed = observed_order(coarse, fine);
                    assert!(
                        (observed - order as f64).abs() <= 0.1,
                        "{kind:?}, seed {seed}: {coarse:e}, {fine:e}, order {observed:.3}"
                    );
                    let small = order == 1 || fine <= 5e-6;
                    assert!(small, "{kind:?}, seed {seed}: {fine:e}");
                }
                let momentum = coarse.momentum.max(fine.momentum);
                assert!(momentum <= 1e-12, "{kind:?}, seed {seed}: {momentum:e}");
            }
        }
    }
}

/// The equations conserve angular momentum and energy to 1e-9: the changes over runs with h and h/2
/// (h = 0.25 ms), extrapolated to h = 0 at every millisecond, Δ = (4 Δ(h/2) − Δ(h)) / 3 (measured
/// up to 2e-10).
#[test]
fn every_joint_conserves_momentum_and_energy_in_the_limit_of_small_steps() {
    for kind in kinds() {
        for seed in [1, 3] {
            let model = free_pair(kind, seed);
            let [coarse, fine] = [2.5e-4, 1.25e-4].map(|h| observations(&model, h, 2));
            let start = coarse[0];
            let (spin, energy) = (start.angular_momentum, start.kinetic);
            for (coarse, fine) in coarse.iter().step_by(4).zip(fine.iter().step_by(8)) {
                let [at_h, at_half] = [coarse, fine].map(|o| o.angular_momentum - spin);
                let change = (at_half * 4.0 - at_h).norm() / (3.0 * spin.norm());
                assert!(change <= 1e-9, "{kind:?}, seed {seed}: {change:e}");
                let [at_h, at_half] = [coarse, fine].map(|o| o.kinetic - energy);
                let change = (at_half * 4.0 - at_h).abs() / (3.0 * energy);
                assert!(
                    change <= 1e-9,
                    "{kind:?}, seed {seed}: {change:e} of the energy"
                );
            }
        }
    }
}

/// Linear and angular momentum and energy to 1e-9 in a single run of 2 s, with steps (25 µs) so
/// small that the formula's own error is below that (measured up to 7.4e-10).
fn assert_conserved(kind: JointKind) {
    let drift = drift(&free_pair(kind, 1), 2.5e-5, 2);
    let worst = drift.angular_momentum.max(drift.momentum);
    assert!(worst.max(drift.energy) <= 1e-9, "{kind:?}: {drift:?}");
}

#[test]
fn a_spherical_joint_conserves_momentum() {
    assert_conserved(JointKind::Spherical);
}

#[test]
fn a_revolute_joint_conserves_momentum() {
    assert_conserved(JointKind::Revolute);
}

#[test]
fn a_prismatic_joint_conserves_momentum() {
    assert_conserved(JointKind::Prismatic);
}

#[test]
fn a_planar_joint_conserves_momentum() {
    assert_conserved(JointKind::Planar);
}

/// Newton's method still solves every step if the step is so small that the extrapolated start is
/// as exact as stored positions: the drift of 80 µs is (80/100)² of that of 100 µs, within 5 %.
#[test]
fn small_steps_are_solved_as_well_as_large_ones() {
    let model = free_pair(JointKind::Planar, 2);
    let [coarse, fine] = [1e-4, 8e-5].map(|h| drift(&model, h, 2).energy);
    let ratio = fine / coarse;
    assert!((ratio / 0.64 - 1.0).abs() <= 0.05, "{coarse:e}, {fine:e}");
}

/// A free top with moments (A, A, C) turns at the rate |L|/A about its angular momentum L and, in
/// itself, at the rate (1 − C/A) ω3 about its axis (Goldstein 1980, *Classical Mechanics*,
/// section 5-6), while its centre moves uniformly. The Euler parameters follow with order 2 within
/// 0.1, and to 2e-5 at 1 ms, after 2 s and about one turn.
#[test]
fn a_free_top_follows_the_exact_solution() {
    let (a, c) = (0.7, 1.1);
    let spin = Vec3::new(1.5, -0.8, 2.0);
    let start = rotation::from_axis_angle(&Vec3::new(0.3, 1.0, -0.4), 0.9);
    let body = RigidBody {
        name: "top".into(),
        mass: 1.3,
        inertia: Mat3::from_diagonal(&Vec3::new(a, a, c)),
        position: Vec3::new(0.1, 0.2, 0.3),
        orientation: start,
        velocity: Vec3::new(-0.5, 0.4, 0.6),
        angular_velocity: spin,
        mobility: Mobility::spatial(),
        role: Role::Solid,
    };
    let momentum = rotation::matrix(&start) * (body.inertia * spin);
    let exact = |t: f64| {
        let precession = rotation::from_axis_angle(&momentum, momentum.norm() / a * t);
        let own = rotation::from_axis_angle(&Vec3::z(), (1.0 - c / a) * spin.z * t);
        rotation::compose(&precession, &rotation::compose(&start, &own))
    };
    let model = Model {
        gravity: Vec3::zeros(),
        bodies: vec![body.clone()],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let errors = [2e-3, 1e-3, 5e-4].map(|h| {
        let run = bdf(&model, DURATION, h, 2);
        (0..=run.last()).fold(0.0_f64, |worst, k| {
            let (q, t) = (run.q(k), run.time(k));
            let centre = body.position + body.velocity * t;
            assert!((Vec3::new(q[0], q[1], q[2]) - centre).norm() <= 1e-12);
            let p = exact(t);
            let off = (0..4).map(|i| (q[3 + i] - p[i]).abs());
            off.fold(worst, f64::max)
        })
    });
    for pair in errors.windows(2) {
        let observed = observed_order(pair[0], pair[1]);
        assert!((observed - 2.0).abs() <= 0.1, "{errors:?}: {observed:.3}");
    }
    assert!(errors[1] <= 2.5e-6, "{errors:?}");
}
