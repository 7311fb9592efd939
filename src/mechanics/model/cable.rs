//! A cable over frictionless pulleys: its parameters.
//!
//! It runs straight from point to point, and its tension N is the same everywhere:
//!
//! ```text
//! L = Σ |P_i − P_{i+1}|,   δ = L − L0(t),   N = N(δ, δ̇),   F_i = −N ∂L/∂P_i
//! ```
//!
//! N is the [`NormalLaw`] of a stop: a cable pulls and never presses. A winch is a length L0 that depends on time. Formulas and
//! derivatives are in `system::loads::cable`.

use super::normal_law::NormalLaw;
use super::time_function::TimeFunction;
use crate::math::{Vec3, parameters};

/// A point of a cable: an end, or a pulley without radius.
#[derive(Clone, Debug)]
pub struct CablePoint<S> {
    /// Its body; `None` is ground.
    pub body: Option<usize>,
    /// From the centre of mass in body axes (on ground: from the origin) \[m\].
    pub point: Vec3<S>,
}

/// A cable.
#[derive(Clone, Debug)]
pub struct Cable<S> {
    /// Its points in order, at least two. Those that follow each other must stay apart.
    pub points: Vec<CablePoint<S>>,
    /// L0 \[m\], twice continuously differentiable.
    pub length: TimeFunction<S>,
    /// The law of the tension.
    pub law: NormalLaw<S>,
}

parameters!(struct CablePoint { body; point });
parameters!(struct Cable {; points, length, law });

impl<S> Cable<S> {
    /// Whether the length never changes.
    pub fn is_fixed(&self) -> bool {
        matches!(&self.length, TimeFunction::Polynomial(all) if all.len() == 1)
    }
}
