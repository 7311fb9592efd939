//! Functions of interest: quantities at an instant, and their reduction over a run to a number.

mod energy;
pub mod evaluate;
pub mod flight;
pub mod function;
pub mod histories;
pub mod instant;
mod interpolation;
pub mod linearised;
mod measure;
pub mod misfit;
mod multipliers;
pub mod peak;
pub mod quantity;
mod rate;
pub mod resolution;
pub mod rest;
pub mod samples;
pub mod scene;
pub mod seen;
pub mod series;
pub mod smoothed;
pub mod snapshot;
pub mod stations;
pub mod turning;
mod view;
pub mod window;
mod windowed;

pub use crate::math::soft_max::Bound;
pub use evaluate::between_samples;
pub use function::{Function, Reduction, Release};
pub use instant::{EnergyPart, Gate, GateSide, Instant, Projectile};
pub use multipliers::{JointMultipliers, Rows};
pub use quantity::{Operation, Quantity};
pub use scene::{Scene, TerminalEvent};
pub use turning::Rotation;
pub use window::{Edge, Reach, Window};
