//! Makes the loads of a model from those of a file.

use super::placement::{Assembly, GROUND};
use super::schema::Document;
use super::schema::joints::Joint;
use super::schema::loads::{
    Axes as WrittenAxes, Interpolation, Load as WrittenLoad, Motion, TimeFunction as Written,
};
use crate::math::scalar::unit;
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, DegreeOfFreedom, Load, LoadKind, Smoothness, TimeFunction};

/// The loads of a checked document, in its order.
pub(crate) fn loads<S: Scalar>(document: &Document, assembly: &Assembly<S>) -> Vec<Load<S>> {
    let one = |(name, written): (&String, &WrittenLoad)| Load {
        name: name.clone(),
        kind: kind(document, assembly, written),
    };
    document.loads.iter().map(one).collect()
}

fn kind<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    written: &WrittenLoad,
) -> LoadKind<S> {
    let get = |quantity: &super::quantity::Quantity| assembly.quantity(quantity);
    let body = |name: &str| {
        assembly
            .index(name)
            .expect("a load acts on a body, not on ground")
    };
    match written {
        WrittenLoad::Force(force) => {
            let pose = assembly.pose(&force.body);
            let from_centre = |point: Vec3<S>| point - pose.centre;
            let point = match (&force.point, &force.at) {
                (Some(point), _) => from_centre(assembly.in_body(&force.body, point)),
                (None, Some(at)) => from_centre(assembly.at_ground(&force.body, at)),
                (None, None) => Vec3::zeros(),
            };
            LoadKind::Force {
                body: body(&force.body),
                point,
                direction: unit(assembly.ground(&force.direction)),
                axes: axes(force.axes),
                magnitude: course(assembly, force.magnitude.parts()),
            }
        }
        WrittenLoad::Torque(torque) => LoadKind::Torque {
            body: body(&torque.body),
            direction: unit(assembly.ground(&torque.direction)),
            axes: axes(torque.axes),
            magnitude: course(assembly, torque.magnitude.parts()),
        },
        WrittenLoad::Spring(spring) => {
            let end = |side: usize| {
                let name = &spring.between[side];
                (name, assembly.end(&spring.between, &spring.at, side))
            };
            let (a, b) = match spring.between[0] == GROUND {
                true => (end(1), end(0)),
                false => (end(0), end(1)),
            };
            LoadKind::Spring {
                body_a: body(a.0),
                body_b: assembly.index(b.0),
                point_a: a.1,
                point_b: b.1,
                rest_length: get(&spring.rest_length),
                stiffness: get(&spring.stiffness),
                cubic: get(&spring.cubic),
                damping: get(&spring.damping),
            }
        }
        WrittenLoad::TorsionSpring(spring) => LoadKind::TorsionSpring {
            joint: joint(document, &spring.joint).0,
            rest_angle: get(&spring.rest_angle),
            stiffness: get(&spring.stiffness),
            damping: get(&spring.damping),
        },
        WrittenLoad::Damping(damping) => {
            let (joint, written) = joint(document, &damping.joint);
            let coefficient = get(&damping.coefficient);
            match dof(written, damping.motion) {
                Some(dof) => LoadKind::Damping {
                    joint,
                    dof,
                    coefficient,
                },
                None => LoadKind::BallDamping { joint, coefficient },
            }
        }
        WrittenLoad::Friction(friction) => {
            let (joint, written) = joint(document, &friction.joint);
            LoadKind::Friction {
                joint,
                dof: dof(written, friction.motion)
                    .expect("joints with friction are checked when a problem is read"),
                size: get(&friction.size),
                width: get(&friction.width),
            }
        }
    }
}

fn axes(written: WrittenAxes) -> Axes {
    match written {
        WrittenAxes::Ground => Axes::Ground,
        WrittenAxes::Body => Axes::Body,
    }
}

fn course<S: Scalar>(assembly: &Assembly<S>, written: Written) -> TimeFunction<S> {
    let get = |quantity: &super::quantity::Quantity| assembly.quantity(quantity);
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

fn joint<'a>(document: &'a Document, name: &str) -> (usize, &'a Joint) {
    let (index, _, joint) = document
        .joints
        .get_full(name)
        .expect("names are checked when a problem is read");
    (index, joint)
}

/// The degree of freedom of a joint on which a load acts: the named one, or the first; `None` if
/// the joint has none.
fn dof(joint: &Joint, motion: Option<Motion>) -> Option<DegreeOfFreedom> {
    match motion {
        Some(motion) => Some(named(motion)),
        None => joint.kind().degrees_of_freedom().first().copied(),
    }
}

/// The degree of freedom of a name in the file.
pub(crate) fn named(motion: Motion) -> DegreeOfFreedom {
    match motion {
        Motion::Turn => DegreeOfFreedom::Rotation,
        Motion::Slide => DegreeOfFreedom::Translation,
    }
}
