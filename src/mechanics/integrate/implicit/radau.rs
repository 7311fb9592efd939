//! The Radau IIA methods of 2 and 3 stages: coefficients, transformation, dense output (Hairer &
//! Wanner 1996, *Solving Ordinary Differential Equations II*, sections IV.5 and IV.8).
//!
//! With the increments Z_i = Y_i − y_n of the stages, h Ẏ_i = Σ_j D_ij Z_j with D = A⁻¹, and
//! y_{n+1} = y_n + Z_s. The eigenvectors of D split the linear systems of Newton's method into a
//! real one (only for 3 stages) and a complex one.

use crate::integrate::settings::Method;
use crate::math::Complex64;
use nalgebra::{DMatrix, DVector};

/// Largest number of stages.
const MOST: usize = 3;

/// Coefficients of a method.
#[derive(Clone, Debug)]
pub struct Scheme {
    /// Nodes c_i; the last is 1.
    pub nodes: Vec<f64>,
    /// D = A⁻¹, row by row.
    pub rates: Vec<Vec<f64>>,
    /// Eigenvalues of D with a non-negative imaginary part.
    pub modes: Vec<Mode>,
    /// Error estimate: weight b̂_0 of the rate at the start, and weights of Z_i.
    pub error: (f64, Vec<f64>),
}

/// An eigenvalue of D with its eigenvectors, lᵀ r = 1.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Eigenvalue.
    pub value: Complex64,
    /// Right eigenvector r.
    pub right: Vec<Complex64>,
    /// Left eigenvector l.
    pub left: Vec<Complex64>,
}

impl Mode {
    /// Whether the eigenvalue is real.
    pub fn is_real(&self) -> bool {
        self.value.im == 0.0
    }
}

impl Scheme {
    /// The scheme of a method, or that of the first steps of a multistep formula: the smallest one whose error in a step
    /// is below that of the formula.
    pub fn of(method: Method) -> Self {
        Self::new(match method {
            Method::Radau { stages } => stages,
            Method::Bdf { order: ..=2, .. } | Method::GeneralisedAlpha { .. } => 2,
            Method::Bdf { .. } | Method::Dop853 => 3,
        })
    }

    /// The method of 2 or 3 stages.
    ///
    /// # Panics
    /// The number of stages is not 2 or 3.
    pub fn new(stages: usize) -> Self {
        let root = 6.0_f64.sqrt();
        let (nodes, a, values) = match stages {
            2 => (
                vec![1.0 / 3.0, 1.0],
                vec![5.0 / 12.0, -1.0 / 12.0, 0.75, 0.25],
                vec![Complex64::new(2.0, 2.0_f64.sqrt())],
            ),
            3 => {
                // λ³ − 9 λ² + 36 λ − 60 = 0.
                let real = 3.0 + 9.0_f64.cbrt() - 3.0_f64.cbrt();
                let half = 0.5 * (9.0 - real);
                let imaginary = (60.0 / real - half * half).sqrt();
                let a = vec![
                    (88.0 - 7.0 * root) / 360.0,
                    (296.0 - 169.0 * root) / 1800.0,
                    (-2.0 + 3.0 * root) / 225.0,
                    (296.0 + 169.0 * root) / 1800.0,
                    (88.0 + 7.0 * root) / 360.0,
                    (-2.0 - 3.0 * root) / 225.0,
                    (16.0 - root) / 36.0,
                    (16.0 + root) / 36.0,
                    1.0 / 9.0,
                ];
                (
                    vec![(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0],
                    a,
                    vec![Complex64::new(real, 0.0), Complex64::new(half, imaginary)],
                )
            }
            _ => panic!("settings allow 2 and 3 stages"),
        };
        let a = DMatrix::from_row_slice(stages, stages, &a);
        let d = a
            .clone()
            .try_inverse()
            .expect("the matrix of Radau IIA is regular");
        let modes = values.iter().map(|&value| mode(&d, value)).collect();
        let error = error_weights(&nodes, &a, &d, &values);
        let rows = 0..stages;
        Self {
            rates: rows.map(|i| d.row(i).iter().copied().collect()).collect(),
            nodes,
            modes,
            error,
        }
    }

    /// Number of stages.
    pub fn stages(&self) -> usize {
        self.nodes.len()
    }

    /// Weights of Z_i in y(θ) − y_n, the polynomial through the start and the stages, and their
    /// derivatives in θ. Entries beyond the stages are zero.
    pub fn dense_weights(&self, theta: f64) -> ([f64; MOST], [f64; MOST]) {
        let (mut values, mut slopes) = ([0.0; MOST], [0.0; MOST]);
        for (i, &node) in self.nodes.iter().enumerate() {
            // Lagrange polynomial of the node times θ / node, which is 1 at the node and 0 at the
            // start.
            let (value, slope) = lagrange(&self.nodes, i, theta);
            values[i] = value * theta / node;
            slopes[i] = (slope * theta + value) / node;
        }
        (values, slopes)
    }

    /// Weights of the stages in their polynomial, which does not use the start.
    pub fn stage_weights(&self, theta: f64) -> [f64; MOST] {
        let mut weights = [0.0; MOST];
        for (i, weight) in weights.iter_mut().enumerate().take(self.stages()) {
            *weight = lagrange(&self.nodes, i, theta).0;
        }
        weights
    }
}

/// Value and derivative at θ of the Lagrange polynomial of node i.
fn lagrange(nodes: &[f64], i: usize, theta: f64) -> (f64, f64) {
    let (mut value, mut slope) = (1.0, 0.0);
    for (j, &node) in nodes.iter().enumerate() {
        if j != i {
            let width = nodes[i] - node;
            slope = slope * (theta - node) / width + value / width;
            value *= (theta - node) / width;
        }
    }
    (value, slope)
}

fn mode(d: &DMatrix<f64>, value: Complex64) -> Mode {
    let shifted = |d: &DMatrix<f64>| {
        let mut m = d.map(|x| Complex64::new(x, 0.0));
        for i in 0..m.nrows() {
            m[(i, i)] -= value;
        }
        m
    };
    let right = null_vector(&shifted(d));
    let mut left = null_vector(&shifted(&d.transpose()));
    let product: Complex64 = right.iter().zip(&left).map(|(r, l)| r * l).sum();
    for l in &mut left {
        *l /= product;
    }
    Mode { value, right, left }
}

/// A null vector of a singular matrix of order 2 or 3: minors of its first rows.
fn null_vector(m: &DMatrix<Complex64>) -> Vec<Complex64> {
    match m.nrows() {
        2 => vec![m[(0, 1)], -m[(0, 0)]],
        _ => {
            let minor = |a: usize, b: usize| m[(0, a)] * m[(1, b)] - m[(0, b)] * m[(1, a)];
            vec![minor(1, 2), minor(2, 0), minor(0, 1)]
        }
    }
}

/// Weights e_i of ŷ − y_{n+1} = h b̂_0 ẏ_n + Σ e_i Z_i for the formula of order s. b̂_0 is the
/// reciprocal of the real eigenvalue, or of the modulus of the complex pair if there is none.
fn error_weights(
    nodes: &[f64],
    a: &DMatrix<f64>,
    d: &DMatrix<f64>,
    values: &[Complex64],
) -> (f64, Vec<f64>) {
    let s = nodes.len();
    let first = 1.0 / values[0].norm();
    let powers = DMatrix::from_fn(s, s, |k, i| nodes[i].powi(k as i32));
    let target = DVector::from_fn(s, |k, _| {
        1.0 / (k + 1) as f64 - if k == 0 { first } else { 0.0 }
    });
    let weights = powers
        .lu()
        .solve(&target)
        .expect("the nodes of Radau IIA are distinct");
    let difference = weights - a.row(s - 1).transpose();
    let error = d.transpose() * difference;
    (first, error.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_diagonalise_the_rates() {
        for stages in [2, 3] {
            let scheme = Scheme::new(stages);
            for i in 0..stages {
                for j in 0..stages {
                    // D = Σ λ r lᵀ over the modes and the conjugates of the complex ones.
                    let sum: f64 = (scheme.modes.iter())
                        .map(|m| {
                            let term = m.value * m.right[i] * m.left[j];
                            if m.is_real() { term.re } else { 2.0 * term.re }
                        })
                        .sum();
                    assert!((sum - scheme.rates[i][j]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn error_weights_are_those_of_radau5() {
        // (−13 − 7√6, −13 + 7√6, −1) / 3 times b̂_0.
        let scheme = Scheme::new(3);
        let root = 6.0_f64.sqrt();
        let known = [-13.0 - 7.0 * root, -13.0 + 7.0 * root, -1.0];
        for (e, known) in scheme.error.1.iter().zip(known) {
            assert!((e / scheme.error.0 - known / 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn dense_output_meets_the_stages() {
        let scheme = Scheme::new(3);
        for (i, &c) in scheme.nodes.iter().enumerate() {
            let (w, rate) = scheme.dense_weights(c);
            for j in 0..3 {
                let one = if i == j { 1.0 } else { 0.0 };
                assert!((w[j] - one).abs() < 1e-13);
                assert!((rate[j] - scheme.rates[i][j]).abs() < 1e-12);
            }
        }
    }
}
