//! The loads of a model in motion: generalised forces, their Jacobians, pull-backs and energy.
//!
//! For virtual velocities ψ, ψᵀf is the power of a load, linear in ψ. `power.rs` has the forces and
//! `pull.rs` the transposed derivative of the power, once for each kind and for any scalar. Forces,
//! Jacobians and pull-backs all use these two, so they agree. Springs have both in `spring.rs`, stops in `stop.rs`, contacts in
//! `contact/`, drag in `drag.rs`, bushings in `bushing.rs` with the friction of their bearings in `bearing.rs`, controllers in
//! `control_law.rs` and `controller.rs` with the limits of their motors in `motor.rs`. The law of stops, contacts and cables is in
//! `normal_law.rs`. Loads that are spread over the elements of a flexible body act on its coordinates too: `distributed/` has all of
//! theirs.

mod bearing;
mod bushing;
pub mod cable;
mod contact;
mod control_law;
mod controlled;
mod controller;
mod coordinate;
mod distributed;
mod drag;
pub mod gaps;
mod kinds;
pub mod measured;
mod motor;
mod normal_law;
mod parameters;
mod power;
mod pull;
mod spring;
mod stop;
pub mod work;

use super::bodies::{BodyMotion, add6, velocities_of};
use super::in_motion::InMotion;
use super::numbering::Numbering;
use super::placement::guess;
use super::side::JointSide;
use super::turns;
use crate::linalg::Emit;
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, DegreeOfFreedom, JointFrame, LoadKind, Model};
use parameters::give_to_parameters;
use pull::Pulled;

pub use controlled::settled as settled_states;
pub use distributed::normal_shares;

/// Both bodies of a load, with its points or frames.
pub(super) struct Acting<'a, S> {
    bodies: [Option<usize>; 2],
    a: JointSide<'a, S>,
    b: JointSide<'a, S>,
    /// The angle of the joint with all its turns, if they are counted \[rad\].
    counted: Option<f64>,
    /// The part of a capsule's half at which the sphere is that touches, or 0.
    part: f64,
}

impl<S> Acting<'_, S> {
    /// The same with the other body first.
    fn exchanged(self) -> Self {
        let [a, b] = self.bodies;
        Self {
            bodies: [b, a],
            a: self.b,
            b: self.a,
            ..self
        }
    }
}

/// Calls `visit(number of the load, its kind, its bodies)` for every load on one or two bodies; once for each sphere of a
/// capsule.
fn for_each_load<S: Scalar>(
    model: &Model<S>,
    motions: &[BodyMotion<S>],
    visit: impl FnMut(usize, &LoadKind<S>, &Acting<S>),
) {
    for_loads(model, motions, 0..model.loads.len(), visit);
}

/// The same without contacts of which the bodies are far from each other.
fn for_near_loads<S: Scalar>(
    here: &InMotion<S>,
    visit: impl FnMut(usize, &LoadKind<S>, &Acting<S>),
) {
    let (model, motions) = (here.model, here.motions);
    match here.numbering.near() {
        None => for_each_load(model, motions, visit),
        Some(near) => {
            let place = |body: usize| motions[body].position.map(Scalar::re);
            for_loads(model, motions, near.loads(place, |_| 0.0), visit);
        }
    }
}

/// The same for some of the loads.
fn for_loads<S: Scalar>(
    model: &Model<S>,
    motions: &[BodyMotion<S>],
    wanted: impl IntoIterator<Item = usize>,
    mut visit: impl FnMut(usize, &LoadKind<S>, &Acting<S>),
) {
    let (ground, nowhere) = (BodyMotion::ground(), JointFrame::zero());
    let at = |point: &Vec3<S>| JointFrame {
        point: *point,
        ..nowhere
    };
    let acting = |(body_a, frame_a): (usize, JointFrame<S>),
                  (body_b, frame_b): (Option<usize>, JointFrame<S>)| Acting {
        bodies: [Some(body_a), body_b],
        a: JointSide::fixed(&motions[body_a], frame_a),
        b: JointSide::fixed(body_b.map_or(&ground, |body| &motions[body]), frame_b),
        counted: None,
        part: 0.0,
    };
    let on_joint = |joint: usize| {
        let joint = &model.joints[joint];
        acting((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b))
    };
    for i in wanted {
        let load = &model.loads[i];
        let acting = match &load.kind {
            LoadKind::Force { body, point, .. } | LoadKind::Drag { body, point, .. } => {
                acting((*body, at(point)), (None, nowhere))
            }
            LoadKind::Torque { body, .. } => acting((*body, nowhere), (None, nowhere)),
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
            } => acting((*body_a, at(point_a)), (*body_b, at(point_b))),
            LoadKind::Contact(own) => {
                let to = |point: Vec3<S>| {
                    acting((own.body_a, at(&point)), (own.body_b, at(&own.point_b)))
                };
                if let Some((half, parts)) = own.spheres() {
                    for part in parts {
                        let acting = to(own.point_a + half * S::from(part));
                        visit(i, &load.kind, &Acting { part, ..acting });
                    }
                    continue;
                }
                to(own.point_a)
            }
            // The angle of a spring or a stop is that of the bodies; it does not include drives.
            LoadKind::TorsionSpring { joint, counter, .. }
            | LoadKind::JointStop { joint, counter, .. } => {
                let acting = on_joint(*joint);
                let ends = [&acting.a.motion.orientation, &acting.b.motion.orientation];
                let counted = counter.map(|counter| {
                    let known = motions[counter].position.x.re();
                    turns::counted(model, (*joint, counter), ends, known)
                });
                Acting { counted, ..acting }
            }
            LoadKind::Bushing {
                joint,
                of_second: true,
                ..
            } => on_joint(*joint).exchanged(),
            LoadKind::Damping { joint, .. }
            | LoadKind::BallDamping { joint, .. }
            | LoadKind::Bushing { joint, .. }
            | LoadKind::Friction { joint, .. } => on_joint(*joint),
            LoadKind::Distributed(_) | LoadKind::Controller(_) | LoadKind::Cable(_) => continue,
        };
        visit(i, &load.kind, &acting);
    }
}

/// Adds the generalised forces f of all loads (force in ground axes, torque in body axes about the
/// reference point, those on elastic coordinates) to `out`, in velocity numbering.
pub fn add_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_near_loads(here, |_, kind, at| {
        let forces = kinds::forces(kind, at, here.time);
        for (body, (force, torque)) in at.bodies.into_iter().zip(forces) {
            let Some(body) = body else { continue };
            add6(&mut out[here.numbering.velocity(body)..], &force, &torque);
        }
    });
    distributed::add_forces(here, out);
    controller::add_forces(here, out);
    cable::add_forces(here, out);
}

/// Adds the forces that supply energy to `out`, in velocity numbering: forces, torques, efforts of controllers, and loads
/// on elements. Springs store energy; dampers and friction take it.
pub fn add_supplying_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each_load(here.model, here.motions, |_, kind, at| {
        if !matches!(kind, LoadKind::Force { .. } | LoadKind::Torque { .. }) {
            return;
        }
        let forces = kinds::forces(kind, at, here.time);
        for (body, (force, torque)) in at.bodies.into_iter().zip(forces) {
            let Some(body) = body else { continue };
            add6(&mut out[here.numbering.velocity(body)..], &force, &torque);
        }
    });
    distributed::add_supplying_forces(here, out);
    controller::add_efforts(here, out);
}

/// Non-zero 3 × 3 blocks of the derivative of a load: (linear, angular) parts.
struct Blocks {
    /// Forces and torques.
    rows: [bool; 2],
    /// Tangent positions.
    y: [bool; 2],
    /// Velocities.
    v: [bool; 2],
}

fn blocks<S: Scalar>(kind: &LoadKind<S>) -> Blocks {
    const NONE: [bool; 2] = [false, false];
    const LINEAR: [bool; 2] = [true, false];
    const ANGULAR: [bool; 2] = [false, true];
    const BOTH: [bool; 2] = [true, true];
    let of = |rows, y, v| Blocks { rows, y, v };
    // A zero that no design changes has no columns.
    let damped = |c: &S, columns| if c.is_zero() { NONE } else { columns };
    match kind {
        LoadKind::Force { axes, .. } => match axes {
            Axes::Ground => of(ANGULAR, ANGULAR, NONE),
            Axes::Body => of(LINEAR, ANGULAR, NONE),
        },
        LoadKind::Torque { axes, .. } => match axes {
            Axes::Ground => of(ANGULAR, ANGULAR, NONE),
            Axes::Body => of(NONE, NONE, NONE),
        },
        LoadKind::Spring {
            damping, tables, ..
        } => match tables[1] {
            Some(_) => of(BOTH, BOTH, BOTH),
            None => of(BOTH, BOTH, damped(damping, BOTH)),
        },
        LoadKind::TorsionSpring {
            damping, tables, ..
        } => match tables[1] {
            Some(_) => of(ANGULAR, ANGULAR, ANGULAR),
            None => of(ANGULAR, ANGULAR, damped(damping, ANGULAR)),
        },
        LoadKind::Contact(_) => of(BOTH, BOTH, BOTH),
        LoadKind::Bushing {
            damping, friction, ..
        } => match damping.iter().all(|c| c.is_zero()) && friction.is_none() {
            true => of(BOTH, BOTH, NONE),
            false => of(BOTH, BOTH, BOTH),
        },
        LoadKind::Drag { .. } => of(BOTH, ANGULAR, BOTH),
        LoadKind::BallDamping { .. } => of(ANGULAR, ANGULAR, ANGULAR),
        LoadKind::JointStop {
            dof: DegreeOfFreedom::Rotation,
            law,
            ..
        } => of(ANGULAR, ANGULAR, damped(&law.dissipation, ANGULAR)),
        LoadKind::JointStop {
            dof: DegreeOfFreedom::Translation,
            law,
            ..
        }
        | LoadKind::DistanceStop { law, .. } => of(BOTH, BOTH, damped(&law.dissipation, BOTH)),
        LoadKind::Damping { dof, .. } | LoadKind::Friction { dof, .. } => match dof {
            DegreeOfFreedom::Rotation => of(ANGULAR, ANGULAR, ANGULAR),
            DegreeOfFreedom::Translation => of(BOTH, BOTH, BOTH),
        },
        LoadKind::Distributed(_) | LoadKind::Controller(_) | LoadKind::Cable(_) => {
            of(NONE, NONE, NONE)
        }
    }
}

/// Place of the derivatives of the forces, in velocity numbering, and their factors.
#[derive(Clone, Copy, Debug)]
pub struct LoadEntries<S> {
    /// Row of the forces.
    pub row: usize,
    /// Column of the tangent positions.
    pub y: usize,
    /// Column of the velocities.
    pub v: usize,
    /// Factor of ∂f/∂y.
    pub by_y: S,
    /// Factor of ∂f/∂v.
    pub by_v: S,
}

/// Emits ∂f/∂y and ∂f/∂v with f as in [`add_forces`]; only the non-zero blocks of a load.
pub fn emit_jacobian<S: Scalar>(here: &InMotion<S>, to: &LoadEntries<S>, emit: &mut dyn Emit<S>) {
    let numbering = here.numbering;
    for_each_load(here.model, here.motions, |_, kind, at| {
        let blocks = blocks(kind);
        // The places of a contact that does not press stay in the pattern of the matrix.
        let touching = match kind {
            LoadKind::Contact(own) => Some((own, contact::state(own, at))),
            _ => None,
        };
        // One row of the Jacobian for each unit virtual velocity of either body.
        for side in 0..2 {
            let Some(body) = at.bodies[side] else {
                continue;
            };
            for component in 0..6 {
                if !blocks.rows[component / 3] {
                    continue;
                }
                let mut psi = [(Vec3::zeros(), Vec3::zeros()); 2];
                let (linear, angular) = &mut psi[side];
                [linear, angular][component / 3][component % 3] = S::one();
                let pulled = match &touching {
                    Some((own, now)) => contact::pulled((own, now.as_ref()), at, &psi),
                    None => kinds::pulled(kind, at, here.time, &psi),
                };
                let row = to.row + numbering.velocity(body) + component;
                for (body, by) in at.bodies.into_iter().zip([&pulled.a, &pulled.b]) {
                    let Some(body) = body else { continue };
                    let o = numbering.velocity(body);
                    let columns = [
                        (blocks.y, to.y, to.by_y, [&by.position, &by.theta]),
                        (blocks.v, to.v, to.by_v, [&by.velocity, &by.omega]),
                    ];
                    for (wanted, start, scale, parts) in columns {
                        for part in (0..2).filter(|&part| wanted[part]) {
                            emit.add_row(row, start + o + 3 * part, &(parts[part] * scale));
                        }
                    }
                }
            }
        }
    });
    distributed::emit_jacobian(here, to, emit);
    controller::emit_jacobian(here, to, emit);
    cable::emit_jacobian(here, to, emit);
}

/// Destination of the pull-back of the loads.
pub struct LoadCotangent<'a> {
    /// Tangent positions, velocity numbering; `None` if not needed.
    pub y: Option<&'a mut [f64]>,
    /// Velocities; `None` if not needed.
    pub v: Option<&'a mut [f64]>,
    /// Time.
    pub time: &'a mut f64,
    /// Parameters of the loads and the frames of their joints.
    pub model: &'a mut Model<f64>,
}

/// Adds the derivatives of ψᵀf, with f as in [`add_forces`], in tangent positions, velocities, time
/// and parameters.
pub fn pull_back(here: &InMotion<f64>, psi: &[f64], out: &mut LoadCotangent) {
    let (numbering, time) = (here.numbering, here.time);
    for_near_loads(here, |i, kind, at| {
        let psi = at.bodies.map(|body| {
            body.map_or((Vec3::zeros(), Vec3::zeros()), |body| {
                velocities_of(&psi[numbering.velocity(body)..])
            })
        });
        let pulled = kinds::pulled(kind, at, time, &psi);
        give_to_states(&pulled, at, numbering, (&mut out.y, &mut out.v));
        give_to_parameters(kind, &pulled, (i, at.part, time), (out.model, out.time));
    });
    distributed::pull_back(here, psi, out);
    controller::pull_back(here, psi, out);
    cable::pull_back(here, psi, out);
}

fn give_to_states(
    pulled: &Pulled<f64>,
    at: &Acting<f64>,
    numbering: &Numbering,
    (y, v): (&mut Option<&mut [f64]>, &mut Option<&mut [f64]>),
) {
    for (body, by) in at.bodies.into_iter().zip([&pulled.a, &pulled.b]) {
        let Some(body) = body else { continue };
        let o = numbering.velocity(body);
        if let Some(y) = y.as_deref_mut() {
            add6(&mut y[o..], &by.position, &by.theta);
        }
        if let Some(v) = v.as_deref_mut() {
            add6(&mut v[o..], &by.velocity, &by.omega);
        }
    }
}

/// Places whose distance is below this part of their coordinates are one place.
const ROUND_OFF: f64 = 1e-12;

/// Whether the points of a load are at one place, but for round-off.
fn at_one_place(at: &Acting<f64>) -> bool {
    let size = |side: &JointSide<f64>| side.motion.position.norm() + side.frame.point.norm();
    (at.a.point() - at.b.point()).norm() <= ROUND_OFF * (size(&at.a) + size(&at.b))
}

/// The contacts of a model with the place of each and its force on body A, in ground axes.
pub fn contact_forces(
    model: &Model<f64>,
    motions: &[BodyMotion<f64>],
) -> Vec<(usize, [Vec3<f64>; 2])> {
    let mut all = Vec::new();
    for_each_load(model, motions, |i, kind, at| {
        if let LoadKind::Contact(own) = kind {
            all.push((i, contact::pressed(own, at)));
        }
    });
    all
}

/// The first spring, stop, contact, controller or part of a cable of length zero in the placement whose ends may not meet, if
/// any.
pub fn without_length(model: &Model<f64>) -> Option<&str> {
    let (q, v) = guess(model);
    let (numbering, mut motions) = (Numbering::new(model), Vec::new());
    BodyMotion::all(&numbering, &q, &v, &mut motions);
    let mut found: Option<usize> = None;
    let mut meet = |i: usize| found = Some(found.map_or(i, |first| first.min(i)));
    for_each_load(model, &motions, |i, kind, at| {
        let meets = match kind {
            LoadKind::DistanceStop { .. } => at_one_place(at),
            LoadKind::Contact(own) => contact::meets(own, at),
            _ => spring::of(kind).is_some_and(|own| own.has_direction()) && at_one_place(at),
        };
        if meets {
            meet(i);
        }
    });
    let here = InMotion {
        model,
        numbering: &numbering,
        motions: &motions,
        time: 0.0,
    };
    controller::for_each(&here, |i, own| {
        let mut distances = own.distances();
        if distances.any(at_one_place) {
            meet(i);
        }
    });
    for (i, load) in model.loads.iter().enumerate() {
        if matches!(&load.kind, LoadKind::Cable(own) if cable::meets(own, &motions)) {
            meet(i);
        }
    }
    found.map(|i| model.loads[i].name.as_str())
}

/// Potential energy of springs, bushings, stops, contacts and cables \[J\] at `time`.
pub fn potential<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>], time: S) -> S {
    let mut sum = cable::potential(model, motions, time);
    for_each_load(model, motions, |_, kind, at| {
        sum += kinds::potential(kind, at);
    });
    sum
}

/// Adds `weight` times the derivative of [`potential`] to tangent positions, time and parameters.
pub fn pull_potential(here: &InMotion<f64>, weight: f64, out: &mut LoadCotangent) {
    for_near_loads(here, |i, kind, at| {
        let Some(pulled) = kinds::pulled_potential(kind, at, weight) else {
            return;
        };
        give_to_states(&pulled, at, here.numbering, (&mut out.y, &mut None));
        give_to_parameters(kind, &pulled, (i, at.part, 0.0), (out.model, &mut 0.0));
    });
    cable::pull_potential(here, weight, out);
}
