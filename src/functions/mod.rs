//! Functions of interest: what is measured at an instant, and how a run is reduced to a number.

pub mod evaluate;
pub mod flight;
pub mod function;
pub mod instant;
pub mod measure;
pub mod peak;
pub mod resolution;
pub mod rest;
pub mod scene;
pub mod turning;

pub use function::{Bound, Function, Reduction, Release};
pub use instant::{EnergyPart, Gate, Instant, Projectile, Side};
pub use scene::{Scene, Until};
pub use turning::Rotation;
