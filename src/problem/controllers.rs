//! Makes the controllers of a model from those of a file.
//!
//! At rest a lag has settled, and an integral is whatever leaves no error: the joint is held at its reference as by a drive,
//! whose torque or force is the effort. Vibrations about rest are those of the closed loop.

use super::courses::course;
use super::load_ends::{course as magnitude, dof, ends, joint};
use super::placement::Assembly;
use crate::math::{Scalar, Vec3};
use crate::model::controller::{
    Controller, Coordinate, Feedback, Integral, Lag, Limits, Regime, Weight,
};
use crate::model::{
    CoupledMotion, DegreeOfFreedom, Drive, LoadKind, Model, RigidBody, Role, TimeFunction,
};
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::controllers::{Controller as Written, Feedback as WrittenFeedback, Reference};
use crate::schema::drives::TimeFunction as Course;
use crate::schema::loads::{Load, Motion};

/// A place that [`crate::model::Model::add_states`] fills.
const NO_BODY: usize = usize::MAX;

/// A controller of a checked document, without counters and states.
pub fn controller<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    written: &Written,
) -> Controller<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    let some = |quantity: &Option<Quantity>| quantity.as_ref().map(get);
    let motor = written.motor.as_ref();
    let first = Feedback {
        coordinate: coordinate(document, assembly, written),
        reference: reference(document, assembly, &written.reference),
        proportional: get(&written.proportional),
        derivative: get(&written.derivative),
    };
    let other = |own: &WrittenFeedback| Feedback {
        coordinate: of_joint(document, &own.joint, own.motion),
        reference: reference(document, assembly, &own.reference),
        proportional: get(&own.proportional),
        derivative: get(&own.derivative),
    };
    let weights = written.gravity_compensation.iter().map(|own| {
        let centre = assembly.pose(&own.body).centre;
        let point = own.point.as_ref();
        Weight {
            body: (assembly.index(&own.body)).expect("weights are of bodies, which is checked"),
            point: point.map_or(Vec3::zeros(), |point| {
                assembly.in_body(&own.body, point) - centre
            }),
            mass: get(&own.mass),
        }
    });
    let feed_forward = written.feed_forward.as_ref();
    let feed_forward = feed_forward.map(|own| magnitude(assembly, own.parts()));
    Controller {
        regime: match document.is_rest() {
            true => Regime::Settled,
            false => Regime::Running,
        },
        feedback: std::iter::once(first)
            .chain(written.feedback.iter().map(other))
            .collect(),
        integral: written.integral.as_ref().map(|gain| Integral {
            state: NO_BODY,
            gain: get(gain),
            tracking: some(&written.anti_windup),
        }),
        feed_forward: held(
            document,
            feed_forward.unwrap_or(TimeFunction::constant(S::zero())),
        ),
        weights: weights.collect(),
        limits: Limits {
            ratio: motor.map_or(S::one(), |own| get(&own.gear_ratio)),
            effort: motor.and_then(|own| some(&own.torque)),
            line: motor
                .and_then(|own| own.curve.as_ref())
                .map(|own| [get(&own.stall_torque), get(&own.no_load_speed)]),
            power: motor.and_then(|own| some(&own.power)),
        },
        lag: motor.and_then(|own| own.lag.as_ref()).map(|time| Lag {
            state: NO_BODY,
            time: get(time),
        }),
    }
}

/// Whether the integral of a controller holds its joint, as it does at rest.
pub fn is_held(document: &Document, written: &Written) -> bool {
    document.is_rest() && written.integral.is_some()
}

/// The drives by which integrals hold a joint at rest.
pub fn held_at_rest<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    joint: &str,
) -> Vec<Drive<S>> {
    let mut all = Vec::new();
    for load in document.loads.values() {
        let Load::Controller(own) = load else {
            continue;
        };
        if is_held(document, own)
            && own.joint.as_deref() == Some(joint)
            && let Some(dof) = controlled(document, own)
        {
            let course = reference(document, assembly, &own.reference);
            all.push(Drive { dof, course });
        }
    }
    all
}

/// Name of the coordinate of a rotor.
fn rotor_of(load: &str) -> String {
    format!("{load}, rotor")
}

/// Adds the rotors of motors to a model.
pub fn add_rotors<S: Scalar>(document: &Document, assembly: &Assembly<S>, model: &mut Model<S>) {
    for (name, load) in &document.loads {
        let Load::Controller(own) = load else {
            continue;
        };
        let Some(motor) = &own.motor else { continue };
        if let (Some(inertia), Some(on), Some(dof)) =
            (&motor.rotor_inertia, &own.joint, controlled(document, own))
        {
            let ratio = assembly.quantity(&motor.gear_ratio);
            let motion = CoupledMotion {
                joint: model.joints[joint(document, on).0].clone(),
                dof,
                factor: S::one(),
            };
            let inertia = assembly.quantity(inertia) * ratio * ratio;
            model.add_coordinate(&rotor_of(name), &motion, inertia);
        }
    }
}

fn coordinate<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    written: &Written,
) -> Coordinate<S> {
    match (&written.joint, &written.between, &written.at) {
        (Some(name), ..) => of_joint(document, name, written.motion),
        (None, Some(between), Some(at)) => {
            let ends = ends(assembly, between, at);
            Coordinate::Distance {
                body_a: ends.body_a,
                body_b: ends.body_b,
                point_a: ends.point_a,
                point_b: ends.point_b,
            }
        }
        (None, ..) => unreachable!("what is controlled is checked when a problem is read"),
    }
}

fn of_joint<S>(document: &Document, name: &str, motion: Option<Motion>) -> Coordinate<S> {
    let (joint, written) = joint(document, name);
    Coordinate::Joint {
        joint,
        dof: dof(written, motion).expect("joints of controllers are checked"),
        counter: None,
    }
}

fn reference<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    written: &Option<Reference>,
) -> TimeFunction<S> {
    let course = match written {
        None => TimeFunction::constant(S::zero()),
        Some(Reference::Constant(value)) => {
            course(assembly, Course::Polynomial(std::slice::from_ref(value)))
        }
        Some(Reference::Varying(own)) => course(assembly, own.parts()),
    };
    held(document, course)
}

/// A machine at rest holds references as they are at the start.
fn held<S: Scalar>(document: &Document, course: TimeFunction<S>) -> TimeFunction<S> {
    match document.is_rest() {
        true => TimeFunction::constant(course.value(S::zero())),
        false => course,
    }
}

/// What the states and measurements of each controller of a model cost, for messages.
pub(super) fn described(model: &Model<f64>) -> Vec<String> {
    let unknowns: usize = model
        .bodies
        .iter()
        .map(|body| body.mobility.unknowns())
        .sum();
    let mut all = Vec::new();
    for load in &model.loads {
        let LoadKind::Controller(own) = &load.kind else {
            continue;
        };
        let runs = own.regime == Regime::Running;
        let integral = own
            .integral
            .as_ref()
            .filter(|_| runs)
            .map(|_| "its integral");
        let lag = own.lag.as_ref().filter(|_| runs).map(|_| "its lag");
        let is_rotor = |body: &RigidBody<f64>| {
            body.role == Role::Coordinate && body.name.starts_with(&rotor_of(&load.name))
        };
        let rotor = model.bodies.iter().any(is_rotor).then_some("its rotor");
        let states: Vec<&str> = integral.into_iter().chain(lag).chain(rotor).collect();
        let cost = match states.len() {
            0 => "no state".to_owned(),
            n => format!("{n} of {unknowns} unknowns for {}", states.join(" and ")),
        };
        let measured = own.feedback.len();
        all.push(format!(
            "{}: {cost}; it measures {measured} of the coordinates",
            load.name
        ));
    }
    all
}

/// The degree of freedom that a controller acts on; `None` if it controls a distance.
pub fn controlled(document: &Document, written: &Written) -> Option<DegreeOfFreedom> {
    let joint = document.joints.get(written.joint.as_ref()?)?;
    dof(joint, written.motion)
}

/// The joints whose rotations a controller measures, in the order of its feedback.
pub fn turned<'a>(document: &Document, written: &'a Written) -> Vec<&'a String> {
    let first = written.joint.iter().map(|joint| (joint, written.motion));
    let others = written.feedback.iter().map(|own| (&own.joint, own.motion));
    first
        .chain(others)
        .filter(|(name, motion)| {
            let joint = document.joints.get(*name);
            joint.and_then(|joint| dof(joint, *motion)) == Some(DegreeOfFreedom::Rotation)
        })
        .map(|(name, _)| name)
        .collect()
}
