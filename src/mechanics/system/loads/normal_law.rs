//! The normal force of stops and contacts, its potential energy and all their derivatives.
//!
//! With the penetration δ, its rate δ̇, u = δ/w + ½ and b = 1 + ³⁄₂ c δ̇ (Hunt & Crossley 1975):
//!
//! ```text
//! ρ(δ) = w R(u),  R = u⁶ − 3 u⁵ + ⁵⁄₂ u⁴ for 0 < u < 1;   ρ = 0 below, ρ = δ above
//! N = f β(b),     f = k ρⁿ ρ' = dV/dδ,     V = k ρⁿ⁺¹ / (n + 1)
//! ```
//!
//! ρ' is the quintic smoothstep of u, so f has two continuous derivatives. β is the same ramp as ρ, with a width of its
//! own; it equals b but where b is near zero or negative, at a fast separation, and there keeps N from pulling. As β − 1 has
//! the sign of δ̇, the dissipated power f (β − 1) δ̇ is never negative.

use crate::math::Scalar;
use crate::model::NormalLaw;
use std::ops::Mul;

/// Width of the ramp β. A free rebound has b > 0, and nearly always above half of this width.
const NO_PULL: f64 = 0.1;

/// A ramp of width w at x, with its derivatives.
struct Ramp<S> {
    value: S,
    slope: S,
    curvature: S,
    /// Derivatives of value and slope in w.
    by_width: S,
    slope_by_width: S,
}

/// The ramp; `None` where it is zero.
fn ramp<S: Scalar>(x: S, width: S) -> Option<Ramp<S>> {
    let u = x / width + 0.5;
    if u.re() <= 0.0 {
        return None;
    }
    if u.re() >= 1.0 {
        return Some(Ramp {
            value: x,
            slope: S::one(),
            curvature: S::zero(),
            by_width: S::zero(),
            slope_by_width: S::zero(),
        });
    }
    let cube = u * u * u;
    let integral = cube * u * (u * u - u * 3.0 + 2.5);
    let slope = cube * (u * u * 6.0 - u * 15.0 + 10.0);
    let rest = S::one() - u;
    let curvature = u * u * rest * rest * 30.0 / width;
    let from_middle = u - 0.5;
    Some(Ramp {
        value: width * integral,
        slope,
        curvature,
        by_width: integral - slope * from_middle,
        slope_by_width: -(curvature * from_middle),
    })
}

/// xⁿ of a positive number.
fn power<S: Scalar>(x: S, n: f64) -> S {
    if n == 0.0 {
        S::one()
    } else if n == 1.0 {
        x
    } else {
        (x.ln() * n).exp()
    }
}

/// A normal force with its derivatives.
#[derive(Clone, Copy)]
pub(super) struct NormalForce<S> {
    /// N \[N or N m\].
    pub value: S,
    /// In the penetration.
    pub by_penetration: S,
    /// In the rate of the penetration.
    pub by_rate: S,
    /// In stiffness, dissipation and width.
    pub by_law: [S; 3],
}

impl<S: Scalar> NormalForce<S> {
    /// No force, and no derivatives.
    pub(super) fn none() -> Self {
        Self {
            value: S::zero(),
            by_penetration: S::zero(),
            by_rate: S::zero(),
            by_law: [S::zero(); 3],
        }
    }
}

/// A share of a force and of its derivatives.
impl<S: Scalar> Mul<f64> for NormalForce<S> {
    type Output = Self;

    fn mul(self, share: f64) -> Self {
        Self {
            value: self.value * share,
            by_penetration: self.by_penetration * share,
            by_rate: self.by_rate * share,
            by_law: self.by_law.map(|by| by * share),
        }
    }
}

/// Whether a penetration is beyond the start of the onset.
pub(super) fn touches<S: Scalar>(law: &NormalLaw<S>, penetration: S) -> bool {
    (penetration / law.width + 0.5).re() > 0.0
}

/// The normal force at a penetration and its rate.
pub(super) fn force<S: Scalar>(law: &NormalLaw<S>, penetration: S, rate: S) -> NormalForce<S> {
    let (n, k, c) = (law.exponent, law.stiffness, law.dissipation);
    let Some(depth) = ramp(penetration, law.width) else {
        return NormalForce::none();
    };
    let Some(bracket) = ramp(S::one() + c * rate * 1.5, S::from(NO_PULL)) else {
        return NormalForce::none();
    };
    let (below, to_n) = (power(depth.value, n - 1.0), power(depth.value, n));
    let shape = to_n * depth.slope;
    let steep = below * depth.slope * n;
    let by_penetration = k * (steep * depth.slope + to_n * depth.curvature);
    let by_width = k * (steep * depth.by_width + to_n * depth.slope_by_width);
    let elastic = k * shape;
    let by_bracket = elastic * bracket.slope * 1.5;
    NormalForce {
        value: elastic * bracket.value,
        by_penetration: by_penetration * bracket.value,
        by_rate: by_bracket * c,
        by_law: [
            shape * bracket.value,
            by_bracket * rate,
            by_width * bracket.value,
        ],
    }
}

/// The potential energy of the elastic part, its derivative in the penetration, and those in stiffness and width.
pub(super) fn potential<S: Scalar>(law: &NormalLaw<S>, penetration: S) -> (S, S, [S; 2]) {
    let (n, k) = (law.exponent, law.stiffness);
    let Some(depth) = ramp(penetration, law.width) else {
        return (S::zero(), S::zero(), [S::zero(); 2]);
    };
    let to_n = power(depth.value, n);
    let of_one = to_n * depth.value / (n + 1.0);
    let by_depth = k * to_n;
    (
        k * of_one,
        by_depth * depth.slope,
        [of_one, by_depth * depth.by_width],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Complex64;
    use crate::math::scalar::COMPLEX_STEP;

    fn law(exponent: f64) -> NormalLaw<f64> {
        NormalLaw {
            exponent,
            stiffness: 3.0,
            dissipation: 0.4,
            width: 0.2,
        }
    }

    /// Depths below, within and above the onset; rates of approach, of separation, and where the bracket is cut off.
    fn states() -> Vec<(f64, f64, f64)> {
        let mut all = Vec::new();
        for n in [1.0, 1.5, 2.2] {
            for depth in [-0.3, -0.08, -0.01, 0.03, 0.09, 0.4] {
                for rate in [-5.0, -1.68, -1.6, -0.7, 0.0, 0.9] {
                    all.push((n, depth, rate));
                }
            }
        }
        all
    }

    fn agree(given: f64, exact: f64, what: &str) {
        let error = (given - exact).abs();
        assert!(
            error <= 1e-12 * exact.abs().max(1e-3),
            "{what}: {given} against {exact}"
        );
    }

    #[test]
    fn derivatives_agree_with_the_complex_step() {
        let i = Complex64::new(0.0, COMPLEX_STEP);
        let lift = |law: &NormalLaw<f64>| NormalLaw {
            exponent: law.exponent,
            stiffness: law.stiffness.into(),
            dissipation: law.dissipation.into(),
            width: Complex64::from(law.width),
        };
        let mut touching = 0;
        for (n, x, rate) in states() {
            let law = law(n);
            let now = force(&law, x, rate);
            touching += usize::from(now.value > 0.0);
            let (_, slope, [by_k, by_w]) = potential(&law, x);
            let mut moved =
                [(); 5].map(|()| (lift(&law), Complex64::from(x), Complex64::from(rate)));
            moved[0].1 += i;
            moved[1].2 += i;
            moved[2].0.stiffness += i;
            moved[3].0.dissipation += i;
            moved[4].0.width += i;
            let exact = moved
                .clone()
                .map(|(law, x, rate)| force(&law, x, rate).value.im / COMPLEX_STEP);
            let [k, c, w] = now.by_law;
            for (given, exact) in [now.by_penetration, now.by_rate, k, c, w]
                .into_iter()
                .zip(exact)
            {
                agree(given, exact, &format!("force at {n}, {x}, {rate}"));
            }
            let exact = moved.map(|(law, x, _)| potential(&law, x).0.im / COMPLEX_STEP);
            for (given, exact) in [slope, 0.0, by_k, 0.0, by_w].into_iter().zip(exact) {
                agree(given, exact, &format!("energy at {n}, {x}"));
            }
        }
        assert!(touching > 40, "{touching}");
    }

    /// N ≥ 0, the elastic force is that at rest, and what damping adds takes energy.
    #[test]
    fn never_pulls_and_never_feeds() {
        for (n, x, rate) in states() {
            let law = law(n);
            let (now, still) = (force(&law, x, rate).value, force(&law, x, 0.0).value);
            assert!(now >= 0.0);
            agree(still, potential(&law, x).1, "elastic force");
            assert!((now - still) * rate >= 0.0, "{n}, {x}, {rate}");
        }
    }

    /// Second derivatives of the elastic force are continuous at both ends of the onset.
    #[test]
    fn the_onset_is_smooth() {
        let law = law(1.0);
        let slope = |x: f64| force(&law, x, 0.0).by_penetration;
        for edge in [-0.1, 0.1] {
            let h = 1e-6;
            let [before, after] = [-1.0, 1.0]
                .map(|side| (slope(edge + 2.0 * side * h) - slope(edge + side * h)) / (side * h));
            assert!(
                (before - after).abs() < 1e-2 * law.stiffness / law.width,
                "{before} {after}"
            );
        }
    }
}
