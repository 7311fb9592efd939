//! The check of energy: no correct run of a conservative scene is rejected, and a run with wrong
//! states is.

use crate::reference::models::{KINDS, Numbers, joint};

use flexbody_mathematics::math::{Complex64, Parameters, Vec3};
use flexbody_mechanics::integrate::energy::{Ledger, Supply};
use flexbody_mechanics::integrate::scale::Scale;
use flexbody_mechanics::integrate::{
    Grid, IntegrationFailure, Method, Settings, Spacing, Trajectory, simulate,
};
use flexbody_mechanics::model::{
    Axes, DegreeOfFreedom, Drive, JointKind, Load, LoadKind, Model, TimeFunction,
};
use flexbody_mechanics::system::BodyMotion;
use flexbody_mechanics::system::accelerations::Accelerations;

/// A tree of one to four bodies on random joints, with and without gravity, with springs of
/// stiffness 1 to 1e5 between points and about hinges, in lengths of `unit` \[m\].
fn scene(seed: u64, unit: f64) -> (Model<f64>, f64) {
    let mut numbers = Numbers(seed);
    let mut below = |n: usize| ((numbers.next() + 1.0) * 0.5 * n as f64) as usize;
    let count = 1 + below(4);
    let picks: Vec<[usize; 4]> = (0..count)
        .map(|k| [below(KINDS.len()), below(k + 1), below(3), below(6)])
        .collect();
    let floats = below(4) == 0;
    let names = ["first", "second", "third", "fourth"];
    let bodies: Vec<_> = (0..count).map(|k| numbers.body(names[k])).collect();
    let (mut joints, mut loads) = (Vec::new(), Vec::new());
    for (k, [kind, parent, spring, size]) in picks.into_iter().enumerate() {
        let parent = (k > 0).then(|| parent.min(k - 1));
        let (point, axis) = (numbers.vector(), numbers.vector());
        let name = format!("joint {k}");
        let index = joints.len();
        let kind = KINDS[kind];
        if k > 0 || !floats {
            joints.push(joint(&bodies, (&name, kind), (k, parent), &point, &axis));
        }
        let stiffness = 10.0_f64.powi(size as i32);
        let turns = index < joints.len() && kind == JointKind::Revolute;
        let kind = match spring {
            0 => continue,
            1 if turns => LoadKind::TorsionSpring {
                joint: index,
                counter: None,
                rest_angle: 0.3 * numbers.next(),
                stiffness,
                cubic: 0.3 * stiffness,
                damping: 0.0,
                tables: [None, None],
            },
            _ => LoadKind::Spring {
                body_a: k,
                body_b: parent,
                point_a: numbers.vector(),
                point_b: numbers.vector() + Vec3::repeat(2.5),
                rest_length: 2.0,
                stiffness,
                cubic: 0.3 * stiffness,
                damping: 0.0,
                tables: [None, None],
            },
        };
        let name = format!("spring {k}");
        loads.push(Load { name, kind });
    }
    let gravity = numbers.vector() * if numbers.next() > 0.0 { 10.0 } else { 0.0 };
    let mut model = Model {
        gravity,
        bodies,
        joints,
        loads,
        flexible: Vec::new(),
    };
    let duration = 0.5 + 0.4 * numbers.next();
    in_lengths_of(&mut model, unit);
    (model, duration)
}

/// The same motion in lengths of `unit`.
fn in_lengths_of(model: &mut Model<f64>, unit: f64) {
    model.gravity *= unit;
    for body in &mut model.bodies {
        body.position *= unit;
        body.velocity *= unit;
        body.inertia *= unit * unit;
    }
    for joint in &mut model.joints {
        for frame in [&mut joint.frame_a, &mut joint.frame_b] {
            frame.point *= unit;
            frame.length *= unit;
        }
    }
    for load in &mut model.loads {
        match &mut load.kind {
            LoadKind::Spring {
                point_a,
                point_b,
                rest_length,
                cubic,
                ..
            } => {
                *point_a *= unit;
                *point_b *= unit;
                *rest_length *= unit;
                *cubic /= unit * unit;
            }
            LoadKind::TorsionSpring { stiffness, .. } => *stiffness *= unit * unit,
            _ => {}
        }
    }
}

fn settings(method: Method, spacing: Spacing) -> Settings {
    Settings {
        spacing,
        ..Settings::steps(method, 1)
    }
}

const RADAU: Method = Method::Radau { stages: 3 };

/// Runs with tolerances from 1e-3 to 1e-12, on the steps of another duration and on halved steps
/// are not rejected for their energy. The explicit method may find them stiff.
#[test]
fn no_right_run_is_refused() {
    let (mut runs, mut kept) = (0, 0);
    for seed in 0..9 {
        let unit = [1.0, 1e-3, 1e2][seed as usize % 3];
        let (model, duration) = scene(seed, unit);
        assert!(model.conserves_energy());
        for (method, exponents) in [
            (Method::Dop853, &[3, 5, 6, 8, 10, 12][..]),
            (RADAU, &[3, 4, 6, 9]),
            (Method::Radau { stages: 2 }, &[3, 5]),
        ] {
            for &exponent in exponents {
                let tolerance = 10.0_f64.powi(-exponent);
                let name = format!("scene {seed}, {}, {tolerance:e}", method.name());
                let chosen = settings(method, Spacing::Tolerance(tolerance));
                let run = match simulate(&model, duration, &chosen) {
                    Ok(run) => run,
                    Err(IntegrationFailure::Stiff { .. }) => continue,
                    Err(failure) => panic!("{name}: {failure}"),
                };
                runs += 1;
                for (grid, duration) in [
                    (run.grid.clone(), 1.1 * duration),
                    (run.grid.halved(), duration),
                ] {
                    let frozen = settings(method, Spacing::Frozen(grid));
                    match simulate(&model, duration, &frozen) {
                        Ok(_) => kept += 1,
                        Err(failure @ IntegrationFailure::EnergyLost { .. }) => {
                            panic!("{name}, kept steps: {failure}")
                        }
                        Err(_) => {}
                    }
                }
            }
        }
    }
    assert!(runs > 75 && kept > 110, "{runs} runs, {kept} on kept steps");
}

/// Checks a run at the ends of its steps after `spoil` has changed the velocities.
fn judge(
    model: &Model<f64>,
    run: &Trajectory<f64>,
    tolerance: f64,
    spoil: impl Fn(usize, &mut [f64]),
) -> Result<(), IntegrationFailure> {
    let scale = Scale::of(model, &run.numbering, &run.initial, run.duration);
    let by = settings(run.method, Spacing::Tolerance(tolerance));
    let mut ledger = Ledger::open(model, &by, &scale).expect("energy is conserved");
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        if !Ledger::is_due(k) && k != run.last() {
            continue;
        }
        let mut v = run.v(k).to_vec();
        spoil(k, &mut v);
        BodyMotion::all(&run.numbering, run.q(k), &v, &mut motions);
        ledger.enter(model, &motions, run.time(k));
    }
    ledger.close(run.grid.steps(), run.step_error)
}

/// A run is rejected, with the time, if its velocities are wrong by a half from some step on, or if
/// a state is NaN; nearly always if they are wrong by 5 %; and not if they are wrong by 1e-6.
#[test]
fn a_spoilt_run_is_refused() {
    let (mut runs, mut small) = (0, 0);
    for seed in 0..40 {
        let unit = [1.0, 1e-2, 1e2][seed as usize % 3];
        let (mut model, duration) = scene(seed, unit);
        model.gravity = Vec3::new(0.0, 0.0, -9.81) * unit;
        let tolerance = 1e-11;
        let by = settings(Method::Dop853, Spacing::Tolerance(tolerance));
        let run = match simulate(&model, duration, &by) {
            Ok(run) => run,
            Err(IntegrationFailure::Stiff { .. }) => continue,
            Err(failure) => panic!("scene {seed}: {failure}"),
        };
        let judge = |from: usize, factor: f64| {
            judge(&model, &run, tolerance, |k, v| {
                if k >= from {
                    v.iter_mut().for_each(|v| *v *= factor);
                }
            })
        };
        judge(0, 1.0).expect("as it was");
        judge(3, 1.0 + 1e-6).expect("nearly as it was");
        // A body that is welded to ground has no velocity to change.
        let fastest = run.v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let moves = fastest > 1e-6 * unit;
        for factor in [1.5, f64::NAN] {
            if !moves && factor.is_finite() {
                continue;
            }
            let Err(failure) = judge(3, factor) else {
                panic!("scene {seed}, {factor}: not refused");
            };
            let text = failure.to_string();
            let IntegrationFailure::EnergyLost { time, drift, .. } = failure else {
                panic!("scene {seed}: {text}");
            };
            // From step 3 on, the first checked end is that of step 4, or the last.
            assert_eq!(time, run.time(run.last().min(4)), "scene {seed}");
            assert_eq!(drift.is_nan(), factor.is_nan(), "scene {seed}");
            let named = text.starts_with("energy is not conserved: at t = ");
            assert!(named, "{text}");
        }
        runs += usize::from(moves);
        small += usize::from(moves && judge(3, 1.05).is_err());
    }
    assert!(runs >= 25 && 10 * small >= 9 * runs, "{small} of {runs}");
}

/// The scene `seed` under gravity with a force, a torque or a drive, or all of them.
fn loaded(seed: u64, unit: f64) -> (Model<f64>, f64) {
    let (mut model, duration) = scene(seed, unit);
    model.gravity = Vec3::new(0.0, 0.0, -9.81) * unit;
    let body = model.bodies.len() - 1;
    let own = &model.bodies[body];
    let (weight, inertia) = (own.mass * 9.81 * unit, own.inertia.trace());
    let kinds = [
        LoadKind::Force {
            body,
            point: Vec3::new(0.1, 0.2, 0.3) * unit,
            direction: Vec3::new(0.6, 0.0, 0.8),
            axes: Axes::Ground,
            magnitude: TimeFunction::Polynomial(vec![0.0, 9.0 * weight]),
        },
        LoadKind::Torque {
            body,
            direction: Vec3::x(),
            axes: Axes::Body,
            magnitude: TimeFunction::constant(20.0 * inertia),
        },
    ];
    let name = |k: usize| format!("load {k}");
    for (k, kind) in kinds.into_iter().enumerate() {
        if seed % 4 == k as u64 || seed % 4 == 3 {
            let name = name(k);
            model.loads.push(Load { name, kind });
        }
    }
    let turns =
        |joint: &&mut flexbody_mechanics::model::Joint<f64>| joint.kind == JointKind::Revolute;
    if seed % 4 >= 2
        && let Some(joint) = model.joints.iter_mut().find(turns)
    {
        joint.drives.push(Drive {
            dof: DegreeOfFreedom::Rotation,
            course: TimeFunction::Polynomial(vec![0.0, 0.0, 3.0]),
        });
    }
    (model, duration)
}

/// Explicit runs with loads and drives are not refused for the energy that these supply. With
/// velocities ten times as large from some step on they are refused at its end.
#[test]
fn energy_that_no_load_supplied_is_refused_at_once() {
    let (mut runs, mut refused) = (0, 0);
    for seed in 0..32 {
        let unit = [1.0, 1e-3, 1e2][seed as usize % 3];
        let (model, duration) = loaded(seed, unit);
        let by = settings(Method::Dop853, Spacing::Tolerance(1e-8));
        let run = match simulate(&model, duration, &by) {
            Ok(run) => run,
            Err(failure @ IntegrationFailure::EnergyGained { .. }) => {
                panic!("scene {seed}: {failure}")
            }
            Err(_) => continue,
        };
        runs += 1;
        let scale = Scale::of(&model, &run.numbering, &run.initial, run.duration);
        let mut field = Accelerations::new(&model, &run.numbering);
        let (mut a, mut lambda) = (run.a(0).to_vec(), run.initial.lambda.clone());
        let mut power = |k: usize| {
            field.set_state(run.q(k), run.v(k), run.time(k));
            field.factorise().expect("is regular");
            field.accelerations(&mut a, &mut lambda);
            field.supplied_power(run.v(k), &lambda)
        };
        let mut motions = Vec::new();
        BodyMotion::all(&run.numbering, run.q(0), run.v(0), &mut motions);
        let supply = Supply::open(&model, &by, &scale, (&motions[..], power(0)));
        let mut supply = supply.expect("steps follow a tolerance");
        for k in 1..=run.last() {
            let factor = if k < 3 { 1.0 } else { 10.0 };
            let v: Vec<f64> = run.v(k).iter().map(|v| factor * v).collect();
            BodyMotion::all(&run.numbering, run.q(k), &v, &mut motions);
            let at = (&motions[..], power(k));
            if let Err(failure) = supply.look(&model, at, (run.time(k), k)) {
                let text = failure.to_string();
                let IntegrationFailure::EnergyGained { time, step, .. } = failure else {
                    panic!("scene {seed}: {text}");
                };
                assert!(step >= 3 && time == run.time(step), "scene {seed}: {text}");
                assert!(text.contains("no load supplied"), "{text}");
                refused += usize::from(step == 3);
                break;
            }
        }
    }
    assert!(runs >= 24 && 3 * refused >= 2 * runs, "{refused} of {runs}");
}

/// There is no check if energy is not conserved, if the user chose equal steps, or in complex runs.
#[test]
fn energy_is_looked_at_only_where_it_is_conserved_and_steps_follow_a_tolerance() {
    let by = settings(Method::Dop853, Spacing::Tolerance(1e-9));
    let scale = Scale {
        length: 1.0,
        floor: [1.0, 1.0],
        elastic: Default::default(),
        states: Vec::new(),
    };
    for seed in 0..20 {
        let mut numbers = Numbers(seed);
        let bodies = vec![numbers.body("body")];
        let kind = (
            ["hinge", "guide"][seed as usize % 2],
            JointKind::Cylindrical,
        );
        let hinge = joint(
            &bodies,
            kind,
            (0, None),
            &numbers.vector(),
            &numbers.vector(),
        );
        let model = Model {
            gravity: numbers.vector(),
            joints: vec![hinge],
            bodies,
            loads: Vec::new(),
            flexible: Vec::new(),
        };
        assert!(Ledger::open(&model, &by, &scale).is_some());
        let kept = settings(RADAU, Spacing::Frozen(Grid::uniform(3)));
        assert!(Ledger::open(&model, &kept, &scale).is_some());
        let equal = Settings::steps(Method::Dop853, 10);
        assert!(Ledger::open(&model, &equal, &scale).is_none());
        let complex = model.map(&mut |x| Complex64::new(x, 0.0));
        assert!(Ledger::open(&complex, &by, &scale).is_none());

        let mut driven = model.clone();
        driven.joints[0].drives.push(Drive {
            dof: DegreeOfFreedom::Rotation,
            course: TimeFunction::Polynomial(vec![0.0, 1.0]),
        });
        assert!(Ledger::open(&driven, &by, &scale).is_none());
        let (joint, dof) = (0, DegreeOfFreedom::Rotation);
        let spring = |damping: f64| LoadKind::Spring {
            body_a: 0,
            body_b: None,
            point_a: Vec3::zeros(),
            point_b: Vec3::repeat(3.0),
            rest_length: 1.0,
            stiffness: 2.0,
            cubic: 0.0,
            damping,
            tables: [None, None],
        };
        for (kind, conserves) in [
            (spring(0.0), true),
            (spring(0.1), false),
            (
                LoadKind::Damping {
                    joint,
                    dof,
                    coefficient: 0.1,
                    table: None,
                },
                false,
            ),
            (
                LoadKind::Friction {
                    joint,
                    dof,
                    size: 0.1,
                    width: 1.0,
                },
                false,
            ),
            (
                LoadKind::Force {
                    body: 0,
                    point: Vec3::zeros(),
                    direction: Vec3::x(),
                    axes: Axes::Ground,
                    magnitude: TimeFunction::constant(1.0),
                },
                false,
            ),
        ] {
            let mut loaded = model.clone();
            let name = "load".into();
            loaded.loads.push(Load { name, kind });
            let open = Ledger::open(&loaded, &by, &scale).is_some();
            assert_eq!(open, conserves, "{:?}", loaded.loads);
        }
    }
}
