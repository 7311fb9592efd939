//! Step size control.

use super::grid::Grid;
use super::headway::{Headway, Stop};
use super::limits::Clock;
use super::quadrature::{Intervals, Samples};
use super::scale::Scale;
use super::settings::{Method, Settings, Spacing};
use super::stops::{kinks, widest};
use crate::math::Scalar;
use crate::model::Model;

/// Safety factor of the next step, and smallest and largest ratio of consecutive steps.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;
/// Steps of Radau IIA in flexible scenes grow only by more than this, so that their factors serve several steps (Hairer &
/// Wanner 1996, section IV.8): up to twelve percent more steps, and a fifth to a half fewer factorisations.
const KEEP: f64 = 1.5;
/// Sizes of steps that are tried near a singular position, relative to the step that failed.
const LEAPS: [f64; 8] = [0.7, 1.3, 0.5, 1.8, 0.3, 2.5, 0.15, 4.0];
/// Smallest step relative to the time in which the scene crosses its length, and relative to the
/// time reached, whose round-off it must exceed.
const SMALLEST: f64 = 1e-12;
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// Constants of leaps over a singular position. Its position in the step: far from the stages of
/// the step and of its two halves; the others follow if that fails. A leap may exceed the step that
/// the error allows by `LEAP_MORE`. The step before it ends `LEAP_FROM` such steps before the
/// position. Positions beyond `LOOK_AHEAD` such steps are ignored.
const LEAP_AT: [f64; 5] = [0.455, 0.4, 0.52, 0.73, 0.36];
const LEAP_MORE: f64 = 1.2;
const LEAP_FROM: f64 = 0.42;
const LOOK_AHEAD: f64 = 1.4;
/// Part of the way to the singular position in which a step may end.
const FREE: f64 = 0.6;
/// Above this error relative to the tolerance, a stage has hit a singular position.
const STRUCK: f64 = 30.0;
/// Round-off in the error of a step from near a singular position, relative to the cube of its
/// magnification there, and its upper bound.
const NOISE: f64 = 200.0 * f64::EPSILON;
const MOST_NOISE: f64 = 1e-10;
/// Number of steps that are retried because they end too close to a singular position.
const KEPT_AWAY: usize = 3;

/// Width of the next step if a singular position is expected at the distance `d`. The error allows
/// steps of `width`, and the motion ends after `rest`. The step is a leap over the position, which
/// lies at the fraction `at` of it; it may exceed `width` by the factor `more` and go beyond the
/// end. Or the step ends where the leap begins.
fn approach(d: f64, width: f64, rest: f64, (at, more): (f64, f64)) -> Option<f64> {
    let leap = d / at;
    let short = d - LEAP_FROM * width;
    if d <= 0.0 || d > LOOK_AHEAD * width || rest < FREE * d {
        None
    } else if leap <= more * width {
        Some(leap)
    } else {
        (short < rest).then_some(short)
    }
}

/// Determines the widths of consecutive steps, as fractions of the duration.
#[derive(Debug)]
pub struct Controller {
    plan: StepPlan,
    /// Exponent 1/m of the controller.
    exponent: f64,
    estimates: bool,
    /// Factor for the next step, and the least one by which steps grow.
    factor: f64,
    keep: f64,
    rejected: bool,
    /// Kinks that adaptive steps must not pass, and the largest width.
    stops: Vec<f64>,
    widest: f64,
    /// The largest width that resolves the tangent.
    resolved: f64,
    /// Width before a stop shortened the step.
    uncut: Option<f64>,
    /// Smallest width, and its part that does not depend on time.
    least: f64,
    shortest: f64,
    /// Expected singular position, and the magnification of round-off at the step's start.
    ahead: Option<f64>,
    magnified: f64,
    /// Whether the step ends after the end of the motion.
    beyond: bool,
    /// Whether the step leaps over a singular position, and the number of leaps that failed before.
    leaping: bool,
    leaps: usize,
    /// Width of the step that failed, and the number of others tried since.
    leap: Option<(f64, usize)>,
    latest: f64,
    largest: f64,
    headway: Headway,
    clock: Option<Clock>,
    stopped: Option<Stop>,
}

#[derive(Clone, Debug)]
enum StepPlan {
    /// Given steps, and the number of the next one.
    Given { grid: Grid, next: usize },
    /// Adaptive steps: tolerance, and width of the next one.
    Chosen { tolerance: f64, width: f64 },
}

impl Controller {
    /// A controller for a method whose step error has the given order.
    pub fn new<S: Scalar>(
        settings: &Settings,
        order: usize,
        scale: &Scale,
        (model, duration): (&Model<S>, f64),
    ) -> Self {
        let (stops, widest) = (
            kinks(model, duration, settings.method),
            widest(model, duration),
        );
        let spacing = &settings.spacing;
        // The time in which the scene crosses its length, as a fraction of the duration.
        let swing = (scale.length / scale.floor[0]).min(1.0 / scale.floor[1]) / duration;
        let least = SMALLEST * swing.min(1.0);
        let widest = widest.max(10.0 * least);
        let plan = match spacing {
            Spacing::Steps(steps) => StepPlan::Given {
                grid: Grid::uniform(*steps),
                next: 1,
            },
            Spacing::Frozen(grid) => StepPlan::Given {
                grid: grid.fitted(&stops),
                next: 1,
            },
            Spacing::Tolerance(tolerance) => {
                let width = swing * tolerance.powf(1.0 / order as f64);
                StepPlan::Chosen {
                    tolerance: *tolerance,
                    width: width.clamp(least, 0.1),
                }
            }
        };
        Self {
            plan,
            exponent: 1.0 / order as f64,
            estimates: !spacing.is_equal(),
            factor: 1.0,
            keep: match settings.method {
                Method::Radau { .. } if !model.flexible.is_empty() => KEEP,
                _ => 1.0,
            },
            rejected: false,
            stops,
            widest,
            resolved: f64::INFINITY,
            uncut: None,
            least,
            shortest: least,
            ahead: None,
            magnified: 1.0,
            beyond: false,
            leaping: false,
            leaps: 0,
            leap: None,
            latest: 0.0,
            largest: 0.0,
            headway: Headway::new(model, &settings.limits),
            clock: Clock::start(&settings.limits, duration),
            stopped: None,
        }
    }

    /// An empty grid for the run, which grows from 0.
    pub fn growing(&self) -> Grid {
        match &self.plan {
            StepPlan::Given { grid, .. } => grid.to_grow(),
            StepPlan::Chosen { .. } => Grid::growing_to(&self.stops),
        }
    }

    /// The steps, if they are given.
    pub fn given(&self) -> Option<&Grid> {
        match &self.plan {
            StepPlan::Given { grid, .. } => Some(grid),
            StepPlan::Chosen { .. } => None,
        }
    }

    /// The intervals at whose ends the motion is sampled.
    pub fn intervals(&self, samples: Samples) -> Intervals {
        let count = samples.intervals();
        (self.given()).map_or_else(|| Intervals::equal(count), |grid| grid.intervals(count))
    }

    /// Number of steps, if they are given.
    pub fn steps(&self) -> Option<usize> {
        self.given().map(Grid::steps)
    }

    /// Whether the errors of steps are needed: to adapt the steps, or to check that they stay
    /// small.
    pub fn estimates(&self) -> bool {
        self.estimates
    }

    /// Width of the step from `reached`; `None` at the end, or if the march is
    /// [stopped](Self::stopped).
    pub fn next(&mut self, reached: f64) -> Option<f64> {
        self.headway.try_one();
        let (tries, rejected) = self.headway.so_far();
        let clock = self.clock.as_ref();
        if clock.is_some_and(Clock::is_over) {
            self.stopped = Some(Stop::Interrupted);
            return None;
        }
        if let Some(seconds) = clock.and_then(|c| c.look(reached, tries, rejected)) {
            self.stopped = Some(Stop::TimeLimit(seconds));
            return None;
        }
        match &mut self.plan {
            StepPlan::Given { grid, next } => (*next <= grid.steps()).then(|| grid.width(*next)),
            StepPlan::Chosen { width, .. } => {
                let rest = 1.0 - reached;
                if rest <= 0.0 {
                    return None;
                }
                self.least = self.shortest.max(ROUND_OFF * reached);
                if *width < self.least.min(rest) {
                    self.stopped = Some(Stop::TooSmall);
                    return None;
                }
                if let Some(stop) = self.headway.look(reached) {
                    self.stopped = Some(stop);
                    return None;
                }
                *width = width.min(self.widest).min(self.resolved);
                let ahead = self.ahead.map(|at| at - reached);
                let more = match self.rejected && self.leaps == 0 {
                    true => 1.0,
                    false => LEAP_MORE,
                };
                let leap = (LEAP_AT[self.leaps], more);
                let planned = ahead.and_then(|d| approach(d, *width, rest, leap));
                self.leaping = planned > ahead;
                if let Some(planned) = planned {
                    self.uncut.get_or_insert(*width);
                    *width = planned;
                }
                let least = self.least;
                let next = self.stops.iter().find(|&&at| at > reached + least);
                if let Some(at) = next.filter(|&&at| at < reached + *width) {
                    self.uncut.get_or_insert(*width);
                    *width = at - reached;
                }
                self.beyond = planned.is_some() && *width > rest;
                if planned.is_some() {
                    // `planned` is the width.
                } else if *width >= rest * (1.0 - 1e-10) {
                    // Two equal steps instead of a whole one and a remainder.
                    *width = rest;
                } else if *width > 0.5 * rest {
                    *width = 0.5 * rest;
                }
                // The width as the difference of the ends, so that frozen steps repeat it exactly.
                let width = *width;
                Some(self.end(reached, width) - reached)
            }
        }
    }

    /// The end of a step of `width` from `reached`. The last step ends exactly at 1, or after it if
    /// it leaps over a singular position.
    pub fn end(&self, reached: f64, width: f64) -> f64 {
        match &self.plan {
            StepPlan::Given { grid, next } => grid.ends()[*next],
            StepPlan::Chosen { .. } if width >= 1.0 - reached && !self.beyond => 1.0,
            StepPlan::Chosen { .. } => reached + width,
        }
    }

    /// Whether a step with the relative error `error` is accepted.
    pub fn judge(&mut self, error: f64) -> bool {
        match &mut self.plan {
            StepPlan::Given { .. } => {
                self.latest = error;
                true
            }
            StepPlan::Chosen { tolerance, width } => {
                let noise = (NOISE * self.magnified.powi(3)).min(MOST_NOISE);
                let relative = error / tolerance.max(noise);
                self.latest = error;
                let most = if self.rejected { 1.0 } else { GROW };
                let factor = (SAFETY * relative.powf(-self.exponent)).clamp(SHRINK, most);
                if relative <= 1.0 {
                    self.factor = match (1.0..self.keep).contains(&factor) {
                        true => 1.0,
                        false => factor,
                    };
                    true
                } else if self.leaping && relative > STRUCK && self.leaps + 1 < LEAP_AT.len() {
                    self.leaps += 1;
                    *width = self.uncut.take().unwrap_or(*width);
                    self.rejected = true;
                    self.headway.reject();
                    false
                } else {
                    self.leaps = 0;
                    self.uncut = None;
                    *width *= if relative.is_finite() {
                        factor.min(SAFETY)
                    } else {
                        SHRINK
                    };
                    self.rejected = true;
                    self.headway.reject();
                    false
                }
            }
        }
    }

    /// Records an accepted step.
    pub fn accept(&mut self) {
        self.leap = None;
        self.leaps = 0;
        self.largest = self.largest.max(self.latest);
        self.rejected = false;
        self.headway.accept();
        match &mut self.plan {
            StepPlan::Given { next, .. } => *next += 1,
            StepPlan::Chosen { width, .. } => {
                // A shortened step does not limit the next one.
                let wanted = self.uncut.take().unwrap_or(0.0);
                *width = (*width * self.factor).max(wanted * self.factor.min(1.0));
            }
        }
    }

    /// Whether the march ends after a step that failed. Otherwise another step is tried: a smaller
    /// one. Near a `singular` position other sizes come first, which may leap over it.
    pub fn give_up(&mut self, singular: bool) -> bool {
        match &mut self.plan {
            StepPlan::Given { .. } => true,
            StepPlan::Chosen { width, .. } => {
                let (from, tried) = self.leap.get_or_insert((*width, 0));
                match LEAPS.get(*tried).filter(|_| singular) {
                    Some(leap) => *width = *from * leap,
                    None => *width *= SHRINK,
                }
                *tried += 1;
                self.rejected = true;
                self.headway.reject();
                *width < self.least
            }
        }
    }

    /// As [`Controller::give_up`], for a step over a contact. The next step ends after this part of it.
    pub fn give_up_over(&mut self, part: f64) -> bool {
        match &mut self.plan {
            StepPlan::Given { .. } => true,
            StepPlan::Chosen { width, .. } => {
                self.uncut = None;
                *width *= part;
                self.rejected = true;
                self.headway.reject();
                *width < self.least
            }
        }
    }

    /// The reason why the march ended early, if it did.
    pub fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// Whether a step that ends too close to a singular position may be replaced by another.
    pub fn may_keep_away(&self) -> bool {
        let chosen = matches!(self.plan, StepPlan::Chosen { .. });
        chosen && self.leap.is_none_or(|(_, tried)| tried < KEPT_AWAY)
    }

    /// As [`Controller::give_up`], for a step that ended too close to a singular position. It is
    /// expected at the fraction `at` of the duration.
    pub fn give_up_near(&mut self, at: f64) -> bool {
        match &mut self.plan {
            StepPlan::Given { .. } => true,
            StepPlan::Chosen { width, .. } => {
                *width = self.uncut.take().unwrap_or(*width);
                let (_, tried) = self.leap.get_or_insert((*width, 0));
                *tried += 1;
                if *tried > KEPT_AWAY {
                    *width *= SHRINK;
                }
                self.ahead = Some(at);
                self.rejected = true;
                self.headway.reject();
                *width < self.least
            }
        }
    }

    /// Records the magnification of round-off at the end of the last step, and the fraction at
    /// which a singular position is expected, if any.
    pub fn expect(&mut self, magnified: f64, ahead: Option<f64>) {
        self.magnified = magnified;
        self.ahead = ahead.or(self.ahead);
    }

    /// Bounds the next steps by this width, which resolves the tangent.
    pub fn resolve(&mut self, width: f64) {
        self.resolved = width.max(10.0 * self.least);
    }

    /// Allowed error of steps: the tolerance, or the largest error of given steps so far.
    pub fn allowed(&self) -> f64 {
        match &self.plan {
            StepPlan::Given { .. } => self.largest.max(self.latest),
            StepPlan::Chosen { tolerance, .. } => *tolerance,
        }
    }

    /// Largest error of an accepted step, relative to the scale.
    pub fn largest_error(&self) -> f64 {
        self.largest
    }
}
