//! Bodies with elastic coordinates in a scene: the body that is their frame, their coordinates, and the
//! points that joints, loads and functions hold on to.

mod described;
mod measures;
mod shapes;

pub use described::described;
pub use measures::{END, START, Sections, outer_fibres, station, stations};

use super::elements;
use super::placement::Assembly;
use crate::functions::{Function, TerminalEvent};
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::controller::Coordinate;
use crate::model::finite::FiniteElements;
use crate::model::flexible::Modes;
use crate::model::flexible::{Form, Inertia, Modal};
use crate::model::{ConstraintRow, JointFrame, LoadKind, Model, RigidBody};
use crate::prepared::Prepared;
use crate::schema::Document;
use crate::schema::elements::ElementInertia;
use crate::schema::loads::Load;
use crate::structures::floating::{NodeMotion, PointMotion};
use crate::system::placement::length_scale;
use shapes::{Shapes, Weighed, start, weighed};
use std::sync::Arc;

/// A body with elastic coordinates.
pub struct Elastic<S> {
    /// The body that is its frame.
    frame: usize,
    /// Its index among those of the model.
    flexible: usize,
    shapes: Shapes<S>,
}

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

/// A point that a joint, load or function holds.
struct Interface<S> {
    flexible: usize,
    point: Vec3<S>,
    /// The body that stands for the point.
    body: usize,
}

/// Points of a body are the same up to this distance, relative to the length scale. Their real parts decide, so that a scene
/// and its derivatives have the same bodies.
const SAME: f64 = 1e-12;

fn is_same<S: Scalar>(length: f64, [p, q]: [&Vec3<S>; 2]) -> bool {
    (p - q).map(|x| x.re().abs()).max() <= SAME * length
}

/// Whether points that are the same differ in their infinitesimal parts by more than round-off: a variable moves them apart.
fn part_company<S: Scalar>(frame: &RigidBody<S>, length: f64, [p, q]: [&Vec3<S>; 2]) -> bool {
    let size = |v: &Vec3<S>| v.map(|x| x.infinitesimal().abs()).max();
    let turned = frame.orientation.iter();
    let turned = turned.fold(0.0_f64, |most, x| most.max(x.infinitesimal().abs()));
    let moved = size(&frame.position) + length * turned + size(p) + size(q);
    size(&(p - q)) > 1e-9 * moved
}

/// What holds a point of a body, by its number in the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holder {
    Joint(usize),
    Load(usize),
    Function(usize),
    Until,
}

/// A place that something holds on a flexible body.
#[derive(Clone, Debug)]
pub struct HeldPlace<S> {
    pub holder: Holder,
    /// The body.
    pub body: usize,
    /// The place in the undeformed body, body axes \[m\].
    pub point: Vec3<S>,
}

/// The bodies with elastic coordinates of a scene.
pub struct FlexibleBodies<S> {
    bodies: Vec<Elastic<S>>,
    shells: Vec<Shells>,
    interfaces: Vec<Interface<S>>,
    /// The places that joints, loads and functions hold.
    pub places: Vec<HeldPlace<S>>,
    /// A body on which a variable moves two places apart that are the same at this design.
    pub apart: Option<String>,
    /// Length scale of the scene, if it has bodies with interfaces at any point \[m\].
    length: f64,
}

/// The numbers of the flexible bodies of a document, each kind in the order of the bodies.
pub struct Numbers<S> {
    /// Beams and bodies of files.
    shapes: Vec<Weighed<S>>,
    finite: Vec<FiniteElements<S>>,
}

/// The frame of a node that an interface follows, how it moves, and the rows that hold nothing: a node of two
/// rotations follows but for the turn about the normal of its surface.
fn tie<S: Scalar>(
    node: &NodeMotion,
    places: &[(usize, usize)],
) -> (JointFrame<S>, Modes<S>, Vec<ConstraintRow>) {
    let mut modes = Modes {
        places: Vec::new(),
        displacement: Vec::new(),
        rotation: Vec::new(),
        profile: None,
    };
    for (k, coordinate) in node.displacements.iter().enumerate() {
        if let Some(coordinate) = coordinate {
            modes.places.push(places[*coordinate]);
            modes.displacement.push(Vec3::ith(k, S::one()));
            modes.rotation.push(Vec3::zeros());
        }
    }
    for (coordinate, rotation) in &node.rotations {
        modes.places.push(places[*coordinate]);
        modes.displacement.push(Vec3::zeros());
        modes.rotation.push(lift3(rotation));
    }
    let (axes, left_out) = match &node.rotations[..] {
        [(_, a), (_, b)] => {
            let (a, b) = (a.normalize(), b.normalize());
            let about_normal = ConstraintRow::Aligned { a: 0, b: 1 };
            ([a, b, a.cross(&b)], vec![about_normal])
        }
        _ => ([0, 1, 2].map(|k| Vec3::ith(k, 1.0)), Vec::new()),
    };
    let frame = JointFrame {
        point: lift3(&node.place),
        axes: axes.map(|axis| lift3(&axis)),
        length: S::zero(),
    };
    (frame, modes, left_out)
}

impl<S: Scalar> FlexibleBodies<S> {
    /// The numbers of the flexible bodies of a document; gives their frames mass and inertia.
    pub fn weigh(document: &Document, model: &mut Model<S>, x: &[S]) -> Numbers<S> {
        let (mut shapes, mut finite) = (Vec::new(), Vec::new());
        for (own, body) in model.bodies.iter_mut().zip(document.bodies.values()) {
            if let Some(elements) = &body.elements {
                let numbers = elements::finite(document, elements, x);
                (own.mass, own.inertia) = numbers.rigid();
                finite.push(numbers);
            } else if let Some((of, numbers)) = weighed(body, x) {
                (own.mass, own.inertia) = (numbers.mass, numbers.inertia);
                shapes.push((of, numbers));
            }
        }
        Numbers { shapes, finite }
    }

    /// Gives the flexible bodies of a document their elastic coordinates, and moves joints and loads from them to
    /// their points. The bodies of `model` are at their start.
    pub fn add(
        document: &Document,
        assembly: &Assembly<S>,
        model: &mut Model<S>,
        numbers: Numbers<S>,
        x: &[S],
    ) -> Self {
        let mut all = Self {
            bodies: Vec::new(),
            shells: Vec::new(),
            interfaces: Vec::new(),
            places: Vec::new(),
            apart: None,
            length: match numbers.shapes.is_empty() {
                true => 0.0,
                false => length_scale(model),
            },
        };
        let bodies = document.bodies.values().enumerate();
        let meshed = bodies.filter_map(|(frame, body)| Some((frame, body.elements.as_ref()?)));
        for ((frame, elements), finite) in meshed.zip(numbers.finite) {
            let prepared = elements::prepared(document, elements);
            let still = vec![S::zero(); prepared.coordinates()];
            let form = match &prepared.reduced {
                None => Form::Finite(finite),
                Some(reduced) => Form::Modal(reduced.shells.modal(finite)),
            };
            let flexible = model.add_flexible(frame, (&still, &still), form);
            model.flexible[flexible].inertia = match elements.inertia {
                ElementInertia::Full => Inertia::Full,
                ElementInertia::Paper => Inertia::Paper,
            };
            all.shells.push(Shells {
                frame,
                flexible,
                prepared,
            });
        }
        let bodies = document.bodies.values().enumerate();
        let weighed = bodies.filter(|(_, body)| body.beam.is_some() || body.modal.is_some());
        for ((frame, body), (shapes, numbers)) in weighed.zip(numbers.shapes) {
            let [elastic, rates] = start(body, numbers.modes(), x);
            let flexible = model.add_flexible(
                frame,
                (&elastic, &rates),
                Form::Modal(Modal {
                    inertia: numbers.shapes,
                    stiffness: numbers.stiffness,
                    damping: numbers.damping,
                    viscosity: numbers.viscosity,
                    shells: None,
                    sections: shapes.sections(),
                }),
            );
            all.bodies.push(Elastic {
                frame,
                flexible,
                shapes,
            });
        }
        if !model.flexible.is_empty() {
            all.hold_ties(model);
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
            if let Some(nodes) = shells.prepared.ties.get(name) {
                let places: Vec<_> = model.flexible[flexible].places().collect();
                let ties = nodes.iter().map(|node| tie(node, &places)).collect();
                let body = model.tie(flexible, name, lift3(&motion.place), ties);
                self.interfaces.push(Interface {
                    flexible,
                    point,
                    body,
                });
                return Some(body);
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
        let known = (self.interfaces.iter()).find(|known| {
            known.flexible == flexible && is_same(self.length, [&known.point, &point])
        });
        if let Some(known) = known {
            let frame = &model.bodies[body];
            if part_company(frame, self.length, [&known.point, &point]) {
                self.apart = Some(frame.name.clone());
            }
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

    /// Adds the points all of whose nodes follow, whatever holds them.
    fn hold_ties(&mut self, model: &mut Model<S>) {
        let of = |shells: &Shells| {
            let (frame, prepared) = (shells.frame, shells.prepared.clone());
            let names: Vec<String> = prepared.ties.keys().cloned().collect();
            names
                .into_iter()
                .map(move |name| (frame, prepared.points[&name].place))
        };
        let all: Vec<(usize, Vec3<f64>)> = self.shells.iter().flat_map(of).collect();
        for (frame, place) in all {
            self.hold(model, frame, lift3(&place));
        }
    }

    /// Moves a place to the body that stands for it.
    fn move_place(
        &mut self,
        model: &mut Model<S>,
        holder: Holder,
        body: &mut usize,
        point: &mut Vec3<S>,
    ) {
        if model
            .flexible
            .iter()
            .any(|flexible| flexible.frame == *body)
        {
            self.places.push(HeldPlace {
                holder,
                body: *body,
                point: *point,
            });
        }
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
            self.move_place(model, Holder::Joint(k), &mut body, &mut point);
            (model.joints[k].body_a, model.joints[k].frame_a.point) = (body, point);
            if let Some(mut body) = model.joints[k].body_b {
                let mut point = model.joints[k].frame_b.point;
                self.move_place(model, Holder::Joint(k), &mut body, &mut point);
                model.joints[k].body_b = Some(body);
                model.joints[k].frame_b.point = point;
            }
        }
    }

    fn move_loads(&mut self, document: &Document, assembly: &Assembly<S>, model: &mut Model<S>) {
        for (k, written) in document.loads.values().enumerate() {
            let mut kind = model.loads[k].kind.clone();
            let load = Holder::Load(k);
            match &mut kind {
                LoadKind::Force { body, point, .. } | LoadKind::Drag { body, point, .. } => {
                    self.move_place(model, load, body, point)
                }
                LoadKind::Spring {
                    body_a,
                    body_b,
                    point_a,
                    point_b,
                    ..
                }
                | LoadKind::DistanceStop {
                    body_a,
                    body_b,
                    point_a,
                    point_b,
                    ..
                } => {
                    self.move_place(model, load, body_a, point_a);
                    if let Some(body) = body_b {
                        self.move_place(model, load, body, point_b);
                    }
                }
                LoadKind::Contact(own) => {
                    self.move_place(model, load, &mut own.body_a, &mut own.point_a);
                    if let Some(body) = &mut own.body_b {
                        self.move_place(model, load, body, &mut own.point_b);
                    }
                }
                LoadKind::Cable(own) => {
                    for own in &mut own.points {
                        if let Some(body) = &mut own.body {
                            self.move_place(model, load, body, &mut own.point);
                        }
                    }
                }
                LoadKind::Torque { body, .. } => {
                    if let Load::Torque(torque) = written
                        && let Some(point) = &torque.point
                    {
                        let mut point = assembly.in_body(&torque.body, point);
                        self.move_place(model, load, body, &mut point);
                    }
                }
                LoadKind::Controller(own) => {
                    let coordinates = own.feedback.iter_mut().map(|own| &mut own.coordinate);
                    for coordinate in coordinates {
                        let Coordinate::Distance {
                            body_a,
                            body_b,
                            point_a,
                            point_b,
                        } = coordinate
                        else {
                            continue;
                        };
                        self.move_place(model, load, body_a, point_a);
                        if let Some(body) = body_b {
                            self.move_place(model, load, body, point_b);
                        }
                    }
                    for own in &mut own.weights {
                        self.move_place(model, load, &mut own.body, &mut own.point);
                    }
                }
                // These act on joints, which have moved, or on all nodes.
                LoadKind::TorsionSpring { .. }
                | LoadKind::Damping { .. }
                | LoadKind::BallDamping { .. }
                | LoadKind::Bushing { .. }
                | LoadKind::Friction { .. }
                | LoadKind::JointStop { .. }
                | LoadKind::Distributed(_) => {}
            }
            model.loads[k].kind = kind;
        }
    }

    /// Moves the points that functions observe to the points of these bodies.
    pub fn move_functions(
        &mut self,
        model: &mut Model<S>,
        functions: &mut [Function<S>],
        until: &mut Option<TerminalEvent<S>>,
    ) {
        if model.flexible.is_empty() {
            return;
        }
        let mut visit = |holder: Holder, body: &mut usize, point: Option<&mut Vec3<S>>| {
            if let Some(point) = point {
                self.move_place(model, holder, body, point);
            }
        };
        for (f, function) in functions.iter_mut().enumerate() {
            function.for_each_place(&mut |body, point| visit(Holder::Function(f), body, point));
        }
        if let Some(until) = until {
            let measure = &mut until.measure;
            measure.for_each_place(&mut |body, point| visit(Holder::Until, body, point));
        }
    }
}
