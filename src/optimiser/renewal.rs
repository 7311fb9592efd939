//! Restart of a stalled method, in units that suit the point where it stalled.

use crate::doubts::degenerate_row;
use crate::ending::FinalIterate;
use crate::program::{Derivatives, Point, Program};
use crate::status::Status;

/// Restarts from a feasible point where `finish` stalled. The restart has new units, an empty
/// quasi-Newton matrix and no earlier derivatives. It is repeated as long as the objective
/// improves. Only after a restart without improvement may the end be [`Status::AtPrecision`].
pub(crate) fn renewed(
    program: &mut Program<'_>,
    mut finish: FinalIterate,
    run: impl Fn(&mut Program<'_>, (Point, Derivatives)) -> FinalIterate,
) -> FinalIterate {
    let norms = program.gradient_norms.clone();
    loop {
        if finish.status != Status::Stalled {
            return finish;
        }
        let z = &finish.multipliers;
        if let Some(j) = degenerate_row(program, &finish.point, &finish.slopes, z) {
            finish.status = Status::Degenerate {
                constraint: program.constraint_name(j),
            };
            return finish;
        }
        let is_feasible = |p: &Point| program.is_feasible(&p.c);
        let places = [Some(&finish.point), program.best.as_ref()];
        let Some(place) = places.into_iter().flatten().find(|p| is_feasible(p)) else {
            return finish;
        };
        let (place, unit_f) = (place.clone(), program.scaling.objective);
        let before = place.f / unit_f;
        let next = match program.renew(place) {
            Ok(first) => run(program, first),
            Err(trouble) => {
                finish.restore_units(program);
                finish.status = trouble.into();
                return finish;
            }
        };
        let gain = before - next.point.f / program.scaling.objective;
        let unit = before.abs().max(program.unit_of_objective());
        let worth = program.options.tolerance * unit;
        let lost = !program.is_feasible(&next.point.c);
        if next.status != Status::Converged && (lost || gain <= worth) {
            // There is no gain left. The residuals may be rounding relative to the gradients of the
            // run.
            finish.restore_units(program);
            program.gradient_norms.extend(&norms);
            return finish.with_stall_named(program);
        }
        finish = next;
    }
}
