//! Unit rows of G by their entries: sparse products, the normal equations, and a pivoted Gram–Schmidt process.

use crate::linalg::cholesky::{SparseCholesky, SymmetricPattern, fill_reducing_order};
use nalgebra::{DMatrix, DVector};

/// A unit row is dependent if its part across the others is smaller.
const DEPENDENT: f64 = 1e-11;
/// An earlier row is preferred if its part is at least this fraction of the largest.
const PREFERRED: f64 = 0.1;
/// Weight that keeps the normal equations regular, relative to unit rows.
const REGULAR: f64 = 1e-10;

/// The entries of a row, ascending by column.
type Entries = Vec<(usize, f64)>;

/// Rows of unit length, with the factors that normalise them.
pub(super) struct UnitRows {
    rows: Vec<Entries>,
    /// Number of columns.
    columns: usize,
    /// By row: its factor.
    pub scales: Vec<f64>,
}

impl UnitRows {
    /// Rows with these entries, ascending by column, each divided by its length.
    pub fn new(mut rows: Vec<Entries>, columns: usize) -> Self {
        let scales: Vec<f64> = rows.iter().map(|row| 1.0 / norm(row)).collect();
        for (row, scale) in rows.iter_mut().zip(&scales) {
            row.iter_mut().for_each(|(_, x)| *x *= scale);
        }
        Self {
            rows,
            columns,
            scales,
        }
    }

    /// Gᵀ as a matrix.
    pub fn transposed(&self) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.columns, self.rows.len());
        for (i, row) in self.rows.iter().enumerate() {
            row.iter().for_each(|&(k, x)| out[(k, i)] = x);
        }
        out
    }

    /// Gᵀ x.
    pub fn combined(&self, x: &[f64]) -> DVector<f64> {
        let mut out = DVector::zeros(self.columns);
        for (row, x) in self.rows.iter().zip(x) {
            row.iter().for_each(|&(k, g)| out[k] += g * x);
        }
        out
    }

    /// G v.
    pub fn products(&self, v: &DVector<f64>) -> Vec<f64> {
        let along = |row: &Entries| row.iter().map(|&(k, g)| g * v[k]).sum();
        self.rows.iter().map(along).collect()
    }

    /// Factors of G Gᵀ, regularised where rows are dependent; `None` if a number is not finite.
    pub fn normal(&self) -> Option<Normal> {
        let mut by_column: Vec<Vec<usize>> = vec![Vec::new(); self.columns];
        for (i, row) in self.rows.iter().enumerate() {
            row.iter().for_each(|&(k, _)| by_column[k].push(i));
        }
        let after = |i: usize| {
            let own = self.rows[i].iter().flat_map(|&(k, _)| &by_column[k]);
            let mut all: Vec<usize> = own.copied().filter(|&j| j > i).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let neighbours: Vec<Vec<usize>> = (0..self.rows.len()).map(after).collect();
        let order = fill_reducing_order(&neighbours);
        let mut place = vec![0; order.len()];
        for (k, &i) in order.iter().enumerate() {
            place[i] = k;
        }
        let mut columns: Vec<Vec<usize>> = (0..order.len()).map(|k| vec![k]).collect();
        for (i, others) in neighbours.iter().enumerate() {
            for &j in others {
                let (a, b) = (place[i].min(place[j]), place[i].max(place[j]));
                columns[a].push(b);
            }
        }
        columns.iter_mut().for_each(|own| own.sort_unstable());
        let pattern = SymmetricPattern::new(&columns);
        let mut values = Vec::with_capacity(pattern.entries());
        let mut dense = vec![0.0; self.columns];
        for (k, own) in columns.iter().enumerate() {
            scatter(&self.rows[order[k]], 1.0, &mut dense);
            values.extend(own.iter().map(|&l| match l == k {
                true => 1.0 + REGULAR,
                false => dot(&self.rows[order[l]], &dense),
            }));
            scatter(&self.rows[order[k]], 0.0, &mut dense);
        }
        let mut factors = SparseCholesky::new(&pattern);
        factors.factorise(&pattern, &values).ok()?;
        Some(Normal { order, factors })
    }

    /// Rows in an order in which each is independent of those before, and the others follow: the first whose part across
    /// those before is not small relative to the largest such part, which is told.
    pub fn independent(self) -> Vec<(usize, f64)> {
        let mut rows = self.rows;
        let mut sizes: Vec<f64> = rows.iter().map(norm).collect();
        let mut dense = vec![0.0; self.columns];
        let mut order = Vec::new();
        loop {
            let largest = sizes.iter().fold(0.0_f64, |m, &x| m.max(x));
            if largest <= DEPENDENT {
                return order;
            }
            let first = sizes.iter().position(|&x| x >= PREFERRED * largest);
            let Some(first) = first else { return order };
            order.push((first, largest));
            let pivot = std::mem::take(&mut rows[first]);
            scatter(&pivot, 1.0 / sizes[first], &mut dense);
            sizes[first] = 0.0;
            for (row, size) in rows.iter_mut().zip(&mut sizes) {
                // Dependent rows and those that have gone count no more.
                if *size <= DEPENDENT {
                    continue;
                }
                let along = dot(row, &dense);
                if along != 0.0 {
                    subtract(row, along, (&pivot, &dense));
                    *size = norm(row);
                }
            }
            scatter(&pivot, 0.0, &mut dense);
        }
    }
}

/// Factors of the normal equations.
pub(super) struct Normal {
    /// By row of the factors: the row of G.
    order: Vec<usize>,
    factors: SparseCholesky,
}

impl Normal {
    /// (G Gᵀ)⁻¹ b.
    pub fn solve(&mut self, b: &[f64]) -> Vec<f64> {
        let mut permuted: Vec<f64> = self.order.iter().map(|&i| b[i]).collect();
        self.factors.solve(&mut permuted);
        let mut out = vec![0.0; b.len()];
        for (&i, x) in self.order.iter().zip(permuted) {
            out[i] = x;
        }
        out
    }
}

fn norm(row: &Entries) -> f64 {
    row.iter().map(|(_, x)| x * x).sum::<f64>().sqrt()
}

fn dot(row: &Entries, dense: &[f64]) -> f64 {
    row.iter().map(|&(k, x)| x * dense[k]).sum()
}

/// Sets the places of a row in `dense` to its entries times `scale`.
fn scatter(row: &Entries, scale: f64, dense: &mut [f64]) {
    row.iter().for_each(|&(k, x)| dense[k] = x * scale);
}

/// Subtracts `along` times a pivot with these places, whose entries are in `dense`.
fn subtract(row: &mut Entries, along: f64, (pivot, dense): (&Entries, &[f64])) {
    let mut out = Vec::with_capacity(row.len() + pivot.len());
    let mut others = pivot.iter().map(|own| own.0).peekable();
    for &(k, x) in &*row {
        while let Some(&l) = others.peek().filter(|&&l| l < k) {
            out.push((l, -along * dense[l]));
            others.next();
        }
        others.next_if_eq(&k);
        out.push((k, x - along * dense[k]));
    }
    out.extend(others.map(|l| (l, -along * dense[l])));
    *row = out;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a chain of loops, with one that follows from two others in each.
    fn chain(count: usize) -> UnitRows {
        let mut rows: Vec<Entries> = Vec::new();
        for k in 0..count {
            let at = 2 * k;
            rows.push(vec![(at, 1.0), (at + 1, 0.5), (at + 2, -1.0)]);
            rows.push(vec![(at, 0.25), (at + 3, 1.0)]);
            rows.push(vec![
                (at, 1.25),
                (at + 1, 0.5),
                (at + 2, -1.0),
                (at + 3, 1.0),
            ]);
        }
        UnitRows::new(rows, 2 * count + 2)
    }

    #[test]
    fn rows_that_follow_from_others_are_left_out() {
        for count in [1, 7, 100] {
            let kept: Vec<usize> = chain(count).independent().iter().map(|own| own.0).collect();
            let expected: Vec<usize> = (0..3 * count).filter(|i| i % 3 != 2).collect();
            assert_eq!(kept, expected);
        }
    }

    #[test]
    fn the_normal_equations_are_those_of_the_matrix() {
        let rows = chain(5);
        let g = rows.transposed();
        let b: Vec<f64> = (0..15).map(|i| (1.0 + f64::from(i)).sin()).collect();
        // A right-hand side in the range of G.
        let b = rows.products(&rows.combined(&b));
        let x = rows.normal().expect("is regular").solve(&b);
        let back = g.tr_mul(&(&g * DVector::from_vec(x)));
        for (found, expected) in back.iter().zip(&b) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
