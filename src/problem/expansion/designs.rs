//! Design variables of numbers in parts, uses and defaults.

use super::writer::Writer;
use crate::finding::Finding;
use crate::origins::Origin;
use crate::pointer::{join, nearest_pointer};
use serde_json::{Map, Value};
use std::collections::HashSet;

/// Sections that are written out.
pub const WRITTEN_OUT: [&str; 3] = ["parts", "use", "defaults"];

impl Writer<'_> {
    /// The paths of the variables.
    pub fn designed(&self) -> HashSet<String> {
        let variables = self.out.get("variables").and_then(Value::as_object);
        let variables = variables.into_iter().flat_map(Map::values);
        let paths = variables.flat_map(|own| {
            let several = own["paths"].as_array().into_iter().flatten();
            own["path"]
                .as_str()
                .into_iter()
                .chain(several.filter_map(Value::as_str))
        });
        paths.map(str::to_owned).collect()
    }

    /// Points the variables of numbers of parts, uses and defaults at the entries that are written out.
    pub fn variables(&mut self) {
        let Some(Value::Object(mut variables)) = self.out.shift_remove("variables") else {
            return;
        };
        let document = Value::Object(self.out.clone());
        for (name, variable) in &mut variables {
            let pointer = join("/variables", name);
            let Value::Object(variable) = variable else {
                continue;
            };
            let written: Vec<(Value, String)> = match (variable.get("path"), variable.get("paths"))
            {
                (Some(path), None) => vec![(path.clone(), join(&pointer, "path"))],
                (None, Some(Value::Array(paths))) => {
                    let at = join(&pointer, "paths");
                    let all = paths.iter().enumerate();
                    all.map(|(k, own)| (own.clone(), join(&at, k))).collect()
                }
                _ => continue,
            };
            let is_written_out = |path: &Value| {
                let path = path.as_str().unwrap_or_default();
                let section = path.split('/').nth(1).unwrap_or_default();
                WRITTEN_OUT.contains(&section)
            };
            if !written.iter().any(|(path, _)| is_written_out(path)) {
                continue;
            }
            let mut paths = Vec::new();
            for (path, from) in written {
                let images = match (is_written_out(&path), path.as_str()) {
                    (true, Some(own)) => self.origins.images(own, &document),
                    _ => vec![path.as_str().unwrap_or_default().to_owned()],
                };
                if images.is_empty() {
                    let found = format!("{}, which no use has", path.as_str().unwrap_or_default());
                    let expected = "the path of a physical number that the machine has";
                    let own = self.structure.numbers.keys().map(String::as_str);
                    let hint = nearest_pointer(path.as_str().unwrap_or_default(), own)
                        .map(|near| format!("did you mean {near}?"));
                    self.findings
                        .push(Finding::new(&from, found, expected).hint(hint));
                }
                for image in images {
                    let own = join(&join(&pointer, "paths"), paths.len());
                    let origin = Origin {
                        pointer: from.clone(),
                        used: None,
                        scope: None,
                    };
                    // The one list takes the place of the other.
                    if own != from {
                        self.origins.add(own, origin);
                    }
                    paths.push(Value::from(image));
                }
            }
            variable.shift_remove("path");
            variable.insert("paths".to_owned(), Value::Array(paths));
        }
        self.out
            .insert("variables".to_owned(), Value::Object(variables));
    }
}
