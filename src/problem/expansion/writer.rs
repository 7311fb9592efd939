//! A document while its parts are written out, and the formulas of its numbers.

use super::algebra::Formula;
use super::frame::Triple;
use crate::derived::{in_scope, place};
use crate::expression::{Expression, MARK};
use crate::finding::Finding;
use crate::origins::{Origin, Origins};
use crate::pointer::join;
use crate::source::Source;
use crate::structure::Structure;
use serde_json::{Map, Number, Value};
use std::collections::HashSet;

/// A document while its parts are written out.
pub struct Writer<'a> {
    /// The document without its parts.
    pub out: &'a mut Map<String, Value>,
    /// Where its entries come from.
    pub origins: Origins,
    /// The text of the file.
    pub source: &'a Source,
    /// The structure of the file.
    pub structure: &'a Structure,
    /// The parts by name.
    pub parts: &'a Value,
    /// Pointers to numbers of the file that are design variables.
    pub designed: HashSet<String>,
    /// Faults.
    pub findings: Vec<Finding>,
}

impl Writer<'_> {
    /// Says where an entry of a use comes from.
    pub fn origin(&mut self, pointer: String, from: String, used: &str, scope: Option<&str>) {
        let origin = Origin {
            pointer: from,
            used: Some(used.to_owned()),
            scope: scope.map(str::to_owned),
        };
        self.origins.add(pointer, origin);
    }

    /// The entries of a section of the document.
    pub fn section(&mut self, name: &str) -> &mut Map<String, Value> {
        let section = self
            .out
            .entry(name.to_owned())
            .or_insert_with(|| Value::Object(Map::new()));
        if !section.is_object() {
            *section = Value::Object(Map::new());
        }
        section.as_object_mut().expect("it is an object")
    }

    /// The formula of a number at a pointer of the file, in an expression of `scope`.
    pub fn number(&mut self, value: &Value, from: &str, scope: Option<&str>) -> Option<Formula> {
        let written = self.origins.resolve(from);
        let formula = match value {
            Value::String(text) => {
                let text = text.strip_prefix(MARK)?;
                match Expression::parse(text) {
                    Ok(expression) => {
                        let parameters = &self.out.get("parameters");
                        let exists =
                            |name: &String| parameters.is_some_and(|all| all.get(name).is_some());
                        in_scope(expression, scope, exists)
                    }
                    Err(fault) => {
                        let mut finding = Finding::new(&written, fault.found, fault.expected);
                        finding.part = place(self.source, &written, fault.at.start, text);
                        self.findings.push(finding);
                        return None;
                    }
                }
            }
            value => Formula::Number(value.as_f64()?),
        };
        if !self.designed.contains(&written) {
            return Some(formula);
        }
        // A variable of a moved number is one of a parameter.
        let pointer = join("/parameters", &written);
        let unit = self
            .structure
            .numbers
            .get(&written)
            .map(|own| own.unit.clone());
        self.origins
            .parameters
            .insert(pointer.clone(), Some(unit.unwrap_or_default()));
        let origin = Origin {
            pointer: written.clone(),
            used: None,
            scope: scope.map(str::to_owned),
        };
        self.origins.add(pointer.clone(), origin);
        if !matches!(formula, Formula::Number(_)) {
            self.origins.made.insert(pointer, formula);
        }
        self.section("parameters")
            .insert(written.clone(), value.clone());
        Some(Formula::Name(written))
    }

    /// The formulas of a list of three.
    pub fn triple(&mut self, value: &Value, from: &str, scope: Option<&str>) -> Option<Triple> {
        let items = value.as_array()?.iter().enumerate();
        let all: Vec<Formula> = items
            .filter_map(|(k, own)| self.number(own, &join(from, k), scope))
            .collect();
        all.try_into().ok()
    }

    /// The values of formulas at a pointer of the document.
    pub fn put(&mut self, pointer: &str, formulas: Triple) -> Value {
        let entries = formulas
            .into_iter()
            .enumerate()
            .map(|(k, formula)| match formula {
                Formula::Number(number) => {
                    Number::from_f64(number).map_or(Value::Null, Value::Number)
                }
                formula => {
                    self.origins.made.insert(join(pointer, k), formula);
                    Value::from(MARK.to_string())
                }
            });
        entries.collect()
    }
}
