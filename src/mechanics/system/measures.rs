//! Quantities of joints for functions: reactions and slides, with their derivatives.
//!
//! The joint acts on body A with −Gᵀλ, and on body B with the opposite. A component of its force along d,
//! and of its moment about a point P along d, is the power of the reaction in a virtual motion w of body A
//! alone, which a common motion of both bodies cannot change:
//!
//! ```text
//! ∓ λᵀ G(q) w,     force: w = (d, 0),     moment: w = (d × (r_A − P), R_Aᵀ d)
//! ```
//!
//! with − for body A and + for body B. P is the joint's point on the body that it acts on.

use super::bodies::BodyMotion;
use super::constraint::{self, RowGradient, SideCotangent};
use super::in_motion::InMotion;
use super::joints::{self, JointCotangent};
use super::rows::RowCotangent;
use super::side::{JointSide, sides};
use crate::math::{Mat3, Scalar, Vec3, parameters};
use crate::model::{Axes, ConstraintRow, Joint};

/// The row whose value is the displacement of body A against body B along the axis.
const SLIDE: ConstraintRow = ConstraintRow::Sliding { a: 2 };

/// Above this size multipliers that move no body change a reaction; a redundant row has 1.
const SHARED: f64 = 1e-8;

/// A body of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Body A.
    A,
    /// Body B, or ground.
    B,
}

/// Kind of component of a reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrenchPart {
    /// The force \[N\].
    Force,
    /// The moment about the joint's point on the body that it acts on \[N m\].
    Moment,
}

/// A component of the reaction of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Wrench<S> {
    /// The joint.
    pub joint: usize,
    /// The body that it acts on.
    pub on: End,
    /// Force or moment.
    pub part: WrenchPart,
    /// Axes of the direction: of ground, or of body A.
    pub axes: Axes,
    /// The direction, used as it is given.
    pub direction: Vec3<S>,
}

parameters!(struct Wrench { joint, on, part, axes; direction });

/// The virtual motion of body A whose power a reaction is measured by.
struct Virtual<S> {
    /// d, ground axes.
    direction: Vec3<S>,
    /// r_A − P, ground axes; of a moment.
    arm: Vec3<S>,
    velocity: Vec3<S>,
    omega: Vec3<S>,
}

impl<S: Scalar> Wrench<S> {
    /// The side with the joint's point on the body, which a drive does not move on it.
    fn side<'a>(
        &self,
        joint: &Joint<S>,
        (a, b): (&JointSide<'a, S>, &JointSide<'a, S>),
    ) -> JointSide<'a, S> {
        match self.on {
            End::A => a.clone(),
            End::B => JointSide::fixed(b.motion, joint.frame_b),
        }
    }

    fn virtual_motion(&self, a: &JointSide<S>, point: Vec3<S>) -> Virtual<S> {
        let rotation = &a.motion.rotation;
        let direction = match self.axes {
            Axes::Ground => self.direction,
            Axes::Body => rotation * self.direction,
        };
        let none = Vec3::zeros();
        match self.part {
            WrenchPart::Force => Virtual {
                direction,
                arm: none,
                velocity: direction,
                omega: none,
            },
            WrenchPart::Moment => {
                let arm = a.motion.position - point;
                Virtual {
                    direction,
                    arm,
                    velocity: direction.cross(&arm),
                    omega: rotation.tr_mul(&direction),
                }
            }
        }
    }

    fn sign(&self) -> f64 {
        match self.on {
            End::A => -1.0,
            End::B => 1.0,
        }
    }

    /// Its value, with the multipliers λ of the rows of its joint. NaN if it depends on multipliers
    /// that the motion does not determine.
    pub fn value(&self, at: &InMotion<S>, (lambda, undetermined): (&[S], &[Vec<f64>])) -> S {
        let joint = &at.model.joints[self.joint];
        let ground = BodyMotion::ground();
        let (a, b) = sides(joint, at.motions, &ground, at.time);
        let w = self.virtual_motion(&a, self.side(joint, (&a, &b)).point());
        let powers = joint
            .rows()
            .map(|row| along(&constraint::gradient(row, &a, &b), &w));
        let powers: Vec<S> = powers.collect();
        let most = powers.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
        let free = |own: &Vec<f64>| {
            let all = own.iter().zip(&powers);
            all.map(|(l, x)| l * x.re()).sum::<f64>().abs() > SHARED * most
        };
        if undetermined.iter().any(free) {
            return S::from(f64::NAN);
        }
        let all = powers.iter().zip(lambda);
        all.fold(S::zero(), |sum, (&x, &l)| sum + x * l) * self.sign()
    }
}

fn along<S: Scalar>(g: &RowGradient<S>, w: &Virtual<S>) -> S {
    g.force.dot(&w.velocity) + g.torque_a.dot(&w.omega)
}

impl Wrench<f64> {
    /// Adds `weight` times the derivative of [`Wrench::value`]: in the multipliers of the joint's rows, in
    /// positions and parameters (`out`), and in the direction (`own`). Returns the derivative in time.
    pub fn pull_back(
        &self,
        at: &InMotion<f64>,
        (lambda, by_lambda): (&[f64], &mut [f64]),
        weight: f64,
        out: &mut JointCotangent,
        own: &mut Self,
    ) -> f64 {
        let joint = &at.model.joints[self.joint];
        let ground = BodyMotion::ground();
        let (a, b) = sides(joint, at.motions, &ground, at.time);
        let w = self.virtual_motion(&a, self.side(joint, (&a, &b)).point());
        let weight = weight * self.sign();
        let (mut force, mut torque) = (Vec3::zeros(), Vec3::zeros());
        for ((row, &l), by) in joint.rows().zip(lambda).zip(by_lambda) {
            let g = constraint::gradient(row, &a, &b);
            *by += weight * along(&g, &w);
            force += g.force * (weight * l);
            torque += g.torque_a * (weight * l);
        }
        let moving = BodyMotion {
            virtual_velocity: w.velocity,
            virtual_omega: w.omega,
            ..*a.motion
        };
        let virtually = JointSide {
            motion: &moving,
            ..a.clone()
        };
        let cot = |i: usize| RowCotangent {
            value: 0.0,
            rate: 0.0,
            acceleration: 0.0,
            virtual_rate: weight * lambda[i],
        };
        let (mut by_a, mut by_b) = constraint::pull_back(joint.rows(), cot, &virtually, &b);
        let rotation = &a.motion.rotation;
        let mut direction = force;
        if self.part == WrenchPart::Moment {
            direction = w.arm.cross(&force) + rotation * torque;
            by_a.theta += torque.cross(&w.omega);
            let arm = force.cross(&w.direction);
            by_a.position += arm;
            let side = self.side(joint, (&a, &b));
            let own = &mut out.model.joints[self.joint];
            let (by, frame) = match self.on {
                // A point of a flexible body moves with it.
                End::A => (&mut by_a, None),
                End::B => (&mut by_b, Some(&mut own.frame_b)),
            };
            let local = pull_point(&side, &-arm, by);
            frame.unwrap_or(&mut by.frame).point += local;
        }
        match self.axes {
            Axes::Ground => own.direction += direction,
            Axes::Body => {
                let local = rotation.tr_mul(&direction);
                by_a.theta += self.direction.cross(&local);
                own.direction += local;
            }
        }
        joints::give(at, self.joint, (&by_a, &by_b), out)
    }
}

/// Adds the pull-back of a cotangent of the joint's point on a body by its motion; that by the place on it.
fn pull_point(side: &JointSide<f64>, x: &Vec3<f64>, by: &mut SideCotangent<f64>) -> Vec3<f64> {
    let local = Mat3::tr_mul(&side.motion.rotation, x);
    by.position += x;
    by.theta += side.frame.point.cross(&local);
    local
}

/// The sides of a joint without its drives.
pub(super) fn undriven<'a, S: Scalar>(
    joint: &Joint<S>,
    motions: &'a [BodyMotion<S>],
    ground: &'a BodyMotion<S>,
) -> (JointSide<'a, S>, JointSide<'a, S>) {
    let motion_b = joint.body_b.map_or(ground, |body| &motions[body]);
    (
        JointSide::fixed(&motions[joint.body_a], joint.frame_a),
        JointSide::fixed(motion_b, joint.frame_b),
    )
}

/// Displacement of body A against body B along the axis of a joint, zero where their points meet \[m\].
pub fn slide<S: Scalar>(joint: &Joint<S>, motions: &[BodyMotion<S>]) -> S {
    let ground = BodyMotion::ground();
    let (a, b) = undriven(joint, motions, &ground);
    constraint::value(SLIDE, &a, &b)
}

/// Adds `weight` times the derivative of [`slide`] of joint `j`.
pub fn pull_slide(at: &InMotion<f64>, j: usize, weight: f64, out: &mut JointCotangent) {
    let joint = &at.model.joints[j];
    let ground = BodyMotion::ground();
    let (a, b) = undriven(joint, at.motions, &ground);
    let cot = RowCotangent {
        value: weight,
        rate: 0.0,
        acceleration: 0.0,
        virtual_rate: 0.0,
    };
    let (by_a, by_b) = constraint::pull_back(std::iter::once(SLIDE), |_| cot, &a, &b);
    joints::give_to_states(at, joint, (&by_a, &by_b), out);
    let own = &mut out.model.joints[j];
    own.frame_a.add(&by_a.frame);
    own.frame_b.add(&by_b.frame);
}
