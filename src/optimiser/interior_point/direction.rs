//! The primal–dual Newton step of the barrier problem.

use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::interior_point::iterate::{Iterate, Layout};
use crate::linear::kkt_system::KktSystem;
use crate::linear::quasi_newton::QuasiNewton;

/// An entry overshoots its bound if this share of its step reaches the bound. It then gets a
/// stiffness with which its step ends at the share `REACH` of its distance. Without stiffening the
/// trusses take four times the evaluations; one share for both loses two far starts.
const OVERSHOOT: f64 = 0.8;
const REACH: f64 = 0.9;

/// Step of all parts of an [`Iterate`].
#[derive(Clone, Debug)]
pub(crate) struct Direction {
    pub x: DVector<f64>,
    pub s: DVector<f64>,
    pub y: DVector<f64>,
    pub zl: DVector<f64>,
    pub zu: DVector<f64>,
}

/// The linear system of one iterate, factored once for all right-hand sides.
pub(crate) struct NewtonSystem {
    system: KktSystem,
    sigma: DVector<f64>,
    /// The addition to Σ.
    pub stiffness: DVector<f64>,
}

impl NewtonSystem {
    /// Factors the system at `at`; `None` if it cannot be made regular.
    pub(crate) fn new(
        at: &Iterate,
        layout: &Layout,
        b: &mut QuasiNewton,
        stiffness: DVector<f64>,
    ) -> Option<NewtonSystem> {
        let sigma = at.sigma(layout) + &stiffness;
        let mut d = DVector::zeros(at.y.len());
        for (k, &j) in layout.slack_rows.iter().enumerate() {
            d[j] = 1.0 / sigma[layout.n + k];
        }
        let head = sigma.rows(0, layout.n).into_owned();
        let system = KktSystem::factor(b, head, &at.slopes.a, d)?;
        Some(NewtonSystem {
            system,
            sigma,
            stiffness,
        })
    }

    /// δ that was added to dependent rows.
    pub(crate) fn regularisation(&self) -> f64 {
        self.system.regularisation()
    }

    /// Step towards the point of the central path with parameter `mu`, where the rows have the
    /// residual `r`.
    pub(crate) fn step(
        &self,
        at: &Iterate,
        layout: &Layout,
        b: &mut QuasiNewton,
        mu: f64,
        r: &DVector<f64>,
    ) -> Direction {
        let force = at.barrier_slope(layout, mu) + at.row_force(layout);
        let n = layout.n;
        let p = -force.rows(0, n).into_owned();
        let mut q = -r.clone_owned();
        for (k, &j) in layout.slack_rows.iter().enumerate() {
            q[j] -= force[n + k] / self.sigma[n + k];
        }
        let a = &at.slopes.a;
        let (x, y) = self.system.solve(b, a, &p, &q);
        // Near a bound Σ is large and dy/Σ is accurate; far away Σ is tiny and only the rows are.
        let moved = a * &x;
        let slack = |(k, &j): (usize, &usize)| {
            let sigma = self.sigma[n + k];
            if sigma > HALF_OF_DIGITS {
                (y[j] - force[n + k]) / sigma
            } else {
                moved[j] + r[j]
            }
        };
        let slacks = layout.slack_rows.iter().enumerate().map(slack);
        let s = DVector::from_iterator(layout.slack_rows.len(), slacks);
        let (below, above) = layout.distances(&at.point.x, &at.s);
        let dw = |i: usize| if i < n { x[i] } else { s[i - n] };
        let zl = DVector::from_fn(layout.len(), |i, _| {
            if below[i].is_finite() {
                (mu - at.zl[i] * dw(i)) / below[i] - at.zl[i]
                    + (-self.stiffness[i] * dw(i)).max(0.0)
            } else {
                0.0
            }
        });
        let zu = DVector::from_fn(layout.len(), |i, _| {
            if above[i].is_finite() {
                (mu + at.zu[i] * dw(i)) / above[i] - at.zu[i] + (self.stiffness[i] * dw(i)).max(0.0)
            } else {
                0.0
            }
        });
        Direction { x, s, y, zl, zu }
    }
}

impl Direction {
    /// Largest step in (0, 1] that keeps the share 1 − τ of every distance to a bound.
    pub(crate) fn primal_limit(&self, at: &Iterate, layout: &Layout, tau: f64) -> f64 {
        let (below, above) = layout.distances(&at.point.x, &at.s);
        let dw = |i: usize| {
            if i < layout.n {
                self.x[i]
            } else {
                self.s[i - layout.n]
            }
        };
        (0..layout.len()).fold(1.0, |alpha: f64, i| {
            let d = dw(i);
            let room = if d < 0.0 { below[i] } else { above[i] };
            if room.is_finite() && d != 0.0 {
                alpha.min(tau * room / d.abs())
            } else {
                alpha
            }
        })
    }

    /// Largest step in (0, 1] that keeps the share 1 − τ of every multiplier of a bound.
    pub(crate) fn dual_limit(&self, at: &Iterate, tau: f64) -> f64 {
        let limit = |alpha: f64, z: &DVector<f64>, dz: &DVector<f64>| {
            z.iter().zip(dz.iter()).fold(alpha, |alpha: f64, (z, dz)| {
                if *dz < 0.0 {
                    alpha.min(-tau * z / dz)
                } else {
                    alpha
                }
            })
        };
        limit(limit(1.0, &at.zl, &self.zl), &at.zu, &self.zu)
    }

    /// Largest component of the step in x and s.
    pub(crate) fn size(&self) -> f64 {
        self.x.amax().max(self.s.amax())
    }

    /// Stiffness, to be added to Σ. With it every overshooting entry, taken alone, would stop
    /// before its bound. `None` if no entry overshoots.
    pub(crate) fn stiffened(
        &self,
        at: &Iterate,
        layout: &Layout,
        system: &NewtonSystem,
        b: &mut QuasiNewton,
    ) -> Option<DVector<f64>> {
        let (below, above) = layout.distances(&at.point.x, &at.s);
        let mut stiffness = system.stiffness.clone();
        let mut found = false;
        for i in 0..layout.len() {
            let d = if i < layout.n {
                self.x[i]
            } else {
                self.s[i - layout.n]
            };
            let room = if d < 0.0 { below[i] } else { above[i] };
            if !room.is_finite() || d.abs() * OVERSHOOT <= room {
                continue;
            }
            found = true;
            let own = system.sigma[i] + if i < layout.n { b.diagonal(i) } else { 0.0 };
            stiffness[i] += own * (d.abs() / (REACH * room) - 1.0);
        }
        found.then_some(stiffness)
    }

    /// Whether every component is a number.
    pub(crate) fn is_finite(&self) -> bool {
        let parts = [&self.x, &self.s, &self.y, &self.zl, &self.zu];
        parts.iter().all(|v| v.iter().all(|e| e.is_finite()))
    }
}
