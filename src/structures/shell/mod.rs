//! The nine-node shell element MITC9 with von Karman's terms.

pub(crate) mod basis;
mod correction;
mod energy;
mod field;
mod frame;
mod mass;
mod matrix;
#[cfg(test)]
mod pairs;
mod strain;
mod stress;
mod tangent;
mod tying;

pub use basis::NODES;
pub use energy::{EnergyParts, Motion, Shell, ShellCotangent};
pub use field::Field;
pub(crate) use mass::SECOND;
pub use mass::{MassMoments, NodalMasses};
pub use matrix::{ElementMatrix, MOST_UNKNOWNS, RotationAxes};
pub use strain::Terms;
pub use stress::STRESS_POINTS;
