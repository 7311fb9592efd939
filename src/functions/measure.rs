//! Values of instant quantities, and their exact derivatives.

use super::flight::{self, Flight};
use super::instant::{EnergyPart, Gate, Instant, Projectile};
use super::multipliers::Rows;
use super::turning::Rotation;
use crate::integrate::Trajectory;
use crate::math::soft_max::SoftMax;
use crate::math::{Scalar, Vec3};
use crate::model::Model;
use crate::system::bodies::add6;
use crate::system::joints::JointCotangent;
use crate::system::loads::springs;
use crate::system::marker::{self, MarkerKinematics};
use crate::system::{BodyMotion, InMotion, Numbering, flexible, loads, measures};

/// A point is at rest below this speed \[m/s\]. There the derivative of its speed is set to zero.
const REST: f64 = 1e-25;

/// A model at one instant.
#[derive(Clone, Copy)]
pub(crate) struct Snapshot<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// Its numbering.
    pub numbering: &'a Numbering,
    /// Positions; one entry per position number.
    pub q: &'a [S],
    /// Velocities; one entry per velocity number.
    pub v: &'a [S],
    /// Accelerations; one entry per velocity number.
    pub a: &'a [S],
    /// Multipliers of the rows of the joint whose reaction is measured, if any.
    pub joint: Rows<'a, S>,
    /// Time \[s\].
    pub time: S,
}

impl<'a, S: Scalar> Snapshot<'a, S> {
    /// Instant k of a run.
    pub(crate) fn of(model: &'a Model<S>, run: &'a Trajectory<S>, k: usize) -> Self {
        Self {
            model,
            numbering: &run.numbering,
            q: run.q(k),
            v: run.v(k),
            a: run.a(k),
            joint: Rows::none(),
            time: run.time(k),
        }
    }

    /// Motion of a body.
    pub(crate) fn motion(&self, body: usize) -> BodyMotion<S> {
        let a = &self.a[self.numbering.velocity(body)..];
        BodyMotion::of(self.numbering, body, self.q, self.v).accelerated(a)
    }

    /// Motions of all bodies.
    pub(crate) fn motions(&self) -> Vec<BodyMotion<S>> {
        let mut motions = Vec::with_capacity(self.numbering.bodies());
        BodyMotion::all(self.numbering, self.q, self.v, &mut motions);
        motions
    }

    /// The model with these motions.
    fn in_motion<'b>(&'b self, motions: &'b [BodyMotion<S>]) -> InMotion<'b, S> {
        InMotion::new(self.model, self.numbering, motions, self.time)
    }

    /// Elastic coordinates of a flexible body.
    fn coordinates(&self, flexible: usize) -> Vec<S> {
        flexible::coordinates(&self.model.flexible[flexible], &self.motions())
    }

    /// The flight of a projectile that is released now.
    pub(crate) fn flight(&self, projectile: &Projectile<S>) -> Flight<S> {
        Flight::new(
            projectile,
            &self.motion(projectile.body),
            &self.model.gravity,
        )
    }

    /// A rotation plus `turns`, a multiple of 2π \[rad\].
    fn rotation(&self, rotation: &Rotation<S>, turns: f64) -> S {
        rotation.angle(self.numbering, self.q) + turns
    }

    /// Openness of a gate; 1 without a gate.
    pub(crate) fn openness(&self, gate: &Option<Gate<S>>, turns: f64) -> S {
        gate.as_ref().map_or(S::one(), |gate| {
            gate.openness(self.rotation(&gate.rotation, turns))
        })
    }
}

/// Cotangents of a snapshot, in tangent positions, velocities and accelerations (all in velocity
/// numbering).
pub(crate) struct SnapshotCotangent<'a> {
    /// Of the tangent positions.
    pub y: &'a mut [f64],
    /// Of the velocities.
    pub v: &'a mut [f64],
    /// Of the accelerations.
    pub a: &'a mut [f64],
    /// Of the multipliers.
    pub lambda: &'a mut [f64],
    /// Of the time, through the motions that drives prescribe.
    pub time: &'a mut f64,
    /// Of the model's parameters.
    pub model: &'a mut Model<f64>,
}

impl<S: Scalar> Instant<S> {
    /// The rotation whose whole turns must be counted, if any.
    pub(crate) fn watched_rotation(&self) -> Option<&Rotation<S>> {
        match self {
            Instant::Rotation(rotation) => Some(rotation),
            Instant::Range {
                gate: Some(gate), ..
            } => Some(&gate.rotation),
            _ => None,
        }
    }

    /// Value in a snapshot. `turns` is the multiple of 2π that makes its rotation continuous.
    pub(crate) fn value(&self, at: &Snapshot<S>, turns: f64) -> S {
        match self {
            Instant::Position {
                body,
                point,
                direction,
            } => direction.dot(&at.motion(*body).point(point)),
            Instant::Velocity {
                body,
                point,
                direction,
            } => direction.dot(&at.motion(*body).point_velocity(point)),
            Instant::Acceleration {
                body,
                point,
                direction,
            } => direction.dot(&MarkerKinematics::point(&at.motion(*body), point).acceleration),
            Instant::Speed { body, point } => {
                let velocity = at.motion(*body).point_velocity(point);
                let square = velocity.dot(&velocity);
                if square.re() > REST * REST {
                    square.sqrt()
                } else {
                    S::zero()
                }
            }
            Instant::SpeedSquared { body, point } => {
                let velocity = at.motion(*body).point_velocity(point);
                velocity.dot(&velocity)
            }
            Instant::AngularVelocity { body, direction } => {
                let motion = at.motion(*body);
                direction.dot(&(motion.rotation * motion.omega))
            }
            Instant::Momentum { direction } => direction.dot(&momentum(at)),
            Instant::Energy(part) => energy(at, *part),
            Instant::StrainEnergy(body) => {
                flexible::strain_energy(&at.model.flexible[*body], &at.motions())
            }
            Instant::ShellStress {
                flexible: body,
                elements,
                rho,
            } => {
                let body = &at.model.flexible[*body];
                let ratios = flexible::stress_ratios(body, &at.motions(), elements);
                SoftMax::new(&ratios, |_| 1.0, *rho).ks
            }
            Instant::Deformation {
                flexible: body,
                form,
                ..
            } => form.value(&at.coordinates(*body)),
            Instant::LargestDeformation {
                flexible: body,
                largest,
                ..
            } => largest.value(&at.coordinates(*body)),
            Instant::AngularMomentum(momentum) => {
                momentum.value(&at.in_motion(&at.motions()), at.v)
            }
            Instant::Reaction(wrench) => {
                let (motions, of) = (at.motions(), &at.joint);
                wrench.value(&at.in_motion(&motions), (of.lambda, of.undetermined))
            }
            Instant::Slide(joint) => measures::slide(&at.model.joints[*joint], &at.motions()),
            Instant::Spring(spring) => springs::value(&at.in_motion(&at.motions()), *spring),
            Instant::Rotation(rotation) => at.rotation(rotation, turns),
            Instant::Range { projectile, gate } => {
                at.flight(projectile).range(projectile.ground) * at.openness(gate, turns)
            }
        }
    }
}

/// Linear momentum of the model in a snapshot, ground axes \[kg m/s\].
fn momentum<S: Scalar>(at: &Snapshot<S>) -> Vec3<S> {
    let motions = at.motions();
    let bodies = at.model.bodies.iter().zip(&motions);
    let own = flexible::held(at.model, &motions).momentum;
    bodies.fold(own, |sum, (body, motion)| sum + motion.velocity * body.mass)
}

/// Energy of the model in a snapshot \[J\].
pub(crate) fn energy<S: Scalar>(at: &Snapshot<S>, part: EnergyPart) -> S {
    let mut sum = S::zero();
    let motions = at.motions();
    for (body, motion) in at.model.bodies.iter().zip(&motions) {
        if part != EnergyPart::Potential {
            let linear = motion.velocity.dot(&motion.velocity) * body.mass;
            let angular = motion.omega.dot(&(body.inertia * motion.omega));
            sum += (linear + angular) * 0.5;
        }
        if part != EnergyPart::Kinetic {
            sum -= at.model.gravity.dot(&motion.position) * body.mass;
        }
    }
    let held = flexible::held(at.model, &motions);
    if part != EnergyPart::Potential {
        sum += held.kinetic;
    }
    if part != EnergyPart::Kinetic {
        sum += held.potential + loads::potential(at.model, &motions);
    }
    sum
}

impl Instant<f64> {
    /// Adds `weight` times the derivative of [`Instant::value`] to the cotangents of the snapshot
    /// and of this quantity's parameters (`own`, of the same variant).
    pub(crate) fn pull_back(
        &self,
        at: &Snapshot<f64>,
        turns: f64,
        weight: f64,
        out: &mut SnapshotCotangent,
        own: &mut Instant<f64>,
    ) {
        match (self, own) {
            (
                Instant::Position {
                    body,
                    point,
                    direction,
                },
                Instant::Position {
                    point: by_point,
                    direction: by_direction,
                    ..
                },
            ) => {
                let jet = MarkerKinematics::point(&at.motion(*body), point);
                *by_direction += jet.x * weight;
                *by_point += pull_point(at, *body, point, [direction * weight, ZERO, ZERO], out);
            }
            (
                Instant::Velocity {
                    body,
                    point,
                    direction,
                },
                Instant::Velocity {
                    point: by_point,
                    direction: by_direction,
                    ..
                },
            ) => {
                let jet = MarkerKinematics::point(&at.motion(*body), point);
                *by_direction += jet.rate * weight;
                *by_point += pull_point(at, *body, point, [ZERO, direction * weight, ZERO], out);
            }
            (
                Instant::Acceleration {
                    body,
                    point,
                    direction,
                },
                Instant::Acceleration {
                    point: by_point,
                    direction: by_direction,
                    ..
                },
            ) => {
                let jet = MarkerKinematics::point(&at.motion(*body), point);
                *by_direction += jet.acceleration * weight;
                *by_point += pull_point(at, *body, point, [ZERO, ZERO, direction * weight], out);
            }
            (
                Instant::Speed { body, point },
                Instant::Speed {
                    point: by_point, ..
                },
            ) => {
                let velocity = at.motion(*body).point_velocity(point);
                let speed = velocity.norm();
                if speed > REST {
                    let by = velocity * (weight / speed);
                    *by_point += pull_point(at, *body, point, [ZERO, by, ZERO], out);
                }
            }
            (
                Instant::SpeedSquared { body, point },
                Instant::SpeedSquared {
                    point: by_point, ..
                },
            ) => {
                let by = at.motion(*body).point_velocity(point) * (2.0 * weight);
                *by_point += pull_point(at, *body, point, [ZERO, by, ZERO], out);
            }
            (
                Instant::AngularVelocity { body, direction },
                Instant::AngularVelocity {
                    direction: by_direction,
                    ..
                },
            ) => {
                let motion = at.motion(*body);
                *by_direction += motion.rotation * motion.omega * weight;
                let own = motion.rotation.tr_mul(direction) * weight;
                let o = at.numbering.velocity(*body);
                add6(&mut out.y[o..], &ZERO, &motion.omega.cross(&own));
                add6(&mut out.v[o..], &ZERO, &own);
            }
            (
                Instant::Momentum { direction },
                Instant::Momentum {
                    direction: by_direction,
                },
            ) => {
                *by_direction += momentum(at) * weight;
                let (motions, along) = (at.motions(), direction * weight);
                for (i, (body, motion)) in at.model.bodies.iter().zip(&motions).enumerate() {
                    let o = at.numbering.velocity(i);
                    add6(&mut out.v[o..], &(along * body.mass), &ZERO);
                    out.model.bodies[i].mass += along.dot(&motion.velocity);
                }
                let of = (at.model, at.numbering);
                flexible::pull_momentum(of, &motions, &along, (out.y, out.v), out.model);
            }
            (Instant::Energy(part), _) => pull_energy(at, *part, weight, out),
            (Instant::StrainEnergy(body), _) => {
                let of = (at.model, at.numbering);
                let part = (*body, weight);
                flexible::pull_strain_energy(of, &at.motions(), part, out.y, out.model);
            }
            (
                Instant::ShellStress {
                    flexible: body,
                    elements,
                    rho,
                },
                _,
            ) => {
                let motions = at.motions();
                let ratios = flexible::stress_ratios(&at.model.flexible[*body], &motions, elements);
                let mut bar = SoftMax::new(&ratios, |_| 1.0, *rho).weights;
                bar.iter_mut().for_each(|bar| *bar *= weight);
                let of = (at.model, at.numbering);
                flexible::pull_stress_ratios(
                    of,
                    &motions,
                    (*body, elements, &bar),
                    out.y,
                    out.model,
                );
            }
            (
                Instant::Deformation {
                    flexible: body,
                    form,
                    ..
                },
                Instant::Deformation { form: by_form, .. },
            ) => {
                let q = at.coordinates(*body);
                let mut by_q = vec![0.0; q.len()];
                form.add_gradient(&q, weight, &mut by_q);
                form.pull_value(&q, weight, by_form);
                let body = &at.model.flexible[*body];
                flexible::add_coordinates(at.numbering, body, &by_q, out.y);
            }
            (
                Instant::LargestDeformation {
                    flexible: body,
                    largest,
                    ..
                },
                Instant::LargestDeformation {
                    largest: by_largest,
                    ..
                },
            ) => {
                let q = at.coordinates(*body);
                let mut by_q = vec![0.0; q.len()];
                largest.pull_back(&q, weight, &mut by_q, by_largest);
                let body = &at.model.flexible[*body];
                flexible::add_coordinates(at.numbering, body, &by_q, out.y);
            }
            (Instant::AngularMomentum(momentum), Instant::AngularMomentum(own)) => {
                let motions = at.motions();
                let here = at.in_motion(&motions);
                let state = (&mut *out.y, &mut *out.v);
                momentum.pull_back(&here, (at.v, weight), state, out.model, own);
            }
            (Instant::Reaction(wrench), Instant::Reaction(own)) => {
                let motions = at.motions();
                let mut to = JointCotangent {
                    y: Some(&mut *out.y),
                    v: None,
                    model: &mut *out.model,
                };
                let lambda = (at.joint.lambda, &mut *out.lambda);
                let here = at.in_motion(&motions);
                *out.time += wrench.pull_back(&here, lambda, weight, &mut to, own);
            }
            (Instant::Slide(joint), _) => {
                let motions = at.motions();
                let mut to = JointCotangent {
                    y: Some(&mut *out.y),
                    v: None,
                    model: &mut *out.model,
                };
                measures::pull_slide(&at.in_motion(&motions), *joint, weight, &mut to);
            }
            (Instant::Spring(spring), _) => {
                let motions = at.motions();
                let mut to = JointCotangent {
                    y: Some(&mut *out.y),
                    v: Some(&mut *out.v),
                    model: &mut *out.model,
                };
                springs::pull_back(&at.in_motion(&motions), *spring, weight, &mut to);
            }
            (Instant::Rotation(rotation), Instant::Rotation(own)) => {
                rotation.pull_back((at.numbering, at.q), weight, out.y, own);
            }
            (
                Instant::Range { projectile, gate },
                Instant::Range {
                    projectile: by_projectile,
                    gate: by_gate,
                },
            ) => {
                let flight = at.flight(projectile);
                let open = at.openness(gate, turns);
                let (by_flight, by_ground) = flight.range_derivative(projectile.ground);
                by_projectile.ground += weight * open * by_ground;
                let cot = by_flight.map(|by| weight * open * by);
                pull_flight(at, projectile, cot, out, by_projectile);
                if let (Some(gate), Some(own)) = (gate, by_gate) {
                    let rotation = at.rotation(&gate.rotation, turns);
                    let by = gate.openness_derivative(rotation) * flight.range(projectile.ground);
                    let place = (at.numbering, at.q);
                    (gate.rotation).pull_back(place, weight * by, out.y, &mut own.rotation);
                }
            }
            _ => unreachable!("a cotangent has the kind of its quantity"),
        }
    }
}

const ZERO: Vec3<f64> = Vec3::new(0.0, 0.0, 0.0);

/// Pulls cotangents of a point's position, velocity and acceleration back. Returns the cotangent of
/// the point.
fn pull_point(
    at: &Snapshot<f64>,
    body: usize,
    point: &Vec3<f64>,
    [x, rate, acceleration]: [Vec3<f64>; 3],
    out: &mut SnapshotCotangent,
) -> Vec3<f64> {
    let motion = at.motion(body);
    let by = marker::pull_back(
        &motion,
        point,
        &MarkerKinematics {
            x,
            rate,
            acceleration,
            virtual_rate: ZERO,
        },
    );
    let o = at.numbering.velocity(body);
    add6(&mut out.y[o..], &x, &by.theta);
    add6(&mut out.v[o..], &rate, &by.omega);
    add6(&mut out.a[o..], &acceleration, &by.alpha);
    by.vector
}

/// Pulls the cotangent of a flight back to the snapshot and the projectile's parameters.
pub(crate) fn pull_flight(
    at: &Snapshot<f64>,
    projectile: &Projectile<f64>,
    cot: [f64; 5],
    out: &mut SnapshotCotangent,
    own: &mut Projectile<f64>,
) {
    let motion = at.motion(projectile.body);
    let by = flight::pull_back(projectile, &motion, &at.model.gravity, cot);
    let o = at.numbering.velocity(projectile.body);
    add6(&mut out.y[o..], &by.position, &by.marker.theta);
    add6(&mut out.v[o..], &by.velocity, &by.marker.omega);
    own.point += by.marker.vector;
    own.direction += by.direction;
    out.model.gravity += by.gravity;
}

fn pull_energy(at: &Snapshot<f64>, part: EnergyPart, weight: f64, out: &mut SnapshotCotangent) {
    let gravity = at.model.gravity;
    let motions = at.motions();
    for (i, (body, motion)) in at.model.bodies.iter().zip(&motions).enumerate() {
        let o = at.numbering.velocity(i);
        let own = &mut out.model.bodies[i];
        if part != EnergyPart::Potential {
            let (velocity, omega) = (&motion.velocity, &motion.omega);
            let (momentum, spin) = (velocity * body.mass, body.inertia * omega);
            add6(&mut out.v[o..], &(momentum * weight), &(spin * weight));
            own.mass += 0.5 * weight * velocity.norm_squared();
            own.inertia += omega * omega.transpose() * (0.5 * weight);
        }
        if part != EnergyPart::Kinetic {
            add6(&mut out.y[o..], &(gravity * (-weight * body.mass)), &ZERO);
            own.mass -= weight * gravity.dot(&motion.position);
            out.model.gravity -= motion.position * (weight * body.mass);
        }
    }
    if part != EnergyPart::Kinetic {
        let (model, numbering) = (at.model, at.numbering);
        loads::pull_potential(model, numbering, &motions, weight, out.y, out.model);
    }
    let parts = match part {
        EnergyPart::Kinetic => [weight, 0.0],
        EnergyPart::Potential => [0.0, weight],
        EnergyPart::Total => [weight, weight],
    };
    let of = (at.model, at.numbering);
    flexible::pull_energies(of, &motions, parts, (out.y, out.v), out.model);
}
