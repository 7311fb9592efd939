//! Filter line search of the barrier problem (Wächter & Biegler 2006, section 2.3 and 2.4).

use nalgebra::DVector;

use crate::constants::MOST_STEPS;
use crate::interior_point::direction::{Direction, NewtonSystem};
use crate::interior_point::filter::{Filter, MARGIN, Measure, SLOPE_POWER, THETA_POWER};
use crate::interior_point::iterate::{Iterate, Layout};
use crate::linear::quasi_newton::QuasiNewton;
use crate::program::{Derivatives, EarlyExit, Point, Program};

/// Longest step, relative to the size of the point. Without it two problems of the bed are lost: a
/// step to the end of an exponential function.
const LONGEST: f64 = 100.0;

/// A step that took more trials than this counts as short. Two short steps in succession show that
/// the quasi-Newton matrix misleads, or four far from feasible points the filter. Without this, two
/// problems of the bed are lost. After so many trials a step is accepted that reduces the residual of
/// the conditions alone: without that a plate of 256 thicknesses crawls, as its matrix of few pairs
/// misleads the filter (256 simulations and more, 55 with it).
pub(crate) const SHORT_TRIALS: usize = 7;

/// Factor by which a step must reduce what alone speaks for it: the residual of the conditions, or in a
/// restoration the violation. Any decrease lets exponential rows crawl from far starts to the limit.
pub(crate) const GAIN: f64 = 0.9;

/// Least factor by which a refused step is shortened, and a corrected one may be shorter. By halving
/// alone, two problems of the bed are lost.
const SHORTEST: f64 = 0.1;

/// Below this sum of scaled residuals a point counts as feasible. The residuals are then mostly
/// rounding, and the barrier function alone decides. A tenth or ten times as much is the same.
const FEASIBLE: f64 = 1e-9;

/// Infeasibility θ of the residuals `r` of rows whose values are `c`.
pub(crate) fn infeasibility(r: &DVector<f64>, c: &DVector<f64>) -> f64 {
    (r.lp_norm(1) - FEASIBLE - 10.0 * f64::EPSILON * c.lp_norm(1)).max(0.0)
}

/// A point that the search accepted.
pub(crate) struct Accepted {
    pub point: Point,
    pub slopes: Derivatives,
    pub s: DVector<f64>,
    pub alpha: f64,
    /// The direction of the accepted step.
    pub direction: Direction,
    pub trials: usize,
}

/// Smallest relative change of a variable that exceeds rounding. Without it the bed takes 2 % more
/// evaluations.
const RESOLUTION: f64 = 1e-15;

/// Data of one search.
pub(crate) struct LineSearch<'s> {
    pub layout: &'s Layout,
    pub at: &'s Iterate,
    pub system: &'s NewtonSystem,
    pub mu: f64,
    pub tau: f64,
    /// Infeasibility below which the objective decides.
    pub theta_small: f64,
}

enum Trial {
    Accepted(Box<(Point, Derivatives, DVector<f64>)>),
    Refused {
        theta: f64,
        phi: f64,
        c: DVector<f64>,
        point: Point,
    },
    Undefined,
}

impl LineSearch<'_> {
    /// Searches along `direction`; `None` if the step becomes too small. The filter is augmented
    /// when a step is accepted for its feasibility.
    pub(crate) fn run(
        &self,
        program: &mut Program<'_>,
        b: &mut QuasiNewton,
        filter: &mut Filter,
        direction: Direction,
    ) -> Result<Option<Accepted>, EarlyExit> {
        let r = self.layout.residual(&self.at.point.c, &self.at.s);
        let here = Measure {
            theta: infeasibility(&r, &self.at.point.c),
            phi: self.layout.barrier_function(
                self.at.point.f,
                &self.at.point.x,
                &self.at.s,
                self.mu,
            ),
            slope: self.slope(&direction),
            theta_small: self.theta_small,
        };
        let room = LONGEST * self.at.point.x.amax().max(1.0);
        let cap = room / direction.x.amax().max(f64::MIN_POSITIVE);
        let longest = direction
            .primal_limit(self.at, self.layout, self.tau)
            .min(cap);
        let least = self.least_step(&here);
        let mut first = None;
        let mut alpha = longest;
        let mut trials = 0;
        let resolved = self.least_resolved_step(&direction);
        loop {
            let goes_on = alpha >= least && alpha > resolved;
            if (!goes_on || trials >= SHORT_TRIALS)
                && let Some(point) = first.take()
                && let Some((point, slopes, s)) =
                    self.soft(program, &here, point, &direction, longest)?
            {
                filter.clear();
                return Ok(Some(Accepted {
                    point,
                    slopes,
                    s,
                    alpha: longest,
                    direction,
                    trials,
                }));
            }
            if !goes_on {
                return Ok(match trials == 0 && here.theta == 0.0 {
                    true => self.multipliers_alone(direction, longest),
                    false => None,
                });
            }
            trials += 1;
            let lengths = (alpha, alpha);
            let trial = self.attempt(program, filter, &here, &direction, lengths)?;
            let mut last = None;
            if let Trial::Refused {
                theta, phi, point, ..
            } = &trial
            {
                last = Some((*theta, *phi));
                if trials == 1 {
                    first = Some(point.clone());
                }
            }
            match trial {
                Trial::Accepted(found) => {
                    let (point, slopes, s) = *found;
                    return Ok(Some(Accepted {
                        point,
                        slopes,
                        s,
                        alpha,
                        direction,
                        trials,
                    }));
                }
                Trial::Refused { theta, c, .. } if trials == 1 && theta > here.theta => {
                    let refused = (alpha, direction.size(), c);
                    let corrected = self.correct(program, b, filter, &here, refused)?;
                    if corrected.is_some() {
                        return Ok(corrected);
                    }
                    trials = 2;
                }
                Trial::Refused { .. } => {}
                Trial::Undefined => self.foresee(program, &direction, alpha),
            }
            alpha *= self.shorten(&here, alpha, &last);
        }
    }

    /// Announces the shorter steps that follow if the functions are undefined at step length
    /// `alpha`.
    fn foresee(&self, program: &mut Program<'_>, direction: &Direction, alpha: f64) {
        let half = |length: &f64| Some(0.5 * length);
        let lengths = std::iter::successors(half(&alpha), half).take(MOST_STEPS);
        program.foresee(lengths.map(|length| &self.at.point.x + &direction.x * length));
    }

    /// Factor by which a refused step is shortened. If the barrier function refused the step, it is
    /// the minimum of the parabola through its values, within bounds.
    fn shorten(&self, here: &Measure, alpha: f64, last: &Option<(f64, f64)>) -> f64 {
        let Some((theta, phi)) = *last else {
            return 0.5;
        };
        let rise = phi - here.phi - alpha * here.slope;
        if here.slope >= 0.0 || rise <= 0.0 || theta > here.theta.max(self.theta_small) {
            return 0.5;
        }
        (-0.5 * alpha * here.slope / rise).clamp(SHORTEST, 0.5)
    }

    /// Gradients at the first trial point if this point reduces the residual of the optimality
    /// conditions. Used if the change of the barrier function is lost in rounding, or if curvature
    /// misleads the filter.
    fn soft(
        &self,
        program: &mut Program<'_>,
        here: &Measure,
        point: Point,
        direction: &Direction,
        alpha: f64,
    ) -> Result<Option<(Point, Derivatives, DVector<f64>)>, EarlyExit> {
        let violation = self.layout.residual(&self.at.point.c, &self.at.s).amax();
        let s = &self.at.s + &direction.s * alpha;
        let rise = self.layout.barrier_function(point.f, &point.x, &s, self.mu) - here.phi;
        let tolerance = program.options.tolerance;
        if violation > tolerance || rise > tolerance * here.phi.abs().max(1.0) {
            return Ok(None);
        }
        let slopes = match program.gradients(&point.x) {
            Ok(slopes) => slopes,
            Err(EarlyExit::Failed(_)) => return Ok(None),
            Err(halt) => return Err(halt),
        };
        let gains = self.gains((&point, &slopes, &s), direction, alpha);
        Ok(gains.then_some((point, slopes, s)))
    }

    /// A step of the multipliers alone, at a point that the direction does not change, as where rows fix it, if it reduces
    /// the residual of the optimality conditions.
    fn multipliers_alone(&self, direction: Direction, alpha: f64) -> Option<Accepted> {
        let (point, slopes, s) = (&self.at.point, &self.at.slopes, &self.at.s);
        let gains = self.gains((point, slopes, s), &direction, alpha);
        gains.then(|| Accepted {
            point: point.clone(),
            slopes: slopes.clone(),
            s: s.clone(),
            alpha,
            direction,
            trials: 1,
        })
    }

    /// Whether the residual of the optimality conditions falls if `point` and the slacks `s` are taken with the
    /// multipliers that `direction` leads to.
    fn gains(
        &self,
        (point, slopes, s): (&Point, &Derivatives, &DVector<f64>),
        direction: &Direction,
        alpha: f64,
    ) -> bool {
        let dual = direction.dual_limit(self.at, self.tau);
        let mut moved = Iterate {
            point: point.clone(),
            slopes: slopes.clone(),
            s: s.clone(),
            y: &self.at.y + &direction.y * alpha,
            zl: &self.at.zl + &direction.zl * dual,
            zu: &self.at.zu + &direction.zu * dual,
        };
        moved.keep_multipliers_in_band(self.layout, self.mu);
        moved.estimate_multipliers(self.layout);
        moved.residual(self.layout, self.mu) < GAIN * self.at.residual(self.layout, self.mu)
    }

    /// Step length below which no variable changes.
    fn least_resolved_step(&self, direction: &Direction) -> f64 {
        let moves = direction.x.iter().zip(self.at.point.x.iter());
        let lengths = moves
            .filter(|(d, _)| **d != 0.0)
            .map(|(d, x)| (x / d).abs());
        let slacks = direction.s.iter().zip(self.at.s.iter());
        let lengths = lengths.chain(
            slacks
                .filter(|(d, _)| **d != 0.0)
                .map(|(d, s)| (s / d).abs()),
        );
        RESOLUTION * lengths.fold(f64::INFINITY, f64::min)
    }

    fn slope(&self, direction: &Direction) -> f64 {
        let slope = self.at.barrier_slope(self.layout, self.mu);
        let n = self.layout.n;
        slope.rows(0, n).dot(&direction.x) + slope.rows(n, slope.len() - n).dot(&direction.s)
    }

    fn least_step(&self, here: &Measure) -> f64 {
        let m = -here.slope;
        let mut least = MARGIN;
        if m > 0.0 {
            least = least.min(MARGIN * here.theta / m);
            if here.theta <= self.theta_small {
                least = least.min(here.theta.powf(THETA_POWER) / m.powf(SLOPE_POWER));
            }
        }
        least
    }

    /// Evaluates the point at `alpha` and, if the tests accept it, its gradients. The tests use
    /// `alpha_test`: for a correction that is the length of the refused step (Wächter & Biegler 2006,
    /// steps ).
    fn attempt(
        &self,
        program: &mut Program<'_>,
        filter: &mut Filter,
        here: &Measure,
        direction: &Direction,
        (alpha, alpha_test): (f64, f64),
    ) -> Result<Trial, EarlyExit> {
        let x = &self.at.point.x + &direction.x * alpha;
        let s = &self.at.s + &direction.s * alpha;
        let point = match program.evaluate(&x) {
            Ok(point) => point,
            Err(EarlyExit::Failed(_)) => return Ok(Trial::Undefined),
            Err(halt) => return Err(halt),
        };
        let r = self.layout.residual(&point.c, &s);
        let theta = infeasibility(&r, &point.c);
        let phi = self.layout.barrier_function(point.f, &x, &s, self.mu);
        if !phi.is_finite() {
            return Ok(Trial::Undefined);
        }
        if !(here.accepts(theta, phi, alpha_test) && filter.accepts(theta, phi)) {
            return Ok(Trial::Refused {
                theta,
                phi,
                c: r,
                point,
            });
        }
        match program.gradients(&x) {
            Ok(slopes) => {
                filter.leave(here, alpha_test);
                Ok(Trial::Accepted(Box::new((point, slopes, s))))
            }
            Err(EarlyExit::Failed(_)) => Ok(Trial::Undefined),
            Err(halt) => Err(halt),
        }
    }

    /// Second-order correction: the rows are linearised about the values `c` of their residuals at
    /// the refused point, which a step of length `alpha_test` and of size `size` reaches (Wächter &
    /// Biegler 2006, section 2.4, with one correction: a second one gains nothing).
    fn correct(
        &self,
        program: &mut Program<'_>,
        b: &mut QuasiNewton,
        filter: &mut Filter,
        here: &Measure,
        (alpha_test, size, c): (f64, f64, DVector<f64>),
    ) -> Result<Option<Accepted>, EarlyExit> {
        let r = self.layout.residual(&self.at.point.c, &self.at.s) * alpha_test + c;
        let direction = self.system.step(self.at, self.layout, b, self.mu, &r);
        let alpha = direction.primal_limit(self.at, self.layout, self.tau);
        // A correction changes a step; it does not take its place. Where the rows overflow at the
        // refused point, the corrected step is cut to nothing, which the filter would accept.
        let short = alpha * direction.size() < SHORTEST * alpha_test * size;
        if short || !direction.is_finite() {
            return Ok(None);
        }
        let lengths = (alpha, alpha_test);
        match self.attempt(program, filter, here, &direction, lengths)? {
            Trial::Accepted(found) => {
                let (point, slopes, s) = *found;
                Ok(Some(Accepted {
                    point,
                    slopes,
                    s,
                    alpha,
                    direction,
                    trials: 2,
                }))
            }
            Trial::Refused { .. } | Trial::Undefined => Ok(None),
        }
    }
}
