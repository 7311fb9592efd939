//! The march of the implicit methods.

use super::Stage;
use super::predict::Past;
use super::radau::Scheme;
use super::samples::sample;
use super::solver::{Solver, starting_stage};
use super::tape::{Block, Tape};
use crate::integrate::control::Controller;
use crate::integrate::energy::Ledger;
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::grid::Grid;
use crate::integrate::quadrature;
use crate::integrate::quadrature::Samples;
use crate::integrate::scale::Scale;
use crate::integrate::settings::{Method, Settings, Spacing};
use crate::integrate::singular::{MOST_IMPLICIT, Steadiness};
use crate::integrate::touches::Touches;
use crate::integrate::trajectory::{self, Trajectory};
use crate::integrate::{close, watch};
use crate::linalg::SolveScalar;
use crate::math::Parameters;
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::initial::InitialState;
use crate::system::redundant_rows::EXCHANGE_WEIGHT;
use crate::system::{BodyMotion, Numbering, flexible, turns};

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
    let run = || march_until((model, numbering), duration, settings, start, None);
    // Among the threads that share the work, none waits for the others to begin.
    match flexible::is_divided(model) {
        true => rayon::scope(|_| run()),
        false => run(),
    }
}

/// A part of a motion, for measuring the pace of a method.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Fraction of the duration at its start.
    from: f64,
    /// Work after which it ends [evaluations].
    most: f64,
    /// Work up to the end of each step, and the fraction reached.
    steps: Vec<(f64, f64)>,
}

/// A step that is longer than the one before by this factor still grows. Growth extends a stretch by at most the other
/// factor.
const GROWS: f64 = 1.2;
const MOST_OF_GROWTH: f64 = 10.0;

impl Stretch {
    /// A part from the fraction `from` that ends after the work `most`.
    pub fn new(from: f64, most: f64) -> Self {
        Self {
            from,
            most,
            steps: Vec::new(),
        }
    }

    /// Whether it ends after this work. Steps that still grow say little of the pace.
    fn is_over(&self, work: f64) -> bool {
        let grows = match self.steps[..] {
            [.., (_, a), (_, b), (_, c)] => c - b > GROWS * (b - a),
            _ => true,
        };
        work >= self.most && (!grows || work >= MOST_OF_GROWTH * self.most)
    }

    /// Fraction of the duration per unit of work. Of several steps only the second half counts,
    /// because the first steps are small and have no history.
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
    let mut first = starting_stage(numbering, &start);
    if let Some(stretch) = &stretch {
        // Drives and loads are those of this instant.
        first.time = duration * stretch.from;
    }
    let models = (model, &real);
    let mut solver = Solver::new(
        (method, settings.solver),
        models,
        (numbering, &scheme),
        estimates,
    );
    let adaptive = matches!(settings.spacing, Spacing::Tolerance(_));
    if S::INFINITESIMAL && estimates && adaptive && settings.derivatives {
        solver.resolve_tangent();
    }
    let mut past = Past::new(numbering, first.clone(), (method, scheme.stages()));
    let mut inside = Stage::zero(numbering);
    let block = Block::new((numbering, &flexible::team(model)), first, scheme.stages());
    let memory = (settings.memory, block.room(method));
    let tape = trajectory::Tape::Implicit(Tape::new(block, memory, controller.steps()));
    let lambda = start.lambda.clone();
    let mut run = Trajectory::start(numbering.clone(), method, duration, start, tape);
    run.lambda = lambda;
    run.solver = settings.solver;
    run.grid = match &stretch {
        Some(stretch) => controller.growing().from(stretch.from),
        None => controller.growing(),
    };
    // A formula gives the motion only at the ends of its steps.
    let samples = match method {
        Method::Radau { .. } => settings.samples,
        _ => match settings.samples {
            Samples::Uniform(..=1) => settings.samples,
            Samples::StepEnds | Samples::Uniform(_) | Samples::Quadrature(_) => Samples::StepEnds,
        },
    };
    let intervals = controller.intervals(samples);
    run.has_cells = matches!(samples, Samples::Quadrature(_));
    // The history of adaptive steps grows with them.
    reserve(&mut run, controller.given(), samples);
    let mut next = 1;
    let mut motions = Vec::new();
    let watched =
        (model.joints.iter()).any(|joint| !joint.redundant.is_empty() || !joint.drives.is_empty());
    let choices = settings.spacing.left_out(&run.initial.left_out);
    let left_out = choices
        .first()
        .map_or(&run.initial.left_out, |(_, rows)| rows);
    solver.leave_out(left_out);
    run.grid.leave_out(left_out);
    // Only loops of joints have singular positions and redundant rows.
    let mut field = Accelerations::new(model, numbering);
    field.leave_out(left_out);
    let loops = field.closes_loops();
    let mut steadiness = Steadiness::new(numbering);
    let mut ledger = match stretch {
        Some(_) => None,
        None => Ledger::open(model, settings, &scale),
    };
    if let Some(ledger) = &mut ledger {
        BodyMotion::all(numbering, &past.from.q, &past.from.v, &mut motions);
        ledger.enter(model, &motions, 0.0);
    }
    let mut touches = Touches::open(
        model,
        numbering,
        (
            [&past.from.q, &past.from.v, &past.from.vdot],
            &settings.spacing,
        ),
    );
    while let Some(width) = controller.next(run.grid.reached()) {
        if let Some(stretch) = &stretch
            && stretch.is_over(run.counts.implicit_work())
        {
            break;
        }
        let begin = run.grid.reached();
        if (settings.limits.steps).is_some_and(|most| run.grid.steps() >= most) {
            return Err(IntegrationFailure::NoHeadway {
                time: run.time_reached(),
                duration: duration.re(),
                step: run.grid.steps() + 1,
                tries: run.grid.steps() + run.counts.rejected,
                rejected: run.counts.rejected,
                advance: run.time_reached(),
            });
        }
        let h = run.grid.size(duration, width, begin);
        let end = controller.end(begin, width);
        let k = run.grid.steps() + 1;
        let in_part = run.grid.in_part(k);
        let at = (k, duration.re() * end);
        let times = (run.grid.time(duration, begin), h);
        let count = match solver.step(&mut past, times, (in_part, at), &mut run.counts) {
            Ok(count) => count,
            Err(failure) if controller.give_up(false) => return Err(failure),
            Err(_) => {
                retry(&mut run, &mut solver, k);
                continue;
            }
        };
        let error = solver.error(&past.from, h.re(), &scale);
        if !controller.judge(error) {
            retry(&mut run, &mut solver, k);
            continue;
        }
        if let Some(touches) = &mut touches {
            let last = &solver.stages[count - 1];
            let ends = [&last.q[..], &last.v, &last.vdot];
            match touches.missed(model, numbering, ends, h.re()) {
                None => {}
                Some(missed) if controller.give_up_over(missed.part) => {
                    let (step, time) = at;
                    let load = missed.over.name(model);
                    return Err(IntegrationFailure::MissedContact { load, time, step });
                }
                Some(_) => {
                    retry(&mut run, &mut solver, k);
                    continue;
                }
            }
        }
        if loops {
            let last = &solver.stages[count - 1];
            field.set_state(&last.q, &last.v, last.time);
            let steady = match field.factorise() {
                Ok(()) => steadiness.of(&mut field, &scale),
                Err(_) => 0.0,
            };
            if steady > 0.0 && steadiness.magnified(steady) <= MOST_IMPLICIT {
                steadiness.see(end, steady);
            } else if controller.give_up(true) {
                let (step, time) = at;
                let drive = String::new();
                let failure = IntegrationFailure::SingularPosition { time, step, drive };
                return Err(failure.with_drive(model, &past.from.q));
            } else {
                retry(&mut run, &mut solver, k);
                continue;
            }
        }
        controller.accept();
        if let Some(touches) = &mut touches {
            touches.go_on();
        }
        let stages = &solver.stages[..count];
        let last = &stages[count - 1];
        let due = ledger.as_mut().filter(|_| Ledger::is_due(k));
        if watched || due.is_some() {
            BodyMotion::all(numbering, &last.q, &last.v, &mut motions);
        }
        if watched {
            watch(model, (&motions, last.time), k)?;
        }
        if let Some(ledger) = due {
            ledger.enter(model, &motions, at.1);
        }
        run.grid.push(end);
        let all = (&past.from, stages);
        let due = quadrature::due(samples, (&mut next, &intervals), run.grid.step(k));
        sample(&mut run, &scheme, all, (samples, due), &mut inside);
        if tape_of(&mut run).keeps(k) {
            tape_of(&mut run).block.push(&past.from, stages);
        }
        solver.remember(count, in_part);
        // Rows are exchanged only between steps, so that every step has smooth equations.
        let exchanged = match choices.is_empty() && loops {
            true => field.exchanged(EXCHANGE_WEIGHT),
            false => None,
        };
        let known = choices.iter().find(|(from, _)| *from == k + 1);
        if let Some(rows) = known.map(|(_, rows)| rows).or(exchanged.as_ref()) {
            field.leave_out(rows);
            solver.leave_out(rows);
            run.grid.leave_out(rows);
        }
        past.advance(h, &mut solver.stages, count);
        turns::count(model, numbering, &mut past.from.q);
        if tape_of(&mut run).is_due(k) {
            let state = (past.clone(), solver.memory.clone());
            let newton = solver.newton();
            tape_of(&mut run).leave(k, (state, newton));
        }
        if let Some(stretch) = &mut stretch {
            let work = run.counts.implicit_work();
            stretch.steps.push((work, run.grid.reached()));
        }
    }
    close(&mut run, &controller)?;
    if let Some(ledger) = &mut ledger {
        BodyMotion::all(numbering, &past.from.q, &past.from.v, &mut motions);
        ledger.enter(model, &motions, run.time_reached());
        ledger.close(run.grid.steps(), run.step_error)?;
    }
    solver.count(&mut run.counts);
    run.counts.factorisations += field.factorisations;
    run.counts.solves += field.solves;
    Ok(run)
}

/// Rejects step number k, so that another is tried.
fn retry<S: SolveScalar>(run: &mut Trajectory<S>, solver: &mut Solver<S>, k: usize) {
    run.counts.rejected += 1;
    solver.forget();
    tape_of(run).retry(k, solver.newton());
}

fn tape_of<S: SolveScalar>(run: &mut Trajectory<S>) -> &mut Tape<S> {
    let trajectory::Tape::Implicit(tape) = &mut run.tape else {
        unreachable!("the tape is that of an implicit method")
    };
    tape
}

/// Reserves memory for the samples of a run whose steps are known.
fn reserve<S: SolveScalar>(run: &mut Trajectory<S>, given: Option<&Grid>, samples: Samples) {
    if let Some(grid) = given {
        let steps = grid.steps();
        run.reserve(steps, samples.count(steps, Some(grid)));
    }
}
