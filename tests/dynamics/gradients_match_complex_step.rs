//! The adjoint gives the exact derivative of every function in every parameter of a scene.

use crate::reference;

use flexbody_mathematics::math::{Complex64, Parameters, Vec3, scalar::COMPLEX_STEP};
use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::functions::{
    Bound, EnergyPart, Function, Gate, GateSide, Instant, Projectile, Reduction, Release, Rotation,
    Scene,
};
use flexbody_mechanics::integrate::{
    Method, Samples, Settings, Spacing, Start, Trajectory, simulate,
};
use flexbody_mechanics::model::{JointKind, Model};

/// Every instant quantity and every reduction, at least once each.
pub(super) fn functions(body: usize, gate_body: usize) -> Vec<Function<f64>> {
    let (point, direction) = (Vec3::new(0.1, 0.4, -0.2), Vec3::new(0.6, 0.64, -0.48));
    let projectile = Projectile {
        body,
        point,
        direction: Vec3::x(),
        ground: -10.0,
    };
    let turned = |body, relative_to, axis, placed| Rotation {
        body,
        relative_to,
        axis,
        placed,
        first: None,
        joint: None,
    };
    let gate = Gate {
        rotation: turned(gate_body, None, Vec3::z(), None),
        limit: 0.4,
        width: 0.3,
        open: GateSide::Above,
    };
    let other = (gate_body != body).then_some(body);
    let seen_from = Gate {
        rotation: turned(gate_body, other, Vec3::z(), Some([0.9, 0.1, -0.2, 0.3])),
        limit: 0.1,
        width: 0.8,
        open: GateSide::Below,
    };
    let reduced = Function::reduced;
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
            Reduction::Ks {
                rho: 2.0,
                bound: Bound::Below,
            },
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
        reduced(
            Instant::SpeedSquared { body, point },
            Reduction::InducedExponential { rho: 0.2 },
        ),
        Function::Duration,
        reduced(
            Instant::AngularVelocity { body, direction },
            Reduction::Ks {
                rho: 0.9,
                bound: Bound::Above,
            },
        ),
        reduced(Instant::Momentum { direction }, Reduction::Integral),
        reduced(Instant::Energy(EnergyPart::Kinetic), Reduction::Integral),
        reduced(
            Instant::Energy(EnergyPart::Potential),
            Reduction::Ks {
                rho: 0.1,
                bound: Bound::Above,
            },
        ),
        reduced(Instant::Energy(EnergyPart::Total), Reduction::Final),
        reduced(
            Instant::Rotation(turned(body, None, direction, None)),
            Reduction::Integral,
        ),
        reduced(
            Instant::Rotation(turned(
                body,
                (gate_body != body).then_some(gate_body),
                direction,
                Some([0.8, -0.2, 0.3, 0.5]),
            )),
            Reduction::Ks {
                rho: 0.5,
                bound: Bound::Above,
            },
        ),
        reduced(
            Instant::Range {
                projectile,
                gate: Some(gate),
            },
            Reduction::Ks {
                rho: 0.5,
                bound: Bound::Below,
            },
        ),
        Function::Clearance {
            projectile,
            release: Release::Best {
                rho: 0.5,
                projectile,
                gate: Some(seen_from),
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

/// The derivative of every function in every parameter agrees to 1e-12 of itself or of the
/// function's largest derivative, whose round-off affects the small ones. Adjoint and complex step
/// differentiate the same motion.
fn check(model: &Model<f64>, duration: f64, settings: &Settings) {
    let scene = scene(model, duration);
    let count = scene.parameters().len();
    let units: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    compare(&scene, settings, &units);
}

/// As [`check`], in three directions that change all parameters at once, in proportion to their
/// size.
fn check_directions(model: &Model<f64>, duration: f64, settings: &Settings) {
    let scene = scene(model, duration);
    let parameters = scene.parameters();
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = || {
        // xorshift64 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut direction = || {
        parameters
            .iter()
            .map(|p| random() * p.abs().max(0.1))
            .collect()
    };
    let directions = [direction(), direction(), direction()];
    compare(&scene, settings, &directions);
}

fn scene(model: &Model<f64>, duration: f64) -> Scene<f64> {
    let last = model.bodies.len() - 1;
    Scene {
        model: model.clone(),
        duration,
        until: None,
        functions: functions(last, last.saturating_sub(1)),
        unstarted: None,
    }
}

pub(super) fn compare(scene: &Scene<f64>, settings: &Settings, directions: &[Vec<f64>]) {
    compare_to(scene, settings, directions, |_, _| (1.0, 1e-12));
}

/// The same, to a size and a tolerance of each function and its value: derivatives below the size are judged by it.
pub(super) fn compare_to(
    scene: &Scene<f64>,
    settings: &Settings,
    directions: &[Vec<f64>],
    size_and_tolerance: impl Fn(&Function<f64>, f64) -> (f64, f64),
) {
    let (exact, run) = complex_steps(scene, settings, directions);
    let which: Vec<usize> = (0..scene.functions.len()).collect();
    let adjoint = gradients(scene, &run, &which).expect("differentiates");
    for (f, gradient) in adjoint.gradients.iter().enumerate() {
        let function = &scene.functions[f];
        let value = function.evaluate(&scene.model, &run).value;
        let (size, tolerance) = size_and_tolerance(function, value);
        let given = gradient.parameters();
        let scale = exact.iter().fold(size, |m, row| m.max(row[f].abs()));
        for (row, direction) in exact.iter().zip(directions) {
            let sum: f64 = given.iter().zip(direction).map(|(g, d)| g * d).sum();
            let relative = (sum - row[f]).abs() / row[f].abs().max(scale);
            assert!(
                relative <= tolerance,
                "{}: function {f}: {sum} against {}, off by {relative:e}",
                settings.method.name(),
                row[f]
            );
        }
    }
}

/// Derivatives [direction][function] by the complex step, with one run per direction; and the real
/// motion.
fn complex_steps(
    scene: &Scene<f64>,
    settings: &Settings,
    directions: &[Vec<f64>],
) -> (Vec<Vec<f64>>, Trajectory<f64>) {
    let mut motion = None;
    let derivative = |direction: &Vec<f64>| {
        let mut i = 0;
        let moved: Scene<Complex64> = scene.map(&mut |x| {
            i += 1;
            Complex64::new(x, COMPLEX_STEP * direction[i - 1])
        });
        let run = simulate(&moved.model, moved.duration, settings).expect("runs");
        let by = |f: &Function<Complex64>| f.evaluate(&moved.model, &run).value.im / COMPLEX_STEP;
        let found = moved.functions.iter().map(by).collect();
        motion.get_or_insert_with(|| run.real());
        found
    };
    let derivatives = directions.iter().map(derivative).collect();
    (derivatives, motion.expect("a scene has parameters"))
}

/// Settings of the explicit method for each scene: given and frozen adaptive grids, samples at the
/// ends of steps and inside.
pub(super) fn explicit(model: &Model<f64>, duration: f64, steps: usize) -> Vec<Settings> {
    let mut chosen = Settings::steps(Method::Dop853, steps);
    let fixed = chosen.clone();
    chosen.spacing = Spacing::Tolerance(1e-7);
    let run = simulate(model, duration, &chosen).expect("runs");
    chosen.spacing = Spacing::Frozen(run.grid);
    chosen.samples = Samples::Uniform(37);
    let mut kept = chosen.clone();
    kept.memory = 1 << 28;
    // Nodes of cells; some steps have none, others several.
    if let Spacing::Frozen(grid) = &chosen.spacing {
        let cells = (0..grid.steps()).map(|k| [1, 0, 3][k % 3]).collect();
        kept.spacing = Spacing::Frozen(grid.clone().with_cells(cells));
        kept.samples = Samples::Quadrature(5);
    }
    // Large corrections by the projections.
    let mut loose = kept.clone();
    loose.spacing = Spacing::Tolerance(1e-2);
    let run = simulate(model, duration, &loose).expect("runs");
    loose.spacing = Spacing::Frozen(run.grid);
    vec![fixed, chosen, kept, loose]
}

/// Every implicit method with equal steps and, if adaptive, on a frozen grid with samples inside
/// the steps.
pub(super) fn implicit(model: &Model<f64>, duration: f64, steps: usize) -> Vec<Settings> {
    let bdf = |order| Method::Bdf {
        order,
        start: Start::Radau,
    };
    let rising = |order| Method::Bdf {
        order,
        start: Start::RisingOrder,
    };
    let radau = |stages| Method::Radau { stages };
    let mut all: Vec<Settings> = [
        bdf(1),
        bdf(2),
        bdf(3),
        bdf(4),
        bdf(5),
        bdf(6),
        rising(2),
        rising(5),
        Method::GeneralisedAlpha { radius: 0.5 },
        Method::GeneralisedAlpha { radius: 0.8 },
        radau(2),
        radau(3),
    ]
    .map(|method| Settings::steps(method, steps))
    .to_vec();
    for stages in [2, 3] {
        let mut settings = Settings::steps(radau(stages), steps);
        settings.spacing = Spacing::Tolerance(1e-5);
        let run = simulate(model, duration, &settings).expect("runs");
        settings.spacing = Spacing::Frozen(run.grid);
        settings.samples = match stages {
            2 => Samples::Uniform(37),
            _ => Samples::Quadrature(5),
        };
        all.push(settings);
    }
    all
}

/// Every single parameter, by one method of each family.
#[test]
fn every_parameter_of_every_kind_of_joint() {
    let (mut model, _) = reference::load("triple_pendulum");
    for (joint, kind) in [(1, JointKind::Prismatic), (2, JointKind::Planar)] {
        model.joints[joint].kind = kind;
    }
    let settings = explicit(&model, 0.4, 10);
    check(&model, 0.4, &settings[1]);
    let bdf = Method::Bdf {
        order: 3,
        start: Start::Radau,
    };
    check(&model, 0.4, &Settings::steps(bdf, 12));
}

#[test]
fn every_parameter_of_the_trebuchet() {
    let (model, _) = reference::load("trebuchet");
    let settings = explicit(&model, 0.5, 10);
    check(&model, 0.5, &settings[2]);
    let alpha = Method::GeneralisedAlpha { radius: 0.8 };
    check(&model, 0.5, &Settings::steps(alpha, 12));
}

/// All methods, in directions that change all parameters.
#[test]
fn triple_pendulum_in_space() {
    let (model, _) = reference::load("triple_pendulum");
    for settings in explicit(&model, 0.4, 10)
        .iter()
        .chain(&implicit(&model, 0.4, 40))
    {
        check_directions(&model, 0.4, settings);
    }
}

/// All methods, in directions that change all parameters.
#[test]
fn trebuchet() {
    let (model, _) = reference::load("trebuchet");
    for settings in explicit(&model, 0.5, 10)
        .iter()
        .chain(&implicit(&model, 0.5, 40))
    {
        check_directions(&model, 0.5, settings);
    }
}
