//! The extension of the Python package `flexbody`: problems, motions and optima on NumPy arrays.
//!
//! | File | Content |
//! |---|---|
//! | `problem` | a problem: values, gradients, motions, rest, modes, check |
//! | `motion` | a motion: histories, states, pull-back |
//! | `optimum` | an optimisation of a problem |
//! | `minimise` | the optimiser alone, on functions of Python |
//! | `run` | work on the threads of the package: interrupts, panics |
//! | `errors`, `arrays` | exceptions and arrays |
//!
//! Names, units and text for people are the business of the Python files beside it.

mod arrays;
mod errors;
mod minimise;
mod motion;
mod optimum;
mod problem;
mod run;

use pyo3::prelude::*;

#[pymodule]
mod _flexbody {
    #[pymodule_export]
    use crate::minimise::minimise;
    #[pymodule_export]
    use crate::motion::Motion;
    #[pymodule_export]
    use crate::optimum::Optimum;
    #[pymodule_export]
    use crate::problem::Problem;
    #[pymodule_export]
    use crate::run::{panic_on_purpose, set_threads, threads};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::run::silence_panics();
        module.add("version", env!("CARGO_PKG_VERSION"))
    }
}
