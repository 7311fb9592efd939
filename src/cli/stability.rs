//! `optimize stability`.

use super::arguments::Suite;
use super::progress::Counter;
use super::{DONE, Failure, NOT_REACHED, print, shown, tell};
use crate::driver::stability::{is_named, names, stability as run};
use crate::report::{StabilityRow, prepare_directory, write_all};
use std::path::Path;

/// Runs the stability suite and writes its table.
pub(crate) fn stability(asked: &Suite) -> Result<u8, Failure> {
    let wanted = |case: &str| asked.only.as_ref().is_none_or(|only| is_named(case, only));
    if let (Some(only), false) = (&asked.only, names(false).iter().any(|case| wanted(case))) {
        let mut families: Vec<String> = Vec::new();
        for name in names(false) {
            let family = name.split('/').next().unwrap_or_default().to_owned();
            if !families.contains(&family) {
                families.push(family);
            }
        }
        return Err(Failure::bad_input(format!(
            "found --only {only:?}, expected a case or the beginning of its name, such as {}",
            families.join(", ")
        )));
    }
    let directory = match (&asked.output, &asked.only) {
        (Some(directory), _) => Some(directory.as_path()),
        (None, None) => Some(Path::new("results/stability")),
        (None, Some(_)) => None,
    };
    // The directory is locked and known to be writable before the runs.
    let _held = match directory {
        Some(directory) => Some(prepare_directory(directory)?),
        None => None,
    };
    let cases = names(false).into_iter();
    let cases = cases.filter(|case| wanted(case)).count();
    let counter = (!asked.quiet).then(|| Counter::new("cases", cases));
    let seen = |row: &StabilityRow| {
        if let Some(counter) = &counter {
            tell(&line(row));
            counter.one();
        }
    };
    let table = run(wanted, asked.seconds, &seen);
    drop(counter);
    // The table is printed first, so a failure to write does not lose it.
    if !asked.quiet {
        print(&format!("{}\n", table.summary()))?;
    }
    if let Some(directory) = directory {
        let files = [
            ("stability.md", table.to_markdown()),
            ("stability.csv", table.to_csv()),
        ];
        let files = files.map(|(name, text)| (directory.join(name), text.into_bytes()));
        write_all(&files)?;
        if !asked.quiet {
            tell(&format!("results in {}\n", shown(directory)));
        }
    }
    Ok(match table.has_failures() {
        true => NOT_REACHED,
        false => DONE,
    })
}

fn line(row: &StabilityRow) -> String {
    let number = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| format!("{x:.1e}"));
    let words = row.outcome.words().replace('\n', " ");
    format!(
        "{:48} {:16} error {:>7}  energy {:>7}  gradient {:>7}  {words}\n",
        row.name(),
        row.outcome.class(),
        number(row.error),
        number(row.energy_drift),
        number(row.gradient_error),
    )
}
