//! The choice of redundant rows, which may change during a run.
//!
//! The matrix of every system has all rows. A redundant row is replaced by λ_i = 0. Dependence
//! changes with the position: if the weight of a redundant row in the dependence becomes zero, the
//! imposed rows become dependent. Before that, it is exchanged for a row of larger weight. The
//! choice does not affect the motion as long as all joints are closed.

use super::attachment;
use super::bodies::add6;
use super::constraint::RowGradient;
use super::in_motion::InMotion;
use super::joints;
use super::numbering::Numbering;
use super::placement::length_scale;
use crate::math::Scalar;
use crate::model::Model;

/// A redundant row is exchanged between steps for an imposed row whose weight is larger by this
/// factor.
pub const EXCHANGE_WEIGHT: f64 = 2.0;

/// Workspace for the weights of rows.
#[derive(Clone, Debug)]
pub struct RowWeights<S> {
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

/// Sets `rhs` to the solution of that system for row i with this gradient.
fn weigh<S: Scalar>(
    at: &InMotion<S>,
    (i, g): (usize, &RowGradient<S>),
    rhs: &mut [S],
    mut solve: impl FnMut(&mut [S]),
) {
    let numbering = at.numbering;
    let joint = &at.model.joints[numbering.joint_of_row(i)];
    rhs.fill(S::zero());
    let a = numbering.velocity(joint.body_a);
    add6(&mut rhs[a..], &-g.force, &-g.torque_a);
    if let Some(body) = joint.body_b {
        add6(&mut rhs[numbering.velocity(body)..], &g.force, &-g.torque_b);
    }
    if let Some(modes) = &joint.modes {
        for (slot, x) in attachment::elastic_gradient(modes, numbering, g.local()) {
            rhs[slot] -= x;
        }
    }
    solve(rhs);
}

/// Redundant rows, which are not imposed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RedundantRows {
    /// By row: whether it is redundant; empty if all are imposed.
    rows: Vec<bool>,
}

impl RedundantRows {
    /// The redundant rows of the joints of a model.
    pub fn of<S>(model: &Model<S>, numbering: &Numbering) -> Self {
        if model.joints.iter().all(|joint| joint.redundant.is_empty()) {
            return Self::default();
        }
        let mut rows = vec![false; numbering.constraints()];
        for (j, joint) in model.joints.iter().enumerate() {
            for (i, row) in numbering.rows(j).zip(joint.rows()) {
                rows[i] = joint.redundant.contains(&row);
            }
        }
        // Trivially satisfied rows are not in the matrix.
        match rows.contains(&true) {
            true => Self { rows },
            false => Self::default(),
        }
    }

    /// The redundant rows with these numbers, of `count` rows; `None` if a number is too large.
    pub fn from_rows(numbers: &[usize], count: usize) -> Option<Self> {
        let mut rows = vec![false; count];
        for &i in numbers {
            *rows.get_mut(i)? = true;
        }
        Some(Self { rows })
    }

    /// Number of all rows; 0 if no row is redundant.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Whether both have equal numbers of rows and of redundant rows.
    pub fn fits(&self, other: &Self) -> bool {
        self.count() == other.count() && self.numbers().count() == other.numbers().count()
    }

    /// Whether no row is redundant.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether row i is redundant.
    pub fn contains(&self, row: usize) -> bool {
        self.rows.get(row) == Some(&true)
    }

    /// Numbers of the redundant rows.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.filter(|(_, out)| **out).map(|(i, _)| i)
    }

    /// Sets the entries of redundant rows to zero.
    pub fn clear<T: Scalar>(&self, values: &mut [T]) {
        for i in self.numbers() {
            values[i] = T::zero();
        }
    }

    /// Sets the gradients of redundant rows to zero.
    pub fn clear_gradients<S: Scalar>(&self, gradients: &mut [RowGradient<S>]) {
        for i in self.numbers() {
            gradients[i] = RowGradient::zero();
        }
    }

    /// Multipliers of all rows that together move no body, one list for each redundant row. The
    /// motion does not determine them. `solve` is as in [`RedundantRows::exchanged`].
    pub fn undetermined<S: Scalar>(
        &self,
        at: &InMotion<S>,
        mut solve: impl FnMut(&mut [S]),
    ) -> Vec<Vec<f64>> {
        let mut gradients = Vec::new();
        joints::gradients(at, &mut gradients);
        let nv = at.numbering.velocities();
        let mut rhs = vec![S::zero(); nv + self.rows.len()];
        let mut of = |i: usize| {
            weigh(at, (i, &gradients[i]), &mut rhs, &mut solve);
            let mut all: Vec<f64> = rhs[nv..].iter().map(|x| x.re()).collect();
            all[i] = 1.0;
            all
        };
        self.numbers().map(&mut of).collect()
    }

    /// The choice after exchanging the first redundant row for an imposed row whose weight in its
    /// dependence is more than `worn` times its own; `None` if there is none. The weights are −λ of
    ///
    /// ```text
    /// M x + Gᵀλ = −g_i,      G x = 0
    /// ```
    ///
    /// with the gradient g_i of the redundant row. x = 0, because the row depends on the others.
    /// `solve` solves that system in place at the present positions.
    pub fn exchanged<S: Scalar>(
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
            weigh(at, (i, &gradients[i]), rhs, &mut solve);
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
