//! Faults that only the scene of the first design shows: ends at the same place, joints that cannot
//! close or start, drives against each other, too many variables for the memory.

use super::Problem;
use super::couplings::{self, Wheel};
use super::finding::Finding;
use super::memory;
use super::placement::Assembly;
use super::pointer::join;
use crate::math::{Dual, Vec3};
use crate::model::{Joint as ModelJoint, JointKind, Load, LoadKind, Model, RigidBody, Shape};
use crate::schema::couplings::Coupling;
use crate::schema::joints::Joint;
use crate::system::failure::AssemblyFailure;
use crate::system::placement::length_scale;
use crate::system::{Numbering, dead_points, initial, loads, rank, redundancy};

/// Memory of an optimisation per pair of variables \[bytes\]: about forty matrices.
const OF_PAIR: usize = 350;

/// The fault of too many variables for the memory. Reductions examine the derivative of a scene by
/// each variable, and an optimisation needs square matrices of their number.
pub(super) fn too_many(problem: &Problem) -> Option<Finding> {
    let count = problem.variables.len();
    let model = problem.unlowered_scene::<f64>(&problem.start()).model;
    let scene = (model.bodies.len() * (size_of::<RigidBody<Dual>>() + 64))
        + model.joints.len() * (size_of::<ModelJoint<Dual>>() + 64);
    let needed = count * (scene + count * OF_PAIR);
    let available = memory::available().filter(|available| needed > *available)?;
    let size = |bytes: usize| format!("{:.1} GB", bytes as f64 / 1e9);
    let found = format!(
        "{count} variables of a scene of {} bodies, which take {} of memory",
        model.bodies.len(),
        size(needed)
    );
    let expected = format!("a problem that fits into the {} available", size(available));
    Some(Finding::new("/variables", found, expected))
}

/// The fault of a spring or rod of length zero in the placement: it has no direction.
pub(super) fn collapsed(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start()).model;
    let rod = (model.joints.iter())
        .find(|joint| {
            let shortest = 1e-12 * length_scale(&model);
            joint.kind == JointKind::Rod && joint.frame_a.length <= shortest
        })
        .map(|joint| join(&join(&join("/joints", &joint.name), "rod"), "at"));
    let apart = "ends that are apart, as a force acts along the line through them";
    let meet = format!(
        "{apart}; only a spring without rest length and damping may start with its ends at one place"
    );
    let spring = || {
        let name = loads::without_length(&model)?;
        let load = join(&join("/loads", name), problem.written.loads[name].key());
        Some((join(&load, "at"), meet))
    };
    let rod = rod.map(|pointer| (pointer, apart.to_owned()));
    let (pointer, expected) = rod.or_else(spring)?;
    if let Some(contact) = pointer.strip_suffix("/at")
        && lies(&model, contact)
    {
        let place = join(&join(contact, "wheel"), "axis");
        let expected = "a wheel that stands: one that lies touches the plane all around";
        return Some(Finding::new(place, "an axis along the normal", expected));
    }
    Some(Finding::new(pointer, "ends at the same place", expected))
}

/// Whether the load at a place of the file is the contact of a wheel.
fn lies(model: &Model<f64>, pointer: &str) -> bool {
    let is = |load: &&Load<f64>| pointer == join(&join("/loads", &load.name), "contact");
    let load = model.loads.iter().find(is);
    load.is_some_and(|load| match &load.kind {
        LoadKind::Contact(own) => matches!(own.shape, Shape::Wheel { .. }),
        _ => false,
    })
}

/// Axes of a universal joint are perpendicular up to this cosine.
const PERPENDICULAR: f64 = 1e-9;

/// The fault of a universal joint whose axes are not perpendicular in the placement.
pub(super) fn oblique(problem: &Problem) -> Option<Finding> {
    let start = problem.start_numbers();
    let assembly = Assembly::new(&problem.written, &problem.order, &start);
    problem.written.joints.iter().find_map(|(name, joint)| {
        let [axis, Some(cross)] = joint.axes() else {
            return None;
        };
        let axis = axis.map_or(Vec3::z(), |axis| assembly.axis(axis).normalize());
        let cross = assembly.axis(cross).normalize();
        let cosine = axis.dot(&cross);
        if let Joint::Free(_) = joint {
            let pointer = join(&join(&join("/joints", name), "free"), "cross");
            let expected = "an axis across \"axis\"";
            let found = || Finding::new(pointer, "an axis along the other", expected);
            return (axis.cross(&cross).norm() <= PERPENDICULAR).then(found);
        }
        (cosine.abs() > PERPENDICULAR).then(|| {
            let pointer = join(&join(&join("/joints", name), "universal"), "cross");
            let degrees = cosine.acos().to_degrees();
            let found = format!("an axis at {degrees:.6} degrees to the other");
            Finding::new(pointer, found, "one that is perpendicular to \"axis\"")
        })
    })
}

/// Axes of gears are parallel, and teeth move alike where they meet, up to this sine.
const ALIKE: f64 = 1e-6;

/// The fault of a coupling whose axes or place do not fit in the placement.
pub(super) fn miscoupled(problem: &Problem) -> Option<Finding> {
    let (document, start) = (&problem.written, problem.start_numbers());
    let assembly = Assembly::new(document, &problem.order, &start);
    let skew = |x: &Vec3<f64>, y: &Vec3<f64>| x.cross(y).norm() > ALIKE * x.norm() * y.norm();
    document.couplings.iter().find_map(|(name, coupling)| {
        let pointer = join(&join("/couplings", name), coupling.key());
        let at =
            |found: &str, expected: &str| Some(Finding::new(join(&pointer, "at"), found, expected));
        let wheels = coupling.wheels();
        let key = wheels.as_ref().map_or("pinion", |own| own.key);
        let pair = wheels.and_then(|own| couplings::pair(document, &assembly, &own));
        let turned = |wheel: &Wheel<f64>| {
            let expected = "a body that turns about parallel axes on its carrier";
            let found = "axes that are not parallel on the way to the carrier";
            (wheel.skew > ALIKE).then(|| Finding::new(join(&pointer, key), found, expected))
        };
        if let Some(finding) = pair.iter().flatten().find_map(turned) {
            return Some(finding);
        }
        match (coupling, pair) {
            (Coupling::Gear(_) | Coupling::Belt(_), Some([a, b])) if skew(&a.axis, &b.axis) => {
                let hint = "use \"bevel\" for gears whose axes meet";
                let found = Finding::new(join(&pointer, key), "axes at an angle", "parallel axes");
                Some(found.hint(Some(hint.to_owned())))
            }
            (Coupling::Bevel(own), _) => {
                let [a, b] = couplings::bevel_paths(document, &assembly, (coupling, own))?;
                let least = ALIKE * length_of(&assembly);
                let expected = "a place in the plane of both axes, on neither";
                match a.norm() <= least || b.norm() <= least {
                    true => at("a place on an axis", expected),
                    false if skew(&a, &b) => at("a place where the teeth move apart", expected),
                    false => None,
                }
            }
            (Coupling::RackAndPinion(own), _) => {
                let rack = couplings::rack(document, &assembly, own)?;
                let (along, path) = (rack.along, rack.path);
                if let Some(finding) = turned(&rack.pinion) {
                    return Some(finding);
                }
                let expected =
                    "the point of the rack's pitch line that is nearest to the axis of the pinion";
                match path.norm() <= ALIKE * length_of(&assembly) {
                    true => at("a place on the axis", expected),
                    false if skew(&path, &along) => {
                        at("a place where the teeth move apart", expected)
                    }
                    false => None,
                }
            }
            _ => None,
        }
    })
}

/// The largest distance of a body from the origin, or 1 \[m\].
fn length_of(assembly: &Assembly<f64>) -> f64 {
    let distances = assembly.poses.iter().map(|pose| pose.origin.norm());
    match distances.fold(0.0, f64::max) {
        0.0 => 1.0,
        length => length,
    }
}

/// The fault of a drive whose motion other joints and drives prescribe already.
pub(super) fn driven_twice(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start()).model;
    let drives = &problem.written.drives;
    if drives.is_empty() {
        return None;
    }
    let undriven = |names: &[&str]| {
        let mut model = model.clone();
        let named = |joint: &&mut ModelJoint<f64>| names.contains(&joint.name.as_str());
        model
            .joints
            .iter_mut()
            .filter(named)
            .for_each(|joint| joint.drives.clear());
        redundancy::redundant_rows(&model)
    };
    let all: Vec<&str> = drives.values().map(|drive| drive.joint.as_str()).collect();
    let (with, without) = (undriven(&[])?, undriven(&all)?);
    if with <= without {
        return None;
    }
    // The last drive whose removal reduces the number of such motions.
    let superfluous = |(_, joint): &(&String, &str)| undriven(&[*joint]).is_some_and(|n| n < with);
    let mut named = drives
        .iter()
        .map(|(name, drive)| (name, drive.joint.as_str()));
    let (name, joint) = named.rfind(superfluous)?;
    let pointer = join(&join("/drives", name), "joint");
    if dead_points::is_at_dead_point(&model, joint) {
        let found = format!(
            "a drive of joint \"{joint}\" at a dead point, where this joint cannot move at first"
        );
        let expected = "a position in which the drive determines the motion";
        let hint = "start away from the dead point, or drive another joint of the linkage";
        return Some(Finding::new(pointer, found, expected).hint(Some(hint.to_owned())));
    }
    let found = format!("the joint \"{joint}\"");
    let expected = "a joint whose motion the other joints and drives leave free";
    Some(Finding::new(pointer, found, expected))
}

/// The fault of joints that cannot start as given at the design of the file.
pub(super) fn unstarted(problem: &Problem) -> Option<Finding> {
    let failure = problem.unlowered_scene::<f64>(&problem.start()).unstarted?;
    let named = match &failure {
        AssemblyFailure::Determined { joint }
        | AssemblyFailure::Open { joint, .. }
        | AssemblyFailure::Turned { joint } => problem.written.joints.get_key_value(joint),
        _ => None,
    };
    let Some((name, joint)) = named else {
        return Some(cannot_assemble(&failure));
    };
    let pointer = join(&join("/joints", name), joint.kind().name());
    let (pointer, expected) = match joint.start() {
        Some(_) => (join(&pointer, "start"), "a start that the joints admit"),
        None => (pointer, "starts at which the joints can be closed"),
    };
    let hint = match &failure {
        AssemblyFailure::Determined { .. } => "give the starts of as many joints as are free",
        _ => "look at how far the joints let the bodies move",
    };
    let finding = Finding::new(pointer, failure.to_string(), expected);
    Some(finding.of_key().hint(Some(hint.to_owned())))
}

/// The fault of joints that have no closed position, or no unique one, at the design of the file.
pub(super) fn unassembled(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start()).model;
    let numbering = Numbering::new(&model);
    let failure = initial::consistent(&model, &numbering).err()?;
    // Round-off in place of an inertia spoils the assembly, too.
    let loose = rank::moving_without_inertia(&model);
    Some(cannot_assemble(&loose.unwrap_or(failure)))
}

/// The fault of bodies that move without inertia in the lowered scene.
pub(super) fn without_inertia(problem: &Problem) -> Option<Finding> {
    let model = problem.scene(&problem.start()).model;
    Some(cannot_assemble(&rank::moving_without_inertia(&model)?))
}

/// The fault of a scene that cannot start.
fn cannot_assemble(failure: &AssemblyFailure) -> Finding {
    let (pointer, expected, hint) = match failure {
        AssemblyFailure::Open {
            joint, iterations, ..
        } => (
            join("/joints", joint),
            "points that the placed bodies can bring together",
            match iterations {
                0 => {
                    "no small motion brings the points nearer: if the lengths fit, the bodies lie in line; give one of them a \
                     \"turn\" that bends the loop to one side"
                }
                _ => "look at the lengths, and at where the bodies are placed",
            },
        ),
        AssemblyFailure::Determined { joint } => (
            join("/joints", joint),
            "a start that the joints admit",
            "give the starts of as many joints as are free",
        ),
        AssemblyFailure::Turned { joint } => (
            join("/joints", joint),
            "axes that point the same way in both bodies",
            "place one of the bodies turned by 180 degrees",
        ),
        AssemblyFailure::SingularPosition { .. } => (
            "/joints".to_owned(),
            "a placement at which the joints are independent, as in its neighbourhood",
            "place the bodies away from straight or folded positions",
        ),
        AssemblyFailure::Redundant { .. } => (
            "/joints".to_owned(),
            "constraints that are independent of each other",
            "leave one of the joints out, or replace a revolute joint by a spherical one",
        ),
        AssemblyFailure::WithoutInertia { without_mass, .. } => (
            "/bodies".to_owned(),
            "inertia in every direction that a body can move in",
            match without_mass {
                true => {
                    "a body without mass needs joints that, with the bodies that have mass, determine its motion"
                }
                false => "give a thin rod a radius: at a spherical joint it can spin about itself",
            },
        ),
        AssemblyFailure::NoEquilibrium { .. } => (
            "/start".to_owned(),
            "gravity and loads that the flexible bodies bear with small deformations",
            "look at stiffnesses and loads, or start undeformed",
        ),
        AssemblyFailure::NotHeld { .. } => (
            "/bodies".to_owned(),
            "joints, springs or drives that hold every body",
            "hold what is free, or simulate its motion",
        ),
        AssemblyFailure::NoRest { .. } => (
            "/analysis".to_owned(),
            "gravity and loads under which the machine comes to rest",
            "place the bodies nearer to where they rest; look at stiffnesses and loads",
        ),
        AssemblyFailure::NotAlike { .. } => (
            "/turning".to_owned(),
            "a machine that is the same at every angle: gravity along the axis or zero, joints with ground on the axis, and \
             springs that hold alike in all directions",
            "set \"gravity\" to [0, 0, 0] if it is across the axis",
        ),
        AssemblyFailure::TooWeak { load, .. } => (
            join("/loads", load),
            "a motor that holds the machine at rest",
            "raise its limits or its gear ratio, or support the machine",
        ),
        AssemblyFailure::NoModes { .. } => (
            "/functions".to_owned(),
            "a stable rest, and as many modes as functions ask for",
            "bodies without inertia, free motions and motions that do not oscillate are no modes",
        ),
        AssemblyFailure::MovedApart { body } => (
            join("/bodies", body),
            "places that are apart, or move together",
            "start with the places apart",
        ),
        AssemblyFailure::Singular => (
            "".to_owned(),
            "a scene whose equations have regular matrices in double precision",
            "scale lengths, masses and times alike, so that they are nearer one",
        ),
    };
    let finding = Finding::new(pointer, failure.to_string(), expected);
    finding.of_key().hint(Some(hint.to_owned()))
}
