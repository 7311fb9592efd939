//! The law of a controller: the equations of [`crate::model::controller`], and the derivatives of its outputs.
//!
//! With virtual velocities ψ of the bodies and ψ_I, ψ_F of the states,
//!
//! ```text
//! ψᵀf = F ẋ_0(ψ) + İ ψ_I + Ḟ ψ_F
//! ```
//!
//! so the cotangents of F, İ and Ḟ are ẋ_0(ψ), ψ_I and ψ_F, and all others follow by the chain rule.

use super::Acting;
use super::coordinate::Coordinate;
use super::motor::{self, Limited};
use super::pull::{Pulled, Virtual, hold_virtual, moving, pull_axis, pull_point, with_motions};
use crate::math::{Scalar, Vec3};
use crate::model::controller::{Controller, Coordinate as Written, Regime};
use crate::model::{JointFrame, LoadKind};
use crate::system::bodies::BodyMotion;
use crate::system::in_motion::InMotion;
use crate::system::side::JointSide;
use crate::system::turns;

/// A controller in motion.
pub(super) struct Running<'a, S> {
    pub own: &'a Controller<S>,
    gravity: Vec3<S>,
    pub coordinates: Vec<(Coordinate, Acting<'a, S>)>,
    /// e_k and ė_k.
    pub errors: Vec<[S; 2]>,
    /// The points whose weights are balanced.
    pub weights: Vec<JointSide<'a, S>>,
    /// I and F of a lag, or zero.
    pub integral: S,
    pub lagged: S,
    pub demand: S,
    pub limited: Limited<S>,
}

/// Cotangents of F, İ and Ḟ.
#[derive(Clone, Copy)]
pub(super) struct Outputs<S> {
    pub effort: S,
    pub integral: S,
    pub lag: S,
}

/// Derivatives by what a controller knows.
pub(super) struct Known<S> {
    /// By coordinate; its points or frames with it.
    pub coordinates: Vec<Pulled<S>>,
    /// By weight.
    pub weights: Vec<Pulled<S>>,
    pub gravity: Vec3<S>,
    pub masses: Vec<S>,
    /// Of u, of s, and of I and F.
    pub demand: S,
    pub limited: S,
    pub integral: S,
    pub lagged: S,
}

/// The controller that a load is, if it is one.
pub(super) fn of<'a, S: Scalar>(here: &InMotion<'a, S>, load: usize) -> Option<&'a Controller<S>> {
    match &here.model.loads[load].kind {
        LoadKind::Controller(own) => Some(own),
        _ => None,
    }
}

/// What acts on a coordinate.
fn acting<'a, S: Scalar>(
    here: &InMotion<'a, S>,
    ground: &'a BodyMotion<S>,
    coordinate: &Written<S>,
) -> (Coordinate, Acting<'a, S>) {
    let motions = here.motions;
    let between = |(body_a, frame_a): (usize, JointFrame<S>),
                   (body_b, frame_b): (Option<usize>, JointFrame<S>)| Acting {
        bodies: [Some(body_a), body_b],
        a: JointSide::fixed(&motions[body_a], frame_a),
        b: JointSide::fixed(body_b.map_or(ground, |body| &motions[body]), frame_b),
        counted: None,
        part: 0.0,
    };
    match coordinate {
        Written::Joint {
            joint,
            dof,
            counter,
        } => {
            let own = &here.model.joints[*joint];
            let mut acting = between((own.body_a, own.frame_a), (own.body_b, own.frame_b));
            acting.counted = counter.map(|counter| {
                let ends = [&acting.a.motion.orientation, &acting.b.motion.orientation];
                let known = motions[counter].position.x.re();
                turns::counted(here.model, (*joint, counter), ends, known)
            });
            (Coordinate::from(*dof), acting)
        }
        Written::Distance {
            body_a,
            body_b,
            point_a,
            point_b,
        } => {
            let at = |point: &Vec3<S>| JointFrame {
                point: *point,
                ..JointFrame::zero()
            };
            let acting = between((*body_a, at(point_a)), (*body_b, at(point_b)));
            (Coordinate::Distance, acting)
        }
    }
}

impl<'a, S: Scalar> Running<'a, S> {
    /// What acts on its distances.
    pub fn distances(&self) -> impl Iterator<Item = &Acting<'a, S>> {
        let all = self.coordinates.iter();
        all.filter_map(|(own, at)| matches!(own, Coordinate::Distance).then_some(at))
    }

    pub fn of(here: &InMotion<'a, S>, ground: &'a BodyMotion<S>, own: &'a Controller<S>) -> Self {
        let coordinates: Vec<(Coordinate, Acting<'a, S>)> = (own.feedback.iter())
            .map(|own| acting(here, ground, &own.coordinate))
            .collect();
        let errors: Vec<[S; 2]> = (own.feedback.iter().zip(&coordinates))
            .map(|(own, (coordinate, at))| {
                let [r, rate, ..] = own.reference.derivatives(here.time);
                [r - coordinate.value(at), rate - coordinate.rate(at)]
            })
            .collect();
        let weights = own.weights.iter().map(|own| {
            let at = JointFrame {
                point: own.point,
                ..JointFrame::zero()
            };
            JointSide::fixed(&here.motions[own.body], at)
        });
        let state = |body: usize| here.motions[body].velocity.x;
        let mut running = Self {
            own,
            gravity: here.model.gravity,
            errors,
            weights: weights.collect(),
            integral: own
                .integral
                .as_ref()
                .map_or(S::zero(), |own| state(own.state)),
            lagged: own.lag.as_ref().map_or(S::zero(), |own| state(own.state)),
            demand: S::zero(),
            limited: motor::limited(&own.limits, S::zero(), S::zero()),
            coordinates,
        };
        let terms = own.feedback.iter().zip(&running.errors);
        let demand = terms.fold(running.integral, |sum, (own, [e, rate])| {
            sum + own.proportional * *e + own.derivative * *rate
        });
        running.demand = demand + own.feed_forward.value(here.time) + running.balance();
        let (coordinate, at) = &running.coordinates[0];
        let rate = coordinate.rate(at);
        running.limited = motor::limited(&own.limits, running.demand, rate);
        running
    }

    /// The effort against the weights that are balanced.
    fn balance(&self) -> S {
        let (kind, at) = &self.coordinates[0];
        let axis = at.a.axis(2);
        let all = self.own.weights.iter().zip(&self.weights);
        all.fold(S::zero(), |sum, (own, side)| {
            let along = match kind {
                Coordinate::Angle => axis.cross(&(side.point() - at.a.point())),
                Coordinate::Slide | Coordinate::Distance => axis,
            };
            sum - own.mass * self.gravity.dot(&along)
        })
    }

    /// F.
    pub fn effort(&self) -> S {
        match (self.own.regime, &self.own.lag, &self.own.integral) {
            (Regime::Off, ..) | (Regime::Settled, _, Some(_)) => S::zero(),
            (Regime::Running, Some(_), _) => self.lagged,
            (Regime::Running, None, _) | (Regime::Settled, _, None) => self.limited.effort,
        }
    }

    /// Bodies and rates of the states: İ and Ḟ.
    pub fn state_rates(&self) -> [Option<(usize, S)>; 2] {
        let s = self.limited.effort;
        let stays = |rate: S| match self.own.regime {
            Regime::Running => rate,
            Regime::Settled | Regime::Off => S::zero(),
        };
        let integral = self.own.integral.as_ref().map(|own| {
            let excess = own.tracking.map(|time| (s - self.demand) / time);
            let rate = own.gain * self.errors[0][0] + excess.unwrap_or(S::zero());
            (own.state, stays(rate))
        });
        let lag = self.own.lag.as_ref();
        let lag = lag.map(|own| (own.state, stays((s - self.lagged) / own.time)));
        [integral, lag]
    }

    /// Cotangents of outputs that change.
    fn counted(&self, by: Outputs<S>) -> Outputs<S> {
        let acts = match self.own.regime {
            Regime::Running => return by,
            Regime::Settled => self.own.integral.is_none(),
            Regime::Off => false,
        };
        Outputs {
            effort: if acts { by.effort } else { S::zero() },
            integral: S::zero(),
            lag: S::zero(),
        }
    }

    /// Derivatives of F, İ and Ḟ times their cotangents, but for those by virtual velocities.
    pub fn pull(&self, by: Outputs<S>) -> Known<S> {
        let own = self.own;
        let by = self.counted(by);
        let mut out = Known {
            coordinates: self.coordinates.iter().map(|_| Pulled::zero()).collect(),
            weights: self.weights.iter().map(|_| Pulled::zero()).collect(),
            gravity: Vec3::zeros(),
            masses: Vec::new(),
            demand: S::zero(),
            limited: S::zero(),
            integral: S::zero(),
            lagged: S::zero(),
        };
        match &own.lag {
            Some(lag) if own.regime == Regime::Running => {
                out.limited += by.lag / lag.time;
                out.lagged += by.effort - by.lag / lag.time;
            }
            _ => out.limited += by.effort,
        }
        let mut by_error = S::zero();
        if let Some(integral) = &own.integral {
            by_error += by.integral * integral.gain;
            if let Some(time) = integral.tracking {
                out.limited += by.integral / time;
                out.demand -= by.integral / time;
            }
        }
        out.demand += out.limited * self.limited.by_demand;
        out.integral = out.demand;
        let mut by_rate = out.limited * self.limited.by_rate;
        let all = own.feedback.iter().zip(&self.coordinates);
        for ((own, (coordinate, at)), to) in all.zip(&mut out.coordinates) {
            let by_x = -(own.proportional * out.demand + by_error);
            by_rate -= own.derivative * out.demand;
            coordinate.pull(at, by_x, by_rate, to);
            (by_error, by_rate) = (S::zero(), S::zero());
        }
        self.pull_balance(&mut out);
        out
    }

    /// Adds the derivatives of the effort against weights.
    fn pull_balance(&self, out: &mut Known<S>) {
        let (kind, at) = &self.coordinates[0];
        let (axis, zero) = (at.a.axis(2), Vec3::zeros());
        let all = self.own.weights.iter().zip(&self.weights);
        for ((own, side), to) in all.zip(&mut out.weights) {
            let by_mass = self.gravity * -out.demand;
            let by_along = by_mass * own.mass;
            let own_point = &mut out.coordinates[0].a;
            let along = match kind {
                Coordinate::Angle => {
                    let arm = side.point() - at.a.point();
                    pull_axis(&at.a, 2, arm.cross(&by_along), own_point);
                    let by_arm = by_along.cross(&axis);
                    pull_point(side, [by_arm, zero], &mut to.a);
                    pull_point(&at.a, [-by_arm, zero], own_point);
                    axis.cross(&arm)
                }
                Coordinate::Slide | Coordinate::Distance => {
                    pull_axis(&at.a, 2, by_along, own_point);
                    axis
                }
            };
            out.masses.push(by_mass.dot(&along));
            out.gravity -= along * (own.mass * out.demand);
        }
    }

    /// The cotangents of F, İ and Ḟ in ψᵀf, and its derivatives.
    pub fn pulled(&self, psi: &Virtual<S>, [integral, lag]: [S; 2]) -> (Outputs<S>, Known<S>) {
        let (coordinate, at) = &self.coordinates[0];
        let motions = moving(at, psi);
        let virtually = with_motions(at, &motions);
        let by = self.counted(Outputs {
            effort: coordinate.rate(&virtually),
            integral,
            lag,
        });
        let mut out = self.pull(by);
        let mut geometry = Pulled::zero();
        coordinate.pull(&virtually, S::zero(), self.effort(), &mut geometry);
        hold_virtual(&mut geometry);
        let first = &mut out.coordinates[0];
        first.a.add(&geometry.a);
        first.b.add(&geometry.b);
        (by, out)
    }
}
