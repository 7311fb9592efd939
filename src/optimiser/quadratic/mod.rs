//! Quadratic subproblems with elastic rows.

pub(crate) mod data;
pub(crate) mod elastic;
pub(crate) mod refined;
pub(crate) mod split;
