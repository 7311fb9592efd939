//! A finished optimisation as a message from one process to another.

use super::integration::{Events, Integration};
use super::known_evaluations::{kept, steps_of};
use super::multi_start::{Run, started_at};
use super::optimise::{Solved, requested};
use crate::optimiser::Outcome;
use crate::problem::Problem;
use crate::report::evaluations::{StepsInUse, Work};
use crate::report::history::History;
use serde::{Deserialize, Serialize};

/// A [`Run`]; of its problem, which both processes know, only the start.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PackedRun {
    design: Vec<f64>,
    outcome: Outcome,
    history: History,
    /// The steps in use at the end, how often they were chosen, and when the last motions ended.
    steps: Option<StepsInUse>,
    refreshes: usize,
    events: Events,
    sign: f64,
    counts: Work,
    unlowered: usize,
    without_values: Option<String>,
    without_gradients: Option<String>,
}

impl From<Run> for PackedRun {
    fn from(run: Run) -> Self {
        let solved = run.solved;
        Self {
            design: run.problem.start(),
            outcome: solved.outcome,
            history: solved.history,
            steps: solved.integration.in_use("at the end").map(steps_of),
            refreshes: solved.integration.refreshes,
            events: solved.integration.events(),
            sign: solved.sign,
            counts: solved.counts,
            unlowered: solved.unlowered,
            without_values: solved.without_values,
            without_gradients: solved.without_gradients,
        }
    }
}

impl PackedRun {
    /// The run that it was, from the start with number `start`.
    pub fn unpack(self, problem: &Problem, start: usize) -> Run {
        let problem = started_at(problem, &self.design);
        let asked: Vec<usize> = requested(&problem).collect();
        let mut integration = Integration::of(&problem, Some(&asked), true);
        if let Some(steps) = self
            .steps
            .as_ref()
            .and_then(|own| kept(own, self.refreshes))
        {
            integration.restore(steps);
        }
        integration.refreshes = self.refreshes;
        integration.recall_events(&self.events);
        let solved = Solved {
            outcome: self.outcome,
            history: self.history,
            integration,
            sign: self.sign,
            counts: self.counts,
            unlowered: self.unlowered,
            without_values: self.without_values,
            without_gradients: self.without_gradients,
        };
        Run {
            start,
            problem,
            solved,
        }
    }
}
