//! What functions look at on flexible bodies: displacements, section forces, stresses.

use super::{Elastic, FlexibleBodies, Shells};
use crate::functions::instant::DeformationKind;
use crate::functions::stations::Largest;
use crate::functions::{Bound, Instant};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::flexible::Quadratic;
use crate::problem::placement::Assembly;
use crate::problem::schema::Document;
use crate::problem::schema::measured::{
    Bound as Side, LargestFibreStress, LargestSectionForce, SectionComponent, SectionPlace,
    SectionPlaces, Sign,
};
use crate::structures::beam::Section;
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
    pub(crate) fn index(&self, body: usize) -> usize {
        let shells = self.shells_of(body).map(|shells| shells.flexible);
        shells.unwrap_or_else(|| self.of(body).flexible)
    }

    /// Aggregate of the stress of a set of shells, or of all of a body.
    pub(crate) fn shell_stress(&self, body: usize, set: Option<&String>, rho: f64) -> Instant<S> {
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
    pub(crate) fn displacement(
        &self,
        body: usize,
        point: Vec3<S>,
        direction: Vec3<S>,
    ) -> Instant<S> {
        if let Some(shells) = self.shells_of(body) {
            let mut linear = vec![S::zero(); shells.prepared.coordinates()];
            if let Some((_, motion)) = shells.at(&point) {
                for (&i, n) in motion.coordinates.iter().zip(&motion.displacement) {
                    linear[i] = lift3(n).dot(&direction);
                }
            }
            return Instant::Deformation {
                flexible: shells.flexible,
                kind: DeformationKind::Displacement,
                form: Quadratic {
                    linear,
                    squares: Vec::new(),
                },
            };
        }
        let Elastic {
            flexible, shapes, ..
        } = self.of(body);
        let modes = shapes.point(point);
        Instant::Deformation {
            flexible: *flexible,
            kind: DeformationKind::Displacement,
            form: Quadratic {
                linear: modes
                    .displacement
                    .iter()
                    .map(|n| n.dot(&direction))
                    .collect(),
                squares: Vec::new(),
            },
        }
    }

    /// A section force or moment.
    pub(crate) fn section(
        &self,
        body: usize,
        component: SectionComponent,
        station: S,
    ) -> Instant<S> {
        use DeformationKind::{Force, Moment};
        let Elastic {
            flexible, shapes, ..
        } = self.of(body);
        let (force, kind) = match component {
            SectionComponent::Axial => (SectionForce::Axial, Force),
            SectionComponent::ShearY => (SectionForce::ShearY, Force),
            SectionComponent::ShearZ => (SectionForce::ShearZ, Force),
            SectionComponent::Torsion => (SectionForce::Torsion, Moment),
            SectionComponent::BendingY => (SectionForce::BendingY, Moment),
            SectionComponent::BendingZ => (SectionForce::BendingZ, Moment),
        };
        Instant::Deformation {
            flexible: *flexible,
            kind,
            form: shapes.beam().section_force(force, station),
        }
    }

    /// The largest section force or moment of several sections.
    pub(crate) fn largest_section(
        &self,
        body: usize,
        of: &LargestSectionForce,
        stations: &[S],
    ) -> Instant<S> {
        let all = stations
            .iter()
            .map(|&at| self.section(body, of.component, at));
        let settings = (of.sign, of.rho, of.bound);
        largest(all, settings)
    }

    /// The largest stress of several sections and fibres.
    pub(crate) fn largest_stress(
        &self,
        body: usize,
        of: &LargestFibreStress,
        stations: &[S],
    ) -> Instant<S> {
        let outer: &[[f64; 2]] = match &self.of(body).shapes.beam().section {
            Section::Tube { .. } => &ROUND,
            Section::Rectangle { .. } | Section::I { .. } | Section::Given(_) => &CORNERS,
        };
        let fibres = of.fibres.as_deref().unwrap_or(outer);
        let at = |station: S| {
            let fibre = move |fibre: &[f64; 2]| self.stress(body, station, fibre.map(S::from));
            fibres.iter().map(fibre)
        };
        let settings = (of.sign, of.rho, of.bound);
        largest(stations.iter().flat_map(|&station| at(station)), settings)
    }

    /// The stress along a fibre, at parts of half the section's height and width.
    pub(crate) fn stress(&self, body: usize, station: S, fibre: [S; 2]) -> Instant<S> {
        let Elastic {
            flexible, shapes, ..
        } = self.of(body);
        let beam = shapes.beam();
        let half = beam
            .half_sizes()
            .expect("a section with stresses has a size, which is checked");
        Instant::Deformation {
            flexible: *flexible,
            kind: DeformationKind::Stress,
            form: beam.fibre_stress(station, [half[0] * fibre[0], half[1] * fibre[1]]),
        }
    }
}

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

/// The largest of several measures of one beam.
fn largest<S: Scalar>(
    all: impl Iterator<Item = Instant<S>>,
    (sign, rho, bound): (Option<Sign>, f64, Option<Side>),
) -> Instant<S> {
    let mut found: Option<(usize, DeformationKind)> = None;
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
            form,
        } = instant
        else {
            unreachable!("section forces and stresses are deformations");
        };
        found = Some((flexible, kind));
        for &factor in sign.unwrap_or_default().factors() {
            largest.forms.push(form.clone());
            largest.signs.push(factor);
        }
    }
    let (flexible, kind) = found.expect("there is a section, which is checked");
    Instant::LargestDeformation {
        flexible,
        kind,
        largest,
    }
}

/// Where several sections are, as fractions of the length.
pub(crate) fn stations<S: Scalar>(
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
pub(crate) fn station<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    body: &str,
    place: &SectionPlace,
) -> S {
    match place {
        SectionPlace::Fraction(fraction) => assembly.quantity(fraction),
        SectionPlace::Named(name) => {
            let beam = document.bodies[body].beam.as_ref();
            let station = beam.and_then(|beam| beam.station(name));
            assembly.quantity(&station.expect("stations are checked"))
        }
    }
}
