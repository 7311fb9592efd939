//! The line of the section's centres: nodes and motion, moved by the offset, and back.
//!
//! y_a = x_a + r_a, w_a = u_a + θ_a × r_a with the arm r_a = o2 e2 + o3 e3 in the axes of the node.

use super::BEAM_NODES;
use super::element::{Beam, BeamMotion};
use super::frame::{Axes, add_sum_transpose, shape, sum};
use crate::math::{Scalar, Vec3};

/// Coordinates r of the nodes.
const PLACES: [f64; BEAM_NODES] = [-1.0, 0.0, 1.0];

/// Arms and places of the line.
pub(super) struct Line<S> {
    axes: [Axes<S>; BEAM_NODES],
    pub arms: [Vec3<S>; BEAM_NODES],
    pub points: [Vec3<S>; BEAM_NODES],
}

/// Cotangents of a line and of its motion.
pub(super) struct LineCotangent<S> {
    pub points: [Vec3<S>; BEAM_NODES],
    pub orientation: Vec3<S>,
    pub displacement: [Vec3<S>; BEAM_NODES],
    pub rotation: [Vec3<S>; BEAM_NODES],
}

impl<S: Scalar> LineCotangent<S> {
    pub fn zeros() -> Self {
        let zero = [Vec3::zeros(); BEAM_NODES];
        Self {
            points: zero,
            orientation: Vec3::zeros(),
            displacement: zero,
            rotation: zero,
        }
    }
}

impl<S: Scalar> Line<S> {
    pub fn new(beam: &Beam<S>) -> Self {
        let axes = PLACES.map(|r| Axes::of(&sum(&shape(r).1, &beam.points), &beam.orientation));
        let [o2, o3] = beam.offset;
        let arms = [0, 1, 2].map(|a: usize| axes[a].e2 * o2 + axes[a].e3 * o3);
        Self {
            axes,
            points: [0, 1, 2].map(|a: usize| beam.points[a] + arms[a]),
            arms,
        }
    }

    /// e2 and e3 at each node.
    pub fn axes(&self) -> [[Vec3<S>; 2]; BEAM_NODES] {
        self.axes.map(|axes| [axes.e2, axes.e3])
    }

    /// The motion w_a of the line; rotations stay.
    pub fn motion(&self, motion: &BeamMotion<S>) -> BeamMotion<S> {
        let w = [0, 1, 2]
            .map(|a: usize| motion.displacement[a] + motion.rotation[a].cross(&self.arms[a]));
        BeamMotion {
            displacement: w,
            rotation: motion.rotation,
        }
    }

    /// Transpose of the derivative of [`Line::new`] and [`Line::motion`].
    pub fn add_transpose(
        &self,
        beam: &Beam<S>,
        motion: &BeamMotion<S>,
        bar: &LineCotangent<S>,
        force: &mut BeamMotion<S>,
        to: &mut Beam<S>,
    ) {
        to.orientation += bar.orientation;
        for a in 0..BEAM_NODES {
            let w_bar = &bar.displacement[a];
            force.displacement[a] += w_bar;
            force.rotation[a] += bar.rotation[a] + self.arms[a].cross(w_bar);
            to.points[a] += bar.points[a];
            let arm_bar = bar.points[a] + w_bar.cross(&motion.rotation[a]);
            let mut axes_bar = Axes::zeros();
            for (k, axis) in [self.axes[a].e2, self.axes[a].e3].iter().enumerate() {
                to.offset[k] += arm_bar.dot(axis);
            }
            axes_bar.e2 = arm_bar * beam.offset[0];
            axes_bar.e3 = arm_bar * beam.offset[1];
            let mut tangent = Vec3::zeros();
            self.axes[a].add_of_transpose(
                &axes_bar,
                &beam.orientation,
                &mut tangent,
                &mut to.orientation,
            );
            add_sum_transpose(&shape(PLACES[a]).1, &tangent, &mut to.points);
        }
    }
}
