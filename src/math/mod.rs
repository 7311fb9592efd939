//! Scalars, vectors, rotations and smooth maxima: mathematics without mechanics.

pub(crate) mod legendre;
pub(crate) mod parameters;
pub(crate) mod rotation;
pub(crate) mod scalar;
pub(crate) mod slices;
pub(crate) mod soft_max;

pub(crate) use parameters::{Parameters, parameters};
pub(crate) use scalar::{Complex64, Dual, Mat3, Scalar, Vec3};
