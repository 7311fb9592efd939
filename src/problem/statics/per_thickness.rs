//! A stress `per` thickness stands for one function for each thickness, and a constraint on it for one for each.
//!
//! One aggregate of all elements bends where its largest stress moves from place to place; one for each thickness follows
//! the thickness that it limits.

use super::expand::thickness_count;
use crate::finding::Finding;
use crate::pointer::join;
use crate::schema::Document;
use crate::schema::statics::Stress;
use crate::schema::structures::Thickness;
use serde_json::{Map, Value};

/// Whether a stress of a document is per thickness.
pub fn is_used(document: &Document) -> bool {
    of_document(document).next().is_some()
}

/// The stresses of a document that are per thickness, by name.
fn of_document(document: &Document) -> impl Iterator<Item = (&String, &Stress)> {
    let stresses = document
        .functions
        .iter()
        .filter_map(|(name, function)| Some((name, function.stress()?)));
    stresses.filter(|(_, stress)| stress.per.is_some())
}

/// Name of the set of the elements that have a thickness of a structure.
pub fn set(structure: &str, thickness: usize) -> String {
    format!("thickness {thickness} of {structure}")
}

/// The sets of all thicknesses of a document, structure by structure.
fn sets(document: &Document) -> Vec<String> {
    let mut all = Vec::new();
    for (name, structure) in &document.structures {
        let count = match &structure.thickness {
            _ if structure.mesh.is_of_beams() => 0,
            Some(Thickness::Varied(varied)) => thickness_count(structure, varied),
            Some(Thickness::Uniform(_)) | None => 1,
        };
        all.extend((0..count).map(|k| set(name, k)));
    }
    all
}

/// Replaces such stresses of `value`, which is `document`, and constraints on them by one for each thickness.
///
/// # Errors
/// If such a stress is the objective, or a name is taken.
pub fn expand(document: &Document, value: &mut Value) -> Result<(), Finding> {
    let several: Vec<&String> = of_document(document).map(|(name, _)| name).collect();
    if several.is_empty() {
        return Ok(());
    }
    let is_several = |name: &str| several.iter().any(|own| *own == name);
    let sets = sets(document);
    replace(value, "functions", sets.len(), |name, function, k| {
        is_several(name).then(|| {
            let mut own = function.clone();
            own["von_mises"]["elements"] = sets[k].as_str().into();
            own
        })
    })?;
    for (key, function) in value["objective"].as_object().into_iter().flatten() {
        if let Some(name) = function.as_str().filter(|name| is_several(name)) {
            let found = format!("\"{name}\", a stress for each thickness");
            let place = join("/objective", key);
            return Err(Finding::new(place, found, "a function of one value"));
        }
    }
    replace(value, "constraints", sets.len(), |_, constraint, k| {
        let function = constraint["function"]
            .as_str()
            .filter(|name| is_several(name))?;
        let mut own = constraint.clone();
        own["function"] = one(function, k).into();
        Some(own)
    })
}

/// Replaces every entry of a section that has members by all `count` of them, in its place; `member` gives the one of
/// this number, if the entry has members.
fn replace(
    document: &mut Value,
    section: &str,
    count: usize,
    member: impl Fn(&str, &Value, usize) -> Option<Value>,
) -> Result<(), Finding> {
    let Some(entries) = document.get_mut(section).and_then(Value::as_object_mut) else {
        return Ok(());
    };
    let mut all = Map::new();
    for (name, entry) in std::mem::take(entries) {
        let members = (0..count).filter_map(|k| Some((one(&name, k), member(&name, &entry, k)?)));
        let members: Vec<(String, Value)> = members.collect();
        let own = match members.is_empty() {
            true => vec![(name, entry)],
            false => members,
        };
        for (name, entry) in own {
            let place = join(&format!("/{section}"), &name);
            if all.insert(name, entry).is_some() {
                let found = "a name that an entry for each thickness has";
                return Err(Finding::new(place, found, "another name").of_key());
            }
        }
    }
    *entries = all;
    Ok(())
}

fn one(name: &str, k: usize) -> String {
    format!("{name}[{k}]")
}
