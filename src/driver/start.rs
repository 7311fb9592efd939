//! Changes of the start that a file gives: bodies are moved to close the joints, velocities are
//! projected onto the joints; and notes on joints without degrees of freedom.

use super::driven_start::{TOLD, hit, short, unsteady};
use crate::math::{Vec3, rotation};
use crate::model::{Model, RigidBody};
use crate::problem::Problem;
use crate::system::flexible::{MeanSquare, strain_energy};
use crate::system::initial::{self, InitialState};
use crate::system::placement::{guess, length_scale};
use crate::system::{BodyMotion, InMotion, Numbering, joints, redundancy};

/// Part of the speeds of a scene that a told strain energy gives to the mass of its body.
const SLOW: f64 = 1e-3;
/// Largest number of bodies that are reported.
const MOST: usize = 5;
/// A ratio of the smallest to the largest singular value of the unit rows below this is reported.
const NEARLY: f64 = 1e-4;

/// Notes on the start at the design `x`, one sentence each; empty if the start is as given, or if
/// there is none.
pub fn notes(problem: &Problem, x: &[f64]) -> Vec<String> {
    // It goes on after an event.
    if problem.last_event().is_some() {
        return Vec::new();
    }
    match problem.without_equilibrium() {
        Some(_) if problem.is_turning() => of_rotation(problem, x),
        Some(_) if problem.is_rest() => of_rest(problem, x),
        Some(placed) => {
            let mut notes = of_placement(&placed, x, " before equilibrium is sought");
            notes.extend(unstable(problem, x));
            let model = placed.unlowered_scene(x).model;
            tell(&mut notes, unsteady(problem, &model, x));
            notes
        }
        None => of_placement(problem, x, ""),
    }
}

/// A note on a machine in steady rotation, if a disturbance grows.
fn of_rotation(problem: &Problem, x: &[f64]) -> Vec<String> {
    let count = problem.told_modes().map_or(1, |told| told.count);
    let found = problem.modes_of_machine(x, (count, None));
    let growth = found.ok().and_then(|own| own.growth);
    let told = growth.map(|rate| format!("the steady rotation is {}", not_stable(rate)));
    told.into_iter().collect()
}

/// Notes on a machine at rest: whether it would stay there.
fn of_rest(problem: &Problem, x: &[f64]) -> Vec<String> {
    let Some(stability) = problem.stability_at_rest(x) else {
        return Vec::new();
    };
    let unstable = (stability.growth).map(|rate| format!("the rest is {}", not_stable(rate)));
    let free = (!stability.free.is_empty()).then(|| {
        let mut names = stability.free;
        let more = names.len().saturating_sub(MOST);
        names.truncate(MOST);
        if more > 0 {
            names.push(format!("{more} more"));
        }
        format!(
            "the rest is neutral: {} can move without a force, and stay as placed",
            names.join(", ")
        )
    });
    let snapped = stability.snapped.then(|| {
        "the way from the placement leads through positions that are not stable, as of an arch that snaps through: this \
         rest may change suddenly with the design; place the bodies nearer to it"
            .to_owned()
    });
    unstable.into_iter().chain(free).chain(snapped).collect()
}

/// A start in equilibrium from which a disturbance grows, as that of a column that buckles.
pub fn unstable(problem: &Problem, x: &[f64]) -> Option<String> {
    let growth = problem.growth_at_equilibrium(x)?;
    Some(format!(
        "the start in equilibrium is {}, unless rotation holds it",
        not_stable(growth)
    ))
}

/// That a disturbance grows with `rate` \[1/s\].
pub fn not_stable(rate: f64) -> String {
    let time = 1.0 / rate;
    format!("not stable: a disturbance grows by a factor of e in {time:.1e} s")
}

/// Notes on a start without equilibrium; `when` says when bodies are deformed.
fn of_placement(problem: &Problem, x: &[f64], when: &str) -> Vec<String> {
    let model = problem.unlowered_scene(x).model;
    let numbering = Numbering::new(&model);
    let mut notes = Vec::new();
    tell(&mut notes, replaced(problem, &model, x));
    let locked = degrees_of_freedom(&problem.scene(x).model) == 0 && !model.bodies.is_empty();
    let driven = model.joints.iter().any(|joint| !joint.drives.is_empty());
    let stuck = locked && !driven;
    if !stuck && consistent(&model, &numbering) {
        return notes;
    }
    let Ok(start) = initial::consistent(&model, &numbering) else {
        return notes;
    };
    if stuck {
        let (rows, _) = redundancy::unit_rows(&model, &start.q);
        let values = rows.singular_values();
        let nearly = values.min() / values.max();
        let near = match nearly < NEARLY {
            true => format!(
                "; their conditions nearly repeat each other (to {nearly:.1e}): with joints that fit \
                 exactly there would be a freedom more"
            ),
            false => String::new(),
        };
        notes.push(format!(
            "the joints leave no freedom: nothing can move{near}"
        ));
    }
    let moved = moved(&model, &numbering, &start);
    tell(&mut notes, moved);
    // The velocities of a start in equilibrium follow its drives.
    if when.is_empty() || !driven {
        tell(&mut notes, deformed(&model, &numbering, &start, when));
        tell(&mut notes, changed(&model, &numbering, &start));
    }
    notes.extend(hit(&model, &numbering, &start));
    notes
}

/// Bodies whose velocities in the file are replaced by the starts of joints.
fn replaced(problem: &Problem, model: &Model<f64>, x: &[f64]) -> Vec<String> {
    let own = problem.own_velocities(x);
    let moving: Vec<(&RigidBody<f64>, Velocities, Velocities)> = (model.bodies.iter().zip(own))
        .filter_map(|(body, own)| {
            let [v, omega] = own?;
            let turned = rotation::matrix(&body.orientation) * body.angular_velocity;
            Some((body, (v, omega), (body.velocity, turned)))
        })
        .collect();
    let sizes = moving.iter().flat_map(|(_, given, start)| [given, start]);
    let (speed, spin) = sizes.fold((0.0_f64, 0.0_f64), |(speed, spin), (v, omega)| {
        (speed.max(v.norm()), spin.max(omega.norm()))
    });
    let one = |(body, given, start): &(&RigidBody<f64>, Velocities, Velocities)| {
        let (by, turning) = ((start.0 - given.0).norm(), (start.1 - given.1).norm());
        (by > TOLD * speed || turning > TOLD * spin).then(|| {
            format!(
                "the starts of joints replace the given velocity of body \"{}\": {}",
                body.name,
                change(given, start)
            )
        })
    };
    moving.iter().filter_map(one).collect()
}

/// A change of velocities as text.
fn change((v, omega): &Velocities, (v_start, omega_start): &Velocities) -> String {
    format!(
        "it starts with {} of {} m/s and {} of {} rad/s (changed by {} m/s and {} rad/s)",
        short(v_start.norm()),
        short(v.norm()),
        short(omega_start.norm()),
        short(omega.norm()),
        short((v_start - v).norm()),
        short((omega_start - omega).norm()),
    )
}

fn tell(notes: &mut Vec<String>, all: Vec<String>) {
    let more = all.len().saturating_sub(MOST);
    notes.extend(all.into_iter().take(MOST));
    if more > 0 {
        notes.push(format!("and {more} more bodies likewise"));
    }
}

/// Number of unknown velocities minus the conditions that are independent in most positions.
fn degrees_of_freedom(model: &Model<f64>) -> usize {
    let imposed: usize = model
        .joints
        .iter()
        .map(|joint| joint.imposed().count())
        .sum();
    Numbering::new(model).unknowns().saturating_sub(imposed)
}

/// Whether the placement and its velocities satisfy the joints.
fn consistent(model: &Model<f64>, numbering: &Numbering) -> bool {
    let (q, v) = guess(model);
    let mut motions = Vec::new();
    BodyMotion::all(numbering, &q, &v, &mut motions);
    let mut rows = vec![0.0; numbering.constraints()];
    let largest = |rows: &[f64]| rows.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let at = InMotion::new(model, numbering, &motions, 0.0);
    joints::values(&at, &mut rows);
    let length = length_scale(model);
    if largest(&rows) > 0.1 * TOLD * length.min(1.0) {
        return false;
    }
    joints::rates(&at, &mut rows);
    let driven = largest(&rows) > 0.0 && v.iter().all(|x| *x == 0.0);
    !driven && largest(&rows) <= 0.1 * TOLD * largest(&v) * length.min(1.0)
}

/// Bodies that were moved.
fn moved(model: &Model<f64>, numbering: &Numbering, start: &InitialState<f64>) -> Vec<String> {
    let length = length_scale(model);
    let one = |(i, body): (usize, &RigidBody<f64>)| {
        let q = &start.q[numbering.position(i)..];
        let by = (Vec3::new(q[0], q[1], q[2]) - body.position).norm();
        let p = [q[3], q[4], q[5], q[6]];
        let turn = rotation::matrix(&body.orientation).transpose() * rotation::matrix(&p);
        let angle = turn_angle(&turn);
        (by > TOLD * length || angle > TOLD).then(|| {
            format!(
                "body \"{}\" was moved by {by:.3e} m and turned by {angle:.3e} rad to close the joints",
                body.name
            )
        })
    };
    let of_the_file = |(i, _): &(usize, &RigidBody<f64>)| !model.is_internal(*i);
    let bodies = model.bodies.iter().enumerate().filter(of_the_file);
    bodies.filter_map(one).collect()
}

/// Flexible bodies that were deformed: by their places, or by a strain energy that moves their mass with a part of the
/// speeds of the scene.
fn deformed(
    model: &Model<f64>,
    numbering: &Numbering,
    start: &InitialState<f64>,
    when: &str,
) -> Vec<String> {
    let length = length_scale(model);
    let (placed, _) = guess(model);
    let energies = |q: &[f64]| -> Vec<f64> {
        let mut motions = Vec::new();
        BodyMotion::all(numbering, q, &start.v, &mut motions);
        let all = model.flexible.iter();
        all.map(|body| strain_energy(body, &motions)).collect()
    };
    let both: Vec<(f64, f64)> = (energies(&placed).into_iter().zip(energies(&start.q))).collect();
    let most = (both.iter()).fold(0.0, |most: f64, (before, after)| most.max(after - before));
    let fall = (model.gravity.norm() * length).sqrt();
    let speed = model.bodies.iter().fold(fall, |speed, body| {
        speed
            .max(body.velocity.norm())
            .max(body.angular_velocity.norm() * length)
    });
    let change = |carrier: usize, k: usize| {
        let i = numbering.position(carrier) + k;
        start.q[i] - placed[i]
    };
    let displacements = MeanSquare::all(model).into_iter();
    let moved: Vec<bool> = displacements
        .map(|own| own.value(change).sqrt() > TOLD * length)
        .collect();
    let is_told = |i: usize| {
        let mass = model.bodies[model.flexible[i].frame].mass;
        let kinetic = 0.5 * mass * (SLOW * speed).powi(2);
        moved[i] || speed > 0.0 && both[i].1 - both[i].0 > kinetic
    };
    if !(0..both.len()).any(is_told) {
        return Vec::new();
    }
    let all = model.flexible.iter().zip(&both).enumerate();
    let told = all.filter(|&(i, (_, both))| is_told(i) || both.1 - both.0 > TOLD * most);
    told.map(|(_, (body, (before, after)))| {
        format!(
            "closing the joints deforms body \"{}\": its strain energy is {after:.3e} J instead of {before:.3e} J{when}; \
             place the bodies so that the joints fit",
            body.name
        )
    })
    .collect()
}

fn turn_angle(turn: &crate::math::Mat3<f64>) -> f64 {
    let axis = Vec3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    (0.5 * axis.norm()).atan2(0.5 * (turn.trace() - 1.0))
}

/// Velocity [m/s] and angular velocity [rad/s] of a body.
type Velocities = (Vec3<f64>, Vec3<f64>);

/// Bodies whose given velocities were changed.
fn changed(model: &Model<f64>, numbering: &Numbering, start: &InitialState<f64>) -> Vec<String> {
    let parts = |v: &[f64]| (Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]));
    let given = |i: usize| (model.bodies[i].velocity, model.bodies[i].angular_velocity);
    let all = (0..model.bodies.len()).map(|i| (given(i), parts(&start.v[numbering.velocity(i)..])));
    let (mut speed, mut spin) = (0.0_f64, 0.0_f64);
    for ((v, omega), (v_start, omega_start)) in all.clone() {
        speed = speed.max(v.norm()).max(v_start.norm());
        spin = spin.max(omega.norm()).max(omega_start.norm());
    }
    // Round-off of a scene that only turns is no speed, and no spin of one that only moves.
    let length = length_scale(model);
    (speed, spin) = (speed.max(spin * length), spin.max(speed / length));
    let one = |(i, (given, start)): (usize, (Velocities, Velocities))| {
        let ((v, omega), (v_start, omega_start)) = (given, start);
        if v.norm() == 0.0 && omega.norm() == 0.0 || model.is_internal(i) {
            return None;
        }
        let (by, turning) = ((v_start - v).norm(), (omega_start - omega).norm());
        (by > TOLD * speed || turning > TOLD * spin).then(|| {
            format!(
                "the joints do not admit the given velocity of body \"{}\": {}",
                model.bodies[i].name,
                change(&(v, omega), &(v_start, omega_start)),
            )
        })
    };
    all.enumerate().filter_map(one).collect()
}
