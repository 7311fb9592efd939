//! A design in all cases of a problem: each is analysed by itself, side by side on the cores. Values and derivatives of
//! functions over cases follow from those of the cases.

pub(crate) mod phases;
mod spread;

use super::{Analysed, AnalysisFailure, Simulated};
use crate::composed::{self, Derivative};
use crate::error::FunctionError;
use crate::estimate::with_expressions;
use crate::integrate::WorkCounts;
use crate::integration::{Integration, Refresh};
use crate::math::soft_max::{Far, Smoothed, two_digits};
use crate::problem::{Case, Cases, Composition, Division, Problem};
use crate::report::optimum::{Aggregate, Integration as IntegrationRecord};
use rayon::prelude::*;
use spread::Spread;
use std::sync::Arc;

/// A smooth bound that differs from the largest value by more than this part is told.
const NEAR: f64 = 0.01;

/// A design in the cases of a problem; in some of them, where it is analysed for some functions alone.
pub struct InCases<T> {
    /// The design.
    pub x: Vec<f64>,
    /// The cases.
    pub cases: Arc<Cases>,
    composition: Arc<Composition>,
    /// By case.
    pub list: Vec<Option<T>>,
    /// What other ranks have of it, if its cases are spread.
    spread: Option<Spread>,
}

/// A failure with the name of its case.
fn of_case(case: &Case) -> impl Fn(AnalysisFailure) -> AnalysisFailure + '_ {
    |failure| {
        let (name, failure) = (case.name.clone(), Box::new(failure));
        match case.problem.is_phase() {
            true => AnalysisFailure::InPhase {
                phase: name,
                failure,
            },
            false => AnalysisFailure::InCase {
                case: name,
                failure,
            },
        }
    }
}

impl<T> InCases<T> {
    fn new(problem: &Problem, cases: &Arc<Cases>, x: &[f64], list: Vec<Option<T>>) -> Self {
        Self {
            x: x.to_vec(),
            cases: cases.clone(),
            composition: problem.composition.clone(),
            list,
            spread: None,
        }
    }

    /// The case of a function that an expression does not give, its problem, and the function there.
    pub fn place(&self, f: usize) -> Option<(&Case, &T, usize)> {
        let &(case, own) = self.cases.places.get(f)?;
        Some((&self.cases.list[case], self.list[case].as_ref()?, own))
    }

    /// The cases that are analysed.
    pub fn each(&self) -> impl Iterator<Item = (&Case, &T)> {
        let all = self.cases.list.iter().zip(&self.list);
        all.filter_map(|(case, at)| Some((case, at.as_ref()?)))
    }

    /// What `of` makes of each case that is analysed, on all cores.
    ///
    /// # Errors
    /// The first failure of `of`.
    pub fn side_by_side<R: Send, E: Send>(
        &self,
        of: impl Fn(&Case, &T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E>
    where
        T: Sync,
    {
        let each: Vec<(&Case, &T)> = self.each().collect();
        each.into_par_iter()
            .map(|(case, at)| of(case, at))
            .collect()
    }

    /// A number of a function that an expression does not give; NaN if its case is not analysed.
    fn at_place(&self, k: usize, of: &impl Fn(&T, usize) -> f64) -> f64 {
        self.place(k).map_or(f64::NAN, |(_, at, own)| of(at, own))
    }

    /// The value of a function, from those of functions of the cases.
    fn value_by(&self, f: usize, of: impl Fn(&T, usize) -> f64) -> f64 {
        let value = |k: usize| self.at_place(k, &of);
        self.composition.value(f, &self.x, &value)
    }

    /// Rows of derivatives of the functions `which`, from those that `of` gives of the functions of each case.
    ///
    /// # Errors
    /// Those of `of`, with the name of the case.
    pub fn derivatives(
        &self,
        which: &[usize],
        value: &(impl Fn(&T, usize) -> f64 + Sync),
        of: &(impl Fn(usize, &T, &[usize]) -> Result<Vec<Vec<Derivative>>, AnalysisFailure> + Sync),
    ) -> Result<Vec<Vec<Derivative>>, AnalysisFailure>
    where
        T: Sync,
    {
        let wanted = self.cases.wanted(&self.composition.of_scene(which));
        let all = self.list.par_iter().zip(&wanted).enumerate();
        let rows = all.map(|(c, (at, wanted))| match at {
            Some(at) if !wanted.is_empty() => {
                of(c, at, wanted).map_err(of_case(&self.cases.list[c]))
            }
            _ => Ok(Vec::new()),
        });
        let rows: Vec<Vec<Vec<Derivative>>> = rows.collect::<Result<_, _>>()?;
        let row = |k: usize| -> &[Derivative] {
            let (case, own) = self.cases.places[k];
            let place = wanted[case].binary_search(&own);
            place.map_or(&[][..], |place| &rows[case][place][..])
        };
        let value = |k: usize| self.at_place(k, &value);
        let one = |&f: &usize| match self.composition.gives(f) {
            true => composed::derivatives(&self.composition.partials(f, &self.x, &value), &row),
            false => row(f).to_vec(),
        };
        Ok(which.iter().map(one).collect())
    }

    /// The origin of a value of function `f` that is not finite, from `origin` of those of the cases.
    fn lost(
        &self,
        (problem, value): (&Problem, f64),
        f: usize,
        of: impl Fn(&T, usize) -> f64,
        origin: impl Fn(&T, &Problem, usize) -> Option<String>,
    ) -> String {
        let needed = self.composition.of_scene(&[f]).into_owned();
        let lost = needed.iter().find_map(|&k| {
            let (case, at, own) = self.place(k)?;
            Some(case.tell(origin(at, &case.problem, own)?))
        });
        let value_of = |k: usize| self.at_place(k, &of);
        lost.unwrap_or_else(|| composed::not_finite(problem, f, value, &value_of))
    }

    /// The functions of the cases on which function `f` depends here, by `value`.
    fn moving(&self, f: usize, value: impl Fn(&T, usize) -> f64) -> Vec<usize> {
        if !self.composition.gives(f) {
            return vec![f];
        }
        let value = |k: usize| self.at_place(k, &value);
        let partials = self.composition.partials(f, &self.x, &value);
        let moving = partials.by_function.iter().filter(|(_, by)| *by != 0.0);
        moving.map(|(k, _)| *k).collect()
    }
}

/// A case, if a function of it is asked, and the change of its steps.
type AnalysedOnce = Option<(Analysed, Option<Refresh>)>;

impl InCases<Analysed> {
    /// Analyses the design `x` in the cases that the functions `asked` need.
    ///
    /// # Errors
    /// The first failure of a case, with its name.
    pub fn with(
        integration: &mut Integration,
        (problem, cases): (&Problem, &Arc<Cases>),
        x: &[f64],
        asked: &[usize],
    ) -> Result<(Self, Option<Refresh>), AnalysisFailure> {
        let wanted = cases.wanted(&problem.composition.of_scene(asked));
        let ranks = integration.shared.clone();
        // Nothing is computed for a run that must end.
        let idle = (ranks.as_ref()).is_some_and(|_| spread::must_end(integration, problem));
        let is_own = |c: usize| !idle && ranks.as_ref().is_none_or(|ranks| ranks.owns(c));
        let chosen = spread::chosen(integration);
        if cases.division == Division::Events {
            return Self::in_phases(integration, (problem, cases), x, &wanted);
        }
        let all = integration.cases.par_iter_mut().zip(&cases.list);
        let found = all
            .zip(&wanted)
            .enumerate()
            .map(|(c, ((own, case), wanted))| match own {
                Some(own) if !wanted.is_empty() && is_own(c) => {
                    Analysed::with(own, &case.problem, x, wanted).map(Some)
                }
                _ => Ok(None),
            });
        // All end, so that steps and counts do not depend on which is first to fail.
        let mut found: Vec<Result<AnalysedOnce, AnalysisFailure>> = found.collect();
        if ranks.is_some() {
            let of_all = (problem, &**cases, &wanted[..]);
            spread::values(integration, of_all, x, &chosen, &mut found)?;
        }
        let found = found.into_iter().zip(&cases.list);
        let found = found.map(|(found, case)| found.map_err(of_case(case)));
        let found: Vec<Result<_, AnalysisFailure>> = found.collect();
        integration.count_cases();
        let found: Vec<AnalysedOnce> = found.into_iter().collect::<Result<_, _>>()?;
        let spread = ranks.map(|ranks| Spread::new(ranks, wanted));
        let (found, refresh) = Self::told(integration, (problem, cases), x, found);
        Ok((Self { spread, ..found }, refresh))
    }

    /// The phases of a motion at the design `x`, each of which begins as the one before it ends.
    fn in_phases(
        integration: &mut Integration,
        (problem, cases): (&Problem, &Arc<Cases>),
        x: &[f64],
        wanted: &[Vec<usize>],
    ) -> Result<(Self, Option<Refresh>), AnalysisFailure> {
        let steps = &mut integration.cases;
        let of = |p: usize, own: &Problem, x: &[f64]| {
            let steps = steps[p].get_or_insert_with(|| Integration::of(own, None, true));
            Analysed::with(steps, own, x, &wanted[p])
        };
        let found = phases::each(cases, x, of, |(at, _)| phases::motion(at));
        integration.count_cases();
        Ok(Self::told(integration, (problem, cases), x, found?))
    }

    /// Cases with the changes of their steps.
    fn told(
        integration: &Integration,
        (problem, cases): (&Problem, &Arc<Cases>),
        x: &[f64],
        found: Vec<AnalysedOnce>,
    ) -> (Self, Option<Refresh>) {
        let reasons = cases.list.iter().zip(&found).filter_map(|(case, own)| {
            let refresh = own.as_ref()?.1.as_ref()?;
            Some(format!("{}: {}", case.name, refresh.reason))
        });
        let reasons: Vec<String> = reasons.collect();
        let refresh = match reasons.is_empty() {
            true => None,
            false => integration.in_use(&reasons.join("; ")),
        };
        let list = found.into_iter().map(|own| Some(own?.0)).collect();
        (Self::new(problem, cases, x, list), refresh)
    }

    /// The value of a function.
    pub fn value(&self, f: usize) -> f64 {
        self.value_by(f, Analysed::value)
    }

    /// The work of all cases.
    pub fn counts(&self) -> WorkCounts {
        let mut sum = WorkCounts::default();
        self.each().for_each(|(_, at)| sum += at.counts());
        sum
    }

    /// Exact gradients of the functions `which`, and the work they took.
    ///
    /// # Errors
    /// If a function has no gradient there.
    pub fn gradients(
        &self,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), AnalysisFailure> {
        let values = |row: Vec<Derivative>| row.into_iter().map(|own| own.value).collect();
        if self.cases.division == Division::Events {
            let (rows, work) = phases::derivatives(self, which)?;
            return Ok((rows.into_iter().map(values).collect(), work));
        }
        let work = std::sync::Mutex::new(WorkCounts::default());
        if let Some(spread) = &self.spread {
            spread.differentiate(self)?;
        }
        let of = |c: usize, at: &Analysed, wanted: &[usize]| {
            let (rows, counts) = match &self.spread {
                Some(spread) => spread.gradients(c, wanted)?,
                None => at.gradients(&self.cases.list[c].problem, wanted)?,
            };
            if let Ok(mut work) = work.lock() {
                *work += counts;
            }
            let terms = |value: f64| Derivative {
                value,
                terms: value.abs(),
            };
            let row = |row: Vec<f64>| row.into_iter().map(terms).collect();
            Ok(rows.into_iter().map(row).collect())
        };
        let rows = self.derivatives(which, &Analysed::value, &of)?;
        let rows = rows.into_iter().map(values).collect();
        Ok((rows, work.into_inner().unwrap_or_default()))
    }

    /// Why function f has no derivative by the design here, if so.
    pub fn no_derivative(&self, f: usize) -> Option<String> {
        self.moving(f, Analysed::value).into_iter().find_map(|k| {
            let (case, at, own) = self.place(k)?;
            let why = match &self.spread {
                Some(spread) => spread.kink(self, (self.cases.places[k].0, own))?,
                None => at.no_derivative(&case.problem, own)?,
            };
            Some(case.tell(why))
        })
    }

    /// The origin of a value that is not finite.
    pub fn not_finite_value(&self, problem: &Problem, f: usize, value: f64) -> String {
        let origin = |at: &Analysed, own: &Problem, f: usize| {
            let value = at.value(f);
            (!value.is_finite()).then(|| at.not_finite_value(own, f, value))
        };
        self.lost((problem, value), f, Analysed::value, origin)
    }

    /// Why gradients of the functions `which` are refused, if they are.
    pub fn refused(&self, which: &[usize]) -> Option<String> {
        if let Some(spread) = &self.spread {
            return spread.refused(self);
        }
        // Gradients of phases also have those by the states with which they begin.
        if self.cases.division == Division::Events {
            return None;
        }
        let wanted = self.cases.wanted(&self.composition.of_scene(which));
        let all = self.cases.list.iter().zip(&self.list).zip(&wanted);
        let mut all = all.filter(|(_, wanted)| !wanted.is_empty());
        all.find_map(|((case, at), wanted)| {
            let at = at.as_ref()?;
            let (gradients, _) = at.gradients(&case.problem, wanted).ok()?;
            let why = at.refused(&case.problem, wanted, &gradients)?;
            Some(case.tell(why))
        })
    }
}

impl InCases<Simulated> {
    /// Analyses the design `x` in all cases for all functions, with the steps in use where there are some.
    ///
    /// # Errors
    /// The first failure of a case, with its name.
    pub fn of(
        integration: Option<&mut Integration>,
        (problem, cases): (&Problem, &Arc<Cases>),
        x: &[f64],
    ) -> Result<Self, AnalysisFailure> {
        let mut none = Vec::new();
        let steps = integration.map_or(&mut none, |own| &mut own.cases);
        steps.resize_with(cases.list.len(), || None);
        if cases.division == Division::Events {
            let of = |p: usize, own: &Problem, x: &[f64]| match &mut steps[p] {
                Some(steps) => Simulated::with(steps, own, x),
                None => Simulated::of(own, x),
            };
            let list = phases::each(cases, x, of, phases::observed)?;
            return Ok(Self::new(problem, cases, x, list));
        }
        let found = steps.par_iter_mut().zip(&cases.list).map(|(own, case)| {
            let found = match own {
                Some(own) => Simulated::with(own, &case.problem, x),
                None => Simulated::of(&case.problem, x),
            };
            found.map(Some).map_err(of_case(case))
        });
        let list = found.collect::<Result<_, _>>()?;
        Ok(Self::new(problem, cases, x, list))
    }

    /// The value of a function.
    pub fn value(&self, f: usize) -> f64 {
        self.value_by(f, Simulated::value)
    }

    /// The origin of a value that is not finite.
    pub fn not_finite_value(&self, problem: &Problem, f: usize) -> String {
        let origin = |at: &Simulated, own: &Problem, f: usize| {
            (!at.value(f).is_finite()).then(|| at.not_finite_value(own, f))
        };
        self.lost((problem, self.value(f)), f, Simulated::value, origin)
    }

    /// The largest value of the quantity that a function of a case aggregates.
    pub fn maximum(&self, f: usize) -> Option<f64> {
        let (_, at, own) = self.place(f)?;
        at.maximum(own)
    }

    /// What a function stands for, if something in it is smoothed: over the motion, over points or over cases.
    pub fn smoothed(&self, f: usize) -> Option<Smoothed> {
        if !self.composition.gives(f) {
            let (_, at, own) = self.place(f)?;
            return at.smoothed(own);
        }
        if let Some(value) = self.sharp(f) {
            let far = self.far(f, value);
            return value.is_finite().then_some(Smoothed { value, far });
        }
        let one = |k: usize| match self.place(k) {
            Some((_, at, own)) => (at.smoothed(own), at.value(own)),
            None => (None, f64::NAN),
        };
        composed::smoothed(&self.composition, f, &self.x, &one)
    }

    /// What a function stands for that is smoothed over cases, from the true values of those of the cases.
    fn sharp(&self, f: usize) -> Option<f64> {
        let truth = |at: &Simulated, own: usize| {
            let known = at.smoothed(own).map(|own| own.value);
            known.unwrap_or_else(|| at.value(own))
        };
        let of = |k: usize| self.at_place(k, &truth);
        self.composition.sharp(f, &self.x, &of)
    }

    /// How far a smooth bound over cases is from what it stands for, if it is far.
    fn far(&self, f: usize, truth: f64) -> Option<Far> {
        let rho = self.composition.rho(f)?;
        let part = (self.value(f) - truth).abs() / truth.abs();
        (part > NEAR && part.is_finite()).then(|| Far {
            part,
            of_zero: false,
            rho: Some(vec![two_digits(rho * part / NEAR)]),
        })
    }

    /// ρ for which a smooth bound of `n` values is within 1 % of the largest, and that bound: their logarithm of n over ρ.
    pub fn near_rho(&self, f: usize) -> Option<(f64, f64)> {
        let value = self.sharp(f)?;
        let count = self.composition.of_scene(&[f]).len() as f64;
        let rho = count.ln().max(1.0) / (NEAR * value.abs());
        (rho.is_finite() && rho > 0.0).then_some((two_digits(rho), value))
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
    ) -> Result<Vec<FunctionError>, AnalysisFailure> {
        if self.cases.division == Division::Events {
            return phases::estimate(self, problem, which, gradients);
        }
        with_expressions((problem, &self.x), which, |flat| {
            let wanted = self.cases.wanted(flat);
            let all = self.cases.list.par_iter().zip(&self.list).zip(&wanted);
            let found = all.map(|((case, at), wanted)| match at {
                Some(at) if !wanted.is_empty() => {
                    let found = at.estimate(&case.problem, wanted, gradients);
                    found.map_err(of_case(case))
                }
                _ => Ok(Vec::new()),
            });
            let found: Vec<Vec<FunctionError>> = found.collect::<Result<_, _>>()?;
            let numbered = |(case, own): (usize, Vec<FunctionError>)| {
                let number = move |own: FunctionError| {
                    let function = self.cases.number(case, own.function)?;
                    Some(FunctionError { function, ..own })
                };
                own.into_iter().filter_map(number).collect::<Vec<_>>()
            };
            let all: Vec<FunctionError> =
                found.into_iter().enumerate().flat_map(numbered).collect();
            // In the order of the question.
            let of = |f: &usize| all.iter().find(|own| own.function == *f).cloned();
            Ok(flat.iter().filter_map(of).collect())
        })
    }

    /// Notes for the user on the cases; `used` are the functions of objective and constraints.
    pub fn warnings(&self, used: &[usize]) -> Vec<String> {
        let wanted = self.cases.wanted(&self.composition.of_scene(used));
        let all = self.cases.list.iter().zip(&self.list).zip(&wanted);
        let notes = all.flat_map(|((case, at), wanted)| {
            let own = at.as_ref().map(|at| at.warnings(&case.problem, wanted));
            let own = own.unwrap_or_default().into_iter();
            own.map(|note| case.tell(note))
        });
        notes.collect()
    }

    /// How the motions were integrated: their methods, and the sum of their steps.
    pub fn integration(&self, refreshes: usize) -> Option<IntegrationRecord> {
        let each = self.each().filter_map(|(_, at)| at.integration(0));
        let all: Vec<IntegrationRecord> = each.collect();
        let mut methods: Vec<String> = all.iter().map(|own| own.method.clone()).collect();
        methods.dedup();
        (!all.is_empty()).then(|| IntegrationRecord {
            method: methods.join(", "),
            reason: match self.cases.division {
                Division::Cases => format!("of {} cases", self.cases.list.len()),
                Division::Events => format!("of {} phases", self.cases.list.len()),
            },
            steps: all.iter().map(|own| own.steps).sum(),
            refreshes: refreshes as u64,
        })
    }

    /// The aggregated quantity of a function of a case, if it is an aggregate.
    pub fn aggregate(&self, f: usize, estimates: &[FunctionError]) -> Option<Aggregate> {
        let (case, at, own) = self.place(f)?;
        let known = estimates.iter().filter(|found| found.function == f);
        let known: Vec<FunctionError> = known
            .map(|found| FunctionError {
                function: own,
                ..found.clone()
            })
            .collect();
        at.aggregate(&case.problem, own, &known)
    }
}
