//! Bases of vectors: orthonormal in the mass, vibrations of the held body, and combinations of
//! largest energy.

use super::matrices::Matrices;
use crate::math::slices::{add_scaled, dot};
use nalgebra::{DMatrix, SymmetricEigen};

/// A vector is no new direction if orthogonalisation leaves less than this part of it.
const DEPENDENT: f64 = 1e-7;

/// M-orthonormal vectors with their products with M.
#[derive(Clone, Debug, Default)]
pub(super) struct Subspace {
    pub vectors: Vec<Vec<f64>>,
    heavy: Vec<Vec<f64>>,
}

impl Subspace {
    /// Subtracts from x its part in the space.
    pub(super) fn remove(&self, x: &mut [f64]) {
        for _ in 0..2 {
            for (vector, heavy) in self.vectors.iter().zip(&self.heavy) {
                add_scaled(x, -dot(heavy, x), vector);
            }
        }
    }

    /// Adds the new direction of x; false if there is none.
    pub(super) fn add(&mut self, matrices: &Matrices, mut x: Vec<f64>) -> bool {
        let before = dot(&matrices.heavy(&x), &x).sqrt();
        self.remove(&mut x);
        let mut heavy = matrices.heavy(&x);
        let after = dot(&heavy, &x).max(0.0).sqrt();
        if !(after > DEPENDENT * before && after > 0.0) {
            return false;
        }
        for (x, heavy) in x.iter_mut().zip(&mut heavy) {
            *x /= after;
            *heavy /= after;
        }
        self.vectors.push(x);
        self.heavy.push(heavy);
        true
    }

    /// The same space by its vibrations, ascending in frequency \[rad/s\].
    pub(super) fn vibrations(self, matrices: &Matrices) -> (Self, Vec<f64>) {
        let n = self.vectors.len();
        if n == 0 {
            return (self, Vec::new());
        }
        let forces: Vec<Vec<f64>> = self.vectors.iter().map(|x| matrices.stiff(x)).collect();
        let gram = DMatrix::from_fn(n, n, |i, j| {
            0.5 * (dot(&self.vectors[i], &forces[j]) + dot(&self.vectors[j], &forces[i]))
        });
        let eigen = SymmetricEigen::new(gram);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let mut out = Self::default();
        for &i in &order {
            let column = eigen.eigenvectors.column(i);
            out.vectors.push(combine(&self.vectors, column.iter()));
            out.heavy.push(combine(&self.heavy, column.iter()));
        }
        let frequencies = order.iter().map(|&i| eigen.eigenvalues[i].max(0.0).sqrt());
        let frequencies = frequencies.collect();
        (out, frequencies)
    }
}

fn combine<'a>(list: &[Vec<f64>], y: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut sum = vec![0.0; list[0].len()];
    for (vector, &y) in list.iter().zip(y) {
        add_scaled(&mut sum, y, vector);
    }
    sum
}

/// Combinations of vectors, orthogonal in K, those of the largest strain energy first, until an energy is
/// below a part of the largest (proper orthogonal decomposition).
pub(super) fn principal(matrices: &Matrices, list: &[Vec<f64>], part: f64) -> Vec<Vec<f64>> {
    let n = list.len();
    if n == 0 {
        return Vec::new();
    }
    let forces: Vec<Vec<f64>> = list.iter().map(|x| matrices.stiff(x)).collect();
    let gram = DMatrix::from_fn(n, n, |i, j| {
        0.5 * (dot(&list[i], &forces[j]) + dot(&list[j], &forces[i]))
    });
    let eigen = SymmetricEigen::new(gram);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let least = part * eigen.eigenvalues[order[0]];
    let kept = order.into_iter().filter(|&i| eigen.eigenvalues[i] > least);
    kept.map(|i| combine(list, eigen.eigenvectors.column(i).iter()))
        .collect()
}
