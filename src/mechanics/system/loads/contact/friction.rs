//! Friction of a contact by its slip.
//!
//! ```text
//! a = n·v,   v_t = v − n a / nᵀn,   q = v_tᵀ v_t,   s = √(q + w²)
//! μ(q) = μ_k + (μ_s − μ_k) e,   e = exp(−q / v_s²)
//! ```

use super::geometry::Touch;
use crate::math::{Scalar, Vec3};
use crate::model::contact::Friction;
use crate::system::loads::pull::Pulled;

/// Places of the parameters among the scalars of a contact.
const COEFFICIENT: usize = 4;
const SLIP: usize = 5;
const STATIC: usize = 8;
const SPEED: usize = 9;

/// The slip of a contact.
pub(super) struct Slip<S> {
    /// v_t.
    pub tangential: Vec3<S>,
    /// a, the speed of separation.
    pub apart: S,
    /// s.
    pub size: S,
    /// μ.
    pub coefficient: S,
    /// Of Stribeck's friction: e and ∂μ/∂q.
    falling: Option<[S; 2]>,
}

impl<S: Scalar> Slip<S> {
    pub(super) fn of(friction: &Friction<S>, touch: &Touch<S>, velocity: &Vec3<S>) -> Self {
        let apart = touch.normal.dot(velocity);
        let tangential = velocity - touch.normal * (apart / touch.square);
        let square = tangential.dot(&tangential) + friction.width * friction.width;
        let mut own = Self {
            tangential,
            apart,
            size: square.sqrt(),
            coefficient: friction.coefficient,
            falling: None,
        };
        if let Some(more) = &friction.stribeck {
            let speed = more.speed * more.speed;
            let e = (-(tangential.dot(&tangential) / speed)).exp();
            let by_e = more.coefficient - friction.coefficient;
            own.coefficient += by_e * e;
            own.falling = Some([e, -(by_e * e / speed)]);
        }
        own
    }

    pub(super) fn is_none(&self) -> bool {
        self.tangential.iter().all(|x| x.re() == 0.0)
    }

    /// ∂μ/∂q, if μ depends on the slip.
    pub(super) fn falls(&self) -> Option<S> {
        self.falling.map(|own| own[1])
    }

    /// Adds the derivatives of `by` μ in the parameters, and of `by_width` w.
    pub(super) fn give(&self, friction: &Friction<S>, (by, by_width): (S, S), out: &mut Pulled<S>) {
        out.scalars[SLIP] += by_width;
        let (Some([e, by_square]), Some(more)) = (self.falling, &friction.stribeck) else {
            out.scalars[COEFFICIENT] += by;
            return;
        };
        out.scalars[COEFFICIENT] += by * (S::one() - e);
        out.scalars[STATIC] += by * e;
        // q / v_s² is the exponent.
        let square = self.tangential.dot(&self.tangential);
        out.scalars[SPEED] -= by * by_square * square * 2.0 / more.speed;
    }
}

/// Adds the derivatives in the parameters to their cotangents.
pub(super) fn give(scalars: &[f64], own: &mut Friction<f64>) {
    own.coefficient += scalars[COEFFICIENT];
    own.width += scalars[SLIP];
    if let Some(more) = &mut own.stribeck {
        more.coefficient += scalars[STATIC];
        more.speed += scalars[SPEED];
    }
}
