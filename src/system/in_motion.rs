//! A model, the numbering of its states, and where its bodies are at a time.

use super::bodies::BodyMotion;
use super::numbering::Numbering;
use crate::model::Model;

/// A model in motion at an instant.
#[derive(Clone, Copy)]
pub(crate) struct InMotion<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// The numbering of its states.
    pub numbering: &'a Numbering,
    /// The motions of its bodies.
    pub motions: &'a [BodyMotion<S>],
    /// The time (s).
    pub time: S,
}

impl<'a, S> InMotion<'a, S> {
    /// Where the bodies of `model` are at `time`.
    pub(crate) fn new(
        model: &'a Model<S>,
        numbering: &'a Numbering,
        motions: &'a [BodyMotion<S>],
        time: S,
    ) -> Self {
        Self {
            model,
            numbering,
            motions,
            time,
        }
    }
}
