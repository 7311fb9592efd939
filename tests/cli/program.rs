//! Runs of the program in scratch directories, and what they leave there.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

pub const HAMMER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hammer.json");

pub const TREBUCHET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");

/// What a run of the program left.
#[derive(Debug)]
pub struct Ran {
    pub code: i32,
    pub out: String,
    pub err: String,
}

pub fn scratch() -> TempDir {
    tempfile::tempdir().expect("a scratch directory")
}

pub fn optimize(directory: &Path, arguments: &[&str]) -> Ran {
    let done = Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(directory)
        .args(arguments)
        .output()
        .expect("the program runs");
    Ran {
        code: done.status.code().expect("ended by itself"),
        out: String::from_utf8(done.stdout).expect("UTF-8"),
        err: String::from_utf8(done.stderr).expect("UTF-8"),
    }
}

/// Runs the program and asserts its exit code.
pub fn expect(code: i32, directory: &Path, arguments: &[&str]) -> Ran {
    let ran = optimize(directory, arguments);
    assert_eq!(ran.code, code, "{arguments:?}\n{}{}", ran.out, ran.err);
    ran
}

/// All files below a directory with their content.
pub fn files(directory: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.insert(path.clone(), std::fs::read(&path).expect("a file"));
        }
    }
    all
}

pub fn names(directory: &Path) -> Vec<String> {
    let name = |path: &PathBuf| {
        let inside = path.strip_prefix(directory).expect("inside");
        inside.to_string_lossy().into_owned()
    };
    files(directory).keys().map(name).collect()
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a text file")
}

pub fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("valid JSON")
}

/// The optimum in a directory without the work of its simulations, which a resumed run has less of.
pub fn optimum(directory: &Path) -> Value {
    let mut record = json(&read(&directory.join("optimum.json")));
    for work in ["steps", "newton_iterations", "factorisations", "solves"] {
        let counts = record["counts"].as_object_mut().expect("counts");
        counts.remove(work);
    }
    record
}

/// Calls `judge` for every value in a document.
pub fn every(value: &Value, judge: &mut impl FnMut(&Value)) {
    judge(value);
    match value {
        Value::Array(items) => items.iter().for_each(|inner| every(inner, judge)),
        Value::Object(map) => map.values().for_each(|inner| every(inner, judge)),
        _ => {}
    }
}

/// The hammer as a document with changes made to it, written to a file of the directory.
pub fn changed(directory: &Path, name: &str, change: impl FnOnce(&mut Value)) -> String {
    let mut document = json(&read(Path::new(HAMMER)));
    change(&mut document);
    let path = directory.join(name);
    std::fs::write(&path, document.to_string()).expect("is written");
    path.to_string_lossy().into_owned()
}
