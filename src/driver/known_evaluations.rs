//! The evaluations of an earlier run, and the receiver of new ones.

use super::integration::{Events, KeptSteps, Refresh};
use crate::integrate::{Grid, Method, WorkCounts};
use crate::problem::Problem;
use crate::report::evaluations::{EvaluationRecord, Found, Head, RowsLeftOut, StepsInUse, Work};
use crate::system::RedundantRows;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::HashMap;

/// Keys of a problem file that do not affect any function.
const SETTINGS: [&str; 5] = ["$schema", "name", "description", "optimiser", "plot"];

/// Known evaluations, and a receiver of new ones.
///
/// The optimiser requests the same designs in the same order if its program returns the same
/// numbers. So a run that is given the evaluations of an interrupted one repeats the same
/// iterations, multipliers and quasi-Newton matrices without a simulation, and then continues. No
/// design is evaluated twice.
#[derive(Default)]
pub struct KnownEvaluations<'a> {
    /// Keyed by whether they are gradients, and by the exact bits of the design.
    known: HashMap<(bool, Vec<u64>), Known>,
    /// How many evaluations there are.
    count: usize,
    /// All choices of steps, and the one in use after the evaluations so far.
    choices: Vec<Choice>,
    in_use: Option<usize>,
    /// The latest requested evaluation of the record, and the time of the event by then.
    latest: Option<(usize, Events)>,
    /// The design of that evaluation, the last one simulated.
    simulated: Vec<u64>,
    /// Work of all requested evaluations.
    work: Work,
    record: Option<Box<dyn FnMut(EvaluationRecord) + 'a>>,
}

/// An evaluation that is known.
struct Known {
    found: Found,
    /// Its number in the record.
    place: usize,
    /// The choice of steps in use at that time.
    steps: Option<usize>,
    events: Events,
    /// Its work, until it is counted.
    work: Work,
}

/// Additional data of an evaluation.
#[derive(Default)]
pub struct EvaluationContext {
    /// Before: times of the events at this design with the steps in use, if known.
    pub settled: Option<Events>,
    /// Before: whether another process simulated this design just before it ended. The extra
    /// simulation is not counted: a resumed run would not repeat it.
    pub repeated: bool,
    /// After: the choice of steps that it caused.
    pub refresh: Option<Refresh>,
    /// After: times of the events in the last motions.
    pub events: Events,
    /// After: its work.
    pub work: WorkCounts,
    /// After: whether it failed because the run is interrupted. Then it is not recorded.
    pub interrupted: bool,
}

/// Steps that were chosen, or used once more.
struct Choice {
    steps: StepsInUse,
    /// Number of other choices before their first use.
    refreshes: usize,
}

impl<'a> KnownEvaluations<'a> {
    /// A log that knows `earlier` and passes new evaluations to `record`.
    pub fn new(earlier: Vec<EvaluationRecord>, record: impl FnMut(EvaluationRecord) + 'a) -> Self {
        let mut log = Self {
            record: Some(Box::new(record)),
            ..Self::default()
        };
        for EvaluationRecord {
            design,
            found,
            event,
            events_of_cases,
            work,
        } in earlier
        {
            match found {
                Found::Steps(steps) => log.choose(steps),
                found => {
                    let of_gradients = matches!(found, Found::Gradients(_) | Found::NoGradients(_));
                    let known = Known {
                        found,
                        place: log.count,
                        steps: log.choices.len().checked_sub(1),
                        events: Events {
                            own: event,
                            cases: events_of_cases,
                        },
                        work,
                    };
                    log.count += 1;
                    log.known.insert((of_gradients, bits(&design)), known);
                }
            }
        }
        log
    }

    /// Index of the choice of steps in use, from 0, if there is one.
    pub fn choice(&self) -> Option<usize> {
        self.in_use
    }

    /// Method and steps of the choice in use.
    pub fn steps(&self) -> Option<KeptSteps> {
        let Choice { steps, refreshes } = &self.choices[self.in_use?];
        kept(steps, *refreshes)
    }

    /// The number of the latest requested evaluation of the record, and the times of the events in
    /// the last motions by then.
    pub fn latest(&self) -> Option<&(usize, Events)> {
        self.latest.as_ref()
    }

    /// Whether values (or gradients) at a design are known.
    pub fn knows(&self, of_gradients: bool, design: &[f64]) -> bool {
        self.known.contains_key(&(of_gradients, bits(design)))
    }

    /// Work of all requested evaluations, including the known ones.
    pub fn work(&self) -> Work {
        self.work
    }

    fn choose(&mut self, steps: StepsInUse) {
        let same = |c: &&Choice| {
            let (a, b) = (&c.steps, &steps);
            let same = a.method == b.method && a.ends == b.ends && a.cells == b.cells;
            same && a.left_out == b.left_out && a.cases == b.cases
        };
        let refreshes = match self.choices.iter().find(same) {
            Some(known) => known.refreshes,
            None => {
                let next = self.choices.iter().map(|c| c.refreshes + 1).max();
                next.unwrap_or(0)
            }
        };
        self.choices.push(Choice { steps, refreshes });
    }

    /// Values at a design: known, or computed by `evaluate` and recorded.
    pub fn values(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce(&mut EvaluationContext) -> Result<Vec<f64>, String>,
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
        let mut account = EvaluationContext {
            repeated: self.simulated == bits(design),
            ..EvaluationContext::default()
        };
        let found = evaluate(&mut account).and_then(finite);
        if account.interrupted {
            return found;
        }
        let recorded = match &found {
            Ok(values) => Found::Values(values.clone()),
            Err(why) => Found::NoValues(why.clone()),
        };
        self.learn(false, design, recorded, account);
        found
    }

    /// Gradients at a design, in the same way.
    pub fn gradients(
        &mut self,
        design: &[f64],
        evaluate: impl FnOnce(&mut EvaluationContext) -> Result<Vec<Vec<f64>>, String>,
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
        let mut account = EvaluationContext {
            settled: self.settled(design),
            repeated: self.simulated == bits(design),
            ..EvaluationContext::default()
        };
        let found = evaluate(&mut account).and_then(finite);
        if account.interrupted {
            return found;
        }
        let recorded = match &found {
            Ok(gradients) => Found::Gradients(gradients.clone()),
            Err(why) => Found::NoGradients(why.clone()),
        };
        self.learn(true, design, recorded, account);
        found
    }

    /// Times of the events at a design whose values are known with the steps in use.
    fn settled(&self, design: &[f64]) -> Option<Events> {
        let known = self.known.get(&(false, bits(design)))?;
        let judged = matches!(known.found, Found::Values(_)) && known.steps == self.in_use;
        judged.then(|| known.events.clone())
    }

    /// The known evaluation of a design. The steps in use are then at least those of that time.
    fn recall(&mut self, of_gradients: bool, design: &[f64]) -> Option<Found> {
        let design = bits(design);
        let known = self.known.get_mut(&(of_gradients, design.clone()))?;
        self.in_use = self.in_use.max(known.steps);
        if self
            .latest
            .as_ref()
            .is_none_or(|(place, _)| *place < known.place)
        {
            self.latest = Some((known.place, known.events.clone()));
            self.simulated = design;
        }
        self.work += std::mem::take(&mut known.work);
        Some(known.found.clone())
    }

    fn learn(
        &mut self,
        of_gradients: bool,
        design: &[f64],
        found: Found,
        account: EvaluationContext,
    ) {
        self.refreshed(design, account.refresh);
        let (events, place) = (account.events, self.count);
        let work = Work::from(account.work);
        self.work += work;
        self.latest = Some((place, events.clone()));
        self.simulated = bits(design);
        self.count += 1;
        let known = Known {
            found: found.clone(),
            place,
            steps: self.in_use,
            events: events.clone(),
            work: Work::default(),
        };
        self.known.insert((of_gradients, bits(design)), known);
        self.write(EvaluationRecord {
            design: design.to_vec(),
            found,
            event: events.own,
            events_of_cases: events.cases,
            work,
        });
    }

    /// Records a change of the steps in use, before the evaluations that use them. A return to
    /// these steps after an earlier run had changed to others is a change too.
    fn refreshed(&mut self, design: &[f64], refresh: Option<Refresh>) {
        let left = |k: &usize| k + 1 < self.choices.len();
        if let Some(refresh) = refresh {
            self.take(design, steps_of(refresh));
        } else if let Some(k) = self.in_use.filter(left) {
            let steps = StepsInUse {
                reason: "as before".into(),
                ..self.choices[k].steps.clone()
            };
            self.take(design, steps);
        }
    }

    fn take(&mut self, design: &[f64], steps: StepsInUse) {
        self.choose(steps.clone());
        self.in_use = Some(self.choices.len() - 1);
        self.write(EvaluationRecord {
            design: design.to_vec(),
            found: Found::Steps(steps),
            event: None,
            events_of_cases: Vec::new(),
            work: Work::default(),
        });
    }

    fn write(&mut self, evaluation: EvaluationRecord) {
        if let Some(record) = &mut self.record {
            record(evaluation);
        }
    }
}

/// Steps of a choice, as they are recorded: method and why, ends and cells, and why they were chosen.
pub(super) fn steps_of(refresh: Refresh) -> StepsInUse {
    let Refresh {
        method,
        method_reason,
        grid,
        reason,
        cases,
    } = refresh;
    let grid = grid.as_ref();
    StepsInUse {
        method,
        method_reason,
        reason,
        cells: grid.map_or_else(Vec::new, |grid| grid.all_cells().to_vec()),
        left_out: grid.map_or_else(Vec::new, rows_left_out),
        kinks: grid.map_or_else(Vec::new, |grid| grid.kinks().to_vec()),
        equal: grid.is_some_and(Grid::is_equal),
        ends: grid.map_or_else(Vec::new, |grid| grid.ends().to_vec()),
        cases: cases.into_iter().map(|own| own.map(steps_of)).collect(),
    }
}

/// Recorded steps, after so many other choices.
pub(super) fn kept(steps: &StepsInUse, refreshes: usize) -> Option<KeptSteps> {
    let cases = steps.cases.iter().map(|own| kept(own.as_ref()?, 0));
    Some(KeptSteps {
        cases: cases.collect(),
        method: match steps.cases.is_empty() {
            true => Method::named(&steps.method)?,
            // Cases have theirs.
            false => Method::Dop853,
        },
        reason: steps.method_reason.clone(),
        grid: steps.grid(),
        refreshes,
    })
}

/// The redundant rows that are left out, by step.
fn rows_left_out(grid: &Grid) -> Vec<RowsLeftOut> {
    let one = |(from, rows): &(usize, RedundantRows)| RowsLeftOut {
        from: *from,
        rows: rows.numbers().collect(),
        of: rows.count(),
    };
    grid.choices().iter().map(one).collect()
}

/// The head of the record: the problem that the evaluations belong to.
pub fn head(problem: &Problem) -> Head {
    let objective = problem.objective.map(|o| o.function);
    let constraints = problem.constraints.iter().map(|c| c.function);
    let document = problem.document.as_object().cloned().unwrap_or_default();
    let is_setting = |(key, _): &(String, Value)| SETTINGS.contains(&key.as_str());
    let (settings, stated): (Map<_, _>, Map<_, _>) = document.into_iter().partition(is_setting);
    let hash = Sha256::digest(Value::Object(stated).to_string() + &problem.files);
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
        chained: true,
        lowered: Some(problem.is_lowered()),
    }
}

/// A design to the last bit.
pub(super) fn bits(design: &[f64]) -> Vec<u64> {
    design.iter().map(|x| x.to_bits()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(ends: &[f64]) -> EvaluationRecord {
        EvaluationRecord {
            design: vec![0.0],
            found: Found::Steps(StepsInUse {
                method: "dop853".into(),
                reason: "first design".into(),
                method_reason: None,
                ends: ends.to_vec(),
                kinks: Vec::new(),
                equal: false,
                cells: Vec::new(),
                left_out: Vec::new(),
                cases: Vec::new(),
            }),
            event: None,
            events_of_cases: Vec::new(),
            work: Work::default(),
        }
    }

    fn value(x: f64) -> EvaluationRecord {
        EvaluationRecord {
            design: vec![x],
            found: Found::Values(vec![x]),
            event: None,
            events_of_cases: Vec::new(),
            work: Work::default(),
        }
    }

    /// A run that departs from the earlier one continues with the steps of that time, and its log
    /// says so.
    #[test]
    fn steps_are_those_of_the_last_known_evaluation() {
        let (coarse, fine) = ([0.0, 1.0], [0.0, 0.5, 1.0]);
        let earlier = vec![steps(&coarse), value(1.0), steps(&fine), value(2.0)];
        let mut written = Vec::new();
        let mut log = KnownEvaluations::new(earlier.clone(), |record| written.push(record));
        let never = |_: &mut EvaluationContext| -> Result<Vec<f64>, String> { panic!("is known") };
        assert!(log.steps().is_none());
        assert_eq!(log.values(&[1.0], never), Ok(vec![1.0]));
        let in_use = |log: &KnownEvaluations<'_>| {
            let kept = log.steps().expect("chosen");
            (kept.grid.expect("ends").ends().to_vec(), kept.refreshes)
        };
        assert_eq!(in_use(&log), (coarse.to_vec(), 0));
        for x in [3.0, 4.0] {
            assert_eq!(log.values(&[x], |_| Ok(vec![x])), Ok(vec![x]));
            // No design is evaluated twice.
            assert_eq!(log.values(&[x], never), Ok(vec![x]));
        }
        assert_eq!(in_use(&log), (coarse.to_vec(), 0));
        // Earlier evaluations do not restore older steps; later ones set no steps.
        assert_eq!(log.values(&[2.0], never), Ok(vec![2.0]));
        assert_eq!(in_use(&log), (coarse.to_vec(), 0));
        drop(log);
        let mut again = steps(&coarse);
        again.design = vec![3.0];
        if let Found::Steps(steps) = &mut again.found {
            steps.reason = "as before".into();
        }
        assert_eq!(written, [again, value(3.0), value(4.0)]);
        // The log, when read back, has the same evaluations.
        let all = [earlier, written].concat();
        let mut log = KnownEvaluations::new(all, |_| {});
        for (x, ends, refreshes) in [(1.0, &coarse[..], 0), (2.0, &fine, 1), (4.0, &coarse, 0)] {
            assert_eq!(log.values(&[x], never), Ok(vec![x]));
            assert_eq!(in_use(&log), (ends.to_vec(), refreshes));
        }
    }

    /// Events and work are those of the requested evaluations, each counted once. The last of them
    /// in the log determines where the search for the next event starts.
    #[test]
    fn events_and_work_are_those_of_the_course() {
        let known = |x: f64, event: f64| EvaluationRecord {
            event: Some(event),
            work: Work {
                steps: 10,
                ..Work::default()
            },
            ..value(x)
        };
        let mut written = Vec::new();
        let earlier = vec![known(1.0, 0.1), known(2.0, 0.2), known(3.0, 0.3)];
        let mut log = KnownEvaluations::new(earlier, |record| written.push(record));
        let never = |_: &mut EvaluationContext| -> Result<Vec<f64>, String> { panic!("is known") };
        let at = |own: f64| Events {
            own: Some(own),
            cases: Vec::new(),
        };
        for (x, latest) in [(2.0, (1, at(0.2))), (1.0, (1, at(0.2)))] {
            for _ in 0..2 {
                assert_eq!(log.values(&[x], never), Ok(vec![x]));
                assert_eq!(log.latest(), Some(&latest));
            }
        }
        assert_eq!(log.work().steps, 20);
        // If the values are known, the event is that of their evaluation.
        let gradients = |account: &mut EvaluationContext| {
            assert_eq!(account.settled, Some(at(0.1)));
            account.events = at(0.1);
            account.work.steps = 5;
            Ok(vec![vec![1.0]])
        };
        assert_eq!(log.gradients(&[1.0], gradients), Ok(vec![vec![1.0]]));
        assert_eq!(log.values(&[3.0], never), Ok(vec![3.0]));
        assert_eq!(log.latest(), Some(&(3, at(0.1))));
        assert_eq!(log.work().steps, 35);
        drop(log);
        assert_eq!(written.len(), 1);
        assert_eq!((written[0].event, written[0].work.steps), (Some(0.1), 5));
    }
}
