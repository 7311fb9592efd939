//! The angle or displacement x of a joint, or the distance of two points, as stops and controllers use it.

use super::Acting;
use super::power::{SLIDE, angle, apart, turn_rate};
use super::pull::{Pulled, pull_angle, pull_rate, pull_row, pull_turn};
use crate::math::{Scalar, Vec3};
use crate::model::DegreeOfFreedom;
use crate::system::constraint;
use crate::system::rows::RowCotangent;

/// A coordinate that a load measures and acts on.
#[derive(Clone, Copy)]
pub(super) enum Coordinate {
    /// Angle of a joint.
    Angle,
    /// Displacement along the axis of a joint.
    Slide,
    /// Distance of two points.
    Distance,
}

impl From<DegreeOfFreedom> for Coordinate {
    fn from(dof: DegreeOfFreedom) -> Self {
        match dof {
            DegreeOfFreedom::Rotation => Self::Angle,
            DegreeOfFreedom::Translation => Self::Slide,
        }
    }
}

impl Coordinate {
    /// x.
    pub(super) fn value<S: Scalar>(self, at: &Acting<S>) -> S {
        match self {
            Self::Angle => angle(at, S::zero()),
            Self::Slide => constraint::value(SLIDE, &at.a, &at.b),
            Self::Distance => apart(at).length,
        }
    }

    /// ẋ.
    pub(super) fn rate<S: Scalar>(self, at: &Acting<S>) -> S {
        match self {
            Self::Angle => turn_rate(at),
            Self::Slide => constraint::rate(SLIDE, &at.a, &at.b),
            Self::Distance => apart(at).rate,
        }
    }

    /// The generalised forces of a unit force along x, on body A and on body B.
    pub(super) fn unit_forces<S: Scalar>(self, at: &Acting<S>) -> [(Vec3<S>, Vec3<S>); 2] {
        let (ra, rb) = (&at.a.motion.rotation, &at.b.motion.rotation);
        match self {
            Self::Angle => {
                let e = at.a.frame.axes[2];
                let in_b = rb.tr_mul(&(ra * e));
                [(Vec3::zeros(), e), (Vec3::zeros(), -in_b)]
            }
            Self::Slide => {
                let g = constraint::gradient(SLIDE, &at.a, &at.b);
                [(g.force, g.torque_a), (-g.force, g.torque_b)]
            }
            Self::Distance => {
                let (f, sa, sb) = (apart(at).direction, &at.a.frame.point, &at.b.frame.point);
                [
                    (f, sa.cross(&ra.tr_mul(&f))),
                    (-f, -sb.cross(&rb.tr_mul(&f))),
                ]
            }
        }
    }

    /// Adds the derivatives of `by_value` x + `by_rate` ẋ.
    pub(super) fn pull<S: Scalar>(
        self,
        at: &Acting<S>,
        by_value: S,
        by_rate: S,
        out: &mut Pulled<S>,
    ) {
        match self {
            Self::Angle => {
                pull_angle(at, by_value, out);
                pull_turn(at, by_rate, out);
            }
            Self::Slide => {
                let cot = RowCotangent {
                    value: by_value,
                    rate: by_rate,
                    acceleration: S::zero(),
                    virtual_rate: S::zero(),
                };
                pull_row(at, SLIDE, cot, out);
            }
            Self::Distance => pull_rate(at, &apart(at), (by_value, by_rate), out),
        }
    }
}
