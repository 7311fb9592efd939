//! The saddle-point system of a scene: bodies and joints eliminated leaf by leaf, what closes loops
//! last.
//!
//! ```text
//! M_b x_b + Σ_j G_jbᵀ λ_j = f_b          every body b
//! Σ_b G_jb x_b            = g_j          every joint j
//! ```
//!
//! In a spanning forest of the joints every body hangs from at most one. Eliminating a body b, then
//! its joint j, leaves on the parent p
//!
//! ```text
//! S = G_jb M̂_b⁻¹ G_jbᵀ,     M̂_p += G_jpᵀ S⁻¹ G_jp,     f̂_p −= G_jpᵀ S⁻¹ (G_jb M̂_b⁻¹ f̂_b − g_j)
//! ```
//!
//! The articulated inertia M̂ only grows. Its decomposition cancels where a light body carries heavy
//! ones, by as many digits as their masses differ; beyond five the tree gives way to sparse LU.
//! The cost is linear in the number of bodies (Featherstone 1983, here in absolute coordinates).
//! x_b are the unknowns that the mobility of b leaves it; where no body and no joint has more than
//! three, the blocks are of order three. The rows of the joints that are not in the forest are
//! eliminated after it (`loops`).

mod blocks;
mod dense;
mod elimination;
mod envelope;
mod links;
mod loops;

use super::constraint::RowGradient;
use super::kkt;
use super::numbering::Numbering;
use super::redundant_rows::RedundantRows;
use crate::linalg::SingularMatrix;
use crate::math::Scalar;
use crate::model::Model;
use elimination::Elimination;

/// Most unknowns of a body and most rows of a joint; and where both are small.
const MOST: usize = 6;
const SMALL: usize = 3;

/// Planned elimination of a model.
#[derive(Clone)]
pub(crate) enum Tree<S> {
    /// Blocks of order three.
    Small(Elimination<S, SMALL>),
    /// Blocks of up to order six.
    Large(Elimination<S, MOST>),
}

impl<S: Scalar> Tree<S> {
    /// Plans the elimination, or `None` if so many joints of `model` close loops that sparse LU
    /// serves better.
    pub(crate) fn plan(model: &Model<S>, numbering: &Numbering) -> Option<Self> {
        let forest = links::forest(model, numbering);
        let small = forest
            .links
            .iter()
            .all(|link| numbering.unknowns_of(link.body) <= SMALL)
            && (0..numbering.joints()).all(|joint| numbering.rows(joint).len() <= SMALL);
        Some(match small {
            true => Tree::Small(Elimination::plan(model, numbering, forest)?),
            false => Tree::Large(Elimination::plan(model, numbering, forest)?),
        })
    }

    /// Whether joints close loops.
    pub(crate) fn closes_loops(&self) -> bool {
        match self {
            Tree::Small(elimination) => elimination.loops.is_some(),
            Tree::Large(elimination) => elimination.loops.is_some(),
        }
    }

    /// How the matrix is eliminated. Operations are those of blocks of the sizes at hand: a
    /// decomposition of order k takes k³/3, a solution 2 k², a product of all rows what its
    /// factors say.
    pub(crate) fn elimination(&self, numbering: &Numbering) -> kkt::EliminationSummary {
        let (links, closing, more) = match self {
            Tree::Small(elimination) => elimination.parts(numbering),
            Tree::Large(elimination) => elimination.parts(numbering),
        };
        let operations = |link: &links::Link| {
            let m = numbering.unknowns_of(link.body);
            let Some((joint, _, parent)) = link.joint else {
                return m.pow(3) / 3;
            };
            let n = numbering.rows(joint).len();
            let p = parent.map_or(0, |parent| numbering.unknowns_of(parent));
            m.pow(3) / 3 + n * 2 * m * m + n * n * m + n.pow(3) / 3 + n * n * p + n * p * p
        };
        kkt::EliminationSummary {
            order: numbering.unknowns() + numbering.constraints(),
            bodies: Some(links.iter().map(|link| link.body).collect()),
            closing,
            fill: None,
            operations: links.iter().map(operations).sum::<usize>() + more,
        }
    }

    /// Eliminates with the given masses and inertias (the model's) and gradients of the rows, zero
    /// those of rows that are left out.
    ///
    /// # Errors
    /// [`SingularMatrix`] with a velocity coordinate that has no inertia or a constraint
    /// (n_v + row) that follows from the others.
    pub(crate) fn factorise(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        rows: (&[RowGradient<S>], &RedundantRows),
    ) -> Result<(), SingularMatrix> {
        match self {
            Tree::Small(elimination) => elimination.factorise(model, numbering, rows),
            Tree::Large(elimination) => elimination.factorise(model, numbering, rows),
        }
    }

    /// Solves in place for (u, λ) given (Bᵀ f, g), with the factors made last.
    pub(crate) fn solve(&mut self, numbering: &Numbering, rhs: &mut [S]) {
        match self {
            Tree::Small(elimination) => elimination.solve(numbering, rhs),
            Tree::Large(elimination) => elimination.solve(numbering, rhs),
        }
    }
}
