//! A word of the command line that is no problem file.

use super::arguments::Arguments;
use super::new::Starter;
use crate::problem::pointer::nearest;
use crate::problem::visible;
use clap::{CommandFactory, ValueEnum};
use std::path::Path;

/// What a word may have meant that stands for a problem and is none.
pub(super) fn meant(path: &Path) -> Option<String> {
    let word = path.to_str()?;
    if path.is_dir() {
        let shown = visible(word);
        let found = path.join("optimum.json").is_file();
        return found.then(|| {
            format!("it holds a result: `optimize report {shown}` shows it, --from {shown} starts at its design")
        });
    }
    if path.exists() || word.is_empty() || word.starts_with('-') {
        return None;
    }
    let files = [format!("{word}.json"), format!("problems/{word}.json")];
    if let Some(file) = files.iter().find(|file| Path::new(file).is_file()) {
        return Some(format!("did you mean {}?", visible(file)));
    }
    let commands = Arguments::command();
    let mut names = commands.get_subcommands().map(|own| own.get_name());
    if names.any(|name| name == word) {
        return None;
    }
    let shown = commands.get_subcommands().filter(|own| !own.is_hide_set());
    if let Some(name) = nearest(word, shown.map(|own| own.get_name())) {
        return Some(format!("did you mean the command `optimize {name}`?"));
    }
    let starters = Starter::value_variants().iter();
    let starters: Vec<_> = starters.filter_map(ValueEnum::to_possible_value).collect();
    let kind = nearest(word, starters.iter().map(|own| own.get_name()))?;
    Some(format!(
        "`optimize new NAME --from {kind}` writes such a problem"
    ))
}
