//! `optimize new`: a problem file to start from.

use super::{BAD_INPUT, DONE, Failure, NO_ACCESS, shown, tell};
use crate::report::atomic_write;
use clap::ValueEnum;
use serde_json::Value;
use std::path::Path;

/// Machines to start from.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Starter {
    /// A bar on a hinge: where must the hinge be?
    Pendulum,
    /// A driven slider-crank: how is it balanced?
    Linkage,
    /// A throw over a barrier: masses and angle.
    Trebuchet,
    /// A flexible arm that slews: the lightest tube with a limit on stress.
    Arm,
    /// A plate in two load cases: thickness of patches.
    Plate,
    /// A portal of tubes: the lightest with limits on sway and frequency.
    Frame,
}

impl Starter {
    fn text(self) -> &'static str {
        match self {
            Self::Pendulum => include_str!("starters/pendulum.json"),
            Self::Linkage => include_str!("starters/linkage.json"),
            Self::Trebuchet => include_str!("starters/trebuchet.json"),
            Self::Arm => include_str!("starters/arm.json"),
            Self::Plate => include_str!("starters/plate.json"),
            Self::Frame => include_str!("starters/frame.json"),
        }
    }
}

/// Writes a starter as `path`, with its file name as name of the problem.
pub(crate) fn new(path: &Path, from: Starter) -> Result<u8, Failure> {
    let name = path.file_stem().map(|name| name.to_string_lossy());
    let is_json = path.extension().is_none_or(|kind| kind == "json");
    let Some(name) = name.filter(|name| !name.is_empty() && is_json && !path.is_dir()) else {
        let what = format!(
            "found \"{}\", expected the name of a file, such as crank or crank.json",
            shown(path)
        );
        return Err(Failure::bad_input(what));
    };
    let path = path.with_extension("json");
    let folder = path.parent().filter(|own| !own.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|own| !own.is_dir()) {
        let what = format!("{} is no folder", shown(folder));
        return Err(Failure::new(NO_ACCESS, what));
    }
    if path.exists() {
        let what = format!("{} is there already, and stays as it is", shown(&path));
        return Err(Failure::new(BAD_INPUT, what));
    }
    // The name alone changes, so that the lines of the starter stay as they are.
    let text = from.text();
    let starter: Value = serde_json::from_str(text).expect("starters are JSON");
    let own = format!("\"name\": {}", starter["name"]);
    let named = format!("\"name\": {}", Value::from(name.as_ref()));
    atomic_write(&path, text.replacen(&own, &named, 1).as_bytes())?;
    let file = match shown(&path) {
        file if file.contains(' ') => format!("'{file}'"),
        file => file,
    };
    tell(&format!(
        "{file} is written; next:\n  optimize simulate {file}\n  optimize {file} --report\n"
    ));
    Ok(DONE)
}
