//! The joints of a planar scene, computed in the plane and in space: every kind of joint with all
//! its rows, between two bodies and between a body and ground, with skew frames in random planes.
//! Components in the plane agree to 1e-14 of the largest number.

use crate::reference;

use flexbody_mathematics::math::{Complex64, Parameters, Scalar, rotation};
use flexbody_mechanics::model::{Mobility, Model};
use flexbody_mechanics::system::InMotion;
use flexbody_mechanics::system::constraint::RowGradient;
use flexbody_mechanics::system::joints::{self, JointCotangent, RowCotangents};
use flexbody_mechanics::system::planar::PlanarJoints;
use flexbody_mechanics::system::{BodyMotion, Numbering, reduce};
use reference::cases::{Case, case, lift, parameters, step};
use reference::models::{KINDS, axes_along};

/// All kinds of joint, moving in a random plane, with accelerations and virtual velocities.
fn cases() -> Vec<(Case, Vec<f64>, Vec<f64>)> {
    let mut all = Vec::new();
    for kind in KINDS {
        for body_b in [Some(0), None] {
            for seed in [5, 6, 7] {
                let mut case = case(kind, body_b, seed);
                let [t1, t2, normal] = axes_along(&case.numbers.vector());
                case.model.joints[0].frame_a.length = 0.7;
                for body in &mut case.model.bodies {
                    let r = rotation::matrix(&body.orientation);
                    body.mobility = Mobility::planar([t1, t2], r.tr_mul(&normal));
                }
                case.numbering = Numbering::new(&case.model);
                let mut planar = || {
                    let mut x = case.numbers.list(12);
                    reduce::project(&case.numbering, &mut x);
                    x
                };
                let (v, a, w) = (planar(), planar(), planar());
                case.v = v;
                all.push((case, a, w));
            }
        }
    }
    all
}

/// Motions with accelerations and virtual velocities.
fn moving<S: Scalar>(case: &Case, q: &[S], v: &[S], a: &[S], w: &[S]) -> Vec<BodyMotion<S>> {
    let mut motions = case.motions(q, v);
    for (i, motion) in motions.iter_mut().enumerate() {
        let o = case.numbering.velocity(i);
        *motion = motion.accelerated(&a[o..]).virtually(&w[o..]);
    }
    motions
}

/// The matrix of the equations in the plane: G B of all rows, column by column.
fn in_plane<S: Scalar>(case: &Case, model: &Model<S>, gradients: &[RowGradient<S>]) -> Vec<S> {
    let numbering = &case.numbering;
    let mut all = Vec::new();
    for unknown in 0..numbering.unknowns() {
        let mut x = vec![S::zero(); numbering.velocities()];
        x[unknown] = S::one();
        reduce::expand(numbering, 1, &mut x);
        let mut column = vec![S::zero(); numbering.constraints()];
        joints::rates_from_gradients(model, numbering, gradients, &x, &mut column);
        all.extend(column);
    }
    all
}

/// Gradients and second derivatives of all rows, in space and in the plane.
fn both<S: Scalar>(
    case: &Case,
    model: &Model<S>,
    [q, v, a]: [&[S]; 3],
    planar: &mut PlanarJoints<S>,
) -> [Vec<S>; 2] {
    let numbering = &case.numbering;
    let at_rest = vec![S::zero(); v.len()];
    let motions = moving(case, q, v, a, &at_rest);
    let at = InMotion::new(model, numbering, &motions, S::zero());
    let (mut spatial, mut own) = (Vec::new(), Vec::new());
    joints::gradients(&at, &mut spatial);
    planar.set_state(&motions);
    planar.set_moving(numbering, Some(a), None);
    planar.gradients(&mut own);
    let mut second = vec![S::zero(); numbering.constraints()];
    let mut found = [spatial, own].map(|gradients| in_plane(case, model, &gradients));
    joints::accelerations(&at, &mut second);
    found[0].extend(&second);
    planar.accelerations(numbering, &mut second);
    found[1].extend(&second);
    found
}

fn assert_equal(case: &Case, what: &str, spatial: &[f64], planar: &[f64]) {
    assert_eq!(spatial.len(), planar.len());
    let largest = spatial.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (i, (a, b)) in spatial.iter().zip(planar).enumerate() {
        assert!(
            (a - b).abs() <= 1e-14 * largest,
            "{}: {what} {i}: {a} in space, {b} in the plane (largest {largest})",
            case.name
        );
    }
}

#[test]
fn gradients_and_accelerations_are_those_in_space() {
    for (case, a, _) in cases() {
        let mut planar = PlanarJoints::of(&case.model).expect("a planar model");
        let state = [&case.q[..], &case.v, &a];
        let [spatial, own] = both(&case, &case.model, state, &mut planar);
        assert_equal(&case, "rows", &spatial, &own);
    }
}

/// The infinitesimal parts agree for any motion in the plane and any change of the model.
#[test]
fn infinitesimal_parts_are_those_in_space() {
    for (mut case, a, _) in cases() {
        let mut dy = case.numbers.list(12);
        reduce::project(&case.numbering, &mut dy);
        let mut faster = case.numbers.list(12);
        reduce::project(&case.numbering, &mut faster);
        let numbers = &mut case.numbers;
        let model = case.model.map(&mut |x| step((&x, &numbers.next())));
        let q = case.moved(&dy);
        let v: Vec<Complex64> = case.v.iter().zip(&faster).map(step).collect();
        let mut planar = PlanarJoints::of(&model).expect("a planar model");
        let state = [&q[..], &v, &lift(&a)];
        let parts = both(&case, &model, state, &mut planar);
        let [spatial, own] = parts.map(|x| reference::cases::slopes(&x));
        assert_equal(&case, "slopes of the rows", &spatial, &own);
    }
}

#[test]
fn pull_backs_are_those_in_space() {
    for (mut case, a, w) in cases() {
        let (model, numbering) = (&case.model, &case.numbering);
        let rows = numbering.constraints();
        let cot: [Vec<f64>; 3] = std::array::from_fn(|_| case.numbers.list(rows));
        let motions = moving(&case, &case.q, &case.v, &a, &w);
        let mut planar = PlanarJoints::of(model).expect("a planar model");
        planar.set_state(&motions);
        planar.set_velocities(numbering, &case.v);
        planar.set_moving(numbering, Some(&a), Some(&w));
        for kept in 0..4 {
            // Each cotangent alone, and all together.
            let given = |i: usize| (kept == 3 || kept == i).then_some(&cot[i][..]);
            let found = [true, false].map(|in_space| {
                let (mut y, mut v) = (vec![0.0; 12], vec![0.0; 12]);
                let mut by = model.map(&mut |_| 0.0);
                let mut out = JointCotangent {
                    y: Some(&mut y),
                    v: Some(&mut v),
                    model: &mut by,
                };
                let given = RowCotangents {
                    value: None,
                    rate: given(0),
                    acceleration: given(1),
                    virtual_rate: given(2),
                };
                match in_space {
                    true => {
                        let at = InMotion::new(model, numbering, &motions, 0.0);
                        joints::pull_back(&at, &given, &mut out);
                    }
                    false => planar.pull_back(numbering, &given, &mut out),
                }
                reduce::compress(numbering, 1, &mut y);
                reduce::compress(numbering, 1, &mut v);
                let nu = numbering.unknowns();
                [&y[..nu], &v[..nu], &parameters(&by)].concat()
            });
            assert_equal(&case, "cotangents", &found[0], &found[1]);
        }
    }
}

/// Bodies that leave the plane, and drives, are treated in space.
#[test]
fn spatial_scenes_are_told_apart() {
    for (mut case, _, _) in cases().into_iter().take(2) {
        case.model.bodies[1].mobility = Mobility::spatial();
        assert!(PlanarJoints::of(&case.model).is_none());
        let [[t1, t2, _], [normal, ..]] = case.model.bodies[0].mobility.plane().expect("planar");
        let tilted = Mobility::planar([t2, -t1], normal);
        case.model.bodies[1].mobility = tilted;
        assert!(PlanarJoints::of(&case.model).is_none());
    }
}
