//! The limits of a motor: the equations of [`crate::model::controller`], with their derivatives.

use crate::math::Scalar;
use crate::model::controller::Limits;

/// An effort within the limits, and its derivatives.
pub(super) struct Limited<S> {
    /// s.
    pub effort: S,
    /// In the demand u.
    pub by_demand: S,
    /// In the rate ẋ.
    pub by_rate: S,
    /// In the ratio, the largest effort, the stall torque and the no-load speed, and the power.
    pub by_limits: Limits<S>,
}

/// The part (1 + z⁸)^(−1/8) of z that is left, and its derivative; σ(z) and its derivative.
fn saturation<S: Scalar>(z: S) -> ([S; 2], [S; 2]) {
    let one = S::one();
    // By the reciprocal beyond 1, so that no power overflows.
    let small = z.re().abs() <= 1.0;
    let base = if small { z } else { one / z };
    let second = base * base;
    let fourth = second * second;
    let eighth = one + fourth * fourth;
    let root = one / eighth.sqrt().sqrt().sqrt();
    let slope = root / eighth;
    if small {
        let part = [root, -(fourth * second * base * slope)];
        return (part, [z * root, slope]);
    }
    let sign = S::from(z.re().signum());
    let part = [base * sign * root, -(second * sign * slope)];
    (part, [sign * root, fourth * fourth * base * sign * slope])
}

/// The effort of a motor for the demand u at the rate ẋ of what it drives.
pub(super) fn limited<S: Scalar>(limits: &Limits<S>, demand: S, rate: S) -> Limited<S> {
    let n = limits.ratio;
    let mut out = Limited {
        effort: demand,
        by_demand: S::one(),
        by_rate: S::zero(),
        by_limits: Limits {
            ratio: S::zero(),
            effort: None,
            line: None,
            power: None,
        },
    };
    if let Some(most) = limits.effort {
        let bound = n * most;
        let z = demand / bound;
        let (_, [value, slope]) = saturation(z);
        let by_bound = value - slope * z;
        out.effort = bound * value;
        out.by_demand = slope;
        out.by_limits.ratio = by_bound * most;
        out.by_limits.effort = Some(by_bound * n);
    }
    if let Some([stall, fastest]) = limits.line {
        let (most, speed) = (n * stall, rate * n / fastest);
        let z = out.effort / most;
        let (_, [value, slope]) = saturation(z + speed);
        let by_most = value - speed - slope * z;
        let by_speed = most * (slope - S::one());
        out.effort = most * (value - speed);
        out.scale(slope);
        out.by_rate += by_speed * n / fastest;
        out.by_limits.ratio += by_most * stall + by_speed * rate / fastest;
        out.by_limits.line = Some([by_most * n, -(by_speed * speed / fastest)]);
    }
    if let Some(power) = limits.power {
        let effort = out.effort;
        let z = effort * rate / power;
        let ([part, by_z], [_, slope]) = saturation(z);
        out.effort = effort * part;
        out.scale(slope);
        out.by_rate += effort * by_z * effort / power;
        out.by_limits.power = Some(-(effort * by_z * z / power));
    }
    out
}

/// The demand for which a motor at rest has an effort; `None` if its limits do not allow it.
pub(super) fn demand<S: Scalar>(limits: &Limits<S>, effort: S) -> Option<S> {
    let n = limits.ratio;
    let before = |effort: S, most: S| {
        let w = effort / (n * most);
        let square = w * w;
        let eighth = square * square * square * square;
        let root = (S::one() - eighth).sqrt().sqrt().sqrt();
        (w.re().abs() < 1.0).then(|| effort / root)
    };
    let mut demand = effort;
    if let Some([stall, _]) = limits.line {
        demand = before(demand, stall)?;
    }
    match limits.effort {
        Some(most) => before(demand, most),
        None => Some(demand),
    }
}

impl<S: Scalar> Limited<S> {
    /// Multiplies all derivatives by that of a limit behind them.
    fn scale(&mut self, by: S) {
        let own = &mut self.by_limits;
        let line = own.line.iter_mut().flatten();
        let some = own.effort.iter_mut().chain(line).chain(&mut own.power);
        let all = [&mut self.by_demand, &mut self.by_rate, &mut own.ratio];
        all.into_iter().chain(some).for_each(|x| *x *= by);
    }
}

/// Adds the derivatives times a cotangent of the effort.
pub(super) fn give(limited: &Limited<f64>, effort: f64, own: &mut Limits<f64>) {
    let by = &limited.by_limits;
    own.ratio += by.ratio * effort;
    if let (Some(own), Some(by)) = (&mut own.effort, by.effort) {
        *own += by * effort;
    }
    if let (Some(own), Some(by)) = (&mut own.line, by.line) {
        own[0] += by[0] * effort;
        own[1] += by[1] * effort;
    }
    if let (Some(own), Some(by)) = (&mut own.power, by.power) {
        *own += by * effort;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Parameters;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};

    fn all() -> Vec<Limits<f64>> {
        let mut found = Vec::new();
        for bits in 0..8 {
            found.push(Limits {
                ratio: 1.7,
                effort: (bits & 1 > 0).then_some(2.0),
                line: (bits & 2 > 0).then_some([3.0, 5.0]),
                power: (bits & 4 > 0).then_some(4.0),
            });
        }
        found
    }

    #[test]
    fn derivatives_are_those_of_the_complex_step() {
        for limits in all() {
            for (demand, rate) in [
                (0.3, 0.2),
                (-2.9, 1.4),
                (3.4, -2.0),
                (40.0, 2.7),
                (1e9, 0.0),
            ] {
                let found = limited(&limits, demand, rate);
                let mut given = vec![found.by_demand, found.by_rate];
                let mut own = limits.map(&mut |_| 0.0);
                give(&found, 1.0, &mut own);
                own.map(&mut |x| {
                    given.push(x);
                    x
                });
                for (wanted, given) in given.iter().enumerate() {
                    let step = |i: usize| if i == wanted { COMPLEX_STEP } else { 0.0 };
                    let mut i = 1;
                    let moved = limits.map(&mut |x| {
                        i += 1;
                        Complex64::new(x, step(i))
                    });
                    let inputs = [
                        Complex64::new(demand, step(0)),
                        Complex64::new(rate, step(1)),
                    ];
                    let exact = limited(&moved, inputs[0], inputs[1]).effort.im / COMPLEX_STEP;
                    // Terms of the size of the effort may cancel.
                    let near = (given - exact).abs() <= 1e-12 * exact.abs().max(0.1);
                    assert!(near, "{limits:?} {demand} {rate} {wanted}: {given} {exact}");
                }
            }
        }
    }

    #[test]
    fn the_demand_at_rest_has_the_effort() {
        for limits in all() {
            for effort in [-3.1, 0.2, 3.2] {
                let demand = demand(&limits, effort).expect("within the limits");
                let found = limited(&limits, demand, 0.0).effort;
                assert!((found - effort).abs() < 1e-12, "{limits:?}: {found}");
            }
            let limited = limits.effort.is_some() || limits.line.is_some();
            assert_eq!(demand(&limits, 5.2).is_none(), limited);
        }
    }

    #[test]
    fn limits_hold_and_leave_small_demands_alone() {
        for limits in all() {
            let small = limited(&limits, 0.1, 0.0).effort;
            assert!((small - 0.1).abs() < 1e-9, "{small}");
            for rate in [-2.0, 0.0, 2.5] {
                for demand in [-1e6, -4.0, 4.0, 1e6] {
                    let effort = limited(&limits, demand, rate).effort;
                    let speed = rate * 1.7 / 5.0;
                    if limits.line.is_some() {
                        assert!(effort <= 5.1 * (1.0 - speed) + 1e-12, "{effort} at {rate}");
                        assert!(effort >= -5.1 * (1.0 + speed) - 1e-12, "{effort} at {rate}");
                    } else if limits.effort.is_some() {
                        assert!(effort.abs() <= 3.4 + 1e-12);
                    }
                    if limits.power.is_some() {
                        assert!((effort * rate).abs() <= 4.0 + 1e-12);
                    }
                }
            }
        }
    }
}
