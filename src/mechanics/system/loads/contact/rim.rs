//! A wheel on heights: the sphere of its tyre that is nearest.
//!
//! The centres of the spheres are p = c + ϱ e(φ), with e′ = a × e and the axis a. d is the distance of p from the surface and n its
//! normal there ([`super::field`]):
//!
//! ```text
//! d′(φ) = ϱ g,   g = n·e′ = 0,   g′ = ϱ e′ᵀ(∂n/∂p) e′ − n·e > 0
//! ```
//!
//! Newton's method on d finds φ from the place below the axis; its [`last_steps`], which are in the scalar, bring the derivatives.

use super::cotangent::{Cotangent, RADIUS_A, WHEEL};
use super::field::Foot;
use super::last_steps::last_steps;
use crate::math::scalar::{length, unit};
use crate::math::{Scalar, Vec3};
use crate::model::{Contact, HeightField};
use crate::system::loads::Acting;
use crate::system::loads::pull::Pulled;

/// Most steps of Newton's method; most halvings of one; the largest turn of one \[rad\].
const STEPS: usize = 60;
const HALVINGS: usize = 30;
const TURN: f64 = 0.5;

/// A fall of the distance, relative to it and the radius, that is not looked for.
const UNSEEN: f64 = 1e-15;
/// A step that is so much smaller than the one before is quadratically convergent.
const CONVERGED: f64 = 1e-4;

/// The nearest sphere of a tyre.
pub(super) struct Rim<S> {
    /// a, e and e′, in ground axes.
    axis: Vec3<S>,
    out: Vec3<S>,
    ahead: Vec3<S>,
    radius: S,
    /// g′.
    slope: S,
    /// The size of what the normal has across the axis.
    across: S,
    foot: Foot<S>,
    normal: Vec3<S>,
}

/// The heights with their axes in ground, and from their origin to the centre of the wheel.
type Ground<'a, S> = ([Vec3<S>; 3], &'a HeightField, Vec3<S>);

impl<S: Scalar> Rim<S> {
    /// The place e of a rim.
    fn at((axes, field, from): &Ground<S>, (axis, radius): (Vec3<S>, S), out: Vec3<S>) -> Self {
        let ahead = axis.cross(&out);
        let (foot, normal) = Foot::of((*axes, field), from + out * radius);
        let turned = foot.turned(&ahead);
        Self {
            slope: radius * ahead.dot(&turned) - normal.dot(&out),
            across: length(&(normal - axis * axis.dot(&normal))),
            axis,
            out,
            ahead,
            radius,
            foot,
            normal,
        }
    }

    /// g.
    fn rises(&self) -> S {
        self.normal.dot(&self.ahead)
    }

    /// The nearest place of a wheel with this axis and radius, in body axes, and the normal in ground axes.
    pub(super) fn of(
        (axis, radius): (&Vec3<S>, S),
        (axes, field): (&[Vec3<S>; 3], &HeightField),
        at: &Acting<S>,
    ) -> (Self, Vec3<S>) {
        let axis = at.a.motion.rotation * axis;
        let axes = axes.each_ref().map(|own| at.b.motion.rotation * own);
        let ground = (axes, field, at.a.point() - at.b.point());
        let real = |v: &Vec3<S>| v.map(|x| x.re());
        let seen = (ground.0.each_ref().map(real), field, real(&ground.2));
        let e = lowest(&seen, (real(&axis), radius.re())).map(S::from);
        let start = Self::at(&ground, (axis, radius), unit(e - axis * axis.dot(&e)));
        let now = last_steps(start, |now| {
            let turn = -(now.rises() / now.slope);
            let (sin, cos) = turn.sin_cos();
            let next = now.out * cos + now.ahead * sin;
            let finite = next.iter().all(|x| x.is_finite());
            finite.then(|| {
                let next = Self::at(&ground, (axis, radius), next);
                (next, turn.re().abs())
            })
        });
        let normal = now.normal;
        (now, normal)
    }

    pub(super) fn distance(&self) -> S {
        self.foot.distance()
    }

    /// The size of what the normal has across the axis; zero for a wheel that lies.
    pub(super) fn across(&self) -> S {
        self.across
    }

    /// From the centre of the wheel to that of the sphere.
    pub(super) fn arm(&self) -> Vec3<S> {
        self.out * self.radius
    }

    /// Pulls the cotangents of δ, n and z back. Returns those of the centre of the wheel from the heights' origin, and of its place.
    pub(super) fn pull(
        &self,
        (contact, own): (&Contact<S>, &Vec3<S>),
        at: &Acting<S>,
        cot: &Cotangent<S>,
        pulled: &mut Pulled<S>,
    ) -> Vec3<S> {
        let by_normal = cot.normal - cot.place * contact.radius;
        pulled.scalars[RADIUS_A] += cot.penetration - self.normal.dot(&cot.place);
        // How all changes with φ, which g = 0 keeps.
        let by_centre = self.foot.by_centre(cot.penetration, &by_normal) + cot.place;
        let by_zero = -(self.radius * self.ahead.dot(&by_centre) / self.slope);
        let by_normal = by_normal + self.ahead * by_zero;
        let by_from = self
            .foot
            .pull(contact, at, (cot.penetration, &by_normal), pulled);
        let by_centre = by_from + cot.place;
        pulled.scalars[WHEEL] += self.out.dot(&by_centre);
        // e and e′ turn with the axis.
        let (by_out, by_ahead) = (by_centre * self.radius, self.normal * by_zero);
        let by_axis = -(self.out * self.axis.dot(&by_out) + self.ahead * self.axis.dot(&by_ahead));
        let local = at.a.motion.rotation.tr_mul(&by_axis);
        pulled.a.theta += own.cross(&local);
        pulled.direction += local;
        by_from
    }
}

/// The place e of the tyre that is nearest.
fn lowest(ground: &Ground<f64>, (axis, radius): (Vec3<f64>, f64)) -> Vec3<f64> {
    let up = ground.0[2];
    let mut across = up - axis * axis.dot(&up);
    if across.norm() <= f64::EPSILON {
        across = ground.0[0] - axis * axis.dot(&ground.0[0]);
    }
    let mut now = Rim::at(ground, (axis, radius), -across.normalize());
    let mut last = 0.0;
    for _ in 0..STEPS {
        let rises = now.rises();
        let fall = 0.5 * radius * rises * rises / now.slope;
        if now.slope > 0.0 && fall <= UNSEEN * (radius + now.distance().abs()) {
            break;
        }
        // Where the distance is not convex, a turn downwards.
        let turn = match now.slope > 0.0 {
            true => (-rises / now.slope).clamp(-TURN, TURN),
            false => -TURN * rises.signum(),
        };
        let mut turn = turn;
        let mut better = None;
        for _ in 0..HALVINGS {
            let (sin, cos) = turn.sin_cos();
            let next = now.out * cos + now.ahead * sin;
            let next = Rim::at(ground, (axis, radius), next.normalize());
            if next.distance() < now.distance() {
                better = Some(next);
                break;
            }
            turn *= 0.5;
        }
        let Some(next) = better else {
            break;
        };
        now = next;
        if turn.abs() <= CONVERGED * last {
            break;
        }
        last = turn.abs();
    }
    now.out
}
