//! The shell elements MITC9 of nine nodes and MITC4 of four, with von Karman's terms.

pub mod basis;
mod correction;
mod energy;
mod field;
pub mod frame;
mod mass;
mod matrix;
#[cfg(test)]
mod pairs;
mod strain;
mod stress;
mod tangent;
mod tying;

pub use crate::model::shell_kind::{PerNode, ShellKind, ShellNodes};
pub use basis::NODES;
pub use energy::{Motion, Shell, ShellCotangent};
pub use field::Field;
pub use mass::MassMoments;
pub use mass::SECOND;
pub use matrix::{ElementMatrix, MOST_UNKNOWNS, RotationAxes};
pub use strain::Terms;
pub use stress::{
    STRESS_POINTS, curvatures, membrane_strains, pull_stress_ratios_of, stress_ratios_of,
};
