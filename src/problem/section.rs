//! From the cross sections of a file to those of beams.

use super::Problem;
use super::quantity::Quantity;
use super::schema::section::Section as Written;
use crate::math::Scalar;
use crate::structures::beam::{Section, SectionFault, SectionValues};

impl Problem {
    /// The first body whose section cannot be built at the design `x`, and why.
    pub(crate) fn impossible_section(&self, x: &[f64]) -> Option<(String, SectionFault)> {
        let bodies = self.written.bodies.iter();
        let beams = bodies.filter_map(|(name, body)| Some((name, body.beam.as_ref()?)));
        beams.into_iter().find_map(|(name, beam)| {
            let section = section(&beam.section, x, |_| SectionValues::zeros());
            Some((name.clone(), section.fault()?))
        })
    }
}

/// The section at the design `x`; `given` makes the values of given stiffnesses.
pub(crate) fn section<G, S: Scalar>(
    written: &Written<G>,
    x: &[S],
    given: impl FnOnce(&G) -> SectionValues<S>,
) -> Section<S> {
    let get = |quantity: &Quantity| quantity.get(x);
    match written {
        Written::Rectangle { width, height } => Section::Rectangle {
            width: get(width),
            height: get(height),
        },
        Written::Tube { radius, wall } => Section::Tube {
            radius: get(radius),
            wall: get(wall),
        },
        Written::I {
            width,
            height,
            flange,
            web,
        } => Section::I {
            width: get(width),
            height: get(height),
            flange: get(flange),
            web: get(web),
        },
        Written::Given(values) => Section::Given(given(values)),
    }
}
