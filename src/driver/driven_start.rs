//! Notes on drives at the start: those that are not steady, and those that hit bodies which have other velocities.

use crate::math::slices::dot;
use crate::model::{DegreeOfFreedom, Drive, Joint, Model};
use crate::problem::Problem;
use crate::system::initial::InitialState;
use crate::system::placement::{guess, length_scale};
use crate::system::{BodyMotion, Numbering, bodies, flexible};

/// Changes of a position or velocity above this, relative to the largest one, are reported.
pub(super) const TOLD: f64 = 1e-6;
/// A vibration that a start in equilibrium leaves is reported above this part of the deformation.
const UNSTEADY: f64 = 1e-5;

/// Value, rate and acceleration of a drive at t = 0.
fn at_start(drive: &Drive<f64>) -> [f64; 4] {
    drive.course.derivatives(0.0)
}

/// Flexible bodies that vibrate after a start in equilibrium, because drives do not move the scene steadily.
pub(super) fn unsteady(problem: &Problem, model: &Model<f64>, x: &[f64]) -> Vec<String> {
    let joints = model.joints.iter();
    let drives = joints.flat_map(|joint| {
        joint
            .drives
            .iter()
            .map(move |drive| (joint, at_start(drive)))
    });
    let running =
        |(_, [_, rate, acceleration, _]): &(_, [f64; 4])| *rate != 0.0 || *acceleration != 0.0;
    let drives: Vec<_> = drives.filter(running).collect();
    if drives.is_empty() {
        return Vec::new();
    }
    let Some(parts) = problem.unsteady_at_equilibrium(x) else {
        return Vec::new();
    };
    let most = parts
        .iter()
        .fold(0.0_f64, |most, (_, part)| most.max(*part));
    let speeds_up = drives
        .iter()
        .find(|(_, [_, _, acceleration, _])| *acceleration != 0.0);
    let why = match speeds_up {
        Some((joint, _)) => format!("the drive of joint \"{}\" accelerates at the start", joint.name),
        None => "the drives do not move the scene and its loads steadily as seen from the flexible bodies".into(),
    };
    if speeds_up.is_none() && most <= UNSTEADY {
        return Vec::new();
    }
    if most <= UNSTEADY {
        return vec![format!(
            "{why}: the start in equilibrium has the inertial forces at t = 0, which change later"
        )];
    }
    let all = parts.iter().filter(|(_, part)| *part >= UNSTEADY * most);
    all.map(|(body, part)| {
        format!(
            "{why}: the start in equilibrium has the inertial forces at t = 0, and leaves out the rate at which they change \
             the deformation of body \"{body}\", which then vibrates by about {} of it",
            short(*part)
        )
    })
    .collect()
}

/// Drives that start with another rate than the given velocities of their bodies.
pub(super) fn hit(
    model: &Model<f64>,
    numbering: &Numbering,
    start: &InitialState<f64>,
) -> Vec<String> {
    let (_, given) = guess(model);
    let mut motions = Vec::new();
    let mut energy = |v: &[f64]| {
        BodyMotion::all(numbering, &start.q, v, &mut motions);
        let mut momentum = vec![0.0; v.len()];
        bodies::mass_product(model, numbering, v, &mut momentum);
        flexible::add_mass_product(model, numbering, &motions, v, &mut momentum);
        0.5 * dot(v, &momentum)
    };
    let (before, after) = (energy(&given), energy(&start.v));
    BodyMotion::all(numbering, &start.q, &given, &mut motions);
    let drives = model.joints.iter();
    let drives = drives.flat_map(|joint| joint.drives.iter().map(move |drive| (joint, drive)));
    let length = length_scale(model);
    let one = |(joint, drive): (&Joint<f64>, &Drive<f64>)| {
        let [value, rate, acceleration, _] = at_start(drive);
        let own = joint_rate(joint, drive.dof, &motions);
        let (unit, scale) = match drive.dof {
            DegreeOfFreedom::Rotation => ("rad/s", 1.0),
            DegreeOfFreedom::Translation => ("m/s", length),
        };
        // Round-off of the velocities, or of the rate of a drive at its dead point, is no change.
        let at_dead_point = (value * acceleration).abs().sqrt();
        let fastest = given.iter().fold(rate.abs().max(at_dead_point), |most, v| {
            most.max(v.abs() * scale)
        });
        ((rate - own).abs() > TOLD * fastest).then(|| {
            format!(
                "the drive of joint \"{}\" starts with a rate of {} {unit}, and the given velocities of its bodies with {}: an \
                 impulse changes velocities at the start by {} {unit} in this joint (kinetic energy from {} J to {} J)",
                joint.name,
                signed(rate),
                signed(own),
                signed(rate - own),
                short(before),
                short(after),
            )
        })
    };
    drives.filter_map(one).collect()
}

/// The rate of a joint about or along its axis.
fn joint_rate(joint: &Joint<f64>, dof: DegreeOfFreedom, motions: &[BodyMotion<f64>]) -> f64 {
    let ground = BodyMotion::ground();
    let (a, b) = (
        &motions[joint.body_a],
        joint.body_b.map_or(&ground, |body| &motions[body]),
    );
    let axis = b.rotation * joint.frame_b.axes[2];
    match dof {
        DegreeOfFreedom::Rotation => axis.dot(&(a.rotation * a.omega - b.rotation * b.omega)),
        DegreeOfFreedom::Translation => {
            let (at_a, at_b) = (a.point(&joint.frame_a.point), b.point(&joint.frame_b.point));
            let apart =
                a.point_velocity(&joint.frame_a.point) - b.point_velocity(&joint.frame_b.point);
            let turning = (b.rotation * b.omega).cross(&axis);
            axis.dot(&apart) + turning.dot(&(at_a - at_b))
        }
    }
}

fn signed(x: f64) -> String {
    match x < 0.0 {
        true => format!("-{}", short(-x)),
        false => short(x),
    }
}

/// A number of a note.
pub(super) fn short(x: f64) -> String {
    match x {
        ..1e-12 => "0".into(),
        ..1e-3 => format!("{x:.1e}"),
        _ => format!("{x:.4}"),
    }
}
