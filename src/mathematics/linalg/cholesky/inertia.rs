//! Number of negative eigenvalues of a matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::{Conj, MatMut, Par, Side};

use super::pattern::structure;
use super::{SparseCholesky, SymmetricPattern, norm};

/// Largest residual of a solution by L D Lᵀ, relative to the right side, with trustworthy pivots.
const SOUND_PIVOTS: f64 = 1e-4;

impl SparseCholesky {
    /// Number of negative eigenvalues of the matrix: the number of negative pivots of L D Lᵀ, by
    /// Sylvester's law of inertia. `None` if round-off spoils the pivots. The factors are
    /// overwritten.
    pub fn negative_eigenvalues(
        &mut self,
        pattern: &SymmetricPattern,
        values: &[f64],
    ) -> Option<usize> {
        for j in 0..pattern.order() {
            let diagonal = values[pattern.starts[j]].abs();
            self.scale[j] = if diagonal > 0.0 {
                1.0 / diagonal.sqrt()
            } else {
                1.0
            };
        }
        self.scale_values(pattern, values);
        let needed = self
            .symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let solve = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut scratch = MemBuffer::new(needed.or(solve));
        let factors = self
            .symbolic
            .factorize_numeric_ldlt(
                &mut self.factors,
                SparseColMatRef::new(structure(pattern), &self.scaled),
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut scratch),
                Default::default(),
            )
            .ok()?;
        // Pivots are not exchanged. The residual of a solution shows whether they have grown.
        let right: Vec<f64> = (0..pattern.order()).map(|i| (i as f64).sin()).collect();
        let mut x = right.clone();
        factors.solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut x, pattern.order(), 1),
            Par::Seq,
            MemStack::new(&mut scratch),
        );
        let mut rest = vec![0.0; right.len()];
        pattern.multiply(&self.scaled, &x, &mut rest);
        for (r, b) in rest.iter_mut().zip(&right) {
            *r -= b;
        }
        let pivots = self.pivots();
        let sound = norm(&rest) <= SOUND_PIVOTS * norm(&right) && pivots.iter().all(|d| *d != 0.0);
        sound.then(|| pivots.iter().filter(|d| **d < 0.0).count())
    }

    /// The diagonal D of L D Lᵀ.
    fn pivots(&self) -> Vec<f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let columns = symbolic.col_ptr();
                let starts = &columns[..columns.len() - 1];
                starts.iter().map(|&start| self.factors[start]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factors = SupernodalLdltRef::<usize, f64>::new(symbolic, &self.factors);
                let blocks = 0..symbolic.n_supernodes();
                let widths = symbolic
                    .supernode_begin()
                    .iter()
                    .zip(symbolic.supernode_end());
                blocks
                    .zip(widths)
                    .flat_map(|(s, (begin, end))| {
                        let block = factors.supernode(s).val();
                        (0..end - begin).map(move |j| block[(j, j)])
                    })
                    .collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second difference of order n has the eigenvalues 4 sin²(kπ / 2(n + 1)). Minus μ I it has
    /// as many negative ones as lie below μ. Factors of small orders are simplicial, large banded
    /// ones may not be.
    #[test]
    fn negative_pivots_count_the_eigenvalues_below() {
        for (order, band) in [(5, 1), (60, 1), (400, 40)] {
            let columns: Vec<Vec<usize>> = (0..order)
                .map(|j| (j..order.min(j + band + 1)).collect())
                .collect();
            let pattern = SymmetricPattern::new(&columns);
            let mut solver = SparseCholesky::new(&pattern);
            let angle = |k: usize| (k as f64) * std::f64::consts::PI / (2.0 * (order as f64 + 1.0));
            for below in [0, 1, order / 3, order - 1, order] {
                // Between two eigenvalues.
                let mu = 4.0 * (angle(below) + 0.37 * angle(1)).sin().powi(2);
                let mut values = vec![0.0; pattern.entries()];
                for j in 0..order {
                    values[pattern.slot(j, j).expect("diagonal")] = 2.0 - mu;
                    if j + 1 < order {
                        values[pattern.slot(j + 1, j).expect("band")] = -1.0;
                    }
                }
                assert_eq!(solver.negative_eigenvalues(&pattern, &values), Some(below));
            }
        }
    }
}
