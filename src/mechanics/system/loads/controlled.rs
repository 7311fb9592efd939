//! Power, effort and error of a controller for functions, with their derivatives.

use super::control_law::{Outputs, Running, of};
use super::controller::give;
use super::motor;
use super::parameters::give_to_joint;
use super::pull::Pulled;
use super::{LoadCotangent, give_to_states};
use crate::math::Scalar;
use crate::model::LoadKind;
use crate::model::controller::Coordinate as Written;
use crate::system::bodies::BodyMotion;
use crate::system::in_motion::InMotion;

/// What `with` makes of the controller that a load is.
fn with<S: Scalar, T>(
    here: &InMotion<S>,
    load: usize,
    with: impl FnOnce(&Running<S>) -> T,
) -> Option<T> {
    let own = of(here, load)?;
    let ground = BodyMotion::ground();
    Some(with(&Running::of(here, &ground, own)))
}

/// The power by which a controller drives its bodies; `None` of another load.
pub(super) fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        running.effort() * coordinate.rate(at)
    })
}

/// Adds `weight` times the derivative of [`power`].
pub(super) fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        let by = Outputs {
            effort: weight * coordinate.rate(at),
            integral: 0.0,
            lag: 0.0,
        };
        let mut known = running.pull(by);
        let first = &mut known.coordinates[0];
        coordinate.pull(at, 0.0, weight * running.effort(), first);
        give(here, (load, running), (by, &known), out);
    });
}

/// The effort F of a controller.
pub(super) fn effort<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| running.effort())
}

/// Adds `weight` times the derivative of [`effort`].
pub(super) fn pull_effort(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let by = Outputs {
            effort: weight,
            integral: 0.0,
            lag: 0.0,
        };
        give(here, (load, running), (by, &running.pull(by)), out);
    });
}

/// What the states of a settled controller are with its bodies, where a drive holds its joint by `held` if it has an integral;
/// `None` if its motor does not allow this effort.
pub fn settled<S: Scalar>(here: &InMotion<S>, load: usize, held: S) -> Option<Vec<(usize, S)>> {
    with(here, load, |running| {
        let own = running.own;
        let mut all = Vec::new();
        let mut effort = running.limited.effort;
        if let Some(integral) = &own.integral {
            effort = held;
            let demand = motor::demand(&own.limits, effort)?;
            all.push((integral.state, demand - running.demand));
        }
        all.extend(own.lag.as_ref().map(|own| (own.state, effort)));
        Some(all)
    })?
}

/// The error e_0 of a controller.
pub(super) fn error<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| running.errors[0][0])
}

/// Adds `weight` times the derivative of [`error`].
pub(super) fn pull_error(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let (coordinate, at) = &running.coordinates[0];
        let mut pulled = Pulled::zero();
        coordinate.pull(at, -weight, 0.0, &mut pulled);
        give_to_states(&pulled, at, here.numbering, (&mut out.y, &mut out.v));
        let own = &running.own.feedback[0];
        if let Written::Joint { joint, .. } = own.coordinate {
            give_to_joint(out.model, joint, &pulled);
        }
        let LoadKind::Controller(to) = &mut out.model.loads[load].kind else {
            unreachable!("a cotangent has the kind of its load")
        };
        let to = &mut to.feedback[0];
        if let Written::Distance {
            point_a, point_b, ..
        } = &mut to.coordinate
        {
            *point_a += pulled.a.frame.point;
            *point_b += pulled.b.frame.point;
        }
        let weights = [weight, 0.0, 0.0];
        *out.time += own
            .reference
            .pull_back(here.time, weights, &mut to.reference);
    });
}
