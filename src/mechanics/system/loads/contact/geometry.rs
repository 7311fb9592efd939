//! Where a contact is: penetration, normal and place, and their derivatives.
//!
//! ```text
//! plane      δ = R_A − n·x,   n given,          z = p − R_A n
//! wheel      p = c_A + ϱ u,   u = −(n − a n·a) / √(1 − (n·a)²),   on a plane; a the axis, ϱ the radius of its circle
//! heights    δ = R_A − d,     d to the nearest point ([`super::field`]), of a wheel to its nearest sphere ([`super::rim`])
//! others     δ = R_A + R_B − d,   n = x / d,    z = p − x R_A / (R_A + R_B)   ([`super::nearest`])
//! ```

use super::cotangent::{Cotangent, RADIUS_A, WHEEL, pull_direction};
use super::field::Foot;
use super::nearest::Nearest;
use super::rim::Rim;
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::model::contact::{Contact, Shape, Surface};
use crate::model::height_field::HeightField;
use crate::system::loads::Acting;
use crate::system::loads::pull::{Pulled, pull_point};

/// A contact at an instant.
pub(super) struct Touch<S> {
    /// n: −∂δ/∂p.
    pub normal: Vec3<S>,
    /// nᵀn, which is 1 but for a crowned capsule, and whether it is one.
    pub square: S,
    pub is_crowned: bool,
    pub penetration: S,
    /// Place of contact z in ground axes.
    pub place: Vec3<S>,
    on: On<S>,
}

/// How it was found.
enum On<S> {
    /// x, from a point of the plane to the centre.
    Plane(Vec3<S>),
    Wheel(Vec3<S>, Lowest<S>),
    Others(Nearest<S>),
    Field(Foot<S>),
    Rim(Rim<S>),
}

/// Where a wheel is lowest, from its centre, of length 1; and √(1 − (n·a)²).
struct Lowest<S> {
    down: Vec3<S>,
    size: S,
}

fn lowest<S: Scalar>(axis: &Vec3<S>, at: &Acting<S>, normal: &Vec3<S>) -> Lowest<S> {
    let axis = at.a.motion.rotation * axis;
    let across = normal - axis * axis.dot(normal);
    let size = length(&across);
    Lowest {
        down: -across / size,
        size,
    }
}

impl<S: Scalar> Touch<S> {
    /// That of a sphere of the radius of the contact with this centre, distance of it from a surface, and normal there.
    fn of_sphere(
        contact: &Contact<S>,
        (centre, distance, normal): (Vec3<S>, S, Vec3<S>),
        on: On<S>,
    ) -> Self {
        Self {
            normal,
            square: S::one(),
            is_crowned: false,
            penetration: contact.radius - distance,
            place: centre - normal * contact.radius,
            on,
        }
    }
}

/// The contact in a motion.
pub(super) fn touch<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> Touch<S> {
    match &contact.surface {
        Surface::Plane { normal } => on_plane(contact, normal, at),
        Surface::Field { axes, heights } => on_field(contact, (axes, heights), at),
        Surface::Sphere { .. } | Surface::Capsule { .. } | Surface::Box { .. } => {
            let (found, normal) = Nearest::of(contact, at);
            Touch {
                normal,
                square: found.square(&normal),
                is_crowned: found.is_crowned(),
                penetration: found.penetration(contact),
                place: found.place(at),
                on: On::Others(found),
            }
        }
    }
}

fn on_plane<S: Scalar>(contact: &Contact<S>, normal: &Vec3<S>, at: &Acting<S>) -> Touch<S> {
    let normal = at.b.motion.rotation * normal;
    let (p, o) = (at.a.point(), at.b.point());
    let (centre, wheel) = match &contact.shape {
        Shape::Wheel { axis, radius } => {
            let own = lowest(axis, at, &normal);
            (p + own.down * *radius, Some(own))
        }
        Shape::Sphere | Shape::Capsule { .. } => (p, None),
    };
    let x = centre - o;
    let distance = normal.dot(&x);
    let on = match wheel {
        Some(own) => On::Wheel(x, own),
        None => On::Plane(x),
    };
    Touch::of_sphere(contact, (centre, distance, normal), on)
}

fn on_field<S: Scalar>(
    contact: &Contact<S>,
    (axes, heights): (&[Vec3<S>; 3], &HeightField),
    at: &Acting<S>,
) -> Touch<S> {
    let (on, normal, distance, centre) = match &contact.shape {
        Shape::Wheel { axis, radius } => {
            let (rim, normal) = Rim::of((axis, *radius), (axes, heights), at);
            let (distance, arm) = (rim.distance(), rim.arm());
            (On::Rim(rim), normal, distance, at.a.point() + arm)
        }
        Shape::Sphere | Shape::Capsule { .. } => {
            let axes = axes.each_ref().map(|own| at.b.motion.rotation * own);
            let (foot, normal) = Foot::of((axes, heights), at.a.point() - at.b.point());
            let distance = foot.distance();
            (On::Field(foot), normal, distance, at.a.point())
        }
    };
    Touch::of_sphere(contact, (centre, distance, normal), on)
}

/// Whether the contact cannot touch: the centre is far from a surface whose nearest point takes time to find.
pub(super) fn is_far<S: Scalar>(contact: &Contact<S>, at: &Acting<S>) -> bool {
    let Surface::Field { axes, heights } = &contact.surface else {
        return false;
    };
    let up = at.b.motion.rotation * axes[2];
    let height = up.dot(&(at.a.point() - at.b.point())).re();
    let around = match &contact.shape {
        Shape::Wheel { radius, .. } => radius.re(),
        Shape::Sphere | Shape::Capsule { .. } => 0.0,
    };
    let reach = around + contact.radius.re() + contact.law.width.re();
    let [along, across] = heights.places();
    // Beyond the grid the surface may rise.
    let inside = |axis: usize, all: &[f64]| {
        let own = (at.b.motion.rotation * axes[axis]).dot(&(at.a.point() - at.b.point()));
        all.len() == 1 || (all[0] + reach < own.re() && own.re() < all[all.len() - 1] - reach)
    };
    height > heights.bound() + reach && inside(0, along) && inside(1, across)
}

/// Whether the centre of A is where a surface has no normal: in the centre of a sphere, on the axis of a capsule, or at a wheel that
/// lies on a plane.
pub(in crate::system::loads) fn meets(contact: &Contact<f64>, at: &Acting<f64>) -> bool {
    let near = super::super::ROUND_OFF;
    match touch(contact, at).on {
        On::Wheel(_, own) => own.size <= near,
        On::Rim(own) => own.across() <= near,
        On::Others(own) if !matches!(contact.surface, Surface::Box { .. }) => {
            own.distance() <= near * contact.radius.max(at.a.point().norm())
        }
        _ => false,
    }
}

/// Pulls the cotangent of the centre c + ϱ u of the lowest sphere of a wheel back to its axis and radius. Returns that of the normal
/// of the plane.
fn pull_wheel<S: Scalar>(
    (own, radius): (&Vec3<S>, S),
    at: &Acting<S>,
    (n, Lowest { down, size }): (&Vec3<S>, &Lowest<S>),
    by_centre: Vec3<S>,
    out: &mut Pulled<S>,
) -> Vec3<S> {
    let rotation = &at.a.motion.rotation;
    let axis = rotation * own;
    out.scalars[WHEEL] += down.dot(&by_centre);
    let by_down = by_centre * radius;
    let by_across = (down * down.dot(&by_down) - by_down) / *size;
    let by_axis = -(by_across * axis.dot(n)) - n * axis.dot(&by_across);
    let local = rotation.tr_mul(&by_axis);
    out.a.theta += own.cross(&local);
    out.direction += local;
    by_across - axis * axis.dot(&by_across)
}

/// Pulls the cotangents of the centre of A from B's point, and of z, back to the points.
fn pull_ends<S: Scalar>(at: &Acting<S>, by_from: Vec3<S>, cot: &Cotangent<S>, out: &mut Pulled<S>) {
    let none = Vec3::zeros();
    pull_point(&at.a, [by_from + cot.place, none], &mut out.a);
    pull_point(&at.b, [-by_from, none], &mut out.b);
}

impl<S: Scalar> Touch<S> {
    /// Pulls the cotangents back to the bodies and parameters.
    pub(super) fn pull(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        cot: &Cotangent<S>,
        out: &mut Pulled<S>,
    ) {
        let n = &self.normal;
        let (x, wheel) = match &self.on {
            On::Others(own) => return own.pull(contact, at, (n, cot), out),
            On::Field(own) => {
                out.scalars[RADIUS_A] += cot.penetration - n.dot(&cot.place);
                let by_normal = cot.normal - cot.place * contact.radius;
                let by_from = own.pull(contact, at, (cot.penetration, &by_normal), out);
                return pull_ends(at, by_from, cot, out);
            }
            On::Rim(own) => {
                let Some(axis) = contact.shape.direction() else {
                    return;
                };
                let by_from = own.pull((contact, axis), at, cot, out);
                return pull_ends(at, by_from, cot, out);
            }
            On::Plane(x) => (x, None),
            On::Wheel(x, own) => (x, Some(own)),
        };
        let (by_depth, none) = (cot.penetration, Vec3::zeros());
        out.scalars[RADIUS_A] += by_depth - n.dot(&cot.place);
        let by_centre = cot.place - n * by_depth;
        pull_point(&at.a, [by_centre, none], &mut out.a);
        pull_point(&at.b, [n * by_depth, none], &mut out.b);
        let mut by_normal = cot.normal - x * by_depth - cot.place * contact.radius;
        if let (Some(own), Shape::Wheel { axis, radius }) = (wheel, &contact.shape) {
            by_normal += pull_wheel((axis, *radius), at, (n, own), by_centre, out);
        }
        pull_direction(&at.b, (0, &contact.surface.directions()[0]), by_normal, out);
    }
}
