//! Functions of a motion beside those of another problem at the same design.

use super::evaluate::Evaluated;
use super::integration::Integration;
use crate::integrate::IntegrationFailure;
use crate::problem::Problem;

/// A function of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// The function, by index.
    pub function: usize,
    /// Its value.
    pub value: f64,
    /// Its value by the other problem.
    pub other: f64,
    /// The largest value over the motion of both, if it is an aggregate.
    pub maximum: Option<[f64; 2]>,
}

impl Compared {
    /// The difference, absolute.
    pub fn error(&self) -> f64 {
        (self.value - self.other).abs()
    }
}

/// Functions of a simulated design, and those of another problem at the same design.
///
/// # Errors
/// If the simulation of the other fails.
pub(super) fn compare(
    at: &Evaluated,
    other: &Problem,
    which: &[usize],
) -> Result<Vec<Compared>, IntegrationFailure> {
    let other = run(other, &at.x, which)?;
    let one = |&function: &usize| {
        let [own, other] = [at, &other].map(|of| of.function(function));
        let maxima = own.maximum.zip(other.maximum);
        Compared {
            function,
            value: own.value,
            other: other.value,
            maximum: maxima.map(|(own, other)| [own.value, other.value]),
        }
    };
    Ok(which.iter().map(one).collect())
}

/// A problem at a design, simulated for the functions `which`.
///
/// # Errors
/// If the simulation fails.
pub fn run(problem: &Problem, x: &[f64], which: &[usize]) -> Result<Evaluated, IntegrationFailure> {
    let scene = problem.scene(x);
    let mut integration = Integration::new(problem, &scene, Some(which), false);
    let (at, _) = Evaluated::with(&mut integration, problem, x)?;
    Ok(at)
}
