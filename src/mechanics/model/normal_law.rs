//! The normal law of stops and contacts: its parameters.
//!
//! With the penetration δ and a smooth ramp ρ(δ) of width w, which is 0 below −w/2 and δ above w/2
//! (Hunt & Crossley 1975, with a smooth onset):
//!
//! ```text
//! N = k ρⁿ ρ' β(1 + ³⁄₂ c δ̇) ≥ 0,     V = k ρⁿ⁺¹ / (n + 1)
//! ```
//!
//! β is a ramp too, so N never pulls. The formulas and their derivatives are in `system::loads::normal_law`.

use crate::math::parameters;

/// Stiffness, dissipation and smoothing width of a stop or a contact.
#[derive(Clone, Debug)]
pub struct NormalLaw<S> {
    /// Exponent n ≥ 1.
    pub exponent: f64,
    /// Stiffness k \[N/mⁿ or N m/radⁿ\].
    pub stiffness: S,
    /// Dissipation c \[s/m or s/rad\]. The coefficient of restitution is about 1 − c v at small speeds v.
    pub dissipation: S,
    /// Width w of the onset \[m or rad\].
    pub width: S,
}

parameters!(struct NormalLaw { exponent; stiffness, dissipation, width });
