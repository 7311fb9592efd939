//! Exact derivatives of eigenvalues, and a smooth function of the lowest frequencies.
//!
//! With xᵀ M x = 1 the derivative of a separate eigenvalue is dλ = xᵀ (dK − λ dM) x. Where eigenvalues
//! meet, single ones have no derivative; a symmetric function of them has, and it is the sum over any
//! basis of their space with the weights ∂J/∂λ_k.

use super::{ModalFailure, ModalProblem, Modes};
use crate::linalg::SolveScalar;
use crate::math::Scalar;
use crate::math::soft_max::SoftMax;
use crate::structures::assembly::add_energy_transpose;
use crate::structures::inertia::add_kinetic_energy_transpose;
use crate::structures::shell::Terms;
use crate::structures::state::NodalMotion;
use crate::structures::structure::Structure;

/// Largest e^{−ρ(f − f_1)} of the first mode that is left out.
pub const NEGLIGIBLE: f64 = 38.0;
/// Largest number of modes of an aggregate.
pub const MOST_MODES: usize = 160;
/// Relative distance below which an eigenvalue counts as repeated.
pub const REPEATED: f64 = 1e-6;

/// The aggregate of the lowest frequencies, its modes and its gradient.
#[derive(Clone, Debug)]
pub struct LowestFrequency {
    /// −(1/ρ) ln Σ e^{−ρ f_k}, not above the lowest frequency \[Hz\].
    pub value: f64,
    /// Its modes.
    pub modes: Modes,
    /// Derivatives by the structure.
    pub gradient: Structure<f64>,
}

/// Σ_k w_k dλ_k by the structure, for modes that `problem` has.
pub fn eigenvalue_gradient(
    problem: &ModalProblem,
    structure: &Structure<f64>,
    modes: &Modes,
    weights: &[f64],
) -> Structure<f64> {
    let configuration = problem.assembly.configuration(structure);
    let mut to = configuration.cotangent();
    for ((x, &lambda), &weight) in modes.vectors.iter().zip(&modes.eigenvalues).zip(weights) {
        if weight == 0.0 {
            continue;
        }
        // xᵀ dK x is twice the derivative of the strain energy, xᵀ dM x that of the kinetic energy.
        let motion = configuration.spread(x);
        let mut force = NodalMotion::zeros(structure.nodes.len());
        let mut part = configuration.cotangent();
        add_energy_transpose(
            &configuration,
            &motion,
            Terms::LINEAR,
            &mut force,
            &mut part,
        );
        add_kinetic_energy_transpose(&configuration, &motion, -lambda, &mut force, &mut part);
        let mut unused = vec![0.0; x.len()];
        configuration.add_spread_transpose(x, &force, &mut unused, &mut part.directors);
        to.add_scaled(&part, 2.0 * weight);
    }
    configuration.finish(to)
}

/// The gradient of one frequency \[Hz\] by the structure.
///
/// # Errors
/// [`ModalFailure::Repeated`] if it equals its neighbour, [`ModalFailure::TooMany`] if `modes` lacks a
/// neighbour that there is.
pub fn frequency_gradient(
    problem: &ModalProblem,
    structure: &Structure<f64>,
    modes: &Modes,
    index: usize,
) -> Result<Structure<f64>, ModalFailure> {
    let there = modes.eigenvalues.len();
    if index >= there || (index + 1 == there && !modes.all) {
        return Err(ModalFailure::TooMany {
            asked: index + 2,
            there,
        });
    }
    let lambda = &modes.eigenvalues;
    let near = |a: usize, b: usize| (lambda[b] - lambda[a]) / lambda[b];
    let neighbours = index.saturating_sub(1)..(index + 1).min(there - 1);
    let gap = neighbours.map(|k| near(k, k + 1)).fold(1.0, f64::min);
    if gap < REPEATED {
        let mode = index + 1;
        return Err(ModalFailure::Repeated { mode, gap });
    }
    let mut weights = vec![0.0; there];
    weights[index] = frequency_slope(lambda[index]);
    Ok(eigenvalue_gradient(problem, structure, modes, &weights))
}

/// df/dλ of f = √λ / 2π.
fn frequency_slope(lambda: f64) -> f64 {
    1.0 / (4.0 * std::f64::consts::PI * lambda.sqrt())
}

/// Stiffness and mass in the space of some modes, XᵀKX and XᵀMX, in any scalar, by columns. X stays: by
/// Rayleigh's principle the eigenvalues of the pair are exact to first order all the same. `structure` has
/// the same real parts.
pub fn reduced<S: Scalar>(
    problem: &ModalProblem,
    structure: &Structure<S>,
    modes: &Modes,
) -> [Vec<Vec<S>>; 2] {
    let configuration = problem.assembly.configuration(structure);
    let mut pair = [Vec::new(), Vec::new()];
    for x in &modes.vectors {
        let x: Vec<S> = x.iter().map(|&x| S::from(x)).collect();
        let motion = configuration.spread(&x);
        for (which, columns) in pair.iter_mut().enumerate() {
            let mut force = NodalMotion::zeros(structure.nodes.len());
            let to = &mut configuration.cotangent();
            if which == 0 {
                add_energy_transpose(&configuration, &motion, Terms::LINEAR, &mut force, to);
            } else {
                add_kinetic_energy_transpose(&configuration, &motion, S::one(), &mut force, to);
            }
            let mut product = vec![S::zero(); x.len()];
            configuration.add_spread_transpose(&x, &force, &mut product, &mut to.directors);
            let dot = |y: &Vec<f64>| {
                let pairs = y.iter().zip(&product);
                pairs.fold(S::zero(), |sum, (&y, &p)| sum + p * y)
            };
            columns.push(modes.vectors.iter().map(dot).collect());
        }
    }
    pair
}

/// −(1/ρ) ln Σ e^{−ρ f_k} of these frequencies \[Hz\], with ρ \[s\].
pub fn lowest_of(frequencies: &[f64], rho: f64) -> f64 {
    -soft_lowest(frequencies, rho).ks
}

/// The soft maximum of −f_k, with ρ \[s\].
pub fn soft_lowest<S: SolveScalar>(frequencies: &[S], rho: f64) -> SoftMax<S> {
    let negative: Vec<S> = frequencies.iter().map(|&f| -f).collect();
    SoftMax::new(&negative, |_| S::one(), rho)
}

/// −(1/ρ) ln Σ e^{−ρ f_k} over the elastic modes, with ρ \[s\] (Kreisselmeier & Steinhauser 1979). As many
/// modes are taken as have a weight above rounding, so nothing jumps where modes meet, swap or come in.
///
/// # Errors
/// [`ModalFailure`]; [`ModalFailure::RhoTooSmall`] if that takes too many modes.
pub fn lowest_frequency(
    problem: &mut ModalProblem,
    structure: &Structure<f64>,
    rho: f64,
) -> Result<LowestFrequency, ModalFailure> {
    let mut count = 6;
    let modes = loop {
        let modes = problem.solve_at_most(structure, count)?;
        let f = modes.frequencies();
        let reach = f.last().map_or(0.0, |last| rho * (last - f[0]));
        if modes.all || reach > NEGLIGIBLE {
            break modes;
        }
        if f.len() >= MOST_MODES {
            return Err(ModalFailure::RhoTooSmall {
                rho,
                most: MOST_MODES,
            });
        }
        // As if the frequencies were evenly spaced.
        let next = (f.len() as f64 * (1.2 * NEGLIGIBLE / reach.max(1e-3))).ceil();
        count = (next.min(2.0 * f.len() as f64 + 4.0) as usize).clamp(f.len() + 1, MOST_MODES);
    };
    let soft = soft_lowest(&modes.frequencies(), rho);
    let slopes = modes
        .eigenvalues
        .iter()
        .map(|&lambda| frequency_slope(lambda));
    let weights: Vec<f64> = soft
        .weights
        .iter()
        .zip(slopes)
        .map(|(w, s)| w * s)
        .collect();
    Ok(LowestFrequency {
        value: -soft.ks,
        gradient: eigenvalue_gradient(problem, structure, &modes, &weights),
        modes,
    })
}
