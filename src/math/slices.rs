//! Sums of products and scaled sums of slices, in any scalar.

use super::Scalar;

/// Σ a_i b_i over the common indices.
pub(crate) fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    let products = a.iter().zip(b);
    products.fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

/// Adds `scale` times `x` to `out`.
pub(crate) fn add_scaled<S: Scalar>(out: &mut [S], scale: S, x: &[S]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}
