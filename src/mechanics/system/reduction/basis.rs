//! The vectors of a reduced basis.

use super::loads::patterns;
use super::matrices::{Matrices, Tie};
use super::spaces::Spaces;
use crate::math::slices::{add_scaled, dot};
use crate::model::finite::FiniteElements;
use crate::structures::floating::PointMotion;
use crate::structures::modes::{Basis, Operator, PencilFailure, largest};
use std::f64::consts::TAU;

/// A static motion is no new one if less than this part of its energy is left.
const DEPENDENT: f64 = 1e-10;
/// Lowest vibrations, held and free, whose forces give static solutions.
const PATTERNS: usize = 4;
/// Parts of the deflection at which they are computed.
const LEVELS: [f64; 3] = [0.25, 0.5, 1.0];

/// Which fixed-interface modes are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeChoice {
    /// The lowest ones.
    Count(usize),
    /// All with frequencies up to this one \[Hz\].
    Below(f64),
}

/// Settings of a basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Fixed-interface modes.
    pub modes: ModeChoice,
    /// Whether companions are made.
    pub companions: bool,
    /// Largest deflection of the static solutions \[m\], were they linear; none if zero.
    pub deflection: f64,
    /// Amplitude, relative to the first, below which a companion or a static solution is left out.
    pub tolerance: f64,
}

/// A reduced basis.
#[derive(Clone, Debug)]
pub struct ReducedBasis {
    /// The vectors: values of the unknowns of the nodes. Each has the mass of the body.
    pub vectors: Vec<Vec<f64>>,
    /// Those that bend.
    pub bending: Vec<usize>,
    /// Boundary modes.
    pub boundary: usize,
    /// Vectors from solutions under spread loads.
    pub loaded: usize,
    /// Frequencies with the held points fixed \[Hz\].
    pub fixed: Vec<f64>,
    /// Companions.
    pub companions: usize,
    /// Vectors from static solutions.
    pub statics: usize,
    /// Frequencies of the vectors with the axes held \[Hz\].
    pub frequencies: Vec<f64>,
}

/// The fixed-interface flexibility: K⁻¹ less that of the boundary modes.
struct FixedInterface<'a, 'b> {
    matrices: &'a mut Matrices<'b>,
    /// Boundary modes, K-orthonormal.
    boundary: &'a [Vec<f64>],
}

impl Operator for FixedInterface<'_, '_> {
    fn order(&self) -> usize {
        self.matrices.linear.pattern.order()
    }

    fn mass(&self, x: &[f64], y: &mut [f64]) {
        let pencil = &self.matrices.linear;
        pencil.pattern.multiply(&pencil.mass, x, y);
    }

    fn solve(&mut self, b: &mut [f64]) {
        let n = self.order();
        for b in b.chunks_exact_mut(n.max(1)) {
            let parts: Vec<f64> = self.boundary.iter().map(|z| dot(z, b)).collect();
            self.matrices.linear.solve(b);
            for (z, part) in self.boundary.iter().zip(parts) {
                add_scaled(b, -part, z);
            }
        }
    }
}

/// Static motions under forces and moments at points, K-orthonormal.
fn boundary_modes(matrices: &mut Matrices, points: &[&PointMotion]) -> Vec<Vec<f64>> {
    let count = matrices.shells.mesh.coordinates;
    let mut modes: Vec<Vec<f64>> = Vec::new();
    for point in points {
        for motions in [&point.displacement, &point.rotation] {
            for k in 0..3 {
                let mut load = vec![0.0; count];
                for (&i, motion) in point.coordinates.iter().zip(motions) {
                    load[i] += motion[k];
                }
                let mut x = matrices.solve(&load);
                let before = dot(&x, &load);
                for _ in 0..2 {
                    let force = matrices.stiff(&x);
                    for mode in &modes {
                        add_scaled(&mut x, -dot(mode, &force), mode);
                    }
                }
                let after = dot(&matrices.stiff(&x), &x);
                if after > DEPENDENT * before && after > 0.0 {
                    let size = after.sqrt();
                    x.iter_mut().for_each(|x| *x /= size);
                    modes.push(x);
                }
            }
        }
    }
    modes
}

/// The lowest modes with the points held, and their frequencies \[Hz\].
fn fixed_modes(
    matrices: &mut Matrices,
    boundary: &[Vec<f64>],
    choice: ModeChoice,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let free = matrices.shells.mesh.coordinates - boundary.len();
    let mut count = match choice {
        ModeChoice::Count(count) => count.min(free),
        ModeChoice::Below(_) => free.min(8),
    };
    loop {
        if count == 0 {
            return (Vec::new(), Vec::new());
        }
        let mut operator = FixedInterface { matrices, boundary };
        let found = largest(&mut operator, &Basis::default(), count, 7);
        let exhausted = found.vectors.len() < count;
        let frequency = |x: &Vec<f64>| dot(&matrices.stiff(x), x).max(0.0).sqrt() / TAU;
        let mut all: Vec<(f64, Vec<f64>)> = found
            .vectors
            .into_iter()
            .map(|x| (frequency(&x), x))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let ModeChoice::Below(highest) = choice {
            let more = all.last().is_some_and(|last| last.0 <= highest);
            if more && !exhausted && count < free {
                count = (2 * count).min(free);
                continue;
            }
            all.retain(|mode| mode.0 <= highest);
        }
        let (frequencies, vectors) = all.into_iter().unzip();
        return (vectors, frequencies);
    }
}

/// A reduced basis of shells that are held at points, of which some edges are rigid, under loads with these forces on the
/// unknowns of the nodes.
///
/// # Errors
/// [`PencilFailure`]: the stiffness is singular with the axes held.
pub fn reduced_basis(
    shells: &FiniteElements<f64>,
    points: &[&PointMotion],
    ties: &[Tie],
    loads: &[Vec<f64>],
    request: &Request,
) -> Result<ReducedBasis, PencilFailure> {
    let mut matrices = Matrices::new(shells, ties)?;
    let matrices = &mut matrices;
    let boundary = boundary_modes(matrices, points);
    let (fixed, frequencies) = fixed_modes(matrices, &boundary, request.modes);
    let mut spaces = Spaces::of(shells);
    for x in boundary.iter().chain(&fixed) {
        spaces.add(matrices, x);
    }
    let held = spaces.count();
    for force in loads {
        let x = matrices.solve(force);
        spaces.add(matrices, &x);
    }
    let first = spaces.count();
    if request.deflection > 0.0 {
        let solutions = static_solutions(matrices, &spaces, request.deflection);
        spaces.add_principal(matrices, solutions, request.tolerance);
    }
    let second = spaces.count();
    if request.companions {
        let companions = companions(matrices, &mut spaces, request.tolerance);
        spaces.add_principal(matrices, companions, request.tolerance);
    }
    let third = spaces.count();
    let (mass, _) = shells.rigid();
    let (bending, mut all) = spaces.bending.vibrations(matrices);
    let (membrane, more) = spaces.membrane.vibrations(matrices);
    all.extend(more);
    let count = bending.vectors.len();
    let mut vectors = bending.vectors;
    vectors.extend(membrane.vectors);
    for x in vectors.iter_mut().flatten() {
        *x *= mass.sqrt();
    }
    Ok(ReducedBasis {
        vectors,
        bending: (0..count).collect(),
        boundary: boundary.len(),
        loaded: first - held,
        fixed: frequencies,
        statics: second - first,
        companions: third - second,
        frequencies: all.into_iter().map(|omega| omega / TAU).collect(),
    })
}

/// Static solutions under the forces of the lowest vibrations, the first of which reaches the deflection.
fn static_solutions(matrices: &mut Matrices, spaces: &Spaces, deflection: f64) -> Vec<Vec<f64>> {
    let (space, frequencies) = spaces.bending.clone().vibrations(matrices);
    let patterns = patterns(matrices, &space, &frequencies, PATTERNS);
    let flat = spaces.bends.is_some();
    let signs: &[f64] = if flat { &[1.0] } else { &[1.0, -1.0] };
    let mut out = Vec::new();
    // Deflections as under one load: as the squares of frequencies, inversely.
    let square = |x: &[f64]| dot(&matrices.stiff(x), x) / dot(&matrices.heavy(x), x);
    let squares: Vec<f64> = patterns.iter().map(|x| square(x)).collect();
    let lowest = squares.iter().copied().fold(f64::INFINITY, f64::min);
    for (pattern, square) in patterns.into_iter().zip(squares) {
        let deflection = deflection * lowest / square;
        let largest = largest_displacement(matrices, &pattern);
        let force = matrices.stiff(&pattern);
        for sign in signs {
            let (mut at, mut before) = (vec![0.0; pattern.len()], 0.0);
            for level in LEVELS {
                let size = sign * level * deflection / largest;
                let load: Vec<f64> = force.iter().map(|f| size * f).collect();
                let grown = if before == 0.0 { 1.0 } else { size / before };
                let start = at.iter().map(|x| x * grown).collect();
                let Some(found) = matrices.statics(&load, start) else {
                    break;
                };
                out.push(found.clone());
                (at, before) = (found, size);
            }
        }
    }
    out
}

/// The largest displacement of a node, or the mean one over the mass, as of a beam that twists.
fn largest_displacement(matrices: &Matrices, x: &[f64]) -> f64 {
    let nodes = matrices.shells.mesh.displacements.iter();
    let sizes = nodes.map(|of| {
        let squares = of.iter().flatten().map(|&i| x[i] * x[i]);
        squares.sum::<f64>().sqrt()
    });
    let (mass, _) = matrices.shells.rigid();
    let mean = (dot(&matrices.heavy(x), x) / mass).sqrt();
    sizes.fold(mean.max(f64::MIN_POSITIVE), f64::max)
}

/// ψ_ij of the bending vectors at amplitudes as under one load: as the squares of their frequencies, inversely.
fn companions(matrices: &mut Matrices, spaces: &mut Spaces, tolerance: f64) -> Vec<Vec<f64>> {
    let (space, frequencies) = std::mem::take(&mut spaces.bending).vibrations(matrices);
    let amplitude = |i: usize| (frequencies[0] / frequencies[i]).powi(2);
    let scaled = |i: usize| -> Vec<f64> {
        let size = 1.0 / largest_displacement(matrices, &space.vectors[i]);
        space.vectors[i].iter().map(|x| x * size).collect()
    };
    let all: Vec<Vec<f64>> = (0..space.vectors.len()).map(scaled).collect();
    let own: Vec<Vec<f64>> = all.iter().map(|x| matrices.quadratic(x)).collect();
    let mut out = Vec::new();
    for i in 0..all.len() {
        for j in i..all.len() {
            let size = amplitude(i) * amplitude(j);
            if size < 1e-2 * tolerance {
                continue;
            }
            let mut force = match i == j {
                true => own[i].clone(),
                false => {
                    let sum: Vec<f64> = all[i].iter().zip(&all[j]).map(|(x, y)| x + y).collect();
                    let mut force = matrices.quadratic(&sum);
                    add_scaled(&mut force, -1.0, &own[i]);
                    add_scaled(&mut force, -1.0, &own[j]);
                    force
                }
            };
            force.iter_mut().for_each(|f| *f *= size);
            out.push(matrices.solve(&force));
        }
    }
    spaces.bending = space;
    out
}
