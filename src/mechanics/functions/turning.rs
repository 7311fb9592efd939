//! Rotation of a body about an axis, relative to ground or another body, counted over whole turns.
//!
//! Let p_A and p_B be the Euler parameters of the body and of the other body (1 for ground), and *
//! the conjugate. The angle is
//!
//! ```text
//! r = p_B* p_A c,     c = p_A0* p_B0 from the placement, c = 1 from parallel axes
//! θ = 2 atan2(eᵀn, r0) + 2π k,     n fixed in B
//! ```
//!
//! The angle of a joint is θ with the joint's axis n and c from the placement. At t = 0 it has the whole turns of the
//! joint's start or drive.

use crate::integrate::Trajectory;
use crate::math::rotation::{self, Quat, compose, conjugate};
use crate::math::{Mat3, Parameters, Scalar, Vec3, parameters};
use crate::system::bodies::{add6, positions_of};
use crate::system::{BodyMotion, Numbering};
use std::f64::consts::{PI, TAU};

/// A rotation of a body about an axis.
#[derive(Clone, Copy, Debug)]
pub struct Rotation<S> {
    /// The body that turns.
    pub body: usize,
    /// Body B, which it is relative to; `None` for ground.
    pub relative_to: Option<usize>,
    /// Unit axis n, axes of body B.
    pub axis: Vec3<S>,
    /// c, if the angle counts from the placement; `None` if it counts from parallel axes.
    pub placed: Option<Quat<S>>,
    /// The angle at t = 0 that the start of a joint or its drive gives, up to less than half a turn \[rad\]; `None` if it
    /// is in (−2π, 2π].
    pub first: Option<f64>,
    /// The joint of the file whose angle it is.
    pub joint: Option<usize>,
}

/// Derivatives of an angle in the tangent positions of both bodies and in its parameters.
struct ByRotation {
    theta: Vec3<f64>,
    theta_other: Vec3<f64>,
    axis: Vec3<f64>,
    placed: Quat<f64>,
}

parameters!(struct Rotation { body, relative_to, first, joint; axis, placed });

impl<S: Scalar> Rotation<S> {
    /// Makes it the angle of frame A of a joint relative to frame B, zero where their axes agree: R_A F_A = R_B F_B.
    pub fn count_from(&mut self, [a, b]: [&[Vec3<S>; 3]; 2]) {
        self.axis = b[2];
        let c = Mat3::from_columns(a) * Mat3::from_columns(b).transpose();
        self.placed = Some(rotation::of_matrix(&c));
    }

    /// r at the positions `q`.
    fn turned(&self, numbering: &Numbering, q: &[S]) -> Quat<S> {
        let p = orientation(numbering, q, self.body);
        let seen = match self.relative_to {
            Some(other) => compose(&conjugate(&orientation(numbering, q, other)), &p),
            None => p,
        };
        self.placed.map_or(seen, |placed| compose(&seen, &placed))
    }

    /// θ at the positions `q`, without whole turns \[rad\].
    pub fn angle(&self, numbering: &Numbering, q: &[S]) -> S {
        rotation::twist(&self.turned(numbering, q), &self.axis)
    }

    /// Whole turns that θ has at t = 0, where it is `twist` without them \[rad\].
    pub fn first_turns(&self, twist: f64) -> f64 {
        self.first.map_or(0.0, |first| whole_turns(first - twist))
    }

    /// θ̇ of the state (q, v) \[rad/s\].
    fn rate(&self, numbering: &Numbering, (q, v): (&[S], &[S])) -> f64 {
        let real = self.map(&mut |x| x.re());
        let motion = |body| {
            let p = orientation(numbering, q, body).map(|x| x.re());
            let omega = BodyMotion::of(numbering, body, q, v).omega.map(|x| x.re());
            (p, rotation::rates(&p, &omega))
        };
        let (p, rate) = motion(self.body);
        let (seen, rate) = match self.relative_to {
            Some(other) => {
                let (p_other, rate_other) = motion(other);
                let ahead = compose(&conjugate(&p_other), &rate);
                let back = compose(&conjugate(&rate_other), &p);
                let rate = std::array::from_fn(|i| ahead[i] + back[i]);
                (compose(&conjugate(&p_other), &p), rate)
            }
            None => (p, rate),
        };
        let (turned, rate) = match &real.placed {
            Some(placed) => (compose(&seen, placed), compose(&rate, placed)),
            None => (seen, rate),
        };
        let slope = rotation::twist_derivative(&turned, &real.axis).0;
        slope.iter().zip(&rate).map(|(a, b)| a * b).sum()
    }

    /// Calls `visit` with both bodies.
    pub fn for_each_body(&mut self, visit: &mut impl FnMut(&mut usize)) {
        visit(&mut self.body);
        if let Some(other) = &mut self.relative_to {
            visit(other);
        }
    }
}

impl Rotation<f64> {
    fn derivative(&self, numbering: &Numbering, q: &[f64]) -> ByRotation {
        let p = orientation(numbering, q, self.body);
        let other = self.relative_to.map(|body| orientation(numbering, q, body));
        let seen = other.map_or(p, |other| compose(&conjugate(&other), &p));
        let turned = self.placed.map_or(seen, |placed| compose(&seen, &placed));
        let (by_turned, axis) = rotation::twist_derivative(&turned, &self.axis);
        // The cotangents of a b are ȳ b* for a, and a* ȳ for b.
        let by_seen = match &self.placed {
            Some(placed) => compose(&by_turned, &conjugate(placed)),
            None => by_turned,
        };
        let tangent = |p: &Quat<f64>, by: &Quat<f64>| rotation::rate_product(p, by) * 0.5;
        let (by_p, theta_other) = match &other {
            Some(other) => {
                let by_other = conjugate(&compose(&by_seen, &conjugate(&p)));
                (compose(other, &by_seen), tangent(other, &by_other))
            }
            None => (by_seen, Vec3::zeros()),
        };
        ByRotation {
            theta: tangent(&p, &by_p),
            theta_other,
            axis,
            placed: compose(&conjugate(&seen), &by_turned),
        }
    }

    /// Adds another cotangent of the parameters.
    pub fn add(&mut self, other: &Self) {
        self.axis += other.axis;
        for (own, by) in self.placed.iter_mut().zip(&other.placed) {
            for (own, by) in own.iter_mut().zip(by) {
                *own += by;
            }
        }
    }

    /// Adds `weight` times the derivative of [`Rotation::angle`] to the cotangents of the tangent
    /// positions, `y` in velocity numbering, and of this rotation's parameters.
    pub fn pull_back(
        &self,
        (numbering, q): (&Numbering, &[f64]),
        weight: f64,
        y: &mut [f64],
        own: &mut Self,
    ) {
        let by = self.derivative(numbering, q);
        let zero = Vec3::zeros();
        let at = numbering.velocity(self.body);
        add6(&mut y[at..], &zero, &(by.theta * weight));
        if let Some(other) = self.relative_to {
            let at = numbering.velocity(other);
            add6(&mut y[at..], &zero, &(by.theta_other * weight));
        }
        own.axis += by.axis * weight;
        if let Some(own) = &mut own.placed {
            for (own, by) in own.iter_mut().zip(by.placed) {
                *own += by * weight;
            }
        }
    }
}

/// Euler parameters of a body.
fn orientation<S: Scalar>(numbering: &Numbering, q: &[S], body: usize) -> Quat<S> {
    positions_of(&q[numbering.position(body)..]).1
}

/// The multiple of 2π nearest to an angle.
pub fn whole_turns(angle: f64) -> f64 {
    TAU * (angle / TAU).round()
}

/// Multiples of 2π that make a rotation continuous over a run; one per sample.
///
/// If the rates at two samples differ by less than half a turn over the time between them, the
/// rotation advances by their mean, with any number of turns. Otherwise it goes to the nearest
/// angle.
pub fn turns<S: Scalar>(watched: Option<&Rotation<S>>, run: &Trajectory<S>) -> Option<Vec<f64>> {
    let watched = watched?;
    let mut before: Option<[f64; 3]> = None;
    let all = (0..=run.last()).map(|k| {
        let twist = watched.angle(&run.numbering, run.q(k)).re();
        let rate = watched.rate(&run.numbering, (run.q(k), run.v(k)));
        let time = run.time(k).re();
        let turns = match before {
            None => watched.first_turns(twist),
            Some([angle, rate_before, time_before]) => {
                let h = time - time_before;
                let expected = match (rate - rate_before).abs() * h < PI {
                    true => angle + 0.5 * (rate + rate_before) * h,
                    false => angle,
                };
                whole_turns(expected - twist)
            }
        };
        before = Some([twist + turns, rate, time]);
        turns
    });
    Some(all.collect())
}
