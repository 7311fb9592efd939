//! Functions of interest: quantities at an instant, and their reduction over a run to a number.

mod energy;
pub(crate) mod evaluate;
pub(crate) mod flight;
pub(crate) mod function;
pub(crate) mod instant;
pub(crate) mod linearised;
mod measure;
mod multipliers;
pub(crate) mod peak;
pub(crate) mod resolution;
pub(crate) mod rest;
pub(crate) mod scene;
pub(crate) mod smoothed;
pub(crate) mod snapshot;
pub(crate) mod stations;
pub(crate) mod turning;

pub(crate) use crate::math::soft_max::Bound;
pub(crate) use evaluate::between_samples;
pub(crate) use function::{Function, Reduction, Release};
pub(crate) use instant::{EnergyPart, Gate, GateSide, Instant, Projectile};
pub(crate) use multipliers::{JointMultipliers, Rows};
pub(crate) use scene::{Scene, TerminalEvent};
pub(crate) use turning::Rotation;
