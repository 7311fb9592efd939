//! The final iterate of a method, and the best point of a run. How a run ended is in `status`;
//! whether the conditions hold is tested in `convergence`.

use nalgebra::DVector;

use crate::convergence::{
    dominant_row, is_at_precision, is_solved, is_solved_in_user_units, kkt, scaled_residual,
};
use crate::linear::quasi_newton::QuasiNewton;
use crate::multipliers::ScaledMultipliers;
use crate::options::Method;
use crate::outcome::Kkt;
use crate::program::{Derivatives, EarlyExit, Point, Program};
use crate::scaling::Units;
use crate::status::Status;

/// The final iterate of a method.
pub(crate) struct FinalIterate {
    pub status: Status,
    pub method: Method,
    pub point: Point,
    pub slopes: Derivatives,
    pub multipliers: ScaledMultipliers,
    pub scaled: f64,
    /// The units of these numbers.
    pub units: Units,
    pub b: QuasiNewton,
    pub barrier: f64,
    pub radius: f64,
}

impl FinalIterate {
    /// The same with the status that its residuals justify: a method that can make no progress has
    /// converged if the conditions hold.
    pub(crate) fn judged(mut self, program: &Program<'_>) -> FinalIterate {
        let (point, slopes, z) = (&self.point, &self.slopes, &self.multipliers);
        let solved = is_solved(program, point, slopes, z, self.scaled);
        match self.status {
            Status::Stalled
            | Status::Degenerate { .. }
            | Status::IterationLimit
            | Status::EvaluationLimit
                if solved =>
            {
                self.status = Status::Converged;
            }
            Status::Converged if !solved => self.status = Status::Stalled,
            _ => {}
        }
        self
    }

    /// The same with another status.
    pub(crate) fn with_status(self, status: Status) -> FinalIterate {
        FinalIterate { status, ..self }
    }

    /// Sets the program to the units of this iterate.
    pub(crate) fn restore_units(&self, program: &mut Program<'_>) {
        program.set_units(&self.units);
    }

    /// Whether `other` is feasible and its objective is lower by more than the tolerance.
    pub(crate) fn is_worse_than(&self, other: &FinalIterate, program: &Program<'_>) -> bool {
        let (mine, theirs) = (self.objective(), other.objective());
        mine - theirs > program.options.tolerance * theirs.abs().max(program.unit_of_objective())
    }

    /// The objective in the unit of the user.
    fn objective(&self) -> f64 {
        self.point.f / self.units.objective
    }

    /// An infeasible final iterate: the largest violation is least here.
    pub(crate) fn infeasible_at(
        self,
        program: &Program<'_>,
        point: Point,
        slopes: Derivatives,
    ) -> FinalIterate {
        let y = DVector::zeros(point.c.len());
        let multipliers = ScaledMultipliers::polished(program, &point, &slopes, &y);
        FinalIterate {
            status: infeasible(program, &point),
            scaled: scaled_residual(program, &point, &slopes, &multipliers),
            multipliers,
            point,
            slopes,
            ..self
        }
    }

    pub(crate) fn kkt(&self, program: &Program<'_>) -> Kkt {
        kkt(
            program,
            &self.point,
            &self.slopes,
            &self.multipliers,
            self.scaled,
        )
    }

    /// The same, with a new status if a method stalled: [`Status::Converged`] if the conditions
    /// hold in the units of the user, [`Status::AtPrecision`] if rounding caused the stall,
    /// [`Status::Degenerate`] if a row dominates.
    pub(crate) fn with_stall_named(mut self, program: &Program<'_>) -> FinalIterate {
        if self.status != Status::Stalled {
            return self;
        }
        let (point, slopes, z) = (&self.point, &self.slopes, &self.multipliers);
        let kkt = self.kkt(program);
        let dominant = dominant_row(program, slopes, z);
        let absolute = is_solved_in_user_units(program, point, slopes, &kkt) && dominant.is_none();
        // Unbounded multipliers show in the complementarity products even if forces vanish. Where
        // all multipliers vanish, these products say nothing.
        let tolerance = program.options.tolerance;
        let vanish = [&z.y, &z.zl, &z.zu].iter().all(|z| z.amax() <= tolerance);
        let precise = is_at_precision(program, point, slopes, z, &mut self.b);
        let holds = absolute && (kkt.relative_complementarity <= tolerance || precise && vanish);
        if holds || precise {
            self.status = if holds {
                Status::Converged
            } else {
                Status::AtPrecision
            };
        } else if let Some(j) = dominant {
            self.status = Status::Degenerate {
                constraint: program.constraint_name(j),
            };
        }
        self
    }
}

/// Replaces the final iterate of a run that did not converge by a better point of the run. If that
/// is better by more than the tolerance, the run had not reached the precision of the objective.
pub(crate) fn best_of(program: &mut Program<'_>, finish: FinalIterate) -> FinalIterate {
    let settled = matches!(finish.status, Status::Converged | Status::Infeasible { .. });
    let at_precision = finish.status == Status::AtPrecision;
    let f = finish.point.f.abs();
    let unit = f.max(program.unit_of_objective() * program.scaling.objective);
    let worth = if at_precision {
        program.options.tolerance * unit
    } else {
        0.0
    };
    // A gain that comes from a violation within the tolerance does not count.
    let y = &finish.multipliers.y;
    let value = |p: &Point| {
        p.f + (0..p.c.len())
            .map(|k| y[k].abs() * program.row_violation(&p.c, k))
            .sum::<f64>()
    };
    let rank = |p: &Point| (program.relative_violation(&p.c).max(1.0), value(p));
    let found = program.best.clone().filter(|best| {
        let (new, old) = (rank(best), rank(&finish.point));
        !settled && (new.0 < old.0 || (new.0 == old.0 && new.1 < old.1 - worth))
    });
    let Some(point) = found else {
        return finish;
    };
    let slopes = match program.gradients(&point.x) {
        Ok(slopes) => slopes,
        // Interrupted: the iterate with its residuals is a result as well.
        Err(EarlyExit::Halt(_)) => return finish,
        Err(EarlyExit::Failed(_)) => {
            // Its values count, but nothing is known of its residuals.
            let mut finish = FinalIterate { point, ..finish };
            finish.slopes.g.fill(f64::NAN);
            finish.scaled = f64::NAN;
            return finish;
        }
    };
    let y = &finish.multipliers.y;
    let multipliers = ScaledMultipliers::polished(program, &point, &slopes, y);
    let scaled = scaled_residual(program, &point, &slopes, &multipliers);
    let status = if at_precision {
        Status::Stalled
    } else {
        finish.status.clone()
    };
    FinalIterate {
        status,
        point,
        slopes,
        multipliers,
        scaled,
        ..finish
    }
    .judged(program)
}

/// The outcome if all variables are fixed.
pub(crate) fn without_freedom(
    program: &Program<'_>,
    point: Point,
    slopes: Derivatives,
) -> FinalIterate {
    let status = match program.is_feasible(&point.c) {
        true => Status::Converged,
        false => infeasible(program, &point),
    };
    FinalIterate {
        status,
        ..unfinished(program, point, slopes)
    }
}

/// The outcome if the observer stops the run at the start.
pub(crate) fn unfinished(program: &Program<'_>, point: Point, slopes: Derivatives) -> FinalIterate {
    let y = DVector::zeros(point.c.len());
    let multipliers = ScaledMultipliers::from_rows(program, &point, &slopes, y);
    let options = program.options;
    FinalIterate {
        status: Status::Interrupted,
        method: program.first_method(),
        b: QuasiNewton::new(point.x.len(), options.dense_limit, options.memory),
        scaled: scaled_residual(program, &point, &slopes, &multipliers),
        units: program.units(),
        multipliers,
        point,
        slopes,
        barrier: options.first_barrier(),
        radius: options.initial_radius,
    }
}

/// The verdict on a point at which the worst row cannot be improved.
pub(crate) fn infeasible(program: &Program<'_>, at: &Point) -> Status {
    let (violation, j) = program.worst_violation(&at.c);
    Status::Infeasible {
        constraint: program.constraint_name(j),
        violation,
    }
}
