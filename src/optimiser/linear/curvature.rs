//! Second derivatives of the Lagrangian, where a program gives them.

use nalgebra::DVector;

use crate::linear::jacobian::Jacobian;

/// The second derivatives of the Lagrangian f + yᵀc in a sparse form:
///
/// ```text
/// ∇²L = diag(d) + Gᵀ W⁻¹ G    with W symmetric, positive definite
/// ```
///
/// The compliance f = pᵀu of K(x) u = p has it: column i of G is ∂K/∂x_i u, W is K/2, and
/// d_i = −uᵀ ∂²K/∂x_i² u.
#[derive(Clone, Debug, PartialEq)]
pub struct Curvature {
    /// The diagonal d, of length n.
    pub diagonal: Vec<f64>,
    /// The matrix G, k × n.
    pub coupling: Jacobian,
    /// The lower triangle of W with its diagonal, k × k.
    pub stiffness: Jacobian,
}

impl Curvature {
    /// The reason why the curvature is useless for `n` variables.
    pub(crate) fn fault(&self, n: usize) -> Option<String> {
        let (k, columns) = self.coupling.shape();
        let shapes = (self.diagonal.len(), columns, self.stiffness.shape());
        if shapes != (n, n, (k, k)) {
            let found = format!("{}, {k} × {columns}, {:?}", shapes.0, shapes.2);
            return Some(format!(
                "the curvature has the shapes {found} where {n}, k × {n}, (k, k) are expected"
            ));
        }
        let above = |j: usize| self.stiffness.row(j).any(|(i, _)| i > j);
        if (0..k).any(above) {
            return Some("the stiffness of the curvature has entries above its diagonal".into());
        }
        let all = [self.coupling.values(), self.stiffness.values()].concat();
        let bad = |v: &f64| !v.is_finite();
        let bad = self.diagonal.iter().any(bad) || all.iter().any(bad);
        bad.then(|| "the curvature has an entry that is not finite".into())
    }

    /// The same for the variables `free` in the units `units` and an objective multiplied by `factor`.
    pub(crate) fn scaled(self, free: &[usize], units: &[f64], factor: f64) -> Curvature {
        let mut place = vec![usize::MAX; units.len()];
        for (k, &i) in free.iter().enumerate() {
            place[i] = k;
        }
        let row = |j: usize| {
            let entries = self
                .coupling
                .row(j)
                .filter(|&(i, _)| place[i] != usize::MAX);
            entries.map(|(i, v)| (place[i], v * units[i])).collect()
        };
        let rows = 0..self.coupling.shape().0;
        let mut stiffness = self.stiffness;
        stiffness.scale(1.0 / factor);
        Curvature {
            coupling: Jacobian::from_rows(free.len(), rows.map(row)),
            diagonal: (free
                .iter()
                .map(|&i| self.diagonal[i] * units[i].powi(2) * factor))
            .collect(),
            stiffness,
        }
    }

    /// Least possible entry `i` of the diagonal of Gᵀ W⁻¹ G, plus d_i. With the columns g of G it is
    /// (gᵀg)²/gᵀWg.
    pub(crate) fn least_diagonal(&self) -> DVector<f64> {
        let n = self.diagonal.len();
        let (starts, places) = self.coupling.by_columns();
        let values = self.coupling.values();
        DVector::from_fn(n, |i, _| {
            let column = &places[starts[i]..starts[i + 1]];
            let mut squares = 0.0;
            let mut energy = 0.0;
            for &(j, p) in column {
                squares += values[p] * values[p];
                for &(k, q) in column.iter().filter(|(k, _)| *k <= j) {
                    let twice = if k < j { 2.0 } else { 1.0 };
                    energy += twice * values[p] * values[q] * self.stiffness[(j, k)];
                }
            }
            let least = if energy > 0.0 {
                squares * squares / energy
            } else {
                0.0
            };
            self.diagonal[i] + least
        })
    }
}

/// The product of a symmetric matrix and `v`, from the lower triangle.
pub(crate) fn symmetric_product(lower: &Jacobian, v: &DVector<f64>) -> DVector<f64> {
    let mut product = DVector::zeros(v.len());
    for j in 0..v.len() {
        for (i, value) in lower.row(j) {
            product[j] += value * v[i];
            if i != j {
                product[i] += value * v[j];
            }
        }
    }
    product
}
