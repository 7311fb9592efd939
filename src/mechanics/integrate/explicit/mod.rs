//! The explicit Runge–Kutta pair DOP853 with projection.
//!
//! ```text
//! q̇ = T(q) v,     v̇ = a(q, v)  of  M a + Gᵀλ = f,  G a = γ         12 stages per step
//! W (q* − q) + G(q*)ᵀ s = 0,  Φ(q*) = 0                            projection of positions
//! M (v* − v) + G(q*)ᵀ σ = 0,  G(q*) v* = 0                         projection of velocities
//! ```
//!
//! (Hairer & Wanner 1996, *Solving Ordinary Differential Equations II*, section VII.2.)

pub mod march;
pub mod record;
pub mod replayer;
pub mod samples;
pub mod step;
pub mod stiffness;
pub mod tableau;
pub mod tangent;
pub mod tape;

pub use record::{NodeView, StepView, add_rows};
pub use replayer::Replayer;
pub use step::Stepper;
pub use tape::Tape;
