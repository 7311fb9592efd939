//! A variable of a property that differs by element, band, patch or group stands for one variable each.

use super::mesh::element_count;
use crate::Variable;
use crate::finding::Finding;
use crate::pointer::{join, keys};
use crate::schema::Document;
use crate::schema::structures::{Direction, Per, Structure, Thickness, VariedThickness};
use serde_json::Value;

/// How many values a varied thickness of a structure has.
pub fn thickness_count(structure: &Structure, varied: &VariedThickness) -> usize {
    let [nx, ny] = structure
        .mesh
        .panel_elements()
        .unwrap_or([element_count(&structure.mesh), 1]);
    match varied.per {
        Per::Element => nx * ny,
        Per::Band => varied.bands.unwrap_or(match varied.along {
            Some(Direction::X) => nx,
            Some(Direction::Y) | None => ny,
        }),
        Per::Patch => varied.patches.map_or(1, |[px, py]| px * py),
        Per::Group => varied.groups.as_ref().map_or(0, Vec::len),
    }
}

/// How many sections a structure has.
pub fn section_count(structure: &Structure) -> usize {
    match &structure.sections {
        None => 1,
        Some(varied) => match varied.per {
            Per::Group => varied.groups.as_ref().map_or(0, Vec::len),
            Per::Element | Per::Band | Per::Patch => element_count(&structure.mesh),
        },
    }
}

/// The varied properties of a document that have one value: their pointers, and their numbers of
/// variables.
fn varied(document: &Document) -> Vec<(String, usize)> {
    let mut all = Vec::new();
    let still = document.structures.iter();
    let still = still.map(|(name, structure)| (join("/structures", name), structure));
    let moving = document.bodies.iter().filter_map(|(name, body)| {
        let own = join(&join(&join("/bodies", name), "elements"), "structure");
        Some((own, &body.elements.as_ref()?.structure))
    });
    for (own, structure) in still.chain(moving) {
        if let Some(Thickness::Varied(varied)) = &structure.thickness
            && varied.value.is_some()
        {
            let count = thickness_count(structure, varied);
            all.push((join(&own, "thickness"), count));
        }
        if structure
            .sections
            .as_ref()
            .is_some_and(|varied| varied.value.is_some())
        {
            all.push((join(&own, "sections"), section_count(structure)));
        }
    }
    all
}

/// Writes every value of the varied properties of `value`, which is `document`, and gives the variables
/// that those of one value stand for.
pub fn expand(
    document: &Document,
    value: &mut Value,
    variables: Vec<Variable>,
) -> Result<Vec<Variable>, Finding> {
    let varied = varied(document);
    for (pointer, count) in &varied {
        if let Some(Value::Object(property)) = value.pointer_mut(pointer)
            && let Some(one) = property.shift_remove("value")
        {
            property.insert("values".to_owned(), Value::Array(vec![one; *count]));
        }
    }
    let mut all = Vec::with_capacity(variables.len());
    for variable in variables {
        // The property, how many there are, and the keys below its value, of each path.
        let parts: Vec<Option<(&String, usize, String)>> = (variable.paths.iter())
            .map(|path| {
                varied.iter().find_map(|(pointer, count)| {
                    let rest = path.strip_prefix(pointer.as_str())?;
                    let rest = rest.strip_prefix("/value")?;
                    Some((pointer, *count, rest.to_owned()))
                })
            })
            .collect();
        let several = parts.iter().flatten().map(|(_, count, _)| *count).max();
        let Some(several) = several else {
            all.push(variable);
            continue;
        };
        if parts
            .iter()
            .any(|part| part.as_ref().is_none_or(|(_, count, _)| *count != several))
        {
            let pointer = join("/variables", &variable.name);
            let found = format!("paths of which one stands for {several} values");
            let expected = "paths that all stand for as many";
            return Err(Finding::new(pointer, found, expected).of_key());
        }
        for k in 0..several {
            let paths = variable.paths.iter().zip(&parts);
            let paths = paths.map(|(path, part)| match part {
                Some((pointer, _, rest)) => format!("{pointer}/values/{k}{rest}"),
                None => path.clone(),
            });
            all.push(Variable {
                name: format!("{}[{k}]", variable.name),
                paths: paths.collect(),
                ..variable.clone()
            });
        }
    }
    let mut names = std::collections::HashSet::new();
    if let Some(twice) = all.iter().find(|variable| !names.insert(&variable.name)) {
        let found = format!("two variables of the name \"{}\"", twice.name);
        return Err(Finding::new("/variables", found, "a name once"));
    }
    Ok(all)
}

/// Whether a path leads to a thickness or section, whose derivatives go straight to the variable.
pub fn is_direct(path: &str) -> bool {
    let keys = keys(path);
    let property = keys.get(2).map_or("", String::as_str);
    keys.first().is_some_and(|key| key == "structures")
        && ["thickness", "section", "sections"].contains(&property)
}
