//! The course of a force or torque in time: constant, harmonic or tabulated.
//!
//! ```text
//! constant   m(t) = m
//! harmonic   m(t) = A sin(2π f t + φ)
//! table      m(t) = cubic Hermite interpolation between (t_i, m_i)
//! ```
//!
//! The slopes of a table are weighted harmonic means of the neighbouring differences, zero where
//! these change sign (Fritsch & Butland 1984, *SIAM J. Sci. Stat. Comput.* 5(2), 300–304), so the
//! course never overshoots its values. It is level at both ends and held beyond them, so it is
//! once continuously differentiable at all times.

use crate::math::Scalar;
use crate::math::scalar::Dual;
use std::f64::consts::TAU;

/// A magnitude as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Course<S> {
    /// The same at all times (N or N m).
    Constant(S),
    /// A sine of time.
    Harmonic {
        /// Amplitude A (N or N m).
        amplitude: S,
        /// Frequency f (Hz).
        frequency: S,
        /// Phase φ at t = 0 (rad).
        phase: S,
    },
    /// Interpolated between instants.
    Table {
        /// Instants t_i, increasing (s); at least two.
        times: Vec<S>,
        /// Values m_i, as many (N or N m).
        values: Vec<S>,
    },
}

impl<S: Scalar> Course<S> {
    /// The course with every parameter replaced by `f` of it.
    pub fn map<T: Scalar>(&self, f: &mut impl FnMut(S) -> T) -> Course<T> {
        match self {
            Course::Constant(value) => Course::Constant(f(*value)),
            Course::Harmonic {
                amplitude,
                frequency,
                phase,
            } => Course::Harmonic {
                amplitude: f(*amplitude),
                frequency: f(*frequency),
                phase: f(*phase),
            },
            Course::Table { times, values } => Course::Table {
                times: times.iter().map(|&x| f(x)).collect(),
                values: values.iter().map(|&x| f(x)).collect(),
            },
        }
    }

    /// Value at `time` (s).
    pub fn value(&self, time: S) -> S {
        match self {
            Course::Constant(value) => *value,
            Course::Harmonic {
                amplitude,
                frequency,
                phase,
            } => harmonic([*amplitude, *frequency, *phase], time),
            Course::Table { times, values } => match interval(times, time.re()) {
                Place::Before => values[0],
                Place::After => values[values.len() - 1],
                Place::Inside(k) => {
                    let at = stencil(k, times.len());
                    let pick = |list: &[S]| at.map(|i| i.map(|i| list[i]));
                    hermite(&pick(times), &pick(values), time)
                }
            },
        }
    }
}

impl Course<f64> {
    /// Adds `weight` times the derivatives of [`Course::value`] to those in the parameters, `own`
    /// (of the same kind), and in the time.
    pub fn pull_back(&self, time: f64, weight: f64, own: &mut Course<f64>, time_bar: &mut f64) {
        match (self, own) {
            (Course::Constant(_), Course::Constant(own)) => *own += weight,
            (
                Course::Harmonic {
                    amplitude,
                    frequency,
                    phase,
                },
                Course::Harmonic {
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
                Course::Table { times, values },
                Course::Table {
                    times: by_times,
                    values: by_values,
                },
            ) => match interval(times, time) {
                Place::Before => by_values[0] += weight,
                Place::After => *by_values.last_mut().expect("a table has values") += weight,
                Place::Inside(k) => {
                    let lists = (&times[..], &values[..]);
                    by_points(k, lists, (by_times, by_values), |t, m| {
                        weight * hermite(t, m, time.into()).du
                    });
                    let at = stencil(k, times.len());
                    let pick = |list: &[f64]| at.map(|i| i.map(|i| Dual::from(list[i])));
                    let now = Dual::new(time, 1.0);
                    *time_bar += weight * hermite(&pick(times), &pick(values), now).du;
                }
            },
            _ => unreachable!("a cotangent has the kind of its course"),
        }
    }
}

fn harmonic<S: Scalar>([amplitude, frequency, phase]: [S; 3], time: S) -> S {
    amplitude * (frequency * time * TAU + phase).sin_cos().0
}

/// Where a time lies in a table.
pub(super) enum Place {
    Before,
    /// Between the instants k and k + 1.
    Inside(usize),
    After,
}

pub(super) fn interval<S: Scalar>(times: &[S], time: f64) -> Place {
    match times.partition_point(|t| t.re() <= time) {
        0 => Place::Before,
        after if after == times.len() => Place::After,
        after => Place::Inside(after - 1),
    }
}

/// The points k − 1 … k + 2, as far as there are any.
pub(super) fn stencil(k: usize, count: usize) -> [Option<usize>; 4] {
    let there = |i: Option<usize>| i.filter(|&i| i < count);
    [k.checked_sub(1), Some(k), Some(k + 1), there(Some(k + 2))]
}

/// The points around a time, as far as there are any: their instants or their values.
pub(super) type Around = [Option<Dual>; 4];

/// Adds the derivatives of an interpolation between the instants k and k + 1 by instants and values:
/// it depends on four points at most, so that of `slope` by dual numbers, one number at a time.
pub(super) fn by_points(
    k: usize,
    (times, values): (&[f64], &[f64]),
    (by_times, by_values): (&mut [f64], &mut [f64]),
    slope: impl Fn(&Around, &Around) -> f64,
) {
    let at = stencil(k, times.len());
    let pick = |list: &[f64]| at.map(|i| i.map(|i| Dual::from(list[i])));
    let (t, m) = (pick(times), pick(values));
    let moved = |list: &Around, j: usize| {
        let mut list = *list;
        list[j] = list[j].map(|x| Dual::new(x.re, 1.0));
        list
    };
    for (j, i) in at.iter().enumerate() {
        let Some(i) = *i else { continue };
        by_times[i] += slope(&moved(&t, j), &m);
        by_values[i] += slope(&t, &moved(&m, j));
    }
}

/// Cubic Hermite interpolation between the two middle points.
fn hermite<S: Scalar>(times: &[Option<S>; 4], values: &[Option<S>; 4], time: S) -> S {
    let point = |i: usize| times[i].zip(values[i]);
    let (Some((t0, m0)), Some((t1, m1))) = (point(1), point(2)) else {
        unreachable!("the two points around a time are in the table");
    };
    let width = t1 - t0;
    let middle = (m1 - m0) / width;
    let slope0 = point(0).map_or(S::zero(), |(t, m)| {
        slope((t0 - t, (m0 - m) / (t0 - t)), (width, middle))
    });
    let slope1 = point(3).map_or(S::zero(), |(t, m)| {
        slope((width, middle), (t - t1, (m - m1) / (t - t1)))
    });
    let x = (time - t0) / width;
    let curve = |end: S| x * (S::one() - x) * end;
    // Linear part, and the departure of the slopes from it.
    m0 + (m1 - m0) * x + curve((slope0 - middle) * (S::one() - x) - (slope1 - middle) * x) * width
}

/// Slope at a point between two intervals, each (width, difference quotient).
fn slope<S: Scalar>((w0, d0): (S, S), (w1, d1): (S, S)) -> S {
    if d0.re() * d1.re() <= 0.0 {
        return S::zero();
    }
    let (a, b) = (w0 + w1 * 2.0, w0 * 2.0 + w1);
    (a + b) / (a / d0 + b / d1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};

    fn table() -> Course<f64> {
        Course::Table {
            times: vec![0.0, 0.5, 0.8, 1.5, 2.0, 2.5],
            values: vec![1.0, 2.0, 5.0, 5.5, 4.0, 4.0],
        }
    }

    #[test]
    fn a_table_meets_its_points_and_stays_between_them() {
        let course = table();
        let Course::Table { times, values } = &course else {
            unreachable!()
        };
        for (t, m) in times.iter().zip(values) {
            assert!((course.value(*t) - m).abs() < 1e-14);
        }
        for (t, m) in times.windows(2).zip(values.windows(2)) {
            for i in 0..=100 {
                let x = course.value(t[0] + (t[1] - t[0]) * f64::from(i) / 100.0);
                assert!(x >= m[0].min(m[1]) - 1e-14 && x <= m[0].max(m[1]) + 1e-14);
            }
        }
        assert_eq!((course.value(-3.0), course.value(9.0)), (1.0, 4.0));
    }

    #[test]
    fn the_rate_of_a_table_is_continuous() {
        let course = table().map(&mut Complex64::from);
        let rate = |t: f64| course.value(Complex64::new(t, COMPLEX_STEP)).im / COMPLEX_STEP;
        for t in [0.0, 0.5, 0.8, 1.5, 2.0, 2.5] {
            assert!((rate(t + 1e-9) - rate(t - 1e-9)).abs() < 1e-6, "at {t}");
        }
    }

    #[test]
    fn derivatives_are_those_of_the_complex_step() {
        let harmonic = Course::Harmonic {
            amplitude: 3.0,
            frequency: 0.7,
            phase: 0.4,
        };
        for course in [Course::Constant(2.0), harmonic, table()] {
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
