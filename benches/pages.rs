//! The page of every problem: its size, what it takes beside the simulation alone, and what it leaves out.
//!
//! `cargo bench --bench pages` writes the pages to `target/pages/` and prints the table of `results/pages.md`. Problems with a
//! record give the page of their optimum, the others that of their start. `-- four_bar trebuchet` takes the problems of these
//! names.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Folders of problem files.
const PROBLEMS: [&str; 4] = [
    "problems",
    "problems/flexible",
    "problems/benchmarks",
    "problems/extreme",
];

fn problems() -> Vec<PathBuf> {
    let of = |folder: &str| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut all: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        all.retain(|path| path.extension().is_some_and(|end| end == "json"));
        all.sort();
        all
    };
    PROBLEMS.into_iter().flat_map(of).collect()
}

/// Seconds of a run of the program; `None` if it fails.
fn seconds(words: &[&Path]) -> Option<f64> {
    let start = Instant::now();
    let mut command = Command::new(env!("CARGO_BIN_EXE_optimize"));
    let out = command.args(words).output().ok()?;
    out.status.success().then(|| start.elapsed().as_secs_f64())
}

/// Makes a page in `directory`: seconds with and without it.
fn made(problem: &Path, name: &str, directory: &Path) -> Option<[f64; 2]> {
    let _ = std::fs::remove_dir_all(directory);
    let record = Path::new("results").join(name).join("optimum.json");
    if record.exists() {
        std::fs::create_dir_all(directory).ok()?;
        for file in ["optimum.json", "history.csv", "state.json"] {
            let _ = std::fs::copy(record.with_file_name(file), directory.join(file));
        }
        let plot = seconds(&[Path::new("plot"), directory])?;
        return Some([seconds(&[Path::new("report"), directory])?, plot]);
    }
    let [simulate, output, quiet, report] =
        ["simulate", "--output", "--quiet", "--report"].map(Path::new);
    let alone = seconds(&[simulate, problem, output, directory, quiet])?;
    let with = seconds(&[simulate, problem, output, directory, quiet, report])?;
    Some([with, alone])
}

fn main() -> ExitCode {
    let names: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .collect();
    println!("| problem | page | seconds | with figures alone | left out |\n|---|---|---|---|---|");
    let mut right = true;
    for problem in problems() {
        let text = std::fs::read_to_string(&problem).unwrap_or_default();
        let document: Value = serde_json::from_str(&text).unwrap_or_default();
        let name = document["name"].as_str().unwrap_or_default().to_owned();
        if !names.is_empty() && !names.contains(&name) {
            continue;
        }
        let directory = Path::new("target/pages").join(&name);
        let times = made(&problem, &name, &directory);
        let page = std::fs::read_to_string(directory.join("report.html"));
        let (Some([with, alone]), Ok(page)) = (times, page) else {
            right = false;
            println!("| {name} | none | | | |");
            continue;
        };
        let data = page.split_once("id=\"data\">").map_or("", |(_, rest)| rest);
        let data = data.split_once("</script>").map_or("", |(data, _)| data);
        let data: Value = serde_json::from_str(data).unwrap_or_default();
        let notes = data["notes"].as_array().into_iter().flatten();
        let notes: Vec<&str> = notes.filter_map(Value::as_str).collect();
        println!(
            "| {name} | {:.2} MB | {with:.2} | {alone:.2} | {} |",
            1e-6 * page.len() as f64,
            notes.join(" ")
        );
    }
    match right {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}
