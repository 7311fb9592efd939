//! Loads: forces and torques on bodies, springs, dampers, friction, drag, stops and contacts.
//!
//! Let m(t) be a [`TimeFunction`], d = P_A − P_B the vector between two points, l = √(dᵀd), e the
//! axis of a joint, φ the angle of its body A relative to body B about e, s = e · d its
//! displacement, and w a width. Each load acts on body A by
//!
//! ```text
//! force              F = m(t) n              at a point; n in ground or in body axes
//! torque             M = m(t) n              n in ground or in body axes
//! spring             F = −(k x + k3 x³ + T(x) + c l̇ + D(l̇)) d / l,    x = l − l0
//! torsion spring     M = −(k x + k3 x³ + T(x) + c φ̇ + D(φ̇)) e,         x = φ − φ0
//! damping            M = −(c φ̇ + D(φ̇)) e   or   F = −(c ṡ + D(ṡ)) e
//! ball damping       M = −c (ω_A − ω_B)
//! bushing            (F, M) = −(K x + C ẋ),             x the relative displacement and rotation of two frames
//! friction           M = −μ tanh(φ̇ / w) e   or   F = −μ tanh(ṡ / w) e
//! drag               F = −c |u|² u / √(|u|² + w²),           u = ṙ of a point
//! joint stop         M = (N(φ_l − φ, −φ̇) − N(φ − φ_u, φ̇)) e   or   F likewise with s
//! distance stop      F = (N(l_l − l, −l̇) − N(l − l_u, l̇)) d / l
//! ```
//!
//! and by the opposite on body B, so momentum is conserved. T and D are [`ForceTable`]s, zero without them. N(δ, δ̇) is the [`NormalLaw`] of a stop at a lower (l) or upper (u) limit. Contacts, and loads that are spread over the elements of a flexible body,
//! have files of their own ([`super::contact`], [`super::distributed`]), as have controllers ([`super::controller`]) and cables ([`super::cable`]). Forces and their derivatives are in `system::loads`.

use super::axes::Axes;
use super::cable::Cable;
use super::contact::Contact;
use super::controller::{Controller, Coordinate};
use super::distributed::DistributedLoad;
use super::drive::DegreeOfFreedom;
use super::force_table::ForceTable;
use super::joint::Joint;
use super::normal_law::NormalLaw;
use super::time_function::TimeFunction;
use crate::math::{Scalar, Vec3, parameters};

/// A named load.
#[derive(Clone, Debug)]
pub struct Load<S> {
    /// Name in the problem file.
    pub name: String,
    /// Kind and parameters.
    pub kind: LoadKind<S>,
}

/// The kinds of load.
#[derive(Clone, Debug)]
pub enum LoadKind<S> {
    /// A force at a point of a body.
    Force {
        /// The body.
        body: usize,
        /// The point, from the centre of mass in body axes \[m\].
        point: Vec3<S>,
        /// Direction n; it is not normalised.
        direction: Vec3<S>,
        /// Axes of the direction.
        axes: Axes,
        /// m(t) \[N\].
        magnitude: TimeFunction<S>,
    },
    /// A torque on a body.
    Torque {
        /// The body.
        body: usize,
        /// Direction n; it is not normalised.
        direction: Vec3<S>,
        /// Axes of the direction.
        axes: Axes,
        /// m(t) \[N m\].
        magnitude: TimeFunction<S>,
    },
    /// A spring with a damper between points of two bodies. The points must stay apart, unless l0 and c are zero and it has no tables: then
    /// F = −(k + k3 l²) d is smooth where they meet.
    Spring {
        /// Body A.
        body_a: usize,
        /// Body B; `None` is ground.
        body_b: Option<usize>,
        /// Point of A, from the centre of mass in body axes \[m\].
        point_a: Vec3<S>,
        /// Point of B, from the centre of mass in body axes (on ground: from the origin) \[m\].
        point_b: Vec3<S>,
        /// Length l0 at zero force \[m\].
        rest_length: S,
        /// Stiffness k \[N/m\].
        stiffness: S,
        /// Cubic stiffness k3 \[N/m³\].
        cubic: S,
        /// Damping c \[N s/m\].
        damping: S,
        /// T over the stretch and D over its rate.
        tables: [Option<ForceTable<S>>; 2],
    },
    /// A spring with a damper about the axis of a joint. Its angle φ has all turns since the start.
    TorsionSpring {
        /// The joint.
        joint: usize,
        /// The body whose first coordinate has the turns of φ (see `system::turns`). Without it x = φ − φ0 is taken in
        /// (−π, π] and jumps by a turn half a turn from rest.
        counter: Option<usize>,
        /// Angle φ0 at zero torque \[rad\].
        rest_angle: S,
        /// Stiffness k \[N m/rad\].
        stiffness: S,
        /// Cubic stiffness k3 \[N m/rad³\].
        cubic: S,
        /// Damping c \[N m s/rad\].
        damping: S,
        /// T over x and D over its rate.
        tables: [Option<ForceTable<S>>; 2],
    },
    /// Viscous damping along or about the axis of a joint.
    Damping {
        /// The joint.
        joint: usize,
        /// The degree of freedom that is damped.
        dof: DegreeOfFreedom,
        /// c \[N m s/rad or N s/m\].
        coefficient: S,
        /// D over the rate.
        table: Option<ForceTable<S>>,
    },
    /// Viscous damping of all relative rotation of a joint's bodies.
    BallDamping {
        /// The joint.
        joint: usize,
        /// c \[N m s/rad\].
        coefficient: S,
    },
    /// Linear elastic forces and torques of all relative motion of the frames of a joint, with damping.
    Bushing {
        /// The joint.
        joint: usize,
        /// Whether e are the axes on body B, as those of a bearing on ground past which a shaft turns, and not those on A.
        of_second: bool,
        /// K by rows, symmetric, of displacements along e1, e2, e3 and rotations about them; 36 numbers \[N/m, N, N m\].
        stiffness: Vec<S>,
        /// C likewise \[N s/m, N s, N m s\].
        damping: Vec<S>,
        /// Friction by the force across e3.
        friction: Option<BearingFriction<S>>,
    },
    /// Coulomb friction of constant size along or about the axis of a joint. It is smooth at rate
    /// zero.
    Friction {
        /// The joint.
        joint: usize,
        /// The degree of freedom with friction.
        dof: DegreeOfFreedom,
        /// Size μ of the torque or force \[N m or N\].
        size: S,
        /// Rate w, at which tanh 1 of μ acts \[rad/s or m/s\].
        width: S,
    },
    /// Quadratic drag on a point of a body in a fluid at rest, smooth where it is at rest.
    Drag {
        /// The body.
        body: usize,
        /// The point, from the centre of mass in body axes \[m\].
        point: Vec3<S>,
        /// c = ½ ρ c_d A \[N s²/m²\].
        coefficient: S,
        /// Speed w, well above which the drag is quadratic \[m/s\].
        width: S,
        /// A flat plate or wing, whose force along its normal is its lift.
        plate: Option<Plate<S>>,
    },
    /// Stops at the ends of the way of a joint, along or about its axis.
    JointStop {
        /// The joint.
        joint: usize,
        /// The degree of freedom that is stopped.
        dof: DegreeOfFreedom,
        /// The body whose first coordinate has the turns of a rotation, as of a torsion spring.
        counter: Option<usize>,
        /// Lower and upper limit \[rad or m\].
        limits: [Option<S>; 2],
        /// The normal law of both.
        law: NormalLaw<S>,
    },
    /// Stops of the distance of points of two bodies. The points must stay apart.
    DistanceStop {
        /// Body A.
        body_a: usize,
        /// Body B; `None` is ground.
        body_b: Option<usize>,
        /// Point of A, from the centre of mass in body axes \[m\].
        point_a: Vec3<S>,
        /// Point of B, from the centre of mass in body axes (on ground: from the origin) \[m\].
        point_b: Vec3<S>,
        /// Lower and upper limit \[m\].
        limits: [Option<S>; 2],
        /// The normal law of both.
        law: NormalLaw<S>,
    },
    /// A contact of a sphere or point with a surface.
    Contact(Contact<S>),
    /// A cable over pulleys.
    Cable(Cable<S>),
    /// A pressure or a dead load on the elements of a flexible body.
    Distributed(DistributedLoad<S>),
    /// A controller of a joint or a distance.
    Controller(Controller<S>),
}

impl<S> LoadKind<S> {
    /// Whether at rest its forces surely are the derivatives of an energy of all positions. Others may have one in the
    /// motions that joints allow, as a torque about a hinge.
    pub fn has_potential(&self) -> bool {
        match self {
            Self::Force { axes, .. } => *axes == Axes::Ground,
            Self::Spring { .. }
            | Self::TorsionSpring { .. }
            | Self::Damping { .. }
            | Self::BallDamping { .. }
            | Self::Friction { .. }
            | Self::Drag { .. }
            | Self::JointStop { .. }
            | Self::DistanceStop { .. } => true,
            Self::Torque { .. }
            | Self::Bushing { .. }
            | Self::Contact(_)
            | Self::Cable(_)
            | Self::Distributed(_)
            | Self::Controller(_) => false,
        }
    }
}

/// A flat plate or wing in a flow.
#[derive(Clone, Debug)]
pub struct Plate<S> {
    /// Its unit normal, in body axes.
    pub normal: Vec3<S>,
    /// c_n = ½ ρ C_n A, with the coefficient C_n sin α of the force along the normal at the angle α \[N s²/m²\].
    pub coefficient: S,
}

/// Friction of a bearing or guide by the force across its axis: T = μ ρ N tanh(ω / w), N = √(f² + n²) − n.
#[derive(Clone, Debug)]
pub struct BearingFriction<S> {
    /// The turn about e3 or the slide along it.
    pub dof: DegreeOfFreedom,
    /// Coefficient μ.
    pub coefficient: S,
    /// Radius ρ of a bearing, 1 of a guide \[m or 1\].
    pub radius: S,
    /// Rate w, at which tanh 1 of it acts \[rad/s or m/s\].
    pub width: S,
    /// Force n, well above which N is the force across \[N\].
    pub load_width: S,
}

parameters!(struct Plate {; normal, coefficient });

parameters!(struct BearingFriction { dof; coefficient, radius, width, load_width });

parameters!(struct Load { name; kind });

parameters!(enum LoadKind {
    Force { body, axes; point, direction, magnitude },
    Torque { body, axes; direction, magnitude },
    Spring { body_a, body_b; point_a, point_b, rest_length, stiffness, cubic, damping, tables },
    TorsionSpring { joint, counter; rest_angle, stiffness, cubic, damping, tables },
    Damping { joint, dof; coefficient, table },
    BallDamping { joint; coefficient },
    Bushing { joint, of_second; stiffness, damping, friction },
    Friction { joint, dof; size, width },
    Drag { body; point, coefficient, width, plate },
    JointStop { joint, dof, counter; limits, law },
    DistanceStop { body_a, body_b; point_a, point_b, limits, law },
    Contact(; contact),
    Cable(; cable),
    Distributed(; load),
    Controller(; controller),
});

impl<S: Scalar> LoadKind<S> {
    /// The time function of the load, if it has one. Those of a controller are its own.
    pub fn course(&self) -> Option<&TimeFunction<S>> {
        match self {
            LoadKind::Force { magnitude, .. } | LoadKind::Torque { magnitude, .. } => {
                Some(magnitude)
            }
            LoadKind::Distributed(load) => Some(&load.magnitude),
            LoadKind::Cable(own) => Some(&own.length),
            LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Bushing { .. }
            | LoadKind::Friction { .. }
            | LoadKind::Drag { .. }
            | LoadKind::JointStop { .. }
            | LoadKind::DistanceStop { .. }
            | LoadKind::Controller(_)
            | LoadKind::Contact(_) => None,
        }
    }
}

impl<S> LoadKind<S> {
    /// The joint through which the load acts, if it does.
    pub fn joint(&self) -> Option<usize> {
        match self {
            LoadKind::TorsionSpring { joint, .. }
            | LoadKind::Damping { joint, .. }
            | LoadKind::BallDamping { joint, .. }
            | LoadKind::Bushing { joint, .. }
            | LoadKind::Friction { joint, .. }
            | LoadKind::JointStop { joint, .. } => Some(*joint),
            LoadKind::Controller(own) => match own.feedback[0].coordinate {
                Coordinate::Joint { joint, .. } => Some(joint),
                Coordinate::Distance { .. } => None,
            },
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Spring { .. }
            | LoadKind::Drag { .. }
            | LoadKind::DistanceStop { .. }
            | LoadKind::Contact(_)
            | LoadKind::Cable(_)
            | LoadKind::Distributed(_) => None,
        }
    }

    /// The bodies that the load acts on, without states of controllers.
    pub fn bodies(&self, joints: &[Joint<S>]) -> Vec<usize> {
        let both = match self {
            LoadKind::Cable(own) => {
                return own.points.iter().filter_map(|own| own.body).collect();
            }
            LoadKind::Force { body, .. }
            | LoadKind::Torque { body, .. }
            | LoadKind::Drag { body, .. } => [Some(*body), None],
            LoadKind::Distributed(load) => [Some(load.body), None],
            LoadKind::Spring { body_a, body_b, .. }
            | LoadKind::DistanceStop { body_a, body_b, .. } => [Some(*body_a), *body_b],
            LoadKind::Contact(own) => [Some(own.body_a), own.body_b],
            LoadKind::Controller(own) => match &own.feedback[0].coordinate {
                Coordinate::Joint { joint, .. } => {
                    let joint = &joints[*joint];
                    [Some(joint.body_a), joint.body_b]
                }
                Coordinate::Distance { body_a, body_b, .. } => [Some(*body_a), *body_b],
            },
            LoadKind::TorsionSpring { joint, .. }
            | LoadKind::Damping { joint, .. }
            | LoadKind::BallDamping { joint, .. }
            | LoadKind::Bushing { joint, .. }
            | LoadKind::Friction { joint, .. }
            | LoadKind::JointStop { joint, .. } => {
                let joint = &joints[*joint];
                [Some(joint.body_a), joint.body_b]
            }
        };
        both.into_iter().flatten().collect()
    }

    /// The joints whose turns are counted for it, with their counters.
    pub fn counters(&self) -> impl Iterator<Item = (usize, usize)> {
        let feedback = match self {
            LoadKind::Controller(own) => &own.feedback[..],
            _ => &[],
        };
        let measured = feedback.iter().filter_map(|own| own.coordinate.counted());
        let own = self.joint().zip(self.counter());
        own.into_iter().chain(measured)
    }

    /// The body that counts the turns of its joint, if one does. A controller may have several.
    pub fn counter(&self) -> Option<usize> {
        match self {
            LoadKind::TorsionSpring { counter, .. } | LoadKind::JointStop { counter, .. } => {
                *counter
            }
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Spring { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Bushing { .. }
            | LoadKind::Friction { .. }
            | LoadKind::Drag { .. }
            | LoadKind::DistanceStop { .. }
            | LoadKind::Contact(_)
            | LoadKind::Cable(_)
            | LoadKind::Controller(_)
            | LoadKind::Distributed(_) => None,
        }
    }
}
