//! The placement of a model's bodies, and its length scale.

use crate::math::{Scalar, Vec3};
use crate::model::Model;

/// Part of a coordinate that is round-off.
const ROUND_OFF: f64 = 1e-13;

/// The placement (q_g, v_g) of the model's bodies, of lengths n_q and n_v.
pub fn guess<S: Scalar>(model: &Model<S>) -> (Vec<S>, Vec<S>) {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for body in &model.bodies {
        q.extend(body.position.iter());
        q.extend(body.orientation);
        v.extend(body.velocity.iter());
        v.extend(body.angular_velocity.iter());
    }
    (q, v)
}

/// As [`length_scale`], but by lengths of vectors, which turn with the scene. Where all are zero, the largest radius of gyration.
pub fn reach(model: &Model<f64>) -> f64 {
    farthest(model, Vec3::zeros())
}

/// The extent of a machine \[m\], wherever it is: as [`reach`], from the middle of its bodies instead of the origin.
pub fn extent(model: &Model<f64>) -> f64 {
    let bodies = positions(model);
    let count = bodies.clone().count().max(1);
    let middle = bodies.sum::<Vec3<f64>>() / count as f64;
    farthest(model, middle)
}

/// Positions of bodies, without coordinates of deformations.
fn positions(model: &Model<f64>) -> impl Iterator<Item = Vec3<f64>> + Clone {
    let bodies = model.bodies.iter().enumerate();
    let bodies = bodies.filter(|(i, _)| !model.is_carrier(*i));
    bodies.map(|(_, b)| b.position)
}

/// The largest distance of a body or a point of ground from `middle`, lever arm or length of a rod. Where all are zero, the
/// largest radius of gyration.
fn farthest(model: &Model<f64>, middle: Vec3<f64>) -> f64 {
    let joints = model.joints.iter().flat_map(|j| {
        let (a, b) = (&j.frame_a, &j.frame_b);
        let from = j.body_b.map_or(middle, |_| Vec3::zeros());
        [a.point.norm(), (b.point - from).norm(), a.length.abs()]
    });
    let bodies = positions(model).map(|position| (position - middle).norm());
    let largest = joints.chain(bodies).fold(0.0, f64::max);
    if largest > ROUND_OFF * middle.norm() {
        return largest;
    }
    let radii = (model.bodies.iter())
        .map(|b| (b.inertia.trace() / b.mass).sqrt())
        .filter(|radius| radius.is_finite());
    match radii.fold(0.0, f64::max) {
        0.0 => 1.0,
        radius => radius,
    }
}

/// Length scale of a scene's gaps and motions \[m\]: its largest lever arm or coordinate of a
/// placement.
pub fn length_scale<S: Scalar>(model: &Model<S>) -> f64 {
    let size = |v: &Vec3<S>| v.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
    let joints = model.joints.iter().flat_map(|j| {
        let (a, b) = (&j.frame_a, &j.frame_b);
        [size(&a.point), size(&b.point), a.length.re().abs()]
    });
    let bodies = model.bodies.iter().enumerate();
    let bodies = bodies.filter(|(i, _)| !model.holds_angles(*i));
    let bodies = bodies.map(|(_, b)| size(&b.position));
    let largest = joints.chain(bodies).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}
