//! The matrix of an element, and the axes of its unknown rotations.

use super::basis::NODES;
use crate::math::{Scalar, Vec3};

/// Largest number of unknowns of an element: three displacements and three rotations a node.
pub const MOST_UNKNOWNS: usize = 6 * NODES;
/// The axes of the unknown rotations of each node: θ_a = Σ_k axis_k φ_k.
#[derive(Clone, Copy, Debug)]
pub struct RotationAxes<S> {
    /// Up to three axes a node.
    pub axes: [[Vec3<S>; 3]; NODES],
    /// How many of them are used.
    pub count: [usize; NODES],
}

impl<S: Scalar> RotationAxes<S> {
    /// The global axes at every node.
    pub fn global() -> Self {
        let one = |i: usize| Vec3::from_fn(|j, _| if i == j { S::one() } else { S::zero() });
        Self {
            axes: [[one(0), one(1), one(2)]; NODES],
            count: [3; NODES],
        }
    }

    /// How many axes the first `nodes` nodes have.
    pub(super) fn total(&self, nodes: usize) -> usize {
        self.count[..nodes].iter().sum()
    }
}

/// A symmetric matrix of the element, lower part: row i holds the columns 0 ..= i. Unknowns are all
/// u_a (3a + i), then the rotations of the nodes in order.
pub struct ElementMatrix<S> {
    /// Order of the matrix.
    pub order: usize,
    /// Rows; entries right of the diagonal are not used.
    pub rows: Box<[[S; MOST_UNKNOWNS]; MOST_UNKNOWNS]>,
}

impl<S: Scalar> ElementMatrix<S> {
    /// An empty matrix, to be used again for every element.
    pub fn new() -> Self {
        Self {
            order: 0,
            rows: Box::new([[S::zero(); MOST_UNKNOWNS]; MOST_UNKNOWNS]),
        }
    }

    pub fn clear(&mut self, order: usize) {
        self.order = order;
        for (i, row) in self.rows.iter_mut().enumerate().take(order) {
            row[..=i].fill(S::zero());
        }
    }

    /// Adds `factor` times Bᵀ D of `N` rows over the columns `0 .. width`.
    #[inline]
    pub(super) fn add_products<const N: usize>(
        &mut self,
        b: &[[S; MOST_UNKNOWNS]; N],
        d: &[[S; MOST_UNKNOWNS]; N],
        width: usize,
    ) {
        for i in 0..width {
            let row = &mut self.rows[i][..=i];
            let mut p = 0;
            while p + 4 <= N {
                let factors = [b[p][i], b[p + 1][i], b[p + 2][i], b[p + 3][i]];
                let (d0, d1) = (&d[p][..=i], &d[p + 1][..=i]);
                let (d2, d3) = (&d[p + 2][..=i], &d[p + 3][..=i]);
                for j in 0..=i {
                    row[j] += factors[0] * d0[j]
                        + factors[1] * d1[j]
                        + factors[2] * d2[j]
                        + factors[3] * d3[j];
                }
                p += 4;
            }
            for q in p..N {
                let factor = b[q][i];
                for (x, &y) in row.iter_mut().zip(&d[q]) {
                    *x += factor * y;
                }
            }
        }
    }
}

impl<S: Scalar> Default for ElementMatrix<S> {
    fn default() -> Self {
        Self::new()
    }
}
