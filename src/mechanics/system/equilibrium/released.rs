//! A machine at rest whose controllers run.
//!
//! Rest is found with a drive in the place of each integral, see [`Regime::Settled`](crate::model::controller::Regime). The
//! vibrations about it are those of the closed loop: the drive goes, its effort F is that of the motor, and the states are
//! what gives it,
//!
//! ```text
//! I = u(F) − p e − d ė − f − g,     F of a lag = F,     u the demand for which the limits of the motor leave F
//! ```
//!
//! Positions and the reactions of joints stay. So the machine is in the state of a motion at an instant, at which it rests.

use super::equations::State;
use super::pencil::{At, Moves};
use crate::math::{Scalar, Vec3};
use crate::model::controller::Coordinate;
use crate::model::{DegreeOfFreedom, LoadKind, Model};
use crate::system::bodies::BodyMotion;
use crate::system::constraint::RowGradient;
use crate::system::failure::AssemblyFailure;
use crate::system::in_motion::InMotion;
use crate::system::joints;
use crate::system::loads::settled_states;
use crate::system::numbering::Numbering;
use crate::system::redundant_rows::RedundantRows;

/// The machine with its state.
pub(super) struct Released<S> {
    model: Model<S>,
    numbering: Numbering,
    left_out: RedundantRows,
    q: Vec<S>,
    v: Vec<S>,
    a: Vec<S>,
    lambda: Vec<S>,
}

impl<S: Scalar> Released<S> {
    /// That of a machine at rest; `None` if no controller has states.
    ///
    /// # Errors
    /// A motor that is too weak.
    pub(super) fn of(
        held: (&Model<S>, &Numbering),
        x: &State<S>,
    ) -> Result<Option<Self>, AssemblyFailure> {
        let (settled, numbering) = held;
        if !settled.is_settled() {
            return Ok(None);
        }
        let mut model = settled.clone();
        model.run();
        let own = Numbering::new(&model);
        let left_out = RedundantRows::of(&model, &own);
        let still = vec![S::zero(); own.velocities()];
        let mut v = still.clone();
        let mut motions = Vec::new();
        BodyMotion::all(numbering, &x.q, &still, &mut motions);
        let here = InMotion::new(settled, numbering, &motions, S::zero());
        let free = InMotion::new(&model, &own, &motions, S::zero());
        let lambda = multipliers((&here, &x.lambda), &free);
        for (load, own_load) in settled.loads.iter().enumerate() {
            let LoadKind::Controller(controller) = &own_load.kind else {
                continue;
            };
            let effort = match (&controller.integral, &controller.feedback[0].coordinate) {
                (Some(_), Coordinate::Joint { joint, dof, .. }) => {
                    effort_of_drive(&here, &model, (*joint, *dof), &x.lambda)
                }
                _ => S::zero(),
            };
            let states = settled_states(&here, load, effort);
            let states = states.ok_or_else(|| AssemblyFailure::TooWeak {
                load: own_load.name.clone(),
                effort: effort.re().abs(),
            })?;
            for (body, state) in states {
                v[own.velocity(body)] = state;
            }
        }
        Ok(Some(Self {
            model,
            numbering: own,
            left_out,
            q: x.q.clone(),
            v,
            a: still,
            lambda,
        }))
    }

    /// What small motions are about.
    pub(super) fn at(&self) -> At<'_, S> {
        At {
            model: &self.model,
            numbering: &self.numbering,
            left_out: &self.left_out,
            q: &self.q,
            lambda: &self.lambda,
            moves: Moves::AtInstant {
                v: &self.v,
                a: &self.a,
                time: S::zero(),
            },
        }
    }
}

/// The multipliers that give the reactions of joints where drives are gone. A drive moves the frame of its joint on body B, and
/// with it what the multipliers of the other rows are those of: where it is gone, they are others.
fn multipliers<S: Scalar>((held, lambda): (&InMotion<S>, &[S]), free: &InMotion<S>) -> Vec<S> {
    let (mut with, mut without) = (Vec::new(), Vec::new());
    joints::gradients(held, &mut with);
    joints::gradients(free, &mut without);
    let mut out = Vec::with_capacity(free.numbering.constraints());
    for (j, joint) in free.model.joints.iter().enumerate() {
        let rows = held.model.joints[j].rows().zip(held.numbering.rows(j));
        let imposed = rows.filter(|(row, _)| joint.rows().any(|own| own == *row));
        let imposed: Vec<usize> = imposed.map(|(_, i)| i).collect();
        if imposed.len() == held.numbering.rows(j).len() {
            out.extend(imposed.into_iter().map(|i| lambda[i]));
            continue;
        }
        // The wrench on body A: a force, and a torque in body axes.
        let wrench = |g: &RowGradient<S>| [g.force, g.torque_a];
        let mut whole = [Vec3::zeros(); 2];
        for i in imposed {
            for (sum, own) in whole.iter_mut().zip(wrench(&with[i])) {
                *sum += own * lambda[i];
            }
        }
        let own: Vec<[Vec3<S>; 2]> = free
            .numbering
            .rows(j)
            .map(|i| wrench(&without[i]))
            .collect();
        out.extend(parts(&own, &whole));
    }
    out
}

/// The factors with which independent wrenches add up to `whole`, which is in their space.
fn parts<S: Scalar>(wrenches: &[[Vec3<S>; 2]], whole: &[Vec3<S>; 2]) -> Vec<S> {
    let inner = |a: &[Vec3<S>; 2], b: &[Vec3<S>; 2]| a[0].dot(&b[0]) + a[1].dot(&b[1]);
    // Normal equations, positive definite, each row with its right side.
    let row = |own: &[Vec3<S>; 2]| -> Vec<S> {
        let all = wrenches.iter().chain([whole]);
        all.map(|other| inner(own, other)).collect()
    };
    let mut rows: Vec<Vec<S>> = wrenches.iter().map(row).collect();
    let n = rows.len();
    for k in 0..n {
        let pivot = rows[k].clone();
        for i in (0..n).filter(|&i| i != k) {
            let factor = rows[i][k] / pivot[k];
            for (x, &p) in rows[i].iter_mut().zip(&pivot) {
                *x -= factor * p;
            }
        }
    }
    (0..n).map(|k| rows[k][n] / rows[k][k]).collect()
}

/// The force or torque on body A of a joint by the rows that it has beyond those of `model`, along its axis.
fn effort_of_drive<S: Scalar>(
    at: &InMotion<S>,
    model: &Model<S>,
    (joint, dof): (usize, DegreeOfFreedom),
    lambda: &[S],
) -> S {
    let mut gradients = Vec::new();
    joints::gradients(at, &mut gradients);
    let own = &at.model.joints[joint];
    let turned = &at.motions[own.body_a].rotation;
    let axis = own.frame_a.axes[2];
    let rows = own.rows().zip(at.numbering.rows(joint));
    let of_drive = rows.filter(|(row, _)| !model.joints[joint].rows().any(|own| own == *row));
    of_drive.fold(S::zero(), |sum, (_, i)| {
        let by = match dof {
            DegreeOfFreedom::Rotation => gradients[i].torque_a.dot(&axis),
            DegreeOfFreedom::Translation => gradients[i].force.dot(&(turned * axis)),
        };
        sum - by * lambda[i]
    })
}
