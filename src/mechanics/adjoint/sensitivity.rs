//! One function during the backward march: its cotangents at the samples and at the present state,
//! and its derivatives in the parameters so far.

use super::compensated::Compensated;
use crate::functions::linearised::Linearised;
use crate::functions::snapshot::{Snapshot, SnapshotCotangent};
use crate::functions::{JointMultipliers, Rows, Scene};
use crate::integrate::Trajectory;
use crate::integrate::{IntegrationFailure, WorkCounts};
use crate::linalg::REFINED_SOLVES;
use crate::system::kkt::SaddlePoint;
use crate::system::{bodies, initial};

/// One function during the backward march.
pub(super) struct Sensitivity<'a> {
    linearised: Linearised<'a>,
    own: usize,
    /// Multipliers of the joint whose reaction the function observes.
    joint: Option<JointMultipliers<'a, f64>>,
    /// Derivatives in the parameters of the scene so far.
    pub cot: Scene<f64>,
    /// Derivative in the duration through the step sizes.
    pub by_duration: f64,
    /// Cotangent of the present positions; seven coordinates per body.
    pub q: Compensated,
    /// Cotangent of the present velocities.
    pub v: Compensated,
    /// Partial derivatives at a sample in tangent positions, velocities and accelerations.
    pub sample: [Vec<f64>; 3],
}

impl<'a> Sensitivity<'a> {
    /// Function number `own` of the scene, at the end of `run`.
    pub fn new(scene: &'a Scene<f64>, run: &'a Trajectory<f64>, own: usize) -> Self {
        let (nq, nv) = (run.numbering.positions(), run.numbering.velocities());
        let function = scene.function(own);
        let joint = function.instant().and_then(|own| own.reacting_joint());
        let joint = joint.map(|j| JointMultipliers::new(&scene.model, &run.numbering, j));
        Self {
            linearised: Linearised::new(function, &scene.model, run),
            joint,
            own,
            cot: scene.zero_cotangent(),
            by_duration: 0.0,
            q: Compensated::zero(nq),
            v: Compensated::zero(nv),
            sample: std::array::from_fn(|_| vec![0.0; nv]),
        }
    }

    /// Whether the function depends on the states of sample k.
    pub fn depends_on(&self, k: usize) -> bool {
        self.linearised.depends_on(k)
    }

    /// Sets `sample` to the partial derivatives of the function at sample k; false if there are
    /// none.
    pub fn linearise(&mut self, scene: &Scene<f64>, run: &Trajectory<f64>, k: usize) -> bool {
        if !self.depends_on(k) {
            return false;
        }
        for part in &mut self.sample {
            part.fill(0.0);
        }
        let [y, v, a] = &mut self.sample;
        let (model, own) = self.cot.model_and_function(self.own);
        let rows = self.joint.as_ref().map_or(0, JointMultipliers::count);
        let (mut lambda, mut by_time) = (vec![0.0; rows], 0.0);
        let mut out = SnapshotCotangent {
            y: &mut *y,
            v: &mut *v,
            a,
            lambda: &mut lambda,
            time: &mut by_time,
            model: &mut *model,
        };
        let at = Snapshot {
            joint: (self.joint.as_mut()).map_or(Rows::none(), |joint| joint.at(run, k)),
            ..Snapshot::of(&scene.model, run, k)
        };
        self.linearised.pull_back(k, &at, &mut out, own);
        if let Some(joint) = &mut self.joint {
            by_time += joint.pull_back(&lambda, (y, v), model);
        }
        self.by_duration += run.grid.rate(run.instants[k]) * by_time;
        true
    }

    /// Pulls the cotangents of the initial state and of the initial accelerations (`a`) back to the
    /// parameters. Adds the derivatives in the duration and in parameters of no instant.
    ///
    /// # Errors
    /// The equations of the initial state are singular.
    pub fn finish(
        &mut self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        saddle: &mut SaddlePoint<f64>,
        a: &[f64],
        counts: &mut WorkCounts,
    ) -> Result<(), IntegrationFailure> {
        if let Some(joint) = &self.joint {
            counts.factorisations += joint.factorisations();
        }
        let before = saddle.factorisations;
        let mut y = vec![0.0; a.len()];
        bodies::tangent_of_cotangent(&run.numbering, &run.initial.q, &self.q.value, &mut y);
        let cot = &mut self.cot;
        initial::pull_back(
            &scene.model,
            &run.numbering,
            saddle,
            &run.initial,
            (&y, &self.v.value, a),
            &mut cot.model,
        )?;
        counts.factorisations += saddle.factorisations - before;
        counts.solves += REFINED_SOLVES * (saddle.factorisations - before);
        cot.duration = self.by_duration + self.linearised.by_duration;
        self.linearised
            .pull_back_parameters(cot.model_and_function(self.own).1);
        Ok(())
    }
}
