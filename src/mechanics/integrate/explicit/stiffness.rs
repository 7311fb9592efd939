//! Decides when an implicit method replaces the explicit one.
//!
//! A scene is suspicious if h |λ| is near the border of the stability region, or if the motion is
//! so smooth that round-off hides |λ|. With a smaller h |λ| stiffness is still possible: at tight
//! tolerances, vibration that does not show may bound the steps. After many steps it is possible in any scene. Then Radau IIA
//! marches on from the present state until it has spent a fixed amount of work, and the paces of both methods are
//! compared. Elastic bodies are stiff in any case where stability bounds the steps. Work is counted in evaluations of the accelerations, so the decision does not depend
//! on the machine.

use super::record::NodeView;
use super::step::Stepper;
use super::tableau::STAGES;
use crate::integrate::implicit::march::{self as implicit, Stretch};
use crate::integrate::limits::Limits;
use crate::integrate::quadrature::Samples;
use crate::integrate::scale::Scale;
use crate::integrate::settings::{Method, Settings};
use crate::integrate::trajectory::Trajectory;
use crate::integrate::work::Measured;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::Numbering;
use crate::system::initial::InitialState;

/// What an explicit march watches for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Steps that stability bounds, for any cost of another method.
    Stability,
    /// A method that costs less.
    Cost,
}

/// Limits of h |λ|: border of the stability region (Hairer & Wanner 1996, section IV.2); possibly
/// near it; below the last an implicit method has no advantage.
pub const UNSTABLE: f64 = 6.1;
const SUSPICIOUS: f64 = 2.0;
const POSSIBLE: f64 = 0.3;
/// Number of steps beyond a limit that make a scene stiff or suspicious.
const STIFF: usize = 15;
/// Number of steps within a limit that end a suspicion.
const NOT_STIFF: usize = 6;
/// Differences of states below this, relative to their scale, are round-off.
const NOISE: f64 = 1e-13;

/// Number of steps before the first comparison of the methods: if the scene is suspicious; if stiffness is possible, which it
/// always is with elastic bodies; and in any scene, as round-off may bound explicit steps where it hardly bounds implicit ones.
/// And the factor between the numbers of steps before consecutive comparisons.
const FIRST: [usize; 3] = [40, 500, 5000];
const FIRST_FLEXIBLE: [usize; 3] = [40, 100, 5000];
const AGAIN: usize = 4;
/// Least number of steps over which the pace is measured.
const RECENT: usize = 32;
/// Work of the implicit method in a comparison: at least this, and this part of the explicit work
/// so far.
const LEAST_WORK: f64 = 300.0;
const PART: f64 = 0.02;
/// The implicit method takes over if it needs less than this part of the explicit work, for the
/// rest and with the work already spent.
const CHEAPER: f64 = 0.8;
const IN_ALL: f64 = 1.5;

/// Counts steps in a row with a property; a few without it do not interrupt the row.
#[derive(Default)]
struct Streak {
    with: usize,
    without: usize,
}

impl Streak {
    /// Counts a step; returns whether there are enough.
    fn count(&mut self, has: bool) -> bool {
        if has {
            self.without = 0;
            self.with += 1;
        } else {
            self.without += 1;
            if self.without == NOT_STIFF {
                self.with = 0;
            }
        }
        self.has_enough()
    }

    fn has_enough(&self) -> bool {
        self.with >= STIFF
    }
}

/// Monitors whether stability, not accuracy, bounds the steps.
pub struct Stiffness {
    watch: Watch,
    /// What was measured so far.
    pub measured: Measured,
    /// Whether the scene has elastic bodies, whose fast modes need not show in the motion.
    flexible: bool,
    /// Whether the tangent is resolved, so that steps in which no motion shows are not suspicious.
    tangent: bool,
    unstable: Streak,
    suspicious: Streak,
    possible: Streak,
    /// Fraction of the duration and work at two earlier steps; the later one is last.
    earlier: [(f64, f64); 2],
    /// Numbers of steps before the next comparison: if suspicious, if possible, and in any scene.
    next: [usize; 3],
}

impl Stiffness {
    /// Watches for `watch`.
    pub fn new(watch: Watch, flexible: bool, tangent: bool) -> Self {
        Self {
            watch,
            measured: Measured::default(),
            flexible,
            tangent,
            unstable: Streak::default(),
            suspicious: Streak::default(),
            possible: Streak::default(),
            earlier: [(0.0, 0.0); 2],
            next: match flexible {
                true => FIRST_FLEXIBLE,
                false => FIRST,
            },
        }
    }

    /// Whether to decide on the scene after the step in `stepper`, of size h, which ended in `to`
    /// and is the last of `run`.
    pub fn seen<S: SolveScalar>(
        &mut self,
        stepper: &mut Stepper<S>,
        scale: &Scale,
        to: NodeView<S>,
        (h, run): (f64, &Trajectory<S>),
    ) -> bool {
        let numbering = stepper.field.numbering;
        let speeds = scale.speeds(numbering, to.v, &stepper.data.v_raw);
        let measure = |q: &[S], v: &[S]| scale.square(numbering, q, v, &speeds);
        let [dy, df] = stepper.last_stage(to, measure);
        // A ratio of round-off does not estimate λ.
        let known = dy > NOISE * NOISE;
        let size = if known { h * (df / dy).sqrt() } else { 0.0 };
        self.measured.largest = self.measured.largest.max(size);
        let beyond = |most: f64| size > most;
        let unstable = self.unstable.count(beyond(UNSTABLE));
        if self.watch == Watch::Stability || unstable && self.flexible {
            return unstable;
        }
        let steps = run.grid.steps();
        if steps.is_multiple_of(RECENT) {
            self.earlier = [self.earlier[1], (run.grid.reached(), work_so_far(run))];
        }
        let hidden = !known && !self.tangent;
        let suspicious = self.suspicious.count(hidden || beyond(SUSPICIOUS));
        let possible = !known || beyond(POSSIBLE) || self.flexible;
        let possible = self.possible.count(possible);
        [suspicious, possible, true]
            .into_iter()
            .zip(self.next)
            .any(|(applies, least)| applies && steps >= least)
    }

    /// Decides on a suspicious scene at the end of `run`, in the state `at`. If the implicit method
    /// takes over, returns its part of the explicit work, if measured.
    pub fn decides<S: SolveScalar>(
        &mut self,
        (model, numbering): (&Model<S>, &Numbering),
        settings: &Settings,
        at: NodeView<S>,
        run: &Trajectory<S>,
    ) -> Option<Option<f64>> {
        // Fast vibrations of elastic bodies, fed by explicit steps at the border of stability, would slow down the
        // other method, too.
        let fed = self.flexible && self.unstable.has_enough();
        if self.watch == Watch::Stability || fed {
            return Some(None);
        }
        let reached = run.grid.reached();
        // Many contacts couple all bodies in the matrix of an implicit step, though few touch: its factors cost far more than the
        // evaluations in which work is counted.
        if reached >= 1.0 || numbering.near().is_some() {
            return None;
        }
        let again = AGAIN * run.grid.steps();
        self.next = self.next.map(|next| next.max(again));
        let spent = work_so_far(run);
        let (from, before) = self.earlier[0];
        let pace = (reached - from) / (spent - before);
        let start = InitialState {
            q: at.q.to_vec(),
            v: at.v.to_vec(),
            a: at.a.to_vec(),
            lambda: at.lambda.to_vec(),
            ..run.initial.clone()
        };
        let settings = Settings {
            method: Method::Radau { stages: 3 },
            solver: settings.solver,
            spacing: settings.spacing.clone(),
            samples: Samples::Uniform(1),
            memory: 0,
            limits: Limits::default(),
            derivatives: settings.derivatives,
        };
        let mut stretch = Stretch::new(reached, LEAST_WORK.max(PART * spent));
        let all = (model, numbering);
        implicit::march_stretch(all, run.duration, &settings, start, &mut stretch).ok()?;
        let other = stretch.pace()?;
        // The other method starts again at the beginning.
        self.measured.compared = Some((run.time_reached(), pace / other));
        let own = spent + (1.0 - reached) / pace;
        let takes_over = 1.0 / other < CHEAPER * own && spent + 1.0 / other < IN_ALL * own;
        takes_over.then_some(Some(pace / other))
    }
}

/// Work of an explicit march without that of its samples.
fn work_so_far<S: SolveScalar>(run: &Trajectory<S>) -> f64 {
    (STAGES * (run.grid.steps() + run.counts.rejected)) as f64
}
