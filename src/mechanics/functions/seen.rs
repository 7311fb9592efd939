//! A point as seen from another body: what is measured. Values and derivatives are in [`super::view`].

use crate::math::{Vec3, parameters};

/// What is seen of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenPart {
    /// Component of its position \[m\].
    Position,
    /// Component of its velocity \[m/s\].
    Velocity,
    /// Its distance \[m\]. It has a kink where the points meet; its derivative is set to zero there.
    Distance,
}

/// A point of a body as seen from another body.
#[derive(Clone, Copy, Debug)]
pub struct Seen<S> {
    /// What is seen.
    pub part: SeenPart,
    /// The body A that is seen.
    pub body: usize,
    /// Its point, from the centre of mass in body axes \[m\].
    pub point: Vec3<S>,
    /// The body B that sees it; `None` for ground.
    pub from: Option<usize>,
    /// Its point, from the centre of mass in body axes (on ground: from the origin) \[m\].
    pub eye: Vec3<S>,
    /// Direction d, axes of body B; not used by a distance.
    pub direction: Vec3<S>,
}

parameters!(struct Seen { part, body, from; point, eye, direction });
