//! Minimises Rosenbrock's function in a disc by the optimiser alone:
//! `cargo run --release --example optimiser`.

use flexbody::optimiser::{
    Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp, Options, Silent, Status, solve,
};

/// Minimise (1 − x)² + 100 (y − x²)² subject to x² + y² ≤ 1.
struct Rosenbrock;

impl Nlp for Rosenbrock {
    fn variables(&self) -> usize {
        2
    }

    fn constraints(&self) -> usize {
        1
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![f64::NEG_INFINITY; 2], vec![f64::INFINITY; 2])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![f64::NEG_INFINITY], vec![1.0])
    }

    fn start(&self) -> Vec<f64> {
        vec![-1.2, 1.0]
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        Ok(Evaluation {
            objective: a * a + 100.0 * b * b,
            constraints: vec![x[0] * x[0] + x[1] * x[1]],
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        Ok(Gradients {
            objective: vec![-2.0 * a - 400.0 * b * x[0], 200.0 * b],
            jacobian: Jacobian::dense(1, 2, vec![2.0 * x[0], 2.0 * x[1]]),
        })
    }
}

/// Runs the example.
pub fn main() {
    let found = solve(&mut Rosenbrock, &Options::default(), &mut Silent);
    println!(
        "{:?} at {:?}: f = {:.8}",
        found.status, found.x, found.objective
    );
    println!(
        "multiplier of the disc: {:.6}",
        found.multipliers.constraints[0]
    );
    assert_eq!(found.status, Status::Converged);
    assert!((found.objective - 0.045_674_8).abs() < 1e-6);
}
