//! A program whose objective is given in another unit.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Nlp};

use crate::problems::problem::Problem;

pub struct Scaled {
    pub inner: Problem,
    pub factor: f64,
}

impl Nlp for Scaled {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        start
    );

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let mut found = self.inner.evaluate(x)?;
        found.objective *= self.factor;
        Ok(found)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut found = self.inner.gradients(x)?;
        found.objective.iter_mut().for_each(|v| *v *= self.factor);
        Ok(found)
    }
}
