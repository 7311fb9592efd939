//! What the penetration of a stop or contact follows from, for the control of steps.

use crate::math::Vec3;

/// What a penetration follows from, with rates. All of it is smooth, also where a body flies past a point.
#[derive(Clone, Copy, Debug)]
pub enum Course {
    /// The penetration itself.
    Depth {
        /// Penetration, negative before the contact \[m or rad\].
        value: f64,
        /// Its rate.
        rate: f64,
    },
    /// A point y and a segment from −a to a at a distance d: the penetration is `side` (`reach` − d).
    Distance {
        /// y \[m\].
        point: Vec3<f64>,
        /// ẏ \[m/s\].
        rate: Vec3<f64>,
        /// a; zero for a point \[m\].
        half: Vec3<f64>,
        /// Distance at which they touch \[m\].
        reach: f64,
        /// 1 if they press when near, −1 when far.
        side: f64,
    },
}

impl Course {
    /// The penetration.
    pub fn penetration(&self) -> f64 {
        match *self {
            Self::Depth { value, .. } => value,
            Self::Distance {
                point,
                half,
                reach,
                side,
                ..
            } => {
                let square = half.norm_squared();
                let along = match square > 0.0 {
                    true => (point.dot(&half) / square).clamp(-1.0, 1.0),
                    false => 0.0,
                };
                side * (reach - (point - half * along).norm())
            }
        }
    }
}
