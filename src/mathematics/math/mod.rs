//! Scalars, vectors, rotations and smooth maxima: mathematics without mechanics.

pub mod lagrange;
pub mod legendre;
pub mod parameters;
pub mod rotation;
pub mod scalar;
pub mod slices;
pub mod soft_max;
pub mod unit;

pub use parameters::{Parameters, parameters};
pub use scalar::{Complex64, Dual, Mat3, Scalar, Vec3};
