//! Strain components carried from the points where they are tied to the Gauss points.

use super::basis::{SHEAR_POINTS, TYING_POINTS, Tied};
use crate::math::Scalar;

/// The components (rr, ss, rs) at a Gauss point of values at the tying points.
#[inline]
pub fn carry<S: Scalar>(tied: &Tied, values: &[S; TYING_POINTS]) -> [S; 3] {
    let sum = |list: &[(usize, f64)]| {
        list.iter()
            .fold(S::zero(), |sum, &(p, w)| sum + values[p] * w)
    };
    [sum(&tied.rr), sum(&tied.ss), sum(&tied.rs)]
}

/// Transpose of [`carry`].
pub fn add_carry_transpose<S: Scalar>(tied: &Tied, bar: &[S; 3], values: &mut [S; TYING_POINTS]) {
    for (list, &bar) in [&tied.rr[..], &tied.ss, &tied.rs].into_iter().zip(bar) {
        for &(p, w) in list {
            values[p] += bar * w;
        }
    }
}

/// The components (r, s) of the shear at a Gauss point.
#[inline]
pub fn carry_shear<S: Scalar>(tied: &Tied, values: &[S; SHEAR_POINTS]) -> [S; 2] {
    let sum = |list: &[(usize, f64); 2]| {
        list.iter()
            .fold(S::zero(), |sum, &(p, w)| sum + values[p] * w)
    };
    [sum(&tied.shear[0]), sum(&tied.shear[1])]
}

/// Transpose of [`carry_shear`].
pub fn add_carry_shear_transpose<S: Scalar>(
    tied: &Tied,
    bar: &[S; 2],
    values: &mut [S; SHEAR_POINTS],
) {
    for (list, &bar) in tied.shear.iter().zip(bar) {
        for &(p, w) in list {
            values[p] += bar * w;
        }
    }
}
