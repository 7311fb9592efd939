//! Aggregates whose parameter ρ a file leaves out.

use super::Problem;
use super::finding::Finding;
use super::overrides::Override;
use super::pointer::join;
use serde_json::Value;

/// Keys of aggregates.
const AGGREGATES: [&str; 6] = [
    "ks",
    "induced_exponential",
    "von_mises",
    "largest_section_force",
    "largest_fibre_stress",
    LOWEST,
];
const LOWEST: &str = "lowest_frequency";

/// The ρ of an aggregate in a document; NaN if it is to be chosen.
pub(super) fn rho_of(written: Option<f64>) -> f64 {
    written.unwrap_or(f64::NAN)
}

/// A function with aggregates whose ρ the file leaves out.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenAggregate {
    /// Index of the function, of the first of a family.
    pub function: usize,
    /// Its name.
    pub name: String,
    /// Where each ρ is missing.
    pub pointers: Vec<String>,
    /// Another ρ of the function, which is taken for all then: an aggregate over time and points is one function of both.
    pub given: Option<Value>,
}

impl OpenAggregate {
    /// The file with these ρ.
    pub fn overrides(&self, rho: &Value) -> Vec<Override> {
        let one = |pointer: &String| Override {
            path: join(pointer, "rho"),
            value: rho.clone(),
        };
        self.pointers.iter().map(one).collect()
    }

    /// The file with any ρ, with which true values can be computed. Lowest frequencies need few modes if they are sharp.
    pub fn provisional(&self) -> Vec<Override> {
        let lowest = self.pointers.iter().any(|own| own.ends_with(LOWEST));
        self.overrides(&Value::from(if lowest { 1e9 } else { 1.0 }))
    }

    fn collect(&mut self, pointer: &str, value: &Value) {
        let Value::Object(entries) = value else {
            if let Value::Array(list) = value {
                for (i, own) in list.iter().enumerate() {
                    self.collect(&join(pointer, i), own);
                }
            }
            return;
        };
        for (key, own) in entries {
            let below = join(pointer, key);
            match own {
                // Keys are names here.
                Value::Object(series) if key == "series" => {
                    for (name, own) in series {
                        self.collect(&join(&below, name), own);
                    }
                    continue;
                }
                Value::Object(aggregate) if AGGREGATES.contains(&key.as_str()) => {
                    match aggregate.get("rho") {
                        Some(rho) => self.given = Some(rho.clone()),
                        None => self.pointers.push(below.clone()),
                    }
                }
                _ => {}
            }
            self.collect(&below, own);
        }
    }

    fn of(name: &str, pointer: &str, value: &Value) -> Self {
        let mut all = Self {
            function: 0,
            name: name.to_owned(),
            pointers: Vec::new(),
            given: None,
        };
        all.collect(pointer, value);
        all
    }
}

impl Problem {
    /// The function of this name, or the first of a family or of those in cases.
    pub fn named_or_first(&self, name: &str) -> Option<usize> {
        let (family, in_case) = (format!("{name}["), format!("{name} in "));
        let is_one = |own: &String| {
            let other = own.starts_with(&family) || own.starts_with(&in_case);
            own == name || other
        };
        self.function_names.iter().position(is_one)
    }

    /// The functions with aggregates whose ρ the file leaves out. Their values are NaN: a problem is evaluated when each ρ is
    /// chosen.
    pub fn open_aggregates(&self) -> Vec<OpenAggregate> {
        let Some(functions) = self.document["functions"].as_object() else {
            return Vec::new();
        };
        let open = functions.iter().filter_map(|(name, value)| {
            let own = OpenAggregate::of(name, &join("/functions", name), value);
            let function = self.named_or_first(name)?;
            (!own.pointers.is_empty()).then_some(OpenAggregate { function, ..own })
        });
        open.collect()
    }
}

/// A ρ is missing where none can be chosen: in the quantity that ends a motion or a window.
pub(super) fn without_rho(document: &Value) -> Option<Finding> {
    let functions = document["functions"].as_object().into_iter().flatten();
    let windows = functions.flat_map(|(name, value)| {
        let own = OpenAggregate::of(name, &join("/functions", name), value);
        own.pointers
            .into_iter()
            .filter(|pointer| pointer.contains("/during/"))
    });
    let simulation = OpenAggregate::of("", "/simulation", &document["simulation"]);
    let pointer = { windows }.chain(simulation.pointers).next()?;
    let expected = "\"rho\": it is chosen in functions alone";
    Some(Finding::new(&pointer, "no \"rho\"", expected).of_key())
}
