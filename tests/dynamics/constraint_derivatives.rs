//! Every derivative of the constraints, of the equations of a step and of the initial conditions
//! against the complex step (h = 1e-30), for every kind of joint, between two bodies and between a
//! body and ground, each at two random states.
//!
//! The joints are open and their frames skew, so that no term is hidden. A list of derivatives
//! agrees to 1e-12 of its largest entry. `rows_agree` (tests/reference/cases.rs) compares G, rates
//! and biases.

use crate::reference;

use flexbody_mathematics::linalg::{Pattern, SparseMatrix};
use flexbody_mathematics::math::{Complex64, Mat3, Parameters, rotation};
use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::model::Model;
use flexbody_mechanics::system::InMotion;
use flexbody_mechanics::system::bodies::{self, BodyMotion, rates, velocity_of_rates};
use flexbody_mechanics::system::initial;
use flexbody_mechanics::system::joints::{self, JointCotangent, RowCotangents, rates_by_position};
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_mechanics::system::reaction::ReactionJacobian;
use flexbody_mechanics::system::side::sides;
use nalgebra::DMatrix;
use reference::cases::{Case, TIME, cases, dot, lift, parameters, rows_agree, slopes, step, unit};

#[test]
fn gradients_rates_and_biases() {
    for mut case in cases() {
        let all: Vec<usize> = (0..case.v.len()).collect();
        rows_agree(&mut case, &all);
    }
}

/// The blocks of a reaction Jacobian as a matrix over (r_A, θ_A, r_B, θ_B).
fn blocks(k: &ReactionJacobian<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(12, 12);
    let mut put = |row: usize, column: usize, block: Mat3<f64>| {
        all.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    };
    for (row, sign) in [(0, 1.0), (6, -1.0)] {
        put(row, 0, k.force_by_position * sign);
        put(row, 6, k.force_by_position * -sign);
        put(row, 3, k.force_by_a * sign);
        put(row, 9, k.force_by_b * sign);
    }
    for (row, by_position) in [(3, k.a_by_position), (9, k.b_by_position)] {
        put(row, 0, by_position);
        put(row, 6, -by_position);
    }
    put(3, 3, k.a_by_a);
    put(3, 9, k.a_by_b);
    put(9, 3, k.b_by_a);
    put(9, 9, k.b_by_b);
    all
}

#[test]
fn reaction_jacobians() {
    for mut case in cases() {
        let lambda = case.numbers.list(case.numbering.constraints());
        let model = case.lifted();
        let motions = case.motions(&case.q, &case.v);
        let given = blocks(&joints::reaction_jacobian(
            &case.model.joints[0],
            (&motions, TIME),
            &lambda,
        ));
        // Body A is the second body; the first is B, unless that is ground.
        let place = |i: usize| (i + 6) % 12;
        let moving: Vec<usize> = match case.model.joints[0].body_b {
            Some(_) => (0..12).collect(),
            None => (0..6).collect(),
        };
        let (mut found, mut exact) = (Vec::new(), Vec::new());
        for &j in &moving {
            let q = case.moved(&unit(12, place(j)));
            let column = slopes(&case.reactions(&model, &q, &lift(&lambda)));
            found.extend(moving.iter().map(|&i| given[(i, j)]));
            exact.extend(moving.iter().map(|&i| column[place(i)]));
        }
        case.assert("(Gᵀλ) by positions", &found, &exact);
    }
}

#[test]
fn rates_by_positions() {
    for case in cases() {
        let (model, v) = (case.lifted(), lift(&case.v));
        let (motions, ground) = (case.motions(&case.q, &case.v), BodyMotion::ground());
        let joint = &case.model.joints[0];
        let (a, b) = sides(joint, &motions, &ground, TIME);
        let mut i = 0;
        rates_by_position(joint, (&a, &b), |_, by_a, by_b| {
            let mut given = vec![0.0; 12];
            bodies::add6(&mut given[6..], &by_a.position, &by_a.theta);
            if joint.body_b.is_some() {
                bodies::add6(&mut given, &by_b.position, &by_b.theta);
            }
            let by = |j| {
                let q = case.moved(&unit(12, j));
                case.constraints(&model, &q, &v)[case.numbering.constraints() + i]
            };
            let exact: Vec<f64> = (0..12).map(by).collect();
            case.assert(&format!("rate of row {i} by positions"), &given, &exact);
            i += 1;
        });
        assert_eq!(i, joint.rows().count());
    }
}

#[test]
fn pull_backs_of_constraints() {
    for mut case in cases() {
        let rows = case.numbering.constraints();
        let cot = case.numbers.list(3 * rows);
        let parts = [&cot[..rows], &cot[rows..2 * rows], &cot[2 * rows..]];
        let motions = case.motions(&case.q, &case.v);
        // Each of value, rate and bias alone, and all together.
        for wanted in [
            [true, false, false],
            [false, true, false],
            [false, false, true],
            [true; 3],
        ] {
            let picked = |k: usize| wanted[k].then_some(parts[k]);
            let cotangents = RowCotangents {
                value: picked(0),
                rate: picked(1),
                acceleration: picked(2),
                virtual_rate: None,
            };
            let weights: Vec<f64> = (0..3 * rows)
                .map(|i| if wanted[i / rows] { cot[i] } else { 0.0 })
                .collect();
            let (mut y, mut v) = (vec![0.0; 12], vec![0.0; 12]);
            let mut by_model = case.model.map(&mut |_| 0.0);
            let mut out = JointCotangent {
                y: Some(&mut y),
                v: Some(&mut v),
                model: &mut by_model,
            };
            let at = InMotion::new(&case.model, &case.numbering, &motions, TIME);
            let by_time = joints::pull_back(&at, &cotangents, &mut out);
            let model = case.lifted();
            let (now, q) = (step((&TIME, &1.0)), lift(&case.q));
            let slopes = case.constraints_at(&model, &q, &lift(&case.v), now);
            let exact = [dot(&slopes, &weights)];
            case.assert(&format!("pull-back {wanted:?} to time"), &[by_time], &exact);
            let by_y = |j| {
                let q = case.moved(&unit(12, j));
                dot(&case.constraints(&model, &q, &lift(&case.v)), &weights)
            };
            let exact: Vec<f64> = (0..12).map(by_y).collect();
            case.assert(&format!("pull-back {wanted:?} to positions"), &y, &exact);
            let by_v = |j| {
                let v: Vec<_> = case.v.iter().zip(&unit(12, j)).map(step).collect();
                dot(&case.constraints(&model, &lift(&case.q), &v), &weights)
            };
            let exact: Vec<f64> = (0..12).map(by_v).collect();
            case.assert(&format!("pull-back {wanted:?} to velocities"), &v, &exact);
            let (q, v) = (lift(&case.q), lift(&case.v));
            let exact = case.by_parameters(|model| dot(&case.constraints(model, &q, &v), &weights));
            let given = parameters(&by_model);
            case.assert(&format!("pull-back {wanted:?} to frames"), &given, &exact);
        }
    }
}

/// The virtual rate of a motion is the rate at the virtual velocities.
#[test]
fn pull_backs_of_virtual_rates() {
    for mut case in cases() {
        let cot = case.numbers.list(case.numbering.constraints());
        let w = case.numbers.list(12);
        let pull = |motions: &[_], cotangents: RowCotangents| {
            let (mut y, mut by_model) = (vec![0.0; 12], case.model.map(&mut |_| 0.0));
            let mut out = JointCotangent {
                y: Some(&mut y),
                v: None,
                model: &mut by_model,
            };
            let at = InMotion::new(&case.model, &case.numbering, motions, TIME);
            joints::pull_back(&at, &cotangents, &mut out);
            y.extend(parameters(&by_model));
            y
        };
        let mut motions = case.motions(&case.q, &case.v);
        for (body, motion) in motions.iter_mut().enumerate() {
            *motion = motion.virtually(&w[case.numbering.velocity(body)..]);
        }
        let virtually = RowCotangents {
            virtual_rate: Some(&cot),
            ..Default::default()
        };
        let given = pull(&motions, virtually);
        let moving = case.motions(&case.q, &w);
        if !case.model.joints[0].drives.is_empty() {
            // Its rate has a part that does not depend on velocities.
            continue;
        }
        let rate = RowCotangents {
            rate: Some(&cot),
            ..Default::default()
        };
        let exact = pull(&moving, rate);
        case.assert("pull-back of virtual rates", &given, &exact);
    }
}

/// Unknowns and rates of a step, complex.
struct Unknowns {
    q: Vec<Complex64>,
    v: Vec<Complex64>,
    lambda: Vec<Complex64>,
    mu: Vec<Complex64>,
    qdot: Vec<Complex64>,
    vdot: Vec<Complex64>,
}

/// Slopes of the residual of a step of size h.
fn residual(
    case: &Case,
    model: &Model<Complex64>,
    x: &Unknowns,
    h: f64,
    time: Complex64,
) -> Vec<f64> {
    let mut equations = Equations::new(model, &case.numbering);
    let mut out = vec![Complex64::from(0.0); equations.order()];
    let at = StepState {
        q: &x.q,
        v: &x.v,
        lambda: &x.lambda,
        mu: &x.mu,
        qdot: &x.qdot,
        vdot: &x.vdot,
        time,
    };
    equations.residual(&at, h.into(), &mut out);
    slopes(&out)
}

/// The scaled iteration matrix: columns y, v / h, λ / h², μ / h, where q̇ and v̇ change by c times
/// the changes of q and v.
#[test]
fn iteration_matrix_of_the_stabilised_equations() {
    let (h, c) = (0.03, 40.0);
    for mut case in cases() {
        let rows = case.numbering.constraints();
        let (lambda, mu) = (case.numbers.list(rows), case.numbers.list(rows));
        let (qdot, vdot) = (case.numbers.list(14), case.numbers.list(12));
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
        let pattern: Pattern = equations.pattern(&at);
        let mut matrix = SparseMatrix::new(pattern);
        matrix.assemble(|emit| equations.jacobian(&at, h, c, emit));
        let (model, n) = (case.lifted(), equations.order());
        for column in 0..n {
            let e = unit(n, column);
            let moved = |x: &[f64], from: usize, scale: f64| -> Vec<Complex64> {
                let part = e[from..].iter().map(|e| e * scale);
                x.iter().zip(part).map(|(x, e)| step((x, &e))).collect()
            };
            let mut dq = vec![0.0; 14];
            rates(&case.numbering, &case.q, &e[..12], &mut dq);
            let x = Unknowns {
                q: case.moved(&e[..12]),
                v: moved(&case.v, 12, 1.0 / h),
                lambda: moved(&lambda, 24, equations.mass() / (h * h)),
                mu: moved(&mu, 24 + rows, 1.0 / h),
                qdot: qdot
                    .iter()
                    .zip(&dq)
                    .map(|(x, d)| step((x, &(c * d))))
                    .collect(),
                vdot: moved(&vdot, 12, c / h),
            };
            let exact = residual(&case, &model, &x, h, TIME.into());
            case.assert(&format!("column {column}"), &matrix.multiply(&e), &exact);
        }
    }
}

#[test]
fn pull_back_of_the_stabilised_equations() {
    for mut case in cases() {
        let rows = case.numbering.constraints();
        let (lambda, mu) = (case.numbers.list(rows), case.numbers.list(rows));
        let (qdot, vdot) = (case.numbers.list(14), case.numbers.list(12));
        let psi = case.numbers.list(24 + 2 * rows);
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
        let mut cot = case.model.map(&mut |_| 0.0);
        let by_time = equations.pull_back(&at, &psi, &mut cot);
        let x = Unknowns {
            q: lift(&case.q),
            v: lift(&case.v),
            lambda: lift(&lambda),
            mu: lift(&mu),
            qdot: lift(&qdot),
            vdot: lift(&vdot),
        };
        // The dynamics in the residual are divided by a mass.
        let mut weights = psi.clone();
        weights[12..24]
            .iter_mut()
            .for_each(|x| *x *= equations.mass());
        let now = step((&TIME, &1.0));
        let exact = dot(&residual(&case, &case.lifted(), &x, 1.0, now), &weights);
        case.assert("ψᵀF by time", &[by_time], &[exact]);
        let exact = case
            .by_parameters(|model| dot(&residual(&case, model, &x, 1.0, TIME.into()), &weights));
        case.assert("ψᵀF by parameters", &parameters(&cot), &exact);
    }
}

/// Assembly, projected velocities and initial accelerations by every parameter, from a guess that
/// leaves the joint open.
#[test]
fn pull_back_of_the_initial_conditions() {
    for mut case in cases() {
        // Close the joint, and open it a little.
        case.close_joint();
        case.model.bodies[1].position += case.numbers.vector() * 0.05;
        let turned = case.numbers.vector() * 0.1;
        let p = case.model.bodies[1].orientation;
        let change = rotation::retraction(&p, &turned);
        case.model.bodies[1].orientation = std::array::from_fn(|i| p[i] + change[i]);

        let numbering = &case.numbering;
        let mut saddle = SaddlePoint::new(&case.model, numbering);
        let state = initial::solve(&case.model, numbering, &mut saddle).expect("is consistent");
        let bars = [(); 3].map(|()| case.numbers.list(12));
        let mut cot = case.model.map(&mut |_| 0.0);
        let given = (&bars[0][..], &bars[1][..], &bars[2][..]);
        initial::pull_back(&case.model, numbering, &mut saddle, &state, given, &mut cot)
            .expect("is regular");
        let exact = case.by_parameters(|model| {
            let mut saddle = SaddlePoint::new(model, numbering);
            let state = initial::solve(model, numbering, &mut saddle).expect("is consistent");
            let q: Vec<f64> = state.q.iter().map(|q| q.re).collect();
            let mut y = vec![0.0; 12];
            velocity_of_rates(numbering, &q, &slopes(&state.q), &mut y);
            dot(&y, &bars[0]) + dot(&slopes(&state.v), &bars[1]) + dot(&slopes(&state.a), &bars[2])
        });
        case.assert("initial state by parameters", &parameters(&cot), &exact);
    }
}
