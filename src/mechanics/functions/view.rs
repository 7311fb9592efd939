//! A point as seen from another body: in the axes of that body, relative to a point of it.
//!
//! With l = R_Bᵀ (x_A − x_B) and m = R_Bᵀ (ẋ_A − ẋ_B):
//!
//! ```text
//! position   dᵀ l
//! velocity   dᵀ l̇ = dᵀ (m − ω_B × l)
//! distance   |x_A − x_B|
//! ```
//!
//! On ground R_B = 1 and x_B is fixed.

use super::measure::pull_point;
use super::seen::{Seen, SeenPart};
use super::snapshot::{Snapshot, SnapshotCotangent};
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::system::BodyMotion;
use crate::system::bodies::add6;

/// Both points, and what body B sees.
struct View<S> {
    /// x_A − x_B, ground axes.
    apart: Vec3<S>,
    /// l.
    position: Vec3<S>,
    /// m.
    rate: Vec3<S>,
    /// The motion of body B.
    b: BodyMotion<S>,
}

impl<S: Scalar> View<S> {
    fn velocity(&self) -> Vec3<S> {
        self.rate - self.b.omega.cross(&self.position)
    }
}

impl<S: Scalar> Seen<S> {
    fn view(&self, at: &Snapshot<S>) -> View<S> {
        let a = at.motion(self.body);
        let b = self
            .from
            .map_or_else(BodyMotion::ground, |body| at.motion(body));
        let apart = a.point(&self.point) - b.point(&self.eye);
        let rate = a.point_velocity(&self.point) - b.point_velocity(&self.eye);
        View {
            apart,
            position: b.rotation.tr_mul(&apart),
            rate: b.rotation.tr_mul(&rate),
            b,
        }
    }

    /// Its value.
    pub(super) fn value(&self, at: &Snapshot<S>) -> S {
        let view = self.view(at);
        match self.part {
            SeenPart::Position => self.direction.dot(&view.position),
            SeenPart::Velocity => self.direction.dot(&view.velocity()),
            SeenPart::Distance => match view.apart.iter().all(|x| x.re() == 0.0) {
                true => S::zero(),
                false => length(&view.apart),
            },
        }
    }
}

impl Seen<f64> {
    /// Adds `weight` times the derivative of [`Seen::value`] to states and to its parameters.
    pub(super) fn pull_back(
        &self,
        at: &Snapshot<f64>,
        weight: f64,
        out: &mut SnapshotCotangent,
        own: &mut Self,
    ) {
        let view = self.view(at);
        let d = self.direction * weight;
        let none = Vec3::zeros();
        // Cotangents of l and m, and those of ω_B and of the turn of B.
        let (by_position, by_rate, by_omega) = match self.part {
            SeenPart::Position => {
                own.direction += view.position * weight;
                (d, none, none)
            }
            SeenPart::Velocity => {
                own.direction += view.velocity() * weight;
                let omega = view.b.omega;
                (-d.cross(&omega), d, d.cross(&view.position))
            }
            SeenPart::Distance => {
                let distance = view.apart.norm();
                if distance == 0.0 {
                    return;
                }
                (view.position * (weight / distance), none, none)
            }
        };
        let turn = by_position.cross(&view.position) + by_rate.cross(&view.rate);
        let [x, rate] = [by_position, by_rate].map(|by| view.b.rotation * by);
        own.point += pull_point(at, self.body, &self.point, [x, rate, none], out);
        match self.from {
            Some(body) => {
                own.eye += pull_point(at, body, &self.eye, [-x, -rate, none], out);
                let o = at.numbering.velocity(body);
                add6(&mut out.y[o..], &none, &turn);
                add6(&mut out.v[o..], &none, &by_omega);
            }
            None => own.eye -= x,
        }
    }
}
