//! Design of flexible multibody systems by gradient.
pub mod optimiser;
