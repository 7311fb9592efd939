//! How points of beams and of bodies of files move with their coordinates, and their numbers.

use crate::math::{Scalar, Vec3};
use crate::model::flexible::BeamSection;
use crate::schema::mechanics::Body;
use crate::structures::modal::loaded::Loaded;
use crate::structures::modal::{FlexibleBeam, ModalNumbers, PointModes};
use crate::{beam, modal};
use std::sync::Arc;

/// How points of a body move with its elastic coordinates.
pub enum Shapes<S> {
    Beam(FlexibleBeam<S>),
    /// A body of files, and the factor of its lengths.
    Modal(Arc<Loaded>, S),
}

impl<S: Scalar> Shapes<S> {
    /// Sections of a beam (see [`crate::model::flexible::Modal`]).
    pub(super) fn sections(&self) -> Arc<[BeamSection]> {
        match self {
            Self::Beam(beam) => beam.sections().into(),
            Self::Modal(..) => [].into(),
        }
    }

    pub(super) fn point(&self, point: Vec3<S>) -> PointModes<S> {
        match self {
            Self::Beam(beam) => beam.point(point.x / beam.length, [point.y, point.z]),
            Self::Modal(loaded, scale) => loaded.body.point(&point, *scale),
        }
    }

    pub(super) fn beam(&self) -> &FlexibleBeam<S> {
        match self {
            Self::Beam(beam) => beam,
            Self::Modal(..) => unreachable!("sections are those of beams, which is checked"),
        }
    }
}

/// The shapes and numbers of a beam or of a body of files at the design `x`.
pub(super) fn weighed<S: Scalar>(body: &Body, x: &[S]) -> Option<Weighed<S>> {
    if let Some(written) = &body.beam {
        let beam = beam::beam(written, x);
        let numbers = beam.numbers();
        return Some((Shapes::Beam(beam), numbers));
    }
    let written = body.modal.as_ref()?;
    let loaded = written.loaded.clone()?;
    let shapes = Shapes::Modal(loaded, modal::scale(written, x));
    Some((shapes, modal::numbers(written, x)))
}

/// The coordinates of such a body and their rates at the start.
pub(super) fn start<S: Scalar>(body: &Body, count: usize, x: &[S]) -> [Vec<S>; 2] {
    let of_beam = body.beam.as_ref().map(|beam| beam::start(beam, x));
    let written = body.modal.as_ref().and_then(|modal| modal.start.as_ref());
    of_beam.unwrap_or_else(|| modal::start(written, count, x))
}

/// The shapes of a body and its numbers.
pub type Weighed<S> = (Shapes<S>, ModalNumbers<S>);
