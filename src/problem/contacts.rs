//! Makes the contacts of a model from those of a file.

use super::load_ends::ends;
use super::placement::Assembly;
use crate::math::scalar::unit;
use crate::math::{Scalar, Vec3};
use crate::model::{Contact, Friction, HeightField, NormalLaw, Shape, Stribeck, Surface};
use crate::quantity::{Quantity, Vector};
use crate::schema::contacts::{Contact as WrittenContact, Surface as WrittenSurface};
use std::sync::Arc;

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
        law: NormalLaw {
            exponent: contact.exponent,
            stiffness: get(&contact.stiffness),
            dissipation: get(&contact.dissipation),
            width: get(&contact.width),
        },
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
