//! Names the joints or bodies that make a model singular. Used only after a factorisation failed.

use super::failure::AssemblyFailure;
use super::numbering::Numbering;
use super::placement::{guess, length_scale};
use super::redundancy;
use crate::math::{Parameters, Scalar};
use crate::model::{Mobility, Model, RigidBody};
use nalgebra::DMatrix;

/// Singular values below this, relative to the largest, are zero.
const NEGLIGIBLE: f64 = 1e-10;

/// A motion below this inertia or constraint, relative to the largest, has none.
const LOOSE: f64 = 1e-13;

/// Names the redundant constraints at q or, if there are none, the bodies without inertia.
pub fn explain<S: Scalar>(model: &Model<S>, q: &[S]) -> AssemblyFailure {
    let numbering = Numbering::new(model);
    let real = model.map(&mut |x| x.re());
    let q: Vec<f64> = q.iter().map(|x| x.re()).collect();
    let (g, joint_of) = redundancy::unit_rows(&real, &q);
    if g.iter().any(|x| !x.is_finite()) {
        return AssemblyFailure::Singular;
    }
    if g.is_empty() {
        return without_inertia(&real, &g);
    }
    // Its left singular vectors correspond to the rows.
    let svd = g.transpose().svd(true, false);
    let largest = svd.singular_values.max();
    let redundant: Vec<usize> = (0..svd.singular_values.len())
        .filter(|&k| svd.singular_values[k] <= NEGLIGIBLE * largest)
        .collect();
    let extra = joint_of.len().saturating_sub(numbering.velocities());
    if redundant.is_empty() && extra == 0 {
        return without_inertia(&real, &g);
    }
    let mut names: Vec<&str> = Vec::new();
    if let Some(u) = &svd.u {
        for (j, joint) in model.joints.iter().enumerate() {
            let rows = (0..joint_of.len()).filter(|&i| joint_of[i] == j);
            let share: f64 = redundant
                .iter()
                .flat_map(|&k| rows.clone().map(move |i| u[(i, k)].powi(2)))
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
    // Rows that are also redundant near this placement have been left out, or will be.
    let left_out = real.joints.iter().map(|joint| joint.redundant.len()).sum();
    if redundancy::redundant_rows(&real) == Some(left_out) {
        return AssemblyFailure::SingularPosition { joints };
    }
    AssemblyFailure::Redundant {
        redundant: redundant.len() + extra,
        constraints: joint_of.len(),
        joints,
    }
}

/// Names thin bodies that nothing keeps from spinning about their own axes where they are placed, with no inertia but
/// round-off.
pub fn spinning_without_inertia(model: &Model<f64>) -> Option<AssemblyFailure> {
    let thin = |body: &RigidBody<f64>| {
        let values = body.inertia.symmetric_eigenvalues();
        body.mass > 0.0 && values.min() <= LOOSE * values.max()
    };
    // Planar motions have no spin about axes in their plane.
    let spatial = |body: &&RigidBody<f64>| body.mobility == Mobility::spatial();
    if !model.bodies.iter().filter(spatial).any(thin) {
        return None;
    }
    let (g, _) = redundancy::unit_rows(model, &guess(model).0);
    let known = g.iter().all(|x| x.is_finite());
    let found = known.then(|| without_inertia(model, &g))?;
    matches!(found, AssemblyFailure::WithoutInertia { .. }).then_some(found)
}

/// Names the bodies that can move without inertia; `g` has the unit rows as columns. If there are
/// none, the equations are singular for another reason.
fn without_inertia(model: &Model<f64>, g: &DMatrix<f64>) -> AssemblyFailure {
    let length = length_scale(model);
    let n = 6 * model.bodies.len();
    let mut inertia = DMatrix::zeros(n, n);
    for (i, body) in model.bodies.iter().enumerate() {
        let at = 6 * i;
        for k in 0..3 {
            inertia[(at + k, at + k)] = body.mass;
            for l in 0..3 {
                inertia[(at + 3 + k, at + 3 + l)] = body.inertia[(k, l)] / (length * length);
            }
        }
    }
    for body in &model.flexible {
        for (carrier, _) in body.places() {
            // Coordinates have inertia of their own; missing inertia of a carrier is no motion.
            for k in 6 * carrier..6 * carrier + 6 {
                inertia[(k, k)] = 1.0;
            }
        }
    }
    let largest = inertia.amax();
    if largest > 0.0 {
        inertia /= largest;
    }
    // A motion that neither joints nor inertia resist.
    let held = &inertia + inertia.transpose() + g * g.transpose();
    if held.symmetric_eigenvalues().min() > LOOSE {
        return AssemblyFailure::Singular;
    }
    let names: Vec<&str> = model
        .bodies
        .iter()
        .filter(|body| {
            let values = body.inertia.symmetric_eigenvalues();
            body.mass <= 0.0 || values.min() <= NEGLIGIBLE * values.max()
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
