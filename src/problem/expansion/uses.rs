//! Writes the uses of the parts of a document.

use super::algebra::Formula;
use super::designs::WRITTEN_OUT;
use super::frame::{Frame, Triple, composed, rotation};
use super::used::Used;
use super::writer::Writer;
use crate::derived::{names_of, parameter_of};
use crate::expression::MARK;
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::source::Source;
use crate::structure::Structure;
use serde_json::{Map, Value};
use std::collections::HashSet;

/// Sections that a part has.
const SECTIONS: [&str; 5] = ["bodies", "joints", "loads", "drives", "couplings"];

/// Writes the uses of a document whose structure is sound.
pub fn write_out(
    document: &mut Value,
    structure: &Structure,
    source: &mut Source,
) -> Result<(), Vec<Finding>> {
    let Value::Object(out) = document else {
        return Ok(());
    };
    let mut written_out = WRITTEN_OUT.map(|section| out.shift_remove(section));
    let [parts, uses, _] = written_out
        .each_mut()
        .map(|section| section.take().unwrap_or(Value::Null));
    let origins = std::mem::take(&mut source.origins);
    let mut writer = Writer {
        out,
        origins,
        source,
        structure,
        parts: &parts,
        designed: HashSet::new(),
        findings: Vec::new(),
    };
    writer.designed = writer.designed();
    writer.part_names();
    for (name, used) in uses.as_object().into_iter().flatten() {
        writer.used(name, used);
    }
    writer.variables();
    let (findings, origins) = (writer.findings, writer.origins);
    source.origins = origins;
    match findings.is_empty() {
        true => Ok(()),
        false => Err(findings),
    }
}

impl Writer<'_> {
    /// Checks the names of parameters of parts.
    fn part_names(&mut self) {
        for (name, part) in self.parts.as_object().into_iter().flatten() {
            let pointer = join(&join("/parts", name), "parameters");
            let names = part["parameters"]
                .as_object()
                .into_iter()
                .flat_map(Map::keys);
            self.findings.extend(names_of(&pointer, names));
        }
    }

    /// Writes one use.
    fn used(&mut self, name: &str, written: &Value) {
        let at = join("/use", name);
        if name.trim().is_empty() || name.contains('.') {
            let found = format!("the name \"{name}\"");
            let expected = "a name that is not empty and has no dot";
            self.findings
                .push(Finding::new(&at, found, expected).of_key());
            return;
        }
        let own = written["part"].as_str().unwrap_or_default();
        let Some(part) = self.parts.get(own) else {
            let known = self.parts.as_object().into_iter().flat_map(Map::keys);
            let hint = advice(own, "parts", known.map(String::as_str));
            let found = format!("\"{own}\"");
            let finding = Finding::new(join(&at, "part"), found, "the name of a part");
            self.findings.push(finding.hint(hint));
            return;
        };
        let mut used = Used {
            name,
            part,
            from: join("/parts", own),
            connect: written["connect"].as_object().cloned().unwrap_or_default(),
            frame: Frame::default(),
            mentioned: HashSet::new(),
            at,
        };
        self.parameters(&used, &written["parameters"]);
        used.frame = self.frame(&used, written);
        for section in SECTIONS {
            let entries = part[section].as_object().into_iter().flatten();
            for (key, entry) in entries {
                self.entry(&mut used, section, key, entry);
            }
        }
        for name in used.connect.keys() {
            let place = join(&join(&used.at, "connect"), name);
            if used.has("bodies", name) {
                let found = format!("\"{name}\", which is a body of the part");
                let expected = "a name for which the part has no body";
                self.findings
                    .push(Finding::new(place, found, expected).of_key());
            } else if !used.mentioned.contains(name) {
                let mut known: Vec<&str> = used.mentioned.iter().map(String::as_str).collect();
                known.sort_unstable();
                let hint = advice(name, "names of other bodies in the part", known);
                let found = format!("\"{name}\", which the part does not mention");
                let finding = Finding::new(place, found, "the name of a body in the part");
                self.findings.push(finding.of_key().hint(hint));
            }
        }
    }

    /// Writes the parameters of a use.
    fn parameters(&mut self, used: &Used, given: &Value) {
        let own = used.part["parameters"]
            .as_object()
            .cloned()
            .unwrap_or_default();
        for name in given.as_object().into_iter().flat_map(Map::keys) {
            if !own.contains_key(name) {
                let hint = advice(
                    name,
                    "parameters of the part",
                    own.keys().map(String::as_str),
                );
                let place = join(&join(&used.at, "parameters"), name);
                let found = format!("the parameter \"{name}\"");
                let finding = Finding::new(place, found, "a parameter of the part");
                self.findings.push(finding.of_key().hint(hint));
            }
        }
        for (name, value) in &own {
            let full = parameter_of(used.name, name);
            let pointer = join("/parameters", &full);
            let (value, from, scope) = match given.get(name) {
                Some(value) => (value, &used.at, None),
                None => (value, &used.from, Some(used.name)),
            };
            let from = join(&join(from, "parameters"), name);
            self.origin(pointer.clone(), from, used.name, scope);
            self.origins.parameters.insert(pointer, None);
            self.section("parameters").insert(full, value.clone());
        }
    }

    /// The axes of a use.
    fn frame(&mut self, used: &Used, written: &Value) -> Frame {
        let at = join(&used.at, "turn");
        let turns: Vec<(Value, String)> = match &written["turn"] {
            Value::Array(list) => {
                let items = list.iter().enumerate();
                items.map(|(k, own)| (own.clone(), join(&at, k))).collect()
            }
            Value::Null => Vec::new(),
            one => vec![(one.clone(), at.clone())],
        };
        let mut rows: Option<[Triple; 3]> = None;
        for (turn, pointer) in &turns {
            let own = rotation(turn, pointer, &mut |value, from| {
                self.number(value, from, None)
            });
            rows = match (rows, own) {
                (Some(before), Some(own)) => Some(composed(&own, &before)),
                (before, own) => own.or(before),
            };
        }
        let rows = rows.map(|rows| self.as_parameters(rows, used, &at));
        let place = self.triple(&written["at"], &join(&used.at, "at"), None);
        Frame {
            place,
            rotation: rows,
            turns,
        }
    }

    /// Entries of a rotation that follow from parameters, as parameters of their own.
    fn as_parameters(&mut self, rows: [Triple; 3], used: &Used, at: &str) -> [Triple; 3] {
        let mut i = 0;
        rows.map(|row| {
            row.map(|entry| {
                i += 1;
                if matches!(entry, Formula::Number(_)) {
                    return entry;
                }
                let name = format!("{at}/{i}");
                let pointer = join("/parameters", &name);
                self.origin(pointer.clone(), at.to_owned(), used.name, None);
                self.origins
                    .parameters
                    .insert(pointer.clone(), Some("1".to_owned()));
                self.origins.made.insert(pointer, entry);
                self.section("parameters")
                    .insert(name.clone(), Value::from(MARK.to_string()));
                Formula::Name(name)
            })
        })
    }
}
