//! Reduced bases of bodies of shells.
//!
//! - Static motions of the points that joints and loads hold, and the lowest modes with these points held (Craig
//!   & Bampton 1968).
//! - Static solutions under the loads that are spread over the body: modes miss the stress beside a hole or an edge.
//! - Companions: bending stretches a shell. The membrane displacements that relieve the stretch of two bending
//!   vectors i and j are ψ_ij = −K⁻¹ f_ij, f_ij the part of the forces that is quadratic in both (static modal
//!   derivatives: Idelsohn & Cardona 1985). Without them bent shells lock.
//! - Static solutions with von Karman's strains under the forces of the lowest modes: thin shells bend otherwise
//!   where they are stretched.
//!
//! The vectors are those of one design, and no later design changes them.

mod basis;
mod loads;
mod locking;
mod matrices;
mod project;
mod spaces;
mod subspace;

pub use basis::{ModeChoice, ReducedBasis, Request, reduced_basis};
pub use locking::locked_part;
pub use matrices::Tie;
pub use project::{ProjectedShells, project};
