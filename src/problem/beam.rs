//! From the beams of a file to bodies with elastic coordinates.

use super::section::section;
use crate::math::Scalar;
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::flexible::{Beam, BeamSection, Damping, Frame, Functions, Strain};
use crate::structures::beam::SectionValues;
use crate::structures::material::Material;
use crate::structures::modal::{
    BeamDamping, BeamFrame, BeamModes, BendingFunctions, FlexibleBeam, StrainMeasure,
};

/// Functions of bending in each plane where a file gives no number.
const BENDING: u32 = 4;
/// Functions of torsion likewise.
const TORSION: u32 = 2;
/// Functions of stretch likewise, if the strain is linear.
const LINEAR_STRETCH: usize = 2;
/// Poisson's ratio where a file gives none.
const POISSON: f64 = 0.3;

/// So many more has a beam of each kind that is held against it, up to the most that a file may ask for.
const MORE: usize = 2;
const MOST: usize = 12;
const MOST_STRETCH: usize = 25;

/// How many functions a beam has.
pub fn modes(beam: &Beam) -> BeamModes {
    let number = |written: Option<u32>, default| written.unwrap_or(default) as usize;
    let bending = [
        number(beam.modes.bending_y, BENDING),
        number(beam.modes.bending_z, BENDING),
    ];
    let torsion = number(beam.modes.torsion, TORSION);
    let stretch = match beam.strain {
        Strain::VonKarman => BeamModes::companions(bending, torsion),
        Strain::Linear => LINEAR_STRETCH,
    };
    BeamModes {
        bending,
        torsion,
        stretch: beam.modes.stretch.map_or(stretch, |n| n as usize),
    }
}

/// Gives every beam more functions of each kind that it has. False if there are no beams or none has fewer than it may.
pub(super) fn enrich(document: &mut Document) -> bool {
    let mut changed = false;
    for beam in (document.bodies.values_mut()).filter_map(|body| body.beam.as_mut()) {
        changed |= richer(beam);
    }
    changed
}

fn richer(beam: &mut Beam) -> bool {
    let before = kinds(&modes(beam));
    let more = |count: usize, most: usize| match count {
        0 => 0,
        count => (count + MORE).min(most),
    };
    let [along_y, along_z, torsion] = [0, 1, 2].map(|kind| Some(more(before[kind], MOST) as u32));
    (
        beam.modes.bending_y,
        beam.modes.bending_z,
        beam.modes.torsion,
    ) = (along_y, along_z, torsion);
    let stretch = beam.modes.stretch;
    beam.modes.stretch = stretch.map(|given| more(given as usize, MOST_STRETCH) as u32);
    let after = kinds(&modes(beam));
    if let Some(start) = &mut beam.start {
        for row in [&mut start.coordinates, &mut start.rates]
            .into_iter()
            .flatten()
        {
            let mut given = std::mem::take(row).into_iter();
            for (before, after) in before.into_iter().zip(after) {
                row.extend(given.by_ref().take(before));
                row.extend((before..after).map(|_| Quantity::fixed(0.0)));
            }
        }
    }
    after != before
}

/// Functions by kind, in the order of the coordinates.
fn kinds(modes: &BeamModes) -> [usize; 4] {
    let [along_y, along_z] = modes.bending;
    [along_y, along_z, modes.torsion, modes.stretch]
}

/// Whether the sections of a beam shear.
pub fn shears(beam: &Beam) -> bool {
    match &beam.section {
        BeamSection::Given(given) => given.ga_y.is_some() || given.ga_z.is_some(),
        _ => beam.shear.unwrap_or(true),
    }
}

/// The beam at the design `x`. Missing entries, which a checked file does not lack, count as one.
pub fn beam<S: Scalar>(written: &Beam, x: &[S]) -> FlexibleBeam<S> {
    let get = |quantity: &Quantity| quantity.get(x);
    let or = |quantity: &Option<Quantity>, default: f64| {
        quantity.as_ref().map_or(S::from(default), |q| q.get(x))
    };
    // Axis 3 of a section is y, its axis 2 is z. EI2 resists bending along axis 3.
    let section = section(&written.section, x, |given| {
        let (along_y, along_z) = (or(&given.ga_y, 1.0), or(&given.ga_z, 1.0));
        SectionValues {
            stiffness: [
                get(&given.ea),
                along_z,
                along_y,
                or(&given.gj, 1.0),
                or(&given.ei_y, 1.0),
                or(&given.ei_z, 1.0),
            ],
            inertia: [
                get(&given.mass_per_length),
                get(&given.inertia_y),
                get(&given.inertia_z),
            ],
        }
    });
    let material = written.material.as_ref();
    let material = Material {
        young: material.map_or(S::one(), |material| get(&material.young)),
        poisson: material.map_or(S::zero(), |material| or(&material.poisson, POISSON)),
        density: material.map_or(S::one(), |material| or(&material.density, 1.0)),
        yield_stress: S::zero(),
    };
    FlexibleBeam {
        length: get(&written.length),
        section,
        material,
        frame: match written.frame {
            Frame::Chord => BeamFrame::Chord,
            Frame::Clamped => BeamFrame::Clamped,
        },
        functions: match written.functions {
            Functions::Polynomial => BendingFunctions::Polynomial,
            Functions::Sine => BendingFunctions::Sine,
        },
        modes: modes(written),
        strain: match written.strain {
            Strain::VonKarman => StrainMeasure::VonKarman,
            Strain::Linear => StrainMeasure::Linear,
        },
        shear: shears(written),
        damping: damping(written.damping.as_ref(), x),
    }
}

fn damping<S: Scalar>(written: Option<&Damping>, x: &[S]) -> BeamDamping<S> {
    let get = |quantity: Option<Quantity>| quantity.map(|quantity| quantity.get(x));
    let of = |key: fn(&Damping) -> Option<Quantity>| get(written.and_then(key));
    let all = of(|damping| damping.ratio).unwrap_or(S::zero());
    BeamDamping {
        ratios: [
            all,
            of(|damping| damping.torsion_ratio).unwrap_or(all),
            of(|damping| damping.stretch_ratio).unwrap_or(all),
        ],
        mass: of(|damping| damping.mass).unwrap_or(S::zero()),
        viscosity: of(|damping| damping.stiffness),
    }
}

/// Elastic coordinates and their rates at the start.
pub fn start<S: Scalar>(written: &Beam, x: &[S]) -> [Vec<S>; 2] {
    let count = modes(written).count();
    let row = |given: Option<&Vec<Quantity>>| {
        let mut all: Vec<S> = given.into_iter().flatten().map(|q| q.get(x)).collect();
        all.resize(count, S::zero());
        all
    };
    let start = written.start.as_ref();
    [
        row(start.and_then(|start| start.coordinates.as_ref())),
        row(start.and_then(|start| start.rates.as_ref())),
    ]
}
