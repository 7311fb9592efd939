//! Text about the flexible bodies of a document: coordinates and natural frequencies.

use crate::schema::Document;
use crate::schema::elements::ElementInertia;
use crate::schema::flexible::Beam;
use crate::structures::modal::FlexibleBeam;
use crate::structures::modal::frequencies::{Held, frequencies};
use crate::system::reduction::ReducedBasis;
use crate::{beam, elements, modal};

/// Largest number of natural frequencies of a body in the text.
const TOLD: usize = 4;

/// Coordinates and natural frequencies of the flexible bodies of a document.
pub fn described(document: &Document, x: &[f64]) -> Vec<String> {
    let told = |held, beam: &FlexibleBeam<f64>| {
        let all = frequencies(&beam.numbers(), held)?;
        let told = all.iter().take(TOLD).map(|f| format!("{f:.4e}"));
        Some(told.collect::<Vec<String>>().join(", "))
    };
    let unknown = || "none, as its stiffness or mass is singular".to_owned();
    let shells = document.bodies.iter().filter_map(|(name, body)| {
        let elements = body.elements.as_ref()?;
        let prepared = elements::prepared(document, elements);
        let mesh = &prepared.mesh;
        let (nodes, shells) = (mesh.nodes.len(), mesh.elements.len());
        let count = prepared.coordinates();
        let basis = match &prepared.reduced {
            None => String::new(),
            Some(reduced) => match &reduced.basis {
                None => ", as a rigid body".to_owned(),
                Some(basis) => of_basis(basis),
            },
        };
        let beams = match mesh.beams.len() {
            0 => String::new(),
            beams => format!(" and {beams} beams"),
        };
        let masses = match mesh.parts.len() - mesh.beams.len() {
            0 => String::new(),
            masses => format!(", with masses at {masses} nodes"),
        };
        let kind = match shells {
            0 => "beams",
            _ => "shells",
        };
        let shells = match shells {
            0 => mesh.beams.len().to_string(),
            _ => format!("{shells} elements{beams}"),
        };
        let of = match kind {
            "beams" => format!("{shells} elements"),
            _ => shells,
        };
        let inertia = match elements.inertia {
            ElementInertia::Full => "",
            ElementInertia::Paper => "; inertia of equations 13 and 14 of Kennedy & Boopathy (2016)",
        };
        Some(format!(
            "{kind} \"{name}\": {count} coordinates of {nodes} nodes of {of}{masses}{basis}{inertia}"
        ))
    });
    let shells: Vec<String> = shells.collect();
    let of_beam = |name: &str, written: &Beam| {
        let beam = beam::beam(written, x);
        let [y, z, torsion, stretch] = beam.modes.ranges().map(|range| range.len());
        let held = told(Held::Axes, &beam).unwrap_or_else(unknown);
        let free = told(Held::Nothing, &beam).unwrap_or_else(unknown);
        format!(
            "beam \"{name}\": {} coordinates ({y} of bending along y, {z} along z, {torsion} of \
                 torsion, {stretch} of stretch); frequencies with its axes held {held} Hz, free {free} Hz",
            beam.modes.count()
        )
    };
    let bodies = document.bodies.iter();
    bodies
        .filter_map(|(name, body)| match (&body.beam, &body.modal) {
            (Some(beam), _) => Some(of_beam(name, beam)),
            (None, Some(modal)) => Some(modal::described(name, modal, x)),
            (None, None) => None,
        })
        .chain(shells)
        .collect()
}

/// The vectors of a reduced basis.
fn of_basis(basis: &ReducedBasis) -> String {
    let hertz = |all: &[f64]| -> String {
        let told = all.iter().take(TOLD).map(|f| format!("{f:.4e}"));
        told.collect::<Vec<String>>().join(", ")
    };
    let fixed = match basis.fixed.len() {
        0 => "no fixed-interface modes".to_owned(),
        count => {
            let last = basis.fixed.last().map_or(0.0, |f| *f);
            format!("{count} fixed-interface modes up to {last:.4e} Hz")
        }
    };
    let loaded = match basis.loaded {
        0 => String::new(),
        count => format!(" {count} vectors of spread loads,"),
    };
    format!(
        " in a reduced basis of the design in the file ({} boundary modes, {fixed},{loaded} {} vectors of static \
         solutions, {} companions; {} vectors bend); frequencies with its axes held {} Hz",
        basis.boundary,
        basis.statics,
        basis.companions,
        basis.bending.len(),
        hertz(&basis.frequencies)
    )
}
