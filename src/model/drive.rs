//! Prescribed motions of joints.
//!
//! A drive turns or shifts the joint's frame on body B by a course in time, about or along e3, and
//! adds the row that makes body A follow it (see [`super::joint`]):
//!
//! ```text
//! turn    e1(t) = e1 cos φ(t) + e2 sin φ(t),   e2(t) = e2 cos φ(t) − e1 sin φ(t)
//! slide   s(t)  = s + σ(t) e3
//! ```
//!
//! φ is thus the angle and σ the displacement of body A relative to body B from the placement. The
//! courses are twice continuously differentiable:
//!
//! ```text
//! polynomial   c0 + c1 t + c2 t² + …
//! harmonic     m + A sin(2π f t + φ0)
//! table        quintic Hermite interpolation between (t_i, m_i)
//! ```
//!
//! Slope and curvature at a point of a table are those of the parabola through it and its
//! neighbours; both are zero at its ends, beyond which it is held.

use super::course::{Place, by_points, interval, stencil};
use super::joint::Freedom;
use crate::math::Scalar;
use crate::math::scalar::Dual;
use std::f64::consts::TAU;

/// The prescribed motion of a joint along or about its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive<S> {
    /// Which motion.
    pub freedom: Freedom,
    /// Angle (rad) or displacement (m) in time.
    pub course: MotionCourse<S>,
}

/// An angle or displacement as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionCourse<S> {
    /// Coefficients of 1, t, t², …; at least one.
    Polynomial(Vec<S>),
    /// A sine of time about a mean.
    Harmonic {
        /// Mean m.
        mean: S,
        /// Amplitude A.
        amplitude: S,
        /// Frequency f (Hz).
        frequency: S,
        /// Phase φ0 at t = 0 (rad).
        phase: S,
    },
    /// Interpolated between instants.
    Table {
        /// Instants t_i, increasing (s); at least two.
        times: Vec<S>,
        /// Values m_i, as many.
        values: Vec<S>,
    },
}

impl<S: Scalar> Drive<S> {
    /// The drive with every parameter replaced by `f` of it.
    pub fn map<T: Scalar>(&self, f: &mut impl FnMut(S) -> T) -> Drive<T> {
        Drive {
            freedom: self.freedom,
            course: self.course.map(f),
        }
    }
}

impl<S: Scalar> MotionCourse<S> {
    /// The course with every parameter replaced by `f` of it.
    pub fn map<T: Scalar>(&self, f: &mut impl FnMut(S) -> T) -> MotionCourse<T> {
        let mut list = |list: &[S]| list.iter().map(|&x| f(x)).collect::<Vec<T>>();
        match self {
            Self::Polynomial(coefficients) => MotionCourse::Polynomial(list(coefficients)),
            Self::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => MotionCourse::Harmonic {
                mean: f(*mean),
                amplitude: f(*amplitude),
                frequency: f(*frequency),
                phase: f(*phase),
            },
            Self::Table { times, values } => MotionCourse::Table {
                times: list(times),
                values: list(values),
            },
        }
    }

    /// Value and first to third derivative at `time` (s).
    pub fn derivatives(&self, time: S) -> [S; 4] {
        match self {
            Self::Polynomial(coefficients) => polynomial(coefficients, time),
            Self::Harmonic {
                mean,
                amplitude,
                frequency,
                phase,
            } => harmonic([*mean, *amplitude, *frequency, *phase], time),
            Self::Table { times, values } => match interval(times, time.re()) {
                Place::Before => held(values[0]),
                Place::After => held(values[values.len() - 1]),
                Place::Inside(k) => {
                    let at = stencil(k, times.len());
                    let pick = |list: &[S]| at.map(|i| i.map(|i| list[i]));
                    quintic(&pick(times), &pick(values), time)
                }
            },
        }
    }
}

impl MotionCourse<f64> {
    /// Adds the derivatives of w0 m + w1 ṁ + w2 m̈ by the parameters, at `time`, to those in `own`
    /// (of the same kind); returns that by time.
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
            (
                Self::Table { times, values },
                Self::Table {
                    times: by_times,
                    values: by_values,
                },
            ) => match interval(times, time) {
                Place::Before => by_values[0] += w0,
                Place::After => *by_values.last_mut().expect("a table has values") += w0,
                Place::Inside(k) => {
                    let lists = (&times[..], &values[..]);
                    by_points(k, lists, (by_times, by_values), |t, m| {
                        along(quintic(t, m, now))
                    });
                }
            },
            _ => unreachable!("a cotangent has the kind of its course"),
        }
        let [_, rate, acceleration, jerk] = self.derivatives(time);
        w0 * rate + w1 * acceleration + w2 * jerk
    }
}

fn held<S: Scalar>(value: S) -> [S; 4] {
    [value, S::zero(), S::zero(), S::zero()]
}

/// Σ c_j tʲ and its derivatives, by Horner's scheme.
fn polynomial<S: Scalar>(coefficients: &[S], t: S) -> [S; 4] {
    let mut out = [S::zero(); 4];
    for &c in coefficients.iter().rev() {
        for k in (1..4).rev() {
            out[k] = out[k] * t + out[k - 1];
        }
        out[0] = out[0] * t + c;
    }
    // Taylor coefficients so far.
    [out[0], out[1], out[2] * 2.0, out[3] * 6.0]
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

/// Quintic Hermite interpolation between the two middle points.
fn quintic<S: Scalar>(times: &[Option<S>; 4], values: &[Option<S>; 4], time: S) -> [S; 4] {
    let point = |i: usize| times[i].zip(values[i]);
    let (Some((t0, m0)), Some((t1, m1))) = (point(1), point(2)) else {
        unreachable!("the two points around a time are in the table");
    };
    let h = t1 - t0;
    let middle = (m1 - m0) / h;
    let (s0, c0) = point(0).map_or((S::zero(), S::zero()), |(t, m)| {
        parabola((t0 - t, (m0 - m) / (t0 - t)), (h, middle))
    });
    let (s1, c1) = point(3).map_or((S::zero(), S::zero()), |(t, m)| {
        parabola((h, middle), (t - t1, (m - m1) / (t - t1)))
    });
    // m0 + h s0 x + ½ h² c0 x² + (cubic to quintic part) in x = (t − t0)/h.
    let (slope, curvature) = (h * s0, h * h * c0);
    let d = m1 - m0 - slope - curvature * 0.5;
    let e = h * s1 - slope - curvature;
    let f = h * h * c1 - curvature;
    let coefficients = [
        m0,
        slope,
        curvature * 0.5,
        d * 10.0 - e * 4.0 + f * 0.5,
        d * -15.0 + e * 7.0 - f,
        d * 6.0 - e * 3.0 + f * 0.5,
    ];
    let [value, rate, acceleration, jerk] = polynomial(&coefficients, (time - t0) / h);
    [value, rate / h, acceleration / (h * h), jerk / (h * h * h)]
}

/// Slope and curvature at a point between two intervals, each (width, difference quotient).
fn parabola<S: Scalar>((w0, d0): (S, S), (w1, d1): (S, S)) -> (S, S) {
    let both = w0 + w1;
    ((d0 * w1 + d1 * w0) / both, (d1 - d0) * 2.0 / both)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};

    fn courses() -> [MotionCourse<f64>; 3] {
        [
            MotionCourse::Polynomial(vec![0.3, -1.2, 0.7, 0.25]),
            MotionCourse::Harmonic {
                mean: 0.2,
                amplitude: 1.3,
                frequency: 0.8,
                phase: 0.4,
            },
            MotionCourse::Table {
                times: vec![0.0, 0.5, 0.8, 1.5, 2.0],
                values: vec![1.0, 2.0, 5.0, 5.5, 4.0],
            },
        ]
    }

    #[test]
    fn each_derivative_is_the_rate_of_the_one_before() {
        for course in courses() {
            let complex = course.map(&mut Complex64::from);
            for t in [-0.5, 0.2, 0.6, 1.0, 1.7, 2.5] {
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
    fn a_table_meets_its_points_with_continuous_curvature() {
        let [.., course] = courses();
        let MotionCourse::Table { times, values } = &course else {
            unreachable!("the last course is a table");
        };
        for (&t, &m) in times.iter().zip(values) {
            assert!((course.derivatives(t)[0] - m).abs() < 1e-14);
            let (before, after) = (course.derivatives(t - 1e-9), course.derivatives(t + 1e-9));
            for k in 0..3 {
                assert!((before[k] - after[k]).abs() < 1e-5, "derivative {k} at {t}");
            }
        }
    }

    #[test]
    fn derivatives_by_parameters_are_those_of_the_complex_step() {
        let weights = [0.7, -1.1, 0.4];
        for course in courses() {
            for t in [-0.5, 0.2, 0.6, 1.0, 1.7, 2.5] {
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
}
