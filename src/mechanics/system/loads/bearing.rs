//! Friction of a bearing or guide that a bushing holds: by the force across its axis.
//!
//! With the force (r_1, r_2) of the bushing along e1 and e2 and the rate ω of the turn about e3, or of the slide along it:
//!
//! ```text
//! T = μ ρ N tanh(ω / w),   N = √(r_1² + r_2² + n²) − n          ρ the radius of a bearing, 1 of a guide
//! ```

use super::power::tanh;
use crate::math::Scalar;
use crate::model::load::BearingFriction;

/// Number of parameters: μ, ρ, w and n.
pub(super) const PARAMETERS: usize = 4;

/// T and its derivatives.
pub(super) struct Resistance<S> {
    /// T \[N m or N\].
    pub value: S,
    /// In ω.
    pub by_rate: S,
    /// In r_1 and r_2.
    pub by_forces: [S; 2],
    /// In the parameters.
    pub by_own: [S; PARAMETERS],
}

/// T under a force at a rate.
pub(super) fn resistance<S: Scalar>(
    own: &BearingFriction<S>,
    [x, y]: [S; 2],
    rate: S,
) -> Resistance<S> {
    let root = (x * x + y * y + own.load_width * own.load_width).sqrt();
    let load = root - own.load_width;
    let share = tanh(rate / own.width);
    let slope = (S::one() - share * share) / own.width;
    let arm = own.coefficient * own.radius;
    let by_load = arm * share;
    let by_rate = arm * load * slope;
    Resistance {
        value: by_load * load,
        by_rate,
        by_forces: [x, y].map(|force| by_load * force / root),
        by_own: [
            own.radius * load * share,
            own.coefficient * load * share,
            -(by_rate * rate / own.width),
            by_load * (own.load_width / root - 1.0),
        ],
    }
}
