//! Step size control: what errors are measured against, and how large the next step is.

use super::grid::Grid;
use super::limits::Clock;
use super::settings::{Settings, Spacing};
use crate::math::Scalar;
use crate::model::course::Course;
use crate::model::table::breaks;
use crate::model::{Model, MotionCourse};
use crate::system::initial::InitialState;
use crate::system::{Numbering, assembly};

/// Safety factor of the next step, and how much it may shrink or grow.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;
/// Steps that are tried near a singular position, relative to the one that failed.
const LEAPS: [f64; 8] = [0.7, 1.3, 0.5, 1.8, 0.3, 2.5, 0.15, 4.0];
/// Smallest step, as a part of the time in which the scene crosses its length, and of the time that
/// has passed, whose round-off it must exceed.
const SMALLEST: f64 = 1e-12;
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// Where in a step that leaps over a singular position this stands: far from the stages, and from those
/// of the two halves of the step; and where else, if that fails. A leap may exceed the step that the
/// error allows by a factor; the step before it leaves a part of such a step to the singular
/// position; and one further away than so many steps is not looked at.
const LEAP_AT: [f64; 5] = [0.455, 0.4, 0.52, 0.73, 0.36];
const LEAP_MORE: f64 = 1.2;
const LEAP_FROM: f64 = 0.42;
const LOOK_AHEAD: f64 = 1.4;
/// Part of the way to the singular position that is free to end in.
const FREE: f64 = 0.6;
/// Error of a step, relative to the tolerance, that tells of a stage at the singular position.
const STRUCK: f64 = 30.0;
/// Round-off in the error of a step from near a singular position, relative to the cube of its
/// magnification there, and at most.
const NOISE: f64 = 200.0 * f64::EPSILON;
const MOST_NOISE: f64 = 1e-10;
/// Steps that are given up for others that end further away from a singular position.
const KEPT_AWAY: usize = 3;
/// Most tries of a run whose steps follow the error, and most of them that are rejected, times the
/// unknowns of the accelerations. The pace is looked at every so many tries: a run that would need more
/// at its latest pace is given up at once. A mechanism that is nearly locked rejects a quarter of its
/// tries; so may a fast vibration of one body, which costs little.
const MOST: usize = 10_000_000;
const MOST_REJECTED: usize = 2_000_000;
const PACE: usize = 5_000;

/// Lengths and speeds of a scene that errors are relative to.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Length (m).
    pub length: f64,
    /// Least speed (m/s) and angular speed (rad/s) to be relative to.
    pub floor: [f64; 2],
}

impl Scale {
    /// The scale of a model that starts in `start` and moves for `duration` (s): its largest lever
    /// arm; the speed at its start or that of a fall over the length.
    pub fn of<S: Scalar>(
        model: &Model<S>,
        numbering: &Numbering,
        start: &InitialState<S>,
        duration: f64,
    ) -> Self {
        let length = assembly::length_scale(model);
        let gravity = largest(model.gravity.as_slice());
        let fall = (gravity * length).sqrt();
        let [speed, spin] = fastest(numbering, &start.v);
        let drift = if fall > 0.0 { fall } else { length / duration };
        Self {
            length,
            floor: [speed.max(drift), spin.max(drift / length)],
        }
    }

    /// Speeds that the errors of a step between the velocities `v` and `w` are relative to.
    pub fn speeds<S: Scalar>(&self, numbering: &Numbering, v: &[S], w: &[S]) -> [f64; 2] {
        let (v, w) = (fastest(numbering, v), fastest(numbering, w));
        std::array::from_fn(|i| self.floor[i].max(v[i]).max(w[i]))
    }

    /// Mean square of a difference of positions and velocities, each relative to its scale.
    pub fn square<S: Scalar>(
        &self,
        numbering: &Numbering,
        q: &[S],
        v: &[S],
        speeds: [f64; 2],
    ) -> f64 {
        let part = |x: &[S], scale: f64| -> f64 {
            x.iter().map(|x| (x.re() / scale) * (x.re() / scale)).sum()
        };
        let mut sum = 0.0;
        for body in 0..numbering.bodies() {
            let q = &q[numbering.position(body)..][..7];
            let v = &v[numbering.velocity(body)..][..6];
            sum += part(&q[..3], self.length) + part(&q[3..], 1.0);
            sum += part(&v[..3], speeds[0]) + part(&v[3..], speeds[1]);
        }
        sum / (q.len() + v.len()).max(1) as f64
    }

    /// As [`Scale::square`] for a tangent change y of positions and h times one of velocities.
    pub fn tangent_square(&self, y: &[f64], hv: &[f64], h: f64, speeds: [f64; 2]) -> f64 {
        let part = |x: &[f64], scale: f64| -> f64 { x.iter().map(|x| (x / scale).powi(2)).sum() };
        let both = y.chunks_exact(6).zip(hv.chunks_exact(6));
        let sum: f64 = both
            .map(|(y, v)| {
                part(&y[..3], self.length)
                    + part(&y[3..], 1.0)
                    + part(&v[..3], h * speeds[0])
                    + part(&v[3..], h * speeds[1])
            })
            .sum();
        sum / (2 * y.len()).max(1) as f64
    }
}

fn fastest<S: Scalar>(numbering: &Numbering, v: &[S]) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for body in 0..numbering.bodies() {
        let v = &v[numbering.velocity(body)..][..6];
        most[0] = most[0].max(largest(&v[..3]));
        most[1] = most[1].max(largest(&v[3..]));
    }
    most
}

fn largest<S: Scalar>(x: &[S]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}

/// Unknowns of the accelerations: velocities and multipliers.
fn unknowns<S>(model: &Model<S>) -> usize {
    let velocities = model.bodies.iter().map(|body| body.mobility.unknowns());
    let rows = model.joints.iter().map(|joint| joint.rows().count());
    velocities.chain(rows).sum()
}

/// Part of a period of the fastest harmonic load that a step may take.
const PART_OF_PERIOD: f64 = 0.25;

/// What the loads and drives of a model say of the steps: fractions of the duration at which steps must end,
/// ascending, and their largest width.
fn load_steps<S: Scalar>(model: &Model<S>, duration: f64) -> (Vec<f64>, f64) {
    let mut stops = Vec::new();
    let mut widest = 1.0_f64;
    for course in model.loads.iter().filter_map(|load| load.kind.course()) {
        match course {
            Course::Constant(_) => {}
            Course::Harmonic { frequency, .. } => {
                let period = 1.0 / frequency.re().abs();
                widest = widest.min(PART_OF_PERIOD * period / duration);
            }
            Course::Table {
                times,
                interpolation,
                ..
            } => stops.extend(breaks(times, *interpolation, false)),
        }
    }
    for drive in model.joints.iter().flat_map(|joint| &joint.drives) {
        match &drive.course {
            MotionCourse::Polynomial(_) => {}
            MotionCourse::Harmonic { frequency, .. } => {
                let period = 1.0 / frequency.re().abs();
                widest = widest.min(PART_OF_PERIOD * period / duration);
            }
            MotionCourse::Table {
                times,
                interpolation,
                ..
            } => stops.extend(breaks(times, *interpolation, true)),
        }
    }
    stops.iter_mut().for_each(|at| *at /= duration);
    stops.retain(|&at| at > 0.0 && at < 1.0);
    stops.sort_by(f64::total_cmp);
    (stops, widest)
}

/// Width of the next step where a singular position is expected at the distance `d`, the error allows
/// steps of `width`, and the motion ends after `rest`: a leap over it, at the fraction `at` of the step,
/// which may exceed `width` by the factor `more` and reach beyond the end; or a step to where the leap
/// may begin.
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

/// Gives the width of one step after the other, in fractions of the duration.
#[derive(Debug)]
pub struct Controller {
    plan: Plan,
    /// Exponent 1/m of the controller.
    exponent: f64,
    estimates: bool,
    /// Factor for the step to come.
    factor: f64,
    rejected: bool,
    /// Ends that chosen steps must not step over, and the largest width (see [`load_steps`]).
    stops: Vec<f64>,
    widest: f64,
    /// Width that was wanted where a stop cut the step.
    uncut: Option<f64>,
    /// Smallest width, and the part of it that does not depend on the time.
    least: f64,
    shortest: f64,
    /// Where a singular position is expected, and the magnification of round-off at the step's start.
    ahead: Option<f64>,
    magnified: f64,
    /// Whether the step reaches beyond the end.
    beyond: bool,
    /// Whether the step leaps over a singular position, and how many leaps failed before.
    leaping: bool,
    leaps: usize,
    /// Width of the step that could not be made, and how many others were tried since.
    leap: Option<(f64, usize)>,
    latest: f64,
    largest: f64,
    /// Tries and rejected ones so far.
    tries: usize,
    refused: usize,
    /// Fraction of the duration and rejected tries when the pace was looked at.
    looked: (f64, usize),
    /// Most rejected tries.
    most_rejected: usize,
    clock: Option<Clock>,
    stopped: Option<Stop>,
}

/// Why a march ended before the end of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The steps became too small.
    TooSmall,
    /// The latest `tries`, `rejected` of them rejected, advanced the motion by the fraction `advance`
    /// of its duration; at this pace it would need too many.
    NoHeadway {
        /// Tries.
        tries: usize,
        /// Rejected ones among them.
        rejected: usize,
        /// Fraction of the duration.
        advance: f64,
    },
    /// It took longer than it may \[s\].
    TimeLimit(f64),
}

#[derive(Clone, Debug)]
enum Plan {
    /// Steps that are given, and the number of the next one.
    Given { grid: Grid, next: usize },
    /// Chosen by the error: tolerance and width of the next step.
    Chosen { tolerance: f64, width: f64 },
}

impl Controller {
    /// A controller for a method whose steps have an error of the given order.
    pub fn new<S: Scalar>(
        settings: &Settings,
        order: usize,
        scale: &Scale,
        (model, duration): (&Model<S>, f64),
    ) -> Self {
        let (stops, widest) = load_steps(model, duration);
        let spacing = &settings.spacing;
        // The time in which the scene crosses its length.
        let swing = (scale.length / scale.floor[0]).min(1.0 / scale.floor[1]) / duration;
        let least = SMALLEST * swing.min(1.0);
        let widest = widest.max(10.0 * least);
        let plan = match spacing {
            Spacing::Steps(steps) => Plan::Given {
                grid: Grid::uniform(*steps),
                next: 1,
            },
            Spacing::Frozen(grid) => Plan::Given {
                grid: grid.clone(),
                next: 1,
            },
            Spacing::Tolerance(tolerance) => {
                let width = swing * tolerance.powf(1.0 / order as f64);
                Plan::Chosen {
                    tolerance: *tolerance,
                    width: width.clamp(least, 0.1),
                }
            }
        };
        Self {
            plan,
            exponent: 1.0 / order as f64,
            estimates: !matches!(spacing, Spacing::Steps(_)),
            factor: 1.0,
            rejected: false,
            stops,
            widest,
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
            tries: 0,
            refused: 0,
            looked: (0.0, 0),
            // Who says how long it may take says so instead.
            most_rejected: match settings.limits.seconds {
                Some(_) => MOST,
                None => MOST_REJECTED / unknowns(model).max(1),
            },
            clock: Clock::start(&settings.limits, duration),
            stopped: None,
        }
    }

    /// The grid of the run, which grows from 0.
    pub fn growing(&self) -> Grid {
        match &self.plan {
            Plan::Given { grid, .. } => grid.to_grow(),
            Plan::Chosen { .. } => Grid::growing(),
        }
    }

    /// Number of steps, where they are given.
    pub fn steps(&self) -> Option<usize> {
        match &self.plan {
            Plan::Given { grid, .. } => Some(grid.steps()),
            Plan::Chosen { .. } => None,
        }
    }

    /// Whether the error of steps is of interest: they follow it, or are kept as long as it is small.
    pub fn estimates(&self) -> bool {
        self.estimates
    }

    /// Width of the step from `reached`, or `None` at the end or if the march is [stopped](Self::stopped).
    pub fn next(&mut self, reached: f64) -> Option<f64> {
        self.tries += 1;
        let clock = self.clock.as_ref();
        if let Some(seconds) = clock.and_then(|c| c.look(reached, self.tries, self.refused)) {
            self.stopped = Some(Stop::TimeLimit(seconds));
            return None;
        }
        match &mut self.plan {
            Plan::Given { grid, next } => (*next <= grid.steps()).then(|| grid.width(*next)),
            Plan::Chosen { width, .. } => {
                let rest = 1.0 - reached;
                if rest <= 0.0 {
                    return None;
                }
                self.least = self.shortest.max(ROUND_OFF * reached);
                if *width < self.least.min(rest) {
                    self.stopped = Some(Stop::TooSmall);
                    return None;
                }
                if self.tries.is_multiple_of(PACE) {
                    let advance = reached - self.looked.0;
                    let rejected = self.refused - self.looked.1;
                    let too_many = |latest: usize, so_far: usize, most: usize| {
                        latest as f64 * rest > advance * most.saturating_sub(so_far) as f64
                    };
                    if too_many(PACE, self.tries, MOST)
                        || too_many(rejected, self.refused, self.most_rejected)
                    {
                        self.stopped = Some(Stop::NoHeadway {
                            tries: PACE,
                            rejected,
                            advance,
                        });
                        return None;
                    }
                    self.looked = (reached, self.refused);
                }
                *width = width.min(self.widest);
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
                    // It was said above how far the step goes.
                } else if *width >= rest * (1.0 - 1e-10) {
                    // Two equal steps rather than a whole one and a remainder.
                    *width = rest;
                } else if *width > 0.5 * rest {
                    *width = 0.5 * rest;
                }
                // The width that the ends of the steps tell, so that kept steps repeat it exactly.
                let width = *width;
                Some(self.end(reached, width) - reached)
            }
        }
    }

    /// The end of a step of `width` from `reached`; the last one ends at 1 exactly, or beyond it if it
    /// leaps over a singular position.
    pub fn end(&self, reached: f64, width: f64) -> f64 {
        match &self.plan {
            Plan::Given { grid, next } => grid.ends()[*next],
            Plan::Chosen { .. } if width >= 1.0 - reached && !self.beyond => 1.0,
            Plan::Chosen { .. } => reached + width,
        }
    }

    /// Whether a step whose error relative to the scale is `error` is accepted.
    pub fn judge(&mut self, error: f64) -> bool {
        match &mut self.plan {
            Plan::Given { .. } => {
                self.latest = error;
                true
            }
            Plan::Chosen { tolerance, width } => {
                let noise = (NOISE * self.magnified.powi(3)).min(MOST_NOISE);
                let relative = error / tolerance.max(noise);
                self.latest = error;
                let most = if self.rejected { 1.0 } else { GROW };
                let factor = (SAFETY * relative.powf(-self.exponent)).clamp(SHRINK, most);
                if relative <= 1.0 {
                    self.factor = factor;
                    true
                } else if self.leaping && relative > STRUCK && self.leaps + 1 < LEAP_AT.len() {
                    self.leaps += 1;
                    *width = self.uncut.take().unwrap_or(*width);
                    self.rejected = true;
                    self.refused += 1;
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
                    self.refused += 1;
                    false
                }
            }
        }
    }

    /// Records that the step was made.
    pub fn accept(&mut self) {
        self.leap = None;
        self.leaps = 0;
        self.largest = self.largest.max(self.latest);
        self.rejected = false;
        match &mut self.plan {
            Plan::Given { next, .. } => *next += 1,
            Plan::Chosen { width, .. } => {
                // A step that was cut short says little of the next one.
                let wanted = self.uncut.take().unwrap_or(0.0);
                *width = (*width * self.factor).max(wanted * self.factor.min(1.0));
            }
        }
    }

    /// Whether a step that could not be made is the end; otherwise another is tried: a smaller one
    /// or, near a `singular` position, which it may leap over, one of another size first.
    pub fn give_up(&mut self, singular: bool) -> bool {
        match &mut self.plan {
            Plan::Given { .. } => true,
            Plan::Chosen { width, .. } => {
                let (from, tried) = self.leap.get_or_insert((*width, 0));
                match LEAPS.get(*tried).filter(|_| singular) {
                    Some(leap) => *width = *from * leap,
                    None => *width *= SHRINK,
                }
                *tried += 1;
                self.rejected = true;
                self.refused += 1;
                *width < self.least
            }
        }
    }

    /// Why the march ended before the end of its motion, if it did.
    pub fn stopped(&self) -> Option<Stop> {
        self.stopped
    }

    /// Whether a step may be given up for another that keeps away from a singular position.
    pub fn may_keep_away(&self) -> bool {
        let chosen = matches!(self.plan, Plan::Chosen { .. });
        chosen && self.leap.is_none_or(|(_, tried)| tried < KEPT_AWAY)
    }

    /// As [`Controller::give_up`] for a step that ended too close to a singular position, expected at the
    /// fraction `at` of the duration.
    pub fn give_up_near(&mut self, at: f64) -> bool {
        match &mut self.plan {
            Plan::Given { .. } => true,
            Plan::Chosen { width, .. } => {
                *width = self.uncut.take().unwrap_or(*width);
                let (_, tried) = self.leap.get_or_insert((*width, 0));
                *tried += 1;
                if *tried > KEPT_AWAY {
                    *width *= SHRINK;
                }
                self.ahead = Some(at);
                self.rejected = true;
                self.refused += 1;
                *width < self.least
            }
        }
    }

    /// Takes notice of how round-off is magnified at the end of the step made last, and of where a
    /// singular position is expected, if one is.
    pub fn expect(&mut self, magnified: f64, ahead: Option<f64>) {
        self.magnified = magnified;
        self.ahead = ahead.or(self.ahead);
    }

    /// Error that steps may have: the tolerance, or what those that are given had so far.
    pub fn allowed(&self) -> f64 {
        match &self.plan {
            Plan::Given { .. } => self.largest.max(self.latest),
            Plan::Chosen { tolerance, .. } => *tolerance,
        }
    }

    /// Largest error of an accepted step, relative to the scale.
    pub fn largest_error(&self) -> f64 {
        self.largest
    }
}
