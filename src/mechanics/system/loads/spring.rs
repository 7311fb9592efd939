//! Springs with dampers, between two points or about the axis of a joint.
//!
//! With the stretch x = l − l0 or φ − φ0, and tables T of forces over x and D over ẋ, the tension is
//!
//! ```text
//! F = k x + k3 x³ + T(x) + c ẋ + D(ẋ),     V = ½ k x² + ¼ k3 x⁴ + ∫ T,     ψᵀf = −F ẋ(ψ)
//! ```

use super::Acting;
use super::coordinate::Coordinate;
use super::power::{SpringLength, about_axis, angle, apart, turn_rate};
use super::pull::{Pulled, hold_virtual, pull_point, pull_rate};
use crate::math::{Scalar, Vec3};
use crate::model::{ForceTable, LoadKind};
use crate::system::side::JointSide;

/// A spring: its coordinate and its law.
pub(super) struct Spring<'a, S> {
    coordinate: Coordinate,
    rest: S,
    stiffness: S,
    cubic: S,
    damping: S,
    tables: &'a [Option<ForceTable<S>>; 2],
}

/// The spring or torsion spring that a load is, if it is one.
pub(super) fn of<S: Scalar>(kind: &LoadKind<S>) -> Option<Spring<'_, S>> {
    let (coordinate, [rest, stiffness, cubic, damping], tables) = match kind {
        LoadKind::Spring {
            rest_length,
            stiffness,
            cubic,
            damping,
            tables,
            ..
        } => {
            let law = [*rest_length, *stiffness, *cubic, *damping];
            (Coordinate::Distance, law, tables)
        }
        LoadKind::TorsionSpring {
            rest_angle,
            stiffness,
            cubic,
            damping,
            tables,
            ..
        } => {
            let law = [*rest_angle, *stiffness, *cubic, *damping];
            (Coordinate::Angle, law, tables)
        }
        _ => return None,
    };
    Some(Spring {
        coordinate,
        rest,
        stiffness,
        cubic,
        damping,
        tables,
    })
}

/// x and ẋ of a spring, and the length of one between points.
struct State<S> {
    state: [S; 2],
    length: Option<SpringLength<S>>,
}

impl<S: Scalar> State<S> {
    /// Adds the derivatives of `by_x` x + `by_rate` ẋ.
    fn pull(&self, at: &Acting<S>, by: (S, S), out: &mut Pulled<S>) {
        match &self.length {
            Some(now) => pull_rate(at, now, by, out),
            None => Coordinate::Angle.pull(at, by.0, by.1, out),
        }
    }
}

impl<S: Scalar> Spring<'_, S> {
    /// Whether the ends of a spring may meet: its force −(k + k3 l²) d is then smooth at d = 0.
    fn may_meet(&self) -> bool {
        let smooth = self.rest.re() == 0.0 && self.damping.re() == 0.0;
        smooth && self.tables.iter().all(Option::is_none)
    }

    /// Whether it needs the direction from one end to the other, which may not meet then.
    pub(super) fn has_direction(&self) -> bool {
        matches!(self.coordinate, Coordinate::Distance) && !self.may_meet()
    }

    /// The length of a spring between points. Where ends meet that may, it has no direction, and the rate of its length is
    /// set to zero.
    fn stretch(&self, at: &Acting<S>) -> SpringLength<S> {
        let d = at.a.point() - at.b.point();
        if self.may_meet() && d.iter().all(|x| x.re() == 0.0) {
            return SpringLength {
                length: S::zero(),
                rate: S::zero(),
                direction: Vec3::zeros(),
                apart: d,
            };
        }
        apart(at)
    }

    /// x and ẋ, with the length of a spring between points.
    fn state(&self, at: &Acting<S>) -> State<S> {
        let length = match self.coordinate {
            Coordinate::Distance => Some(self.stretch(at)),
            Coordinate::Angle | Coordinate::Slide => None,
        };
        let state = match &length {
            Some(now) => [now.length - self.rest, now.rate],
            None => [angle(at, self.rest), turn_rate(at)],
        };
        State { state, length }
    }

    /// F, ∂F/∂x and ∂F/∂ẋ.
    fn law(&self, [x, rate]: [S; 2]) -> [S; 3] {
        let square = x * x;
        let mut force = x * (self.stiffness + self.cubic * square) + self.damping * rate;
        let mut by = [self.stiffness + self.cubic * square * 3.0, self.damping];
        for ((table, at), by) in self.tables.iter().zip([x, rate]).zip(&mut by) {
            if let Some(table) = table {
                let [own, slope] = table.force(at);
                force += own;
                *by += slope;
            }
        }
        [force, by[0], by[1]]
    }

    /// The distance of the points of a spring.
    pub(super) fn length(&self, at: &Acting<S>) -> S {
        self.stretch(at).length
    }

    /// Adds `weight` times the derivatives of [`Self::length`].
    pub(super) fn pull_length(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        pull_rate(at, &self.stretch(at), (weight, S::zero()), out);
    }

    /// F.
    pub(super) fn tension(&self, at: &Acting<S>) -> S {
        self.law(self.state(at).state)[0]
    }

    /// Adds `weight` times the derivatives of F.
    pub(super) fn pull_tension(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        let now = self.state(at);
        let law = self.law(now.state);
        self.pull_law(at, (&now, law), weight, out);
    }

    fn pull_law(
        &self,
        at: &Acting<S>,
        (now, [_, by_x, by_rate]): (&State<S>, [S; 3]),
        weight: S,
        out: &mut Pulled<S>,
    ) {
        let (by_x, by_rate) = (by_x * weight, by_rate * weight);
        now.pull(at, (by_x, by_rate), out);
        let [x, rate] = now.state;
        out.set_scalars([-by_x, x * weight, x * x * x * weight, rate * weight]);
        (out.places, out.by_tables) = (now.state, [weight, weight, S::zero()]);
    }

    /// Generalised forces on body A and on body B.
    pub(super) fn forces(&self, at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
        let now = self.state(at);
        let force = -self.law(now.state)[0];
        match &now.length {
            Some(now) => {
                let f = now.direction * force;
                let [a, b] = [&at.a, &at.b].map(|side| {
                    let local = side.motion.rotation.tr_mul(&f);
                    side.frame.point.cross(&local)
                });
                [(f, a), (-f, -b)]
            }
            None => about_axis(at, force),
        }
    }

    /// Derivatives of ψᵀf; `virtually` has the velocities ψ.
    pub(super) fn pull(&self, at: &Acting<S>, virtually: &Acting<S>, out: &mut Pulled<S>) {
        if self.may_meet() && matches!(self.coordinate, Coordinate::Distance) {
            return self.pull_meeting(at, virtually, out);
        }
        let (now, virtual_state) = (self.state(at), self.state(virtually));
        let [_, virtual_rate] = virtual_state.state;
        let law = self.law(now.state);
        virtual_state.pull(virtually, (S::zero(), -law[0]), out);
        hold_virtual(out);
        self.pull_law(at, (&now, law), -virtual_rate, out);
    }

    /// Derivatives of the power −(k + k3 l²) d · w of a spring whose ends may meet, w their virtual velocity from each other.
    /// Its rest length and its damping are zero, with derivatives where the spring has a direction.
    fn pull_meeting(&self, at: &Acting<S>, virtually: &Acting<S>, out: &mut Pulled<S>) {
        let (k, k3) = (self.stiffness, self.cubic);
        let now = self.stretch(at);
        let d = now.apart;
        let speed = |side: &JointSide<S>| side.point_jet().rate;
        let w = speed(&virtually.a) - speed(&virtually.b);
        let square = d.dot(&d);
        let (force, power, zero) = (k + k3 * square, d.dot(&w), Vec3::zeros());
        pull_point(&virtually.a, [zero, -d * force], &mut out.a);
        pull_point(&virtually.b, [zero, d * force], &mut out.b);
        hold_virtual(out);
        let by_d = -(w * force + d * (k3 * power * 2.0));
        pull_point(&at.a, [by_d, zero], &mut out.a);
        pull_point(&at.b, [-by_d, zero], &mut out.b);
        let along = now.direction.dot(&w);
        out.set_scalars([
            (k + k3 * square * 3.0) * along,
            -power,
            -(square * power),
            -(now.rate * along),
        ]);
    }

    /// V.
    pub(super) fn potential(&self, at: &Acting<S>) -> S {
        let [x, _] = self.state(at).state;
        let square = x * x;
        let table = self.tables[0].as_ref().map(|table| table.energy(x));
        square * (self.stiffness * 0.5 + self.cubic * square * 0.25) + table.unwrap_or(S::zero())
    }

    /// Adds `weight` times the derivatives of V.
    pub(super) fn pull_potential(&self, at: &Acting<S>, weight: S, out: &mut Pulled<S>) {
        let now = self.state(at);
        let [x, _] = now.state;
        let square = x * x;
        let table = self.tables[0].as_ref().map(|table| table.force(x)[0]);
        let force = x * (self.stiffness + self.cubic * square) + table.unwrap_or(S::zero());
        let by_x = weight * force;
        now.pull(at, (by_x, S::zero()), out);
        let quartic = weight * square * square * 0.25;
        out.set_scalars([-by_x, weight * square * 0.5, quartic, S::zero()]);
        (out.places, out.by_tables) = (now.state, [S::zero(), S::zero(), weight]);
    }
}

/// Adds the derivatives of tables to their cotangents.
pub(super) fn give_tables(
    pulled: &Pulled<f64>,
    tables: &[Option<ForceTable<f64>>; 2],
    to: &mut [Option<ForceTable<f64>>; 2],
) {
    let [by_elastic, by_viscous, by_energy] = pulled.by_tables;
    let weights = [[by_elastic, by_energy], [by_viscous, 0.0]];
    for (((table, to), at), weights) in tables.iter().zip(to).zip(pulled.places).zip(weights) {
        if let (Some(table), Some(to)) = (table, to) {
            table.pull_back(at, weights, to);
        }
    }
}
