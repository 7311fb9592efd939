//! A model with the motions of its bodies at an instant.

use super::bodies::BodyMotion;
use super::numbering::Numbering;
use crate::model::Model;

/// A model in motion at an instant.
#[derive(Clone, Copy)]
pub struct InMotion<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// The numbering of its states.
    pub numbering: &'a Numbering,
    /// The motions of its bodies.
    pub motions: &'a [BodyMotion<S>],
    /// The time \[s\].
    pub time: S,
}

impl<'a, S> InMotion<'a, S> {
    /// The motions of the bodies of `model` at `time`.
    pub fn new(
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
