//! Bodies with elastic coordinates in a scene: the body that is their frame, their coordinates, and the
//! points that joints, loads and functions hold on to.

use super::beam;
use super::elements;
use super::modal;
use super::placement::Assembly;
use super::prepared::Prepared;
use super::schema::Document;
use super::schema::flexible::Beam;
use super::schema::loads::Load;
use super::schema::measured::{
    Bound as Side, LargestFibreStress, LargestSectionForce, SectionComponent, SectionPlace,
    SectionPlaces, Sign,
};
use super::schema::mechanics::Body;
use crate::functions::instant::DeformationKind;
use crate::functions::stations::Largest;
use crate::functions::{Bound, Function, Instant, TerminalEvent};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::flexible::{Form, Modal, Quadratic};
use crate::model::{LoadKind, Model};
use crate::structures::beam::Section;
use crate::structures::floating::PointMotion;
use crate::structures::modal::frequencies::{Held, frequencies};
use crate::structures::modal::loaded::Loaded;
use crate::structures::modal::sections::SectionForce;
use crate::structures::modal::{FlexibleBeam, ModalNumbers, PointModes};
use std::sync::Arc;

/// A body with elastic coordinates.
struct Elastic<S> {
    /// The body that is its frame.
    frame: usize,
    /// Its index among those of the model.
    flexible: usize,
    shapes: Shapes<S>,
}

/// How points of a body move with its elastic coordinates.
pub(crate) enum Shapes<S> {
    Beam(FlexibleBeam<S>),
    /// A body of files, and the factor of its lengths.
    Modal(Arc<Loaded>, S),
}

impl<S: Scalar> Shapes<S> {
    fn point(&self, point: Vec3<S>) -> PointModes<S> {
        match self {
            Self::Beam(beam) => beam.point(point.x / beam.length, [point.y, point.z]),
            Self::Modal(loaded, scale) => loaded.body.point(&point, *scale),
        }
    }

    fn beam(&self) -> &FlexibleBeam<S> {
        match self {
            Self::Beam(beam) => beam,
            Self::Modal(..) => unreachable!("sections are those of beams, which is checked"),
        }
    }
}

/// The shapes and numbers of a beam or of a body of files at the design `x`.
fn weighed<S: Scalar>(body: &Body, x: &[S]) -> Option<Weighed<S>> {
    if let Some(written) = &body.beam {
        let beam = beam::beam(written, x);
        let numbers = beam.numbers();
        return Some((Shapes::Beam(beam), numbers));
    }
    let written = body.modal.as_ref()?;
    let loaded = written.loaded.clone()?;
    let shapes = Shapes::Modal(loaded, modal::scale(written, x));
    Some((shapes, modal::numbers(written, x)))
}

/// The coordinates of such a body and their rates at the start.
fn start<S: Scalar>(body: &Body, count: usize, x: &[S]) -> [Vec<S>; 2] {
    let of_beam = body.beam.as_ref().map(|beam| beam::start(beam, x));
    let written = body.modal.as_ref().and_then(|modal| modal.start.as_ref());
    of_beam.unwrap_or_else(|| modal::start(written, count, x))
}

/// The shapes of a body and its numbers.
pub(crate) type Weighed<S> = (Shapes<S>, ModalNumbers<S>);

/// A body of finite elements.
struct Shells {
    /// The body that is its frame.
    frame: usize,
    /// Its index among those of the model.
    flexible: usize,
    prepared: Arc<Prepared>,
}

/// How far a place may be from a named point, as a part of the size of the body.
const SAME_PLACE: f64 = 1e-6;

impl Shells {
    /// The named point at a place, and its name.
    fn at<S: Scalar>(&self, place: &Vec3<S>) -> Option<(&String, &PointMotion)> {
        let place = place.map(Scalar::re);
        let nodes = self.prepared.mesh.nodes.iter();
        let size = nodes.fold(0.0_f64, |size, node| size.max(node.norm()));
        let same = |motion: &PointMotion| (motion.place - place).norm() <= SAME_PLACE * size;
        let mut points = self.prepared.points.iter();
        points.find(|(_, motion)| same(motion))
    }
}

/// A point that something holds on to.
struct Interface<S> {
    flexible: usize,
    point: Vec3<S>,
    /// The body that stands for the point.
    body: usize,
}

/// The bodies with elastic coordinates of a scene.
pub(crate) struct FlexibleBodies<S> {
    bodies: Vec<Elastic<S>>,
    shells: Vec<Shells>,
    interfaces: Vec<Interface<S>>,
}

impl<S: Scalar> FlexibleBodies<S> {
    /// The beams and bodies of files of a document with their numbers; gives their frames mass and inertia.
    pub(crate) fn weigh(document: &Document, model: &mut Model<S>, x: &[S]) -> Vec<Weighed<S>> {
        let mut all = Vec::new();
        for (frame, body) in document.bodies.values().enumerate() {
            if let Some((shapes, numbers)) = weighed(body, x) {
                model.bodies[frame].mass = numbers.mass;
                model.bodies[frame].inertia = numbers.inertia;
                all.push((shapes, numbers));
            }
        }
        all
    }

    /// Gives the flexible bodies of a document their elastic coordinates, and moves joints and loads from them to
    /// their points. The bodies of `model` are at their start.
    pub(crate) fn add(
        document: &Document,
        assembly: &Assembly<S>,
        model: &mut Model<S>,
        bodies_with_shapes: Vec<Weighed<S>>,
        x: &[S],
    ) -> Self {
        let mut all = Self {
            bodies: Vec::new(),
            shells: Vec::new(),
            interfaces: Vec::new(),
        };
        for (frame, body) in document.bodies.values().enumerate() {
            let Some(elements) = &body.elements else {
                continue;
            };
            let finite = elements::finite(document, elements, x);
            let (mass, inertia) = finite.rigid();
            model.bodies[frame].mass = mass;
            model.bodies[frame].inertia = inertia;
            let still = vec![S::zero(); finite.mesh.coordinates];
            let flexible = model.add_flexible(frame, (&still, &still), Form::Finite(finite));
            all.shells.push(Shells {
                frame,
                flexible,
                prepared: elements::prepared(document, elements),
            });
        }
        let bodies = document.bodies.values().enumerate();
        let weighed = bodies.filter(|(_, body)| body.beam.is_some() || body.modal.is_some());
        for ((frame, body), (shapes, numbers)) in weighed.zip(bodies_with_shapes) {
            let [elastic, rates] = start(body, numbers.modes(), x);
            let flexible = model.add_flexible(
                frame,
                (&elastic, &rates),
                Form::Modal(Modal {
                    inertia: numbers.shapes,
                    stiffness: numbers.stiffness,
                    damping: numbers.damping,
                }),
            );
            all.bodies.push(Elastic {
                frame,
                flexible,
                shapes,
            });
        }
        if !model.flexible.is_empty() {
            all.move_joints(model);
            all.move_loads(document, assembly, model);
        }
        all
    }

    /// The body that stands for a point of body `body`: itself, unless its points move on it.
    fn hold(&mut self, model: &mut Model<S>, body: usize, point: Vec3<S>) -> Option<usize> {
        if let Some(shells) = self.shells.iter().find(|shells| shells.frame == body) {
            let flexible = shells.flexible;
            let (name, motion) = shells.at(&point)?;
            let same = |known: &&Interface<S>| {
                known.flexible == flexible
                    && shells.at(&known.point).is_some_and(|(of, _)| of == name)
            };
            if let Some(known) = self.interfaces.iter().find(same) {
                return Some(known.body);
            }
            if motion.coordinates.is_empty() {
                return None;
            }
            let lift = |all: &[Vec3<f64>]| all.iter().map(lift3).collect();
            let modes = (lift(&motion.displacement), lift(&motion.rotation));
            let indices = Some(&motion.coordinates[..]);
            let body = model.attach(flexible, name, lift3(&motion.place), modes, indices);
            self.interfaces.push(Interface {
                flexible,
                point,
                body,
            });
            return Some(body);
        }
        let elastic = self.bodies.iter().find(|elastic| elastic.frame == body)?;
        let flexible = elastic.flexible;
        let known = (self.interfaces.iter())
            .find(|known| known.flexible == flexible && known.point == point);
        if let Some(known) = known {
            return Some(known.body);
        }
        let modes = elastic.shapes.point(point);
        let still = |all: &[Vec3<S>]| all.iter().all(|v| v.iter().all(|x| *x == S::zero()));
        if still(&modes.displacement) && still(&modes.rotation) {
            return None;
        }
        let [px, py, pz] = [point.x, point.y, point.z].map(|x| (x.re() * 1e6).round() / 1e6);
        let name = format!("point [{px}, {py}, {pz}]");
        let modes = (modes.displacement, modes.rotation);
        let body = model.attach(flexible, &name, point, modes, None);
        self.interfaces.push(Interface {
            flexible,
            point,
            body,
        });
        Some(body)
    }

    /// Moves a place to the body that stands for it.
    fn move_place(&mut self, model: &mut Model<S>, body: &mut usize, point: &mut Vec3<S>) {
        if let Some(interface) = self.hold(model, *body, *point) {
            *body = interface;
            *point = Vec3::zeros();
        }
    }

    fn move_joints(&mut self, model: &mut Model<S>) {
        for k in 0..model.joints.len() {
            if model.joints[k].modes.is_some() {
                continue;
            }
            let (mut body, mut point) = (model.joints[k].body_a, model.joints[k].frame_a.point);
            self.move_place(model, &mut body, &mut point);
            (model.joints[k].body_a, model.joints[k].frame_a.point) = (body, point);
            if let Some(mut body) = model.joints[k].body_b {
                let mut point = model.joints[k].frame_b.point;
                self.move_place(model, &mut body, &mut point);
                model.joints[k].body_b = Some(body);
                model.joints[k].frame_b.point = point;
            }
        }
    }

    fn move_loads(&mut self, document: &Document, assembly: &Assembly<S>, model: &mut Model<S>) {
        for (k, written) in document.loads.values().enumerate() {
            let mut kind = model.loads[k].kind.clone();
            match &mut kind {
                LoadKind::Force { body, point, .. } => self.move_place(model, body, point),
                LoadKind::Spring {
                    body_a,
                    body_b,
                    point_a,
                    point_b,
                    ..
                } => {
                    self.move_place(model, body_a, point_a);
                    if let Some(body) = body_b {
                        self.move_place(model, body, point_b);
                    }
                }
                LoadKind::Torque { body, .. } => {
                    if let Load::Torque(torque) = written
                        && let Some(point) = &torque.point
                    {
                        let mut point = assembly.in_body(&torque.body, point);
                        self.move_place(model, body, &mut point);
                    }
                }
                // These act on joints, which have moved.
                LoadKind::TorsionSpring { .. }
                | LoadKind::Damping { .. }
                | LoadKind::BallDamping { .. }
                | LoadKind::Friction { .. } => {}
            }
            model.loads[k].kind = kind;
        }
    }

    /// Moves what functions look at to the points of these bodies.
    pub(crate) fn move_functions(
        &mut self,
        model: &mut Model<S>,
        functions: &mut [Function<S>],
        until: &mut Option<TerminalEvent<S>>,
    ) {
        if model.flexible.is_empty() {
            return;
        }
        let mut visit = |body: &mut usize, point: Option<&mut Vec3<S>>| {
            if let Some(point) = point {
                self.move_place(model, body, point);
            }
        };
        for function in functions {
            function.for_each_place(&mut visit);
        }
        if let Some(until) = until {
            until.measure.for_each_place(&mut visit);
        }
    }

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
            let mut linear = vec![S::zero(); shells.prepared.mesh.coordinates];
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
