//! Constant matrices of an element. Only those of its unknowns are stored that have entries: the membrane of a flat
//! plate has none for deflections, its bending none for displacements in the plane.

use crate::math::Scalar;
use crate::math::slices::{dot_by_four, vectorised};

/// Unknowns of an element at most: six of each of nine nodes.
pub const UNKNOWNS: usize = 54;

/// A matrix with N rows, by columns.
#[derive(Clone, Debug)]
pub struct Columns<const N: usize> {
    /// The unknowns of the columns, ascending.
    pub unknowns: Vec<usize>,
    /// The columns.
    pub entries: Vec<[f64; N]>,
}

impl<const N: usize> Columns<N> {
    /// The columns that are not zero.
    pub fn of(all: impl IntoIterator<Item = [f64; N]>) -> Self {
        let columns = all.into_iter().enumerate();
        let (unknowns, entries) = columns
            .filter(|(_, column)| column.iter().any(|&x| x != 0.0))
            .unzip();
        Self { unknowns, entries }
    }

    /// Each unknown with its column.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[f64; N])> {
        self.unknowns.iter().copied().zip(&self.entries)
    }

    /// The largest entry in the columns of some unknowns.
    pub fn largest(&self, of: impl Fn(usize) -> bool) -> f64 {
        let own = self.iter().filter(|(i, _)| of(*i));
        let all = own.flat_map(|(_, column)| column);
        all.fold(0.0, |most, x| most.max(x.abs()))
    }

    /// A x.
    pub fn times<S: Scalar>(&self, x: &[S]) -> [S; N] {
        vectorised(
            #[inline(always)]
            || {
                let mut out = [S::zero(); N];
                for (i, column) in self.iter() {
                    let x = x[i];
                    for (out, &a) in out.iter_mut().zip(column) {
                        *out += x * a;
                    }
                }
                out
            },
        )
    }

    /// Adds Aᵀ y.
    pub fn add_transposed<S: Scalar>(&self, y: &[S; N], out: &mut [S]) {
        vectorised(
            #[inline(always)]
            || {
                for (i, column) in self.iter() {
                    out[i] += dot_by_four(y, column);
                }
            },
        );
    }
}

/// A symmetric matrix.
#[derive(Clone, Debug)]
pub struct Symmetric {
    /// The unknowns of its rows and columns, ascending.
    unknowns: Vec<usize>,
    /// By rows.
    entries: Vec<f64>,
}

impl Symmetric {
    /// The rows and columns of a symmetric matrix that are not zero.
    pub fn of(matrix: &[f64], order: usize) -> Self {
        let row = |i: usize| &matrix[i * order..(i + 1) * order];
        let own = |i: &usize| row(*i).iter().any(|&x| x != 0.0);
        let unknowns: Vec<usize> = (0..order).filter(own).collect();
        let of_row = |&i: &usize| unknowns.iter().map(move |&j| row(i)[j]);
        let entries = unknowns.iter().flat_map(of_row).collect();
        Self { unknowns, entries }
    }

    /// Adds `scale` A x.
    pub fn add_product<S: Scalar>(&self, scale: S, x: &[S], out: &mut [S]) {
        let n = self.unknowns.len();
        let (mut own, mut sum) = ([S::zero(); UNKNOWNS], [S::zero(); UNKNOWNS]);
        for (own, &i) in own.iter_mut().zip(&self.unknowns) {
            *own = x[i] * scale;
        }
        // Rows are columns. Four at a time read and write the sum once.
        let sum = &mut sum[..n];
        let (fours, rest) = own[..n].as_chunks::<4>();
        vectorised(
            #[inline(always)]
            || {
                for (x, rows) in fours.iter().zip(self.entries.chunks_exact(4 * n.max(1))) {
                    let (a, others) = rows.split_at(n);
                    let (b, others) = others.split_at(n);
                    let (c, d) = others.split_at(n);
                    for k in 0..n {
                        sum[k] += (x[0] * a[k] + x[1] * b[k]) + (x[2] * c[k] + x[3] * d[k]);
                    }
                }
                let last = self.entries[4 * fours.len() * n..].chunks_exact(n.max(1));
                for (&x, row) in rest.iter().zip(last) {
                    for (sum, &a) in sum.iter_mut().zip(row) {
                        *sum += x * a;
                    }
                }
            },
        );
        for (&i, &sum) in self.unknowns.iter().zip(&*sum) {
            out[i] += sum;
        }
    }

    /// Row, column and value of all stored entries.
    pub fn entries(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        let n = self.unknowns.len().max(1);
        let all = self.entries.iter().enumerate();
        all.map(move |(k, &x)| ([self.unknowns[k / n], self.unknowns[k % n]], x))
    }

    /// xᵀ A y.
    pub fn inner<S: Scalar>(&self, x: &[S], y: &[S]) -> S {
        let mut product = [S::zero(); UNKNOWNS];
        self.add_product(S::one(), y, &mut product);
        let own = self.unknowns.iter();
        own.fold(S::zero(), |sum, &i| sum + x[i] * product[i])
    }

    /// Adds `scale` A to a matrix of order n, by rows.
    pub fn add_to<S: Scalar>(&self, scale: S, n: usize, out: &mut [S]) {
        let rows = self.entries.chunks_exact(self.unknowns.len().max(1));
        for (&i, row) in self.unknowns.iter().zip(rows) {
            let out = &mut out[i * n..(i + 1) * n];
            for (&j, &a) in self.unknowns.iter().zip(row) {
                out[j] += scale * a;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of order 9 with zeros in rows and columns 2 and 6.
    #[test]
    fn products_leave_out_nothing_but_zeros() {
        let n = 9;
        let zero = |i: usize| i == 2 || i == 6;
        let entry = |i: usize, j: usize| match zero(i) || zero(j) {
            true => 0.0,
            false => 1.0 / (1 + i + j) as f64 + f64::from(u8::from(i == j)),
        };
        let full: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let x: Vec<f64> = (0..n).map(|i| 0.3 * i as f64 - 1.0).collect();
        let product = |i: usize| (0..n).map(|j| entry(i, j) * x[j]).sum::<f64>();
        let own = Symmetric::of(&full, n);
        assert_eq!(own.unknowns.len(), n - 2);
        let (mut out, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
        own.add_product(2.0, &x, &mut out);
        own.add_to(1.0, n, &mut matrix);
        assert_eq!(matrix, full);
        let energy: f64 = (0..n).map(|i| x[i] * product(i)).sum();
        assert!((own.inner(&x, &x) - energy).abs() < 1e-14);
        let columns = Columns::<5>::of((0..n).map(|j| std::array::from_fn(|i| entry(i, j))));
        assert_eq!(columns.unknowns, own.unknowns);
        let rows = columns.times(&x);
        for i in 0..n {
            assert!((out[i] - 2.0 * product(i)).abs() < 1e-14);
            if i < 5 {
                assert!((rows[i] - product(i)).abs() < 1e-14);
            }
        }
        let y = [1.0, -2.0, 0.5, 3.0, 0.25];
        let mut by = vec![0.0; n];
        columns.add_transposed(&y, &mut by);
        for j in 0..n {
            let found: f64 = (0..5).map(|i| y[i] * entry(i, j)).sum();
            assert!((by[j] - found).abs() < 1e-14);
        }
    }
}
