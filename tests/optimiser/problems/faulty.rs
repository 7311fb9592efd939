//! Programs whose evaluation fails.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Nlp};

/// How an evaluation fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// An error is returned.
    Error,
    /// The objective is NaN.
    NotANumber,
    /// The last constraint, or else the objective, is infinite.
    Infinite,
}

/// A program that fails at every `period`-th evaluation and gradient.
pub struct Faulty<N: Nlp> {
    pub inner: N,
    pub period: usize,
    pub fault: Fault,
    pub calls: usize,
}

impl<N: Nlp> Faulty<N> {
    fn fails(&mut self) -> bool {
        self.calls += 1;
        self.calls.is_multiple_of(self.period)
    }
}

fn failure() -> EvaluationFailure {
    EvaluationFailure {
        what: "the simulation".into(),
        reason: "Newton stalled".into(),
    }
}

impl<N: Nlp> Nlp for Faulty<N> {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        start
    );

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let mut values = self.inner.evaluate(x)?;
        if self.fails() {
            match self.fault {
                Fault::Error => return Err(failure()),
                Fault::NotANumber => values.objective = f64::NAN,
                Fault::Infinite => match values.constraints.last_mut() {
                    Some(last) => *last = f64::INFINITY,
                    None => values.objective = f64::INFINITY,
                },
            }
        }
        Ok(values)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut slopes = self.inner.gradients(x)?;
        if self.fails() {
            match self.fault {
                Fault::Error => return Err(failure()),
                _ => slopes.objective[0] = f64::NAN,
            }
        }
        Ok(slopes)
    }
}
