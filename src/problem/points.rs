//! Points that bodies do not have: those away from a point mass, and those beyond the ends of a
//! beam.

use super::Problem;
use super::elements::{mesh_quantities, prepared};
use super::finding::Finding;
use super::flexible::{HeldPlace, Holder};
use super::joints::{at, holds_points};
use super::placement::Assembly;
use super::pointer::join;
use super::scene;
use crate::math::scalar::lift3;
use crate::math::{Dual, Scalar, Vec3};
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::contacts::Surface;
use crate::schema::joints::{Ends, Joint};
use crate::schema::loads::Load;
use crate::schema::mechanics::Shape;
use crate::system::placement::length_scale;

/// Two points are the same up to this distance, relative to the length scale.
const SAME: f64 = 1e-9;

/// The first beam that is held beyond its ends, where its shapes are not defined.
pub(super) fn off_beams(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start_numbers()).model;
    model.joints.iter().find_map(|joint| {
        joint.modes.as_ref()?;
        let (name, body) = problem.written.bodies.get_index(joint.body_a)?;
        let length = body.beam.as_ref()?.length.value;
        let x = joint.frame_a.point.x;
        let beyond = x < -SAME * length || x > length * (1.0 + SAME);
        beyond.then(|| {
            let found = format!("a joint, load or function at x = {x:.6} m of \"{name}\"");
            let expected = format!("places on the beam, x from 0 to {length} m");
            Finding::new(join(&join("/bodies", name), "beam"), found, expected)
        })
    })
}

/// The first mesh or material of shells that move that a variable changes.
pub(super) fn moved_meshes(problem: &Problem) -> Option<Finding> {
    let document = &problem.written;
    let moves = |quantities: &[Quantity]| quantities.iter().any(|q| q.variable.is_some());
    document.bodies.iter().find_map(|(name, body)| {
        let structure = &body.elements.as_ref()?.structure;
        let own = join(&join(&join("/bodies", name), "elements"), "structure");
        let mesh = moves(&mesh_quantities(&structure.mesh));
        let material = document.materials.get(&structure.material);
        let of_material = join("/materials", &structure.material);
        let poisson = material.map(|material| material.poisson);
        let yield_stress = material.and_then(|material| material.yield_stress);
        let all = [
            (join(&own, "mesh"), mesh),
            (join(&own, "at"), structure.at.is_some_and(|at| moves(&at))),
            (join(&of_material, "poisson"), moves(poisson.as_slice())),
            (
                join(&of_material, "yield_stress"),
                moves(yield_stress.as_slice()),
            ),
        ];
        let (place, _) = all.into_iter().find(|(_, moved)| *moved)?;
        let found = "a design variable in the mesh or material of shells that move";
        let expected = "thickness, density, Young's modulus or surface mass as variables";
        Some(Finding::new(place, found, expected))
    })
}

/// The first joint, load or function that holds shells where they have no named point.
pub(super) fn off_points(problem: &Problem) -> Option<Finding> {
    let document = &problem.written;
    let of = |body: usize| document.bodies.get_index(body)?.1.elements.as_ref();
    if !document.bodies.values().any(|body| body.elements.is_some()) {
        return None;
    }
    let twice = document.bodies.iter().find_map(|(name, body)| {
        let prepared = prepared(document, body.elements.as_ref()?);
        let points: Vec<_> = prepared.points.iter().collect();
        let size = prepared
            .mesh
            .nodes
            .iter()
            .fold(0.0_f64, |size, node| size.max(node.norm()));
        let (first, second) = (0..points.len()).find_map(|i| {
            let near = |j: &usize| (points[*j].1.place - points[i].1.place).norm() <= 1e-6 * size;
            (i + 1..points.len())
                .find(near)
                .map(|j| (points[i].0, points[j].0))
        })?;
        let pointer = join(&join(&join("/bodies", name), "elements"), "points");
        let found = format!("\"{second}\" where \"{first}\" is");
        let expected = "points at different places, as joints find them by their place";
        Some(Finding::new(join(&pointer, second), found, expected).of_key())
    });
    if twice.is_some() {
        return twice;
    }
    let (_, places) = scene::with_places(document, &problem.order, &problem.start_numbers());
    places.into_iter().find_map(|place| {
        let HeldPlace {
            holder,
            body,
            point,
        } = place;
        let pointer = pointer_of(document, holder);
        let prepared = prepared(document, of(body)?);
        let size = prepared
            .mesh
            .nodes
            .iter()
            .fold(0.0_f64, |size, node| size.max(node.norm()));
        let mut named = prepared.points.values();
        // A named point that still has the body itself is held by the frame.
        let known = named.any(|motion| (motion.place - point).norm() <= 1e-6 * size);
        let (name, _) = document.bodies.get_index(body)?;
        let [x, y, z] = [point.x, point.y, point.z].map(|x| (x * 1e6).round() / 1e6);
        (!known).then(|| {
            let found = format!("the place [{x}, {y}, {z}] of \"{name}\"");
            let names: Vec<&str> = prepared.points.keys().map(String::as_str).collect();
            let expected = format!(
                "a point that the \"elements\" of the body name: {}",
                names.join(", ")
            );
            Finding::new(pointer, found, expected)
        })
    })
}

/// Where the document has what holds a point.
fn pointer_of(document: &Document, holder: Holder) -> String {
    let within = |section: &str, name: Option<&String>| join(section, name.map_or("", |own| own));
    match holder {
        Holder::Joint(k) => within("/joints", document.joints.get_index(k).map(|own| own.0)),
        Holder::Load(k) => within("/loads", document.loads.get_index(k).map(|own| own.0)),
        Holder::Function(k) => within(
            "/functions",
            document.functions.get_index(k).map(|own| own.0),
        ),
        Holder::Until => "/simulation/until".to_owned(),
    }
}

/// A place moves with a variable if it does so by more than this part of the size of its body, for a
/// typical change of the variable.
const MOVES: f64 = 1e-9;

/// The first variable that moves a place off its node or interface: shapes are known at these alone.
pub(super) fn moved_places(problem: &Problem) -> Option<Finding> {
    let document = &problem.written;
    let mut bodies = document.bodies.values();
    if !bodies.any(|body| body.elements.is_some() || body.modal.is_some()) {
        return None;
    }
    let start = problem.start();
    problem.variables.iter().enumerate().find_map(|(i, variable)| {
        let seed = |(j, &x): (usize, &f64)| Dual::new(x, if i == j { 1.0 } else { 0.0 });
        let x: Vec<Dual> = start.iter().enumerate().map(seed).collect();
        let change = variable.scale.max(variable.start.abs());
        let (_, places) = scene::with_places(document, &problem.order, &problem.extended(&x));
        places.into_iter().find_map(|place| {
            let (name, body) = document.bodies.get_index(place.body)?;
            let (node, size) = match (&body.elements, &body.modal) {
                (Some(elements), _) => {
                    let nodes = &prepared(document, elements).mesh.nodes;
                    let size = nodes.iter().fold(0.0_f64, |size, node| size.max(node.norm()));
                    (place.point.map(|x| x.re().into()), size)
                }
                (None, Some(modal)) => {
                    let scale = super::modal::scale(modal, &x);
                    let point = place.point.map(|x| x.re());
                    let nearest = modal.body().nearest(&point, scale.re())?;
                    let node: Vec3<Dual> = lift3(&nearest.position);
                    (node * scale, modal.body().size() * scale.re())
                }
                (None, None) => return None,
            };
            let moved = (place.point - node).map(|x| x.infinitesimal()).norm() * change;
            (moved.is_nan() || moved > MOVES * size).then(|| {
                let of = pointer_of(document, place.holder);
                let paths = variable.paths.join(", ");
                let found = format!(
                    "the variable \"{}\" of {paths}, which moves the place of {of} on \"{name}\" off its node",
                    variable.name
                );
                let expected = "variables that leave such places at nodes or interfaces of their bodies";
                let hint = "name the point of the body instead of its coordinates, so that the place follows it";
                let pointer = join("/variables", &variable.name);
                Finding::new(pointer, found, expected).of_key().hint(Some(hint.into()))
            })
        })
    })
}

/// Distance of a place from an interface, relative to the size of its body, up to which it is there.
const AT_INTERFACE: f64 = 1e-6;

/// The first joint, load or function that holds a body from files away from its interfaces, or the
/// first joint or torque at an interface whose rotation is not known.
pub(super) fn off_interfaces(problem: &Problem) -> Option<Finding> {
    let written = &problem.written;
    if !written.bodies.values().any(|body| body.modal.is_some()) {
        return None;
    }
    let start = problem.start_numbers();
    let scene = problem.unlowered_scene::<f64>(&start);
    let near = |name: &str, point: &Vec3<f64>| {
        let modal = written.bodies.get(name)?.modal.as_ref()?;
        let (body, scale) = (modal.body(), super::modal::scale(modal, &start));
        let nearest = body.nearest(point, scale)?;
        let distance = (nearest.position * scale - point).norm();
        let there = distance <= AT_INTERFACE * body.size() * scale;
        Some((nearest, distance, there))
    };
    let beside = scene.model.joints.iter().find_map(|joint| {
        joint.modes.as_ref()?;
        let (name, _) = written.bodies.get_index(joint.body_a)?;
        let (nearest, distance, there) = near(name, &joint.frame_a.point)?;
        (!there).then(|| {
            let [x, y, z] = <[f64; 3]>::from(joint.frame_a.point);
            let found = format!(
                "a joint, load or function at [{x:.6}, {y:.6}, {z:.6}] m of \"{name}\", {distance:.3e} m from \
                 the interface \"{}\"",
                nearest.name
            );
            let expected = "places that are interfaces of the body";
            let pointer = join(&join("/bodies", name), "modal");
            Finding::new(pointer, found, expected).of_key()
        })
    });
    let assembly = Assembly::new(written, &problem.order, &start);
    let turned = || {
        written.joints.iter().find_map(|(key, joint)| {
            let place = joint.place().filter(|_| !holds_points(joint.kind()))?;
            joint.between().iter().find_map(|name| {
                let point = at(
                    &assembly,
                    place,
                    name,
                    usize::from(joint.between()[1] == *name),
                );
                let (nearest, ..) = near(name, &point)?;
                (!nearest.turns).then(|| {
                    let found = format!(
                        "the interface \"{}\" of \"{name}\", whose rotation is not known",
                        nearest.name
                    );
                    let pointer =
                        join(&join(&join("/joints", key), joint.kind().name()), "between");
                    let hint = "an interface of several nodes turns as one rigid body";
                    let expected = "an interface that turns, or a joint that is spherical or rod";
                    Finding::new(pointer, found, expected).hint(Some(hint.into()))
                })
            })
        })
    };
    let twisted = || {
        written.loads.iter().find_map(|(key, load)| {
            let Load::Torque(torque) = load else {
                return None;
            };
            let point = assembly.in_body(&torque.body, torque.point.as_ref()?);
            let (nearest, ..) = near(&torque.body, &point)?;
            (!nearest.turns).then(|| {
                let found = format!(
                    "the interface \"{}\" of \"{}\", whose rotation is not known",
                    nearest.name, torque.body
                );
                let pointer = join(&join(&join("/loads", key), load.key()), "point");
                let expected = "an interface that turns";
                let hint = "an interface of several nodes turns as one rigid body";
                Finding::new(pointer, found, expected).hint(Some(hint.into()))
            })
        })
    };
    beside.or_else(turned).or_else(twisted)
}

/// The first joint or load that a point mass does not admit.
pub(super) fn beside(problem: &Problem) -> Option<Finding> {
    let written = &problem.written;
    let is_point = |name: &str| {
        let body = written.bodies.get(name);
        body.is_some_and(|body| matches!(body.shape, Some(Shape::Point)))
    };
    if !written.bodies.keys().any(|name| is_point(name)) {
        return None;
    }
    let start = problem.start_numbers();
    let assembly = Assembly::new(written, &problem.order, &start);
    let near = SAME * length_scale(&problem.scene(&start).model);
    let away = |pointer: String, name: &str, offset: Vec3<f64>| {
        (offset.norm() > near).then(|| {
            let found = format!("a place {:.3e} m beside \"{name}\"", offset.norm());
            let expected = "its own place, as a point mass has no extent";
            Finding::new(pointer, found, expected)
        })
    };
    let turned = |pointer: String, name: &str, what: &str| {
        let expected = "a body with extent, as nothing turns a point mass";
        Finding::new(pointer, format!("{what} \"{name}\""), expected)
    };
    let bodies = written.bodies.iter().find_map(|(name, body)| {
        let velocity = body.velocity.as_ref().filter(|_| is_point(name))?;
        let spin = velocity.angular.as_ref()?;
        let turns = spin.iter().any(|x| x.value != 0.0);
        let pointer = join(&join(&join("/bodies", name), "velocity"), "angular");
        turns.then(|| turned(pointer, name, "the spin of"))
    });
    let joints = || {
        written.joints.iter().find_map(|(name, joint)| {
            let between = joint.between();
            let pointer = join(&join(&join("/joints", name), joint.kind().name()), "at");
            (0..2)
                .filter(|&side| is_point(&between[side]))
                .find_map(|side| {
                    let body = &between[side];
                    let offset = match (joint, joint.place()) {
                        (Joint::Rod(rod), _) => assembly.end(between, &rod.at, side),
                        (_, Some(place)) => {
                            at(&assembly, place, body, side) - assembly.pose(body).centre
                        }
                        (_, None) => Vec3::zeros(),
                    };
                    away(pointer.clone(), body, offset)
                })
        })
    };
    let ends = |pointer: &str, between: &[String; 2], at: &Ends| {
        let mut sides = (0..2).filter(|&side| is_point(&between[side]));
        sides.find_map(|side| {
            let end = assembly.end(between, at, side);
            away(join(pointer, "at"), &between[side], end)
        })
    };
    let loads = || {
        written.loads.iter().find_map(|(name, load)| {
            let pointer = join(&join("/loads", name), load.key());
            match load {
                Load::Force(force) if is_point(&force.body) => {
                    let centre = assembly.pose(&force.body).centre;
                    let (key, place) = match (&force.point, &force.at) {
                        (Some(point), _) => ("point", assembly.in_body(&force.body, point)),
                        (None, Some(at)) => ("at", assembly.at_ground(&force.body, at)),
                        (None, None) => return None,
                    };
                    away(join(&pointer, key), &force.body, place - centre)
                }
                Load::Torque(torque) if is_point(&torque.body) => {
                    Some(turned(join(&pointer, "body"), &torque.body, "a torque on"))
                }
                Load::Drag(drag) if is_point(&drag.body) => {
                    let place = assembly.in_body(&drag.body, drag.point.as_ref()?);
                    let centre = assembly.pose(&drag.body).centre;
                    away(join(&pointer, "point"), &drag.body, place - centre)
                }
                Load::Spring(spring) => ends(&pointer, &spring.between, &spring.at),
                Load::Contact(own) => ends(&pointer, &own.between, &own.at).or_else(|| {
                    let is_ball = matches!(own.surface, Surface::Sphere { .. });
                    let rubs = own.friction.as_ref().map(|_| "friction at the surface of");
                    let first = match (&own.half, &own.wheel) {
                        (Some(_), _) => Some("a capsule of"),
                        (_, Some(_)) => Some("a wheel of"),
                        _ => rubs.filter(|_| own.radius.value > 0.0),
                    };
                    let second = if is_ball { rubs } else { Some("a surface of") };
                    let mut sides = own.between.iter().zip([first, second]);
                    sides.find_map(|(body, what)| {
                        let what = what.filter(|_| is_point(body))?;
                        Some(turned(join(&pointer, "between"), body, what))
                    })
                }),
                Load::Cable(own) => own.points.iter().enumerate().find_map(|(k, own)| {
                    let point = own.point.as_ref().filter(|_| is_point(&own.body))?;
                    let place = assembly.in_body(&own.body, point);
                    let pointer = join(&join(&join(&pointer, "points"), k), "point");
                    away(pointer, &own.body, place - assembly.pose(&own.body).centre)
                }),
                Load::Stop(stop) => ends(&pointer, stop.between.as_ref()?, stop.at.as_ref()?),
                Load::Damping(damping) => {
                    let joint = written.joints.get(&damping.joint)?;
                    let body = joint.between().iter().find(|body| is_point(body))?;
                    Some(turned(
                        join(&pointer, "joint"),
                        body,
                        "damping of the rotation of",
                    ))
                }
                // Elements are no point masses.
                Load::Pressure(_) | Load::Area(_) | Load::Edge(_) | Load::Line(_) => None,
                Load::Controller(own) => ends(&pointer, own.between.as_ref()?, own.at.as_ref()?),
                Load::Force(_)
                | Load::Torque(_)
                | Load::TorsionSpring(_)
                | Load::Bushing(_)
                | Load::Friction(_)
                | Load::Drag(_) => None,
            }
        })
    };
    bodies.or_else(joints).or_else(loads)
}
