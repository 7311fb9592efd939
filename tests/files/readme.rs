//! The example of README.md runs and has the stated result. Paths in the documents exist.

use crate::reference::documents::optimised;
use flexbody_problem::Problem;
use std::path::{Path, PathBuf};

#[test]
fn the_example_of_the_readme_finds_the_radius_of_gyration() {
    let readme = include_str!("../../README.md");
    let (_, example) = readme.split_once("```json\n").expect("an example");
    let (example, _) = example.split_once("```").expect("its end");
    let problem = Problem::parse(example, "README.md", &[]).expect("no faults");
    let done = optimised(&problem);
    assert!(done.outcome.converged());
    let pin = done.optimum.design["pin"].value;
    // The angular acceleration m g d cos θ / (I + m d²) is largest at d² = I/m for any angle.
    assert!((pin + (1.0_f64 / 12.0).sqrt()).abs() < 2e-5, "{pin}");
}

/// Documents at the root and in docs/: path, and text without code blocks.
fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<PathBuf> = [root.to_path_buf(), root.join("docs")]
        .iter()
        .flat_map(|directory| std::fs::read_dir(directory).expect("a directory").flatten())
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
        .collect();
    paths.sort();
    assert!(paths.len() > 8);
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a document");
        let prose = text.split("```").step_by(2).collect();
        (path, prose)
    };
    paths.into_iter().map(read).collect()
}

/// Expands `a/{b,c}.rs` to two paths.
fn expanded(text: &str) -> Vec<String> {
    match text
        .split_once('{')
        .and_then(|(head, rest)| Some((head, rest.split_once('}')?)))
    {
        Some((head, (inner, tail))) => {
            let all = inner.split(',');
            all.map(|part| format!("{head}{part}{tail}")).collect()
        }
        None => vec![text.to_owned()],
    }
}

/// All files below a directory, by their paths in the project.
fn below(directory: &Path, all: &mut Vec<String>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for entry in std::fs::read_dir(directory).expect("a directory").flatten() {
        let path = entry.path();
        let inside = path.strip_prefix(root).expect("below the root");
        all.push(inside.to_string_lossy().replace('\\', "/"));
        if path.is_dir() {
            below(&path, all);
        }
    }
}

/// Every source, test, problem and document that a document names in its prose exists; so do the
/// targets of its links, with their headings.
#[test]
fn paths_and_links_of_the_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [
        "src", "tests", "docs", "problems", "benches", "examples", "results", ".ci",
    ];
    let mut known = Vec::new();
    for folder in folders {
        known.push(folder.to_owned());
        below(&root.join(folder), &mut known);
    }
    // A file may be named by the end of its path.
    let is_known = |name: &str| {
        let name = name.trim_end_matches('/');
        let end = format!("/{name}");
        known
            .iter()
            .any(|path| path == name || path.ends_with(&end))
    };
    let mut wrong = Vec::new();
    let (mut paths, mut links) = (0, 0);
    for (document, prose) in documents() {
        let named = |what: &str| format!("{}: {what}", document.display());
        for quoted in prose.split('`').skip(1).step_by(2) {
            if quoted.contains([' ', '<', '*', '(', '…', '=']) || quoted.starts_with(['/', '-']) {
                continue;
            }
            for path in expanded(quoted) {
                let first = path.split('/').next().unwrap_or_default();
                let in_folder = path.contains('/') && folders.contains(&first);
                if in_folder || path.ends_with(".rs") {
                    paths += 1;
                    // Results are created on request.
                    if !is_known(&path) && !path.starts_with("results/") {
                        wrong.push(named(&path));
                    }
                }
            }
        }
        for link in prose
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            if link.contains("://") {
                continue;
            }
            links += 1;
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => document.clone(),
                file => document.parent().expect("a folder").join(file),
            };
            let Ok(metadata) = std::fs::metadata(&target) else {
                wrong.push(named(link));
                continue;
            };
            if !heading.is_empty() && metadata.is_file() {
                let text = std::fs::read_to_string(&target).expect("a document");
                let mut headings = text.lines().filter(|line| line.starts_with('#'));
                if !headings.any(|line| slug(line) == heading) {
                    wrong.push(named(link));
                }
            }
        }
    }
    assert!(paths > 100 && links > 10, "{paths} {links}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The anchor of a heading.
fn slug(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}
