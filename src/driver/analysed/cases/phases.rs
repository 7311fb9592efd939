//! The phases of a motion that events divide, one after the other. The state z_p with which phase p begins is that in which
//! the one before it ends (`problem/phases.rs`).
//!
//! Backwards, with the functions f_p of the phases and their weights w_p in a function of the whole motion:
//!
//! ```text
//! (df/dx, z̄_p) += w_p ∂f_p/∂(x, z_p) + z̄_{p+1} ∂z_{p+1}/∂(x, z_p),     from the last phase to the first
//! ```
//!
//! Each line is one march of the adjoint of phase p, with all functions and all z̄_{p+1} as its targets. The time of the event
//! at its end moves with (x, z_p) as in `driver/event.rs`.

use super::{InCases, of_case};
use crate::analysed::{Analysed, AnalysisFailure, Simulated};
use crate::checked::{CheckedDerivative, checked_row};
use crate::composed::{Derivative, infinitesimal};
use crate::error::{Estimate, FunctionError, halved};
use crate::evaluate::Evaluated;
use crate::event::{self, Admit};
use crate::frozen::{Stored, complex_design, complex_motion, settings};
use crate::integrate::{IntegrationFailure, Settings, WorkCounts};
use crate::integration::Integration;
use crate::math::{Complex64, scalar::COMPLEX_STEP};
use crate::problem::{Case, Cases, EndCotangent, Problem};
use crate::size::function_size;
use rayon::prelude::*;
use std::sync::Arc;

/// A failure with the phase or the event where it happens.
fn told(case: &Case, failure: AnalysisFailure) -> AnalysisFailure {
    match (&failure, case.problem.next_event()) {
        (AnalysisFailure::Motion(IntegrationFailure::NotReached { .. }), Some(event)) => {
            AnalysisFailure::NoEvent {
                event: event.to_owned(),
                failure: Box::new(failure),
            }
        }
        _ => of_case(case)(failure),
    }
}

/// Events nearer than this part of the time, or of the change of the quantity, come at once.
const AT_ONCE: f64 = 1e-9;

/// The failure of a phase whose event comes with the one before it, at the time `begin`.
fn at_once(case: &Case, begin: f64) -> Option<AnalysisFailure> {
    let own = &case.problem;
    Some(AnalysisFailure::AtOnce {
        first: own.last_event()?.to_owned(),
        second: own.next_event()?.to_owned(),
        time: begin,
    })
}

/// Fails if the end of a phase is due before it begins, or as it begins. `before` is the phase before it.
fn admit(
    case: &Case,
    (x, begin): (&[f64], f64),
    before: Option<&Evaluated>,
) -> Result<(), AnalysisFailure> {
    let scene = case.problem.unlowered_scene::<f64>(x);
    let duration = scene.duration;
    let has_reached = |before: &Evaluated| {
        let until = scene.until.as_ref()?;
        let gaps = until.gaps(&before.scene.model, &before.run);
        let largest = gaps.iter().fold(0.0_f64, |m, gap| m.max(gap.abs()));
        Some(gaps.last()?.abs() <= AT_ONCE * largest)
    };
    // A quantity may reach a value again.
    let reached = before.filter(|_| !case.problem.waits_again());
    let is_due = duration.abs() <= AT_ONCE * begin || reached.and_then(has_reached) == Some(true);
    if let Some(failure) = at_once(case, begin).filter(|_| is_due) {
        return Err(failure);
    }
    if duration > 0.0 {
        return Ok(());
    }
    let end = match case.problem.next_event() {
        Some(event) => format!("the event \"{event}\""),
        None => "the end of the motion".to_owned(),
    };
    let late = -duration;
    let what = format!("{}: {end} is due {late:.6e} s before the begin", case.name);
    Err(AnalysisFailure::Undefined(what))
}

/// What `of` makes of each phase at the design `x`, from its number, its problem, and the design with the state with which it
/// begins. `motion` is the motion in it.
///
/// # Errors
/// The first failure of a phase, or an event that does not come.
pub(crate) fn each<T>(
    cases: &Cases,
    x: &[f64],
    mut of: impl FnMut(usize, &Problem, &[f64]) -> Result<T, AnalysisFailure>,
    motion: impl Fn(&T) -> Option<&Evaluated>,
) -> Result<Vec<Option<T>>, AnalysisFailure> {
    let (mut list, mut begin, mut whole) = (Vec::<Option<T>>::new(), 0.0, x.to_vec());
    for (p, case) in cases.list.iter().enumerate() {
        let before = list.last().and_then(|own| motion(own.as_ref()?));
        admit(case, (&whole, begin), before)?;
        let found = of(p, &case.problem, &whole).map_err(|failure| told(case, failure))?;
        if let (Some(next), Some(at)) = (cases.list.get(p + 1), motion(&found)) {
            let at_once = at_once(case, begin).filter(|_| at.run.duration <= AT_ONCE * begin);
            if let Some(failure) = at_once {
                return Err(failure);
            }
            let state = next.problem.state_after(&at.scene, &at.run, begin);
            begin += at.run.duration;
            whole = [x, &state].concat();
        }
        list.push(Some(found));
    }
    Ok(list)
}

/// The motion of a phase.
pub(super) fn motion(at: &Analysed) -> Option<&Evaluated> {
    match at {
        Analysed::Motion(at) => Some(at),
        Analysed::Statics(_) | Analysed::Cases(_) | Analysed::Elsewhere(_) => None,
    }
}

/// The motion of a phase, with its observations.
pub(super) fn observed(at: &Simulated) -> Option<&Evaluated> {
    match at {
        Simulated::Motion(at) => Some(&at.at),
        Simulated::Statics(_) | Simulated::Cases(_) => None,
    }
}

/// The gradient of a function on the way backwards.
struct Backwards {
    /// By function of the phases: its weight.
    weights: Vec<(usize, f64)>,
    row: Vec<Derivative>,
    /// z̄ of the phase that was swept last, and the sum of the sizes of its terms.
    state: Vec<f64>,
    terms: f64,
    /// Of the z̄ with which the next sweep begins: the sizes of its terms by its own size.
    cancelled: f64,
}

impl Backwards {
    /// Adds derivatives by variables and state, times `by`. The round-off of `by` is `cancelled` times that of a number of
    /// its size.
    fn add(&mut self, count: usize, found: &[Derivative], (by, cancelled): (f64, f64)) {
        let terms = |own: &Derivative| (by * own.terms).abs() * cancelled;
        for (own, more) in self.row.iter_mut().zip(found) {
            own.value += by * more.value;
            own.terms += terms(more);
        }
        self.terms += found[count..].iter().map(terms).sum::<f64>();
        let state = found[count..].iter().map(|own| by * own.value);
        match self.state.is_empty() {
            true => self.state = state.collect(),
            false => self
                .state
                .iter_mut()
                .zip(state)
                .for_each(|(own, more)| *own += more),
        }
    }
}

/// Derivatives of the functions `which`, and the work that they took.
///
/// # Errors
/// If a function has no gradient, or an event only touches its value.
pub(super) fn derivatives(
    all: &InCases<Analysed>,
    which: &[usize],
) -> Result<(Vec<Vec<Derivative>>, WorkCounts), AnalysisFailure> {
    let (count, composition) = (all.x.len(), &all.composition);
    let value = |k: usize| all.at_place(k, &Analysed::value);
    let begin = |&f: &usize| {
        let direct = |value: f64| Derivative {
            value,
            terms: value.abs(),
        };
        let (weights, by) = match composition.gives(f) {
            true => {
                let partials = composition.partials(f, &all.x, &value);
                (partials.by_function, partials.by_variable)
            }
            false => (vec![(f, 1.0)], vec![0.0; count]),
        };
        Backwards {
            weights: weights.into_iter().filter(|(_, by)| *by != 0.0).collect(),
            row: by.into_iter().map(direct).collect(),
            state: Vec::new(),
            terms: 0.0,
            cancelled: 1.0,
        }
    };
    let mut sums: Vec<Backwards> = which.iter().map(begin).collect();
    let mut work = WorkCounts::default();
    for (p, case) in all.cases.list.iter().enumerate().rev() {
        let Some(at) = all.list[p].as_ref().and_then(motion) else {
            return Err(AnalysisFailure::NoMotion);
        };
        let of_phase = |k: usize| Some(all.cases.places[k]).filter(|place| place.0 == p);
        let mut functions: Vec<usize> = sums
            .iter()
            .flat_map(|own| &own.weights)
            .filter_map(|&(k, _)| Some(of_phase(k)?.1))
            .collect();
        functions.sort_unstable();
        functions.dedup();
        let next = all.cases.list.get(p + 1);
        let pulled = |own: &mut Backwards| {
            let state = std::mem::take(&mut own.state);
            let size: f64 = state.iter().map(|by| by.abs()).sum();
            let terms = std::mem::take(&mut own.terms);
            own.cancelled = if size > 0.0 {
                (terms / size).max(1.0)
            } else {
                1.0
            };
            let moving = next.filter(|_| state.iter().any(|by| *by != 0.0));
            Some(moving?.problem.pull_state(&at.scene, &at.run, &state))
        };
        let ends: Vec<Option<EndCotangent>> = sums.iter_mut().map(pulled).collect();
        let known: Vec<&EndCotangent> = ends.iter().flatten().collect();
        if functions.is_empty() && known.is_empty() {
            continue;
        }
        let found = at.derivatives_to_end(&case.problem, &functions, &known);
        let (rows, counts) = found.map_err(|failure| told(case, failure.into()))?;
        work += counts;
        let (of_functions, of_ends) = rows.split_at(functions.len());
        let mut of_ends = of_ends.iter();
        for (own, end) in sums.iter_mut().zip(&ends) {
            let weights = std::mem::take(&mut own.weights);
            for &(k, by) in &weights {
                let place = of_phase(k).and_then(|(_, f)| functions.binary_search(&f).ok());
                if let Some(place) = place {
                    own.add(count, &of_functions[place], (by, 1.0));
                }
            }
            own.weights = weights;
            if let Some(end) = end
                && let Some(row) = of_ends.next()
            {
                own.add(count, row, (1.0, own.cancelled));
                // t_{p+1} = t_p + T_p.
                if let Some(time) = own.state.last_mut() {
                    *time += end.duration;
                }
            }
        }
    }
    Ok((sums.into_iter().map(|own| own.row).collect(), work))
}

/// Settings of the steps of a phase, and when its event comes and how fast.
type Steps = (Settings, (f64, f64));

/// The steps of the phases of a motion, to be frozen.
fn steps(all: &InCases<Analysed>) -> Result<Vec<Steps>, AnalysisFailure> {
    let one = |(case, at): (&Case, &Analysed)| {
        let at = motion(at).ok_or(AnalysisFailure::NoMotion)?;
        let settings = settings(&case.problem, at).ok_or(AnalysisFailure::NoMotion)?;
        let duration = at.run.duration;
        let rate = match &at.scene.until {
            Some(_) => event::rate(&at.scene, &settings, duration)?,
            None => f64::NAN,
        };
        Ok((settings, (duration, rate)))
    };
    all.each().map(one).collect()
}

/// Derivatives of all functions along a direction by a complex step through all phases, and these in real numbers.
fn complex_step(
    (problem, cases): (&Problem, &Arc<Cases>),
    (known, stored): (&[Steps], Stored),
    (x, direction): (&[f64], &[f64]),
) -> Result<(Vec<f64>, InCases<Analysed>), AnalysisFailure> {
    let design = complex_design(x, direction);
    let (mut whole, mut begin) = (design.clone(), Complex64::from(0.0));
    let mut values = vec![Complex64::from(0.0); cases.places.len()];
    let mut phases = Vec::new();
    for (p, (case, (settings, event))) in cases.list.iter().zip(known).enumerate() {
        let found = complex_motion(&case.problem, (settings, stored), *event, &whole);
        let (scene, run) = found.map_err(|failure| told(case, failure.into()))?;
        let own = values.iter_mut().zip(&cases.places);
        for (value, &(_, f)) in own.filter(|(_, place)| place.0 == p) {
            *value = scene.functions[f].evaluate(&scene.model, &run).value;
        }
        let real: Vec<f64> = whole.iter().map(|x| x.re).collect();
        let mut of_real = case.problem.scene::<f64>(&real);
        of_real.duration = run.duration.re;
        phases.push(Some(Analysed::Motion(Box::new(Evaluated {
            x: real,
            scene: of_real,
            run: run.real(),
            composition: case.problem.composition.clone(),
        }))));
        if let Some(next) = cases.list.get(p + 1) {
            let state = next.problem.state_after(&scene, &run, begin);
            begin += run.duration;
            whole = [&design[..], &state].concat();
        }
    }
    let found = infinitesimal(&problem.composition, &design, &values, COMPLEX_STEP);
    Ok((found, InCases::new(problem, cases, x, phases)))
}

/// Derivatives of every function in every variable at the design `x`, function by function: by the adjoint and by complex
/// steps through all phases.
///
/// # Errors
/// If a phase fails.
pub(in crate::analysed) fn check(
    (problem, cases): (&Problem, &Arc<Cases>),
    x: &[f64],
) -> Result<Vec<CheckedDerivative>, AnalysisFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::of(problem, Some(&which), true);
    let (at, _) = InCases::<Analysed>::with(&mut integration, (problem, cases), x, &which)?;
    let known = steps(&at)?;
    let along = |i: usize| {
        let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
        let direction: Vec<f64> = (0..x.len()).map(unit).collect();
        let stored = match i {
            0 => Stored::Steps,
            _ => Stored::Motion,
        };
        complex_step((problem, cases), (&known, stored), (x, &direction))
    };
    let found: Vec<(Vec<f64>, InCases<Analysed>)> = (0..x.len())
        .into_par_iter()
        .map(along)
        .collect::<Result<_, _>>()?;
    let Some((_, same)) = found.first() else {
        return Ok(Vec::new());
    };
    let (adjoint, _) = derivatives(same, &which)?;
    let (in_use, _) = derivatives(&at, &which)?;
    // A function may have no value in a phase that no function of the whole motion needs.
    let first = problem.composition.first;
    let told = which
        .iter()
        .filter(|&&f| f >= first || at.value(f).is_finite());
    let rows = told.map(|&f| {
        let others = |i: usize| (found[i].0[f], Some(in_use[f][i].value));
        checked_row((problem, x), (f, size(same, f)), &adjoint[f], others)
    });
    Ok(rows.flatten().collect())
}

/// For every function: its derivative along a direction by the adjoint and by a complex step, Σ |g_i d_i|, and the size of its
/// terms.
///
/// # Errors
/// If a phase fails.
pub(crate) fn directional(
    problem: &Problem,
    all: &InCases<Simulated>,
    direction: &[f64],
) -> Result<Vec<[f64; 4]>, AnalysisFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let known = steps(&repeated(problem, all))?;
    let known = (&known[..], Stored::Steps);
    let (complex, same) = complex_step((problem, &all.cases), known, (&all.x, direction))?;
    let (adjoint, _) = derivatives(&same, &which)?;
    let one = |&f: &usize| {
        let along = || adjoint[f].iter().zip(direction);
        let own: f64 = along().map(|(d, by)| d.value * by).sum();
        let sizes: f64 = along().map(|(d, by)| (d.value * by).abs()).sum();
        let terms: f64 = along().map(|(d, by)| d.terms * by.abs()).sum();
        [own, complex[f], sizes, terms.max(size(&same, f))]
    };
    Ok(which.iter().map(one).collect())
}

/// The same motions without their observations.
fn repeated(problem: &Problem, all: &InCases<Simulated>) -> InCases<Analysed> {
    let again = |at: &Option<Simulated>| {
        let at = at.as_ref().and_then(observed)?;
        let same = at.with_run(at.scene.clone(), at.run.clone());
        Some(Analysed::Motion(Box::new(same)))
    };
    InCases::new(
        problem,
        &all.cases,
        &all.x,
        all.list.iter().map(again).collect(),
    )
}

/// The size of a function that determines its round-off.
fn size(all: &InCases<Analysed>, f: usize) -> f64 {
    let own = |k: usize| match all.place(k) {
        Some((_, Analysed::Motion(at), f)) => function_size(at, f),
        _ => 0.0,
    };
    if !all.composition.gives(f) {
        return own(f);
    }
    let value = |k: usize| all.at_place(k, &Analysed::value);
    let terms = all.composition.partials(f, &all.x, &value).by_function;
    let sizes = terms.iter().map(|&(k, by)| by.abs() * own(k));
    sizes.sum::<f64>().max(all.value(f).abs())
}

/// Errors of the functions `which`, and of their gradients if `gradients`, from the whole motion with every step halved.
///
/// # Errors
/// If the finer motion or a gradient fails.
pub(super) fn estimate(
    all: &InCases<Simulated>,
    problem: &Problem,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, AnalysisFailure> {
    let known: Vec<&Evaluated> = all.list.iter().flatten().filter_map(observed).collect();
    let coarse = repeated(problem, all);
    let finer = |p: usize, own: &Problem, x: &[f64]| {
        let run = &known[p].run;
        let settings = halved(run, (run.has_cells, true), own.simulation.limits.clone());
        let mut scene = own.scene::<f64>(x);
        let run = event::settle(&mut scene, &settings, run.duration, Admit::Late)?;
        Ok(Evaluated {
            x: x.to_vec(),
            scene,
            run,
            composition: own.composition.clone(),
        })
    };
    let fine = each(&all.cases, &all.x, finer, |at| Some(at))?;
    let boxed = |at: Option<Evaluated>| Some(Analysed::Motion(Box::new(at?)));
    let fine = InCases::new(
        problem,
        &all.cases,
        &all.x,
        fine.into_iter().map(boxed).collect(),
    );
    let rows = |of: &InCases<Analysed>| match gradients && !problem.variables.is_empty() {
        true => Ok(derivatives(of, which)?.0),
        false => Ok::<_, AnalysisFailure>(vec![Vec::new(); which.len()]),
    };
    let (of_coarse, of_fine) = (rows(&coarse)?, rows(&fine)?);
    let order = known.iter().map(|at| at.run.method.order()).min();
    let gain = 2.0_f64.powi(order.unwrap_or(1) as i32);
    let estimate = |value: f64, finer: f64| {
        let of_steps = (value - finer) * gain / (gain - 1.0);
        Estimate {
            value,
            error: of_steps.abs(),
            of_steps,
            of_samples: 0.0,
        }
    };
    let one = |(row, &function): (usize, &usize)| {
        let both = of_coarse[row].iter().zip(&of_fine[row]);
        FunctionError {
            function,
            value: estimate(coarse.value(function), fine.value(function)),
            maximum: None,
            gradient: both.map(|(a, b)| estimate(a.value, b.value)).collect(),
        }
    };
    Ok(which.iter().enumerate().map(one).collect())
}
