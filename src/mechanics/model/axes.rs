//! The axes in which a direction is fixed.

/// The axes in which the direction of a force or torque is fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Ground axes.
    Ground,
    /// Axes of the loaded body.
    Body,
}
