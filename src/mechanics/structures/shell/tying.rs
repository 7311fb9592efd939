//! Strain components carried from the points where they are tied to the Gauss points.

use super::basis::{SHEAR_POINTS, TABLES, TYING_POINTS};
use crate::math::Scalar;

/// The components (rr, ss, rs) at Gauss point `g` of values at the tying points.
#[inline]
pub fn carry<S: Scalar>(g: usize, values: &[S; TYING_POINTS]) -> [S; 3] {
    let tied = &TABLES.tied[g];
    let sum = |list: &[(usize, f64)]| {
        list.iter()
            .fold(S::zero(), |sum, &(p, w)| sum + values[p] * w)
    };
    [sum(&tied.rr), sum(&tied.ss), sum(&tied.rs)]
}

/// Transpose of [`carry`].
pub fn add_carry_transpose<S: Scalar>(g: usize, bar: &[S; 3], values: &mut [S; TYING_POINTS]) {
    let tied = &TABLES.tied[g];
    for (list, &bar) in [&tied.rr[..], &tied.ss, &tied.rs].into_iter().zip(bar) {
        for &(p, w) in list {
            values[p] += bar * w;
        }
    }
}

/// The components (r, s) of the shear at Gauss point `g`.
#[inline]
pub fn carry_shear<S: Scalar>(g: usize, values: &[S; SHEAR_POINTS]) -> [S; 2] {
    let tied = &TABLES.tied[g];
    let sum = |list: &[(usize, f64); 2]| {
        list.iter()
            .fold(S::zero(), |sum, &(p, w)| sum + values[p] * w)
    };
    [sum(&tied.rr), sum(&tied.ss)]
}

/// Transpose of [`carry_shear`].
pub fn add_carry_shear_transpose<S: Scalar>(
    g: usize,
    bar: &[S; 2],
    values: &mut [S; SHEAR_POINTS],
) {
    let tied = &TABLES.tied[g];
    for (list, &bar) in [&tied.rr, &tied.ss].into_iter().zip(bar) {
        for &(p, w) in list {
            values[p] += bar * w;
        }
    }
}
