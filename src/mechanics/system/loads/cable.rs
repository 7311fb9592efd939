//! Cables: their tension, forces, Jacobians, energy and pull-backs.
//!
//! ```text
//! ψᵀf = −N(δ, δ̇) L̇(ψ),     δ = Σ l_i − L0(t),     V = V(δ)
//! ```
//!
//! l_i are the distances of points that follow each other, with N and V of [`super::normal_law`].

use super::coordinate::Coordinate;
use super::normal_law::{self, NormalForce};
use super::power::{SpringLength, apart, speed_seen};
use super::pull::{Pulled, Virtual, hold_virtual, moving, pull_rate, with_motions};
use super::{Acting, LoadCotangent, LoadEntries, give_to_states, stop};
use crate::linalg::Emit;
use crate::math::{Scalar, Vec3};
use crate::model::{Cable, JointFrame, LoadKind, Model};
use crate::system::bodies::{BodyMotion, add6, velocities_of};
use crate::system::in_motion::InMotion;
use crate::system::side::JointSide;

/// A cable at an instant.
struct Running<'a, S> {
    own: &'a Cable<S>,
    /// Its straight parts.
    parts: Vec<(Acting<'a, S>, SpringLength<S>)>,
    /// δ and δ̇.
    stretch: [S; 2],
    /// L̇0.
    paid_out: S,
    normal: NormalForce<S>,
}

/// Derivatives of a scalar that depends on a cable.
struct CablePulled<S> {
    parts: Vec<Pulled<S>>,
    /// In δ and δ̇.
    stretch: [S; 2],
    law: [S; 3],
}

impl<'a, S: Scalar> Running<'a, S> {
    fn of(
        own: &'a Cable<S>,
        motions: &'a [BodyMotion<S>],
        ground: &'a BodyMotion<S>,
        time: S,
    ) -> Self {
        let side = |i: usize| {
            let place = &own.points[i];
            let frame = JointFrame {
                point: place.point,
                ..JointFrame::zero()
            };
            let motion = place.body.map_or(ground, |body| &motions[body]);
            (place.body, JointSide::fixed(motion, frame))
        };
        let part = |i: usize| {
            let ((body_a, a), (body_b, b)) = (side(i), side(i + 1));
            let at = Acting {
                bodies: [body_a, body_b],
                a,
                b,
                counted: None,
                part: 0.0,
            };
            let now = apart(&at);
            (at, now)
        };
        let parts: Vec<_> = (0..own.points.len() - 1).map(part).collect();
        let [length, paid_out, ..] = own.length.derivatives(time);
        let sum = |of: &dyn Fn(&SpringLength<S>) -> S| {
            parts.iter().fold(S::zero(), |sum, (_, now)| sum + of(now))
        };
        let stretch = [
            sum(&|now| now.length) - length,
            sum(&|now| now.rate) - paid_out,
        ];
        Self {
            own,
            stretch,
            paid_out,
            normal: normal_law::force(&own.law, stretch[0], stretch[1]),
            parts,
        }
    }

    /// L and L̇.
    fn length(&self) -> [S; 2] {
        let zero = [S::zero(); 2];
        let all = self.parts.iter();
        all.fold(zero, |[l, rate], (_, now)| {
            [l + now.length, rate + now.rate]
        })
    }

    /// The derivatives of `by_stretch` δ + `by_rate` δ̇, without those of L0.
    fn pull(&self, stretch: [S; 2], law: [S; 3]) -> CablePulled<S> {
        let one = |(at, now): &(Acting<S>, SpringLength<S>)| {
            let mut out = Pulled::zero();
            pull_rate(at, now, stretch.into(), &mut out);
            out
        };
        CablePulled {
            parts: self.parts.iter().map(one).collect(),
            stretch,
            law,
        }
    }

    /// The derivatives of `weight` N.
    fn pull_tension(&self, weight: S) -> CablePulled<S> {
        let of = &self.normal;
        let stretch = [of.by_penetration * weight, of.by_rate * weight];
        self.pull(stretch, of.by_law.map(|by| by * weight))
    }

    /// The derivatives of ψᵀf, ψ given for the parts that have some.
    fn pull_power(&self, psi: impl Fn(usize) -> Option<Virtual<S>>) -> CablePulled<S> {
        let mut rate = S::zero();
        let mut turned = Vec::new();
        for (i, (at, _)) in self.parts.iter().enumerate() {
            let Some(psi) = psi(i) else { continue };
            let motions = moving(at, &psi);
            let virtually = with_motions(at, &motions);
            let now = apart(&virtually);
            rate += now.rate;
            let mut out = Pulled::zero();
            pull_rate(&virtually, &now, (S::zero(), -self.normal.value), &mut out);
            hold_virtual(&mut out);
            turned.push((i, out));
        }
        let mut all = self.pull_tension(-rate);
        for (i, out) in turned {
            all.parts[i].a.add(&out.a);
            all.parts[i].b.add(&out.b);
        }
        all
    }

    /// Calls `visit(body, force, torque)` for the forces on both ends of every part.
    fn each_force(&self, mut visit: impl FnMut(usize, Vec3<S>, Vec3<S>)) {
        for (at, _) in &self.parts {
            let unit = Coordinate::Distance.unit_forces(at);
            for (body, (force, torque)) in at.bodies.into_iter().zip(unit) {
                let Some(body) = body else { continue };
                visit(
                    body,
                    force * -self.normal.value,
                    torque * -self.normal.value,
                );
            }
        }
    }
}

/// Calls `visit` for every cable.
fn for_each<S: Scalar>(
    model: &Model<S>,
    motions: &[BodyMotion<S>],
    time: S,
    mut visit: impl FnMut(usize, &Running<S>),
) {
    let mut ground = None;
    for (i, load) in model.loads.iter().enumerate() {
        if let LoadKind::Cable(own) = &load.kind {
            let ground = ground.get_or_insert_with(BodyMotion::ground);
            visit(i, &Running::of(own, motions, ground, time));
        }
    }
}

/// What `with` makes of the cable that a load is.
fn with<S: Scalar, T>(
    here: &InMotion<S>,
    load: usize,
    with: impl FnOnce(&Running<S>) -> T,
) -> Option<T> {
    let LoadKind::Cable(own) = &here.model.loads[load].kind else {
        return None;
    };
    let ground = BodyMotion::ground();
    Some(with(&Running::of(own, here.motions, &ground, here.time)))
}

/// Adds the forces on bodies to `out`, in velocity numbering.
pub(super) fn add_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here.model, here.motions, here.time, |_, running| {
        running.each_force(|body, force, torque| {
            add6(&mut out[here.numbering.velocity(body)..], &force, &torque);
        });
    });
}

/// The power by which winches supply energy, −Σ N L̇0 \[W\].
pub fn winch_power<S: Scalar>(here: &InMotion<S>) -> S {
    let mut sum = S::zero();
    for_each(here.model, here.motions, here.time, |_, running| {
        sum -= running.normal.value * running.paid_out;
    });
    sum
}

/// Emits the derivatives of the forces of all cables.
pub(super) fn emit_jacobian<S: Scalar>(
    here: &InMotion<S>,
    to: &LoadEntries<S>,
    emit: &mut dyn Emit<S>,
) {
    for_each(here.model, here.motions, here.time, |_, running| {
        // A zero that no design changes has no columns.
        let damped = !running.own.law.dissipation.is_zero();
        for (i, (at, _)) in running.parts.iter().enumerate() {
            for side in 0..2 {
                let Some(body) = at.bodies[side] else {
                    continue;
                };
                for component in 0..6 {
                    let mut psi = [(Vec3::zeros(), Vec3::zeros()); 2];
                    let (linear, angular) = &mut psi[side];
                    [linear, angular][component / 3][component % 3] = S::one();
                    let pulled = running.pull_power(|k| (k == i).then_some(psi));
                    let row = to.row + here.numbering.velocity(body) + component;
                    let all = running.parts.iter().zip(&pulled.parts);
                    for ((at, _), by) in all {
                        for (body, by) in at.bodies.into_iter().zip([&by.a, &by.b]) {
                            let Some(body) = body else { continue };
                            let o = here.numbering.velocity(body);
                            for (part, by) in [&by.position, &by.theta].into_iter().enumerate() {
                                emit.add_row(row, to.y + o + 3 * part, &(by * to.by_y));
                            }
                            let rates = [&by.velocity, &by.omega].into_iter().enumerate();
                            for (part, by) in rates.filter(|_| damped) {
                                emit.add_row(row, to.v + o + 3 * part, &(by * to.by_v));
                            }
                        }
                    }
                }
            }
        }
    });
}

/// Adds derivatives that depend on cable `load` to states, time and parameters.
fn give(
    here: &InMotion<f64>,
    (load, running): (usize, &Running<f64>),
    pulled: &CablePulled<f64>,
    out: &mut LoadCotangent,
) {
    for ((at, _), pulled) in running.parts.iter().zip(&pulled.parts) {
        give_to_states(pulled, at, here.numbering, (&mut out.y, &mut out.v));
    }
    let own = &running.own;
    let by_time = give_to_parameters((load, own), here.time, pulled, out.model);
    *out.time += by_time;
}

/// Adds derivatives in the parameters of cable `load`. Returns that in time.
fn give_to_parameters(
    (load, own): (usize, &Cable<f64>),
    time: f64,
    pulled: &CablePulled<f64>,
    model: &mut Model<f64>,
) -> f64 {
    let LoadKind::Cable(to) = &mut model.loads[load].kind else {
        unreachable!("a cotangent has the kind of its load")
    };
    for (i, pulled) in pulled.parts.iter().enumerate() {
        to.points[i].point += pulled.a.frame.point;
        to.points[i + 1].point += pulled.b.frame.point;
    }
    stop::give_law(&pulled.law, &mut to.law);
    let [by_stretch, by_rate] = pulled.stretch;
    let weights = [-by_stretch, -by_rate, 0.0];
    own.length.pull_back(time, weights, &mut to.length)
}

/// Adds the derivatives of ψᵀf of all cables.
pub(super) fn pull_back(here: &InMotion<f64>, psi: &[f64], out: &mut LoadCotangent) {
    for_each(here.model, here.motions, here.time, |load, running| {
        let of_body = |body: Option<usize>| {
            body.map_or((Vec3::zeros(), Vec3::zeros()), |body| {
                velocities_of(&psi[here.numbering.velocity(body)..])
            })
        };
        let pulled = running.pull_power(|i| Some(running.parts[i].0.bodies.map(of_body)));
        give(here, (load, running), &pulled, out);
    });
}

/// The potential energy of all cables.
pub(super) fn potential<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>], time: S) -> S {
    let mut sum = S::zero();
    for_each(model, motions, time, |_, running| {
        sum += normal_law::potential(&running.own.law, running.stretch[0]).0;
    });
    sum
}

/// Adds `weight` times the derivative of [`potential`].
pub(super) fn pull_potential(here: &InMotion<f64>, weight: f64, out: &mut LoadCotangent) {
    for_each(here.model, here.motions, here.time, |load, running| {
        let law = &running.own.law;
        let (_, by_stretch, [by_stiffness, by_width]) =
            normal_law::potential(law, running.stretch[0]);
        let by_law = [by_stiffness * weight, 0.0, by_width * weight];
        let pulled = running.pull([by_stretch * weight, 0.0], by_law);
        give(here, (load, running), &pulled, out);
    });
}

/// The power by which a cable drives its bodies, −N L̇; `None` of another load.
pub(super) fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    with(here, load, |running| {
        -(running.normal.value * running.length()[1])
    })
}

/// Adds `weight` times the derivative of [`power`].
pub(super) fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    with(here, load, |running| {
        let [_, rate] = running.length();
        give(
            here,
            (load, running),
            &running.pull_tension(-weight * rate),
            out,
        );
        let mut by_rate = running.pull([0.0, -weight * running.normal.value], [0.0; 3]);
        // That of L̇, without L̇0.
        by_rate.stretch = [0.0; 2];
        give(here, (load, running), &by_rate, out);
    });
}

/// The tension of a cable, or its length from end to end.
pub(super) fn measure<S: Scalar>(here: &InMotion<S>, load: usize, tension: bool) -> Option<S> {
    with(here, load, |running| match tension {
        true => running.normal.value,
        false => running.length()[0],
    })
}

/// Adds `weight` times the derivative of [`measure`].
pub(super) fn pull_measure(
    here: &InMotion<f64>,
    (load, tension): (usize, bool),
    weight: f64,
    out: &mut LoadCotangent,
) {
    with(here, load, |running| {
        let mut pulled = match tension {
            true => running.pull_tension(weight),
            false => running.pull([weight, 0.0], [0.0; 3]),
        };
        if !tension {
            pulled.stretch = [0.0; 2];
        }
        give(here, (load, running), &pulled, out);
    });
}

/// How far a cable is from being taut, δ, and a bound of its rate.
pub(super) fn gap<S: Scalar>(own: &Cable<S>, motions: &[BodyMotion<S>], time: S) -> [f64; 2] {
    let ground = BodyMotion::ground();
    let running = Running::of(own, motions, &ground, time);
    let speeds = running.parts.iter().map(|(at, _)| speed_seen(at));
    let speed = speeds.sum::<f64>() + running.paid_out.re().abs();
    [running.stretch[0].re(), speed]
}

/// Whether two points of a cable that follow each other are at one place.
pub(super) fn meets<S: Scalar>(own: &Cable<S>, motions: &[BodyMotion<S>]) -> bool {
    let place = |i: usize| {
        let own = &own.points[i];
        own.body
            .map_or(own.point, |body| motions[body].point(&own.point))
    };
    (1..own.points.len()).any(|i| place(i) == place(i - 1))
}
