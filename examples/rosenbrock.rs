//! Minimises Rosenbrock's function: `cargo run --release --example rosenbrock`.

use flexbody::optimiser::{Functions, Options, Printed, solve};

/// Runs the example.
pub fn main() {
    let mut valley = Functions::new(&[-1.2, 1.0], |x| {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        let gradient = vec![-2.0 * a - 400.0 * x[0] * b, 200.0 * b];
        (a * a + 100.0 * b * b, gradient)
    });
    let found = solve(
        &mut valley,
        &Options::default(),
        &mut Printed(std::io::stdout()),
    );
    println!("{:?} at {:?}", found.status, found.x);
    assert!(found.converged() && found.objective < 1e-12);
}
