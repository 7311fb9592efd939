//! Structures at rest: figures, stages of a page, fields.

pub mod fields;
pub mod figures;
pub mod stages;
