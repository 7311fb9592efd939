//! Reduction of a free body to static motions of its interfaces and vibrations between them (Craig & Bampton
//! 1968).
//!
//! ```text
//! x = Φ_b u_b + Φ_f η,   Φ_b = [1; −K_ii⁻¹ K_ib] R_b,   K_ii φ = λ M_ii φ
//! ```
//!
//! R_b moves an interface: a node, or several nodes that move as one rigid body. Six combinations of the boundary
//! modes are rigid motions, which the frame of the body has already. What holds the frame leaves six boundary
//! modes out: those of one interface (clamped), or three displacements of a first, two of a second and the
//! turn about the line between them (chord). The rest is turned into modes of the held body, each with
//! the mass of the body, so that coordinates are mean displacements.

use super::free_body::{COMPONENTS, FreeBody, Unknown};
use super::imported::{ImportedBody, ImportedPoint};
use super::interfaces::{Abilities, Column, Holding, Interface, NoReduction, abilities, columns};
use super::mass_integrals::integrals;
use super::written::deviation;
use crate::linalg::cholesky::{NotPositiveDefinite, SymmetricPattern};
use crate::math::Vec3;
use crate::math::slices::dot;
use crate::structures::modes::{Pencil, PencilFailure};
use nalgebra::{DMatrix, SymmetricEigen};

/// 1/ω² of a mode relative to the largest below which the mode has no mass.
const MASSLESS: f64 = 1e-14;
/// Largest standard deviation of the stiffness of a coordinate by the digits of a file, relative to it.
const UNCERTAIN: f64 = 0.1;

/// A reduced body, and the data of its reduction.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// Its numbers.
    pub body: ImportedBody,
    /// Boundary modes that are kept: index of the interface, and name of the motion.
    pub boundary: Vec<(usize, String)>,
    /// Boundary modes of all interfaces, rigid motions included.
    pub boundary_before: usize,
    /// Frequencies with all interfaces held \[Hz\].
    pub fixed: Vec<f64>,
    /// Modes that were left out because they have no mass.
    pub massless: usize,
    /// Largest standard deviation of the stiffness of a coordinate by the digits of the file, relative to it.
    pub uncertain: f64,
}

/// Reduces a body; at least `modes` fixed-interface modes are kept, if there are as many.
///
/// # Errors
/// [`NoReduction`]: the body is a mechanism between its interfaces, or they do not hold its frame.
pub fn reduce(
    free: &FreeBody,
    interfaces: &[Interface],
    holding: &Holding,
    modes: usize,
) -> Result<Reduction, NoReduction> {
    let abilities: Vec<Abilities> = (interfaces.iter())
        .map(|interface| abilities(free, interface))
        .collect::<Result<_, _>>()?;
    let before = abilities.iter().map(|all| {
        let both = all.displacements.iter().chain(&all.rotations);
        both.filter(|there| **there).count()
    });
    let boundary_before = before.sum();
    let columns = columns(interfaces, &abilities, holding)?;
    let (statics, fixed, frequencies) = interior(free, interfaces, &abilities, &columns, modes)?;
    let count = statics.len();
    let basis: Vec<Vec<f64>> = statics.into_iter().chain(fixed).collect();
    if basis.is_empty() {
        return Err(NoReduction::Nothing);
    }
    let (mix, massless) = held_modes(free, &basis).map_err(|failure| {
        let parts = basis.iter().map(|x| by_digits(free, x));
        let part = parts.fold(0.0, f64::max);
        match part > UNCERTAIN {
            true => NoReduction::Digits { part },
            false => failure,
        }
    })?;
    let shapes: Vec<Vec<f64>> = mix
        .column_iter()
        .map(|y| combine(&basis, y.iter()))
        .collect();
    // Every mode gets the mass of the body.
    let mass = integrals(free, &[]).mass;
    let (mut shapes, mut mix) = (shapes, mix);
    for (i, shape) in shapes.iter_mut().enumerate() {
        let own = product(&free.pattern, &free.mass, shape);
        let factor = (mass / dot(shape, &own)).sqrt();
        shape.iter_mut().for_each(|x| *x *= factor);
        mix.column_mut(i).scale_mut(factor);
    }
    let mut body = integrals(free, &shapes);
    let forces = shapes
        .iter()
        .map(|x| product(&free.pattern, &free.stiffness, x));
    let forces: Vec<Vec<f64>> = forces.collect();
    let m = shapes.len();
    for i in 0..m {
        for j in 0..m {
            body.stiffness[i * m + j] =
                0.5 * (dot(&shapes[i], &forces[j]) + dot(&shapes[j], &forces[i]));
        }
    }
    let parts = shapes.iter().map(|x| by_digits(free, x));
    let uncertain = parts.fold(0.0, f64::max);
    if uncertain > UNCERTAIN {
        return Err(NoReduction::Digits { part: uncertain });
    }
    body.points = (interfaces.iter().zip(&abilities).enumerate())
        .map(|(k, (interface, can))| {
            let own = || columns.iter().enumerate().filter(|(_, c)| c.interface == k);
            let sum = |mode: usize, of: fn(&Column) -> Vec3<f64>| {
                own().fold(Vec3::zeros(), |sum: Vec3<f64>, (c, column)| {
                    sum + of(column) * mix[(c, mode)]
                })
            };
            ImportedPoint {
                name: interface.name.clone(),
                position: can.centre,
                displacement: (0..m).map(|i| sum(i, |c| c.displacement)).collect(),
                rotation: (0..m).map(|i| sum(i, |c| c.rotation)).collect(),
                turns: can.rotations.iter().all(|there| *there),
            }
        })
        .collect();
    debug_assert_eq!(count, columns.len());
    Ok(Reduction {
        body,
        boundary: columns.into_iter().map(|c| (c.interface, c.name)).collect(),
        boundary_before,
        fixed: frequencies,
        massless,
        uncertain,
    })
}

/// Standard deviation of the stiffness of a motion by the digits of the file, relative to it; 0 of exact numbers.
fn by_digits(free: &FreeBody, x: &[f64]) -> f64 {
    let energy = dot(x, &product(&free.pattern, &free.stiffness, x)).abs();
    match deviation(&free.pattern, &free.rounding[0], x) {
        deviation if deviation > 0.0 => deviation / energy.max(f64::MIN_POSITIVE),
        _ => 0.0,
    }
}

fn combine<'a>(basis: &[Vec<f64>], y: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut sum = vec![0.0; basis[0].len()];
    for (v, y) in basis.iter().zip(y) {
        sum.iter_mut().zip(v).for_each(|(s, v)| *s += y * v);
    }
    sum
}

fn product(pattern: &SymmetricPattern, values: &[f64], x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    pattern.multiply(values, x, &mut y);
    y
}

/// Static motions of all unknowns, fixed-interface modes, and the frequencies of these \[Hz\].
type Interior = (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<f64>);

fn interior(
    free: &FreeBody,
    interfaces: &[Interface],
    abilities: &[Abilities],
    columns: &[Column],
    modes: usize,
) -> Result<Interior, NoReduction> {
    let order = free.unknowns.len();
    let mut owner = vec![None; free.nodes.len()];
    for (k, interface) in interfaces.iter().enumerate() {
        for &node in &interface.nodes {
            owner[node] = Some(k);
        }
    }
    let mut number = vec![None; order];
    let mut inside = Vec::new();
    for (i, unknown) in free.unknowns.iter().enumerate() {
        if owner[unknown.node].is_none() {
            number[i] = Some(inside.len());
            inside.push(i);
        }
    }
    // Motions of the interfaces, all else at rest.
    let moved = |column: &Column| -> Vec<f64> {
        let value = |unknown: &Unknown| {
            if owner[unknown.node] != Some(column.interface) {
                return 0.0;
            }
            let arm = free.nodes[unknown.node] - abilities[column.interface].centre;
            match unknown.component {
                k @ 0..3 => (column.displacement + column.rotation.cross(&arm))[k],
                k => column.rotation[k - 3],
            }
        };
        free.unknowns.iter().map(value).collect()
    };
    let mut statics: Vec<Vec<f64>> = columns.iter().map(moved).collect();
    if inside.is_empty() {
        return Ok((statics, Vec::new(), Vec::new()));
    }
    let mut rows = Vec::with_capacity(inside.len());
    let mut slots = Vec::new();
    for &j in &inside {
        let mut column = Vec::new();
        for (at, i) in free.pattern.column(j) {
            if let Some(i) = number[i] {
                column.push(i);
                slots.push(at);
            }
        }
        rows.push(column);
    }
    let mut pencil = Pencil::new(SymmetricPattern::new(&rows));
    for (k, &at) in slots.iter().enumerate() {
        pencil.stiffness[k] = free.stiffness[at];
        pencil.mass[k] = free.mass[at];
    }
    let failure = |failure: PencilFailure| match failure {
        PencilFailure::NotDefinite(failure) => mechanism(free, &inside, &failure),
        PencilFailure::NoConvergence { asked, found } => {
            NoReduction::NoConvergence { asked, found }
        }
        PencilFailure::NoMass | PencilFailure::TooMany { .. } => NoReduction::Nothing,
    };
    pencil.factorise_stiffness().map_err(failure)?;
    for x in &mut statics {
        let force = product(&free.pattern, &free.stiffness, x);
        let mut inner: Vec<f64> = inside.iter().map(|&i| -force[i]).collect();
        pencil.solve(&mut inner);
        // One step of refinement.
        let mut rest = product(&pencil.pattern, &pencil.stiffness, &inner);
        for (r, &i) in rest.iter_mut().zip(&inside) {
            *r = -force[i] - *r;
        }
        pencil.solve(&mut rest);
        for ((&i, a), b) in inside.iter().zip(&inner).zip(&rest) {
            x[i] = a + b;
        }
    }
    let found = match modes {
        0 => None,
        _ => match pencil.lowest(Vec::new(), modes) {
            Ok(found) => Some(found),
            Err(PencilFailure::TooMany { there, .. }) if there > 0 => {
                Some(pencil.lowest(Vec::new(), there).map_err(failure)?)
            }
            Err(PencilFailure::TooMany { .. } | PencilFailure::NoMass) => None,
            Err(other) => return Err(failure(other)),
        },
    };
    let Some(found) = found else {
        return Ok((statics, Vec::new(), Vec::new()));
    };
    let whole = |inner: &Vec<f64>| {
        let mut x = vec![0.0; order];
        for (&i, &value) in inside.iter().zip(inner) {
            x[i] = value;
        }
        x
    };
    let fixed = found.vectors.iter().map(whole).collect();
    Ok((statics, fixed, found.frequencies()))
}

/// The node that moves most where the stiffness between the interfaces is singular; or the fault
/// that the digits of the stiffness do not show whether it is.
fn mechanism(free: &FreeBody, inside: &[usize], failure: &NotPositiveDefinite) -> NoReduction {
    let mut x = vec![0.0; free.unknowns.len()];
    for (&i, &value) in inside.iter().zip(&failure.direction) {
        x[i] = value;
    }
    let part = by_digits(free, &x);
    if part > UNCERTAIN {
        return NoReduction::Digits { part };
    }
    let sizes = failure.direction.iter().map(|x| x.abs());
    let most = sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let unknown = most.and_then(|(k, _)| Some(free.unknowns[*inside.get(k)?]));
    let text = unknown.map_or_else(String::new, |Unknown { node, component }| {
        let [x, y, z] = <[f64; 3]>::from(free.nodes[node]);
        format!(
            "nothing holds the {} of the node at [{x}, {y}, {z}] while the interfaces are held",
            COMPONENTS[component]
        )
    });
    NoReduction::Interior(text)
}

/// Coefficients of the modes of the held body in a basis, ascending in frequency, and how many have no mass.
fn held_modes(free: &FreeBody, basis: &[Vec<f64>]) -> Result<(DMatrix<f64>, usize), NoReduction> {
    let n = basis.len();
    let gram = |values: &[f64]| {
        let products: Vec<Vec<f64>> = (basis.iter())
            .map(|x| product(&free.pattern, values, x))
            .collect();
        DMatrix::from_fn(n, n, |i, j| {
            0.5 * (dot(&basis[i], &products[j]) + dot(&basis[j], &products[i]))
        })
    };
    let (k, m) = (gram(&free.stiffness), gram(&free.mass));
    let scale: Vec<f64> = (0..n).map(|i| 1.0 / k[(i, i)].sqrt()).collect();
    if scale.iter().any(|x| !x.is_finite()) {
        return Err(NoReduction::Loose);
    }
    let scaled = |a: &DMatrix<f64>| DMatrix::from_fn(n, n, |i, j| a[(i, j)] * scale[i] * scale[j]);
    let (k, m) = (scaled(&k), scaled(&m));
    let least = SymmetricEigen::new(k.clone()).eigenvalues.min();
    if least.is_nan() || least < MASSLESS {
        return Err(NoReduction::Loose);
    }
    let l = k.cholesky().ok_or(NoReduction::Loose)?.l();
    let loose = || NoReduction::Loose;
    let half = l.solve_lower_triangular(&m).ok_or_else(loose)?;
    let g = l
        .solve_lower_triangular(&half.transpose())
        .ok_or_else(loose)?;
    let eigen = SymmetricEigen::new((&g + g.transpose()) * 0.5);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let most = eigen.eigenvalues[order[0]];
    order.retain(|&i| eigen.eigenvalues[i] > MASSLESS * most);
    if order.is_empty() || most.is_nan() || most <= 0.0 {
        return Err(NoReduction::Nothing);
    }
    let upper = l.transpose();
    let vectors = upper
        .solve_upper_triangular(&eigen.eigenvectors)
        .ok_or_else(loose)?;
    let mix = DMatrix::from_fn(n, order.len(), |i, j| vectors[(i, order[j])] * scale[i]);
    Ok((mix, n - order.len()))
}
