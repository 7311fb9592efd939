//! A design with the values of its functions: a motion, or structures under load cases.

mod cases;
mod check_cases;

use crate::alike::{Message, grouped};
use crate::evaluate::{Derivative, Evaluated};
use crate::functions::evaluate::ungated_maximum;
use crate::functions::instant::Instant;
use crate::functions::{Bound, Function, Reduction};
use crate::integrate::{IntegrationFailure, WorkCounts};
use crate::integration::{Integration, Refresh};
use crate::math::soft_max::Smoothed;
use crate::problem::{Asked, Division, Problem};
use crate::report::optimum::{Aggregate, Integration as IntegrationRecord, Lies};
use crate::report::with_space;
use crate::shared::Elsewhere;
use crate::simulate::{Simulation, simulate, simulate_with};
use crate::statics::{self, StaticDesign, StaticsFailure};
use crate::structures::functions::{self, Peak};
use crate::{CheckedDerivative, composed, error, not_finite, resolved, start};
pub use cases::InCases;
pub(crate) use cases::phases;

/// A design that was analysed.
pub enum Analysed {
    /// A scene in motion.
    Motion(Box<Evaluated>),
    /// Structures that do not move.
    Statics(Box<StaticDesign>),
    /// Several cases.
    Cases(Box<InCases<Analysed>>),
    /// A case that another rank has.
    Elsewhere(Box<Elsewhere>),
}

/// Why a design has no values or no gradients.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisFailure {
    /// The motion.
    #[error(transparent)]
    Motion(#[from] IntegrationFailure),
    /// The structures.
    #[error(transparent)]
    Statics(#[from] StaticsFailure),
    /// A case.
    #[error("in the case \"{case}\": {failure}")]
    InCase {
        /// Its name.
        case: String,
        /// Why.
        failure: Box<AnalysisFailure>,
    },
    /// A phase of a motion with events.
    #[error("{phase}: {failure}")]
    InPhase {
        /// Its name.
        phase: String,
        /// Why.
        failure: Box<AnalysisFailure>,
    },
    /// An event of a motion.
    #[error("the event \"{event}\" does not come: {failure}")]
    NoEvent {
        /// Its name.
        event: String,
        /// Why.
        failure: Box<AnalysisFailure>,
    },
    /// Two events of a motion come at the same time.
    #[error(
        "the events \"{first}\" and \"{second}\" come at once, at t = {time:.6e} s: their order, and what the motion is after \
         them, would be a matter of round-off; make them one event, or move one of them"
    )]
    AtOnce {
        /// The earlier one in the file.
        first: String,
        /// The later one.
        second: String,
        /// When \[s\].
        time: f64,
    },
    /// One motion was requested of several cases.
    #[error("the problem has cases: ask for one of them")]
    SeveralCases,
    /// A motion was requested of structures that do not move.
    #[error("the problem has structures that do not move, so there is no motion to simulate")]
    NoMotion,
    /// The derivatives of a case were asked of a rank that does not have it.
    #[error("another rank has the case")]
    OnAnotherRank,
    /// Something else that a value or a derivative needs is missing.
    #[error("{0}")]
    Undefined(String),
}

impl Analysed {
    /// Analyses the design `x` for the functions `asked` (a motion for all); of a motion with the steps in
    /// use, and also says if these changed.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn with(
        integration: &mut Integration,
        problem: &Problem,
        x: &[f64],
        asked: &[usize],
    ) -> Result<(Self, Option<Refresh>), AnalysisFailure> {
        if let Some(cases) = &problem.cases {
            let (found, refresh) = InCases::with(integration, (problem, cases), x, asked)?;
            return Ok((Self::Cases(Box::new(found)), refresh));
        }
        Ok(match &problem.statics {
            Some(statics) => {
                let design = StaticDesign::of(problem, statics, x, Some(asked))?;
                (Self::Statics(Box::new(design)), None)
            }
            None => {
                let (evaluated, refresh) = Evaluated::with(integration, problem, x)?;
                (Self::Motion(Box::new(evaluated)), refresh)
            }
        })
    }

    /// The design.
    pub fn x(&self) -> &[f64] {
        match self {
            Self::Motion(at) => &at.x,
            Self::Statics(at) => &at.x,
            Self::Cases(at) => &at.x,
            Self::Elsewhere(at) => &at.x,
        }
    }

    /// The value of a function.
    pub fn value(&self, f: usize) -> f64 {
        match self {
            Self::Motion(at) => at.value(f),
            Self::Statics(at) => at.function(f).value,
            Self::Cases(at) => at.value(f),
            Self::Elsewhere(at) => at.value(f),
        }
    }

    /// The work of the analysis.
    pub fn counts(&self) -> WorkCounts {
        match self {
            Self::Motion(at) => at.run.counts,
            Self::Statics(at) => at.counts,
            Self::Cases(at) => at.counts(),
            Self::Elsewhere(at) => at.counts(),
        }
    }

    /// Exact gradients of the functions `which`, and the work they took.
    ///
    /// # Errors
    /// If a function has no gradient there.
    pub fn gradients(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), AnalysisFailure> {
        Ok(match self {
            Self::Motion(at) => at.gradients(problem, which)?,
            Self::Cases(at) => at.gradients(which)?,
            Self::Elsewhere(_) => return Err(AnalysisFailure::OnAnotherRank),
            Self::Statics(at) => {
                let (found, counts) = at.derivatives(problem, which)?;
                let values = |row: Vec<_>| row.into_iter().map(|d: Derivative| d.value);
                (
                    found.into_iter().map(|row| values(row).collect()).collect(),
                    counts,
                )
            }
        })
    }

    /// Values of the functions `which`, which are finite.
    ///
    /// # Errors
    /// A value is not finite; the text says of what.
    pub fn finite_values(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<Vec<f64>, AnalysisFailure> {
        let one = |&f: &usize| match self.value(f) {
            value if value.is_finite() => Ok(value),
            value => {
                let what = self.not_finite_value(problem, f, value);
                Err(AnalysisFailure::Undefined(what))
            }
        };
        which.iter().map(one).collect()
    }

    /// As [`Analysed::gradients`], of functions that have finite derivatives.
    ///
    /// # Errors
    /// Also if a function has a kink here, or a derivative is not finite.
    pub fn finite_gradients(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<Vec<Vec<f64>>, AnalysisFailure> {
        let kink = which.iter().find_map(|&f| self.no_derivative(problem, f));
        if let Some(why) = kink {
            return Err(AnalysisFailure::Undefined(why));
        }
        let (gradients, _) = self.gradients(problem, which)?;
        for (&f, gradient) in which.iter().zip(&gradients) {
            if let Some(i) = gradient.iter().position(|d| !d.is_finite()) {
                let what = self.not_finite_derivative(problem, (f, i), gradient[i]);
                return Err(AnalysisFailure::Undefined(what));
            }
        }
        Ok(gradients)
    }

    /// Why function f has no derivative by the design here, if so.
    pub(crate) fn no_derivative(&self, problem: &Problem, f: usize) -> Option<String> {
        match self {
            Self::Motion(at) => at.no_derivative(problem, f),
            Self::Statics(_) | Self::Elsewhere(_) => None,
            Self::Cases(at) => at.no_derivative(f),
        }
    }

    /// The origin of a value that is not finite.
    pub(crate) fn not_finite_value(&self, problem: &Problem, f: usize, value: f64) -> String {
        match self {
            Self::Motion(at) => not_finite::value(problem, at, f, value),
            Self::Cases(at) => at.not_finite_value(problem, f, value),
            Self::Elsewhere(at) => at.not_finite_value(f),
            Self::Statics(at) => not_finite_at_rest(problem, at, f, value),
        }
    }

    /// Why these gradients of the functions `which` are refused, if they are: the steps do not
    /// resolve them. Where this cannot be judged they are not.
    pub fn refused(
        &self,
        problem: &Problem,
        which: &[usize],
        gradients: &[Vec<f64>],
    ) -> Option<String> {
        match self {
            Self::Motion(at) => {
                let found = resolved::of_gradients(problem, at, which, gradients).ok()?;
                resolved::refusal(problem, &found)
            }
            Self::Statics(_) | Self::Elsewhere(_) => None,
            Self::Cases(at) => at.refused(which),
        }
    }

    /// The origin of a derivative that is not finite.
    pub(crate) fn not_finite_derivative(
        &self,
        problem: &Problem,
        (f, i): (usize, usize),
        value: f64,
    ) -> String {
        match self {
            Self::Motion(at) => not_finite::derivative(problem, at, (f, i), value),
            Self::Statics(_) | Self::Cases(_) | Self::Elsewhere(_) => format!(
                "the derivative of the function \"{}\" in the variable {} is {value}",
                problem.function_names[f],
                not_finite::variable(problem, i)
            ),
        }
    }
}

/// The origin of a value of structures that is not finite.
fn not_finite_at_rest(problem: &Problem, at: &StaticDesign, f: usize, value: f64) -> String {
    match problem.composition.gives(f) {
        true => composed::not_finite(problem, f, value, &|g| at.function(g).value),
        false => format!("the function \"{}\" is {value}", problem.function_names[f]),
    }
}

/// Largest part of a limit by which an aggregate may differ from what it stands for.
const OF_LIMIT: f64 = 1e-2;

/// Whether a function serves constraints alone, and `gap` is small beside their limits.
fn is_near_its_limits(problem: &Problem, f: usize, gap: f64) -> bool {
    let constraints = problem.constraints.iter().filter(|own| own.function == f);
    let limits = constraints.flat_map(|own| [own.lower, own.upper]);
    let mut limits = limits.filter(|limit| limit.is_finite()).peekable();
    problem.objective.is_none_or(|own| own.function != f)
        && limits.peek().is_some()
        && limits.all(|limit| gap.abs() <= OF_LIMIT * limit.abs())
}

/// A design with the data of its record and figures.
pub enum Simulated {
    /// A motion with its observations.
    Motion(Box<Simulation>),
    /// Structures with all load cases.
    Statics(Box<StaticDesign>),
    /// Several cases.
    Cases(Box<InCases<Simulated>>),
}

impl Simulated {
    /// Analyses the design `x` for all functions; a motion with steps of its own.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn of(problem: &Problem, x: &[f64]) -> Result<Self, AnalysisFailure> {
        if let Some(cases) = &problem.cases {
            return Ok(Self::Cases(Box::new(InCases::of(
                None,
                (problem, cases),
                x,
            )?)));
        }
        Ok(match &problem.statics {
            Some(statics) => Self::Statics(Box::new(StaticDesign::of(problem, statics, x, None)?)),
            None => Self::Motion(Box::new(simulate(problem, x)?)),
        })
    }

    /// The structures of a problem that has some, for all load cases and functions.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn of_statics(
        problem: &Problem,
        x: &[f64],
    ) -> Result<Option<StaticDesign>, AnalysisFailure> {
        let Some(statics) = &problem.statics else {
            return Ok(None);
        };
        Ok(Some(StaticDesign::of(problem, statics, x, None)?))
    }

    /// As [`Simulated::of`], with the steps in use.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn with(
        integration: &mut Integration,
        problem: &Problem,
        x: &[f64],
    ) -> Result<Self, AnalysisFailure> {
        if let Some(cases) = &problem.cases {
            let found = InCases::of(Some(integration), (problem, cases), x)?;
            return Ok(Self::Cases(Box::new(found)));
        }
        match problem.statics {
            Some(_) => Self::of(problem, x),
            None => {
                let found = simulate_with(integration, problem, x)?;
                Ok(Self::Motion(Box::new(found)))
            }
        }
    }

    /// The value of a function.
    pub fn value(&self, f: usize) -> f64 {
        match self {
            Self::Motion(simulation) => simulation.at.function(f).value,
            Self::Statics(at) => at.function(f).value,
            Self::Cases(at) => at.value(f),
        }
    }

    /// The origin of a value that is not finite.
    pub fn not_finite_value(&self, problem: &Problem, f: usize) -> String {
        let value = self.value(f);
        match self {
            Self::Motion(simulation) => not_finite::value(problem, &simulation.at, f, value),
            Self::Statics(at) => not_finite_at_rest(problem, at, f, value),
            Self::Cases(at) => at.not_finite_value(problem, f),
        }
    }

    /// The largest value of the quantity that a function aggregates.
    pub fn maximum(&self, f: usize) -> Option<f64> {
        match self {
            Self::Motion(simulation) => simulation.at.function(f).maximum.map(|m| m.value),
            Self::Statics(at) => at.function(f).peak.map(|peak| peak.ratio),
            Self::Cases(at) => at.maximum(f),
        }
    }

    /// What a function stands for, if something in it is smoothed.
    pub fn smoothed(&self, f: usize) -> Option<Smoothed> {
        match self {
            Self::Motion(simulation) => simulation.at.smoothed(f),
            Self::Statics(at) => at.smoothed(f),
            Self::Cases(at) => at.smoothed(f),
        }
    }

    /// What a function stands for, if something else than a maximum over time or points is smoothed.
    pub(crate) fn true_value(&self, f: usize) -> Option<f64> {
        match self.maximum(f) {
            None => Some(self.smoothed(f)?.value),
            Some(_) => None,
        }
    }

    /// Warnings of functions whose aggregates are far from what they stand for, one of a family; `when` says at which design.
    /// Of a constraint alone, far is what is far in parts of its limits.
    pub(crate) fn far(&self, problem: &Problem, used: &[usize], when: &str) -> Vec<String> {
        let one = |&f: &usize| {
            let Smoothed { value, far } = self.smoothed(f)?;
            let name = &problem.function_names[f];
            let unit = with_space(Some(&problem.function_unit(f)));
            let far = far.filter(|_| !is_near_its_limits(problem, f, self.value(f) - value))?;
            Some(Message {
                name: name.clone(),
                size: far.part,
                text: format!(
                    "the true value of \"{name}\" {when} is {value:.6e}{unit}, and {far}"
                ),
            })
        };
        grouped(used.iter().filter_map(one))
    }

    /// Errors of the functions `which`, and of their gradients if `gradients`.
    ///
    /// # Errors
    /// If the finer analysis fails.
    pub fn estimate(
        &self,
        problem: &Problem,
        which: &[usize],
        gradients: bool,
    ) -> Result<Vec<error::FunctionError>, AnalysisFailure> {
        Ok(match self {
            Self::Motion(simulation) => error::estimate(problem, &simulation.at, which, gradients)?,
            Self::Statics(at) => statics::error::estimate(problem, at, which, gradients)?,
            Self::Cases(at) => at.estimate(problem, which, gradients)?,
        })
    }

    /// Notes for the user on the result; `used` are the functions of objective and constraints.
    pub(crate) fn warnings(&self, problem: &Problem, used: &[usize]) -> Vec<String> {
        match self {
            Self::Motion(simulation) => {
                let doubts = simulation.at.doubts(problem, used.iter().copied());
                simulation.warning.iter().cloned().chain(doubts).collect()
            }
            Self::Statics(at) => {
                let doubts = statics::error::doubts(problem, at, used);
                doubts.into_iter().chain(at.large_rotation()).collect()
            }
            Self::Cases(at) => at.warnings(used),
        }
    }

    /// How a motion was integrated.
    pub(crate) fn integration(&self, refreshes: usize) -> Option<IntegrationRecord> {
        let end = match self {
            Self::Motion(end) => end,
            Self::Statics(_) => return None,
            Self::Cases(at) => return at.integration(refreshes),
        };
        if end.at.is_rest() {
            return None;
        }
        Some(IntegrationRecord {
            method: end.at.run.method.name(),
            reason: end.reason.clone(),
            steps: end.at.run.grid.steps() as u64,
            refreshes: refreshes as u64,
        })
    }

    /// The aggregated quantity of a function, if it is an aggregate.
    pub(crate) fn aggregate(
        &self,
        problem: &Problem,
        f: usize,
        estimates: &[error::FunctionError],
    ) -> Option<Aggregate> {
        let known = estimates.iter().find(|found| found.function == f);
        let known = known
            .and_then(|found| found.maximum)
            .map_or(0.0, |m| m.error);
        match self {
            Self::Motion(end) => {
                let function = end.at.scene.functions.get(f)?;
                let found = end.at.function(f);
                let maximum = found.maximum?;
                let Function::Reduced { of, reduction, .. } = function else {
                    return None;
                };
                let instant = of.instant();
                let above = match reduction {
                    Reduction::Ks {
                        bound: Bound::Above,
                        ..
                    } if !matches!(instant, Some(Instant::LargestDeformation { .. })) => true,
                    // Sums over points lie above their maximum, means over time and points below.
                    _ if matches!(
                        instant,
                        Some(Instant::ShellStress { .. } | Instant::LargestDeformation { .. })
                    ) =>
                    {
                        found.value >= maximum.value
                    }
                    _ => false,
                };
                Some(Aggregate {
                    lies: if above { Lies::Above } else { Lies::Below },
                    true_maximum: maximum.value,
                    time: Some(maximum.time),
                    place: None,
                    error: maximum.error.max(known),
                    ungated: ungated_maximum(function, &end.at.scene.model, &end.at.run),
                })
            }
            Self::Cases(at) => at.aggregate(f, estimates),
            Self::Statics(end) => {
                let peak = end.function(f).peak?;
                let statics = problem.statics.as_ref()?;
                let above = matches!(
                    &statics.functions[f],
                    Asked::OfSolutions(functions::Function::Stress {
                        aggregate: functions::Aggregate::Ks,
                        ..
                    })
                );
                Some(Aggregate {
                    lies: if above { Lies::Above } else { Lies::Below },
                    true_maximum: peak.ratio,
                    time: None,
                    place: Some(place(&statics.cases, &peak)),
                    error: known,
                    ungated: None,
                })
            }
        }
    }
}

/// Every derivative at the design `x`, by the adjoint and by the complex step.
///
/// # Errors
/// If the analysis fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, AnalysisFailure> {
    if let Some(cases) = &problem.cases {
        return match cases.division {
            Division::Cases => check_cases::check((problem, cases), x),
            Division::Events => cases::phases::check((problem, cases), x),
        };
    }
    Ok(match Simulated::of_statics(problem, x)? {
        Some(at) => statics::check::check(problem, &at)?,
        None => crate::check::check(problem, x)?,
    })
}

/// Where a stress is largest, in words.
pub fn place(cases: &[String], peak: &Peak) -> String {
    format!(
        "shell {}, Gauss point {}, {} face, load case \"{}\"",
        peak.shell,
        peak.point,
        if peak.upper { "upper" } else { "lower" },
        cases[peak.case]
    )
}

/// Notes for the user on the start at the design `x`, one sentence each.
pub(crate) fn notes_of_start(problem: &Problem, x: &[f64]) -> Vec<String> {
    if let Some(cases) = &problem.cases {
        // Later phases do not start at the start.
        let starting = match cases.division {
            Division::Cases => &cases.list[..],
            Division::Events => &cases.list[..1],
        };
        let notes = starting.iter().flat_map(|case| {
            let own = notes_of_start(&case.problem, x).into_iter();
            own.map(|note| case.tell(note))
        });
        return notes.collect();
    }
    match problem.statics {
        Some(_) => Vec::new(),
        None => start::notes(problem, x),
    }
}
