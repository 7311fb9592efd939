//! Time integration: the equations that each method solves, and the march over the steps.

pub mod bdf;
pub mod failure;
pub mod ggl;
pub mod newton;
pub mod settings;
pub mod trajectory;

pub use bdf::simulate;
pub use failure::IntegrationFailure;
pub use settings::{Method, Settings};
pub use trajectory::{Trajectory, WorkCounts};
