//! The march of the explicit method over given or chosen steps.

use super::record::{Node, NodeView};
use super::step::{StepFailure, Stepper};
use super::stiffness::{Stiffness, Watch};
use super::tableau::{ORDER, STAGES};
use super::tape::{Block, Tape};
use crate::integrate::control::{Controller, Scale};
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::grid::{Place, place};
use crate::integrate::quadrature;
use crate::integrate::settings::{Method, Samples, Settings, Spacing};
use crate::integrate::trajectory::{self, Trajectory};
use crate::integrate::{close, watch};
use crate::linalg::{SingularMatrix, SolveScalar};
use crate::model::Model;
use crate::system::Numbering;
use crate::system::initial::InitialState;

/// Correction of the velocities, relative to their scale, that is none of the step's error.
const LOST: f64 = 0.01;

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
    let block = Block::new(numbering, settings.samples);
    let memory = (settings.memory, block.room());
    let tape = trajectory::Tape::Explicit(Tape::new(block, memory, controller.steps()));
    let mut run = Trajectory::start(numbering.clone(), Method::Dop853, duration, start, tape);
    run.grid = controller.growing();
    run.take_cells(&settings.spacing, settings.samples);
    // Kept steps were found good where they were chosen, and are judged by their error.
    let mut stiffness = match settings.spacing {
        Spacing::Frozen(_) => None,
        Spacing::Steps(_) => Some(Stiffness::new(Watch::Stability)),
        Spacing::Tolerance(_) => Some(Stiffness::new(watch_for)),
    };
    let (mut from, mut to) = (node.clone(), node);
    let mut next = 1;
    // The history of steps that are chosen on the way grows with them.
    reserve(&mut run, settings);
    while let Some(width) = controller.next(run.grid.reached()) {
        let h = duration * width;
        let end = controller.end(run.grid.reached(), width);
        let tried = stepper
            .stages(from.view(), (duration * run.grid.reached(), h))
            .map(|()| error(&mut stepper, &scale, from.view(), h))
            .and_then(|error| {
                let accepted = controller.judge(error);
                if accepted {
                    stepper.finish(&mut to, duration * end)?;
                    if leaves_branch(&mut stepper, &scale, from.view()) {
                        return Err(StepFailure::Projection);
                    }
                }
                Ok(accepted)
            });
        let number = run.grid.steps() + 1;
        run.counts.evaluations += STAGES;
        match tried {
            Ok(true) => {}
            Ok(false) => {
                run.counts.rejected += 1;
                tape_of(&mut run).retry(number, stepper.field.memory());
                continue;
            }
            Err(failure) if controller.give_up(failure != StepFailure::NotFinite) => {
                let time = duration.re() * end;
                return Err(failed(failure, (model, numbering), (number, time)));
            }
            Err(_) => {
                run.counts.rejected += 1;
                tape_of(&mut run).retry(number, stepper.field.memory());
                continue;
            }
        }
        controller.accept();
        // The equations were left standing at the end of the step.
        watch(model, (&stepper.field.motions, duration * end), number)?;
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
            settings,
            &mut next,
        )
        .map_err(|failure| failed(failure, (model, numbering), (number, duration.re() * end)))?;
        let tape = tape_of(&mut run);
        if tape.keeps(number) {
            tape.block
                .push([from.view(), to.view()], stepper.data.view());
        }
        if tape.is_due(number) {
            tape.leave(number, (to.clone(), stepper.field.memory()));
        }
        std::mem::swap(&mut from, &mut to);
    }
    close(&mut run, &controller)?;
    run.counts.factorisations += stepper.field.factorisations;
    run.counts.solves += stepper.field.solves;
    Ok(run)
}

/// Makes room for the history of a run whose steps are known.
fn reserve<S: SolveScalar>(run: &mut Trajectory<S>, settings: &Settings) {
    let (steps, grid) = match &settings.spacing {
        Spacing::Steps(steps) => (*steps, None),
        Spacing::Frozen(grid) => (grid.steps(), Some(grid)),
        Spacing::Tolerance(_) => return,
    };
    let samples = settings.samples.count(steps, grid);
    run.reserve(steps, samples);
}

fn tape_of<S: SolveScalar>(run: &mut Trajectory<S>) -> &mut Tape<S> {
    let trajectory::Tape::Explicit(tape) = &mut run.tape else {
        unreachable!("the tape is that of the explicit method")
    };
    tape
}

/// Adds the instants of the step that was just accepted.
fn sample<S: SolveScalar>(
    run: &mut Trajectory<S>,
    stepper: &mut Stepper<S>,
    (from, to): (NodeView<S>, NodeView<S>),
    settings: &Settings,
    next: &mut usize,
) -> Result<(), StepFailure> {
    let k = run.grid.steps();
    let h = run.duration * run.grid.width(k);
    let step = run.grid.step(k);
    if let Samples::Quadrature(_) = settings.samples {
        run.weigh_start(&step);
    }
    for due in quadrature::due(settings.samples, next, step) {
        let place = place(&run.grid, k, due.at);
        match place {
            Place::Node(_) => run.push(due, place, [to.q, to.v, to.a, &[]]),
            Place::Inside { theta, .. } => {
                if !stepper.data.dense {
                    let start = run.duration * run.grid.ends()[k - 1];
                    stepper.dense_stages((from, to), (start, h))?;
                    run.counts.evaluations += super::tableau::ALL - super::tableau::END - 1;
                }
                let [q, v, a] = stepper.inside(from, h, theta);
                run.push(due, place, [q, v, a, &[]]);
            }
        }
    }
    Ok(())
}

/// Estimated error of a step relative to the scene's scale (Hairer, Nørsett & Wanner 1993,
/// eq. II.10.17): |e5|² / √(|e5|² + 0.01 |e3|²).
fn error<S: SolveScalar>(stepper: &mut Stepper<S>, scale: &Scale, from: NodeView<S>, h: S) -> f64 {
    let numbering = stepper.field.numbering;
    let speeds = scale.speeds(numbering, from.v, &stepper.data.v_raw);
    let [e5, e3] = stepper.errors(h, |q, v| scale.square(numbering, q, v, speeds));
    let denominator = e5 + 0.01 * e3;
    if denominator == 0.0 {
        0.0
    } else {
        e5 / denominator.sqrt()
    }
}

/// Whether the projection takes away much of the velocities, as where branches of the motion meet and
/// the step ends on another than it came on: there it is no correction of the step's error.
fn leaves_branch<S: SolveScalar>(
    stepper: &mut Stepper<S>,
    scale: &Scale,
    from: NodeView<S>,
) -> bool {
    let numbering = stepper.field.numbering;
    let speeds = scale.speeds(numbering, from.v, &stepper.data.v_raw);
    let lost = stepper.velocity_correction(|q, v| scale.square(numbering, q, v, speeds));
    lost.sqrt() > LOST
}

/// The body or joint that an unknown of the index-1 equations belongs to.
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

/// What a step that could not be made is told as, with its number and the time of its end.
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
        StepFailure::NotFinite => IntegrationFailure::NotFinite {
            time,
            step,
            worst: "the explicit step".into(),
        },
    }
}
