//! Integration of a problem from design to design. The method is chosen once. Steps that follow a
//! tolerance are kept until their error is too large, so functions are smooth in the design.

mod tangent;
mod unresolved_sums;

use super::event::{self, Admit};
pub use super::event_times::Events;
use super::flexible_limits;
use super::memory;
use super::shared::Shared;
use crate::functions::resolution::{Resolution, resolution};
use crate::functions::{Function, Reduction, Scene};
use crate::integrate::{
    Chosen, Grid, IntegrationFailure, Limits, MEMORY, Method, Samples, Settings, Spacing,
    StepSolver, Trajectory, choice, has_kinks, simulate, simulate_by,
};
use crate::problem::{Case, Division, Problem};
use std::sync::Arc;

/// Samples of a motion with steps by tolerance, for tables, figures and events.
const SAMPLES: usize = 1000;
/// Kept steps are chosen anew above this step error, relative to the tolerance.
const REFRESH: f64 = 10.0;
/// Error of sums over the motion for which cells are chosen, relative to the tolerance of the
/// steps.
const OF_SUMS: f64 = 0.1;
/// Largest number of choices of cells, or of steps up to an event, for one motion.
const ROUNDS: usize = 8;
/// An event on kept steps counts only if it comes before the longest duration by this part,
/// relative to the tolerance and absolute. Otherwise steps of the design itself decide.
const LATE: f64 = 1e3;
const LEAST_LATE: f64 = 1e-9;
const MOST_LATE: f64 = 0.05;

/// Reason of a choice after the end has moved past a kink.
const PASSED: &str = "the end of the motion has passed an instant of a table";

/// Reason of the first choice of steps.
pub const FIRST_DESIGN: &str = "first design";

/// The method and the steps that are in use.
#[derive(Clone, Debug)]
pub struct Integration {
    method: Option<Method>,
    solver: StepSolver,
    spacing: Spacing,
    samples: Samples,
    limits: Limits,
    /// Samples that tables, figures and events have.
    shown: usize,
    /// The functions that depend on more than the end.
    summed: Vec<usize>,
    /// Settings in use, after the first simulation.
    chosen: Option<(Settings, String)>,
    /// How often the steps were chosen anew. Of cases together the log of evaluations counts it: see [`Self::restore`].
    pub refreshes: usize,
    /// Number of designs that do not fulfil the conditions of the lowering.
    pub unlowered: usize,
    /// Memory of the steps for gradients \[bytes\], and of those whose samples may be chosen anew.
    memory: usize,
    to_resample: usize,
    /// Whether the functions have derivatives: the problem has variables; and whether they will be requested.
    derivatives: bool,
    gradients: bool,
    /// When the event came in the last run, if the scene has one \[s\].
    pub event: Option<f64>,
    /// When it comes in the next run, if that is known to the last bit \[s\].
    pub settled: Option<f64>,
    /// By case of a problem with cases: its integration, if a function of it is asked.
    pub cases: Vec<Option<Integration>>,
    /// The ranks over which the cases are spread, if they are.
    pub(crate) shared: Option<Arc<Shared>>,
}

/// Method and steps of an earlier choice.
pub struct KeptSteps {
    /// The method.
    pub method: Method,
    /// Why, if it is not used for its usual purpose.
    pub reason: Option<String>,
    /// Its steps; `None` for equal ones.
    pub grid: Option<Grid>,
    /// Number of earlier choices.
    pub refreshes: usize,
    /// By case.
    pub cases: Vec<Option<KeptSteps>>,
}

/// A change of the steps in use.
#[derive(Clone, Debug, PartialEq)]
pub struct Refresh {
    /// Name of the method.
    pub method: String,
    /// Why this method, if it is not used for its usual purpose.
    pub method_reason: Option<String>,
    /// The new steps; `None` for equal ones.
    pub grid: Option<Grid>,
    /// Why.
    pub reason: String,
    /// By case: the steps in use from now on.
    pub cases: Vec<Option<Refresh>>,
}

/// How steps are solved: those of a phase to round-off, as events and later phases multiply what Newton's method leaves.
fn solver(problem: &Problem, spacing: &Spacing) -> StepSolver {
    let linear = problem.simulation.solver;
    match problem.is_phase() {
        true => StepSolver {
            linear,
            ..StepSolver::default()
        },
        false => StepSolver::suited(linear, spacing),
    }
}

/// Name of the method in records of problems with cases.
pub(super) const OF_CASES: &str = "cases";

impl Integration {
    /// The integration that `problem` requests. `asked` are the functions that will be requested,
    /// or `None` if the whole motion is needed in any case; `gradients` tells whether derivatives
    /// will be.
    pub fn new(
        problem: &Problem,
        scene: &Scene<f64>,
        asked: Option<&[usize]>,
        gradients: bool,
    ) -> Self {
        let simulation = &problem.simulation;
        let all: Vec<usize> = (0..scene.functions.len()).collect();
        let asked_of_scene = |asked| problem.composition.of_scene(asked).into_owned();
        let mut summed = asked.map_or(all, asked_of_scene);
        summed.retain(|&f| looks_at_the_whole(&scene.functions[f]));
        let shown = simulation.samples.unwrap_or(SAMPLES);
        // An event is looked for inside every step, whatever the samples.
        let (seen, ends) = (asked.is_none(), scene.until.is_some());
        let sums = !summed.is_empty();
        summed.extend(ends.then(|| scene.event()));
        let samples = match (simulation.samples, &simulation.spacing) {
            (Some(samples), Spacing::Steps(_)) if sums || !ends => Samples::Uniform(samples),
            (Some(samples), Spacing::Steps(_)) => Samples::Quadrature(samples),
            (None, Spacing::Steps(_)) if seen || sums || ends => Samples::StepEnds,
            (None, Spacing::Steps(0)) => Samples::StepEnds,
            (None, Spacing::Steps(_)) => Samples::Uniform(1),
            _ if !summed.is_empty() => Samples::Quadrature(if seen { shown } else { 0 }),
            _ if seen => Samples::Uniform(shown),
            _ => Samples::Uniform(1),
        };
        // Steps that end at kinks do so at every duration, so that values are smooth in it.
        let spacing = match simulation.spacing {
            Spacing::Steps(steps) if problem.end_moves() && has_kinks(&scene.model) => {
                Spacing::Frozen(Grid::between(steps, &[]))
            }
            _ => simulation.spacing.clone(),
        };
        let most = memory::for_gradients(simulation.memory);
        let memory = if gradients { most } else { 0 };
        let to_resample = match (samples, &spacing) {
            (Samples::Quadrature(_), Spacing::Tolerance(_)) => memory.max(most.min(MEMORY)),
            _ => memory,
        };
        Self {
            method: simulation.method,
            solver: solver(problem, &spacing),
            spacing,
            samples,
            limits: simulation.limits.clone(),
            shown,
            summed,
            chosen: None,
            refreshes: 0,
            unlowered: 0,
            memory,
            to_resample,
            derivatives: !problem.variables.is_empty(),
            gradients,
            event: None,
            settled: None,
            cases: Vec::new(),
            shared: None,
        }
    }

    /// As [`Integration::new`] for the scene of the start. Structures are not integrated, and cases have theirs.
    pub fn of(problem: &Problem, asked: Option<&[usize]>, gradients: bool) -> Self {
        if problem.statics.is_none() && problem.cases.is_none() {
            return Self::new(problem, &problem.scene(&problem.start()), asked, gradients);
        }
        Self {
            method: None,
            solver: StepSolver::default(),
            spacing: problem.simulation.spacing.clone(),
            samples: Samples::Uniform(1),
            limits: problem.simulation.limits.clone(),
            shown: SAMPLES,
            summed: Vec::new(),
            chosen: None,
            refreshes: 0,
            unlowered: 0,
            memory: 0,
            to_resample: 0,
            derivatives: false,
            gradients: false,
            event: None,
            settled: None,
            cases: Self::of_cases(problem, asked, gradients),
            shared: None,
        }
    }

    fn of_cases(problem: &Problem, asked: Option<&[usize]>, gradients: bool) -> Vec<Option<Self>> {
        let Some(cases) = &problem.cases else {
            return Vec::new();
        };
        let wanted = asked.map(|asked| cases.wanted(&problem.composition.of_scene(asked)));
        let one = |(c, case): (usize, &Case)| match &wanted {
            None => Some(Self::of(&case.problem, None, gradients)),
            Some(wanted) if wanted[c].is_empty() && cases.division == Division::Cases => None,
            Some(wanted) => Some(Self::of(&case.problem, Some(&wanted[c]), gradients)),
        };
        cases.list.iter().enumerate().map(one).collect()
    }

    /// Adds the changes of the models of cases.
    pub(super) fn count_cases(&mut self) {
        self.unlowered = self.cases.iter().flatten().map(|own| own.unlowered).sum();
    }

    /// The integrations of its cases, or of the phases of these, in their order.
    fn leaves(&self) -> Vec<Option<&Self>> {
        let mut all = Vec::new();
        for own in &self.cases {
            match own.as_ref() {
                Some(own) if !own.cases.is_empty() => all.extend(own.leaves()),
                own => all.push(own),
            }
        }
        all
    }

    fn leaves_mut(&mut self) -> Vec<Option<&mut Self>> {
        let mut all = Vec::new();
        for own in &mut self.cases {
            match own.as_mut() {
                Some(own) if !own.cases.is_empty() => all.extend(own.leaves_mut()),
                own => all.push(own),
            }
        }
        all
    }

    /// When the events came in the last runs.
    pub(super) fn events(&self) -> Events {
        let leaves = self.leaves().into_iter();
        Events {
            own: self.event,
            cases: leaves.map(|own| own?.event).collect(),
        }
    }

    /// Begins to look for events where they came in an earlier run.
    pub(super) fn recall_events(&mut self, events: &Events) {
        self.event = events.own;
        for (own, event) in self.leaves_mut().into_iter().zip(&events.cases) {
            if let Some(own) = own {
                own.event = *event;
            }
        }
    }

    /// When the events come in the next runs, if that is known to the last bit.
    pub(super) fn settle(&mut self, events: Option<&Events>) {
        self.settled = events.and_then(|events| events.own);
        for (c, own) in self.leaves_mut().into_iter().enumerate() {
            if let Some(own) = own {
                own.settled = events.and_then(|events| *events.cases.get(c)?);
            }
        }
    }

    /// The steps in use, if they were chosen, and `why` they are.
    pub(super) fn in_use(&self, why: &str) -> Option<Refresh> {
        let cases: Vec<Option<Refresh>> = self
            .cases
            .iter()
            .map(|own| own.as_ref()?.in_use(why))
            .collect();
        if !cases.is_empty() {
            return Some(Refresh {
                method: OF_CASES.to_owned(),
                method_reason: None,
                grid: None,
                reason: why.to_owned(),
                cases,
            });
        }
        let (settings, reason) = self.chosen()?;
        Some(Refresh {
            method: settings.method.name(),
            method_reason: Some(reason.to_owned()),
            grid: match &settings.spacing {
                Spacing::Frozen(grid) => Some(grid.clone()),
                Spacing::Steps(_) | Spacing::Tolerance(_) => None,
            },
            reason: why.to_owned(),
            cases,
        })
    }

    /// Whether the next runs use steps that were chosen before. Structures have none.
    pub(super) fn has_steps(&self, problem: &Problem) -> bool {
        match &problem.cases {
            Some(cases) => {
                let all = cases.list.iter().zip(&self.cases);
                { all }.all(|(case, own)| match own {
                    Some(own) => own.has_steps(&case.problem),
                    None => true,
                })
            }
            None => problem.statics.is_some() || self.chosen.is_some(),
        }
    }

    /// The method that the problem requests, if any.
    pub(super) fn method(&self) -> Option<Method> {
        self.method
    }

    /// The settings in use and the reason for the method, after the first simulation.
    pub fn chosen(&self) -> Option<(&Settings, &str)> {
        let (settings, reason) = self.chosen.as_ref()?;
        Some((settings, reason))
    }

    /// Takes other steps from now on.
    pub(super) fn take_steps(&mut self, settings: Settings, why: String) -> Refresh {
        let reason = self
            .chosen
            .take()
            .map_or_else(String::new, |(_, reason)| reason);
        let general = choice::reason(self.method.is_some(), settings.method);
        let refresh = Refresh {
            method: settings.method.name(),
            method_reason: Some(reason.clone()).filter(|reason| reason != general),
            grid: match &settings.spacing {
                Spacing::Frozen(grid) => Some(grid.clone()),
                Spacing::Steps(_) | Spacing::Tolerance(_) => None,
            },
            reason: why,
            cases: Vec::new(),
        };
        self.chosen = Some((settings, reason));
        refresh
    }

    /// Goes on in one process, which has these limits.
    pub(super) fn leave_ranks(&mut self, limits: &Limits) {
        self.shared = None;
        self.limits = limits.clone();
        if let Some((settings, _)) = &mut self.chosen {
            settings.limits = limits.clone();
        }
        for own in self.cases.iter_mut().flatten() {
            own.leave_ranks(limits);
        }
    }

    /// Whether the run must end, as all ranks know it if its cases are spread.
    pub(super) fn is_over(&self) -> bool {
        match &self.shared {
            Some(shared) => shared.is_over(),
            None => self.limits.is_over(),
        }
    }

    /// Number of steps of the motion, if known.
    pub fn steps(&self) -> Option<usize> {
        if !self.cases.is_empty() {
            return self.cases.iter().flatten().map(Self::steps).sum();
        }
        let spacing = self.chosen.as_ref().map(|(settings, _)| &settings.spacing);
        match spacing.unwrap_or(&self.spacing) {
            Spacing::Steps(steps) => Some(*steps),
            Spacing::Frozen(grid) => Some(grid.steps()),
            Spacing::Tolerance(_) => None,
        }
    }

    /// Where the motion is sampled.
    pub fn samples(&self) -> Samples {
        self.samples
    }

    /// Samples the whole motion from now on, for figures. Functions of the end do not change.
    pub fn see_whole(&mut self) {
        self.cases.iter_mut().flatten().for_each(Self::see_whole);
        self.samples = match self.samples {
            Samples::Uniform(1) => Samples::Uniform(self.shown),
            Samples::Quadrature(0) => Samples::Quadrature(self.shown),
            seen => seen,
        };
        if let Some((settings, _)) = &mut self.chosen {
            settings.samples = self.samples;
        }
    }

    /// Continues with an earlier choice of steps.
    pub fn restore(&mut self, kept: KeptSteps) {
        self.refreshes = kept.refreshes;
        if !self.cases.is_empty() {
            for (own, kept) in self.cases.iter_mut().zip(kept.cases) {
                if let (Some(own), Some(kept)) = (own, kept) {
                    own.restore(kept);
                }
            }
            return;
        }
        let mut settings = Settings {
            method: kept.method,
            ..self.wanted()
        };
        if let Some(grid) = kept.grid {
            settings.spacing = Spacing::Frozen(grid);
        }
        let general = || choice::reason(self.method.is_some(), kept.method).into();
        let reason = kept.reason.unwrap_or_else(general);
        self.chosen = Some((settings, reason));
    }

    /// A warning about the method in use for a scene whose steps it made.
    pub fn warning(&self, scene: &Scene<f64>, run: &Trajectory<f64>) -> Option<String> {
        let widest = (1..=run.grid.steps()).map(|k| run.grid.width(k));
        let h = run.duration * widest.fold(0.0, f64::max);
        let of_method = choice::warning(&scene.model, run.method, h);
        let of_bodies = flexible_limits::warning(&scene.model, run);
        let all: Vec<String> = of_method.into_iter().chain(of_bodies).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }

    /// Settings of the first run, or of one that chooses its steps anew.
    pub(super) fn wanted(&self) -> Settings {
        Settings {
            method: self.method.unwrap_or(Method::Dop853),
            solver: self.solver,
            spacing: self.spacing.clone(),
            samples: self.samples,
            limits: self.limits.clone(),
            memory: self.memory,
            derivatives: self.derivatives,
        }
    }

    /// Simulates a scene with the steps in use, and chooses them anew if their error is too large.
    /// Sets the duration of a scene that ends at an event.
    ///
    /// # Errors
    /// If the simulation fails, or a flexible body is turned inside out.
    pub fn simulate(
        &mut self,
        scene: &mut Scene<f64>,
    ) -> Result<(Trajectory<f64>, Option<Refresh>), IntegrationFailure> {
        let found = self.by_steps_in_use(scene)?;
        flexible_limits::refuse_inside_out(&scene.model, &found.0)?;
        Ok(found)
    }

    fn by_steps_in_use(
        &mut self,
        scene: &mut Scene<f64>,
    ) -> Result<(Trajectory<f64>, Option<Refresh>), IntegrationFailure> {
        scene.admit_start()?;
        memory::admit(&scene.model, &self.wanted())?;
        let settled = self.settled.take();
        let waited = scene.duration;
        let why = match (&self.chosen, &self.spacing) {
            (None, _) => FIRST_DESIGN.into(),
            (Some((settings, _)), Spacing::Tolerance(tolerance)) => {
                match self.run(scene, settings, settled) {
                    Ok(run) if passes_kinks(settings, &run) => PASSED.into(),
                    Ok(run) if run.step_error <= REFRESH * tolerance => {
                        let Resolution { error, cells } = self.resolution(scene, &run);
                        // More cells than allowed do not improve a sum that is not smooth.
                        let best = cells == run.grid.all_cells();
                        if error <= REFRESH * OF_SUMS * tolerance || best {
                            return Ok((self.keep(scene, run), None));
                        }
                        let why = format!(
                            "a sum over the motion may err by {error:.1e}: its samples were chosen anew"
                        );
                        return self.choose_cells(scene, run, why);
                    }
                    Ok(run) => format!(
                        "a step's error of {:.1e} exceeds {REFRESH} times the tolerance",
                        run.step_error
                    ),
                    Err(failure) => failure.to_string(),
                }
            }
            (Some((settings, _)), _) => match self.run(scene, settings, settled) {
                Err(
                    failure @ (IntegrationFailure::Stiff { .. }
                    | IntegrationFailure::Unstable { .. }),
                ) if self.method.is_none() => failure.to_string(),
                Err(failure @ IntegrationFailure::NotReached { .. }) => failure.to_string(),
                Ok(run) if passes_kinks(settings, &run) => PASSED.into(),
                found => return Ok((self.keep(scene, found?), None)),
            },
        };
        let wanted = Settings {
            memory: self.to_resample,
            ..self.wanted()
        };
        // Steps with too large an error may still have found an event.
        scene.duration = waited;
        if let Some(until) = &scene.until {
            scene.duration = event::sought(scene, until, waited, |duration| {
                Ok(simulate_by(&scene.model, duration, self.method, &wanted)?.run)
            })?;
        }
        let mut guess = scene.duration;
        let mut chosen = simulate_by(&scene.model, guess, self.method, &wanted)?;
        if scene.until.is_some() {
            for _ in 0..ROUNDS {
                scene.duration = waited;
                chosen.run = event::settle(scene, &chosen.settings, guess, Admit::InTime)?;
                if !passes_kinks(&chosen.settings, &chosen.run) {
                    break;
                }
                guess = chosen.run.duration;
                chosen = simulate_by(&scene.model, guess, self.method, &wanted)?;
            }
        }
        let Chosen {
            run,
            settings,
            reason,
        } = chosen;
        let (mut run, mut settings) = self.resolved(scene, run, settings)?;
        settings.memory = self.memory;
        if self.memory == 0 {
            run.forget_steps();
        }
        let grid = match &settings.spacing {
            Spacing::Frozen(grid) => Some(grid.clone()),
            Spacing::Steps(_) | Spacing::Tolerance(_) => None,
        };
        let before = self.chosen.as_ref().map(|(before, _)| before.method);
        // Equal steps never change. Only their method may change, if none is given.
        let anew = grid.is_some() || before != Some(settings.method);
        let general = choice::reason(self.method.is_some(), settings.method);
        let changed = (grid.is_some() || (anew && self.method.is_none())).then(|| Refresh {
            method: settings.method.name(),
            method_reason: Some(reason.clone()).filter(|reason| reason != general),
            grid,
            reason: why,
            cases: Vec::new(),
        });
        self.refreshes += usize::from(self.chosen.is_some() && anew);
        self.chosen = Some((settings, reason));
        Ok((self.keep(scene, run), changed))
    }

    /// Accuracy of the cells of a run for the requested sums.
    fn resolution(&self, scene: &Scene<f64>, run: &Trajectory<f64>) -> Resolution {
        match (self.samples, &self.spacing) {
            (Samples::Quadrature(_), Spacing::Tolerance(tolerance)) => {
                resolution(scene, &self.summed, run, OF_SUMS * tolerance)
            }
            _ => Resolution {
                error: 0.0,
                cells: run.grid.all_cells().to_vec(),
            },
        }
    }

    /// The motion of `run` with the cells that its sums need, and its settings. Cells are chosen
    /// until they no longer change; the motion is repeated only if its steps are not stored.
    fn resolved(
        &self,
        scene: &Scene<f64>,
        mut run: Trajectory<f64>,
        mut settings: Settings,
    ) -> Result<(Trajectory<f64>, Settings), IntegrationFailure> {
        for _ in 0..ROUNDS {
            let Resolution { cells, .. } = self.resolution(scene, &run);
            let (Spacing::Frozen(grid), Spacing::Tolerance(_)) = (&settings.spacing, &self.spacing)
            else {
                break;
            };
            if cells == grid.all_cells() {
                break;
            }
            // Also if cells are only removed: a resumed run knows only these cells.
            settings.spacing = Spacing::Frozen(grid.clone().with_cells(cells.clone()));
            let (counts, duration) = (run.counts, run.duration);
            run = match run.resampled(&scene.model, cells, settings.samples) {
                Some(run) => run,
                None => {
                    let mut again = simulate(&scene.model, duration, &settings)?;
                    again.counts += counts;
                    again
                }
            };
        }
        Ok((run, settings))
    }

    /// Chooses the cells of the steps in use anew.
    fn choose_cells(
        &mut self,
        scene: &Scene<f64>,
        run: Trajectory<f64>,
        why: String,
    ) -> Result<(Trajectory<f64>, Option<Refresh>), IntegrationFailure> {
        let Some((settings, _)) = self.chosen.clone() else {
            return Ok((run, None));
        };
        let (run, settings) = self.resolved(scene, run, settings)?;
        if !matches!(settings.spacing, Spacing::Frozen(_)) {
            return Ok((self.keep(scene, run), None));
        }
        self.refreshes += 1;
        let refresh = self.take_steps(settings, why);
        Ok((self.keep(scene, run), Some(refresh)))
    }

    /// A run on the steps in use, up to the event if there is one. The event is at `settled`, or is
    /// searched near its last time if known, or from the start.
    fn run(
        &self,
        scene: &mut Scene<f64>,
        settings: &Settings,
        settled: Option<f64>,
    ) -> Result<Trajectory<f64>, IntegrationFailure> {
        let Some(until) = &scene.until else {
            return simulate(&scene.model, scene.duration, settings);
        };
        if let Some(event) = settled {
            scene.duration = event;
            return simulate(&scene.model, event, settings);
        }
        let guess = match self.event {
            Some(event) => event,
            None => event::sought(scene, until, scene.duration, |duration| {
                simulate(&scene.model, duration, settings)
            })?,
        };
        // Steps chosen for this design may give another result, by their errors.
        let margin = match self.spacing {
            Spacing::Tolerance(tolerance) => (LATE * tolerance).clamp(LEAST_LATE, MOST_LATE),
            Spacing::Steps(_) | Spacing::Frozen(_) => LEAST_LATE,
        };
        event::settle(scene, settings, guess, Admit::Certain { margin })
    }

    /// Stores the time of the event.
    fn keep(&mut self, scene: &Scene<f64>, run: Trajectory<f64>) -> Trajectory<f64> {
        self.event = scene.until.as_ref().map(|_| run.duration);
        run
    }
}

/// Whether a run on kept steps ends on another side of a kink than the run that chose them.
fn passes_kinks(settings: &Settings, run: &Trajectory<f64>) -> bool {
    match &settings.spacing {
        Spacing::Frozen(grid) => grid.kinks().len() != run.grid.kinks().len(),
        Spacing::Steps(_) | Spacing::Tolerance(_) => false,
    }
}

/// Whether a function depends on more than the state at the end.
pub(super) fn looks_at_the_whole(function: &Function<f64>) -> bool {
    match function {
        Function::Reduced {
            of,
            during,
            reduction,
        } => !matches!(reduction, Reduction::Final) || during.is_some() || of.looks_around(),
        Function::Misfit { .. } => true,
        Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => false,
        Function::Clearance { release, .. } => {
            matches!(release, crate::functions::Release::Best { .. })
        }
    }
}
