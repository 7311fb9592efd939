//! Conserved quantities, constraint drift and joint reactions of a state.

use super::bodies::{BodyMotion, add6};
use super::constraint::gradient;
use super::flexible;
use super::in_motion::InMotion;
use super::joints;
use super::loads;
use super::numbering::Numbering;
use super::redundancy::smallest_multipliers;
use super::side::sides;
use crate::math::Vec3;
use crate::model::{Model, Role};

/// Conserved quantities and constraint drift of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// ½ Σ (m ṙᵀṙ + ωᵀJω) \[J\].
    pub kinetic: f64,
    /// −Σ m gᵀr from the origin, plus the energy of springs \[J\].
    pub potential: f64,
    /// Linear momentum Σ m ṙ, ground axes \[kg m/s\].
    pub momentum: Vec3<f64>,
    /// Angular momentum about the origin, Σ (m r × ṙ + R J ω), ground axes \[kg m²/s\].
    pub angular_momentum: Vec3<f64>,
    /// Largest |Φ|, including redundant rows \[m or 1\].
    pub position_drift: f64,
    /// Largest |G v + Φ_t|, including redundant rows \[m/s or 1/s\].
    pub velocity_drift: f64,
}

/// Force and torque of a joint on its body A, at the joint's point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Force in the joint's axes e1, e2, e3 on body A \[N\].
    pub force: Vec3<f64>,
    /// Torque about the joint's point in the joint's axes on body A \[N m\].
    pub torque: Vec3<f64>,
    /// The same force in ground axes \[N\].
    pub force_ground: Vec3<f64>,
    /// The same torque in ground axes \[N m\].
    pub torque_ground: Vec3<f64>,
}

/// Observes the state (q, v) at `time` \[s\].
pub fn observe(
    model: &Model<f64>,
    numbering: &Numbering,
    (q, v): (&[f64], &[f64]),
    time: f64,
) -> Observation {
    let mut motions = Vec::new();
    BodyMotion::all(numbering, q, v, &mut motions);
    let mut seen = Observation {
        kinetic: 0.0,
        potential: 0.0,
        momentum: Vec3::zeros(),
        angular_momentum: Vec3::zeros(),
        position_drift: 0.0,
        velocity_drift: 0.0,
    };
    for (body, motion) in model.bodies.iter().zip(&motions) {
        let momentum = motion.velocity * body.mass;
        let spin = body.inertia * motion.omega;
        if body.role != Role::State {
            seen.kinetic += 0.5 * (momentum.dot(&motion.velocity) + spin.dot(&motion.omega));
        }
        if body.role.is_abstract() {
            continue;
        }
        seen.potential -= body.mass * model.gravity.dot(&motion.position);
        seen.momentum += momentum;
        seen.angular_momentum += motion.position.cross(&momentum) + motion.rotation * spin;
    }
    let held = flexible::held(model, &motions);
    seen.kinetic += held.kinetic;
    seen.potential += held.potential;
    seen.momentum += held.momentum;
    seen.angular_momentum += held.angular_momentum;
    seen.potential += loads::potential(model, &motions, time);
    let mut rows = vec![0.0; numbering.constraints()];
    let at = InMotion::new(model, numbering, &motions, time);
    joints::values(&at, &mut rows);
    seen.position_drift = largest(&rows);
    joints::rates(&at, &mut rows);
    seen.velocity_drift = largest(&rows);
    seen
}

/// Largest absolute value; NaN if there is one.
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(
        0.0,
        |m: f64, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) },
    )
}

/// Reactions of all joints in the state (q, λ) at `time` \[s\], from −Gᵀλ.
///
/// With redundant rows, reactions are not unique. Then these are those with the smallest
/// multipliers over all rows that move the bodies in the same way.
pub fn reactions(
    model: &Model<f64>,
    numbering: &Numbering,
    (q, lambda): (&[f64], &[f64]),
    time: f64,
) -> Vec<Reaction> {
    let at_rest = vec![0.0; numbering.velocities()];
    let mut motions = Vec::new();
    BodyMotion::all(numbering, q, &at_rest, &mut motions);
    let lambda = match model.joints.iter().all(|joint| joint.redundant.is_empty()) {
        true => lambda.to_vec(),
        false => smallest_multipliers(&InMotion::new(model, numbering, &motions, time), lambda),
    };
    let ground = BodyMotion::ground();
    let reaction = |(j, joint): (usize, &crate::model::Joint<f64>)| {
        let (a, b) = sides(joint, &motions, &ground, time);
        let mut total = [0.0; 6];
        for (row, &l) in joint.rows().zip(&lambda[numbering.rows(j)]) {
            let g = gradient(row, &a, &b);
            add6(&mut total, &(g.force * -l), &(g.torque_a * -l));
        }
        let force_ground = Vec3::new(total[0], total[1], total[2]);
        let about_centre = Vec3::new(total[3], total[4], total[5]);
        let r = &motions[joint.body_a].rotation;
        let force = r.tr_mul(&force_ground);
        let torque = about_centre - a.frame.point.cross(&force);
        let in_joint = |x: &Vec3<f64>| Vec3::from(a.frame.axes.map(|axis| axis.dot(x)));
        Reaction {
            force: in_joint(&force),
            torque: in_joint(&torque),
            force_ground,
            torque_ground: r * torque,
        }
    };
    model.joints.iter().enumerate().map(reaction).collect()
}
