//! Energy as a witness: a motion that conserves it has to have kept it.
//!
//! Springs without damping, gravity and joints at rest conserve E = T + V. A step that errs by ε of the
//! scene's lengths L and speeds U changes it by about
//!
//! ```text
//! ε (X + K) + ε √(X S) + ε² S,      K = Σ (½ m U² + ½ tr J Ω²),      S = Σ ½ k L²,
//! ```
//!
//! with X the energy exchanged between bodies, gravity and springs. A run of N steps that is off by far
//! more than N times that, and by a thousandth of X + K, is not the motion of the scene.

use super::failure::IntegrationFailure;
use super::scale::Scale;
use super::settings::{Settings, Spacing};
use crate::math::Scalar;
use crate::model::Model;
use crate::model::load::LoadKind;
use crate::system::{BodyMotion, loads};

/// Part of the energy that no run by a tolerance may lose, however small its error.
const PART: f64 = 1e-3;
/// How much more than what follows from the errors of the steps.
const MARGIN: f64 = 100.0;
/// Round-off, relative to the energies.
const ROUND_OFF: f64 = 1e-10;

/// Energies of a run at a few instants: at the ends of steps 1, 2, 4, 8 … and of the last.
#[derive(Clone, Debug)]
pub(crate) struct Ledger {
    /// The tolerance, if steps follow one.
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
    /// Of each body's weight, and of all springs.
    potential: Vec<f64>,
}

impl Look {
    fn energy(&self) -> f64 {
        self.kinetic + self.potential.iter().sum::<f64>()
    }

    /// Sum of the sizes of all energies.
    fn size(&self) -> f64 {
        self.kinetic + self.potential.iter().map(|x| x.abs()).sum::<f64>()
    }
}

impl Ledger {
    /// A ledger for a run of `model`, if the model conserves energy and the steps follow a tolerance or did
    /// so when they were chosen. Accuracy by equal steps is the user's choice.
    pub(crate) fn open<S: Scalar>(
        model: &Model<S>,
        settings: &Settings,
        scale: &Scale,
    ) -> Option<Self> {
        let tolerance = match settings.spacing {
            Spacing::Steps(_) => return None,
            Spacing::Tolerance(tolerance) => Some(tolerance),
            Spacing::Frozen(_) => None,
        };
        // A complex run has the real part of one that was judged.
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
            | LoadKind::Torque { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Friction { .. } => 0.0,
        });
        Some(Self {
            tolerance,
            at_speed: bodies.sum(),
            stiff: springs.sum(),
            looks: Vec::new(),
        })
    }

    /// Whether the end of step k is looked at; zero is the start.
    pub(crate) fn is_due(k: usize) -> bool {
        k == 0 || k.is_power_of_two()
    }

    /// Enters the energies at `time`.
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
        self.looks.push(Look {
            time,
            kinetic,
            potential,
        });
    }

    /// Refuses a run of so many steps, each of at most the estimated error `step_error`, that has not kept
    /// its energy.
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
        // NaN is lost, too.
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
