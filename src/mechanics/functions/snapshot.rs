//! A model at one instant of a run, and the cotangents of what it holds.

use super::flight::Flight;
use super::instant::{Gate, Projectile};
use super::multipliers::{RowCotangent, Rows};
use super::turning::Rotation;
use crate::integrate::Trajectory;
use crate::math::Scalar;
use crate::model::Model;
use crate::system::equilibrium::FrozenMode;
use crate::system::joints::JointCotangent;
use crate::system::{BodyMotion, InMotion, Numbering, flexible};

/// A model at one instant.
#[derive(Clone, Copy)]
pub struct Snapshot<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// Its numbering.
    pub numbering: &'a Numbering,
    /// Positions; one entry per position number.
    pub q: &'a [S],
    /// Velocities; one entry per velocity number.
    pub v: &'a [S],
    /// Accelerations; one entry per velocity number.
    pub a: &'a [S],
    /// Multipliers of the rows of joints whose reactions are measured, if any.
    pub reactions: Rows<'a, S>,
    /// Time \[s\].
    pub time: S,
}

impl<'a, S: Scalar> Snapshot<'a, S> {
    /// Instant k of a run.
    pub fn of(model: &'a Model<S>, run: &'a Trajectory<S>, k: usize) -> Self {
        Self {
            model,
            numbering: &run.numbering,
            q: run.q(k),
            v: run.v(k),
            a: run.a(k),
            reactions: Rows::none(),
            time: run.time(k),
        }
    }

    /// Motion of a body.
    pub fn motion(&self, body: usize) -> BodyMotion<S> {
        let a = &self.a[self.numbering.velocity(body)..];
        BodyMotion::of(self.numbering, body, self.q, self.v).accelerated(a)
    }

    /// Motions of all bodies.
    pub fn motions(&self) -> Vec<BodyMotion<S>> {
        let mut motions = Vec::with_capacity(self.numbering.bodies());
        BodyMotion::all(self.numbering, self.q, self.v, &mut motions);
        motions
    }

    /// The model with these motions.
    pub(super) fn in_motion<'b>(&'b self, motions: &'b [BodyMotion<S>]) -> InMotion<'b, S> {
        InMotion::new(self.model, self.numbering, motions, self.time)
    }

    /// Elastic coordinates of a flexible body.
    pub(super) fn coordinates(&self, flexible: usize) -> Vec<S> {
        flexible::coordinates(&self.model.flexible[flexible], &self.motions())
    }

    /// These unknowns of its nodes, or all elastic coordinates.
    pub fn unknowns(&self, flexible: usize, unknowns: Option<&[usize]>) -> Vec<S> {
        let q = self.coordinates(flexible);
        let Some(unknowns) = unknowns else {
            return q;
        };
        let basis = flexible::basis_of(&self.model.flexible[flexible]);
        let all = unknowns.iter();
        all.map(|&unknown| flexible::unknown_of(basis, unknown, &q))
            .collect()
    }

    /// The flight of a projectile that is released now.
    pub fn flight(&self, projectile: &Projectile<S>) -> Flight<S> {
        Flight::new(
            projectile,
            &self.motion(projectile.body),
            &self.model.gravity,
        )
    }

    /// A rotation plus `turns`, a multiple of 2π \[rad\].
    pub(super) fn rotation(&self, rotation: &Rotation<S>, turns: f64) -> S {
        rotation.angle(self.numbering, self.q) + turns
    }

    /// Openness of a gate; 1 without a gate.
    pub fn openness(&self, gate: &Option<Gate<S>>, turns: f64) -> S {
        gate.as_ref().map_or(S::one(), |gate| {
            gate.openness(self.rotation(&gate.rotation, turns))
        })
    }
}

/// Cotangents of a snapshot, in tangent positions, velocities and accelerations (all in velocity
/// numbering).
pub struct SnapshotCotangent<'a> {
    /// Of the tangent positions.
    pub y: &'a mut [f64],
    /// Of the velocities.
    pub v: &'a mut [f64],
    /// Of the accelerations.
    pub a: &'a mut [f64],
    /// Of the multipliers and of the accelerations with them.
    pub reactions: &'a mut RowCotangent,
    /// Of the time, through the motions that drives prescribe.
    pub time: &'a mut f64,
    /// Of the model's parameters.
    pub model: &'a mut Model<f64>,
    /// Derivatives in the model's parameters through vibrations.
    pub modes: &'a mut Vec<FrozenMode>,
}

impl SnapshotCotangent<'_> {
    /// Those of positions, velocities and parameters.
    pub(super) fn of_states(&mut self) -> JointCotangent<'_> {
        JointCotangent {
            y: Some(&mut *self.y),
            v: Some(&mut *self.v),
            model: &mut *self.model,
        }
    }
}
