//! Whether quantities that have to vanish do, and the first one that does not.

use crate::math::Scalar;

/// Size, relative to its scale, up to which a quantity is round-off.
pub(super) const ROUND_OFF: f64 = 1e-13;

/// What stands against a reduction.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What it is, with the name of the part of the scene.
    pub what: String,
    /// By how much (or, if a variable is at fault, by how much for a typical change of it).
    pub size: f64,
    /// Unit of the size.
    pub unit: &'static str,
    /// The design variable that makes it so, if only some designs do.
    pub variable: Option<String>,
    /// Whether it is so at a design between the bounds, and not at the start.
    pub elsewhere: bool,
}

impl std::fmt::Display for Obstacle {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}", self.what)?;
        if self.size > 0.0 {
            write!(f, " by {:.1e}", self.size)?;
            if !self.unit.is_empty() {
                write!(f, " {}", self.unit)?;
            }
        }
        match &self.variable {
            Some(name) => write!(f, ", moved by the variable \"{name}\""),
            None if self.elsewhere => write!(f, ", at another design"),
            None => Ok(()),
        }
    }
}

/// Collects the first quantity that does not vanish.
pub(super) struct Examiner {
    /// The typical change that an infinitesimal part is multiplied by.
    pub change: f64,
    pub found: Result<(), Obstacle>,
}

impl Examiner {
    pub fn new(change: f64) -> Self {
        Self {
            change,
            found: Ok(()),
        }
    }

    /// Asks that `value` vanishes beside `scale`; `what` tells it with its unit if it does not.
    pub fn zero<S: Scalar>(
        &mut self,
        value: S,
        scale: f64,
        what: impl FnOnce() -> (String, &'static str),
    ) {
        self.vanishes(&[value], scale, what);
    }

    /// As [`Examiner::zero`], of a vector.
    pub fn vanishes<S: Scalar>(
        &mut self,
        vector: &[S],
        scale: f64,
        what: impl FnOnce() -> (String, &'static str),
    ) {
        let length = |part: &dyn Fn(S) -> f64| {
            let squares = vector.iter().map(|x| part(*x).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let derived = length(&|x| x.infinitesimal()) * self.change;
        let size = length(&|x| x.re()).max(derived);
        // A value that is not a number does not vanish.
        if self.found.is_ok() && (size.is_nan() || size > ROUND_OFF * scale) {
            let (what, unit) = what();
            // Angles are asked for by their sine.
            let size = match unit {
                "rad" => size.min(1.0).asin(),
                _ => size,
            };
            self.found = Err(Obstacle {
                what,
                size,
                unit,
                variable: None,
                elsewhere: false,
            });
        }
    }
}
