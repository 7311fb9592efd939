//! The command as a user runs it: what it prints of a scene, and how it ended.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// A number with its estimated error, 0 where the program gives none.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its estimated error.
    pub error: f64,
}

/// What `optimize simulate --json --error` says of a scene.
pub enum Answer {
    /// Values by function, and derivatives by function and variable.
    Numbers {
        /// Values and derivatives by name; a derivative is called `function / variable`.
        table: BTreeMap<String, Estimate>,
        /// Whether a warning came with them.
        warned: bool,
    },
    /// It refused the scene or gave it up, with this message.
    Refused(String),
    /// It panicked or was killed.
    Broke(String),
}

/// Simulates `document` in `directory` with further words.
pub fn simulate(directory: &Path, name: &str, document: &Value, words: &[&str]) -> Answer {
    let file = directory.join(format!("{name}.json"));
    if let Err(fault) = std::fs::write(&file, document.to_string()) {
        return Answer::Broke(format!("{}: {fault}", file.display()));
    }
    let done = Command::new(env!("CARGO_BIN_EXE_optimize"))
        .arg("simulate")
        .arg(&file)
        .args(["--json"])
        .args(words)
        .env("RAYON_NUM_THREADS", "1")
        .output();
    let done = match done {
        Ok(done) => done,
        Err(fault) => return Answer::Broke(fault.to_string()),
    };
    let message = String::from_utf8_lossy(&done.stderr).trim().to_owned();
    match done.status.code() {
        Some(0) => match serde_json::from_slice(&done.stdout) {
            Ok(result) => numbers(&result),
            Err(fault) => Answer::Broke(fault.to_string()),
        },
        Some(2 | 3) => Answer::Refused(message),
        _ => Answer::Broke(message),
    }
}

fn numbers(result: &Value) -> Answer {
    let mut table = BTreeMap::new();
    let estimate = |of: &Value| Estimate {
        value: of["value"].as_f64().unwrap_or(f64::NAN),
        error: of["error"].as_f64().unwrap_or(0.0),
    };
    for (function, entry) in result["functions"].as_object().into_iter().flatten() {
        table.insert(function.clone(), estimate(entry));
        for (variable, slope) in entry["gradient"].as_object().into_iter().flatten() {
            table.insert(format!("{function} / {variable}"), estimate(slope));
        }
    }
    let warned = result["warnings"]
        .as_array()
        .is_some_and(|all| !all.is_empty());
    Answer::Numbers { table, warned }
}
