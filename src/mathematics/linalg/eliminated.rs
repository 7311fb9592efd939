//! Factors of a front of a multifrontal elimination. Its pivots are eliminated by panels with a search among
//! their own rows (Golub & Van Loan 2013, section 3.4).

use super::elimination::SolveScalar;
use super::front::{Child, Front, Run, System};
use super::scaling::size;
use crate::math::slices::vectorised;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// Columns of a front that are eliminated together.
const PANEL: usize = 16;
/// Columns of a triangle that a solution takes together.
const TOGETHER: usize = 4;

/// Factors of a front of order f with p pivots, by columns.
pub(super) struct Eliminated<S> {
    /// The row that was exchanged with each pivot row.
    exchanges: Vec<u32>,
    /// Its first p columns: L below the diagonal, U above.
    pub left: Vec<S>,
    /// U of the other columns, p × (f − p).
    pub upper: Vec<S>,
}

impl<S: SolveScalar> Eliminated<S> {
    pub(super) fn new(front: &Front) -> Self {
        let (left, upper) = front.sizes();
        Self {
            exchanges: vec![0; front.pivots.len()],
            left: vec![S::zero(); left],
            upper: vec![S::zero(); upper],
        }
    }
}

impl<S> Eliminated<S> {
    /// Of a front that another rank eliminates.
    pub(super) fn elsewhere() -> Self {
        Self {
            exchanges: Vec::new(),
            left: Vec::new(),
            upper: Vec::new(),
        }
    }
}

/// Whether a pivot is neither zero nor infinite nor NaN.
pub(super) fn usable<S: SolveScalar>(pivot: S) -> bool {
    let size = size(pivot);
    size > 0.0 && size.is_finite()
}

/// Adds runs of numbers to their places.
pub(super) fn add_runs<S: SolveScalar>(out: &mut [S], own: &[S], runs: &[Run]) {
    for run in runs {
        let own = &own[run.from as usize..][..run.length as usize];
        let out = &mut out[run.targets()];
        out.iter_mut().zip(own).for_each(|(x, &own)| *x += own);
    }
}

/// Subtracts l x from y.
#[inline(always)]
fn subtract<S: SolveScalar>(y: &mut [S], l: &[S], x: S) {
    for (y, &l) in y.iter_mut().zip(l) {
        *y -= l * x;
    }
}

/// Subtracts A x from y, A in columns of the given stride. Four columns at a time read and write y once.
#[inline(always)]
fn subtract_columns<S: SolveScalar>(y: &mut [S], (a, stride): (&[S], usize), x: &[S]) {
    let m = y.len();
    let column = |k: usize| &a[k * stride..][..m];
    let (fours, rest) = x.as_chunks::<4>();
    for (k, x) in fours.iter().enumerate() {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| column(4 * k + i));
        for i in 0..m {
            y[i] -= (a[i] * x[0] + b[i] * x[1]) + (c[i] * x[2] + d[i] * x[3]);
        }
    }
    for (k, &x) in rest.iter().enumerate() {
        subtract(y, column(4 * fours.len() + k), x);
    }
}

#[inline(always)]
fn dot<S: SolveScalar>(x: &[S], y: &[S]) -> S {
    // Eight sums, because an addition waits for the one before.
    let (x8, x) = x[..y.len()].as_chunks::<8>();
    let (y8, y) = y.as_chunks::<8>();
    let mut sums = [S::zero(); 8];
    for (x, y) in x8.iter().zip(y8) {
        for (sum, (&x, &y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    let rest = x.iter().zip(y).fold(S::zero(), |sum, (&x, &y)| sum + x * y);
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

/// Adds −A B to C, each in columns of the given stride.
fn subtract_product<S: SolveScalar>(
    (c, c_stride): (&mut [S], usize),
    (a, a_stride): (&[S], usize),
    (b, b_stride): (&[S], usize),
    [m, n, k]: [usize; 3],
) {
    if m == 0 || n == 0 || k == 0 {
        return;
    }
    let a = MatRef::from_column_major_slice_with_stride(a, m, k, a_stride);
    let b = MatRef::from_column_major_slice_with_stride(b, k, n, b_stride);
    let c = MatMut::from_column_major_slice_with_stride_mut(c, m, n, c_stride);
    matmul(c, Accum::Add, a, b, -S::one(), Par::Seq);
}

impl<S: SolveScalar> Eliminated<S> {
    /// Adds the remainder of a child.
    pub(super) fn extend(&mut self, rest: &mut [S], front: &Front, child: &Child, own: &[S]) {
        let (order, p, r) = (front.order(), front.pivots.len(), front.rest.len());
        let inside: usize = child.inside.iter().map(|run| run.length as usize).sum();
        let mut columns = own.chunks_exact(child.order);
        for (to, column) in child.inside.iter().flat_map(Run::targets).zip(&mut columns) {
            let (above, below) = column.split_at(inside);
            let (top, bottom) = self.left[to * order..][..order].split_at_mut(p);
            add_runs(top, above, &child.inside);
            add_runs(bottom, below, &child.outside);
        }
        for (to, column) in child.outside.iter().flat_map(Run::targets).zip(columns) {
            let (above, below) = column.split_at(inside);
            add_runs(&mut self.upper[to * p..][..p], above, &child.inside);
            add_runs(&mut rest[to * r..][..r], below, &child.outside);
        }
    }

    /// Eliminates the pivots of the front; `rest` becomes the remainder. The error is the missing
    /// pivot.
    pub(super) fn eliminate(&mut self, rest: &mut [S], front: &Front) -> Result<(), usize> {
        let (order, p, r) = (front.order(), front.pivots.len(), front.rest.len());
        let left = &mut self.left;
        for start in (0..p).step_by(PANEL) {
            let end = (start + PANEL).min(p);
            eliminate_panel(left, (order, p), start..end, &mut self.exchanges)?;
            let (before, after) = left.split_at_mut(end * order);
            if end < p {
                let above: Vec<S> = (after.chunks_exact(order))
                    .flat_map(|column| &column[start..end])
                    .copied()
                    .collect();
                let own = (&before[start * order + end..], order);
                let shape = [order - end, p - end, end - start];
                let beside = (&above[..], end - start);
                subtract_product((&mut after[end..], order), own, beside, shape);
            }
        }
        let left = &self.left;
        for column in self.upper.chunks_exact_mut(p.max(1)) {
            for (k, &other) in self.exchanges.iter().enumerate() {
                column.swap(k, other as usize);
            }
        }
        if p > 0 && r > 0 {
            let lower = MatRef::from_column_major_slice_with_stride(&left[..], p, p, order);
            let upper = MatMut::from_column_major_slice_mut(&mut self.upper, p, r);
            solve_unit_lower_triangular_in_place(lower, upper, Par::Seq);
            let below = (&left[p..], order);
            subtract_product((rest, r), below, (&self.upper, p), [r, r, p]);
        }
        Ok(())
    }

    /// The forward substitution of a front in the unknowns x; `beside` is workspace.
    pub(super) fn forward(&self, system: System, front: &Front, x: &mut [S], beside: &mut [S]) {
        vectorised(
            #[inline(always)]
            || match system {
                System::Plain => self.forward_plain(front, x, beside),
                System::Transposed => self.forward_transposed(front, x),
            },
        );
    }

    /// The backward substitution of a front.
    pub(super) fn backward(&self, system: System, front: &Front, x: &mut [S], beside: &mut [S]) {
        vectorised(
            #[inline(always)]
            || match system {
                System::Plain => self.backward_plain(front, x, beside),
                System::Transposed => self.backward_transposed(front, x, beside),
            },
        );
    }

    #[inline(always)]
    fn forward_plain(&self, front: &Front, x: &mut [S], beside: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        for (k, &other) in self.exchanges.iter().enumerate() {
            x.swap(start + k, start + other as usize);
        }
        let beside = &mut beside[..front.rest.len()];
        for (own, &i) in beside.iter_mut().zip(&front.rest) {
            *own = x[i];
        }
        let own = &mut x[start..start + p];
        for from in (0..p).step_by(TOGETHER) {
            let to = (from + TOGETHER).min(p);
            for k in from..to {
                let (column, factor) = (&self.left[k * order..], own[k]);
                subtract(&mut own[k + 1..to], &column[k + 1..to], factor);
            }
            let (known, later) = own.split_at_mut(to);
            let columns = (&self.left[from * order + to..], order);
            subtract_columns(later, columns, &known[from..]);
        }
        if p > 0 {
            subtract_columns(beside, (&self.left[p..], order), own);
        }
        for (own, &i) in beside.iter().zip(&front.rest) {
            x[i] = *own;
        }
    }

    #[inline(always)]
    fn backward_plain(&self, front: &Front, x: &mut [S], beside: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        let beside = &mut beside[..front.rest.len()];
        for (own, &i) in beside.iter_mut().zip(&front.rest) {
            *own = x[i];
        }
        let own = &mut x[start..start + p];
        subtract_columns(own, (&self.upper, p), beside);
        for from in (0..p).step_by(TOGETHER).rev() {
            let to = (from + TOGETHER).min(p);
            for k in (from..to).rev() {
                let column = &self.left[k * order..][..order];
                let factor = own[k] / column[k];
                own[k] = factor;
                subtract(&mut own[from..k], &column[from..k], factor);
            }
            let (earlier, known) = own.split_at_mut(from);
            let columns = (&self.left[from * order..], order);
            subtract_columns(earlier, columns, &known[..to - from]);
        }
    }

    #[inline(always)]
    fn forward_transposed(&self, front: &Front, x: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        let own = &mut x[start..start + p];
        for k in 0..p {
            let column = &self.left[k * order..][..order];
            own[k] = (own[k] - dot(column, &own[..k])) / column[k];
        }
        for (&i, column) in front.rest.iter().zip(self.upper.chunks_exact(p.max(1))) {
            x[i] -= dot(column, &x[start..start + p]);
        }
    }

    #[inline(always)]
    fn backward_transposed(&self, front: &Front, x: &mut [S], beside: &mut [S]) {
        let (order, p, start) = (front.order(), front.pivots.len(), front.pivots.start);
        let beside = &mut beside[..front.rest.len()];
        for (own, &i) in beside.iter_mut().zip(&front.rest) {
            *own = x[i];
        }
        let own = &mut x[start..start + p];
        for k in (0..p).rev() {
            let column = &self.left[k * order..][..order];
            let sum = dot(beside, &column[p..]) + dot(&own[k + 1..], &column[k + 1..p]);
            own[k] -= sum;
        }
        for (k, &other) in self.exchanges.iter().enumerate().rev() {
            x.swap(start + k, start + other as usize);
        }
    }
}

/// Solves with the unit lower triangle of the pivots from `start` to `end`, whose columns `own` are.
#[inline(always)]
fn lower_solve<S: SolveScalar>(own: &[S], (order, start, end): (usize, usize, usize), x: &mut [S]) {
    for k in start..end {
        let l = &own[(k - start) * order..][k + 1..end];
        let factor = x[k];
        subtract(&mut x[k + 1..end], l, factor);
    }
}

/// Eliminates some pivots of the first p columns of a front. The error is the missing pivot.
fn eliminate_panel<S: SolveScalar>(
    left: &mut [S],
    (order, p): (usize, usize),
    Range { start, end }: Range<usize>,
    exchanges: &mut [u32],
) -> Result<(), usize> {
    vectorised(
        #[inline(always)]
        || {
            for k in start..end {
                let column = &left[k * order..][..p];
                let (mut best, mut largest) = (k, size(column[k]));
                for (i, &x) in column.iter().enumerate().skip(k + 1) {
                    if size(x) > largest {
                        (best, largest) = (i, size(x));
                    }
                }
                exchanges[k] = best as u32;
                if best != k {
                    for column in left.chunks_exact_mut(order) {
                        column.swap(k, best);
                    }
                }
                let pivot = left[k * order + k];
                if !usable(pivot) {
                    return Err(k);
                }
                let inverse = S::one() / pivot;
                let (before, after) = left.split_at_mut((k + 1) * order);
                let own = &mut before[k * order + k + 1..];
                for x in &mut *own {
                    *x *= inverse;
                }
                for other in after.chunks_exact_mut(order).take(end - k - 1) {
                    let factor = other[k];
                    subtract(&mut other[k + 1..], own, factor);
                }
            }
            // The other columns of the pivots.
            let (before, after) = left.split_at_mut(end * order);
            for column in after.chunks_exact_mut(order) {
                lower_solve(&before[start * order..], (order, start, end), column);
            }
            Ok(())
        },
    )
}
