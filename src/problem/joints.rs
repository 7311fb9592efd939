//! Makes the joints and drives of a model from those of a file.

use super::controllers;
use super::courses::course;
use super::placement::{Assembly, GROUND, split_location};
use crate::math::scalar::{length, unit};
use crate::math::{Scalar, Vec3};
use crate::model::{DegreeOfFreedom, Drive, Fit, Joint, JointFrame, JointKind, TimeFunction};
use crate::schema::Document;
use crate::schema::drives::{Drive as WrittenDrive, TimeFunction as Written};
use crate::schema::joints::{Joint as WrittenJoint, JointPlace};
use crate::schema::mechanics::Shape;

/// The joints of a checked document with their drives, in its order.
pub fn joints<S: Scalar>(document: &Document, assembly: &Assembly<S>) -> Vec<Joint<S>> {
    let one = |(name, written): (&String, &WrittenJoint)| Joint {
        drives: drives(document, assembly, name),
        ..joint(document, assembly, name, written)
    };
    document.joints.iter().map(one).collect()
}

/// The ground axis that is farthest from an axis; of several the first.
pub(super) fn farthest(axis: [f64; 3]) -> usize {
    let nearer = |&i: &usize, &j: &usize| axis[i].abs().total_cmp(&axis[j].abs());
    (0..3)
        .min_by(nearer)
        .expect("a vector has three components")
}

/// A right-handed orthonormal triad whose third axis is along `axis`. The first is the projection
/// of the ground axis that is farthest from it.
fn triad<S: Scalar>(axis: Vec3<S>) -> [Vec3<S>; 3] {
    let e3 = unit(axis);
    let mut e1 = Vec3::zeros();
    e1[farthest([e3.x.re(), e3.y.re(), e3.z.re()])] = S::one();
    triad_with(e3, e1)
}

/// The right-handed triad with the unit vector `e3` and the first axis along the projection of
/// `e1`.
fn triad_with<S: Scalar>(e3: Vec3<S>, e1: Vec3<S>) -> [Vec3<S>; 3] {
    let e1 = unit(e1 - e3 * e3.dot(&e1));
    [e1, e3.cross(&e1), e3]
}

/// A joint without its drives. Ground is always body B.
fn joint<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    name: &str,
    written: &WrittenJoint,
) -> Joint<S> {
    let between = written.between();
    let (a, b) = if between[0] == GROUND { (1, 0) } else { (0, 1) };
    let [axis, cross] = written
        .axes()
        .map(|axis| axis.map(|axis| assembly.axis(axis)));
    let triad = match (axis, cross) {
        (axis, Some(cross)) if matches!(written, WrittenJoint::Free(_)) => {
            triad_with(unit(axis.unwrap_or(Vec3::z())), cross)
        }
        (None, _) => triad(Vec3::z()),
        (Some(axis), None) => triad(axis),
        // e3 is fixed in body A, e1 in body B.
        (Some(axis), Some(cross)) => {
            let (e3, e1) = if a == 0 { (axis, cross) } else { (cross, axis) };
            triad_with(unit(e3), e1)
        }
    };
    let frame = |side: usize| {
        let body = &between[side];
        let pose = assembly.pose(body);
        let is_point = document
            .bodies
            .get(body)
            .is_some_and(|body| matches!(body.shape, Some(Shape::Point)));
        let point = match (written, written.place()) {
            _ if is_point => Vec3::zeros(),
            (WrittenJoint::Rod(rod), _) => assembly.end(between, &rod.at, side),
            (_, None) => Vec3::zeros(),
            (_, Some(place)) => at(assembly, place, body, side) - pose.centre,
        };
        JointFrame {
            point,
            axes: triad.map(|e| pose.rotation.tr_mul(&e)),
            length: S::zero(),
        }
    };
    let (mut frame_a, frame_b) = (frame(a), frame(b));
    if let WrittenJoint::Rod(rod) = written {
        let end = |side: usize, frame: &JointFrame<S>| {
            let pose = assembly.pose(&between[side]);
            pose.position() + pose.rotation * frame.point
        };
        frame_a.length = match &rod.length {
            Some(length) => assembly.quantity(length),
            None => length(&(end(a, &frame_a) - end(b, &frame_b))),
        };
    }
    Joint {
        name: name.to_owned(),
        kind: written.kind(),
        body_a: assembly
            .index(&between[a])
            .expect("a joint has at least one body that is not ground"),
        body_b: assembly.index(&between[b]),
        frame_a,
        frame_b,
        drives: Vec::new(),
        redundant: Vec::new(),
        fit: Fit {
            tolerance: document.input_tolerance(),
            rounded: false,
        },
        trivial_rows: Vec::new(),
        modes: None,
    }
}

/// Position of a joint on a body, from the origin of the body's axes \[m\].
pub(super) fn at<S: Scalar>(
    assembly: &Assembly<S>,
    place: &JointPlace,
    body: &str,
    side: usize,
) -> Vec3<S> {
    match place {
        JointPlace::Named(text) if split_location(text).0 == body => assembly.named_in_body(text),
        JointPlace::Named(text) => {
            let pose = assembly.pose(body);
            pose.rotation.tr_mul(&(assembly.named(text) - pose.origin))
        }
        JointPlace::Coordinates(point) => assembly.at_ground(body, point),
        JointPlace::Each(pair) => assembly.in_body(body, [&pair.a, &pair.b][side]),
    }
}

/// The drives of the joint `name` that are on, in the first phase if events switch them.
pub(super) fn drives<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    name: &str,
) -> Vec<Drive<S>> {
    let phase = document.phase.unwrap_or(0);
    let of =
        |(own, drive): &(&String, &WrittenDrive)| drive.joint == name && document.is_on(own, phase);
    // A machine at rest holds its drives as they are at the start.
    let course = |written: Written| match (course(assembly, written), document.is_rest()) {
        (course, true) => TimeFunction::constant(course.value(S::zero())),
        (course, false) => course,
    };
    let parts = |drive: &WrittenDrive| {
        let turn = drive.turn.as_ref().map(|turn| Drive {
            dof: DegreeOfFreedom::Rotation,
            course: course(turn.parts()),
        });
        let slide = drive.slide.as_ref().map(|slide| Drive {
            dof: DegreeOfFreedom::Translation,
            course: course(slide.parts()),
        });
        turn.into_iter().chain(slide)
    };
    let mut all: Vec<Drive<S>> = document
        .drives
        .iter()
        .filter(of)
        .flat_map(|(_, drive)| parts(drive))
        .collect();
    all.extend(controllers::held_at_rest(document, assembly, name));
    all
}

/// Whether a joint of this kind may act on a point mass: it needs no extent and no rotation.
pub fn holds_points(kind: JointKind) -> bool {
    matches!(kind, JointKind::Spherical | JointKind::Rod)
}
