//! Scalars, vectors, short lists, rotations and smooth maxima: mathematics without mechanics.

pub mod array_vec;
pub mod lagrange;
pub mod legendre;
pub mod packed;
pub mod parameters;
pub mod rotation;
pub mod scalar;
pub mod slices;
pub mod soft_max;
pub mod team;
pub mod unit;

pub use array_vec::ArrayVec;
pub use packed::Packed;
pub use parameters::{Parameters, parameters};
pub use scalar::{Complex64, Dual, Mat3, Scalar, Vec3};
pub use team::{Gather, Team};
