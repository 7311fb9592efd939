//! Multifrontal LU with known pivots: the elimination of structures with many coordinates, bordered by the
//! unknowns of frames and joints, whose pivots are searched last.
//!
//! Each front is a dense matrix. Its pivots are eliminated with a search among their own rows; the rest goes
//! to the parent (Duff & Reid 1983).

use super::border::{EliminatedBorder, Left};
use super::branches::work;
use super::eliminated::{Eliminated, add_runs, usable};
use super::elimination::{SingularMatrix, SolveScalar};
use super::fronts::Plan;
use super::matrix::SparseMatrix;
use super::owners::Owners;
use super::pattern::{KnownPivots, Pattern};
use super::plans::plan;
use super::scaling::{Equilibration, size};
use super::workspace::Workspace;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// The elimination of matrices of one pattern.
pub(super) struct Multifrontal<S> {
    pub(super) plan: Arc<Plan>,
    /// Who eliminates which branch.
    pub(super) owners: Owners,
    pub(super) scaling: Equilibration,
    /// The entries of the scaled matrix.
    pub(super) scaled: Vec<S>,
    /// Inverse pivots of the short rows.
    pub(super) inverse: Vec<S>,
    /// Entries beside short pivots by the pivots.
    pub(super) beside: Vec<S>,
    pub(super) done: Vec<Eliminated<S>>,
    /// Remainders of the fronts.
    remainders: Vec<Vec<S>>,
    /// Workspace of the branches, and of the trunk.
    pub(super) of_branches: Vec<Workspace<S>>,
    pub(super) of_trunk: Workspace<S>,
    /// The factors of a sparse border.
    pub(super) border: Option<EliminatedBorder<S>>,
}

/// What the eliminations of all fronts read.
struct Shared<'a, S> {
    plan: &'a Plan,
    scaled: &'a [S],
    beside: &'a [S],
}

/// The parts of a slice in some ranges, ascending.
fn parts<T>(mut all: &mut [T], ranges: impl Iterator<Item = Range<usize>>) -> Vec<&mut [T]> {
    let (mut out, mut at) = (Vec::new(), 0);
    for range in ranges {
        let (_, rest) = all.split_at_mut(range.start - at);
        let (own, rest) = rest.split_at_mut(range.len());
        out.push(own);
        (all, at) = (rest, range.end);
    }
    out
}

impl<S: SolveScalar> Shared<'_, S> {
    /// Eliminates the pivots of front k; `done` and `remainders` are those of the fronts from `first` on. `last` is
    /// the last front of a branch, whose remainder stays where it is.
    fn eliminate(
        &self,
        (k, first): (usize, usize),
        (done, remainders): (&mut [Eliminated<S>], &mut [Vec<S>]),
        free: &mut Vec<Vec<S>>,
    ) -> Result<(), SingularMatrix> {
        let front = &self.plan.fronts[k];
        let done = &mut done[k - first];
        let mut rest = match self.plan.ends_branch(k) {
            true => std::mem::take(&mut remainders[k - first]),
            false => free.pop().unwrap_or_default(),
        };
        rest.clear();
        rest.resize(front.rest.len().pow(2), S::zero());
        done.left.fill(S::zero());
        done.upper.fill(S::zero());
        let parts = [&mut done.left[..], &mut done.upper[..], &mut rest[..]];
        for ((part, entries), products) in
            (parts.into_iter().zip(&front.entries)).zip(&front.products)
        {
            add_runs(part, self.scaled, entries);
            for (beside, run) in products {
                let by = self.beside[*beside as usize];
                let values = &self.scaled[run.from as usize..][..run.length as usize];
                let into = &mut part[run.targets()];
                into.iter_mut()
                    .zip(values)
                    .for_each(|(x, &own)| *x -= own * by);
            }
        }
        for child in &front.children {
            let own = &mut remainders[child.front - first];
            done.extend(&mut rest, front, child, own);
            if !self.plan.ends_branch(child.front) {
                free.push(std::mem::take(own));
            }
        }
        done.eliminate(&mut rest, front)
            .map_err(|pivot| self.singular(k, front.pivots.start + pivot))?;
        remainders[k - first] = rest;
        Ok(())
    }

    fn singular(&self, front: usize, pivot: usize) -> SingularMatrix {
        let branch = self
            .plan
            .branches
            .iter()
            .find(|own| own.fronts.contains(&front));
        let unknown = pivot + branch.map_or(0, |branch| branch.own.start);
        SingularMatrix {
            column: self.plan.columns[unknown],
        }
    }
}

impl<S: SolveScalar> Multifrontal<S> {
    pub(super) fn new(pattern: &Pattern, known: &KnownPivots) -> Self {
        Self::by(plan(pattern, known), pattern)
    }

    /// The elimination of matrices of a pattern by its plan.
    pub(super) fn by(plan: Arc<Plan>, pattern: &Pattern) -> Self {
        let widths = plan.fronts.iter().map(|front| front.rest.len());
        let widest = widths.max().unwrap_or(0);
        let owners = Owners::new(pattern.team(), &plan);
        let done = plan.fronts.iter().enumerate();
        let done = done.map(|(k, front)| match owners.has_front(&plan, k) {
            true => Eliminated::new(front),
            false => Eliminated::elsewhere(),
        });
        let space = || Workspace::new(widest);
        Self {
            scaling: Equilibration::new(pattern),
            scaled: vec![S::zero(); pattern.entries()],
            inverse: vec![S::zero(); plan.short.len()],
            beside: vec![S::zero(); plan.short.beside.len()],
            done: done.collect(),
            remainders: plan.fronts.iter().map(|_| Vec::new()).collect(),
            of_branches: plan.branches.iter().map(|_| space()).collect(),
            of_trunk: space(),
            border: plan.border.as_ref().map(EliminatedBorder::new),
            owners,
            plan,
        }
    }

    pub(super) fn factorise(&mut self, matrix: &SparseMatrix<S>) -> Result<(), SingularMatrix> {
        let plan = &self.plan;
        self.scaling.fit(matrix, &mut self.scaled);
        for (k, inverse) in self.inverse.iter_mut().enumerate() {
            let pivot = self.scaled[plan.short.pivots[k]];
            if !usable(pivot) {
                let column = plan.short.column(k);
                return Err(SingularMatrix { column });
            }
            *inverse = S::one() / pivot;
        }
        for (by, &[k, slot, _]) in self.beside.iter_mut().zip(&plan.short.beside) {
            *by = self.scaled[slot as usize] * self.inverse[k as usize];
        }
        let shared = Shared {
            plan,
            scaled: &self.scaled,
            beside: &self.beside,
        };
        if !plan.branches.is_empty() {
            let ranges = || plan.branches.iter().map(|branch| branch.fronts.clone());
            let done = parts(&mut self.done, ranges());
            let remainders = parts(&mut self.remainders, ranges());
            let pieces =
                (plan.branches.par_iter().zip(done).zip(remainders)).zip(&mut self.of_branches);
            let owners = &self.owners;
            let own = pieces.enumerate().filter(|(b, _)| owners.owns(*b));
            let eliminated = own.map(|(b, (((branch, done), remainders), space))| {
                let first = branch.fronts.start;
                let end = (branch.fronts.clone()).try_for_each(|k| {
                    let own = (&mut *done, &mut *remainders);
                    shared.eliminate((k, first), own, &mut space.free)
                });
                (b, end)
            });
            let eliminated = eliminated.collect();
            owners.exchange_remainders(&plan.branches, eliminated, &mut self.remainders)?;
        }
        let free = &mut self.of_trunk.free;
        for &k in &plan.trunk {
            let own = (&mut self.done[..], &mut self.remainders[..]);
            shared.eliminate((k, 0), own, free)?;
        }
        if let (Some(border), Some(own)) = (&plan.border, &mut self.border) {
            let left = Left {
                scaled: &self.scaled,
                beside: &self.beside,
                remainders: &self.remainders,
            };
            let first = plan.first_of_border();
            own.factorise(border, &left)
                .map_err(|singular| SingularMatrix {
                    column: plan.columns[first + singular.column],
                })?;
            for k in border.children().filter(|&k| !plan.ends_branch(k)) {
                free.push(std::mem::take(&mut self.remainders[k]));
            }
        }
        Ok(())
    }

    /// By column, whether a transposed solution may leave more than round-off there: the unknowns of short rows come
    /// from the columns of their pivots.
    pub(super) fn remaining(&self) -> Vec<bool> {
        let columns = &self.plan.columns;
        let mut out = vec![false; columns.len() + self.plan.short.len()];
        columns.iter().for_each(|&column| out[column] = true);
        out
    }

    /// Entries of the factors, and operations.
    pub(super) fn cost(&mut self) -> (usize, usize) {
        let of_border = self.border.as_mut().map_or((0, 0), EliminatedBorder::cost);
        let fronts = self.plan.fronts.iter();
        fronts.fold(of_border, |(entries, all), front| {
            let (p, r) = (front.pivots.len(), front.rest.len());
            (entries + p * (p + 2 * r), all + work(front))
        })
    }

    /// Smallest pivot of the columns from `first` on that are not known.
    pub(super) fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        let none = (f64::INFINITY, first);
        if let Some(border) = &mut self.border {
            let columns = &self.plan.columns[self.plan.first_of_border()..];
            let from = columns.partition_point(|&column| column < first);
            let (pivot, at) = border.smallest_pivot(from);
            return columns.get(at).map_or(none, |&column| (pivot, column));
        }
        let (Some(front), Some(done)) = (self.plan.fronts.last(), self.done.last()) else {
            return none;
        };
        let order = front.order();
        let pivots = front.pivots.clone().enumerate();
        let all = pivots.map(|(k, i)| (size(done.left[k * order + k]), self.plan.columns[i]));
        let later = all.filter(|(_, column)| *column >= first);
        later.fold(none, |least, own| if own.0 < least.0 { own } else { least })
    }
}

#[cfg(test)]
mod tests {
    use super::super::factors::SparseLu;
    use super::super::front::System;
    use super::super::matrix::SparseMatrix;
    use super::super::pattern::{Emit, KnownPivots, Pattern};
    use super::Multifrontal;
    use crate::math::Complex64;
    use nalgebra::{DMatrix, DVector};
    use std::ops::Range;

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

    /// A grid of n × n nodes with three unknowns each, coupled with their neighbours, and a border.
    fn grid(n: usize, border: usize, emit: &mut dyn Emit<f64>) {
        let number = |k: usize| ((k * 7919) as f64 * 0.618_033_988_7).fract() - 0.5;
        let order = 3 * n * n;
        for node in 0..n * n {
            let (x, y) = (node % n, node / n);
            let near = (y.saturating_sub(1)..(y + 2).min(n))
                .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(n)).map(move |x| n * y + x));
            for other in near {
                for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                    let (row, column) = (3 * node + i, 3 * other + j);
                    let on = if row == column { 12.0 } else { 0.0 };
                    emit.add(row, column, on + number(row * order + column));
                }
            }
            for k in 0..border {
                emit.add(3 * node, order + k, number(node + 31 * k));
                emit.add(order + k, 3 * node + 1, number(node + 17 * k));
            }
        }
    }

    /// The nodes of a part of the grid, separators last (George 1973).
    fn dissected(n: usize, x: Range<usize>, y: Range<usize>) -> Vec<usize> {
        if x.len().min(y.len()) < 3 {
            let node = |y: usize| x.clone().map(move |x| n * y + x);
            return y.flat_map(node).collect();
        }
        let (middle_x, middle_y) = ((x.start + x.end) / 2, (y.start + y.end) / 2);
        let (low, high, on) = match x.len() > y.len() {
            true => {
                let on = y.clone().map(|y| n * y + middle_x).collect();
                let low = dissected(n, x.start..middle_x, y.clone());
                (low, dissected(n, middle_x + 1..x.end, y), on)
            }
            false => {
                let on = x.clone().map(|x| n * middle_y + x).collect();
                let low = dissected(n, x.clone(), y.start..middle_y);
                (low, dissected(n, x, middle_y + 1..y.end), on)
            }
        };
        [low, high, on].concat()
    }

    #[test]
    fn divided_eliminations_solve_on_any_number_of_processors() {
        let (n, border) = (40, 5);
        let order = 3 * n * n + border;
        let known = KnownPivots {
            short: Vec::new(),
            inner: (dissected(n, 0..n, 0..n).into_iter())
                .flat_map(|node| (0..3).map(move |i| (3 * node + i, 3 * node + i)))
                .collect(),
        };
        let pattern = Pattern::record(order, |e| grid(n, border, e)).with_pivots(known);
        let mut matrix = SparseMatrix::new(pattern);
        matrix.assemble(|e| grid(n, border, e));
        let b: Vec<f64> = (0..order).map(|i| 1.0 + (i as f64).sin()).collect();
        let solved = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let known = matrix.pattern.known_pivots().expect("known pivots");
                let mut lu = Multifrontal::new(&matrix.pattern, known);
                assert!(lu.plan.branches.len() > 1);
                lu.factorise(&matrix).expect("regular");
                let [mut x, mut y] = [b.clone(), b.clone()];
                lu.solve(System::Plain, &mut [&mut x]);
                lu.solve(System::Transposed, &mut [&mut y]);
                [x, y]
            })
        };
        let [x, y] = solved(1);
        let rest = matrix.remainder([&x, &y], &b);
        assert!(rest < 1e-11, "{rest}");
        assert_eq!([x, y], solved(3));
    }
}
