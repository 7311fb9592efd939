//! The adjoint gives the derivative of every function in every single parameter of a scene.

mod reference;

use flexbody::adjoint::gradients;
use flexbody::functions::{
    EnergyPart, Function, Gate, Instant, Projectile, Reduction, Release, Scene, Side,
};
use flexbody::integrate::bdf::simulate_complex;
use flexbody::integrate::{Method, Settings, simulate};
use flexbody::math::{Complex64, Vec3, scalar::COMPLEX_STEP};
use flexbody::model::{JointKind, Model};

/// Every instant quantity and every reduction at least once.
fn functions(body: usize, gate_body: usize) -> Vec<Function<f64>> {
    let (point, direction) = (Vec3::new(0.1, 0.4, -0.2), Vec3::new(0.6, 0.64, -0.48));
    let projectile = Projectile {
        body,
        point,
        direction: Vec3::x(),
        ground: -10.0,
    };
    let gate = Gate {
        body: gate_body,
        axis: Vec3::z(),
        limit: 0.4,
        width: 0.3,
        open: Side::Above,
    };
    let reduced = |instant, reduction| Function::Reduced { instant, reduction };
    vec![
        reduced(
            Instant::Position {
                body,
                point,
                direction,
            },
            Reduction::Final,
        ),
        reduced(
            Instant::Velocity {
                body,
                point,
                direction,
            },
            Reduction::Ks { rho: 2.0 },
        ),
        reduced(
            Instant::Acceleration {
                body,
                point,
                direction,
            },
            Reduction::Integral,
        ),
        reduced(
            Instant::Speed { body, point },
            Reduction::InducedExponential { rho: 0.7 },
        ),
        reduced(Instant::Energy(EnergyPart::Kinetic), Reduction::Integral),
        reduced(
            Instant::Energy(EnergyPart::Potential),
            Reduction::Ks { rho: 0.1 },
        ),
        reduced(Instant::Energy(EnergyPart::Total), Reduction::Final),
        reduced(
            Instant::Rotation {
                body,
                axis: direction,
            },
            Reduction::Integral,
        ),
        reduced(
            Instant::Range {
                projectile,
                gate: Some(gate),
            },
            Reduction::Ks { rho: 0.5 },
        ),
        Function::Clearance {
            projectile,
            release: Release::Best {
                rho: 0.5,
                projectile,
                gate: Some(gate),
            },
            distance: 30.0,
            top: 4.0,
        },
        Function::Clearance {
            projectile,
            release: Release::Final,
            distance: 30.0,
            top: 4.0,
        },
    ]
}

/// Every derivative agrees to 1e-11 of itself or to 1e-12 of the function's largest derivative:
/// round-off of the large ones reaches the small ones, and the complex run takes its own path within
/// Newton's tolerance. (`problems_check.rs` differentiates one and the same motion twice.)
fn check(model: Model<f64>, duration: f64, steps: usize, order: usize) {
    let last = model.bodies.len() - 1;
    let scene = Scene {
        model,
        duration,
        functions: functions(last, last.saturating_sub(1)),
    };
    let settings = Settings {
        steps,
        method: Method::Bdf { order },
    };
    let run = simulate(&scene.model, duration, &settings).expect("runs");
    let which: Vec<usize> = (0..scene.functions.len()).collect();
    let adjoint = gradients(&scene, &run, &which).expect("differentiates");
    assert_eq!(
        adjoint.counts.factorisations,
        steps + 2 * which.len() + accelerations(&which)
    );
    let exact = complex_steps(&scene, &settings);
    for (f, gradient) in adjoint.gradients.iter().enumerate() {
        let given = gradient.parameters();
        let scale = exact.iter().fold(1.0_f64, |m, row| m.max(row[f].abs()));
        for (i, row) in exact.iter().enumerate() {
            let difference = (given[i] - row[f]).abs();
            let bound = 1e-11 * row[f].abs().max(0.1 * scale);
            assert!(
                difference <= bound,
                "function {f} parameter {i}: {} against {}, off by {difference:e}",
                given[i],
                row[f]
            );
        }
    }
}

/// The one function of accelerations needs the initial accelerations too.
fn accelerations(which: &[usize]) -> usize {
    usize::from(which.contains(&2))
}

/// Derivatives [parameter][function] by the complex step, one run a parameter.
fn complex_steps(scene: &Scene<f64>, settings: &Settings) -> Vec<Vec<f64>> {
    let count = scene.parameters().len();
    (0..count)
        .map(|wanted| {
            let mut i = 0;
            let moved: Scene<Complex64> = scene.map(&mut |x| {
                i += 1;
                Complex64::new(x, if i == wanted + 1 { COMPLEX_STEP } else { 0.0 })
            });
            let run = simulate_complex(&moved.model, moved.duration, settings).expect("runs");
            moved
                .functions
                .iter()
                .map(|f| f.evaluate(&moved.model, &run).value.im / COMPLEX_STEP)
                .collect()
        })
        .collect()
}

#[test]
fn triple_pendulum_in_space() {
    let (model, _) = reference::load("triple_pendulum");
    for order in [1, 2] {
        check(model.clone(), 0.4, 40, order);
    }
}

#[test]
fn trebuchet() {
    let (model, _) = reference::load("trebuchet");
    check(model, 0.5, 100, 2);
}

#[test]
fn every_kind_of_joint() {
    let (mut model, _) = reference::load("triple_pendulum");
    for (joint, kind) in [(1, JointKind::Prismatic), (2, JointKind::Planar)] {
        model.joints[joint].kind = kind;
    }
    check(model, 0.4, 40, 2);
}
