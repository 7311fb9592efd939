//! Makes the contacts of a model from those of a file.

use super::load_ends::ends;
use super::placement::Assembly;
use crate::math::scalar::unit;
use crate::math::{Scalar, Vec3};
use crate::model::{Contact, Friction, HeightField, NormalLaw, Shape, Stribeck, Surface};
use crate::quantity::{Quantity, Vector, values};
use crate::schema::contacts::{Contact as WrittenContact, Surface as WrittenSurface};
use std::sync::Arc;

/// The exponent of Hertz, and the default width of its onset, relative to its radius: a ball of steel that rests has a penetration of
/// about so much, one that falls from a metre of a hundred times as much.
pub(super) const HERTZ: f64 = 1.5;
const OF_RADIUS: f64 = 1e-5;

/// Most spheres that are made without being asked for.
pub(super) const MOST: f64 = 100.0;

/// Of a length, which is to fit a whole number of times.
const ROUND_OFF: f64 = 1e-9;

/// A contact of a checked document.
pub(super) fn contact<S: Scalar>(assembly: &Assembly<S>, contact: &WrittenContact) -> Contact<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    let ends = ends(assembly, &contact.between, &contact.at);
    let [of_a, turn] = contact
        .between
        .each_ref()
        .map(|own| assembly.pose(own).rotation);
    let in_body = |direction: &Vector| turn.tr_mul(&assembly.ground(direction));
    let friction = contact.friction.as_ref();
    Contact {
        body_a: ends.body_a,
        body_b: ends.body_b,
        point_a: ends.point_a,
        radius: get(&contact.radius),
        shape: match (&contact.wheel, &contact.half) {
            (Some(own), _) => Shape::Wheel {
                axis: unit(of_a.tr_mul(&assembly.ground(&own.axis))),
                radius: get(&own.radius),
            },
            (None, Some(half)) => Shape::Capsule {
                half: of_a.tr_mul(&assembly.ground(half)),
                spheres: spheres(contact, half),
            },
            (None, None) => Shape::Sphere,
        },
        point_b: ends.point_b,
        surface: match &contact.surface {
            WrittenSurface::Plane { normal } => Surface::Plane {
                normal: unit(in_body(normal)),
            },
            WrittenSurface::Sphere { radius } => Surface::Sphere {
                radius: get(radius),
            },
            WrittenSurface::Capsule { half, radius } => Surface::Capsule {
                half: in_body(half),
                radius: get(radius),
            },
            WrittenSurface::Box { size, radius } => {
                let radius = get(radius);
                let half = |i: usize| Vec3::ith(i, get(&size[i]) * 0.5 - radius);
                Surface::Box {
                    halves: [0, 1, 2].map(half),
                    radius,
                }
            }
            WrittenSurface::HeightField(own) => {
                let up = unit(in_body(&own.normal));
                let direction = in_body(&own.direction);
                let along = unit(direction - up * up.dot(&direction));
                Surface::Field {
                    axes: [along, up.cross(&along), up],
                    heights: Arc::new(HeightField::new(
                        own.along.clone(),
                        own.across.clone(),
                        &own.heights,
                    )),
                }
            }
        },
        law: law(assembly, contact),
        friction: Friction {
            coefficient: friction.map_or(S::zero(), |own| get(&own.coefficient)),
            // Without friction any width will do.
            width: friction.map_or(S::one(), |own| get(&own.width)),
            stribeck: friction.and_then(|own| {
                own.stribeck.as_ref().map(|own| Stribeck {
                    coefficient: get(&own.coefficient),
                    speed: get(&own.speed),
                })
            }),
        },
    }
}

/// How many spheres of a capsule touch planes and heights.
pub(super) fn spheres(contact: &WrittenContact, half: &Vector) -> usize {
    let apart = match &contact.surface {
        WrittenSurface::HeightField(_) => contact.radius.value,
        _ => f64::INFINITY,
    };
    let length = 2.0 * Vec3::from(values(half)).norm();
    let intervals = (length / apart * (1.0 - ROUND_OFF)).ceil();
    contact
        .spheres
        .unwrap_or(1 + intervals.clamp(1.0, MOST) as usize)
}

/// The width of the onset of a contact whose materials are given.
pub(super) fn default_width(contact: &WrittenContact) -> Quantity {
    Quantity::fixed(radius_of_hertz(contact, |own| own.value) * OF_RADIUS)
}

/// R of a sphere on a plane or sphere, 1/R = Σ 1 / R_i.
fn radius_of_hertz<S: Scalar>(contact: &WrittenContact, get: impl Fn(&Quantity) -> S) -> S {
    let radius = get(&contact.radius);
    match &contact.surface {
        WrittenSurface::Sphere { radius: other } => {
            let other = get(other);
            radius * other / (radius + other)
        }
        _ => radius,
    }
}

/// The law of a contact; by Hertz, if its materials are given: F = 4/3 E √R δ^1.5 with 1/E = Σ (1 − ν²) / E_i and 1/R = Σ 1 / R_i
/// (Johnson, Contact Mechanics, 1985, eq. 4.23).
fn law<S: Scalar>(assembly: &Assembly<S>, contact: &WrittenContact) -> NormalLaw<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    let own = |quantity: &Option<Quantity>| quantity.as_ref().map(get);
    let hertz = contact.materials.as_ref().map(|names| {
        let compliance = |name: &String| {
            let own = &assembly.document().materials[name];
            let ratio = get(&own.poisson);
            (S::one() - ratio * ratio) / get(&own.young)
        };
        let radius = radius_of_hertz(contact, get);
        let compliance = compliance(&names[0]) + compliance(&names[1]);
        (radius.sqrt() * (4.0 / 3.0) / compliance, radius)
    });
    let [stiffness, width] = match hertz {
        Some((stiffness, radius)) => [stiffness, radius * OF_RADIUS],
        None => [S::one(); 2],
    };
    let exponent = if hertz.is_some() { HERTZ } else { 1.0 };
    NormalLaw {
        exponent: contact.exponent.unwrap_or(exponent),
        stiffness: own(&contact.stiffness).unwrap_or(stiffness),
        dissipation: get(&contact.dissipation),
        width: own(&contact.width).unwrap_or(width),
    }
}
