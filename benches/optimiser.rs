//! The optimiser's own time: whole runs on a chain of discs with a cheap evaluation.
//!
//! `cargo bench --bench optimiser`. The name of each case has the iterations, the time of one
//! without the evaluations, and the share of the quadratic programs. A simulation of the trebuchet
//! takes about 0.1 s, for comparison.

use std::fmt;

use divan::Bencher;
use flexbody::optimiser::{
    Evaluation, EvaluationFailure, Gradients, Method, Nlp, Options, Outcome, Silent, solve,
};
use nalgebra::DMatrix;

fn main() {
    divan::main();
}

/// Minimise Σ (x_i − t_i)² + 0.1 Σ (x_i − x_{i−1})⁴ within a box; pairs stay in discs and on
/// curves.
struct Chain {
    n: usize,
}

impl Chain {
    fn target(i: usize) -> f64 {
        1.5 * (0.7 * i as f64).sin()
    }
}

impl Nlp for Chain {
    fn variables(&self) -> usize {
        self.n
    }

    fn constraints(&self) -> usize {
        self.n / 2
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![-1.0; self.n], vec![1.2; self.n])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let upper = (0..self.n / 2).map(|j| {
            if j.is_multiple_of(2) {
                f64::INFINITY
            } else {
                0.0
            }
        });
        (vec![0.0; self.n / 2], upper.collect())
    }

    fn start(&self) -> Vec<f64> {
        vec![0.5; self.n]
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let pull: f64 = (0..self.n).map(|i| (x[i] - Self::target(i)).powi(2)).sum();
        let chain: f64 = x.windows(2).map(|w| (w[1] - w[0]).powi(4)).sum();
        let row = |j: usize| {
            let (a, b) = (x[2 * j], x[2 * j + 1]);
            if j.is_multiple_of(2) {
                1.5 - a * a - b * b
            } else {
                a + b * x[2 * j - 2] - 0.2
            }
        };
        let constraints = (0..self.n / 2).map(row).collect();
        Ok(Evaluation {
            objective: pull + 0.1 * chain,
            constraints,
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut objective: Vec<f64> = (0..self.n)
            .map(|i| 2.0 * (x[i] - Self::target(i)))
            .collect();
        for i in 1..self.n {
            let slope = 0.4 * (x[i] - x[i - 1]).powi(3);
            objective[i] += slope;
            objective[i - 1] -= slope;
        }
        let mut jacobian = DMatrix::zeros(self.n / 2, self.n);
        for j in 0..self.n / 2 {
            let (a, b) = (2 * j, 2 * j + 1);
            if j.is_multiple_of(2) {
                jacobian[(j, a)] = -2.0 * x[a];
                jacobian[(j, b)] = -2.0 * x[b];
            } else {
                jacobian[(j, a)] = 1.0;
                jacobian[(j, b)] = x[a - 2];
                jacobian[(j, a - 2)] = x[b];
            }
        }
        Ok(Gradients {
            objective,
            jacobian,
        })
    }
}

/// A method on a chain, within a number of iterations.
#[derive(Clone)]
struct Case {
    n: usize,
    options: Options,
    done: Outcome,
}

impl Case {
    fn new(n: usize, method: Method, max_iterations: usize) -> Case {
        let options = Options {
            method,
            max_iterations,
            ..Options::default()
        };
        let done = solve(&mut Chain { n }, &options, &mut Silent);
        Case { n, options, done }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = &self.done.counts;
        let own = counts.seconds - counts.evaluation_seconds;
        write!(
            f,
            "{:?}, {} variables, iterations: {}, each {:.3} ms, quadratic programs {:.0} %",
            self.options.method,
            self.n,
            counts.iterations,
            1e3 * own / counts.iterations.max(1) as f64,
            100.0 * counts.quadratic_program_seconds / own
        )
    }
}

fn cases() -> Vec<Case> {
    vec![
        Case::new(6, Method::InteriorPoint, 500),
        Case::new(100, Method::InteriorPoint, 500),
        Case::new(1000, Method::InteriorPoint, 500),
        Case::new(6, Method::TrustRegion, 500),
        Case::new(100, Method::TrustRegion, 500),
        Case::new(1000, Method::TrustRegion, 5),
    ]
}

#[divan::bench(args = cases(), sample_count = 3, sample_size = 1)]
fn whole_run(bencher: Bencher, case: &Case) {
    bencher.bench_local(|| solve(&mut Chain { n: case.n }, &case.options, &mut Silent).objective);
}
