//! The way of a machine to [rest](super::rest): downhill in energy, without swinging.
//!
//! With a metric M̃ and K = −∂f/∂q + ∂(Gᵀ λ)/∂q, a step is
//!
//! ```text
//! [K + σ M̃, Gᵀ; G, 0] [δq; δλ] = −[balance; Φ]
//! ```
//!
//! A large σ goes along the forces; σ → 0 is Newton's method (pseudo-transient continuation; Kelley & Keyes 1998, *SIAM J.
//! Numer. Anal.* 35, 508). As in the method of Levenberg and Marquardt, σ follows from the gain of a step: the energy
//! that it releases, ½ (g_0 + g_1)ᵀ δq with the balance g before and after by the new reactions, over that foreseen,
//! g_0ᵀ δq + ½ δqᵀ K δq. σ rises where δqᵀ (K + σ M̃) δq is not positive, as the equations lead uphill there.
//!
//! An equilibrium that is not stable is left along the motion that grows, unless the machine was placed there. Motions that
//! nothing resists and nothing drives stay as placed, by the smallest σ.

use super::equations::State;
use super::matrix::{Factors, RigidMetric};
use super::pencil::{At, Matrices};
use super::rest::{FLOOR, FREE, ROUND_OFF, remove};
use super::{CLOSE, LARGEST, STAGNANT, Solver};
use crate::math::slices::dot;
use crate::system::failure::AssemblyFailure;
use crate::system::turns;

const ITERATIONS: usize = 500;
/// σ changes by these factors after a good step and a bad one, and after one that was cut to less than half.
const FALL: f64 = 0.1;
const RISE: f64 = 10.0;
const CUT: f64 = 4.0;
/// The smallest σ, relative to the rate of the placement, falls to this where steps converge by more than `SLOW` each.
const LEAST_FLOOR: f64 = 1e-14;
const SLOW: f64 = 0.3;
/// The largest σ, relative to the rate.
const LARGEST_SHIFT: f64 = 1e15;
/// A step is taken above the first gain and good above the second.
const LEAST_GAIN: f64 = 0.05;
const GOOD_GAIN: f64 = 0.5;
/// A shorter step says nothing of the energy.
const SHORT: f64 = 1e-7;
/// Motions with less than so many times the stiffness σ converge slowly by it.
const FLOORED: f64 = 100.0;
/// Accelerations below this, relative to those of the placement, are round-off, and so many slow steps the end.
const BALANCED: f64 = 1e-11;
const SLOW_STEPS: usize = 3;
/// σ at which steps go along the forces, relative to the rate without joints; and the least rate relative to it.
const ALONG_FORCES: f64 = 1e6;
const LEAST_RATE: f64 = 1e-2;
/// A machine that has moved less was placed at rest. An equilibrium that is not stable is left by the next length; so often.
const PLACED: f64 = 1e-6;
const LEFT_BY: f64 = 0.02;
const LEAVES: usize = 20;

/// A last step of this part of the way, or less, is the end.
const SETTLED: f64 = 1e-10;

/// A step before it is cut.
struct Step {
    change: Vec<f64>,
    /// Largest change of a position.
    size: f64,
    /// δqᵀ (K + σ M̃) δq.
    curvature: f64,
    /// δqᵀ M̃ δq.
    square: f64,
}

impl Solver<'_> {
    /// The descent from the placement. Its end becomes known.
    pub(super) fn rest(&self) -> Result<State<f64>, AssemblyFailure> {
        let layout = self.layout;
        let none = |iterations| AssemblyFailure::NoRest { iterations };
        let mut factors = Factors::plan(layout, self.model, &layout.start(self.given));
        let mut x = self.released(&mut factors)?;
        let rate = x.rate;
        let mut residual = layout.residual(self.model, self.given, &x);
        let (mut shift, mut floor) = (rate, FLOOR * rate);
        let (mut before, mut away, mut leaves) = (f64::INFINITY, 0.0, 0);
        let mut slow: Vec<State<f64>> = Vec::new();
        for iteration in 1..=ITERATIONS {
            if shift > LARGEST_SHIFT * rate {
                return Err(none(iteration));
            }
            let made = factors.make(layout, self.model, (&x, shift));
            made.map_err(|_| none(iteration))?;
            let step = self.step(&mut factors, &residual, &x);
            if !step.size.is_finite() {
                return Err(none(iteration));
            }
            if step.size > SHORT && step.curvature <= 0.0 {
                x.snapped = true;
                shift *= RISE;
                continue;
            }
            let part = (LARGEST / step.size).min(1.0);
            let change: Vec<f64> = step.change.iter().map(|x| part * x).collect();
            let mut next = x.clone();
            layout.advance(&mut next, &change);
            turns::count(self.model, layout.numbering, &mut next.q);
            let left = layout.residual(self.model, self.given, &next);
            let gain = match step.size > SHORT {
                true => self.gain(shift, (&step, part), [&residual, &left]),
                false => 1.0,
            };
            if gain.is_nan() || gain <= LEAST_GAIN {
                shift *= RISE;
                continue;
            }
            (x, residual) = (next, left);
            away += part * step.size;
            let slowly = step.size > SLOW * before;
            let stiffness = step.curvature / step.square;
            let rounding = step.size <= STAGNANT || stiffness * step.size <= BALANCED * rate;
            match slowly && rounding {
                true => slow.push(x.clone()),
                false => slow.clear(),
            }
            if step.size <= CLOSE || slow.len() == SLOW_STEPS {
                // Later ones have drifted.
                let end = slow.first().cloned().unwrap_or(x);
                // Gyroscopic forces may hold a machine that turns where its stiffness does not.
                let leaves_it = away > PLACED && leaves < LEAVES && layout.turning.is_none();
                let growing = match leaves_it {
                    true => self.growing(&mut factors, &end)?,
                    false => None,
                };
                let Some(along) = growing else {
                    // Rotation is a load of every machine that turns, and not a small one.
                    let is_short = step.size > SETTLED * away && layout.turning.is_none();
                    let end = match is_short {
                        true => self.settled(&mut factors, end, away)?,
                        false => end,
                    };
                    self.same_when_turned(&end)?;
                    self.known.keep(&self.numbers, &end);
                    return Ok(end);
                };
                (x, shift, leaves) = (end, rate, leaves + 1);
                self.leave(&mut x, &along, &change);
                residual = layout.residual(self.model, self.given, &x);
                before = f64::INFINITY;
                slow.clear();
                continue;
            }
            // Slow by the shift, not by the way.
            if shift <= floor && slowly && stiffness < FLOORED * shift {
                floor = (FALL * floor).max(LEAST_FLOOR * rate);
            }
            if part < 0.5 {
                shift *= CUT;
            } else if gain > GOOD_GAIN {
                shift = (FALL * shift).max(floor);
            }
            before = step.size;
        }
        self.factorise_at(&mut factors, &x)?;
        self.not_held(&mut factors, &x)?;
        Err(none(ITERATIONS))
    }

    /// The end of a descent whose last steps σ may have made short: under loads that are small beside the stiffness of the
    /// machine they are as short as round-off. Newton's method goes on with a smaller σ, but not along free motions, nor where
    /// the stiffness is round-off.
    fn settled(
        &self,
        factors: &mut Factors,
        end: State<f64>,
        mut away: f64,
    ) -> Result<State<f64>, AssemblyFailure> {
        let layout = self.layout;
        let y = layout.groups()[0].clone();
        self.factorise_at(factors, &end)?;
        let free = self.free_motions(factors, &end)?;
        let stiffest = Matrices::new(At::rest(layout, self.model, &end, None), false).stiffest();
        let (mut x, mut shift, mut before) = (end, FLOOR, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let residual = layout.residual(self.model, self.given, &x);
            let mut step = self.step(factors, &residual, &x);
            let stiffness = step.curvature / step.square - shift * x.rate;
            for own in &free {
                remove(own, &mut step.change[y.clone()]);
            }
            let size = self.moved(&x, &step.change);
            let slowly = size > SLOW * before;
            let resolved = stiffness > ROUND_OFF * stiffest && size <= LEFT_BY;
            if !resolved || slowly && shift <= FREE {
                break;
            }
            layout.advance(&mut x, &step.change);
            turns::count(self.model, layout.numbering, &mut x.q);
            away += size;
            if size <= SETTLED * away {
                break;
            }
            if slowly {
                shift *= FALL;
                let made = factors.make(layout, self.model, (&x, shift * x.rate));
                made.map_err(|_| AssemblyFailure::Singular)?;
            }
            before = size;
        }
        Ok(x)
    }

    /// The placement with reactions and its rate, the first σ: the largest acceleration by length of the scene.
    fn released(&self, factors: &mut Factors) -> Result<State<f64>, AssemblyFailure> {
        let layout = self.layout;
        let mut x = layout.start(self.given);
        let residual = layout.residual(self.model, self.given, &x);
        let turning = layout.turning.as_ref();
        let spin = turning.map_or(0.0, |own| own.speed * own.speed);
        let mut without_joints = self.rate(&residual);
        // Gravity is a load of every machine, and rotation one of those that turn.
        if spin == 0.0
            && self.model.gravity.norm() == 0.0
            && let Some(rate) = self.rate_of_stiffness(factors, (&x, without_joints))?
        {
            x.rate = rate;
            return Ok(x);
        }
        if without_joints == 0.0 {
            without_joints = 1.0;
        }
        let shift = ALONG_FORCES * without_joints;
        let made = factors.make(layout, self.model, (&x, shift));
        made.map_err(|_| AssemblyFailure::Singular)?;
        let mut change = self.step(factors, &residual, &x).change;
        change[layout.groups()[0].clone()].fill(0.0);
        layout.advance(&mut x, &change);
        let with_joints = self.rate(&layout.residual(self.model, self.given, &x));
        x.rate = with_joints.max(LEAST_RATE * without_joints).max(spin);
        Ok(x)
    }

    /// The largest acceleration of a body that the balance in `residual` leaves, per length of the scene \[1/s²\].
    fn rate(&self, residual: &[f64]) -> f64 {
        let layout = self.layout;
        let forces = layout.expanded(residual[layout.groups()[0].clone()].to_vec());
        let metric = RigidMetric::of(self.model);
        let bodies = self.model.bodies.iter().enumerate();
        let rates = bodies
            .filter(|&(i, _)| !self.model.is_internal(i))
            .map(|(i, body)| {
                let six = &forces[layout.numbering.velocity(i)..][..6];
                let size = |x: &[f64]| dot(x, x).sqrt();
                let [mass, _] = metric.of_body(body);
                if body.role.is_angle() {
                    return size(&six[..3]) / mass;
                }
                let force = size(&six[..3]).max(size(&six[3..]) / self.scale);
                force / (mass * self.scale)
            });
        rates.fold(0.0, f64::max)
    }

    /// The step by the present factors.
    fn step(&self, factors: &mut Factors, residual: &[f64], x: &State<f64>) -> Step {
        let [y, _, _, lambda, ..] = self.layout.groups();
        let mut change: Vec<f64> = residual.iter().map(|x| -x).collect();
        factors.solve(&mut change);
        let gaps = dot(&residual[lambda.clone()], &change[lambda]);
        let finite = change.iter().all(|x| x.is_finite());
        Step {
            size: match finite {
                true => self.moved(x, &change),
                false => f64::NAN,
            },
            curvature: gaps - dot(&residual[y.clone()], &change[y.clone()]),
            square: {
                let motions = self.layout.at_rest(&x.q);
                dot(
                    &self.metric_product(&motions, &change[y.clone()]),
                    &change[y],
                )
            },
            change,
        }
    }

    /// The energy that a part of a step releases, relative to that foreseen.
    fn gain(&self, shift: f64, (step, part): (&Step, f64), [before, after]: [&[f64]; 2]) -> f64 {
        let y = self.layout.groups()[0].clone();
        let moved: Vec<f64> = step.change[y.clone()].iter().map(|x| part * x).collect();
        let [curvature, square] = [step.curvature, step.square].map(|own| part * part * own);
        // By the new reactions.
        let slope = (1.0 - part) * dot(&before[y.clone()], &moved) - curvature;
        let foreseen = slope + 0.5 * (curvature - shift * square);
        let released = 0.5 * (slope + dot(&after[y], &moved));
        match foreseen < 0.0 {
            true => released / foreseen,
            false => 1.0,
        }
    }

    /// Leaves an equilibrium by the motion `along`, onwards as the machine came by `last`.
    fn leave(&self, x: &mut State<f64>, along: &[f64], last: &[f64]) {
        let y = self.layout.groups()[0].clone();
        let length = LEFT_BY / self.moved(x, along);
        let back = dot(&along[y.clone()], &last[y]) < 0.0;
        let length = if back { -length } else { length };
        let step: Vec<f64> = along.iter().map(|x| length * x).collect();
        self.layout.advance(x, &step);
        x.snapped = true;
    }
}
