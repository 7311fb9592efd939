//! A word of the command line that is no file.

use super::arguments::Arguments;
use super::new::Starter;
use crate::problem::pointer::nearest;
use crate::problem::visible;
use clap::{CommandFactory, ValueEnum};
use std::path::Path;

/// What a word that is no file may have meant.
pub(super) fn meant(path: &Path) -> String {
    let Some(word) = path.to_str().filter(|_| !path.exists()) else {
        return String::new();
    };
    let files = [format!("{word}.json"), format!("problems/{word}.json")];
    if let Some(file) = files.iter().find(|file| Path::new(file).is_file()) {
        return format!("\n  did you mean {}?", visible(file));
    }
    let commands = Arguments::command();
    let names = commands.get_subcommands().filter(|own| !own.is_hide_set());
    if let Some(name) = nearest(word, names.map(|own| own.get_name())) {
        return format!("\n  did you mean the command `optimize {name}`?");
    }
    let starters = Starter::value_variants().iter();
    let starters: Vec<_> = starters.filter_map(ValueEnum::to_possible_value).collect();
    match nearest(word, starters.iter().map(|own| own.get_name())) {
        Some(kind) => format!("\n  `optimize new NAME --from {kind}` writes such a problem"),
        None => String::new(),
    }
}
