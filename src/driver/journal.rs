//! What is known of a problem from an earlier run, and where new evaluations are written.

use super::integration::Refresh;
use crate::integrate::{Grid, Method};
use crate::problem::Problem;
use crate::report::evaluations::{EvaluationRecord, Found, Head, StepsInUse};
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
    /// Steps in use at the end of the earlier run, and how often it chose them.
    steps: Option<(StepsInUse, usize)>,
    record: Option<&'a mut dyn FnMut(EvaluationRecord)>,
}

impl<'a> Journal<'a> {
    /// A journal that knows `earlier` and hands new evaluations to `record`.
    pub fn new(
        earlier: Vec<EvaluationRecord>,
        record: &'a mut dyn FnMut(EvaluationRecord),
    ) -> Self {
        let chosen = |record: &EvaluationRecord| match &record.found {
            Found::Steps(steps) => Some(steps.clone()),
            _ => None,
        };
        let times = earlier.iter().filter_map(chosen).count();
        let steps = earlier.iter().rev().find_map(chosen);
        let steps = steps.map(|steps| (steps, times));
        let known = earlier
            .into_iter()
            .filter(|record| !matches!(record.found, Found::Steps(_)))
            .map(|EvaluationRecord { design, found }| {
                let of_gradients = matches!(found, Found::Gradients(_) | Found::NoGradients(_));
                ((of_gradients, bits(&design)), found)
            })
            .collect();
        Self {
            known,
            steps,
            record: Some(record),
        }
    }

    /// Method and steps in use at the end of the earlier run, and how often it chose them.
    pub fn steps(&self) -> Option<(Method, Grid, usize)> {
        let (steps, times) = self.steps.as_ref()?;
        let method = Method::adaptive(&steps.method)?;
        Some((method, Grid::from_ends(steps.ends.clone())?, *times))
    }

    /// Values at a design: known, or found by `evaluate` and recorded.
    pub fn values(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce(&mut Option<Refresh>) -> Result<Vec<f64>, String>,
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
        let mut refresh = None;
        let found = evaluate(&mut refresh).and_then(finite);
        self.refreshed(design, refresh);
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
        evaluate: impl FnOnce(&mut Option<Refresh>) -> Result<Vec<Vec<f64>>, String>,
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
        let mut refresh = None;
        let found = evaluate(&mut refresh).and_then(finite);
        self.refreshed(design, refresh);
        let recorded = match &found {
            Ok(gradients) => Found::Gradients(gradients.clone()),
            Err(why) => Found::NoGradients(why.clone()),
        };
        self.write(design, recorded);
        found
    }

    /// Writes a change of the steps in use, before what was found with them.
    fn refreshed(&mut self, design: &[f64], refresh: Option<Refresh>) {
        if let Some(Refresh {
            method,
            grid,
            reason,
        }) = refresh
        {
            let ends = grid.ends().to_vec();
            let steps = StepsInUse {
                method,
                reason,
                ends,
            };
            self.write(design, Found::Steps(steps));
        }
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
