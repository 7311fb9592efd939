//! Scales of the errors of steps.
//!
//! Positions, rotations and velocities of bodies count component by component. The elastic
//! coordinates of a flexible body count as the three components of one displacement, its mean over
//! the mass. So many coordinates do not hide the joints, and coordinates of any unit count by the
//! displacement that they cause. Those of couplings do not count, as the bodies that follow them do.
//!
//! The states of controllers count relative to their size in the step, or to a part of the effort that its gains give for an
//! error of the scene's size: where a drive or a stop holds the machine, bodies do not show what a controller does.

use crate::math::Scalar;
use crate::model::controller::{Controller, Coordinate};
use crate::model::{DegreeOfFreedom, Model};
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
    /// The bodies whose velocities are states of controllers, with the smallest scale of each \[N or N m\].
    pub states: Vec<(usize, f64)>,
}

/// Scales of velocities.
#[derive(Clone, Debug)]
pub struct Speeds {
    /// Speed \[m/s\] and angular speed \[rad/s\].
    pub of_bodies: [f64; 2],
    /// By state of a controller \[N or N m\]; those with zero, and those beyond, do not count.
    of_states: Vec<f64>,
}

impl Speeds {
    /// Scales by which states of controllers do not count.
    pub fn without_states(of_bodies: [f64; 2]) -> Self {
        Self {
            of_bodies,
            of_states: Vec::new(),
        }
    }
}

/// Part of the effort that the gains of a controller give for an error of the scene's size, to which its states are resolved.
const LEAST_EFFORT: f64 = 1e-2;

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
        let states = model.controllers().flat_map(Controller::states).count();
        Self {
            components: [7 * rigid + own, 6 * rigid + own + states],
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
        let floor = [speed.max(drift), spin.max(drift / length)];
        let sizes = ([length, 1.0], floor, duration);
        let states = model.controllers().flat_map(|own| {
            let least = LEAST_EFFORT * effort(own, gravity, sizes);
            own.states().map(move |state| (state, least))
        });
        Self {
            states: states.collect(),
            length,
            floor,
            elastic,
        }
    }

    /// Scales of a step between the velocities `v` and `w`.
    pub fn speeds<S: Scalar>(&self, numbering: &Numbering, v: &[S], w: &[S]) -> Speeds {
        let states = self.states.iter().map(|&(state, least)| {
            let at = numbering.velocity(state);
            least.max(v[at].re().abs()).max(w[at].re().abs())
        });
        let of_states = states.collect();
        let (v, w) = (
            fastest(numbering, &self.elastic, v),
            fastest(numbering, &self.elastic, w),
        );
        Speeds {
            of_bodies: std::array::from_fn(|i| self.floor[i].max(v[i]).max(w[i])),
            of_states,
        }
    }

    /// Sum of the squares of a change of states, each relative to its scale.
    fn states_square(&self, speeds: &Speeds, change: impl Fn(usize) -> f64) -> f64 {
        let all = self.states.iter().zip(&speeds.of_states);
        let counted = all.filter(|(_, scale)| **scale > 0.0);
        counted
            .map(|((state, _), scale)| (change(*state) / scale).powi(2))
            .sum()
    }

    /// Mean square of a difference of positions and velocities, each relative to its scale.
    pub fn square<S: Scalar>(
        &self,
        numbering: &Numbering,
        q: &[S],
        v: &[S],
        speeds: &Speeds,
    ) -> f64 {
        let part = |x: &[S], scale: f64| -> f64 {
            x.iter().map(|x| (x.re() / scale) * (x.re() / scale)).sum()
        };
        let mut sum = 0.0;
        for body in (0..numbering.bodies()).filter(|&body| !self.elastic.carries(body)) {
            let q = &q[numbering.position(body)..][..7];
            let v = &v[numbering.velocity(body)..][..6];
            sum += part(&q[..3], self.length) + part(&q[3..], 1.0);
            sum += part(&v[..3], speeds.of_bodies[0]) + part(&v[3..], speeds.of_bodies[1]);
        }
        sum += self.states_square(speeds, |state| v[numbering.velocity(state)].re());
        for own in &self.elastic.displacements {
            let moved = own.value(|body, k| q[numbering.position(body) + k].re());
            let rate = own.value(|body, k| v[numbering.velocity(body) + k].re());
            sum += moved / (self.length * self.length)
                + rate / (speeds.of_bodies[0] * speeds.of_bodies[0]);
        }
        let [positions, velocities] = self.elastic.components;
        sum / (positions + velocities).max(1) as f64
    }

    /// As [`Scale::square`], for a tangent change y of positions and h times a change of
    /// velocities.
    pub fn tangent_square(&self, y: &[f64], hv: &[f64], h: f64, speeds: &Speeds) -> f64 {
        let [linear, angular] = speeds.of_bodies;
        let part = |x: &[f64], scale: f64| -> f64 { x.iter().map(|x| (x / scale).powi(2)).sum() };
        let both = y.chunks_exact(6).zip(hv.chunks_exact(6)).enumerate();
        let mut sum: f64 = both
            .filter(|(body, _)| !self.elastic.carries(*body))
            .map(|(_, (y, v))| {
                part(&y[..3], self.length)
                    + part(&y[3..], 1.0)
                    + part(&v[..3], h * linear)
                    + part(&v[3..], h * angular)
            })
            .sum();
        sum += self.states_square(speeds, |state| hv[6 * state] / h);
        if !self.elastic.displacements.is_empty() {
            let speed = h * linear;
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

/// The effort \[N or N m\] that the gains of a controller give for errors of these sizes (of a displacement and of an angle) and
/// speeds, with the integral of such an error over the motion, and the weights that it balances.
fn effort<S: Scalar>(
    own: &Controller<S>,
    gravity: f64,
    (sizes, speeds, duration): ([f64; 2], [f64; 2], f64),
) -> f64 {
    let kind = |coordinate: &Coordinate<S>| match coordinate {
        Coordinate::Joint {
            dof: DegreeOfFreedom::Rotation,
            ..
        } => 1,
        Coordinate::Joint { .. } | Coordinate::Distance { .. } => 0,
    };
    let feedback = own.feedback.iter().map(|by| {
        let k = kind(&by.coordinate);
        by.proportional.re().abs() * sizes[k] + by.derivative.re().abs() * speeds[k]
    });
    let first = kind(&own.feedback[0].coordinate);
    // An angle is balanced by a torque.
    let arm = [1.0, sizes[0]][first];
    let weights = own
        .weights
        .iter()
        .map(|weight| weight.mass.re().abs() * gravity * arm);
    let integral = own.integral.as_ref();
    let integral = integral.map_or(0.0, |own| own.gain.re().abs() * sizes[first] * duration);
    feedback.chain(weights).sum::<f64>() + integral
}
