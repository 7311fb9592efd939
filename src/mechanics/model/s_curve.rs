//! A way from one value to another within a speed and an acceleration, as of a servo: an S-curve.
//!
//! ```text
//! ẍ = ± A sin²(π τ / T)        while it starts and while it stops, both of duration T = 2 v / A
//! ẋ = ± v                      between, if the way is longer than v T
//! ```
//!
//! The speed v is the given one, or √(A D / 2) if the way D is too short for it. Position, speed, acceleration and jerk are
//! continuous. All instants follow from the numbers, so they have derivatives.

use crate::math::{Scalar, parameters};
use std::f64::consts::PI;

/// A way within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct SCurve<S> {
    /// Value before the way.
    pub from: S,
    /// Value behind it, another one.
    pub to: S,
    /// Instant of the start \[s\].
    pub start: S,
    /// Largest speed.
    pub speed: S,
    /// Largest acceleration A.
    pub acceleration: S,
}

parameters!(struct SCurve {; from, to, start, speed, acceleration });

impl<S: Scalar> SCurve<S> {
    /// Size of the way, speed, duration of a change of speed, and of the whole.
    fn course(&self) -> [S; 4] {
        let sign = (self.to - self.from).re().signum();
        let size = (self.to - self.from) * sign;
        let a = self.acceleration;
        let own = self.speed;
        let speed = match (own * own * 2.0).re() <= (size * a).re() {
            true => own,
            false => (size * a * 0.5).sqrt(),
        };
        let change = speed * 2.0 / a;
        [size, speed, change, size / speed + change]
    }

    /// Instants at which its formula changes \[s\].
    pub fn breaks(&self) -> [f64; 4] {
        let [_, _, change, whole] = self.course();
        let at = |x: S| (self.start + x).re();
        [at(S::zero()), at(change), at(whole - change), at(whole)]
    }

    /// Value and first to third derivatives at `time` \[s\].
    pub fn derivatives(&self, time: S) -> [S; 4] {
        let [size, speed, change, whole] = self.course();
        let sign = (self.to - self.from).re().signum();
        let t = time - self.start;
        let left = whole - t;
        let held = |x: S| [x, S::zero(), S::zero(), S::zero()];
        if t.re() <= 0.0 {
            return held(self.from);
        }
        if left.re() <= 0.0 {
            return held(self.to);
        }
        let [x, v, a, jerk] = if t.re() < change.re() {
            self.rising(t, change)
        } else if left.re() < change.re() {
            let [x, v, a, jerk] = self.rising(left, change);
            [size - x, v, -a, jerk]
        } else {
            let x = speed * (t - change * 0.5);
            [x, speed, S::zero(), S::zero()]
        };
        [self.from + x * sign, v * sign, a * sign, jerk * sign]
    }

    /// The way since the start while the speed rises.
    fn rising(&self, t: S, change: S) -> [S; 4] {
        let half = self.acceleration * 0.5;
        let rate = S::from(2.0 * PI) / change;
        let (sine, cosine) = (rate * t).sin_cos();
        let one = S::one();
        [
            half * (t * t * 0.5 + (cosine - one) / (rate * rate)),
            half * (t - sine / rate),
            half * (one - cosine),
            half * rate * sine,
        ]
    }
}

impl SCurve<f64> {
    /// All its numbers, in the order of their list.
    pub fn all_mut(&mut self) -> [&mut f64; 5] {
        [
            &mut self.from,
            &mut self.to,
            &mut self.start,
            &mut self.speed,
            &mut self.acceleration,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_arrives_within_its_limits() {
        for (to, top) in [(1.3, 0.9), (-1.0, 0.9), (0.2, (3.0_f64 * 0.1 / 2.0).sqrt())] {
            let curve = SCurve {
                from: 0.1,
                to,
                start: 0.2,
                speed: 0.9,
                acceleration: 3.0,
            };
            let [first, .., last] = curve.breaks();
            assert_eq!(
                (
                    curve.derivatives(first)[0],
                    curve.derivatives(last + 1.0)[0]
                ),
                (0.1, to)
            );
            let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
            let mut before = curve.derivatives(0.0);
            for i in 1..=4000 {
                let now = curve.derivatives(f64::from(i) * 5e-4);
                speed = speed.max(now[1].abs());
                acceleration = acceleration.max(now[2].abs());
                for k in 0..3 {
                    assert!(
                        (now[k] - before[k]).abs() < 0.05,
                        "derivative {k} jumps at {i}"
                    );
                }
                before = now;
            }
            assert!((speed - top).abs() < 1e-4 && (acceleration - 3.0).abs() < 1e-3);
        }
    }
}
