//! Reads expressions of functions: names, order and units.

use super::aggregates::rho_of;
use super::composed::{Composed, Composition, Term};
use super::derived::{Derived, place};
use super::expression::{Call, Expression, MARK, Operator, Placed};
use super::expression_units::{Known, unit};
use super::finding::{Finding, Part};
use super::pointer::{advice, join};
use super::prune::Damage;
use super::source::Source;
use crate::math::unit::Unit;
use crate::schema::cases::{CaseCombination, Extreme, OverCases};
use crate::schema::functions::{Function, WhichFunction};
use crate::schema::{Document, Objective};
use indexmap::IndexMap;
use serde_json::{Map, Value};
use std::collections::HashSet;

/// An expression of functions in a file.
struct Written {
    name: String,
    pointer: String,
    /// Without a mark at its beginning.
    text: String,
    /// Bytes before it.
    skipped: usize,
    expression: Expression<Placed>,
}

/// The expressions of functions of a file.
#[derive(Default)]
pub(super) struct Composing {
    /// Each after those that it names.
    list: Vec<Written>,
    /// Names of those in the place of a name, by their text.
    in_place: IndexMap<String, String>,
}

/// The expression of a function in a document, if it is one.
fn expression_of(function: &Function) -> Option<&String> {
    match function {
        Function::Expression(text) => Some(text),
        _ => None,
    }
}

/// References to functions, with their pointers.
pub(super) fn references(document: &Document) -> Vec<(String, &WhichFunction)> {
    let objective = document.objective.as_ref().map(|own| match own {
        Objective::Minimise(of) => ("/objective/minimise".to_owned(), of),
        Objective::Maximise(of) => ("/objective/maximise".to_owned(), of),
    });
    let constraints = document.constraints.iter().map(|(name, own)| {
        let pointer = join(&join("/constraints", name), "function");
        (pointer, &own.function)
    });
    objective.into_iter().chain(constraints).collect()
}

/// All expressions of functions: name, if it has one, pointer and text.
fn texts(document: &Document) -> Vec<(Option<&String>, String, &String)> {
    let named = document.functions.iter().filter_map(|(name, function)| {
        let pointer = join(&join("/functions", name), "expression");
        Some((Some(name), pointer, expression_of(function)?))
    });
    let in_place = references(document)
        .into_iter()
        .filter_map(|(pointer, of)| match of {
            WhichFunction::Named(_) => None,
            WhichFunction::Written(own) => {
                Some((None, join(&pointer, "expression"), &own.expression))
            }
        });
    named.chain(in_place).collect()
}

/// Whether the objective, a constraint or an expression names a function.
pub(super) fn is_wanted(document: &Document, function: &str) -> bool {
    let mut own = references(document).into_iter();
    let named = own.any(|(_, of)| matches!(of, WhichFunction::Named(name) if name == function));
    let names = |text: &String| {
        let parsed = Expression::parse_placed(without_mark(text));
        parsed.is_ok_and(|own| own.names().iter().any(|own| own.name == function))
    };
    named || texts(document).iter().any(|(_, _, text)| names(text))
}

/// An expression without the mark that expressions of numbers have.
pub(super) fn without_mark(text: &str) -> &str {
    text.strip_prefix(MARK).unwrap_or(text)
}

/// A fault of bytes of an expression.
fn fault_at(
    source: &Source,
    own: (&str, &str, usize),
    finding: Finding,
    at: [usize; 2],
) -> Finding {
    let (pointer, text, skipped) = own;
    Finding {
        part: match place(source, pointer, (at[0], at[1]), text, skipped) {
            Some(bytes) => Part::Bytes(bytes),
            None => Part::Value,
        },
        ..finding
    }
}

impl Composing {
    /// Reads the expressions of functions of a document.
    ///
    /// # Errors
    /// All faults of grammar, names and circles.
    pub fn read(
        written: &Document,
        (parameters, source): (Option<&Map<String, Value>>, &Source),
        damage: &Damage,
    ) -> Result<Self, Vec<Finding>> {
        let mut findings = Vec::new();
        let mut list: Vec<Written> = Vec::new();
        let mut in_place: IndexMap<String, String> = IndexMap::new();
        for (name, pointer, whole) in texts(written) {
            let text = without_mark(whole);
            let skipped = whole.len() - text.len();
            let expression = match Expression::parse_placed(text) {
                Ok(expression) => expression,
                Err(fault) => {
                    let finding = Finding::new(&pointer, fault.found, fault.expected);
                    let at = [fault.at.start, text.len()];
                    findings.push(fault_at(source, (&pointer, text, skipped), finding, at));
                    continue;
                }
            };
            let name = match name {
                Some(name) => name.clone(),
                None => {
                    let own = text.trim().to_owned();
                    if in_place.contains_key(&own) {
                        continue;
                    }
                    if let Expression::Name(lone) = &expression
                        && written.functions.contains_key(&lone.name)
                    {
                        in_place.insert(own, lone.name.clone());
                        continue;
                    }
                    let mut free = own.clone();
                    // An expression may be the name of a parameter alone.
                    let is_parameter =
                        |name: &str| parameters.is_some_and(|all| all.contains_key(name));
                    while written.functions.contains_key(&free) || is_parameter(&free) {
                        free.push('\'');
                    }
                    in_place.insert(own, free.clone());
                    free
                }
            };
            list.push(Written {
                name,
                pointer,
                text: text.to_owned(),
                skipped,
                expression,
            });
        }
        let over = written
            .functions
            .iter()
            .filter_map(|(name, own)| match own {
                Function::OverCases(own) => Some(Written {
                    name: name.clone(),
                    pointer: join(&join("/functions", name), "over_cases"),
                    text: String::new(),
                    skipped: 0,
                    expression: over_cases(written, own),
                }),
                _ => None,
            });
        list.extend(over);
        for own in &list {
            for name in own.expression.names() {
                if let Some(finding) = wrong_name(written, parameters, damage, (own, name)) {
                    let of = (&own.pointer[..], &own.text[..], own.skipped);
                    findings.push(fault_at(source, of, finding, [name.at.start, name.at.end]));
                }
            }
        }
        if !findings.is_empty() {
            return Err(findings);
        }
        let (list, circle) = in_order(list);
        match circle {
            Some(finding) => Err(vec![finding]),
            None => Ok(Self { list, in_place }),
        }
    }

    /// Names of the functions that expressions give.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.list.iter().map(|own| &own.name)
    }

    /// The name of the function that is meant.
    pub fn name<'a>(&'a self, of: &'a WhichFunction) -> &'a str {
        match of {
            WhichFunction::Named(name) => name,
            WhichFunction::Written(own) => {
                let text = without_mark(&own.expression).trim();
                self.in_place.get(text).map_or(text, String::as_str)
            }
        }
    }

    /// The functions of these expressions. `names` are those of all functions, the first `first` of the scene.
    pub fn composition(
        &self,
        (names, first): (&[String], usize),
        parameters: Option<&Map<String, Value>>,
        derived: &Derived,
    ) -> Composition {
        let term = |own: &Placed| -> Result<Term, ()> {
            if let Some(f) = names.iter().position(|name| *name == own.name) {
                return Ok(Term::Function(f));
            }
            if let Some(place) = derived.place(&own.name) {
                return Ok(Term::Place(place));
            }
            let number = parameters.and_then(|all| all.get(&own.name)?.as_f64());
            number.map(Term::Fixed).ok_or(())
        };
        let one = |own: &Written| Composed {
            expression: (own.expression.named(&mut |name| term(name)))
                .expect("names are checked before"),
            unit: String::new(),
        };
        Composition {
            first,
            list: self.list.iter().map(one).collect(),
            derived: derived.clone(),
        }
    }

    /// The units of the expressions, in their order; `of` gives those of functions of the scene.
    ///
    /// # Errors
    /// Terms of different units.
    pub fn units(
        &self,
        of: impl Fn(&str) -> Option<String>,
        source: &Source,
    ) -> Result<Vec<String>, Vec<Finding>> {
        let mut known: IndexMap<&str, Known> = IndexMap::new();
        let mut findings = Vec::new();
        for own in &self.list {
            let of_name = |name: &str| match (known.get(name), of(name)) {
                (Some(known), _) => known.clone(),
                (None, Some(text)) => {
                    let unit = Unit::read(&text);
                    let exact = unit.is_some();
                    Known { unit, exact }
                }
                (None, None) => Known {
                    unit: None,
                    exact: false,
                },
            };
            match unit(&own.expression, &of_name) {
                Ok(unit) => {
                    known.insert(&own.name, unit);
                }
                Err(fault) => {
                    let finding = Finding::new(&own.pointer, fault.found, fault.expected);
                    let finding = finding.hint(Some(fault.hint.to_owned()));
                    let of = (&own.pointer[..], &own.text[..], own.skipped);
                    let at = [fault.at.start, fault.at.end];
                    findings.push(fault_at(source, of, finding, at));
                    let (unit, exact) = (None, false);
                    known.insert(&own.name, Known { unit, exact });
                }
            }
        }
        if !findings.is_empty() {
            return Err(findings);
        }
        let text = |known: &Known| {
            known
                .unit
                .as_ref()
                .map_or_else(String::new, Unit::to_string)
        };
        Ok(known.values().map(text).collect())
    }
}

/// Removes the functions that expressions give.
pub(super) fn strip(document: &mut Document) {
    document.functions.retain(|_, function| {
        !matches!(function, Function::Expression(_) | Function::OverCases(_))
    });
}

/// Name of the value of a function in a case, and of what belongs to it.
pub(super) fn value_in_case(function: &str, case: &str) -> String {
    format!("{function} in {case}")
}

/// A function over cases as an expression of its values in these.
fn over_cases(written: &Document, own: &OverCases) -> Expression<Placed> {
    let weights = own.weights(written.cases.keys().map(String::as_str));
    let number = |x: f64| Expression::Number(x);
    let value = |case: &str| {
        Expression::Name(Placed {
            name: value_in_case(&own.function, case),
            at: 0..0,
        })
    };
    let both = |operator, a, b| Expression::Binary(operator, Box::new([a, b]));
    // Equal weights of one leave values as they are.
    let weighted = |weight: f64, of| match weight {
        1.0 => of,
        weight => both(Operator::Times, number(weight), of),
    };
    let sum = |terms: &mut dyn Iterator<Item = Expression<Placed>>| {
        let sum = terms.reduce(|sum, term| both(Operator::Plus, sum, term));
        sum.unwrap_or(Expression::Number(0.0))
    };
    let of_all = || sum(&mut weights.iter().map(|&(case, w)| weighted(w, value(case))));
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mean = || both(Operator::Over, of_all(), number(total));
    match &own.by {
        CaseCombination::Sum => of_all(),
        CaseCombination::Mean => mean(),
        CaseCombination::Deviation => {
            let square = |&(case, w): &(&str, f64)| {
                let distance = both(Operator::Minus, value(case), mean());
                weighted(w, both(Operator::Power, distance, number(2.0)))
            };
            let squares = sum(&mut weights.iter().map(square));
            let variance = both(Operator::Over, squares, number(total));
            Expression::Call(Call::Sqrt, Box::new(variance))
        }
        CaseCombination::Ks(ks) => {
            let rho = rho_of(ks.rho);
            let all = weights.iter().map(|(case, _)| value(case));
            match ks.of.unwrap_or_default() {
                Extreme::Largest => Expression::Ks(rho, all.collect()),
                Extreme::Smallest => {
                    let minus = |own| Expression::Minus(Box::new(own));
                    minus(Expression::Ks(rho, all.map(minus).collect()))
                }
            }
        }
    }
}

/// Why a name of an expression stands for nothing, or for nothing that is one number.
fn wrong_name(
    written: &Document,
    parameters: Option<&Map<String, Value>>,
    damage: &Damage,
    (own, Placed { name, .. }): (&Written, &Placed),
) -> Option<Finding> {
    let function = written.functions.get(name);
    let is_parameter = parameters.is_some_and(|all| all.contains_key(name));
    let stress = function.and_then(Function::stress);
    let of = |found: String, expected: &str| Some(Finding::new(&own.pointer, found, expected));
    match (function, is_parameter) {
        (Some(_), true) => {
            let found = format!("\"{name}\", a function and a parameter");
            of(found, "names that mean one thing")
        }
        (Some(_), false) if stress.is_some_and(|own| own.per.is_some()) => {
            let found = format!("\"{name}\", a stress for each thickness");
            of(found, "a function of one value")
        }
        (Some(_), false) | (None, true) => None,
        (None, false) if damage.holds("functions", name) || damage.touches("parameters") => None,
        (None, false) => {
            let functions = written.functions.keys().map(String::as_str);
            let parameters = parameters.into_iter().flat_map(Map::keys);
            let all = functions.chain(parameters.map(String::as_str));
            let hint = match &name[..] {
                "mass" | "duration" => Some(format!(
                    "\"functions\": {{\"{name}\": \"{name}\"}} gives it"
                )),
                _ => advice(name, "functions and parameters", all),
            };
            let expected = "the name of a function or parameter, pi or deg";
            of(format!("the name \"{name}\""), expected).map(|finding| finding.hint(hint))
        }
    }
}

/// Expressions in an order in which each is after those that it names; or a circle.
fn in_order(mut waiting: Vec<Written>) -> (Vec<Written>, Option<Finding>) {
    let mut list: Vec<Written> = Vec::new();
    let mut open: HashSet<String> = waiting.iter().map(|own| own.name.clone()).collect();
    loop {
        let (ready, others): (Vec<Written>, Vec<Written>) = waiting.into_iter().partition(|own| {
            let mut names = own.expression.names().into_iter();
            names.all(|name| !open.contains(&name.name))
        });
        waiting = others;
        if ready.is_empty() {
            break;
        }
        for own in ready {
            open.remove(&own.name);
            list.push(own);
        }
    }
    let circle = waiting.first().map(|first| {
        // From any that waits, each names one that waits, until one comes again.
        let mut path = vec![first];
        let start = loop {
            let last = path[path.len() - 1];
            let names = last.expression.names();
            let next = names.iter().find(|name| open.contains(&name.name));
            let next = waiting
                .iter()
                .find(|own| next.is_some_and(|name| own.name == name.name));
            let Some(next) = next else { break 0 };
            if let Some(start) = path.iter().position(|own| own.name == next.name) {
                break start;
            }
            path.push(next);
        };
        let circle = &path[start..];
        let names = circle.iter().chain(circle.first());
        let names: Vec<String> = names.map(|own| format!("\"{}\"", own.name)).collect();
        let found = format!("a circle: {}", names.join(" names "));
        let expected = "functions that do not depend on themselves";
        Finding::new(&circle[0].pointer, found, expected)
    });
    (list, circle)
}
