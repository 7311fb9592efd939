//! Linear static equilibrium of a structure under its load cases.
//!
//! F(x) = f, F the derivative of the strain energy, f that of the work of the loads. The iteration
//! is x ← x + K⁻¹ (f − F(x)), with K in real numbers and x in any scalar: one step after the real
//! part, the derivative of a complex or dual number has converged too.

use super::assembly::{Assembly, add_energy_transpose};
use super::loads::{Load, add_work_transpose};
use super::mesh::UnknownSet;
use super::shell::Terms;
use super::state::NodalMotion;
use super::structure::Structure;
use super::supports::{NodeUnknowns, Support};
use crate::linalg::cholesky::{NotPositiveDefinite, SparseCholesky};
use crate::math::Scalar;

/// Kind of the point at which the load cannot be carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Critical {
    /// The load has a maximum.
    LimitPoint,
    /// Another path branches off.
    Bifurcation,
}

impl std::fmt::Display for Critical {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::LimitPoint => "a limit point",
            Self::Bifurcation => "a bifurcation",
        })
    }
}

/// Why there is no static solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StaticFailure {
    /// A name that is no set of the mesh.
    #[error(transparent)]
    UnknownSet(#[from] UnknownSet),
    /// No unknown is left.
    #[error("the supports hold every node, so nothing can be deformed; leave nodes free")]
    Held,
    /// Part of the structure can move without strain.
    #[error(
        "the structure is a mechanism: {dof} of node {node} at ({:.4}, {:.4}, {:.4}) m moves \
         without resistance; support it, or join it to what is supported",
        place[0], place[1], place[2]
    )]
    Mechanism {
        /// The node that moves most.
        node: usize,
        /// Where it stands \[m\].
        place: [f64; 3],
        /// Which of its unknowns moves most.
        dof: &'static str,
    },
    /// The structure does not carry the whole load.
    #[error(
        "the structure carries {factor:.4} of the load and no more: at {kind} its tangent stiffness ceases \
         to be positive definite, and {dof} of node {node} at ({:.4}, {:.4}, {:.4}) m gives way; make \
         the load smaller, or the structure stiffer",
        place[0], place[1], place[2]
    )]
    Critical {
        /// What kind of point it is.
        kind: Critical,
        /// The part of the load that was reached.
        factor: f64,
        /// The node that moves most in the direction without stiffness.
        node: usize,
        /// Where it stands \[m\].
        place: [f64; 3],
        /// Which of its unknowns moves most.
        dof: &'static str,
    },
    /// The iteration does not converge although the tangent is definite.
    #[error(
        "no equilibrium was found beyond {factor:.4} of the load, though the structure is stable there"
    )]
    NoConvergence {
        /// The part of the load that was reached.
        factor: f64,
    },
}

/// A structure with supports, ready to be loaded: the analysis of its matrix is done.
pub struct StaticProblem {
    pub assembly: Assembly,
    pub(super) solver: SparseCholesky,
    pub(super) values: Vec<f64>,
}

impl StaticProblem {
    /// Analyses a structure with supports.
    ///
    /// # Errors
    /// [`StaticFailure::UnknownSet`] if a support names no set of the mesh, [`StaticFailure::Held`] if no node is free.
    pub fn new(
        structure: &Structure<f64>,
        supports: &[Support],
        node_unknowns: NodeUnknowns,
    ) -> Result<Self, StaticFailure> {
        let assembly = Assembly::new(structure, supports, node_unknowns)?;
        if assembly.unknowns.count == 0 {
            return Err(StaticFailure::Held);
        }
        Ok(Self {
            solver: SparseCholesky::new(&assembly.pattern),
            values: vec![0.0; assembly.pattern.entries()],
            assembly,
        })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.assembly.unknowns.count
    }

    /// Entries of the factor of the stiffness.
    pub fn factor_entries(&self) -> usize {
        self.solver.entries()
    }

    /// The motion of the nodes that a solution stands for.
    pub fn motion<S: Scalar>(&self, structure: &Structure<S>, x: &[S]) -> NodalMotion<S> {
        self.assembly.configuration(structure).spread(x)
    }

    /// Assembles and factorises the linear stiffness.
    ///
    /// # Errors
    /// [`StaticFailure::Mechanism`] if it is singular.
    pub fn factorise(&mut self, structure: &Structure<f64>) -> Result<(), StaticFailure> {
        self.assemble(structure);
        self.factorise_assembled(structure)
    }

    /// Assembles the linear stiffness.
    pub fn assemble(&mut self, structure: &Structure<f64>) {
        let configuration = self.assembly.configuration(structure);
        let rest = NodalMotion::zeros(structure.nodes.len());
        self.assembly
            .tangent(&configuration, &rest, Terms::LINEAR, &mut self.values);
    }

    /// Solves K x = b once with the factors, without refinement.
    pub fn solve_once(&mut self, b: &mut [f64]) {
        self.solver.solve(b);
    }

    /// Factorises the stiffness that was assembled last, that of `structure`.
    ///
    /// # Errors
    /// [`StaticFailure::Mechanism`] if it is singular.
    pub fn factorise_assembled(&mut self, structure: &Structure<f64>) -> Result<(), StaticFailure> {
        self.solver
            .factorise(&self.assembly.pattern, &self.values)
            .map_err(|failure| mechanism(&self.assembly, structure, &failure))
    }

    /// Solves K x = b with the factors, the infinitesimal part too.
    pub fn solve_factorised<S: Scalar>(&mut self, b: &[S]) -> Vec<S> {
        let real: Vec<f64> = b.iter().map(|b| b.re()).collect();
        let real = self.solve_refined(&real);
        if !S::INFINITESIMAL {
            return real.into_iter().map(S::from).collect();
        }
        let small: Vec<f64> = b.iter().map(|b| b.infinitesimal()).collect();
        let small = self.solve_refined(&small);
        real.into_iter()
            .zip(small)
            .map(|(x, dx)| S::from(x) + S::of_infinitesimal(dx))
            .collect()
    }

    /// Solves with two steps of iterative refinement: stiffnesses of thin shells are ill-conditioned.
    fn solve_refined(&mut self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.solver.solve(&mut x);
        let mut rest = vec![0.0; b.len()];
        for _ in 0..2 {
            let pattern = &self.assembly.pattern;
            pattern.exact_residual(&self.values, &x, b, &mut rest);
            self.solver.solve(&mut rest);
            for (x, d) in x.iter_mut().zip(&rest) {
                *x += d;
            }
        }
        x
    }

    /// The load vector of a case.
    pub fn load_vector<S: Scalar>(
        &self,
        structure: &Structure<S>,
        case: &[Load<S>],
    ) -> Result<Vec<S>, UnknownSet> {
        let configuration = self.assembly.configuration(structure);
        let mut force = NodalMotion::zeros(structure.nodes.len());
        let mut to = configuration.cotangent();
        let rest = force.clone();
        for load in case {
            let mut load_to = load.clone();
            add_work_transpose(
                &configuration,
                load,
                &rest,
                &mut force,
                &mut to,
                &mut load_to,
            )?;
        }
        let mut vector = vec![S::zero(); self.unknowns()];
        let rest = vec![S::zero(); self.unknowns()];
        configuration.add_spread_transpose(&rest, &force, &mut vector, &mut to.directors);
        Ok(vector)
    }

    /// The internal forces of a state.
    pub fn internal_force<S: Scalar>(
        &self,
        structure: &Structure<S>,
        x: &[S],
        terms: Terms,
    ) -> Vec<S> {
        let configuration = self.assembly.configuration(structure);
        let motion = configuration.spread(x);
        let mut force = NodalMotion::zeros(structure.nodes.len());
        let mut to = configuration.cotangent();
        add_energy_transpose(&configuration, &motion, terms, &mut force, &mut to);
        let mut vector = vec![S::zero(); x.len()];
        configuration.add_spread_transpose(x, &force, &mut vector, &mut to.directors);
        vector
    }

    /// Solves a load case of the structure that was factorised last, linearly. `structure` has the same
    /// real parts.
    ///
    /// # Errors
    /// [`UnknownSet`] if a load names no set of the mesh.
    pub fn solve_linear<S: Scalar>(
        &mut self,
        structure: &Structure<S>,
        case: &[Load<S>],
    ) -> Result<Vec<S>, UnknownSet> {
        let load = self.load_vector(structure, case)?;
        let mut x = self.solve_factorised(&load);
        // The first step adds the effect of the stiffness to the infinitesimal part, the second
        // refines it.
        for _ in 0..2 {
            let force = self.internal_force(structure, &x, Terms::LINEAR);
            let rest: Vec<S> = load.iter().zip(&force).map(|(&f, &g)| f - g).collect();
            for (x, d) in x.iter_mut().zip(self.solve_factorised(&rest)) {
                *x += d;
            }
        }
        Ok(x)
    }

    /// The solution of a structure with an infinitesimal part, from the solution `x` of its real part and the
    /// factors of the tangent there: x + K⁻¹ δ(f − F(x)). The tangent is the one that adjoints have, so both
    /// agree to the rounding of f and F.
    ///
    /// # Errors
    /// [`UnknownSet`] if a load names no set of the mesh.
    pub fn infinitesimal_solution<S: Scalar>(
        &mut self,
        structure: &Structure<S>,
        case: &[Load<S>],
        x: &[f64],
        terms: Terms,
    ) -> Result<Vec<S>, UnknownSet> {
        let load = self.load_vector(structure, case)?;
        let still: Vec<S> = x.iter().map(|&x| S::from(x)).collect();
        let force = self.internal_force(structure, &still, terms);
        let pairs = load.iter().zip(&force);
        let rest: Vec<f64> = pairs.map(|(&f, &g)| (f - g).infinitesimal()).collect();
        let change = self.solve_refined(&rest);
        let pairs = x.iter().zip(change);
        Ok(pairs
            .map(|(&x, d)| S::from(x) + S::of_infinitesimal(d))
            .collect())
    }
}

/// The part of the structure that moves without resistance.
pub fn mechanism(
    assembly: &Assembly,
    structure: &Structure<f64>,
    failure: &NotPositiveDefinite,
) -> StaticFailure {
    let (node, dof) = most_moved(assembly, &failure.direction);
    StaticFailure::Mechanism {
        node,
        place: structure.nodes[node].into(),
        dof,
    }
}

/// The node and the unknown that a direction moves most.
pub fn most_moved(assembly: &Assembly, x: &[f64]) -> (usize, &'static str) {
    const DISPLACEMENTS: [&str; 3] = ["displacement x", "displacement y", "displacement z"];
    let largest = (0..x.len())
        .max_by(|&a, &b| x[a].abs().total_cmp(&x[b].abs()))
        .unwrap_or(0);
    for (node, at) in assembly.unknowns.nodes.iter().enumerate() {
        let displacement = (0..3).find(|&k| at.displacements[k] == Some(largest));
        if let Some(k) = displacement {
            return (node, DISPLACEMENTS[k]);
        }
        if assembly.unknowns.rotations_of(node).contains(&largest) {
            return (node, "rotation");
        }
    }
    unreachable!("every unknown belongs to a node")
}
