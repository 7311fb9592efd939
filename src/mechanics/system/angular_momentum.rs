//! Angular momentum of the whole model about a fixed point c, along d: wᵀ M(q) v with the virtual motion w
//! of all bodies together, a turn about d through c, w = (d × (r − c), Rᵀ d).

use super::bodies::{add6, velocities_of};
use super::flexible;
use super::in_motion::InMotion;
use crate::math::{Scalar, Vec3, parameters};
use crate::model::Model;

/// Angular momentum about a point, along a direction; both in ground axes.
#[derive(Clone, Copy, Debug)]
pub struct AngularMomentum<S> {
    /// d.
    pub direction: Vec3<S>,
    /// c \[m\].
    pub about: Vec3<S>,
}

parameters!(struct AngularMomentum {; direction, about });

impl<S: Scalar> AngularMomentum<S> {
    /// w; elastic coordinates rest.
    fn motion(&self, at: &InMotion<S>) -> Vec<S> {
        let mut w = vec![S::zero(); at.numbering.velocities()];
        for (i, motion) in at.motions.iter().enumerate() {
            if !at.model.is_carrier(i) {
                let linear = self.direction.cross(&(motion.position - self.about));
                let angular = motion.rotation.tr_mul(&self.direction);
                add6(&mut w[at.numbering.velocity(i)..], &linear, &angular);
            }
        }
        w
    }

    /// Its value at velocities \[kg m²/s\].
    pub fn value(&self, at: &InMotion<S>, v: &[S]) -> S {
        let (w, momentum) = (self.motion(at), product(at, v));
        let terms = w.iter().zip(&momentum);
        terms.fold(S::zero(), |sum, (&w, &p)| sum + w * p)
    }
}

/// M(q) x.
fn product<S: Scalar>(at: &InMotion<S>, x: &[S]) -> Vec<S> {
    let mut out = vec![S::zero(); x.len()];
    for (i, body) in at.model.bodies.iter().enumerate() {
        let o = at.numbering.velocity(i);
        let (linear, angular) = velocities_of(&x[o..]);
        add6(
            &mut out[o..],
            &(linear * body.mass),
            &(body.inertia * angular),
        );
    }
    flexible::add_mass_product(at.model, at.numbering, at.motions, x, &mut out);
    out
}

impl AngularMomentum<f64> {
    /// Adds `weight` times the derivative of [`AngularMomentum::value`] to the cotangents of tangent
    /// positions, velocities, the model's parameters and its own.
    pub fn pull_back(
        &self,
        at: &InMotion<f64>,
        (v, weight): (&[f64], f64),
        (by_y, by_v): (&mut [f64], &mut [f64]),
        cot: &mut Model<f64>,
        own: &mut Self,
    ) {
        let (model, numbering) = (at.model, at.numbering);
        let mut w = self.motion(at);
        w.iter_mut().for_each(|x| *x *= weight);
        let moved = product(at, &w);
        by_v.iter_mut().zip(&moved).for_each(|(v, x)| *v += x);
        flexible::pull_mass_product((model, numbering), at.motions, (&w, v), by_y, cot);
        let momentum = product(at, v);
        for (i, motion) in at.motions.iter().enumerate() {
            let o = numbering.velocity(i);
            let ((linear, angular), body) = (velocities_of(&w[o..]), &mut cot.bodies[i]);
            body.mass += linear.dot(&motion.velocity);
            body.inertia += angular * motion.omega.transpose();
            if model.is_carrier(i) {
                continue;
            }
            // By w itself.
            let (linear, angular) = velocities_of(&momentum[o..]);
            let arm = motion.position - self.about;
            let by_arm = linear.cross(&self.direction) * weight;
            let local = motion.rotation.tr_mul(&self.direction);
            own.direction += (arm.cross(&linear) + motion.rotation * angular) * weight;
            own.about -= by_arm;
            let theta = angular.cross(&local) * weight;
            add6(&mut by_y[o..], &by_arm, &theta);
        }
    }
}
