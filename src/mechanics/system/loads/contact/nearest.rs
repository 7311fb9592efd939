//! A sphere, or the axis of a capsule, against a sphere, capsule or box: the nearest points.
//!
//! With the centre p of A, c that of B, the half a of A's capsule and the halves b_i of B's capsule or box, which are across each
//! other:
//!
//! ```text
//! x = Y − Σ b_i s_i,   Y = p − c + a t,   s_i = Y·b_i / b_i² within ±1
//! d² = xᵀx + η t² with the t in ±1 that makes it least, so a·x + η t = 0 between the ends;   n = x / d
//! η = w (R_A + R_B) / 4 for capsules and boxes, 0 for spheres
//! ```
//!
//! η crowns A's capsule: its ends are thinner by η/2d, an eighth of the width w of the onset, so axes that are nearly parallel touch at
//! one place which moves smoothly from one end to the other. As d is the least over t, the force is the gradient of its energy. Within
//! a box, where all s_i are free, d = n·Y − |b| < 0 is that to the nearest face.

use super::cotangent::{Cotangent, RADIUS_A, RADIUS_B, WIDTH, pull_direction};
use crate::math::{Scalar, Vec3, scalar::length};
use crate::model::{Contact, Shape, Surface};
use crate::system::loads::Acting;
use crate::system::loads::pull::{Pulled, pull_point};

/// η of w (R_A + R_B).
const CROWN: f64 = 0.25;

/// A fraction of a half, and whether it is between the ends.
type Part<S> = (S, bool);

/// The nearest points.
pub(super) struct Nearest<S> {
    /// Y.
    y: Vec3<S>,
    x: Vec3<S>,
    distance: S,
    /// R_A / (R_A + R_B).
    share: S,
    /// s_i.
    along: [Part<S>; 3],
    /// a, t and η of a capsule of A.
    own: Option<(Vec3<S>, Part<S>, S)>,
    /// The nearest face of a box that Y is in.
    face: Option<usize>,
}

/// A number within ±1.
fn clamped<S: Scalar>(free: S) -> Part<S> {
    match free.re() {
        s if s >= 1.0 => (S::one(), false),
        s if s <= -1.0 => (-S::one(), false),
        _ => (free, true),
    }
}

/// The radius R_B.
fn radius_b<S: Scalar>(surface: &Surface<S>) -> S {
    match surface {
        Surface::Sphere { radius }
        | Surface::Capsule { radius, .. }
        | Surface::Box { radius, .. } => *radius,
        Surface::Plane { .. } | Surface::Field { .. } => S::zero(),
    }
}

/// t of A's axis from y = p − c, in ground axes.
fn own_part<S: Scalar>((a, crown): (&Vec3<S>, S), y: &Vec3<S>, halves: &[Vec3<S>]) -> Part<S> {
    let real = |v: &Vec3<S>| v.map(|x| x.re());
    let (a0, y0) = (real(a), real(y));
    let all: Vec<Vec3<f64>> = halves.iter().map(real).collect();
    let slope = |t: f64| {
        let at = y0 + a0 * t;
        let mut x = at;
        for b in &all {
            x -= b * (at.dot(b) / b.dot(b)).clamp(-1.0, 1.0);
        }
        a0.dot(&x) + crown.re() * t
    };
    // The slope is straight between the places where some s_i comes to an end.
    let mut places = vec![-1.0, 1.0];
    for b in &all {
        let by = a0.dot(b) / b.dot(b);
        let at = |end: f64| (end - y0.dot(b) / b.dot(b)) / by;
        places.extend([-1.0, 1.0].map(at).iter().filter(|t| t.abs() < 1.0));
    }
    places.sort_by(f64::total_cmp);
    let rises = places.partition_point(|&t| slope(t) < 0.0);
    if rises == 0 {
        return (-S::one(), false);
    }
    if rises == places.len() {
        return (S::one(), false);
    }
    let middle = y0 + a0 * (0.5 * (places[rises - 1] + places[rises]));
    let (mut base, mut by) = (*y, *a);
    let mut free = 0;
    for b in halves {
        let square = b.dot(b);
        let part = middle.dot(&real(b)) / square.re();
        if part.abs() < 1.0 {
            base -= b * (b.dot(y) / square);
            by -= b * (b.dot(a) / square);
            free += 1;
        } else {
            base -= b * S::from(part.signum());
        }
    }
    if free == 3 {
        // Within a box x vanishes all along.
        return (S::zero(), false);
    }
    let t = -(a.dot(&base) / (a.dot(&by) + crown));
    (t, true)
}

impl<S: Scalar> Nearest<S> {
    /// The nearest points, and the normal.
    pub(super) fn of(contact: &Contact<S>, at: &Acting<S>) -> (Self, Vec3<S>) {
        let (zero, one) = (S::zero(), S::one());
        let (p, o) = (at.a.point(), at.b.point());
        let mut y = p - o;
        let halves = contact.surface.directions();
        let turned = |direction: &Vec3<S>| at.b.motion.rotation * direction;
        let own = match &contact.shape {
            Shape::Capsule { half, .. } => {
                let a = at.a.motion.rotation * half;
                let turned: Vec<Vec3<S>> = halves.iter().map(turned).collect();
                let crown = match halves.is_empty() {
                    true => zero,
                    false => {
                        contact.law.width * (contact.radius + radius_b(&contact.surface)) * CROWN
                    }
                };
                let part = own_part((&a, crown), &y, &turned);
                y += a * part.0;
                Some((a, part, crown))
            }
            Shape::Sphere | Shape::Wheel { .. } => None,
        };
        let mut along = [(zero, false); 3];
        let mut x = y;
        for (half, along) in halves.iter().zip(&mut along) {
            let a = turned(half);
            *along = clamped(y.dot(&a) / a.dot(&a));
            x -= a * along.0;
        }
        let sum = contact.radius + radius_b(&contact.surface);
        let mut found = Self {
            y,
            x,
            distance: zero,
            // A point and sharp edges have no radius.
            share: match sum.re() {
                0.0 => zero,
                _ => contact.radius / sum,
            },
            along,
            own,
            face: None,
        };
        if let Surface::Box { halves, .. } = &contact.surface
            && along.iter().all(|own| own.1)
        {
            let depth = |i: &usize| (one.re() - along[*i].0.re().abs()) * length(&halves[*i]).re();
            let nearest = (0..3).min_by(|i, k| depth(i).total_cmp(&depth(k)));
            if let Some(i) = nearest {
                let size = length(&halves[i]);
                let normal = turned(&halves[i]) * (S::from(along[i].0.re().signum()) / size);
                found.distance = normal.dot(&y) - size;
                found.x = normal * found.distance;
                found.face = nearest;
                return (found, normal);
            }
        }
        found.distance = match found.own {
            None => length(&x),
            Some((_, (t, _), crown)) => (x.dot(&x) + crown * t * t).sqrt(),
        };
        let normal = x / found.distance;
        (found, normal)
    }

    pub(super) fn distance(&self) -> S {
        self.distance
    }

    /// δ.
    pub(super) fn penetration(&self, contact: &Contact<S>) -> S {
        contact.radius + radius_b(&contact.surface) - self.distance
    }

    /// Whether the capsule is crowned where it touches.
    pub(super) fn is_crowned(&self) -> bool {
        self.face.is_none() && self.own.is_some()
    }

    /// nᵀn.
    pub(super) fn square(&self, normal: &Vec3<S>) -> S {
        match self.is_crowned() {
            true => normal.dot(normal),
            false => S::one(),
        }
    }

    /// z.
    pub(super) fn place(&self, at: &Acting<S>) -> Vec3<S> {
        let mut p = at.a.point();
        if let Some((a, (t, _), _)) = self.own {
            p += a * t;
        }
        p - self.x * self.share
    }

    /// Pulls the cotangents of δ, n and z back.
    pub(super) fn pull(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        (n, cot): (&Vec3<S>, &Cotangent<S>),
        out: &mut Pulled<S>,
    ) {
        let radius_b = radius_b(&contact.surface);
        out.scalars[RADIUS_A] += cot.penetration;
        out.scalars[RADIUS_B] += cot.penetration;
        let sum = contact.radius + radius_b;
        if sum.re() != 0.0 {
            // z = p − x R_A / R.
            let by_share = -self.x.dot(&cot.place) / (sum * sum);
            out.scalars[RADIUS_A] += by_share * radius_b;
            out.scalars[RADIUS_B] -= by_share * contact.radius;
        }
        let (by_y, by_distance) = match (self.face, &contact.surface) {
            (Some(i), Surface::Box { halves, .. }) => {
                let by_y = self.pull_face(at, (i, &halves[i]), (n, cot), out);
                (by_y, S::zero())
            }
            _ => {
                let along = n.dot(&cot.normal);
                let across = cot.normal - n * along;
                let by_x = across / self.distance - n * cot.penetration - cot.place * self.share;
                let by_distance = -cot.penetration - along / self.distance;
                (self.pull_x(contact, at, by_x, out), by_distance)
            }
        };
        let by_y = self.pull_own(contact, at, (by_y, by_distance, cot.place), out);
        let none = Vec3::zeros();
        pull_point(&at.a, [by_y + cot.place, none], &mut out.a);
        pull_point(&at.b, [-by_y, none], &mut out.b);
    }

    /// Pulls the cotangent of x back to the halves of B. Returns that of Y.
    fn pull_x(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        by_x: Vec3<S>,
        out: &mut Pulled<S>,
    ) -> Vec3<S> {
        let mut by_y = by_x;
        let halves = contact.surface.directions().iter().zip(self.along);
        for (i, (half, (s, between))) in halves.enumerate() {
            let a = at.b.motion.rotation * half;
            let mut by_a = -(by_x * s);
            if between {
                // x has −a s, s = Y·a / a·a.
                let part = a.dot(&by_x) / a.dot(&a);
                by_a -= (self.y - a * (s * 2.0)) * part;
                by_y -= a * part;
            }
            pull_direction(&at.b, (i, half), by_a, out);
        }
        by_y
    }

    /// Pulls the cotangents of the face of a box that Y is in back. Returns that of Y.
    fn pull_face(
        &self,
        at: &Acting<S>,
        (i, half): (usize, &Vec3<S>),
        (n, cot): (&Vec3<S>, &Cotangent<S>),
        out: &mut Pulled<S>,
    ) -> Vec3<S> {
        // δ = R − d, z = p − n d R_A / R.
        let by_distance = -cot.penetration - n.dot(&cot.place) * self.share;
        let by_normal =
            cot.normal - cot.place * (self.distance * self.share) + self.y * by_distance;
        let size = length(half);
        let sign = S::from(self.along[i].0.re().signum());
        let across = by_normal - n * n.dot(&by_normal);
        let by_half = across * (sign / size) - n * (sign * by_distance);
        pull_direction(&at.b, (i, half), by_half, out);
        n * by_distance
    }

    /// Pulls the cotangents of Y and z back through the place on A's capsule. Returns that of Y where it stays on the axis.
    fn pull_own(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        (mut by_y, by_distance, by_place): (Vec3<S>, S, Vec3<S>),
        out: &mut Pulled<S>,
    ) -> Vec3<S> {
        let (Some((a, (t, between), crown)), Shape::Capsule { half, .. }) =
            (self.own, &contact.shape)
        else {
            return by_y;
        };
        let by_end = by_y + by_place;
        let mut by_a = by_end * t;
        // d has ½ η t² / d.
        let by_square = by_distance * t / self.distance;
        let mut by_crown = by_square * t * 0.5;
        if between {
            let mut free = a;
            for (half, (_, between)) in contact.surface.directions().iter().zip(self.along) {
                if between {
                    let b = at.b.motion.rotation * half;
                    free -= b * (b.dot(&a) / b.dot(&b));
                }
            }
            // a·x + η t = 0.
            let by_zero = -((a.dot(&by_end) + by_square * crown) / (a.dot(&free) + crown));
            by_a += self.x * by_zero;
            by_crown += by_zero * t;
            let more = self.pull_x(contact, at, a * by_zero, out);
            by_a += more * t;
            by_y += more;
        }
        let local = at.a.motion.rotation.tr_mul(&by_a);
        out.a.theta += half.cross(&local);
        out.direction += local;
        if !contact.surface.directions().is_empty() {
            let width = contact.law.width * CROWN;
            out.scalars[RADIUS_A] += by_crown * width;
            out.scalars[RADIUS_B] += by_crown * width;
            let sum = contact.radius + radius_b(&contact.surface);
            out.scalars[WIDTH] += by_crown * sum * CROWN;
        }
        by_y
    }
}
