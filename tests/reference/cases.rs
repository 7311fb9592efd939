//! Open joints in random states, and their derivatives by the complex step.

use super::models::{KINDS, Numbers, axes_along, joint};
use flexbody_mathematics::math::scalar::COMPLEX_STEP;
use flexbody_mathematics::math::{Complex64, Parameters, Scalar};
use flexbody_mechanics::model::Interpolation;
use flexbody_mechanics::model::{
    DegreeOfFreedom, Drive, JointKind, Model, Smoothness, TimeFunction,
};
use flexbody_mechanics::system::bodies::{BodyMotion, rates};
use flexbody_mechanics::system::{InMotion, Numbering, joints, placement};

/// A model in a state, and random numbers for cotangents.
pub struct Case {
    pub name: String,
    pub model: Model<f64>,
    pub numbering: Numbering,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub numbers: Numbers,
}

/// Time of the cases [s].
pub const TIME: f64 = 0.3;

/// Every kind of joint between two bodies and to ground, at two random states, without drives and
/// with all possible drives.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for kind in KINDS {
        for body_b in [Some(0), None] {
            for seed in [3, 4] {
                all.push(case(kind, body_b, seed));
                if !kind.degrees_of_freedom().is_empty() {
                    all.push(driven(case(kind, body_b, seed + 10)));
                }
            }
        }
    }
    all
}

pub fn case(kind: JointKind, body_b: Option<usize>, seed: u64) -> Case {
    let mut numbers = Numbers(seed);
    let bodies = vec![numbers.body("first"), numbers.body("second")];
    let (point, axis) = (numbers.vector(), numbers.vector());
    let mut joint = joint(&bodies, ("joint", kind), (1, body_b), &point, &axis);
    joint.frame_b.point += numbers.vector();
    joint.frame_b.axes = axes_along(&numbers.vector());
    let model = Model {
        gravity: numbers.vector() * 10.0,
        bodies,
        joints: vec![joint],
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let (q, v) = placement::guess(&model);
    Case {
        name: format!("{kind:?} {body_b:?} {seed}"),
        numbering: Numbering::new(&model),
        model,
        q,
        v,
        numbers,
    }
}

/// The case with drives along and about the joint's axis, by functions of time of all kinds.
fn driven(mut case: Case) -> Case {
    let joint = &mut case.model.joints[0];
    let course = |dof: DegreeOfFreedom| match (joint.kind, dof) {
        (JointKind::Planar, _) => TimeFunction::Table {
            smoothness: Smoothness::Motion,
            times: vec![0.0, 0.1, 0.25, 0.4, 0.6],
            values: vec![0.1, 0.2, -0.3, 0.4, 0.2],
            interpolation: Interpolation::Spline,
        },
        (_, DegreeOfFreedom::Translation) => TimeFunction::Harmonic {
            mean: 0.1,
            amplitude: 0.4,
            frequency: 0.7,
            phase: 0.2,
        },
        (_, DegreeOfFreedom::Rotation) => TimeFunction::Polynomial(vec![0.2, 1.3, -0.7, 0.4]),
    };
    let drive = |&dof: &DegreeOfFreedom| Drive {
        dof,
        course: course(dof),
    };
    let drives = joint.kind.degrees_of_freedom().iter().map(drive).collect();
    joint.drives = drives;
    case.name += " driven";
    case.numbering = Numbering::new(&case.model);
    case
}

impl Case {
    /// Closes the joint at a random place with a random axis.
    pub fn close_joint(&mut self) {
        let joint = &self.model.joints[0];
        let at = (joint.name.as_str(), joint.kind);
        let between = (joint.body_a, joint.body_b);
        let (point, axis) = (self.numbers.vector(), self.numbers.vector());
        let mut closed = super::models::joint(&self.model.bodies, at, between, &point, &axis);
        closed.drives.clone_from(&joint.drives);
        self.model.joints[0] = closed;
    }

    /// Asserts the tolerance for a list of derivatives.
    pub fn assert(&self, what: &str, given: &[f64], exact: &[f64]) {
        assert_eq!(given.len(), exact.len());
        let largest = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (i, (given, exact)) in given.iter().zip(exact).enumerate() {
            assert!(
                (given - exact).abs() <= 1e-12 * largest,
                "{}: {what} {i}: {given} against {exact} (largest {largest})",
                self.name
            );
        }
    }

    /// q + i h T(q) dy.
    pub fn moved(&self, dy: &[f64]) -> Vec<Complex64> {
        let mut dq = vec![0.0; self.q.len()];
        rates(&self.numbering, &self.q, dy, &mut dq);
        self.q.iter().zip(&dq).map(step).collect()
    }

    pub fn motions<S: Scalar>(&self, q: &[S], v: &[S]) -> Vec<BodyMotion<S>> {
        let mut motions = Vec::new();
        BodyMotion::all(&self.numbering, q, v, &mut motions);
        motions
    }

    /// Values, rates and biases of all rows, in this order.
    pub fn constraints(
        &self,
        model: &Model<Complex64>,
        q: &[Complex64],
        v: &[Complex64],
    ) -> Vec<f64> {
        self.constraints_at(model, q, v, TIME.into())
    }

    /// As [`Case::constraints`], at another time.
    pub fn constraints_at(
        &self,
        model: &Model<Complex64>,
        q: &[Complex64],
        v: &[Complex64],
        time: Complex64,
    ) -> Vec<f64> {
        let (numbering, motions) = (&self.numbering, self.motions(q, v));
        let at = InMotion::new(model, numbering, &motions, time);
        let rows = numbering.constraints();
        let mut all = vec![Complex64::from(0.0); 3 * rows];
        joints::values(&at, &mut all[..rows]);
        joints::rates(&at, &mut all[rows..2 * rows]);
        joints::accelerations(&at, &mut all[2 * rows..]);
        slopes(&all)
    }

    pub fn lifted(&self) -> Model<Complex64> {
        self.model.map(&mut Complex64::from)
    }

    /// G(q)ᵀ λ.
    pub fn reactions<S: Scalar>(&self, model: &Model<S>, q: &[S], lambda: &[S]) -> Vec<S> {
        let at_rest = vec![S::zero(); self.v.len()];
        let mut gradients = Vec::new();
        let motions = self.motions(q, &at_rest);
        let at = InMotion::new(model, &self.numbering, &motions, S::from(TIME));
        joints::gradients(&at, &mut gradients);
        let mut out = at_rest;
        joints::add_reactions(model, &self.numbering, &gradients, lambda, &mut out);
        out
    }

    /// The derivative of `f` in every parameter of the model, by the complex step.
    pub fn by_parameters(&self, f: impl Fn(&Model<Complex64>) -> f64) -> Vec<f64> {
        let count = parameters(&self.model).len();
        (0..count)
            .map(|wanted| {
                let mut i = 0;
                f(&self.model.map(&mut |x| {
                    i += 1;
                    step((&x, &if i == wanted + 1 { 1.0 } else { 0.0 }))
                }))
            })
            .collect()
    }
}

pub fn step((x, dx): (&f64, &f64)) -> Complex64 {
    Complex64::new(*x, COMPLEX_STEP * dx)
}

pub fn lift(x: &[f64]) -> Vec<Complex64> {
    x.iter().map(|&x| x.into()).collect()
}

pub fn slopes(x: &[Complex64]) -> Vec<f64> {
    x.iter().map(|x| x.im / COMPLEX_STEP).collect()
}

pub fn unit(n: usize, i: usize) -> Vec<f64> {
    let mut e = vec![0.0; n];
    e[i] = 1.0;
    e
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn parameters(model: &Model<f64>) -> Vec<f64> {
    let mut all = Vec::new();
    model.map(&mut |x| {
        all.push(x);
        x
    });
    all
}

/// Asserts that the gradients, rates, biases and reactions of all rows are those of the constraints,
/// for the velocities `admitted`.
pub fn rows_agree(case: &mut Case, admitted: &[usize]) {
    let (nv, rows) = (case.v.len(), case.numbering.constraints());
    let (model, v) = (case.lifted(), lift(&case.v));
    let mut gradients = Vec::new();
    let motions = case.motions(&case.q, &case.v);
    let at = InMotion::new(&case.model, &case.numbering, &motions, TIME);
    joints::gradients(&at, &mut gradients);
    // G by columns, from the values and from the rates.
    let (mut given, mut by_value, mut by_rate) = (Vec::new(), Vec::new(), Vec::new());
    for &j in admitted {
        let e = unit(nv, j);
        let mut column = vec![0.0; rows];
        joints::rates_from_gradients(&case.model, &case.numbering, &gradients, &e, &mut column);
        given.extend(column);
        by_value.extend(&case.constraints(&model, &case.moved(&e), &v)[..rows]);
        let faster: Vec<_> = case.v.iter().zip(&e).map(step).collect();
        by_rate.extend(&case.constraints(&model, &lift(&case.q), &faster)[rows..2 * rows]);
    }
    case.assert("G by Φ", &given, &by_value);
    case.assert("G by G v", &given, &by_rate);
    let lambda = case.numbers.list(rows);
    let columns = given.chunks(rows).map(|column| dot(column, &lambda));
    let product: Vec<f64> = columns.collect();
    let all = case.reactions(&case.model, &case.q, &lambda);
    let reactions: Vec<f64> = admitted.iter().map(|&i| all[i]).collect();
    case.assert("Gᵀλ", &reactions, &product);
    // Along the motion, at constant v.
    let now = step((&TIME, &1.0));
    let in_time = case.constraints_at(&model, &case.moved(&case.v), &v, now);
    let (mut rate, mut bias) = (vec![0.0; rows], vec![0.0; rows]);
    joints::rates(&at, &mut rate);
    joints::accelerations(&at, &mut bias);
    case.assert("rate", &rate, &in_time[..rows]);
    case.assert("bias", &bias, &in_time[rows..2 * rows]);
}
