//! What is known of a problem from an earlier run, and where new evaluations are written.

use crate::problem::Problem;
use crate::report::evaluations::{EvaluationRecord, Found, Head};
use std::collections::HashMap;

/// Evaluations that are known, and a receiver of new ones.
///
/// The optimiser asks for the same designs in the same order whenever its program returns the same
/// numbers, so a run that is given the evaluations of an interrupted one goes through the same
/// iterations, multipliers and quasi-Newton matrices without a simulation, and then goes on.
#[derive(Default)]
pub struct Journal<'a> {
    /// By whether they are gradients, and by the bits of the design.
    known: HashMap<(bool, Vec<u64>), Found>,
    record: Option<&'a mut dyn FnMut(EvaluationRecord)>,
}

impl<'a> Journal<'a> {
    /// A journal that knows `earlier` and hands new evaluations to `record`.
    pub fn new(
        earlier: Vec<EvaluationRecord>,
        record: &'a mut dyn FnMut(EvaluationRecord),
    ) -> Self {
        let known = earlier
            .into_iter()
            .map(|EvaluationRecord { design, found }| {
                let of_gradients = matches!(found, Found::Gradients(_) | Found::NoGradients(_));
                ((of_gradients, bits(&design)), found)
            })
            .collect();
        Self {
            known,
            record: Some(record),
        }
    }

    /// Values at a design: known, or found by `evaluate` and recorded.
    pub fn values(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce() -> Result<Vec<f64>, String>,
    ) -> Result<Vec<f64>, String> {
        match self.known.get(&(false, bits(design))) {
            Some(Found::Values(values)) => return Ok(values.clone()),
            Some(Found::NoValues(why)) => return Err(why.clone()),
            _ => {}
        }
        let finite = |values: Vec<f64>| match values.iter().find(|x| !x.is_finite()) {
            Some(x) => Err(format!("a value is {x}")),
            None => Ok(values),
        };
        let found = evaluate().and_then(finite);
        let recorded = match &found {
            Ok(values) => Found::Values(values.clone()),
            Err(why) => Found::NoValues(why.clone()),
        };
        self.write(design, recorded);
        found
    }

    /// Gradients at a design, likewise.
    pub fn gradients(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce() -> Result<Vec<Vec<f64>>, String>,
    ) -> Result<Vec<Vec<f64>>, String> {
        match self.known.get(&(true, bits(design))) {
            Some(Found::Gradients(gradients)) => return Ok(gradients.clone()),
            Some(Found::NoGradients(why)) => return Err(why.clone()),
            _ => {}
        }
        let finite =
            |gradients: Vec<Vec<f64>>| match gradients.iter().flatten().find(|x| !x.is_finite()) {
                Some(x) => Err(format!("a derivative is {x}")),
                None => Ok(gradients),
            };
        let found = evaluate().and_then(finite);
        let recorded = match &found {
            Ok(gradients) => Found::Gradients(gradients.clone()),
            Err(why) => Found::NoGradients(why.clone()),
        };
        self.write(design, recorded);
        found
    }

    fn write(&mut self, design: &[f64], found: Found) {
        if let Some(record) = &mut self.record {
            record(EvaluationRecord {
                design: design.to_vec(),
                found,
            });
        }
    }
}

/// What the evaluations of a problem belong to.
pub fn head(problem: &Problem) -> Head {
    let objective = problem.objective.map(|o| o.function);
    let constraints = problem.constraints.iter().map(|c| c.function);
    Head {
        sha256: problem.hash.clone(),
        start: problem.start(),
        variables: problem.variables.iter().map(|v| v.name.clone()).collect(),
        functions: objective
            .into_iter()
            .chain(constraints)
            .map(|f| problem.function_names[f].clone())
            .collect(),
    }
}

fn bits(design: &[f64]) -> Vec<u64> {
    design.iter().map(|x| x.to_bits()).collect()
}
