//! Motions of flexible bodies: what is conserved, what does not depend on the observer, and the limit of
//! a stiff body.

use crate::reference;

use flexbody_mathematics::math::{Vec3, rotation};
use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::functions::{Function, Instant, Reduction, Scene};
use flexbody_mechanics::integrate::{Method, Settings, Spacing, Trajectory, simulate};
use flexbody_mechanics::lower::Plane;
use flexbody_mechanics::model::flexible::ModalStiffness;
use flexbody_mechanics::model::{Mobility, Model, Role};
use flexbody_mechanics::system::Numbering;
use flexbody_mechanics::system::observe::{Observation, observe};
use reference::flexible::{Points, modal, modal_of, planar_swing, stiffness, swing_from, swing_of};
use reference::models::{Numbers, alone};

const RADAU: Method = Method::Radau { stages: 3 };

/// A free undamped body that spins and vibrates.
fn free(seed: u64, modes: usize) -> Model<f64> {
    let mut numbers = Numbers(seed);
    let points = Points::any(&mut numbers, 12, modes);
    let mut frame = numbers.body("body");
    (frame.mass, frame.inertia) = points.rigid();
    let mut model = alone(frame);
    let stiff = stiffness(&mut numbers, modes, 100.0);
    let (q, rate) = (numbers.list(modes), numbers.list(modes));
    let scaled = |x: &[f64], by: f64| -> Vec<f64> { x.iter().map(|x| x * by).collect() };
    let damping = vec![0.0; modes * modes];
    let start = (&scaled(&q, 0.1)[..], &scaled(&rate, 0.5)[..]);
    model.add_flexible(0, start, modal(points.inertia(), stiff, damping));
    model
}

fn run(model: &Model<f64>, duration: f64, method: Method, spacing: Spacing) -> Trajectory<f64> {
    let mut settings = Settings::steps(method, 1);
    settings.spacing = spacing;
    simulate(model, duration, &settings).expect("runs")
}

fn seen(model: &Model<f64>, run: &Trajectory<f64>, k: usize) -> Observation {
    observe(model, &run.numbering, (run.q(k), run.v(k)), run.instants[k])
}

/// Elastic coordinates at a sample.
fn elastic(model: &Model<f64>, run: &Trajectory<f64>, k: usize) -> Vec<f64> {
    let places = model.flexible[0].places();
    places
        .map(|(carrier, i)| run.q(k)[run.numbering.position(carrier) + i])
        .collect()
}

#[test]
fn energy_and_momenta_are_kept() {
    for (seed, modes) in [(1, 2), (2, 3), (3, 5)] {
        let model = free(seed, modes);
        for (method, tolerance, most) in [(Method::Dop853, 1e-11, 1e-9), (RADAU, 1e-9, 1e-6)] {
            let run = run(&model, 1.0, method, Spacing::Tolerance(tolerance));
            let first = seen(&model, &run, 0);
            let energy = first.kinetic + first.potential;
            assert!(first.potential > 0.01 * energy);
            for k in 0..=run.last() {
                let now = seen(&model, &run, k);
                let off = (now.kinetic + now.potential - energy).abs() / energy;
                assert!(off <= most, "{} energy {off:e}", method.name());
                let linear = (now.momentum - first.momentum).norm() / first.momentum.norm();
                let angular = (now.angular_momentum - first.angular_momentum).norm();
                let angular = angular / first.angular_momentum.norm();
                assert!(linear <= 1e-9, "{} momentum {linear:e}", method.name());
                assert!(angular <= most, "{} momentum {angular:e}", method.name());
            }
        }
    }
}

/// The error of the energy falls with the order of the method.
#[test]
fn energy_converges_with_the_order() {
    let model = free(4, 4);
    for (method, steps, order) in [(Method::Dop853, 30, 7.0), (RADAU, 40, 4.5)] {
        let error = |steps| {
            let run = run(&model, 1.0, method, Spacing::Steps(steps));
            let (first, last) = (seen(&model, &run, 0), seen(&model, &run, run.last()));
            let energy = first.kinetic + first.potential;
            (last.kinetic + last.potential - energy).abs() / energy
        };
        let (coarse, fine) = (error(steps), error(2 * steps));
        let found = (coarse / fine).log2();
        assert!(found > order, "{}: {coarse:e} {fine:e}", method.name());
    }
}

/// A body to which 10 m/s are added vibrates in the same way, and so does a turned one.
#[test]
fn vibration_does_not_depend_on_the_observer() {
    for (seed, modes) in [(5, 1), (6, 3), (7, 5)] {
        let model = free(seed, modes);
        let mut numbers = Numbers(seed);
        let mut fast = model.clone();
        fast.bodies[0].velocity += numbers.vector().normalize() * 10.0;
        let mut turned = model.clone();
        let turn = numbers.orientation();
        let frame = &mut turned.bodies[0];
        frame.orientation = rotation::compose(&turn, &frame.orientation);
        frame.velocity = rotation::matrix(&turn) * frame.velocity;
        for method in [Method::Dop853, RADAU] {
            let of = |model: &Model<f64>| run(model, 1.0, method, Spacing::Steps(120));
            let base = of(&model);
            for other in [&fast, &turned] {
                let same = of(other);
                for k in 0..=base.last() {
                    let (x, y) = (elastic(&model, &base, k), elastic(other, &same, k));
                    let off = x
                        .iter()
                        .zip(&y)
                        .fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
                    assert!(off <= 1e-11, "{}: {off:e}", method.name());
                }
            }
        }
    }
}

/// Explicit and implicit methods find the same motion, joints included; the constraints hold.
#[test]
fn methods_agree() {
    for (seed, modes) in [(31, 3), (32, 4)] {
        let model = swing_of(seed, modes, 300.0);
        let explicit = run(&model, 0.5, Method::Dop853, Spacing::Tolerance(1e-10));
        let bdf = Method::Bdf {
            order: 2,
            start: flexbody_mechanics::integrate::Start::Radau,
        };
        let alpha = Method::GeneralisedAlpha { radius: 0.8 };
        for (method, spacing, most) in [
            (RADAU, Spacing::Tolerance(1e-8), 1e-6),
            (Method::Radau { stages: 2 }, Spacing::Steps(800), 1e-5),
            (bdf, Spacing::Steps(3000), 2e-3),
            (alpha, Spacing::Steps(3000), 2e-3),
        ] {
            let implicit = run(&model, 0.5, method, spacing);
            let (x, y) = (explicit.q(explicit.last()), implicit.q(implicit.last()));
            let off = x
                .iter()
                .zip(y)
                .fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
            assert!(off <= most, "{}: {off:e}", method.name());
            let last = seen(&model, &implicit, implicit.last());
            assert!(last.position_drift <= 1e-10, "{:e}", last.position_drift);
        }
        let last = seen(&model, &explicit, explicit.last());
        assert!(last.position_drift <= 1e-11 && last.velocity_drift <= 1e-10);
    }
}

/// The motion of a stiff body goes to that of a rigid one, of which the coordinates cannot move, as 1/k.
#[test]
fn stiff_bodies_are_nearly_rigid() {
    let modes = 3;
    let at = |size: f64| {
        // Closed where it starts undeformed.
        let mut model = swing_from(41, modes, 1.0, 0.0);
        let own = modal_of(&mut model.flexible[0].form);
        let ModalStiffness { linear, strains } = &mut own.stiffness;
        linear.iter_mut().for_each(|k| *k *= size);
        strains.iter_mut().for_each(|strain| strain.weight *= size);
        // Critical damping and more, so that the start leaves no vibration.
        let damping = &mut own.damping;
        damping.iter_mut().for_each(|d| *d *= 8.0 * size.sqrt());
        for body in &mut model.bodies {
            body.velocity.fill(0.0);
            body.angular_velocity.fill(0.0);
        }
        model
    };
    let mut rigid = at(1.0);
    for carrier in rigid.flexible[0].carriers() {
        rigid.bodies[carrier].mobility = Mobility::fixed();
    }
    let exact = run(&rigid, 0.4, RADAU, Spacing::Tolerance(1e-10));
    let off = |size: f64| {
        let run = run(&at(size), 0.4, RADAU, Spacing::Tolerance(1e-9));
        let (x, y) = (exact.q(exact.last()), run.q(run.last()));
        x[..14]
            .iter()
            .zip(y)
            .fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()))
    };
    for size in [1e4, 1e5, 1e6, 1e7] {
        eprintln!("{size:e} {:e}", off(size));
    }
    let (soft, stiff) = (off(1e6), off(1e8));
    let order = (soft / stiff).log10() / 2.0;
    assert!(
        stiff < 1e-4 && (order - 1.0).abs() < 0.15,
        "{soft:e} {stiff:e}"
    );
}

/// In its plane a body has three unknowns beside its coordinates; motion and gradients are those in space.
#[test]
fn planes_are_found() {
    for (seed, modes) in [(51, 2), (52, 3), (53, 5)] {
        let model = planar_swing(seed, modes);
        let plane = Plane::of(&model).expect("is planar");
        let mut lowered = model.clone();
        plane.apply(&mut lowered);
        assert_eq!(Numbering::new(&lowered).unknowns(), 3 * 3 + modes);
        let tip = (0..model.bodies.len()).find(|&body| model.bodies[body].role == Role::Interface);
        for method in [Method::Dop853, RADAU] {
            let all = [&model, &lowered].map(|model| {
                let run = run(model, 0.3, method, Spacing::Steps(40));
                let scene = Scene {
                    model: model.clone(),
                    duration: 0.3,
                    until: None,
                    functions: vec![Function::reduced(
                        Instant::SpeedSquared {
                            body: tip.expect("has an interface"),
                            point: Vec3::new(0.1, 0.2, 0.0),
                        },
                        Reduction::Integral,
                    )],
                    unstarted: None,
                };
                let found = gradients(&scene, &run, &[0]).expect("differentiates");
                let mut by = found.gradients[0].model.flexible[0].clone();
                let by = modal_of(&mut by.form);
                let inertia = by
                    .inertia
                    .products
                    .iter()
                    .flat_map(|s| [s[(0, 0)], s[(1, 0)]]);
                let stiff = by.stiffness.linear.iter().copied();
                let by: Vec<f64> = inertia.chain(stiff).collect();
                (run.q(run.last()).to_vec(), by)
            });
            let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let off = |x: &[f64], y: &[f64]| {
                let pairs = x.iter().zip(y);
                largest(&pairs.map(|(x, y)| x - y).collect::<Vec<_>>())
            };
            let [(q, by), (q_lowered, by_lowered)] = &all;
            assert!(off(q, q_lowered) <= 1e-11, "{:e}", off(q, q_lowered));
            let relative = off(by, by_lowered) / largest(by);
            assert!(relative <= 1e-10, "{relative:e}");
        }
        // A mode that leaves the plane is named.
        let mut tilted = model.clone();
        modal_of(&mut tilted.flexible[0].form)
            .inertia
            .static_moments[0]
            .z = 1e-6;
        let kept = Plane::of(&tilted)
            .expect_err("leaves the plane")
            .to_string();
        assert!(kept.contains("the deformation of body \"arm\""), "{kept}");
    }
}
