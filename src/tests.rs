//! Tests of internals. They live in `tests/` with the tests of the command and the public library,
//! and are compiled with the library.

#[macro_use]
#[path = "../tests/reference/json.rs"]
pub(crate) mod json;

#[path = "../tests/dynamics/mod.rs"]
mod dynamics;
#[path = "../tests/files/mod.rs"]
mod files;
#[path = "../tests/optimiser/filter.rs"]
mod filter;
#[path = "../tests/reference/numbers.rs"]
mod numbers;
#[path = "../tests/reference/mod.rs"]
pub(crate) mod reference;
#[path = "../tests/structures/mod.rs"]
mod structures;
