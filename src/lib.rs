//! Design of flexible multibody systems by gradient.

pub mod adjoint;
pub mod functions;
pub mod integrate;
pub mod linalg;
pub mod math;
pub mod model;
pub mod optimiser;
pub mod problem;
pub mod report;
pub mod system;
