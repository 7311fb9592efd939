//! Cases that are spread over ranks: each rank has some, and the numbers of all.

use super::{AnalysedOnce, InCases};
use crate::analysed::{Analysed, AnalysisFailure};
use crate::integrate::WorkCounts;
use crate::integration::Integration;
use crate::known_evaluations::{kept, steps_of};
use crate::problem::{Case, Cases, Problem};
use crate::report::evaluations::Work;
use crate::shared::{CaseGradients, CaseValues, Content, Elsewhere, Lost, Shared, counts};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

impl From<Lost> for AnalysisFailure {
    fn from(lost: Lost) -> Self {
        Self::Undefined(lost.to_string())
    }
}

/// Whether this rank wishes the end of the run.
pub(super) fn must_end(integration: &Integration, problem: &Problem) -> bool {
    let wishes = |ranks: &Arc<Shared>| ranks.wishes_end() || ranks.is_over();
    integration.shared.as_ref().is_some_and(wishes) || problem.simulation.limits.is_over()
}

/// By case: how often its steps were chosen, if they were.
pub(super) fn chosen(integration: &Integration) -> Vec<Option<usize>> {
    if integration.shared.is_none() {
        return Vec::new();
    }
    let one = |own: &Option<Integration>| {
        let own = own.as_ref()?;
        own.chosen().map(|_| own.refreshes)
    };
    integration.cases.iter().map(one).collect()
}

/// Adds to the cases of this rank in `found` those of the others, with their steps and events. `before` tells which steps
/// were in use.
///
/// # Errors
/// The run must end.
pub(super) fn values(
    integration: &mut Integration,
    (problem, cases, wanted): (&Problem, &Cases, &[Vec<usize>]),
    x: &[f64],
    before: &[Option<usize>],
    found: &mut [Result<AnalysedOnce, AnalysisFailure>],
) -> Result<(), AnalysisFailure> {
    let Some(ranks) = integration.shared.clone() else {
        return Ok(());
    };
    let own = (0..found.len()).filter(|&c| ranks.owns(c) && !wanted[c].is_empty());
    let own = own.filter_map(|c| {
        let steps = integration.cases[c].as_ref()?;
        told((c, &cases.list[c], &wanted[c]), steps, before[c], &found[c])
    });
    let own = own.collect();
    let ends = must_end(integration, problem);
    let all = ranks.all(x, ends, Content::Values(own))?;
    let told = all.into_iter().flat_map(|told| match told {
        Content::Values(values) => values,
        _ => Vec::new(),
    });
    for told in told.filter(|told| !ranks.owns(told.case)) {
        let Some(own) = integration.cases[told.case].as_mut() else {
            continue;
        };
        if let Some(kept) = (told.steps.as_ref()).and_then(|steps| kept(steps, told.refreshes)) {
            own.restore(kept);
        }
        own.recall_events(&told.events);
        (own.refreshes, own.unlowered) = (told.refreshes, told.unlowered);
        let refresh = told.reason.and_then(|why| own.in_use(&why));
        found[told.case] = match told.found {
            Ok(found) => {
                let found = Elsewhere {
                    x: x.to_vec(),
                    ..found
                };
                Ok(Some((Analysed::Elsewhere(Box::new(found)), refresh)))
            }
            Err(why) => Err(AnalysisFailure::Undefined(why)),
        };
    }
    Ok(())
}

/// What other ranks need to know of a case of this rank; `None` if it was not analysed.
fn told(
    (number, case, wanted): (usize, &Case, &[usize]),
    integration: &Integration,
    before: Option<usize>,
    found: &Result<AnalysedOnce, AnalysisFailure>,
) -> Option<CaseValues> {
    let now = integration.chosen().map(|_| integration.refreshes);
    let reason = match found {
        Ok(Some((_, Some(refresh)))) => Some(refresh.reason.clone()),
        _ => None,
    };
    let is_new = now != before || reason.is_some();
    let steps = is_new.then(|| integration.in_use("on another rank"));
    let steps = steps.flatten().map(steps_of);
    let found = match found {
        Ok(None) => return None,
        Ok(Some((at, _))) => Ok(elsewhere(case, at, wanted)),
        Err(failure) => Err(failure.to_string()),
    };
    Some(CaseValues {
        case: number,
        events: integration.events(),
        refreshes: integration.refreshes,
        unlowered: integration.unlowered,
        steps,
        reason,
        found,
    })
}

fn elsewhere(case: &Case, at: &Analysed, wanted: &[usize]) -> Elsewhere {
    let values: Vec<(usize, f64)> = wanted.iter().map(|&f| (f, at.value(f))).collect();
    let broken = values.iter().filter(|(_, value)| !value.is_finite());
    let why = |&(f, value): &(usize, f64)| (f, at.not_finite_value(&case.problem, f, value));
    Elsewhere {
        x: Vec::new(),
        not_finite: broken.map(why).collect(),
        values,
        work: Work::from(at.counts()),
    }
}

/// The derivatives of all cases, once they are asked for.
pub(super) struct Spread {
    ranks: Arc<Shared>,
    /// By case: the functions that are wanted.
    wanted: Vec<Vec<usize>>,
    gradients: OnceLock<Result<Vec<Option<CaseGradients>>, Lost>>,
}

impl Spread {
    pub fn new(ranks: Arc<Shared>, wanted: Vec<Vec<usize>>) -> Self {
        Self {
            ranks,
            wanted,
            gradients: OnceLock::new(),
        }
    }

    /// The gradients of all cases: those of this rank by their backward marches, the others by an exchange.
    ///
    /// # Errors
    /// The run must end.
    pub fn differentiate(
        &self,
        at: &InCases<Analysed>,
    ) -> Result<&[Option<CaseGradients>], AnalysisFailure> {
        let all = self.gradients.get_or_init(|| self.exchanged(at));
        match all {
            Ok(all) => Ok(all),
            Err(lost) => Err((*lost).into()),
        }
    }

    fn exchanged(&self, at: &InCases<Analysed>) -> Result<Vec<Option<CaseGradients>>, Lost> {
        let limits = |case: &Case| case.problem.simulation.limits.is_over();
        let is_over = || at.cases.list.iter().any(limits);
        let idle = self.ranks.wishes_end() || is_over();
        let one = |(c, own): (usize, &Option<Analysed>)| {
            let own = own.as_ref().filter(|_| self.has(c) && !idle)?;
            Some(self.of_case(c, &at.cases.list[c], own))
        };
        let own = at.list.par_iter().enumerate().filter_map(one).collect();
        let ends = idle || is_over();
        let all = self.ranks.all(&at.x, ends, Content::Gradients(own))?;
        let mut found: Vec<Option<CaseGradients>> = at.list.iter().map(|_| None).collect();
        for told in all {
            if let Content::Gradients(told) = told {
                for own in told {
                    let c = own.case;
                    found[c] = Some(own);
                }
            }
        }
        Ok(found)
    }

    /// Whether a case that is wanted belongs to this rank.
    fn has(&self, case: usize) -> bool {
        self.ranks.owns(case) && !self.wanted[case].is_empty()
    }

    fn of_case(&self, c: usize, case: &Case, at: &Analysed) -> CaseGradients {
        let wanted = &self.wanted[c];
        let kink = |&f: &usize| Some((f, at.no_derivative(&case.problem, f)?));
        let found = at.gradients(&case.problem, wanted);
        CaseGradients {
            case: c,
            kinks: wanted.iter().filter_map(kink).collect(),
            found: found
                .map(|(rows, work)| (rows, Work::from(work)))
                .map_err(|failure| failure.to_string()),
        }
    }

    /// The gradients of functions of a case, once they are exchanged.
    ///
    /// # Errors
    /// It has none.
    pub fn gradients(
        &self,
        c: usize,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), AnalysisFailure> {
        let lacking = || AnalysisFailure::OnAnotherRank;
        let all = self.gradients.get().and_then(|all| all.as_ref().ok());
        let own = all.and_then(|all| all[c].as_ref()).ok_or_else(lacking)?;
        let found = own.found.clone().map_err(AnalysisFailure::Undefined);
        let (rows, work) = found?;
        let row = |f: &usize| {
            let place = self.wanted[c].binary_search(f).ok()?;
            rows.get(place).cloned()
        };
        let rows = which.iter().map(row).collect::<Option<_>>();
        Ok((rows.ok_or_else(lacking)?, counts(work)))
    }

    /// Why a function of a case has no derivative, if so.
    pub fn kink(&self, at: &InCases<Analysed>, (c, f): (usize, usize)) -> Option<String> {
        let all = self.differentiate(at).ok()?;
        let kinks = &all[c].as_ref()?.kinks;
        let found = kinks.iter().find(|(own, _)| *own == f);
        found.map(|(_, why)| why.clone())
    }

    /// Why the steps of a case do not resolve its gradients, if so.
    pub fn refused(&self, at: &InCases<Analysed>) -> Option<String> {
        let one = |(c, own): (usize, &Option<Analysed>)| {
            let own = own.as_ref().filter(|_| self.has(c))?;
            let (gradients, _) = self.gradients(c, &self.wanted[c]).ok()?;
            let problem = &at.cases.list[c].problem;
            Some((c, own.refused(problem, &self.wanted[c], &gradients)))
        };
        let own = at.list.par_iter().enumerate().filter_map(one).collect();
        let all = self.ranks.all(&at.x, false, Content::Refusals(own)).ok()?;
        let told = all.into_iter().flat_map(|told| match told {
            Content::Refusals(own) => own,
            _ => Vec::new(),
        });
        let first = told.filter_map(|(c, why)| Some((c, why?)));
        let (c, why) = first.min_by_key(|(c, _)| *c)?;
        Some(at.cases.list[c].tell(why))
    }
}
