//! Residuals of the optimality conditions at the end of a run, computed only from the problem and
//! the reported multipliers.

use flexbody_optimiser::{Nlp, Outcome};

/// Residuals in the units of the problem; those of forces and objective are divided by the larger
/// of the given unit and ‖∇f‖∞ or |f|.
#[derive(Debug)]
pub struct Residuals {
    pub violation: f64,
    pub stationarity: f64,
    pub complementarity: f64,
    /// Whether all multipliers have the right sign and belong to existing bounds.
    pub signs: bool,
}

impl Residuals {
    pub fn in_unit(problem: &mut dyn Nlp, outcome: &Outcome, unit: f64) -> Residuals {
        let x = &outcome.x;
        let at = problem.evaluate(x).expect("is defined");
        let slopes = problem.gradients(x).expect("is defined");
        let (lower, upper) = problem.variable_bounds();
        let (row_lower, row_upper) = problem.constraint_bounds();
        let z = &outcome.multipliers;
        let mut found = Residuals {
            violation: 0.0,
            stationarity: 0.0,
            complementarity: 0.0,
            signs: true,
        };
        let mut bound = |value: f64, lower: f64, upper: f64, zl: f64, zu: f64| {
            found.violation = found.violation.max(lower - value).max(value - upper);
            found.signs &= zl >= 0.0 && zu >= 0.0;
            found.signs &= (zl == 0.0 || lower.is_finite()) && (zu == 0.0 || upper.is_finite());
            let product = |z: f64, room: f64| if z > 0.0 { z * room.abs() } else { 0.0 };
            found.complementarity += product(zl, value - lower) + product(zu, upper - value);
        };
        for i in 0..x.len() {
            bound(
                x[i],
                lower[i],
                upper[i],
                z.lower_bounds[i],
                z.upper_bounds[i],
            );
        }
        for (j, &y) in z.constraints.iter().enumerate() {
            let (yl, yu) = ((-y).max(0.0), y.max(0.0));
            bound(at.constraints[j], row_lower[j], row_upper[j], yl, yu);
        }
        for i in 0..x.len() {
            let rows = z.constraints.iter().enumerate();
            let rows: f64 = rows.map(|(j, y)| y * slopes.jacobian[(j, i)]).sum();
            let force = slopes.objective[i] + rows - z.lower_bounds[i] + z.upper_bounds[i];
            found.stationarity = found.stationarity.max(force.abs());
        }
        let gradient = slopes.objective.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        // A constant objective has no unit.
        let unit = if gradient == 0.0 { 1.0 } else { unit };
        found.stationarity /= gradient.max(unit);
        found.complementarity /= at.objective.abs().max(unit);
        found
    }
}
