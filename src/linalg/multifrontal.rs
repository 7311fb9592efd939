//! Multifrontal LU with known pivots: the elimination of structures with many coordinates, bordered by the
//! unknowns of frames and joints, whose pivots are searched last.
//!
//! Each front is a dense matrix. Its pivots are eliminated with a search among their own rows; the rest goes
//! to the parent (Duff & Reid 1983).

use super::fronts::{Front, Plan};
use super::pattern::{KnownPivots, Pattern, SparseMatrix};
use super::scaling::{Equilibration, size};
use super::sparse_lu::{SingularMatrix, SolveScalar};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Factors of a front of order f with p pivots, by columns.
struct Eliminated<S> {
    /// The row that was exchanged with each pivot row.
    exchanges: Vec<u32>,
    /// Its first p columns: L below the diagonal, U above.
    left: Vec<S>,
    /// U of the other columns, p × (f − p).
    upper: Vec<S>,
}

/// The elimination of matrices of one pattern.
pub(super) struct Multifrontal<S> {
    plan: Plan,
    scaling: Equilibration,
    scaled: Vec<S>,
    /// Inverse pivots of the short rows.
    inverse: Vec<S>,
    done: Vec<Eliminated<S>>,
    /// Right-hand sides: of the unknowns, and of the short rows.
    inside: Vec<S>,
    of_short: Vec<S>,
}

impl<S: SolveScalar> Multifrontal<S> {
    pub(super) fn new(pattern: &Pattern, known: &KnownPivots) -> Self {
        let plan = Plan::new(pattern, known);
        Self {
            scaling: Equilibration::new(pattern),
            scaled: vec![S::zero(); pattern.entries()],
            inverse: vec![S::zero(); plan.short.len()],
            done: Vec::new(),
            inside: vec![S::zero(); plan.rows.len()],
            of_short: vec![S::zero(); plan.short.len()],
            plan,
        }
    }

    pub(super) fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        let plan = &self.plan;
        self.scaling.fit(matrix);
        let scales = matrix.values.iter().zip(&self.scaling.entries);
        for (scaled, (&x, &by)) in self.scaled.iter_mut().zip(scales) {
            *scaled = x * by;
        }
        for (inverse, own) in self.inverse.iter_mut().zip(&plan.short) {
            let pivot = self.scaled[own.pivot];
            if !usable(pivot) {
                return Err(SingularMatrix { column: own.column });
            }
            *inverse = S::one() / pivot;
        }
        self.done.clear();
        let mut remainders: Vec<Vec<S>> = Vec::with_capacity(plan.fronts.len());
        for front in &plan.fronts {
            let order = front.order();
            let mut dense = vec![S::zero(); order * order];
            for &(slot, place) in &front.entries {
                dense[place as usize] += self.scaled[slot as usize];
            }
            for &[k, below, beside, place] in &front.products {
                dense[place as usize] -= self.scaled[below as usize]
                    * self.scaled[beside as usize]
                    * self.inverse[k as usize];
            }
            for (child, places) in &front.children {
                let rest = std::mem::take(&mut remainders[*child]);
                let columns = rest.chunks_exact(places.len());
                for (column, &to) in columns.zip(places) {
                    let own = &mut dense[to as usize * order..][..order];
                    for (&x, &row) in column.iter().zip(places) {
                        own[row as usize] += x;
                    }
                }
            }
            let (done, remainder) = eliminate(dense, front).map_err(|pivot| SingularMatrix {
                column: plan.columns[front.pivots.start + pivot],
            })?;
            self.done.push(done);
            remainders.push(remainder);
        }
        Ok(())
    }

    /// Entries of the factors, and operations.
    pub(super) fn cost(&self) -> (usize, usize) {
        self.plan
            .fronts
            .iter()
            .fold((0, 0), |(entries, all), front| {
                let (p, r) = (front.pivots.len(), front.rest.len());
                let work = p * p * p * 2 / 3 + 2 * p * p * r + 2 * p * r * r;
                (entries + p * (p + 2 * r), all + work)
            })
    }

    /// Smallest pivot of the columns from `first` on that are not known.
    pub(super) fn smallest_pivot(&self, first: usize) -> (f64, usize) {
        let none = (f64::INFINITY, first);
        let (Some(front), Some(done)) = (self.plan.fronts.last(), self.done.last()) else {
            return none;
        };
        let order = front.order();
        let pivots = front.pivots.clone().enumerate();
        let all = pivots.map(|(k, i)| (size(done.left[k * order + k]), self.plan.columns[i]));
        let later = all.filter(|(_, column)| *column >= first);
        later.fold(none, |least, own| if own.0 < least.0 { own } else { least })
    }

    pub(super) fn solve(&mut self, b: &mut [S]) {
        let Self {
            plan,
            scaled,
            inverse,
            inside,
            of_short,
            scaling,
            done,
        } = self;
        scale(b, &scaling.rows);
        for ((t, own), &inverse) in of_short.iter_mut().zip(&plan.short).zip(&*inverse) {
            *t = b[own.row] * inverse;
            for &(row, slot) in &own.below {
                b[row] -= scaled[slot] * *t;
            }
        }
        for (x, &row) in inside.iter_mut().zip(&plan.rows) {
            *x = b[row];
        }
        for (front, done) in plan.fronts.iter().zip(&*done) {
            done.forward(front, inside);
        }
        for (front, done) in plan.fronts.iter().zip(&*done).rev() {
            done.backward(front, inside);
        }
        for (&x, &column) in inside.iter().zip(&plan.columns) {
            b[column] = x;
        }
        for ((&t, own), &inverse) in of_short.iter().zip(&plan.short).zip(&*inverse) {
            let beside = own.beside.iter();
            let sum = beside.fold(S::zero(), |sum, &(column, slot)| {
                sum + scaled[slot] * b[column]
            });
            b[own.column] = t - sum * inverse;
        }
        scale(b, &scaling.columns);
    }

    pub(super) fn solve_transposed(&mut self, b: &mut [S]) {
        let Self {
            plan,
            scaled,
            inverse,
            inside,
            of_short,
            scaling,
            done,
        } = self;
        scale(b, &scaling.columns);
        for ((t, own), &inverse) in of_short.iter_mut().zip(&plan.short).zip(&*inverse) {
            *t = b[own.column] * inverse;
            for &(column, slot) in &own.beside {
                b[column] -= scaled[slot] * *t;
            }
        }
        for (x, &column) in inside.iter_mut().zip(&plan.columns) {
            *x = b[column];
        }
        for (front, done) in plan.fronts.iter().zip(&*done) {
            done.forward_transposed(front, inside);
        }
        for (front, done) in plan.fronts.iter().zip(&*done).rev() {
            done.backward_transposed(front, inside);
        }
        for (&x, &row) in inside.iter().zip(&plan.rows) {
            b[row] = x;
        }
        for ((&t, own), &inverse) in of_short.iter().zip(&plan.short).zip(&*inverse) {
            let below = own.below.iter();
            let sum = below.fold(S::zero(), |sum, &(row, slot)| sum + scaled[slot] * b[row]);
            b[own.row] = t - sum * inverse;
        }
        scale(b, &scaling.rows);
    }
}

fn scale<S: SolveScalar>(b: &mut [S], by: &[f64]) {
    for (b, &by) in b.iter_mut().zip(by) {
        *b = *b * by;
    }
}

fn usable<S: SolveScalar>(pivot: S) -> bool {
    let size = size(pivot);
    size > 0.0 && size.is_finite()
}

/// Eliminates the pivots of a front; returns its factors and the remainder, or the pivot that is missing.
fn eliminate<S: SolveScalar>(
    mut dense: Vec<S>,
    front: &Front,
) -> Result<(Eliminated<S>, Vec<S>), usize> {
    let (order, p, r) = (front.order(), front.pivots.len(), front.rest.len());
    let mut exchanges = Vec::with_capacity(p);
    for k in 0..p {
        let column = &dense[k * order..][..p];
        let (mut best, mut largest) = (k, size(column[k]));
        for (i, &x) in column.iter().enumerate().skip(k + 1) {
            if size(x) > largest {
                (best, largest) = (i, size(x));
            }
        }
        exchanges.push(best as u32);
        if best != k {
            for j in 0..order {
                dense.swap(j * order + k, j * order + best);
            }
        }
        let pivot = dense[k * order + k];
        if !usable(pivot) {
            return Err(k);
        }
        let inverse = S::one() / pivot;
        let (before, after) = dense.split_at_mut((k + 1) * order);
        let own = &mut before[k * order + k + 1..];
        for x in &mut *own {
            *x *= inverse;
        }
        for other in after.chunks_exact_mut(order).take(p - k - 1) {
            let factor = other[k];
            for (x, &l) in other[k + 1..].iter_mut().zip(&*own) {
                *x -= l * factor;
            }
        }
    }
    let mut left = dense;
    let right = left.split_off(p * order);
    let mut upper = Vec::with_capacity(p * r);
    let mut remainder = Vec::with_capacity(r * r);
    for column in right.chunks_exact(order.max(1)) {
        upper.extend_from_slice(&column[..p]);
        remainder.extend_from_slice(&column[p..]);
    }
    for column in upper.chunks_exact_mut(p) {
        for k in 0..p {
            let x = column[k];
            for (y, &l) in column[k + 1..].iter_mut().zip(&left[k * order + k + 1..]) {
                *y -= l * x;
            }
        }
    }
    if r > 0 && p > 0 {
        let lower = MatRef::from_column_major_slice_with_stride(&left[p..], r, p, order);
        let beside = MatRef::from_column_major_slice(&upper, p, r);
        let rest = MatMut::from_column_major_slice_mut(&mut remainder, r, r);
        matmul(rest, Accum::Add, lower, beside, -S::one(), Par::Seq);
    }
    let done = Eliminated {
        exchanges,
        left,
        upper,
    };
    Ok((done, remainder))
}

impl<S: SolveScalar> Eliminated<S> {
    fn forward(&self, front: &Front, x: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        for (k, &other) in self.exchanges.iter().enumerate() {
            x.swap(start + k, start + other as usize);
        }
        for k in 0..p {
            let factor = x[start + k];
            let column = &self.left[k * order..][..order];
            for (x, &l) in x[start + k + 1..start + p]
                .iter_mut()
                .zip(&column[k + 1..p])
            {
                *x -= l * factor;
            }
            for (&i, &l) in front.rest.iter().zip(&column[p..]) {
                x[i] -= l * factor;
            }
        }
    }

    fn backward(&self, front: &Front, x: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        for (&i, column) in front.rest.iter().zip(self.upper.chunks_exact(p.max(1))) {
            let factor = x[i];
            for (x, &u) in x[start..start + p].iter_mut().zip(column) {
                *x -= u * factor;
            }
        }
        for k in (0..p).rev() {
            let column = &self.left[k * order..][..order];
            let factor = x[start + k] / column[k];
            x[start + k] = factor;
            for (x, &u) in x[start..start + k].iter_mut().zip(column) {
                *x -= u * factor;
            }
        }
    }

    fn forward_transposed(&self, front: &Front, x: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        for k in 0..p {
            let column = &self.left[k * order..][..order];
            let known = x[start..start + k].iter().zip(column);
            let sum = known.fold(S::zero(), |sum, (&x, &u)| sum + x * u);
            x[start + k] = (x[start + k] - sum) / column[k];
        }
        for (&i, column) in front.rest.iter().zip(self.upper.chunks_exact(p.max(1))) {
            let known = x[start..start + p].iter().zip(column);
            let sum = known.fold(S::zero(), |sum, (&x, &u)| sum + x * u);
            x[i] -= sum;
        }
    }

    fn backward_transposed(&self, front: &Front, x: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        for k in (0..p).rev() {
            let column = &self.left[k * order..][..order];
            let rest = front.rest.iter().zip(&column[p..]);
            let mut sum = rest.fold(S::zero(), |sum, (&i, &l)| sum + x[i] * l);
            for (&x, &l) in x[start + k + 1..start + p].iter().zip(&column[k + 1..p]) {
                sum += x * l;
            }
            x[start + k] -= sum;
        }
        for (k, &other) in self.exchanges.iter().enumerate().rev() {
            x.swap(start + k, start + other as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::factors::SparseLu;
    use super::super::pattern::{Emit, KnownPivots, Pattern, SparseMatrix};
    use crate::math::Complex64;
    use nalgebra::{DMatrix, DVector};

    /// Positions and velocities of chains of masses that constraints couple, for some seeds.
    fn sample(seed: usize, n: usize, border: usize, emit: &mut dyn Emit<Complex64>) {
        let number =
            |k: usize| ((k * 7919 + seed * 104_729) as f64 * 0.618_033_988_7).fract() - 0.5;
        let all = 2 * n + border;
        for i in 0..n {
            // Rows 0 … n − 1: y_i − v_i and some of the border.
            emit.add(i, i, Complex64::new(0.7 + number(i), 0.2));
            emit.add(i, n + i, Complex64::new(-1.0, 0.0));
            emit.add(i, 2 * n + i % border, Complex64::new(number(3 * i), 0.1));
            for j in i.saturating_sub(3)..(i + 4).min(n) {
                let near = if i == j { 6.0 } else { number(i * n + j) };
                emit.add(n + i, j, Complex64::new(near, 0.3 * near));
                emit.add(n + i, n + j, Complex64::new(0.3 * near, number(i + j)));
            }
            for k in 0..border {
                emit.add(n + i, 2 * n + k, Complex64::new(number(i + 31 * k), 0.0));
                emit.add(2 * n + k, i, Complex64::new(number(i + 17 * k), 0.2));
                emit.add(2 * n + k, n + i, Complex64::new(number(5 * i + k), 0.0));
            }
        }
        for k in 0..border - 1 {
            emit.add(all - 1 - k, 2 * n + k, Complex64::new(number(k), 1.0));
        }
    }

    #[test]
    fn plain_and_transposed_solutions_agree_with_a_dense_oracle() {
        for (seed, n, border) in [(1, 1, 1), (2, 5, 2), (3, 40, 3), (4, 90, 7), (5, 13, 20)] {
            let order = 2 * n + border;
            let known = KnownPivots {
                short: (0..n).map(|i| (i, n + i)).collect(),
                inner: (0..n)
                    .map(|i| (i * 7 + seed) % n)
                    .map(|i| (n + i, i))
                    .collect(),
            };
            let pattern = Pattern::record(order, |e| sample(seed, n, border, e)).with_pivots(known);
            let mut matrix = SparseMatrix::new(pattern);
            matrix.assemble(|e| sample(seed, n, border, e));
            let mut dense = DMatrix::from_element(order, order, Complex64::new(0.0, 0.0));
            for j in 0..order {
                let mut unit = vec![Complex64::new(0.0, 0.0); order];
                unit[j].re = 1.0;
                dense.set_column(j, &DVector::from_vec(matrix.multiply(&unit)));
            }
            let b = DVector::from_fn(order, |i, _| Complex64::new(1.0 + i as f64, 1.0));
            let mut lu = SparseLu::new(&matrix.pattern);
            for _ in 0..2 {
                lu.factorise(&matrix).expect("regular");
                let mut x = b.as_slice().to_vec();
                lu.solve(&mut x);
                let rest = (&dense * DVector::from_vec(x.clone()) - &b).camax();
                let size = DVector::from_vec(x).camax();
                assert!(rest < 1e-12 * (b.camax() + 10.0 * size), "{seed}: {rest}");
                let mut x = b.as_slice().to_vec();
                lu.solve_transposed(&mut x);
                let rest = (dense.transpose() * DVector::from_vec(x.clone()) - &b).camax();
                let size = DVector::from_vec(x).camax();
                assert!(rest < 1e-12 * (b.camax() + 10.0 * size), "{seed}: {rest}");
            }
        }
    }
}
