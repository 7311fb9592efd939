//! What is wrong with cases, functions over them and references to functions in a document with cases.

use super::composing::value_in_case;
use super::finding::Finding;
use super::pointer::{advice, is_below, join, keys};
use super::stated_cases::{Stated, names_in, parts};
use crate::schema::cases::{CaseCombination, OverCases, WhichCases};
use crate::schema::functions::{Function, WhichFunction};
use crate::schema::{Document, Objective};

/// Sections of a file in which a case may not set values: they state what is sought, not the machine.
const OF_ALL_CASES: [&str; 9] = [
    "version",
    "name",
    "cases",
    "functions",
    "variables",
    "objective",
    "constraints",
    "optimiser",
    "plot",
];

impl Stated {
    /// What is wrong with cases, functions over them and references to functions. `document` is sound otherwise.
    pub fn faults(&self, document: &Document) -> Vec<Finding> {
        let mut found: Vec<Finding> = Vec::new();
        for (name, case) in &self.cases {
            let pointer = join("/cases", name);
            let fits = |c: char| c.is_alphanumeric() || "-_ .".contains(c);
            if name.trim().is_empty() || name.starts_with('.') || !name.chars().all(fits) {
                let expected = "a name for a directory, of letters, digits, spaces, dots, - and _";
                found.push(Finding::new(&pointer, format!("\"{name}\""), expected).of_key());
            }
            found.extend(self.ambiguous(&pointer, name));
            let sets = join(&pointer, "set");
            found.extend(
                case.set
                    .keys()
                    .filter_map(|path| wrong_set(document, &sets, path)),
            );
        }
        for (name, own) in &self.over {
            if let Function::OverCases(own) = own {
                let pointer = join(&join("/functions", name), "over_cases");
                found.extend(self.wrong_over(&pointer, own));
            }
        }
        let all = self.machine.keys().flat_map(|function| {
            let cases = self.cases.keys();
            cases.map(move |case| value_in_case(function, case))
        });
        let taken = all.filter(|name| document.functions.contains_key(name));
        found.extend(taken.map(|name| {
            let found = "the name of a function in a case";
            Finding::new(join("/functions", name), found, "another name").of_key()
        }));
        found.extend(self.wrong_references(document));
        found
    }

    /// Why a name of a case may stand for something else: the directory of another case, or a case of another name.
    fn ambiguous(&self, pointer: &str, name: &str) -> Option<Finding> {
        let own = self.cases.get_index_of(name)?;
        let mut before = self.cases.keys().take(own);
        let same = before.find(|other| other.to_lowercase() == name.to_lowercase());
        let (said, expected) = match same {
            Some(other) => (
                format!("\"{name}\" after \"{other}\""),
                "names that differ by more than letter case, as each is a directory",
            ),
            None if name.contains(" in ") => (
                format!("\"{name}\""),
                "a name without \" in \", which stands between function and case",
            ),
            None => return None,
        };
        Some(Finding::new(pointer, said, expected).of_key())
    }

    fn wrong_references(&self, document: &Document) -> Vec<Finding> {
        let mut found = Vec::new();
        let mut objective = None;
        if let Some(own) = &self.objective {
            objective = Some(match own {
                Objective::Minimise(of) => ("/objective/minimise".to_owned(), of),
                Objective::Maximise(of) => ("/objective/maximise".to_owned(), of),
            });
        }
        if let Some((pointer, of)) = &objective {
            let (name, many) = match of {
                WhichFunction::Named(name) => (name, self.has_many_values(name)),
                WhichFunction::Written(own) => {
                    let names = names_in(&own.expression);
                    let has_many = |name: &String| self.has_many_values(name);
                    (&own.expression, names.iter().any(has_many))
                }
            };
            if many {
                let said = format!("\"{name}\", which has a value in each case");
                let first = self.cases.keys().next().map_or("", String::as_str);
                let hint = format!(
                    "\"{}\" is that of one case; a function {{\"over_cases\": {{\"function\": …, \"by\": {{\"ks\": {{}}}}}}}} is the worst of all",
                    value_in_case(name, first)
                );
                let expected = "a function of one value";
                found.push(Finding::new(pointer, said, expected).hint(Some(hint)));
            }
        }
        let constraints = self
            .constraints
            .iter()
            .map(|(name, own)| (join(&join("/constraints", name), "function"), &own.function));
        for (pointer, of) in objective.into_iter().chain(constraints) {
            let WhichFunction::Named(name) = of else {
                continue;
            };
            let known = document.functions.contains_key(name) || self.machine.contains_key(name);
            let of_case = parts(name, &document.functions, &self.cases);
            if known
                || of_case.is_some_and(|(own, _)| !self.families.iter().any(|name| name == own))
            {
                continue;
            }
            let own = document.functions.keys().cloned();
            let in_cases = self.machine.keys().flat_map(|function| {
                self.cases
                    .keys()
                    .map(move |case| value_in_case(function, case))
            });
            let all: Vec<String> = own.chain(in_cases).collect();
            let hint = advice(name, "functions", all.iter().map(String::as_str));
            let expected = "the name of a function, or FUNCTION in CASE";
            found.push(Finding::new(pointer, format!("\"{name}\""), expected).hint(hint));
        }
        for name in self.constraints.keys() {
            let taken = self.cases.keys().map(|case| value_in_case(name, case));
            for other in taken.filter(|other| self.constraints.contains_key(other)) {
                let said = "the name of a constraint in a case";
                found
                    .push(Finding::new(join("/constraints", other), said, "another name").of_key());
            }
        }
        found
    }

    fn wrong_over(&self, pointer: &str, own: &OverCases) -> Vec<Finding> {
        let mut found = Vec::new();
        if !self.machine.contains_key(&own.function) {
            let names = self.machine.keys().map(String::as_str);
            let hint = advice(&own.function, "such functions", names);
            let expected = "the name of a function of the machine";
            let said = match self.over.contains_key(&own.function) {
                true => format!("\"{}\", which is one over cases itself", own.function),
                false => format!("\"{}\"", own.function),
            };
            found.push(Finding::new(join(pointer, "function"), said, expected).hint(hint));
        }
        if self.families.contains(&own.function) {
            let said = format!("\"{}\", a stress for each thickness", own.function);
            let place = join(pointer, "function");
            found.push(Finding::new(place, said, "a function of one value"));
        }
        let at = join(pointer, "cases");
        let weights = own.weights(self.cases.keys().map(String::as_str));
        for (k, (name, weight)) in weights.iter().enumerate() {
            let place = match &own.cases {
                Some(WhichCases::Weighted(_)) => join(&at, name),
                _ => join(&at, k),
            };
            if !self.cases.contains_key(*name) {
                let hint = advice(name, "cases", self.cases.keys().map(String::as_str));
                let said = format!("\"{name}\"");
                let finding = Finding::new(&place, said, "the name of a case").hint(hint);
                let key = matches!(own.cases, Some(WhichCases::Weighted(_)));
                found.push(if key { finding.of_key() } else { finding });
            } else if weights[..k].iter().any(|(other, _)| other == name) {
                let said = format!("\"{name}\" once more");
                found.push(Finding::new(&place, said, "each case once"));
            }
            let positive = !matches!(own.by, CaseCombination::Sum);
            if !weight.is_finite() || (positive && *weight <= 0.0) {
                let expected = if positive {
                    "a weight above zero"
                } else {
                    "a finite weight"
                };
                found.push(Finding::new(&place, weight.to_string(), expected));
            }
        }
        if weights.is_empty() {
            found.push(Finding::new(&at, "no case", "one case or more"));
        }
        match (&own.by, &own.cases) {
            (CaseCombination::Ks(_), Some(WhichCases::Weighted(_))) => {
                let expected = "a list of cases: the largest of values has no weights";
                found.push(Finding::new(&at, "weights", expected));
            }
            (CaseCombination::Deviation, _) if weights.len() == 1 => {
                let said = "the deviation of one case, which is zero";
                found.push(Finding::new(join(pointer, "by"), said, "two cases or more"));
            }
            _ => {}
        }
        found
    }
}

/// Why a case cannot set a value at a path, if so.
fn wrong_set(document: &Document, sets: &str, path: &str) -> Option<Finding> {
    let at = join(sets, path);
    if !path.starts_with('/') {
        let hint = format!("did you mean \"/{}\"?", path.replace('.', "/"));
        let expected = "a JSON Pointer such as \"/bodies/arm/mass\"";
        let finding = Finding::new(at, format!("\"{path}\""), expected).of_key();
        return Some(finding.hint(Some(hint)));
    }
    let section = keys(path).into_iter().next().unwrap_or_default();
    if OF_ALL_CASES.contains(&section.as_str()) {
        let said = format!("a value of \"{section}\", which all cases have in common");
        let expected = "a value of the machine or of its simulation";
        return Some(Finding::new(at, said, expected).of_key());
    }
    document.variables.iter().find_map(|(name, own)| {
        let mut paths = own.path.iter().chain(own.paths.iter().flatten());
        let same = |other: &String| is_below(other, path) || is_below(path, other);
        paths.any(same).then(|| {
            let said = format!("a number that the design variable \"{name}\" gives");
            Finding::new(&at, said, "a value that no variable changes").of_key()
        })
    })
}
