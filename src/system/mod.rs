//! The mechanical system, from which integrators assemble their equations.
//!
//! States are positions q (per body r, p) and velocities v (per body ṙ in ground axes, ω in body
//! axes). The kinematics are q̇ = T(q) v, the dynamics M v̇ = f(q, v, t) − G(q)ᵀ λ, the constraints
//! Φ(q) = 0 with G = Φ_q T. Small changes of position are in the tangent, δq = T(q) δy, so the
//! Euler parameters keep unit length and need no multiplier. This folder does not depend on the
//! discretisation of time.

pub(crate) mod accelerations;
pub(crate) mod angular_momentum;
pub(crate) mod assembly;
pub(crate) mod attachment;
pub(crate) mod blocks;
pub(crate) mod bodies;
pub(crate) mod constraint;
pub(crate) mod dead_points;
mod elastic;
pub(crate) mod emit_bodies;
pub(crate) mod equilibrium;
pub(crate) mod failure;
pub(crate) mod finite;
pub(crate) mod flexible;
pub(crate) mod flexing;
pub(crate) mod frame_motion;
pub(crate) mod in_motion;
pub(crate) mod initial;
pub(crate) mod joints;
pub(crate) mod kkt;
pub(crate) mod left_out;
pub(crate) mod loads;
mod loop_rows;
pub(crate) mod marker;
pub(crate) mod measures;
pub(crate) mod nearest;
pub(crate) mod numbering;
pub(crate) mod observe;
mod pairs;
pub(crate) mod placement;
pub(crate) mod planar;
mod planar_pull_back;
pub(crate) mod rank;
pub(crate) mod reaction;
pub(crate) mod reduce;
pub(crate) mod reduction;
pub(crate) mod redundancy;
pub(crate) mod redundant_rows;
mod rounded;
pub(crate) mod rows;
pub(crate) mod side;
mod strains;
pub(crate) mod tree;
pub(crate) mod turns;

pub(crate) use bodies::BodyMotion;
pub(crate) use in_motion::InMotion;
pub(crate) use numbering::Numbering;
pub(crate) use redundant_rows::RedundantRows;
