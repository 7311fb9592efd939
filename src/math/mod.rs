//! Scalars, vectors, rotations and smooth maxima: mathematics without mechanics.

pub mod rotation;
pub mod scalar;
pub mod soft_max;

pub use scalar::{Complex64, Dual, Mat3, Scalar, Vec3};
