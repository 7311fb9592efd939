//! The pull-back of cotangents of the rows of a planar scene to states and parameters, as
//! [`super::joints::pull_back`] in space, for rates and second derivatives.

use super::bodies::add6;
use super::joints::{JointCotangent, RowCotangents};
use super::numbering::Numbering;
use super::planar::{
    PlanarFrame, PlanarJoint, PlanarJoints, PlanarMarker, PlanarMotion, Vec2, spatial,
};
use super::rows::RowCotangent;
use crate::model::JointFrame;

/// Cotangents of one side of a joint.
#[derive(Clone, Copy)]
struct SideCotangent {
    position: Vec2<f64>,
    theta: f64,
    velocity: Vec2<f64>,
    omega: f64,
    frame: PlanarFrame<f64>,
}

impl SideCotangent {
    fn zero() -> Self {
        Self {
            position: Vec2::zeros(),
            theta: 0.0,
            velocity: Vec2::zeros(),
            omega: 0.0,
            frame: PlanarFrame {
                point: Vec2::zeros(),
                axes: [Vec2::zeros(); 3],
            },
        }
    }

    /// Pulls the cotangent of a direction back. Returns that of its components in the body.
    fn direction(
        &mut self,
        at: &PlanarMotion<f64>,
        s: &Vec2<f64>,
        cot: &PlanarMarker<f64>,
    ) -> Vec2<f64> {
        let (x, across) = at.turned(s);
        // Cotangents of ρ and ρ'.
        let by_x = cot.x - cot.acceleration * (at.omega * at.omega);
        let by_across =
            cot.rate * at.omega + cot.acceleration * at.alpha + cot.virtual_rate * at.virtual_omega;
        self.theta += by_x.dot(&across) - by_across.dot(&x);
        self.omega += cot.rate.dot(&across) - cot.acceleration.dot(&x) * (2.0 * at.omega);
        let [c1, c2] = &at.turn;
        Vec2::new(
            c1.dot(&by_x) + c2.dot(&by_across),
            c2.dot(&by_x) - c1.dot(&by_across),
        )
    }

    /// Pulls the cotangent of axis i back.
    fn axis(
        &mut self,
        at: &PlanarMotion<f64>,
        frame: &PlanarFrame<f64>,
        i: usize,
        cot: &PlanarMarker<f64>,
    ) {
        let by = self.direction(at, &frame.axes[i], cot);
        self.frame.axes[i] += by;
    }

    /// Pulls the cotangent of the point back.
    fn point(&mut self, at: &PlanarMotion<f64>, frame: &PlanarFrame<f64>, cot: &PlanarMarker<f64>) {
        let by = self.direction(at, &frame.point, cot);
        self.frame.point += by;
        self.position += cot.x;
        self.velocity += cot.rate;
    }
}

impl PlanarJoints<f64> {
    /// Pulls cotangents of the rates, second derivatives and virtual rates of all rows (not of
    /// their values) back to tangent positions, velocities and the parameters of the joints, at
    /// constant accelerations and virtual velocities.
    pub fn pull_back(
        &self,
        numbering: &Numbering,
        cotangents: &RowCotangents,
        out: &mut JointCotangent,
    ) {
        for (j, joint) in self.joints.iter().enumerate() {
            let first = numbering.rows(j).start;
            let cot = |i: usize| cotangents.row(first + i);
            let (by_a, by_b, by_length) = self.pull_joint(joint, cot);
            let own = &mut out.model.joints[j];
            own.frame_a.length += by_length;
            self.add_frame(joint.body_a, &by_a.frame, &mut own.frame_a);
            self.add_frame(joint.body_b, &by_b.frame, &mut own.frame_b);
            for (body, by) in [(joint.body_a, &by_a), (joint.body_b, &by_b)] {
                if body == numbering.bodies() {
                    continue;
                }
                let (o, normal) = (numbering.velocity(body), self.planes[body].normal);
                let linear = |x: &Vec2<f64>| spatial(&self.along, x);
                if let Some(y) = out.y.as_deref_mut() {
                    add6(&mut y[o..], &linear(&by.position), &(normal * by.theta));
                }
                if let Some(v) = out.v.as_deref_mut() {
                    add6(&mut v[o..], &linear(&by.velocity), &(normal * by.omega));
                }
            }
        }
    }

    fn pull_joint(
        &self,
        joint: &PlanarJoint<f64>,
        cot: impl Fn(usize) -> RowCotangent<f64>,
    ) -> (SideCotangent, SideCotangent, f64) {
        let (at_a, at_b) = (&self.motions[joint.body_a], &self.motions[joint.body_b]);
        let (mut by_a, mut by_b) = (SideCotangent::zero(), SideCotangent::zero());
        let (by, by_length) = self.with_rows(joint, |rows| rows.pull_back(cot));
        if joint.used.points {
            by_a.point(at_a, &joint.a, &by.distance);
            by_b.point(at_b, &joint.b, &by.distance.scaled(-1.0));
        }
        for i in 0..3 {
            if joint.used.axes_a[i] {
                by_a.axis(at_a, &joint.a, i, &by.axes_a[i]);
            }
            if joint.used.axes_b[i] {
                by_b.axis(at_b, &joint.b, i, &by.axes_b[i]);
            }
        }
        (by_a, by_b, by_length)
    }

    /// Adds the components in a body's plane, transformed to the body's axes.
    fn add_frame(&self, body: usize, by: &PlanarFrame<f64>, out: &mut JointFrame<f64>) {
        let along = &self.planes[body].along;
        out.point += spatial(along, &by.point);
        for (out, by) in out.axes.iter_mut().zip(&by.axes) {
            if *by != Vec2::zeros() {
                *out += spatial(along, by);
            }
        }
    }
}
