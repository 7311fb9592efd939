//! Which joints or bodies make a model singular, by name. Runs only after a factorisation failed.

use super::assembly::{AssemblyFailure, length_scale};
use super::bodies::Motion;
use super::joints;
use super::numbering::Numbering;
use super::redundancy::redundant_rows;
use crate::math::Scalar;
use crate::model::Model;
use nalgebra::DMatrix;

/// Singular values below this, relative to the largest, count as zero.
const NEGLIGIBLE: f64 = 1e-10;

/// Inertia or hold, relative to the largest, up to which a motion has none.
const LOOSE: f64 = 1e-13;

/// Says which constraints are redundant at q, or else which bodies can move without inertia.
pub fn explain<S: Scalar>(model: &Model<S>, q: &[S]) -> AssemblyFailure {
    let numbering = Numbering::new(model);
    let mut motions = Vec::new();
    let at_rest = vec![S::zero(); numbering.velocities()];
    Motion::all(&numbering, q, &at_rest, &mut motions);
    let mut gradients = Vec::new();
    joints::gradients(model, &numbering, (&motions, S::zero()), &mut gradients);
    let mut g = DMatrix::<f64>::zeros(numbering.constraints(), numbering.velocities());
    for (j, joint) in model.joints.iter().enumerate() {
        for i in numbering.rows(j) {
            let row = &gradients[i];
            for k in 0..3 {
                let a = numbering.velocity(joint.body_a);
                g[(i, a + k)] += row.force[k].re();
                g[(i, a + 3 + k)] += row.torque_a[k].re();
                if let Some(b) = joint.body_b.map(|b| numbering.velocity(b)) {
                    g[(i, b + k)] -= row.force[k].re();
                    g[(i, b + 3 + k)] += row.torque_b[k].re();
                }
            }
        }
    }
    if g.iter().any(|x| !x.is_finite()) {
        return AssemblyFailure::Singular;
    }
    scale(&mut g, length_scale(model));
    if g.is_empty() {
        return without_inertia(model, &g);
    }
    let svd = g.clone().svd(true, false);
    let largest = svd.singular_values.max();
    let redundant: Vec<usize> = (0..svd.singular_values.len())
        .filter(|&k| svd.singular_values[k] <= NEGLIGIBLE * largest)
        .collect();
    let extra = numbering
        .constraints()
        .saturating_sub(numbering.velocities());
    if redundant.is_empty() && extra == 0 {
        return without_inertia(model, &g);
    }
    let mut names: Vec<&str> = Vec::new();
    if let Some(u) = &svd.u {
        for (j, joint) in model.joints.iter().enumerate() {
            let share: f64 = redundant
                .iter()
                .flat_map(|&k| numbering.rows(j).map(move |i| u[(i, k)].powi(2)))
                .sum();
            if share > 1e-8 {
                names.push(&joint.name);
            }
        }
    }
    let joints = if names.is_empty() {
        "all".to_string()
    } else {
        names.join(", ")
    };
    // What is redundant beside this placement as well has been left out already, or not yet.
    let model = model.map(&mut |x| x.re());
    let left_out = model.joints.iter().map(|joint| joint.left_out.len()).sum();
    if redundant_rows(&model) == Some(left_out) {
        return AssemblyFailure::SingularPosition { joints };
    }
    AssemblyFailure::Redundant {
        redundant: redundant.len() + extra,
        constraints: numbering.constraints(),
        joints,
    }
}

/// Counts angles as arcs at the `length`, and makes all rows unit rows, so that the scene's scale does
/// not decide what is singular.
fn scale(g: &mut DMatrix<f64>, length: f64) {
    for (j, mut column) in g.column_iter_mut().enumerate() {
        if j % 6 >= 3 {
            column /= length;
        }
    }
    for mut row in g.row_iter_mut() {
        let size = row.norm();
        if size > 0.0 {
            row /= size;
        }
    }
}

/// Says which bodies can move without inertia, given the scaled gradients; if none can, that the
/// equations are singular for another reason.
fn without_inertia<S: Scalar>(model: &Model<S>, g: &DMatrix<f64>) -> AssemblyFailure {
    let length = length_scale(model);
    let n = 6 * model.bodies.len();
    let mut inertia = DMatrix::zeros(n, n);
    for (i, body) in model.bodies.iter().enumerate() {
        let at = 6 * i;
        for k in 0..3 {
            inertia[(at + k, at + k)] = body.mass.re();
            for l in 0..3 {
                inertia[(at + 3 + k, at + 3 + l)] = body.inertia[(k, l)].re() / (length * length);
            }
        }
    }
    let largest = inertia.amax();
    if largest > 0.0 {
        inertia /= largest;
    }
    // A motion that neither joints hold nor inertia resists.
    let held = &inertia + inertia.transpose() + g.tr_mul(g);
    if held.symmetric_eigenvalues().min() > LOOSE {
        return AssemblyFailure::Singular;
    }
    let names: Vec<&str> = model
        .bodies
        .iter()
        .filter(|body| {
            let j = body.inertia.map(|x| x.re());
            let values = j.symmetric_eigenvalues();
            body.mass.re() <= 0.0 || values.min() <= NEGLIGIBLE * values.max()
        })
        .map(|body| body.name.as_str())
        .collect();
    if names.is_empty() {
        AssemblyFailure::Singular
    } else {
        AssemblyFailure::WithoutInertia {
            bodies: names.join(", "),
        }
    }
}
