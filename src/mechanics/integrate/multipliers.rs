//! The multipliers of a run at any of its instants.

use super::trajectory::Trajectory;
use crate::model::Model;
use crate::system::Numbering;
use crate::system::accelerations::Accelerations;
use crate::system::redundant_rows::EXCHANGE_WEIGHT;

/// Multipliers λ of a model along a run: those of the method. If the method has none, or if rows of
/// the model were left out of the run, the index-1 equations of the states give them.
pub struct Multipliers<'a> {
    run: &'a Trajectory<f64>,
    numbering: &'a Numbering,
    /// Solver of the index-1 equations, planned once for all instants.
    field: Option<Accelerations<'a, f64>>,
}

impl<'a> Multipliers<'a> {
    /// The multipliers of `model`, with its numbering. It has as many bodies as the model of `run`.
    pub fn new(model: &'a Model<f64>, numbering: &'a Numbering, run: &'a Trajectory<f64>) -> Self {
        let marched = !run.lambda.is_empty() && run.numbering == *numbering;
        Self {
            run,
            numbering,
            field: (!marched).then(|| Accelerations::new(model, numbering)),
        }
    }

    /// λ at instant k; NaN if the equations are singular.
    pub fn at(&mut self, k: usize) -> Vec<f64> {
        let (run, nc) = (self.run, self.numbering.constraints());
        let Some(field) = &mut self.field else {
            return run.lambda[k * nc..(k + 1) * nc].to_vec();
        };
        let (mut a, mut lambda) = (run.a(k).to_vec(), vec![0.0; nc]);
        field.set_state(run.q(k), run.v(k), run.time(k));
        // The weights of the rows choose the redundant ones. Each is exchanged at most once.
        for _ in 0..=nc {
            if field.factorise().is_err() {
                lambda.fill(f64::NAN);
                return lambda;
            }
            let Some(rows) = field.exchanged(EXCHANGE_WEIGHT) else {
                break;
            };
            field.leave_out(&rows);
            field.set_state(run.q(k), run.v(k), run.time(k));
        }
        field.accelerations(&mut a, &mut lambda);
        lambda
    }
}
