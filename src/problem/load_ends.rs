//! What loads of a file act on: joints and their motions, and points of bodies; and their magnitudes in time.

use super::placement::{Assembly, GROUND};
use crate::math::{Scalar, Vec3};
use crate::model::{DegreeOfFreedom, Smoothness, TimeFunction};
use crate::schema::Document;
use crate::schema::joints::{Ends, Joint};
use crate::schema::loads::{Interpolation, Motion, TimeFunction as Written};

/// Both ends of a load: body A is not ground.
pub(super) struct BothEnds<S> {
    pub body_a: usize,
    pub body_b: Option<usize>,
    pub point_a: Vec3<S>,
    pub point_b: Vec3<S>,
}

pub(super) fn ends<S: Scalar>(
    assembly: &Assembly<S>,
    between: &[String; 2],
    at: &Ends,
) -> BothEnds<S> {
    let sides = match between[0] == GROUND {
        true => [1, 0],
        false => [0, 1],
    };
    let [body_a, body_b] = sides.map(|side| assembly.index(&between[side]));
    let [point_a, point_b] = sides.map(|side| assembly.end(between, at, side));
    BothEnds {
        body_a: body_a.expect("a load acts on a body, not on ground"),
        body_b,
        point_a,
        point_b,
    }
}

/// A magnitude in time.
pub(super) fn course<S: Scalar>(assembly: &Assembly<S>, written: Written) -> TimeFunction<S> {
    let get = |quantity: &crate::quantity::Quantity| assembly.quantity(quantity);
    match written {
        Written::Constant(value) => TimeFunction::constant(get(value)),
        Written::Harmonic([amplitude, frequency, phase]) => TimeFunction::Harmonic {
            mean: S::zero(),
            amplitude: get(amplitude),
            frequency: get(frequency),
            phase: get(phase),
        },
        Written::Table(times, values, interpolation) => TimeFunction::Table {
            interpolation: Interpolation::of(interpolation),
            smoothness: Smoothness::Magnitude,
            times: times.iter().map(|&t| t.into()).collect(),
            values: values.iter().map(get).collect(),
        },
    }
}

/// A joint of the document, with its index.
pub(super) fn joint<'a>(document: &'a Document, name: &str) -> (usize, &'a Joint) {
    let (index, _, joint) = document
        .joints
        .get_full(name)
        .expect("names are checked when a problem is read");
    (index, joint)
}

/// The degree of freedom of a joint on which a load acts: the named one, or the first; `None` if
/// the joint has none.
pub(super) fn dof(joint: &Joint, motion: Option<Motion>) -> Option<DegreeOfFreedom> {
    match motion {
        Some(motion) => Some(named(motion)),
        None => joint.kind().degrees_of_freedom().first().copied(),
    }
}

/// The degree of freedom of a name in the file.
pub fn named(motion: Motion) -> DegreeOfFreedom {
    match motion {
        Motion::Turn => DegreeOfFreedom::Rotation,
        Motion::Slide => DegreeOfFreedom::Translation,
    }
}
