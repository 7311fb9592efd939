//! A stress `per` thickness stands for one function for each thickness, and a constraint on it for one for each.
//!
//! One aggregate of all elements bends where its largest stress moves from place to place; one for each thickness follows
//! the thickness that it limits.

use super::expand::thickness_count;
use crate::problem::finding::Finding;
use crate::problem::pointer::join;
use crate::problem::schema::Document;
use crate::problem::schema::statics::Stress;
use crate::problem::schema::structures::Thickness;
use serde_json::{Map, Value};

/// Whether a stress of a document is per thickness.
pub(crate) fn is_used(document: &Document) -> bool {
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
pub(crate) fn set(structure: &str, thickness: usize) -> String {
    format!("thickness {thickness} of {structure}")
}

/// The sets of all thicknesses of a document, structure by structure.
fn sets(document: &Document) -> Vec<String> {
    let shells = document
        .structures
        .iter()
        .filter(|(_, structure)| !structure.mesh.is_of_beams());
    let of_one = |(name, structure): (&String, _)| {
        let structure: &crate::problem::schema::structures::Structure = structure;
        let count = match &structure.thickness {
            Some(Thickness::Varied(varied)) => thickness_count(structure, varied),
            Some(Thickness::Uniform(_)) | None => 1,
        };
        let name = name.clone();
        (0..count).map(move |k| set(&name, k))
    };
    shells.flat_map(of_one).collect()
}

/// Replaces such stresses of `value`, which is `document`, and constraints on them by one for each thickness.
///
/// # Errors
/// If such a stress is the objective, or a name is taken.
pub(crate) fn expand(document: &Document, value: &mut Value) -> Result<(), Finding> {
    let several: Vec<&String> = of_document(document).map(|(name, _)| name).collect();
    if several.is_empty() {
        return Ok(());
    }
    let sets = sets(document);
    let functions = entries(value, "functions");
    let mut all = Map::new();
    for (name, function) in std::mem::take(functions) {
        if !several.contains(&&name) {
            insert(&mut all, "functions", name, function)?;
            continue;
        }
        for (k, set) in sets.iter().enumerate() {
            let mut own = function.clone();
            own["von_mises"]["elements"] = Value::String(set.clone());
            insert(&mut all, "functions", one(&name, k), own)?;
        }
    }
    *functions = all;
    let is_several = |function: &Value| several.iter().any(|name| function == name.as_str());
    if let Some(objective) = value.get("objective").and_then(Value::as_object) {
        for (key, function) in objective {
            if is_several(function) {
                let found = format!(
                    "\"{}\", a stress for each thickness",
                    function.as_str().unwrap_or_default()
                );
                return Err(Finding::new(
                    join("/objective", key),
                    found,
                    "a function of one value",
                ));
            }
        }
    }
    let constraints = entries(value, "constraints");
    let mut all = Map::new();
    for (name, constraint) in std::mem::take(constraints) {
        let function = constraint["function"].clone();
        if !is_several(&function) {
            insert(&mut all, "constraints", name, constraint)?;
            continue;
        }
        for k in 0..sets.len() {
            let mut own = constraint.clone();
            own["function"] = Value::String(one(function.as_str().unwrap_or_default(), k));
            insert(&mut all, "constraints", one(&name, k), own)?;
        }
    }
    *constraints = all;
    Ok(())
}

fn one(name: &str, k: usize) -> String {
    format!("{name}[{k}]")
}

/// The entries of a section of a document; those of a new one if it has none.
fn entries<'a>(document: &'a mut Value, section: &str) -> &'a mut Map<String, Value> {
    if !document[section].is_object() {
        document[section] = Value::Object(Map::new());
    }
    document[section]
        .as_object_mut()
        .expect("it is an object now")
}

fn insert(
    all: &mut Map<String, Value>,
    section: &str,
    name: String,
    entry: Value,
) -> Result<(), Finding> {
    let pointer = join(&format!("/{section}"), &name);
    match all.insert(name, entry) {
        None => Ok(()),
        Some(_) => Err(Finding::new(
            pointer,
            "a name that an entry for each thickness has",
            "another name",
        )
        .of_key()),
    }
}
