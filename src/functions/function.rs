//! A function of interest: an instant quantity reduced over the run to one number.

use super::instant::{Gate, Instant, Projectile};
use crate::math::Scalar;

/// How the values g_k of an instant quantity become one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reduction {
    /// The value at the end of the run.
    Final,
    /// ∫ g dt by the trapezoidal rule.
    Integral,
    /// Integral Kreisselmeier–Steinhauser function
    /// g_m + (1/ρ) ln[(1/T) ∫ exp(ρ (g − g_m)) dt], a smooth lower bound of the maximum that
    /// does not move when the step is refined (Kennedy & Hicken 2015, eq. 10).
    Ks {
        /// Aggregation parameter ρ, in 1/unit of g; larger is closer to the maximum.
        rho: f64,
    },
    /// Induced exponential ∫ g e^{ρg} dt / ∫ e^{ρg} dt (Kennedy & Hicken 2015, eq. 16).
    InducedExponential {
        /// Aggregation parameter ρ, in 1/unit of g.
        rho: f64,
    },
}

/// When a projectile is let go.
#[derive(Clone, Debug)]
pub enum Release<S> {
    /// At the end of the run.
    Final,
    /// Around the best instant: the mean state z̄ = Σ w_k z_k with the weights
    /// w_k ∝ τ_k exp(ρ R_k) of the gated range R.
    Best {
        /// Aggregation parameter ρ [1/m].
        rho: f64,
        /// Ground height and direction that the range is measured with.
        projectile: Projectile<S>,
        /// Gate that keeps later turns of the sling out.
        gate: Option<Gate>,
    },
}

/// A function of interest.
#[derive(Clone, Debug)]
pub enum Function<S> {
    /// An instant quantity, reduced over the run.
    Reduced {
        /// What is measured at each instant.
        instant: Instant<S>,
        /// How it becomes one number.
        reduction: Reduction,
    },
    /// Height of the flight path above a barrier's top at the barrier,
    /// c = y + v_y T_b − ½ g T_b² − h_b, T_b = (x_b − x) / v_x [m].
    Clearance {
        /// The thrown point and the horizontal direction of flight (its ground is not used).
        projectile: Projectile<S>,
        /// When it is let go.
        release: Release<S>,
        /// Place x_b of the barrier along the direction of flight [m].
        distance: S,
        /// Height h_b of the barrier's top above the origin [m].
        top: S,
    },
}

impl<S: Scalar> Function<S> {
    /// Appends the parameters in one fixed order.
    pub fn parameters(&self, all: &mut Vec<S>) {
        match self {
            Function::Reduced { instant, .. } => instant.parameters(all),
            Function::Clearance {
                projectile,
                release,
                distance,
                top,
            } => {
                projectile.parameters(all);
                if let Release::Best { projectile, .. } = release {
                    projectile.parameters(all);
                }
                all.extend([*distance, *top]);
            }
        }
    }

    /// The cotangent of this function: every parameter zero.
    pub fn zero_cotangent(&self) -> Function<f64> {
        match self {
            Function::Reduced { instant, reduction } => Function::Reduced {
                instant: instant.zero_cotangent(),
                reduction: *reduction,
            },
            Function::Clearance {
                projectile,
                release,
                ..
            } => Function::Clearance {
                projectile: projectile.zero_cotangent(),
                release: match release {
                    Release::Final => Release::Final,
                    Release::Best {
                        rho,
                        projectile,
                        gate,
                    } => Release::Best {
                        rho: *rho,
                        projectile: projectile.zero_cotangent(),
                        gate: *gate,
                    },
                },
                distance: 0.0,
                top: 0.0,
            },
        }
    }
}
