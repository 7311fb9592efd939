//! `optimize simulate`, `explain` and `work-precision` of structures.

use super::aggregates::{add_smoothed, told};
use super::arguments::Job;
use super::error_table::{add_errors, table};
use super::{DONE, Failure, draw, print, shown, tell, write_report};
use crate::driver::analysed::place;
use crate::driver::ends::Ends;
use crate::driver::error::FunctionError;
use crate::driver::statics::{StaticDesign, error, precision};
use crate::figures::plots;
use crate::figures::statics::{fields, figures};
use crate::problem::Problem;
use crate::report::{PrecisionOfMesh, prepare_directory, with_space, write_all};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

fn start(problem: &Problem) -> Result<StaticDesign, Failure> {
    let statics = problem.statics.as_ref();
    let statics = statics.ok_or_else(|| Failure::bad_input("no structures"))?;
    StaticDesign::of(problem, statics, &problem.start(), None).map_err(Failure::numerical)
}

fn all(problem: &Problem) -> Vec<usize> {
    (0..problem.function_names.len()).collect()
}

/// Solves the load cases of a problem's start. The directory for the results is held by the caller.
pub(crate) fn simulate(job: &Job, problem: &Problem, json: bool) -> Result<u8, Failure> {
    let design = start(problem)?;
    let errors = match job.error {
        true => {
            let found = error::estimate(problem, &design, &all(problem), true);
            Some(found.map_err(Failure::numerical)?)
        }
        false => None,
    };
    if json {
        let all = as_json(problem, &design, errors.as_deref());
        let text = serde_json::to_string_pretty(&all).map_err(Failure::numerical)?;
        print(&(text + "\n"))?;
    } else {
        if !job.quiet {
            print(&summary(problem, &design))?;
        }
        if let Some(errors) = &errors {
            print(&table(problem, errors))?;
            if let Some(doubt) = error::doubts(problem, &design, &all(problem)) {
                print(&format!("{doubt}\n"))?;
            }
        }
    }
    if let Some(directory) = &job.output {
        write_files(job, directory, problem, &design)?;
        if job.report {
            let (text, ends) = (summary(problem, &design), Ends::of_structure(&design));
            write_report(directory, problem, text, &ends, None)?;
        }
        if !job.quiet {
            tell(&format!("results in {}\n", shown(directory)));
        }
    }
    let lost: Vec<String> = problem
        .function_names
        .iter()
        .enumerate()
        .filter(|(f, _)| !design.function(*f).value.is_finite())
        .map(|(_, name)| format!("\"{name}\""))
        .collect();
    if !lost.is_empty() {
        let what = format!("{}: not finite: {}", problem.name, lost.join(", "));
        return Err(Failure::numerical(what));
    }
    Ok(DONE)
}

/// The files of solved structures.
pub(super) fn write_files(
    job: &Job,
    directory: &Path,
    problem: &Problem,
    design: &StaticDesign,
) -> Result<(), Failure> {
    if job.vtu {
        let fields = fields::fields(design).into_bytes();
        write_all(&[(directory.join("fields.vtu"), fields)])?;
    }
    draw(directory, figures::figures(problem, &[("", design)], None));
    Ok(())
}

/// Solved structures in full precision.
pub(super) fn as_json(
    problem: &Problem,
    design: &StaticDesign,
    errors: Option<&[FunctionError]>,
) -> Value {
    let mut functions = Map::new();
    for (f, name) in problem.function_names.iter().enumerate() {
        let found = design.function(f);
        let mut own = json!({"value": found.value, "unit": problem.function_unit(f)});
        if let Some(peak) = found.peak {
            let place = place(&design.statics.cases, &peak);
            own["true_maximum"] = json!({"value": peak.ratio, "place": place});
        }
        if let Some(smoothed) = design.smoothed(f) {
            add_smoothed(&mut own, &smoothed, found.peak.is_some());
        }
        if let Some(errors) = errors {
            add_errors(&mut own, problem, &errors[f]);
        }
        functions.insert(name.clone(), own);
    }
    let doubt = errors
        .is_some()
        .then(|| error::doubts(problem, design, &all(problem)));
    let mut found = json!({
        "name": problem.name,
        "mesh": size(design),
        "work": {
            "factorisations": design.counts.factorisations,
            "solves": design.counts.solves,
        },
        "functions": functions,
    });
    if let Some(doubt) = doubt.flatten() {
        found["warning"] = json!(doubt);
    }
    if let Some(warning) = design.large_rotation() {
        found["warnings"] = json!([warning]);
    }
    found
}

fn size(design: &StaticDesign) -> Value {
    let mesh = design.statics.mesh();
    json!({
        "nodes": mesh.nodes,
        "shells": mesh.shells.len(),
        "beams": mesh.beams.len(),
        "unknowns": design.unknowns(),
    })
}

/// Numbers of elements, nodes and unknowns, for messages.
fn counts(design: &StaticDesign) -> String {
    let mesh = design.statics.mesh();
    let (shells, beams) = (mesh.shells.len(), mesh.beams.len());
    let (nodes, unknowns) = (mesh.nodes, design.unknowns());
    format!("{shells} shells, {beams} beams, {nodes} nodes, {unknowns} unknowns")
}

pub(super) fn summary(problem: &Problem, design: &StaticDesign) -> String {
    let mut text = format!(
        "{}: {}; {} load cases ({} factorisations, {} solves)\n",
        problem.name,
        counts(design),
        design.statics.cases.len(),
        design.counts.factorisations,
        design.counts.solves,
    );
    let widths = problem.function_names.iter().map(|n| n.chars().count());
    let width = widths.max().unwrap_or(0);
    for (f, name) in problem.function_names.iter().enumerate() {
        let found = design.function(f);
        let unit = problem.function_unit(f);
        let unit = with_space(Some(&unit));
        let _ = write!(text, "  {name:width$}  {:>16.9e}{unit}", found.value);
        if let Some(peak) = found.peak {
            let place = place(&design.statics.cases, &peak);
            let _ = write!(text, "  true maximum {:.9e} at {place}", peak.ratio);
        }
        text += &told(design.smoothed(f), found.peak.is_some());
        text.push('\n');
    }
    if let Some(warning) = design.large_rotation() {
        let _ = writeln!(text, "  warning: {warning}");
    }
    text
}

/// What structures have, and what functions depend on.
pub(crate) fn explained(problem: &Problem, json: bool) -> Result<String, Failure> {
    let design = start(problem)?;
    let (gradients, _) = design
        .derivatives(problem, &all(problem))
        .map_err(Failure::numerical)?;
    let depends = |f: usize| -> Vec<&str> {
        let moved = gradients[f].iter().zip(&problem.variables);
        let moved = moved.filter(|(d, _)| d.value != 0.0);
        moved.map(|(_, variable)| variable.name.as_str()).collect()
    };
    let used: Vec<usize> = problem
        .objective
        .iter()
        .map(|o| o.function)
        .chain(problem.constraints.iter().map(|c| c.function))
        .collect();
    let idle: Vec<&str> = problem
        .variables
        .iter()
        .enumerate()
        .filter(|(i, _)| used.iter().all(|&f| gradients[f][*i].value == 0.0))
        .map(|(_, variable)| variable.name.as_str())
        .collect();
    if json {
        let functions: Map<String, Value> = problem
            .function_names
            .iter()
            .enumerate()
            .map(|(f, name)| (name.clone(), json!(depends(f))))
            .collect();
        let all = json!({
            "name": problem.name,
            "mesh": size(&design),
            "factor_entries": design.factor_entries(),
            "load_cases": design.statics.cases,
            "functions": functions,
            "idle_variables": idle,
        });
        let text = serde_json::to_string_pretty(&all).map_err(Failure::numerical)?;
        return Ok(text + "\n");
    }
    let mut text = format!(
        "{}: structures that do not move\n  mesh: {}\n",
        problem.name,
        counts(&design),
    );
    if let Some(entries) = design.factor_entries() {
        let _ = writeln!(
            text,
            "  stiffness: sparse Cholesky factor of {entries} entries ({:.1} MB), analysed once",
            8e-6 * entries as f64
        );
    }
    let _ = writeln!(text, "  load cases: {}", design.statics.cases.join(", "));
    let _ = writeln!(
        text,
        "  strains: {}",
        match design.statics.terms.von_karman {
            true => "with von Karman's terms, by Newton's method with load steps",
            false => "linear, one factorisation for all load cases",
        }
    );
    let _ = writeln!(
        text,
        "  gradients: one adjoint solve for each function and load case that it depends on"
    );
    for (f, name) in problem.function_names.iter().enumerate() {
        let all = depends(f);
        let shown = match all.len() {
            0 => "no variable".to_owned(),
            n if n == problem.variables.len() && n > 3 => format!("all {n} variables"),
            n if n > 8 => format!("{n} of {} variables", problem.variables.len()),
            _ => all.join(", "),
        };
        let _ = writeln!(text, "  {name} depends on {shown}");
    }
    if !idle.is_empty() && !used.is_empty() {
        let _ = writeln!(
            text,
            "  neither objective nor constraint depends on {}",
            idle.join(", ")
        );
    }
    Ok(text)
}

/// Measures error against time and mesh.
pub(crate) fn measure(
    job: &Job,
    problem: &Problem,
    function: Option<&str>,
    runs: u32,
) -> Result<u8, Failure> {
    let directory = match &job.output {
        Some(directory) => directory.clone(),
        None => Path::new("results/work-precision").join(&problem.name),
    };
    let chosen = match function {
        Some(name) => {
            let found = problem.function_names.iter().position(|own| own == name);
            let known = problem.function_names.join(", ");
            Some(found.ok_or_else(|| {
                Failure::bad_input(format!(
                    "found --function {name}, expected the name of a function: {known}"
                ))
            })?)
        }
        None => problem.objective.map(|objective| objective.function),
    };
    let _held = prepare_directory(&directory)?;
    let mut seen = |text: &str| {
        if !job.quiet {
            tell(text);
        }
    };
    let measured: PrecisionOfMesh =
        precision::measure(problem, chosen.unwrap_or(0), runs, &mut seen)
            .map_err(Failure::numerical)?;
    if !job.quiet {
        print(&measured.text())?;
    }
    let mut files = vec![
        ("work_precision.csv", measured.to_csv()),
        ("summary.txt", measured.text()),
    ];
    match plots::mesh_precision(&measured) {
        Ok(figure) => files.push(("work_precision.svg", figure)),
        Err(error) if !job.quiet => tell(&format!("no work_precision.svg: {error}\n")),
        Err(_) => {}
    }
    let files: Vec<_> = files
        .into_iter()
        .map(|(name, text)| (directory.join(name), text.into_bytes()))
        .collect();
    write_all(&files)?;
    if !job.quiet {
        tell(&format!("results in {}\n", shown(&directory)));
    }
    Ok(DONE)
}
