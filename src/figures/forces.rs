//! Forces for the page: reactions of joints, applied forces and those of contacts, as arrows.

use crate::driver::Simulation;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::model::{Axes, LoadKind};
use crate::page::{Arrow, rounded};
use crate::system::loads;

/// Most arrows: more hide the machine.
const MOST: usize = 24;

/// The arrows of a motion at some instants; none if there would be too many, and whether that is so.
pub fn arrows(simulation: &Simulation, frames: &[usize]) -> (Vec<Arrow>, bool) {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let is_force = |kind: &LoadKind<f64>| matches!(kind, LoadKind::Force { .. });
    let forces = || model.loads.iter().filter(|load| is_force(&load.kind));
    // The attachments of flexible bodies are no joints of the file.
    let joints = || (model.joints.iter().enumerate()).filter(|(_, joint)| joint.modes.is_none());
    let contacts = || {
        model
            .loads
            .iter()
            .filter(|load| matches!(load.kind, LoadKind::Contact(_)))
    };
    if joints().count() + forces().count() + contacts().count() > MOST {
        return (Vec::new(), true);
    }
    let at = |k: usize| Snapshot::of(model, run, k);
    let ends =
        |p: Vec3<f64>, f: Vec3<f64>| -> [f64; 6] { [p.x, p.y, p.z, f.x, f.y, f.z].map(rounded) };
    let reactions = simulation.reactions_at(frames.iter().copied());
    let of_joint = |(j, joint): (usize, &crate::model::Joint<f64>)| Arrow {
        name: format!("{}, on {}", joint.name, model.bodies[joint.body_a].name),
        applied: false,
        forces: (frames.iter().zip(&reactions))
            .map(|(&k, all)| {
                let body = at(k).motion(joint.body_a);
                let point = body.position + body.rotation * joint.frame_a.point;
                ends(point, all[j].force_ground)
            })
            .collect(),
    };
    let of_load = |load: &crate::model::Load<f64>| {
        let LoadKind::Force {
            body,
            point,
            direction,
            axes,
            magnitude,
        } = &load.kind
        else {
            return None;
        };
        let each = |&k: &usize| {
            let motion = at(k).motion(*body);
            let force = direction * magnitude.value(run.time(k));
            let force = match axes {
                Axes::Ground => force,
                Axes::Body => motion.rotation * force,
            };
            ends(motion.position + motion.rotation * point, force)
        };
        Some(Arrow {
            name: load.name.clone(),
            applied: true,
            forces: frames.iter().map(each).collect(),
        })
    };
    let pressed: Vec<_> = (frames.iter())
        .map(|&k| loads::contact_forces(model, &at(k).motions()))
        .collect();
    let of_contact = |i: usize| {
        let (load, _) = pressed[0][i];
        let forces = pressed.iter().map(|own| {
            let (_, [place, force]) = own[i];
            ends(place, force)
        });
        Arrow {
            name: model.loads[load].name.clone(),
            applied: false,
            forces: forces.collect(),
        }
    };
    let mut all: Vec<Arrow> = joints().map(of_joint).collect();
    all.extend(forces().filter_map(of_load));
    all.extend((0..pressed.first().map_or(0, Vec::len)).map(of_contact));
    (all, false)
}
