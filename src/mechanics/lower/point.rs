//! Bodies whose rotation is neither loaded nor observed: three unknowns instead of six.
//!
//! If spherical joints, springs and forces act only at the centre of mass, and the body starts
//! without spin, then M = 0 and ω = 0: it keeps its orientation. Its rotation is left out if no
//! function observes it or a point away from the centre, since a design may turn its start.

use super::characteristic_length::Reach;
use super::examine::{ConditionChecker, Verdict};
use super::reactions;
use crate::functions::{Function, Gate, Instant, Release, Rotation, Scene};
use crate::math::{Scalar, Vec3};
use crate::model::controller::Coordinate;
use crate::model::{Axes, JointKind, LoadKind, Shape};

/// Largest lever arm that counts as zero, relative to the characteristic length and [`ROUND_OFF`].
/// It is small because a lever arm turns a small body fast.
const CENTRED: f64 = 1e-2;

/// Examines whether body `index` of `scene` is a point, in values and for a `change` of the
/// variable of the infinitesimal part.
///
/// # Errors
/// The loads on its rotation, and the functions that observe it.
pub(super) fn holds<S: Scalar>(
    scene: &Scene<S>,
    characteristic_length: &Reach,
    index: usize,
    change: f64,
) -> Verdict {
    let model = &scene.model;
    let mut examiner = ConditionChecker::new(change);
    let length = CENTRED * characteristic_length.of([Some(index), None]);
    // `None` if the rotation is loaded whatever the lever arm.
    let mut vanishes = |arm: Option<&Vec3<S>>, what: &dyn Fn() -> String| match arm {
        Some(arm) => examiner.vanishes(arm.as_slice(), length, || (what(), "m")),
        None => examiner.tell(what()),
    };
    let spin = &model.bodies[index].angular_velocity;
    if spin.iter().any(|x| !x.is_zero()) {
        vanishes(None, &|| "it starts with a spin".into());
    }
    let is = |other: usize| other == index;
    for joint in &model.joints {
        let sides = [
            (Some(joint.body_a), &joint.frame_a),
            (joint.body_b, &joint.frame_b),
        ];
        for (_, frame) in sides.iter().filter(|(body, _)| body.is_some_and(is)) {
            let name = &joint.name;
            match joint.kind {
                JointKind::Free => {}
                JointKind::Spherical | JointKind::Rod => {
                    let what = || format!("joint \"{name}\" is off its centre of mass");
                    vanishes(Some(&frame.point), &what);
                }
                JointKind::Revolute
                | JointKind::Prismatic
                | JointKind::Planar
                | JointKind::Cylindrical
                | JointKind::Universal
                | JointKind::Weld
                | JointKind::Attachment
                | JointKind::Coupled(_) => {
                    vanishes(None, &|| format!("joint \"{name}\" turns it"));
                }
            }
        }
    }
    for load in &model.loads {
        let name = &load.name;
        let turns = || format!("load \"{name}\" turns it");
        match &load.kind {
            LoadKind::Force {
                body, point, axes, ..
            } if is(*body) => match axes {
                Axes::Ground => vanishes(Some(point), &turns),
                Axes::Body => vanishes(None, &turns),
            },
            LoadKind::Drag { body, point, .. } if is(*body) => vanishes(Some(point), &turns),
            LoadKind::Torque { body, .. } if is(*body) => vanishes(None, &turns),
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
                if is(*body_a) {
                    vanishes(Some(point_a), &turns);
                }
                if body_b.is_some_and(is) {
                    vanishes(Some(point_b), &turns);
                }
            }
            LoadKind::Contact(own) => {
                // Friction turns a sphere; a point only if it is off the centre of mass.
                let is_sphere = matches!(own.shape, Shape::Sphere);
                let slides = is_sphere && (own.friction.is_none() || own.radius.is_zero());
                if is(own.body_a) {
                    vanishes(slides.then_some(&own.point_a), &turns);
                }
                if own.body_b.is_some_and(is) {
                    vanishes(None, &turns);
                }
            }
            LoadKind::Cable(own) => {
                for own in own.points.iter().filter(|own| own.body.is_some_and(is)) {
                    vanishes(Some(&own.point), &turns);
                }
            }
            LoadKind::TorsionSpring { joint, .. }
            | LoadKind::Damping { joint, .. }
            | LoadKind::BallDamping { joint, .. }
            | LoadKind::Bushing { joint, .. }
            | LoadKind::Friction { joint, .. }
            | LoadKind::JointStop { joint, .. } => {
                let joint = &model.joints[*joint];
                if is(joint.body_a) || joint.body_b.is_some_and(is) {
                    vanishes(None, &turns);
                }
            }
            LoadKind::Controller(own) => {
                let turned = own.feedback.iter().any(|own| match &own.coordinate {
                    Coordinate::Joint { joint, .. } => {
                        let joint = &model.joints[*joint];
                        is(joint.body_a) || joint.body_b.is_some_and(is)
                    }
                    Coordinate::Distance { body_a, body_b, .. } => {
                        is(*body_a) || body_b.is_some_and(is)
                    }
                });
                if turned || own.weights.iter().any(|own| is(own.body)) {
                    vanishes(None, &turns);
                }
            }
            // No flexible body is a point.
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Drag { .. }
            | LoadKind::Distributed(_) => {}
        }
    }
    let read = || "a function observes its rotation".to_owned();
    let event = scene.until.as_ref().map(|until| &until.measure);
    for function in scene.functions.iter().chain(event) {
        for (body, point) in looks_at(scene, function) {
            if is(body) {
                vanishes(point.as_ref(), &read);
            }
        }
    }
    examiner.verdict()
}

/// Bodies that a function observes, each with the point; `None` if it observes the rotation.
fn looks_at<S: Scalar>(scene: &Scene<S>, function: &Function<S>) -> Vec<(usize, Option<Vec3<S>>)> {
    let turned = |rotation: &Rotation<S>| {
        let bodies = [Some(rotation.body), rotation.relative_to];
        bodies.into_iter().flatten().map(|body| (body, None))
    };
    let gated = |gate: &Option<Gate<S>>| {
        gate.iter()
            .flat_map(|gate| turned(&gate.rotation))
            .collect::<Vec<_>>()
    };
    let of_instant = |instant: &Instant<S>| match instant {
        Instant::Position { body, point, .. }
        | Instant::Velocity { body, point, .. }
        | Instant::Acceleration { body, point, .. }
        | Instant::Speed { body, point }
        | Instant::SpeedSquared { body, point } => vec![(*body, Some(*point))],
        // The energy depends on angular velocities, which are zero, and on heights of centres.
        Instant::Energy(_) => Vec::new(),
        Instant::Momentum { .. }
        | Instant::Vibration(_)
        | Instant::StrainEnergy(_)
        | Instant::ShellStress { .. }
        | Instant::Deformation { .. }
        | Instant::LargestDeformation { .. } => Vec::new(),
        // Loads turn only bodies that are no points. Angular velocities are zero, but the angular
        // momentum of a centre is not, whatever its body's rotation.
        Instant::AngularMomentum(_) | Instant::Load(_) | Instant::Power(_) => Vec::new(),
        Instant::Reaction(wrench) => {
            let all = reactions::turning(scene, wrench).into_iter();
            all.map(|body| (body, None)).collect()
        }
        Instant::Slide(joint) => vec![(scene.model.joints[*joint].body_a, None)],
        Instant::JointRate { joint, .. } => {
            let joint = &scene.model.joints[*joint];
            let ends = [Some(joint.body_a), joint.body_b];
            let ends = ends.into_iter().flatten();
            ends.map(|body| (body, None)).collect()
        }
        Instant::Felt { body, point, .. } => vec![(*body, Some(*point)), (*body, None)],
        Instant::Seen(seen) => {
            let from = seen.from.into_iter();
            let from = from.flat_map(|body| [(body, Some(seen.eye)), (body, None)]);
            [(seen.body, Some(seen.point))]
                .into_iter()
                .chain(from)
                .collect()
        }
        Instant::AngularVelocity { body, .. } => vec![(*body, None)],
        Instant::Rotation(rotation) => turned(rotation).collect(),
        Instant::Range { projectile, gate } => {
            let thrown = (projectile.body, Some(projectile.point));
            [thrown].into_iter().chain(gated(gate)).collect()
        }
    };
    match function {
        Function::Reduced { .. } | Function::Misfit { .. } => {
            let all = function.instants().into_iter();
            all.flat_map(of_instant).collect()
        }
        Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => {
            Vec::new()
        }
        Function::Clearance {
            projectile,
            release,
            ..
        } => {
            let mut all = vec![(projectile.body, Some(projectile.point))];
            if let Release::Best {
                projectile, gate, ..
            } = release
            {
                all.push((projectile.body, Some(projectile.point)));
                all.extend(gated(gate));
            }
            all
        }
    }
}
