//! Which constraint rows are not imposed, as they follow from those that are, chosen again on the way.
//!
//! The matrix of every system has all rows. One that is left out stands there as λ_i = 0. What follows
//! from what changes with the position: with a row left out whose weight in the dependence passes
//! through zero the rows that are imposed depend on each other. So a row is exchanged for one of
//! larger weight before that. The motion does not depend on the choice where all joints are closed.

use super::bodies::add6;
use super::constraint::RowGradient;
use super::in_motion::InMotion;
use super::joints;
use super::numbering::Numbering;
use super::placement::length_scale;
use crate::math::Scalar;
use crate::model::Model;

/// Weight of an imposed row, relative to that of a row that is left out, at which the two are
/// exchanged between steps.
pub(crate) const EXCHANGE_WEIGHT: f64 = 2.0;

/// What the weights of rows are found in, used again.
#[derive(Clone, Debug)]
pub(crate) struct RowWeights<S> {
    gradients: Vec<RowGradient<S>>,
    sizes: Vec<f64>,
    rhs: Vec<S>,
}

impl<S> Default for RowWeights<S> {
    fn default() -> Self {
        Self {
            gradients: Vec::new(),
            sizes: Vec::new(),
            rhs: Vec::new(),
        }
    }
}

/// Rows that are not imposed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct RedundantRows {
    /// One entry a row; none if all are imposed.
    rows: Vec<bool>,
}

impl RedundantRows {
    /// Those that the joints of a model name.
    pub(crate) fn of<S>(model: &Model<S>, numbering: &Numbering) -> Self {
        if model.joints.iter().all(|joint| joint.redundant.is_empty()) {
            return Self::default();
        }
        let mut rows = vec![false; numbering.constraints()];
        for (j, joint) in model.joints.iter().enumerate() {
            for (i, row) in numbering.rows(j).zip(joint.rows()) {
                rows[i] = joint.redundant.contains(&row);
            }
        }
        // What holds identically is no row.
        match rows.contains(&true) {
            true => Self { rows },
            false => Self::default(),
        }
    }

    /// Those with these numbers among `count` rows; `None` if there are not as many rows.
    pub(crate) fn from_rows(numbers: &[usize], count: usize) -> Option<Self> {
        let mut rows = vec![false; count];
        for &i in numbers {
            *rows.get_mut(i)? = true;
        }
        Some(Self { rows })
    }

    /// Number of rows, imposed or not; 0 if all are imposed in every choice.
    pub(crate) fn count(&self) -> usize {
        self.rows.len()
    }

    /// Whether this is another choice of as many rows of as many.
    pub(crate) fn fits(&self, other: &Self) -> bool {
        self.count() == other.count() && self.numbers().count() == other.numbers().count()
    }

    /// Whether all rows are imposed in every choice.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether row i is left out.
    pub(crate) fn contains(&self, row: usize) -> bool {
        self.rows.get(row) == Some(&true)
    }

    /// Their numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.filter(|(_, out)| **out).map(|(i, _)| i)
    }

    /// Sets the entries of rows that are left out to zero.
    pub(crate) fn clear<T: Scalar>(&self, values: &mut [T]) {
        for i in self.numbers() {
            values[i] = T::zero();
        }
    }

    /// Sets their gradients to zero.
    pub(crate) fn clear_gradients<S: Scalar>(&self, gradients: &mut [RowGradient<S>]) {
        for i in self.numbers() {
            let row = &mut gradients[i];
            row.force.fill(S::zero());
            row.torque_a.fill(S::zero());
            row.torque_b.fill(S::zero());
        }
    }

    /// The choice with the first row that is left out exchanged for an imposed one whose weight in its
    /// dependence is more than `worn` times its own; `None` if there is none. The weights are −λ of
    ///
    /// ```text
    /// M x + Gᵀλ = −g_i,      G x = 0
    /// ```
    ///
    /// with the gradient g_i of the row that is left out, and x = 0 as it follows from the others.
    /// `solve` solves that system in place where the bodies are.
    pub(crate) fn exchanged<S: Scalar>(
        &self,
        at: &InMotion<S>,
        worn: f64,
        weighing: &mut RowWeights<S>,
        mut solve: impl FnMut(&mut [S]),
    ) -> Option<Self> {
        if !self.rows.contains(&true) {
            return None;
        }
        let RowWeights {
            gradients,
            sizes,
            rhs,
        } = weighing;
        let (model, numbering) = (at.model, at.numbering);
        joints::gradients(at, gradients);
        let arm = 1.0 / length_scale(model);
        let size = |row: &RowGradient<S>| {
            let square = |x: &crate::math::Vec3<S>| x.iter().map(|x| x.re().powi(2)).sum::<f64>();
            let torques = square(&row.torque_a) + square(&row.torque_b);
            (2.0 * square(&row.force) + arm * arm * torques).sqrt()
        };
        sizes.clear();
        sizes.extend(gradients.iter().map(size));
        let nv = numbering.velocities();
        rhs.resize(nv + self.rows.len(), S::zero());
        for i in self.numbers() {
            rhs.fill(S::zero());
            let joint = &model.joints[numbering.joint_of_row(i)];
            let g = &gradients[i];
            let a = numbering.velocity(joint.body_a);
            add6(&mut rhs[a..], &-g.force, &-g.torque_a);
            if let Some(body) = joint.body_b {
                add6(&mut rhs[numbering.velocity(body)..], &g.force, &-g.torque_b);
            }
            solve(rhs);
            let weights = rhs[nv..].iter().zip(&*sizes).enumerate();
            let heaviest = weights
                .filter(|(k, _)| !self.rows[*k])
                .map(|(k, (lambda, size))| (k, lambda.re().abs() * size))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((k, weight)) = heaviest
                && weight > worn * sizes[i]
            {
                let mut rows = self.rows.clone();
                (rows[i], rows[k]) = (false, true);
                return Some(Self { rows });
            }
        }
        None
    }
}
