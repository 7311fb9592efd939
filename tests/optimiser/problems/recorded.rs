//! Records of the requests to a program.

use flexbody::optimiser::{Evaluation, EvaluationFailure, Gradients, Nlp};

/// A program that records every requested design.
pub struct Recorded<N: Nlp> {
    pub inner: N,
    pub designs: Vec<Vec<f64>>,
}

impl<N: Nlp> Nlp for Recorded<N> {
    fn variables(&self) -> usize {
        self.inner.variables()
    }

    fn constraints(&self) -> usize {
        self.inner.constraints()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.inner.variable_bounds()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.inner.constraint_bounds()
    }

    fn start(&self) -> Vec<f64> {
        self.inner.start()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.designs.push(x.to_vec());
        self.inner.evaluate(x)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        self.inner.gradients(x)
    }
}
