//! Powers of loads and rates of joints for functions, with their derivatives.

use super::kinds::{forces, pulled as pull};
use super::parameters::{give_to_joint, give_to_parameters};
use super::power::{SLIDE, turn_rate};
use super::pull::{Pulled, pull_slide, pull_turn};
use super::{Acting, LoadCotangent, cable, controlled, distributed, for_loads, give_to_states};
use crate::math::{Scalar, Vec3};
use crate::model::DegreeOfFreedom;
use crate::system::bodies::{BodyMotion, add6};
use crate::system::in_motion::InMotion;
use crate::system::joints::JointCotangent;
use crate::system::{constraint, measures};

/// Velocities of both bodies of a load, linear in ground axes and angular in body axes.
fn velocities<S: Scalar>(at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
    [at.a.motion, at.b.motion].map(|motion| (motion.velocity, motion.omega))
}

/// The power \[W\] by which a load drives its bodies: Σ (Fᵀ ṙ + Mᵀ ω), over the nodes of a load that is spread over
/// elements. Positive if it gives energy to them.
pub fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> S {
    let own = distributed::power(here, load)
        .or_else(|| controlled::power(here, load))
        .or_else(|| cable::power(here, load));
    if let Some(power) = own {
        return power;
    }
    let mut found = S::zero();
    for_loads(here.model, here.motions, [load], |_, kind, at| {
        let pairs = forces(kind, at, here.time).into_iter().zip(velocities(at));
        found += pairs.fold(S::zero(), |sum, ((force, torque), (velocity, omega))| {
            sum + force.dot(&velocity) + torque.dot(&omega)
        });
    });
    found
}

/// Adds `weight` times the derivative of [`power`] to states and parameters. Returns the derivative in time.
pub fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut JointCotangent) -> f64 {
    let mut by_time = 0.0;
    for_loads(here.model, here.motions, [load], |i, kind, at| {
        // The power is linear in the velocities that the forces are weighed with.
        let weighed = velocities(at).map(|(velocity, omega)| (velocity * weight, omega * weight));
        let pulled = pull(kind, at, here.time, &weighed);
        give_to_states(&pulled, at, here.numbering, (&mut out.y, &mut out.v));
        give_to_parameters(
            kind,
            &pulled,
            (i, at.part, here.time),
            (out.model, &mut by_time),
        );
        let all = at.bodies.into_iter().zip(forces(kind, at, here.time));
        for (body, (force, torque)) in all {
            if let (Some(body), Some(v)) = (body, out.v.as_deref_mut()) {
                let o = here.numbering.velocity(body);
                add6(&mut v[o..], &(force * weight), &(torque * weight));
            }
        }
    });
    let mut to = LoadCotangent {
        y: out.y.as_deref_mut(),
        v: out.v.as_deref_mut(),
        time: &mut by_time,
        model: out.model,
    };
    distributed::pull_power(here, load, weight, &mut to);
    controlled::pull_power(here, load, weight, &mut to);
    cable::pull_power(here, load, weight, &mut to);
    by_time
}

/// Calls `visit` with both bodies of a joint, without its drives.
fn at_joint<S: Scalar, T>(
    here: &InMotion<S>,
    joint: usize,
    visit: impl FnOnce(&Acting<S>) -> T,
) -> T {
    let ground = BodyMotion::ground();
    let joint = &here.model.joints[joint];
    let (a, b) = measures::undriven(joint, here.motions, &ground);
    visit(&Acting {
        bodies: [Some(joint.body_a), joint.body_b],
        a,
        b,
        counted: None,
        part: 0.0,
    })
}

/// The rate of body A against body B about or along the axis of a joint \[rad/s or m/s\].
pub fn joint_rate<S: Scalar>(here: &InMotion<S>, (joint, dof): (usize, DegreeOfFreedom)) -> S {
    at_joint(here, joint, |at| match dof {
        DegreeOfFreedom::Rotation => turn_rate(at),
        DegreeOfFreedom::Translation => constraint::rate(SLIDE, &at.a, &at.b),
    })
}

/// Adds `weight` times the derivative of [`joint_rate`] to states and parameters.
pub fn pull_joint_rate(
    here: &InMotion<f64>,
    (joint, dof): (usize, DegreeOfFreedom),
    weight: f64,
    out: &mut JointCotangent,
) {
    at_joint(here, joint, |at| {
        let mut pulled = Pulled::zero();
        match dof {
            DegreeOfFreedom::Rotation => pull_turn(at, weight, &mut pulled),
            DegreeOfFreedom::Translation => pull_slide(at, weight, &mut pulled),
        }
        give_to_states(&pulled, at, here.numbering, (&mut out.y, &mut out.v));
        give_to_joint(out.model, joint, &pulled);
    });
}
