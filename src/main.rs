//! The command `optimize`.
fn main() {}
