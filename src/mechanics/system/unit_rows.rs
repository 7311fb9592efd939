//! Unit rows of G by their entries: sparse products, the normal equations, and a pivoted Gram–Schmidt process.

use crate::linalg::cholesky::{SparseCholesky, SymmetricPattern, fill_reducing_order};
use crate::math::slices;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A unit row is dependent if its part across the others is smaller.
const DEPENDENT: f64 = 1e-11;
/// An earlier row is preferred if its part is at least this fraction of the largest.
const PREFERRED: f64 = 0.1;
/// Weight that keeps the normal equations regular, relative to unit rows.
const REGULAR: f64 = 1e-10;
/// Rows keep all numbers between their first and last entry once more than one in so many is an entry.
const FULL: usize = 4;

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
        let mut rows: Vec<Row> = self.rows.into_iter().map(Row::Sparse).collect();
        let mut sizes: Vec<f64> = rows.iter().map(Row::norm).collect();
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
            let pivot = std::mem::replace(&mut rows[first], Row::Sparse(Vec::new()));
            let own = pivot.columns();
            pivot.scatter(1.0 / sizes[first], &mut dense);
            sizes[first] = 0.0;
            for (row, size) in rows.iter_mut().zip(&mut sizes) {
                // Dependent rows and those that have gone count no more.
                if *size <= DEPENDENT {
                    continue;
                }
                let along = row.dot(&dense, &own);
                if along != 0.0 {
                    row.subtract(along, (&pivot, &own), &dense);
                    *size = row.norm();
                }
            }
            dense[own].fill(0.0);
        }
    }
}

/// A row while others are subtracted, which fill it.
enum Row {
    Sparse(Entries),
    /// All numbers from a column on.
    Dense(usize, Vec<f64>),
}

impl Row {
    /// The columns between its first and last entry.
    fn columns(&self) -> Range<usize> {
        match self {
            Self::Sparse(own) => match (own.first(), own.last()) {
                (Some(first), Some(last)) => first.0..last.0 + 1,
                _ => 0..0,
            },
            Self::Dense(first, own) => *first..first + own.len(),
        }
    }

    fn norm(&self) -> f64 {
        match self {
            Self::Sparse(own) => norm(own),
            Self::Dense(_, own) => slices::dot(own, own).sqrt(),
        }
    }

    /// Sets its places in `dense` to its entries times `scale`.
    fn scatter(&self, scale: f64, dense: &mut [f64]) {
        match self {
            Self::Sparse(own) => scatter(own, scale, dense),
            Self::Dense(first, own) => {
                let places = dense[*first..].iter_mut().zip(own);
                places.for_each(|(to, x)| *to = x * scale);
            }
        }
    }

    /// The product with a vector that is zero beyond some columns.
    fn dot(&self, dense: &[f64], within: &Range<usize>) -> f64 {
        match self {
            Self::Sparse(own) => dot(own, dense),
            Self::Dense(first, own) => {
                let (from, to) = (within.start.max(*first), within.end.min(first + own.len()));
                match from < to {
                    true => slices::dot(&own[from - first..to - first], &dense[from..to]),
                    false => 0.0,
                }
            }
        }
    }

    /// Subtracts `along` times a pivot with these columns, whose entries are in `dense`.
    fn subtract(&mut self, along: f64, (pivot, within): (&Row, &Range<usize>), dense: &[f64]) {
        let own = self.columns();
        let (from, to) = (own.start.min(within.start), own.end.max(within.end));
        match (&mut *self, pivot) {
            (Self::Sparse(row), Row::Sparse(pivot))
                if FULL * (row.len() + pivot.len()) < to - from =>
            {
                subtract(row, along, (pivot, dense));
            }
            (Self::Dense(first, row), _) if (from, to) == (own.start, own.end) => {
                let row = &mut row[within.start - *first..within.end - *first];
                slices::add_scaled(row, -along, &dense[within.clone()]);
            }
            _ => {
                let mut wider = vec![0.0; to - from];
                match &*self {
                    Self::Sparse(row) => row.iter().for_each(|&(k, x)| wider[k - from] = x),
                    Self::Dense(first, row) => {
                        wider[first - from..][..row.len()].copy_from_slice(row);
                    }
                }
                let part = &mut wider[within.start - from..within.end - from];
                slices::add_scaled(part, -along, &dense[within.clone()]);
                *self = Self::Dense(from, wider);
            }
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

    /// Of rows that fill while others are subtracted, as many are kept as the rank, and they are independent.
    #[test]
    fn rows_that_fill_are_left_out_alike() {
        let (count, columns) = (60, 40);
        let number = |k: usize| ((k * 7919) as f64 * 0.618_033_988_7).fract() - 0.5;
        let mut rows: Vec<Entries> = (0..count)
            .map(|i| {
                let places = [i % columns, (7 * i + 3) % columns, (11 * i + 5) % columns];
                let mut own: Vec<usize> = places.to_vec();
                own.sort_unstable();
                own.dedup();
                own.iter().map(|&k| (k, number(i * columns + k))).collect()
            })
            .collect();
        // Some follow from their neighbours.
        for i in (4..count).step_by(5) {
            let mut sum = vec![0.0; columns];
            let others = rows[i - 1].iter().chain(&rows[i - 2]);
            others.for_each(|&(k, x)| sum[k] += x);
            let entries = sum.into_iter().enumerate();
            rows[i] = entries.filter(|own| own.1 != 0.0).collect();
        }
        let of = |which: &[usize]| {
            let chosen = which.iter().map(|&i| rows[i].clone()).collect();
            UnitRows::new(chosen, columns).transposed()
        };
        let all: Vec<usize> = (0..count).collect();
        let kept: Vec<usize> = UnitRows::new(rows.clone(), columns)
            .independent()
            .iter()
            .map(|own| own.0)
            .collect();
        assert_eq!(kept.len(), of(&all).rank(1e-9));
        assert_eq!(of(&kept).rank(1e-9), kept.len());
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
