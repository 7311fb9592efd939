//! Cams in a file: the motions of joints that they name, and their profiles.

use super::courses::course;
use super::placement::Assembly;
use crate::math::Scalar;
use crate::model::{DegreeOfFreedom, TimeFunction};
use crate::schema::couplings::{Cam, JointMotion};
use crate::schema::drives::TimeFunction as WrittenCourse;
use crate::schema::loads::Interpolation;

/// The degree of freedom of a motion.
pub(super) fn dof(of: &JointMotion) -> DegreeOfFreedom {
    match of {
        JointMotion::Turn(_) => DegreeOfFreedom::Rotation,
        JointMotion::Slide(_) => DegreeOfFreedom::Translation,
    }
}

/// The profile of a cam, of motions as functions measure them.
pub(super) fn written_profile<S: Scalar>(assembly: &Assembly<S>, cam: &Cam) -> TimeFunction<S> {
    let own = &cam.profile;
    let written = WrittenCourse::Table(
        &own.at,
        &own.values,
        Some(own.interpolation.unwrap_or(Interpolation::Spline)),
    );
    course(assembly, written)
}
