//! Tests of what the library keeps to itself. They live in `tests/`, beside those of the command and of
//! the library's front, and are compiled with the library.

#[path = "../tests/dynamics/mod.rs"]
mod dynamics;
#[path = "../tests/files/mod.rs"]
mod files;
#[path = "../tests/reference/numbers.rs"]
mod numbers;
#[path = "../tests/reference/mod.rs"]
mod reference;
#[path = "../tests/structures/mod.rs"]
mod structures;
