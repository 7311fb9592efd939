//! Records of the requests to a program.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Nlp};

/// A program that records every requested design.
pub struct Recorded<N: Nlp> {
    pub inner: N,
    pub designs: Vec<Vec<f64>>,
}

impl<N: Nlp> Nlp for Recorded<N> {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        start,
        gradients
    );

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.designs.push(x.to_vec());
        self.inner.evaluate(x)
    }
}
