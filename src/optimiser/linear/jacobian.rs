//! The Jacobian of the constraints, row by row.

use std::ops::{Index, Mul};

use nalgebra::{DMatrix, DVector};

/// The matrix ∂c_j/∂x_i, kept row by row. A row lists the variables on which it may depend; all
/// other entries are zero.
///
/// ```
/// use flexbody_optimiser::Jacobian;
/// let dense = Jacobian::dense(2, 3, vec![1.0, 0.0, 2.0, 0.0, 3.0, 0.0]);
/// let sparse = Jacobian::sparse(2, 3, [(0, 0, 1.0), (0, 2, 2.0), (1, 1, 3.0)]);
/// assert_eq!(dense[(0, 2)], sparse[(0, 2)]);
/// assert_eq!(sparse[(1, 0)], 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobian {
    columns: usize,
    /// Where each row begins, and where the last one ends.
    starts: Vec<usize>,
    index: Vec<usize>,
    value: Vec<f64>,
}

impl Jacobian {
    /// A full matrix of `rows` × `columns` from its rows, one after the other. If `values` has
    /// another length, the optimiser refuses the matrix.
    #[must_use]
    pub fn dense(rows: usize, columns: usize, values: Vec<f64>) -> Jacobian {
        if values.len() != rows * columns {
            // No matrix of the program has this shape.
            let starts = vec![0, values.len()];
            let index = (0..values.len()).collect();
            return Jacobian {
                columns: usize::MAX,
                starts,
                index,
                value: values,
            };
        }
        Jacobian {
            columns,
            starts: (0..=rows).map(|j| j * columns).collect(),
            index: (0..rows * columns).map(|k| k % columns).collect(),
            value: values,
        }
    }

    /// The full matrix of the entries `entry(j, i)`.
    pub fn from_fn(
        rows: usize,
        columns: usize,
        mut entry: impl FnMut(usize, usize) -> f64,
    ) -> Self {
        let values = (0..rows * columns).map(|k| entry(k / columns, k % columns));
        Jacobian::dense(rows, columns, values.collect())
    }

    /// A matrix of the given entries (j, i, ∂c_j/∂x_i), in any order. Entries of the same place are
    /// added. A place outside of the matrix makes it wider or longer; the optimiser then refuses
    /// it.
    pub fn sparse(
        rows: usize,
        columns: usize,
        entries: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Jacobian {
        let mut all: Vec<(usize, usize, f64)> = entries.into_iter().collect();
        all.sort_by_key(|&(j, i, _)| (j, i));
        all.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        let rows = all.last().map_or(rows, |e| rows.max(e.0 + 1));
        let columns = all.iter().fold(columns, |n, e| n.max(e.1 + 1));
        let mut starts = vec![0; rows + 1];
        for &(j, _, _) in &all {
            starts[j + 1] += 1;
        }
        for j in 0..rows {
            starts[j + 1] += starts[j];
        }
        Jacobian {
            columns,
            starts,
            index: all.iter().map(|e| e.1).collect(),
            value: all.iter().map(|e| e.2).collect(),
        }
    }

    /// A matrix of rows, each a list of (variable, entry) with rising variables.
    pub(crate) fn from_rows(
        columns: usize,
        rows: impl Iterator<Item = Vec<(usize, f64)>>,
    ) -> Jacobian {
        let mut found = Jacobian {
            columns,
            starts: vec![0],
            index: Vec::new(),
            value: Vec::new(),
        };
        for row in rows {
            for (i, v) in row {
                found.index.push(i);
                found.value.push(v);
            }
            found.starts.push(found.index.len());
        }
        found
    }

    /// Number of rows and of columns.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.starts.len() - 1, self.columns)
    }

    /// Number of entries that are kept.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.value.len()
    }

    /// The entries of row `j`: variable and derivative.
    pub fn row(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let part = self.starts[j]..self.starts[j + 1];
        let index = self.index[part.clone()].iter().copied();
        index.zip(self.value[part].iter().copied())
    }

    /// The sum Σ y_j ∇c_j over all rows.
    #[must_use]
    pub fn weighted_sum(&self, y: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.columns];
        for (j, y) in y.iter().enumerate() {
            for (i, v) in self.row(j) {
                sum[i] += y * v;
            }
        }
        sum
    }

    /// Multiplies all entries by `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.value.iter_mut().for_each(|v| *v *= factor);
    }

    /// Aᵀ y.
    pub(crate) fn tr_mul(&self, y: &DVector<f64>) -> DVector<f64> {
        DVector::from_vec(self.weighted_sum(y.as_slice()))
    }

    /// Product of row `j` and `x`.
    pub(crate) fn row_dot(&self, j: usize, x: &DVector<f64>) -> f64 {
        self.row(j).map(|(i, v)| v * x[i]).sum()
    }

    /// Largest entry of row `j`, without its sign.
    pub(crate) fn row_amax(&self, j: usize) -> f64 {
        self.row(j).fold(0.0, |a, (_, v)| a.max(v.abs()))
    }

    /// Largest entry, without its sign.
    pub(crate) fn amax(&self) -> f64 {
        self.value.iter().fold(0.0, |a, v| a.max(v.abs()))
    }

    /// Multiplies row `j` by `factor`.
    pub(crate) fn scale_row(&mut self, j: usize, factor: f64) {
        for v in &mut self.value[self.starts[j]..self.starts[j + 1]] {
            *v *= factor;
        }
    }

    /// Multiplies each column by its factor.
    pub(crate) fn scale_columns(&mut self, factors: &DVector<f64>) {
        for (&i, v) in self.index.iter().zip(&mut self.value) {
            *v *= factors[i];
        }
    }

    /// Whether each column has an entry that is not zero.
    pub(crate) fn touched(&self) -> Vec<bool> {
        let mut touched = vec![false; self.columns];
        for (&i, &v) in self.index.iter().zip(&self.value) {
            touched[i] |= v != 0.0;
        }
        touched
    }

    /// Whether `other` has its entries in the same places.
    pub(crate) fn has_pattern_of(&self, other: &Jacobian) -> bool {
        self.columns == other.columns && self.starts == other.starts && self.index == other.index
    }

    /// The rows of this matrix, then those of `below`.
    pub(crate) fn above(&self, below: &Jacobian) -> Jacobian {
        let mut all = self.clone();
        let end = self.index.len();
        all.starts
            .extend(below.starts[1..].iter().map(|at| end + at));
        all.index.extend(&below.index);
        all.value.extend(&below.value);
        all
    }

    /// As a matrix with all its zeros.
    pub(crate) fn to_dense(&self) -> DMatrix<f64> {
        let (m, n) = self.shape();
        let mut dense = DMatrix::zeros(m, n);
        for j in 0..m {
            for (i, v) in self.row(j) {
                dense[(j, i)] = v;
            }
        }
        dense
    }

    /// The places of the entries by columns: where each column begins, and for each entry its row
    /// and its number.
    pub(crate) fn by_columns(&self) -> (Vec<usize>, Vec<(usize, usize)>) {
        let mut starts = vec![0; self.columns + 1];
        for &i in &self.index {
            starts[i + 1] += 1;
        }
        for i in 0..self.columns {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut places = vec![(0, 0); self.index.len()];
        for j in 0..self.starts.len() - 1 {
            for k in self.starts[j]..self.starts[j + 1] {
                let place = &mut next[self.index[k]];
                places[*place] = (j, k);
                *place += 1;
            }
        }
        (starts, places)
    }

    /// All entries, row by row.
    pub(crate) fn values(&self) -> &[f64] {
        &self.value
    }
}

impl Index<(usize, usize)> for Jacobian {
    type Output = f64;

    fn index(&self, (j, i): (usize, usize)) -> &f64 {
        let (first, last) = (self.starts[j], self.starts[j + 1]);
        let found = self.index[first..last].binary_search(&i);
        found.map_or(&0.0, |k| &self.value[first + k])
    }
}

impl Mul<&DVector<f64>> for &Jacobian {
    type Output = DVector<f64>;

    fn mul(self, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.shape().0, |j, _| self.row_dot(j, x))
    }
}

impl From<DMatrix<f64>> for Jacobian {
    fn from(matrix: DMatrix<f64>) -> Jacobian {
        let (rows, columns) = matrix.shape();
        Jacobian::from_fn(rows, columns, |j, i| matrix[(j, i)])
    }
}
