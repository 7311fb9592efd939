//! A simulated motion: states, energies, reactions and histories, and the pull-back of functions of
//! histories to the design.

use super::SimulationError;
use crate::adjoint::WeightedHistories;
use crate::driver::integration::Integration;
use crate::driver::{AnalysisFailure, Evaluated, resolved};
use crate::figures::elastic_figures::stresses;
use crate::functions::Scene;
use crate::functions::histories::{Readings, history};
use crate::functions::snapshot::Snapshot;
use crate::integrate::{Multipliers, Trajectory, WorkCounts};
use crate::model::{Form, Model};
use crate::problem::Problem;
use crate::system::Numbering;
use crate::system::observe::{Observation, observe, reactions};
use std::sync::{Arc, OnceLock};

/// Instants may lie outside of a motion by this part of its duration, which is round-off.
const ROUND_OFF: f64 = 1e-12;

/// Simulates the design `x`: one number per variable, in the units of the problem file.
///
/// # Errors
/// The joints cannot be closed, the motion cannot be integrated to its end, or the problem is one of
/// structures without a motion.
pub fn simulate(problem: &Problem, x: &[f64]) -> Result<Motion, SimulationError> {
    if problem.statics.is_some() {
        return Err(AnalysisFailure::NoMotion.into());
    }
    let mut integration = Integration::of(problem, None, false);
    let found = Evaluated::with(&mut integration, problem, x);
    let (evaluated, _) = found.map_err(AnalysisFailure::from)?;
    Ok(Motion::new(Arc::new(problem.clone()), evaluated))
}

fn is_inside(fraction: f64) -> bool {
    (-ROUND_OFF..=1.0 + ROUND_OFF).contains(&fraction)
}

/// The motion of a design at some instants.
pub struct Motion {
    problem: Arc<Problem>,
    at: Evaluated,
    /// The instants as fractions of the duration, and as sums of samples.
    fractions: Vec<f64>,
    readings: Readings,
    /// Whether the instants keep their time where the duration changes; else they keep their fraction of it.
    are_fixed: bool,
    whole: OnceLock<Whole>,
}

/// The scene as it is written, and the motion of all its bodies if some were merged or left out.
struct Whole {
    scene: Scene<f64>,
    motion: Option<(Trajectory<f64>, Readings)>,
    observations: OnceLock<Vec<Observation>>,
}

/// Position and velocity of a body at one instant, in ground axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass \[m\].
    pub position: [f64; 3],
    /// Euler parameters of the rotation from body axes to ground axes; the real part comes first.
    pub orientation: [f64; 4],
    /// Velocity of the centre of mass \[m/s\].
    pub velocity: [f64; 3],
    /// Angular velocity \[rad/s\].
    pub angular_velocity: [f64; 3],
}

/// Energies, momenta and drift of the constraints at every instant.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    /// Kinetic energy \[J\].
    pub kinetic: Vec<f64>,
    /// Potential energy of gravity, springs and strains \[J\].
    pub potential: Vec<f64>,
    /// Linear momentum, ground axes \[kg m/s\].
    pub momentum: Vec<[f64; 3]>,
    /// Angular momentum about the origin, ground axes \[kg m²/s\].
    pub angular_momentum: Vec<[f64; 3]>,
}

/// Force and torque of a joint on its first body (that is not ground), at the joint's point, in ground
/// axes, at every instant.
#[derive(Clone, Debug, Default)]
pub struct Reactions {
    /// Force \[N\].
    pub force: Vec<[f64; 3]>,
    /// Torque about the joint's point \[N m\].
    pub torque: Vec<[f64; 3]>,
}

/// Elastic coordinates of a flexible body and their rates, one row per instant.
#[derive(Clone, Debug, Default)]
pub struct ElasticStates {
    /// Coordinates.
    pub coordinates: Vec<Vec<f64>>,
    /// Rates \[1/s\].
    pub rates: Vec<Vec<f64>>,
}

/// Derivatives of a function of histories by the histories: weights at each instant of
/// [`Motion::times`].
#[derive(Clone, Debug, Default)]
pub struct Cotangents {
    /// Pairs of a function with a history, and the weights of its quantity.
    pub functions: Vec<(usize, Vec<f64>)>,
    /// Weights of the instants themselves; empty for none. They move only where the duration depends on
    /// the design.
    pub times: Vec<f64>,
}

impl Motion {
    /// A motion at the instants of tables and figures.
    pub(super) fn new(problem: Arc<Problem>, at: Evaluated) -> Self {
        let run = &at.run;
        let shown = run.shown().into_iter().map(|k| run.instants[k]);
        Self {
            fractions: shown.collect(),
            readings: Readings::shown(run),
            are_fixed: false,
            problem,
            at,
            whole: OnceLock::new(),
        }
    }

    /// The same motion at these instants \[s\]. They are fixed: where the duration depends on the design,
    /// derivatives are those at these times.
    ///
    /// # Errors
    /// An instant is not between 0 and the end.
    pub fn at_times(self, times: &[f64]) -> Result<Self, String> {
        let end = self.at.run.duration;
        let fractions: Vec<f64> = times.iter().map(|time| time / end).collect();
        let wrong = times.iter().zip(&fractions);
        match wrong.into_iter().find(|(_, part)| !is_inside(**part)) {
            None => Ok(self.read(fractions, true)),
            Some((time, _)) => Err(format!(
                "found the instant {time} s, expected one between 0 and the end of the motion, {end} s"
            )),
        }
    }

    /// The same motion at instants at these fractions of the duration, which they keep where it depends on the design.
    ///
    /// # Errors
    /// A fraction is not between 0 and 1.
    pub fn at_fractions(self, fractions: &[f64]) -> Result<Self, String> {
        match fractions.iter().find(|part| !is_inside(**part)) {
            None => Ok(self.read(fractions.to_vec(), false)),
            Some(part) => Err(format!(
                "found the fraction {part}, expected one between 0 and 1"
            )),
        }
    }

    fn read(mut self, mut fractions: Vec<f64>, are_fixed: bool) -> Self {
        for part in &mut fractions {
            *part = part.clamp(0.0, 1.0);
        }
        self.readings = Readings::at(&self.at.run, &fractions);
        (self.fractions, self.are_fixed, self.whole) = (fractions, are_fixed, OnceLock::new());
        self
    }

    /// Instants \[s\]: those that were requested, or from 0 to the end of the motion.
    pub fn times(&self) -> Vec<f64> {
        let run = &self.at.run;
        let time = |&at: &f64| run.grid.time(run.duration, at);
        self.fractions.iter().map(time).collect()
    }

    /// End of the motion \[s\].
    pub fn duration(&self) -> f64 {
        self.at.run.duration
    }

    /// Name of the method.
    pub fn method(&self) -> String {
        self.at.run.method.name()
    }

    /// Value of every function, in the order of [`Problem::functions`].
    pub fn values(&self) -> Vec<f64> {
        let count = self.at.scene.functions.len();
        (0..count).map(|f| self.at.function(f).value).collect()
    }

    /// Exact gradients of the functions with the indices `which`, on the steps of this motion.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients(&self, which: &[usize]) -> Result<Vec<Vec<f64>>, SimulationError> {
        let found = self.at.gradients(&self.problem, which);
        Ok(found.map_err(AnalysisFailure::from)?.0)
    }

    /// The quantity that the function with this index reduces, at every instant; `None` for functions that
    /// reduce none, such as a duration, a mass or a clearance.
    pub fn history(&self, function: usize) -> Option<Vec<f64>> {
        let samples = self.samples(function)?;
        Some(self.readings.values(&samples))
    }

    /// Largest estimated error of [`Motion::history`] by the polynomials between the samples; zero at samples.
    pub fn history_error(&self, function: usize) -> Option<f64> {
        let samples = self.samples(function)?;
        Some(self.readings.error(&samples))
    }

    fn samples(&self, function: usize) -> Option<Vec<f64>> {
        let scene = &self.at.scene;
        history(scene.functions.get(function)?, &scene.model, &self.at.run)
    }

    /// Exact derivatives of functions of histories by the design, from their cotangents w: one row of
    /// Σ w_k dg(t_k)/dx for each of `all`, in one backward march of the discrete adjoint. Where the duration depends
    /// on the design, instants of [`Motion::at_times`] keep their time, others their fraction of it. With t = s T of
    /// the part of the motion that moves, a fixed time has ds/dT = −(dt/dT)/T.
    ///
    /// # Errors
    /// The equations of a step are singular; a function has no history; or a list has another length than
    /// [`Motion::times`].
    pub fn pull_back(&self, all: &[Cotangents]) -> Result<Vec<Vec<f64>>, SimulationError> {
        let undefined = |what: String| SimulationError::from(AnalysisFailure::Undefined(what));
        let spread = |name: &str, weights: &[f64]| match weights.len() == self.readings.count() {
            true => Ok(self.readings.spread(weights)),
            false => Err(undefined(format!(
                "found {} weights of \"{name}\", expected one for each of {} instants",
                weights.len(),
                self.readings.count()
            ))),
        };
        let weighted = |own: &Cotangents| -> Result<WeightedHistories, SimulationError> {
            let mut functions = Vec::with_capacity(own.functions.len());
            for (f, weights) in &own.functions {
                let function = self.at.scene.functions.get(*f);
                let name = self.problem.function_names.get(*f);
                let name = name.map_or("?", String::as_str);
                if function.and_then(|function| function.instant()).is_none() {
                    return Err(undefined(format!("the function \"{name}\" has no history")));
                }
                if let Some(why) = self.at.no_derivative_of_history(&self.problem, *f) {
                    return Err(undefined(why));
                }
                functions.push((*f, spread(name, weights)?));
            }
            let mut times = match own.times.is_empty() || self.are_fixed {
                true => Vec::new(),
                false => spread("time", &own.times)?,
            };
            if self.are_fixed {
                times = vec![0.0; self.at.run.last() + 1];
                for (f, weights) in &own.functions {
                    self.hold_times(*f, weights, &mut times);
                }
            }
            Ok(WeightedHistories { functions, times })
        };
        let all = all.iter().map(weighted).collect::<Result<_, _>>()?;
        let found = self.at.pull_back(&self.problem, all);
        let found = found.map_err(AnalysisFailure::from)?;
        match found.iter().flatten().all(|d| d.is_finite()) {
            true => Ok(found),
            false => Err(undefined(
                "a derivative of the function of histories is not finite".to_owned(),
            )),
        }
    }

    /// Adds the weights of samples' instants by which the readings of a function keep their time.
    fn hold_times(&self, function: usize, weights: &[f64], times: &mut [f64]) {
        let Some(samples) = self.samples(function) else {
            return;
        };
        let slopes = self.readings.slopes(&samples);
        let by_time = weights.iter().zip(slopes);
        let by_time: Vec<f64> = by_time
            .map(|(w, slope)| -w * slope / self.at.run.duration)
            .collect();
        for (sum, by) in times.iter_mut().zip(self.readings.spread(&by_time)) {
            *sum += by;
        }
    }

    /// Why derivatives of the functions `which` mean nothing, if so: the time steps do not resolve them.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn unresolved(&self, which: &[usize]) -> Result<Option<String>, SimulationError> {
        let gradients = self.gradients(which)?;
        let found = resolved::of_gradients(&self.problem, &self.at, which, &gradients);
        // Where the finer run fails this cannot be judged.
        Ok(found
            .ok()
            .and_then(|own| resolved::refusal(&self.problem, &own)))
    }

    fn whole(&self) -> &Whole {
        self.whole.get_or_init(|| {
            let (scene, motion) = self.at.written(&self.problem);
            let motion = match motion {
                std::borrow::Cow::Borrowed(_) => None,
                std::borrow::Cow::Owned(run) => {
                    let readings = match run.instants == self.at.run.instants {
                        true => self.readings.clone(),
                        false => Readings::at(&run, &self.fractions),
                    };
                    Some((run, readings))
                }
            };
            Whole {
                scene,
                motion,
                observations: OnceLock::new(),
            }
        })
    }

    /// The model as it is written, the motion of all its bodies, and the instants in it.
    fn all_bodies(&self) -> (&Model<f64>, &Trajectory<f64>, &Readings) {
        let whole = self.whole();
        match &whole.motion {
            Some((run, readings)) => (&whole.scene.model, run, readings),
            None => (&whole.scene.model, &self.at.run, &self.readings),
        }
    }

    /// Names of the bodies of the problem file.
    pub fn bodies(&self) -> Vec<String> {
        let model = self.all_bodies().0;
        let own = (0..model.bodies.len()).filter(|&body| !model.is_internal(body));
        own.map(|body| model.bodies[body].name.clone()).collect()
    }

    /// Names of the joints of the problem file.
    pub fn joints(&self) -> Vec<String> {
        let joints = self.all_bodies().0.joints.iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    fn index(&self, name: &str) -> Option<usize> {
        let bodies = &self.all_bodies().0.bodies;
        bodies.iter().position(|body| body.name == name)
    }

    /// State of a body at the instant `k` of [`Motion::times`]. `None` if there is no such body or
    /// instant.
    pub fn body(&self, name: &str, k: usize) -> Option<BodyState> {
        self.states(name)?.get(k).copied()
    }

    /// States of a body at every instant; of a flexible body those of its frame. `None` if there is no such
    /// body.
    pub fn states(&self, name: &str) -> Option<Vec<BodyState>> {
        let body = self.index(name)?;
        let (model, run, readings) = self.all_bodies();
        let mut columns: [Vec<f64>; 13] =
            std::array::from_fn(|_| Vec::with_capacity(run.last() + 1));
        for k in 0..=run.last() {
            let motion = Snapshot::of(model, run, k).motion(body);
            let spin = motion.rotation * motion.omega;
            let all = motion.position.iter().copied().chain(motion.orientation);
            let all = all.chain(motion.velocity.iter().copied().chain(spin.iter().copied()));
            for (column, value) in columns.iter_mut().zip(all) {
                column.push(value);
            }
        }
        let columns: Vec<Vec<f64>> = columns.iter().map(|own| readings.values(own)).collect();
        let state = |k: usize| {
            let at = |from: usize| [0, 1, 2].map(|i| columns[from + i][k]);
            let p = [0, 1, 2, 3].map(|i| columns[3 + i][k]);
            let size = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            BodyState {
                position: at(0),
                // Between samples the parameters are of unit length only nearly.
                orientation: match (size - 1.0).abs() < ROUND_OFF {
                    true => p,
                    false => p.map(|x| x / size),
                },
                velocity: at(7),
                angular_velocity: at(10),
            }
        };
        Some((0..readings.count()).map(state).collect())
    }

    /// Names of the flexible bodies that have [elastic states](Motion::elastic).
    pub fn flexible_bodies(&self) -> Vec<String> {
        let modal = self.all_bodies().0.flexible.iter();
        let modal = modal.filter(|own| matches!(own.form, Form::Modal(_)));
        modal.map(|own| own.name.clone()).collect()
    }

    /// Elastic coordinates of a flexible body with shapes, at every instant. `None` for other bodies.
    pub fn elastic(&self, name: &str) -> Option<ElasticStates> {
        let (model, run, readings) = self.all_bodies();
        let mut all = model.flexible.iter();
        let body = all.find(|own| own.name == name && matches!(own.form, Form::Modal(_)))?;
        let count = body.modes();
        let mut columns = vec![Vec::new(); 2 * count];
        for k in 0..=run.last() {
            let at = Snapshot::of(model, run, k);
            for (i, (carrier, axis)) in body.places().enumerate() {
                let motion = at.motion(carrier);
                columns[i].push(motion.position[axis]);
                columns[count + i].push(motion.velocity[axis]);
            }
        }
        let columns: Vec<Vec<f64>> = columns.iter().map(|own| readings.values(own)).collect();
        let rows = |from: usize| {
            let row = |k: usize| columns[from..from + count].iter().map(|c| c[k]).collect();
            (0..readings.count()).map(row).collect()
        };
        Some(ElasticStates {
            coordinates: rows(0),
            rates: rows(count),
        })
    }

    fn observations(&self) -> &[Observation] {
        let (model, run, _) = self.all_bodies();
        self.whole().observations.get_or_init(|| {
            let numbering = Numbering::new(model);
            let all = 0..=run.last();
            all.map(|k| observe(model, &numbering, (run.q(k), run.v(k)), run.time(k)))
                .collect()
        })
    }

    /// Energies and momenta at every instant.
    pub fn energies(&self) -> Energies {
        let (_, _, readings) = self.all_bodies();
        let seen = self.observations();
        let column = |of: &dyn Fn(&Observation) -> f64| {
            let samples: Vec<f64> = seen.iter().map(of).collect();
            readings.values(&samples)
        };
        let vector = |of: &dyn Fn(&Observation, usize) -> f64| {
            let columns = [0, 1, 2].map(|i| column(&|seen| of(seen, i)));
            let row = |k: usize| [0, 1, 2].map(|i| columns[i][k]);
            (0..readings.count()).map(row).collect()
        };
        Energies {
            kinetic: column(&|seen| seen.kinetic),
            potential: column(&|seen| seen.potential),
            momentum: vector(&|seen, i| seen.momentum[i]),
            angular_momentum: vector(&|seen, i| seen.angular_momentum[i]),
        }
    }

    /// Reactions of a joint at every instant. `None` if there is no such joint.
    pub fn reactions(&self, name: &str) -> Option<Reactions> {
        let (model, run, readings) = self.all_bodies();
        let joint = model.joints.iter().position(|own| own.name == name)?;
        let numbering = Numbering::new(model);
        let mut multipliers = Multipliers::new(model, &numbering, run);
        let mut columns = vec![vec![0.0; run.last() + 1]; 6];
        for k in run.shown() {
            let lambda = multipliers.at(k);
            let found = reactions(model, &numbering, (run.q(k), &lambda), run.time(k));
            let both = [found[joint].force_ground, found[joint].torque_ground];
            for (i, value) in both.iter().flat_map(|v| v.iter()).enumerate() {
                columns[i][k] = *value;
            }
        }
        let columns: Vec<Vec<f64>> = columns.iter().map(|own| readings.values(own)).collect();
        let rows = |from: usize| {
            let row = |k: usize| [0, 1, 2].map(|i| columns[from + i][k]);
            (0..readings.count()).map(row).collect()
        };
        Some(Reactions {
            force: rows(0),
            torque: rows(3),
        })
    }

    /// The largest stress of each body whose stresses are known, at every instant \[Pa\]: von Mises stress of
    /// shells, largest stress along the fibres of beams.
    pub fn stresses(&self) -> Vec<(String, Vec<f64>)> {
        let (model, run, readings) = self.all_bodies();
        let drawing = self.problem.drawing(&self.at.x);
        let found = stresses("", (model, run), &drawing).curves.into_iter();
        found
            .map(|(name, samples)| (name, readings.values(&samples)))
            .collect()
    }

    /// Largest |E(t) − E(0)| of kinetic and potential energy \[J\].
    pub fn energy_drift(&self) -> f64 {
        let total = |o: &Observation| o.kinetic + o.potential;
        let seen = self.observations();
        let start = total(&seen[0]);
        let changes = seen.iter().map(|o| (total(o) - start).abs());
        changes.fold(0.0, f64::max)
    }

    /// Largest violation of a position constraint \[m or 1\] and of a velocity constraint \[m/s or
    /// rad/s\].
    pub fn constraint_drift(&self) -> (f64, f64) {
        let seen = self.observations().iter();
        seen.fold((0.0, 0.0), |(p, v), o| {
            (p.max(o.position_drift), v.max(o.velocity_drift))
        })
    }

    /// Work of the simulation.
    pub fn work(&self) -> WorkCounts {
        self.at.run.counts
    }
}
