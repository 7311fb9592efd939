//! Functions of time: magnitudes of loads, and angles and displacements that drives prescribe.
//!
//! ```text
//! polynomial   m(t) = c0 + c1 t + c2 t² + …
//! harmonic     m(t) = m + A sin(2π f t + φ)
//! table        m(t) = interpolation between (t_i, m_i), see [`super::table`]; constant outside
//! S-curve      m(t) from one value to another within a speed and an acceleration, see [`super::s_curve`]
//! ```
//!
//! Accelerations depend on the second derivative of a prescribed motion. So its tables are twice
//! continuously differentiable ([`Smoothness::Motion`]).

use super::s_curve::SCurve;
use super::table::{
    Bracket, Interpolation, Smoothness, around, by_points, interpolate, interval, polynomial,
};
use crate::math::scalar::Dual;
use crate::math::{Parameters, Scalar, parameters};
use std::f64::consts::TAU;

/// A function of time: a force \[N\], torque \[N m\], angle \[rad\] or displacement \[m\].
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction<S> {
    /// Coefficients of 1, t, t², …; at least one.
    Polynomial(Vec<S>),
    /// Harmonic function about a mean.
    Harmonic {
        /// Mean m.
        mean: S,
        /// Amplitude A.
        amplitude: S,
        /// Frequency f \[Hz\].
        frequency: S,
        /// Phase φ at t = 0 \[rad\].
        phase: S,
    },
    /// Interpolation between instants.
    Table {
        /// Instants t_i \[s\], increasing; at least two.
        times: Vec<S>,
        /// Values m_i; length of `times`.
        values: Vec<S>,
        /// Interpolation between the values.
        interpolation: Interpolation,
        /// Continuous derivatives.
        smoothness: Smoothness,
    },
    /// A way from one value to another, at rest before and after it.
    SCurve(SCurve<S>),
}

parameters!(enum TimeFunction {
    Polynomial(; coefficients),
    Harmonic {; mean, amplitude, frequency, phase },
    Table { interpolation, smoothness; times, values },
    SCurve(; curve),
});

impl<S: Scalar> TimeFunction<S> {
    /// A constant.
    pub fn constant(value: S) -> Self {
        Self::Polynomial(vec![value])
    }

    /// The same function of the time since `start` \[s\]: m(t + start).
    pub fn since(&self, start: S) -> Self {
        match self {
            Self::Polynomial(coefficients) => {
                // Taylor's polynomial there, by repeated division (Horner).
                let mut all = coefficients.clone();
                for from in 0..all.len() {
                    for k in (from..all.len() - 1).rev() {
                        let next = all[k + 1];
                        all[k] += next * start;
                    }
                }
                Self::Polynomial(all)
            }
            Self::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => Self::Harmonic {
                mean: *mean,
                amplitude: *amplitude,
                frequency: *frequency,
                phase: *phase + *frequency * start * TAU,
            },
            Self::SCurve(curve) => {
                let mut own = curve.clone();
                own.start -= start;
                Self::SCurve(own)
            }
            Self::Table {
                times,
                values,
                interpolation,
                smoothness,
            } => Self::Table {
                times: times.iter().map(|&t| t - start).collect(),
                values: values.clone(),
                interpolation: *interpolation,
                smoothness: *smoothness,
            },
        }
    }

    /// The same function and a constant: m(t) + by.
    pub fn shifted(&self, by: S) -> Self {
        let mut own = self.clone();
        match &mut own {
            Self::Polynomial(coefficients) => coefficients[0] += by,
            Self::Harmonic { mean, .. } => *mean += by,
            Self::SCurve(curve) => {
                curve.from += by;
                curve.to += by;
            }
            Self::Table { values, .. } => values.iter_mut().for_each(|value| *value += by),
        }
        own
    }

    /// Value at `time` \[s\].
    pub fn value(&self, time: S) -> S {
        self.derivatives(time)[0]
    }

    /// Value and first to third derivatives at `time` \[s\].
    pub fn derivatives(&self, time: S) -> [S; 4] {
        match self {
            Self::Polynomial(coefficients) => polynomial(coefficients, time),
            Self::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => harmonic([*mean, *amplitude, *frequency, *phase], time),
            Self::SCurve(curve) => curve.derivatives(time),
            Self::Table {
                times,
                values,
                interpolation,
                smoothness,
            } => match interval(times, time.re()) {
                Bracket::Before => held(values[0]),
                Bracket::After => held(values[values.len() - 1]),
                Bracket::Inside(k) => {
                    let (times, values) = (around(times, k), around(values, k));
                    interpolate((*interpolation, *smoothness), &times, &values, time)
                }
            },
        }
    }
}

impl TimeFunction<f64> {
    /// Adds the derivatives of w0 m + w1 ṁ + w2 m̈ at `time` in the parameters to `own`, which has
    /// the same variant. Returns the derivative in time.
    pub fn pull_back(&self, time: f64, weights: [f64; 3], own: &mut Self) -> f64 {
        let [w0, w1, w2] = weights;
        let along = |d: [Dual; 4]| w0 * d[0].du + w1 * d[1].du + w2 * d[2].du;
        let now = Dual::from(time);
        match (self, own) {
            (Self::Polynomial(coefficients), Self::Polynomial(own)) => {
                // tʲ and its derivatives.
                let mut power = [1.0, 0.0, 0.0];
                for own in own.iter_mut().take(coefficients.len()) {
                    *own += w0 * power[0] + w1 * power[1] + w2 * power[2];
                    let [p, d, dd] = power;
                    power = [p * time, d * time + p, dd * time + 2.0 * d];
                }
            }
            (
                Self::Harmonic {
                    mean,
                    amplitude,
                    frequency,
                    phase,
                },
                Self::Harmonic {
                    mean: by_mean,
                    amplitude: by_amplitude,
                    frequency: by_frequency,
                    phase: by_phase,
                },
            ) => {
                let parameters = [*mean, *amplitude, *frequency, *phase];
                let own = [by_mean, by_amplitude, by_frequency, by_phase];
                for (j, own) in own.into_iter().enumerate() {
                    let mut moved = parameters.map(Dual::from);
                    moved[j].du = 1.0;
                    *own += along(harmonic(moved, now));
                }
            }
            (Self::SCurve(curve), Self::SCurve(own)) => {
                for (j, own) in own.all_mut().into_iter().enumerate() {
                    let mut at = 0;
                    let moved = curve.map(&mut |x| {
                        at += 1;
                        Dual::new(x, if at == j + 1 { 1.0 } else { 0.0 })
                    });
                    *own += along(moved.derivatives(now));
                }
            }
            (
                Self::Table {
                    times,
                    values,
                    interpolation,
                    smoothness,
                },
                Self::Table {
                    times: by_times,
                    values: by_values,
                    ..
                },
            ) => match interval(times, time) {
                Bracket::Before => by_values[0] += w0,
                Bracket::After => *by_values.last_mut().expect("a table has values") += w0,
                Bracket::Inside(k) => {
                    let lists = (&times[..], &values[..]);
                    by_points(k, lists, (by_times, by_values), |t, m| {
                        along(interpolate((*interpolation, *smoothness), t, m, now))
                    });
                }
            },
            _ => unreachable!("a cotangent has the kind of its function"),
        }
        let [_, rate, acceleration, jerk] = self.derivatives(time);
        w0 * rate + w1 * acceleration + w2 * jerk
    }
}

fn held<S: Scalar>(value: S) -> [S; 4] {
    [value, S::zero(), S::zero(), S::zero()]
}

fn harmonic<S: Scalar>([mean, amplitude, frequency, phase]: [S; 4], time: S) -> [S; 4] {
    let omega = frequency * TAU;
    let (sine, cosine) = (omega * time + phase).sin_cos();
    let (along, across) = (amplitude * sine, amplitude * cosine);
    let square = omega * omega;
    [
        mean + along,
        across * omega,
        -along * square,
        -across * square * omega,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};
    use crate::model::table::breaks;

    fn table(interpolation: Interpolation) -> TimeFunction<f64> {
        TimeFunction::Table {
            times: vec![0.0, 0.5, 0.8, 1.5, 2.0],
            values: vec![1.0, 2.0, 5.0, 5.5, 4.0],
            interpolation,
            smoothness: Smoothness::Motion,
        }
    }

    fn magnitude(interpolation: Interpolation) -> TimeFunction<f64> {
        TimeFunction::Table {
            times: vec![0.0, 0.5, 0.8, 1.5, 2.0, 2.5],
            values: vec![1.0, 2.0, 5.0, 5.5, 4.0, 4.0],
            interpolation,
            smoothness: Smoothness::Magnitude,
        }
    }

    /// A way with a cruise between, or one that is too short for its speed.
    fn s_curve(to: f64) -> TimeFunction<f64> {
        TimeFunction::SCurve(SCurve {
            from: 0.1,
            to,
            start: 0.1,
            speed: 0.9,
            acceleration: 3.0,
        })
    }

    const ALL: [Interpolation; 3] = [
        Interpolation::Linear,
        Interpolation::Monotone,
        Interpolation::Spline,
    ];

    fn courses() -> [TimeFunction<f64>; 11] {
        let [linear, monotone, spline] = ALL.map(table);
        let [straight, cubic, quintic] = ALL.map(magnitude);
        [
            TimeFunction::constant(2.0),
            TimeFunction::Polynomial(vec![0.3, -1.2, 0.7, 0.25]),
            TimeFunction::Harmonic {
                mean: 0.2,
                amplitude: 1.3,
                frequency: 0.8,
                phase: 0.4,
            },
            linear,
            monotone,
            spline,
            straight,
            cubic,
            quintic,
            s_curve(1.3),
            s_curve(-0.2),
        ]
    }

    #[test]
    fn each_derivative_is_the_rate_of_the_one_before() {
        for course in courses() {
            let complex = course.map(&mut Complex64::from);
            for t in [-0.5, 0.02, 0.2, 0.6, 0.79, 1.0, 1.7, 2.5] {
                let exact = complex.derivatives(Complex64::new(t, COMPLEX_STEP));
                let given = course.derivatives(t);
                for k in 0..3 {
                    let rate = exact[k].im / COMPLEX_STEP;
                    assert!((rate - given[k + 1]).abs() <= 1e-12 * (1.0 + rate.abs()));
                }
            }
        }
    }

    #[test]
    fn a_function_since_an_instant_is_that_of_the_later_time() {
        for course in courses() {
            for start in [0.0, 0.37, 1.1, 2.6] {
                let later = course.since(start);
                for t in [0.02, 0.2, 0.6, 0.79, 1.7] {
                    let (given, found) = (course.derivatives(start + t), later.derivatives(t));
                    for (a, b) in given.iter().zip(found) {
                        assert!((a - b).abs() <= 1e-11 * (1.0 + a.abs()), "{course:?} {t}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_table_meets_its_points_with_continuous_curvature() {
        for interpolation in ALL {
            let course = table(interpolation);
            let TimeFunction::Table { times, values, .. } = &course else {
                unreachable!("a table")
            };
            for (&t, &m) in times.iter().zip(values) {
                assert!((course.derivatives(t)[0] - m).abs() < 1e-14);
            }
            for t in breaks(times, (interpolation, Smoothness::Motion)) {
                let (before, after) = (course.derivatives(t - 1e-9), course.derivatives(t + 1e-9));
                for k in 0..3 {
                    // The next derivative bounds the change over the 2e-9 s between them.
                    let slope = before[k + 1].abs().max(after[k + 1].abs());
                    let jump = (before[k] - after[k]).abs();
                    let near = jump < 4e-9 * slope + 1e-8;
                    assert!(near, "{interpolation:?}: derivative {k} at {t}: {jump}");
                }
            }
        }
    }

    #[test]
    fn motions_do_not_overshoot_whatever_the_table() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        for _ in 0..200 {
            // Dwells, reversals, and steps and intervals of very different sizes.
            let (mut t, mut times, mut values) = (0.0, Vec::new(), Vec::new());
            for _ in 0..8 {
                times.push(t);
                t += 10_f64.powf(-2.0 * random());
                let step = 10_f64.powf(-3.0 * random());
                let last = values.last().copied().unwrap_or(0.0);
                values.push(match (random() * 4.0) as usize {
                    0 => last,
                    1 => last - step,
                    _ => last + step,
                });
            }
            for interpolation in [Interpolation::Linear, Interpolation::Monotone] {
                let (times, values) = (times.clone(), values.clone());
                let course = TimeFunction::Table {
                    times: times.clone(),
                    values: values.clone(),
                    interpolation,
                    smoothness: Smoothness::Motion,
                };
                for (t, m) in times.windows(2).zip(values.windows(2)) {
                    let mut before = m[0];
                    for i in 0..=200 {
                        let at = t[0] + (t[1] - t[0]) * f64::from(i) / 200.0;
                        let x = course.derivatives(at.min(t[1]))[0];
                        // Monotone: the motion stays between the values.
                        let way = (x - before) * (m[1] - m[0]).signum();
                        let flat = m[1] == m[0] && (x - before).abs() > 1e-13;
                        assert!(
                            way >= -1e-13 && !flat,
                            "{interpolation:?} at {at}: {times:?} {values:?}"
                        );
                        before = x;
                    }
                }
            }
        }
    }

    #[test]
    fn a_monotone_table_of_a_smooth_motion_is_near_it() {
        let times: Vec<f64> = (0..=20).map(|i| 0.05 * f64::from(i)).collect();
        let values: Vec<f64> = times.iter().map(|t| (1.5 * t).sin()).collect();
        let interpolation = Interpolation::Monotone;
        let course = TimeFunction::Table {
            times,
            values,
            interpolation,
            smoothness: Smoothness::Motion,
        };
        // The mean of power −4 of two quotients is below their mean by 5/8 of their squared
        // difference over it; that mean misses the slope by h²/6 of the third derivative.
        // Curvatures by neighbours err by at most h times that. Values between err by h/4 times the
        // error of the slopes plus 0.035 h² times that of the curvatures, rates by twice that of
        // the slopes. This holds away from the ends, where the motion starts at rest.
        let (h, third) = (0.05, 1.5_f64.powi(3));
        for i in 0..100 {
            let t = 0.1 + 0.008 * f64::from(i);
            let [x, rate, ..] = course.derivatives(t);
            let (sin, cos) = (1.5 * (t + h)).sin_cos();
            let slope = h * h * third / 6.0 + 0.625 * (2.25 * h * sin).powi(2) / (1.5 * cos);
            let value = 0.25 * h * slope + 0.035 * h.powi(3) * third;
            assert!((x - (1.5 * t).sin()).abs() < value, "{x} at {t}");
            let away = (rate - 1.5 * (1.5 * t).cos()).abs();
            assert!(away < 2.0 * slope, "{rate} at {t}");
        }
    }

    #[test]
    fn derivatives_by_parameters_are_those_of_the_complex_step() {
        let weights = [0.7, -1.1, 0.4];
        for course in courses() {
            for t in [-0.5, 0.02, 0.2, 0.6, 0.79, 1.0, 1.7, 2.5] {
                let mut own = course.map(&mut |_| 0.0);
                let by_time = course.pull_back(t, weights, &mut own);
                let mut given = vec![by_time];
                own.map(&mut |x| {
                    given.push(x);
                    x
                });
                for (wanted, given) in given.iter().enumerate() {
                    let mut i = 0;
                    let moved = course.map(&mut |x| {
                        i += 1;
                        Complex64::new(x, if i == wanted { COMPLEX_STEP } else { 0.0 })
                    });
                    let time = if wanted == 0 { COMPLEX_STEP } else { 0.0 };
                    let at = moved.derivatives(Complex64::new(t, time));
                    let exact: f64 = (0..3).map(|k| weights[k] * at[k].im / COMPLEX_STEP).sum();
                    assert!((given - exact).abs() <= 1e-12 * (1.0 + exact.abs()));
                }
            }
        }
    }

    #[test]
    fn a_table_meets_its_points_and_stays_between_them() {
        for interpolation in ALL {
            let course = magnitude(interpolation);
            let TimeFunction::Table { times, values, .. } = &course else {
                unreachable!()
            };
            for (t, m) in times.iter().zip(values) {
                assert!((course.value(*t) - m).abs() < 1e-14);
            }
            assert_eq!((course.value(-3.0), course.value(9.0)), (1.0, 4.0));
            if interpolation == Interpolation::Spline {
                continue;
            }
            for (t, m) in times.windows(2).zip(values.windows(2)) {
                for i in 0..=100 {
                    let x = course.value(t[0] + (t[1] - t[0]) * f64::from(i) / 100.0);
                    assert!(x >= m[0].min(m[1]) - 1e-14 && x <= m[0].max(m[1]) + 1e-14);
                }
            }
        }
    }

    #[test]
    fn the_rate_of_a_smooth_table_is_continuous() {
        for interpolation in [Interpolation::Monotone, Interpolation::Spline] {
            let course = magnitude(interpolation).map(&mut Complex64::from);
            let rate = |t: f64| course.value(Complex64::new(t, COMPLEX_STEP)).im / COMPLEX_STEP;
            for t in [0.0, 0.5, 0.8, 1.5, 2.0, 2.5] {
                assert!((rate(t + 1e-9) - rate(t - 1e-9)).abs() < 1e-6, "at {t}");
            }
        }
    }
}
