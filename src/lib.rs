//! Design of flexible multibody systems by gradient.

pub mod functions;
pub mod integrate;
pub mod math;
pub mod model;
pub mod problem;
