//! What lowering removes from a problem's scenes, and what remains.

use super::analysed::{AnalysisFailure, phases};
use super::bases;
use super::evaluate::{Derivative, Evaluated};
use super::integration::{Integration, looks_at_the_whole};
use super::{memory, stretch};
use crate::functions::Scene;
use crate::integrate::implicit::cost::factor_cost;
use crate::integrate::implicit::krylov::PRODUCTS_OF_FACTORS;
use crate::integrate::{IntegrationFailure, LinearSolver, Method, Trajectory};
use crate::model::{Mobility, Model};
use crate::problem::Problem;
use crate::report::{Explanation, FunctionUse, IntegrationUse, LinearUse, SystemSize};
use crate::system::accelerations::{self, FallbackReason};
use crate::system::left_out::listed;
use crate::system::{Numbering, placement};

/// The motion of a problem's start, or a stretch of it.
struct MotionExplanation {
    at: Evaluated,
    reason: String,
    /// Its part of the whole if it is a stretch; steps and samples are those of the whole.
    part: Option<f64>,
    steps: usize,
    samples: usize,
}

impl MotionExplanation {
    /// Simulates the start, or a first stretch that takes little time.
    fn of(problem: &Problem, x: &[f64], which: &[usize]) -> Result<Self, IntegrationFailure> {
        let x = x.to_vec();
        let mut scene = problem.scene(&x);
        let mut integration = Integration::new(problem, &scene, Some(which), true);
        memory::admit(&scene.model, &integration.wanted())?;
        if let Some(stretch) = stretch::of_long(&scene, &integration)? {
            scene.duration *= stretch.part;
            let run = stretch.run;
            return Ok(Self {
                at: Evaluated {
                    x,
                    scene,
                    run,
                    composition: problem.composition.clone(),
                },
                reason: stretch.reason,
                part: Some(stretch.part),
                steps: stretch.steps,
                samples: stretch.samples,
            });
        }
        let (at, _) = Evaluated::with(&mut integration, problem, &x)?;
        let reason = integration.chosen().map_or("", |(_, reason)| reason);
        Ok(Self {
            reason: reason.into(),
            part: None,
            steps: at.run.grid.steps(),
            samples: at.run.last(),
            at,
        })
    }

    /// Derivatives of all functions. None for a stretch that ends before the event.
    fn derivatives(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Option<Result<Vec<Vec<Derivative>>, IntegrationFailure>> {
        if self.part.is_some() && self.at.scene.until.is_some() {
            return None;
        }
        let found = self.at.derivatives(problem, which);
        Some(found.map(|(found, _)| found))
    }

    fn used(&self, problem: &Problem) -> IntegrationUse {
        let run = &self.at.run;
        let [samples_bytes, tape_bytes] = run.bytes();
        let (schedule, foreseen) = run.checkpoint_plan(self.steps);
        let each = samples_bytes as f64 / (run.last() + 1) as f64;
        IntegrationUse {
            method: run.method.name(),
            reason: self.reason.clone(),
            merged: merged_errs(problem, &self.at).map(Into::into),
            steps: self.steps,
            samples_bytes: (each * (self.samples + 1) as f64) as usize,
            tape_bytes: match self.part {
                None => tape_bytes,
                Some(_) => foreseen,
            },
            linear: linear(&self.at),
            factorisations: run.counts.factorisations,
            newton_iterations: run.counts.newton_iterations,
            recomputed: schedule.recomputed(),
            stretch: self.part,
        }
    }
}

/// How the linear systems of a motion with finite elements are solved, if it has any.
fn linear(at: &Evaluated) -> Option<LinearUse> {
    let (model, run) = (&at.scene.model, &at.run);
    if let Method::Dop853 = run.method {
        return None;
    }
    let cost = factor_cost(model, run)?;
    let (solver, reason) = match (run.solver.linear, run.method) {
        (LinearSolver::Krylov, _) => (
            "Krylov with kept factors",
            format!("as the problem says; new factors count as {PRODUCTS_OF_FACTORS} products"),
        ),
        (LinearSolver::Direct, Method::Radau { .. }) => (
            "direct",
            "the stages are coupled; the cost is that of a stage alone".into(),
        ),
        (LinearSolver::Direct, _) => (
            "direct",
            format!(
                "new factors cost about {PRODUCTS_OF_FACTORS} Krylov products, as measured for plates, and kept \
                 factors serve several steps"
            ),
        ),
    };
    Some(LinearUse {
        solver: solver.into(),
        reason,
        unknowns: cost.unknowns,
        entries: cost.entries,
        factors: cost.factors,
        operations: cost.operations,
        krylov_products: run.counts.products,
    })
}

/// Explains the start of `problem`. The start is simulated with its gradients if possible. Parts
/// that an optimisation leaves out because neither objective nor constraint observes them (no
/// function, if there is no objective) are left out here too. Of a long motion only the first
/// stretch is simulated.
pub fn explain(problem: &Problem) -> Explanation {
    let all: Vec<usize> = (0..problem.function_names.len()).collect();
    let focused = match problem.objective {
        Some(_) => problem.for_optimisation(),
        None => problem.focused(&all),
    };
    let whole = problem.unlowered_scene::<f64>(&problem.start());
    let model = &whole.model;
    let seen = focused.as_ref().and_then(|focused| {
        let seen = &focused.focus.as_ref()?.seen;
        (!seen.keeps_all(model)).then_some((focused, seen))
    });
    let Some((focused, seen)) = seen else {
        return explain_seen(problem, &problem.start());
    };
    let mut found = explain_seen(focused, &focused.start());
    let unseen: Vec<String> = (model.bodies.iter().enumerate())
        .filter(|(body, _)| !seen.keeps(*body))
        .map(|(_, body)| format!("\"{}\"", body.name))
        .collect();
    let (bodies, they) = match unseen.len() {
        1 => ("body", "it"),
        _ => ("bodies", "them"),
    };
    let told = match unseen.len().saturating_sub(TOLD) {
        0 => unseen.join(", "),
        more => format!("{} and {more} more", unseen[..TOLD].join(", ")),
    };
    let who = match problem.objective {
        Some(_) => "neither the objective nor a constraint",
        None => "no function",
    };
    let line = format!("{bodies} {told} with their joints: {who} depends on {they}");
    found.left_out.insert(0, line);
    (found.bodies, found.joints) = (problem.body_count(), problem.joint_count());
    found.loads = model.loads.len();
    found.written = size(model, placement::guess(model));
    let mut known = found.functions;
    let use_of = |(f, name): (usize, &String)| match known.iter().position(|own| own.name == *name)
    {
        Some(place) => known.swap_remove(place),
        None => FunctionUse {
            name: name.clone(),
            used: String::new(),
            whole_motion: sees_all(problem, &whole, f),
            variables: None,
        },
    };
    found.functions = (problem.function_names.iter().enumerate())
        .map(use_of)
        .collect();
    found
}

/// Explains the phases of a motion that events divide, each from the state with which it begins.
///
/// # Errors
/// If a phase fails.
pub fn explain_phases(problem: &Problem) -> Result<Vec<Explanation>, AnalysisFailure> {
    let Some(cases) = &problem.cases else {
        return Ok(Vec::new());
    };
    let of = |_: usize, own: &Problem, x: &[f64]| {
        let at = Evaluated::new(own, x)?;
        Ok((at, explain_seen(own, x)))
    };
    let found = phases::each(cases, &problem.start(), of, |(at, _)| Some(at))?;
    Ok(found.into_iter().flatten().map(|own| own.1).collect())
}

/// Explains a problem with all its bodies simulated.
fn explain_seen(problem: &Problem, x: &[f64]) -> Explanation {
    let written = problem.unlowered_scene(x).model;
    let scene = problem.scene(x);
    let (left_out, kept) = lowering(problem, &written, &scene.model);
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let motion = MotionExplanation::of(problem, x, &which);
    let found = match &motion {
        Ok(motion) => motion.derivatives(problem, &which),
        Err(failure) => Some(Err(failure.clone())),
    };
    let derived = found.as_ref().and_then(|found| found.as_ref().ok());
    let failure = found.as_ref().and_then(|found| found.as_ref().err());
    let functions: Vec<FunctionUse> = which
        .iter()
        .map(|&f| FunctionUse {
            name: problem.function_names[f].clone(),
            used: used(problem, f).join(", "),
            whole_motion: sees_all(problem, &scene, f),
            variables: derived.map(|gradients| names(problem, |i| depends(&gradients[f][i]))),
        })
        .collect();
    let needed = |f: &usize| !functions[*f].used.is_empty();
    let asked = which.iter().any(&needed);
    let idle = |i: usize| {
        let Some(gradients) = derived else {
            return false;
        };
        let mut needed = which.iter().filter(|f| needed(f));
        asked && !needed.any(|&f| depends(&gradients[f][i]))
    };
    let idle_variables = names(problem, idle);
    let start = motion.as_ref().ok().map(|motion| {
        let (_, whole) = motion.at.written(problem);
        let of = |run: &Trajectory<f64>| (run.q(0).to_vec(), run.v(0).to_vec());
        [of(&whole), of(&motion.at.run)]
    });
    let [of_written, of_lowered] =
        start.unwrap_or_else(|| [placement::guess(&written), placement::guess(&scene.model)]);
    Explanation {
        name: problem.name.clone(),
        bodies: problem.body_count(),
        joints: problem.joint_count(),
        loads: written.loads.len(),
        couplings: problem.couplings(&written),
        controllers: problem.controllers(&written),
        flexible: problem.flexible_bodies(x),
        bases: motion
            .as_ref()
            .map_or_else(|_| Vec::new(), |motion| of_bases(problem, motion, &which)),
        left_out,
        kept,
        start: super::start::notes(problem, x),
        written: size(&written, of_written),
        lowered: size(&scene.model, of_lowered),
        failure: failure.map(ToString::to_string),
        integration: motion.ok().map(|motion| motion.used(problem)),
        idle_variables,
        functions,
    }
}

/// How functions of the start change with richer bases; nothing of a stretch.
fn of_bases(problem: &Problem, motion: &MotionExplanation, which: &[usize]) -> Vec<String> {
    if motion.part.is_some() {
        return Vec::new();
    }
    let name = |f: usize| &problem.function_names[f];
    match bases::changes(problem, &motion.at, which) {
        Ok(found) => (found.iter())
            .map(|own| {
                let value = own.value;
                format!(
                    "\"{}\" = {value:.9e} changes by {:.1e}",
                    name(own.function),
                    own.error()
                )
            })
            .collect(),
        Err(failure) => vec![format!("the run with richer bases fails: {failure}")],
    }
}

/// Whether a derivative is larger than the round-off of its terms.
fn depends(derivative: &Derivative) -> bool {
    derivative.value.abs() > 64.0 * f64::EPSILON * derivative.terms
}

fn names(problem: &Problem, which: impl Fn(usize) -> bool) -> Vec<String> {
    let variables = problem.variables.iter().enumerate();
    let wanted = variables.filter(|(i, _)| which(*i));
    wanted.map(|(_, variable)| variable.name.clone()).collect()
}

/// Whether a function looks at the whole motion.
fn sees_all(problem: &Problem, scene: &Scene<f64>, f: usize) -> bool {
    let own = problem.composition.of_scene(&[f]).into_owned();
    own.iter().any(|&g| looks_at_the_whole(&scene.functions[g]))
}

/// The use of function f in an optimisation.
fn used(problem: &Problem, f: usize) -> Vec<&'static str> {
    let mut used = Vec::new();
    if problem
        .objective
        .is_some_and(|objective| objective.function == f)
    {
        used.push("objective");
    }
    if problem.constraints.iter().any(|own| own.function == f) {
        used.push("constraint");
    }
    if problem.composition.names(f) {
        used.push("expression");
    }
    used
}

/// Largest number of failed reductions that are listed one by one.
const TOLD: usize = 8;

/// The reductions made, and the failed ones with their reasons.
fn lowering(
    problem: &Problem,
    written: &Model<f64>,
    lowered: &Model<f64>,
) -> (Vec<String>, Vec<String>) {
    let (mut left_out, mut kept) = (Vec::new(), Vec::new());
    let Some(lowering) = &problem.lowering else {
        return (left_out, vec!["anything, as --no-lowering asks".into()]);
    };
    if let Ok(plane) = &lowering.plane {
        let normal = plane.name();
        left_out.push(format!(
            "motion out of a plane: the scene moves in the plane across {normal}; three unknowns a body"
        ));
    }
    let name = |body: &usize| format!("\"{}\"", written.bodies[*body].name);
    for cluster in &lowering.welded.clusters {
        let carried = cluster.members.iter().filter(|own| **own != cluster.host);
        let carried: Vec<String> = carried.map(name).collect();
        let host = name(&cluster.host);
        left_out.push(match &carried[..] {
            [one] => format!("body {one}: it is welded to body {host}"),
            all => format!("bodies {}: they are welded to body {host}", all.join(", ")),
        });
    }
    let bodies = lowered.bodies.iter().enumerate();
    for (i, body) in bodies.filter(|(i, _)| !written.is_internal(*i)) {
        let name = name(&i);
        if lowering.non_rotating.contains(i) {
            left_out.push(format!("the rotation of body {name}: its joints hold it"));
        } else if body.mobility == Mobility::point() {
            left_out.push(format!(
                "the rotation of body {name}: it is neither loaded nor observed by a function"
            ));
        } else if lowering.fixed.contains(i) {
            left_out.push(format!("body {name}: it is welded to ground"));
        }
    }
    let all = lowering.kept();
    kept.extend(all.iter().take(TOLD).map(|own| own.to_string()));
    if all.len() > TOLD {
        kept.push(format!("{} more", all.len() - TOLD));
    }
    left_out.extend(rows_left_out(written, lowered));
    left_out.extend(problem.notes_of_input());
    (left_out, kept)
}

/// Largest number of joints whose rows are told one by one, of those that lose equally many.
const ALONE: usize = 8;

/// The rows that the reductions leave out, with one line for many joints that are alike.
fn rows_left_out(written: &Model<f64>, lowered: &Model<f64>) -> Vec<String> {
    let joints = written.joints.iter().zip(&lowered.joints);
    let counts = joints.map(|(before, after)| {
        let (all, rows) = (before.imposed().count(), after.imposed().count());
        (all.saturating_sub(rows), all, before.name.as_str())
    });
    let lost: Vec<_> = counts.filter(|own| own.0 > 0).collect();
    let mut lines = Vec::new();
    for (i, &(rows, all, name)) in lost.iter().enumerate() {
        let is_like = |own: &&(usize, usize, &str)| (own.0, own.1) == (rows, all);
        let group: Vec<&str> = lost.iter().filter(is_like).map(|own| own.2).collect();
        if group.len() <= ALONE {
            lines.push(format!("{rows} of {all} rows of joint \"{name}\""));
        } else if !lost[..i].iter().any(|own| is_like(&own)) {
            let names = listed(&group);
            lines.push(format!(
                "{rows} of {all} rows of each of {} joints: {names}",
                group.len()
            ));
        }
    }
    lines
}

/// The warning that the discretisation error of merged bodies differs from that of their parts, if
/// an implicit method marches some.
pub fn merged_errs(problem: &Problem, at: &Evaluated) -> Option<&'static str> {
    let lowering = problem.lowering.as_ref();
    let merged = lowering.is_some_and(|lowering| !lowering.welded.is_empty());
    (merged && at.run.method != Method::Dop853).then_some(
        "welded bodies were merged, for which an implicit method errs otherwise than for their parts: its \
         results differ from those of --no-lowering by its error, not by round-off",
    )
}

/// Why the tree elimination does not apply.
fn told(model: &Model<f64>, why: FallbackReason) -> String {
    match why {
        FallbackReason::Loops => "loops of joints reach far and overlap".into(),
        FallbackReason::Flexible => "a body is flexible".into(),
        FallbackReason::Coupled => "joints are coupled".into(),
        FallbackReason::Body(body) => {
            let body = &model.bodies[body];
            let principal = body.inertia.symmetric_eigenvalues();
            let name = &body.name;
            match principal.min() <= f64::EPSILON * principal.max() {
                true => format!("body \"{name}\" has no inertia of its own about some axis"),
                false => format!(
                    "the inertia of body \"{name}\" is five decades below that of the bodies that it carries"
                ),
            }
        }
        FallbackReason::Joint(joint) => format!(
            "the inertias that joint \"{}\" holds differ by five digits",
            model.joints[joint].name
        ),
    }
}

/// Size of the equations of a model in a state.
fn size(model: &Model<f64>, (q, v): (Vec<f64>, Vec<f64>)) -> SystemSize {
    let numbering = Numbering::new(model);
    let (elimination, sparse) = accelerations::elimination(model, &numbering, &q, &v);
    let sparse = sparse.map(|why| told(model, why));
    let named = |bodies: Vec<usize>| {
        let name = |body: usize| model.bodies[body].name.clone();
        bodies.into_iter().map(name).collect()
    };
    let (velocities, rows) = (numbering.unknowns(), numbering.constraints());
    SystemSize {
        velocities,
        rows,
        stabilised: 2 * (velocities + rows),
        sparse,
        fill: elimination.as_ref().and_then(|found| found.fill),
        operations: elimination.as_ref().map_or(0, |found| found.operations),
        closing: elimination.as_ref().map_or(Vec::new(), |found| {
            let name = |&joint: &usize| model.joints[joint].name.clone();
            found.closing.iter().map(name).collect()
        }),
        order: elimination
            .and_then(|found| found.bodies)
            .map_or(Vec::new(), named),
    }
}
