//! Twist and curvatures of a beam that bends in two planes and twists, to second order.
//!
//! A section is turned by a swing θ2, θ3 of the line of centres and by the twist φ about it. In its own axes
//!
//! ```text
//! κ1 = φ' − ½ (θ2 θ3' − θ3 θ2'),   κ2 = θ2' + φ θ3',   κ3 = θ3' − φ θ2'
//! U = ½ ∫ (GJ κ1² + EI2 κ2² + EI3 κ3²) dx
//! ```
//!
//! with κ to second order: the stiffness of bending errs by the square of φ.
//!
//! So a moment about the strong axis bends the twisted beam sideways: it buckles laterally (Timoshenko & Gere 1961,
//! ch. 6).
//!
//! **No locking.** κ3 of n functions has n coordinates of its own, which relieve the combination of its functions that is
//! nearest to the products, and no more: κ3 is that combination. It is found by sums over m points, where m is the
//! largest of the three numbers of functions: those of Gauss for polynomials, and k/(m + 1) for sines. With fewer points
//! than n = m the work of a moment on the products would be wrong; with n = m the curvature has the products' values at the
//! points. κ1 and κ2 likewise.

use super::beam::{FlexibleBeam, SectionMode, StrainMeasure};
use super::shapes::BendingFunctions;
use crate::math::Scalar;
use crate::math::legendre::gauss;
use crate::model::flexible::{Quadratic, Strain};

/// Products (i, j, factor) of rotations θ_i and curvatures θ_j' in κ1, κ2, κ3.
const PRODUCTS: [&[(usize, usize, f64)]; 3] = [
    &[(1, 2, -0.5), (2, 1, 0.5)],
    &[(0, 2, 1.0)],
    &[(0, 1, -1.0)],
];

/// Squares (c, g) of Σ c (g · q)².
type Squares<S> = Vec<(S, Vec<S>)>;

impl<S: Scalar> FlexibleBeam<S> {
    /// Whether twist and bending couple.
    pub(super) fn couples(&self) -> bool {
        let [y, z] = self.modes.bending;
        self.strain == StrainMeasure::VonKarman && y > 0 && z > 0 && self.modes.torsion > 0
    }

    /// The coordinates of κ of an axis.
    fn own(&self, axis: usize) -> std::ops::Range<usize> {
        let [y, z, torsion, _] = self.modes.ranges();
        [torsion, z, y][axis].clone()
    }

    /// `count` points and weights at which κ of an axis, or its products, are taken.
    fn points(&self, axis: usize, count: usize) -> Vec<(f64, f64)> {
        match (axis, self.functions) {
            (1 | 2, BendingFunctions::Sine) => {
                let part = 1.0 / (count + 1) as f64;
                (1..=count).map(|k| (k as f64 * part, part)).collect()
            }
            _ => gauss(count),
        }
    }

    /// The number of points at which products are taken.
    fn most(&self) -> usize {
        let all = (0..3).map(|axis| self.own(axis).len());
        all.fold(0, usize::max)
    }

    /// The strains κ1, κ2, κ3; none if K has them.
    pub(super) fn twist_strains(&self) -> Vec<Strain<S>> {
        let mut all = Vec::new();
        if !self.couples() {
            return all;
        }
        for axis in 0..3 {
            let count = self.own(axis).len();
            for (xi, weight) in self.points(axis, count) {
                let modes = self.section_modes(S::from(xi));
                let squares = match count == self.most() {
                    true => self.products(axis, &modes, S::one()),
                    false => self.products_at(axis, |i| modes[i].curvature[axis]),
                };
                all.push(Strain {
                    weight: self.values().stiffness[3 + axis] * self.length * weight,
                    axial: false,
                    strain: Quadratic {
                        linear: modes.iter().map(|mode| mode.curvature[axis]).collect(),
                        squares,
                    },
                });
            }
        }
        all
    }

    /// The products in κ of an axis, times a factor, as squares.
    fn products(&self, axis: usize, modes: &[SectionMode<S>], factor: S) -> Squares<S> {
        // A curvature counts by the length, so that sum and difference with a rotation are of like size.
        let both = |&(i, j, c): &(usize, usize, f64)| {
            let square = |sign: f64| {
                let of = |mode: &SectionMode<S>| {
                    mode.rotation[i] + mode.curvature[j] * self.length * sign
                };
                let c = factor * (0.5 * c * sign) / self.length;
                (c, modes.iter().map(of).collect())
            };
            [square(1.0), square(-1.0)]
        };
        PRODUCTS[axis].iter().flat_map(both).collect()
    }

    /// The products in κ of an axis at ξ, or in its slope: the nearest combination of functions that have these values `of`
    /// each coordinate.
    pub(super) fn products_at(&self, axis: usize, of: impl Fn(usize) -> S) -> Squares<S> {
        if !self.couples() {
            return Vec::new();
        }
        let (points, own) = (self.points(axis, self.most()), self.own(axis));
        let at = |&(xi, weight): &(f64, f64)| (self.section_modes(S::from(xi)), weight);
        let all: Vec<_> = points.iter().map(at).collect();
        let value = |modes: &[SectionMode<S>], i: usize| modes[i].curvature[axis];
        let squares = |i: usize| {
            let sum = all
                .iter()
                .map(|(modes, weight)| value(modes, i) * value(modes, i) * *weight);
            sum.fold(S::zero(), |sum, x| sum + x)
        };
        let factors: Vec<(usize, S)> = own.map(|i| (i, of(i) / squares(i))).collect();
        let one = |(modes, weight): &(Vec<SectionMode<S>>, f64)| {
            let share = factors.iter().fold(S::zero(), |sum, &(i, factor)| {
                sum + factor * value(modes, i) * *weight
            });
            self.products(axis, modes, share)
        };
        all.iter().flat_map(one).collect()
    }
}
