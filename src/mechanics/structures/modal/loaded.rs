//! A body whose files are read.

use super::craig_bampton::Reduction;
use super::free_body::FreeBody;
use super::imported::ImportedBody;
use super::interfaces::{Holding, Interface};

/// A body whose files are read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Its numbers.
    pub body: ImportedBody,
    /// Where they come from; nothing if a file had them.
    pub reduced: Option<Reduced>,
}

/// The matrices of a body, and how they are reduced.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The full body.
    pub free: FreeBody,
    /// Its reduction.
    pub reduction: Reduction,
    /// Where it is held.
    pub interfaces: Vec<Interface>,
    /// What holds its frame.
    pub holding: Holding,
}
