//! Numbers of a file that expressions of its parameters give: `"parameters": {"L": 0.35}` and then
//! `"= L/2"` in the place of a number.
//!
//! Expressions are replaced by their values before the document is checked. Those that change with a
//! design variable are bound to places behind the variables: a design x becomes
//! x, d_0(x), d_1(x), …, in any scalar. So derivatives follow as those of variables do.

use super::expression::{Expression, MARK, is_name, reserved};
use super::finding::{Finding, Part};
use super::parameter_units::{claims, give};
use super::pointer::{advice, join, keys, of_parameter};
use super::source::Source;
use super::structure::Structure;
use super::variables::Variable;
use crate::math::{Dual, Scalar};
use crate::quantity::Quantity;
use crate::schema::OF_PARAMETERS;
use indexmap::IndexMap;
use serde_json::{Map, Number, Value};
use std::borrow::Cow;
use std::ops::Range;

/// Most faults of bounds that are reported.
const MOST_BOUNDS: usize = 5;
/// Largest whole number that a floating-point number holds exactly.
const LARGEST_WHOLE: f64 = 9e15;

/// The expressions of a document.
#[derive(Default)]
pub(super) struct Expressions {
    /// By pointer, those of parameters in the order of their dependence before the others.
    list: IndexMap<String, Written>,
}

/// An expression in a document.
struct Written {
    expression: Expression<String>,
    value: f64,
}

/// Numbers that follow from a design.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Derived {
    /// Number of variables.
    variables: usize,
    /// Each in terms of the variables and of those before it.
    list: Vec<(String, Expression<Operand>)>,
    /// Places of the parameters that change with the design.
    places: IndexMap<String, usize>,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    /// A number of the file.
    Fixed(f64),
    /// A place in the design and what follows from it.
    Place(usize),
}

/// The parameter at a pointer.
fn parameter_at(pointer: &str) -> Option<String> {
    match &keys(pointer)[..] {
        [section, name] if section == "parameters" => Some(name.clone()),
        _ => None,
    }
}

impl Expressions {
    /// Evaluates the expressions at the pointers that `structure` found in a document.
    pub fn evaluate(
        document: &Value,
        structure: &Structure,
        source: &Source,
    ) -> Result<Self, Vec<Finding>> {
        let parameters = document["parameters"].as_object();
        let origins = &source.origins;
        let own = |name: &String| !origins.parameters.contains_key(&of_parameter(name));
        let named = parameters
            .into_iter()
            .flat_map(Map::keys)
            .filter(|name| own(name));
        let mut findings = names_of("/parameters", named);
        let mut parsed: IndexMap<String, Expression<String>> = IndexMap::new();
        let exists = |name: &String| parameters.is_some_and(|all| all.contains_key(name));
        for pointer in &structure.expressions {
            if let Some(made) = origins.made.get(pointer) {
                parsed.insert(pointer.clone(), made.clone());
                continue;
            }
            let text = document.pointer(pointer).and_then(Value::as_str);
            let text = text.and_then(|text| text.strip_prefix(MARK)).unwrap_or("");
            match Expression::parse(text) {
                Ok(expression) => {
                    let scope = origins.scope(pointer);
                    parsed.insert(pointer.clone(), in_scope(expression, scope, exists));
                }
                Err(fault) => {
                    let mut finding = Finding::new(pointer, fault.found, fault.expected);
                    let bytes = place(source, pointer, (fault.at.start, text.len()), text, 1);
                    finding.part = bytes.map_or(Part::Value, Part::Bytes);
                    findings.push(finding);
                }
            }
        }
        let none = Map::new();
        let parameters = parameters.unwrap_or(&none);
        for (pointer, expression) in &parsed {
            for name in expression.names() {
                if !parameters.contains_key(name) {
                    let scope = origins.scope(pointer);
                    let known = parameters.keys().filter_map(|name| seen_from(scope, name));
                    let hint = match parameters.is_empty() {
                        true => Some("the file has no \"parameters\"".to_owned()),
                        false => advice(name, "parameters", known),
                    };
                    let found = format!("the name \"{name}\"");
                    let expected = "a name of \"parameters\", pi, deg or a function";
                    findings.push(Finding::new(pointer, found, expected).hint(hint));
                }
            }
        }
        if !findings.is_empty() {
            return Err(findings);
        }
        let mut done = Self::default();
        let mut known: IndexMap<String, f64> = IndexMap::new();
        for (name, value) in parameters {
            if let Some(number) = value.as_f64() {
                known.insert(name.clone(), number);
            }
        }
        // Parameters first: each after those that it names.
        let is_of_parameter = |pointer: &String| parameter_at(pointer).is_some();
        let (mut waiting, others): (IndexMap<_, _>, IndexMap<_, _>) =
            (parsed.into_iter()).partition(|(pointer, _)| is_of_parameter(pointer));
        loop {
            let ready = waiting.values().position(|expression| {
                let names = expression.names();
                names.iter().all(|name| known.contains_key(*name))
            });
            let Some(next) = ready else { break };
            if let Some((pointer, expression)) = waiting.shift_remove_index(next) {
                let value = expression.value(&|name: &String| known[name]);
                known.extend(parameter_at(&pointer).map(|name| (name, value)));
                done.list.insert(pointer, Written { expression, value });
            }
        }
        for (pointer, expression) in waiting {
            let names = expression.names();
            let open = names.iter().find(|name| !known.contains_key(**name));
            let open = open.map_or("", |name| name.as_str());
            let found = format!("a circle through \"{open}\"");
            let expected = "parameters that do not depend on themselves";
            findings.push(Finding::new(pointer, found, expected));
        }
        for (pointer, expression) in others {
            // The circle of a parameter, or its wrong kind, is a fault already.
            if !(expression.names().iter()).all(|name| known.contains_key(*name)) {
                continue;
            }
            let value = expression.value(&|name: &String| known[name]);
            done.list.insert(pointer, Written { expression, value });
        }
        for (pointer, written) in &done.list {
            if !written.value.is_finite() {
                let found = format!("an expression whose value is {}", written.value);
                findings.push(Finding::new(pointer, found, "a finite number"));
            }
        }
        match findings.is_empty() {
            true => Ok(done),
            false => Err(findings),
        }
    }

    /// Puts the values in the places of the expressions.
    pub fn replace(&self, document: &mut Value) {
        for (pointer, Written { value, .. }) in &self.list {
            let whole = value.fract() == 0.0 && value.abs() < LARGEST_WHOLE;
            let number = match whole {
                true => Some(Number::from(*value as i64)),
                false => Number::from_f64(*value),
            };
            if let (Some(place), Some(number)) = (document.pointer_mut(pointer), number) {
                *place = Value::Number(number);
            }
        }
    }

    /// Whether the number at a pointer is given by an expression.
    pub fn gives(&self, pointer: &str) -> bool {
        self.list.contains_key(pointer)
    }

    /// Binds the numbers that change with the variables, and returns what gives them.
    pub fn bind(
        &self,
        document: &mut Value,
        variables: &mut [Variable],
        structure: &Structure,
    ) -> Result<Derived, Vec<Finding>> {
        let mut derived = Derived {
            variables: variables.len(),
            list: Vec::new(),
            places: IndexMap::new(),
        };
        let mut places: IndexMap<String, usize> = IndexMap::new();
        for (index, variable) in variables.iter().enumerate() {
            let names = variable.paths.iter().filter_map(|path| parameter_at(path));
            places.extend(names.map(|name| (name, index)));
        }
        let values = |name: &str| {
            let pointer = of_parameter(name);
            let given = self.list.get(&pointer).map(|own| own.value);
            given.or_else(|| document.pointer(&pointer).and_then(Value::as_f64))
        };
        let values: IndexMap<String, f64> = (self.list.values())
            .flat_map(|own| own.expression.names())
            .filter_map(|name| Some((name.clone(), values(name)?)))
            .collect();
        let (mut findings, mut units) = (Vec::new(), Vec::new());
        for (pointer, Written { expression, value }) in &self.list {
            if !(expression.names().iter()).any(|name| places.contains_key(*name)) {
                continue;
            }
            let number = structure.numbers.get(pointer);
            let own = parameter_at(pointer);
            let why = number.map_or(Some("it is no physical number"), |own| {
                own.barred.as_deref()
            });
            if let (None, Some(why)) = (&own, why) {
                let found = "an expression that changes with a design variable";
                let finding = Finding::new(pointer, found, "one of fixed parameters");
                findings.push(finding.hint(Some(why.to_owned())));
                continue;
            }
            if let Some(number) = number.filter(|own| own.unit != OF_PARAMETERS) {
                let given = |name: &String| {
                    let own = self.list.get(&of_parameter(name))?;
                    Some(&own.expression)
                };
                units.extend(claims(expression, &number.unit, &values, &given));
            }
            let place = derived.variables + derived.list.len();
            let of = |name: &String| match places.get(name) {
                Some(place) => Operand::Place(*place),
                None => Operand::Fixed(values[name]),
            };
            let Ok(resolved) = expression.named(&mut |name| Ok::<_, ()>(of(name))) else {
                continue;
            };
            derived.list.push((pointer.clone(), resolved));
            match own {
                Some(name) => {
                    places.insert(name, place);
                }
                None => {
                    let entries = entries(document, pointer);
                    if entries.is_empty() {
                        let found = "an expression that changes with a design variable";
                        let expected = "a number that is written out";
                        findings.push(Finding::new(pointer, found, expected));
                    }
                    for entry in entries {
                        if let Some(entry) = document.pointer_mut(&entry) {
                            *entry = Quantity::bound(place, *value);
                        }
                    }
                }
            }
        }
        derived.places = places;
        findings.extend(derived.beyond_limits(variables, structure));
        give(&units, variables);
        // What is not known is not told.
        for variable in variables.iter_mut().filter(|own| own.unit == OF_PARAMETERS) {
            variable.unit.clear();
        }
        match findings.is_empty() {
            true => Ok(derived),
            false => Err(findings),
        }
    }
}

/// Where a number stands by now: at its pointer, or, if it is the one value of a varied thickness or section, in
/// each of the values that it stands for.
fn entries(document: &Value, pointer: &str) -> Vec<String> {
    if document.pointer(pointer).is_some() {
        return vec![pointer.to_owned()];
    }
    let Some((property, below)) = pointer.rsplit_once("/value") else {
        return Vec::new();
    };
    let values = document.pointer(&join(property, "values"));
    let count = values.and_then(Value::as_array).map_or(0, Vec::len);
    let entry = |k: usize| format!("{property}/values/{k}{below}");
    let all = (0..count).map(entry);
    all.filter(|entry| document.pointer(entry).is_some())
        .collect()
}

/// The name in the document of a parameter of a use.
pub(super) fn parameter_of(used: &str, name: &str) -> String {
    format!("{used}/{name}")
}

/// An expression of a use, whose names are those of its own parameters where `exists` knows them.
pub(super) fn in_scope(
    expression: Expression<String>,
    scope: Option<&str>,
    exists: impl Fn(&String) -> bool,
) -> Expression<String> {
    let Some(scope) = scope else {
        return expression;
    };
    let of = |name: &String| {
        let own = parameter_of(scope, name);
        Ok::<_, ()>(if exists(&own) { own } else { name.clone() })
    };
    expression.named(&mut { of }).unwrap_or(expression)
}

/// The name by which expressions of a use, or of the machine, know a parameter; none if they do not.
fn seen_from<'a>(scope: Option<&str>, name: &'a str) -> Option<&'a str> {
    let own = scope.and_then(|scope| name.strip_prefix(scope)?.strip_prefix('/'));
    own.or(Some(name)).filter(|name| is_name(name))
}

/// Faults of the names of parameters at a pointer.
pub(super) fn names_of<'a>(pointer: &str, names: impl Iterator<Item = &'a String>) -> Vec<Finding> {
    let wrong = names.filter_map(|name| {
        let expected = match is_name(name) {
            true if reserved().any(|own| own == name) => "a name that has no meaning yet",
            true => return None,
            false => "letters, digits and underscores, and no digit first",
        };
        let found = format!("the name \"{name}\"");
        Some(Finding::new(join(pointer, name), found, expected).of_key())
    });
    wrong.collect()
}

/// The bytes of the file from one byte of a text to another, with `skipped` bytes between its quotation mark and the
/// text; `None` if it is written with escapes.
pub(super) fn place(
    source: &Source,
    pointer: &str,
    (from, to): (usize, usize),
    text: &str,
    skipped: usize,
) -> Option<Range<usize>> {
    let bytes = source.value(pointer)?;
    let start = bytes.start + 1 + skipped;
    let written = bytes.len() == text.len() + 2 + skipped;
    written.then(|| start + from..(start + to).max(start + from))
}

impl Derived {
    /// Number of derived numbers.
    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// The place of a parameter in the design and what follows from it, if it changes.
    pub fn place(&self, parameter: &str) -> Option<usize> {
        self.places.get(parameter).copied()
    }

    /// Pointers to the derived numbers of the document.
    pub fn pointers(&self) -> impl Iterator<Item = &String> {
        self.list.iter().map(|(pointer, _)| pointer)
    }

    /// The design `x` with what follows from it.
    pub fn extend<'x, S: Scalar>(&self, x: &'x [S]) -> Cow<'x, [S]> {
        if self.list.is_empty() || x.len() != self.variables {
            return Cow::Borrowed(x);
        }
        let mut all = x.to_vec();
        all.reserve(self.list.len());
        for (_, expression) in &self.list {
            let value = expression.value(&|source: &Operand| match source {
                Operand::Fixed(number) => S::from(*number),
                Operand::Place(place) => all[*place],
            });
            all.push(value);
        }
        Cow::Owned(all)
    }

    /// Bounds of variables, each with the others at their start, at which a number is beyond its limits.
    fn beyond_limits(&self, variables: &[Variable], structure: &Structure) -> Vec<Finding> {
        let start: Vec<f64> = variables.iter().map(|own| own.start).collect();
        let mut findings = Vec::new();
        for (i, variable) in variables.iter().enumerate() {
            for (key, bound) in [("lower", variable.lower), ("upper", variable.upper)] {
                if !bound.is_finite() || findings.len() >= MOST_BOUNDS {
                    continue;
                }
                let mut x = start.clone();
                x[i] = bound;
                let all = self.extend(&x);
                let values = self.list.iter().zip(all.iter().skip(self.variables));
                let wrong = values.filter_map(|((pointer, _), value)| {
                    let number = structure.numbers.get(pointer)?;
                    let (low, excluded) = number.least.unwrap_or((f64::NEG_INFINITY, false));
                    let below = *value < low || (excluded && *value <= low);
                    let above = number.most.is_some_and(|most| *value > most);
                    (below || above || !value.is_finite()).then_some((pointer, value))
                });
                findings.extend(wrong.take(1).map(|(pointer, value)| {
                    let found = format!("the bound {bound}, at which {pointer} is {value}");
                    let of_variable = join("/variables", &variable.name);
                    Finding::new(
                        join(&of_variable, key),
                        found,
                        "a bound that keeps it in its limits",
                    )
                }));
            }
        }
        findings
    }

    /// The first expression without a finite value at the design `x`, in words.
    pub fn undefined(&self, x: &[f64]) -> Option<String> {
        let all = self.extend(x);
        let values = self.list.iter().zip(all.iter().skip(self.variables));
        let mut wrong = values.filter(|(_, value)| !value.is_finite());
        let ((pointer, _), value) = wrong.next()?;
        Some(format!("the expression at {pointer} has the value {value}"))
    }

    /// Derivative of each derived number by variable i.
    pub fn by_variable(&self, x: &[f64], i: usize) -> Vec<f64> {
        let seeded = x.iter().enumerate();
        let seeded: Vec<Dual> = seeded
            .map(|(j, &x)| Dual::new(x, f64::from(u8::from(i == j))))
            .collect();
        let all = self.extend(&seeded);
        all.iter().skip(self.variables).map(|own| own.du).collect()
    }
}
