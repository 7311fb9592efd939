//! Primal–dual interior-point iteration (Wächter & Biegler 2006, algorithm A).

use nalgebra::DVector;

use crate::doubts::wrong_gradients;
use crate::interior_point::barrier::BarrierRule;
use crate::interior_point::direction::{Direction, NewtonSystem};
use crate::interior_point::filter::Filter;
use crate::interior_point::iterate::{Iterate, Layout};
use crate::interior_point::line_search::{Accepted, LineSearch, SHORT_TRIALS, infeasibility};
use crate::linear::quasi_newton::QuasiNewton;
use crate::multipliers::ScaledMultipliers;
use crate::observer::Phase;
use crate::program::{Derivatives, EarlyExit, Point, Program, Progress};
use crate::status::Status;

/// How often entries may be stiffened in one iteration. With one time, trusses take twice the
/// evaluations; with twenty, two discs that touch three times as many.
const STIFFENINGS: usize = 8;

/// State of the iteration.
pub(crate) struct InteriorPoint {
    pub(crate) layout: Layout,
    pub at: Iterate,
    pub b: QuasiNewton,
    pub barrier: BarrierRule,
    pub(crate) filter: Filter,
    pub(crate) theta_small: f64,
    pub(crate) short_steps: usize,
    /// Successive points at which a row dominated.
    pub(crate) dominated: usize,
    /// Whether the gradients were tested.
    doubted: bool,
    /// A point that the iteration has not left by more than `NEARBY`, and the evaluations before.
    pub(crate) anchor: (DVector<f64>, usize),
    /// Variables on which nothing has depended so far. They have no barrier, so they stay.
    idle: Vec<usize>,
}

impl InteriorPoint {
    /// Starts from a strictly interior point; slacks keep the share `push` from their bounds.
    pub(crate) fn new(
        program: &Program<'_>,
        point: Point,
        slopes: Derivatives,
        push: f64,
    ) -> InteriorPoint {
        let mut layout = Layout::new(program);
        let is_idle = slopes.idle();
        let idle: Vec<usize> = (0..layout.n).filter(|&k| is_idle[k]).collect();
        for &k in &idle {
            (layout.lower[k], layout.upper[k]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let options = program.options;
        let n = layout.n;
        let s = DVector::from_iterator(
            layout.slack_rows.len(),
            layout
                .slack_rows
                .iter()
                .enumerate()
                .map(|(k, &j)| layout.push_inside(n + k, point.c[j], push)),
        );
        let (below, above) = layout.distances(&point.x, &s);
        // Neither a multiplier nor its product with the distance starts above one: bounds far away
        // would outweigh the objective.
        let moderate = |d: f64| if d.is_finite() { 1.0 / d.max(1.0) } else { 0.0 };
        let mut at = Iterate {
            y: DVector::zeros(point.c.len()),
            zl: below.map(moderate),
            zu: above.map(moderate),
            point,
            slopes,
            s,
        };
        at.estimate_multipliers(&layout);
        let theta = infeasibility(&layout.residual(&at.point.c, &at.s), &at.point.c);
        // The first step is no longer than the point, or 1.
        let mut b = QuasiNewton::new(n, options.dense_limit, options.memory).with_diagonal();
        let force = at.lagrangian_slope(&layout).rows(0, n).amax();
        b.set_scale((force / at.point.x.amax().max(1.0)).max(1.0));
        InteriorPoint {
            b,
            barrier: BarrierRule::new(options),
            filter: Filter::new(1e2 * theta.max(1.0)),
            theta_small: 1e-4 * theta.max(1.0),
            short_steps: 0,
            dominated: 0,
            doubted: false,
            anchor: (at.point.x.clone(), program.counts.evaluations),
            idle,
            layout,
            at,
        }
    }

    /// Continues with multipliers of an earlier run.
    pub(crate) fn warm_start(&mut self, multipliers: &ScaledMultipliers, b: QuasiNewton, mu: f64) {
        let n = self.layout.n;
        self.barrier.mu = mu;
        if b.order() == n {
            self.b = b;
        }
        self.at.y.copy_from(&multipliers.y);
        for i in 0..self.layout.len() {
            let (zl, zu) = match self.layout.row_of(i) {
                None => (multipliers.zl[i], multipliers.zu[i]),
                Some(j) => ((-multipliers.y[j]).max(0.0), multipliers.y[j].max(0.0)),
            };
            self.at.zl[i] = if self.at.zl[i] > 0.0 { zl } else { 0.0 };
            self.at.zu[i] = if self.at.zu[i] > 0.0 { zu } else { 0.0 };
        }
        self.at.keep_multipliers_in_band(&self.layout, mu);
    }

    /// Iterates until the run ends.
    pub(crate) fn run(&mut self, program: &mut Program<'_>) -> Status {
        self.iterate(program).unwrap_or_else(Status::from)
    }

    /// Algorithm A of Wächter & Biegler (2006), step by step.
    fn iterate(&mut self, program: &mut Program<'_>) -> Result<Status, EarlyExit> {
        let mut failures = 0;
        loop {
            // the tests of the whole problem.
            self.activate_bounds(program);
            if let Some(ending) = self.ending(program) {
                return Ok(ending);
            }
            if program.goes_far(&self.at.point) && program.falls_on(&self.at.point)? {
                return Ok(Status::Unbounded);
            }
            // a new barrier parameter begins with an empty filter.
            let curvature = program.curvature(&self.at.point.x, &self.at.y)?;
            self.b.set_exact(curvature);
            if self.barrier.update(&self.at, &self.layout, &mut self.b) {
                self.filter.clear();
            }
            // the search direction.
            program.next_iteration()?;
            let tau = (1.0 - self.barrier.mu).max(0.99);
            let Some((system, direction)) = self.direction(tau) else {
                return Ok(Status::Stalled);
            };
            // the line search, which augments the filter.
            let dual = direction.dual_limit(&self.at, tau);
            let search = LineSearch {
                layout: &self.layout,
                at: &self.at,
                system: &system,
                mu: self.barrier.mu,
                tau,
                theta_small: self.theta_small,
            };
            match search.run(program, &mut self.b, &mut self.filter, direction)? {
                // the accepted point.
                Some(accepted) => {
                    failures = 0;
                    self.step(program, accepted, dual, system.regularisation())?;
                    if self.short_steps > 0
                        && let Some(ending) = self.leave_crawl(program)?
                    {
                        return Ok(ending);
                    }
                }
                // restoration of feasibility.
                None => {
                    failures += 1;
                    if let Some(ending) = self.recover(program, failures)? {
                        return Ok(ending);
                    }
                }
            }
        }
    }

    /// Adds barriers for the idle variables on which something depends at this point.
    fn activate_bounds(&mut self, program: &Program<'_>) {
        if self.idle.is_empty() {
            return;
        }
        let is_idle = self.at.slopes.idle();
        let (idle, woken): (Vec<usize>, Vec<usize>) = self.idle.iter().partition(|&&k| is_idle[k]);
        self.idle = idle;
        for &k in &woken {
            let x = self.at.point.x[k];
            let (lower, upper) = (program.lower[k], program.upper[k]);
            (self.layout.lower[k], self.layout.upper[k]) = (lower, upper);
            (self.at.zl[k], self.at.zu[k]) =
                (self.barrier.mu / (x - lower), self.barrier.mu / (upper - x));
        }
        if !woken.is_empty() {
            self.filter.clear();
        }
    }

    pub(crate) fn theta(&self) -> f64 {
        infeasibility(
            &self.layout.residual(&self.at.point.c, &self.at.s),
            &self.at.point.c,
        )
    }

    fn direction(&mut self, tau: f64) -> Option<(NewtonSystem, Direction)> {
        for _ in 0..2 {
            if let Some(found) = self.newton(DVector::zeros(self.layout.len())) {
                return Some(self.stiffen(found, tau));
            }
            self.b.reset();
        }
        None
    }

    fn newton(&mut self, stiffness: DVector<f64>) -> Option<(NewtonSystem, Direction)> {
        let system = NewtonSystem::new(&self.at, &self.layout, &mut self.b, stiffness)?;
        let r = self.layout.residual(&self.at.point.c, &self.at.s);
        let step = system.step(&self.at, &self.layout, &mut self.b, self.barrier.mu, &r);
        step.is_finite().then_some((system, step))
    }

    /// Stiffens the entries of w that overshoot their bounds, so they do not shorten the step of
    /// the others. Their force is added to the multipliers of the bounds.
    fn stiffen(&mut self, found: (NewtonSystem, Direction), tau: f64) -> (NewtonSystem, Direction) {
        let plain = found.1.primal_limit(&self.at, &self.layout, tau);
        let mut last: Option<(NewtonSystem, Direction)> = None;
        for _ in 0..STIFFENINGS {
            let (system, step) = last.as_ref().unwrap_or(&found);
            let Some(more) = step.stiffened(&self.at, &self.layout, system, &mut self.b) else {
                break;
            };
            let Some(stiffer) = self.newton(more) else {
                break;
            };
            last = Some(stiffer);
        }
        match last {
            Some(stiff) if stiff.1.primal_limit(&self.at, &self.layout, tau) > 2.0 * plain => stiff,
            _ => found,
        }
    }

    /// Moves to an accepted point.
    fn step(
        &mut self,
        program: &mut Program<'_>,
        accepted: Accepted,
        dual: f64,
        regularisation: f64,
    ) -> Result<(), EarlyExit> {
        let Accepted {
            point,
            slopes,
            s,
            alpha,
            direction,
            trials,
        } = accepted;
        let moved = &point.x - &self.at.point.x;
        let at = &mut self.at;
        at.y += &direction.y * alpha;
        at.zl += &direction.zl * dual;
        at.zu += &direction.zu * dual;
        at.point = point;
        let before = std::mem::replace(&mut at.slopes, slopes);
        at.s = s;
        at.keep_multipliers_in_band(&self.layout, self.barrier.mu);
        let r = self.layout.residual(&at.point.c, &at.s);
        // Never to do so makes a false claim, always to do so loses three problems of the bed.
        if r.lp_norm(1) < program.options.tolerance {
            at.estimate_multipliers(&self.layout);
        }
        let change = &at.slopes.g - &before.g + at.slopes.a.tr_mul(&at.y) - before.a.tr_mul(&at.y);
        let model = at.reciprocal_model(&moved);
        self.b.update_with(moved, change, model);
        self.short_steps = if trials > SHORT_TRIALS {
            self.short_steps + 1
        } else {
            0
        };
        let progress = Progress {
            optimality: self.optimality(),
            barrier: self.barrier.mu,
            step: direction.size(),
            regularisation,
            primal_step: alpha,
            dual_step: dual,
            trials,
            phase: Phase::Regular,
        };
        program.report(&self.at.point, &progress)
    }

    /// Ends the run if the gradients are wrong here. Values that do not follow their gradients over
    /// and over again are suspicious, but a curved valley has such values too: one test suffices.
    pub(crate) fn doubt_gradients(&mut self, program: &mut Program<'_>) -> Result<(), EarlyExit> {
        if std::mem::replace(&mut self.doubted, true) {
            return Ok(());
        }
        match wrong_gradients(program, &self.at.point, &self.at.slopes) {
            Some(what) => Err(EarlyExit::Halt(Status::Inconsistent { what })),
            None => Ok(()),
        }
    }
}
