//! The run on the truss, printed.

use std::time::Instant;

use flexbody::optimiser::{Observer, Options, Row, solve};

use crate::truss::Truss;

struct Print(Instant);

impl Observer for Print {
    fn iteration(&mut self, row: &Row<'_>) -> std::ops::ControlFlow<()> {
        println!(
            "{:4} compliance {:.8e} residual {:.1e} mu {:.1e} step {:.1e} evaluations {} at {:.1} s",
            row.iteration,
            row.objective,
            row.optimality,
            row.barrier,
            row.primal_step,
            row.evaluations,
            self.0.elapsed().as_secs_f64()
        );
        std::ops::ControlFlow::Continue(())
    }
}

pub fn report() {
    let arguments: Vec<usize> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let (columns, rows) = match arguments[..] {
        [columns, rows, ..] => (columns, rows),
        _ => (60, 22),
    };
    let mut truss = Truss::new(columns, rows);
    println!(
        "{} bars, {} degrees of freedom",
        truss.bars.len(),
        truss.freedoms
    );
    let options = Options::default();
    let outcome = solve(&mut truss, &options, &mut Print(Instant::now()));
    println!(
        "{:?} {:?} {:?}",
        outcome.status, outcome.kkt, outcome.counts
    );
}
