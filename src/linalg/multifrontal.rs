//! Multifrontal LU with known pivots: the elimination of structures with many coordinates, bordered by the
//! unknowns of frames and joints, whose pivots are searched last.
//!
//! Each front is a dense matrix. Its pivots are eliminated with a search among their own rows; the rest goes
//! to the parent (Duff & Reid 1983).

use super::eliminated::{Eliminated, usable};
use super::fronts::Plan;
use super::pattern::{KnownPivots, Pattern, SparseMatrix};
use super::scaling::{Equilibration, size};
use super::sparse_lu::{SingularMatrix, SolveScalar};

/// The elimination of matrices of one pattern.
pub(super) struct Multifrontal<S> {
    plan: Plan,
    scaling: Equilibration,
    scaled: Vec<S>,
    /// Inverse pivots of the short rows.
    inverse: Vec<S>,
    done: Vec<Eliminated<S>>,
    /// Remainders of the fronts, and memory of remainders that are used up.
    remainders: Vec<Vec<S>>,
    free: Vec<Vec<S>>,
    /// Right-hand sides: of the unknowns, of the short rows, and of what a front touches.
    inside: Vec<S>,
    of_short: Vec<S>,
    beside: Vec<S>,
}

impl<S: SolveScalar> Multifrontal<S> {
    pub(super) fn new(pattern: &Pattern, known: &KnownPivots) -> Self {
        let plan = Plan::new(pattern, known);
        let widths = plan.fronts.iter().map(|front| front.rest.len());
        let widest = widths.max().unwrap_or(0);
        Self {
            scaling: Equilibration::new(pattern),
            scaled: vec![S::zero(); pattern.entries()],
            inverse: vec![S::zero(); plan.short.len()],
            done: plan.fronts.iter().map(Eliminated::new).collect(),
            remainders: plan.fronts.iter().map(|_| Vec::new()).collect(),
            free: Vec::new(),
            beside: vec![S::zero(); widest],
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
        for (k, front) in plan.fronts.iter().enumerate() {
            let done = &mut self.done[k];
            let mut rest = self.free.pop().unwrap_or_default();
            rest.clear();
            rest.resize(front.rest.len().pow(2), S::zero());
            done.left.fill(S::zero());
            done.upper.fill(S::zero());
            let (left, upper) = front.sizes();
            let mut add = |place: u32, x: S| {
                let place = place as usize;
                if place < left {
                    done.left[place] += x;
                } else if place < left + upper {
                    done.upper[place - left] += x;
                } else {
                    rest[place - left - upper] += x;
                }
            };
            for &(slot, place) in &front.entries {
                add(place, self.scaled[slot as usize]);
            }
            for &[k, below, beside, place] in &front.products {
                let by = self.scaled[below as usize] * self.scaled[beside as usize];
                add(place, -(by * self.inverse[k as usize]));
            }
            for child in &front.children {
                let own = std::mem::take(&mut self.remainders[child.front]);
                done.extend(&mut rest, front, child, &own);
                self.free.push(own);
            }
            done.eliminate(&mut rest, front)
                .map_err(|pivot| SingularMatrix {
                    column: plan.columns[front.pivots.start + pivot],
                })?;
            self.remainders[k] = rest;
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
            beside,
            ..
        } = self;
        scale(b, &scaling.rows);
        for ((t, own), &inverse) in of_short.iter_mut().zip(&plan.short).zip(&*inverse) {
            *t = b[own.row] * inverse;
            for &[row, slot] in &own.below {
                b[row as usize] -= scaled[slot as usize] * *t;
            }
        }
        for (x, &row) in inside.iter_mut().zip(&plan.rows) {
            *x = b[row];
        }
        for (front, done) in plan.fronts.iter().zip(&*done) {
            done.forward(front, inside, beside);
        }
        for (front, done) in plan.fronts.iter().zip(&*done).rev() {
            done.backward(front, inside, beside);
        }
        for (&x, &column) in inside.iter().zip(&plan.columns) {
            b[column] = x;
        }
        for ((&t, own), &inverse) in of_short.iter().zip(&plan.short).zip(&*inverse) {
            let beside = own.beside.iter();
            let sum = beside.fold(S::zero(), |sum, &[column, slot]| {
                sum + scaled[slot as usize] * b[column as usize]
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
            beside,
            ..
        } = self;
        scale(b, &scaling.columns);
        for ((t, own), &inverse) in of_short.iter_mut().zip(&plan.short).zip(&*inverse) {
            *t = b[own.column] * inverse;
            for &[column, slot] in &own.beside {
                b[column as usize] -= scaled[slot as usize] * *t;
            }
        }
        for (x, &column) in inside.iter_mut().zip(&plan.columns) {
            *x = b[column];
        }
        for (front, done) in plan.fronts.iter().zip(&*done) {
            done.forward_transposed(front, inside, beside);
        }
        for (front, done) in plan.fronts.iter().zip(&*done).rev() {
            done.backward_transposed(front, inside, beside);
        }
        for (&x, &row) in inside.iter().zip(&plan.rows) {
            b[row] = x;
        }
        for ((&t, own), &inverse) in of_short.iter().zip(&plan.short).zip(&*inverse) {
            let below = own.below.iter();
            let sum = below.fold(S::zero(), |sum, &[row, slot]| {
                sum + scaled[slot as usize] * b[row as usize]
            });
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
