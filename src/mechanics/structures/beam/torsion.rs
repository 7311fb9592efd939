//! Torsion constant of a rectangle.

use crate::math::Scalar;

/// Σ 1/n⁵ over odd n: (31/32) ζ(5).
const ODD_FIFTHS: f64 = 31.0 / 32.0 * 1.036_927_755_143_37;

/// J of a rectangle by Saint-Venant's series (Timoshenko & Goodier 1951, eq. 160), and its derivatives by
/// the two sides. With ρ = long / short it is short⁴ g(ρ),
///
/// ```text
/// g = ρ/3 − (64/π⁵) Σ tanh(nπρ/2)/n⁵,  n = 1, 3, 5, …
/// ```
///
/// The series is that of 1 − tanh here, which ends at rounding. J is one analytic function of both sides,
/// so nothing breaks where they change places.
pub(super) fn rectangle<S: Scalar>(sides: [S; 2]) -> (S, [S; 2]) {
    let swapped = sides[0].re() < sides[1].re();
    let [long, short] = if swapped { [sides[1], sides[0]] } else { sides };
    let pi = std::f64::consts::PI;
    let ratio = long / short;
    let (mut sum, mut slope) = (S::from(ODD_FIFTHS), S::zero());
    for n in (1..16).step_by(2).map(f64::from) {
        let decay = (ratio * (-n * pi)).exp();
        let rest = decay * 2.0 / (decay + 1.0);
        sum -= rest / n.powi(5);
        // tanh' = 1 − tanh² = rest (2 − rest).
        slope += rest * (S::from(2.0) - rest) * (0.5 * pi / n.powi(4));
    }
    let factor = 64.0 / pi.powi(5);
    let g = ratio / 3.0 - sum * factor;
    let g_slope = S::from(1.0 / 3.0) - slope * factor;
    let cube = short * short * short;
    let by_long = cube * g_slope;
    let by_short = cube * (g * 4.0 - ratio * g_slope);
    let by = if swapped {
        [by_short, by_long]
    } else {
        [by_long, by_short]
    };
    (cube * short * g, by)
}
