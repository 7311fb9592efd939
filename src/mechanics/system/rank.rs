//! Names the joints or bodies that make a model singular. Used only after a factorisation failed.

use super::failure::AssemblyFailure;
use super::numbering::Numbering;
use super::placement::{guess, length_scale};
use super::redundancy;
use crate::math::{Parameters, Scalar};
use crate::model::{Model, RigidBody};
use nalgebra::DMatrix;

/// Singular values below this, relative to the largest, are zero.
const NEGLIGIBLE: f64 = 1e-10;

/// A motion below this inertia or constraint, relative to the largest, has none.
const LOOSE: f64 = 1e-13;

/// A body whose part in a motion of unit size is below this takes no part in it.
const MOVES: f64 = 1e-6;

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

/// Names bodies that can move where they are placed with no inertia but round-off: thin ones that nothing keeps from
/// spinning about their own axes, and bodies without mass whose motion the joints leave open.
pub fn moving_without_inertia(model: &Model<f64>) -> Option<AssemblyFailure> {
    if loose_bodies(model).is_empty() {
        return None;
    }
    let (g, _) = redundancy::unit_rows(model, &guess(model).0);
    let known = g.iter().all(|x| x.is_finite());
    let found = known.then(|| without_inertia(model, &g))?;
    matches!(found, AssemblyFailure::WithoutInertia { .. }).then_some(found)
}

/// Bodies of the file without inertia in a direction in which they can move: those without mass, and those that are thin
/// about an axis about which they turn. In a plane that is the normal alone.
fn loose_bodies(model: &Model<f64>) -> Vec<usize> {
    let is_loose = |&i: &usize| {
        let body = &model.bodies[i];
        let moments = body.inertia.symmetric_eigenvalues();
        let rotation = &body.mobility.rotation;
        let least = match rotation.free() {
            0 => f64::INFINITY,
            1 => rotation.quadratic(&body.inertia, 0, 0),
            _ => moments.min(),
        };
        let lacks_inertia = body.mass == 0.0 || least <= LOOSE * moments.max();
        body.mobility.unknowns() > 0 && lacks_inertia && !model.is_internal(i)
    };
    (0..model.bodies.len()).filter(is_loose).collect()
}

/// Names the bodies that can move without inertia; `g` has the unit rows as columns. If there are
/// none, the equations are singular for another reason.
///
/// Such a motion moves no direction with inertia. So the motions of the loose bodies alone are examined: those u
/// that inertia M and rows G leave free, M u = 0 and G u = 0.
fn without_inertia(model: &Model<f64>, g: &DMatrix<f64>) -> AssemblyFailure {
    let loose = loose_bodies(model);
    if loose.is_empty() {
        return AssemblyFailure::Singular;
    }
    let length = length_scale(model);
    let moments = |body: &RigidBody<f64>| body.inertia / (length * length);
    let largest = (model.bodies.iter()).fold(0.0_f64, |largest, body| {
        largest.max(body.mass).max(moments(body).amax())
    });
    let scale = if largest > 0.0 { 2.0 / largest } else { 1.0 };
    let n = 6 * loose.len();
    let mut rows = DMatrix::zeros(n, g.ncols());
    let mut held = DMatrix::zeros(n, n);
    for (k, &i) in loose.iter().enumerate() {
        let (body, at) = (&model.bodies[i], 6 * k);
        rows.rows_mut(at, 6).copy_from(&g.rows(6 * i, 6));
        for l in 0..3 {
            held[(at + l, at + l)] = scale * body.mass;
        }
        let mut rotation = held.fixed_view_mut::<3, 3>(at + 3, at + 3);
        rotation += scale * moments(body);
        // Directions in which the body cannot move.
        let directions = [&body.mobility.translation, &body.mobility.rotation];
        for (part, directions) in directions.into_iter().enumerate() {
            let mut block = held.fixed_view_mut::<3, 3>(at + 3 * part, at + 3 * part);
            for fixed in (directions.free()..3).map(|l| directions.axis(l)) {
                block += fixed * fixed.transpose();
            }
        }
    }
    held += &rows * rows.transpose();
    let motions = held.symmetric_eigen();
    let free: Vec<usize> = (0..n)
        .filter(|&k| motions.eigenvalues[k] <= LOOSE)
        .collect();
    let moves = |&k: &usize| {
        let part = |&motion: &usize| motions.eigenvectors.view((6 * k, motion), (6, 1)).norm();
        free.iter().any(|motion| part(motion) > MOVES)
    };
    let moving: Vec<&RigidBody<f64>> = (0..loose.len())
        .filter(moves)
        .map(|k| &model.bodies[loose[k]])
        .collect();
    let names: Vec<&str> = moving.iter().map(|body| body.name.as_str()).collect();
    match names.is_empty() {
        true => AssemblyFailure::Singular,
        false => AssemblyFailure::WithoutInertia {
            bodies: names.join(", "),
            without_mass: moving.iter().all(|body| body.mass == 0.0),
        },
    }
}
