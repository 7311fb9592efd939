//! What `optimize simulate` prints and writes of a motion, or of a machine at rest.

use super::aggregates::{add_smoothed, told};
use super::arguments::Job;
use super::error_table::{self, add_errors, table};
use super::{Failure, draw, modes};
use crate::driver::modes::ToldModes;
use crate::driver::unfollowed::unfollowed;
use crate::driver::{self, Evaluated, Simulated, Simulation, error};
use crate::figures::tables::ReactionAxes;
use crate::figures::{self, tables};
use crate::functions::evaluate::ungated_maximum;
use crate::functions::peak::Maximum;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;
use crate::report::{with_space, write_all};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// The files of a motion.
pub(super) fn write_files(
    job: &Job,
    directory: &Path,
    (problem, simulation): (&Problem, &Simulation),
    axes: ReactionAxes,
) -> Result<(), Failure> {
    let tables: Vec<_> = tables::of_simulation(problem, simulation, axes)
        .into_iter()
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&tables)?;
    if job.vtu {
        let series = figures::shell_fields::series(directory, problem, simulation);
        write_all(&series)?;
    }
    draw(directory, figures::of_simulation(problem, simulation));
    Ok(())
}

/// The result of a simulation in full precision.
pub(super) fn as_json(
    problem: &Problem,
    simulation: &Simulation,
    (with_errors, shown): (bool, Option<&ToldModes>),
) -> Result<Value, Failure> {
    let (run, counts) = (&simulation.at.run, simulation.at.run.counts);
    let names = &problem.function_names;
    let mut functions = Map::new();
    let (mut bases, mut sharper) = (None, None);
    let unknown = with_errors
        .then(|| unfollowed(problem, &simulation.at))
        .flatten();
    for (f, name) in names.iter().enumerate() {
        let found = simulation.at.function(f);
        let mut own = json!({"value": found.value, "unit": problem.function_unit(f)});
        if let Some(Maximum { value, time, error }) = found.maximum {
            own["true_maximum"] = json!({"value": value, "time": time, "error": error});
        }
        if let Some(smoothed) = simulation.at.smoothed(f) {
            add_smoothed(&mut own, &smoothed, found.maximum.is_some());
        }
        functions.insert(name.clone(), own);
    }
    if with_errors {
        let all: Vec<usize> = (0..names.len()).collect();
        let found = error::estimate(problem, &simulation.at, &all, true);
        for found in found.map_err(Failure::numerical)? {
            let own = &mut functions[&names[found.function]];
            add_errors(own, problem, &found);
            if unknown.is_some() {
                own["error_known"] = json!(false);
            }
        }
        let found = driver::smoothing::changes(problem, &simulation.at, &all);
        sharper = found.as_ref().err().map(of_sharper);
        for found in found.into_iter().flatten() {
            let own = &mut functions[&names[found.function]];
            own["smoothing_change"] = json!(found.error());
            if let Some([value, other]) = found.maximum {
                own["true_maximum"]["smoothing_change"] = json!((value - other).abs());
            }
        }
        let found = driver::bases::errors(problem, &simulation.at, &all);
        bases = found.as_ref().err().map(of_finer);
        for found in found.into_iter().flatten() {
            let own = &mut functions[&names[found.function]];
            own["basis_error"] = json!(found.error());
            if let Some([value, other]) = found.maximum {
                own["true_maximum"]["basis_error"] = json!((value - other).abs());
            }
        }
    }
    let mut warnings: Vec<String> = simulation.warning.iter().cloned().collect();
    warnings.extend(simulation.at.doubts(problem, 0..names.len()));
    warnings.extend(unknown.into_iter().chain(bases).chain(sharper));
    let first = &simulation.observations[0];
    let conserved = simulation.at.scene.model.conserves_energy();
    let (position, velocity) = simulation.constraint_drift();
    if simulation.at.is_rest() {
        let mut all = json!({
            "name": problem.name,
            "analysis": if shown.is_some() { "modes" } else { "rest" },
            "functions": functions,
            "energy": first.kinetic + first.potential,
            "left": {"acceleration": simulation.unbalanced(), "gaps": position},
            "notes": driver::start::notes(problem, &simulation.at.x),
            "warnings": warnings,
        });
        if let Value::Object(all) = &mut all {
            if problem.is_turning() {
                all.retain(|key, _| key != "energy" && key != "left");
            }
            all.extend(shown.map_or(Map::new(), modes::json));
        }
        return Ok(all);
    }
    let mut all = json!({
        "name": problem.name,
        "duration": run.duration,
        "method": run.method.name(),
        "reason": simulation.reason,
        "work": {
            "steps": run.grid.steps(),
            "evaluations": counts.evaluations,
            "newton_iterations": counts.newton_iterations,
            "factorisations": counts.factorisations,
        },
        "functions": functions,
        "energy": {
            "start": first.kinetic + first.potential,
            "largest_change": simulation.energy_drift(),
            "conserved": conserved,
            "meaning": match conserved {
                true => "no drive, load or damping does work; largest_change is the error of the run",
                false => "drives, loads or damping do work; largest_change contains it",
            },
        },
        "constraint_drift": {"position": position, "velocity": velocity},
        "start": driver::start::notes(problem, &simulation.at.x),
        "warnings": warnings,
    });
    if let (Some(event), Some([before, after])) = (problem.last_event(), simulation.jump(problem)) {
        all["event"] = json!({
            "name": event,
            "time": simulation.begin,
            "kinetic_energy": {"before": before, "after": after},
        });
    }
    if counts.products > 0 {
        all["work"]["krylov_products"] = json!(counts.products);
    }
    Ok(all)
}

/// The result of a simulation in lines, with the modes that the file asks for.
pub(super) fn summary(
    problem: &Problem,
    simulation: &Simulation,
    shown: Option<&ToldModes>,
) -> String {
    let run = &simulation.at.run;
    let counts = run.counts;
    let products = match counts.products {
        0 => String::new(),
        products => format!(", {products} Krylov products"),
    };
    let is_rest = simulation.at.is_rest();
    let mut text = match is_rest {
        true if problem.is_turning() => format!("{}: in steady rotation\n", problem.name),
        true => format!("{}: at rest\n", problem.name),
        false => format!(
            "{}: {} s by {} in {} steps ({} evaluations, {} Newton iterations, {} factorisations{products})\n  \
         method: {}\n",
            problem.name,
            (run.duration * 1e9).round() / 1e9,
            run.method.name(),
            run.grid.steps(),
            counts.evaluations,
            counts.newton_iterations,
            counts.factorisations,
            simulation.reason
        ),
    };
    if let (Some(event), Some([before, after])) = (problem.last_event(), simulation.jump(problem)) {
        let _ = writeln!(
            text,
            "  event: \"{event}\" at t = {:.9} s; kinetic energy {before:.6e} J before, {after:.6e} J after: {:.6e} J are lost",
            simulation.begin,
            before - after
        );
    }
    if let Some(warning) = &simulation.warning {
        let _ = writeln!(text, "  warning: {warning}");
    }
    if let Some(note) = simulation.many_steps(problem) {
        let _ = writeln!(text, "  note: {note}");
    }
    for note in driver::start::notes(problem, &simulation.at.x) {
        let what = if is_rest { "note" } else { "start" };
        let _ = writeln!(text, "  {what}: {note}");
    }
    if simulation.unlowered {
        text.push_str("  integrated as written: this design does not admit the lowering\n");
    } else if let Some(merged) = driver::merged_errs(problem, &simulation.at) {
        let _ = writeln!(text, "  {merged}");
    }
    for warning in simulation
        .at
        .doubts(problem, 0..problem.function_names.len())
    {
        let _ = writeln!(text, "  warning: {warning}");
    }
    let width = problem
        .function_names
        .iter()
        .map(|n| n.chars().count())
        .max()
        .unwrap_or(0);
    for (f, name) in problem.function_names.iter().enumerate() {
        let found = simulation.at.function(f);
        let unit = with_space(Some(&problem.function_unit(f)));
        let _ = write!(text, "  {name:width$}  {:>16.9e}{unit}", found.value);
        if let Some(Maximum { value, time, error }) = found.maximum {
            let _ = match is_rest {
                true => write!(text, "  true maximum {value:.9e}{unit} (± {error:.0e}"),
                false => write!(
                    text,
                    "  true maximum {value:.9e}{unit} at t = {time:.6} s (between samples ± {error:.0e}"
                ),
            };
            let at = &simulation.at;
            match ungated_maximum(&at.scene.functions[f], &at.scene.model, &at.run) {
                Some(free) => {
                    let _ = write!(text, "; with the gate's factor, without it {free:.9e})");
                }
                None => text.push(')'),
            }
        }
        text += &told(simulation.at.smoothed(f), found.maximum.is_some());
        text.push('\n');
    }
    let (first, last) = (&simulation.observations[0], simulation.observations.last());
    let energy = first.kinetic + first.potential;
    let (position, velocity) = simulation.constraint_drift();
    if problem.is_turning() {
        return text + &shown.map_or(String::new(), modes::text);
    }
    if is_rest {
        let _ = writeln!(
            text,
            "  energy {energy:.6e} J; left: acceleration {:.1e} m/s^2, gaps of joints {position:.1e} m",
            simulation.unbalanced()
        );
        return text + &shown.map_or(String::new(), modes::text);
    }
    let _ = writeln!(
        text,
        "  energy {energy:.6e} J, {} {:.2e} J; constraints: position {position:.1e}, \
         velocity {velocity:.1e}",
        match simulation.at.scene.model.conserves_energy() {
            true => "drift",
            false => "by loads and drives up to",
        },
        simulation.energy_drift()
    );
    if let Some(last) = last {
        let _ = writeln!(
            text,
            "  momentum at the end {:.6e} kg m/s, angular momentum {:.6e} kg m^2/s",
            last.momentum.norm(),
            last.angular_momentum.norm()
        );
    }
    text
}

/// All functions of a problem.
pub(super) fn all(problem: &Problem) -> Vec<usize> {
    (0..problem.function_names.len()).collect()
}

/// A table of the estimated discretisation errors of all functions and their gradients.
pub(super) fn errors(problem: &Problem, at: &Simulated) -> Result<String, Failure> {
    match at {
        Simulated::Motion(simulation) => errors_of_motion(problem, simulation),
        Simulated::Statics(_) | Simulated::Cases(_) => {
            let found = at.estimate(problem, &all(problem), true);
            Ok(table(problem, &found.map_err(Failure::numerical)?))
        }
    }
}

/// The same of a motion, with the errors of bases and the changes by the smoothing of loads.
pub(super) fn errors_of_motion(
    problem: &Problem,
    simulation: &Simulation,
) -> Result<String, Failure> {
    let at = &simulation.at;
    let found = error::estimate(problem, at, &all(problem), true);
    let text = table(problem, &found.map_err(Failure::numerical)?);
    let sharper = of_smoothing(problem, at);
    Ok(text + &of_bases(problem, at) + &sharper + &warned(problem, at))
}

/// A table of the errors of bases, if there are any.
fn of_bases(problem: &Problem, at: &Evaluated) -> String {
    match driver::bases::errors(problem, at, &all(problem)) {
        Ok(found) => error_table::of_bases(problem, &found),
        Err(failure) => format!("not known: {}\n", of_finer(&failure)),
    }
}

/// A table of the changes by the smoothing of loads, if there are any.
fn of_smoothing(problem: &Problem, at: &Evaluated) -> String {
    match driver::smoothing::changes(problem, at, &all(problem)) {
        Ok(found) => error_table::of_smoothing(problem, &found),
        Err(failure) => format!("not known: {}\n", of_sharper(&failure)),
    }
}

/// Why the changes by the smoothing of loads are not known.
fn of_sharper(failure: &IntegrationFailure) -> String {
    format!(
        "changes by the smoothing of loads are not known: the run with half the widths fails: {failure}"
    )
}

/// Why the errors of bases are not known.
fn of_finer(failure: &IntegrationFailure) -> String {
    format!(
        "errors of bases are not known: the run with all nodes and more functions of beams fails: {failure}"
    )
}

/// A warning of a motion that magnifies round-off.
fn warned(problem: &Problem, at: &Evaluated) -> String {
    let chaos = driver::chaos::of_motion(problem, at, &all(problem));
    let chaos = chaos.map(|chaos| format!("warning: {chaos}\n"));
    let unknown = unfollowed(problem, at).map(|why| format!("not known: {why}\n"));
    unknown.into_iter().chain(chaos).collect()
}
