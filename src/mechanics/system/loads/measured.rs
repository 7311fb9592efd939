//! Quantities of springs, stops, contacts and controllers for functions, with their derivatives.

use super::pull::Pulled;
use super::{
    Acting, LoadCotangent, cable, contact, controlled, for_loads, give_to_parameters,
    give_to_states, spring, stop,
};
use crate::math::Scalar;
use crate::model::{Contact, LoadKind};
use crate::system::InMotion;
use crate::system::joints::JointCotangent;

/// Kind of quantity of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadPart {
    /// The distance of the points of a spring, or the length of a cable from end to end \[m\].
    Length,
    /// The force by which a spring or cable pulls its points together, damping included \[N\].
    Tension,
    /// The torque by which a torsion spring turns its joint back, damping included \[N m\].
    Torque,
    /// How deep a stop or a contact is entered; negative before it \[m\].
    Penetration,
    /// The same of the stop of an angle \[rad\].
    PenetrationAngle,
    /// Normal force of a stop or a contact, never negative \[N\].
    NormalForce,
    /// The same of the stop of an angle \[N m\].
    NormalTorque,
    /// Size of the friction of a contact \[N\].
    Friction,
    /// Power that the friction of a contact takes, never negative \[W\].
    SlipPower,
    /// Force by which a controller acts along its coordinate \[N\].
    EffortForce,
    /// The same about the axis of a joint \[N m\].
    EffortTorque,
    /// What a controller's coordinate lacks to its reference \[m\].
    ErrorLength,
    /// The same of an angle \[rad\].
    ErrorAngle,
}

/// A measure of a load.
#[derive(Clone, Copy, Debug)]
pub struct LoadMeasure {
    /// The load.
    pub load: usize,
    /// The quantity.
    pub part: LoadPart,
}

/// Its value in a motion.
pub fn value<S: Scalar>(at: &InMotion<S>, measure: LoadMeasure) -> S {
    let own = match measure.part {
        LoadPart::EffortForce | LoadPart::EffortTorque => controlled::effort(at, measure.load),
        LoadPart::ErrorLength | LoadPart::ErrorAngle => controlled::error(at, measure.load),
        LoadPart::Length => cable::measure(at, measure.load, false),
        LoadPart::Tension => cable::measure(at, measure.load, true),
        _ => None,
    };
    if let Some(value) = own {
        return value;
    }
    let mut value: Option<S> = None;
    for_loads(at.model, at.motions, [measure.load], |_, kind, acting| {
        let own = of(kind, acting, measure.part);
        // Forces of both ends of a capsule add, and the deeper end counts.
        value = Some(match value {
            None => own,
            Some(first) if measure.part == LoadPart::Penetration => {
                if own.re() > first.re() {
                    own
                } else {
                    first
                }
            }
            Some(first) => first + own,
        });
    });
    value.unwrap_or_else(S::zero)
}

const CHECKED: &str = "a load has this measure, which is checked";

fn of<S: Scalar>(kind: &LoadKind<S>, at: &Acting<S>, part: LoadPart) -> S {
    match part {
        LoadPart::Length => spring::of(kind).expect(CHECKED).length(at),
        LoadPart::Tension | LoadPart::Torque => spring::of(kind).expect(CHECKED).tension(at),
        LoadPart::Penetration | LoadPart::PenetrationAngle => match kind {
            LoadKind::Contact(own) => contact::penetration(own, at),
            _ => stop::of(kind).expect(CHECKED).penetration(at),
        },
        LoadPart::NormalForce | LoadPart::NormalTorque => match kind {
            LoadKind::Contact(own) => contact::normal(own, at),
            _ => stop::of(kind).expect(CHECKED).normal(at),
        },
        LoadPart::Friction => contact::tangential(touching(kind), at),
        LoadPart::SlipPower => contact::slip_power(touching(kind), at),
        LoadPart::EffortForce
        | LoadPart::EffortTorque
        | LoadPart::ErrorLength
        | LoadPart::ErrorAngle => unreachable!("{CHECKED}"),
    }
}

/// The contact that a load is.
fn touching<S>(kind: &LoadKind<S>) -> &Contact<S> {
    let LoadKind::Contact(own) = kind else {
        unreachable!("{CHECKED}")
    };
    own
}

/// Adds `weight` times the derivative of [`value`] to states and parameters. Returns the derivative in time.
pub fn pull_back(
    at: &InMotion<f64>,
    measure: LoadMeasure,
    weight: f64,
    out: &mut JointCotangent,
) -> f64 {
    let mut by_time = 0.0;
    let mut to = LoadCotangent {
        y: out.y.as_deref_mut(),
        v: out.v.as_deref_mut(),
        time: &mut by_time,
        model: out.model,
    };
    match measure.part {
        LoadPart::EffortForce | LoadPart::EffortTorque => {
            controlled::pull_effort(at, measure.load, weight, &mut to);
        }
        LoadPart::ErrorLength | LoadPart::ErrorAngle => {
            controlled::pull_error(at, measure.load, weight, &mut to);
        }
        LoadPart::Length | LoadPart::Tension
            if matches!(at.model.loads[measure.load].kind, LoadKind::Cable(_)) =>
        {
            let tension = measure.part == LoadPart::Tension;
            cable::pull_measure(at, (measure.load, tension), weight, &mut to);
        }
        _ => pull_others(at, measure, weight, out),
    }
    by_time
}

fn pull_others(at: &InMotion<f64>, measure: LoadMeasure, weight: f64, out: &mut JointCotangent) {
    let deepest = match measure.part {
        LoadPart::Penetration => Some(value(at, measure)),
        _ => None,
    };
    let mut given = false;
    for_loads(at.model, at.motions, [measure.load], |i, kind, acting| {
        if deepest.is_some_and(|own| given || of(kind, acting, measure.part) < own) {
            return;
        }
        given = true;
        let pulled = pull(kind, acting, measure.part, weight);
        give_to_states(&pulled, acting, at.numbering, (&mut out.y, &mut out.v));
        give_to_parameters(kind, &pulled, (i, acting.part, 0.0), (out.model, &mut 0.0));
    });
}

fn pull(kind: &LoadKind<f64>, at: &Acting<f64>, part: LoadPart, weight: f64) -> Pulled<f64> {
    let mut out = Pulled::zero();
    match part {
        LoadPart::Length => {
            let own = spring::of(kind).expect(CHECKED);
            own.pull_length(at, weight, &mut out);
        }
        LoadPart::Tension | LoadPart::Torque => {
            let own = spring::of(kind).expect(CHECKED);
            own.pull_tension(at, weight, &mut out);
        }
        LoadPart::Penetration | LoadPart::PenetrationAngle => {
            if let LoadKind::Contact(own) = kind {
                contact::pull_penetration(own, at, weight, &mut out);
                return out;
            }
            let stop = stop::of(kind).expect(CHECKED);
            stop.pull_penetration(at, weight, &mut out);
        }
        LoadPart::Friction => contact::pull_tangential(touching(kind), at, weight, &mut out),
        LoadPart::SlipPower => contact::pull_slip_power(touching(kind), at, weight, &mut out),
        LoadPart::EffortForce
        | LoadPart::EffortTorque
        | LoadPart::ErrorLength
        | LoadPart::ErrorAngle => unreachable!("{CHECKED}"),
        LoadPart::NormalForce | LoadPart::NormalTorque => {
            if let LoadKind::Contact(own) = kind {
                contact::pull_normal(own, at, weight, &mut out);
                return out;
            }
            stop::of(kind)
                .expect(CHECKED)
                .pull_normal(at, weight, &mut out);
        }
    }
    out
}
