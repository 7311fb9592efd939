//! Steps of an implicit method that resolve a tangent of the motion, too (see `integrate/implicit/tangent.rs`).

use super::Integration;
use crate::event::{self, Admit};
use crate::functions::Scene;
use crate::integrate::{
    IntegrationFailure, Limits, Method, Samples, Settings, Spacing, Trajectory, simulate,
};
use crate::integration::Refresh;
use crate::math::Complex64;

/// A motion of more steps than this moves, and its steps resolve its derivatives, too: of rigid scenes, and of flexible
/// ones, whose tangents cost more.
const FEW: [usize; 2] = [1000, 100];
/// Largest number of steps of a run for the tangent: so many for each step of the motion, and so many of a scene with one
/// unknown, fewer with the square of their number.
const PER_STEP: usize = 2;
const OF_ONE: f64 = 3e7;

/// Reason of steps that follow a tangent.
const RESOLVED: &str = "the gradients need smaller steps than the motion";

impl Integration {
    /// Whether steps in use that were chosen by `tolerance` have followed the error of the motion alone, although
    /// gradients will be requested.
    fn overlooks_tangent(&self) -> Option<(&Settings, f64)> {
        let (settings, _) = self.chosen.as_ref()?;
        match self.spacing {
            Spacing::Tolerance(tolerance)
                if self.gradients && self.derivatives && settings.method != Method::Dop853 =>
            {
                Some((settings, tolerance))
            }
            _ => None,
        }
    }

    /// Makes the steps that `run` has chosen anew resolve a tangent, too: they are those of a run of `tangent`, the scene
    /// with an infinitesimal change of the design, if these are more. A tangent that cannot be followed changes nothing.
    ///
    /// # Errors
    /// If the simulation by these steps fails.
    pub fn resolve_tangent(
        &mut self,
        scene: &mut Scene<f64>,
        run: Trajectory<f64>,
        tangent: impl FnOnce() -> Scene<Complex64>,
    ) -> Result<(Trajectory<f64>, Option<Refresh>), IntegrationFailure> {
        let Some((settings, tolerance)) = self.overlooks_tangent() else {
            return Ok((run, None));
        };
        if run.grid.steps() > FEW[usize::from(!scene.model.flexible.is_empty())] {
            return Ok((run, None));
        }
        let numbering = &run.numbering;
        let unknowns = 2 * (numbering.velocities() + numbering.constraints());
        let alone = OF_ONE / (unknowns as f64).powi(2);
        let by_tangent = Settings {
            spacing: Spacing::Tolerance(tolerance),
            samples: Samples::Uniform(1),
            memory: 0,
            limits: Limits {
                steps: Some(PER_STEP * run.grid.steps() + alone as usize),
                ..settings.limits.clone()
            },
            ..settings.clone()
        };
        let duration = Complex64::from(run.duration);
        let Ok(found) = simulate(&tangent().model, duration, &by_tangent) else {
            return Ok((run, None));
        };
        if found.grid.steps() <= run.grid.steps() {
            return Ok((run, None));
        }
        let settings = Settings {
            spacing: Spacing::Frozen(found.grid),
            ..settings.clone()
        };
        let finer = event::settle(scene, &settings, run.duration, Admit::Late)?;
        let (run, settings) = self.resolved(scene, finer, settings)?;
        let refresh = self.take_steps(settings, RESOLVED.into());
        Ok((self.keep(scene, run), Some(refresh)))
    }
}
