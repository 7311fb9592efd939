//! A sparse border of a multifrontal elimination: frames and joints of many bodies, each of which touches few
//! others. Its matrix is what the fronts leave; its pivots are searched.

use super::elimination::{Pivots, SingularMatrix, SolveScalar};
use super::front::{Child, Run, Short, System};
use super::matrix::SparseMatrix;
use super::pattern::{Emit, Pattern};
use super::sparse_lu::PivotedLu;
use std::sync::Arc;

/// Order up to which a border is one dense front.
const DENSE: usize = 700;
/// A larger border is sparse if it has at most this part of all entries.
const SPARSE: usize = 4;

/// The plan of a border. Its unknowns are numbered from 0.
pub(super) struct Border {
    /// Row, column and slot of entries of the matrix.
    entries: Vec<[u32; 3]>,
    /// Row, column, slot below and number of the entry beside of products of short rows.
    products: Vec<[u32; 4]>,
    /// Fronts whose remainders are added, and where their unknowns stand.
    children: Vec<(usize, Vec<u32>)>,
    pattern: Pattern,
}

/// What the fronts leave to a border: the scaled matrix, entries beside short pivots by the pivots, and remainders.
pub(super) struct Left<'a, S> {
    pub scaled: &'a [S],
    pub beside: &'a [S],
    pub remainders: &'a [Vec<S>],
}

impl Border {
    /// The border of all unknowns from `first` on up to `end`, with the fronts before it; `None` if it is small or dense.
    /// `entries` are (row, column, slot).
    pub(super) fn new(
        (first, end): (usize, usize),
        entries: &[(usize, usize, usize)],
        (short, column_of): (&[Short], &[usize]),
        children: &[Child],
    ) -> Option<Self> {
        let order = end - first;
        if order <= DENSE {
            return None;
        }
        let inside = |at: &&(usize, usize, usize)| at.0.min(at.1) >= first;
        let own = entries.iter().filter(inside);
        let entries = own.map(|&(r, c, slot)| [r - first, c - first, slot].map(|x| x as u32));
        let (mut products, mut number) = (Vec::new(), 0);
        for own in short {
            for &[column, _] in &own.beside {
                let c = column_of[column as usize];
                for &[r, below] in own
                    .below
                    .iter()
                    .filter(|[r, _]| c.min(*r as usize) >= first)
                {
                    products.push([r - first as u32, (c - first) as u32, below, number]);
                }
                number += 1;
            }
        }
        let places = |child: &Child| {
            let all = child.inside.iter().flat_map(Run::targets);
            (child.front, all.map(|i| i as u32).collect())
        };
        let mut border = Self {
            entries: entries.collect(),
            products,
            children: children.iter().map(places).collect(),
            pattern: Pattern::record::<f64>(0, |_| {}),
        };
        border.pattern = Pattern::record::<f64>(order, |emit| {
            border.visit(|row, column, _| emit.add(row as usize, column as usize, 1.0));
        });
        (SPARSE * border.pattern.entries() <= order * order).then_some(border)
    }

    /// Fronts whose remainders are added.
    pub(super) fn children(&self) -> impl Iterator<Item = usize> {
        self.children.iter().map(|(front, _)| *front)
    }

    /// Passes row, column and origin of all contributions.
    fn visit(&self, mut take: impl FnMut(u32, u32, Origin)) {
        for &[row, column, slot] in &self.entries {
            take(row, column, Origin::Entry(slot as usize));
        }
        for &[row, column, below, beside] in &self.products {
            take(
                row,
                column,
                Origin::Product(below as usize, beside as usize),
            );
        }
        for (front, places) in &self.children {
            let places = places.as_slice();
            let all = places
                .iter()
                .flat_map(|&column| places.iter().map(move |&row| (row, column)));
            for (k, (row, column)) in all.enumerate() {
                take(row, column, Origin::Remainder(*front, k));
            }
        }
    }
}

/// Where a contribution to a border comes from.
enum Origin {
    /// The entry of a slot.
    Entry(usize),
    /// The entry of a slot below a short pivot times the entry beside it of a number.
    Product(usize, usize),
    /// An entry of the remainder of a front.
    Remainder(usize, usize),
}

/// The factors of a border.
pub(super) struct EliminatedBorder<S> {
    matrix: SparseMatrix<S>,
    lu: PivotedLu<S>,
}

impl<S: SolveScalar> EliminatedBorder<S> {
    pub(super) fn new(plan: &Border) -> Self {
        Self {
            lu: PivotedLu::new(&plan.pattern),
            matrix: SparseMatrix::new(plan.pattern.clone()),
        }
    }

    pub(super) fn factorise(
        &mut self,
        plan: &Border,
        left: &Left<S>,
    ) -> Result<(), SingularMatrix> {
        self.matrix.assemble(|emit: &mut dyn Emit<S>| {
            plan.visit(|row, column, origin| {
                let value = match origin {
                    Origin::Entry(slot) => left.scaled[slot],
                    Origin::Product(below, beside) => -(left.scaled[below] * left.beside[beside]),
                    Origin::Remainder(front, k) => left.remainders[front][k],
                };
                emit.add(row as usize, column as usize, value);
            });
        });
        self.lu.factorise(&self.matrix)
    }

    pub(super) fn solve(&mut self, system: System, x: &mut [S]) {
        match system {
            System::Plain => self.lu.solve(x),
            System::Transposed => self.lu.solve_transposed(x),
        }
    }

    /// Number of entries of the factors, and of operations.
    pub(super) fn cost(&mut self) -> (usize, usize) {
        self.lu.cost()
    }

    /// Smallest pivot in the columns from `first` on, and its column.
    pub(super) fn smallest_pivot(&mut self, first: usize) -> (f64, usize) {
        self.lu.smallest_pivot(first)
    }

    pub(super) fn pivots(&mut self) -> Option<Arc<Pivots>> {
        self.lu.pivots()
    }

    pub(super) fn set_pivots(&mut self, pivots: Option<&Arc<Pivots>>) {
        self.lu.set_pivots(&self.matrix.pattern, pivots);
    }
}

#[cfg(test)]
mod tests {
    use super::super::factors::SparseLu;
    use super::super::matrix::SparseMatrix;
    use super::super::pattern::{Emit, KnownPivots, Pattern};

    /// Inner unknowns of a body, and its frame: as many other unknowns, the last of them a constraint.
    const BODY: [usize; 2] = [5, 8];

    /// A chain of bodies. The inner unknowns come first; a constraint couples the frame with the next body.
    fn chain(bodies: usize, emit: &mut dyn Emit<f64>) {
        let number = |k: usize| ((k * 7919) as f64 * 0.618_033_988_7).fract() - 0.5;
        let [inner, frame] = BODY;
        let at = |body: usize, i: usize| match i < inner {
            true => body * inner + i,
            false => bodies * inner + body * frame + i - inner,
        };
        let constraint = inner + frame - 1;
        for body in 0..bodies {
            for (i, j) in (0..constraint).flat_map(|i| (0..constraint).map(move |j| (i, j))) {
                let on = if i == j { 9.0 } else { 0.0 };
                emit.add(
                    at(body, i),
                    at(body, j),
                    on + number(31 * i + 17 * j + body),
                );
            }
            for near in [body, (body + 1) % bodies] {
                for i in 0..3 {
                    let (own, by) = (
                        at(body, constraint),
                        number(7 * i + 13 * near + 5 * body) + 1.0,
                    );
                    emit.add(own, at(near, inner + i), by);
                    emit.add(at(near, inner + i), own, by);
                }
            }
        }
    }

    /// Entries of the factors and operations; the solutions have small remainders.
    fn solved(bodies: usize) -> (usize, usize) {
        let order = bodies * (BODY[0] + BODY[1]);
        let known = KnownPivots {
            short: Vec::new(),
            inner: (0..bodies * BODY[0]).map(|i| (i, i)).collect(),
        };
        let pattern = Pattern::record(order, |e| chain(bodies, e)).with_pivots(known);
        let mut matrix = SparseMatrix::new(pattern);
        matrix.assemble(|e| chain(bodies, e));
        let b: Vec<f64> = (0..order).map(|i| 1.0 + (i as f64).sin()).collect();
        let mut lu = SparseLu::new(&matrix.pattern);
        for _ in 0..2 {
            lu.factorise(&matrix).expect("regular");
            let [mut x, mut y] = [b.clone(), b.clone()];
            lu.solve(&mut x);
            lu.solve_transposed(&mut y);
            let rest = matrix.remainder([&x, &y], &b);
            assert!(rest < 1e-12 * order as f64, "{bodies}: {rest}");
        }
        lu.cost()
    }

    #[test]
    fn work_grows_as_the_bodies() {
        let [few, many] = [200, 400].map(solved);
        assert!(10 * many.0 < 21 * few.0, "{few:?} {many:?}");
        assert!(10 * many.1 < 21 * few.1, "{few:?} {many:?}");
    }

    #[test]
    fn a_constraint_without_unknowns_is_singular() {
        let (bodies, [inner, frame]) = (200, BODY);
        let order = bodies * (inner + frame);
        let known = KnownPivots {
            short: Vec::new(),
            inner: (0..bodies * inner).map(|i| (i, i)).collect(),
        };
        let pattern = Pattern::record(order, |e| chain(bodies, e)).with_pivots(known);
        let mut matrix = SparseMatrix::new(pattern);
        matrix.assemble(|e| chain(bodies, e));
        let lost = order - 1;
        for k in matrix.pattern.column_starts()[lost]..matrix.pattern.column_starts()[order] {
            matrix.values[k] = 0.0;
        }
        let failure = SparseLu::new(&matrix.pattern).factorise(&matrix);
        assert_eq!(failure.map_err(|singular| singular.column), Err(lost));
    }
}
