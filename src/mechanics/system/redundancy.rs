//! Redundant constraint rows: they follow from the others in every position near the start. They
//! are found by rank and left out, so that the remaining equations have full rank.
//!
//! A row that is dependent only in the placement indicates a singular position, not a redundancy.
//! So the rank is determined at the closed placement and at a closed position near it, along a
//! motion that the joints allow. The position of the larger rank decides. A pivoted Gram–Schmidt
//! process on the rows of G chooses the rows to keep: the first in the order of the joints whose
//! part across the rows kept so far is not small relative to the largest such part. Rows that are
//! redundant only within the tolerance of the input are left out before ([`super::rounded`]).

use super::bodies::BodyMotion;
use super::constraint;
use super::in_motion::InMotion;
use super::joints;
use super::left_out::Redundancy;
use super::loop_rows::{DependentRow, Row, Rows};
use super::placement::length_scale;
use super::redundant_rows::RedundantRows;
use super::rounded;
use crate::math::Scalar;
use crate::model::{ConstraintRow, Joint, Model};
use nalgebra::DMatrix;

/// A row that was left out is open above this gap relative to the length scale.
const OPENED: f64 = 1e-6;
/// Factor of the tolerance of the input by which rounded rows may be open in other positions and designs:
/// an axis that is off turns against its counterpart.
const IN_MOTION: f64 = 4.0;
/// Relative size of G below which a direction of the multipliers is not in its range.
const DAMPED: f64 = 1e-6;

/// Leaves the redundant rows out of the joints of `model`, and returns these joints. If the joints
/// cannot be closed, none are left out; assembly reports the failure.
pub fn leave_out(model: &mut Model<f64>) -> Vec<Redundancy> {
    for joint in &mut model.joints {
        joint.redundant.clear();
        joint.fit.rounded = false;
    }
    let Some(dependent) = dependent_rows(model) else {
        return Vec::new();
    };
    for &DependentRow { joint, row, misfit } in &dependent {
        let joint = &mut model.joints[joint];
        joint.redundant.push(row);
        joint.fit.rounded |= misfit > 0.0;
    }
    let told = |(j, joint): (usize, &mut Joint<f64>)| {
        let own = dependent.iter().filter(|own| own.joint == j);
        let misfit = own.fold(0.0_f64, |most, own| most.max(own.misfit));
        (!joint.redundant.is_empty()).then(|| Redundancy {
            joint: joint.name.clone(),
            left_out: joint.redundant.len(),
            rows: joint.all_rows().count(),
            misfit: (misfit > 0.0).then_some([misfit, joint.fit.tolerance]),
        })
    };
    model
        .joints
        .iter_mut()
        .enumerate()
        .filter_map(told)
        .collect()
}

/// Number of redundant rows of the model, including those that are left out; `None` if its joints
/// cannot be closed.
pub fn redundant_rows(model: &Model<f64>) -> Option<usize> {
    let mut model = model.clone();
    for joint in &mut model.joints {
        joint.redundant.clear();
    }
    dependent_rows(&model).map(|rows| rows.len())
}

/// Imposed unit rows of G at q as columns, in the order of the joints, and the joint of each.
/// Angles count as arcs at the length scale.
pub fn unit_rows(model: &Model<f64>, q: &[f64]) -> (DMatrix<f64>, Vec<usize>) {
    let joints: Vec<usize> = (0..model.joints.len()).collect();
    let mut rows = Rows::new(model, &joints, length_scale(model));
    let left_out = RedundantRows::of(model, &rows.numbering);
    rows.list.retain(|own| !left_out.contains(own.number));
    let of = rows.list.iter().map(|own| own.joint).collect();
    (rows.gradients(q).transposed(), of)
}

/// The redundant rows of a model, in the order of its joints; `None` if the joints cannot be closed.
fn dependent_rows(model: &Model<f64>) -> Option<Vec<DependentRow>> {
    let joints = in_loops(model);
    if joints.is_empty() {
        return Some(Vec::new());
    }
    let mut rows = Rows::new(model, &joints, length_scale(model));
    let exact = rows.independent();
    let tolerance = (joints.iter()).fold(0.0, |t, &j| model.joints[j].fit.tolerance.max(t));
    let driven = joints.iter().any(|&j| !model.joints[j].drives.is_empty());
    let suspicious = exact
        .as_ref()
        .is_none_or(|found| found.weakest <= tolerance || driven && found.kept.contains(&false));
    let mut out = match suspicious && tolerance > 0.0 {
        true => rounded::rows(model, tolerance),
        false => Vec::new(),
    };
    let found = match out.is_empty() {
        true => exact?,
        false => {
            let is_out = |own: &Row| out.iter().any(|o| (o.joint, o.row) == (own.joint, own.row));
            rows.list.retain(|own| !is_out(own));
            rows.independent()?
        }
    };
    let others = rows
        .list
        .iter()
        .zip(&found.kept)
        .filter(|(_, kept)| !**kept);
    out.extend(others.map(|(own, _)| DependentRow {
        joint: own.joint,
        row: own.row,
        misfit: 0.0,
    }));
    out.sort_by_key(|own| own.joint);
    Some(out)
}

/// Joints in loops of bodies and ground, which couplings close too. Without loops no row is redundant.
pub fn in_loops<S: Scalar>(model: &Model<S>) -> Vec<usize> {
    let ground = model.bodies.len();
    let ends = |j: usize| {
        let joint = &model.joints[j];
        [joint.body_a, joint.body_b.unwrap_or(ground)]
    };
    let mut left: Vec<usize> = (0..model.joints.len()).collect();
    let mut tied = vec![0; ground + 1];
    for body in model.ties().into_iter().flatten() {
        tied[body.unwrap_or(ground)] = 2;
    }
    loop {
        let mut degree = tied.clone();
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

/// The row with the largest gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widest {
    /// Its joint.
    pub joint: usize,
    /// The row.
    pub row: ConstraintRow,
    /// |Φ| \[m or 1\].
    pub gap: f64,
}

/// The row with the largest gap relative to the allowed one, if rows are left out and it is open too far:
/// by more than `allowed`, or than four times the tolerance of the input if rows fit only within it.
pub fn open<S: Scalar>(
    model: &Model<S>,
    at: (&[BodyMotion<S>], S),
    allowed: f64,
) -> Option<Widest> {
    if model.joints.iter().all(|joint| joint.redundant.is_empty()) {
        return None;
    }
    let (length, slack) = (length_scale(model), IN_MOTION * model.slack());
    let mut widest: Option<(f64, Widest)> = None;
    joints::for_each_row(model, at, |joint, row, a, b| {
        let gap = constraint::value(row, a, b).re().abs();
        let part = gap / allowed.max(slack * row.size(length));
        if widest.is_none_or(|(most, _)| part > most || part.is_nan()) {
            widest = Some((part, Widest { joint, row, gap }));
        }
    });
    widest
        .filter(|(part, _)| part.is_nan() || *part > 1.0)
        .map(|(_, widest)| widest)
}

/// The same with the gap allowed in a motion, [`OPENED`] times the model's length scale.
pub fn opened<S: Scalar>(model: &Model<S>, at: (&[BodyMotion<S>], S)) -> Option<Widest> {
    open(model, at, OPENED * length_scale(model))
}

/// The multipliers of all rows, including redundant ones, with the smallest sum of squares and the
/// same effect as `lambda`: the part of `lambda` in the range of G. Redundant rows are dependent
/// only up to the drift of the constraints. So directions in which G is that small are damped,
///
/// ```text
/// min |λ − G y|² + δ² |y|²,     δ = 1e-6 of the largest row, or ten times the tolerance of rounded rows,
/// ```
///
/// by conjugate gradients on the normal equations (Björck 1996, *Numerical Methods for Least
/// Squares Problems*, algorithm 7.4.1 and section 7.4.3), and once more for the remainder of λ. In
/// a direction in which G has the size σ, the relative error is (δ/σ)⁴ inside the range and 2
/// (σ/δ)² outside.
///
/// Rows of a joint are in the order of its kind. The model must have all rows imposed.
pub fn smallest_multipliers(at: &InMotion<f64>, lambda: &[f64]) -> Vec<f64> {
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
    let damping = DAMPED.max(10.0 * model.slack()).powi(2) * squares.fold(0.0, f64::max);
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
