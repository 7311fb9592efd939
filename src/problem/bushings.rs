//! Makes the bushings of a model from those of a file.

use super::load_ends::joint;
use super::placement::{Assembly, GROUND};
use crate::math::Scalar;
use crate::model::load::BearingFriction;
use crate::model::{DegreeOfFreedom, LoadKind};
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::joints::Joint;
use crate::schema::loads::{Bushing, BushingAxes, BushingEntries, Motion};

/// A bushing of a checked document.
pub(super) fn bushing<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    own: &Bushing,
) -> LoadKind<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    // The symmetric part, of which two equal numbers are halves.
    let matrix = |entries: &BushingEntries| -> Vec<S> {
        let at = |i: usize, k: usize| entries[i][k].map_or(S::zero(), get);
        let rows = (0..6).flat_map(|i| (0..6).map(move |k| (i, k)));
        let all = rows.map(|(i, k)| match i == k {
            true => at(i, k),
            false => (at(i, k) + at(k, i)) * 0.5,
        });
        all.collect()
    };
    let (index, joint) = joint(document, &own.joint);
    LoadKind::Bushing {
        joint: index,
        of_second: has_axes_of_second(own, joint),
        stiffness: matrix(&own.stiffness.entries()),
        damping: match &own.damping {
            Some(damping) => matrix(&damping.entries()),
            None => vec![S::zero(); 36],
        },
        friction: own.friction.as_ref().map(|own| BearingFriction {
            dof: match own.motion {
                Motion::Turn => DegreeOfFreedom::Rotation,
                Motion::Slide => DegreeOfFreedom::Translation,
            },
            coefficient: get(&own.coefficient),
            radius: own.radius.as_ref().map_or(S::one(), get),
            width: get(&own.width),
            load_width: get(&own.load_width),
        }),
    }
}

/// Whether e1, e2, e3 turn with the second body of the joint; ground counts as the second. A bearing on ground has axes that stay:
/// those of a shaft would turn its damping with the shaft, which makes rotors unstable.
fn has_axes_of_second(own: &Bushing, joint: &Joint) -> bool {
    let [first, second] = joint.between().each_ref().map(|name| name == GROUND);
    match own.axes {
        Some(axes) => (axes == BushingAxes::Second) != first,
        None => {
            let slides = (own.friction.as_ref()).is_some_and(|own| own.motion == Motion::Slide);
            let free = matches!(joint, Joint::Free(_));
            free && (first || second) && !resists_turn(own) && !slides
        }
    }
}

/// Whether a bushing resists the turn about e3.
fn resists_turn(own: &Bushing) -> bool {
    let entries = own.stiffness.entries();
    let mut about = (0..6)
        .flat_map(|k| [entries[5][k], entries[k][5]])
        .flatten();
    about.any(|own| own.value != 0.0)
}
