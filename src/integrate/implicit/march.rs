//! The march of the implicit methods.

use super::formula::{Formula, memory_size, remembers_start};
use super::newton::Newton;
use super::predict::{Past, dense, predict, predict_stages, taylor};
use super::radau::Scheme;
use super::stage_newton::StageNewton;
use super::{Stage, Tape};
use crate::integrate::control::{Controller, Scale};
use crate::integrate::failure::IntegrationFailure;
use crate::integrate::grid::{Place, place};
use crate::integrate::settings::{Method, Samples, Settings};
use crate::integrate::trajectory::{self, Trajectory};
use crate::integrate::{close, watch};
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::initial::InitialState;
use crate::system::{Motion, Numbering, bodies, joints};
use std::collections::VecDeque;

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
    let method = settings.method;
    let real: Model<f64> = model.map(&mut |x| x.re());
    let scheme = Scheme::of(method);
    let scale = Scale::of(model, numbering, &start, duration.re());
    let mut controller = Controller::new(
        &settings.spacing,
        scheme.stages() + 1,
        &scale,
        (model, duration.re()),
    );
    let estimates = controller.estimates() && method.is_adaptive();
    let mut solver = Solver {
        method,
        numbering,
        scheme: &scheme,
        one: None,
        coupled: None,
        model,
        real: &real,
        field: estimates.then(|| Accelerations::new(&real, numbering)),
        memory: Vec::new(),
    };
    let first = starting_stage(numbering, &start);
    let tape = trajectory::Tape::Implicit(Tape {
        start: first.clone(),
        steps: Vec::new(),
    });
    let lambda = start.lambda.clone();
    let mut run = Trajectory::start(numbering.clone(), method, duration, start, tape);
    run.lambda = lambda;
    let mut past = Past {
        from: first,
        before: None,
        recent: VecDeque::new(),
    };
    // A formula knows its motion at the ends of its steps only.
    let samples = match method {
        Method::Radau { .. } => settings.samples,
        _ => Samples::StepEnds,
    };
    let mut next = 1;
    let mut motions = Vec::new();
    let watched =
        (model.joints.iter()).any(|joint| !joint.left_out.is_empty() || !joint.drives.is_empty());
    while let Some(width) = controller.next(run.grid.reached()) {
        let h = duration * width;
        let end = controller.end(run.grid.reached(), width);
        let k = run.grid.steps() + 1;
        let at = (k, duration.re() * end);
        let start = duration * run.grid.reached();
        let made = solver.step(&past, (start, h), at, &mut run.counts);
        let stages = match made {
            Ok(stages) => stages,
            Err(failure) if controller.give_up(false) => return Err(failure),
            Err(_) => {
                run.counts.rejected += 1;
                continue;
            }
        };
        let error = solver.error(&past.from, &stages, h.re(), &scale);
        if !controller.judge(error) {
            run.counts.rejected += 1;
            continue;
        }
        controller.accept();
        if watched {
            let last = &stages[stages.len() - 1];
            Motion::all(numbering, &last.q, &last.v, &mut motions);
            watch(model, (&motions, last.time), k)?;
        }
        solver.remember(&stages, k);
        run.grid.push(end);
        sample(&mut run, &scheme, &past.from, &stages, samples, &mut next);
        past.from = stages[stages.len() - 1].clone();
        if method.is_adaptive() || stages.len() > 1 {
            past.before = Some((h, stages.clone()));
        } else {
            past.before = None;
        }
        if !method.is_adaptive() {
            past.recent.truncate(2);
            past.recent.push_front(past.from.clone());
        }
        let trajectory::Tape::Implicit(tape) = &mut run.tape else {
            unreachable!("the tape is that of an implicit method")
        };
        tape.steps.push(stages);
    }
    close(&mut run, &controller)?;
    if let Some(field) = &solver.field {
        run.counts.factorisations += field.factorisations;
        run.counts.solves += field.solves;
    }
    Ok(run)
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

/// Something of the positions and of the velocities.
type Pair<S> = (Vec<S>, Vec<S>);

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
    /// True rates at the start of a step, for the error estimate.
    field: Option<Accelerations<'a, f64>>,
    /// Memory of a formula, pairs of (q, v) vectors.
    memory: Vec<Pair<S>>,
}

impl<S: SolveScalar> Solver<'_, S> {
    /// Stages of step `at.0` of size `h`.
    fn step(
        &mut self,
        past: &Past<S>,
        (start, h): (S, S),
        at: (usize, f64),
        counts: &mut trajectory::WorkCounts,
    ) -> Result<Vec<Stage<S>>, IntegrationFailure> {
        let Some(formula) = Formula::of_step(self.method, at.0) else {
            let mut stages = predict_stages(self.numbering, self.scheme, past, h);
            for (stage, &c) in stages.iter_mut().zip(&self.scheme.nodes) {
                stage.hold(self.numbering, &past.from);
                stage.time = start + h * c;
            }
            let (model, real, numbering) = (self.model, self.real, self.numbering);
            let (scheme, estimates) = (self.scheme, self.field.is_some());
            self.coupled
                .get_or_insert_with(|| StageNewton::new(model, real, numbering, scheme, estimates))
                .solve(&mut stages, h, at, counts)?;
            return Ok(stages);
        };
        if at.0 == 1 && remembers_start(self.method) {
            let scaled = |rates: &[S]| -> Vec<S> { rates.iter().map(|&x| x * h).collect() };
            let first = (scaled(&past.from.qdot), scaled(&past.from.vdot));
            self.memory = vec![first; memory_size(self.method)];
        }
        let mut stage = predict(self.numbering, past, h);
        stage.hold(self.numbering, &past.from);
        stage.time = start + h;
        // h ẏ = c Δ + Σ e_j m_j.
        let (mut qdot, mut vdot) = (
            vec![S::zero(); stage.q.len()],
            vec![S::zero(); stage.v.len()],
        );
        for (e, (mq, mv)) in formula.past.iter().zip(&self.memory) {
            let e = S::from(*e) / h;
            qdot.iter_mut().zip(mq).for_each(|(out, &m)| *out += e * m);
            vdot.iter_mut().zip(mv).for_each(|(out, &m)| *out += e * m);
        }
        let history = super::newton::History {
            c: S::from(formula.lead) / h,
            qdot,
            vdot,
        };
        let (model, numbering) = (self.model, self.numbering);
        let newton = self
            .one
            .get_or_insert_with(|| Newton::new(model, numbering));
        newton
            .solve(&mut stage, &history, h, at, counts)
            .or_else(|_| {
                // An extrapolation over steps that are large for the motion may lead astray.
                stage = taylor(numbering, &past.from, h);
                stage.hold(numbering, &past.from);
                stage.time = start + h;
                newton.forget();
                newton.solve(&mut stage, &history, h, at, counts)
            })?;
        Ok(vec![stage])
    }

    /// Moves the memory past step k.
    fn remember(&mut self, stages: &[Stage<S>], k: usize) {
        let last = &stages[stages.len() - 1];
        let Some(formula) = Formula::of_step(self.method, k) else {
            // Increments that a formula to come starts from, newest first.
            if memory_size(self.method) > 0 {
                self.memory.insert(0, (last.dq.clone(), last.dv.clone()));
            }
            return;
        };
        let combine = |pick: fn(&Pair<S>) -> &Vec<S>, delta: &[S], row: &(f64, Vec<f64>)| {
            let mut out: Vec<S> = delta.iter().map(|&d| d * row.0).collect();
            for (&f, m) in row.1.iter().zip(&self.memory) {
                if f != 0.0 {
                    out.iter_mut()
                        .zip(pick(m))
                        .for_each(|(out, &m)| *out += m * f);
                }
            }
            out
        };
        self.memory = formula
            .memory
            .iter()
            .map(|row| {
                (
                    combine(|m| &m.0, &last.dq, row),
                    combine(|m| &m.1, &last.dv, row),
                )
            })
            .collect();
    }

    /// Estimated error of a step relative to the scene's scale; zero without an estimate.
    fn error(&mut self, from: &Stage<S>, stages: &[Stage<S>], h: f64, scale: &Scale) -> f64 {
        let (Some(coupled), Some(field)) = (&mut self.coupled, &mut self.field) else {
            return 0.0;
        };
        let start = from.real();
        let numbering = self.numbering;
        let (mut qdot, mut a) = (vec![0.0; start.q.len()], vec![0.0; start.v.len()]);
        let mut lambda = vec![0.0; start.lambda.len()];
        bodies::rates(numbering, &start.q, &start.v, &mut qdot);
        field.stand(&start.q, &start.v, start.time);
        if field.factorise().is_err() {
            return f64::NAN;
        }
        field.accelerations(&mut a, &mut lambda);
        let found = coupled.error(stages, (&qdot, &a), h);
        let nv = a.len();
        let end: Vec<f64> = stages[stages.len() - 1].v.iter().map(|x| x.re()).collect();
        let speeds = scale.speeds(numbering, &start.v, &end);
        let error = scale
            .tangent_square(&found[..nv], &found[nv..], h, speeds)
            .sqrt();
        if self.real.joints.iter().all(|joint| joint.drives.is_empty()) {
            return error;
        }
        let stages: Vec<Stage<f64>> = stages.iter().map(Stage::real).collect();
        error.max(self.drift(&start, &stages, h, (scale, speeds)))
    }

    /// How far the middle of a step is off the joints, relative to the scene's scale. The stages are
    /// on them: motion that is prescribed has no other error to be seen.
    fn drift(
        &self,
        from: &Stage<f64>,
        stages: &[Stage<f64>],
        h: f64,
        (scale, speeds): (&Scale, [f64; 2]),
    ) -> f64 {
        let mut middle = dense(self.scheme, from, stages, h, 0.5);
        let (model, numbering) = (self.real, self.numbering);
        bodies::bring_to_unit(numbering, &mut middle.q);
        let mut motions = Vec::new();
        Motion::all(numbering, &middle.q, &middle.v, &mut motions);
        let at = (&motions[..], from.time + 0.5 * h);
        let mut rows = vec![0.0; numbering.constraints()];
        let largest = |rows: &[f64]| rows.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        joints::values(model, numbering, at, &mut rows);
        let open = largest(&rows) / scale.length;
        joints::rates(model, numbering, at, &mut rows);
        open.max(largest(&rows) / speeds[0])
    }
}

/// Adds the instants of the step that was just accepted.
fn sample<S: SolveScalar>(
    run: &mut Trajectory<S>,
    scheme: &Scheme,
    from: &Stage<S>,
    stages: &[Stage<S>],
    samples: Samples,
    next: &mut usize,
) {
    let k = run.grid.steps();
    let h = run.duration * run.grid.width(k);
    let last = &stages[stages.len() - 1];
    for at in trajectory::due(samples, next, run.grid.reached()) {
        let place = place(&run.grid, k, at);
        match place {
            Place::Node(_) => run.push(at, place, [&last.q, &last.v, &last.vdot, &last.lambda]),
            Place::Inside { theta, .. } => {
                let mut inside = dense(scheme, from, stages, h, theta);
                bodies::bring_to_unit(&run.numbering, &mut inside.q);
                let Stage {
                    q, v, vdot, lambda, ..
                } = &inside;
                run.push(at, place, [q, v, vdot, lambda]);
            }
        }
    }
}
