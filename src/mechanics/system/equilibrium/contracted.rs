//! Numbers lᵀ (a K + b D + c M) r, from which the derivatives of vibrations follow.

use super::pencil::{At, emit_pencil};
use super::turning::Weights;
use crate::linalg::Emit;
use crate::math::{Complex64, Scalar};
use crate::system::bodies::BodyMotion;
use crate::system::{flexible, reduce};

/// A pair of vectors, and the factors of K, D and M between them.
pub(super) struct Between<'a> {
    pub left: &'a [Complex64],
    pub right: &'a [Complex64],
    pub factors: [Complex64; 3],
}

/// By pair: real and imaginary part of lᵀ (a K + b D + c M) r in any scalar, with the rows of constraints in K.
///
/// The strain energy of finite elements is taken by elements, which leaves less round-off than its entries in K and D.
pub(super) fn contracted<S: Scalar>(at: At<S>, pairs: &[Between]) -> Vec<[S; 2]> {
    let mut sums = vec![[S::zero(); 2]; pairs.len()];
    let without_strains = flexible::without_strains(at.model);
    let rest = At {
        model: without_strains.as_ref().unwrap_or(at.model),
        ..at
    };
    for which in 0..3 {
        let zero = Complex64::new(0.0, 0.0);
        if pairs.iter().all(|pair| pair.factors[which] == zero) {
            continue;
        }
        let weight = |k: usize| if k == which { S::one() } else { S::zero() };
        let weights = Weights {
            stiffness: weight(0),
            damping: weight(1),
            mass: weight(2),
        };
        let mut product = Contracted {
            pairs,
            which,
            sums: &mut sums,
        };
        emit_pencil(rest, weights, &mut product);
    }
    if without_strains.is_some() {
        add_strain_energies(at, pairs, &mut sums);
    }
    sums
}

struct Contracted<'a, S> {
    pairs: &'a [Between<'a>],
    which: usize,
    sums: &'a mut [[S; 2]],
}

impl<S: Scalar> Emit<S> for Contracted<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        for (pair, sum) in self.pairs.iter().zip(self.sums.iter_mut()) {
            let weight = pair.left[row] * pair.right[column] * pair.factors[self.which];
            sum[0] += value * weight.re;
            sum[1] += value * weight.im;
        }
    }
}

/// Adds the shares of the strain energies of finite elements in K, and in D of their damping.
fn add_strain_energies<S: Scalar>(at: At<S>, pairs: &[Between], sums: &mut [[S; 2]]) {
    let (model, numbering) = (at.model, at.numbering);
    let ([speeds, _], _) = at.motion();
    let mut motions = Vec::new();
    BodyMotion::all(numbering, at.q, &speeds, &mut motions);
    // In velocity numbering, of the real or of the imaginary part; none if it is zero.
    let part = |x: &[Complex64], part: fn(&Complex64) -> f64| -> Option<Vec<S>> {
        let unknowns = x[..numbering.unknowns()].iter().map(part);
        let out = reduce::expanded(numbering, unknowns.map(S::from).collect());
        out.iter().any(|&x| x != S::zero()).then_some(out)
    };
    let parts = |x: &[Complex64]| [part(x, |x| x.re), part(x, |x| x.im)];
    for (pair, sum) in pairs.iter().zip(sums) {
        let (left, right) = (parts(pair.left), parts(pair.right));
        for (i, l) in left.iter().enumerate() {
            for (j, r) in right.iter().enumerate() {
                let (Some(l), Some(r)) = (l, r) else {
                    continue;
                };
                let products = flexible::strain_products((model, numbering), &motions, [l, r]);
                let unit = Complex64::new(0.0, 1.0).powu((i + j) as u32);
                for (product, factor) in products.into_iter().zip(pair.factors) {
                    let weight = unit * factor;
                    sum[0] += product * weight.re;
                    sum[1] += product * weight.im;
                }
            }
        }
    }
}
