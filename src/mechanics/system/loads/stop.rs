//! Stops of a coordinate x: the angle or displacement of a joint, or the distance of two points.
//!
//! At a limit x₀ the penetration is δ = s (x₀ − x), with s = 1 for the lower limit and −1 for the upper. The force along x is
//!
//! ```text
//! F = Σ s N(δ, δ̇),     δ̇ = −s ẋ,     ψᵀf = F(x, ẋ) ẋ(ψ)
//! ```
//!
//! with N of [`super::normal_law`].

use super::Acting;
use super::coordinate::Coordinate;
use super::normal_law::{self, NormalForce};
use super::power::speed_seen;
use super::pull::{Pulled, hold_virtual};
use crate::math::{Scalar, Vec3};
use crate::model::{LoadKind, NormalLaw};

/// Sides of the lower and the upper limit.
const SIDES: [f64; 2] = [1.0, -1.0];
/// Places of the limits and of the law among the scalars of a load.
const LIMITS: usize = 0;
const LAW: usize = 2;

/// A stop: its coordinate, limits and law.
pub(super) struct Stop<'a, S> {
    coordinate: Coordinate,
    limits: &'a [Option<S>; 2],
    law: &'a NormalLaw<S>,
}

/// The stop that a load is, if it is one.
pub(super) fn of<S>(kind: &LoadKind<S>) -> Option<Stop<'_, S>> {
    let (coordinate, limits, law) = match kind {
        LoadKind::JointStop {
            dof, limits, law, ..
        } => (Coordinate::from(*dof), limits, law),
        LoadKind::DistanceStop { limits, law, .. } => (Coordinate::Distance, limits, law),
        LoadKind::Force { .. }
        | LoadKind::Torque { .. }
        | LoadKind::Spring { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Bushing { .. }
        | LoadKind::Friction { .. }
        | LoadKind::Drag { .. }
        | LoadKind::Contact(_)
        | LoadKind::Controller(_)
        | LoadKind::Cable(_)
        | LoadKind::Distributed(_) => return None,
    };
    Some(Stop {
        coordinate,
        limits,
        law,
    })
}

impl<S: Scalar> Stop<'_, S> {
    /// Calls `visit(number of the limit, its side, δ, N)` for both limits, as far as they exist.
    fn for_each(&self, x: S, rate: S, mut visit: impl FnMut(usize, f64, S, NormalForce<S>)) {
        for (i, (limit, side)) in self.limits.iter().zip(SIDES).enumerate() {
            if let Some(limit) = limit {
                let depth = (*limit - x) * side;
                let normal = normal_law::force(self.law, depth, -(rate * side));
                visit(i, side, depth, normal);
            }
        }
    }

    /// The penetration at the limit that is nearer: negative before the stop.
    pub(super) fn penetration(&self, at: &Acting<S>) -> S {
        self.nearer(at).1
    }

    /// The limit that is nearer, and its penetration.
    fn nearer(&self, at: &Acting<S>) -> (usize, S) {
        let x = self.coordinate.value(at);
        let depths = self.limits.iter().zip(SIDES).enumerate();
        let depths = depths.filter_map(|(i, (limit, side))| Some((i, ((*limit)? - x) * side)));
        let nearer = depths.reduce(|a, b| if b.1.re() > a.1.re() { b } else { a });
        nearer.expect("a stop has a limit, which is checked")
    }

    /// Width of the onset.
    pub(super) fn width(&self) -> S {
        self.law.width
    }

    /// Calls `visit(penetration, speed)` for each limit, for the control of steps. The penetration changes no faster than by
    /// the speed.
    pub(super) fn each_gap(&self, at: &Acting<S>, mut visit: impl FnMut(f64, f64)) {
        let x = self.coordinate.value(at);
        let speed = match self.coordinate {
            Coordinate::Angle | Coordinate::Slide => self.coordinate.rate(at).re().abs(),
            Coordinate::Distance => speed_seen(at),
        };
        for (limit, side) in self.limits.iter().zip(SIDES) {
            if let Some(limit) = limit {
                visit(side * (limit.re() - x.re()), speed);
            }
        }
    }

    /// The sum of the normal forces.
    pub(super) fn normal(&self, at: &Acting<S>) -> S {
        let (x, rate) = (self.coordinate.value(at), self.coordinate.rate(at));
        let mut sum = S::zero();
        self.for_each(x, rate, |_, _, _, normal| sum += normal.value);
        sum
    }

    /// Generalised forces on body A and on body B.
    pub(super) fn forces(&self, at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
        let (x, rate) = (self.coordinate.value(at), self.coordinate.rate(at));
        let mut sum = S::zero();
        self.for_each(x, rate, |_, side, _, normal| sum += normal.value * side);
        let unit = self.coordinate.unit_forces(at);
        unit.map(|(force, torque)| (force * sum, torque * sum))
    }

    /// Derivatives of ψᵀf; `virtually` has the velocities ψ.
    pub(super) fn pull(&self, at: &Acting<S>, virtually: &Acting<S>, out: &mut Pulled<S>) {
        let (x, rate) = (self.coordinate.value(at), self.coordinate.rate(at));
        let virtual_rate = self.coordinate.rate(virtually);
        let (mut size, mut by_x, mut by_rate) = (S::zero(), S::zero(), S::zero());
        self.for_each(x, rate, |i, side, _, normal| {
            size += normal.value * side;
            by_x -= normal.by_penetration;
            by_rate -= normal.by_rate;
            out.scalars[LIMITS + i] += normal.by_penetration * virtual_rate;
            for (k, by) in normal.by_law.into_iter().enumerate() {
                out.scalars[LAW + k] += by * virtual_rate * side;
            }
        });
        self.coordinate.pull(virtually, S::zero(), size, out);
        hold_virtual(out);
        self.coordinate
            .pull(at, by_x * virtual_rate, by_rate * virtual_rate, out);
    }

    /// Adds `weight` times the derivatives of the sum of the normal forces.
    pub(super) fn pull_normal(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        let (x, rate) = (self.coordinate.value(at), self.coordinate.rate(at));
        let (mut by_x, mut by_rate) = (S::zero(), S::zero());
        self.for_each(x, rate, |i, side, _, normal| {
            by_x -= normal.by_penetration * side;
            by_rate -= normal.by_rate * side;
            out.scalars[LIMITS + i] += normal.by_penetration * weight * side;
            for (k, by) in normal.by_law.into_iter().enumerate() {
                out.scalars[LAW + k] += by * weight;
            }
        });
        self.coordinate
            .pull(at, by_x * weight, by_rate * weight, out);
    }

    /// Adds `weight` times the derivatives of the penetration.
    pub(super) fn pull_penetration(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        let i = self.nearer(at).0;
        let by_limit = weight * SIDES[i];
        out.scalars[LIMITS + i] += by_limit;
        self.coordinate.pull(at, -by_limit, S::zero(), out);
    }

    /// The elastic energy.
    pub(super) fn potential(&self, at: &Acting<S>) -> S {
        let x = self.coordinate.value(at);
        let mut sum = S::zero();
        self.for_each(x, S::zero(), |_, _, depth, _| {
            sum += normal_law::potential(self.law, depth).0;
        });
        sum
    }

    /// Adds `weight` times the derivatives of the elastic energy.
    pub(super) fn pull_potential(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        let x = self.coordinate.value(at);
        let mut by_x = S::zero();
        self.for_each(x, S::zero(), |i, side, depth, _| {
            let (_, by_depth, [by_stiffness, by_width]) = normal_law::potential(self.law, depth);
            by_x -= by_depth * weight * side;
            out.scalars[LIMITS + i] += by_depth * weight * side;
            out.scalars[LAW] += by_stiffness * weight;
            out.scalars[LAW + 2] += by_width * weight;
        });
        self.coordinate.pull(at, by_x, S::zero(), out);
    }
}

/// Adds the derivatives in the scalars of a stop to the cotangents of its limits and its law.
pub(super) fn give(scalars: &[f64], limits: &mut [Option<f64>; 2], law: &mut NormalLaw<f64>) {
    for (limit, by) in limits.iter_mut().zip(&scalars[LIMITS..]) {
        if let Some(limit) = limit {
            *limit += by;
        }
    }
    give_law(&scalars[LAW..], law);
}

/// Adds the derivatives in stiffness, dissipation and width.
pub(super) fn give_law(scalars: &[f64], law: &mut NormalLaw<f64>) {
    law.stiffness += scalars[0];
    law.dissipation += scalars[1];
    law.width += scalars[2];
}
