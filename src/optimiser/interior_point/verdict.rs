//! The tests of the whole problem at a point of the interior point.

use crate::constants::{HALF_OF_DIGITS, SUCCESSIVE};
use crate::convergence::{dominant_row, is_solved};
use crate::interior_point::iteration::InteriorPoint;
use crate::multipliers::ScaledMultipliers;
use crate::program::Program;
use crate::status::Status;

/// After so many evaluations within this distance, relative to the size of the point, a run ends. Without
/// this, x² ≤ 0 takes 2813 evaluations (608), and far starts end at a limit.
const MOST_TRIALS: usize = 120;

impl InteriorPoint {
    /// How the run ends at this point, if it does.
    pub(crate) fn ending(&mut self, program: &Program<'_>) -> Option<Status> {
        if self.is_solved(program) {
            return Some(Status::Converged);
        }
        if let Some(j) = self.degenerate(program) {
            let constraint = program.constraint_name(j);
            return Some(Status::Degenerate { constraint });
        }
        if self.stays(program) {
            return Some(Status::Stalled);
        }
        let unbounded = program.is_unbounded(&self.at.point);
        unbounded.then_some(Status::Unbounded)
    }

    /// Multipliers of the program at the present point.
    pub(crate) fn multipliers(&self, program: &Program<'_>) -> ScaledMultipliers {
        let n = self.layout.n;
        let mut z = ScaledMultipliers {
            y: self.at.y.clone(),
            zl: self.at.zl.rows(0, n).into_owned(),
            zu: self.at.zu.rows(0, n).into_owned(),
        };
        z.clip(program);
        if self.is_gap_least() && self.gap() > self.allowed_gap(program) {
            z.release(program, &self.at.point);
        }
        z
    }

    /// Sum of the products of multipliers and distances.
    fn gap(&self) -> f64 {
        self.at.products(&self.layout).iter().sum()
    }

    /// The gap that a solution may have.
    fn allowed_gap(&self, program: &Program<'_>) -> f64 {
        let least = program.unit_of_objective() * program.scaling.objective;
        0.1 * program.options.tolerance * self.at.point.f.abs().max(least)
    }

    /// Whether the barrier cannot make the gap much smaller: it leaves about μ_min in each product
    /// of a multiplier and its distance. Where the objective and its unit vanish, as after a start
    /// that is stationary, no iteration reaches the allowed gap.
    fn is_gap_least(&self) -> bool {
        let pairs = self.at.products(&self.layout).len() as f64;
        self.barrier.is_least() || self.gap() <= 4.0 * self.barrier.least() * pairs
    }

    /// Scaled residual of the optimality conditions.
    pub(crate) fn optimality(&self) -> f64 {
        self.at.residual(&self.layout, 0.0)
    }

    /// The row without which no multipliers exist: it dominates at `SUCCESSIVE` successive
    /// points that solve the program beside the size of their multipliers, but not otherwise.
    fn degenerate(&mut self, program: &Program<'_>) -> Option<usize> {
        let solves =
            self.optimality() <= program.options.tolerance && program.is_feasible(&self.at.point.c);
        let z = self.multipliers(program);
        let dominant = dominant_row(program, &self.at.slopes, &z).filter(|_| solves);
        self.dominated = dominant.map_or(0, |_| self.dominated + 1);
        dominant.filter(|_| self.dominated > SUCCESSIVE)
    }

    /// Whether the point has stayed in one place for many evaluations.
    fn stays(&mut self, program: &Program<'_>) -> bool {
        let (anchor, before) = &self.anchor;
        let now = program.counts.evaluations;
        let x = &self.at.point.x;
        if (x - anchor).amax() > HALF_OF_DIGITS * x.amax().max(1.0) {
            self.anchor = (x.clone(), now);
            return false;
        }
        now - before > MOST_TRIALS
    }

    fn is_solved(&self, program: &Program<'_>) -> bool {
        let scaled = self.optimality();
        let is_wide = !self.is_gap_least() && self.gap() > self.allowed_gap(program);
        if scaled > program.options.tolerance || is_wide {
            return false;
        }
        let z = self.multipliers(program);
        let (point, slopes) = (&self.at.point, &self.at.slopes);
        is_solved(program, point, slopes, &z, scaled)
    }
}
