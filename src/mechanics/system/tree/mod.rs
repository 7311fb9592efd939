//! The saddle-point system of a scene. Bodies and joints are eliminated leaves first, joints that
//! close loops last.
//!
//! ```text
//! M_b x_b + Σ_j G_jbᵀ λ_j = f_b          every body b
//! Σ_b G_jb x_b            = g_j          every joint j
//! ```
//!
//! In a spanning forest of the joints every body has at most one joint to its parent. Elimination
//! of a body b and then of this joint j modifies the parent p:
//!
//! ```text
//! S = G_jb M̂_b⁻¹ G_jbᵀ,    M̂_p += G_jpᵀ S⁻¹ G_jp,    f̂_p −= G_jpᵀ S⁻¹ (G_jb M̂_b⁻¹ f̂_b − g_j)
//! ```
//!
//! The articulated inertia M̂ only grows. If a light body carries heavy ones, its decomposition
//! loses as many digits as their masses differ; beyond five digits sparse LU replaces the tree. The
//! cost is linear in the number of bodies (Featherstone 1983, here in absolute coordinates). x_b
//! are the unknowns that the mobility of b admits. If no body and no joint has more than three, the
//! blocks have order three. Rows of joints outside the forest are eliminated after it (`loops`).

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

/// Largest number of unknowns of a body and of rows of a joint, in general and for small blocks.
const MOST: usize = 6;
const SMALL: usize = 3;

/// Planned elimination of a model.
#[derive(Clone)]
pub enum Tree<S> {
    /// Blocks of order three.
    Small(Elimination<S, SMALL>),
    /// Blocks of up to order six.
    Large(Elimination<S, MOST>),
}

/// Whether joints close loops.
pub fn closes_loops<S>(model: &Model<S>, numbering: &Numbering) -> bool {
    !links::forest(model, numbering).closing.is_empty()
}

impl<S: Scalar> Tree<S> {
    /// Plans the elimination; `None` if so many joints of `model` close loops that sparse LU costs
    /// less, a body is flexible, or joints are coupled.
    pub fn plan(model: &Model<S>, numbering: &Numbering) -> Option<Self> {
        if !model.flexible.is_empty() || model.is_coupled() {
            return None;
        }
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

    /// Summary of the elimination. A decomposition of order k counts k³/3 operations and a solution
    /// 2 k², with the sizes of the blocks.
    pub fn elimination(&self, numbering: &Numbering) -> kkt::EliminationSummary {
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

    /// Eliminates with the model's masses and inertias and the gradients of the rows; those of
    /// redundant rows must be zero.
    ///
    /// # Errors
    /// [`SingularMatrix`] with a velocity coordinate without inertia, or a dependent constraint
    /// (n_v + row).
    pub fn factorise(
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

    /// Solves in place for (u, λ) from (Bᵀ f, g), with the last factors.
    pub fn solve(&mut self, numbering: &Numbering, rhs: &mut [S]) {
        match self {
            Tree::Small(elimination) => elimination.solve(numbering, rhs),
            Tree::Large(elimination) => elimination.solve(numbering, rhs),
        }
    }
}
