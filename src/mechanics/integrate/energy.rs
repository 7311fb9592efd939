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
//! its energy changes by far more than N times that, and by a thousandth of X + K; or by half of that, whatever the tolerance.
//!
//! Stiff springs and elastic bodies make S large: a displacement within the tolerance is then a
//! large energy. So after every explicit step, in scenes with loads too, the energy gained is
//! compared with what there was: it may not exceed half of the energy at the start, of that
//! released by gravity and of K, and twice what loads and drives have supplied. Energy above that
//! is no motion, whatever the tolerance: explicit steps at the border of stability feed fast
//! vibrations. Elastic bodies without loads and drives may gain a twentieth.

use super::failure::IntegrationFailure;
use super::scale::Scale;
use super::settings::{Settings, Spacing};
use crate::math::Scalar;
use crate::model::load::LoadKind;
use crate::model::{DegreeOfFreedom, ForceTable, Model, NormalLaw, RigidBody, Role};
use crate::system::{BodyMotion, flexible, loads};

/// Smallest change of energy that can reject a run, relative to X + K.
const PART: f64 = 1e-3;
/// Factor on the change that follows from the errors of the steps.
const MARGIN: f64 = 100.0;
/// Largest part that is allowed whatever the tolerance.
const MOST: f64 = 0.5;
/// Round-off relative to the energies.
const ROUND_OFF: f64 = 1e-10;

/// Part of the available energy that a run may gain by its errors, and factor on the supplied one,
/// whose power is known at the ends of steps only.
const GAINED: f64 = 0.5;
/// The same part of scenes with elastic bodies, where neither loads nor drives supply energy.
const GAINED_ELASTIC: f64 = 0.05;
const SUPPLIED: f64 = 2.0;

/// Energy of a motion and its sources, after every step of an explicit march.
#[derive(Clone, Debug)]
pub struct Supply {
    /// K of rigid bodies \[J\].
    at_speed: f64,
    start: Stock,
    /// Part of the available energy that may be gained.
    may_gain: f64,
    /// Largest energy that gravity and springs with a negative stiffness released \[J\].
    released: f64,
    /// Energy that loads and drives supplied or took, and their last power and its time.
    supplied: f64,
    power: f64,
    time: f64,
}

/// Energies at an instant \[J\]: kinetic, of springs, of elastic bodies, and of the weight of each
/// rigid body and of all elastic ones.
#[derive(Clone, Debug, Default)]
struct Stock {
    kinetic: f64,
    springs: f64,
    elastic: f64,
    weights: Vec<f64>,
}

impl Stock {
    /// At the start of a run.
    fn of<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>]) -> Self {
        let mut own = Self {
            springs: loads::potential(model, motions, S::zero()).re(),
            ..Self::default()
        };
        for (body, motion) in model.bodies.iter().zip(motions) {
            own.kinetic += kinetic(body, motion);
            own.weights.push(weight(model, body, motion));
        }
        if !model.flexible.is_empty() {
            let held = flexible::held(model, motions);
            own.kinetic += held.kinetic.re();
            own.elastic = elastic(model, motions);
            own.weights.push(held.potential.re() - own.elastic);
        }
        own
    }
}

fn kinetic<S: Scalar>(body: &RigidBody<S>, motion: &BodyMotion<S>) -> f64 {
    if body.role == Role::State {
        return 0.0;
    }
    let (v, omega) = (&motion.velocity, &motion.omega);
    0.5 * (body.mass * v.dot(v) + omega.dot(&(body.inertia * omega))).re()
}

/// The energy of the weight of a body.
fn weight<S: Scalar>(model: &Model<S>, body: &RigidBody<S>, motion: &BodyMotion<S>) -> f64 {
    match body.role.is_abstract() {
        true => 0.0,
        false => -(body.mass * model.gravity.dot(&motion.position)).re(),
    }
}

fn elastic<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>]) -> f64 {
    let bodies = model.flexible.iter();
    bodies
        .map(|body| flexible::strain_energy(body, motions).re())
        .sum()
}

/// Σ (½ m U² + ½ tr J Ω²) over the rigid bodies.
fn at_speed<S: Scalar>(model: &Model<S>, scale: &Scale) -> f64 {
    let [speed, spin] = scale.floor;
    let bodies = model.bodies.iter().filter(|body| !body.role.is_abstract());
    let bodies = bodies.map(|body| {
        let turning = body.inertia.trace().re() * spin * spin;
        0.5 * (body.mass.re() * speed * speed + turning)
    });
    bodies.sum()
}

impl Supply {
    /// For a run of `model` that starts in `motions`, where loads and drives have the power `power`
    /// \[W\]. `None` if the steps are equal: their accuracy is the user's choice.
    pub fn open<S: Scalar>(
        model: &Model<S>,
        settings: &Settings,
        scale: &Scale,
        (motions, power): (&[BodyMotion<S>], f64),
    ) -> Option<Self> {
        // A complex run has the real part of a run that was checked.
        if S::INFINITESIMAL || matches!(settings.spacing, Spacing::Steps(_)) {
            return None;
        }
        Some(Self {
            at_speed: at_speed(model, scale),
            start: Stock::of(model, motions),
            may_gain: match model.flexible.is_empty() || model.is_fed() {
                true => GAINED,
                false => GAINED_ELASTIC,
            },
            released: 0.0,
            supplied: 0.0,
            power,
            time: 0.0,
        })
    }

    /// Compares the energy at `time` with what there was; `power` is that of loads and drives.
    ///
    /// # Errors
    /// [`IntegrationFailure::EnergyGained`].
    pub fn look<S: Scalar>(
        &mut self,
        model: &Model<S>,
        (motions, power): (&[BodyMotion<S>], f64),
        (time, step): (f64, usize),
    ) -> Result<(), IntegrationFailure> {
        self.supplied += (time - self.time) * power.max(self.power);
        (self.power, self.time) = (power, time);
        let start = &self.start;
        let (mut now, mut weighs) = (0.0, 0.0);
        let mut size = 0.0;
        let mut fell = 0.0;
        let bodies = model.bodies.iter().zip(motions);
        for ((body, motion), then) in bodies.zip(&start.weights) {
            now += kinetic(body, motion);
            let weight = weight(model, body, motion);
            weighs += weight - then;
            fell += (weight - then).abs();
            size += weight.abs();
        }
        let springs = loads::potential(model, motions, time.into()).re();
        let mut strained = 0.0;
        if !model.flexible.is_empty() {
            let held = flexible::held(model, motions);
            strained = elastic(model, motions);
            now += held.kinetic.re();
            let weight = held.potential.re() - strained;
            let then = start.weights.last().copied().unwrap_or(0.0);
            weighs += weight - then;
            fell += (weight - then).abs();
            size += weight.abs();
        }
        size += now + springs.abs() + strained;
        self.released = self.released.max(fell + (start.springs - springs).max(0.0));
        let before = start.kinetic + start.elastic + start.springs.abs();
        let gained =
            now + springs + strained + weighs - (start.kinetic + start.springs + start.elastic);
        let available = before + self.released + self.at_speed;
        let most = self.may_gain * available + SUPPLIED * self.supplied + ROUND_OFF * size;
        // NaN counts as a gain.
        match gained <= most {
            true => Ok(()),
            false => Err(IntegrationFailure::EnergyGained {
                time,
                step,
                gained: if gained.is_nan() {
                    f64::INFINITY
                } else {
                    gained
                },
                available: available + self.supplied,
            }),
        }
    }
}

/// Energies of a run at the ends of steps 1, 2, 4, 8 … and of the last step.
#[derive(Clone, Debug)]
pub struct Ledger {
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
    pub fn open<S: Scalar>(model: &Model<S>, settings: &Settings, scale: &Scale) -> Option<Self> {
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
        let stored = |law: &NormalLaw<S>, depth: f64| {
            law.stiffness.re() * depth.powf(law.exponent + 1.0) / (law.exponent + 1.0)
        };
        let steepest = |tables: &[Option<ForceTable<S>>; 2]| {
            tables[0].as_ref().map_or(0.0, ForceTable::steepest)
        };
        let springs = model.loads.iter().map(|load| match &load.kind {
            LoadKind::Spring {
                stiffness,
                cubic,
                tables,
                ..
            } => {
                let square = scale.length * scale.length;
                let k = stiffness.re().abs() + steepest(tables);
                0.5 * square * (k + 0.5 * cubic.re().abs() * square)
            }
            LoadKind::TorsionSpring {
                stiffness,
                cubic,
                tables,
                ..
            } => 0.5 * (stiffness.re().abs() + steepest(tables) + 0.5 * cubic.re().abs()),
            LoadKind::Bushing { stiffness, .. } => {
                let size = |i: usize| if i < 3 { scale.length } else { 1.0 };
                let entries = stiffness.iter().enumerate();
                let entries = entries.map(|(i, k)| k.re().abs() * size(i / 6) * size(i % 6));
                0.5 * entries.sum::<f64>()
            }
            LoadKind::JointStop { dof, law, .. } => match dof {
                DegreeOfFreedom::Rotation => stored(law, 1.0),
                DegreeOfFreedom::Translation => stored(law, scale.length),
            },
            LoadKind::DistanceStop { law, .. } => stored(law, scale.length),
            LoadKind::Contact(own) => stored(&own.law, scale.length),
            LoadKind::Cable(own) => stored(&own.law, scale.length),
            LoadKind::Force { .. }
            | LoadKind::Distributed(_)
            | LoadKind::Controller(_)
            | LoadKind::Torque { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Friction { .. }
            | LoadKind::Drag { .. } => 0.0,
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
            at_speed: at_speed(model, scale),
            stiff: springs.sum::<f64>() + elastic.sum::<f64>(),
            looks: Vec::new(),
        })
    }

    /// Whether the end of step k is recorded; 0 is the start.
    pub fn is_due(k: usize) -> bool {
        k == 0 || k.is_power_of_two()
    }

    /// Records the energies at `time`.
    pub fn enter<S: Scalar>(&mut self, model: &Model<S>, motions: &[BodyMotion<S>], time: f64) {
        let (mut energy, mut potential) = (0.0, Vec::with_capacity(motions.len() + 1));
        for (body, motion) in model.bodies.iter().zip(motions) {
            energy += kinetic(body, motion);
            potential.push(weight(model, body, motion));
        }
        potential.push(loads::potential(model, motions, time.into()).re());
        if !model.flexible.is_empty() {
            let held = flexible::held(model, motions);
            energy += held.kinetic.re();
            potential.push(held.potential.re());
        }
        self.looks.push(Look {
            time,
            kinetic: energy,
            potential,
        });
    }

    /// Rejects a run of so many steps, with the largest estimated error `step_error`, that has not
    /// conserved its energy.
    ///
    /// # Errors
    /// [`IntegrationFailure::EnergyLost`].
    pub fn close(&self, steps: usize, step_error: f64) -> Result<(), IntegrationFailure> {
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
        let allowed = follows.max(PART * all).min(MOST * all) + ROUND_OFF * size;
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
