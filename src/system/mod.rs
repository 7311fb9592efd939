//! The mechanical system: what integrators assemble their equations from.
//!
//! States are positions q (per body r, p) and velocities v (per body ṙ in ground axes, ω in body
//! axes), with the kinematics q̇ = T(q) v, the dynamics M v̇ = f(q, v, t) − G(q)ᵀ λ and the
//! constraints Φ(q) = 0, G = Φ_q T. Small changes of position are taken in the tangent,
//! δq = T(q) δy, so the Euler parameters stay of unit length and need no multiplier.
//! Nothing here knows how time is discretised.

pub mod accelerations;
pub mod assembly;
pub mod bodies;
pub mod constraint;
pub mod emit_bodies;
pub mod failure;
pub mod in_motion;
pub mod initial;
pub mod joints;
pub mod kkt;
pub mod left_out;
pub mod loads;
pub mod marker;
pub mod nearest;
pub mod numbering;
pub mod observe;
pub mod placement;
pub mod planar;
mod planar_pull_back;
pub mod rank;
pub mod reaction;
pub mod reduce;
pub mod redundancy;
pub mod side;
pub mod tree;

pub use bodies::Motion;
pub use in_motion::InMotion;
pub use left_out::LeftOut;
pub use numbering::Numbering;
