//! Rows of joints in loops: their closed positions, and which of them are independent there.

use super::attachment;
use super::bodies::{self, BodyMotion};
use super::in_motion::InMotion;
use super::joints;
use super::numbering::Numbering;
use super::placement::guess;
use super::reduce;
use super::unit_rows::UnitRows;
use crate::math::Vec3;
use crate::model::{ConstraintRow, Model};
use nalgebra::DVector;

/// Joints are closed up to this gap relative to the length scale.
const CLOSED: f64 = 1e-12;
/// Largest number of closing steps.
const ITERATIONS: usize = 50;
/// Distances from the placement that are tried for the nearby position, in units of the length
/// scale and in radians.
const BESIDE: [f64; 3] = [0.03, -0.02, 0.005];

/// A row of a joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Its number among the constraints.
    pub number: usize,
    pub joint: usize,
    pub row: ConstraintRow,
}

/// A redundant row.
#[derive(Clone, Copy, Debug)]
pub(super) struct DependentRow {
    /// Its joint.
    pub joint: usize,
    /// The row.
    pub row: ConstraintRow,
    /// How far it misses, relative to the size of its loop or as an angle \[rad\], if it fits only within
    /// the tolerance of the input; otherwise zero.
    pub misfit: f64,
}

/// Which rows to keep.
pub(super) struct Independent {
    pub kept: Vec<bool>,
    /// The smallest part of a kept row across the others.
    pub weakest: f64,
}

/// Some rows of a model.
#[derive(Clone)]
pub(super) struct Rows<'a> {
    model: &'a Model<f64>,
    pub numbering: Numbering,
    pub list: Vec<Row>,
    /// Length of arcs and gaps \[m\].
    pub length: f64,
    /// Time of the drives \[s\].
    pub time: f64,
}

impl<'a> Rows<'a> {
    /// The rows of these joints, in the order of the joints.
    pub(super) fn new(model: &'a Model<f64>, joints: &[usize], length: f64) -> Self {
        let numbering = Numbering::new(model);
        let of = |&joint: &usize| {
            let rows = numbering.rows(joint).zip(model.joints[joint].rows());
            rows.map(move |(number, row)| Row { number, joint, row })
        };
        let list = joints.iter().flat_map(of).collect();
        Self {
            model,
            numbering,
            list,
            length,
            time: 0.0,
        }
    }

    /// The rows to keep, so that they are independent and the others follow; `None` if the joints cannot
    /// be closed.
    pub(super) fn independent(&self) -> Option<Independent> {
        let (q, _) = guess(self.model);
        let placed = self.close(q, None)?;
        let there = self.order(&placed);
        let mut best = there;
        if best.len() < self.list.len() {
            // Joints that allow no motion have no nearby position.
            let beside = self.nearby(&placed).map(|q| self.order(&q));
            if let Some(beside) = beside.filter(|beside| beside.len() > best.len()) {
                best = beside;
            }
        }
        let mut kept = vec![false; self.list.len()];
        best.iter().for_each(|&(row, _)| kept[row] = true);
        let weakest = best
            .iter()
            .fold(f64::INFINITY, |least, own| least.min(own.1));
        Some(Independent { kept, weakest })
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

    /// Unit rows of G, with angles as arcs at the length scale.
    pub(super) fn gradients(&self, q: &[f64]) -> UnitRows {
        let motions = self.motions(q);
        let mut all = Vec::new();
        joints::gradients(&self.at(&motions), &mut all);
        let numbering = &self.numbering;
        let columns = numbering.velocities();
        let mut dense = vec![0.0; columns];
        let one = |own: &Row| {
            let joint = &self.model.joints[own.joint];
            let row = &all[own.number];
            let mut places = Vec::new();
            let mut put = |at: usize, values: &Vec3<f64>, scale: f64| {
                for k in 0..3 {
                    dense[at + k] += values[k] * scale;
                }
                places.extend(at..at + 3);
            };
            let a = numbering.velocity(joint.body_a);
            put(a, &row.force, 1.0);
            put(a + 3, &row.torque_a, 1.0 / self.length);
            if let Some(b) = joint.body_b.map(|b| numbering.velocity(b)) {
                put(b, &row.force, -1.0);
                put(b + 3, &row.torque_b, 1.0 / self.length);
            }
            if let Some(modes) = &joint.modes {
                for (slot, x) in attachment::elastic_gradient(modes, numbering, row.local()) {
                    dense[slot] += x;
                    places.push(slot);
                }
            }
            reduce::project(numbering, &mut dense);
            places.sort_unstable();
            places.dedup();
            let entries = places.iter().map(|&k| (k, dense[k])).collect();
            places.iter().for_each(|&k| dense[k] = 0.0);
            entries
        };
        UnitRows::new(self.list.iter().map(one).collect(), columns)
    }

    /// The values of the rows at q.
    fn values(&self, q: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.numbering.constraints()];
        let motions = self.motions(q);
        joints::values(&self.at(&motions), &mut values);
        self.list.iter().map(|own| values[own.number]).collect()
    }

    /// How far the rows are open at q, relative to the length or as angles \[rad\].
    pub(super) fn misfits(&self, q: &[f64]) -> Vec<f64> {
        let relative = |(x, own): (f64, &Row)| x.abs() / own.row.size(self.length);
        let values = self.values(q).into_iter();
        values.zip(&self.list).map(relative).collect()
    }

    /// The position that Newton's method reaches from `q` by small steps and in which the rows are closed,
    /// to the last digits or, if given, up to a gap relative to the length.
    pub(super) fn close(&self, mut q: Vec<f64>, within: Option<f64>) -> Option<Vec<f64>> {
        let mut increment = vec![0.0; q.len()];
        bodies::normalise(&self.numbering, &mut q, &mut increment);
        let largest = |all: &[f64]| all.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut closed_before = false;
        for _ in 0..ITERATIONS {
            let values = self.values(&q);
            let closed = match within {
                None => largest(&values) <= CLOSED * self.length.max(1.0),
                Some(gap) => largest(&self.misfits(&q)) <= gap,
            };
            if closed && (closed_before || within.is_some()) {
                return Some(q);
            }
            closed_before = closed;
            let g = self.gradients(&q);
            let open = values.iter().zip(&g.scales);
            let open: Vec<f64> = open.map(|(x, scale)| -x * scale).collect();
            let step = g.combined(&g.normal()?.solve(&open));
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

    /// A closed position at one of the distances beside `q`.
    pub(super) fn nearby(&self, q: &[f64]) -> Option<Vec<f64>> {
        BESIDE.iter().find_map(|&distance| self.beside(q, distance))
    }

    /// A closed position at the given distance from `q`, along a motion that the joints allow;
    /// `None` if they allow none.
    fn beside(&self, q: &[f64], distance: f64) -> Option<Vec<f64>> {
        let g = self.gradients(q);
        // A direction without symmetry.
        let count = self.numbering.velocities();
        let mut along = DVector::from_fn(count, |i, _| (1.0 + 1.7 * i as f64).sin());
        reduce::project(&self.numbering, along.as_mut_slice());
        let mut factors = g.normal()?;
        // Twice, because the regularising weight leaves a small part.
        for _ in 0..2 {
            along -= g.combined(&factors.solve(&g.products(&along)));
        }
        let size = along.amax();
        if size < 1e-6 {
            return None;
        }
        let mut moved = q.to_vec();
        self.advance(&mut moved, &(along * (distance * self.length / size)));
        self.close(moved, None)
    }

    /// The rows to keep at q in this order, so that they are independent and the others follow, each with
    /// the largest part of a row across those before.
    pub(super) fn order(&self, q: &[f64]) -> Vec<(usize, f64)> {
        self.gradients(q).independent()
    }
}
