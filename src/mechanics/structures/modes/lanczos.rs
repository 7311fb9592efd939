//! The largest eigenvalues of a self-adjoint operator by block Lanczos with full reorthogonalisation and
//! thick restarts (Wu & Simon 2000, on blocks).
//!
//! The operator is A = (K + sM)⁻¹ M in the inner product of M. The basis V is M-orthonormal, H = VᵀMAV
//! is kept whole, so a restart puts Ritz vectors in the place of V and their values on the diagonal of H.

use crate::math::slices::dot;
use nalgebra::{DMatrix, SymmetricEigen};

/// Vectors of a block.
const BLOCK: usize = 4;
/// Residual ‖A x − θ x‖ relative to θ at which a pair has converged.
const TOLERANCE: f64 = 1e-12;
/// A vector is no new direction if orthogonalisation leaves less than this part of it.
const DEPENDENT: f64 = 1e-11;
/// Largest number of blocks that are solved for.
const MOST_BLOCKS: usize = 2000;

/// A self-adjoint operator (K + sM)⁻¹ M.
pub trait Operator {
    /// Order of the matrices.
    fn order(&self) -> usize;
    /// y = M x.
    fn mass(&self, x: &[f64], y: &mut [f64]);
    /// Solves (K + sM) X = B in place, the columns of B one after another.
    fn solve(&mut self, b: &mut [f64]);
}

/// M-orthonormal vectors with their products with M.
#[derive(Default)]
pub struct Basis {
    pub vectors: Vec<Vec<f64>>,
    pub products: Vec<Vec<f64>>,
}

impl Basis {
    pub fn len(&self) -> usize {
        self.vectors.len()
    }

    /// Subtracts from `w` its parts along the basis, twice; returns the parts.
    pub fn orthogonalise(&self, w: &mut [f64]) -> Vec<f64> {
        let mut parts = vec![0.0; self.len()];
        for _ in 0..2 {
            for ((v, product), part) in self.vectors.iter().zip(&self.products).zip(&mut parts) {
                let along = dot(product, w);
                *part += along;
                for (w, v) in w.iter_mut().zip(v) {
                    *w -= along * v;
                }
            }
        }
        parts
    }

    /// Scales a vector that is orthogonal to the others and adds it; returns its length before, or
    /// `None` if that is not above `least`.
    pub fn push(&mut self, operator: &impl Operator, mut w: Vec<f64>, least: f64) -> Option<f64> {
        let mut product = vec![0.0; w.len()];
        operator.mass(&w, &mut product);
        let square = dot(&w, &product);
        let length = square.max(0.0).sqrt();
        if !(length > least && length > 0.0) {
            return None;
        }
        w.iter_mut().for_each(|x| *x /= length);
        product.iter_mut().for_each(|x| *x /= length);
        self.vectors.push(w);
        self.products.push(product);
        Some(length)
    }

    /// Σ_j y_j v_j.
    fn combine(list: &[Vec<f64>], y: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sum = vec![0.0; list[0].len()];
        for (v, y) in list.iter().zip(y) {
            for (s, v) in sum.iter_mut().zip(v) {
                *s += y * v;
            }
        }
        sum
    }
}

/// What [`largest`] found.
pub struct Found {
    /// The vectors, those of the largest eigenvalues first, M-orthonormal.
    pub vectors: Vec<Vec<f64>>,
    /// Right sides that were solved for.
    pub solves: usize,
    /// True if there are no other eigenvalues but zeros.
    pub exhausted: bool,
}

/// Numbers in (−1, 1) that look random, the same in every run.
fn random(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed
        .wrapping_mul(2862933555777941757)
        .wrapping_add(3037000493);
    (0..n)
        .map(|_| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// The `wanted` largest eigenvalues in the space orthogonal to `locked`; fewer if there are no
/// more, or if they do not converge. Copies of an eigenvalue beyond the size of a block may be
/// missed, so the caller must count.
pub fn largest(operator: &mut impl Operator, locked: &Basis, wanted: usize, seed: u64) -> Found {
    let n = operator.order();
    let most = (2 * wanted + 8 * BLOCK).max(60);
    let mut basis = Basis::default();
    let mut h = DMatrix::<f64>::zeros(most + 2 * BLOCK, most + 2 * BLOCK);
    // A start in the range of A: no part without mass.
    let mut start = vec![0.0; n * BLOCK];
    for (k, column) in start.chunks_exact_mut(n.max(1)).enumerate() {
        operator.mass(&random(seed + k as u64, n), column);
    }
    operator.solve(&mut start);
    let mut solves = BLOCK;
    for column in start.chunks_exact(n.max(1)) {
        let mut w = column.to_vec();
        let size = {
            let mut product = vec![0.0; n];
            operator.mass(&w, &mut product);
            dot(&w, &product).max(0.0).sqrt()
        };
        locked.orthogonalise(&mut w);
        basis.orthogonalise(&mut w);
        basis.push(operator, w, DEPENDENT * size);
    }
    let mut open = 0..basis.len();
    for _ in 0..MOST_BLOCKS {
        let old = basis.len();
        let mut block: Vec<f64> = basis.products[open.clone()].concat();
        if !open.is_empty() {
            operator.solve(&mut block);
            solves += open.len();
        }
        for (c, column) in open.clone().zip(block.chunks_exact(n.max(1))) {
            let mut w = column.to_vec();
            let size = dot(&w, &basis.products[c]).abs();
            locked.orthogonalise(&mut w);
            let parts = basis.orthogonalise(&mut w);
            for (j, part) in parts.into_iter().enumerate() {
                h[(j, c)] = part;
                h[(c, j)] = part;
            }
            let new = basis.len();
            if let Some(length) = basis.push(operator, w, DEPENDENT * size) {
                h[(new, c)] = length;
                h[(c, new)] = length;
            }
        }
        let new = old..basis.len();
        let (values, y) = ritz(&h, old);
        // The residual of a Ritz pair is in the new vectors.
        let residual = |i: usize| {
            let squares = new.clone().map(|r| {
                let sum: f64 = open.clone().map(|c| h[(r, c)] * y[(c, i)]).sum();
                sum * sum
            });
            squares.sum::<f64>().sqrt()
        };
        let converged = (0..values.len().min(wanted))
            .take_while(|&i| residual(i) <= TOLERANCE * values[i])
            .count();
        let exhausted = new.is_empty();
        if converged == wanted || exhausted {
            let count = if exhausted {
                values.len().min(wanted)
            } else {
                converged
            };
            let combine = |i: usize| Basis::combine(&basis.vectors, y.column(i).iter().copied());
            return Found {
                vectors: (0..count).map(combine).collect(),
                exhausted: exhausted && values.len() <= wanted,
                solves,
            };
        }
        open = new;
        if basis.len() + BLOCK > most {
            open = restart(&mut basis, &mut h, &values, &y, old, wanted + BLOCK);
        }
    }
    Found {
        vectors: Vec::new(),
        solves,
        exhausted: false,
    }
}

/// Eigenvalues, the largest first, and vectors of the leading part of H.
fn ritz(h: &DMatrix<f64>, order: usize) -> (Vec<f64>, DMatrix<f64>) {
    if order == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let part = h.view((0, 0), (order, order)).into_owned();
    let eigen = SymmetricEigen::new(part);
    let mut by_size: Vec<usize> = (0..order).collect();
    by_size.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let values = by_size.iter().map(|&k| eigen.eigenvalues[k]).collect();
    let columns: Vec<_> = by_size
        .iter()
        .map(|&k| eigen.eigenvectors.column(k))
        .collect();
    (values, DMatrix::from_columns(&columns))
}

/// Keeps the best Ritz vectors and the newest block; returns the place of that block.
fn restart(
    basis: &mut Basis,
    h: &mut DMatrix<f64>,
    values: &[f64],
    y: &DMatrix<f64>,
    old: usize,
    keep: usize,
) -> std::ops::Range<usize> {
    let keep = keep.min(old);
    let combine = |list: &[Vec<f64>]| -> Vec<Vec<f64>> {
        (0..keep)
            .map(|i| Basis::combine(list, y.column(i).iter().copied()))
            .collect()
    };
    let mut next = Basis {
        vectors: combine(&basis.vectors[..old]),
        products: combine(&basis.products[..old]),
    };
    let new = old..basis.len();
    let mut coupling = DMatrix::<f64>::zeros(new.len(), keep);
    for (r, row) in new.clone().enumerate() {
        for i in 0..keep {
            coupling[(r, i)] = (0..old).map(|c| h[(row, c)] * y[(c, i)]).sum();
        }
    }
    next.vectors.extend(basis.vectors.drain(new.clone()));
    next.products.extend(basis.products.drain(new.clone()));
    *basis = next;
    h.fill(0.0);
    for i in 0..keep {
        h[(i, i)] = values[i];
        for r in 0..new.len() {
            h[(keep + r, i)] = coupling[(r, i)];
            h[(i, keep + r)] = coupling[(r, i)];
        }
    }
    keep..keep + new.len()
}
