//! What a document states of its cases: which functions are those of the machine, and where they are wanted.

use crate::composing::{value_in_case, without_mark};
use crate::expression::Expression;
use crate::pointer::keys;
use crate::schema::cases::Case as WrittenCase;
use crate::schema::functions::{Function, WhichFunction};
use crate::schema::{Constraint, Document, Objective};
use indexmap::IndexMap;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Sections without a part in the mass.
const WITHOUT_MASS: [&str; 9] = [
    "gravity",
    "loads",
    "drives",
    "couplings",
    "events",
    "simulation",
    "load_cases",
    "modes",
    "turning",
];

/// What a document states of its cases.
pub(super) struct Stated {
    pub(super) cases: IndexMap<String, WrittenCase>,
    /// Functions of the machine: those that they name, and the cases in which they are wanted.
    pub(super) machine: IndexMap<String, Wanted>,
    /// Those that have the same value in all cases: a mass that no case changes, and expressions of it.
    constant: Vec<String>,
    /// Those that stand for several functions: a stress for each thickness.
    pub(super) families: Vec<String>,
    /// Functions over cases, and expressions of them.
    pub(super) over: IndexMap<String, Function>,
    /// Expressions of functions of the machine that stand in constraints; their text is their name.
    in_place: Vec<String>,
    pub(super) objective: Option<Objective>,
    pub(super) constraints: IndexMap<String, Constraint>,
}

/// Where a function of the machine is wanted.
#[derive(Clone, Default)]
pub(super) struct Wanted {
    /// Functions that it needs.
    names: Vec<String>,
    cases: BTreeSet<usize>,
}

/// The names in an expression; none where it has a fault, which is told where it is read.
pub(super) fn names_in(text: &str) -> Vec<String> {
    let parsed = Expression::parse_placed(without_mark(text));
    parsed.map_or_else(
        |_| Vec::new(),
        |own| own.names().iter().map(|own| own.name.clone()).collect(),
    )
}

/// The functions that a function names.
fn needs(function: &Function) -> Vec<String> {
    match function {
        Function::Expression(text) => names_in(text),
        Function::Clearance(own) => vec![own.release.clone()],
        Function::Misfit(own) => own.numbers.iter().map(|own| own.function.clone()).collect(),
        _ => Vec::new(),
    }
}

/// The function and the case of "FUNCTION in CASE".
pub(super) fn parts<'n>(
    name: &'n str,
    functions: &IndexMap<String, Function>,
    cases: &IndexMap<String, WrittenCase>,
) -> Option<(&'n str, usize)> {
    name.match_indices(" in ").find_map(|(at, mark)| {
        let (function, case) = (&name[..at], &name[at + mark.len()..]);
        let case = cases.get_index_of(case)?;
        functions.contains_key(function).then_some((function, case))
    })
}

/// References to functions in the objective and in constraints.
fn references(document: &Document) -> impl Iterator<Item = &WhichFunction> {
    let objective = document.objective.as_ref().map(|own| match own {
        Objective::Minimise(of) | Objective::Maximise(of) => of,
    });
    let constraints = document.constraints.values().map(|own| &own.function);
    objective.into_iter().chain(constraints)
}

impl Stated {
    /// What a document states; `None` if it has no cases.
    pub fn read(document: &Document) -> Option<Self> {
        let (functions, cases) = (&document.functions, &document.cases);
        if cases.is_empty() {
            return None;
        }
        let mut over: IndexMap<String, Function> = IndexMap::new();
        loop {
            let is_over =
                |name: &String| over.contains_key(name) || parts(name, functions, cases).is_some();
            let more = functions.iter().find(|(name, own)| {
                let found = match own {
                    Function::OverCases(_) => true,
                    Function::Expression(text) => names_in(text).iter().any(is_over),
                    _ => false,
                };
                found && !over.contains_key(*name)
            });
            let Some((name, own)) = more else { break };
            over.insert(name.clone(), own.clone());
        }
        // As in the file.
        over.sort_by_cached_key(|name, _| functions.get_index_of(name));
        let of_machine = functions
            .iter()
            .filter(|(name, _)| !over.contains_key(*name));
        let mut machine: IndexMap<String, Wanted> = of_machine
            .map(|(name, own)| {
                let names = needs(own);
                (
                    name.clone(),
                    Wanted {
                        names,
                        cases: BTreeSet::new(),
                    },
                )
            })
            .collect();
        let constant = constant(&machine, functions, cases);
        let all = || 0..cases.len();
        let mut in_place = Vec::new();
        let mut want = |name: &str, which: &mut dyn Iterator<Item = usize>| {
            if let Some(own) = machine.get_mut(name) {
                own.cases.extend(which);
            }
        };
        for name in &constant {
            want(name, &mut std::iter::once(0));
        }
        let mut named = Vec::new();
        for own in over.values() {
            match own {
                Function::OverCases(own) => {
                    let which = own.weights(cases.keys().map(String::as_str));
                    let mut which = which
                        .iter()
                        .filter_map(|(case, _)| cases.get_index_of(*case));
                    want(&own.function, &mut which);
                }
                own => named.extend(needs(own)),
            }
        }
        for of in references(document) {
            match of {
                WhichFunction::Named(name) => {
                    if !constant.contains(name) {
                        want(name, &mut all());
                    }
                    named.push(name.clone());
                }
                WhichFunction::Written(own) => named.extend(names_in(&own.expression)),
            }
        }
        for name in &named {
            if let Some((function, case)) = parts(name, functions, cases) {
                want(function, &mut std::iter::once(case));
            }
        }
        for own in document.constraints.values() {
            if let WhichFunction::Written(own) = &own.function {
                let names = names_in(&own.expression);
                let is_machine = |name: &String| {
                    !over.contains_key(name) && parts(name, functions, cases).is_none()
                };
                let is_constant = |name: &String| constant.contains(name);
                if names.iter().all(is_machine)
                    && !names.iter().all(is_constant)
                    && !in_place.contains(&own.expression)
                {
                    in_place.push(own.expression.clone());
                    let wanted = Wanted {
                        names,
                        cases: all().collect(),
                    };
                    machine.entry(own.expression.clone()).or_insert(wanted);
                }
            }
        }
        spread(&mut machine, cases.len());
        let is_family = |(_, own): &(&String, &Function)| {
            own.stress().is_some_and(|stress| stress.per.is_some())
        };
        let families = functions.iter().filter(is_family);
        Some(Self {
            cases: cases.clone(),
            families: families.map(|(name, _)| name.clone()).collect(),
            machine,
            constant,
            over,
            in_place,
            objective: document.objective.clone(),
            constraints: document.constraints.clone(),
        })
    }

    /// The cases in the order of the file.
    pub fn cases(&self) -> impl Iterator<Item = (&String, &WrittenCase)> {
        self.cases.iter()
    }

    /// Removes the functions of machines whose analysis is that of no case without another one.
    pub fn prepare(&self, document: &mut Document) {
        let same = |case: usize| {
            let own = self.cases[case].analysis;
            own.is_none() || own == document.analysis
        };
        let kept = |name: &String| match self.machine.get(name) {
            Some(own) => own.cases.iter().any(|&case| same(case)),
            None => true,
        };
        let kept: Vec<String> = document
            .functions
            .keys()
            .filter(|&name| kept(name))
            .cloned()
            .collect();
        document.functions.retain(|name, _| kept.contains(name));
    }

    /// Leaves the machine alone.
    pub fn strip(&self, document: &mut Document) {
        document
            .functions
            .retain(|name, _| !self.over.contains_key(name));
        document.constraints.clear();
        document.cases.clear();
        document.objective = None;
    }

    /// Leaves of a file the machine with the functions that are wanted in a case.
    pub fn keep(&self, file: &mut Value, case: &str) {
        let Value::Object(entries) = file else { return };
        for key in ["cases", "objective", "constraints"] {
            entries.shift_remove(key);
        }
        let place = self.cases.get_index_of(case);
        let is_wanted = |name: &str| {
            let own = self.machine.get(name);
            own.is_some_and(|own| place.is_some_and(|place| own.cases.contains(&place)))
        };
        let functions = entries.entry("functions").or_insert_with(|| json!({}));
        if let Value::Object(functions) = functions {
            functions.retain(|name, _| is_wanted(name));
            for text in &self.in_place {
                functions.insert(text.clone(), json!({"expression": text}));
            }
        }
    }

    /// Adds functions over cases, the objective and the constraints to a document of the functions in each case.
    /// `list` has the functions of each case.
    pub fn state(&self, document: &mut Document, list: &[(&str, &[String])]) {
        document.cases.clone_from(&self.cases);
        if let Some(first) = self.cases.keys().next() {
            let one = |name: &String| {
                let of = value_in_case(name, first);
                let mark = if of.contains('\'') { '`' } else { '\'' };
                let text = format!("{mark}{of}{mark}");
                (name.clone(), Function::Expression(text))
            };
            document.functions.extend(self.constant.iter().map(one));
        }
        document.functions.extend(self.over.clone());
        document.objective.clone_from(&self.objective);
        for (name, own) in &self.constraints {
            let of_machine = match &own.function {
                WhichFunction::Named(of) => Some(of),
                WhichFunction::Written(of) => Some(&of.expression),
            };
            let Some(of) = of_machine.filter(|of| self.has_many_values(of)) else {
                document.constraints.insert(name.clone(), own.clone());
                continue;
            };
            for (case, functions) in list {
                let is_meant = |function: &&String| {
                    let member = function.strip_prefix(of.as_str());
                    let is_member = member.is_some_and(|rest| rest.starts_with('['));
                    *function == of || (is_member && self.families.contains(of))
                };
                for function in functions.iter().filter(is_meant) {
                    let name = format!("{name}{}", &function[of.len()..]);
                    let function = WhichFunction::Named(value_in_case(function, case));
                    let own = Constraint {
                        function,
                        ..own.clone()
                    };
                    document.constraints.insert(value_in_case(&name, case), own);
                }
            }
        }
    }

    /// Whether a function is one of the machine whose value may differ from case to case.
    pub(super) fn has_many_values(&self, name: &String) -> bool {
        self.machine.contains_key(name) && !self.constant.contains(name)
    }
}

/// Whether the value at a path has no part in the mass of anything.
fn has_no_mass(path: &str) -> bool {
    let keys = keys(path);
    match keys.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["bodies", _, "place" | "velocity" | "points", ..] => true,
        [section, ..] => WITHOUT_MASS.contains(&section),
        [] => false,
    }
}

/// The functions of the machine that have one value in all cases.
fn constant(
    machine: &IndexMap<String, Wanted>,
    functions: &IndexMap<String, Function>,
    cases: &IndexMap<String, WrittenCase>,
) -> Vec<String> {
    let mut sets = cases.values().flat_map(|case| case.set.keys());
    let mut found: Vec<String> = Vec::new();
    if !sets.all(|path| has_no_mass(path)) {
        return found;
    }
    loop {
        let more = machine.iter().find(|(name, own)| {
            let is_one = match functions.get(*name) {
                Some(Function::Mass) => true,
                // Names of no functions are those of parameters.
                Some(Function::Expression(_)) => (own.names.iter())
                    .all(|name| found.contains(name) || !functions.contains_key(name)),
                _ => false,
            };
            is_one && !found.contains(name)
        });
        match more {
            Some((name, _)) => found.push(name.clone()),
            None => return found,
        }
    }
}

/// Functions that others need are wanted where these are, and those that nothing wants are in all cases.
fn spread(machine: &mut IndexMap<String, Wanted>, count: usize) {
    let mut left: Vec<usize> = (0..machine.len()).collect();
    loop {
        let needed_by_left = |k: usize| {
            let name = machine.get_index(k).map_or("", |(name, _)| name.as_str());
            let others = left.iter().filter(|&&other| other != k);
            let mut others = others.map(|&other| &machine[other].names);
            others.any(|names| names.iter().any(|own| own == name))
        };
        // In a circle, which is told where expressions are read, any is next.
        let next = left.iter().position(|&k| !needed_by_left(k)).unwrap_or(0);
        if left.is_empty() {
            return;
        }
        let k = left.swap_remove(next);
        if machine[k].cases.is_empty() {
            machine[k].cases = (0..count).collect();
        }
        let Wanted { names, cases } = machine[k].clone();
        for name in &names {
            if let Some(own) = machine.get_mut(name) {
                own.cases.extend(&cases);
            }
        }
    }
}
