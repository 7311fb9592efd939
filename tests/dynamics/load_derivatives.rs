//! Every derivative of every kind of load against the complex step (h = 1e-30): Jacobians in
//! positions and velocities, pull-backs in state, time and parameters, between two bodies and
//! between a body and ground, at two random states.
//!
//! The joints are open and their frames skew, so that no term is hidden. A list of derivatives
//! agrees to 1e-12 of its largest entry or of 0.01, as some vanish among forces of order one.

use crate::reference;

use flexbody_mathematics::linalg::{Emit, SparseMatrix};
use flexbody_mathematics::math::scalar::COMPLEX_STEP;
use flexbody_mathematics::math::{Complex64, Parameters, Scalar};
use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::model::Interpolation;
use flexbody_mechanics::model::controller::{
    Controller, Coordinate, Feedback, Limits, Regime, Weight,
};
use flexbody_mechanics::model::load::{BearingFriction, Plate};
use flexbody_mechanics::model::{
    Axes, Cable, CablePoint, Contact, DegreeOfFreedom, ForceTable, Friction, HeightField,
    JointKind, Load, LoadKind, Model, NormalLaw, Shape, Smoothness, Stribeck, Surface,
    TimeFunction,
};
use flexbody_mechanics::system::InMotion;
use flexbody_mechanics::system::initial;
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::loads::{self, LoadCotangent, LoadEntries};
use flexbody_mechanics::system::{Numbering, bodies};
use nalgebra::DMatrix;
use reference::cases::{Case, case, dot, lift, parameters, slopes, step, unit};
use reference::models::Numbers;
use std::sync::Arc;

/// An instant within the second interval of the tables.
const TIME: f64 = 0.37;

fn table() -> TimeFunction<f64> {
    TimeFunction::Table {
        smoothness: Smoothness::Magnitude,
        times: vec![0.0, 0.2, 0.5, 0.9],
        values: vec![1.0, 2.0, 4.0, 4.5],
        interpolation: Interpolation::Monotone,
    }
}

fn harmonic() -> TimeFunction<f64> {
    TimeFunction::Harmonic {
        mean: 0.3,
        amplitude: 3.0,
        frequency: 0.8,
        phase: 0.3,
    }
}

/// Every kind of load with the joint that it needs; every option at least once.
fn kinds(body_b: Option<usize>, numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    use JointKind::{Prismatic, Revolute, Spherical};
    let mut all = Vec::new();
    for axes in [Axes::Ground, Axes::Body] {
        for magnitude in [TimeFunction::constant(2.0), harmonic(), table()] {
            let (point, direction) = (numbers.vector(), numbers.vector());
            let force = LoadKind::Force {
                body: 1,
                point,
                direction,
                axes,
                magnitude: magnitude.clone(),
            };
            let torque = LoadKind::Torque {
                body: 1,
                direction,
                axes,
                magnitude,
            };
            all.extend([(Spherical, force), (Spherical, torque)]);
        }
    }
    for damping in [0.0, 0.7] {
        let spring = LoadKind::Spring {
            body_a: 1,
            body_b,
            point_a: numbers.vector(),
            point_b: numbers.vector(),
            rest_length: 0.8,
            stiffness: 3.0,
            cubic: 1.7,
            damping,
            tables: [None, None],
        };
        // A rest angle on the far side, so that the difference is wrapped.
        let torsion = LoadKind::TorsionSpring {
            joint: 0,
            counter: None,
            rest_angle: 2.5,
            stiffness: 1.3,
            cubic: 0.7,
            damping,
            tables: [None, None],
        };
        all.extend([(Spherical, spring), (Revolute, torsion)]);
    }
    let table = |places: [f64; 4], interpolation: Interpolation| ForceTable {
        interpolation,
        places: places.to_vec(),
        forces: vec![-8.0, 0.0, 0.7, 5.0],
    };
    for interpolation in [
        Interpolation::Linear,
        Interpolation::Monotone,
        Interpolation::Spline,
    ] {
        // Within the table and beyond it.
        for wide in [0.4, 40.0] {
            let elastic = table([-1.0, 0.1, 0.3, 1.2].map(|x| x * wide), interpolation);
            let viscous = table([-2.0, 0.0, 0.4, 2.5].map(|x| x * wide), interpolation);
            let tables = [Some(elastic), Some(viscous.clone())];
            let spring = LoadKind::Spring {
                body_a: 1,
                body_b,
                point_a: numbers.vector(),
                point_b: numbers.vector(),
                rest_length: 0.8,
                stiffness: 0.0,
                cubic: 0.0,
                damping: 0.0,
                tables: tables.clone(),
            };
            let torsion = LoadKind::TorsionSpring {
                joint: 0,
                counter: None,
                rest_angle: 2.5,
                stiffness: 0.4,
                cubic: 0.0,
                damping: 0.2,
                tables,
            };
            let damping = LoadKind::Damping {
                joint: 0,
                dof: DegreeOfFreedom::Translation,
                coefficient: 0.3,
                table: Some(viscous),
            };
            all.extend([
                (Spherical, spring),
                (Revolute, torsion),
                (Prismatic, damping),
            ]);
        }
    }
    for (kind, dof) in [
        (Revolute, DegreeOfFreedom::Rotation),
        (Prismatic, DegreeOfFreedom::Translation),
    ] {
        let damping = LoadKind::Damping {
            joint: 0,
            dof,
            coefficient: 0.6,
            table: None,
        };
        let friction = LoadKind::Friction {
            joint: 0,
            dof,
            size: 1.4,
            width: 0.9,
        };
        all.extend([(kind, damping), (kind, friction)]);
    }
    let coefficient = 0.9;
    let ball = LoadKind::BallDamping {
        joint: 0,
        coefficient,
    };
    all.push((Spherical, ball));
    for width in [0.7, 3.0] {
        for coefficient in [0.0, 1.7] {
            let normal = numbers.vector().normalize();
            let drag = LoadKind::Drag {
                body: 1,
                point: numbers.vector(),
                coefficient: 0.8,
                width,
                plate: (coefficient > 0.0).then_some(Plate {
                    normal,
                    coefficient,
                }),
            };
            all.push((Spherical, drag));
        }
    }
    all.extend(bushings(numbers));
    all.extend(stops(body_b, numbers));
    all.extend(cables(body_b, numbers));
    all.extend(contacts(body_b, numbers));
    all.extend(controllers(body_b, numbers));
    all
}

/// Controllers without states, which have bodies of their own: with and without each limit, of a joint and a distance.
fn controllers(body_b: Option<usize>, numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    use JointKind::{Prismatic, Revolute, Spherical};
    let joint = |dof| Coordinate::Joint {
        joint: 0,
        dof,
        counter: None,
    };
    let mut all = Vec::new();
    for limited in [false, true] {
        for kind in [Revolute, Prismatic, Spherical] {
            let distance = Coordinate::Distance {
                body_a: 1,
                body_b,
                point_a: numbers.vector(),
                point_b: numbers.vector(),
            };
            let (coordinate, other) = match kind {
                Revolute => (joint(DegreeOfFreedom::Rotation), distance),
                Prismatic => (joint(DegreeOfFreedom::Translation), distance),
                _ => (distance.clone(), distance),
            };
            let weights = match kind {
                Spherical => Vec::new(),
                _ => vec![Weight {
                    body: 0,
                    point: numbers.vector(),
                    mass: 0.7,
                }],
            };
            let feedback = |coordinate, reference, proportional| Feedback {
                coordinate,
                reference,
                proportional,
                derivative: 0.4,
            };
            let own = Controller {
                regime: Regime::Running,
                feedback: vec![
                    feedback(coordinate, harmonic(), 0.9),
                    feedback(other, table(), 0.3),
                ],
                integral: None,
                feed_forward: harmonic(),
                weights,
                limits: Limits {
                    ratio: 1.4,
                    effort: limited.then_some(1.6),
                    line: limited.then_some([2.5, 3.0]),
                    power: limited.then_some(2.0),
                },
                lag: None,
            };
            all.push((kind, LoadKind::Controller(own)));
        }
    }
    all
}

/// Bushings with friction of their bearing or guide, and without.
fn bushings(numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    let mut matrix = |scale: f64| {
        let list = numbers.list(36);
        let symmetric = |k: usize| 0.5 * scale * (list[k] + list[6 * (k % 6) + k / 6]);
        (0..36).map(symmetric).collect::<Vec<f64>>()
    };
    let frictions = [
        None,
        Some((DegreeOfFreedom::Rotation, 0.2, 0.5)),
        Some((DegreeOfFreedom::Translation, 1.0, 3.0)),
    ];
    let one = |(own, of_second): (Option<(DegreeOfFreedom, f64, f64)>, bool)| {
        let friction = own.map(|(dof, radius, width)| BearingFriction {
            dof,
            coefficient: 0.3,
            radius,
            width,
            load_width: 0.4,
        });
        let kind = LoadKind::Bushing {
            joint: 0,
            of_second,
            stiffness: matrix(2.0),
            damping: matrix(0.3),
            friction,
        };
        (JointKind::Spherical, kind)
    };
    let both = |own| [(own, false), (own, true)];
    frictions.into_iter().flat_map(both).map(one).collect()
}

/// Contacts with every surface: deep and within the onset, sliding and nearly sticking, of spheres, points, wheels and capsules.
fn contacts(body_b: Option<usize>, numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    let half = numbers.vector();
    let mut all = Vec::new();
    let falling = |coefficient: f64, speed: f64| Some(Stribeck { coefficient, speed });
    for (exponent, width, friction, slip, stribeck) in [
        (1.0, 0.3, 0.4, 0.02, None),
        (1.5, 0.3, 0.7, 30.0, falling(1.1, 4.0)),
        (1.5, 40.0, 0.5, 0.5, falling(0.8, 1.5)),
        (1.0, 0.3, 0.0, 1.0, None),
    ] {
        for (radius, surface) in [
            (
                20.0,
                Surface::Plane {
                    normal: numbers.vector().normalize(),
                },
            ),
            (6.0, Surface::Sphere { radius: 4.0 }),
            (0.0, Surface::Sphere { radius: 11.0 }),
            (
                6.0,
                Surface::Capsule {
                    half: half * 30.0,
                    radius: 5.0,
                },
            ),
            (
                6.0,
                Surface::Capsule {
                    half: half * 1e-3,
                    radius: 5.0,
                },
            ),
            (6.0, boxed(numbers, [0.1, 0.1, 0.1], 5.0)),
            (6.0, boxed(numbers, [20.0, 0.1, 30.0], 5.0)),
            (3.0, boxed(numbers, [20.0, 30.0, 25.0], 2.0)),
            (0.0, boxed(numbers, [20.0, 30.0, 25.0], 0.0)),
            (20.0, hills(numbers)),
        ] {
            let contact = Contact {
                body_a: 1,
                body_b,
                point_a: numbers.vector(),
                radius,
                shape: Shape::Sphere,
                point_b: numbers.vector(),
                surface,
                law: NormalLaw {
                    exponent,
                    stiffness: 0.3,
                    dissipation: 0.1,
                    width,
                },
                friction: Friction {
                    coefficient: friction,
                    width: slip,
                    stribeck: stribeck.clone(),
                },
            };
            let mut with = |shape: Shape<f64>| {
                let own = Contact {
                    shape,
                    ..contact.clone()
                };
                all.push((JointKind::Spherical, LoadKind::Contact(own)));
            };
            match contact.surface {
                Surface::Plane { .. } => {
                    with(Shape::Wheel {
                        axis: numbers.vector().normalize(),
                        radius: 0.7,
                    });
                    with(Shape::Capsule {
                        half: numbers.vector() * 3.0,
                        spheres: 2,
                    });
                }
                Surface::Field { .. } => {
                    with(Shape::Wheel {
                        axis: numbers.vector().normalize(),
                        radius: 1.5,
                    });
                    with(Shape::Capsule {
                        half: numbers.vector() * 3.0,
                        spheres: 4,
                    });
                }
                // Nearest at an end, and between. One without radius has no sides.
                _ if contact.radius > 0.0 => {
                    for long in [0.01, 1.0] {
                        with(Shape::Capsule {
                            half: numbers.vector() * long,
                            spheres: 2,
                        });
                    }
                }
                _ => {}
            }
            all.push((JointKind::Spherical, LoadKind::Contact(contact)));
        }
    }
    all
}

/// Gentle heights, obliquely on their body.
fn hills(numbers: &mut Numbers) -> Surface<f64> {
    let first = numbers.vector().normalize();
    let second = first.cross(&numbers.vector()).normalize();
    let along: Vec<f64> = (-4..=4).map(|k| 10.0 * f64::from(k)).collect();
    let across = vec![-30.0, -5.0, 10.0, 40.0];
    let row = |v: &f64| {
        along
            .iter()
            .map(|u| 2.0 * (u / 20.0 + v / 30.0).sin())
            .collect()
    };
    let heights: Vec<Vec<f64>> = across.iter().map(row).collect();
    Surface::Field {
        axes: [first, second, first.cross(&second)],
        heights: Arc::new(HeightField::new(along, across, &heights)),
    }
}

/// A box with these half edges, obliquely on its body.
fn boxed(numbers: &mut Numbers, sizes: [f64; 3], radius: f64) -> Surface<f64> {
    let first = numbers.vector().normalize();
    let second = first.cross(&numbers.vector()).normalize();
    let third = first.cross(&second);
    Surface::Box {
        halves: [first * sizes[0], second * sizes[1], third * sizes[2]],
        radius,
    }
}

/// Cables over pulleys on both bodies and ground: taut, within their onset and slack; of constant and changing length.
fn cables(body_b: Option<usize>, numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    let mut all = Vec::new();
    for (length, width, dissipation) in [
        (TimeFunction::constant(1.0), 0.3, 0.02),
        (TimeFunction::constant(4.0), 300.0, 0.0),
        (harmonic(), 0.3, 0.02),
        (TimeFunction::constant(1e3), 0.3, 0.0),
    ] {
        // One without ground, whose forces balance.
        let over = if dissipation > 0.0 { Some(0) } else { None };
        let bodies = [body_b, Some(1), over, Some(1), Some(0)];
        let point = |body| CablePoint {
            body,
            point: numbers.vector() * 2.0,
        };
        let cable = Cable {
            points: bodies.map(point).to_vec(),
            length,
            law: NormalLaw {
                exponent: 1.0,
                stiffness: 0.4,
                dissipation,
                width,
            },
        };
        all.push((JointKind::Spherical, LoadKind::Cable(cable)));
    }
    all
}

/// Stops that are entered deeply, that press from both sides, and that are within their onset.
fn stops(body_b: Option<usize>, numbers: &mut Numbers) -> Vec<(JointKind, LoadKind<f64>)> {
    use JointKind::{Prismatic, Revolute, Spherical};
    let law = |exponent: f64, width: f64| NormalLaw {
        exponent,
        stiffness: 3.0,
        dissipation: 0.05,
        width,
    };
    let mut all = Vec::new();
    for (limits, law) in [
        ([Some(4.0), None], law(1.0, 0.3)),
        ([None, Some(-4.0)], law(1.5, 0.3)),
        ([Some(3.5), Some(-4.5)], law(2.0, 0.1)),
        ([Some(0.5), Some(0.6)], law(1.0, 12.0)),
    ] {
        for (kind, dof) in [
            (Revolute, DegreeOfFreedom::Rotation),
            (Prismatic, DegreeOfFreedom::Translation),
        ] {
            let stop = LoadKind::JointStop {
                joint: 0,
                dof,
                counter: None,
                limits,
                law: law.clone(),
            };
            all.push((kind, stop));
        }
        let distance = LoadKind::DistanceStop {
            body_a: 1,
            body_b,
            point_a: numbers.vector(),
            point_b: numbers.vector(),
            limits,
            law,
        };
        all.push((Spherical, distance));
    }
    all
}

fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for body_b in [Some(0), None] {
        for seed in [3, 4] {
            for (joint, kind) in kinds(body_b, &mut Numbers(seed + 10)) {
                let mut one = case(joint, body_b, seed);
                one.name = format!("{kind:?} {}", one.name);
                one.model.loads = vec![Load {
                    name: "load".into(),
                    kind,
                }];
                all.push(one);
            }
        }
    }
    all
}

/// Asserts the tolerance for a list of derivatives.
fn agree(case: &Case, what: &str, given: &[f64], exact: &[f64]) {
    assert_eq!(given.len(), exact.len());
    let largest = exact.iter().fold(0.01_f64, |m, x| m.max(x.abs()));
    for (i, (given, exact)) in given.iter().zip(exact).enumerate() {
        assert!(
            (given - exact).abs() <= 1e-12 * largest,
            "{}: {what} {i}: {given} against {exact} (largest {largest})",
            case.name
        );
    }
}

/// f at the state (q, v).
fn forces<S: Scalar>(case: &Case, model: &Model<S>, q: &[S], v: &[S], time: S) -> Vec<S> {
    let mut out = vec![S::zero(); v.len()];
    let motions = case.motions(q, v);
    let here = InMotion::new(model, &case.numbering, &motions, time);
    loads::add_forces(&here, &mut out);
    out
}

/// Collects emitted entries.
struct Dense(DMatrix<f64>, usize);

impl Emit<f64> for Dense {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.0[(row, column)] += value;
        self.1 += 1;
    }
}

#[test]
fn jacobians() {
    for case in cases() {
        let motions = case.motions(&case.q, &case.v);
        let mut given = Dense(DMatrix::zeros(13, 26), 0);
        let here = InMotion::new(&case.model, &case.numbering, &motions, TIME);
        let to = LoadEntries {
            row: 1,
            y: 2,
            v: 14,
            by_y: -2.0,
            by_v: 0.5,
        };
        loads::emit_jacobian(&here, &to, &mut given);
        let (model, time) = (case.lifted(), TIME.into());
        for j in 0..12 {
            let e = unit(12, j);
            let by_y = forces(&case, &model, &case.moved(&e), &lift(&case.v), time);
            let faster: Vec<_> = case.v.iter().zip(&e).map(step).collect();
            let by_v = forces(&case, &model, &lift(&case.q), &faster, time);
            for (column, by, scale) in [(2 + j, by_y, -2.0), (14 + j, by_v, 0.5)] {
                let exact: Vec<f64> = slopes(&by).iter().map(|x| x * scale).collect();
                let given: Vec<f64> = (1..13).map(|i| given.0[(i, column)]).collect();
                agree(&case, &format!("∂f by column {column}"), &given, &exact);
            }
        }
    }
}

#[test]
fn pull_backs() {
    for mut case in cases() {
        let psi = case.numbers.list(12);
        let (mut y, mut v, mut by_time) = (vec![0.0; 12], vec![0.0; 12], 0.0);
        let mut cot = case.model.map(&mut |_| 0.0);
        let mut out = LoadCotangent {
            y: Some(&mut y),
            v: Some(&mut v),
            time: &mut by_time,
            model: &mut cot,
        };
        let motions = case.motions(&case.q, &case.v);
        let here = InMotion::new(&case.model, &case.numbering, &motions, TIME);
        loads::pull_back(&here, &psi, &mut out);
        let (model, q0, v0) = (case.lifted(), lift(&case.q), lift(&case.v));
        let power = |model: &Model<Complex64>, q: &[Complex64], v: &[Complex64], time| {
            dot(&slopes(&forces(&case, model, q, v, time)), &psi)
        };
        let time = Complex64::from(TIME);
        let exact: Vec<f64> = (0..12)
            .map(|j| power(&model, &case.moved(&unit(12, j)), &v0, time))
            .collect();
        agree(&case, "ψᵀf by positions", &y, &exact);
        let exact: Vec<f64> = (0..12)
            .map(|j| {
                let v: Vec<_> = case.v.iter().zip(&unit(12, j)).map(step).collect();
                power(&model, &q0, &v, time)
            })
            .collect();
        agree(&case, "ψᵀf by velocities", &v, &exact);
        let later = Complex64::new(TIME, COMPLEX_STEP);
        let exact = power(&model, &q0, &v0, later);
        agree(&case, "ψᵀf by time", &[by_time], &[exact]);
        let exact = case.by_parameters(|model| power(model, &q0, &v0, time));
        agree(&case, "ψᵀf by parameters", &parameters(&cot), &exact);
    }
}

#[test]
fn potentials() {
    for case in cases() {
        let mut y = vec![0.0; 12];
        let mut cot = case.model.map(&mut |_| 0.0);
        let motions = case.motions(&case.q, &case.v);
        let (model, numbering) = (&case.model, &case.numbering);
        let mut by_time = 0.0;
        let mut out = LoadCotangent {
            y: Some(&mut y),
            v: None,
            time: &mut by_time,
            model: &mut cot,
        };
        let here = InMotion::new(model, numbering, &motions, TIME);
        loads::pull_potential(&here, 0.7, &mut out);
        let v = lift(&case.v);
        let energy_at = |model: &Model<Complex64>, q: &[Complex64], time: Complex64| {
            let energy = loads::potential(model, &case.motions(q, &v), time);
            0.7 * energy.im / COMPLEX_STEP
        };
        let energy = |model: &Model<Complex64>, q: &[Complex64]| energy_at(model, q, TIME.into());
        let lifted = case.lifted();
        let exact: Vec<f64> = (0..12)
            .map(|j| energy(&lifted, &case.moved(&unit(12, j))))
            .collect();
        agree(&case, "energy by positions", &y, &exact);
        let q = lift(&case.q);
        let exact = case.by_parameters(|model| energy(model, &q));
        agree(&case, "energy by parameters", &parameters(&cot), &exact);
        let later = energy_at(&lifted, &q, Complex64::new(TIME, COMPLEX_STEP));
        agree(&case, "energy by time", &[by_time], &[later]);
        if matches!(
            case.model.loads[0].kind,
            LoadKind::Spring { .. }
                | LoadKind::JointStop {
                    dof: DegreeOfFreedom::Translation,
                    ..
                }
                | LoadKind::DistanceStop { .. }
                | LoadKind::Contact(_)
        ) || matches!(&case.model.loads[0].kind, LoadKind::Cable(own) if own.is_fixed())
        {
            // At rest, the force of a spring, a stop, a contact or a cable is minus the derivative of its energy.
            let still = forces(&case, &case.model, &case.q, &[0.0; 12], TIME);
            let down: Vec<f64> = y.iter().map(|y| -y / 0.7).collect();
            agree(&case, "force from energy", &still, &down);
        }
    }
}

/// The loads within the equations of a step: matrix, parameters and time.
#[test]
fn equations_of_a_step() {
    let (h, c) = (0.03, 40.0);
    for mut case in cases() {
        let rows = case.numbering.constraints();
        let n = 24 + 2 * rows;
        let zeros = vec![0.0; 24];
        let at = StepState {
            q: &case.q,
            v: &case.v,
            lambda: &zeros[..rows],
            mu: &zeros[..rows],
            qdot: &zeros[..14],
            vdot: &zeros[..12],
            time: TIME,
        };
        let mut equations = Equations::new(&case.model, &case.numbering);
        let mut matrix = SparseMatrix::new(equations.pattern(&at));
        matrix.assemble(|emit| equations.jacobian(&at, h, c, emit));
        let still: Vec<Complex64> = lift(&zeros);
        let residual = |model: &Model<Complex64>, q: &[_], v: &[_], vdot: &[_], time, h: f64| {
            let mut equations = Equations::new(model, &case.numbering);
            let mut out = lift(&vec![0.0; n]);
            let at = StepState {
                q,
                v,
                lambda: &still[..rows],
                mu: &still[..rows],
                qdot: &still[..14],
                vdot,
                time,
            };
            equations.residual(&at, h.into(), &mut out);
            slopes(&out)
        };
        let (model, time) = (case.lifted(), Complex64::from(TIME));
        let (q0, v0) = (lift(&case.q), lift(&case.v));
        for j in 0..12 {
            // Columns of positions at q̇ = 0: the part c h of the rates is known.
            let e = unit(n, j);
            let mut exact = residual(&model, &case.moved(&e[..12]), &v0, &still[..12], time, h);
            exact[j] += c * h;
            let given = matrix.multiply(&e);
            agree(&case, "column of y", &given[12..], &exact[12..]);
            let scaled = |x: &[f64], s: f64| -> Vec<Complex64> {
                let e = unit(12, j);
                x.iter().zip(&e).map(|(x, e)| step((x, &(e * s)))).collect()
            };
            let v = scaled(&case.v, 1.0 / h);
            let vdot = scaled(&[0.0; 12], c / h);
            let exact = residual(&model, &q0, &v, &vdot, time, h);
            agree(
                &case,
                "column of v",
                &matrix.multiply(&unit(n, 12 + j)),
                &exact,
            );
        }
        let psi = case.numbers.list(n);
        let mut cot = case.model.map(&mut |_| 0.0);
        let by_time = equations.pull_back(&at, &psi, &mut cot);
        // The dynamics in the residual are divided by a mass.
        let mut weights = psi.clone();
        let dynamics = weights[12..24].iter_mut();
        dynamics.for_each(|x| *x *= equations.mass());
        let pulled = |model: &Model<Complex64>, time| {
            let slopes = residual(model, &q0, &v0, &still[..12], time, 1.0);
            dot(&slopes, &weights)
        };
        let exact = case.by_parameters(|model| pulled(model, time));
        agree(&case, "ψᵀF by parameters", &parameters(&cot), &exact);
        let exact = pulled(&model, Complex64::new(TIME, COMPLEX_STEP));
        agree(&case, "ψᵀF by time", &[by_time], &[exact]);
    }
}

/// The initial accelerations depend on the loads at t = 0 by state and parameters.
#[test]
fn initial_accelerations() {
    for mut case in cases() {
        case.close_joint();
        let numbering = &case.numbering;
        let mut saddle = SaddlePoint::new(&case.model, numbering);
        let state = initial::solve(&case.model, numbering, &mut saddle).expect("is consistent");
        let bar = case.numbers.list(12);
        let nothing = [0.0; 12];
        let mut cot = case.model.map(&mut |_| 0.0);
        let given = (&nothing[..], &nothing[..], &bar[..]);
        initial::pull_back(&case.model, numbering, &mut saddle, &state, given, &mut cot)
            .expect("is regular");
        let exact = case.by_parameters(|model| {
            let numbering = Numbering::new(model);
            let mut saddle = SaddlePoint::new(model, &numbering);
            let state = initial::solve(model, &numbering, &mut saddle).expect("is consistent");
            dot(&slopes(&state.a), &bar)
        });
        agree(
            &case,
            "accelerations by parameters",
            &parameters(&cot),
            &exact,
        );
    }
}

/// Loads between two bodies do not change the total momentum.
#[test]
fn forces_between_two_bodies_balance() {
    for case in cases() {
        if matches!(
            case.model.loads[0].kind,
            LoadKind::Force { .. } | LoadKind::Torque { .. } | LoadKind::Drag { .. }
        ) || matches!(&case.model.loads[0].kind, LoadKind::Cable(own) if own.points.iter().any(|own| own.body.is_none()))
            || case.model.joints[0].body_b.is_none()
        {
            continue;
        }
        let f = forces(&case, &case.model, &case.q, &case.v, TIME);
        let mut total = [0.0; 6];
        for (six, motion) in f.chunks(6).zip(case.motions(&case.q, &case.v)) {
            let (force, torque) = bodies::velocities_of(six);
            let moment = motion.position.cross(&force) + motion.rotation * torque;
            bodies::add6(&mut total, &force, &moment);
        }
        let largest = f.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(largest > 1e-3, "{}", case.name);
        for x in total {
            assert!(x.abs() <= 1e-13 * largest, "{}: {total:?}", case.name);
        }
    }
}
