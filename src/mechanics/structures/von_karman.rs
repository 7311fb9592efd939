//! Static equilibrium with von Karman's strains: load steps, Newton's iteration and a line search.
//!
//! F(x) = t f for load factors t from 0 to 1. The tangent K_T = ∂F/∂x is positive definite on a
//! stable path, so the Newton step is a descent of the potential Π = U − t f·x, and the line search
//! is one on Π. Where K_T ceases to be definite the path is at a limit point (the direction φ that
//! goes soft does work with the load, φ·f ≠ 0) or at a bifurcation (φ·f = 0). A step that moves far
//! more than its tangent predicts has left the path, and is repeated in smaller ones.

use super::loads::Load;
use super::shell::Terms;
use super::statics::{Critical, StaticFailure, StaticProblem, most_moved};
use super::structure::Structure;
use crate::linalg::cholesky::NotPositiveDefinite;
use crate::math::Scalar;
use crate::math::slices::dot;

/// Settings of the load steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadSteps {
    /// The first step, as a part of the load.
    pub first: f64,
    /// The smallest step, and so the accuracy of the load that can be carried.
    pub smallest: f64,
    /// Largest number of iterations of a step.
    pub iterations: usize,
    /// Energy of the last Newton step, relative to the work of the load; the step is taken.
    pub tolerance: f64,
}

impl Default for LoadSteps {
    fn default() -> Self {
        Self {
            first: 0.25,
            smallest: 1e-4,
            iterations: 25,
            tolerance: 1e-18,
        }
    }
}

/// Counted work of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadWork {
    /// Load steps that were kept.
    pub steps: usize,
    /// Load steps that were repeated in smaller ones.
    pub repeated: usize,
    /// Tangents that were assembled and factorised.
    pub tangents: usize,
    /// Newton steps that the line search shortened.
    pub shortened: usize,
}

/// A state of equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Values of the unknowns.
    pub x: Vec<f64>,
    /// What it took.
    pub work: LoadWork,
}

/// A critical point is a limit point if φ·f relative to |φ| |f|, in the norms of the diagonal, is
/// above this.
const DOES_WORK: f64 = 1e-5;
/// A step has left the path if it moves farther than its tangent predicts by this factor.
const LEFT: f64 = 4.0;
/// Sufficient decrease of the potential (Armijo).
const DECREASE: f64 = 1e-4;

/// Why a load step was not kept.
enum Lost {
    /// The tangent is not definite there.
    Indefinite(NotPositiveDefinite),
    /// No convergence, or another path.
    Elsewhere,
}

impl StaticProblem {
    /// Equilibrium of a load case with von Karman's strains.
    ///
    /// # Errors
    /// [`StaticFailure::Critical`] if the load cannot be carried, [`StaticFailure::Mechanism`] if the
    /// unloaded structure can move, [`StaticFailure::UnknownSet`] if a load names no set of the mesh.
    pub fn solve_von_karman(
        &mut self,
        structure: &Structure<f64>,
        case: &[Load<f64>],
        steps: &LoadSteps,
    ) -> Result<Equilibrium, StaticFailure> {
        self.factorise(structure)?;
        let load = self.load_vector(structure, case)?;
        let mut work = LoadWork::default();
        let mut x = vec![0.0; self.unknowns()];
        let (mut t, mut step) = (0.0, steps.first.clamp(steps.smallest, 1.0));
        let mut soft = None;
        while t < 1.0 {
            let next = if t + 1.01 * step >= 1.0 {
                1.0
            } else {
                t + step
            };
            let before = work.tangents;
            match self.load_step(structure, &load, next, &x, steps, &mut work) {
                Ok(reached) => {
                    (x, t) = (reached, next);
                    work.steps += 1;
                    if work.tangents - before <= 6 {
                        step *= 1.5;
                    }
                    continue;
                }
                Err(Lost::Indefinite(failure)) => soft = Some(failure),
                Err(Lost::Elsewhere) => {}
            }
            work.repeated += 1;
            step = 0.5 * (next - t);
            if step < steps.smallest {
                return Err(self.critical(structure, &load, t, soft));
            }
        }
        Ok(Equilibrium { x, work })
    }

    /// Assembles and factorises the tangent at a state.
    pub fn factorise_at(
        &mut self,
        structure: &Structure<f64>,
        x: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        let configuration = self.assembly.configuration(structure);
        let motion = configuration.spread(x);
        self.assembly
            .tangent(&configuration, &motion, Terms::VON_KARMAN, &mut self.values);
        self.solver.factorise(&self.assembly.pattern, &self.values)
    }

    /// As [`StaticProblem::factorise_at`], with a failure that names what moves.
    pub fn factorise_for(
        &mut self,
        structure: &Structure<f64>,
        x: &[f64],
    ) -> Result<(), StaticFailure> {
        self.factorise_at(structure, x)
            .map_err(|failure| super::statics::mechanism(&self.assembly, structure, &failure))
    }

    fn potential(&self, structure: &Structure<f64>, load: &[f64], t: f64, x: &[f64]) -> f64 {
        let configuration = self.assembly.configuration(structure);
        let energy = configuration.strain_energy(&configuration.spread(x), Terms::VON_KARMAN);
        energy - t * dot(load, x)
    }

    /// The state at load factor t, from one at a smaller factor.
    fn load_step(
        &mut self,
        structure: &Structure<f64>,
        load: &[f64],
        t: f64,
        start: &[f64],
        steps: &LoadSteps,
        work: &mut LoadWork,
    ) -> Result<Vec<f64>, Lost> {
        let mut x = start.to_vec();
        let mut foretold = None;
        for _ in 0..steps.iterations {
            let force = self.internal_force(structure, &x, Terms::VON_KARMAN);
            let rest: Vec<f64> = load.iter().zip(&force).map(|(f, g)| t * f - g).collect();
            work.tangents += 1;
            self.factorise_at(structure, &x).map_err(Lost::Indefinite)?;
            let dx = self.solve_factorised(&rest);
            let energy = dot(&dx, &rest);
            let foretold = *foretold.get_or_insert_with(|| self.length(&dx));
            let moved =
                |s: f64| -> Vec<f64> { x.iter().zip(&dx).map(|(x, d)| x + s * d).collect() };
            let full = moved(1.0);
            let scale = (t * dot(load, &full)).abs();
            if energy <= steps.tolerance * scale {
                let way: Vec<f64> = full.iter().zip(start).map(|(a, b)| a - b).collect();
                let stays = self.length(&way) <= LEFT * foretold;
                return if stays {
                    Ok(full)
                } else {
                    Err(Lost::Elsewhere)
                };
            }
            // Near the end differences of the potential are rounding.
            if energy <= 1e-10 * scale {
                x = full;
                continue;
            }
            let here = self.potential(structure, load, t, &x);
            let mut s = 1.0;
            let mut trial = full;
            while self.potential(structure, load, t, &trial) > here - DECREASE * s * energy {
                s *= 0.5;
                if s < 1e-3 {
                    return Err(Lost::Elsewhere);
                }
                trial = moved(s);
            }
            work.shortened += usize::from(s < 1.0);
            x = trial;
        }
        Err(Lost::Elsewhere)
    }

    /// √(xᵀ diag(K) x) with the last tangent.
    fn length(&self, x: &[f64]) -> f64 {
        let pattern = &self.assembly.pattern;
        let diagonal = (0..x.len()).filter_map(|j| pattern.slot(j, j));
        let squares = diagonal.zip(x).map(|(at, x)| self.values[at].abs() * x * x);
        squares.sum::<f64>().sqrt()
    }

    /// The failure at the last load factor that was reached.
    fn critical(
        &self,
        structure: &Structure<f64>,
        load: &[f64],
        factor: f64,
        soft: Option<NotPositiveDefinite>,
    ) -> StaticFailure {
        let Some(NotPositiveDefinite { direction, .. }) = soft else {
            return StaticFailure::NoConvergence { factor };
        };
        let pattern = &self.assembly.pattern;
        let diagonal = (0..load.len()).filter_map(|j| pattern.slot(j, j));
        let squares = diagonal
            .zip(load)
            .map(|(at, f)| f * f / self.values[at].abs().max(f64::MIN_POSITIVE));
        let size = squares.sum::<f64>().sqrt() * self.length(&direction);
        // Metres and radians do not compare: the place is that of the largest displacement, if any.
        let mut displaced = vec![0.0; direction.len()];
        for at in &self.assembly.unknowns.nodes {
            for &unknown in at.displacements.iter().flatten() {
                displaced[unknown] = direction[unknown];
            }
        }
        let moves = displaced.iter().any(|&x| x != 0.0);
        let (node, dof) = most_moved(&self.assembly, if moves { &displaced } else { &direction });
        StaticFailure::Critical {
            kind: if dot(&direction, load).abs() > DOES_WORK * size {
                Critical::LimitPoint
            } else {
                Critical::Bifurcation
            },
            factor,
            node,
            place: structure.nodes[node].into(),
            dof,
        }
    }

    /// A state of equilibrium of a structure in any scalar, from that of its real parts: two Newton steps
    /// with the real tangent give it the exact infinitesimal part.
    ///
    /// # Errors
    /// [`StaticFailure`] if the state is not stable, or a load names no set of the mesh.
    pub fn lift_von_karman<S: Scalar>(
        &mut self,
        real: &Structure<f64>,
        structure: &Structure<S>,
        case: &[Load<S>],
        x: &[f64],
    ) -> Result<Vec<S>, StaticFailure> {
        self.factorise_at(real, x)
            .map_err(|failure| super::statics::mechanism(&self.assembly, real, &failure))?;
        let load = self.load_vector(structure, case)?;
        let mut x: Vec<S> = x.iter().map(|&x| S::from(x)).collect();
        for _ in 0..2 {
            let force = self.internal_force(structure, &x, Terms::VON_KARMAN);
            let rest: Vec<S> = load.iter().zip(&force).map(|(&f, &g)| f - g).collect();
            for (x, d) in x.iter_mut().zip(self.solve_factorised(&rest)) {
                *x += d;
            }
        }
        Ok(x)
    }
}
