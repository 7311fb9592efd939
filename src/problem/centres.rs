//! Loads without a point on flexible bodies. On a beam they act in its middle, which is the centre of mass of an undeformed
//! beam. Other flexible bodies have no point there in general, so that a load has to name one.

use super::finding::Finding;
use super::pointer::join;
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::loads::Load;
use crate::schema::mechanics::{Body, Point};
use indexmap::IndexMap;

/// The station in the middle.
const MIDDLE: &str = "middle";

/// Gives loads without a point the middle of their beam.
///
/// # Errors
/// Of another flexible body.
pub(super) fn fill(document: &mut Document) -> Result<(), Finding> {
    let bodies = &mut document.bodies;
    for (name, load) in &mut document.loads {
        let pointer = join(&join("/loads", name), load.key());
        match load {
            Load::Force(own) if own.at.is_none() => {
                fill_one(bodies, (&own.body, &mut own.point), &pointer)?;
            }
            Load::Drag(own) if own.faces.is_none() => {
                fill_one(bodies, (&own.body, &mut own.point), &pointer)?;
            }
            Load::Controller(own) => {
                let pointer = join(&pointer, "gravity_compensation");
                for (k, own) in own.gravity_compensation.iter_mut().enumerate() {
                    fill_one(bodies, (&own.body, &mut own.point), &join(&pointer, k))?;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn fill_one(
    bodies: &mut IndexMap<String, Body>,
    (name, point): (&str, &mut Option<Point>),
    pointer: &str,
) -> Result<(), Finding> {
    let Some(body) = bodies.get_mut(name).filter(|_| point.is_none()) else {
        return Ok(());
    };
    if let Some(beam) = &mut body.beam {
        let mut middle = MIDDLE.to_owned();
        while beam
            .stations
            .get(&middle)
            .is_some_and(|own| own.value != 0.5 || own.variable.is_some())
        {
            middle.push('\'');
        }
        beam.stations.insert(middle.clone(), Quantity::fixed(0.5));
        *point = Some(Point::Named(middle));
        return Ok(());
    }
    if body.elements.is_none() && body.modal.is_none() {
        return Ok(());
    }
    let found = format!("no \"point\" on the flexible body \"{name}\"");
    Err(Finding::new(pointer, found, "the point where it acts").of_key())
}
