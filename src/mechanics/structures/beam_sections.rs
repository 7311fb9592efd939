//! Section forces, moments and fibre stresses of beams of elements as quadratic forms of unknowns of nodes.
//!
//! Strains are most accurate at the two Gauss points of an element, r = ±1/√3 (Barlow 1976). At other places of it they
//! are linear between and beyond these:
//!
//! ```text
//! e(r) = ½ (1 − √3 r) e(−1/√3) + ½ (1 + √3 r) e(1/√3)
//! N = EA e_1,  V2 = GA2 e_2,  V3 = GA3 e_3,  T = GJ e_4,  M2 = EI2 e_5,  M3 = EI3 e_6,  σ = E (e_1 − y e_6 + z e_5)
//! ```
//!
//! They act on the end of a part whose axis t points out of it. y and z are distances from the centre of the section
//! along its axes 2 and 3.

use super::beam::{Beam, Section};
use super::floating::NodeMotion;
use super::parts::{coordinates, strains};
use crate::math::{Scalar, Vec3};
use crate::model::shapes::Quadratic;
use std::sync::Arc;

/// Strains of a Gauss point.
const STRAINS: usize = 6;
/// e_1, e_5 and e_6.
const AXIAL: usize = 0;
const CURVATURE_2: usize = 4;
const CURVATURE_3: usize = 5;

/// Beams one after the other, whose sections are looked at.
pub struct BeamLine<S> {
    /// Unknowns of the nodes of all beams.
    pub unknowns: Arc<[usize]>,
    beams: Vec<OfLine<S>>,
}

struct OfLine<S> {
    /// Strains of both points over the unknowns of the line.
    strains: Vec<Quadratic<S>>,
    /// EA, GA2, GA3, GJ, EI2, EI3.
    stiffness: [S; STRAINS],
    young: S,
    section: Section<S>,
}

impl<S: Scalar> BeamLine<S> {
    /// Beams with their nodes.
    pub fn new(beams: &[([NodeMotion; 3], Beam<S>)]) -> Self {
        let own = beams.iter().map(|(nodes, _)| coordinates(nodes));
        let own: Vec<Vec<usize>> = own.collect();
        let mut unknowns = own.concat();
        unknowns.sort_unstable();
        unknowns.dedup();
        let one = |((nodes, beam), own): (&([NodeMotion; 3], Beam<S>), &Vec<usize>)| {
            let spread = |row: &[S]| {
                let mut out = vec![S::zero(); unknowns.len()];
                for (x, unknown) in row.iter().zip(own) {
                    let place = unknowns.binary_search(unknown);
                    out[place.expect("the line has the unknowns of its beams")] = *x;
                }
                out
            };
            let strains = strains(nodes, beam).into_iter().map(|own| Quadratic {
                linear: spread(&own.strain.linear),
                squares: (own.strain.squares.iter())
                    .map(|(c, g)| (*c, spread(g)))
                    .collect(),
            });
            OfLine {
                strains: strains.collect(),
                stiffness: beam.section.values(&beam.material).stiffness,
                young: beam.material.young,
                section: beam.section,
            }
        };
        Self {
            beams: beams.iter().zip(&own).map(one).collect(),
            unknowns: unknowns.into(),
        }
    }

    /// A beam at rest in its structure. Unknown 6 a + k is the displacement (k < 3) or the rotation of node a along an axis.
    pub fn at_rest(beam: Beam<S>) -> Self {
        let node = |a: usize| NodeMotion {
            place: beam.points[a].map(|x| x.re()),
            displacements: [0, 1, 2].map(|k| Some(6 * a + k)),
            rotations: (0..3).map(|k| (6 * a + 3 + k, Vec3::ith(k, 1.0))).collect(),
        };
        Self::new(&[([node(0), node(1), node(2)], beam)])
    }

    /// The beam at a fraction of the line, and the weights of the strains of its two points.
    fn at(&self, fraction: S) -> (&OfLine<S>, [S; 2]) {
        let count = self.beams.len();
        let place = fraction * count as f64;
        let index = (place.re().max(0.0) as usize).min(count - 1);
        let across = ((place - S::from(index as f64)) * 2.0 - S::one()) * 3.0_f64.sqrt();
        (
            &self.beams[index],
            [(S::one() - across) * 0.5, (S::one() + across) * 0.5],
        )
    }

    /// Force or moment `k` of N, V2, V3, T, M2, M3 in the section at a fraction of the line.
    pub fn force(&self, k: usize, fraction: S) -> Quadratic<S> {
        let (beam, weights) = self.at(fraction);
        let parts = [0, 1].map(|p| (beam.stiffness[k] * weights[p], STRAINS * p + k));
        beam.sum(&parts)
    }

    /// Stress \[Pa\] along a fibre, given in parts of half the size of the section along its axes.
    pub fn stress(&self, [y, z]: [f64; 2], fraction: S) -> Quadratic<S> {
        let (beam, weights) = self.at(fraction);
        let half = half_sizes(&beam.section)
            .expect("sections with stresses have a size, which is checked");
        let mut parts = Vec::with_capacity(6);
        for (p, weight) in weights.into_iter().enumerate() {
            let own = beam.young * weight;
            parts.push((own, STRAINS * p + AXIAL));
            parts.push((own * half[1] * z, STRAINS * p + CURVATURE_2));
            parts.push((-(own * half[0] * y), STRAINS * p + CURVATURE_3));
        }
        beam.sum(&parts)
    }

    /// Whether all sections have a size, which stresses need.
    pub fn has_sizes(&self) -> bool {
        let mut sections = self.beams.iter().map(|beam| &beam.section);
        sections.all(|section| half_sizes(section).is_some())
    }

    /// Whether the section at a fraction of the line is round.
    pub fn is_round(&self, fraction: S) -> bool {
        match self.at(fraction).0.section {
            Section::Tube { .. } => true,
            Section::Rectangle { .. } | Section::I { .. } | Section::Given(_) => false,
        }
    }
}

impl<S: Scalar> OfLine<S> {
    /// Σ factor · strain.
    fn sum(&self, parts: &[(S, usize)]) -> Quadratic<S> {
        let mut out = Quadratic {
            linear: vec![S::zero(); self.strains[0].linear.len()],
            squares: Vec::new(),
        };
        for &(factor, k) in parts {
            let own = &self.strains[k];
            crate::math::slices::add_scaled(&mut out.linear, factor, &own.linear);
            let squares = own.squares.iter();
            out.squares
                .extend(squares.map(|(c, g)| (*c * factor, g.clone())));
        }
        out
    }
}

/// Half the size of a section along its axes 2 and 3 \[m\]; none for given stiffnesses.
fn half_sizes<S: Scalar>(section: &Section<S>) -> Option<[S; 2]> {
    match *section {
        Section::Rectangle { width, height } | Section::I { width, height, .. } => {
            Some([width * 0.5, height * 0.5])
        }
        Section::Tube { radius, .. } => Some([radius, radius]),
        Section::Given(_) => None,
    }
}
