//! A case of the bed: a program and what is known of its end.

use flexbody::optimiser::{Nlp, Outcome, Status};

use crate::problems::problem::Problem;
use crate::problems::residuals::Residuals;

/// What is known of a program.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// The least objective. Other stationary points may exist.
    Optimum(f64),
    /// The least objective, at a point without multipliers: no claim of convergence can be true.
    WithoutMultipliers(f64),
    /// Any point that satisfies the first-order conditions will do.
    Stationary,
    /// No point satisfies all rows.
    Infeasible,
    /// The objective falls below every number along feasible points.
    Unbounded,
    /// Nothing can be found: the functions end or the gradients are wrong. The run should say so
    /// after few evaluations.
    Hopeless,
    /// The lists that the program returns have wrong lengths.
    IllPosed,
}

/// How a run ended, seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// The known end, with the right verdict.
    Solved,
    /// Another stationary point, or another end that is true.
    Other,
    /// No verdict.
    Open,
    /// A verdict that is not true.
    False,
}

pub struct Case {
    pub group: &'static str,
    pub name: String,
    pub truth: Truth,
    pub nlp: Box<dyn Nlp>,
}

/// Evaluations with which a hopeless run may end at its limit of work.
const LIMIT: usize = 3000;

pub fn case(group: &'static str, problem: Problem) -> Case {
    let truth = Truth::Optimum(problem.best);
    known(group, truth, problem)
}

pub fn known(group: &'static str, truth: Truth, problem: Problem) -> Case {
    Case {
        group,
        name: problem.name.to_string(),
        truth,
        nlp: Box::new(problem),
    }
}

impl Case {
    pub fn grade(&mut self, outcome: &Outcome) -> Grade {
        let gave_up = matches!(
            outcome.status,
            Status::Stalled
                | Status::Inconsistent { .. }
                | Status::AtPrecision
                | Status::Degenerate { .. }
                | Status::IterationLimit
                | Status::EvaluationLimit
                | Status::TimeLimit
        );
        match (self.truth, &outcome.status) {
            (Truth::IllPosed, Status::IllPosed { .. }) => Grade::Solved,
            (Truth::IllPosed, _) => Grade::Other,
            (_, Status::Converged) => self.grade_of_claim(outcome),
            (Truth::WithoutMultipliers(best), _) if gave_up => {
                let near = (outcome.objective - best).abs() <= 1e-3 * best.abs().max(1.0);
                if near { Grade::Solved } else { Grade::Open }
            }
            // A large objective has no more digits. Its residuals cannot become small.
            (Truth::Optimum(best), Status::AtPrecision) if is_near(outcome.objective, best) => {
                Grade::Solved
            }
            (Truth::Infeasible, Status::Infeasible { .. }) => Grade::Solved,
            (Truth::Unbounded, Status::Unbounded) => Grade::Solved,
            (Truth::Hopeless, _) if gave_up => {
                if outcome.counts.evaluations < LIMIT {
                    Grade::Solved
                } else {
                    Grade::Open
                }
            }
            (_, Status::Infeasible { .. }) => self.grade_of_infeasible(outcome),
            _ if gave_up => Grade::Open,
            _ => Grade::False,
        }
    }

    fn grade_of_claim(&mut self, outcome: &Outcome) -> Grade {
        let least = match self.truth {
            Truth::Optimum(best) => Some(best),
            Truth::Stationary => None,
            // A claim by wrong gradients says nothing of the optimiser.
            Truth::Hopeless => return Grade::Other,
            _ => return Grade::False,
        };
        let found = Residuals::in_unit(self.nlp.as_mut(), outcome, 1.0);
        let holds = found.violation <= 1e-6
            && found.stationarity <= 2e-5
            && found.complementarity <= 1e-6
            && found.signs;
        if !holds {
            return Grade::False;
        }
        match least {
            Some(best) if !is_near(outcome.objective, best) => Grade::Other,
            _ => Grade::Solved,
        }
    }

    /// A claim of infeasibility is false if the violation falls nearby.
    fn grade_of_infeasible(&mut self, outcome: &Outcome) -> Grade {
        if matches!(self.truth, Truth::Unbounded | Truth::Hopeless) {
            return Grade::False;
        }
        let Some(here) = self.violation(&outcome.x) else {
            return Grade::False;
        };
        let size = outcome.x.iter().fold(1.0_f64, |a, v| a.max(v.abs()));
        for trial in 1..400 {
            let reach = size * [1e-1, 1e-2, 1e-3, 1e-4][trial % 4];
            let x: Vec<f64> = (outcome.x.iter().enumerate())
                .map(|(i, v)| {
                    let phase = ((trial * (i + 1)) as f64 * 0.618_033_988_749_895).fract();
                    v + reach * (2.0 * phase - 1.0)
                })
                .collect();
            if self
                .violation(&x)
                .is_some_and(|v| v < here - 1e-6 * here.abs())
            {
                return Grade::False;
            }
        }
        Grade::Other
    }

    /// Largest violation of a row at `x`, moved into its bounds.
    fn violation(&mut self, x: &[f64]) -> Option<f64> {
        let (lower, upper) = self.nlp.variable_bounds();
        let x: Vec<f64> = (0..x.len())
            .map(|i| x[i].clamp(lower[i], upper[i]))
            .collect();
        let c = self.nlp.evaluate(&x).ok()?.constraints;
        let (lower, upper) = self.nlp.constraint_bounds();
        let worst = (0..c.len()).map(|j| (lower[j] - c[j]).max(c[j] - upper[j]));
        Some(worst.fold(0.0, f64::max))
    }
}

fn is_near(value: f64, best: f64) -> bool {
    (value - best).abs() <= 1e-6 * best.abs().max(1.0)
}
