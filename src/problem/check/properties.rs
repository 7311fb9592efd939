//! Cross sections and inertias, of moving bodies and of structures.

use super::Checker;
use crate::finding::Finding;
use crate::math::Mat3;
use crate::model::rigid_body::is_inertia_of_solid;
use crate::pointer::join;
use crate::schema::section::Section;
use crate::section::section;
use crate::structures::beam::SectionValues;

impl Checker<'_> {
    /// Checks that a section can be built.
    pub(super) fn sizes<G>(&mut self, pointer: &str, written: &Section<G>) {
        let kind = match written {
            Section::Tube { .. } => "tube",
            Section::I { .. } => "i",
            Section::Rectangle { .. } | Section::Given(_) => return,
        };
        if let Some(fault) = section(written, &[], |_| SectionValues::zeros()).fault() {
            let found = format!("a {} of {} m", fault.size, fault.found);
            let expected = format!("one that is not above {}, {} m", fault.limit, fault.most);
            let place = join(&join(pointer, kind), fault.size);
            self.fault(Finding::new(place, found, expected));
        }
    }

    /// Checks that an inertia is that of a solid, up to a part of its largest moment.
    pub(super) fn inertia(&mut self, pointer: &str, inertia: &Mat3<f64>, tolerance: f64) {
        if !is_inertia_of_solid(inertia, tolerance) {
            let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
            moments.sort_by(f64::total_cmp);
            let [a, b, c] = moments.map(rounded);
            let found = format!("principal moments of inertia {a}, {b}, {c} kg m²");
            let expected = "those of a solid: none negative, none above the sum of the others";
            let expected = match tolerance > 0.0 {
                true => {
                    format!("{expected} by more than {tolerance:e} of it (\"input_tolerance\")")
                }
                false => expected.to_owned(),
            };
            self.fault(Finding::new(pointer, found, expected));
        }
    }
}

/// Rounds a number to six digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}
