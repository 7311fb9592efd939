//! The joints and their constraint rows.
//!
//! Let d = r_A + R_A s_A − r_B − R_B s_B, and let e1, e2, e3 be orthonormal axes fixed in each body
//! (e3 is the joint's axis). Every joint is a list of rows of these kinds (the first four: Haug 1989,
//! *Computer Aided Kinematics and Dynamics of Mechanical Systems*, ch. 9):
//!
//! ```text
//! Coincident k     d_k                     = 0      component k of d in ground axes
//! Perpendicular    (R_A e_i) · (R_B e_j)   = 0
//! Sliding i        (R_A e_i) · d           = 0
//! Distance         ½ (d · d / L − L)       = 0      L is the length of a rod
//! Aligned          ½ ((R_A e_i) · (R_B e_j) − (R_A e_j) · (R_B e_i)) = 0
//! ```
//!
//! Three rows Aligned turn body B by the rotation that is nearest to the axes of A, which need not be orthonormal: those of a
//! section that deforms turn by atan |θ| about θ, whatever the axes are (polar decomposition).
//!
//! A drive adds one row for a degree of freedom of the joint, see [`super::drive`]. The equations,
//! Jacobians and pull-backs of the rows are in `system::constraint`.

use super::drive::{DegreeOfFreedom, Drive};
use super::flexible::Modes;
use crate::math::{Scalar, Vec3, parameters};

impl DegreeOfFreedom {
    /// The row of a drive of this degree of freedom.
    pub fn driven_row(self) -> ConstraintRow {
        match self {
            DegreeOfFreedom::Rotation => Perpendicular { a: 0, b: 1 },
            DegreeOfFreedom::Translation => Sliding { a: 2 },
        }
    }
}

/// One scalar constraint equation; indices are 0-based components or axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintRow {
    /// Component `k` of d in ground axes vanishes.
    Coincident(usize),
    /// Axis `a` of the frame on body A is perpendicular to axis `b` of the frame on body B.
    Perpendicular {
        /// Axis on body A.
        a: usize,
        /// Axis on body B.
        b: usize,
    },
    /// d has no component along axis `a` of the frame on body A.
    Sliding {
        /// Axis on body A.
        a: usize,
    },
    /// d has the length of the rod.
    Distance,
    /// Axes `a` and `b` of both frames have no relative rotation in the plane that they span.
    Aligned {
        /// An axis on both bodies.
        a: usize,
        /// Another one.
        b: usize,
    },
}

impl ConstraintRow {
    /// The component, if the row's force points along a ground axis.
    pub fn ground_component(self) -> Option<usize> {
        match self {
            Coincident(k) => Some(k),
            Perpendicular { .. } | Aligned { .. } | Sliding { .. } | Distance => None,
        }
    }

    /// What the row constrains, for messages.
    pub fn describe(self) -> &'static str {
        match self {
            Coincident(0) => "x distance",
            Coincident(1) => "y distance",
            Coincident(_) => "z distance",
            Perpendicular { .. } | Aligned { .. } => "angle between axes",
            Sliding { .. } => "distance along an axis",
            Distance => "length",
        }
    }

    /// Unit of the row's value: 1 of an angle, and `length` otherwise.
    pub fn size(self, length: f64) -> f64 {
        match self {
            Perpendicular { .. } | Aligned { .. } => 1.0,
            Coincident(_) | Sliding { .. } | Distance => length,
        }
    }

    /// Whether the row holds an angle.
    pub fn is_angle(self) -> bool {
        match self {
            Perpendicular { .. } | Aligned { .. } => true,
            Coincident(_) | Sliding { .. } | Distance => false,
        }
    }

    /// Whether the row transmits a force.
    pub fn has_force(self) -> bool {
        match self {
            Coincident(_) | Sliding { .. } | Distance => true,
            Perpendicular { .. } | Aligned { .. } => false,
        }
    }

    /// Whether the gradient depends on d, and so on the positions of the bodies.
    pub fn depends_on_distance(self) -> bool {
        match self {
            Sliding { .. } | Distance => true,
            Coincident(_) | Perpendicular { .. } | Aligned { .. } => false,
        }
    }

    /// Whether the force has the direction of d.
    pub fn follows_distance(self) -> bool {
        match self {
            Distance => true,
            Coincident(_) | Perpendicular { .. } | Aligned { .. } | Sliding { .. } => false,
        }
    }

    /// Whether the reaction on one body depends on the rotation of the other.
    pub fn couples_rotations(self) -> bool {
        match self {
            Perpendicular { .. } | Aligned { .. } | Sliding { .. } | Distance => true,
            Coincident(_) => false,
        }
    }
}

/// The kinds of joint; e3 of the joint frame is the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Two points coincide: 3 rows.
    Spherical,
    /// Two points coincide and one axis is common: 5 rows.
    Revolute,
    /// One body slides along an axis of the other without turning: 5 rows.
    Prismatic,
    /// One body moves in a plane of the other and turns about its normal: 3 rows.
    Planar,
    /// One body slides along an axis of the other and turns about it: 4 rows.
    Cylindrical,
    /// Two points coincide and the axis of A stays perpendicular to the cross axis of B: 4 rows.
    Universal,
    /// Two points keep their distance: 1 row.
    Rod,
    /// Two bodies move as one: 6 rows.
    Weld,
    /// Two bodies move freely: no row. Its frames are those of a bushing.
    Free,
    /// Body B is the interface of a point of the flexible body whose frame is body A: 6 rows.
    Attachment,
    /// A rotation or displacement of another joint that follows the coordinates of a coupling: 1 row (see
    /// [`super::coupling`]).
    Coupled(DegreeOfFreedom),
}

use ConstraintRow::{Aligned, Coincident, Distance, Perpendicular, Sliding};

impl JointKind {
    /// The constraint rows of this joint.
    pub fn rows(self) -> &'static [ConstraintRow] {
        match self {
            JointKind::Spherical => &[Coincident(0), Coincident(1), Coincident(2)],
            JointKind::Revolute => &[
                Coincident(0),
                Coincident(1),
                Coincident(2),
                Perpendicular { a: 2, b: 0 },
                Perpendicular { a: 2, b: 1 },
            ],
            JointKind::Prismatic => &[
                Perpendicular { a: 0, b: 1 },
                Perpendicular { a: 1, b: 2 },
                Perpendicular { a: 2, b: 0 },
                Sliding { a: 0 },
                Sliding { a: 1 },
            ],
            JointKind::Planar => &[
                Sliding { a: 2 },
                Perpendicular { a: 2, b: 0 },
                Perpendicular { a: 2, b: 1 },
            ],
            JointKind::Cylindrical => &[
                Perpendicular { a: 2, b: 0 },
                Perpendicular { a: 2, b: 1 },
                Sliding { a: 0 },
                Sliding { a: 1 },
            ],
            JointKind::Universal => &[
                Coincident(0),
                Coincident(1),
                Coincident(2),
                Perpendicular { a: 2, b: 0 },
            ],
            JointKind::Rod => &[Distance],
            JointKind::Free => &[],
            JointKind::Attachment => &[
                Coincident(0),
                Coincident(1),
                Coincident(2),
                Aligned { a: 0, b: 1 },
                Aligned { a: 1, b: 2 },
                Aligned { a: 2, b: 0 },
            ],
            JointKind::Weld => &[
                Coincident(0),
                Coincident(1),
                Coincident(2),
                Perpendicular { a: 0, b: 1 },
                Perpendicular { a: 1, b: 2 },
                Perpendicular { a: 2, b: 0 },
            ],
            JointKind::Coupled(DegreeOfFreedom::Rotation) => &[Perpendicular { a: 0, b: 1 }],
            JointKind::Coupled(DegreeOfFreedom::Translation) => &[Sliding { a: 2 }],
        }
    }

    /// The degrees of freedom along or about its axis, rotation first.
    pub fn degrees_of_freedom(self) -> &'static [DegreeOfFreedom] {
        match self {
            JointKind::Revolute | JointKind::Planar => &[DegreeOfFreedom::Rotation],
            JointKind::Prismatic => &[DegreeOfFreedom::Translation],
            JointKind::Cylindrical => &[DegreeOfFreedom::Rotation, DegreeOfFreedom::Translation],
            JointKind::Spherical
            | JointKind::Universal
            | JointKind::Rod
            | JointKind::Weld
            | JointKind::Free
            | JointKind::Attachment
            | JointKind::Coupled(_) => &[],
        }
    }

    /// Frame axes that both bodies share. The rows alone would also admit a rotation by 180°.
    pub fn common_axes(self) -> &'static [usize] {
        match self {
            JointKind::Spherical | JointKind::Universal | JointKind::Rod | JointKind::Free => &[],
            JointKind::Revolute
            | JointKind::Planar
            | JointKind::Cylindrical
            | JointKind::Coupled(DegreeOfFreedom::Translation) => &[2],
            JointKind::Coupled(DegreeOfFreedom::Rotation)
            | JointKind::Prismatic
            | JointKind::Weld
            | JointKind::Attachment => &[0, 1, 2],
        }
    }

    /// The joint's name in problem files.
    pub fn name(self) -> &'static str {
        match self {
            JointKind::Spherical => "spherical",
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
            JointKind::Planar => "planar",
            JointKind::Cylindrical => "cylindrical",
            JointKind::Universal => "universal",
            JointKind::Rod => "rod",
            JointKind::Weld => "weld",
            JointKind::Free => "free",
            JointKind::Attachment => "attachment",
            JointKind::Coupled(_) => "coupled",
        }
    }
}

/// Frame of a joint on a body.
#[derive(Clone, Copy, Debug)]
pub struct JointFrame<S> {
    /// Point from the centre of mass, body axes (on ground: from the origin) \[m\].
    pub point: Vec3<S>,
    /// Orthonormal axes e1, e2, e3 in body axes; e3 is the joint's axis.
    pub axes: [Vec3<S>; 3],
    /// Length L of a rod \[m\]; only used in frame A of a rod.
    pub length: S,
}

impl<S: Scalar> JointFrame<S> {
    /// The zero frame (a cotangent).
    pub fn zero() -> Self {
        Self {
            point: Vec3::zeros(),
            axes: [Vec3::zeros(); 3],
            length: S::zero(),
        }
    }

    /// Adds another cotangent.
    pub fn add(&mut self, other: &Self) {
        self.point += other.point;
        for (axis, by) in self.axes.iter_mut().zip(&other.axes) {
            *axis += by;
        }
        self.length += other.length;
    }
}

/// A joint between two bodies, or a body and ground.
#[derive(Clone, Debug)]
pub struct Joint<S> {
    /// Name in the problem file.
    pub name: String,
    /// Kind, which determines its equations.
    pub kind: JointKind,
    /// Body A.
    pub body_a: usize,
    /// Body B; `None` is ground.
    pub body_b: Option<usize>,
    /// Frame on body A.
    pub frame_a: JointFrame<S>,
    /// Frame on body B.
    pub frame_b: JointFrame<S>,
    /// Prescribed motions; at most one per degree of freedom.
    pub drives: Vec<Drive<S>>,
    /// Redundant rows of [`Joint::all_rows`]: they follow from those of other joints and are not
    /// imposed at the start. A run may exchange them for others (see `system::redundant_rows`).
    pub redundant: Vec<ConstraintRow>,
    /// How well redundant rows have to fit.
    pub fit: Fit,
    /// Trivially satisfied rows: they hold in all motions that the bodies' mobility admits, and are
    /// not imposed.
    pub trivial_rows: Vec<ConstraintRow>,
    /// How a frame moves with coordinates: that on body A with those of a flexible body, of attachments; that on
    /// body B with those of a coupling, of coupled joints.
    pub modes: Option<Modes<S>>,
}

/// How well the redundant rows of a scene have to fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Tolerance of the input: a part of the size of a loop, and an angle \[rad\].
    pub tolerance: f64,
    /// Whether rows are redundant only within this tolerance, as the numbers of a file are rounded.
    pub rounded: bool,
}

impl<S> Joint<S> {
    /// Whether it is a motion of another joint that follows the coordinates of a coupling.
    pub fn is_coupled(&self) -> bool {
        matches!(self.kind, JointKind::Coupled(_))
    }

    /// The rows of the kind and of the drives.
    pub fn all_rows(&self) -> impl Iterator<Item = ConstraintRow> + Clone + '_ {
        let driven = self.drives.iter().map(|drive| drive.dof.driven_row());
        self.kind.rows().iter().copied().chain(driven)
    }

    /// The rows that are not trivially satisfied.
    pub fn rows(&self) -> impl Iterator<Item = ConstraintRow> + Clone + '_ {
        let counts = |row: &ConstraintRow| !self.trivial_rows.contains(row);
        self.all_rows().filter(counts)
    }

    /// The rows of [`Joint::rows`] that are imposed at the start.
    pub fn imposed(&self) -> impl Iterator<Item = ConstraintRow> + Clone + '_ {
        self.rows().filter(|row| !self.redundant.contains(row))
    }

    /// Frame axes that both bodies share if the joint is closed.
    pub fn common_axes(&self) -> &'static [usize] {
        let turned = |drive: &Drive<S>| drive.dof == DegreeOfFreedom::Rotation;
        match self.drives.iter().any(turned) {
            true => &[0, 1, 2],
            false => self.kind.common_axes(),
        }
    }
}

parameters!(struct JointFrame {; point, axes, length });

parameters!(struct Joint {
    name, kind, body_a, body_b, redundant, fit, trivial_rows;
    frame_a, frame_b, drives, modes
});
