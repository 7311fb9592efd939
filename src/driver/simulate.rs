//! A simulation and its observations.

use super::evaluate::Evaluated;
use super::flexible_limits::many_steps;
use super::integration::Integration;
use crate::functions::Scene;
use crate::integrate::{IntegrationFailure, Multipliers, Trajectory};
use crate::model::{Load, LoadKind};
use crate::problem::Problem;
use crate::system::Numbering;
use crate::system::observe::{Observation, Reaction, observe, reactions};
use crate::system::placement::guess;
use std::borrow::Cow;

/// A simulated design with its observations at every instant.
pub struct Simulation {
    /// The design, its scene and motion.
    pub at: Evaluated,
    /// The scene without lowering. Observations and reactions are those of this scene.
    pub written: Scene<f64>,
    /// The motion of all its bodies, if some were merged.
    expanded: Option<Trajectory<f64>>,
    /// Energy, momentum and drift at every instant.
    pub observations: Vec<Observation>,
    /// When it begins, if it is a phase of a motion that events divide; else zero \[s\].
    pub begin: f64,
    /// Why the method was chosen.
    pub reason: String,
    /// A warning about the method for this scene, if any.
    pub warning: Option<String>,
    /// Whether this design does not admit the lowering of the others.
    pub unlowered: bool,
}

/// Simulates the design `x` of `problem`.
///
/// # Errors
/// If the simulation fails.
pub fn simulate(problem: &Problem, x: &[f64]) -> Result<Simulation, IntegrationFailure> {
    of_design(problem, x, false)
}

/// As [`simulate`], with steps that also resolve the gradients of all functions.
///
/// # Errors
/// If the simulation fails.
pub fn simulate_for_gradients(
    problem: &Problem,
    x: &[f64],
) -> Result<Simulation, IntegrationFailure> {
    of_design(problem, x, true)
}

fn of_design(
    problem: &Problem,
    x: &[f64],
    gradients: bool,
) -> Result<Simulation, IntegrationFailure> {
    let mut integration = Integration::new(problem, &problem.scene(x), None, gradients);
    simulate_with(&mut integration, problem, x)
}

/// Simulates the design `x` of `problem` with the steps in use.
///
/// # Errors
/// If the simulation fails.
pub fn simulate_with(
    integration: &mut Integration,
    problem: &Problem,
    x: &[f64],
) -> Result<Simulation, IntegrationFailure> {
    let before = integration.unlowered;
    let (at, _) = Evaluated::with(integration, problem, x)?;
    let unlowered = integration.unlowered > before;
    let of_method = integration.warning(&at.scene, &at.run);
    let reason = integration.chosen().map_or("", |(_, reason)| reason).into();
    let of_sums = integration.unresolved_sums(problem, (&at.scene, &at.run));
    let own = Simulation::of(problem, at);
    let warnings = of_method.into_iter().chain(of_sums);
    let all: Vec<String> = warnings.chain(own.lost_energy()).collect();
    Ok(Simulation {
        reason,
        warning: (!all.is_empty()).then(|| all.join("; ")),
        unlowered,
        ..own
    })
}

/// A change of the energy that should stay is told above this part of what is exchanged.
const LOST: f64 = 0.01;

impl Simulation {
    /// A motion with its observations.
    pub(super) fn of(problem: &Problem, at: Evaluated) -> Self {
        let (written, run) = at.written(problem);
        let model = &written.model;
        let numbering = Numbering::new(model);
        let observations = (0..=run.last())
            .map(|k| observe(model, &numbering, (run.q(k), run.v(k)), run.time(k)))
            .collect();
        let expanded = match run {
            Cow::Owned(run) => Some(run),
            Cow::Borrowed(_) => None,
        };
        Self {
            written,
            expanded,
            observations,
            begin: problem.begin(&at.x),
            reason: String::new(),
            warning: None,
            unlowered: false,
            at,
        }
    }

    /// A warning of a motion with contacts whose energy should be conserved and is not, or should fall and rises.
    fn lost_energy(&self) -> Option<String> {
        let model = &self.at.scene.model;
        let touches = |load: &Load<f64>| matches!(load.kind, LoadKind::Contact(_));
        if !model.is_passive() || model.is_fed() || !model.loads.iter().any(touches) {
            return None;
        }
        let first = self.observations.first()?;
        let exchanged = self.observations.iter().map(|own| {
            let potential = (own.potential - first.potential).abs();
            own.kinetic.min(first.kinetic).max(potential)
        });
        let exchanged = exchanged.fold(0.0, f64::max);
        let (off, what) = match model.conserves_energy() {
            true => (self.energy_drift(), "be conserved, and changes"),
            false => (self.energy_gain(), "only fall, and rises"),
        };
        let kept = off <= LOST * exchanged;
        (!kept).then(|| {
            format!(
                "energy should {what} by {off:.3e} J, where {exchanged:.3e} J are exchanged: smaller steps or a smaller tolerance"
            )
        })
    }

    /// The motion of all bodies.
    pub fn motion(&self) -> &Trajectory<f64> {
        self.expanded.as_ref().unwrap_or(&self.at.run)
    }

    /// Time of instant k, from the start of the whole motion \[s\].
    pub fn time(&self, k: usize) -> f64 {
        self.begin + self.motion().time(k)
    }

    /// Kinetic energy before and after the event with which a phase begins \[J\]. The joints that close take what is
    /// missing: ½ (v⁻ − v⁺)ᵀ M (v⁻ − v⁺) if they rest.
    pub fn jump(&self, problem: &Problem) -> Option<[f64; 2]> {
        problem.last_event()?;
        let (model, run) = (&self.at.scene.model, &self.at.run);
        let (_, v) = guess(model);
        let before = observe(model, &run.numbering, (run.q(0), &v), 0.0);
        Some([before.kinetic, self.observations[0].kinetic])
    }

    /// Largest rise of the total energy above what it was before \[J\].
    fn energy_gain(&self) -> f64 {
        let (mut least, mut gain) = (f64::INFINITY, 0.0_f64);
        for own in &self.observations {
            let energy = own.kinetic + own.potential;
            least = least.min(energy);
            gain = gain.max(energy - least);
        }
        gain
    }

    /// Largest |E(t) − E(0)| of the total energy \[J\].
    pub fn energy_drift(&self) -> f64 {
        energy_drift(&self.observations)
    }

    /// Largest acceleration \[m/s²\] of a body's origin that is left at rest.
    pub fn unbalanced(&self) -> f64 {
        let (run, model) = (self.motion(), &self.written.model);
        let of_body = |six: &[f64]| six[..3].iter().map(|a| a * a).sum::<f64>().sqrt();
        let all = run.a(0).chunks_exact(6).enumerate();
        let seen = all.filter(|(body, _)| !model.is_internal(*body));
        seen.map(|(_, six)| of_body(six)).fold(0.0, f64::max)
    }

    /// Largest position and velocity constraint violations.
    pub fn constraint_drift(&self) -> (f64, f64) {
        constraint_drift(&self.observations)
    }

    /// Advice on the number of its steps, if elastic bodies vibrate in many.
    pub fn many_steps(&self, problem: &Problem) -> Option<String> {
        many_steps(problem, &self.at.scene.model, &self.at.run)
    }

    /// Joint reactions at instant k.
    pub fn reactions(&self, k: usize) -> Vec<Reaction> {
        let all = self.reactions_at(std::iter::once(k));
        all.into_iter().flatten().collect()
    }

    /// Joint reactions at the given instants.
    pub fn reactions_at(&self, instants: impl Iterator<Item = usize>) -> Vec<Vec<Reaction>> {
        let (model, run) = (&self.written.model, self.motion());
        let numbering = Numbering::new(model);
        let mut multipliers = Multipliers::new(model, &numbering, run);
        let at = |k| {
            let lambda = multipliers.at(k);
            reactions(model, &numbering, (run.q(k), &lambda), run.time(k))
        };
        instants.map(at).collect()
    }
}

/// Largest |E(t) − E(0)| of the total energy \[J\].
pub fn energy_drift(observations: &[Observation]) -> f64 {
    let total = |o: &Observation| o.kinetic + o.potential;
    let start = total(&observations[0]);
    let changes = observations.iter().map(|o| (total(o) - start).abs());
    changes.fold(0.0, f64::max)
}

/// Largest position and velocity constraint violations.
pub fn constraint_drift(observations: &[Observation]) -> (f64, f64) {
    observations.iter().fold((0.0, 0.0), |(p, v), o| {
        (p.max(o.position_drift), v.max(o.velocity_drift))
    })
}
