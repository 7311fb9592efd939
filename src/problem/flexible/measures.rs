//! Quantities of flexible bodies for functions: displacements, section forces, stresses.

use super::{Elastic, FlexibleBodies, Shells};
use crate::aggregates::rho_of;
use crate::functions::instant::DeformationKind;
use crate::functions::stations::Largest;
use crate::functions::{Bound, Instant};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::flexible::Quadratic;
use crate::parts::line_of;
use crate::placement::Assembly;
use crate::schema::Document;
use crate::schema::measured::{
    Bound as Side, LargestFibreStress, LargestSectionForce, SectionComponent, SectionPlace,
    SectionPlaces, Sign,
};
use crate::structures::beam::Section;
use crate::structures::beam_sections::BeamLine;
use crate::structures::modal::sections::SectionForce;

impl<S: Scalar> FlexibleBodies<S> {
    fn of(&self, body: usize) -> &Elastic<S> {
        let found = self.bodies.iter().find(|elastic| elastic.frame == body);
        found.expect("a function of elastic coordinates is of such a body, which is checked")
    }

    fn shells_of(&self, body: usize) -> Option<&Shells> {
        self.shells.iter().find(|shells| shells.frame == body)
    }

    /// Its index among the flexible bodies of the model.
    pub fn index(&self, body: usize) -> usize {
        let shells = self.shells_of(body).map(|shells| shells.flexible);
        shells.unwrap_or_else(|| self.of(body).flexible)
    }

    /// Aggregate of the stress of a set of shells, or of all of a body.
    pub fn shell_stress(&self, body: usize, set: Option<&String>, rho: f64) -> Instant<S> {
        let shells = self.shells_of(body);
        let shells = shells.expect("a stress of shells is of such a body, which is checked");
        let all = || (0..shells.prepared.mesh.elements.len()).collect();
        Instant::ShellStress {
            flexible: shells.flexible,
            elements: set.map_or_else(all, |set| shells.prepared.sets.face_sets[set].clone()),
            rho,
        }
    }

    /// The displacement of a point from where it is in the undeformed body, along a direction in the
    /// body's axes.
    pub fn displacement(&self, body: usize, point: Vec3<S>, direction: Vec3<S>) -> Instant<S> {
        if let Some(shells) = self.shells_of(body) {
            let mut linear = vec![S::zero(); shells.prepared.coordinates()];
            if let Some((_, motion)) = shells.at(&point) {
                for (&i, n) in motion.coordinates.iter().zip(&motion.displacement) {
                    linear[i] = lift3(n).dot(&direction);
                }
            }
            let form = Quadratic {
                linear,
                squares: Vec::new(),
            };
            return of_coordinates(shells.flexible, DeformationKind::Displacement, form);
        }
        let Elastic {
            flexible, shapes, ..
        } = self.of(body);
        let modes = shapes.point(point);
        let along = modes.displacement.iter().map(|n| n.dot(&direction));
        let form = Quadratic {
            linear: along.collect(),
            squares: Vec::new(),
        };
        of_coordinates(*flexible, DeformationKind::Displacement, form)
    }

    /// The sections of a beam, or of beams of a body of elements: `set` of them, or all.
    pub fn sections(
        &self,
        document: &Document,
        (name, body): (&str, usize),
        set: Option<&String>,
        x: &[S],
    ) -> Sections<'_, S> {
        let Some(shells) = self.shells_of(body) else {
            return Sections::OfBeam(self.of(body));
        };
        let elements = document.bodies[name].elements.as_ref();
        let elements = elements.expect("a body of elements is written as one");
        let line = line_of(document, elements, &shells.prepared, (set, x));
        Sections::OfElements(shells.flexible, line)
    }
}

/// The sections of a beam whose forces and stresses are measured.
pub enum Sections<'a, S> {
    /// Of a beam with functions.
    OfBeam(&'a Elastic<S>),
    /// Of beams among the elements of a flexible body, an index into those of the model.
    OfElements(usize, BeamLine<S>),
}

impl<S: Scalar> Sections<'_, S> {
    /// A section force or moment.
    pub fn force(&self, component: SectionComponent, station: S) -> Instant<S> {
        use DeformationKind::{Force, Moment};
        // N, V2, V3, T, M2, M3 of elements, whose y and z are axes 2 and 3 of the section.
        let (force, number, kind) = match component {
            SectionComponent::Axial => (SectionForce::Axial, 0, Force),
            SectionComponent::ShearY => (SectionForce::ShearY, 1, Force),
            SectionComponent::ShearZ => (SectionForce::ShearZ, 2, Force),
            SectionComponent::Torsion => (SectionForce::Torsion, 3, Moment),
            SectionComponent::BendingY => (SectionForce::BendingY, 4, Moment),
            SectionComponent::BendingZ => (SectionForce::BendingZ, 5, Moment),
        };
        match self {
            Self::OfBeam(own) => {
                let form = own.shapes.beam().section_force(force, station);
                of_coordinates(own.flexible, kind, form)
            }
            Self::OfElements(flexible, line) => {
                let form = line.force(number, station);
                of_unknowns((*flexible, line), kind, form)
            }
        }
    }

    /// The stress along a fibre, at parts of half the section's size.
    pub fn stress(&self, station: S, fibre: [f64; 2]) -> Instant<S> {
        let kind = DeformationKind::Stress;
        match self {
            Self::OfBeam(own) => {
                let beam = own.shapes.beam();
                let half = beam.half_sizes();
                let half = half.expect("a section with stresses has a size, which is checked");
                let place = [half[0] * fibre[0], half[1] * fibre[1]];
                of_coordinates(own.flexible, kind, beam.fibre_stress(station, place))
            }
            Self::OfElements(flexible, line) => {
                let form = line.stress(fibre, station);
                of_unknowns((*flexible, line), kind, form)
            }
        }
    }

    /// The outer fibres of a section.
    fn outer(&self, station: S) -> &'static [[f64; 2]] {
        let round = match self {
            Self::OfBeam(own) => matches!(own.shapes.beam().section, Section::Tube { .. }),
            Self::OfElements(_, line) => line.is_round(station),
        };
        outer_fibres(round)
    }

    /// The largest section force or moment of several sections.
    pub fn largest_force(&self, of: &LargestSectionForce, stations: &[S]) -> Instant<S> {
        let all = stations.iter().map(|&at| self.force(of.component, at));
        largest(all, (of.sign, rho_of(of.rho), of.bound))
    }

    /// The largest stress of several sections and fibres.
    pub fn largest_stress(&self, of: &LargestFibreStress, stations: &[S]) -> Instant<S> {
        let at = |&station: &S| {
            let fibres = of.fibres.as_deref().unwrap_or(self.outer(station));
            fibres.iter().map(move |&fibre| self.stress(station, fibre))
        };
        largest(
            stations.iter().flat_map(at),
            (of.sign, rho_of(of.rho), of.bound),
        )
    }
}

fn of_coordinates<S>(flexible: usize, kind: DeformationKind, form: Quadratic<S>) -> Instant<S> {
    Instant::Deformation {
        flexible,
        kind,
        unknowns: None,
        form,
    }
}

fn of_unknowns<S>(
    (flexible, line): (usize, &BeamLine<S>),
    kind: DeformationKind,
    form: Quadratic<S>,
) -> Instant<S> {
    Instant::Deformation {
        flexible,
        kind,
        unknowns: Some(line.unknowns.clone()),
        form,
    }
}

/// The named sections of a line of elements.
pub const START: &str = "start";
pub const END: &str = "end";

/// The outermost fibres of a rectangle and of an I.
const CORNERS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
/// Fibres around a tube.
const ROUND: [[f64; 2]; 8] = {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [HALF, HALF],
        [0.0, 1.0],
        [-HALF, HALF],
        [-1.0, 0.0],
        [-HALF, -HALF],
        [0.0, -1.0],
        [HALF, -HALF],
    ]
};

/// The outer fibres of a section, round or not, in parts of half its size.
pub fn outer_fibres(round: bool) -> &'static [[f64; 2]] {
    if round { &ROUND } else { &CORNERS }
}

/// The largest of several measures of one beam.
fn largest<S: Scalar>(
    all: impl Iterator<Item = Instant<S>>,
    (sign, rho, bound): (Option<Sign>, f64, Option<Side>),
) -> Instant<S> {
    let mut found = None;
    let mut largest = Largest {
        forms: Vec::new(),
        signs: Vec::new(),
        rho,
        bound: match bound {
            None | Some(Side::Below) => Bound::Below,
            Some(Side::Above) => Bound::Above,
        },
    };
    for instant in all {
        let Instant::Deformation {
            flexible,
            kind,
            unknowns,
            form,
        } = instant
        else {
            unreachable!("section forces and stresses are deformations");
        };
        found = Some((flexible, kind, unknowns));
        for &factor in sign.unwrap_or_default().factors() {
            largest.forms.push(form.clone());
            largest.signs.push(factor);
        }
    }
    let (flexible, kind, unknowns) = found.expect("there is a section, which is checked");
    Instant::LargestDeformation {
        flexible,
        kind,
        unknowns,
        largest,
    }
}

/// Where several sections are, as fractions of the length.
pub fn stations<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    body: &str,
    places: &SectionPlaces,
) -> Vec<S> {
    match places {
        SectionPlaces::Count(count) => {
            let last = (count - 1) as f64;
            (0..*count).map(|k| S::from(k as f64 / last)).collect()
        }
        SectionPlaces::List(all) => {
            let one = |place| station(document, assembly, body, place);
            all.iter().map(one).collect()
        }
    }
}

/// Where a section is, as a fraction of the length.
pub fn station<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    body: &str,
    place: &SectionPlace,
) -> S {
    match place {
        SectionPlace::Fraction(fraction) => assembly.quantity(fraction),
        SectionPlace::Named(name) => match &document.bodies[body].beam {
            Some(beam) => {
                let station = beam.station(name);
                assembly.quantity(&station.expect("stations are checked"))
            }
            None => S::from(if name == END { 1.0 } else { 0.0 }),
        },
    }
}
