//! `optimize compare`, `optimize plot`, `optimize report` and `optimize schema`.

use super::arguments::Comparison;
use super::earlier::state_in;
use super::{DONE, Failure, NOT_REACHED, command, print, record, shown, tell};
use crate::driver::recorded::Recorded;
use crate::figures;
use crate::figures::report_page::page;
use crate::library::made::made;
use crate::library::written::REPORT;
use crate::report::{
    History, Optimum, Tolerances, prepare_directory, read_text, summary, write_all,
};
use std::path::{Path, PathBuf};

/// Compares two records.
pub(crate) fn compare(files: &Comparison) -> Result<u8, Failure> {
    let ((_, new), (_, baseline)) = (record(&files.new)?, record(&files.baseline)?);
    let comparison = crate::report::compare(&new, &baseline, &Tolerances::default());
    print(&comparison.text())?;
    Ok(if comparison.passed() {
        DONE
    } else {
        NOT_REACHED
    })
}

/// Draws the figures of a result directory from its record.
pub(crate) fn plot(directory: &Path) -> Result<u8, Failure> {
    from_record(directory, |_, recorded, history| {
        let ends = recorded.ends();
        let named = |(name, bytes): figures::NamedFile| (PathBuf::from(name), bytes);
        let mut all: Vec<(PathBuf, Vec<u8>)> = figures::of_ends(&recorded.problem, &ends, history)
            .into_iter()
            .map(named)
            .collect();
        let alone = ends
            .cases
            .iter()
            .filter(|(case, _)| !case.problem.is_phase());
        for (case, ends) in alone {
            let own = figures::of_designs(&case.problem, ends).into_iter();
            all.extend(own.map(|(name, bytes)| (Path::new(&case.name).join(name), bytes)));
        }
        Ok(all)
    })
}

/// Writes the page of a result directory from its record.
pub(crate) fn report(directory: &Path) -> Result<u8, Failure> {
    from_record(directory, |optimum, recorded, history| {
        let of_run = Some((optimum, history));
        let page = page(
            &recorded.problem,
            summary(optimum),
            &recorded.ends(),
            (of_run, made(&command())),
        );
        let page = page.map_err(Failure::numerical)?;
        Ok(vec![(REPORT.into(), page.into_bytes())])
    })
}

/// Writes files beside a record, made from it.
fn from_record(
    directory: &Path,
    make: impl Fn(&Optimum, &Recorded, &History) -> Result<Vec<(PathBuf, Vec<u8>)>, Failure>,
) -> Result<u8, Failure> {
    // The record itself stands for its directory.
    let directory = match (directory.is_file(), directory.parent()) {
        (true, Some(above)) if directory.ends_with("optimum.json") => above,
        _ => directory,
    };
    let (_, optimum) = record(directory)?;
    let history = read_text(&directory.join("history.csv"))?;
    let history = History::from_csv(&history)?;
    let state = state_in(directory);
    let _held = prepare_directory(directory)?;
    let recorded = Recorded::of(&optimum, state.as_ref(), directory).map_err(Failure::bad_input)?;
    let mut of_cases = Vec::new();
    for case in recorded.problem.case_names() {
        of_cases.push(prepare_directory(&directory.join(case))?);
    }
    let files = make(&optimum, &recorded, &history)?.into_iter();
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .map(|(name, bytes)| (directory.join(name), bytes))
        .collect();
    write_all(&files)?;
    let names = files.iter().map(|(path, _)| format!("{}\n", shown(path)));
    tell(&names.collect::<String>());
    Ok(DONE)
}

/// Prints the JSON Schema of problem files.
pub(crate) fn schema() -> Result<u8, Failure> {
    let text = serde_json::to_string_pretty(&crate::problem::schema_with_expressions())
        .map_err(Failure::bad_input)?;
    print(&(text + "\n"))?;
    Ok(DONE)
}
