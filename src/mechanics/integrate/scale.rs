//! Scales of the errors of steps.
//!
//! Positions, rotations and velocities of bodies count component by component. The elastic
//! coordinates of a flexible body count as the three components of one displacement, its mean over
//! the mass. So many coordinates do not hide the joints, and coordinates of any unit count by the
//! displacement that they cause. Those of couplings do not count, as the bodies that follow them do.

use crate::math::Scalar;
use crate::model::Model;
use crate::system::flexible::MeanSquare;
use crate::system::initial::InitialState;
use crate::system::{Numbering, placement};

/// Length and speeds of a scene, relative to which errors are measured.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Length \[m\].
    pub length: f64,
    /// Smallest scales of speed \[m/s\] and angular speed \[rad/s\].
    pub floor: [f64; 2],
    /// What elastic coordinates count.
    pub elastic: Elastic,
}

/// Part of the way of a motion, at its speed and falling, up to which places are in the origin but for round-off.
const ORIGIN: f64 = 1e-13;

/// What elastic coordinates count; by default there are none.
#[derive(Clone, Debug, Default)]
pub struct Elastic {
    /// By flexible body.
    displacements: Vec<MeanSquare>,
    /// By body: whether it carries coordinates of a flexible body, a coupling or a controller; empty if none does.
    carries: Vec<bool>,
    /// Number of components that count, of positions and velocities.
    components: [usize; 2],
}

/// Components of a displacement.
const DISPLACEMENT: usize = 3;

impl Elastic {
    fn of<S: Scalar>(model: &Model<S>) -> Self {
        let displacements = MeanSquare::all(model);
        let mut carries = Vec::new();
        let coordinates = model.coordinates();
        if !displacements.is_empty() || !coordinates.is_empty() {
            carries.resize(model.bodies.len(), false);
        }
        // The bodies of coupled joints count themselves.
        for body in coordinates {
            carries[body] = true;
        }
        for body in displacements.iter().flat_map(MeanSquare::carriers) {
            carries[body] = true;
        }
        let rigid = model.bodies.len() - carries.iter().filter(|carries| **carries).count();
        let own = DISPLACEMENT * displacements.len();
        Self {
            components: [7 * rigid + own, 6 * rigid + own],
            displacements,
            carries,
        }
    }

    fn carries(&self, body: usize) -> bool {
        self.carries.get(body).copied().unwrap_or(false)
    }

    /// Sum of the mean squares of vectors in velocity numbering.
    fn of_velocities(&self, x: &[f64]) -> f64 {
        let all = self.displacements.iter();
        all.map(|own| own.value(|body, k| x[6 * body + k])).sum()
    }
}

impl Scale {
    /// The scale of a model that starts in `start` and moves for `duration` \[s\]: its largest
    /// lever arm, and the speed at its start or that of a fall over the length.
    pub fn of<S: Scalar>(
        model: &Model<S>,
        numbering: &Numbering,
        start: &InitialState<S>,
        duration: f64,
    ) -> Self {
        let gravity = largest(model.gravity.as_slice());
        let elastic = Elastic::of(model);
        let [speed, spin] = fastest(numbering, &elastic, &start.v);
        let way = speed * duration + 0.5 * gravity * duration * duration;
        // Bodies that are in the origin but for round-off have no size.
        let length = match placement::length_scale(model) {
            length if length > ORIGIN * way => length,
            _ => way,
        };
        let fall = (gravity * length).sqrt();
        let drift = if fall > 0.0 { fall } else { length / duration };
        Self {
            length,
            floor: [speed.max(drift), spin.max(drift / length)],
            elastic,
        }
    }

    /// Scales of speed and angular speed of a step between the velocities `v` and `w`.
    pub fn speeds<S: Scalar>(&self, numbering: &Numbering, v: &[S], w: &[S]) -> [f64; 2] {
        let (v, w) = (
            fastest(numbering, &self.elastic, v),
            fastest(numbering, &self.elastic, w),
        );
        std::array::from_fn(|i| self.floor[i].max(v[i]).max(w[i]))
    }

    /// Mean square of a difference of positions and velocities, each relative to its scale.
    pub fn square<S: Scalar>(
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
        for body in (0..numbering.bodies()).filter(|&body| !self.elastic.carries(body)) {
            let q = &q[numbering.position(body)..][..7];
            let v = &v[numbering.velocity(body)..][..6];
            sum += part(&q[..3], self.length) + part(&q[3..], 1.0);
            sum += part(&v[..3], speeds[0]) + part(&v[3..], speeds[1]);
        }
        for own in &self.elastic.displacements {
            let moved = own.value(|body, k| q[numbering.position(body) + k].re());
            let rate = own.value(|body, k| v[numbering.velocity(body) + k].re());
            sum += moved / (self.length * self.length) + rate / (speeds[0] * speeds[0]);
        }
        let [positions, velocities] = self.elastic.components;
        sum / (positions + velocities).max(1) as f64
    }

    /// As [`Scale::square`], for a tangent change y of positions and h times a change of
    /// velocities.
    pub fn tangent_square(&self, y: &[f64], hv: &[f64], h: f64, speeds: [f64; 2]) -> f64 {
        let part = |x: &[f64], scale: f64| -> f64 { x.iter().map(|x| (x / scale).powi(2)).sum() };
        let both = y.chunks_exact(6).zip(hv.chunks_exact(6)).enumerate();
        let mut sum: f64 = both
            .filter(|(body, _)| !self.elastic.carries(*body))
            .map(|(_, (y, v))| {
                part(&y[..3], self.length)
                    + part(&y[3..], 1.0)
                    + part(&v[..3], h * speeds[0])
                    + part(&v[3..], h * speeds[1])
            })
            .sum();
        if !self.elastic.displacements.is_empty() {
            let speed = h * speeds[0];
            sum += self.elastic.of_velocities(y) / (self.length * self.length)
                + self.elastic.of_velocities(hv) / (speed * speed);
        }
        sum / (2 * self.elastic.components[1]).max(1) as f64
    }
}

fn fastest<S: Scalar>(numbering: &Numbering, elastic: &Elastic, v: &[S]) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for own in &elastic.displacements {
        let rate = own.value(|body, k| v[numbering.velocity(body) + k].re());
        most[0] = most[0].max(rate.sqrt());
    }
    for body in (0..numbering.bodies()).filter(|&body| !elastic.carries(body)) {
        let v = &v[numbering.velocity(body)..][..6];
        most[0] = most[0].max(largest(&v[..3]));
        most[1] = most[1].max(largest(&v[3..]));
    }
    most
}

fn largest<S: Scalar>(x: &[S]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}
