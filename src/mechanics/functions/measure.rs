//! Values of instant quantities, and their exact derivatives.

use super::instant::{Instant, Projectile};
use super::snapshot::{Snapshot, SnapshotCotangent};
use super::turning::Rotation;
use super::{energy, flight};
use crate::math::soft_max::SoftMax;
use crate::math::{Scalar, Vec3};
use crate::system::bodies::add6;
use crate::system::joints::JointCotangent;
use crate::system::loads::{measured, work};
use crate::system::marker::{self, MarkerKinematics};
use crate::system::{BodyMotion, flexible, measures};

/// A point is at rest below this speed \[m/s\]. There the derivative of its speed is set to zero.
const REST: f64 = 1e-25;

/// The von Mises stresses of elements of a flexible body, relative to the yield stress, aggregated with ρ.
fn stress<S: Scalar>(
    at: &Snapshot<S>,
    motions: &[BodyMotion<S>],
    (body, elements, rho): (usize, &[usize], f64),
) -> SoftMax<S> {
    let body = &at.model.flexible[body];
    let ratios = flexible::stress_ratios(body, motions, elements);
    SoftMax::new(&ratios, |_| S::one(), rho)
}

impl<S: Scalar> Instant<S> {
    /// The rotation whose whole turns must be counted, if any.
    pub fn watched_rotation(&self) -> Option<&Rotation<S>> {
        match self {
            Instant::Rotation(rotation) => Some(rotation),
            Instant::Range {
                gate: Some(gate), ..
            } => Some(&gate.rotation),
            _ => None,
        }
    }

    /// The rotation of [`Instant::watched_rotation`], to be changed.
    pub fn watched_rotation_mut(&mut self) -> Option<&mut Rotation<S>> {
        match self {
            Instant::Rotation(rotation) => Some(rotation),
            Instant::Range {
                gate: Some(gate), ..
            } => Some(&mut gate.rotation),
            _ => None,
        }
    }

    /// Value in a snapshot, and without aggregation over points: their largest value. See [`Instant::value`].
    pub fn value_and_largest(&self, at: &Snapshot<S>, turns: f64) -> (S, S) {
        match self {
            Instant::ShellStress {
                flexible,
                elements,
                rho,
            } => {
                let soft = stress(at, &at.motions(), (*flexible, elements, *rho));
                (soft.ks, S::from(soft.maximum))
            }
            Instant::LargestDeformation {
                flexible: body,
                unknowns,
                largest,
                ..
            } => largest.value_and_largest(&at.unknowns(*body, unknowns.as_deref())),
            _ => {
                let value = self.value(at, turns);
                (value, value)
            }
        }
    }

    /// Value in a snapshot. `turns` is the multiple of 2π that makes its rotation continuous.
    pub fn value(&self, at: &Snapshot<S>, turns: f64) -> S {
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
            Instant::Momentum { direction } => direction.dot(&energy::momentum(at)),
            Instant::Energy(part) => energy::energy(at, *part),
            Instant::StrainEnergy(body) => {
                flexible::strain_energy(&at.model.flexible[*body], &at.motions())
            }
            Instant::ShellStress {
                flexible,
                elements,
                rho,
            } => stress(at, &at.motions(), (*flexible, elements, *rho)).ks,
            Instant::Deformation {
                flexible: body,
                unknowns,
                form,
                ..
            } => form.value(&at.unknowns(*body, unknowns.as_deref())),
            Instant::LargestDeformation {
                flexible: body,
                unknowns,
                largest,
                ..
            } => largest.value(&at.unknowns(*body, unknowns.as_deref())),
            Instant::AngularMomentum(momentum) => {
                momentum.value(&at.in_motion(&at.motions()), at.v)
            }
            Instant::Reaction(wrench) => {
                let (motions, of) = (at.motions(), &at.reactions);
                wrench.value(&at.in_motion(&motions), (of.lambda, of.undetermined))
            }
            Instant::Felt {
                body,
                point,
                direction,
            } => {
                let motion = at.motion(*body);
                let a = MarkerKinematics::point(&motion, point).acceleration;
                direction.dot(&motion.rotation.tr_mul(&a))
            }
            Instant::Seen(seen) => seen.value(at),
            Instant::Power(load) => load.map_or_else(S::zero, |load| {
                work::power(&at.in_motion(&at.motions()), load)
            }),
            Instant::Vibration(of) => of.value(at),
            Instant::JointRate { joint, dof } => {
                work::joint_rate(&at.in_motion(&at.motions()), (*joint, *dof))
            }
            Instant::Slide(joint) => measures::slide(&at.model.joints[*joint], &at.motions()),
            Instant::Load(of) => measured::value(&at.in_motion(&at.motions()), *of),
            Instant::Rotation(rotation) => at.rotation(rotation, turns),
            Instant::Range { projectile, gate } => {
                at.flight(projectile).range(projectile.ground) * at.openness(gate, turns)
            }
        }
    }
}

impl Instant<f64> {
    /// Adds `weight` times the derivative of [`Instant::value`] to the cotangents of the snapshot
    /// and of this quantity's parameters (`own`, of the same variant).
    pub fn pull_back(
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
                *by_direction += energy::momentum(at) * weight;
                energy::pull_momentum(at, &(direction * weight), out);
            }
            (Instant::Energy(part), _) => energy::pull_energy(at, *part, weight, out),
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
                let mut bar = stress(at, &motions, (*body, elements, *rho)).weights;
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
                    unknowns,
                    form,
                    ..
                },
                Instant::Deformation { form: by_form, .. },
            ) => {
                let unknowns = unknowns.as_deref();
                let q = at.unknowns(*body, unknowns);
                let mut by_q = vec![0.0; q.len()];
                form.add_gradient(&q, weight, &mut by_q);
                form.pull_value(&q, weight, by_form);
                let body = &at.model.flexible[*body];
                flexible::add_unknowns(at.numbering, (body, unknowns), &by_q, out.y);
            }
            (
                Instant::LargestDeformation {
                    flexible: body,
                    unknowns,
                    largest,
                    ..
                },
                Instant::LargestDeformation {
                    largest: by_largest,
                    ..
                },
            ) => {
                let unknowns = unknowns.as_deref();
                let q = at.unknowns(*body, unknowns);
                let mut by_q = vec![0.0; q.len()];
                largest.pull_back(&q, weight, &mut by_q, by_largest);
                let body = &at.model.flexible[*body];
                flexible::add_unknowns(at.numbering, (body, unknowns), &by_q, out.y);
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
                let lambda = (at.reactions.lambda, &mut out.reactions.lambda[..]);
                let here = at.in_motion(&motions);
                *out.time += wrench.pull_back(&here, lambda, weight, &mut to, own);
            }
            (
                Instant::Felt {
                    body,
                    point,
                    direction,
                },
                Instant::Felt {
                    point: by_point,
                    direction: by_direction,
                    ..
                },
            ) => {
                let motion = at.motion(*body);
                let a = MarkerKinematics::point(&motion, point).acceleration;
                let own = motion.rotation.tr_mul(&a);
                *by_direction += own * weight;
                let by = motion.rotation * (direction * weight);
                *by_point += pull_point(at, *body, point, [ZERO, ZERO, by], out);
                let turn = (direction * weight).cross(&own);
                add6(&mut out.y[at.numbering.velocity(*body)..], &ZERO, &turn);
            }
            (Instant::Seen(seen), Instant::Seen(own)) => seen.pull_back(at, weight, out, own),
            (Instant::Vibration(of), _) => of.pull_back(at, weight, out),
            (Instant::Power(None), _) => {}
            (Instant::Power(Some(load)), _) => {
                let motions = at.motions();
                let mut to = out.of_states();
                let here = at.in_motion(&motions);
                let by_time = work::pull_power(&here, *load, weight, &mut to);
                *out.time += by_time;
            }
            (Instant::JointRate { joint, dof }, _) => {
                let motions = at.motions();
                let here = at.in_motion(&motions);
                work::pull_joint_rate(&here, (*joint, *dof), weight, &mut out.of_states());
            }
            (Instant::Slide(joint), _) => {
                let motions = at.motions();
                let here = at.in_motion(&motions);
                measures::pull_slide(&here, *joint, weight, &mut out.of_states());
            }
            (Instant::Load(of), _) => {
                let motions = at.motions();
                let here = at.in_motion(&motions);
                let by_time = measured::pull_back(&here, *of, weight, &mut out.of_states());
                *out.time += by_time;
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
pub(super) fn pull_point(
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
pub fn pull_flight(
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
