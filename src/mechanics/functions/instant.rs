//! Quantities at an instant.

use super::multipliers::Reacting;
use super::seen::{Seen, SeenPart};
use super::stations::Largest;
use super::turning::Rotation;
use super::vibration::{OfVibration, VibrationPart};
use crate::math::{Scalar, Vec3, parameters};
use crate::model::DegreeOfFreedom;
use crate::model::flexible::Quadratic;
use crate::system::angular_momentum::AngularMomentum;
use crate::system::loads::measured::{LoadMeasure, LoadPart};
use crate::system::measures::{Wrench, WrenchPart};
use std::sync::Arc;

/// A thrown point and the definition of its range. Up is against gravity.
#[derive(Clone, Copy, Debug)]
pub struct Projectile<S> {
    /// The body that is thrown.
    pub body: usize,
    /// Its point that flies, from the centre of mass in body axes \[m\].
    pub point: Vec3<S>,
    /// Horizontal unit vector along which the range is measured, ground axes.
    pub direction: Vec3<S>,
    /// Height of the ground above the origin \[m\].
    pub ground: S,
}

/// Side of its limit on which a gate is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GateSide {
    /// Open while the rotation is above the limit.
    Above,
    /// Open while the rotation is below the limit.
    Below,
}

/// A smooth gate σ(±(θ − θ_c) / w) on a rotation θ, counted over whole turns. It excludes the
/// later, unphysical maxima of a whirling sling from a range.
#[derive(Clone, Copy, Debug)]
pub struct Gate<S> {
    /// The rotation θ.
    pub rotation: Rotation<S>,
    /// The rotation θ_c at which the gate is half open \[rad\].
    pub limit: f64,
    /// Width w of the transition \[rad\].
    pub width: f64,
    /// Side on which it is open.
    pub open: GateSide,
}

/// Kind of energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyPart {
    /// ½ Σ (m ṙᵀṙ + ωᵀJω).
    Kinetic,
    /// −Σ m gᵀr, with r from the origin, plus the energy of springs.
    Potential,
    /// Kinetic plus potential.
    Total,
}

/// What a quadratic form in the elastic coordinates measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeformationKind {
    /// A displacement relative to the frame \[m\].
    Displacement,
    /// A force on a section \[N\].
    Force,
    /// A moment on a section \[N m\].
    Moment,
    /// A stress \[Pa\].
    Stress,
}

impl DeformationKind {
    fn unit(self) -> &'static str {
        match self {
            DeformationKind::Displacement => "m",
            DeformationKind::Force => "N",
            DeformationKind::Moment => "N m",
            DeformationKind::Stress => "Pa",
        }
    }

    fn name(self) -> &'static str {
        match self {
            DeformationKind::Displacement => "elastic displacement",
            DeformationKind::Force => "section force",
            DeformationKind::Moment => "section moment",
            DeformationKind::Stress => "stress",
        }
    }
}

/// A quantity at an instant. Points are from the centre of mass in body axes \[m\]. Directions are
/// in ground axes and not normalised (a unit vector gives a component).
#[derive(Clone, Debug)]
pub enum Instant<S> {
    /// Component of a point's position \[m\].
    Position {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
        /// The direction.
        direction: Vec3<S>,
    },
    /// Component of a point's velocity \[m/s\].
    Velocity {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
        /// The direction.
        direction: Vec3<S>,
    },
    /// Component of a point's acceleration \[m/s²\].
    Acceleration {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
        /// The direction.
        direction: Vec3<S>,
    },
    /// Speed of a point \[m/s\]. It is not differentiable at rest; there its derivative is set to
    /// zero.
    Speed {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
    },
    /// Square of the speed of a point \[m²/s²\]. Differentiable everywhere.
    SpeedSquared {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
    },
    /// Component of the angular velocity of a body \[rad/s\].
    AngularVelocity {
        /// The body.
        body: usize,
        /// The direction.
        direction: Vec3<S>,
    },
    /// Component of the linear momentum of the whole model \[kg m/s\].
    Momentum {
        /// The direction.
        direction: Vec3<S>,
    },
    /// Component of the angular momentum of the whole model \[kg m²/s\].
    AngularMomentum(AngularMomentum<S>),
    /// Energy of the whole model \[J\].
    Energy(EnergyPart),
    /// Strain energy of a flexible body \[J\], an index into those of the model.
    StrainEnergy(usize),
    /// Aggregate of von Mises stress by yield stress over points of shells: (1/ρ) ln Σ e^{ρ σ/σ_y}.
    ShellStress {
        /// The flexible body, an index into those of the model.
        flexible: usize,
        /// The elements.
        elements: Vec<usize>,
        /// ρ.
        rho: f64,
    },
    /// A quadratic form in the elastic coordinates of a flexible body.
    Deformation {
        /// The flexible body, an index into those of the model.
        flexible: usize,
        /// What it measures.
        kind: DeformationKind,
        /// The unknowns of nodes that it is a form in, instead of all coordinates.
        unknowns: Option<Arc<[usize]>>,
        /// The form.
        form: Quadratic<S>,
    },
    /// The largest of several quadratic forms in the elastic coordinates of a flexible body.
    LargestDeformation {
        /// The flexible body, an index into those of the model.
        flexible: usize,
        /// What they measure.
        kind: DeformationKind,
        /// As of a form.
        unknowns: Option<Arc<[usize]>>,
        /// The forms.
        largest: Largest<S>,
    },
    /// Component of the reaction of a joint \[N or N m\].
    Reaction(Wrench<S>),
    /// Component of a point's acceleration in the axes of its body, as a sensor there measures it but for gravity \[m/s²\].
    Felt {
        /// The body.
        body: usize,
        /// The point.
        point: Vec3<S>,
        /// The direction, body axes.
        direction: Vec3<S>,
    },
    /// A point as seen from another body \[m or m/s\].
    Seen(Seen<S>),
    /// Power by which a load drives its bodies \[W\]; zero of what is off.
    Power(Option<usize>),
    /// A number of a vibration of the whole machine about its state at the instant.
    Vibration(OfVibration),
    /// Rate of body A of a joint against body B about or along its axis \[rad/s or m/s\].
    JointRate {
        /// The joint.
        joint: usize,
        /// About or along.
        dof: DegreeOfFreedom,
    },
    /// Displacement of body A of a joint against body B along its axis \[m\].
    Slide(usize),
    /// Quantity of a spring, a stop or a contact, such as its force.
    Load(LoadMeasure),
    /// Rotation of a body about an axis, continuous in time \[rad\]. At t = 0 it has the turns of a joint's start, or is in
    /// (−2π, 2π].
    Rotation(Rotation<S>),
    /// Range of a projectile that is released at this instant \[m\], times the gate if there is
    /// one: R = x + (v_x/g)(v_y + √s0), s0 = v_y² + 2 g (y − y_g). It is smoothed if the ground is
    /// out of reach (see [`Flight::range`](super::flight::Flight::range)).
    Range {
        /// The projectile.
        projectile: Projectile<S>,
        /// The gate.
        gate: Option<Gate<S>>,
    },
}

parameters!(struct Gate { limit, width, open; rotation });

parameters!(struct Projectile { body; point, direction, ground });

parameters!(enum Instant {
    Position { body; point, direction },
    Velocity { body; point, direction },
    Acceleration { body; point, direction },
    Speed { body; point },
    SpeedSquared { body; point },
    AngularVelocity { body; direction },
    Momentum {; direction },
    AngularMomentum(; momentum),
    Energy(part;),
    StrainEnergy(body;),
    ShellStress { flexible, elements, rho; },
    Deformation { flexible, kind, unknowns; form },
    LargestDeformation { flexible, kind, unknowns; largest },
    Reaction(; wrench),
    Felt { body; point, direction },
    Seen(; seen),
    Power(load;),
    Vibration(of;),
    JointRate { joint, dof; },
    Slide(joint;),
    Load(measure;),
    Rotation(; rotation),
    Range {; projectile, gate },
});

impl<S: Scalar> Instant<S> {
    /// SI unit of the quantity.
    pub fn unit(&self) -> &'static str {
        match self {
            Instant::Position { .. } | Instant::Range { .. } => "m",
            Instant::Velocity { .. } | Instant::Speed { .. } => "m/s",
            Instant::Acceleration { .. } => "m/s²",
            Instant::SpeedSquared { .. } => "m²/s²",
            Instant::AngularVelocity { .. } => "rad/s",
            Instant::Momentum { .. } => "kg m/s",
            Instant::AngularMomentum(_) => "kg m²/s",
            Instant::Energy(_) | Instant::StrainEnergy(_) => "J",
            Instant::ShellStress { .. } => "1",
            Instant::Deformation { kind, .. } | Instant::LargestDeformation { kind, .. } => {
                kind.unit()
            }
            Instant::Reaction(wrench) => match wrench.part {
                WrenchPart::Force => "N",
                WrenchPart::Moment => "N m",
            },
            Instant::Felt { .. } => "m/s²",
            Instant::Seen(seen) => match seen.part {
                SeenPart::Position | SeenPart::Distance => "m",
                SeenPart::Velocity => "m/s",
            },
            Instant::Power(_) => "W",
            Instant::Vibration(of) => match of.part {
                VibrationPart::Frequency => "Hz",
                VibrationPart::DampingRatio => "1",
            },
            Instant::JointRate { dof, .. } => match dof {
                DegreeOfFreedom::Rotation => "rad/s",
                DegreeOfFreedom::Translation => "m/s",
            },
            Instant::Slide(_) => "m",
            Instant::Load(measure) => match measure.part {
                LoadPart::Length | LoadPart::Penetration | LoadPart::ErrorLength => "m",
                LoadPart::PenetrationAngle | LoadPart::ErrorAngle => "rad",
                LoadPart::Tension
                | LoadPart::NormalForce
                | LoadPart::Friction
                | LoadPart::EffortForce => "N",
                LoadPart::Torque | LoadPart::NormalTorque | LoadPart::EffortTorque => "N m",
                LoadPart::SlipPower => "W",
            },
            Instant::Rotation(_) => "rad",
        }
    }

    /// SI unit of its integral over time.
    pub fn integral_unit(&self) -> String {
        match self.unit() {
            "m/s" => "m".into(),
            "m/s²" => "m/s".into(),
            "m²/s²" => "m²/s".into(),
            "rad/s" => "rad".into(),
            "W" => "J".into(),
            "kg m/s" => "kg m".into(),
            "kg m²/s" => "kg m²".into(),
            unit => format!("{unit} s"),
        }
    }

    /// Name of the quantity for messages.
    pub fn describe(&self) -> &'static str {
        match self {
            Instant::Position { .. } => "position",
            Instant::Velocity { .. } => "velocity",
            Instant::Acceleration { .. } => "acceleration",
            Instant::Speed { .. } => "speed",
            Instant::SpeedSquared { .. } => "speed squared",
            Instant::AngularVelocity { .. } => "angular velocity",
            Instant::Momentum { .. } => "momentum",
            Instant::AngularMomentum(_) => "angular momentum",
            Instant::Energy(_) => "energy",
            Instant::StrainEnergy(_) => "strain energy",
            Instant::ShellStress { .. } => "von Mises stress by yield stress",
            Instant::Deformation { kind, .. } => kind.name(),
            Instant::LargestDeformation { kind, .. } => match kind {
                DeformationKind::Displacement => "largest elastic displacement",
                DeformationKind::Force => "largest section force",
                DeformationKind::Moment => "largest section moment",
                DeformationKind::Stress => "largest stress",
            },
            Instant::Reaction(wrench) => match wrench.part {
                WrenchPart::Force => "joint force",
                WrenchPart::Moment => "joint moment",
            },
            Instant::Felt { .. } => "acceleration",
            Instant::Seen(seen) => match seen.part {
                SeenPart::Position => "relative position",
                SeenPart::Velocity => "relative velocity",
                SeenPart::Distance => "distance",
            },
            Instant::Power(_) => "power",
            Instant::Vibration(of) => match of.part {
                VibrationPart::Frequency => "frequency",
                VibrationPart::DampingRatio => "damping ratio",
            },
            Instant::JointRate { .. } => "joint rate",
            Instant::Slide(_) => "slide",
            Instant::Load(measure) => match measure.part {
                LoadPart::Length => "spring length",
                LoadPart::Tension => "spring force",
                LoadPart::Torque => "spring torque",
                LoadPart::Penetration | LoadPart::PenetrationAngle => "penetration",
                LoadPart::NormalForce => "contact force",
                LoadPart::NormalTorque => "contact torque",
                LoadPart::Friction => "friction",
                LoadPart::SlipPower => "slip power",
                LoadPart::EffortForce | LoadPart::EffortTorque => "effort",
                LoadPart::ErrorLength | LoadPart::ErrorAngle => "tracking error",
            },
            Instant::Rotation(_) => "rotation",
            Instant::Range { .. } => "range",
        }
    }

    /// The joints whose multipliers the quantity needs, if any.
    pub fn reacting(&self) -> Option<Reacting> {
        match self {
            Instant::Reaction(wrench) => Some(Reacting::Joint(wrench.joint)),
            Instant::Vibration(_) => Some(Reacting::All),
            Instant::Position { .. }
            | Instant::Velocity { .. }
            | Instant::Acceleration { .. }
            | Instant::Speed { .. }
            | Instant::SpeedSquared { .. }
            | Instant::AngularVelocity { .. }
            | Instant::Momentum { .. }
            | Instant::AngularMomentum(_)
            | Instant::Energy(_)
            | Instant::StrainEnergy(_)
            | Instant::ShellStress { .. }
            | Instant::Deformation { .. }
            | Instant::LargestDeformation { .. }
            | Instant::Felt { .. }
            | Instant::Seen(_)
            | Instant::Power(_)
            | Instant::JointRate { .. }
            | Instant::Slide(_)
            | Instant::Load(_)
            | Instant::Rotation(_)
            | Instant::Range { .. } => None,
        }
    }
}
