//! The optimiser on programs with known optima.

mod endings;
mod far_starts;
mod feasibility;
mod hard_cases;
mod hock_schittkowski;
mod large;
mod problems;
mod restart;
mod scales;
mod verdicts;
mod wide_bounds;
