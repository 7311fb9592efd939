//! Inexact solutions with kept factors: FGMRES (Saad 1993) for the present matrix, with the factors of another
//! state on the right as preconditioner.
//!
//! The elimination takes the nodes of structures first, and frames, joints and references last. So kept factors
//! are the lagged Schur preconditioner of Kennedy & Boopathy (equations 23 and 24, with the product S_RS S_S⁻¹ S_SR),
//! and their transpose is that of equation 25:
//!
//! ```text
//! J = [R  S_RS; S_SR  S_S],   G = R − S_RS S_S⁻¹ S_SR
//! t = S_S⁻¹ b_S,   y_R = G⁻¹ (b_R − S_RS t),   y_S = S_S⁻¹ (b_S − S_SR y_R)
//! ```
//!
//! Factors turn with their bodies (see [`super::turned`]). No number depends on units: residuals are divided by R,
//! those of the transposed equations by C. With the sizes s of positions, which are the length L of the structures,
//! and 1 of angles,
//!
//! ```text
//! R = s (kinematics),   L² / s (dynamics),   Σ_j |J_ij| s_j (joints)
//! C = 1 / s (positions and velocities),      Σ_i |J_ij| / R_i (multipliers)
//! ```
//!
//! The stiffness is in no scale: a row divided by it would hide the inertia of slow motions.

use super::ggl::Equations;
use super::turned::Turned;
use crate::linalg::gmres::{Gmres, Reached};
use crate::linalg::{LAST, SolveScalar, SparseLu, SparseMatrix, System, is_last};
use crate::math::Scalar;
use crate::model::{Form, Model};
use crate::system::{Numbering, placement};
use std::mem::take;

/// New factors of plates cost as much as six products with the matrix and the preconditioner.
pub const PRODUCTS_OF_FACTORS: usize = 6;
/// Products of one solution; after them the factors are renewed.
const MOST: usize = 2 * PRODUCTS_OF_FACTORS;
/// The first forcing term of a step, and the largest one. Those from 0.5 to 1e-3 take as many products. At a third or
/// less, the safeguard of choice 2 is never active.
const FIRST: f64 = 0.1;
/// γ of choice 2 of Eisenstat & Walker (1996): the forcing term is γ times the square of the last decline.
const GAMMA: f64 = 0.9;
/// Safety factor of the last forcing term.
const SPARE: f64 = 0.5;
/// Solutions of the transposed equations that refine each other.
const CYCLES: usize = 4;

/// Kept factors, their turns, and the matrix that they precondition.
pub struct Kept<'k, 'm, S> {
    /// The factors.
    pub factors: &'k mut SparseLu<S>,
    /// Turns since they were made.
    pub turned: &'k Turned,
    /// The present matrix.
    pub matrix: &'k SparseMatrix<S>,
    /// The equations of both.
    pub equations: &'k Equations<'m, S>,
}

/// Scales and memory of solutions.
#[derive(Debug)]
pub struct Krylov<S> {
    gmres: Gmres<S>,
    /// Number of positions and velocities, and s of them.
    moving: usize,
    sizes: Vec<f64>,
    /// R and C, in the unknowns of the bodies.
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// The right side that is scaled, its solution, and a vector in velocity numbering.
    scaled: Vec<S>,
    found: Vec<S>,
    whole: Vec<S>,
    /// Solutions of transposed equations, and what is left of a right side.
    solutions: Vec<Vec<S>>,
    rest: Vec<S>,
    /// Size of the residual of the iteration before.
    before: Option<f64>,
    /// Products since the step began, or since new factors.
    pub products: usize,
}

impl<S: SolveScalar> Krylov<S> {
    /// Plans solutions of these equations.
    pub fn new(equations: &Equations<S>, numbering: &Numbering) -> Self {
        let order = equations.order();
        let (sizes, length) = sizes(equations.model(), numbering);
        let mut rows = [&sizes[..], &sizes[..]].concat();
        let mut columns: Vec<f64> = rows.iter().map(|size| 1.0 / size).collect();
        for (row, size) in rows[sizes.len()..].iter_mut().zip(&sizes) {
            *row = length * length / size;
        }
        rows.resize(order, 1.0);
        columns.resize(order, 1.0);
        Self {
            gmres: Gmres::new(),
            moving: 2 * sizes.len(),
            sizes: [&sizes[..], &sizes[..]].concat(),
            rows,
            columns,
            scaled: vec![S::zero(); order],
            found: vec![S::zero(); order],
            whole: vec![S::zero(); equations.length()],
            solutions: Vec::new(),
            rest: Vec::new(),
            before: None,
            products: 0,
        }
    }

    /// Sets the scales of a matrix.
    pub fn fit(&mut self, matrix: &SparseMatrix<S>) {
        self.products = 0;
        let (starts, places) = (matrix.pattern.column_starts(), matrix.pattern.rows());
        let moving = self.moving;
        self.rows[moving..].fill(0.0);
        for column in 0..moving {
            for slot in starts[column]..starts[column + 1] {
                if places[slot] >= moving {
                    self.rows[places[slot]] += matrix.values[slot].re().abs() * self.sizes[column];
                }
            }
        }
        // A row that is left out has its multiplier alone.
        for row in self.rows[moving..].iter_mut().filter(|row| **row == 0.0) {
            *row = 1.0;
        }
        for column in moving..self.columns.len() {
            let own = starts[column]..starts[column + 1];
            let parts = own.map(|slot| matrix.values[slot].re().abs() / self.rows[places[slot]]);
            self.columns[column] = parts.sum();
        }
    }

    /// Begins the iterations of a step.
    pub fn begin(&mut self) {
        self.before = None;
        self.products = 0;
    }

    /// The forcing term for a residual (Eisenstat & Walker 1996, choice 2), not below a part of `least`: a smaller
    /// one would change round-off alone (Kelley 1995, section 6.3).
    pub fn force(&mut self, equations: &Equations<S>, residual: &[S], least: f64) -> f64 {
        self.whole.copy_from_slice(residual);
        equations.compress(&mut self.whole);
        let parts = self.whole.iter().zip(&self.rows);
        let size = parts.map(|(x, r)| (x.re() / r).powi(2)).sum::<f64>().sqrt();
        let forcing = match self.before {
            None => FIRST,
            Some(before) => {
                let ratio: f64 = size / before;
                GAMMA * ratio * ratio
            }
        };
        let forcing = forcing.max(SPARE * least).min(FIRST);
        self.before = Some(size);
        forcing
    }

    /// Solves J u = b in place with a residual of `forcing` |b|; `b` is a residual in velocity numbering. Returns
    /// the number of products, and whether they sufficed.
    pub fn solve(&mut self, kept: &mut Kept<S>, b: &mut [S], forcing: f64) -> Reached {
        if b.iter().any(|x| !x.is_finite()) {
            b.fill(S::from(f64::NAN));
            return Reached {
                products: 0,
                solved: false,
            };
        }
        kept.equations.compress(b);
        let reached = self.within_space(System::Plain, kept, b, forcing);
        b[..self.found.len()].copy_from_slice(&self.found);
        kept.equations.expand(b);
        self.products += reached.products;
        reached
    }

    /// Solves Jᵀ x = b for several b in the unknowns of the bodies, in place, refined as with new factors. Returns the
    /// number of products, and whether they sufficed. If not, `b` is as before.
    pub fn solve_transposed(&mut self, kept: &mut Kept<S>, b: &mut [Vec<S>]) -> Reached {
        let n = self.found.len();
        let (mut solutions, mut rest) = (take(&mut self.solutions), take(&mut self.rest));
        solutions.resize_with(b.len(), || vec![S::zero(); n]);
        rest.resize(n, S::zero());
        let mut all = Reached {
            products: 0,
            solved: true,
        };
        for (b, x) in b.iter().zip(&mut solutions) {
            let cycles = self.refine(kept, b, x, &mut rest);
            all.products += cycles.products;
            all.solved = cycles.solved;
            if !all.solved {
                break;
            }
        }
        if all.solved {
            for (b, x) in b.iter_mut().zip(&solutions) {
                b[..n].copy_from_slice(x);
            }
        }
        (self.solutions, self.rest) = (solutions, rest);
        all
    }

    /// Solves Jᵀ x = b by spaces that refine each other. The next correction would be smaller than the last one by the
    /// same part.
    fn refine(&mut self, kept: &mut Kept<S>, b: &[S], x: &mut [S], rest: &mut [S]) -> Reached {
        let mut products = 0;
        x.fill(S::zero());
        rest.copy_from_slice(&b[..rest.len()]);
        for _ in 0..CYCLES {
            let reached = self.within_space(System::Transposed, kept, rest, LAST);
            products += reached.products;
            x.iter_mut().zip(&self.found).for_each(|(x, &d)| *x += d);
            let solved = reached.solved && is_last(x, &self.found);
            if solved || !reached.solved {
                return Reached { products, solved };
            }
            kept.matrix.multiply_transposed(x, rest);
            rest.iter_mut().zip(b).for_each(|(r, &b)| *r = b - *r);
        }
        Reached {
            products,
            solved: false,
        }
    }

    /// Sets `found` to a solution in the unknowns of the bodies, with a scaled residual of `tolerance`.
    fn within_space(
        &mut self,
        system: System,
        kept: &mut Kept<S>,
        b: &[S],
        tolerance: f64,
    ) -> Reached {
        let Kept {
            factors,
            turned,
            matrix,
            equations,
        } = kept;
        let scales = match system {
            System::Plain => &self.rows,
            System::Transposed => &self.columns,
        };
        for ((out, &b), &scale) in self.scaled.iter_mut().zip(b).zip(scales) {
            *out = b / scale;
        }
        let whole = &mut self.whole;
        let apply = |v: &[S], z: &mut [S], w: &mut [S]| {
            let n = z.len();
            for ((out, &v), &scale) in whole.iter_mut().zip(v).zip(scales) {
                *out = v * scale;
            }
            equations.expand(whole);
            turned.through(equations, whole, |x| match system {
                System::Plain => factors.solve(x),
                System::Transposed => factors.solve_transposed(x),
            });
            equations.compress(whole);
            z.copy_from_slice(&whole[..n]);
            match system {
                System::Plain => matrix.multiply_into(z, w),
                System::Transposed => matrix.multiply_transposed(z, w),
            }
            for (w, &scale) in w.iter_mut().zip(scales) {
                *w = *w / scale;
            }
        };
        let sides = (&self.scaled[..], &mut self.found[..]);
        self.gmres.solve(apply, sides, tolerance, MOST)
    }
}

/// Sizes of the unknowns of the bodies, and the length of structures.
fn sizes<S: Scalar>(model: &Model<S>, numbering: &Numbering) -> (Vec<f64>, f64) {
    let meshes = || {
        let bodies = model.flexible.iter();
        bodies.filter_map(|body| match &body.form {
            Form::Finite(own) => Some((body, &own.mesh)),
            Form::Modal(_) => None,
        })
    };
    let nodes = meshes().flat_map(|(_, mesh)| &mesh.nodes);
    let length = nodes.fold(0.0_f64, |most, node| most.max(node.amax()));
    let length = if length > 0.0 {
        length
    } else {
        placement::length_scale(model)
    };
    let mut sizes = vec![0.0; numbering.unknowns()];
    for body in 0..numbering.bodies() {
        let (at, mobility) = (numbering.unknown(body), numbering.mobility(body));
        let turns = at + mobility.translation.free();
        sizes[at..turns].fill(length);
        sizes[turns..at + mobility.unknowns()].fill(1.0);
    }
    // Of shells, coordinates that are no displacements are rotations of directors.
    for (body, mesh) in meshes() {
        let mut shifts = vec![false; mesh.coordinates];
        for coordinate in mesh.displacements.iter().flatten().flatten() {
            shifts[*coordinate] = true;
        }
        let places = body.places().zip(&shifts).filter(|(_, shifts)| !**shifts);
        for ((carrier, k), _) in places {
            sizes[numbering.unknown(carrier) + k] = 1.0;
        }
    }
    (sizes, length)
}
