//! Places that bodies do not have: those beside a point mass, and those beyond the ends of a beam.

use super::Problem;
use super::finding::Finding;
use super::joints::at;
use super::placement::Assembly;
use super::pointer::join;
use super::schema::joints::Joint;
use super::schema::loads::Load;
use super::schema::mechanics::Shape;
use crate::math::Vec3;
use crate::system::placement::length_scale;

/// Two points are the same up to this distance, relative to the length scale.
const SAME: f64 = 1e-9;

/// The first beam that something holds beyond its ends, where its shapes say nothing.
pub(super) fn off_beams(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start()).model;
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
    let start = problem.start();
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
                Load::Spring(spring) => {
                    let sides = (0..2).filter(|&side| is_point(&spring.between[side]));
                    sides.into_iter().find_map(|side| {
                        let end = assembly.end(&spring.between, &spring.at, side);
                        away(join(&pointer, "at"), &spring.between[side], end)
                    })
                }
                Load::Damping(damping) => {
                    let joint = written.joints.get(&damping.joint)?;
                    let body = joint.between().iter().find(|body| is_point(body))?;
                    Some(turned(
                        join(&pointer, "joint"),
                        body,
                        "damping of the rotation of",
                    ))
                }
                Load::Force(_) | Load::Torque(_) | Load::TorsionSpring(_) | Load::Friction(_) => {
                    None
                }
            }
        })
    };
    bodies.or_else(joints).or_else(loads)
}
