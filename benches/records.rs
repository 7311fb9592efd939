//! The records in `results/`, made again by the commands that made them.
//!
//! `cargo bench --bench records` optimises every problem with a record and compares both (see `optimize compare`). It
//! takes half an hour, so CI runs the short ones alone; run it by night. `-- four_bar trebuchet` takes the problems of
//! these names, `-- --write` renews the records instead.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};
use std::time::Instant;

/// Folders of problem files.
const PROBLEMS: [&str; 3] = ["problems", "problems/flexible", "problems/extreme"];

/// The problems with a record, by name.
fn recorded() -> Vec<(String, PathBuf)> {
    let entries = std::fs::read_dir("results").into_iter().flatten().flatten();
    let with_record = entries.filter(|entry| entry.path().join("optimum.json").exists());
    let mut names: Vec<String> = with_record
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    names.sort();
    let file = |name: &String| {
        let paths = PROBLEMS.map(|folder| Path::new(folder).join(format!("{name}.json")));
        paths.into_iter().find(|path| path.exists())
    };
    let found = names.into_iter().map(|name| {
        let path = file(&name).unwrap_or_default();
        (name, path)
    });
    found.collect()
}

fn optimize(words: &[&Path]) -> std::io::Result<Output> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_optimize"));
    command.args(words).arg("--quiet").output()
}

/// Makes a record again. Gives what differs, if something does.
fn differs(problem: &Path, made: &Path, kept: &Path) -> Result<(), String> {
    let failed = |out: Output| {
        let text = [out.stdout, out.stderr].map(|x| String::from_utf8_lossy(&x).into_owned());
        text.concat()
    };
    let out = optimize(&[problem, Path::new("--output"), made]).map_err(|e| e.to_string())?;
    if !out.status.success() {
        return Err(failed(out));
    }
    let out = optimize(&[Path::new("compare"), made, kept]).map_err(|e| e.to_string())?;
    match out.status.success() {
        true => Ok(()),
        false => Err(failed(out)),
    }
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let write = words.iter().any(|word| word == "--write");
    let names: Vec<&String> = words
        .iter()
        .filter(|word| !word.starts_with("--"))
        .collect();
    let Ok(temporary) = tempfile::tempdir() else {
        eprintln!("there is no directory for temporary files");
        return ExitCode::FAILURE;
    };
    println!("| record | seconds | |\n|---|---|---|");
    let mut right = true;
    for (name, problem) in recorded() {
        if !names.is_empty() && !names.contains(&&name) {
            continue;
        }
        let kept = Path::new("results").join(&name);
        let made = match write {
            true => kept.clone(),
            false => temporary.path().join(&name),
        };
        let start = Instant::now();
        let found = match problem.exists() {
            true => differs(&problem, &made, &kept),
            false => Err("no problem has this name".into()),
        };
        let verdict = match (&found, write) {
            (Ok(()), true) => "renewed",
            (Ok(()), false) => "the same",
            (Err(_), _) => "DIFFERS",
        };
        println!(
            "| {name} | {:.0} | {verdict} |",
            start.elapsed().as_secs_f64()
        );
        if let Err(words) = found {
            right = false;
            eprintln!("{name}: {words}");
        }
    }
    if right {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
