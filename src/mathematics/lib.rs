//! Mathematics of flexbody: scalars and their derivatives, and sparse linear algebra.

pub mod linalg;
pub mod math;
