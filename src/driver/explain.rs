//! What is left out of a problem's scenes, and what is left.

use super::evaluate::{Derivative, Evaluated};
use super::integration::{Integration, looks_at_the_whole};
use crate::integrate::{IntegrationFailure, Trajectory};
use crate::model::{Mobility, Model};
use crate::problem::Problem;
use crate::report::{Explanation, FunctionUse, SystemSize};
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;

/// Explains the start of `problem`, which is simulated with its gradients.
///
/// # Errors
/// If the simulation or its adjoint fails.
pub fn explain(problem: &Problem) -> Result<Explanation, IntegrationFailure> {
    let x = problem.start();
    let mut integration = Integration::new(problem, &problem.scene(&x), false, true);
    let (at, _) = Evaluated::with(&mut integration, problem, &x)?;
    let written = problem.unlowered_scene(&x).model;
    let (left_out, kept) = lowering(problem, &written, &at.scene.model);
    let which: Vec<usize> = (0..at.scene.functions.len()).collect();
    let (gradients, _) = at.derivatives(problem, &which)?;
    let functions: Vec<FunctionUse> = which
        .iter()
        .map(|&f| FunctionUse {
            name: problem.function_names[f].clone(),
            used: used(problem, f).join(", "),
            whole_motion: looks_at_the_whole(&at.scene.functions[f]),
            variables: names(problem, |i| depends(&gradients[f][i])),
        })
        .collect();
    let needed = |f: &usize| !functions[*f].used.is_empty();
    let asked = which.iter().any(&needed);
    let idle = |i: usize| {
        let mut needed = which.iter().filter(|f| needed(f));
        asked && !needed.any(|&f| depends(&gradients[f][i]))
    };
    let [samples_bytes, tape_bytes] = at.run.bytes();
    let reason = integration.chosen().map_or("", |(_, reason)| reason);
    Ok(Explanation {
        name: problem.name.clone(),
        bodies: written.bodies.len(),
        joints: written.joints.len(),
        loads: written.loads.len(),
        left_out,
        kept,
        written: size(&written, &at.run),
        lowered: size(&at.scene.model, &at.run),
        method: at.run.method.name(),
        reason: reason.into(),
        steps: at.run.grid.steps(),
        samples_bytes,
        tape_bytes,
        idle_variables: names(problem, idle),
        functions,
    })
}

/// Whether a derivative is more than the round-off of what it is the sum of.
fn depends(derivative: &Derivative) -> bool {
    derivative.value.abs() > 64.0 * f64::EPSILON * derivative.terms
}

fn names(problem: &Problem, which: impl Fn(usize) -> bool) -> Vec<String> {
    let variables = problem.variables.iter().enumerate();
    let wanted = variables.filter(|(i, _)| which(*i));
    wanted.map(|(_, variable)| variable.name.clone()).collect()
}

/// What an optimisation needs function f for.
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
    used
}

/// What is left out, and what is not and why.
fn lowering(
    problem: &Problem,
    written: &Model<f64>,
    lowered: &Model<f64>,
) -> (Vec<String>, Vec<String>) {
    let (mut left_out, mut kept) = (Vec::new(), Vec::new());
    match &problem.lowering {
        None => kept.push("anything, as --no-lowering asks".into()),
        Some(lowering) => {
            for (reduction, found) in lowering.reductions() {
                match found {
                    Ok(what) => left_out.push(format!("{reduction}: {what}")),
                    Err(obstacle) => kept.push(format!("{reduction}: {obstacle}")),
                }
            }
        }
    }
    for body in &lowered.bodies {
        let name = &body.name;
        match body.mobility {
            Mobility::Point => left_out.push(format!(
                "the rotation of body \"{name}\": nothing turns it, and no function looks at it"
            )),
            Mobility::Fixed => left_out.push(format!("body \"{name}\": it is welded to ground")),
            Mobility::Spatial | Mobility::Planar { .. } => {}
        }
    }
    for (before, after) in written.joints.iter().zip(&lowered.joints) {
        let (all, rows) = (before.rows().count(), after.rows().count());
        if rows < all {
            let name = &before.name;
            left_out.push(format!("{} of {all} rows of joint \"{name}\"", all - rows));
        }
    }
    for redundancy in &problem.redundant {
        left_out.push(redundancy.to_string());
    }
    (left_out, kept)
}

/// Size of the equations of a model at the start of a run.
fn size(model: &Model<f64>, run: &Trajectory<f64>) -> SystemSize {
    let numbering = Numbering::new(model);
    let mut field = Accelerations::new(model, &numbering);
    field.stand(run.q(0), run.v(0), 0.0);
    // The run has shown that the start is regular.
    let elimination = field.factorise().ok().map(|()| field.elimination());
    let named = |bodies: Vec<usize>| {
        let name = |body: usize| model.bodies[body].name.clone();
        bodies.into_iter().map(name).collect()
    };
    let (velocities, rows) = (numbering.unknowns(), numbering.constraints());
    SystemSize {
        velocities,
        rows,
        stabilised: 2 * (velocities + rows),
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
