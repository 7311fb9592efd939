//! The motion of all bodies as the problem file has them: states, energies, reactions, stresses.

use super::response::{Motion, ROUND_OFF, Whole};
use crate::driver::simulate::{constraint_drift, energy_drift};
use crate::figures::elastic_figures::stresses;
use crate::functions::histories::Readings;
use crate::functions::snapshot::Snapshot;
use crate::integrate::{Multipliers, Trajectory};
use crate::model::{Form, Model};
use crate::system::Numbering;
use crate::system::observe::{Observation, observe, reactions};
use std::sync::OnceLock;

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

impl Motion {
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
        energy_drift(self.observations())
    }

    /// Largest violation of a position constraint \[m or 1\] and of a velocity constraint \[m/s or
    /// rad/s\].
    pub fn constraint_drift(&self) -> (f64, f64) {
        constraint_drift(self.observations())
    }
}
