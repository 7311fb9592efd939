//! The march of the implicit methods.

use super::estimate::Estimate;
use super::formula::{Formula, memory_size, remembers_start};
use super::newton::{History, Newton};
use super::predict::{Past, dense};
use super::radau::Scheme;
use super::stage_newton::StageNewton;
use super::{Stage, Tape};
use crate::integrate::control::{Controller, Scale};
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::grid::{Grid, Place, place};
use crate::integrate::quadrature;
use crate::integrate::settings::{Method, Samples, Settings, Spacing};
use crate::integrate::trajectory::{self, Trajectory};
use crate::integrate::{close, watch};
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::initial::InitialState;
use crate::system::{Motion, Numbering, bodies};

/// Integrates from a consistent start.
///
/// # Errors
/// [`IntegrationFailure`] says what failed, when and where.
pub fn march<S: SolveScalar>(
    model: &Model<S>,
    numbering: &Numbering,
    duration: S,
    settings: &Settings,
    start: InitialState<S>,
) -> Result<Trajectory<S>, IntegrationFailure> {
    march_until((model, numbering), duration, settings, start, None)
}

/// Part of a motion, on which the pace of a method is measured.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Fraction of the duration that it begins at.
    from: f64,
    /// Work after which it ends [evaluations].
    most: f64,
    /// Work by the end of each step, and the fraction that it reached.
    steps: Vec<(f64, f64)>,
}

impl Stretch {
    /// A stretch from the fraction `from` that ends after so much work.
    pub fn new(from: f64, most: f64) -> Self {
        Self {
            from,
            most,
            steps: Vec::new(),
        }
    }

    /// Fraction of the duration for a unit of work, in its second half where it has several steps: the
    /// first steps are small and have no past.
    pub fn pace(&self) -> Option<f64> {
        let &(work, reached) = self.steps.last()?;
        let half = self.steps.iter().find(|(before, _)| *before >= 0.5 * work);
        match half {
            Some(&(before, at)) if before < work && reached < 1.0 => {
                Some((reached - at) / (work - before))
            }
            _ => Some((reached - self.from) / work),
        }
    }
}

/// Marches over `stretch` only.
///
/// # Errors
/// As [`march`].
pub fn march_stretch<S: SolveScalar>(
    (model, numbering): (&Model<S>, &Numbering),
    duration: S,
    settings: &Settings,
    start: InitialState<S>,
    stretch: &mut Stretch,
) -> Result<(), IntegrationFailure> {
    march_until((model, numbering), duration, settings, start, Some(stretch)).map(drop)
}

fn march_until<S: SolveScalar>(
    (model, numbering): (&Model<S>, &Numbering),
    duration: S,
    settings: &Settings,
    start: InitialState<S>,
    mut stretch: Option<&mut Stretch>,
) -> Result<Trajectory<S>, IntegrationFailure> {
    let method = settings.method;
    let real: Model<f64> = model.map(&mut |x| x.re());
    let scheme = Scheme::of(method);
    let scale = Scale::of(model, numbering, &start, duration.re());
    let mut controller = Controller::new(
        settings,
        scheme.stages() + 1,
        &scale,
        (model, duration.re()),
    );
    let estimates = controller.estimates() && method.is_adaptive();
    let first = starting_stage(numbering, &start);
    let mut solver = Solver {
        method,
        numbering,
        scheme: &scheme,
        one: None,
        coupled: None,
        model,
        real: &real,
        estimate: estimates.then(|| Estimate::new(&real, numbering, &scheme)),
        memory: [first.q.len(), first.v.len()]
            .map(|n| vec![vec![S::zero(); n]; memory_size(method)]),
        history: History::new(numbering),
        stages: vec![Stage::zero(numbering); scheme.stages()],
    };
    let mut past = Past::new(numbering, first.clone(), scheme.stages());
    let mut inside = Stage::zero(numbering);
    let tape = trajectory::Tape::Implicit(Tape::new(numbering, first));
    let lambda = start.lambda.clone();
    let mut run = Trajectory::start(numbering.clone(), method, duration, start, tape);
    run.lambda = lambda;
    if let Some(stretch) = &stretch {
        run.grid = Grid::growing_from(stretch.from);
    }
    // A formula knows its motion at the ends of its steps only.
    let samples = match method {
        Method::Radau { .. } => settings.samples,
        _ => Samples::StepEnds,
    };
    run.take_cells(&settings.spacing, samples);
    // The history of steps that are chosen on the way grows with them.
    reserve(&mut run, &settings.spacing, samples, scheme.stages());
    let mut next = 1;
    let mut motions = Vec::new();
    let watched =
        (model.joints.iter()).any(|joint| !joint.left_out.is_empty() || !joint.drives.is_empty());
    while let Some(width) = controller.next(run.grid.reached()) {
        if let Some(stretch) = &stretch
            && run.counts.implicit_work() >= stretch.most
        {
            break;
        }
        let h = duration * width;
        let end = controller.end(run.grid.reached(), width);
        let k = run.grid.steps() + 1;
        let at = (k, duration.re() * end);
        let start = duration * run.grid.reached();
        let count = match solver.step(&mut past, (start, h), at, &mut run.counts) {
            Ok(count) => count,
            Err(failure) if controller.give_up(false) => return Err(failure),
            Err(_) => {
                run.counts.rejected += 1;
                continue;
            }
        };
        let error = solver.error(&past.from, h.re(), &scale);
        if !controller.judge(error) {
            run.counts.rejected += 1;
            continue;
        }
        controller.accept();
        let stages = &solver.stages[..count];
        let last = &stages[count - 1];
        if watched {
            Motion::all(numbering, &last.q, &last.v, &mut motions);
            watch(model, (&motions, last.time), k)?;
        }
        run.grid.push(end);
        let all = (&past.from, stages);
        sample(&mut run, &scheme, all, samples, (&mut next, &mut inside));
        let trajectory::Tape::Implicit(tape) = &mut run.tape else {
            unreachable!("the tape is that of an implicit method")
        };
        tape.push(stages);
        solver.remember(count, k);
        past.advance(h, &mut solver.stages, count);
        if let Some(stretch) = &mut stretch {
            let work = run.counts.implicit_work();
            stretch.steps.push((work, run.grid.reached()));
        }
    }
    close(&mut run, &controller)?;
    if let Some(estimate) = &solver.estimate {
        estimate.count(&mut run.counts);
    }
    Ok(run)
}

/// Makes room for the history of a run whose steps are known.
fn reserve<S: SolveScalar>(
    run: &mut Trajectory<S>,
    spacing: &Spacing,
    samples: Samples,
    stages: usize,
) {
    let (steps, grid) = match spacing {
        Spacing::Steps(steps) => (*steps, None),
        Spacing::Frozen(grid) => (grid.steps(), Some(grid)),
        Spacing::Tolerance(_) => return,
    };
    let samples = samples.count(steps, grid);
    run.reserve(steps, samples);
    // Formulas have one stage a step, but for the first ones.
    let stages = match run.method {
        Method::Radau { .. } => steps * stages,
        _ => steps + memory_size(run.method) * (stages - 1),
    };
    if let trajectory::Tape::Implicit(tape) = &mut run.tape {
        tape.reserve(steps, stages);
    }
}

/// The start as a stage, with its rates q̇ = T(q) v and v̇.
fn starting_stage<S: SolveScalar>(numbering: &Numbering, start: &InitialState<S>) -> Stage<S> {
    let mut first = Stage::zero(numbering);
    first.q.copy_from_slice(&start.q);
    first.v.copy_from_slice(&start.v);
    first.lambda.copy_from_slice(&start.lambda);
    first.vdot.copy_from_slice(&start.a);
    bodies::rates(numbering, &start.q, &start.v, &mut first.qdot);
    first
}

/// Makes the steps of a method.
struct Solver<'a, S> {
    method: Method,
    model: &'a Model<S>,
    real: &'a Model<f64>,
    numbering: &'a Numbering,
    scheme: &'a Scheme,
    /// Newton's method for formulas, once it is needed.
    one: Option<Newton<'a, S>>,
    /// Newton's method for Radau IIA, once it is needed.
    coupled: Option<StageNewton<'a, S>>,
    estimate: Option<Estimate<'a>>,
    /// Memory of a formula, of q and of v.
    memory: [Vec<Vec<S>>; 2],
    history: History<S>,
    /// Stages of the latest step, a formula's in front.
    stages: Vec<Stage<S>>,
}

impl<S: SolveScalar> Solver<'_, S> {
    /// Makes step `at.0` of size `h`; returns its number of stages.
    fn step(
        &mut self,
        past: &mut Past<S>,
        (start, h): (S, S),
        at: (usize, f64),
        counts: &mut trajectory::WorkCounts,
    ) -> Result<usize, IntegrationFailure> {
        let (model, real, numbering) = (self.model, self.real, self.numbering);
        let stages = &mut self.stages;
        let Some(formula) = Formula::of_step(self.method, at.0) else {
            past.predict_stages(numbering, self.scheme, h, stages);
            for (stage, &c) in stages.iter_mut().zip(&self.scheme.nodes) {
                stage.hold(numbering, &past.from);
                stage.time = start + h * c;
            }
            let (scheme, estimates) = (self.scheme, self.estimate.is_some());
            self.coupled
                .get_or_insert_with(|| StageNewton::new(model, real, numbering, scheme, estimates))
                .solve(stages, h, at, counts)?;
            return Ok(stages.len());
        };
        if at.0 == 1 && remembers_start(self.method) {
            for (memory, rates) in self
                .memory
                .iter_mut()
                .zip([&past.from.qdot, &past.from.vdot])
            {
                for m in memory {
                    m.iter_mut().zip(rates).for_each(|(m, &x)| *m = x * h);
                }
            }
        }
        let stage = &mut stages[0];
        past.predict(numbering, h, stage);
        stage.hold(numbering, &past.from);
        stage.time = start + h;
        self.history.set(&formula, &self.memory, h);
        let history = &self.history;
        let newton = self
            .one
            .get_or_insert_with(|| Newton::new(model, numbering));
        newton.solve(stage, history, h, at, counts).or_else(|_| {
            // An extrapolation over steps that are large for the motion may lead astray.
            past.taylor(numbering, h, stage);
            stage.hold(numbering, &past.from);
            stage.time = start + h;
            newton.forget();
            newton.solve(stage, history, h, at, counts)
        })?;
        Ok(1)
    }

    /// Moves the memory past step k of `count` stages.
    fn remember(&mut self, count: usize, k: usize) {
        let last = &self.stages[count - 1];
        let formula = Formula::of_step(self.method, k);
        for (memory, delta) in self.memory.iter_mut().zip([&last.dq, &last.dv]) {
            match &formula {
                Some(formula) => {
                    for (k, &delta) in delta.iter().enumerate() {
                        formula.remember(delta, memory, k);
                    }
                }
                // Increments that a formula to come starts from, newest first.
                None => {
                    if let Some(oldest) = memory.last_mut() {
                        oldest.copy_from_slice(delta);
                        memory.rotate_right(1);
                    }
                }
            }
        }
    }

    /// Estimated error of the step that was just made from `from`, relative to the scene's scale;
    /// zero without an estimate.
    fn error(&mut self, from: &Stage<S>, h: f64, scale: &Scale) -> f64 {
        match (&mut self.coupled, &mut self.estimate) {
            (Some(newton), Some(estimate)) => {
                estimate.error(newton, (from, &self.stages), h, scale)
            }
            _ => 0.0,
        }
    }
}

/// Adds the instants of the step that was just accepted, given its start and its stages.
fn sample<S: SolveScalar>(
    run: &mut Trajectory<S>,
    scheme: &Scheme,
    (from, stages): (&Stage<S>, &[Stage<S>]),
    samples: Samples,
    (next, inside): (&mut usize, &mut Stage<S>),
) {
    let k = run.grid.steps();
    let h = run.duration * run.grid.width(k);
    let last = &stages[stages.len() - 1];
    let step = run.grid.step(k);
    if let Samples::Quadrature(_) = samples {
        run.weigh_start(&step);
    }
    for due in quadrature::due(samples, next, step) {
        let place = place(&run.grid, k, due.at);
        match place {
            Place::Node(_) => run.push(due, place, [&last.q, &last.v, &last.vdot, &last.lambda]),
            Place::Inside { theta, .. } => {
                dense(scheme, from, stages, h, theta, inside);
                bodies::bring_to_unit(&run.numbering, &mut inside.q);
                let Stage {
                    q, v, vdot, lambda, ..
                } = &*inside;
                run.push(due, place, [q, v, vdot, lambda]);
            }
        }
    }
}
