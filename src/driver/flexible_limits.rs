//! Where the equations of flexible bodies are no longer accurate: bodies that turn far from their own axes (see
//! [`crate::structures::turned`]), beams near lateral buckling whose twist and bending do not couple, large strains,
//! bodies of linear strain that spin fast, inertia that depends on the observer, and reduced bases that lock.

use crate::integrate::{IntegrationFailure, Spacing, Trajectory};
use crate::model::flexible::{Modes, carriers};
use crate::model::{FlexibleBody, Form, Inertia, JointKind, LoadKind, Model};
use crate::problem::Problem;
use crate::structures::modal::ModalNumbers;
use crate::structures::modal::frequencies::{Held, frequencies};
use crate::structures::turned::{LARGE_ERROR, Turned};
use crate::system::attachment::section_rotation;
use crate::system::reduction::locked_part;
use crate::system::{BodyMotion, flexible};
use std::f64::consts::TAU;

/// The axes of a section are those turned by the tangent of its rotation θ, so a body that is welded to it is turned by
/// θ³/3 too little.
const OF_WELDS: f64 = 1.0 / 3.0;
/// A torque on a section does work along the angle atan θ of its axes, so it acts on θ with a part 1 / (1 + θ²).
const OF_TORQUES: f64 = 1.0;
/// Of bodies from files only sections are known. A cantilever with a force at its end errs by 0.42 θ².
const OF_FILES: f64 = 0.42;
/// Part of the moment of lateral buckling above which a beam that cannot buckle is told.
const LATERAL: f64 = 0.5;
/// Strain above which stress is no longer proportional to it.
const LARGE_STRAIN: f64 = 0.1;
/// Part of the strain energy of reduced shells that is locked above which a run warns.
const LOCKED: f64 = 0.06;
/// Number of instants, besides the start and that of the largest strain energy, at which the strains of shells are
/// evaluated.
const LOOKS: usize = 8;

/// Part of the lowest angular frequency above which a body of linear strain spins fast. A beam that turns with Ω
/// gains a stiffness of about Ω²/ω² of its own by the tension, which linear strain does not have.
const FAST: f64 = 0.1;

/// Number of steps by a tolerance above which what sets them is told.
const MANY_STEPS: usize = 2000;

/// Advice where a tolerance makes a motion of elastic bodies follow fast vibrations in many steps.
pub(super) fn many_steps(
    problem: &Problem,
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Option<String> {
    let Spacing::Tolerance(tolerance) = problem.simulation.spacing else {
        return None;
    };
    let steps = run.grid.steps();
    if model.flexible.is_empty() || steps < MANY_STEPS {
        return None;
    }
    let looser = format!("{:.0e}", 100.0 * tolerance);
    Some(format!(
        "{steps} steps follow the vibrations of elastic bodies to the tolerance {tolerance:e}. If slow motion is wanted, a \
         looser tolerance takes fewer; see what changes with --set /simulation/tolerance={looser} --error"
    ))
}

/// A warning about a motion that flexible bodies do not follow accurately.
pub(super) fn warning(model: &Model<f64>, run: &Trajectory<f64>) -> Option<String> {
    if model.flexible.is_empty() {
        return None;
    }
    let peaks = peaks(model, run);
    let all = [
        truncated_inertia(model),
        large_rotation(model, run, &peaks),
        lateral(model, run),
        large_strain(model, run, &peaks),
        fast_spin(model, run),
        locked(model, run, &peaks),
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// By flexible body: the sample with the largest strain energy; none of bodies without shells.
fn peaks(model: &Model<f64>, run: &Trajectory<f64>) -> Vec<Option<usize>> {
    let has_shells = |body: &FlexibleBody<f64>| body.form.shells().is_some();
    let mut most: Vec<(f64, Option<usize>)> = vec![(-1.0, None); model.flexible.len()];
    if !model.flexible.iter().any(has_shells) {
        return vec![None; most.len()];
    }
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        for (body, most) in model.flexible.iter().zip(&mut most) {
            if has_shells(body) {
                let energy = flexible::strain_energy(body, &motions);
                if energy > most.0 {
                    *most = (energy, Some(k));
                }
            }
        }
    }
    most.into_iter().map(|(_, k)| k).collect()
}

/// The reduced basis that locks most, where the strain energy of its body is largest, if it locks much.
fn locked(model: &Model<f64>, run: &Trajectory<f64>, peaks: &[Option<usize>]) -> Option<String> {
    let mut most: Option<(f64, String)> = None;
    let mut motions = Vec::new();
    for (body, peak) in model.flexible.iter().zip(peaks) {
        let (Form::Modal(modal), &Some(k)) = (&body.form, peak) else {
            continue;
        };
        let Some(shells) = &modal.shells else {
            continue;
        };
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        let q = flexible::coordinates(body, &motions);
        let Ok(Some(part)) = locked_part(shells, &q) else {
            continue;
        };
        if part > LOCKED && most.as_ref().is_none_or(|(before, _)| part > *before) {
            let told = format!(
                "the reduced basis of \"{}\" locks: at t = {:.4} s {:.0} % of its strain energy is of stretch that \
                 all nodes would relieve; \"companions\", a smaller \"tolerance\" or \"clamped\" axes may help, and \
                 --error compares with all nodes",
                body.name,
                run.time(k),
                100.0 * part
            );
            most = Some((part, told));
        }
    }
    most.map(|(_, told)| told)
}

/// The bodies whose inertia leaves out how they are deformed.
fn truncated_inertia(model: &Model<f64>) -> Option<String> {
    let all = model
        .flexible
        .iter()
        .filter(|body| body.inertia == Inertia::Paper);
    let names: Vec<String> = all.map(|body| format!("\"{}\"", body.name)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "the inertia of {} is that of equations 13 and 14 of Kennedy & Boopathy (2016): it leaves out products of \
             places and deformations, and its results depend on the velocity of the observer",
            names.join(", ")
        )
    })
}

/// How far a body is turned at an instant.
struct At {
    sample: usize,
    turned: Turned,
    /// Of its section whose rotation spoils most: the angle \[rad\], and the part by which it errs.
    section: (f64, f64),
}

/// A section of a body, and the factor of the square of its rotation in the error.
type Section<'m> = (&'m Modes<f64>, f64);

/// The sections of each flexible body whose rotations spoil something: those that are welded to another body, those on which
/// torques act, directly or by such a body, and all of bodies from files.
fn sections(model: &Model<f64>) -> Vec<Vec<Section<'_>>> {
    let mut all = vec![Vec::new(); model.flexible.len()];
    let mut welded = vec![false; model.bodies.len()];
    let mut direct = vec![false; model.bodies.len()];
    for load in &model.loads {
        if let LoadKind::Torque { body, .. } = load.kind {
            direct[body] = true;
        }
    }
    let mut torqued = direct.clone();
    let welds = (model.joints.iter()).filter(|joint| joint.kind == JointKind::Weld);
    for joint in welds {
        let bodies = [Some(joint.body_a), joint.body_b].into_iter().flatten();
        let turns = bodies.clone().any(|body| direct[body]);
        for body in bodies {
            welded[body] = true;
            torqued[body] |= turns;
        }
    }
    let mut owners = vec![None; model.bodies.len()];
    for (i, body) in model.flexible.iter().enumerate() {
        owners[body.carriers..][..carriers(body.modes()).count()].fill(Some(i));
    }
    for joint in &model.joints {
        let owner = joint.modes.as_ref().and_then(|modes| {
            let owner = owners[modes.places.first()?.0]?;
            Some((owner, modes))
        });
        let Some((owner, modes)) = owner else {
            continue;
        };
        let factor = |of: &[bool], factor: f64| match joint.body_b.is_some_and(|body| of[body]) {
            true => factor,
            false => 0.0,
        };
        let of_joints = factor(&welded, OF_WELDS) + factor(&torqued, OF_TORQUES);
        let of_file = match &model.flexible[owner].form {
            Form::Modal(modal) if modal.shells.is_none() && modal.sections.is_empty() => OF_FILES,
            Form::Modal(_) | Form::Finite(_) => 0.0,
        };
        if of_joints + of_file > 0.0 {
            all[owner].push((modes, of_joints + of_file));
        }
    }
    all
}

/// The body whose large rotations spoil its deformation most, if they spoil it much.
fn large_rotation(
    model: &Model<f64>,
    run: &Trajectory<f64>,
    peaks: &[Option<usize>],
) -> Option<String> {
    let sections = sections(model);
    let mut all: Vec<(Turned, Vec<At>)> = Vec::new();
    all.resize_with(model.flexible.len(), Default::default);
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        for (i, body) in model.flexible.iter().enumerate() {
            let shells = body.form.shells().is_some();
            let turned = match !shells || is_looked_at(run, k) || peaks[i] == Some(k) {
                true => flexible::turned(body, &motions).unwrap_or_default(),
                false => Turned::default(),
            };
            let mut section = (0.0, 0.0);
            for &(modes, factor) in &sections[i] {
                let angle = section_rotation(modes, &motions).norm();
                if factor * angle * angle > section.1 {
                    section = (angle, factor * angle * angle);
                }
            }
            all[i].0.raise(&turned);
            all[i].1.push(At {
                sample: k,
                turned,
                section,
            });
        }
    }
    let mut most: Option<(f64, &At, &FlexibleBody<f64>)> = None;
    for (body, (of_body, found)) in model.flexible.iter().zip(&all) {
        for at in found {
            let error = at.turned.error(of_body) + at.section.1;
            if most.is_none_or(|most| error > most.0) {
                most = Some((error, at, body));
            }
        }
    }
    let (error, at, body) = most.filter(|most| most.0 > LARGE_ERROR)?;
    let (angle, element) = at.turned.most;
    let place = match body.form.shells() {
        Some(_) if angle > at.section.0 => format!("element {element} of "),
        _ => String::new(),
    };
    Some(format!(
        "{place}\"{}\" turns by {:.2} rad relative to its body's frame at t = {:.4} s: its deformation errs by about \
         {:.1} %, since strains and joints hold for small rotations; divide the body",
        body.name,
        angle.max(at.section.0),
        run.time(at.sample),
        100.0 * error
    ))
}

/// The beam without coupling of twist and bending whose moment comes near lateral buckling, if one does.
fn lateral(model: &Model<f64>, run: &Trajectory<f64>) -> Option<String> {
    let mut most: (f64, usize, &str) = (0.0, 0, "");
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        for body in &model.flexible {
            let part = flexible::of_lateral_moment(body, &motions);
            if part > most.0 {
                most = (part, k, &body.name);
            }
        }
    }
    let (part, k, name) = most;
    (part > LATERAL).then(|| {
        format!(
            "\"{name}\" bears {part:.2} of the moment π √(EI GJ)/L that buckles it sideways between hinges at t = {:.4} s, \
             and its twist and bending do not couple: give it \"von_karman\" strain and functions of \
             \"bending_y\", \"bending_z\" and \"torsion\"",
            run.time(k)
        )
    })
}

/// The body with the largest strain, if it is too large.
fn large_strain(
    model: &Model<f64>,
    run: &Trajectory<f64>,
    peaks: &[Option<usize>],
) -> Option<String> {
    let mut most: Option<(f64, usize, &FlexibleBody<f64>)> = None;
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        for (body, peak) in model.flexible.iter().zip(peaks) {
            let looked = is_looked_at(run, k) || *peak == Some(k);
            let strain = strain(body, &motions, looked);
            if most.is_none_or(|most| strain > most.0) {
                most = Some((strain, k, body));
            }
        }
    }
    let (strain, k, body) = most.filter(|most| most.0 > LARGE_STRAIN)?;
    Some(format!(
        "\"{}\" is strained by {strain:.2} at t = {:.4} s; above {LARGE_STRAIN} strains are not small, \
         and stress is not proportional to them",
        body.name,
        run.time(k)
    ))
}

/// Whether sample `k` is one at which strains of all shells are evaluated.
fn is_looked_at(run: &Trajectory<f64>, k: usize) -> bool {
    let every = run.last().div_ceil(LOOKS).max(1);
    k.is_multiple_of(every) || k == run.last()
}

/// Refuses a motion in which shells are turned inside out, or a beam is shortened by its length or more.
///
/// # Errors
/// [`IntegrationFailure::InsideOut`].
pub(super) fn refuse_inside_out(
    model: &Model<f64>,
    run: &Trajectory<f64>,
) -> Result<(), IntegrationFailure> {
    if model.flexible.is_empty() {
        return Ok(());
    }
    let mut motions = Vec::new();
    for k in 0..=run.last() {
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        for body in &model.flexible {
            if let Some(place) = inside_out(body, &motions) {
                return Err(IntegrationFailure::InsideOut {
                    body: body.name.clone(),
                    place,
                    time: run.time(k),
                });
            }
        }
    }
    Ok(())
}

/// The first part of a body that is turned inside out.
fn inside_out(body: &FlexibleBody<f64>, motions: &[BodyMotion<f64>]) -> Option<String> {
    if let Some(element) = flexible::inside_out(body, motions) {
        return Some(format!("element {element}"));
    }
    let strains = flexible::axial_strains(body, motions);
    let shortened = strains.into_iter().any(|strain| strain <= -1.0);
    shortened.then(|| "it is shortened by more than its length".into())
}

/// The largest strain of a beam along its axis or, if `looked`, von Mises stress of shells by
/// Young's modulus.
fn strain(body: &FlexibleBody<f64>, motions: &[BodyMotion<f64>], looked: bool) -> f64 {
    let strains = flexible::axial_strains(body, motions);
    let mut most = (strains.iter()).fold(0.0_f64, |most, strain| most.max(strain.abs()));
    if let (Some(shells), true) = (body.form.shells(), looked) {
        for (i, element) in shells.mesh.elements.iter().enumerate() {
            let ratios = flexible::stress_ratios(body, motions, &[i]);
            let ratio = ratios.into_iter().fold(0.0_f64, f64::max);
            most = most.max(ratio * element.yield_stress / shells.young[i]);
        }
    }
    most
}

/// The body of linear strain that spins fastest relative to its lowest frequency, if it spins too fast.
fn fast_spin(model: &Model<f64>, run: &Trajectory<f64>) -> Option<String> {
    let mut most: Option<(f64, String)> = None;
    for body in &model.flexible {
        let modal = match &body.form {
            Form::Modal(modal) if modal.stiffness.strains.is_empty() && modal.shells.is_none() => {
                modal
            }
            Form::Modal(_) | Form::Finite(_) => continue,
        };
        let frame = &model.bodies[body.frame];
        let numbers = ModalNumbers {
            mass: frame.mass,
            inertia: frame.inertia,
            shapes: modal.inertia.clone(),
            stiffness: modal.stiffness.clone(),
            damping: Vec::new(),
            viscosity: None,
        };
        let lowest = frequencies(&numbers, Held::Axes).and_then(|all| all.first().copied());
        let Some(lowest) = lowest.map(|hertz| TAU * hertz) else {
            continue;
        };
        let (mut spin, mut at) = (0.0, 0);
        let mut motions = Vec::new();
        for k in 0..=run.last() {
            BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
            let own = motions[body.frame].omega.norm();
            if own > spin {
                (spin, at) = (own, k);
            }
        }
        let part = spin / lowest;
        if part > FAST && most.as_ref().is_none_or(|(before, _)| part > *before) {
            let told = format!(
                "\"{}\" turns with {spin:.3e} rad/s at t = {:.4} s, {part:.2} of its lowest angular frequency \
                 {lowest:.3e} rad/s; its strain is linear, so rotation softens it and does not stiffen it: its \
                 stiffness errs by about {:.0} %",
                body.name,
                run.time(at),
                100.0 * part * part
            );
            most = Some((part, told));
        }
    }
    most.map(|(_, told)| told)
}
