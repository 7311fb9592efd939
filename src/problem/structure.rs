//! Checks a document by the JSON Schema: finds all structural faults, and all numbers with units.
//!
//! It supports only the part of JSON Schema that the schema of problem files uses.

use super::expression::MARK;
use super::finding::Finding;
use super::pointer::{advice, join, nearest};
use indexmap::IndexMap;
use serde_json::{Map, Value};

/// Largest physical number: inertias, its fifth power, stay finite.
const LARGEST: f64 = 1e50;

/// What the schema states about a number.
#[derive(Clone, Debug, Default)]
pub struct Number {
    /// Unit, if it has one.
    pub unit: String,
    /// The reason why no design variable may point at it; `None` if one may.
    pub barred: Option<String>,
    /// Smallest value, and whether that value itself is excluded.
    pub least: Option<(f64, bool)>,
    /// Largest value.
    pub most: Option<f64>,
}

/// Result of checking a document.
#[derive(Default)]
pub struct Structure {
    /// Structural faults.
    pub findings: Vec<Finding>,
    /// Numbers by pointer.
    pub numbers: IndexMap<String, Number>,
    /// Pointers to expressions in the place of a number.
    pub expressions: Vec<String>,
}

/// Checks a document.
pub fn walk(document: &Value, schema: &Value) -> Structure {
    let mut walker = Walker {
        root: schema,
        structure: Structure::default(),
    };
    walker.value(document, schema, "");
    walker.structure
}

/// A JSON value in a few words.
pub(super) fn describe(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".into(),
        Value::String(text) if text.chars().count() > 40 => {
            format!("\"{}…\"", text.chars().take(40).collect::<String>())
        }
        other => other.to_string(),
    }
}

/// The alternatives of an enum: words, and keys with a value.
struct Alternatives<'a> {
    words: Vec<&'a str>,
    keys: Vec<(&'a str, &'a Value)>,
}

impl<'a> Alternatives<'a> {
    fn names(&self) -> impl Iterator<Item = &'a str> + Clone {
        let keys: Vec<&'a str> = self.keys.iter().map(|(key, _)| *key).collect();
        self.words.clone().into_iter().chain(keys)
    }
}

struct Walker<'a> {
    root: &'a Value,
    structure: Structure,
}

impl<'a> Walker<'a> {
    /// Resolves a reference.
    fn follow(&self, schema: &'a Value) -> &'a Value {
        match schema["$ref"]
            .as_str()
            .and_then(|text| text.strip_prefix('#'))
        {
            Some(pointer) => self.root.pointer(pointer).unwrap_or(&Value::Null),
            None => schema,
        }
    }

    fn fault(&mut self, finding: Finding) {
        self.structure.findings.push(finding);
    }

    fn wrong(&mut self, value: &Value, schema: &'a Value, pointer: &str) {
        let expected = self.wanted(schema);
        let hint = match value {
            Value::Null => Some("leave the key out if it is not wanted".to_owned()),
            Value::Array(items) if expected.starts_with("a text") => match &items[..] {
                [Value::String(only)] => Some(format!("write \"{only}\" without brackets")),
                _ => Some("give each its own entry".to_owned()),
            },
            _ => None,
        };
        self.fault(Finding::new(pointer, describe(value), expected).hint(hint));
    }

    fn value(&mut self, value: &Value, schema: &'a Value, pointer: &str) {
        let schema = self.follow(schema);
        if let Some(alternatives) = alternatives(schema) {
            return self.alternative(value, schema, &alternatives, pointer);
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            let choices = choices.iter().map(|choice| self.follow(choice));
            let fits = |choice: &&Value| kind_fits(value, choice) && keys_fit(value, choice);
            let found = choices.clone().find(fits);
            let found = found.or_else(|| choices.clone().find(|choice| kind_fits(value, choice)));
            return match found {
                Some(choice) => self.value(value, choice, pointer),
                None if is_expression(value) && choices.clone().any(is_of_number) => {
                    self.structure.expressions.push(pointer.to_owned());
                }
                None => self.wrong(value, schema, pointer),
            };
        }
        if is_expression(value) && is_of_number(schema) {
            self.structure.expressions.push(pointer.to_owned());
            return;
        }
        if !kind_fits(value, schema) {
            return self.wrong(value, schema, pointer);
        }
        match value {
            Value::Object(object) => self.object(object, schema, pointer),
            Value::Array(items) => self.list(value, items, schema, pointer),
            Value::Number(_) => self.number(value, schema, pointer),
            _ => {}
        }
    }

    fn object(&mut self, object: &Map<String, Value>, schema: &'a Value, pointer: &str) {
        let properties = schema["properties"].as_object();
        let mut misspelt = Vec::new();
        for (key, value) in object {
            let inner = join(pointer, key);
            match properties.and_then(|properties| properties.get(key)) {
                Some(schema) => self.value(value, schema, &inner),
                None if schema["additionalProperties"].is_object() => {
                    self.value(value, &schema["additionalProperties"], &inner);
                }
                // Values of a case, which are checked where they replace those of the file.
                None if schema["additionalProperties"] == Value::Bool(true) => {}
                None => {
                    let known = properties.into_iter().flat_map(|map| map.keys());
                    let known = known.map(String::as_str);
                    misspelt.extend(nearest(key, known.clone()));
                    let hint = advice(key, "keys", known);
                    let found = format!("the key \"{key}\"");
                    let finding = Finding::new(inner, found, "a key of the format");
                    self.fault(finding.of_key().hint(hint));
                }
            }
        }
        for key in required(schema, object) {
            // A misspelt key is not missing.
            if !object.contains_key(key) && !misspelt.contains(&key) {
                let wanted = self.wanted(&schema["properties"][key]);
                let finding = Finding::new(
                    pointer,
                    format!("no \"{key}\""),
                    format!("\"{key}\": {wanted}"),
                );
                self.fault(finding.of_key());
            }
        }
    }

    fn list(&mut self, value: &Value, items: &[Value], schema: &'a Value, pointer: &str) {
        let size = |key: &str| schema[key].as_u64().map(|size| size as usize);
        if size("minItems").is_some_and(|least| items.len() < least)
            || size("maxItems").is_some_and(|most| items.len() > most)
        {
            self.wrong(value, schema, pointer);
        }
        for (k, item) in items.iter().enumerate() {
            self.value(item, &schema["items"], &join(pointer, k));
        }
    }

    fn number(&mut self, value: &Value, schema: &'a Value, pointer: &str) {
        let x = value.as_f64().unwrap_or(f64::NAN);
        let limit = |key: &str| schema[key].as_f64();
        let least = match (limit("exclusiveMinimum"), limit("minimum")) {
            (Some(above), _) => Some((above, true)),
            (None, least) => least.map(|least| (least, false)),
        };
        let low = least.is_some_and(|(least, excluded)| x < least || (excluded && x <= least));
        let high = limit("maximum").is_some_and(|most| x > most);
        let other = schema.get("const").is_some_and(|only| only != value);
        if low || high || other {
            self.wrong(value, schema, pointer);
        } else if x.abs() > LARGEST {
            let expected = format!("a number of size up to {LARGEST:e}");
            self.fault(Finding::new(pointer, describe(value), expected));
        }
        // A mass may be 0, but not shrink to it.
        let designed =
            least.map(|(least, excluded)| (least, excluded || schema["designed"] == "positive"));
        let unit = schema["unit"].as_str().unwrap_or_default().to_owned();
        let barred = match &schema["design_variable"] {
            Value::Bool(true) => None,
            Value::String(why) => Some(why.clone()),
            _ => Some("it is not a physical number of the scene".to_owned()),
        };
        let number = Number {
            unit,
            barred,
            least: designed,
            most: limit("maximum"),
        };
        self.structure.numbers.insert(pointer.to_owned(), number);
    }

    fn alternative(
        &mut self,
        value: &Value,
        schema: &'a Value,
        alternatives: &Alternatives<'a>,
        pointer: &str,
    ) {
        let names = alternatives.names();
        let unknown = |name: &str| advice(name, "choices", names.clone());
        let expected = self.wanted(schema);
        match value {
            Value::String(word) if alternatives.words.contains(&word.as_str()) => {}
            Value::String(word) => {
                let hint = match alternatives.keys.iter().any(|(key, _)| key == word) {
                    true => Some(format!("\"{word}\" needs a value: {{\"{word}\": …}}")),
                    false => unknown(word),
                };
                self.fault(Finding::new(pointer, describe(value), expected).hint(hint));
            }
            Value::Object(object) if object.len() == 1 => {
                for (key, inner) in object {
                    let below = join(pointer, key);
                    match alternatives.keys.iter().find(|(name, _)| name == key) {
                        Some((_, schema)) => self.value(inner, schema, &below),
                        None => {
                            let found = format!("the key \"{key}\"");
                            let finding = Finding::new(below, found, &expected);
                            self.fault(finding.of_key().hint(unknown(key)));
                        }
                    }
                }
            }
            Value::Object(object) => {
                let found = match object.len() {
                    0 => "an empty object".to_owned(),
                    count => format!("an object of {count} keys"),
                };
                self.fault(Finding::new(pointer, found, expected));
            }
            _ => self.wrong(value, schema, pointer),
        }
    }

    /// Describes what a schema requires.
    fn wanted(&self, schema: &'a Value) -> String {
        let schema = self.follow(schema);
        if let Some(alternatives) = alternatives(schema) {
            let words = alternatives.words.iter().map(|word| format!("\"{word}\""));
            let keys = alternatives
                .keys
                .iter()
                .map(|(key, _)| format!("{{\"{key}\": …}}"));
            return match words.chain(keys).collect::<Vec<_>>() {
                all if all.len() == 1 => all.concat(),
                all => format!("one of {}", all.join(", ")),
            };
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            let words: Vec<String> = choices.iter().map(|choice| self.wanted(choice)).collect();
            return words.join(" or ");
        }
        if let Some(only) = schema.get("const") {
            return only.to_string();
        }
        match schema["type"].as_str().unwrap_or_default() {
            "number" => format!("a number{}", limits(schema)),
            "integer" => format!("a whole number{}", limits(schema)),
            "string" => "a text".into(),
            "boolean" => "true or false".into(),
            "array" => {
                let items = self.follow(&schema["items"]);
                let count = schema["minItems"].as_u64().map(|n| format!(" of {n}"));
                let what = match items["type"].as_str() {
                    Some("number") => format!("numbers{}", limits(items)),
                    Some("integer") => format!("whole numbers{}", limits(items)),
                    Some("string") => "texts".into(),
                    _ => "objects".into(),
                };
                format!("a list{} {what}", count.unwrap_or_else(|| " of".into()))
            }
            _ => {
                let keys = required(schema, &Map::new());
                match keys.is_empty() {
                    true => "an object".into(),
                    false => format!("an object with {}", keys.join(", ")),
                }
            }
        }
    }
}

/// The keys that an object needs: `required`, and what its conditions add.
fn required<'s>(schema: &'s Value, object: &Map<String, Value>) -> Vec<&'s str> {
    let own = schema["required"].as_array().into_iter().flatten();
    let mut keys: Vec<&str> = own.filter_map(Value::as_str).collect();
    let condition = &schema["if"];
    if condition.is_object() {
        let has = |key: &str| object.contains_key(key);
        let equal = |(key, property): (&String, &Value)| object.get(key) == property.get("const");
        let mut values = condition["properties"].as_object().into_iter().flatten();
        let holds = required(condition, object).into_iter().all(has) && values.all(equal);
        let branch = if holds { "then" } else { "else" };
        keys.extend(required(&schema[branch], object));
    }
    keys
}

/// Describes limits and unit of a number.
fn limits(schema: &Value) -> String {
    let mut words = String::new();
    if let Some(above) = schema.get("exclusiveMinimum") {
        words += &format!(" above {above}");
    } else if let Some(least) = schema.get("minimum") {
        words += &format!(" of at least {least}");
    }
    if let Some(most) = schema.get("maximum") {
        words += &format!(" and at most {most}");
    }
    match schema["unit"].as_str() {
        Some("1") | None => words,
        Some(unit) => format!("{words} [{unit}]"),
    }
}

/// The alternatives of an enum; `None` if the schema is no enum.
fn alternatives(schema: &Value) -> Option<Alternatives<'_>> {
    let mut found = Alternatives {
        words: Vec::new(),
        keys: Vec::new(),
    };
    if schema["type"] == "string" && schema["enum"].is_array() {
        let listed = schema["enum"].as_array().into_iter().flatten();
        found.words = listed.filter_map(Value::as_str).collect();
        return Some(found);
    }
    for choice in schema["oneOf"].as_array()? {
        if let Some(properties) = choice["properties"].as_object() {
            found
                .keys
                .extend(properties.iter().map(|(key, inner)| (key.as_str(), inner)));
        } else {
            let listed = choice["enum"].as_array().into_iter().flatten();
            found
                .words
                .extend(listed.chain(choice.get("const")).filter_map(Value::as_str));
        }
    }
    Some(found)
}

/// Whether a value is an expression.
fn is_expression(value: &Value) -> bool {
    value.as_str().is_some_and(|text| text.starts_with(MARK))
}

/// Whether a schema is that of a number.
fn is_of_number(schema: &Value) -> bool {
    matches!(schema["type"].as_str(), Some("number" | "integer"))
}

/// Whether an object has a key of the schema; true for other values.
fn keys_fit(value: &Value, schema: &Value) -> bool {
    let Some(object) = value.as_object() else {
        return true;
    };
    match alternatives(schema) {
        Some(choices) => (choices.keys.iter()).any(|(key, _)| object.contains_key(*key)),
        None => match schema["properties"].as_object() {
            Some(known) => object.is_empty() || object.keys().any(|key| known.contains_key(key)),
            None => true,
        },
    }
}

/// Whether a value has the type of the schema.
fn kind_fits(value: &Value, schema: &Value) -> bool {
    match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("boolean") => value.is_boolean(),
        _ => alternatives(schema).is_none_or(|choices| {
            value.is_object() || (value.is_string() && !choices.words.is_empty())
        }),
    }
}
