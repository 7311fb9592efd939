//! Scales of the updates of Newton's method.

use crate::math::Scalar;
use crate::model::Model;
use crate::system::{Numbering, placement};
use std::ops::Range;

/// Changes below this are round-off, relative to the largest position or velocity.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Length and gravity of a scene; they are constant during a run.
#[derive(Clone, Debug)]
pub(super) struct SceneScale {
    /// Length scale \[m\].
    length: f64,
    gravity: f64,
    /// Bodies that count by those that follow them: coordinates of couplings.
    followed: Range<usize>,
}

/// For positions, rotations, velocities and angular velocities: largest increment of the step and
/// largest value.
pub(super) struct Scales {
    parts: [[f64; 2]; 4],
    /// Relative round-off of velocity increments due to positions.
    pub round_off: f64,
    /// Bodies that do not count.
    followed: Range<usize>,
}

impl SceneScale {
    pub fn of<S: Scalar>(model: &Model<S>) -> Self {
        Self {
            length: placement::length_scale(model),
            gravity: largest(model.gravity.as_slice()),
            followed: model.coordinates(),
        }
    }

    /// The scales of a step of size `h` with the increments `dq`, `dv` to (q, v). They are at least
    /// the change by gravity in a step, so a model at rest is not judged by its round-off.
    pub fn step<S: Scalar>(&self, n: &Numbering, [q, v, dq, dv]: [&[S]; 4], h: f64) -> Scales {
        let (mut shift, mut turn, mut place) = (0.0_f64, 0.0_f64, self.length);
        let counts = |body: &usize| !self.followed.contains(body);
        for body in (0..n.bodies()).filter(counts) {
            let (dq, q) = (&dq[n.position(body)..], &q[n.position(body)..]);
            shift = shift.max(largest(&dq[..3]));
            place = place.max(largest(&q[..3]));
            turn = turn.max(2.0 * largest(&dq[3..7]));
        }
        let gained = h * self.gravity;
        let mut rates = [[0.0_f64, gained], [0.0, gained / self.length]];
        let all = dv.chunks_exact(6).zip(v.chunks_exact(6)).enumerate();
        for (_, (six, now)) in all.filter(|(body, _)| counts(body)) {
            for part in 0..2 {
                rates[part][0] = rates[part][0].max(largest(&six[3 * part..3 * part + 3]));
                rates[part][1] = rates[part][1].max(largest(&now[3 * part..3 * part + 3]));
            }
        }
        let gained = rates[0][0].max(gained);
        Scales {
            parts: [[shift, place], [turn, 1.0], rates[0], rates[1]],
            followed: self.followed.clone(),
            round_off: if gained > 0.0 {
                ROUND_OFF * place / (h * gained)
            } else {
                0.0
            },
        }
    }
}

impl Scales {
    /// Largest coordinate of a body, or the scene's length if that is larger \[m\]. The round-off
    /// of positions is proportional to it.
    pub fn place(&self) -> f64 {
        self.parts[0][1]
    }

    /// Largest change of the scaled update (δy, h δv) relative to the increments, without
    /// round-off; NaN if it is not finite.
    pub fn size<S: Scalar>(&self, update: &[S], h: f64) -> f64 {
        let (positions, velocities) = update.split_at(update.len() / 2);
        let mut size = 0.0_f64;
        for (half, all, scale) in [(0, positions, 1.0), (2, velocities, 1.0 / h)] {
            for (body, six) in all.chunks_exact(6).enumerate() {
                if six.iter().any(|x| !x.is_finite()) {
                    return f64::NAN;
                }
                if self.followed.contains(&body) {
                    continue;
                }
                for part in 0..2 {
                    let change = largest(&six[3 * part..3 * part + 3]) * scale;
                    let [increment, value] = self.parts[half + part];
                    // Parts that are zero have no relative change.
                    if increment.max(value) > 0.0 && change > ROUND_OFF * value.max(increment) {
                        size = size.max(change / increment.max(ROUND_OFF * value));
                    }
                }
            }
        }
        size
    }
}

pub(super) fn largest<S: Scalar>(x: &[S]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.re().abs()))
}
