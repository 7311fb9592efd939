//! Runs of the program in scratch directories, and the files that they write.

#[path = "../reference/directory.rs"]
mod directory;

pub use directory::files;
use serde_json::Value;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;
use tempfile::TempDir;

pub const HAMMER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hammer.json");

pub const TREBUCHET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");

/// Result of a run of the program.
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

pub fn names(directory: &Path) -> Vec<String> {
    files(directory).into_keys().collect()
}

/// Locks a directory, as a run that writes to it does.
pub fn held(directory: &Path) -> File {
    std::fs::create_dir_all(directory).expect("is made");
    let file = File::open(directory).expect("a directory");
    file.try_lock().expect("is free");
    file
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a text file")
}

pub fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("valid JSON")
}

pub fn optimum(directory: &Path) -> Value {
    json(&read(&directory.join("optimum.json")))
}

/// Starts the program without waiting for it.
pub fn start(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_optimize"))
        .current_dir(directory)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs")
}

/// Kills runs with these arguments at twenty moments spread over the whole run, some of them early,
/// and resumes them. The `records` (complete lines at the kill) equal those of a run that is not
/// killed and repeat no evaluation. Every other file is the same, byte for byte.
pub fn killed_runs_resume(arguments: &[&str], phase: f64, records: &[&str]) {
    let at = scratch();
    let with = |how: &[&str]| -> Vec<String> {
        let all = arguments.iter().chain(how);
        all.map(|argument| (*argument).to_owned()).collect()
    };
    let run = |how: &[&str]| {
        let all = with(how);
        start(
            at.path(),
            &all.iter().map(String::as_str).collect::<Vec<_>>(),
        )
    };
    let begun = Instant::now();
    let ended = run(&["--output", "whole"]).wait().expect("ends");
    let (duration, code) = (begun.elapsed(), ended.code().expect("ended by itself"));
    let whole = files(&at.path().join("whole"));
    let mut in_the_midst = 0;
    for k in 0..20 {
        let output = format!("killed_{k}");
        let directory = at.path().join(&output);
        let mut killed = run(&["--output", &output]);
        // Multiples of the golden ratio are spread without a pattern.
        let moment = (phase + f64::from(k) * 0.618_033_988_749_895).fract();
        std::thread::sleep(duration.mul_f64(moment));
        killed.kill().expect("is killed or has ended");
        killed.wait().expect("has ended");
        let (mut begun, mut complete) = (false, true);
        for name in records {
            let left = std::fs::read(directory.join(name)).unwrap_or_default();
            let end = left.iter().rposition(|byte| *byte == b'\n');
            let kept = &left[..end.map_or(0, |end| end + 1)];
            assert!(whole[*name].starts_with(kept), "{name} at moment {k}");
            begun |= kept.iter().filter(|byte| **byte == b'\n').count() > 1;
            complete &= kept == whole[*name];
        }
        in_the_midst += usize::from(begun && !complete);
        // A run that was killed before it wrote a record is started again.
        let how = match records.iter().any(|name| directory.join(name).exists()) {
            true => "--resume",
            false => "--output",
        };
        let again = with(&[how, &output, "--quiet"]);
        let again: Vec<&str> = again.iter().map(String::as_str).collect();
        expect(code, at.path(), &again);
        let found = files(&directory);
        assert_eq!(names(&directory), whole.keys().cloned().collect::<Vec<_>>());
        for (name, bytes) in &whole {
            assert!(found[name] == *bytes, "{name} at moment {k}");
        }
    }
    assert!(in_the_midst >= 5, "{in_the_midst} runs were killed midway");
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

/// The hammer as a document with changes, written to a file in the directory.
pub fn changed(directory: &Path, name: &str, change: impl FnOnce(&mut Value)) -> String {
    let mut document = json(&read(Path::new(HAMMER)));
    change(&mut document);
    let path = directory.join(name);
    std::fs::write(&path, document.to_string()).expect("is written");
    path.to_string_lossy().into_owned()
}
