//! What is known of a problem from an earlier run, and where new evaluations are written.

use super::integration::Refresh;
use crate::integrate::{Grid, Method};
use crate::problem::Problem;
use crate::report::evaluations::{EvaluationRecord, Found, Head, StepsInUse};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::HashMap;

/// Keys of a problem file that no function follows from.
const SETTINGS: [&str; 5] = ["$schema", "name", "description", "optimiser", "plot"];

/// Evaluations that are known, and a receiver of new ones.
///
/// The optimiser asks for the same designs in the same order whenever its program returns the same
/// numbers, so a run that is given the evaluations of an interrupted one goes through the same
/// iterations, multipliers and quasi-Newton matrices without a simulation, and then goes on. No design
/// is evaluated twice.
#[derive(Default)]
pub struct Journal<'a> {
    /// By whether they are gradients, and by the bits of the design: what was found, and the steps
    /// that were in use then.
    known: HashMap<(bool, Vec<u64>), (Found, Option<usize>)>,
    /// All choices of steps, and the one that the evaluations so far have led to.
    choices: Vec<StepsInUse>,
    in_use: Option<usize>,
    record: Option<Box<dyn FnMut(EvaluationRecord) + 'a>>,
}

impl<'a> Journal<'a> {
    /// A journal that knows `earlier` and hands new evaluations to `record`.
    pub fn new(earlier: Vec<EvaluationRecord>, record: impl FnMut(EvaluationRecord) + 'a) -> Self {
        let mut journal = Self {
            record: Some(Box::new(record)),
            ..Self::default()
        };
        for EvaluationRecord { design, found } in earlier {
            match found {
                Found::Steps(steps) => journal.choices.push(steps),
                found => {
                    let of_gradients = matches!(found, Found::Gradients(_) | Found::NoGradients(_));
                    let steps = journal.choices.len().checked_sub(1);
                    let key = (of_gradients, bits(&design));
                    journal.known.insert(key, (found, steps));
                }
            }
        }
        journal
    }

    /// Which choice of steps is in use, counted from 0, if any was made.
    pub fn choice(&self) -> Option<usize> {
        self.in_use
    }

    /// Method and steps of the choice in use.
    pub fn steps(&self) -> Option<(Method, Grid)> {
        let steps = &self.choices[self.in_use?];
        let method = Method::adaptive(&steps.method)?;
        Some((method, Grid::from_ends(steps.ends.clone())?))
    }

    /// Values at a design: known, or found by `evaluate` and recorded.
    pub fn values(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce(&mut Option<Refresh>) -> Result<Vec<f64>, String>,
    ) -> Result<Vec<f64>, String> {
        match self.recall(false, design) {
            Some(Found::Values(values)) => return Ok(values),
            Some(Found::NoValues(why)) => return Err(why),
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
        self.learn(false, design, recorded);
        found
    }

    /// Gradients at a design, likewise.
    pub fn gradients(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce(&mut Option<Refresh>) -> Result<Vec<Vec<f64>>, String>,
    ) -> Result<Vec<Vec<f64>>, String> {
        match self.recall(true, design) {
            Some(Found::Gradients(gradients)) => return Ok(gradients),
            Some(Found::NoGradients(why)) => return Err(why),
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
        self.learn(true, design, recorded);
        found
    }

    /// What is known of a design; the steps in use are then at least those of that time.
    fn recall(&mut self, of_gradients: bool, design: &[f64]) -> Option<Found> {
        let (found, steps) = self.known.get(&(of_gradients, bits(design)))?;
        self.in_use = self.in_use.max(*steps);
        Some(found.clone())
    }

    fn learn(&mut self, of_gradients: bool, design: &[f64], found: Found) {
        let key = (of_gradients, bits(design));
        self.known.insert(key, (found.clone(), self.in_use));
        self.write(design, found);
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
            self.choices.push(steps.clone());
            self.in_use = Some(self.choices.len() - 1);
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
    let document = problem.document.as_object().cloned().unwrap_or_default();
    let is_setting = |(key, _): &(String, Value)| SETTINGS.contains(&key.as_str());
    let (settings, stated): (Map<_, _>, Map<_, _>) = document.into_iter().partition(is_setting);
    let hash = Sha256::digest(Value::Object(stated).to_string());
    Head {
        sha256: hash.iter().map(|byte| format!("{byte:02x}")).collect(),
        start: problem.start(),
        variables: problem.variables.iter().map(|v| v.name.clone()).collect(),
        functions: objective
            .into_iter()
            .chain(constraints)
            .map(|f| problem.function_names[f].clone())
            .collect(),
        settings,
    }
}

/// A design to the last bit.
pub(super) fn bits(design: &[f64]) -> Vec<u64> {
    design.iter().map(|x| x.to_bits()).collect()
}
