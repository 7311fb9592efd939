//! Design variables: their numbers in the file, their start and their bounds.
//!
//! `read::single` calls `bind`. Then `Quantity::get(x)` returns x_i (quantity.rs), and
//! driver/evaluate.rs (`derivatives`, `parameter_derivatives`) sums ∂f/∂p · ∂p/∂x_i.

use super::finding::Finding;
use super::overrides::nearest_path;
use super::pointer::{is_below, join, keys, nearest_pointer};
use super::structure::{Number, Structure, describe};
use crate::quantity::Quantity;
use crate::schema::{Document, Variable as Written};
use serde_json::Value;
use std::collections::{HashMap, HashSet};

/// A design variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name in the problem file.
    pub name: String,
    /// JSON Pointers to the numbers that share its value.
    pub paths: Vec<String>,
    /// Value in the file: the start of the design.
    pub start: f64,
    /// Smallest value; −∞ if there is none.
    pub lower: f64,
    /// Largest value; +∞ if there is none.
    pub upper: f64,
    /// Typical change. Only the optimiser uses it.
    pub scale: f64,
    /// Unit of the numbers.
    pub unit: String,
}

/// Replaces the numbers of the variables by their bound form.
pub(super) fn bind(document: &mut Value, variables: &[Variable]) {
    for (index, variable) in variables.iter().enumerate() {
        for path in &variable.paths {
            if let Some(place) = document.pointer_mut(path) {
                *place = Quantity::bound(index, variable.start);
            }
        }
    }
}

/// The variables of a document, and their faults; `is_given` tells the numbers that expressions give.
pub(super) fn variables(
    written: &Document,
    (document, structure): (&Value, &Structure),
    is_given: &dyn Fn(&str) -> bool,
) -> (Vec<Variable>, Vec<Finding>) {
    let mut checker = Checker {
        document,
        structure,
        is_given,
        owners: HashMap::new(),
        findings: Vec::new(),
    };
    let mut variables = Vec::new();
    for (name, written) in &written.variables {
        checker.add(name, written, &mut variables);
    }
    let mut names = HashSet::new();
    for own in &variables {
        if !names.insert(&own.name) {
            let found = format!("\"{}\", the name of a number of a list", own.name);
            let finding = Finding::new(join("/variables", &own.name), found, "another name");
            checker.findings.push(finding.of_key());
        }
    }
    (variables, checker.findings)
}

struct Checker<'a> {
    document: &'a Value,
    structure: &'a Structure,
    /// Whether an expression gives the number at a pointer.
    is_given: &'a dyn Fn(&str) -> bool,
    /// By path: the variable that owns it.
    owners: HashMap<String, String>,
    findings: Vec<Finding>,
}

impl<'a> Checker<'a> {
    fn fault(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    /// Adds the variable of an entry; or, if it points at a list, one for each number: `name[0]`, `name[1]`, …
    fn add(&mut self, name: &str, written: &Written, all: &mut Vec<Variable>) {
        let pointer = join("/variables", name);
        let paths = self.paths(&pointer, written);
        let list = |path: &str| self.document.pointer(path).and_then(Value::as_array);
        let lengths: Vec<usize> = (paths.iter())
            .map(|(_, path)| list(path).map_or(0, Vec::len))
            .collect();
        let count = lengths.first().copied().unwrap_or(0);
        if count == 0 {
            all.push(self.variable((&pointer, name), paths, written));
            return;
        }
        if let Some(k) = lengths.iter().position(|&own| own != count) {
            let found = format!("{}, which has {} numbers", paths[k].1, lengths[k]);
            let expected = format!("a list of {count} as {}, which it shares", paths[0].1);
            self.fault(Finding::new(&paths[k].0, found, expected));
            return;
        }
        let before = self.findings.len();
        for k in 0..count {
            let own = format!("{name}[{k}]");
            let paths = paths
                .iter()
                .map(|(place, path)| (place.clone(), join(path, k)));
            let paths = paths.collect();
            all.push(self.variable((&pointer, &own), paths, written));
            // The others have the same faults.
            if self.findings.len() > before {
                return;
            }
        }
    }

    /// The paths of an entry, and where they stand.
    fn paths(&mut self, pointer: &str, written: &Written) -> Vec<(String, String)> {
        match (&written.path, &written.paths) {
            (Some(path), None) => vec![(join(pointer, "path"), path.clone())],
            (None, Some(paths)) if !paths.is_empty() => {
                let list = join(pointer, "paths");
                let entries = paths.iter().enumerate();
                entries
                    .map(|(k, path)| (join(&list, k), path.clone()))
                    .collect()
            }
            (path, paths) => {
                let found = match (path, paths) {
                    (Some(_), Some(_)) => "both \"path\" and \"paths\"",
                    (None, Some(_)) => "no path",
                    _ => "neither \"path\" nor \"paths\"",
                };
                let expected = "\"path\": one JSON Pointer, or \"paths\": a list of them";
                self.fault(Finding::new(pointer, found, expected).of_key());
                Vec::new()
            }
        }
    }

    fn variable(
        &mut self,
        (pointer, name): (&str, &str),
        paths: Vec<(String, String)>,
        written: &Written,
    ) -> Variable {
        let numbers: Vec<(&String, f64, &Number)> = paths
            .iter()
            .filter_map(|(place, path)| {
                let (value, number) = self.number(name, place, path)?;
                Some((path, value, number))
            })
            .collect();
        let first = numbers.first().copied();
        for (path, value, number) in numbers.iter().skip(1) {
            let Some((shared, start, pattern)) = first else {
                break;
            };
            let place = paths
                .iter()
                .find(|(_, p)| p == *path)
                .map_or(pointer, |(place, _)| place);
            if number.unit != pattern.unit {
                let found = format!("{path} in {}", named_unit(&number.unit));
                let expected = format!("a number in {} as {shared}", named_unit(&pattern.unit));
                self.findings.push(Finding::new(place, found, expected));
            } else if *value != start {
                let found = format!("{path} = {value}");
                let expected = format!("the value {start} of {shared}, which it shares");
                self.findings.push(Finding::new(place, found, expected));
            }
        }
        if let Some((path, start, number)) = first {
            self.bounds(pointer, written, path, start, number);
        }
        let (start, unit) = first.map_or((0.0, String::new()), |(_, start, number)| {
            (start, number.unit.clone())
        });
        let lower = written.lower.unwrap_or(f64::NEG_INFINITY);
        let upper = written.upper.unwrap_or(f64::INFINITY);
        // Wide bounds do not indicate a typical change.
        let most = WIDE * start.abs().max(1.0);
        let scale = match 0.5 * (upper - lower) {
            half if half.is_finite() && half > 0.0 => half.min(most),
            // Open or fixed.
            _ if start != 0.0 => start.abs(),
            _ => 1.0,
        };
        Variable {
            name: name.to_owned(),
            paths: paths.into_iter().map(|(_, path)| path).collect(),
            start,
            lower,
            upper,
            scale: written.scale.unwrap_or(scale),
            unit,
        }
    }

    /// The number at `path`, if a design variable may own it; `place` is the pointer to the path.
    fn number(&mut self, name: &str, place: &str, path: &str) -> Option<(f64, &'a Number)> {
        let expected = "the path of a physical number";
        let Some(value) = self.document.pointer(path) else {
            if !self.is_damaged(path) {
                let found = format!("{path}, which does not exist");
                let hint = self.hint(path);
                self.fault(Finding::new(place, found, expected).hint(hint));
            }
            return None;
        };
        if let Some(owner) = self.owners.insert(path.to_owned(), name.to_owned()) {
            let found = format!("{path} a second time");
            let hint = format!("it belongs to the variable \"{owner}\"");
            self.fault(Finding::new(place, found, "a path once").hint(Some(hint)));
            return None;
        }
        if self.is_damaged(path) {
            return None;
        }
        if (self.is_given)(path) {
            let found = format!("{path}, which an expression gives");
            let hint = "point at a parameter of the expression, such as /parameters/length";
            self.fault(Finding::new(place, found, expected).hint(Some(hint.to_owned())));
            return None;
        }
        let numbers = &self.structure.numbers;
        if let (Some(number), Some(value)) = (numbers.get(path), value.as_f64()) {
            let Some(why) = &number.barred else {
                return Some((value, number));
            };
            let found = format!("{path} = {value}");
            self.fault(Finding::new(place, found, expected).hint(Some(why.clone())));
            return None;
        }
        let inside = numbers
            .iter()
            .find(|(inner, number)| is_below(inner, path) && number.barred.is_none());
        let hint = inside.map(|(inner, _)| format!("point at one number, such as {inner}"));
        let found = format!("{path}, which is {}", describe(value));
        self.fault(Finding::new(place, found, expected).hint(hint));
        None
    }

    /// Whether the path leads into an entry that has a fault already. It is not reported twice.
    fn is_damaged(&self, path: &str) -> bool {
        let keys = keys(path);
        let entry: String = keys.iter().take(2).map(|key| join("", key)).collect();
        let findings = &self.structure.findings;
        findings.iter().any(|fault| {
            let at = &fault.pointer;
            !at.is_empty() && (is_below(at, &entry) || is_below(path, at))
        })
    }

    /// Advice about a path that does not exist.
    fn hint(&self, path: &str) -> Option<String> {
        let numbers = self.structure.numbers.iter();
        let mut open = numbers
            .filter(|(_, number)| number.barred.is_none())
            .map(|(path, _)| path);
        if let Some(near) = nearest_pointer(path, open.clone().map(String::as_str)) {
            return Some(format!("did you mean {near}?"));
        }
        let section = keys(path).first().cloned().unwrap_or_default();
        match self.document.get(&section) {
            Some(_) => nearest_path(path, self.document),
            None => open.next().map(|path| format!("such a path is {path}")),
        }
    }

    fn bounds(
        &mut self,
        pointer: &str,
        written: &Written,
        path: &str,
        start: f64,
        number: &Number,
    ) {
        let unit = unit_suffix(&number.unit);
        let (lower, upper) = (join(pointer, "lower"), join(pointer, "upper"));
        if let (Some(low), Some(high)) = (written.lower, written.upper)
            && low > high
        {
            let found = format!("the bounds {low} and {high}");
            let expected = "a lower bound below the upper one, or equal bounds to fix the variable";
            self.fault(Finding::new(&upper, found, expected));
            return;
        }
        if let (Some(low), Some(high)) = (written.lower, written.upper)
            && low == high
            && low != start
        {
            let found = format!("the start {start}{unit} of {path}");
            let expected = format!("{low}{unit}, at which both bounds fix the variable");
            self.fault(Finding::new(&lower, found, expected));
            return;
        }
        if let Some(low) = written.lower.filter(|&low| start < low) {
            let found = format!("the lower bound {low}");
            let expected = format!("at most the start {start}{unit}, the value of {path}");
            self.fault(Finding::new(&lower, found, expected));
        }
        if let Some(high) = written.upper.filter(|&high| start > high) {
            let found = format!("the upper bound {high}");
            let expected = format!("at least the start {start}{unit}, the value of {path}");
            self.fault(Finding::new(&upper, found, expected));
        }
        if let Some((least, excluded)) = number.least {
            let range = if excluded { "above" } else { "of at least" };
            let expected = format!("a lower bound {range} {least}{unit}, as {path} must be");
            match written.lower {
                None => self.fault(Finding::new(pointer, "no \"lower\"", expected).of_key()),
                Some(low) if low < least || (excluded && low <= least) => {
                    self.fault(Finding::new(
                        &lower,
                        format!("the lower bound {low}"),
                        expected,
                    ));
                }
                Some(_) => {}
            }
        }
        if let Some(most) = number.most {
            let expected = format!("an upper bound of at most {most}{unit}, as {path} must be");
            match written.upper {
                None => self.fault(Finding::new(pointer, "no \"upper\"", expected).of_key()),
                Some(high) if high > most => {
                    self.fault(Finding::new(
                        &upper,
                        format!("the upper bound {high}"),
                        expected,
                    ));
                }
                Some(_) => {}
            }
        }
    }
}

/// Largest typical change relative to the starting value (absolute for a small start).
const WIDE: f64 = 1e3;

/// A unit in brackets after a number.
fn unit_suffix(unit: &str) -> String {
    match unit {
        "" | "1" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// A unit in words.
fn named_unit(unit: &str) -> &str {
    if unit == "1" { "no unit" } else { unit }
}
