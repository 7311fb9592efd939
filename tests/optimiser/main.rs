//! The optimiser on programs with known optima.

mod curvature;
mod curved;
mod derivatives;
mod disagree;
mod endings;
mod far_starts;
mod faults;
mod feasibility;
mod filter;
mod fixed_by_rows;
mod gives_up;
mod hard_cases;
mod hock_schittkowski;
mod large;
mod least_squares;
mod problems;
mod restart;
mod scales;
mod sized_trusses;
mod verdicts;
mod wide_bounds;
