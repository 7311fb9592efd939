//! Where the entries of a document come from whose parts and defaults are written out.

use super::expression::Expression;
use super::pointer::join;
use super::structure::Number;
use indexmap::IndexMap;
use serde_json::Value;

/// The entry of the file from which an entry of the document comes.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Pointer to the entry of the file.
    pub pointer: String,
    /// The use of a part to which it belongs.
    pub used: Option<String>,
    /// The use whose parameters its expressions name first.
    pub scope: Option<String>,
}

/// The origins of entries; those without one are where the file has them.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    /// By pointer to the entry of the document. What is below an entry comes from below its origin.
    list: IndexMap<String, Origin>,
    /// Expressions of numbers that parts do not have as they are written, by pointer.
    pub made: IndexMap<String, Expression<String>>,
    /// Parameters of uses and of moved numbers, with the unit of the latter.
    pub parameters: IndexMap<String, Option<String>>,
}

impl Origins {
    /// Whether every entry is where the file has it.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Says where an entry of the document comes from.
    pub fn add(&mut self, pointer: String, origin: Origin) {
        self.list.insert(pointer, origin);
    }

    /// The origin of the entry at a pointer or of one above it, and what is below.
    fn find<'a>(&self, pointer: &'a str) -> Option<(&Origin, &'a str)> {
        let mut above = pointer;
        while !self.list.is_empty() {
            if let Some(origin) = self.list.get(above) {
                return Some((origin, &pointer[above.len()..]));
            }
            above = above.rsplit_once('/')?.0;
        }
        None
    }

    /// The pointer in the file of an entry of the document.
    pub fn resolve(&self, pointer: &str) -> String {
        let mut found = pointer.to_owned();
        // An entry of a part comes from a default at most.
        while let Some((origin, below)) = self.find(&found) {
            found = format!("{}{below}", origin.pointer);
        }
        found
    }

    /// The use to which an entry belongs.
    pub fn used(&self, pointer: &str) -> Option<&str> {
        self.find(pointer)?.0.used.as_deref()
    }

    /// The use whose parameters the expression at a pointer names first.
    pub fn scope(&self, pointer: &str) -> Option<&str> {
        self.find(pointer)?.0.scope.as_deref()
    }

    /// Gives the parameters of moved numbers the units of these.
    pub fn name_units(&self, numbers: &mut IndexMap<String, Number>) {
        for (pointer, unit) in &self.parameters {
            if let (Some(unit), Some(number)) = (unit, numbers.get_mut(pointer)) {
                number.unit.clone_from(unit);
            }
        }
    }

    /// The entries of a written-out document that come from an entry of the file.
    pub fn images(&self, pointer: &str, document: &Value) -> Vec<String> {
        let mut images = Vec::new();
        let parameter = join("/parameters", pointer);
        if self.parameters.contains_key(&parameter) {
            images.push(parameter);
        }
        if document.pointer(pointer).is_some() {
            images.push(pointer.to_owned());
        }
        for (own, origin) in &self.list {
            let below = pointer.strip_prefix(&origin.pointer);
            let below = below.filter(|below| below.is_empty() || below.starts_with('/'));
            let Some(below) = below else { continue };
            let entry = format!("{own}{below}");
            if self.resolve(&entry) == self.resolve(pointer) {
                images.extend(self.images(&entry, document));
            }
        }
        images.retain(|entry| !self.made.contains_key(entry) || entry.starts_with("/parameters/"));
        images.sort();
        images.dedup();
        images
    }
}
