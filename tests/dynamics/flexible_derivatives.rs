//! Inertial and elastic forces of flexible bodies against sums over points with masses, and every
//! derivative against the complex step, at random states of random bodies of 1 to 7 coordinates.

use crate::reference;

use flexbody_mathematics::linalg::SparseMatrix;
use flexbody_mathematics::math::{Complex64, Parameters, Scalar, Vec3};
use flexbody_mechanics::functions::instant::DeformationKind;
use flexbody_mechanics::functions::snapshot::{Snapshot, SnapshotCotangent};
use flexbody_mechanics::functions::{EnergyPart, Instant, RowCotangent, Rows};
use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::model::{Form, Inertia, Model};
use flexbody_mechanics::system::bodies::{
    BodyMotion, all_force_balances, rates, velocity_of_rates,
};
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::marker::{MarkerKinematics, RelativeMotion};
use flexbody_mechanics::system::{Numbering, flexible, initial, placement};
use reference::cases::{Case, TIME, dot, lift, parameters, rows_agree, slopes, step, unit};
use reference::flexible::{Points, modal, quadratic, stiffness, swing_of, totals};
use reference::models::Numbers;
use reference::shells::{four_node_swing, press, reduced_swing, shell_swing, stiffened_swing};

/// Swings of shapes and of shells at random states, their attachments a little open. Shells carry pressures and dead
/// loads.
fn cases() -> Vec<Case> {
    let shapes = [(1, 1), (2, 2), (3, 3), (4, 5), (5, 7)];
    let shapes = shapes.map(|(seed, modes)| (seed, swing_of(seed, modes, 40.0)));
    let shells = [(6, [1, 1]), (7, [2, 1])];
    let shells = shells.map(|(seed, elements)| (seed, shell_swing(seed, elements)));
    let reduced = [(8, [1, 1], 3), (9, [2, 1], 4)];
    let reduced =
        reduced.map(|(seed, elements, vectors)| (seed, reduced_swing(seed, elements, vectors)));
    let stiffened = [
        (10, [1, 1], None),
        (11, [2, 1], None),
        (12, [2, 1], Some(4)),
    ];
    let stiffened = stiffened.map(|(seed, elements, v)| (seed, stiffened_swing(seed, elements, v)));
    let four = [(15, [2, 1], None), (16, [2, 2], Some(4))];
    let four = four.map(|(seed, elements, v)| (seed, four_node_swing(seed, elements, v)));
    // The inertia that leaves out deformations, of shells with beams, masses and damping, and in a basis.
    let truncated = [(13, None), (14, Some(4))];
    let truncated = truncated.map(|(seed, vectors)| {
        let mut model = stiffened_swing(seed, [1, 1], vectors);
        model.flexible[0].inertia = Inertia::Paper;
        (seed, model)
    });
    let case = |(seed, mut model): (u64, Model<f64>)| {
        let modes = model.flexible[0].modes();
        if model.flexible[0].form.shells().is_some() {
            press(&mut model);
        }
        let mut numbers = Numbers(seed + 100);
        for i in 0..model.bodies.len() {
            let count = model.bodies[i].mobility.translation.free();
            for k in 0..count {
                model.bodies[i].position[k] += 0.2 * numbers.next();
                model.bodies[i].velocity[k] += numbers.next();
            }
            if model.bodies[i].mobility.has_rotation() {
                model.bodies[i].orientation = numbers.orientation();
                model.bodies[i].angular_velocity += numbers.vector();
            }
        }
        let (q, v) = placement::guess(&model);
        Case {
            name: format!("swing {seed} of {modes}"),
            numbering: Numbering::new(&model),
            model,
            q,
            v,
            numbers,
        }
    };
    shapes
        .into_iter()
        .chain(shells)
        .chain(reduced)
        .chain(stiffened)
        .chain(four)
        .chain(truncated)
        .map(case)
        .collect()
}

/// Velocity coordinates that the mobilities admit.
fn admitted(case: &Case) -> Vec<usize> {
    let numbering = &case.numbering;
    let own = |body: usize| {
        let (o, mobility) = (numbering.velocity(body), numbering.mobility(body));
        let turns = if mobility.has_rotation() { 3 } else { 0 };
        (0..mobility.translation.free())
            .chain(3..3 + turns)
            .map(move |k| o + k)
    };
    (0..numbering.bodies()).flat_map(own).collect()
}

/// M v̇ − f(q, v).
fn balance<S: Scalar>(case: &Case, model: &Model<S>, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
    let motions = case.motions(q, v);
    let mut out = vec![S::zero(); v.len()];
    all_force_balances(model, &case.numbering, &motions, a, &mut out);
    flexible::add_force_balances(model, &case.numbering, &motions, a, &mut out);
    out
}

/// The virtual power of the forces is the sum over the points of m (ẍ − g) · δx, their accelerations
/// and virtual velocities by the kinematics of markers.
#[test]
fn inertial_forces_are_those_of_the_points() {
    for modes in [1, 2, 3, 5] {
        let mut numbers = Numbers(40 + modes as u64);
        let points = Points::any(&mut numbers, 10, modes);
        let mut frame = numbers.body("body");
        (frame.mass, frame.inertia) = points.rigid();
        let mut model = Model {
            gravity: numbers.vector() * 9.0,
            bodies: vec![frame],
            joints: Vec::new(),
            loads: Vec::new(),
            flexible: Vec::new(),
        };
        let (q, rate) = (numbers.list(modes), numbers.list(modes));
        let mut stiff = stiffness(&mut numbers, modes, 0.0);
        stiff.strains.clear();
        model.add_flexible(
            0,
            (&q, &rate),
            modal(points.inertia(), stiff, vec![0.0; modes * modes]),
        );
        let numbering = Numbering::new(&model);
        let (q, v) = placement::guess(&model);
        let (a, w) = (numbers.list(v.len()), numbers.list(v.len()));
        let mut motions = Vec::new();
        BodyMotion::all(&numbering, &q, &v, &mut motions);
        let mut forces = vec![0.0; v.len()];
        all_force_balances(&model, &numbering, &motions, &a, &mut forces);
        flexible::add_force_balances(&model, &numbering, &motions, &a, &mut forces);
        let places: Vec<usize> = (0..6)
            .chain(
                model.flexible[0]
                    .places()
                    .map(|(b, k)| numbering.velocity(b) + k),
            )
            .collect();
        let power: f64 = places.iter().map(|&i| forces[i] * w[i]).sum();
        let elastic = |of: &[f64], offset: &dyn Fn(usize) -> usize| -> Vec<f64> {
            let all = model.flexible[0].places();
            all.map(|(b, k)| of[offset(b) + k]).collect()
        };
        let by_v = |b: usize| numbering.velocity(b);
        let (x, xdot) = (elastic(&q, &|b| numbering.position(b)), elastic(&v, &by_v));
        let (xddot, xw) = (elastic(&a, &by_v), elastic(&w, &by_v));
        let motion = motions[0].accelerated(&a).virtually(&w);
        let mut exact = 0.0;
        for (k, m) in points.masses.iter().enumerate() {
            let sum = |x: &[f64]| {
                let terms = points.shapes.iter().zip(x);
                terms.fold(Vec3::zeros(), |sum, (shape, x)| sum + shape[k] * *x)
            };
            let local = RelativeMotion {
                rate: sum(&xdot),
                acceleration: sum(&xddot),
                virtual_rate: sum(&xw),
            };
            let place = points.places[k] + sum(&x);
            let at = MarkerKinematics::moving_point(&motion, &place, Some(&local));
            exact += m * (at.acceleration - model.gravity).dot(&at.virtual_rate);
        }
        assert!(
            (power - exact).abs() <= 1e-13 * exact.abs().max(10.0),
            "{power} {exact}"
        );
        // Energy and momenta likewise.
        let (kinetic, _, momentum, angular) = totals(&model, &motions);
        let (mut energy, mut linear, mut turning) = (0.0, Vec3::zeros(), Vec3::zeros());
        for (k, m) in points.masses.iter().enumerate() {
            let sum = |x: &[f64]| {
                let terms = points.shapes.iter().zip(x);
                terms.fold(Vec3::zeros(), |sum, (shape, x)| sum + shape[k] * *x)
            };
            let local = RelativeMotion {
                rate: sum(&xdot),
                acceleration: Vec3::zeros(),
                virtual_rate: Vec3::zeros(),
            };
            let place = points.places[k] + sum(&x);
            let at = MarkerKinematics::moving_point(&motion, &place, Some(&local));
            energy += 0.5 * m * at.rate.norm_squared();
            linear += at.rate * *m;
            turning += at.x.cross(&at.rate) * *m;
        }
        assert!((kinetic - energy).abs() <= 1e-13 * energy.max(1.0));
        assert!((momentum - linear).norm() <= 1e-13 * linear.norm().max(10.0));
        assert!((angular - turning).norm() <= 1e-13 * turning.norm().max(10.0));
    }
}

/// Rows of attachments: gradients, rates, biases and their pull-backs.
#[test]
fn rows_of_attachments() {
    for mut case in cases() {
        let admitted = admitted(&case);
        rows_agree(&mut case, &admitted);
    }
}

/// ψᵀ(M v̇ − f) by positions, velocities and parameters; ψᵀ M x by positions and parameters.
#[test]
fn pull_backs_of_the_forces() {
    for mut case in cases() {
        let nv = case.v.len();
        let (a, psi) = (case.numbers.list(nv), case.numbers.list(nv));
        let places = admitted(&case);
        let motions = case.motions(&case.q, &case.v);
        let (mut y, mut v) = (vec![0.0; nv], vec![0.0; nv]);
        let mut cot = case.model.map(&mut |_| 0.0);
        let of = (&case.model, &case.numbering);
        let mut state = flexible::StateCotangent {
            y: Some(&mut y),
            v: Some(&mut v),
        };
        flexible::pull_force_balances(of, (&motions, &a), &psi, &mut state, &mut cot);
        let forces = |model: &Model<Complex64>, q: &[Complex64], v: &[Complex64]| {
            let motions = case.motions(q, v);
            let mut out = vec![Complex64::from(0.0); nv];
            let a = lift(&a);
            flexible::add_force_balances(model, &case.numbering, &motions, &a, &mut out);
            dot(&slopes(&out), &psi)
        };
        let model = case.lifted();
        let pick = |x: &[f64]| -> Vec<f64> { places.iter().map(|&i| x[i]).collect() };
        let by_y = |&j: &usize| forces(&model, &case.moved(&unit(nv, j)), &lift(&case.v));
        let exact: Vec<f64> = places.iter().map(by_y).collect();
        case.assert("forces by positions", &pick(&y), &exact);
        let by_v = |&j: &usize| {
            let v: Vec<_> = case.v.iter().zip(&unit(nv, j)).map(step).collect();
            forces(&model, &lift(&case.q), &v)
        };
        let exact: Vec<f64> = places.iter().map(by_v).collect();
        case.assert("forces by velocities", &pick(&v), &exact);
        let (q, v) = (lift(&case.q), lift(&case.v));
        let exact = case.by_parameters(|model| forces(model, &q, &v));
        case.assert("forces by parameters", &parameters(&cot), &exact);

        let (mut y, mut cot) = (vec![0.0; nv], case.model.map(&mut |_| 0.0));
        flexible::pull_mass_product(of, &motions, (&psi, &a), &mut y, &mut cot);
        let product = |model: &Model<Complex64>, q: &[Complex64]| {
            let mut out = vec![Complex64::from(0.0); nv];
            flexible::add_mass_product_at(model, &case.numbering, q, &lift(&a), &mut out);
            dot(&slopes(&out), &psi)
        };
        let by_y = |&j: &usize| product(&model, &case.moved(&unit(nv, j)));
        let exact: Vec<f64> = places.iter().map(by_y).collect();
        case.assert("M x by positions", &pick(&y), &exact);
        let exact = case.by_parameters(|model| product(model, &q));
        case.assert("M x by parameters", &parameters(&cot), &exact);
    }
}

/// The scaled iteration matrix of the stabilised equations, M(q) and ∂(M v̇)/∂q in it, and its parts.
#[test]
fn iteration_matrix() {
    let (h, c) = (0.03, 40.0);
    for mut case in cases() {
        let rows = case.numbering.constraints();
        let (nq, nv) = (case.q.len(), case.v.len());
        let (lambda, mu) = (case.numbers.list(rows), case.numbers.list(rows));
        let (qdot, vdot) = (case.numbers.list(nq), case.numbers.list(nv));
        let mut equations = Equations::new(&case.model, &case.numbering);
        let at = StepState {
            q: &case.q,
            v: &case.v,
            lambda: &lambda,
            mu: &mu,
            qdot: &qdot,
            vdot: &vdot,
            time: TIME,
        };
        let mut matrix = SparseMatrix::new(equations.pattern(&at));
        matrix.assemble(|emit| equations.jacobian(&at, h, c, emit));
        let (model, order, length) = (case.lifted(), equations.order(), equations.length());
        for column in 0..order {
            let reduced = unit(order, column);
            let mut e = reduced.clone();
            e.resize(length, 0.0);
            equations.expand(&mut e);
            let moved = |x: &[f64], from: usize, scale: f64| -> Vec<Complex64> {
                let part = e[from..].iter().map(|e| e * scale);
                x.iter().zip(part).map(|(x, e)| step((x, &e))).collect()
            };
            let mut dq = vec![0.0; nq];
            rates(&case.numbering, &case.q, &e[..nv], &mut dq);
            let by_q = qdot.iter().zip(&dq).map(|(x, d)| step((x, &(c * d))));
            let (q, v) = (case.moved(&e[..nv]), moved(&case.v, nv, 1.0 / h));
            let lambda = moved(&lambda, 2 * nv, equations.mass() / (h * h));
            let mu = moved(&mu, 2 * nv + rows, 1.0 / h);
            let (qdot, vdot) = (by_q.collect::<Vec<_>>(), moved(&vdot, nv, c / h));
            let at = StepState {
                q: &q,
                v: &v,
                lambda: &lambda,
                mu: &mu,
                qdot: &qdot,
                vdot: &vdot,
                time: TIME.into(),
            };
            let mut lifted = Equations::new(&model, &case.numbering);
            let mut out = vec![Complex64::from(0.0); length];
            lifted.residual(&at, h.into(), &mut out);
            let mut exact = slopes(&out);
            equations.compress(&mut exact);
            let given = matrix.multiply(&reduced);
            case.assert(&format!("column {column}"), &given, &exact[..order]);
        }
    }
}

/// Assembly, projected velocities and initial accelerations by every parameter, with attachments that
/// are open at the placement.
#[test]
fn pull_back_of_the_initial_conditions() {
    for (seed, modes) in [(11, 2), (12, 4)] {
        let mut model = swing_of(seed, modes, 40.0);
        let mut numbers = Numbers(seed);
        model.bodies[1].position += numbers.vector() * 0.05;
        let tip = model.bodies.len() - 2;
        model.bodies[tip].position += numbers.vector() * 0.03;
        let (q, v) = placement::guess(&model);
        let case = Case {
            name: format!("start of {modes}"),
            numbering: Numbering::new(&model),
            model,
            q,
            v,
            numbers,
        };
        let numbering = &case.numbering;
        let nv = case.v.len();
        let places = admitted(&case);
        let mut saddle = SaddlePoint::new(&case.model, numbering);
        let state = initial::solve(&case.model, numbering, &mut saddle).expect("is consistent");
        let mut numbers = Numbers(7);
        let bars = [(); 3].map(|()| {
            let mut bar = vec![0.0; nv];
            places.iter().for_each(|&i| bar[i] = numbers.next());
            bar
        });
        let mut cot = case.model.map(&mut |_| 0.0);
        let given = (&bars[0][..], &bars[1][..], &bars[2][..]);
        initial::pull_back(&case.model, numbering, &mut saddle, &state, given, &mut cot)
            .expect("is regular");
        let exact = case.by_parameters(|model| {
            let mut saddle = SaddlePoint::new(model, numbering);
            let state = initial::solve(model, numbering, &mut saddle).expect("is consistent");
            let q: Vec<f64> = state.q.iter().map(|q| q.re).collect();
            let mut y = vec![0.0; nv];
            velocity_of_rates(numbering, &q, &slopes(&state.q), &mut y);
            dot(&y, &bars[0]) + dot(&slopes(&state.v), &bars[1]) + dot(&slopes(&state.a), &bars[2])
        });
        case.assert("initial state by parameters", &parameters(&cot), &exact);
    }
}

/// Energies, strain energy and forms in the coordinates, by state and parameters.
#[test]
fn pull_backs_of_quantities() {
    for mut case in cases() {
        let modes = case.model.flexible[0].modes();
        let instants = [
            Instant::Energy(EnergyPart::Kinetic),
            Instant::Energy(EnergyPart::Potential),
            Instant::Energy(EnergyPart::Total),
            Instant::StrainEnergy(0),
            Instant::AngularVelocity {
                body: 0,
                direction: Vec3::new(0.4, -0.7, 0.9),
            },
            Instant::Momentum {
                direction: Vec3::new(-0.4, 0.7, 0.3),
            },
            Instant::Deformation {
                flexible: 0,
                kind: DeformationKind::Stress,
                unknowns: None,
                form: quadratic(&mut case.numbers, modes),
            },
        ];
        let stress = Instant::ShellStress {
            flexible: 0,
            elements: vec![0],
            rho: 2.0,
        };
        let shells = match &case.model.flexible[0].form {
            Form::Modal(modal) => modal.shells.is_some(),
            Form::Finite(_) => true,
        };
        let instants = instants.into_iter().chain(shells.then_some(stress));
        let nv = case.v.len();
        let places = admitted(&case);
        let still = vec![0.0; nv];
        for instant in &instants.collect::<Vec<_>>() {
            let (mut y, mut v, mut a) = (still.clone(), still.clone(), still.clone());
            let mut cot = case.model.map(&mut |_| 0.0);
            let mut own = instant.map(&mut |_| 0.0);
            let at = Snapshot {
                model: &case.model,
                numbering: &case.numbering,
                q: &case.q,
                v: &case.v,
                a: &still,
                reactions: Rows::none(),
                time: 0.0,
            };
            let mut out = SnapshotCotangent {
                y: &mut y,
                v: &mut v,
                a: &mut a,
                reactions: &mut RowCotangent::default(),
                time: &mut 0.0,
                model: &mut cot,
                modes: &mut Vec::new(),
            };
            instant.pull_back(&at, 0.0, 1.0, &mut out, &mut own);
            let zero = lift(&still);
            let value = |model: &Model<Complex64>,
                         instant: &Instant<Complex64>,
                         q: &[Complex64],
                         v: &[Complex64]| {
                let at = Snapshot {
                    model,
                    numbering: &case.numbering,
                    q,
                    v,
                    a: &zero,
                    reactions: Rows::none(),
                    time: Complex64::from(0.0),
                };
                slopes(&[instant.value(&at, 0.0)])[0]
            };
            let (model, lifted) = (case.lifted(), instant.map(&mut Complex64::from));
            let (q, w) = (lift(&case.q), lift(&case.v));
            let what = instant.describe();
            let pick = |x: &[f64]| -> Vec<f64> { places.iter().map(|&i| x[i]).collect() };
            let by_y = |&j: &usize| value(&model, &lifted, &case.moved(&unit(nv, j)), &w);
            let exact: Vec<f64> = places.iter().map(by_y).collect();
            case.assert(&format!("{what} by positions"), &pick(&y), &exact);
            let by_v = |&j: &usize| {
                let w: Vec<_> = case.v.iter().zip(&unit(nv, j)).map(step).collect();
                value(&model, &lifted, &q, &w)
            };
            let exact: Vec<f64> = places.iter().map(by_v).collect();
            case.assert(&format!("{what} by velocities"), &pick(&v), &exact);
            let exact = case.by_parameters(|model| value(model, &lifted, &q, &w));
            case.assert(&format!("{what} by parameters"), &parameters(&cot), &exact);
            let mut given = Vec::new();
            own.map(&mut |x| {
                given.push(x);
                x
            });
            let exact: Vec<f64> = (0..given.len())
                .map(|wanted| {
                    let mut i = 0;
                    let moved = instant.map(&mut |x| {
                        i += 1;
                        step((&x, &if i == wanted + 1 { 1.0 } else { 0.0 }))
                    });
                    value(&model, &moved, &q, &w)
                })
                .collect();
            case.assert(&format!("{what} by its own"), &given, &exact);
        }
        let (q, v) = (lift(&case.q), lift(&case.v));
        let a = lift(&case.numbers.list(nv));
        // The balance is finite and real where all is real.
        let found = balance(&case, &case.lifted(), &q, &v, &a);
        assert!(found.iter().all(|x| x.is_finite() && x.im == 0.0));
    }
}
