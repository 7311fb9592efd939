//! The nine-node shell element MITC9 with von Karman's terms.

pub(crate) mod basis;
mod correction;
mod energy;
mod field;
pub(crate) mod frame;
mod mass;
mod matrix;
#[cfg(test)]
mod pairs;
mod strain;
mod stress;
mod tangent;
mod tying;

pub(crate) use basis::NODES;
pub(crate) use energy::{Motion, Shell, ShellCotangent};
pub(crate) use field::Field;
pub(crate) use mass::MassMoments;
pub(crate) use mass::SECOND;
pub(crate) use matrix::{ElementMatrix, MOST_UNKNOWNS, RotationAxes};
pub use strain::Terms;
pub(crate) use stress::{
    STRESS_POINTS, curvatures, membrane_strains, pull_stress_ratios_of, stress_ratios_of,
};
