//! Force or torque as a function of time: constant, harmonic or tabulated.
//!
//! ```text
//! constant   m(t) = m
//! harmonic   m(t) = A sin(2π f t + φ)
//! table      m(t) = interpolation between (t_i, m_i), see [`super::table`]; constant outside
//! ```

use super::table::{Bracket, Interpolation, around, by_points, interval, magnitude};
use crate::math::Scalar;
use crate::math::scalar::Dual;
use std::f64::consts::TAU;

/// A magnitude as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TimeFunction<S> {
    /// Constant \[N or N m\].
    Constant(S),
    /// Sine of time.
    Harmonic {
        /// Amplitude A \[N or N m\].
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
        /// Values m_i \[N or N m\]; length of `times`.
        values: Vec<S>,
        /// Interpolation between the values.
        interpolation: Interpolation,
    },
}

impl<S: Scalar> TimeFunction<S> {
    /// The function with `f` applied to every parameter.
    pub(crate) fn map<T: Scalar>(&self, f: &mut impl FnMut(S) -> T) -> TimeFunction<T> {
        match self {
            TimeFunction::Constant(value) => TimeFunction::Constant(f(*value)),
            TimeFunction::Harmonic {
                amplitude,
                frequency,
                phase,
            } => TimeFunction::Harmonic {
                amplitude: f(*amplitude),
                frequency: f(*frequency),
                phase: f(*phase),
            },
            TimeFunction::Table {
                times,
                values,
                interpolation,
            } => TimeFunction::Table {
                times: times.iter().map(|&x| f(x)).collect(),
                values: values.iter().map(|&x| f(x)).collect(),
                interpolation: *interpolation,
            },
        }
    }

    /// Value at `time` \[s\].
    pub(crate) fn value(&self, time: S) -> S {
        match self {
            TimeFunction::Constant(value) => *value,
            TimeFunction::Harmonic {
                amplitude,
                frequency,
                phase,
            } => harmonic([*amplitude, *frequency, *phase], time),
            TimeFunction::Table {
                times,
                values,
                interpolation,
            } => match interval(times, time.re()) {
                Bracket::Before => values[0],
                Bracket::After => values[values.len() - 1],
                Bracket::Inside(k) => {
                    let (times, values) = (around(times, k), around(values, k));
                    magnitude(*interpolation, &times, &values, time)
                }
            },
        }
    }
}

impl TimeFunction<f64> {
    /// Adds `weight` times the derivatives of [`TimeFunction::value`] to those in the parameters
    /// (`own`, of the same variant) and in the time.
    pub(crate) fn pull_back(
        &self,
        time: f64,
        weight: f64,
        own: &mut TimeFunction<f64>,
        time_bar: &mut f64,
    ) {
        match (self, own) {
            (TimeFunction::Constant(_), TimeFunction::Constant(own)) => *own += weight,
            (
                TimeFunction::Harmonic {
                    amplitude,
                    frequency,
                    phase,
                },
                TimeFunction::Harmonic {
                    amplitude: by_amplitude,
                    frequency: by_frequency,
                    phase: by_phase,
                },
            ) => {
                let (sine, cosine) = (TAU * frequency * time + phase).sin_cos();
                *by_amplitude += weight * sine;
                *by_frequency += weight * amplitude * cosine * TAU * time;
                *by_phase += weight * amplitude * cosine;
                *time_bar += weight * amplitude * cosine * TAU * frequency;
            }
            (
                TimeFunction::Table {
                    times,
                    values,
                    interpolation,
                },
                TimeFunction::Table {
                    times: by_times,
                    values: by_values,
                    ..
                },
            ) => match interval(times, time) {
                Bracket::Before => by_values[0] += weight,
                Bracket::After => *by_values.last_mut().expect("a table has values") += weight,
                Bracket::Inside(k) => {
                    let lists = (&times[..], &values[..]);
                    by_points(k, lists, (by_times, by_values), |t, m| {
                        weight * magnitude(*interpolation, t, m, time.into()).du
                    });
                    let lift = |list: &[f64]| around(list, k).map(|x| x.map(Dual::from));
                    let now = Dual::new(time, 1.0);
                    let at = magnitude(*interpolation, &lift(times), &lift(values), now);
                    *time_bar += weight * at.du;
                }
            },
            _ => unreachable!("a cotangent has the kind of its course"),
        }
    }
}

fn harmonic<S: Scalar>([amplitude, frequency, phase]: [S; 3], time: S) -> S {
    amplitude * (frequency * time * TAU + phase).sin_cos().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};

    fn table(interpolation: Interpolation) -> TimeFunction<f64> {
        TimeFunction::Table {
            times: vec![0.0, 0.5, 0.8, 1.5, 2.0, 2.5],
            values: vec![1.0, 2.0, 5.0, 5.5, 4.0, 4.0],
            interpolation,
        }
    }

    const ALL: [Interpolation; 3] = [
        Interpolation::Linear,
        Interpolation::Monotone,
        Interpolation::Spline,
    ];

    #[test]
    fn a_table_meets_its_points_and_stays_between_them() {
        for interpolation in ALL {
            let course = table(interpolation);
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
            let course = table(interpolation).map(&mut Complex64::from);
            let rate = |t: f64| course.value(Complex64::new(t, COMPLEX_STEP)).im / COMPLEX_STEP;
            for t in [0.0, 0.5, 0.8, 1.5, 2.0, 2.5] {
                assert!((rate(t + 1e-9) - rate(t - 1e-9)).abs() < 1e-6, "at {t}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_complex_step() {
        let harmonic = TimeFunction::Harmonic {
            amplitude: 3.0,
            frequency: 0.7,
            phase: 0.4,
        };
        let [linear, monotone, spline] = ALL.map(table);
        for course in [
            TimeFunction::Constant(2.0),
            harmonic,
            linear,
            monotone,
            spline,
        ] {
            for t in [-1.0, 0.2, 0.6, 1.0, 1.7, 2.2, 3.0] {
                let mut own = course.map(&mut |_| 0.0);
                let mut by_time = 0.0;
                course.pull_back(t, 1.0, &mut own, &mut by_time);
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
                    let exact = moved.value(Complex64::new(t, time)).im / COMPLEX_STEP;
                    assert!((given - exact).abs() <= 1e-13 * (1.0 + exact.abs()));
                }
            }
        }
    }
}
