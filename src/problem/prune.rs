//! Removes structural faults from a document, so that the rest can be checked.

use super::finding::Finding;
use super::pointer::{keys, nearest};
use crate::schema::VERSION;
use serde_json::{Map, Value, json};
use std::collections::HashSet;

/// Sections with named entries that are independent of each other.
const NAMED: [&str; 12] = [
    "bodies",
    "joints",
    "loads",
    "drives",
    "couplings",
    "structures",
    "materials",
    "load_cases",
    "functions",
    "variables",
    "constraints",
    "cases",
];

/// The parts that were removed from a document.
#[derive(Default)]
pub(super) struct Damage {
    sections: HashSet<String>,
    entries: HashSet<(String, String)>,
}

impl Damage {
    /// Whether nothing was removed.
    pub fn is_empty(&self) -> bool {
        self.sections.is_empty() && self.entries.is_empty()
    }

    /// Whether a part of a section was removed.
    pub fn touches(&self, section: &str) -> bool {
        self.sections.contains(section) || self.entries.iter().any(|(own, _)| own == section)
    }

    /// Whether the entry of this name was removed.
    pub fn holds(&self, section: &str, name: &str) -> bool {
        let entry = (section.to_owned(), name.to_owned());
        self.sections.contains(section) || self.entries.contains(&entry)
    }
}

/// Removes the faulty parts of `findings` from `document` and adds missing required parts.
pub(super) fn prune(document: &mut Map<String, Value>, findings: &[Finding]) -> Damage {
    let mut damage = Damage::default();
    for finding in findings {
        let keys = keys(&finding.pointer);
        match &keys[..] {
            [section, name, ..] if NAMED.contains(&section.as_str()) => {
                if let Some(Value::Object(entries)) = document.get_mut(section) {
                    entries.shift_remove(name);
                }
                damage.entries.insert((section.clone(), name.clone()));
            }
            [section, ..] => {
                document.shift_remove(section);
                damage.sections.insert(section.clone());
                let meant = nearest(section, NAMED);
                damage.sections.extend(meant.map(str::to_owned));
            }
            [] => {}
        }
    }
    let required = [
        ("version", json!(VERSION)),
        ("name", json!("problem")),
        ("bodies", json!({})),
        ("simulation", json!({"duration": 1, "steps": 1})),
    ];
    // Structures without a motion need neither bodies nor a simulation.
    let fixed = document.contains_key("structures") || damage.touches("structures");
    let rests = ["rest", "modes"]
        .map(|own| Some(json!(own)))
        .contains(&document.get("analysis").cloned());
    let count = match (fixed, rests) {
        (true, _) => 2,
        (false, true) => 3,
        (false, false) => required.len(),
    };
    for (key, value) in required.into_iter().take(count) {
        if !document.contains_key(key) {
            document.insert(key.to_owned(), value);
            damage.sections.insert(key.to_owned());
        }
    }
    damage
}
