//! Redundant constraint rows: they follow from the others in every position near the start. They
//! are found by rank and left out, so that the remaining equations have full rank.
//!
//! A row that is dependent only in the placement indicates a singular position, not a redundancy.
//! So the rank is determined at the closed placement and at a closed position near it, along a
//! motion that the joints allow. The position of the larger rank decides. A pivoted Gram–Schmidt
//! process on the rows of G chooses the rows to keep: the first in the order of the joints whose
//! part across the rows kept so far is not small relative to the largest such part.

use super::attachment;
use super::bodies::{self, BodyMotion};
use super::constraint;
use super::in_motion::InMotion;
use super::joints;
use super::numbering::Numbering;
use super::placement::{guess, length_scale};
use super::reduce;
use super::redundant_rows::RedundantRows;
use crate::math::{Scalar, Vec3};
use crate::model::{ConstraintRow, Model};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A unit row is dependent if its part across the others is smaller.
const DEPENDENT: f64 = 1e-11;
/// An earlier row is preferred if its part is at least this fraction of the largest.
const PREFERRED: f64 = 0.1;
/// Joints are closed up to this gap relative to the length scale.
const CLOSED: f64 = 1e-12;
/// Weight that keeps the equations of a closing step regular, relative to unit rows.
const REGULAR: f64 = 1e-10;
/// A row that was left out is open above this gap relative to the length scale.
pub(crate) const OPENED: f64 = 1e-6;
/// Relative size of G below which a direction of the multipliers is not in its range.
const DAMPED: f64 = 1e-6;
/// Largest number of closing steps.
const ITERATIONS: usize = 50;
/// Distances from the placement that are tried for the nearby position, in units of the length
/// scale and in radians.
pub(super) const BESIDE: [f64; 3] = [0.03, -0.02, 0.005];

/// A joint with redundant rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Redundancy {
    /// The joint.
    pub joint: String,
    /// Number of its rows that are left out.
    pub left_out: usize,
    /// Number of its rows.
    pub rows: usize,
}

impl std::fmt::Display for Redundancy {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "joint \"{}\": {} of {} rows follow from the others to 1e-11 and are left out; its reactions \
             are not unique",
            self.joint, self.left_out, self.rows
        )
    }
}

/// Leaves the redundant rows out of the joints of `model`, and returns these joints. If the joints
/// cannot be closed, none are left out; assembly reports the failure.
pub(crate) fn leave_out(model: &mut Model<f64>) -> Vec<Redundancy> {
    for joint in &mut model.joints {
        joint.redundant.clear();
    }
    let joints = in_loops(model);
    if joints.is_empty() {
        return Vec::new();
    }
    let Some(kept) = independent_rows(model, &joints) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut kept = kept.into_iter();
    for &j in &joints {
        let joint = &mut model.joints[j];
        let rows: Vec<ConstraintRow> = joint.rows().collect();
        let out = rows.iter().zip(&mut kept).filter(|(_, kept)| !kept);
        joint.redundant = out.map(|(row, _)| *row).collect();
        let rows = joint.all_rows().count();
        if !joint.redundant.is_empty() {
            found.push(Redundancy {
                joint: joint.name.clone(),
                left_out: joint.redundant.len(),
                rows,
            });
        }
    }
    found
}

/// Number of redundant rows of the model, including those that are left out; `None` if its joints
/// cannot be closed.
pub(crate) fn redundant_rows(model: &Model<f64>) -> Option<usize> {
    let mut model = model.clone();
    for joint in &mut model.joints {
        joint.redundant.clear();
    }
    let kept = independent_rows(&model, &in_loops(&model))?;
    Some(kept.into_iter().filter(|kept| !kept).count())
}

/// Imposed unit rows of G at q as columns, in the order of the joints, and the joint of each.
/// Angles count as arcs at the length scale.
pub(crate) fn unit_rows(model: &Model<f64>, q: &[f64]) -> (DMatrix<f64>, Vec<usize>) {
    let joints: Vec<usize> = (0..model.joints.len()).collect();
    let rows = Rows::new(model, &joints);
    let left_out = RedundantRows::of(model, &rows.numbering);
    let imposed: Vec<usize> = rows.numbers().filter(|&i| !left_out.contains(i)).collect();
    let of = imposed.iter().map(|&i| rows.numbering.joint_of_row(i));
    let of = of.collect();
    (rows.gradients(q).0.select_columns(&imposed), of)
}

/// Joints in loops of bodies and ground. Without loops no row is redundant.
pub(crate) fn in_loops<S>(model: &Model<S>) -> Vec<usize> {
    let ground = model.bodies.len();
    let ends = |j: usize| {
        let joint = &model.joints[j];
        [joint.body_a, joint.body_b.unwrap_or(ground)]
    };
    let mut left: Vec<usize> = (0..model.joints.len()).collect();
    loop {
        let mut degree = vec![0; ground + 1];
        for body in left.iter().flat_map(|&j| ends(j)) {
            degree[body] += 1;
        }
        let before = left.len();
        left.retain(|&j| ends(j).into_iter().all(|body| degree[body] > 1));
        if left.len() == before {
            return left;
        }
    }
}

/// Which rows of the `joints` to keep, in their order; `None` if the joints cannot be closed.
fn independent_rows(model: &Model<f64>, joints: &[usize]) -> Option<Vec<bool>> {
    let rows = Rows::new(model, joints);
    let (q, _) = guess(model);
    let placed = rows.close(q)?;
    let there = rows.independent(&placed);
    let count = |kept: &[bool]| kept.iter().filter(|kept| **kept).count();
    if count(&there) == there.len() {
        return Some(there);
    }
    // Joints that allow no motion have no nearby position.
    let beside = BESIDE
        .iter()
        .find_map(|&distance| rows.beside(&placed, distance));
    let beside = beside.map(|q| rows.independent(&q));
    Some(match beside {
        Some(beside) if count(&beside) > count(&there) => beside,
        _ => there,
    })
}

/// The rows of some joints of a model.
pub(super) struct Rows<'a> {
    model: &'a Model<f64>,
    pub(super) numbering: Numbering,
    joints: &'a [usize],
    length: f64,
    /// Time of the drives \[s\].
    pub(super) time: f64,
}

impl<'a> Rows<'a> {
    pub(super) fn new(model: &'a Model<f64>, joints: &'a [usize]) -> Self {
        Self {
            model,
            numbering: Numbering::new(model),
            joints,
            length: length_scale(model),
            time: 0.0,
        }
    }

    fn motions(&self, q: &[f64]) -> Vec<BodyMotion<f64>> {
        let at_rest = vec![0.0; self.numbering.velocities()];
        let mut motions = Vec::new();
        BodyMotion::all(&self.numbering, q, &at_rest, &mut motions);
        motions
    }

    fn at<'b>(&'b self, motions: &'b [BodyMotion<f64>]) -> InMotion<'b, f64> {
        InMotion::new(self.model, &self.numbering, motions, self.time)
    }

    /// Constraint rows by number, in the order of the joints.
    pub(super) fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.joints.iter().flat_map(|&j| self.numbering.rows(j))
    }

    /// Unit rows of G as columns, with angles as arcs at the length scale, and the factors that
    /// normalise them.
    pub(super) fn gradients(&self, q: &[f64]) -> (DMatrix<f64>, Vec<f64>) {
        let motions = self.motions(q);
        let mut all = Vec::new();
        joints::gradients(&self.at(&motions), &mut all);
        let count = self.numbers().count();
        let mut g = DMatrix::zeros(self.numbering.velocities(), count);
        let mut i = 0;
        for &j in self.joints {
            let joint = &self.model.joints[j];
            for number in self.numbering.rows(j) {
                let row = &all[number];
                let a = self.numbering.velocity(joint.body_a);
                let mut put = |at: usize, values: &Vec3<f64>, scale: f64| {
                    for k in 0..3 {
                        g[(at + k, i)] += values[k] * scale;
                    }
                };
                put(a, &row.force, 1.0);
                put(a + 3, &row.torque_a, 1.0 / self.length);
                if let Some(b) = joint.body_b.map(|b| self.numbering.velocity(b)) {
                    put(b, &row.force, -1.0);
                    put(b + 3, &row.torque_b, 1.0 / self.length);
                }
                if let Some(modes) = &joint.modes {
                    let local = row.local();
                    for (slot, x) in attachment::elastic_gradient(modes, &self.numbering, local) {
                        g[(slot, i)] += x;
                    }
                }
                i += 1;
            }
        }
        for mut row in g.column_iter_mut() {
            reduce::project(&self.numbering, row.as_mut_slice());
        }
        let scales: Vec<f64> = g.column_iter().map(|row| 1.0 / row.norm()).collect();
        for (mut row, scale) in g.column_iter_mut().zip(&scales) {
            row *= *scale;
        }
        (g, scales)
    }

    /// The closed position that Newton's method reaches from `q` by small steps.
    pub(super) fn close(&self, mut q: Vec<f64>) -> Option<Vec<f64>> {
        let mut increment = vec![0.0; q.len()];
        bodies::normalise(&self.numbering, &mut q, &mut increment);
        let mut values = vec![0.0; self.numbering.constraints()];
        let mut closed_before = false;
        for _ in 0..ITERATIONS {
            let motions = self.motions(&q);
            joints::values(&self.at(&motions), &mut values);
            let gap = self.numbers().fold(0.0_f64, |m, i| m.max(values[i].abs()));
            let closed = gap <= CLOSED * self.length.max(1.0);
            if closed && closed_before {
                return Some(q);
            }
            closed_before = closed;
            let (g, scales) = self.gradients(&q);
            let open = self
                .numbers()
                .zip(&scales)
                .map(|(i, scale)| -values[i] * scale);
            let open = DVector::from_iterator(scales.len(), open);
            let step = &g * normal(&g)?.solve(&open);
            self.advance(&mut q, &step);
        }
        None
    }

    /// Adds a step to q; its angles are arcs at the length scale.
    fn advance(&self, q: &mut [f64], step: &DVector<f64>) {
        let arcs = step.iter().enumerate();
        let step: Vec<f64> = arcs
            .map(|(i, x)| if i % 6 < 3 { *x } else { x / self.length })
            .collect();
        let mut increment = vec![0.0; q.len()];
        bodies::advance(&self.numbering, q, &mut increment, &step);
    }

    /// A closed position at the given distance from `q`, along a motion that the joints allow;
    /// `None` if they allow none.
    pub(super) fn beside(&self, q: &[f64], distance: f64) -> Option<Vec<f64>> {
        let (g, _) = self.gradients(q);
        // A direction without symmetry.
        let count = self.numbering.velocities();
        let mut along = DVector::from_fn(count, |i, _| (1.0 + 1.7 * i as f64).sin());
        reduce::project(&self.numbering, along.as_mut_slice());
        let factors = normal(&g)?;
        // Twice, because the regularising weight leaves a small part.
        for _ in 0..2 {
            along -= &g * factors.solve(&g.tr_mul(&along));
        }
        let size = along.amax();
        if size < 1e-6 {
            return None;
        }
        let mut moved = q.to_vec();
        self.advance(&mut moved, &(along * (distance * self.length / size)));
        self.close(moved)
    }

    /// Which rows to keep at q, so that they are independent and the others follow.
    pub(super) fn independent(&self, q: &[f64]) -> Vec<bool> {
        let (mut g, _) = self.gradients(q);
        let mut kept = vec![false; g.ncols()];
        loop {
            let sizes: Vec<f64> = g.column_iter().map(|row| row.norm()).collect();
            let free = |i: &usize| !kept[*i];
            let largest = (0..sizes.len())
                .filter(free)
                .map(|i| sizes[i])
                .fold(0.0, f64::max);
            if largest <= DEPENDENT {
                return kept;
            }
            let first = (0..sizes.len())
                .filter(free)
                .find(|&i| sizes[i] >= PREFERRED * largest);
            let Some(first) = first else { return kept };
            kept[first] = true;
            let pivot = g.column(first) / sizes[first];
            for (i, mut row) in g.column_iter_mut().enumerate() {
                if !kept[i] {
                    row.axpy(-row.dot(&pivot), &pivot, 1.0);
                }
            }
        }
    }
}

/// Factors of G Gᵀ, regularised where rows are dependent; `g` is the transpose of G.
fn normal(g: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let mut product = g.transpose() * g;
    for i in 0..product.nrows() {
        product[(i, i)] += REGULAR;
    }
    product.cholesky()
}

/// The row with the largest gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Widest {
    /// Its joint.
    pub joint: usize,
    /// The row.
    pub row: ConstraintRow,
    /// |Φ| \[m or 1\].
    pub gap: f64,
}

/// The row with the largest gap; `None` if no row is left out.
pub(crate) fn widest<S: Scalar>(model: &Model<S>, at: (&[BodyMotion<S>], S)) -> Option<Widest> {
    if model.joints.iter().all(|joint| joint.redundant.is_empty()) {
        return None;
    }
    let mut widest: Option<Widest> = None;
    joints::for_each_row(model, at, |joint, row, a, b| {
        let gap = constraint::value(row, a, b).re().abs();
        if widest.is_none_or(|most| gap > most.gap || gap.is_nan()) {
            widest = Some(Widest { joint, row, gap });
        }
    });
    widest
}

/// The row with the largest gap, if it is above [`OPENED`] times the model's length scale.
pub(crate) fn opened<S: Scalar>(model: &Model<S>, at: (&[BodyMotion<S>], S)) -> Option<Widest> {
    widest(model, at).filter(|widest| {
        let limit = OPENED * length_scale(model);
        widest.gap.is_nan() || widest.gap > limit
    })
}

/// The multipliers of all rows, including redundant ones, with the smallest sum of squares and the
/// same effect as `lambda`: the part of `lambda` in the range of G. Redundant rows are dependent
/// only up to the drift of the constraints. So directions in which G is that small are damped,
///
/// ```text
/// min |λ − G y|² + δ² |y|²,     δ = 1e-6 of the largest row,
/// ```
///
/// by conjugate gradients on the normal equations (Björck 1996, *Numerical Methods for Least
/// Squares Problems*, algorithm 7.4.1 and section 7.4.3), and once more for the remainder of λ. In
/// a direction in which G has the size σ, the relative error is (δ/σ)⁴ inside the range and 2
/// (σ/δ)² outside.
///
/// Rows of a joint are in the order of its kind. The model must have all rows imposed.
pub(crate) fn smallest_multipliers(at: &InMotion<f64>, lambda: &[f64]) -> Vec<f64> {
    let (model, numbering) = (at.model, at.numbering);
    let mut gradients = Vec::new();
    joints::gradients(at, &mut gradients);
    let transposed = |x: &[f64]| {
        let mut out = vec![0.0; numbering.velocities()];
        joints::add_reactions(model, numbering, &gradients, x, &mut out);
        out
    };
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let squares = gradients.iter().map(|row| {
        2.0 * row.force.norm_squared() + row.torque_a.norm_squared() + row.torque_b.norm_squared()
    });
    let damping = DAMPED.powi(2) * squares.fold(0.0, f64::max);
    let mut rest = lambda.to_vec();
    let mut image = vec![0.0; lambda.len()];
    let enough = square(&transposed(&rest)) * 1e-28;
    for _ in 0..2 {
        let mut y = vec![0.0; numbering.velocities()];
        let mut slope = transposed(&rest);
        let mut along = slope.clone();
        let mut size = square(&slope);
        for _ in 0..4 * lambda.len() {
            if size <= enough {
                break;
            }
            joints::rates_from_gradients(model, numbering, &gradients, &along, &mut image);
            let step = size / (square(&image) + damping * square(&along));
            for (y, along) in y.iter_mut().zip(&along) {
                *y += step * along;
            }
            for (rest, image) in rest.iter_mut().zip(&image) {
                *rest -= step * image;
            }
            slope = transposed(&rest);
            for (slope, y) in slope.iter_mut().zip(&y) {
                *slope -= damping * y;
            }
            let next = square(&slope);
            for (along, slope) in along.iter_mut().zip(&slope) {
                *along = slope + next / size * *along;
            }
            size = next;
        }
    }
    lambda
        .iter()
        .zip(&rest)
        .map(|(all, rest)| all - rest)
        .collect()
}
