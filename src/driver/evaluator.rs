//! A problem as a nonlinear program for the optimiser.

use super::analysed::Analysed;
use super::fit;
use super::integration::Integration;
use super::known_evaluations::{EvaluationContext, KnownEvaluations, bits};
use super::shared::Shared;
use super::speculation::SpeculativeCache;
use crate::optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp, Residuals};
use crate::problem::{Problem, Sense};
use crate::report::evaluations::Work;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

/// The steps of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JudgedOn {
    /// Number of steps.
    pub steps: Option<usize>,
    /// How often they had been chosen anew.
    pub refreshes: usize,
}

/// The steps of every evaluated design, keyed by its exact bits; shared with the observer of the
/// run.
pub type Judgements = Rc<RefCell<HashMap<Vec<u64>, JudgedOn>>>;

/// The problem as a nonlinear program. It keeps the last simulated design, so a gradient at the
/// point just evaluated costs the backward march only.
pub struct Evaluator<'a> {
    problem: &'a Problem,
    objective: usize,
    sign: f64,
    last: Option<Analysed>,
    /// The steps in use.
    pub integration: Integration,
    /// Number of designs that do not fulfil the conditions of the lowering.
    pub unlowered: usize,
    log: KnownEvaluations<'a>,
    speculative: SpeculativeCache,
    /// The log's choice of steps that `integration` uses, and the recorded evaluation whose
    /// event it knows.
    choice: Option<usize>,
    latest: Option<usize>,
    /// The steps of each evaluated design.
    pub judgements: Judgements,
    /// Why the latest design without values has none, and that without gradients.
    pub without_values: Option<String>,
    pub without_gradients: Option<String>,
    /// Whether the first gradient was judged, and why it is refused, if it is.
    judged: bool,
    refused: Option<String>,
}

impl<'a> Evaluator<'a> {
    /// The program that `problem` states, or `None` if it has no objective.
    pub fn new(problem: &'a Problem, log: KnownEvaluations<'a>) -> Option<Self> {
        Self::shared(problem, log, None)
    }

    /// The same over ranks, if there are any.
    pub fn shared(
        problem: &'a Problem,
        log: KnownEvaluations<'a>,
        ranks: Option<Arc<Shared>>,
    ) -> Option<Self> {
        let objective = problem.objective?;
        let sign = match objective.sense {
            Sense::Minimise => 1.0,
            Sense::Maximise => -1.0,
        };
        let asked = asked(problem, objective.function);
        let mut integration = Integration::of(problem, Some(&asked), true);
        integration.shared = ranks;
        Some(Self {
            problem,
            objective: objective.function,
            sign,
            last: None,
            integration,
            unlowered: 0,
            log,
            speculative: SpeculativeCache::default(),
            choice: None,
            latest: None,
            judgements: Judgements::default(),
            without_values: None,
            without_gradients: None,
            judged: false,
            refused: None,
        })
    }

    /// +1 if the objective is minimised, −1 if it is maximised.
    pub fn sign(&self) -> f64 {
        self.sign
    }

    /// Indices of the objective's function and the constraints' functions.
    fn functions(&self) -> Vec<usize> {
        asked(self.problem, self.objective)
    }

    /// Work of all simulations and gradients so far, including those that the log knew.
    pub fn counts(&self) -> Work {
        self.log.work()
    }

    /// Adopts the steps and the event of the log. A motion that failed may have left steps that the log does not know.
    fn follow(&mut self, failed: bool) {
        let choice = self.log.choice();
        if choice != self.choice || failed {
            self.choice = choice;
            if let Some(kept) = self.log.steps() {
                self.integration.restore(kept);
            }
        }
        if let Some((place, events)) = self.log.latest()
            && self.latest != Some(*place)
        {
            self.latest = Some(*place);
            self.integration.recall_events(events);
        }
    }

    /// Computes the gradients at `points` side by side, if they will be requested. `x` is scaled as
    /// in the optimiser.
    pub fn foresee_gradients(&mut self, points: &[Vec<f64>]) {
        let functions = self.functions();
        let designs = self.unknown(points, true);
        let wanted = (&designs[..], &functions[..]);
        let (problem, integration) = (self.problem, &self.integration);
        self.speculative.differentiate(problem, integration, wanted);
    }

    /// The designs of `points` that the log does not know.
    fn unknown(&self, points: &[Vec<f64>], of_gradients: bool) -> Vec<Vec<f64>> {
        let designs = points.iter().map(|x| unscaled(self.problem, x));
        designs
            .filter(|x| !self.log.knows(of_gradients, x))
            .collect()
    }

    fn failure(&self, reason: String) -> EvaluationFailure {
        EvaluationFailure {
            what: format!("the simulation of \"{}\"", self.problem.name),
            reason,
        }
    }
}

fn asked(problem: &Problem, objective: usize) -> Vec<usize> {
    let constraints = problem.constraints.iter().map(|c| c.function);
    std::iter::once(objective).chain(constraints).collect()
}

/// Why there is no gradient at a design: the objective or a constraint has no derivative there. Of a constraint
/// strictly inside its bounds any derivative will do.
fn no_gradient(problem: &Problem, at: &Analysed, objective: usize) -> Option<String> {
    let matters = |c: &&crate::problem::Constraint| {
        let value = at.value(c.function);
        value < c.lower || value >= c.upper
    };
    let rows = problem.constraints.iter().filter(matters);
    let mut asked = std::iter::once(objective).chain(rows.map(|c| c.function));
    asked.find_map(|f| at.no_derivative(problem, f))
}

/// Before and after a motion that several ranks compute together, if they do: whether the run goes on.
///
/// # Errors
/// It must end.
fn meet(
    (ranks, problem): (Option<&Arc<Shared>>, &Problem),
    account: &mut EvaluationContext,
    x: &[f64],
) -> Result<(), String> {
    let Some(ranks) = ranks else {
        return Ok(());
    };
    let met = ranks.meet(x, problem.simulation.limits.is_over());
    account.interrupted |= met.is_err();
    met.map_err(|lost| lost.to_string())
}

/// The simulated design `x`: the last one, or a new one.
fn at<'e>(
    (last, speculative): (&'e mut Option<Analysed>, &mut SpeculativeCache),
    (integration, account): (&mut Integration, &mut EvaluationContext),
    (problem, functions): (&Problem, &[usize]),
    x: &[f64],
) -> Result<&'e Analysed, String> {
    let found = match last.take().filter(|last| last.x() == x) {
        Some(known) => Ok(known),
        None => {
            let ranks = integration.shared.clone();
            let ranks = (ranks.as_ref(), problem);
            meet(ranks, account, x)?;
            integration.settle(account.settled.as_ref());
            let found = match speculative.take(integration, x) {
                Some(found) => found.map(|evaluated| (evaluated, None)),
                None => Analysed::with(integration, problem, x, functions),
            };
            meet(ranks, account, x)?;
            found.map(|(evaluated, refresh)| {
                account.refresh = refresh;
                if !account.repeated {
                    account.work += evaluated.counts();
                }
                evaluated
            })
        }
    };
    integration.settle(None);
    account.events = integration.events();
    let found = found.map_err(|failure| {
        account.interrupted = integration.is_over();
        failure.to_string()
    });
    Ok(last.insert(found?))
}

impl Nlp for Evaluator<'_> {
    fn variables(&self) -> usize {
        self.problem.variables.len()
    }

    fn constraints(&self) -> usize {
        self.problem.constraints.len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.problem
            .variables
            .iter()
            .map(|v| (v.lower / v.scale, v.upper / v.scale))
            .unzip()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.problem
            .constraints
            .iter()
            .map(|c| (c.lower, c.upper))
            .unzip()
    }

    fn start(&self) -> Vec<f64> {
        self.problem
            .variables
            .iter()
            .map(|v| v.start / v.scale)
            .collect()
    }

    fn variable_name(&self, i: usize) -> String {
        self.problem.variables[i].name.clone()
    }

    fn variable_unit(&self, i: usize) -> f64 {
        self.problem.variables[i].scale
    }

    fn constraint_name(&self, j: usize) -> String {
        self.problem.constraints[j].name.clone()
    }

    fn is_interrupted(&self) -> bool {
        match &self.integration.shared {
            Some(ranks) => ranks.is_over(),
            None => self.problem.simulation.limits.is_over(),
        }
    }

    fn seconds_since(&self, started: Instant) -> f64 {
        match &self.integration.shared {
            Some(ranks) => ranks.seconds(),
            None => started.elapsed().as_secs_f64(),
        }
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        // Gradients that mean nothing at the start mean nothing beside it.
        if let Some(reason) = &self.refused {
            return Err(self.failure(reason.clone()));
        }
        let x = unscaled(self.problem, x);
        let functions = self.functions();
        let problem = self.problem;
        let integration = &mut self.integration;
        let made = (&mut self.last, &mut self.speculative);
        let (before, mut known) = (integration.unlowered, true);
        let found = self.log.values(&x, |account| {
            known = false;
            let steps = (&mut *integration, account);
            let asked = (problem, &functions[..]);
            let at = at(made, steps, asked, &x)?;
            let mut values = Vec::with_capacity(functions.len());
            for &f in &functions {
                let value = at.value(f);
                if !value.is_finite() {
                    return Err(at.not_finite_value(problem, f, value));
                }
                values.push(value);
            }
            Ok(values)
        });
        self.unlowered += match known {
            true => usize::from(problem.has_scene() && !problem.lowered_scene(&x).1),
            false => integration.unlowered - before,
        };
        self.follow(found.is_err());
        let judged = JudgedOn {
            steps: self.integration.steps(),
            refreshes: self.integration.refreshes,
        };
        let mut judgements = self.judgements.borrow_mut();
        judgements.entry(bits(&x)).or_insert(judged);
        drop(judgements);
        if let Err(reason) = &found {
            self.without_values = Some(reason.clone());
        }
        let values = found.map_err(|reason| self.failure(reason))?;
        Ok(Evaluation {
            objective: self.sign * values[0],
            constraints: values[1..].to_vec(),
        })
    }

    fn foresee(&mut self, points: &[Vec<f64>]) {
        let designs = self.unknown(points, false);
        let functions = self.functions();
        let asked = (self.problem, &functions[..]);
        self.speculative
            .simulate(asked, &self.integration, &designs);
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let problem = self.problem;
        let x = unscaled(problem, x);
        let functions = self.functions();
        let (last, speculative) = (&mut self.last, &mut self.speculative);
        let integration = &mut self.integration;
        let (judged, refused) = (&mut self.judged, &mut self.refused);
        let found = self.log.gradients(&x, |account| {
            if let Some((gradients, [run, own])) = speculative.take_gradients(integration, &x) {
                if !account.repeated {
                    account.work += run;
                }
                account.work += own;
                return Ok(gradients);
            }
            let ranks = integration.shared.clone();
            let (made, steps) = ((last, speculative), (integration, &mut *account));
            let asked = (problem, &functions[..]);
            let at = at(made, steps, asked, &x)?;
            let is_over = || match &ranks {
                Some(ranks) => ranks.is_over(),
                None => problem.simulation.limits.is_over(),
            };
            if let Some(why) = no_gradient(problem, at, functions[0]) {
                return Err(why);
            }
            let found = at.gradients(problem, &functions);
            meet((ranks.as_ref(), problem), account, &x)?;
            let (gradients, work) = found.map_err(|failure| {
                account.interrupted = is_over();
                failure.to_string()
            })?;
            account.work += work;
            for (&f, gradient) in functions.iter().zip(&gradients) {
                if let Some(i) = gradient.iter().position(|d| !d.is_finite()) {
                    return Err(at.not_finite_derivative(problem, (f, i), gradient[i]));
                }
            }
            if !std::mem::replace(judged, true) {
                *refused = at.refused(problem, &functions, &gradients);
                if ranks.is_some() && is_over() {
                    account.interrupted = true;
                    return Err("interrupted".into());
                }
                if let Some(reason) = &*refused {
                    return Err(reason.clone());
                }
            }
            Ok(gradients)
        });
        self.follow(found.is_err());
        if let Err(reason) = &found {
            self.without_gradients = Some(reason.clone());
        }
        let gradients = found.map_err(|reason| self.failure(reason))?;
        let scaled = |f: usize, i: usize| gradients[f][i] * problem.variables[i].scale;
        let n = x.len();
        Ok(Gradients {
            objective: (0..n).map(|i| self.sign * scaled(0, i)).collect(),
            jacobian: Jacobian::from_fn(functions.len() - 1, n, |j, i| scaled(j + 1, i)),
        })
    }

    fn residuals(&mut self, x: &[f64]) -> Result<Option<Residuals>, EvaluationFailure> {
        let problem = self.problem;
        // A fit has no cases that ranks could share.
        let ranks = self.integration.shared.as_ref();
        let alone = ranks.is_none_or(|ranks| ranks.together().is_some());
        let Some(misfits) = fit::fitted(problem).filter(|_| alone) else {
            return Ok(None);
        };
        let x = unscaled(problem, x);
        let found = match self.last.as_ref().filter(|last| last.x() == x) {
            Some(last) => last.residuals(problem, &misfits),
            // The log knew values and gradients.
            None => {
                let mut own = self.integration.clone();
                let which: Vec<usize> = misfits.iter().map(|&(f, _)| f).collect();
                Analysed::with(&mut own, problem, &x, &which)
                    .and_then(|(at, _)| at.residuals(problem, &misfits))
            }
        };
        let found = found.map_err(|failure| self.failure(failure.to_string()))?;
        let Some(found) = found else {
            return Ok(None);
        };
        let rows = found.values.len();
        Ok(Some(Residuals {
            jacobian: Jacobian::from_fn(rows, x.len(), |k, i| {
                found.factors[k] * found.jacobian[k][i] * problem.variables[i].scale
            }),
            values: { found.values.iter().zip(&found.factors) }
                .map(|(r, factor)| factor * r)
                .collect(),
        }))
    }
}

/// A design in the problem's units from the optimiser's, x = scale · x̂.
pub fn unscaled(problem: &Problem, x: &[f64]) -> Vec<f64> {
    // A scaled bound returns as the bound itself, without round-off.
    let clamp = |x: f64, v: &crate::problem::Variable| (x * v.scale).clamp(v.lower, v.upper);
    x.iter()
        .zip(&problem.variables)
        .map(|(&x, v)| clamp(x, v))
        .collect()
}
