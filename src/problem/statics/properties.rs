//! Thickness and sections of a structure: which value each element has, and its quantity.

use super::mesh::Part;
use crate::math::Scalar;
use crate::quantity::Quantity;
use crate::schema::structures::{self as written, Per, Section as WrittenSection};
use crate::structures::beam::{Section, SectionValues};

/// Which value of its structure each element has.
pub fn slots(structure: &written::Structure, part: &Part<f64>) -> Vec<usize> {
    let beams = structure.mesh.is_of_beams();
    let [nx, ny] = (structure.mesh.panel_elements()).unwrap_or([part.parent.len(), 1]);
    let (per, groups) = match (&structure.thickness, &structure.sections) {
        (_, Some(varied)) if beams => (varied.per, &varied.groups),
        (Some(written::Thickness::Varied(varied)), _) if !beams => (varied.per, &varied.groups),
        _ => return vec![0; part.parent.len()],
    };
    let mut of_groups = vec![0; part.parent.len()];
    let sets = match beams {
        true => &part.mesh.beam_sets,
        false => &part.mesh.face_sets,
    };
    // The first group that has an element gives its value.
    for (k, name) in groups.as_deref().unwrap_or(&[]).iter().enumerate().rev() {
        for &e in sets.get(name).into_iter().flatten() {
            of_groups[e] = k;
        }
    }
    let one = |e: usize| -> usize {
        let p = part.parent[e];
        let Some(written::Thickness::Varied(varied)) = &structure.thickness else {
            return match per {
                Per::Group => of_groups[e],
                Per::Element | Per::Band | Per::Patch => p,
            };
        };
        let (i, j) = (p % nx, p / nx);
        match per {
            Per::Element => p,
            Per::Group => of_groups[e],
            Per::Band => match varied.along.unwrap_or(written::Direction::Y) {
                written::Direction::X => i * varied.bands.unwrap_or(nx) / nx,
                written::Direction::Y => j * varied.bands.unwrap_or(ny) / ny,
            },
            Per::Patch => {
                let [px, py] = varied.patches.unwrap_or([1, 1]);
                (i * px / nx) + px * (j * py / ny)
            }
        }
    };
    (0..part.parent.len()).map(one).collect()
}

/// The thickness of this number.
pub fn thickness(structure: &written::Structure, slot: usize) -> Quantity {
    let none = Quantity::fixed(0.0);
    match &structure.thickness {
        None => none,
        Some(written::Thickness::Uniform(one)) => *one,
        Some(written::Thickness::Varied(varied)) => match &varied.values {
            Some(values) => values[slot],
            None => varied.value.unwrap_or(none),
        },
    }
}

/// The section of this number.
pub fn section(structure: &written::Structure, slot: usize) -> Option<&WrittenSection> {
    match (&structure.section, &structure.sections) {
        (Some(one), _) => Some(one),
        (None, Some(varied)) => match &varied.values {
            Some(values) => values.get(slot),
            None => varied.value.as_ref(),
        },
        (None, None) => None,
    }
}

/// The quantities of a section, in the order of [`Section::map`].
pub(super) fn quantities(section: &WrittenSection) -> Vec<Quantity> {
    match section {
        WrittenSection::Rectangle { width, height } => vec![*width, *height],
        WrittenSection::Tube { radius, wall } => vec![*radius, *wall],
        WrittenSection::I {
            width,
            height,
            flange,
            web,
        } => vec![*width, *height, *flange, *web],
        WrittenSection::Given(given) => {
            let stiffness = given.axial_and_shear.iter();
            let stiffness = stiffness.chain(&given.torsion_and_bending);
            let all = stiffness.chain([&given.mass]).chain(&given.inertia);
            all.copied().collect()
        }
    }
}

pub(super) fn section_at<S: Scalar>(written: Option<&WrittenSection>, x: &[S]) -> Section<S> {
    section_by(written, |quantity| quantity.get(x))
}

/// The section with the values that `get` gives to quantities.
pub fn section_by<S: Scalar>(
    written: Option<&WrittenSection>,
    get: impl Fn(&Quantity) -> S,
) -> Section<S> {
    let Some(written) = written else {
        return Section::Given(SectionValues::zeros());
    };
    crate::section::section_by(written, &get, |given| {
        let [ea, ga2, ga3] = given.axial_and_shear.each_ref().map(&get);
        let [gj, ei2, ei3] = given.torsion_and_bending.each_ref().map(&get);
        let [i2, i3] = given.inertia.each_ref().map(&get);
        SectionValues {
            stiffness: [ea, ga2, ga3, gj, ei2, ei3],
            inertia: [get(&given.mass), i2, i3],
        }
    })
}
