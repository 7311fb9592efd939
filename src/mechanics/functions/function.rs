//! A function of interest: an instant quantity reduced over the run to one number.

use super::instant::{Gate, Instant, Projectile};
use crate::math::soft_max::Bound;
use crate::math::{Scalar, Vec3, parameters};
use crate::system::measures::Wrench;

/// Reduction of the values g_k of an instant quantity to one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reduction {
    /// The value at the end of the run.
    Final,
    /// ∫ g dt.
    Integral,
    /// Kreisselmeier–Steinhauser function. Below the maximum: its integral form
    /// g_m + (1/ρ) ln[(1/T) ∫ exp(ρ (g − g_m)) dt], a smooth lower bound that does not depend on
    /// the number of samples (Kennedy & Hicken 2015, eq. 10). Above the maximum:
    /// g_m + (1/ρ) ln[Σ exp(ρ (M_i − g_m)) − Σ exp(ρ (m_j − g_m))] with the maxima M_i and the
    /// minima m_j of g over time.
    Ks {
        /// Aggregation parameter ρ, in 1/unit of g. A larger one is closer to the maximum.
        rho: f64,
        /// Side of the maximum.
        bound: Bound,
    },
    /// Induced exponential ∫ g e^{ρg} dt / ∫ e^{ρg} dt (Kennedy & Hicken 2015, eq. 16).
    InducedExponential {
        /// Aggregation parameter ρ, in 1/unit of g.
        rho: f64,
    },
}

/// Release of a projectile.
#[derive(Clone, Debug)]
pub enum Release<S> {
    /// At the end of the run.
    Final,
    /// Around the best instant: the mean state z̄ = Σ w_k z_k with the weights
    /// w_k ∝ τ_k exp(ρ R_k) of the gated range R.
    Best {
        /// Aggregation parameter ρ \[1/m\].
        rho: f64,
        /// Ground height and direction of the range.
        projectile: Projectile<S>,
        /// Gate that excludes later turns of the sling.
        gate: Option<Gate<S>>,
    },
}

/// A function of interest.
#[derive(Clone, Debug)]
pub enum Function<S> {
    /// An instant quantity, reduced over the run.
    Reduced {
        /// Quantity at each instant.
        instant: Instant<S>,
        /// Its reduction to one number.
        reduction: Reduction,
    },
    /// Height of the flight path above a barrier's top at the barrier,
    /// c = y + v_y T_b − ½ g T_b² − h_b, T_b = (x_b − x) / v_x \[m\].
    Clearance {
        /// The thrown point and the horizontal direction of flight (its ground is not used).
        projectile: Projectile<S>,
        /// Release of the projectile.
        release: Release<S>,
        /// Position x_b of the barrier along the direction of flight \[m\].
        distance: S,
        /// Height h_b of the barrier's top above the origin \[m\].
        top: S,
    },
    /// Duration T of the run; with an event, its time \[s\].
    Duration,
    /// A number that depends only on the design.
    OfDesign {
        /// Its SI unit.
        unit: &'static str,
        /// The number.
        value: S,
    },
}

parameters!(enum Function {
    Reduced { reduction; instant },
    Clearance {; projectile, release, distance, top },
    Duration,
    OfDesign { unit; value },
});

parameters!(enum Release {
    Final,
    Best { rho; projectile, gate },
});

/// A joint or load, by its number.
pub enum Part<'a> {
    /// A joint.
    Joint(&'a mut usize),
    /// A load.
    Load(&'a mut usize),
}

impl<S: Scalar> Function<S> {
    /// SI unit of the value.
    pub fn unit(&self) -> String {
        match self {
            Function::Reduced {
                instant,
                reduction: Reduction::Integral,
            } => instant.integral_unit(),
            Function::Reduced { instant, .. } => instant.unit().to_owned(),
            Function::Clearance { .. } => "m".to_owned(),
            Function::Duration => "s".to_owned(),
            Function::OfDesign { unit, .. } => (*unit).to_owned(),
        }
    }

    /// The quantity at an instant, if the function reduces one.
    pub fn instant(&self) -> Option<&Instant<S>> {
        match self {
            Function::Reduced { instant, .. } => Some(instant),
            Function::Clearance { .. } | Function::Duration | Function::OfDesign { .. } => None,
        }
    }

    /// The component of a joint's reaction that the function observes, if any.
    pub fn reaction(&self) -> Option<&Wrench<S>> {
        match self.instant() {
            Some(Instant::Reaction(wrench)) => Some(wrench),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn reaction_mut(&mut self) -> Option<&mut Wrench<S>> {
        match self {
            Function::Reduced {
                instant: Instant::Reaction(wrench),
                ..
            } => Some(wrench),
            _ => None,
        }
    }

    /// The joint or load that the function observes by its number, if any.
    pub fn part(&mut self) -> Option<Part<'_>> {
        let Function::Reduced { instant, .. } = self else {
            return None;
        };
        match instant {
            Instant::Reaction(wrench) => Some(Part::Joint(&mut wrench.joint)),
            Instant::Slide(joint) => Some(Part::Joint(joint)),
            Instant::Spring(spring) => Some(Part::Load(&mut spring.load)),
            _ => None,
        }
    }

    /// Calls `visit` with every body that the function observes and its point; with `None` if it
    /// observes the rotation of the body.
    pub fn for_each_place(&mut self, visit: &mut impl FnMut(&mut usize, Option<&mut Vec3<S>>)) {
        match self {
            Function::Reduced { instant, .. } => match instant {
                Instant::Position { body, point, .. }
                | Instant::Velocity { body, point, .. }
                | Instant::Acceleration { body, point, .. }
                | Instant::Speed { body, point }
                | Instant::SpeedSquared { body, point } => visit(body, Some(point)),
                Instant::AngularVelocity { body, .. } => visit(body, None),
                Instant::Energy(_)
                | Instant::Momentum { .. }
                | Instant::AngularMomentum(_)
                | Instant::StrainEnergy(_)
                | Instant::ShellStress { .. }
                | Instant::Deformation { .. }
                | Instant::LargestDeformation { .. }
                | Instant::Reaction(_)
                | Instant::Slide(_)
                | Instant::Spring(_) => {}
                Instant::Rotation(rotation) => {
                    rotation.for_each_body(&mut |body| visit(body, None))
                }
                Instant::Range { projectile, gate } => {
                    visit(&mut projectile.body, Some(&mut projectile.point));
                    if let Some(gate) = gate {
                        gate.rotation.for_each_body(&mut |body| visit(body, None));
                    }
                }
            },
            Function::Duration | Function::OfDesign { .. } => {}
            Function::Clearance {
                projectile,
                release,
                ..
            } => {
                visit(&mut projectile.body, Some(&mut projectile.point));
                if let Release::Best {
                    projectile, gate, ..
                } = release
                {
                    visit(&mut projectile.body, Some(&mut projectile.point));
                    if let Some(gate) = gate {
                        gate.rotation.for_each_body(&mut |body| visit(body, None));
                    }
                }
            }
        }
    }
}
