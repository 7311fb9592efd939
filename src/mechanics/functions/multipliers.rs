//! Multipliers of the rows of a joint, or of all joints, and accelerations at the instants of a run, and their derivatives.
//! They are those of the index-1 equations of the states, for every method:
//!
//! ```text
//! M v̇ + Gᵀ λ = f(q, v, t),     G v̇ = γ(q, v, t)
//! ```

use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;
use crate::system::redundant_rows::{EXCHANGE_WEIGHT, RedundantRows};
use std::ops::Range;

/// The joints whose reactions a quantity needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reacting {
    /// One joint.
    Joint(usize),
    /// All joints.
    All,
}

/// Multipliers of the rows of joints, with the accelerations.
pub struct Reactions<'a, S> {
    field: Accelerations<'a, S>,
    rows: Range<usize>,
    a: Vec<S>,
    lambda: Vec<S>,
    undetermined: Vec<Vec<f64>>,
}

/// Multipliers of the rows of joints at an instant.
#[derive(Clone, Copy)]
pub struct Rows<'a, S> {
    /// λ; empty if none are requested.
    pub lambda: &'a [S],
    /// Accelerations of the same equations, in velocity numbering; empty if no multipliers are requested.
    pub accelerations: &'a [S],
    /// Rows that follow from others; `None` if no multipliers are requested.
    pub left_out: Option<&'a RedundantRows>,
    /// Changes of the multipliers that move no body.
    pub undetermined: &'a [Vec<f64>],
}

impl<S> Rows<'_, S> {
    /// Those of no joint.
    pub fn none() -> Self {
        Self {
            lambda: &[],
            accelerations: &[],
            left_out: None,
            undetermined: &[],
        }
    }
}

/// Cotangents of multipliers and accelerations at an instant.
#[derive(Clone, Debug, Default)]
pub struct RowCotangent {
    /// Of the multipliers.
    pub lambda: Vec<f64>,
    /// Of the accelerations, in velocity numbering.
    pub accelerations: Vec<f64>,
}

impl<'a, S: SolveScalar> Reactions<'a, S> {
    /// The solver for joints of `model`, which has this numbering.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering, of: Reacting) -> Self {
        Self {
            field: Accelerations::new(model, numbering),
            rows: match of {
                Reacting::Joint(joint) => numbering.rows(joint),
                Reacting::All => 0..numbering.constraints(),
            },
            a: vec![S::zero(); numbering.velocities()],
            lambda: vec![S::zero(); numbering.constraints()],
            undetermined: Vec::new(),
        }
    }

    /// Those at instant `k`; NaN if the equations are singular. The run has the bodies of the model.
    pub fn at(&mut self, run: &Trajectory<S>, k: usize) -> Rows<'_, S> {
        let (q, v, time) = (run.q(k), run.v(k), run.time(k));
        self.field.set_state(q, v, time);
        // Each redundant row is exchanged at most once.
        for _ in 0..=self.lambda.len() {
            if self.field.factorise().is_err() {
                self.lambda.fill(S::from(f64::NAN));
                return self.found();
            }
            let Some(rows) = self.field.exchanged(EXCHANGE_WEIGHT) else {
                break;
            };
            self.field.leave_out(&rows);
            self.field.set_state(q, v, time);
        }
        self.undetermined = self.field.undetermined();
        let rows = self.rows.clone();
        for own in &mut self.undetermined {
            *own = own[rows.clone()].to_vec();
        }
        self.field.accelerations(&mut self.a, &mut self.lambda);
        self.found()
    }

    fn found(&self) -> Rows<'_, S> {
        Rows {
            lambda: &self.lambda[self.rows.clone()],
            accelerations: &self.a,
            left_out: Some(self.field.left_out()),
            undetermined: &self.undetermined,
        }
    }

    /// Cotangents that are zero.
    pub fn zero_cotangent(&self) -> RowCotangent {
        RowCotangent {
            lambda: vec![0.0; self.rows.len()],
            accelerations: vec![0.0; self.a.len()],
        }
    }

    /// Number of factorisations so far.
    pub fn factorisations(&self) -> usize {
        self.field.factorisations
    }
}

impl Reactions<'_, f64> {
    /// Pulls cotangents of the multipliers and accelerations at the latest instant back to tangent positions, velocities
    /// and parameters. Returns the derivative in time.
    pub fn pull_back(
        &mut self,
        by: &RowCotangent,
        state: (&mut [f64], &mut [f64]),
        cot: &mut Model<f64>,
    ) -> f64 {
        let mut by_lambda = vec![0.0; self.lambda.len()];
        by_lambda[self.rows.clone()].copy_from_slice(&by.lambda);
        let found = (&self.a[..], &self.lambda[..]);
        let both = (&by.accelerations[..], &by_lambda[..]);
        self.field.pull_back_both(found, both, state, cot)
    }
}
