//! The check of energy: a conservative motion must conserve it.
//!
//! Springs without damping, gravity and joints at rest conserve E = T + V. A step with the error ε
//! relative to the scene's lengths L and speeds U changes E by about
//!
//! ```text
//! ε (X + K) + ε √(X S) + ε² S,      K = Σ (½ m U² + ½ tr J Ω²),      S = Σ ½ k L²,
//! ```
//!
//! where X is the energy exchanged between bodies, gravity and springs. A run of N steps is wrong if
//! its energy changes by far more than N times that, and by a thousandth of X + K.

use super::failure::IntegrationFailure;
use super::scale::Scale;
use super::settings::{Settings, Spacing};
use crate::math::Scalar;
use crate::model::Model;
use crate::model::load::LoadKind;
use crate::system::{BodyMotion, flexible, loads};

/// Smallest change of energy that can reject a run, relative to X + K.
const PART: f64 = 1e-3;
/// Factor on the change that follows from the errors of the steps.
const MARGIN: f64 = 100.0;
/// Round-off relative to the energies.
const ROUND_OFF: f64 = 1e-10;

/// Energies of a run at the ends of steps 1, 2, 4, 8 … and of the last step.
#[derive(Clone, Debug)]
pub(crate) struct Ledger {
    /// The tolerance of adaptive steps.
    tolerance: Option<f64>,
    /// K and S \[J\].
    at_speed: f64,
    stiff: f64,
    looks: Vec<Look>,
}

/// Energies at an instant \[J\].
#[derive(Clone, Debug)]
struct Look {
    time: f64,
    kinetic: f64,
    /// Of the weight of each body, and of all springs.
    potential: Vec<f64>,
}

impl Look {
    fn energy(&self) -> f64 {
        self.kinetic + self.potential.iter().sum::<f64>()
    }

    /// Sum of the absolute values of all energies.
    fn size(&self) -> f64 {
        self.kinetic + self.potential.iter().map(|x| x.abs()).sum::<f64>()
    }
}

impl Ledger {
    /// A ledger for a run of `model`. `None` if the model does not conserve energy, or if the steps
    /// are equal: their accuracy is the user's choice. Frozen steps have followed a tolerance.
    pub(crate) fn open<S: Scalar>(
        model: &Model<S>,
        settings: &Settings,
        scale: &Scale,
    ) -> Option<Self> {
        let tolerance = match settings.spacing {
            Spacing::Steps(_) => return None,
            Spacing::Tolerance(tolerance) => Some(tolerance),
            Spacing::Frozen(_) if settings.spacing.is_equal() => return None,
            Spacing::Frozen(_) => None,
        };
        // A complex run has the real part of a run that was checked.
        if S::INFINITESIMAL || !settings.method.is_adaptive() || !model.conserves_energy() {
            return None;
        }
        let [speed, spin] = scale.floor;
        let bodies = model.bodies.iter().map(|body| {
            let turning = body.inertia.trace().re() * spin * spin;
            0.5 * (body.mass.re() * speed * speed + turning)
        });
        let springs = model.loads.iter().map(|load| match &load.kind {
            LoadKind::Spring {
                stiffness, cubic, ..
            } => {
                let square = scale.length * scale.length;
                0.5 * square * (stiffness.re().abs() + 0.5 * cubic.re().abs() * square)
            }
            LoadKind::TorsionSpring { stiffness, .. } => 0.5 * stiffness.re().abs(),
            LoadKind::Force { .. }
            | LoadKind::Distributed(_)
            | LoadKind::Torque { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Friction { .. } => 0.0,
        });
        let square = scale.length * scale.length;
        let elastic = model.flexible.iter().map(|body| {
            let diagonal = flexible::alone(body)
                .into_iter()
                .map(|[k, ..]| k.re().abs());
            0.5 * square * diagonal.sum::<f64>()
        });
        Some(Self {
            tolerance,
            at_speed: bodies.sum(),
            stiff: springs.sum::<f64>() + elastic.sum::<f64>(),
            looks: Vec::new(),
        })
    }

    /// Whether the end of step k is recorded; 0 is the start.
    pub(crate) fn is_due(k: usize) -> bool {
        k == 0 || k.is_power_of_two()
    }

    /// Records the energies at `time`.
    pub(crate) fn enter<S: Scalar>(
        &mut self,
        model: &Model<S>,
        motions: &[BodyMotion<S>],
        time: f64,
    ) {
        let (mut kinetic, mut potential) = (0.0, Vec::with_capacity(motions.len() + 1));
        for (body, motion) in model.bodies.iter().zip(motions) {
            let (mass, v, omega) = (body.mass, &motion.velocity, &motion.omega);
            let twice = mass * v.dot(v) + omega.dot(&(body.inertia * omega));
            kinetic += 0.5 * twice.re();
            potential.push(-(mass * model.gravity.dot(&motion.position)).re());
        }
        potential.push(loads::potential(model, motions).re());
        if !model.flexible.is_empty() {
            let held = flexible::held(model, motions);
            kinetic += held.kinetic.re();
            potential.push(held.potential.re());
        }
        self.looks.push(Look {
            time,
            kinetic,
            potential,
        });
    }

    /// Rejects a run of so many steps, with the largest estimated error `step_error`, that has not
    /// conserved its energy.
    ///
    /// # Errors
    /// [`IntegrationFailure::EnergyLost`].
    pub(crate) fn close(&self, steps: usize, step_error: f64) -> Result<(), IntegrationFailure> {
        let Some(start) = self.looks.first() else {
            return Ok(());
        };
        let (mut exchanged, mut size) = (0.0_f64, 0.0_f64);
        for look in &self.looks {
            let pairs = look.potential.iter().zip(&start.potential);
            let changed: f64 = pairs.map(|(now, then)| (now - then).abs()).sum();
            exchanged = exchanged.max(look.kinetic).max(changed);
            size = size.max(look.size());
        }
        let all = exchanged + self.at_speed;
        let error = self.tolerance.unwrap_or(0.0).max(step_error);
        let off = MARGIN * error * steps as f64;
        let slack = off * self.stiff.sqrt();
        let follows = off * all + slack * (2.0 * exchanged.sqrt() + slack);
        let allowed = follows.max(PART * all) + ROUND_OFF * size;
        let drift = |look: &Look| (look.energy() - start.energy()).abs();
        // NaN counts as a loss.
        let lost = self.looks.iter().find(|look| {
            let drift = drift(look);
            drift.is_nan() || drift > allowed
        });
        match lost {
            None => Ok(()),
            Some(look) => Err(IntegrationFailure::EnergyLost {
                time: look.time,
                drift: drift(look),
                exchanged,
            }),
        }
    }
}
