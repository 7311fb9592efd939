//! Whole turns of joints with torsion springs, stops or controllers.
//!
//! The state gives the angle of a joint up to whole turns, and a spring or a stop needs all of it. A body without mass and unknowns, the
//! counter of the load, has the angle φ_k of the last step as the first component of its position. With the Euler parameters
//! of both bodies (0 as placed), * the conjugate and n the axis in body B, the angle is
//!
//! ```text
//! r = p_B* p_A p_A0* p_B0,     φ = φ_0 + 2 atan2(eᵀn, r0) + 4π k,     k such that φ is nearest to φ_k
//! ```
//!
//! Steps turn no joint by a whole turn, so φ is continuous. It is used to choose the branch of the angle alone; so it is real,
//! and no derivative depends on it.

use super::numbering::Numbering;
use crate::math::rotation::{Quat, compose, conjugate, twist};
use crate::math::{Scalar, Vec3};
use crate::model::Model;
use std::f64::consts::TAU;

/// The counted angle \[rad\] of a joint whose bodies A and B have these Euler parameters, nearest to `known`; `counter` is the
/// counter of its spring.
pub(super) fn counted<S: Scalar>(
    model: &Model<S>,
    (joint, counter): (usize, usize),
    [a, b]: [&Quat<S>; 2],
    known: f64,
) -> f64 {
    let joint = &model.joints[joint];
    let real = |p: &Quat<S>| p.map(|x| x.re());
    let ground = [1.0, 0.0, 0.0, 0.0];
    let placed = |body: usize| real(&model.bodies[body].orientation);
    let placed_b = joint.body_b.map_or(ground, placed);
    let seen = compose(&conjugate(&real(b)), &real(a));
    let before = compose(&conjugate(&placed(joint.body_a)), &placed_b);
    let axis: Vec3<f64> = joint.frame_b.axes[2].map(|x| x.re());
    let first = model.bodies[counter].position.x.re();
    let angle = first + twist(&compose(&seen, &before), &axis);
    angle + 2.0 * TAU * ((known - angle) / (2.0 * TAU)).round()
}

/// Counts the turns at the end of a step in its positions.
pub fn count<S: Scalar>(model: &Model<S>, numbering: &Numbering, q: &mut [S]) {
    let ground = [S::one(), S::zero(), S::zero(), S::zero()];
    let count = |(joint, counter): (usize, usize)| {
        let of = |body: usize| {
            let p = &q[numbering.position(body) + 3..];
            [p[0], p[1], p[2], p[3]]
        };
        let (a, b) = (model.joints[joint].body_a, model.joints[joint].body_b);
        let known = numbering.position(counter);
        let ends = [&of(a), &b.map_or(ground, of)];
        let angle = counted(model, (joint, counter), ends, q[known].re());
        q[known] = S::from(angle);
    };
    let counters = model.loads.iter().flat_map(|load| load.kind.counters());
    counters.for_each(count);
}
