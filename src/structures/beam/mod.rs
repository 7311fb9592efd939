//! The three-node shear-flexible beam, straight or curved, with von Karman's terms.
//!
//! ```text
//! ε = t·w,s + ½ (e2·w,s)² + ½ (e3·w,s)²,  γ2 = e2·w,s − e3·θ,  γ3 = e3·w,s + e2·θ
//! κ1 = t·θ,s,  κ2 = e2·θ,s,  κ3 = e3·θ,s
//! U = ½ ∫ [EA ε² + GA2 γ2² + GA3 γ3² + GJ κ1² + EI2 κ2² + EI3 κ3²] ds
//! ```
//!
//! All strains are taken at two Gauss points, where those of a quadratic element are most exact: the
//! element does not lock, and its stiffness has the rank 12 that 18 unknowns less 6 rigid motions leave.

mod element;
mod energy;
mod frame;
mod line;
mod mass;
mod section;
mod torsion;

pub(crate) use element::{Beam, BeamMotion};
pub(crate) use energy::BeamStrain;
pub use section::{Section, SectionFault, SectionValues};

/// Nodes of a beam, at r = −1, 0, 1.
pub(crate) const BEAM_NODES: usize = 3;
