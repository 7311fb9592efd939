//! Flexible generalised minimal residuals (Saad & Schultz 1986; Saad 1993), for a matrix that is given by its
//! products with vectors, with any preconditioner on the right.

use crate::math::Scalar;
use crate::math::slices::{add_scaled, dot};

/// A vector lies in the space of those before if orthogonalisation leaves less than this part of
/// it.
const DEPENDENT: f64 = 1e-15;

/// The Krylov space of a solution. Its memory is kept.
#[derive(Debug)]
pub struct Gmres<S> {
    /// Orthonormal vectors, and the parts of the solution that they give.
    basis: Vec<Vec<S>>,
    parts: Vec<Vec<S>>,
    /// The columns of R, the rotations that made it, and the right side in their basis.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    rest: Vec<f64>,
}

/// The work of a solution, and what it reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// Products with the matrix.
    pub products: usize,
    /// Whether |b − A x| is within the tolerance.
    pub solved: bool,
}

impl<S: Scalar> Gmres<S> {
    /// No space yet.
    pub fn new() -> Self {
        Self {
            basis: Vec::new(),
            parts: Vec::new(),
            columns: Vec::new(),
            rotations: Vec::new(),
            rest: Vec::new(),
        }
    }

    /// Sets `x` to that with the smallest |b − A x| in the Krylov space of at most `most` products.
    /// `apply(v, z, w)` sets z = P v with a preconditioner P ≈ A⁻¹, and w = A z. The numbers have no infinitesimal
    /// parts.
    ///
    /// It ends when |b − A x| ≤ `tolerance` |b|, or when the space grows no more.
    pub fn solve(
        &mut self,
        mut apply: impl FnMut(&[S], &mut [S], &mut [S]),
        (b, x): (&[S], &mut [S]),
        tolerance: f64,
        most: usize,
    ) -> Reached {
        debug_assert!(!S::INFINITESIMAL);
        x.fill(S::zero());
        let size = norm(b);
        if size == 0.0 || !size.is_finite() {
            return Reached {
                products: 0,
                solved: size == 0.0,
            };
        }
        self.rotations.clear();
        self.rest.clear();
        self.rest.push(size);
        reserve(&mut self.basis, 1, b.len());
        for (v, &b) in self.basis[0].iter_mut().zip(b) {
            *v = b / size;
        }
        let mut products = 0;
        for k in 0..most {
            reserve(&mut self.basis, k + 2, b.len());
            reserve(&mut self.parts, k + 1, b.len());
            reserve(&mut self.columns, k + 1, 0);
            let (basis, next) = self.basis.split_at_mut(k + 1);
            let w = &mut next[0];
            apply(&basis[k], &mut self.parts[k], w);
            products += 1;
            let whole = norm(w);
            let column = &mut self.columns[k];
            column.clear();
            column.resize(k + 1, 0.0);
            // Twice, so that round-off of the first pass goes.
            for _ in 0..2 {
                for (h, v) in column.iter_mut().zip(&*basis) {
                    let along = dot(v, w).re();
                    add_scaled(w, S::from(-along), v);
                    *h += along;
                }
            }
            let mut last = norm(w);
            for (i, &(c, s)) in self.rotations.iter().enumerate() {
                let (x, y) = (column[i], column[i + 1]);
                (column[i], column[i + 1]) = (c * x + s * y, c * y - s * x);
            }
            let ended = last <= DEPENDENT * whole;
            if ended {
                last = 0.0;
            }
            let length = column[k].hypot(last);
            if length == 0.0 || !length.is_finite() {
                break;
            }
            let (c, s) = (column[k] / length, last / length);
            column[k] = length;
            let left = self.rest[k];
            self.rest[k] = c * left;
            self.rest.push(-s * left);
            self.rotations.push((c, s));
            if ended || (s * left).abs() <= tolerance * size {
                break;
            }
            w.iter_mut().for_each(|x| *x = *x / last);
        }
        let count = self.rotations.len();
        let solved = self.rest[count].abs() <= tolerance * size;
        let y = &mut self.rest[..count];
        for i in (0..count).rev() {
            for j in i + 1..count {
                y[i] -= self.columns[j][i] * y[j];
            }
            y[i] /= self.columns[i][i];
        }
        for (&y, part) in y.iter().zip(&self.parts) {
            add_scaled(x, S::from(y), part);
        }
        Reached { products, solved }
    }
}

/// Grows a list to `count` vectors of this length at least.
fn reserve<S: Scalar>(all: &mut Vec<Vec<S>>, count: usize, length: usize) {
    while all.len() < count {
        all.push(vec![S::zero(); length]);
    }
}

fn norm<S: Scalar>(x: &[S]) -> f64 {
    dot(x, x).re().sqrt()
}

/// The x with the smallest |b − A x| in the Krylov space of at most `most` products, without a preconditioner.
pub fn gmres(
    mut product: impl FnMut(&[f64]) -> Vec<f64>,
    b: &[f64],
    tolerance: f64,
    most: usize,
) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let apply = |v: &[f64], z: &mut [f64], w: &mut [f64]| {
        z.copy_from_slice(v);
        w.copy_from_slice(&product(v));
    };
    Gmres::new().solve(apply, (b, &mut x), tolerance, most);
    x
}

#[cfg(test)]
mod tests {
    use super::{Gmres, gmres};

    /// A matrix that differs from unity in three rows takes four products.
    #[test]
    fn a_matrix_near_unity_takes_few_products() {
        let n = 40;
        let mut products = 0;
        let apply = |x: &[f64]| -> Vec<f64> {
            let mut y = x.to_vec();
            for (row, factor) in [(3, 2.0), (17, -0.7), (31, 5.0)] {
                y[row] += x
                    .iter()
                    .enumerate()
                    .map(|(j, x)| factor * x / (j + 2) as f64)
                    .sum::<f64>();
            }
            y
        };
        let exact: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let b = apply(&exact);
        let x = gmres(
            |x| {
                products += 1;
                apply(x)
            },
            &b,
            1e-14,
            20,
        );
        assert!(products <= 5, "{products}");
        assert!(x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-13));
    }

    /// Products that are zero or no numbers solve nothing.
    #[test]
    fn useless_products_do_not_pass_as_solutions() {
        for value in [0.0, f64::NAN, f64::INFINITY] {
            let mut x = [0.0_f64; 3];
            let apply = |v: &[f64], z: &mut [f64], w: &mut [f64]| {
                z.copy_from_slice(v);
                w.fill(value);
            };
            let found = Gmres::new().solve(apply, (&[1.0, 2.0, 3.0], &mut x), 0.1, 5);
            assert!(!found.solved, "{value} {x:?}");
        }
    }
}
