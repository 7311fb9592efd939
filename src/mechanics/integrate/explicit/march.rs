//! The march of the explicit method over given or adaptive steps.

use super::record::{Node, NodeView};
use super::samples::sample;
use super::step::{StepFailure, Stepper};
use super::stiffness::{Stiffness, Watch};
use super::tableau::{ORDER, STAGES};
use super::tangent::Tangent;
use super::tape::{Block, Tape};
use crate::integrate::control::Controller;
use crate::integrate::energy::{Ledger, Supply};
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::grid::Grid;
use crate::integrate::quadrature;
use crate::integrate::quadrature::Samples;
use crate::integrate::scale::Scale;
use crate::integrate::settings::{Method, Settings, Spacing};
use crate::integrate::singular::{self, Steadiness};
use crate::integrate::touches::Touches;
use crate::integrate::trajectory::{self, Trajectory};
use crate::integrate::{close, watch};
use crate::linalg::{SingularMatrix, SolveScalar};
use crate::model::Model;
use crate::system::initial::InitialState;
use crate::system::redundant_rows::EXCHANGE_WEIGHT;
use crate::system::{BodyMotion, Numbering};

/// A correction of the velocities above this, relative to their scale, is no error of the step.
const LOST: f64 = 0.01;

/// Stages without weight see a force that the others miss if their accelerations change by more than this times those of the others.
const UNSEEN: f64 = 10.0;
/// A given step fails above this estimated error, relative to the scale.
const UNSTABLE: f64 = 0.1;
/// Fractions of a step at which the constraints are checked, and their largest violation: relative
/// to the allowed error of steps, for adaptive and for given steps. The allowed error is at least
/// the last.
const LOOKED_AT: [f64; 2] = [0.2, 0.75];
const OPEN: f64 = 100.0;
/// By so many times the tolerance of rounded rows may joints open where others are imposed instead.
const JUMP: f64 = 100.0;
const OPEN_GIVEN: f64 = 1e3;
const LEAST_ERROR: f64 = 1e-10;

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
    watch_for: Watch,
) -> Result<Trajectory<S>, IntegrationFailure> {
    let mut stepper = Stepper::new(model, numbering);
    let node = Node {
        q: start.q.clone(),
        v: start.v.clone(),
        a: start.a.clone(),
        lambda: start.lambda.clone(),
    };
    let scale = Scale::of(model, numbering, &start, duration.re());
    let mut controller = Controller::new(settings, ORDER, &scale, (model, duration.re()));
    let equal = settings.spacing.is_equal();
    let leap = stepper.field.closes_loops() && !equal;
    let block = Block::new(numbering, settings.samples, leap);
    let memory = (settings.memory, block.room());
    let tape = trajectory::Tape::Explicit(Tape::new(block, memory, controller.steps()));
    let mut run = Trajectory::start(numbering.clone(), Method::Dop853, duration, start, tape);
    run.grid = controller.growing();
    let intervals = controller.intervals(settings.samples);
    run.has_cells = matches!(settings.samples, Samples::Quadrature(_));
    let mut steadiness = Steadiness::new(numbering);
    let given = !matches!(settings.spacing, Spacing::Tolerance(_));
    let most = singular::most(match settings.spacing {
        Spacing::Tolerance(tolerance) => Some(tolerance),
        Spacing::Steps(_) | Spacing::Frozen(_) => None,
    });
    // Frozen steps were not stiff when they were chosen. Their error is checked instead.
    let flexible = !model.flexible.is_empty();
    let mut stiffness = match settings.spacing {
        Spacing::Steps(_) | Spacing::Frozen(_) if equal => {
            Some(Stiffness::new(Watch::Stability, flexible, false))
        }
        Spacing::Steps(_) | Spacing::Frozen(_) => None,
        Spacing::Tolerance(_) => {
            let tangent = settings.derivatives;
            Some(Stiffness::new(watch_for, flexible, tangent))
        }
    };
    let (mut from, mut to) = (node.clone(), node);
    let mut next = 1;
    let choices = settings.spacing.left_out(&run.initial.left_out);
    let left_out = choices
        .first()
        .map_or(&run.initial.left_out, |(_, rows)| rows);
    stepper.field.leave_out(left_out);
    run.grid.leave_out(left_out);
    // The history of adaptive steps grows with them.
    reserve(&mut run, controller.given(), settings.samples);
    if stepper.field.closes_loops() {
        let before = stepper.field.memory();
        stepper.field.set_state(&from.q, &from.v, duration * 0.0);
        if stepper.field.factorise().is_ok() {
            let steady = steadiness.of(&mut stepper.field, &scale);
            steadiness.see(0.0, steady);
        }
        // Replayed steps begin without this factorisation.
        stepper.field.restore(&before);
    }
    let mut tangent = match settings.spacing {
        Spacing::Tolerance(tolerance) if settings.derivatives => Some(Tangent::new(
            (model, numbering),
            &scale,
            from.view(),
            stepper.field.left_out(),
            tolerance,
        )),
        Spacing::Tolerance(_) | Spacing::Steps(_) | Spacing::Frozen(_) => None,
    };
    if let Some(tangent) = &tangent {
        controller.resolve(tangent.largest_step() / duration.re());
    }
    let mut ledger = Ledger::open(model, settings, &scale);
    let mut motions = Vec::new();
    if let Some(ledger) = &mut ledger {
        BodyMotion::all(numbering, &from.q, &from.v, &mut motions);
        ledger.enter(model, &motions, 0.0);
    }
    let mut supply = match (S::INFINITESIMAL, equal) {
        (false, false) => {
            stepper.field.set_state(&from.q, &from.v, duration * 0.0);
            let power = stepper.field.supplied_power(&from.v, &from.lambda);
            let at = (&stepper.field.motions[..], power);
            Supply::open(model, settings, &scale, at)
        }
        _ => None,
    };
    let mut touches = {
        let start = [&from.q[..], &from.v, &from.a];
        Touches::open(model, numbering, (start, &settings.spacing))
    };
    while let Some(width) = controller.next(run.grid.reached()) {
        let begin = run.grid.reached();
        let h = run.grid.size(duration, width, begin);
        let start = run.grid.time(duration, begin);
        let end = controller.end(begin, width);
        let end_time = run.grid.time(duration, end);
        let mut exchanged = None;
        let tried = stepper
            .stages(from.view(), (start, h))
            .map(|()| {
                let [smooth, kinked] = errors(&mut stepper, &scale, from.view(), h);
                let Some(touches) = &touches else {
                    return smooth;
                };
                let last_stage = (&stepper.field.motions[..], (start + h).re());
                let error = match !given && touches.change(model, last_stage) {
                    true => kinked,
                    false => smooth,
                };
                error.max(unweighted(&mut stepper, &scale, from.view(), h))
            })
            .and_then(|error| {
                // The tolerance judges steps that may be replaced by others.
                if given && (error > UNSTABLE || error.is_nan()) {
                    return Err(StepFailure::Inaccurate(error));
                }
                if !controller.judge(error) {
                    return Ok(None);
                }
                stepper.finish(&mut to, end_time)?;
                let looked = touches.as_mut();
                let ends = [&to.q[..], &to.v, &to.a];
                if let Some(missed) = looked.and_then(|t| t.missed(model, numbering, ends, h.re()))
                {
                    return Err(StepFailure::Missed(missed));
                }
                if !stepper.field.closes_loops() {
                    return Ok(Some(f64::INFINITY));
                }
                if leaves_branch(&mut stepper, &scale, from.view()) {
                    return Err(StepFailure::Projection);
                }
                let steady = steadiness.of(&mut stepper.field, &scale);
                let ahead = steadiness.foresee(end, steady);
                let close = ahead.filter(|&at| steadiness.too_close(end, at));
                if let Some(at) = close.filter(|_| controller.may_keep_away()) {
                    return Err(StepFailure::Close(at));
                }
                let errs = equal && steadiness.errs(steady, error, controller.largest_error());
                if steadiness.magnified(steady) > most || errs {
                    return Err(StepFailure::Close(ahead.unwrap_or(end)));
                }
                // Use the matrix at the end of the step, before those inside it.
                if choices.is_empty() {
                    exchanged = stepper.field.exchanged(EXCHANGE_WEIGHT);
                }
                let cells = run.grid.cells(run.grid.steps() + 1);
                if quadrature::looks_inside(settings.samples, (next, &intervals), (end, cells)) {
                    stepper.dense_stages((from.view(), to.view()), (start, h))?;
                    let error = controller.allowed().max(LEAST_ERROR);
                    let open = open(&mut stepper, &scale, from.view(), (start, h));
                    let slack = JUMP * model.slack();
                    let limit = slack.max(error * if given { OPEN_GIVEN } else { OPEN });
                    if open > limit || open.is_nan() {
                        return Err(StepFailure::Open);
                    }
                    stepper.field.set_state(&to.q, &to.v, end_time);
                }
                Ok(Some(steady))
            });
        let number = run.grid.steps() + 1;
        run.counts.evaluations += STAGES;
        let gives_up = match tried {
            Ok(Some(_)) => false,
            Ok(None) => {
                run.counts.rejected += 1;
                tape_of(&mut run).retry(number, stepper.field.memory());
                continue;
            }
            Err(StepFailure::Close(at)) => controller.give_up_near(at),
            Err(StepFailure::Missed(missed)) => controller.give_up_over(missed.part),
            Err(failure) => controller.give_up(failure != StepFailure::NotFinite),
        };
        let steady = match tried {
            Ok(steady) => steady.unwrap_or(f64::INFINITY),
            Err(failure) if gives_up => {
                let time = duration.re() * end;
                let failure = failed(failure, (model, numbering), (number, time));
                return Err(failure.with_drive(model, &from.q));
            }
            Err(_) => {
                run.counts.rejected += 1;
                tape_of(&mut run).retry(number, stepper.field.memory());
                continue;
            }
        };
        controller.accept();
        if let Some(touches) = &mut touches {
            touches.go_on();
        }
        if stepper.data.dense {
            run.counts.evaluations += super::tableau::ALL - super::tableau::END - 1;
        }
        if steady.is_finite() {
            let ahead = steadiness.foresee(end, steady);
            steadiness.see(end, steady);
            controller.expect(steadiness.magnified(steady), ahead);
        }
        // The equations are still evaluated at the end of the step.
        watch(model, (&stepper.field.motions, end_time), number)?;
        if let Some(ledger) = ledger.as_mut().filter(|_| Ledger::is_due(number)) {
            ledger.enter(model, &stepper.field.motions, duration.re() * end);
        }
        let power = match &mut supply {
            Some(supply) => {
                let power = stepper.field.supplied_power(&to.v, &to.lambda);
                let at = (&stepper.field.motions[..], power);
                supply.look(model, at, (duration.re() * end, number))?;
                power
            }
            None => 0.0,
        };
        let sampled = run.last() + 1;
        run.grid.push(end);
        if let Some(stiffness) = &mut stiffness
            && stiffness.seen(&mut stepper, &scale, to.view(), (h.re(), &run))
            && let Some(share) = stiffness.decides((model, numbering), settings, to.view(), &run)
        {
            return Err(IntegrationFailure::Stiff {
                time: duration.re() * end,
                step: number,
                share,
            });
        }
        sample(
            &mut run,
            &mut stepper,
            (from.view(), to.view()),
            settings.samples,
            (&mut next, &intervals),
        )
        .map_err(|failure| failed(failure, (model, numbering), (number, duration.re() * end)))?;
        // At the border of stability stiff modes may burst between the ends of steps, which stay tame.
        if let Some(supply) = supply.as_mut().filter(|_| flexible) {
            for k in sampled..=run.last() {
                BodyMotion::all(numbering, run.q(k), run.v(k), &mut motions);
                let at = (duration.re() * end, number);
                supply.look(model, (&motions, power), at)?;
            }
        }
        let tape = tape_of(&mut run);
        if tape.keeps(number) {
            tape.block
                .push([from.view(), to.view()], stepper.data.view());
        }
        if tape.is_due(number) {
            tape.leave(number, (to.clone(), stepper.field.memory()));
        }
        std::mem::swap(&mut from, &mut to);
        // Rows are exchanged only between steps, so that every step has smooth equations.
        let known = choices.iter().find(|(from, _)| *from == number + 1);
        if let Some(rows) = known.map(|(_, rows)| rows).or(exchanged.as_ref()) {
            stepper.field.leave_out(rows);
        }
        run.grid.leave_out(stepper.field.left_out());
        if let Some(tangent) = &mut tangent {
            let magnified = match steady.is_finite() {
                true => steadiness.magnified(steady),
                false => 1.0,
            };
            let at = (from.view(), duration * end);
            let left_out = stepper.field.left_out();
            tangent.renew(at, &scale, left_out, (number, magnified));
            controller.resolve(tangent.largest_step() / duration.re());
        }
    }
    if let Some(tangent) = &tangent {
        let [factorisations, solves] = tangent.work();
        run.counts.evaluations += tangent.evaluations;
        run.counts.factorisations += factorisations;
        run.counts.solves += solves;
    }
    run.stiffness = stiffness.map(|own| own.measured);
    close(&mut run, &controller)?;
    if let Some(ledger) = &mut ledger {
        BodyMotion::all(numbering, &from.q, &from.v, &mut motions);
        ledger.enter(model, &motions, run.time_reached());
        ledger.close(run.grid.steps(), run.step_error)?;
    }
    run.counts.factorisations += stepper.field.factorisations;
    run.counts.solves += stepper.field.solves;
    Ok(run)
}

/// Reserves memory for the history of a run whose steps are known.
fn reserve<S: SolveScalar>(run: &mut Trajectory<S>, given: Option<&Grid>, samples: Samples) {
    if let Some(grid) = given {
        let steps = grid.steps();
        run.reserve(steps, samples.count(steps, Some(grid)));
    }
}

fn tape_of<S: SolveScalar>(run: &mut Trajectory<S>) -> &mut Tape<S> {
    let trajectory::Tape::Explicit(tape) = &mut run.tape else {
        unreachable!("the tape is that of the explicit method")
    };
    tape
}

/// Violation of the constraints inside the step, relative to the scene's scale.
fn open<S: SolveScalar>(
    stepper: &mut Stepper<S>,
    scale: &Scale,
    from: NodeView<S>,
    (start, h): (S, S),
) -> f64 {
    let speeds = scale.speeds(stepper.field.numbering, from.v, &stepper.data.v_raw);
    let [a, b] =
        LOOKED_AT.map(|theta| stepper.open(from, (h, theta), start + h * theta, speeds.of_bodies));
    if a.is_nan() || a > b { a } else { b }
}

/// Estimated error of a step relative to the scene's scale (Hairer, Nørsett & Wanner 1993,
/// eq. II.10.17): |e5|² / √(|e5|² + 0.01 |e3|²), and that of a step in which a force sets in or lets go: √(|e5|² + 0.01 |e3|²).
/// There e3 is not larger than e5 by an order of h², and the first estimate vanishes by chance where e5 does.
fn errors<S: SolveScalar>(
    stepper: &mut Stepper<S>,
    scale: &Scale,
    from: NodeView<S>,
    h: S,
) -> [f64; 2] {
    let numbering = stepper.field.numbering;
    let speeds = scale.speeds(numbering, from.v, &stepper.data.v_raw);
    let [e5, e3] = stepper.errors(h, |q, v| scale.square(numbering, q, v, &speeds));
    let both = (e5 + 0.01 * e3).sqrt();
    match both == 0.0 {
        true => [0.0, 0.0],
        false => [e5 / both, both],
    }
}

/// The change of velocity by what stages without weight have met and all others have not; 0 if these have met it too. A contact that
/// throws off the stages that meet it leaves no other trace in the step.
fn unweighted<S: SolveScalar>(
    stepper: &mut Stepper<S>,
    scale: &Scale,
    from: NodeView<S>,
    h: S,
) -> f64 {
    let numbering = stepper.field.numbering;
    let speeds = scale.speeds(numbering, from.v, &stepper.data.v_raw);
    let [without, with] = stepper.changes(h, |q, v| scale.square(numbering, q, v, &speeds));
    match without > UNSEEN * UNSEEN * with {
        true => without.sqrt(),
        false => 0.0,
    }
}

/// Whether the projection removes a large part of the velocities. This happens where branches of
/// the motion meet and the step changes to another branch; it is no correction of the step's error.
fn leaves_branch<S: SolveScalar>(
    stepper: &mut Stepper<S>,
    scale: &Scale,
    from: NodeView<S>,
) -> bool {
    let numbering = stepper.field.numbering;
    let speeds = scale.speeds(numbering, from.v, &stepper.data.v_raw);
    let lost = stepper.velocity_correction(|q, v| scale.square(numbering, q, v, &speeds));
    lost.sqrt() > LOST
}

/// The body or joint of an unknown of the index-1 equations.
fn describe<S>(model: &Model<S>, numbering: &Numbering, singular: SingularMatrix) -> String {
    let nv = numbering.velocities();
    match singular.column {
        i if i < nv => {
            let body = &model.bodies[numbering.body_of_velocity(i)];
            format!("the dynamics of body \"{}\"", body.name)
        }
        i => {
            let joint = &model.joints[numbering.joint_of_row(i - nv)];
            format!("the constraints of joint \"{}\"", joint.name)
        }
    }
}

/// The failure of a step as an [`IntegrationFailure`], with its number and the time of its end.
pub fn failed<S: SolveScalar>(
    failure: StepFailure,
    (model, numbering): (&Model<S>, &Numbering),
    (step, time): (usize, f64),
) -> IntegrationFailure {
    match failure {
        StepFailure::Singular(singular) => IntegrationFailure::Singular {
            time,
            step,
            place: describe(model, numbering, singular),
        },
        StepFailure::Projection => IntegrationFailure::Projection { time, step },
        StepFailure::Close(_) => IntegrationFailure::SingularPosition {
            time,
            step,
            drive: String::new(),
        },
        StepFailure::Open => IntegrationFailure::Opened { time, step },
        StepFailure::Inaccurate(error) => IntegrationFailure::Unstable { time, step, error },
        StepFailure::Missed(missed) => IntegrationFailure::MissedContact {
            load: missed.over.name(model),
            time,
            step,
        },
        StepFailure::NotFinite => IntegrationFailure::NotFinite {
            time,
            step,
            worst: "the explicit step".into(),
        },
    }
}
