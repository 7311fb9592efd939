//! The three-node shear-flexible beam, straight or curved, with von Karman's terms.
//!
//! ```text
//! ε = t·w,s + ½ (e2·w,s)² + ½ (e3·w,s)² + ½ (I_p/A) (t·θ,s)²
//! γ = w,s − θ × t − ½ (t·θ) θ,   κ = θ,s − ½ θ × θ,s
//! U = ½ ∫ [EA ε² + GA2 γ2² + GA3 γ3² + GJ κ1² + EI2 κ2² + EI3 κ3²] ds
//! ```
//!
//! with the components of γ along e2 and e3, and of κ along t, e2 and e3. θ is the vector of rotation R of a section:
//! γ and κ are those of Reissner (1973) and Simo (1985), w,s less the turned tangent R t − t and the vector of RᵀR,s, to
//! second order. So moments bend what is twisted and twist what is bent, beams buckle laterally, and any rotation of
//! a rigid body leaves κ zero. The products are left out where strains are linear. Wagner's term is the stretch of fibres
//! that a twist makes helices: an axial force N adds N I_p/A to the torsional stiffness (Wagner 1929).
//!
//! All strains are taken at two Gauss points, where those of a quadratic element are most exact: the
//! element does not lock, and its stiffness has the rank 12 that 18 unknowns less 6 rigid motions leave.

mod element;
mod energy;
mod frame;
mod line;
mod mass;
mod section;
mod strain;
mod torsion;

pub use element::{Beam, BeamMotion};
pub use energy::BeamStrain;
pub use section::{Section, SectionFault, SectionValues};

/// Nodes of a beam, at r = −1, 0, 1.
pub const BEAM_NODES: usize = 3;
