//! One target during the backward march: its cotangents at the samples and at the present state,
//! and its derivatives in the parameters so far.

use super::compensated::Compensated;
use super::{Target, WeightedEnd};
use crate::functions::linearised::Linearised;
use crate::functions::snapshot::{Snapshot, SnapshotCotangent};
use crate::functions::{Reactions, RowCotangent, Rows, Scene};
use crate::integrate::Trajectory;
use crate::integrate::{IntegrationFailure, WorkCounts};
use crate::linalg::REFINED_SOLVES;
use crate::system::equilibrium::FrozenMode;
use crate::system::kkt::SaddlePoint;
use crate::system::{bodies, initial};

/// A function of interest, or a weighted history, as a part of a target.
struct Term<'a> {
    linearised: Linearised<'a>,
    /// Number of the function in the scene.
    function: usize,
    /// For each quantity of an instant in it: the multipliers of the joints whose reactions it needs.
    reactions: Vec<Option<Reactions<'a, f64>>>,
}

/// One target during the backward march.
pub(super) struct Sensitivity<'a> {
    terms: Vec<Term<'a>>,
    /// Weights of the state at the end, if they are the target.
    end: Option<WeightedEnd>,
    /// Derivatives in the parameters of the scene so far.
    pub cot: Scene<f64>,
    /// Derivatives in the parameters of the model through vibrations, besides those in `cot`.
    pub modes: Vec<FrozenMode>,
    /// Derivative in the duration through the step sizes and the instants.
    pub by_duration: f64,
    /// Cotangent of the present positions; seven coordinates per body.
    pub q: Compensated,
    /// Cotangent of the present velocities.
    pub v: Compensated,
    /// Partial derivatives at a sample in tangent positions, velocities and accelerations.
    pub sample: [Vec<f64>; 3],
}

impl<'a> Sensitivity<'a> {
    /// A target over a run of `scene`, at its end.
    pub fn new(scene: &'a Scene<f64>, run: &'a Trajectory<f64>, target: &Target) -> Self {
        let (nq, nv) = (run.numbering.positions(), run.numbering.velocities());
        let term = |number: usize, weights: Option<&[f64]>| {
            let function = scene.function(number);
            let model = &scene.model;
            let linearised = match weights {
                Some(weights) => Linearised::history(function, weights, (model, run)),
                None => Linearised::new(function, model, run),
            };
            let reactions = |which| {
                let of = linearised.reacting(which)?;
                Some(Reactions::new(model, &run.numbering, of))
            };
            Term {
                reactions: (0..linearised.quantities()).map(reactions).collect(),
                linearised,
                function: number,
            }
        };
        let (terms, by_duration) = match target {
            Target::Function(number) => (vec![term(*number, None)], 0.0),
            Target::Histories(histories) => {
                let terms = histories.functions.iter();
                let terms = terms.map(|(number, weights)| term(*number, Some(weights)));
                let times = histories.times.iter().zip(&run.instants);
                let by_time = times.map(|(weight, &at)| weight * run.grid.rate(at)).sum();
                (terms.collect(), by_time)
            }
            Target::End(_) => (Vec::new(), 0.0),
        };
        let end = match target {
            Target::End(own) => Some(own.clone()),
            Target::Function(_) | Target::Histories(_) => None,
        };
        Self {
            terms,
            end,
            cot: scene.zero_cotangent(),
            modes: Vec::new(),
            by_duration,
            q: Compensated::zero(nq),
            v: Compensated::zero(nv),
            sample: std::array::from_fn(|_| vec![0.0; nv]),
        }
    }

    /// Whether the target depends on the states of sample `k` of `run`.
    pub fn depends_on(&self, run: &Trajectory<f64>, k: usize) -> bool {
        self.terms.iter().any(|term| term.linearised.depends_on(k))
            || (self.end.is_some() && k == run.last())
    }

    /// Sets `sample` to the partial derivatives of the target at sample k; false if there are
    /// none.
    pub fn linearise(&mut self, scene: &Scene<f64>, run: &Trajectory<f64>, k: usize) -> bool {
        if !self.depends_on(run, k) {
            return false;
        }
        for part in &mut self.sample {
            part.fill(0.0);
        }
        let [y, v, a] = &mut self.sample;
        if let Some(end) = &self.end {
            bodies::tangent_of_cotangent(&run.numbering, run.q(k), &end.q, y);
            v.copy_from_slice(&end.v);
        }
        let mut by_time = 0.0;
        for term in (self.terms.iter_mut()).filter(|term| term.linearised.depends_on(k)) {
            let (model, own) = self.cot.model_and_function(term.function);
            let linearised = &term.linearised;
            let plain = Snapshot::of(&scene.model, run, k);
            for (which, reactions) in term.reactions.iter_mut().enumerate() {
                if !linearised.depends_through(which, k) {
                    continue;
                }
                let mut by_rows = (reactions.as_ref())
                    .map_or_else(RowCotangent::default, Reactions::zero_cotangent);
                let mut out = SnapshotCotangent {
                    y: &mut *y,
                    v: &mut *v,
                    a: &mut *a,
                    reactions: &mut by_rows,
                    time: &mut by_time,
                    model: &mut *model,
                    modes: &mut self.modes,
                };
                let at = Snapshot {
                    reactions: (reactions.as_mut()).map_or(Rows::none(), |own| own.at(run, k)),
                    ..plain
                };
                linearised.pull_quantity(which, k, &at, &mut out, own);
                if let Some(reactions) = reactions {
                    by_time += reactions.pull_back(&by_rows, (&mut *y, &mut *v), model);
                }
            }
            let mut out = SnapshotCotangent {
                y: &mut *y,
                v: &mut *v,
                a: &mut *a,
                reactions: &mut RowCotangent::default(),
                time: &mut by_time,
                model: &mut *model,
                modes: &mut self.modes,
            };
            linearised.pull_flight(k, &plain, &mut out, own);
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
        let reactions = self
            .terms
            .iter()
            .flat_map(|term| term.reactions.iter().flatten());
        counts.factorisations += reactions.map(Reactions::factorisations).sum::<usize>();
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
        let by_terms = self.terms.iter().map(|term| term.linearised.by_duration);
        cot.duration = self.by_duration + by_terms.sum::<f64>();
        for term in &self.terms {
            let own = cot.model_and_function(term.function).1;
            term.linearised.pull_back_parameters(own);
        }
        Ok(())
    }
}
