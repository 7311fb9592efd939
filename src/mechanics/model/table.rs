//! Tables of values at instants, and interpolation between them.
//!
//! Let the points (t_i, m_i) and (t_{i+1}, m_{i+1}) be h_i apart, with difference quotients d_i:
//!
//! ```text
//!            a magnitude                          a motion
//! linear     straight, C0                         straight, each end of an interval rounded over a
//!                                                 fifth of it, C2
//! monotone   cubic, level where d changes sign,   quintic, level where d changes sign, C2
//!            C1
//! spline     quintic by parabolas, C2             the same
//! ```
//!
//! Linear and monotone functions stay between neighbouring values. All functions are level at both
//! ends and constant beyond, except for a linear magnitude, which has kinks at its instants.
//!
//! The slopes of the cubic are weighted harmonic means of the neighbouring quotients (Fritsch &
//! Butland 1984, *SIAM J. Sci. Stat. Comput.* 5(2), 300–304).
//!
//! The slope of a motion is s = ((d_{i−1}⁻⁴ + d_i⁻⁴)/2)^{−1/4}, which is at most 2^{1/4} of either
//! quotient. A quintic is monotone if its derivative has no negative Bernstein coefficient
//! (Dougherty, Edelman & Hyman 1989, *Math. Comp.* 52(186), 471–494). With α = s/d and γ = c h/d
//! for the slope s and the curvature c at an end, this holds if |γ| ≤ 4α and |γ| ≤ 10 − 8α at both
//! ends. The curvature of the parabola through three points is reduced smoothly to fulfil this.
//!
//! The spline has slope and curvature of the parabola through a point and its neighbours. It has
//! the least error for smooth values and overshoots for others.

use crate::math::Scalar;
use crate::math::scalar::Dual;

/// Interpolation between the values of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// Without overshoot.
    #[default]
    Monotone,
    /// As smooth as the values.
    Spline,
}

/// How smooth the curve of a table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    /// That of a force or torque: C0 or C1.
    Magnitude,
    /// That of a prescribed motion: C2.
    Motion,
}

/// Part of an interval over which a linear motion is rounded at each of its ends.
const ROUNDED: f64 = 0.2;

/// Number of continuous derivatives, at its breaks, of the force or acceleration that a table gives. A
/// motion gives an acceleration, its second derivative.
pub fn continuous((interpolation, smoothness): (Interpolation, Smoothness)) -> usize {
    match (interpolation, smoothness) {
        (_, Smoothness::Motion) | (Interpolation::Linear, Smoothness::Magnitude) => 0,
        (Interpolation::Monotone, Smoothness::Magnitude) => 1,
        (Interpolation::Spline, Smoothness::Magnitude) => 2,
    }
}

/// Instants at which the curve of a table is no longer smooth, where steps should end.
pub fn breaks<S: Scalar>(
    times: &[S],
    (interpolation, smoothness): (Interpolation, Smoothness),
) -> Vec<f64> {
    let mut all: Vec<f64> = times.iter().map(|t| t.re()).collect();
    if (interpolation, smoothness) == (Interpolation::Linear, Smoothness::Motion) {
        for pair in times.windows(2) {
            let (start, end) = (pair[0].re(), pair[1].re());
            let rounded = ROUNDED * (end - start);
            all.extend([start + rounded, end - rounded]);
        }
    }
    all
}

/// Position of a time in a table.
pub(super) enum Bracket {
    Before,
    /// Between the instants k and k + 1.
    Inside(usize),
    After,
}

pub(super) fn interval<S: Scalar>(times: &[S], time: f64) -> Bracket {
    match times.partition_point(|t| t.re() <= time) {
        0 => Bracket::Before,
        after if after == times.len() => Bracket::After,
        after => Bracket::Inside(after - 1),
    }
}

/// Instants or values of the points k − 1 … k + 2; `None` beyond the ends of the table.
pub(super) type Neighbours<S> = [Option<S>; 4];

fn stencil(k: usize, count: usize) -> [Option<usize>; 4] {
    let there = |i: Option<usize>| i.filter(|&i| i < count);
    [k.checked_sub(1), Some(k), Some(k + 1), there(Some(k + 2))]
}

/// The entries of a list around interval k.
pub(super) fn around<S: Scalar>(list: &[S], k: usize) -> Neighbours<S> {
    stencil(k, list.len()).map(|i| i.map(|i| list[i]))
}

/// Adds the derivatives in instants and values of the interpolation between points k and k + 1. It
/// depends on at most four points. `slope` computes them by dual numbers, one entry at a time.
pub(super) fn by_points(
    k: usize,
    (times, values): (&[f64], &[f64]),
    (by_times, by_values): (&mut [f64], &mut [f64]),
    slope: impl Fn(&Neighbours<Dual>, &Neighbours<Dual>) -> f64,
) {
    let lift = |list: &[f64]| around(list, k).map(|x| x.map(Dual::from));
    let (t, m) = (lift(times), lift(values));
    let moved = |list: &Neighbours<Dual>, j: usize| {
        let mut list = *list;
        list[j] = list[j].map(|x| Dual::new(x.re, 1.0));
        list
    };
    for (j, i) in stencil(k, times.len()).iter().enumerate() {
        let Some(i) = *i else { continue };
        by_times[i] += slope(&moved(&t, j), &m);
        by_values[i] += slope(&t, &moved(&m, j));
    }
}

/// The interval of a time: its ends (instant, value), and the width and quotient of the intervals
/// before, at and after it.
struct Interval<S> {
    start: (S, S),
    end: (S, S),
    own: (S, S),
    before: Option<(S, S)>,
    after: Option<(S, S)>,
}

impl<S: Scalar> Interval<S> {
    fn of(times: &Neighbours<S>, values: &Neighbours<S>) -> Self {
        let point = |i: usize| times[i].zip(values[i]);
        let (Some(start), Some(end)) = (point(1), point(2)) else {
            unreachable!("the two points around a time are in the table");
        };
        let between = |(t0, m0): (S, S), (t1, m1): (S, S)| (t1 - t0, (m1 - m0) / (t1 - t0));
        Self {
            start,
            end,
            own: between(start, end),
            before: point(0).map(|before| between(before, start)),
            after: point(3).map(|after| between(end, after)),
        }
    }

    /// `rule` applied to the two intervals at the start and at the end; zero at an end of the
    /// table.
    fn ends(&self, rule: impl Fn((S, S), (S, S)) -> [S; 2]) -> [[S; 2]; 2] {
        let level = [S::zero(); 2];
        [
            self.before.map_or(level, |before| rule(before, self.own)),
            self.after.map_or(level, |after| rule(self.own, after)),
        ]
    }
}

/// Value and first to third derivative at `time`.
pub(super) fn interpolate<S: Scalar>(
    (interpolation, smoothness): (Interpolation, Smoothness),
    times: &Neighbours<S>,
    values: &Neighbours<S>,
    time: S,
) -> [S; 4] {
    let at = Interval::of(times, values);
    match (interpolation, smoothness) {
        (Interpolation::Linear, Smoothness::Magnitude) => straight(&at, time),
        (Interpolation::Linear, Smoothness::Motion) => rounded(&at, time),
        (Interpolation::Monotone, Smoothness::Magnitude) => cubic(&at, time),
        (Interpolation::Monotone, Smoothness::Motion) => {
            quintic(at.start, at.end, at.ends(limited), time)
        }
        (Interpolation::Spline, _) => quintic(at.start, at.end, at.ends(parabola), time),
    }
}

/// The straight line between the points.
fn straight<S: Scalar>(at: &Interval<S>, time: S) -> [S; 4] {
    let ((t0, m0), (_, slope)) = (at.start, at.own);
    [m0 + slope * (time - t0), slope, S::zero(), S::zero()]
}

/// Cubic Hermite interpolation and its derivatives.
fn cubic<S: Scalar>(at: &Interval<S>, time: S) -> [S; 4] {
    let ((t0, m0), (width, middle)) = (at.start, at.own);
    let [[slope0, _], [slope1, _]] = at.ends(|a, b| [harmonic_mean(a, b), S::zero()]);
    // In t − t0: the departures of the slopes from the quotient give the square and the cube.
    let (start, end) = (slope0 - middle, slope1 - middle);
    let square = -(start * 2.0 + end) / width;
    let cube = (start + end) / (width * width);
    polynomial(&[m0, slope0, square, cube], time - t0)
}

/// A straight motion whose ends are rounded.
fn rounded<S: Scalar>(at: &Interval<S>, time: S) -> [S; 4] {
    let zero = S::zero();
    let ((t0, m0), (t1, m1), (width, slope)) = (at.start, at.end, at.own);
    let [start, end] = at.ends(|(_, a), (_, b)| [power_mean(a, b), zero]);
    let part = width * ROUNDED;
    let straight = [slope, zero];
    let (first, last) = (
        (t0 + part, m0 + slope * part),
        (t1 - part, m1 - slope * part),
    );
    if time.re() < first.0.re() {
        quintic(at.start, first, [start, straight], time)
    } else if time.re() < last.0.re() {
        [m0 + slope * (time - t0), slope, zero, zero]
    } else {
        quintic(last, at.end, [straight, end], time)
    }
}

/// Quintic Hermite interpolation between two points (instant, value) with (slope, curvature) at
/// both, and its first to third derivatives.
fn quintic<S: Scalar>(
    (t0, m0): (S, S),
    (t1, m1): (S, S),
    [[s0, c0], [s1, c1]]: [[S; 2]; 2],
    time: S,
) -> [S; 4] {
    let h = t1 - t0;
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

/// Σ c_j tʲ and its derivatives, by Horner's scheme.
pub(super) fn polynomial<S: Scalar>(coefficients: &[S], t: S) -> [S; 4] {
    let mut out = [S::zero(); 4];
    for &c in coefficients.iter().rev() {
        for k in (1..4).rev() {
            out[k] = out[k] * t + out[k - 1];
        }
        out[0] = out[0] * t + c;
    }
    // The sums are Taylor coefficients.
    [out[0], out[1], out[2] * 2.0, out[3] * 6.0]
}

/// Slope and curvature of the parabola at a point between two intervals (width, quotient).
fn parabola<S: Scalar>((w0, d0): (S, S), (w1, d1): (S, S)) -> [S; 2] {
    let both = w0 + w1;
    [(d0 * w1 + d1 * w0) / both, (d1 - d0) * 2.0 / both]
}

/// Slope of the cubic at a point between two intervals (width, quotient).
fn harmonic_mean<S: Scalar>((w0, d0): (S, S), (w1, d1): (S, S)) -> S {
    if d0.re() * d1.re() <= 0.0 {
        return S::zero();
    }
    let (a, b) = (w0 + w1 * 2.0, w0 * 2.0 + w1);
    (a + b) / (a / d0 + b / d1)
}

/// Mean of power −4 of two quotients of one sign, else zero; at most 2^{1/4} of the smaller.
fn power_mean<S: Scalar>(a: S, b: S) -> S {
    if a.re() * b.re() <= 0.0 {
        return S::zero();
    }
    let (small, large) = if a.re().abs() < b.re().abs() {
        (a, b)
    } else {
        (b, a)
    };
    let ratio = small / large;
    let square = ratio * ratio;
    small / ((square * square + 1.0) * 0.5).sqrt().sqrt()
}

/// Slope and curvature of a monotone motion at a point between two intervals (width, quotient).
fn limited<S: Scalar>((w0, d0): (S, S), (w1, d1): (S, S)) -> [S; 2] {
    let slope = power_mean(d0, d1);
    if slope.re() == 0.0 {
        return [slope, slope];
    }
    let [_, curvature] = parabola((w0, d0), (w1, d1));
    let mut square = S::one();
    for (w, d) in [(w0, d0), (w1, d1)] {
        for bound in [slope * 4.0, d * 10.0 - slope * 8.0] {
            let part = curvature * w / bound;
            square += part * part;
        }
    }
    [slope, curvature / square.sqrt()]
}
