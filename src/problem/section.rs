//! From the cross sections of a file to those of beams.

use super::Problem;
use crate::math::Scalar;
use crate::quantity::Quantity;
use crate::schema::section::Section as Written;
use crate::structures::beam::{Section, SectionFault, SectionValues};

impl Problem {
    /// The first body whose section cannot be built at the design `x`, and why.
    pub fn impossible_section(&self, x: &[f64]) -> Option<(String, SectionFault)> {
        let x = &*self.extended(x);
        self.written.bodies.iter().find_map(|(name, body)| {
            let of_beam = body
                .beam
                .as_ref()
                .and_then(|beam| section(&beam.section, x, |_| SectionValues::zeros()).fault());
            let of_elements = || {
                let mut all = body.elements.as_ref()?.sections();
                all.find_map(|own| section(own, x, |_| SectionValues::zeros()).fault())
            };
            Some((name.clone(), of_beam.or_else(of_elements)?))
        })
    }
}

/// The section at the design `x`; `given` makes the values of given stiffnesses.
pub fn section<G, S: Scalar>(
    written: &Written<G>,
    x: &[S],
    given: impl FnOnce(&G) -> SectionValues<S>,
) -> Section<S> {
    section_by(written, |quantity| quantity.get(x), given)
}

/// The section with the values that `get` gives to quantities.
pub fn section_by<G, S: Scalar>(
    written: &Written<G>,
    get: impl Fn(&Quantity) -> S,
    given: impl FnOnce(&G) -> SectionValues<S>,
) -> Section<S> {
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
