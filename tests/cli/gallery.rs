//! `docs/gallery.md` shows every problem: a line, a command, and the picture of its result where there is one.
//! `FLEXBODY_WRITE=1 cargo test --release --test cli gallery` writes it, and simulates what has no picture yet.

use crate::program::{json, optimize, read, scratch};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The problem files of a folder, in order.
fn problems(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).expect("a folder");
    let mut all: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    all.retain(|path| path.extension().is_some_and(|end| end == "json"));
    all.sort();
    all
}

/// The first sentence of a description.
fn sentence(text: &str) -> String {
    let mut ends = text.match_indices(". ");
    let is_end = |at: usize| text[at + 2..].starts_with(char::is_uppercase);
    let end = ends
        .find(|&(at, _)| is_end(at))
        .map_or(text.len(), |(at, _)| at + 1);
    text[..end].replace('|', "\\|")
}

/// The chapters and their folders.
const FOLDERS: [(&str, &str); 4] = [
    ("Rigid machines and structures", "problems"),
    ("Flexible machines", "problems/flexible"),
    ("Published benchmarks", "problems/benchmarks"),
    ("Extreme scenes", "problems/extreme"),
];

/// Pictures of a result, the most telling first.
const PICTURES: [&str; 5] = [
    "fit.svg",
    "campbell.svg",
    "motion.svg",
    "thickness.svg",
    "deformed.svg",
];

/// Size of a picture [bytes] from which two instants suffice.
const LARGE: usize = 600_000;

/// The picture of a problem: of its committed result, of its first case there, or of its start in `docs/gallery`. Path as seen
/// from `docs`.
fn picture(document: &Value) -> Option<String> {
    let name = document["name"].as_str().expect("a name");
    let cases = document["cases"].as_object().into_iter().flatten();
    let folders = cases.take(1).map(|(case, _)| format!("{name}/{case}"));
    let folders = std::iter::once(name.to_owned()).chain(folders);
    let results =
        folders.flat_map(|folder| PICTURES.map(|own| format!("../results/{folder}/{own}")));
    let start = format!("gallery/{name}.svg");
    let mut all = results.chain([start]);
    all.find(|path| root().join("docs").join(path).exists())
}

/// Simulates the start of a problem, and keeps its picture in `docs/gallery`.
fn draw(problem: &Path, name: &str) {
    let at = scratch();
    let file = problem.to_str().expect("a path");
    let drawn = |file: &str| -> Option<Vec<u8>> {
        let ran = optimize(at.path(), &["simulate", file, "--output", "out"]);
        println!("{name}: exit code {}", ran.code);
        let mut all = PICTURES.iter().map(|own| at.path().join("out").join(own));
        all.find_map(|path| std::fs::read(path).ok())
    };
    let mut picture = drawn(file);
    // A picture of a thousand bodies is large at every instant.
    if picture.as_ref().is_some_and(|own| own.len() > LARGE) {
        let mut document = json(&read(problem));
        document["plot"]["snapshots"] = 2.into();
        std::fs::write(at.path().join("two.json"), document.to_string()).expect("is written");
        picture = drawn("two.json");
    }
    if let Some(bytes) = picture {
        let path = root().join("docs/gallery").join(format!("{name}.svg"));
        std::fs::write(path, bytes).expect("is written");
    }
}

fn gallery() -> String {
    let mut text = String::from(
        "# Gallery\n\nEvery problem of the folder `problems`, with the command that solves it. \
         `--report` adds a page with the machine in motion.\n",
    );
    for (title, folder) in FOLDERS {
        let mut plain = String::new();
        let _ = write!(text, "\n## {title}\n");
        for path in problems(folder) {
            let document = json(&read(&path));
            let file = path
                .file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            let name = document["name"].as_str().expect("a name");
            let line = sentence(document["description"].as_str().unwrap_or(""));
            let is_design = ["objective", "constraints"]
                .iter()
                .any(|key| document.get(key).is_some());
            let command = match is_design {
                true => format!("optimize {folder}/{file}"),
                false => format!("optimize simulate {folder}/{file} --output results/{name}"),
            };
            match picture(&document) {
                Some(picture) => {
                    let what = match picture.starts_with("..") {
                        true => "start and optimum",
                        false => "start",
                    };
                    let _ = write!(
                        text,
                        "\n### {name}\n\n{line}\n\n```sh\n{command}\n```\n\n![{name}: {what}]({picture})\n"
                    );
                }
                None => {
                    let _ = writeln!(
                        plain,
                        "| [{name}](../{folder}/{file}) | {line} | `{command}` |"
                    );
                }
            }
        }
        if !plain.is_empty() {
            let _ = write!(text, "\n| problem | | command |\n|---|---|---|\n{plain}");
        }
    }
    text
}

#[test]
fn the_gallery_shows_every_problem() {
    let path = root().join("docs/gallery.md");
    if std::env::var_os("FLEXBODY_WRITE").is_some() {
        for folder in FOLDERS.map(|(_, folder)| folder) {
            for problem in problems(folder) {
                let document = json(&read(&problem));
                let name = document["name"].as_str().expect("a name");
                if picture(&document).is_none() {
                    draw(&problem, name);
                }
            }
        }
    }
    let wanted = gallery();
    if std::env::var_os("FLEXBODY_WRITE").is_some() {
        std::fs::write(&path, &wanted).expect("is written");
    }
    assert!(
        read(&path) == wanted,
        "docs/gallery.md is not that of the problems; FLEXBODY_WRITE=1 writes it"
    );
}
