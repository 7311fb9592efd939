//! The mechanical system, from which integrators assemble their equations.
//!
//! States are positions q (per body r, p) and velocities v (per body ṙ in ground axes, ω in body
//! axes). The kinematics are q̇ = T(q) v, the dynamics M v̇ = f(q, v, t) − G(q)ᵀ λ, the constraints
//! Φ(q) = 0 with G = Φ_q T. Small changes of position are in the tangent, δq = T(q) δy, so the
//! Euler parameters keep unit length and need no multiplier. This folder does not depend on the
//! discretisation of time.

pub mod accelerations;
pub mod angular_momentum;
pub mod assembly;
pub mod attachment;
pub mod blocks;
pub mod bodies;
pub mod constraint;
pub mod dead_points;
mod elastic;
pub mod emit_bodies;
pub mod equilibrium;
pub mod failure;
pub mod finite;
pub mod flexible;
pub mod flexing;
pub mod frame_motion;
pub mod in_motion;
pub mod initial;
pub mod joints;
pub mod kkt;
pub mod left_out;
pub mod loads;
mod loop_rows;
pub mod marker;
pub mod measures;
mod near;
pub mod nearest;
pub mod numbering;
pub mod observe;
mod pairs;
pub mod placement;
pub mod planar;
mod planar_pull_back;
pub mod rank;
pub mod reaction;
pub mod reduce;
pub mod reduction;
pub mod redundancy;
pub mod redundant_rows;
mod rounded;
pub mod rows;
pub mod side;
mod strains;
pub mod tree;
pub mod turns;
mod unit_rows;

pub use bodies::BodyMotion;
pub use in_motion::InMotion;
pub use numbering::Numbering;
pub use redundant_rows::RedundantRows;
