//! Natural frequencies and modes of a structure.
//!
//! K x = λ M x, f = √λ / 2π. The lowest eigenvalues are found by block Lanczos on (K + sM)⁻¹ M. The
//! negative pivots of K − μM count the eigenvalues below μ (Sylvester's law of inertia), so none is
//! missed. Rigid motions are known beforehand and left out; s > 0 only if there are some.

mod frequencies;
mod lanczos;
mod rigid;
mod search;

pub use frequencies::{
    LowestFrequency, MOST_MODES, NEGLIGIBLE, REPEATED, eigenvalue_gradient, frequency_gradient,
    lowest_frequency, reduced, soft_lowest,
};

pub use frequencies::lowest_of;
pub use lanczos::{Basis, Operator, largest};
pub use search::{Pencil, PencilFailure, dense_pencil};

use super::assembly::Assembly;
use super::shell::Terms;
use super::state::NodalMotion;
use super::statics::{StaticFailure, StaticProblem, mechanism, most_moved};
use super::structure::Structure;
use super::supports::{NodeUnknowns, Support};
use crate::math::slices::dot;

/// Why there are no modes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModalFailure {
    /// The stiffness has no factors.
    #[error(transparent)]
    Static(#[from] StaticFailure),
    /// Nothing has mass.
    #[error("the structure has no mass, so it has no natural frequencies; give a density")]
    NoMass,
    /// The structure has fewer modes than requested.
    #[error("{asked} modes are requested, and the structure has {there}")]
    TooMany {
        /// Requested number.
        asked: usize,
        /// Existing number.
        there: usize,
    },
    /// The iteration did not converge.
    #[error("the {asked} lowest modes did not converge; {found} were found")]
    NoConvergence {
        /// Requested number.
        asked: usize,
        /// Number found.
        found: usize,
    },
    /// A single frequency is requested that equals another one.
    #[error(
        "frequency {mode} has no derivative: it lies within {gap:.1e} of its neighbour, relatively; take \
         a smooth function of the lowest frequencies"
    )]
    Repeated {
        /// Its number, from 1.
        mode: usize,
        /// Relative distance of the eigenvalues.
        gap: f64,
    },
    /// No mode has the shape of one that is followed.
    #[error(
        "no mode has the shape that mode {mode} has at the start: the nearest agrees to {:.0} % (modal assurance)",
        100.0 * .assurance
    )]
    Unlike {
        /// Its number, from 1.
        mode: usize,
        /// The largest assurance.
        assurance: f64,
    },
    /// The aggregate would have too many modes.
    #[error(
        "the aggregate with rho = {rho:.3e} s takes in more than {most} modes; a larger rho takes in fewer"
    )]
    RhoTooSmall {
        /// Its sharpness \[s\].
        rho: f64,
        /// How many modes are allowed.
        most: usize,
    },
}

/// The least assurance of a mode that counts as one that is followed.
pub const LIKE: f64 = 0.5;
/// Modes beyond the wanted ones among which followed ones are sought.
pub const BEYOND: usize = 8;

/// Counted work of [`ModalProblem::solve`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ModalWork {
    /// Factorisations, with those that count.
    pub factorisations: usize,
    /// Right sides that were solved for.
    pub solves: usize,
}

/// The lowest modes of a structure, without rigid motions.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Number of rigid motions; their frequencies are zero.
    pub rigid: usize,
    /// Eigenvalues λ = (2πf)², ascending [1/s²].
    pub eigenvalues: Vec<f64>,
    /// Values of the unknowns in each mode; xᵀ M x = 1.
    pub vectors: Vec<Vec<f64>>,
    /// Whether these are all modes that there are.
    pub all: bool,
    /// Work of the solution.
    pub work: ModalWork,
}

impl Modes {
    /// Natural frequencies \[Hz\], ascending, without those of rigid motions.
    pub fn frequencies(&self) -> Vec<f64> {
        let all = self.eigenvalues.iter();
        all.map(|x| x.sqrt() / (2.0 * std::f64::consts::PI))
            .collect()
    }
}

/// A structure with supports, ready for its modes: the analysis of its matrices is done.
pub struct ModalProblem {
    pub(super) assembly: Assembly,
    pencil: Pencil,
}

impl ModalProblem {
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
            pencil: Pencil::new(assembly.pattern.clone()),
            assembly,
        })
    }

    /// The `count` lowest modes besides rigid motions, and those that form a cluster with the last.
    ///
    /// # Errors
    /// [`ModalFailure`] if the structure is a mechanism without being rigid, has no mass or fewer modes.
    pub fn solve(
        &mut self,
        structure: &Structure<f64>,
        count: usize,
    ) -> Result<Modes, ModalFailure> {
        let configuration = self.assembly.configuration(structure);
        let rest = NodalMotion::zeros(structure.nodes.len());
        let Pencil {
            stiffness, mass, ..
        } = &mut self.pencil;
        self.assembly
            .tangent(&configuration, &rest, Terms::LINEAR, stiffness);
        self.assembly.mass(&configuration, mass);
        let motions = rigid::rigid_motions(&configuration);
        let found = self.pencil.lowest(motions, count);
        found.map_err(|failure| match failure {
            PencilFailure::NotDefinite(failure) => {
                mechanism(&self.assembly, structure, &failure).into()
            }
            PencilFailure::NoMass => ModalFailure::NoMass,
            PencilFailure::TooMany { asked, there } => ModalFailure::TooMany { asked, there },
            PencilFailure::NoConvergence { asked, found } => {
                ModalFailure::NoConvergence { asked, found }
            }
        })
    }

    /// As [`ModalProblem::solve`], with all modes if there are fewer.
    ///
    /// # Errors
    /// [`ModalFailure`] as there.
    pub fn solve_at_most(
        &mut self,
        structure: &Structure<f64>,
        count: usize,
    ) -> Result<Modes, ModalFailure> {
        match self.solve(structure, count) {
            Err(ModalFailure::TooMany { there, .. }) if there > 0 => self.solve(structure, there),
            other => other,
        }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.assembly.unknowns.count
    }

    /// How like each of some modes of the latest solution is to another shape r, by its mass:
    /// MAC = (rᵀ M y)² / ((rᵀ M r) (yᵀ M y)), from 0 to 1 (Allemang & Brown 1982).
    pub fn assurances(&self, shape: &[f64], modes: &[Vec<f64>]) -> Vec<f64> {
        let heavy = |x: &[f64]| {
            let mut out = vec![0.0; x.len()];
            let Pencil { pattern, mass, .. } = &self.pencil;
            pattern.multiply(mass, x, &mut out);
            out
        };
        let heavy_shape = heavy(shape);
        let size = dot(shape, &heavy_shape);
        let assurance = |y: &Vec<f64>| {
            let own = dot(y, &heavy(y));
            dot(y, &heavy_shape).powi(2) / (size * own)
        };
        modes.iter().map(assurance).collect()
    }

    /// The motion of the nodes in a mode.
    pub fn motion(&self, structure: &Structure<f64>, mode: &[f64]) -> NodalMotion<f64> {
        self.assembly.configuration(structure).spread(mode)
    }
}

/// A rigid motion that the supports leave to a part of a structure, as the node that moves most in it.
pub fn loose_part(problem: &StaticProblem, structure: &Structure<f64>) -> Option<StaticFailure> {
    let motions = rigid::rigid_motions(&problem.assembly.configuration(structure));
    let (node, dof) = most_moved(&problem.assembly, motions.first()?);
    Some(StaticFailure::Mechanism {
        node,
        place: structure.nodes[node].into(),
        dof,
    })
}
