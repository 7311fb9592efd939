//! The integration, compiled once for each scalar.

use super::explicit::stiffness::Watch;
use super::{IntegrationFailure, Settings, Trajectory, simulate_watching};
use crate::linalg::SolveScalar;
use crate::math::Complex64;
use crate::model::Model;

/// Scalars in which a model can be integrated: `f64`, and `Complex64` for the complex step. Other crates
/// call these instances instead of compiling their own.
pub trait Integrated: SolveScalar {
    /// See [`simulate`](super::simulate). An explicit march with a tolerance watches for `watch`.
    ///
    /// # Errors
    /// As there.
    fn simulate(
        model: &Model<Self>,
        duration: Self,
        settings: &Settings,
        watch: Watch,
    ) -> Result<Trajectory<Self>, IntegrationFailure>;
}

macro_rules! integrated {
    ($scalar:ty) => {
        impl Integrated for $scalar {
            fn simulate(
                model: &Model<Self>,
                duration: Self,
                settings: &Settings,
                watch: Watch,
            ) -> Result<Trajectory<Self>, IntegrationFailure> {
                simulate_watching(model, duration, settings, watch)
            }
        }
    };
}
integrated!(f64);
integrated!(Complex64);
