//! Writes out the parts of a document, their uses and defaults, so that what reads it meets bodies, joints,
//! loads, drives and couplings alone. [`crate::origins`] keeps where each comes from.

mod algebra;
mod defaults;
mod designs;
mod entries;
mod files;
mod frame;
mod used;
mod uses;
mod writer;

pub(super) use files::{read, twice};

use super::finding::Finding;
use super::source::Source;
use super::structure::walk;
use crate::schema;
use serde_json::{Map, Value};

/// Whether a document has something to write out.
pub(super) fn is_needed(document: &Value) -> bool {
    ["parts", "use", "defaults"]
        .iter()
        .any(|section| document.get(section).is_some())
}

/// Writes a document out.
///
/// # Errors
/// Its structural faults, and those of its uses.
pub(super) fn expand(document: &mut Value, source: &mut Source) -> Result<(), Vec<Finding>> {
    defaults::apply(document, schema::schema(), &mut source.origins);
    if let Value::Object(entries) = &mut *document
        && entries.contains_key("use")
    {
        entries
            .entry("bodies")
            .or_insert_with(|| Value::Object(Map::new()));
    }
    let structure = walk(document, schema::schema());
    if !structure.findings.is_empty() {
        return Err(structure.findings);
    }
    uses::write_out(document, &structure, source)
}
