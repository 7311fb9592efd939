//! The run on the truss, printed.

use std::time::Instant;

use flexbody::optimiser::{Nlp, Observer, Options, Row, solve};

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
    let has = |name: &str| std::env::args().any(|a| a == name);
    if has("criteria") {
        criteria(&mut truss);
        return;
    }
    truss.with_curvature = has("curvature");
    let options = Options::default();
    let outcome = solve(&mut truss, &options, &mut Print(Instant::now()));
    println!(
        "{:?} {:?} {:?}",
        outcome.status, outcome.kkt, outcome.counts
    );
}

/// Steps of the optimality criteria: each minimises the model of terms a/x of the compliance, whose
/// areas are x √(−g/(λ v)) between their bounds, with λ by bisection.
fn criteria(truss: &mut Truss) {
    let (lower, upper) = truss.variable_bounds();
    let mut x = truss.start();
    for step in 0..=500 {
        let slopes = truss.gradients(&x).expect("the truss is stiff");
        let (g, row) = (&slopes.objective, &slopes.jacobian);
        let at = |lambda: f64| -> Vec<f64> {
            let area = |i: usize| x[i] * (-g[i] / (lambda * row[(0, i)])).sqrt();
            (0..x.len())
                .map(|i| area(i).clamp(lower[i], upper[i]))
                .collect()
        };
        let volume = |x: &[f64]| row.row(0).map(|(i, v)| v * x[i]).sum::<f64>();
        let (mut least, mut most) = (1e-10_f64, 1e10_f64);
        while most > least * (1.0 + 1e-14) {
            let middle = (least * most).sqrt();
            if volume(&at(middle)) > 1.0 {
                least = middle;
            } else {
                most = middle;
            }
        }
        if step % 50 == 0 {
            let size = g.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            let force = |i: usize| {
                let force = g[i] + most * row[(0, i)];
                let room = if force > 0.0 {
                    x[i] - lower[i]
                } else {
                    upper[i] - x[i]
                };
                (force.abs() / size).min(room)
            };
            let worst = (0..x.len()).map(force).fold(0.0, f64::max);
            let f = truss.evaluate(&x).expect("the truss is stiff").objective;
            println!("{step:4} compliance {f:.8e} residual relative to the gradient {worst:.1e}");
        }
        x = at(most);
    }
}
