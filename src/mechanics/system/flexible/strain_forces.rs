//! Products of the derivatives of elastic and viscous forces of finite elements with motions, by strains.

use super::coordinates::{coordinates, rates, slots};
use crate::math::{Dual, Parameters};
use crate::model::finite::FiniteElements;
use crate::model::{Form, Model};
use crate::system::bodies::BodyMotion;
use crate::system::finite;
use crate::system::numbering::Numbering;

/// The forces of strains of all bodies of finite elements about a state. Those that are damped are at rest in it.
#[derive(Clone, Debug)]
pub struct StrainForces(Vec<OfBody>);

#[derive(Clone, Debug)]
struct OfBody {
    elements: FiniteElements<Dual>,
    coordinates: Vec<f64>,
    /// Their places in velocity numbering.
    slots: Vec<usize>,
}

impl StrainForces {
    /// Those of a model, with their damping or without; `None` if it has no finite elements, or some that are damped move.
    pub fn new(
        (model, numbering): (&Model<f64>, &Numbering),
        motions: &[BodyMotion<f64>],
        damped: bool,
    ) -> Option<Self> {
        let mut all = Vec::new();
        for body in &model.flexible {
            let Form::Finite(own) = &body.form else {
                continue;
            };
            let moves = rates(body, motions).iter().any(|&rate| rate != 0.0);
            if own.damping.is_some() && moves {
                return None;
            }
            let mut elements = own.map(&mut |x| Dual::new(x, 0.0));
            // Damping by the mass is no force of strains.
            elements.damping = match elements.damping {
                Some([_, by_stiffness]) if damped => Some([Dual::new(0.0, 0.0), by_stiffness]),
                _ => None,
            };
            all.push(OfBody {
                elements,
                coordinates: coordinates(body, motions),
                slots: slots(numbering, body)[6..].to_vec(),
            });
        }
        (!all.is_empty()).then_some(Self(all))
    }

    /// Adds A x and B x for the symmetric derivatives A by coordinates and B by rates, in velocity numbering.
    pub fn add_products(&self, x: &[f64], [elastic, viscous]: &mut [Vec<f64>; 2]) {
        for own in &self.0 {
            let along = own.slots.iter().map(|&slot| x[slot]);
            let moved = own.coordinates.iter().zip(along.clone());
            let moved: Vec<Dual> = moved.map(|(&q, x)| Dual::new(q, x)).collect();
            let still: Vec<Dual> = own.coordinates.iter().map(|&q| Dual::new(q, 0.0)).collect();
            let speeds: Vec<Dual> = along.map(|x| Dual::new(0.0, x)).collect();
            let zero = Dual::new(0.0, 0.0);
            let [mut by_place, mut by_rate] = [0, 1].map(|_| vec![zero; still.len()]);
            finite::add_forces(&own.elements, &moved, &mut by_place);
            finite::add_damping(&own.elements, (&still, &speeds), &mut by_rate);
            for (k, &slot) in own.slots.iter().enumerate() {
                elastic[slot] += by_place[k].du;
                viscous[slot] += by_rate[k].du;
            }
        }
    }
}
