//! Whole simulations and gradients; the name of each case says how far its motion is from the
//! reference.
//!
//! `cargo bench --bench run`; read the column "fastest" on a shared machine.

mod scenes;

use divan::Bencher;
use flexbody::driver::Evaluated;
use flexbody::problem::Problem;
use scenes::{Case, NAMES, trebuchet_problem};
use std::fmt;

fn main() {
    divan::main();
}

fn simulations() -> Vec<Case> {
    let implicit = NAMES.map(|name| Case::new(name, 1e-3));
    let explicit = NAMES.map(|name| Case::explicit(name, 1e-8));
    implicit.into_iter().chain(explicit).collect()
}

#[divan::bench(args = simulations(), sample_count = 20, sample_size = 1)]
fn forward(bencher: Bencher, case: &Case) {
    bencher.bench(|| case.simulate());
}

/// The six design variables of the trebuchet and the first `functions` of its functions.
struct Design {
    problem: Problem,
    error: f64,
    functions: usize,
}

impl fmt::Display for Design {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "trebuchet, {} variables, functions: {}; {:.1e} m",
            self.problem.variables.len(),
            self.functions,
            self.error
        )
    }
}

fn designs() -> Vec<Design> {
    let (problem, error) = trebuchet_problem();
    let of = |functions| Design {
        problem: problem.clone(),
        error,
        functions,
    };
    vec![of(0), of(1), of(3)]
}

/// With no function: the forward run alone.
#[divan::bench(args = designs(), sample_count = 20, sample_size = 1)]
fn forward_and_gradients(bencher: Bencher, design: &Design) {
    let which: Vec<usize> = (0..design.functions).collect();
    let x = design.problem.start();
    bencher.bench(|| {
        let at = Evaluated::new(&design.problem, &x).expect("the scene runs");
        if which.is_empty() {
            return Vec::new();
        }
        let (gradients, _) = at.gradients(&design.problem, &which).expect("regular");
        gradients
    });
}
