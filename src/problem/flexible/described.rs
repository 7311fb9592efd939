//! What is told of the flexible bodies of a document.

use crate::problem::schema::Document;
use crate::problem::schema::flexible::Beam;
use crate::problem::{beam, elements, modal};
use crate::structures::modal::FlexibleBeam;
use crate::structures::modal::frequencies::{Held, frequencies};

/// Natural frequencies that are told of a body.
const TOLD: usize = 4;

/// Coordinates and natural frequencies of the flexible bodies of a document.
pub(crate) fn described(document: &Document, x: &[f64]) -> Vec<String> {
    let told = |held, beam: &FlexibleBeam<f64>| {
        let all = frequencies(&beam.numbers(), held)?;
        let told = all.iter().take(TOLD).map(|f| format!("{f:.4e}"));
        Some(told.collect::<Vec<String>>().join(", "))
    };
    let unknown = || "none, as its stiffness or mass is singular".to_owned();
    let shells = document.bodies.iter().filter_map(|(name, body)| {
        let elements = body.elements.as_ref()?;
        let mesh = elements::prepared(document, elements).mesh.clone();
        let (nodes, count) = (mesh.nodes.len(), mesh.coordinates);
        let shells = mesh.elements.len();
        Some(format!(
            "shells \"{name}\": {count} coordinates of {nodes} nodes of {shells} elements"
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
