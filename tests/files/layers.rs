//! The folders of `src` form layers: a file imports only from folders above its own in the table of
//! `src/lib.rs`. The optimiser, which contains no mechanics, imports only from its own folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Folders that import from no other folder.
const INDEPENDENT: [&str; 1] = ["optimiser"];

/// An import of a folder of the crate.
#[derive(Debug, PartialEq)]
struct Import {
    line: usize,
    /// The folder, or "crate" for an item of the crate's root.
    folder: String,
}

pub(super) fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

pub(super) fn read(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a source file")
}

/// The folders of the table in `src/lib.rs`, from the top.
fn table() -> Vec<String> {
    let text = read(&source().join("lib.rs"));
    let row = |line: &str| {
        let cell = line.strip_prefix("//! | `")?;
        Some(cell.split_once("` |")?.0.to_owned())
    };
    text.lines().filter_map(row).collect()
}

/// The Rust files of a folder and its subfolders, in order.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            all.extend(files(&path));
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            all.push(path);
        }
    }
    all
}

/// The text without comments; the lines are kept.
pub(super) fn code(text: &str) -> String {
    text.lines()
        .map(|line| line.split("//").next().unwrap_or("").to_owned() + "\n")
        .collect()
}

pub(super) fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    &text[..end.unwrap_or(text.len())]
}

/// The first names of a list `{a::b, c, d::{e, f}}`, each with its position in `text`.
fn names_in_braces(text: &str) -> Vec<(usize, String)> {
    let (mut depth, mut expected, mut names) = (0, false, Vec::new());
    for (at, c) in text.char_indices() {
        match c {
            '{' => {
                depth += 1;
                expected = depth == 1;
            }
            '}' if depth == 1 => break,
            '}' => depth -= 1,
            ',' => expected = depth == 1,
            c if expected && !c.is_whitespace() => {
                names.push((at, identifier(&text[at..]).to_owned()));
                expected = false;
            }
            _ => {}
        }
    }
    names
}

/// All folders that a file imports by `crate::`, and by more `super::` than its `depth` below the
/// root allows (each inline module above allows one more).
fn imports(text: &str, depth: usize) -> Vec<Import> {
    let code = code(text);
    let line = |at: usize| code[..at].matches('\n').count() + 1;
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let start = at + "crate::".len();
        let names = if code[start..].starts_with('{') {
            names_in_braces(&code[start..])
        } else {
            vec![(0, identifier(&code[start..]).to_owned())]
        };
        found.extend(names.into_iter().map(|(offset, folder)| Import {
            line: line(start + offset),
            folder,
        }));
    }
    let mut allowed = depth - 1;
    for (number, text) in code.lines().enumerate() {
        if text.contains("mod ") && text.trim_end().ends_with('{') {
            allowed += 1;
        }
        let climbs = "super::".repeat(allowed + 1);
        if let Some(at) = text.find(&climbs) {
            found.push(Import {
                line: number + 1,
                folder: identifier(&text[at + climbs.len()..]).to_owned(),
            });
        }
    }
    found
}

/// Depth of a file's module below the crate's root.
fn depth(file: &Path) -> usize {
    let parts = file
        .strip_prefix(source())
        .expect("below src")
        .components()
        .count();
    parts - usize::from(file.ends_with("mod.rs"))
}

/// Faults of the imports of a file of `folder`, as `file:line: …`.
fn offences(table: &[String], folder: &str, file: &str, imports: &[Import]) -> Vec<String> {
    let rank = |name: &str| table.iter().position(|known| known == name);
    let own = rank(folder);
    let wrong = |import: &&Import| {
        let other = rank(&import.folder);
        let independent = INDEPENDENT.contains(&folder);
        // What tests share is there for the tests inside files alone: nothing else compiles with it.
        let by_tests = import.folder == "tests";
        let outside = import.folder != folder && !by_tests;
        outside && (other.is_none() || other > own || independent)
    };
    let tell = |import: &Import| {
        format!(
            "{file}:{}: {folder} imports {}, which does not stand above it",
            import.line, import.folder
        )
    };
    imports.iter().filter(wrong).map(tell).collect()
}

#[test]
fn the_table_lists_the_folders_on_disk_and_the_modules_of_the_crate() {
    let table = table();
    let listed: BTreeSet<&str> = table.iter().map(String::as_str).collect();
    assert_eq!(listed.len(), table.len(), "a folder is listed twice");
    let folders: BTreeSet<String> = std::fs::read_dir(source())
        .expect("src")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().expect("a name").to_string_lossy().into())
        .collect();
    assert_eq!(listed, folders.iter().map(String::as_str).collect());
    let text = read(&source().join("lib.rs"));
    let modules: BTreeSet<&str> = text
        .lines()
        .map(|line| line.strip_prefix("pub ").unwrap_or(line))
        .filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'))
        .filter(|module| *module != "tests")
        .collect();
    assert_eq!(listed, modules);
    assert_eq!(table.last().map(String::as_str), Some("cli"));
    let loose: Vec<PathBuf> = std::fs::read_dir(source())
        .expect("src")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file())
        .filter(|path| {
            !["lib.rs", "main.rs", "tests.rs"]
                .iter()
                .any(|own| path.ends_with(own))
        })
        .collect();
    assert!(loose.is_empty(), "files outside the folders: {loose:?}");
}

#[test]
fn every_folder_imports_from_above_only() {
    let table = table();
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for folder in &table {
        for file in files(&source().join(folder)) {
            let imports = imports(&read(&file), depth(&file));
            seen += imports.len();
            let name = file.strip_prefix(env!("CARGO_MANIFEST_DIR"));
            let name = name.expect("below the package").display().to_string();
            wrong.extend(offences(&table, folder, &name, &imports));
        }
    }
    assert!(seen > 100, "only {seen} imports were found");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn an_import_from_below_is_told_with_file_and_line() {
    let text = "//! use crate::cli::nothing;\n\
                use crate::math::{Mat3, Vec3};\n\
                use crate::{\n    driver::{simulate, check},\n    linalg,\n};\n\
                fn f() { crate::report::summary() }\n\
                use super::super::cli::run;\n\
                mod tests {\n    use super::super::joints;\n}\n";
    let import = |line, folder: &str| Import {
        line,
        folder: folder.into(),
    };
    let found = imports(text, 2);
    assert_eq!(
        found,
        [
            import(2, "math"),
            import(4, "driver"),
            import(5, "linalg"),
            import(7, "report"),
            import(8, "cli"),
        ]
    );
    let wrong = offences(&table(), "system", "src/system/joints.rs", &found);
    assert_eq!(
        wrong,
        [
            "src/system/joints.rs:4: system imports driver, which does not stand above it",
            "src/system/joints.rs:7: system imports report, which does not stand above it",
            "src/system/joints.rs:8: system imports cli, which does not stand above it",
        ]
    );
    let independent = [import(1, "math"), import(2, "optimiser")];
    let wrong = offences(
        &table(),
        "optimiser",
        "src/optimiser/solve.rs",
        &independent,
    );
    assert_eq!(
        wrong,
        ["src/optimiser/solve.rs:1: optimiser imports math, which does not stand above it"]
    );
}
