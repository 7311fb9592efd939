//! Quantities of springs for functions, with their derivatives.

use super::power::{angle, stretch, tension, torsion, turn_rate};
use super::pull::{Pulled, pull_angle, pull_rate, pull_turn};
use super::{Acting, for_each_load, give_to_parameters, give_to_states};
use crate::math::Scalar;
use crate::model::LoadKind;
use crate::system::InMotion;
use crate::system::joints::JointCotangent;

/// Kind of quantity of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringPart {
    /// The distance of its points \[m\].
    Length,
    /// The force by which it pulls its points together, damping included \[N\].
    Tension,
    /// The torque by which a torsion spring turns its joint back, damping included \[N m\].
    Torque,
}

/// A measure of a spring.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    /// The load.
    pub load: usize,
    /// The quantity.
    pub part: SpringPart,
}

/// Its value in a motion.
pub fn value<S: Scalar>(at: &InMotion<S>, spring: Spring) -> S {
    let mut found = S::zero();
    for_each_load(at.model, at.motions, |i, kind, acting| {
        if i == spring.load {
            found = of(kind, acting, spring.part);
        }
    });
    found
}

fn of<S: Scalar>(kind: &LoadKind<S>, at: &Acting<S>, part: SpringPart) -> S {
    match (kind, part) {
        (
            LoadKind::Spring {
                rest_length,
                stiffness,
                cubic,
                damping,
                ..
            },
            SpringPart::Length,
        ) => stretch(at, [*rest_length, *stiffness, *cubic, *damping]).length,
        (
            LoadKind::Spring {
                rest_length,
                stiffness,
                cubic,
                damping,
                ..
            },
            SpringPart::Tension,
        ) => {
            let law = [*rest_length, *stiffness, *cubic, *damping];
            tension(&stretch(at, law), law)
        }
        (
            LoadKind::TorsionSpring {
                rest_angle,
                stiffness,
                damping,
                ..
            },
            SpringPart::Torque,
        ) => torsion(at, [*rest_angle, *stiffness, *damping]),
        (
            LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. }
            | LoadKind::Force { .. }
            | LoadKind::Distributed(_)
            | LoadKind::Torque { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Friction { .. },
            SpringPart::Length | SpringPart::Tension | SpringPart::Torque,
        ) => unreachable!("a load has this measure, which is checked"),
    }
}

/// Adds `weight` times the derivative of [`value`] to states and parameters.
pub fn pull_back(at: &InMotion<f64>, spring: Spring, weight: f64, out: &mut JointCotangent) {
    for_each_load(at.model, at.motions, |i, kind, acting| {
        if i == spring.load {
            let pulled = pull(kind, acting, spring.part, weight);
            give_to_states(&pulled, acting, at.numbering, (&mut out.y, &mut out.v));
            give_to_parameters(kind, &pulled, (i, 0.0), (out.model, &mut 0.0));
        }
    });
}

fn pull(kind: &LoadKind<f64>, at: &Acting<f64>, part: SpringPart, weight: f64) -> Pulled<f64> {
    let mut out = Pulled::zero();
    match (kind, part) {
        (
            LoadKind::Spring {
                rest_length,
                stiffness,
                cubic,
                damping,
                ..
            },
            SpringPart::Length,
        ) => {
            let now = stretch(at, [*rest_length, *stiffness, *cubic, *damping]);
            pull_rate(at, &now, (weight, 0.0), &mut out);
        }
        (
            LoadKind::Spring {
                rest_length,
                stiffness,
                cubic,
                damping,
                ..
            },
            SpringPart::Tension,
        ) => {
            let now = stretch(at, [*rest_length, *stiffness, *cubic, *damping]);
            let x = now.length - *rest_length;
            let by_length = weight * (*stiffness + 3.0 * *cubic * x * x);
            pull_rate(at, &now, (by_length, weight * *damping), &mut out);
            out.scalars = [
                -by_length,
                weight * x,
                weight * x * x * x,
                weight * now.rate,
            ];
        }
        (
            LoadKind::TorsionSpring {
                rest_angle,
                stiffness,
                damping,
                ..
            },
            SpringPart::Torque,
        ) => {
            pull_angle(at, weight * *stiffness, &mut out);
            pull_turn(at, weight * *damping, &mut out);
            out.scalars[0] = -(weight * *stiffness);
            out.scalars[1] = weight * angle(at, *rest_angle);
            out.scalars[2] = weight * turn_rate(at);
        }
        (
            LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. }
            | LoadKind::Force { .. }
            | LoadKind::Distributed(_)
            | LoadKind::Torque { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Friction { .. },
            SpringPart::Length | SpringPart::Tension | SpringPart::Torque,
        ) => unreachable!("a load has this measure, which is checked"),
    }
    out
}
