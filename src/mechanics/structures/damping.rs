//! Rayleigh damping C = α M + β K.

use crate::math::Scalar;

/// Coefficients of Rayleigh damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayleighDamping<S> {
    /// α [1/s], of the mass.
    pub mass: S,
    /// β \[s\], of the stiffness.
    pub stiffness: S,
}

impl<S: Scalar> RayleighDamping<S> {
    /// The coefficients that give two different frequencies \[Hz\] their damping ratios [-]:
    /// ζ = α/2ω + βω/2 at both.
    pub fn of_ratios([(f1, z1), (f2, z2)]: [(S, S); 2]) -> Self {
        let turn = 2.0 * std::f64::consts::PI;
        let (w1, w2) = (f1 * turn, f2 * turn);
        let determinant = w2 * w2 - w1 * w1;
        Self {
            mass: w1 * w2 * (z1 * w2 - z2 * w1) * 2.0 / determinant,
            stiffness: (z2 * w2 - z1 * w1) * 2.0 / determinant,
        }
    }

    /// Damping ratio ζ of a mode of frequency f \[Hz\]; a mode is damped by it and by no other.
    pub fn ratio(&self, f: S) -> S {
        let w = f * (2.0 * std::f64::consts::PI);
        self.mass / (w * 2.0) + self.stiffness * w * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;

    #[test]
    fn the_two_frequencies_get_their_ratios() {
        for pair in [[(2.0, 0.01), (30.0, 0.05)], [(9.0, 0.02), (1.0, 0.02)]] {
            let damping = RayleighDamping::of_ratios(pair);
            for (f, ratio) in pair {
                assert!((damping.ratio(f) - ratio).abs() < 1e-15);
            }
            // By the frequency of the first: the ratio there stays.
            let [(f1, z1), other] = pair;
            let moved = (Dual::new(f1, 1.0), Dual::from(z1));
            let other = (Dual::from(other.0), Dual::from(other.1));
            let damping = RayleighDamping::of_ratios([moved, other]);
            assert!(damping.ratio(moved.0).du.abs() < 1e-15);
            assert!(damping.ratio(Dual::from(f1)).du.abs() > 1e-5);
        }
    }
}
