//! What the optimiser reports while it runs.

use std::io::Write;
use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

/// Part of the algorithm that made an iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Interior-point iteration.
    #[default]
    Regular,
    /// Reduction of the constraint violation alone.
    Restoration,
    /// Trust-region iteration.
    Sqp,
}

/// One iteration.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Number of the iteration; 0 is the start.
    pub iteration: usize,
    /// Objective, in the units of the user.
    pub objective: f64,
    /// Largest violation of a constraint or bound, in the units of the user.
    pub infeasibility: f64,
    /// Largest scaled KKT residual.
    pub optimality: f64,
    /// Barrier parameter; 0 in trust-region iterations.
    pub barrier: f64,
    /// Largest component of the step in scaled variables.
    pub step: f64,
    /// Regularisation of the linear system; radius of the trust region in its iterations.
    pub regularisation: f64,
    /// Fraction of the primal step that was taken.
    pub primal_step: f64,
    /// Fraction of the dual step that was taken.
    pub dual_step: f64,
    /// Points tried by the line search.
    pub trials: usize,
    /// Evaluations of the functions so far.
    pub evaluations: usize,
    /// Part of the algorithm.
    pub phase: Phase,
    /// The point, in the units of the user.
    pub x: &'a [f64],
    /// Values of the constraints there, in the units of the user.
    pub constraints: &'a [f64],
}

/// Receives every iteration and may stop the run.
pub trait Observer {
    /// Called after each iteration and once at the start; `Break` ends the run as interrupted.
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()>;
}

/// An observer that ignores all rows.
///
/// ```
/// use flexbody_optimiser::{Observer, Phase, Row, Silent};
/// let x = [1.0];
/// let row = Row {
///     iteration: 0, objective: 2.0, infeasibility: 0.0, optimality: 1.0, barrier: 0.1,
///     step: 0.0, regularisation: 0.0, primal_step: 0.0, dual_step: 0.0, trials: 0,
///     evaluations: 1, phase: Phase::Regular, x: &x, constraints: &[],
/// };
/// assert!(Silent.iteration(&row).is_continue());
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn iteration(&mut self, _row: &Row<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// An observer that writes a line for each iteration: objective, largest violation, residual,
/// barrier parameter, length and part of the step, evaluations.
///
/// ```
/// use flexbody_optimiser::{Functions, Options, Printed, solve};
/// let mut parabola = Functions::new(&[3.0], |x| (x[0] * x[0], vec![2.0 * x[0]]));
/// let mut lines = Vec::new();
/// let outcome = solve(&mut parabola, &Options::default(), &mut Printed(&mut lines));
/// assert!(outcome.converged());
/// let text = String::from_utf8_lossy(&lines);
/// assert_eq!(text.lines().count(), outcome.counts.iterations + 2);
/// ```
#[derive(Debug)]
pub struct Printed<W>(pub W);

impl<W: Write> Observer for Printed<W> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        let head = match row.iteration {
            0 => {
                "iteration objective        violation residual  barrier     step     part evaluations\n"
            }
            _ => "",
        };
        let line = writeln!(
            self.0,
            "{head}{:9} {:<16.9e} {:9.1e} {:8.1e} {:8.1e} {:8.1e} {:8.1e} {:11}",
            row.iteration,
            row.objective,
            row.infeasibility,
            row.optimality,
            row.barrier,
            row.step,
            row.primal_step,
            row.evaluations
        );
        // Without a reader the run goes on.
        drop(line);
        ControlFlow::Continue(())
    }
}
