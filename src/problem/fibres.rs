//! Stresses along the outer fibres of beams, for figures and files of fields.

use super::beam;
use super::elements::prepared;
use super::flexible::outer_fibres;
use super::parts::lines;
use crate::model::flexible::Quadratic;
use crate::schema::Document;
use crate::schema::elements::Elements;
use crate::structures::beam::{Beam, Section};
use crate::structures::beam_sections::BeamLine;
use crate::structures::modal::FlexibleBeam;
use std::sync::Arc;

/// Straight pieces of a beam between the sections that are looked at.
pub(super) const SLICES: usize = 24;
/// Sections of a beam among elements: its start, middle and end.
const OF_ELEMENT: [f64; 3] = [0.0, 0.5, 1.0];

/// Stresses along the outer fibres of sections of a beam, from its start to its end.
#[derive(Clone, Debug)]
pub struct BeamFibres {
    /// The unknowns of nodes that the stresses depend on; none if they depend on all elastic coordinates.
    unknowns: Option<Arc<[usize]>>,
    /// By section, the stress along each outer fibre \[Pa\]. Empty for a section without size.
    sections: Vec<Vec<Quadratic<f64>>>,
}

impl BeamFibres {
    /// Whether stresses are known: the section has a size.
    pub fn are_known(&self) -> bool {
        !self.sections.is_empty()
    }

    /// Those of a beam among elements.
    fn of_line(line: BeamLine<f64>) -> Self {
        let along = |&at: &f64| {
            let places = outer_fibres(line.is_round(at)).iter();
            places.map(|&part| line.stress(part, at)).collect()
        };
        Self {
            sections: match line.has_sizes() {
                true => OF_ELEMENT.iter().map(along).collect(),
                false => Vec::new(),
            },
            unknowns: Some(line.unknowns),
        }
    }

    /// Those of a beam of a structure at rest, over the displacements and rotations of its nodes
    /// ([`BeamLine::at_rest`]); without the squares of displacements unless `von_karman`.
    pub fn at_rest(beam: Beam<f64>, von_karman: bool) -> Self {
        let mut all = Self::of_line(BeamLine::at_rest(beam));
        if !von_karman {
            let forms = all.sections.iter_mut().flatten();
            forms.for_each(|form| form.squares.clear());
        }
        all
    }

    /// The largest |σ| along the outer fibres of each section \[Pa\], at the elastic coordinates or unknowns of
    /// the nodes `q` of the body.
    pub fn largest(&self, q: &[f64]) -> Vec<f64> {
        let own: Vec<f64>;
        let q = match &self.unknowns {
            Some(unknowns) => {
                own = unknowns.iter().map(|&unknown| q[unknown]).collect();
                &own
            }
            None => q,
        };
        let of = |fibres: &Vec<Quadratic<f64>>| {
            let sizes = fibres.iter().map(|form| form.value(q).abs());
            sizes.fold(0.0, larger)
        };
        self.sections.iter().map(of).collect()
    }
}

/// The larger of two values; NaN if one of them is.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The beams of every body of a file: one of a beam, those among elements in the order of the mesh.
pub(super) fn fibres(document: &Document, x: &[f64]) -> Vec<Vec<BeamFibres>> {
    let bodies = document.bodies.values();
    bodies
        .map(|body| match (&body.beam, &body.elements) {
            (Some(written), _) => vec![of_beam(&beam::beam(written, x))],
            (None, Some(elements)) => of_elements(document, elements, x),
            (None, None) => Vec::new(),
        })
        .collect()
}

fn of_beam(beam: &FlexibleBeam<f64>) -> BeamFibres {
    let places = outer_fibres(matches!(beam.section, Section::Tube { .. }));
    let sections = beam.half_sizes().map(|half| {
        let along = |xi: f64| {
            let stress =
                |part: &[f64; 2]| beam.fibre_stress(xi, [half[0] * part[0], half[1] * part[1]]);
            places.iter().map(stress).collect()
        };
        let sections = (0..=SLICES).map(|k| along(k as f64 / SLICES as f64));
        sections.collect()
    });
    BeamFibres {
        unknowns: None,
        sections: sections.unwrap_or_default(),
    }
}

fn of_elements(document: &Document, elements: &Elements, x: &[f64]) -> Vec<BeamFibres> {
    let lines = lines(document, elements, &prepared(document, elements), x);
    lines.into_iter().map(BeamFibres::of_line).collect()
}
