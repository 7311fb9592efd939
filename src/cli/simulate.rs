//! `optimize simulate` and `optimize check`.

use super::aggregates::{add_smoothed, told};
use super::arguments::Job;
use super::earlier::start_from;
use super::error_table::{self, table};
use super::modes;
use super::{
    DONE, Failure, NOT_REACHED, draw, load, no_page, print, read, refine, shown, tell, write_report,
};
use crate::driver::ends::Ends;
use crate::driver::unfollowed::unfollowed;
use crate::driver::{self, CheckedDerivative, Evaluated, Simulated, Simulation, error, not_finite};
use crate::figures::tables::ReactionAxes;
use crate::figures::{self, tables};
use crate::functions::evaluate::ungated_maximum;
use crate::functions::peak::Maximum;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;
use crate::report::{prepare_directory, with_space, write_all};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// Simulates the start of a problem.
pub(crate) fn simulate(
    job: &Job,
    from: Option<&Path>,
    json: bool,
    joint_axes: bool,
) -> Result<u8, Failure> {
    let mut problem = read(job)?;
    if let Some(from) = from {
        start_from(&mut problem, from)?;
    }
    // The directory is locked and known to be writable before the simulation.
    let _held = match &job.output {
        Some(directory) => Some(prepare_directory(directory)?),
        None => None,
    };
    expect_directory(job)?;
    let problem = refine(job, problem)?;
    if problem.statics.is_some() {
        return super::statics::simulate(job, &problem, json);
    }
    let start = problem.start();
    let simulation = match job.error {
        // Their derivatives are told, too.
        true => driver::simulate_for_gradients(&problem, &start),
        false => driver::simulate(&problem, &start),
    };
    let simulation = simulation.map_err(Failure::numerical)?;
    let told = driver::modes::told(&problem, &start).map_err(Failure::numerical)?;
    let modes = told.as_ref().map_or(String::new(), modes::text);
    if json {
        let modes = told.as_ref().map_or(Map::new(), modes::json);
        print(&as_json(&problem, &simulation, (job.error, modes))?)?;
    } else {
        if !job.quiet {
            print(&(summary(&problem, &simulation) + &modes))?;
        }
        if job.error {
            let found = error::estimate(&problem, &simulation.at, &all(&problem), true);
            let text = table(&problem, &found.map_err(Failure::numerical)?);
            let bases = of_bases(&problem, &simulation.at);
            print(&(text + &bases + &warned(&problem, &simulation.at)))?;
        }
    }
    if let Some(directory) = &job.output {
        let axes = match joint_axes {
            true => ReactionAxes::Joint,
            false => ReactionAxes::Ground,
        };
        let tables: Vec<_> = tables::of_simulation(&problem, &simulation, axes)
            .into_iter()
            .map(|(name, bytes)| (directory.join(name), bytes))
            .collect();
        write_all(&tables)?;
        if job.vtu {
            write_all(&figures::shell_fields::series(
                directory,
                &problem,
                &simulation,
            ))?;
        }
        draw(directory, figures::of_simulation(&problem, &simulation));
        if job.report {
            let text = summary(&problem, &simulation) + &modes;
            let ends = Ends::of_motion(&simulation);
            write_report(directory, &problem, text, &ends, None)?;
        }
        if !job.quiet {
            tell(&format!("results in {}\n", shown(directory)));
        }
    }
    let functions = problem.function_names.iter().enumerate();
    let lost = functions
        .filter(|(f, _)| !simulation.at.function(*f).value.is_finite())
        .map(|(f, _)| {
            let value = simulation.at.function(f).value;
            not_finite::value(&problem, &simulation.at, f, value)
        })
        .collect::<Vec<_>>();
    if !lost.is_empty() {
        let what = format!("{}: not finite: {}", problem.name, lost.join("; "));
        return Err(Failure::numerical(what));
    }
    Ok(DONE)
}

/// Refuses files that nothing says where to write.
pub(super) fn expect_directory(job: &Job) -> Result<(), Failure> {
    if let (true, Some(directory)) = (job.report, &job.output)
        && directory.join("optimum.json").is_file()
    {
        return Err(Failure::bad_input(format!(
            "{0}: found the result of an optimisation, expected another directory for the page of a simulation; \
             `optimize report {0}` writes the page of the optimisation",
            shown(directory)
        )));
    }
    let asked = [("--vtu", job.vtu), ("--report", job.report)];
    let found = asked
        .iter()
        .find(|(_, asked)| *asked && job.output.is_none());
    found.map_or(Ok(()), |(option, _)| {
        let what = format!("found {option} without --output, expected a directory for the files");
        Err(Failure::bad_input(what))
    })
}

/// The result of a simulation in full precision.
fn as_json(
    problem: &Problem,
    simulation: &Simulation,
    (with_errors, modes): (bool, Map<String, Value>),
) -> Result<String, Failure> {
    let (run, counts) = (&simulation.at.run, simulation.at.run.counts);
    let names = &problem.function_names;
    let mut functions = Map::new();
    let mut bases = None;
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
            own["error"] = json!(found.value.error);
            if unknown.is_some() {
                own["error_known"] = json!(false);
            }
            let gradient = problem.variables.iter().zip(&found.gradient);
            let gradient = gradient.map(|(variable, derivative)| {
                let both = json!({"value": derivative.value, "error": derivative.error});
                (variable.name.clone(), both)
            });
            own["gradient"] = Value::Object(gradient.collect());
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
    warnings.extend(unknown.into_iter().chain(bases));
    let first = &simulation.observations[0];
    let conserved = simulation.at.scene.model.conserves_energy();
    let (position, velocity) = simulation.constraint_drift();
    if simulation.at.is_rest() {
        let mut all = json!({
            "name": problem.name,
            "analysis": if modes.is_empty() { "rest" } else { "modes" },
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
            all.extend(modes);
        }
        return Ok(serde_json::to_string_pretty(&all).map_err(Failure::numerical)? + "\n");
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
    if counts.products > 0 {
        all["work"]["krylov_products"] = json!(counts.products);
    }
    let text = serde_json::to_string_pretty(&all).map_err(Failure::numerical)?;
    Ok(text + "\n")
}

fn summary(problem: &Problem, simulation: &Simulation) -> String {
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
                    "  true maximum {value:.9e}{unit} at t = {time:.6} s (± {error:.0e}"
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
        return text;
    }
    if is_rest {
        let _ = writeln!(
            text,
            "  energy {energy:.6e} J; left: acceleration {:.1e} m/s^2, gaps of joints {position:.1e} m",
            simulation.unbalanced()
        );
        return text;
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

fn all(problem: &Problem) -> Vec<usize> {
    (0..problem.function_names.len()).collect()
}

/// A table of the estimated discretisation errors of all functions and their gradients.
pub(crate) fn errors(problem: &Problem, at: &Simulated) -> Result<String, Failure> {
    let found = at.estimate(problem, &all(problem), true);
    let text = table(problem, &found.map_err(Failure::numerical)?);
    Ok(match at {
        Simulated::Motion(simulation) => {
            text + &of_bases(problem, &simulation.at) + &warned(problem, &simulation.at)
        }
        Simulated::Statics(_) => text,
    })
}

/// A table of the errors of bases, if there are any.
fn of_bases(problem: &Problem, at: &Evaluated) -> String {
    match driver::bases::errors(problem, at, &all(problem)) {
        Ok(found) => error_table::of_bases(problem, &found),
        Err(failure) => format!("not known: {}\n", of_finer(&failure)),
    }
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

/// Checks all gradients of a problem at its start.
pub(crate) fn check(job: &Job, from: Option<&Path>, tolerance: f64) -> Result<u8, Failure> {
    if job.output.is_some() {
        let what = "found --output, expected none: optimize check writes no files";
        return Err(Failure::bad_input(what));
    }
    no_page(job, "optimize check")?;
    let mut problem = load(job)?;
    if let Some(from) = from {
        start_from(&mut problem, from)?;
    }
    if let Some(focused) = problem.focused(&all(&problem)) {
        problem = focused;
    }
    if problem.variables.is_empty() {
        return Err(Failure::bad_input(format!(
            "{}: nothing to check: the problem has no variables",
            shown(&job.problem)
        )));
    }
    let chaos = match problem.statics {
        Some(_) => None,
        None => driver::chaos(&problem, &problem.start()),
    };
    let derivatives = match (driver::check(&problem, &problem.start()), &chaos) {
        (Ok(derivatives), _) => derivatives,
        // Runs that differ by round-off diverge, and the steps of one do not suit the other.
        (Err(_), Some(chaos)) => return Err(Failure::numerical(chaos)),
        (Err(failure), None) => return Err(Failure::numerical(failure)),
    };
    let unresolved = match problem.statics {
        Some(_) => Vec::new(),
        // Where the finer run fails, the two derivatives still agree or not.
        None => driver::resolved::of_design(&problem, &problem.start()).unwrap_or_default(),
    };
    let names = |all: &mut dyn Iterator<Item = &String>| {
        all.map(|name| name.chars().count())
            .max()
            .unwrap_or(0)
            .max(8)
    };
    let f_width = names(&mut problem.function_names.iter());
    let v_width = names(&mut problem.variables.iter().map(|v| &v.name));
    let mut text = format!(
        "{:f_width$}  {:v_width$}  {:>23}  {:>23}  {:>10}\n",
        "function", "variable", "adjoint", "complex step", "difference"
    );
    let mut worst = 0.0_f64;
    let mut failed = 0;
    for d in &derivatives {
        let difference = d.relative_difference();
        let nothing = d.is_round_off();
        // Round-off of larger terms, if the derivative itself is small.
        let round_off = !nothing && difference > tolerance && d.differs_by_round_off();
        let passed = nothing || round_off || difference <= tolerance;
        failed += usize::from(!passed);
        worst = if difference.is_nan() {
            f64::NAN
        } else if nothing || round_off {
            worst
        } else {
            worst.max(difference)
        };
        let verdict = if nothing {
            "  zero but for round-off".to_string()
        } else if round_off {
            "  differs by round-off of larger terms".to_string()
        } else if passed {
            String::new()
        } else if problem.statics.is_some() {
            "  exceeds the tolerance".to_string()
        } else {
            format!(
                "  exceeds the tolerance; where Newton's method stops moves it by {:.1e}",
                d.noise()
            )
        };
        let _ = writeln!(
            text,
            "{:f_width$}  {:v_width$}  {:>23.15e}  {:>23.15e}  {:>10.1e}{verdict}",
            problem.function_names[d.function],
            problem.variables[d.variable].name,
            d.adjoint,
            d.complex_step,
            difference,
        );
    }
    let _ = writeln!(
        text,
        "{} derivatives, largest relative difference {worst:.1e}, {failed} above {tolerance:.1e}",
        derivatives.len()
    );
    let noise = derivatives
        .iter()
        .filter(|d| !d.is_round_off())
        .map(CheckedDerivative::noise)
        .fold(0.0, f64::max);
    if problem.statics.is_none() {
        let _ = writeln!(
            text,
            "where Newton's method stops moves the derivatives by up to {noise:.1e}"
        );
    }
    if let Some(chaos) = &chaos {
        let _ = writeln!(text, "warning: {chaos}");
    }
    for own in &unresolved {
        let _ = writeln!(text, "refused: {}", own.describe(&problem));
    }
    if !unresolved.is_empty() {
        let advice = driver::resolved::advice(&problem);
        let _ = writeln!(text, "the steps do not resolve these derivatives: {advice}");
    }
    let failed = failed > 0 || !unresolved.is_empty();
    if !job.quiet || failed {
        print(&text)?;
    }
    Ok(if failed { NOT_REACHED } else { DONE })
}
