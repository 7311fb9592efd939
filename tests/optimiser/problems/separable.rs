//! A program of any size: a chain of springs in a box, with two full rows or with sparse rows.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp};

#[derive(Clone, Copy)]
pub enum Rows {
    /// The mean of all variables and of their squares.
    Two,
    /// So many discs, each of three variables.
    Sparse(usize),
}

/// Minimise Σ ½ w_i (x_i − t_i)² + 0.1 Σ (x_i − x_{i−1})⁴ within a box.
pub struct Separable {
    pub n: usize,
    pub rows: Rows,
}

impl Separable {
    fn target(i: usize) -> f64 {
        1.5 * (0.7 * i as f64).sin()
    }

    fn weight(i: usize) -> f64 {
        1.0 + 9.0 * (0.3 * i as f64).cos().powi(2)
    }

    /// First variable of a disc.
    fn first(&self, j: usize, count: usize) -> usize {
        j * (self.n / count)
    }
}

impl Nlp for Separable {
    fn variables(&self) -> usize {
        self.n
    }

    fn constraints(&self) -> usize {
        match self.rows {
            Rows::Two => 2,
            Rows::Sparse(count) => count,
        }
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![-1.0; self.n], vec![1.2; self.n])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let m = self.constraints();
        let upper = match self.rows {
            Rows::Two => vec![-0.1, 0.5],
            Rows::Sparse(_) => vec![1.5; m],
        };
        (vec![f64::NEG_INFINITY; m], upper)
    }

    fn start(&self) -> Vec<f64> {
        vec![0.5; self.n]
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let n = self.n as f64;
        let pull: f64 = (x.iter().enumerate())
            .map(|(i, x)| 0.5 * Self::weight(i) * (x - Self::target(i)).powi(2))
            .sum();
        let chain: f64 = x.windows(2).map(|w| (w[1] - w[0]).powi(4)).sum();
        let constraints = match self.rows {
            Rows::Two => vec![
                x.iter().sum::<f64>() / n,
                x.iter().map(|x| x * x).sum::<f64>() / n,
            ],
            Rows::Sparse(count) => (0..count)
                .map(|j| {
                    let at = self.first(j, count);
                    x[at..at + 3].iter().map(|x| x * x).sum()
                })
                .collect(),
        };
        Ok(Evaluation {
            objective: pull + 0.1 * chain,
            constraints,
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let n = self.n;
        let mut objective: Vec<f64> = (0..n)
            .map(|i| Self::weight(i) * (x[i] - Self::target(i)))
            .collect();
        for i in 1..n {
            let slope = 0.4 * (x[i] - x[i - 1]).powi(3);
            objective[i] += slope;
            objective[i - 1] -= slope;
        }
        let jacobian = match self.rows {
            Rows::Two => {
                let mean = std::iter::repeat_n(1.0 / n as f64, n);
                let squares = x.iter().map(|x| 2.0 * x / n as f64);
                Jacobian::dense(2, n, mean.chain(squares).collect())
            }
            Rows::Sparse(count) => {
                let entries = (0..count).flat_map(|j| {
                    let at = self.first(j, count);
                    (at..at + 3).map(move |i| (j, i, 2.0 * x[i]))
                });
                Jacobian::sparse(count, n, entries)
            }
        };
        Ok(Gradients {
            objective,
            jacobian,
        })
    }
}
