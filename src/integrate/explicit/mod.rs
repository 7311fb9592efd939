//! The explicit Runge–Kutta pair DOP853 with projection.
//!
//! ```text
//! q̇ = T(q) v,     v̇ = a(q, v)  of  M a + Gᵀλ = f,  G a = γ         12 stages per step
//! W (q* − q) + G(q*)ᵀ s = 0,  Φ(q*) = 0                            projection of positions
//! M (v* − v) + G(q*)ᵀ σ = 0,  G(q*) v* = 0                         projection of velocities
//! ```
//!
//! (Hairer & Wanner 1996, *Solving Ordinary Differential Equations II*, section VII.2.)

pub(crate) mod march;
pub(crate) mod record;
pub(crate) mod replayer;
pub(crate) mod step;
pub(crate) mod stiffness;
pub(crate) mod tableau;
pub(crate) mod tangent;
pub(crate) mod tape;

pub(crate) use record::{NodeView, StepView, add_rows};
pub(crate) use replayer::Replayer;
pub(crate) use step::Stepper;
pub(crate) use tape::Tape;
