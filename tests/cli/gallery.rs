//! `docs/gallery.md` shows every problem: a line, a command, and the picture of its result where there is one.
//! `FLEXBODY_WRITE=1 cargo test --release --test cli gallery` writes it.

use crate::program::{json, read};
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

fn gallery() -> String {
    let mut text = String::from(
        "# Gallery\n\nEvery problem of the folder `problems`, with the command that solves it. \
         `--report` adds a page with the machine in motion.\n",
    );
    for (title, folder) in [
        ("Rigid machines and structures", "problems"),
        ("Flexible machines", "problems/flexible"),
        ("Published benchmarks", "problems/benchmarks"),
        ("Extreme scenes", "problems/extreme"),
    ] {
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
                false => format!("optimize simulate {folder}/{file} --output {name}"),
            };
            let pictures = ["motion.svg", "thickness.svg", "deformed.svg"];
            let picture = pictures
                .iter()
                .find(|own| root().join("results").join(name).join(own).exists());
            match picture {
                Some(picture) => {
                    let _ = write!(
                        text,
                        "\n### {name}\n\n{line}\n\n```sh\n{command}\n```\n\n![{name}: start and optimum](../results/{name}/{picture})\n"
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
    let wanted = gallery();
    if std::env::var_os("FLEXBODY_WRITE").is_some() {
        std::fs::write(&path, &wanted).expect("is written");
    }
    assert!(
        read(&path) == wanted,
        "docs/gallery.md is not that of the problems; FLEXBODY_WRITE=1 writes it"
    );
}
