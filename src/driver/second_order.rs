//! Whether an optimum is a minimum of second order: the curvature of the Lagrangian along the
//! directions that the active bounds and constraints leave free.
//!
//! A bound or constraint is weakly active if its multiplier is zero or almost zero. Feasible
//! directions without first-order change then form a cone, {d : a·d = 0 for strictly active a, a·d
//! ≥ 0 for weakly active a}. With H = ∇²L the optimum is strict if dᵀHd > 0 on the span of the
//! cone, and is none if dᵀHd < 0 for a d of the cone. Otherwise it is not decided (Nocedal & Wright
//! 2006, theorems 12.5 and 12.6).

use super::evaluator::Evaluator;
use super::integration::Integration;
use super::known_evaluations::KnownEvaluations;
use crate::optimiser::{BoundSide, EvaluationFailure, Nlp, Outcome};
use crate::problem::Problem;
use crate::report::optimum::{Curvature, SecondOrder};
use nalgebra::{DMatrix, DVector};

/// Length of a difference in scaled variables. The error of a central difference of gradients is
/// proportional to its square.
const STEP: f64 = 1e-4;
/// Eigenvalues of AᵀA for the active rows A, each of unit length, below this count as zero.
const NEGLIGIBLE: f64 = 1e-10;
/// Multipliers below this part of the objective's gradient may be weakly active: the curvature
/// decides.
const WEAK: f64 = 1e-3;
/// A unit direction counts as along a bound if it leaves it by at most this part.
const ALONG: f64 = 1e-6;
/// Number of directions whose gradients are computed side by side.
const AT_ONCE: usize = 8;

/// A weakly active bound or constraint.
struct Weak {
    name: String,
    /// Its gradient, of unit length, which points inwards.
    inwards: DVector<f64>,
    /// Rise of the objective for a unit step inwards.
    force: f64,
}

/// The active bounds and constraints, in the free variables.
struct Active {
    /// Variables that no strictly active bound holds.
    free: Vec<usize>,
    /// Gradients of the strictly active constraints.
    rows: DMatrix<f64>,
    weak: Vec<Weak>,
}

/// Eigenvalues of the reduced Hessian Zᵀ ∇²L Z of the minimised Lagrangian, in the optimiser's
/// scaled variables, by central differences of gradients: four gradients a direction. `None` if
/// `stopped` returns true before the end.
///
/// Z spans the directions in which the variables without a strictly active bound can move without a
/// first-order change of strictly active constraints. The error is estimated from a second step of
/// twice the length and from the asymmetry. Near a bound the differences are centred inside it, by
/// a distance of their length; the estimate includes this.
///
/// Gradients that `log` knows are not evaluated again. The others use the steps of
/// `integration`.
///
/// # Errors
/// If a simulation near the optimum fails.
pub fn second_order(
    problem: &Problem,
    outcome: &Outcome,
    integration: &Integration,
    log: KnownEvaluations<'_>,
    stopped: &dyn Fn() -> bool,
) -> Result<Option<SecondOrder>, EvaluationFailure> {
    let Some(mut program) = Evaluator::new(problem, log) else {
        return Ok(None);
    };
    program.integration = integration.clone();
    let x = DVector::from_column_slice(&outcome.x);
    let Active { free, rows, weak } = active(problem, outcome, &mut program)?;
    let basis = null_space(&rows);
    let (lower, upper) = program.variable_bounds();
    let narrowest = free.iter().map(|&i| (upper[i] - lower[i]) / 4.0);
    let step = narrowest.fold(STEP, f64::min);

    let multipliers = DVector::from_column_slice(&outcome.multipliers.constraints);
    let k = basis.ncols();
    let mut differences = |step: f64| -> Result<Option<DMatrix<f64>>, EvaluationFailure> {
        let mut centre = x.clone();
        for &i in &free {
            centre[i] = centre[i].clamp(lower[i] + step, upper[i] - step);
        }
        let place = |j: usize, length: f64| {
            let mut at = centre.clone();
            for (c, &i) in free.iter().enumerate() {
                at[i] += length * basis[(c, j)];
            }
            at.as_slice().to_vec()
        };
        let mut hessian = DMatrix::zeros(k, k);
        for j in 0..k {
            // A few directions at a time, so the computation can be stopped.
            if j % AT_ONCE == 0 && !stopped() {
                let next = j..k.min(j + AT_ONCE);
                let both = next.flat_map(|j| [place(j, step), place(j, -step)]);
                program.foresee_gradients(&both.collect::<Vec<_>>());
            }
            let mut beside = |length: f64| -> Result<DVector<f64>, EvaluationFailure> {
                let g = program.gradients(&place(j, length))?;
                let all = DVector::from_vec(g.objective)
                    + DVector::from_vec(g.jacobian.weighted_sum(multipliers.as_slice()));
                Ok(all.select_rows(&free))
            };
            if stopped() {
                return Ok(None);
            }
            let change = beside(step)? - beside(-step)?;
            hessian.set_column(j, &(basis.tr_mul(&change) / (2.0 * step)));
        }
        Ok(Some(hessian))
    };
    let (Some(coarse), Some(hessian)) = (differences(2.0 * step)?, differences(step)?) else {
        return Ok(None);
    };
    let transposed = hessian.transpose();
    let asymmetry = (&hessian - &transposed).amax() * 0.5;
    let uncertainty = (&hessian - &coarse).amax().max(asymmetry);
    let reduced = Reduced {
        hessian: (hessian + transposed) * 0.5,
        uncertainty,
        basis,
        weak,
    }
    .held();
    let (curvature, falling) = reduced.judge();
    let descent = falling.map(|direction| {
        let mut changes = vec![0.0; problem.variables.len()];
        for (part, &i) in direction.iter().zip(&free) {
            changes[i] = part * problem.variables[i].scale;
        }
        let names = problem.variables.iter().map(|v| v.name.clone());
        names.zip(changes).collect()
    });
    let mut eigenvalues: Vec<f64> = match curvature {
        Curvature::NoFreeDirection => Vec::new(),
        _ => reduced
            .hessian
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect(),
    };
    eigenvalues.sort_by(f64::total_cmp);
    Ok(Some(SecondOrder {
        eigenvalues,
        uncertainty,
        curvature,
        descent,
        weakly_active: reduced.weak.into_iter().map(|weak| weak.name).collect(),
    }))
}

/// The strictly and the weakly active bounds and constraints.
fn active(
    problem: &Problem,
    outcome: &Outcome,
    program: &mut Evaluator<'_>,
) -> Result<Active, EvaluationFailure> {
    let n = outcome.x.len();
    let slopes = program.gradients(&outcome.x)?;
    let steepest = DVector::from_column_slice(&slopes.objective).amax();
    // Where the gradient vanishes, its typical size decides: the multiplier of a bound through the optimum falls with the
    // root of the barrier parameter.
    let scaling = &outcome.scaling;
    let elsewhere = scaling.typical_gradient.max(scaling.objective_gradient);
    let force = WEAK * steepest.max(elsewhere);
    let (lower, upper) = program.variable_bounds();
    let mut free = Vec::new();
    let mut touched = Vec::new();
    for i in 0..n {
        let name = &problem.variables[i].name;
        let bound = outcome.active_bounds.iter().find(|a| a.name == *name);
        if bound.is_some_and(|a| a.side == BoundSide::Equal || a.multiplier > force) {
            continue;
        }
        let near = |distance: f64| distance <= 2.0 * STEP;
        let multipliers = &outcome.multipliers;
        let close = if near(outcome.x[i] - lower[i]) {
            Some((1.0, multipliers.lower_bounds[i]))
        } else {
            near(upper[i] - outcome.x[i]).then_some((-1.0, multipliers.upper_bounds[i]))
        };
        if let Some((inwards, multiplier)) = close {
            if multiplier > force {
                continue;
            }
            touched.push((free.len(), inwards, multiplier, name.clone()));
        }
        free.push(i);
    }
    let unit = |(c, sign, force, name): (usize, f64, f64, String)| Weak {
        name,
        force,
        inwards: DVector::from_fn(free.len(), |r, _| if r == c { sign } else { 0.0 }),
    };
    let mut weak: Vec<Weak> = touched.into_iter().map(unit).collect();
    let mut strict = Vec::new();
    for (j, constraint) in problem.constraints.iter().enumerate() {
        let mut all = outcome.active_constraints.iter();
        let Some(bound) = all.find(|a| a.name == constraint.name) else {
            continue;
        };
        let n = outcome.x.len();
        let row = DVector::from_fn(n, |i, _| slopes.jacobian[(j, i)]);
        let inner = row.select_rows(&free);
        let held = bound.multiplier * row.amax() > force;
        match bound.side {
            side if side == BoundSide::Equal || held => strict.push(inner.transpose()),
            side => {
                let sign = if side == BoundSide::Lower { 1.0 } else { -1.0 };
                let length = inner.norm().max(f64::MIN_POSITIVE);
                weak.push(Weak {
                    name: constraint.name.clone(),
                    force: bound.multiplier * length,
                    inwards: inner * (sign / length),
                });
            }
        }
    }
    let rows = match strict.is_empty() {
        true => DMatrix::zeros(0, free.len()),
        false => DMatrix::from_rows(&strict),
    };
    Ok(Active { free, rows, weak })
}

/// The Hessian along the directions `basis`, which `weak` may restrict.
struct Reduced {
    hessian: DMatrix<f64>,
    uncertainty: f64,
    basis: DMatrix<f64>,
    weak: Vec<Weak>,
}

impl Reduced {
    /// Removes the directions along which even a small force outweighs the curvature over the
    /// length of the differences: the optimum is held there.
    fn held(self) -> Self {
        let k = self.basis.ncols();
        let (mut rows, mut weak) = (Vec::new(), Vec::new());
        for bound in self.weak {
            let across = self.basis.tr_mul(&bound.inwards);
            let part = across.norm();
            if part <= ALONG {
                continue;
            }
            let curvature = (&self.hessian * &across).dot(&across) / (part * part);
            if bound.force * part > STEP * curvature.abs().max(self.uncertainty) {
                rows.push(across.transpose());
            } else {
                weak.push(bound);
            }
        }
        let free = match rows.is_empty() {
            true => DMatrix::identity(k, k),
            false => null_space(&DMatrix::from_rows(&rows)),
        };
        Self {
            hessian: free.tr_mul(&self.hessian) * &free,
            basis: self.basis * free,
            weak,
            ..self
        }
    }

    /// The verdict, and a feasible direction of negative curvature if there is one.
    fn judge(&self) -> (Curvature, Option<DVector<f64>>) {
        if self.basis.ncols() == 0 {
            return (Curvature::NoFreeDirection, None);
        }
        let eigen = self.hessian.clone().symmetric_eigen();
        let values = &eigen.eigenvalues;
        if values.iter().all(|&value| value > self.uncertainty) {
            return (Curvature::StrictOptimum, None);
        }
        let mut falling: Vec<usize> = (0..values.len()).collect();
        falling.retain(|&k| values[k] < -self.uncertainty);
        falling.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut descent = None;
        for &k in &falling {
            let direction = &self.basis * eigen.eigenvectors.column(k);
            if let Some(sign) = self.admits(&direction, values[k]) {
                descent = descent.or(Some(direction * sign));
            }
        }
        // The face of the cone on which all weakly active bounds stay active.
        let faces = DMatrix::from_fn(self.weak.len(), self.basis.ncols(), |r, c| {
            self.weak[r].inwards.dot(&self.basis.column(c))
        });
        let face = null_space(&faces);
        if face.ncols() > 0 {
            let along = (face.tr_mul(&self.hessian) * &face).symmetric_eigen();
            let (least, value) = along.eigenvalues.argmin();
            if value < -self.uncertainty && descent.is_none() {
                descent = Some(&self.basis * (&face * along.eigenvectors.column(least)));
            }
        }
        match (&descent, falling.is_empty()) {
            (Some(_), _) => (Curvature::NoOptimum, descent),
            (None, false) => (Curvature::NotDecided, None),
            (None, true) => (Curvature::Flat, None),
        }
    }

    /// The sign with which a direction of negative curvature lies in the cone, if any. Small forces
    /// along it must be outweighed within the length of the differences.
    fn admits(&self, direction: &DVector<f64>, curvature: f64) -> Option<f64> {
        let along = |sign: &f64| {
            let part = |w: &Weak| *sign * w.inwards.dot(direction);
            let rise: f64 = self.weak.iter().map(|w| w.force * part(w)).sum();
            self.weak.iter().all(|w| part(w) >= -ALONG) && rise <= -curvature * STEP
        };
        [1.0, -1.0].into_iter().find(along)
    }
}

/// Orthonormal basis of the directions that `rows` map to zero.
fn null_space(rows: &DMatrix<f64>) -> DMatrix<f64> {
    let n = rows.ncols();
    if rows.nrows() == 0 || n == 0 {
        return DMatrix::identity(n, n);
    }
    // Rows may have any units: only their directions matter.
    let mut unit = rows.clone();
    for mut row in unit.row_iter_mut() {
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
    }
    let gram = unit.tr_mul(&unit).symmetric_eigen();
    let free: Vec<_> = (0..n)
        .filter(|&i| gram.eigenvalues[i] <= NEGLIGIBLE)
        .map(|i| gram.eigenvectors.column(i).into_owned())
        .collect();
    if free.is_empty() {
        DMatrix::zeros(n, 0)
    } else {
        DMatrix::from_columns(&free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weak(inwards: [f64; 2], force: f64) -> Weak {
        Weak {
            name: String::new(),
            inwards: DVector::from_column_slice(&inwards),
            force,
        }
    }

    fn reduced(hessian: [f64; 4], weak: Vec<Weak>) -> Reduced {
        Reduced {
            hessian: DMatrix::from_row_slice(2, 2, &hessian),
            uncertainty: 1e-3,
            basis: DMatrix::identity(2, 2),
            weak,
        }
    }

    /// f = ½ xᵀHx at 0: over the plane, over x ≥ 0, over x, y ≥ 0.
    #[test]
    fn a_cone_is_judged_by_its_own_directions() {
        let verdict = |hessian, weak| reduced(hessian, weak).judge().0;
        let half = || vec![weak([1.0, 0.0], 0.0)];
        let quarter = || vec![weak([1.0, 0.0], 0.0), weak([0.0, 1.0], 0.0)];
        let bowl = [1.0, 0.0, 0.0, 2.0];
        // Falls along (1, 1), rises along (1, -1); and the other way.
        let (within, across) = ([0.0, -1.0, -1.0, 0.0], [0.0, 1.0, 1.0, 0.0]);
        assert_eq!(verdict(bowl, quarter()), Curvature::StrictOptimum);
        assert_eq!(verdict(within, vec![]), Curvature::NoOptimum);
        assert_eq!(verdict(within, quarter()), Curvature::NoOptimum);
        let (_, descent) = reduced(within, quarter()).judge();
        let half_root = 0.5_f64.sqrt();
        let inwards = DVector::from_column_slice(&[half_root, half_root]);
        assert!((descent.expect("falls") - inwards).amax() < 1e-14);
        assert_eq!(verdict(across, vec![]), Curvature::NoOptimum);
        assert_eq!(verdict(across, half()), Curvature::NoOptimum);
        // xy over x, y ≥ 0 is a minimum, although an eigenvalue is negative.
        assert_eq!(verdict(across, quarter()), Curvature::NotDecided);
        assert_eq!(verdict([1.0, 0.0, 0.0, 1e-4], half()), Curvature::Flat);
        // Along the face x = 0 it falls both ways.
        assert_eq!(verdict([1.0, 0.0, 0.0, -1.0], half()), Curvature::NoOptimum);
    }

    /// A force along x that outweighs the curvature over the differences, and one that does not.
    #[test]
    fn a_small_force_holds_what_curves_less() {
        for (force, curvature) in [
            (1e-3, Curvature::StrictOptimum),
            (1e-5, Curvature::NoOptimum),
        ] {
            let found = reduced([-1.0, 0.0, 0.0, 1.0], vec![weak([1.0, 0.0], force)]).held();
            assert_eq!(found.judge().0, curvature, "{force}");
            assert_eq!(found.weak.len(), usize::from(force < 1e-4));
        }
        let held = vec![weak([1.0, 0.0], 1.0), weak([0.0, 1.0], 1.0)];
        let vertex = reduced([1.0, 0.0, 0.0, 1.0], held).held();
        assert_eq!(vertex.judge(), (Curvature::NoFreeDirection, None));
    }

    #[test]
    fn a_null_space_is_orthonormal_and_complete() {
        let rows = DMatrix::from_row_slice(2, 4, &[1.0, 2.0, 0.0, -1.0, 2.0, 4.0, 0.0, -2.0]);
        let basis = null_space(&rows);
        assert_eq!(basis.shape(), (4, 3));
        assert!((&rows * &basis).amax() < 1e-14);
        assert!((basis.tr_mul(&basis) - DMatrix::identity(3, 3)).amax() < 1e-14);
        assert_eq!(null_space(&DMatrix::zeros(0, 3)).shape(), (3, 3));
        let units = DMatrix::from_row_slice(2, 3, &[1e8, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(null_space(&units).shape(), (3, 1));
    }
}
