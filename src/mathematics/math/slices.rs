//! Sums of products and scaled sums of slices, in any scalar.

use super::Scalar;
use std::ops::Mul;

/// Runs `work` with the widest vector instructions of the processor. Sums are the same on every processor: no product
/// is fused with an addition.
#[inline(always)]
pub fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(work)
}

/// n numbers in (−1/2, 1/2) that look random, the same in every run for a `seed`. Such a vector has a part of each eigenvector.
pub fn any_vector(n: usize, seed: f64) -> Vec<f64> {
    let any = |i: usize| (seed * (1.0 + i as f64).sqrt()).fract() - 0.5;
    (0..n).map(any).collect()
}

/// Σ a_i b_i over the common indices.
pub fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    let products = a.iter().zip(b);
    products.fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

/// Σ a_i b_i by four sums, because an addition waits for the one before.
#[inline(always)]
pub fn dot_by_four<S, T, const N: usize>(a: &[S; N], b: &[T; N]) -> S
where
    S: Scalar + Mul<T, Output = S>,
    T: Copy,
{
    let mut sums = [S::zero(); 4];
    let (a4, a) = a.as_chunks::<4>();
    let (b4, b) = b.as_chunks::<4>();
    for (a, b) in a4.iter().zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = a.iter().zip(b).fold(S::zero(), |sum, (&a, &b)| sum + a * b);
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Σ a_i x at places\[i\], by four sums, because an addition waits for the one before.
#[inline(always)]
pub fn dot_at<S: Scalar>(a: &[S], places: &[usize], x: &[S]) -> S {
    let (a4, a) = a.as_chunks::<4>();
    let (places4, places) = places.as_chunks::<4>();
    let mut sums = [S::zero(); 4];
    for (a, places) in a4.iter().zip(places4) {
        (0..4).for_each(|k| sums[k] += a[k] * x[places[k]]);
    }
    for (sum, (&a, &place)) in sums.iter_mut().zip(a.iter().zip(places)) {
        *sum += a * x[place];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Adds `scale` times `x` to `out`.
pub fn add_scaled<S: Scalar>(out: &mut [S], scale: S, x: &[S]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}
