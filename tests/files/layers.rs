//! The folders of `src` form layers: a file imports only from folders above its own in the table of
//! `src/lib.rs`. Cargo keeps this order between crates; these tests keep it inside a crate of several
//! folders. The optimiser, which contains no mechanics, depends on no other crate of the workspace.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Crates whose folders are layers of their own; the folders `cli` and `library` belong to the root.
const OF_SEVERAL_FOLDERS: [&str; 2] = ["mathematics", "mechanics"];

/// Macros at the root of a crate.
const MACROS: [&str; 1] = ["parameters"];

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

/// The folders of the table in `src/lib.rs`, from the top: paths below `src`.
pub(super) fn table() -> Vec<String> {
    let text = read(&source().join("lib.rs"));
    let row = |line: &str| {
        let cell = line.strip_prefix("//! | `")?;
        Some(cell.split_once("` |")?.0.to_owned())
    };
    text.lines().filter_map(row).collect()
}

/// The name that the imports use for a folder of the table.
pub(super) fn layer(folder: &str) -> &str {
    folder.rsplit('/').next().unwrap_or(folder)
}

/// The folder of the crate's root file of a folder of the table.
fn root(folder: &str) -> PathBuf {
    let first = folder.split('/').next().unwrap_or(folder);
    let own = source().join(first);
    if own.join("Cargo.toml").is_file() {
        own
    } else {
        source()
    }
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

/// Depth of a file's module below the root of its crate.
fn depth(file: &Path, root: &Path) -> usize {
    let parts = file.strip_prefix(root).expect("below the crate");
    let shared = file.ends_with("mod.rs") || file.ends_with("lib.rs");
    parts.components().count() - usize::from(shared)
}

/// Faults of the imports of a file of `folder`, as `file:line: …`. What no layer is called is a module
/// of the crate itself.
fn offences(table: &[String], folder: &str, file: &str, imports: &[Import]) -> Vec<String> {
    let rank = |name: &str| table.iter().position(|known| layer(known) == name);
    let own = rank(layer(folder));
    let alone = root(folder) == source().join(folder);
    let is_own = |name: &str| alone && root(folder).join(format!("{name}.rs")).is_file();
    let wrong = |import: &&Import| match rank(&import.folder) {
        Some(other) => Some(other) > own && !is_own(&import.folder),
        None => !alone && !MACROS.contains(&&*import.folder),
    };
    let tell = |import: &Import| {
        format!(
            "{file}:{}: {} imports {}, which does not stand above it",
            import.line,
            layer(folder),
            import.folder
        )
    };
    imports.iter().filter(wrong).map(tell).collect()
}

/// The folders in a folder.
fn folders(of: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(of).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let name = |path: PathBuf| path.file_name().expect("a name").to_string_lossy().into();
    paths.filter(|path| path.is_dir()).map(name).collect()
}

/// The modules that a root file declares.
fn modules(file: &Path) -> BTreeSet<String> {
    let text = read(file);
    let lines = text
        .lines()
        .map(|line| line.strip_prefix("pub ").unwrap_or(line));
    let name = |line: &str| Some(line.strip_prefix("mod ")?.strip_suffix(';')?.to_owned());
    lines.filter_map(name).collect()
}

#[test]
fn the_table_lists_the_folders_on_disk_and_the_modules_of_the_crates() {
    let table = table();
    let listed: BTreeSet<String> = table.iter().cloned().collect();
    assert_eq!(listed.len(), table.len(), "a folder is listed twice");
    let mut on_disk = BTreeSet::new();
    for folder in folders(&source()) {
        if !OF_SEVERAL_FOLDERS.contains(&&*folder) {
            on_disk.insert(folder);
            continue;
        }
        let inner = folders(&source().join(&folder));
        assert_eq!(modules(&source().join(&folder).join("lib.rs")), inner);
        on_disk.extend(inner.iter().map(|inner| format!("{folder}/{inner}")));
    }
    assert_eq!(listed, on_disk);
    let of_root = |folder: &&String| root(folder) == source();
    let in_root: BTreeSet<String> = table.iter().filter(of_root).cloned().collect();
    assert_eq!(modules(&source().join("lib.rs")), in_root);
    // What runs the command over processes stands behind the command.
    assert!(table.ends_with(&["cli".to_owned(), "mpi".to_owned()]));
    let entries = std::fs::read_dir(source()).expect("src");
    let mut loose = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file());
    let known = |path: PathBuf| path.ends_with("lib.rs") || path.ends_with("main.rs");
    assert!(loose.all(known), "files outside the folders");
}

/// Mathematics and the optimiser are of use without the rest.
#[test]
fn the_optimiser_depends_on_no_other_crate_of_the_workspace() {
    for name in ["mathematics", "optimiser"] {
        let manifest = read(&source().join(name).join("Cargo.toml"));
        let (_, dependencies) = manifest.split_once("[dependencies]").expect("a list");
        assert!(dependencies.contains("nalgebra"), "{name}");
        assert!(!dependencies.contains("flexbody"), "{name}");
    }
}

#[test]
fn every_folder_imports_from_above_only() {
    let table = table();
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for folder in &table {
        for file in files(&source().join(folder)) {
            let imports = imports(&read(&file), depth(&file, &root(folder)));
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
    let file = "src/mechanics/system/joints.rs";
    let wrong = offences(&table(), "mechanics/system", file, &found);
    let told = |line: usize, name: &str| {
        format!("{file}:{line}: system imports {name}, which does not stand above it")
    };
    assert_eq!(
        wrong,
        [told(4, "driver"), told(7, "report"), told(8, "cli")]
    );
    // A module of a crate of one folder is its own.
    let own = [import(1, "pages"), import(2, "cli")];
    let wrong = offences(&table(), "report", "src/report/lib.rs", &own);
    assert_eq!(
        wrong,
        ["src/report/lib.rs:2: report imports cli, which does not stand above it"]
    );
}
