//! A function of interest: an instant quantity reduced over the run to one number.

use super::instant::{Gate, Instant, Projectile};
use super::quantity::Quantity;
use super::series::Series;
use super::turning::Rotation;
use super::window::{Edge, Window};
use crate::math::soft_max::Bound;
use crate::math::{Scalar, Vec3, parameters};
use crate::system::measures::Wrench;

/// Reduction of the values g_k of an instant quantity to one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reduction {
    /// The value at the end of the run, or of the window.
    Final,
    /// ∫ g dt.
    Integral,
    /// (1/T) ∫ g dt, with the length T of the run or of the window.
    Mean,
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
    /// Damage of crossings: D = ¼ ∫ |dF(g)| with F(g) = sign(g) |g/s|^m, the strength s and the slope m of Basquin's law
    /// N = (s/a)^m. A cycle between −a and a adds 1/N (Palmgren & Miner). Of irregular histories about zero it is an upper
    /// bound of the damage by rainflow counting (Rychlik 1993, *Fatigue Fract. Engng Mater. Struct.* 16, 377).
    Damage {
        /// Slope m.
        slope: f64,
        /// Amplitude s that one cycle endures, in the unit of g.
        strength: f64,
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
    /// A quantity, reduced over the run or a window.
    Reduced {
        /// The quantity.
        of: Quantity<S>,
        /// The window; `None` for the whole run.
        during: Option<Window<S>>,
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
    /// Mean square of the distances of quantities from measured values, in their standard deviations.
    Misfit {
        /// The quantities and their values.
        series: Vec<Series<S>>,
    },
    /// Duration T of the run; with an event, its time \[s\].
    Duration,
    /// −(1/ρ) ln Σ e^{−ρ f_k} of natural frequencies about rest, not above the lowest one.
    LowestFrequency {
        /// Parameter ρ \[s\].
        rho: f64,
        /// The frequencies f_k \[Hz\], the lowest first.
        frequencies: Vec<S>,
    },
    /// A number that depends only on the design.
    OfDesign {
        /// Its SI unit.
        unit: &'static str,
        /// The number.
        value: S,
    },
}

parameters!(enum Function {
    Reduced { reduction; of, during },
    Clearance {; projectile, release, distance, top },
    Misfit {; series },
    Duration,
    LowestFrequency { rho; frequencies },
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
    /// A quantity of an instant, reduced over the whole run.
    pub fn reduced(instant: Instant<S>, reduction: Reduction) -> Self {
        Self::Reduced {
            of: Quantity::Of(instant),
            during: None,
            reduction,
        }
    }

    /// SI unit of the value.
    pub fn unit(&self) -> String {
        match self {
            Function::Reduced {
                of,
                reduction: Reduction::Integral,
                ..
            } => of.integral_unit(),
            Function::Reduced {
                reduction: Reduction::Damage { .. },
                ..
            } => "1".to_owned(),
            Function::Reduced { of, .. } => of.unit(),
            Function::Clearance { .. } => "m".to_owned(),
            Function::Misfit { .. } => "1".to_owned(),
            Function::Duration => "s".to_owned(),
            Function::LowestFrequency { .. } => "Hz".to_owned(),
            Function::OfDesign { unit, .. } => (*unit).to_owned(),
        }
    }

    /// The quantity that the function reduces, if it does.
    pub fn quantity(&self) -> Option<&Quantity<S>> {
        match self {
            Function::Reduced { of, .. } => Some(of),
            Function::Clearance { .. }
            | Function::Misfit { .. }
            | Function::Duration
            | Function::LowestFrequency { .. }
            | Function::OfDesign { .. } => None,
        }
    }

    /// The quantity, if it is one of an instant.
    pub fn instant(&self) -> Option<&Instant<S>> {
        self.quantity().and_then(Quantity::instant)
    }

    /// All quantities of an instant in what the function reduces, in the ends of its window, and in its series.
    pub fn instants(&self) -> Vec<&Instant<S>> {
        let mut all = Vec::new();
        match self {
            Function::Reduced { of, during, .. } => {
                let edges = during.iter().flat_map(|own| [&own.from, &own.to]);
                let edges = edges.filter_map(Edge::quantity);
                for quantity in std::iter::once(of).chain(edges) {
                    quantity.for_each(&mut |instant| all.push(instant));
                }
            }
            Function::Misfit { series } => {
                for own in series {
                    own.of.for_each(&mut |instant| all.push(instant));
                }
            }
            Function::Clearance { .. }
            | Function::Duration
            | Function::LowestFrequency { .. }
            | Function::OfDesign { .. } => {}
        }
        all
    }

    /// The same, to be changed.
    pub fn instants_mut(&mut self) -> Vec<&mut Instant<S>> {
        let mut all = Vec::new();
        match self {
            Function::Reduced { of, during, .. } => {
                let edges = during.iter_mut();
                let edges = edges.flat_map(|own| [&mut own.from, &mut own.to]);
                let edges = edges.filter_map(Edge::quantity_mut);
                for quantity in std::iter::once(of).chain(edges) {
                    quantity.for_each_mut(&mut |instant| all.push(instant));
                }
            }
            Function::Misfit { series } => {
                for own in series {
                    own.of.for_each_mut(&mut |instant| all.push(instant));
                }
            }
            Function::Clearance { .. }
            | Function::Duration
            | Function::LowestFrequency { .. }
            | Function::OfDesign { .. } => {}
        }
        all
    }

    /// The rotations of these quantities whose whole turns count.
    pub fn rotations_mut(&mut self) -> impl Iterator<Item = &mut Rotation<S>> {
        let all = self.instants_mut().into_iter();
        all.filter_map(Instant::watched_rotation_mut)
    }

    /// One of them, by its number.
    pub(super) fn instant_mut(&mut self, which: usize) -> Option<&mut Instant<S>> {
        let mut left = which;
        match self {
            Function::Reduced { of, during, .. } => {
                let edges = during.iter_mut();
                let edges = edges.flat_map(|own| [&mut own.from, &mut own.to]);
                let mut all = std::iter::once(of).chain(edges.filter_map(Edge::quantity_mut));
                all.find_map(|own| own.nth_mut(&mut left))
            }
            Function::Misfit { series } => {
                let mut all = series.iter_mut();
                all.find_map(|own| own.of.nth_mut(&mut left))
            }
            Function::Clearance { .. }
            | Function::Duration
            | Function::LowestFrequency { .. }
            | Function::OfDesign { .. } => None,
        }
    }

    /// The components of reactions of joints that the function observes.
    pub fn reactions(&self) -> Vec<&Wrench<S>> {
        let all = self.instants().into_iter();
        all.filter_map(|instant| match instant {
            Instant::Reaction(wrench) => Some(wrench),
            _ => None,
        })
        .collect()
    }

    /// The same, to be changed.
    pub fn reactions_mut(&mut self) -> Vec<&mut Wrench<S>> {
        let all = self.instants_mut().into_iter();
        all.filter_map(|instant| match instant {
            Instant::Reaction(wrench) => Some(wrench),
            _ => None,
        })
        .collect()
    }

    /// The joints and loads that the function observes by their numbers.
    pub fn parts(&mut self) -> Vec<Part<'_>> {
        let all = self.instants_mut().into_iter();
        all.filter_map(|instant| match instant {
            Instant::Reaction(wrench) => Some(Part::Joint(&mut wrench.joint)),
            Instant::Slide(joint) => Some(Part::Joint(joint)),
            Instant::JointRate { joint, .. } => Some(Part::Joint(joint)),
            Instant::Load(measure) => Some(Part::Load(&mut measure.load)),
            Instant::Power(load) => Some(Part::Load(load.as_mut()?)),
            _ => None,
        })
        .collect()
    }

    /// Calls `visit` with every body that the function observes and its point; with `None` if it
    /// observes the rotation of the body.
    pub fn for_each_place(&mut self, visit: &mut impl FnMut(&mut usize, Option<&mut Vec3<S>>)) {
        match self {
            Function::Reduced { .. } | Function::Misfit { .. } => {
                for instant in self.instants_mut() {
                    instant.for_each_place(visit);
                }
            }
            Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => {}
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

impl<S: Scalar> Instant<S> {
    /// Calls `visit` with every body that the quantity observes and its point; with `None` if it observes the
    /// rotation of the body.
    pub fn for_each_place(&mut self, visit: &mut impl FnMut(&mut usize, Option<&mut Vec3<S>>)) {
        match self {
            Instant::Position { body, point, .. }
            | Instant::Velocity { body, point, .. }
            | Instant::Acceleration { body, point, .. }
            | Instant::Speed { body, point }
            | Instant::SpeedSquared { body, point } => visit(body, Some(point)),
            Instant::Felt { body, point, .. } => visit(body, Some(point)),
            Instant::Seen(seen) => {
                visit(&mut seen.body, Some(&mut seen.point));
                if let Some(from) = &mut seen.from {
                    visit(from, Some(&mut seen.eye));
                }
            }
            Instant::AngularVelocity { body, .. } => visit(body, None),
            Instant::Energy(_)
            | Instant::Momentum { .. }
            | Instant::AngularMomentum(_)
            | Instant::StrainEnergy(_)
            | Instant::ShellStress { .. }
            | Instant::Deformation { .. }
            | Instant::LargestDeformation { .. }
            | Instant::Reaction(_)
            | Instant::Power(_)
            | Instant::Vibration(_)
            | Instant::JointRate { .. }
            | Instant::Slide(_)
            | Instant::Load(_) => {}
            Instant::Rotation(rotation) => rotation.for_each_body(&mut |body| visit(body, None)),
            Instant::Range { projectile, gate } => {
                visit(&mut projectile.body, Some(&mut projectile.point));
                if let Some(gate) = gate {
                    gate.rotation.for_each_body(&mut |body| visit(body, None));
                }
            }
        }
    }
}
