//! Shape functions of a beam over ξ = x / L in [0, 1].
//!
//! Polynomials of bending have Legendre polynomials as second derivatives, those of stretch and torsion as
//! first ones: the functions of one kind are orthogonal in their strain energy. Each has a mean square of ½
//! like a sine, except the first of stretch and torsion, which is ξ.

use crate::math::Scalar;
use crate::math::legendre::{legendre, legendre_slopes};

/// What holds the axes of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeamFrame {
    /// The chord: the axes' x runs through both ends, and the start does not turn about it.
    Chord,
    /// The section at the start: neither its centre nor its rotation departs from the axes.
    Clamped,
}

/// Functions of bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendingFunctions {
    /// Polynomials of growing degree.
    Polynomial,
    /// sin kπξ: the modes of a beam on hinges. They have no bending moment at the ends.
    Sine,
}

/// A function and its first three derivatives by ξ.
pub(super) type Jet<S> = [S; 4];

/// The first `count` functions of bending at ξ. All vanish at the start; in the chord frame at the end too,
/// in the clamped frame their slope vanishes at the start.
pub(super) fn bending<S: Scalar>(
    functions: BendingFunctions,
    frame: BeamFrame,
    count: usize,
    xi: S,
) -> Vec<Jet<S>> {
    match functions {
        BendingFunctions::Polynomial => polynomials(frame, count, xi),
        BendingFunctions::Sine => sines(frame, count, xi),
    }
}

fn sines<S: Scalar>(frame: BeamFrame, count: usize, xi: S) -> Vec<Jet<S>> {
    let jet = |k: usize| {
        let a = std::f64::consts::PI * (k + 1) as f64;
        let (sin, cos) = (xi * a).sin_cos();
        // A clamped section keeps its slope: the line with the slope at the start is taken off.
        let slope = match frame {
            BeamFrame::Chord => 0.0,
            BeamFrame::Clamped => a,
        };
        [
            sin - xi * slope,
            cos * a - slope,
            -sin * (a * a),
            -cos * (a * a * a),
        ]
    };
    (0..count).map(jet).collect()
}

fn polynomials<S: Scalar>(frame: BeamFrame, count: usize, xi: S) -> Vec<Jet<S>> {
    let t = xi * 2.0 - 1.0;
    let p = legendre(count + 2, t);
    let slopes = legendre_slopes(&p);
    let jet = |k: usize| {
        let n = 2.0 * k as f64;
        // First and second integral of P_k by t, and the integral of the square of the second over [−1, 1].
        let (first, second, square) = match (k, frame) {
            (0, BeamFrame::Chord) => (t, (t * t - 1.0) * 0.5, 4.0 / 15.0),
            (0, BeamFrame::Clamped) => (t + 1.0, (t + 1.0) * (t + 1.0) * 0.5, 8.0 / 5.0),
            (1, BeamFrame::Chord) => (
                t * t * 0.5 - 1.0 / 6.0,
                (t * t - 1.0) * t / 6.0,
                4.0 / 945.0,
            ),
            (1, BeamFrame::Clamped) => {
                let second = (t + 1.0) * (t + 1.0) * (t - 2.0) / 6.0;
                ((t * t - 1.0) * 0.5, second, 104.0 / 315.0)
            }
            _ => {
                let above = 1.0 / ((n + 1.0) * (n + 3.0));
                let below = 1.0 / ((n + 1.0) * (n - 1.0));
                let square = above * above * 2.0 / (n + 5.0)
                    + (above + below) * (above + below) * 2.0 / (n + 1.0)
                    + below * below * 2.0 / (n - 3.0);
                (
                    (p[k + 1] - p[k - 1]) / (n + 1.0),
                    p[k + 2] * above - p[k] * (above + below) + p[k - 2] * below,
                    square,
                )
            }
        };
        // The mean square over [0, 1] becomes ½. The first chord function is positive.
        let sign = if k == 0 && frame == BeamFrame::Chord {
            -1.0
        } else {
            1.0
        };
        let scale = sign / square.sqrt();
        [
            second * scale,
            first * (2.0 * scale),
            p[k] * (4.0 * scale),
            slopes[k] * (8.0 * scale),
        ]
    };
    (0..count).map(jet).collect()
}

/// The first `count` functions of stretch or torsion at ξ, and their first derivatives. All vanish at the
/// start. Together they are all polynomials of degree `count` that do.
pub(super) fn stretch<S: Scalar>(count: usize, xi: S) -> Vec<[S; 2]> {
    let p = legendre(count, xi * 2.0 - 1.0);
    let function = |k: usize| {
        if k == 0 {
            return [xi, S::one()];
        }
        let n = 2.0 * k as f64;
        let (below, at, above) = (n - 1.0, n + 1.0, n + 3.0);
        let scale = (1.0 / (1.0 / above + 1.0 / below)).sqrt();
        [
            (p[k + 1] - p[k - 1]) * scale * std::f64::consts::FRAC_1_SQRT_2,
            p[k] * (at * scale * std::f64::consts::SQRT_2),
        ]
    };
    (0..count).map(function).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;
    use crate::math::legendre::gauss;

    const FRAMES: [BeamFrame; 2] = [BeamFrame::Chord, BeamFrame::Clamped];
    const KINDS: [BendingFunctions; 2] = [BendingFunctions::Polynomial, BendingFunctions::Sine];

    #[test]
    fn each_derivative_is_that_of_the_one_before() {
        for xi in [0.0, 0.13, 0.5, 0.87, 1.0] {
            let xi = Dual::new(xi, 1.0);
            for (frame, kind) in FRAMES.iter().flat_map(|f| KINDS.map(|k| (*f, k))) {
                for jet in bending(kind, frame, 9, xi) {
                    for pair in jet.windows(2) {
                        let scale = pair[1].re.abs().max(1.0);
                        assert!((pair[0].du - pair[1].re).abs() < 1e-12 * scale);
                    }
                }
            }
            for [value, slope] in stretch(12, xi) {
                assert!((value.du - slope.re).abs() < 1e-12 * slope.re.abs().max(1.0));
            }
        }
    }

    #[test]
    fn the_ends_stay_where_the_frame_is() {
        for (frame, kind) in FRAMES.iter().flat_map(|f| KINDS.map(|k| (*f, k))) {
            let (start, end) = (bending(kind, frame, 9, 0.0), bending(kind, frame, 9, 1.0));
            for (start, end) in start.iter().zip(&end) {
                assert!(start[0].abs() < 1e-14);
                match frame {
                    BeamFrame::Chord => assert!(end[0].abs() < 1e-13),
                    BeamFrame::Clamped => assert!(start[1].abs() < 1e-13),
                }
            }
        }
        for [value, _] in stretch(12, 0.0) {
            assert!(value.abs() < 1e-14);
        }
    }

    #[test]
    fn mean_squares_are_one_half() {
        let rule = gauss(30);
        for frame in FRAMES {
            for k in 0..9 {
                let at = |x: f64| bending(BendingFunctions::Polynomial, frame, 9, x)[k][0];
                let mean: f64 = rule.iter().map(|&(x, w)| w * at(x).powi(2)).sum();
                assert!((mean - 0.5).abs() < 1e-13, "{frame:?} {k}: {mean}");
            }
        }
        for k in 1..9 {
            let mean: f64 = rule
                .iter()
                .map(|&(x, w)| w * stretch(9, x)[k][0].powi(2))
                .sum();
            assert!((mean - 0.5).abs() < 1e-13, "stretch {k}: {mean}");
        }
    }
}
