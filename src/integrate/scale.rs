//! Scales of the errors of steps.

use crate::math::Scalar;
use crate::model::Model;
use crate::system::initial::InitialState;
use crate::system::{Numbering, placement};

/// Length and speeds of a scene, relative to which errors are measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Length \[m\].
    pub length: f64,
    /// Smallest scales of speed \[m/s\] and angular speed \[rad/s\].
    pub floor: [f64; 2],
}

impl Scale {
    /// The scale of a model that starts in `start` and moves for `duration` \[s\]: its largest
    /// lever arm, and the speed at its start or that of a fall over the length.
    pub(crate) fn of<S: Scalar>(
        model: &Model<S>,
        numbering: &Numbering,
        start: &InitialState<S>,
        duration: f64,
    ) -> Self {
        let length = placement::length_scale(model);
        let gravity = largest(model.gravity.as_slice());
        let fall = (gravity * length).sqrt();
        let [speed, spin] = fastest(numbering, &start.v);
        let drift = if fall > 0.0 { fall } else { length / duration };
        Self {
            length,
            floor: [speed.max(drift), spin.max(drift / length)],
        }
    }

    /// Scales of speed and angular speed of a step between the velocities `v` and `w`.
    pub(crate) fn speeds<S: Scalar>(&self, numbering: &Numbering, v: &[S], w: &[S]) -> [f64; 2] {
        let (v, w) = (fastest(numbering, v), fastest(numbering, w));
        std::array::from_fn(|i| self.floor[i].max(v[i]).max(w[i]))
    }

    /// Mean square of a difference of positions and velocities, each relative to its scale.
    pub(crate) fn square<S: Scalar>(
        &self,
        numbering: &Numbering,
        q: &[S],
        v: &[S],
        speeds: [f64; 2],
    ) -> f64 {
        let part = |x: &[S], scale: f64| -> f64 {
            x.iter().map(|x| (x.re() / scale) * (x.re() / scale)).sum()
        };
        let mut sum = 0.0;
        for body in 0..numbering.bodies() {
            let q = &q[numbering.position(body)..][..7];
            let v = &v[numbering.velocity(body)..][..6];
            sum += part(&q[..3], self.length) + part(&q[3..], 1.0);
            sum += part(&v[..3], speeds[0]) + part(&v[3..], speeds[1]);
        }
        sum / (q.len() + v.len()).max(1) as f64
    }

    /// As [`Scale::square`], for a tangent change y of positions and h times a change of
    /// velocities.
    pub(crate) fn tangent_square(&self, y: &[f64], hv: &[f64], h: f64, speeds: [f64; 2]) -> f64 {
        let part = |x: &[f64], scale: f64| -> f64 { x.iter().map(|x| (x / scale).powi(2)).sum() };
        let both = y.chunks_exact(6).zip(hv.chunks_exact(6));
        let sum: f64 = both
            .map(|(y, v)| {
                part(&y[..3], self.length)
                    + part(&y[3..], 1.0)
                    + part(&v[..3], h * speeds[0])
                    + part(&v[3..], h * speeds[1])
            })
            .sum();
        sum / (2 * y.len()).max(1) as f64
    }
}

fn fastest<S: Scalar>(numbering: &Numbering, v: &[S]) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for body in 0..numbering.bodies() {
        let v = &v[numbering.velocity(body)..][..6];
        most[0] = most[0].max(largest(&v[..3]));
        most[1] = most[1].max(largest(&v[3..]));
    }
    most
}

fn largest<S: Scalar>(x: &[S]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}
