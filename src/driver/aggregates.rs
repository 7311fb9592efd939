//! Chooses ρ of aggregates whose file leaves it out, so that a function is within 1 % of what it stands for at the start; or
//! within 1 % of its limits, if it has some. An objective is sharper.

use super::analysed::Simulated;
use crate::functions::smoothed;
use crate::math::soft_max::two_digits;
use crate::problem::{Faults, OpenAggregate, Override, Problem};
use serde_json::Value;

/// ρ of an objective by the smallest that suits the start: its values fall, and several maxima become equal.
const OF_OBJECTIVE: f64 = 4.0;

/// The ρ of a function's aggregates.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenRho {
    /// The function.
    pub name: String,
    /// ρ, by the unit of the quantity.
    pub rho: Value,
}

impl std::fmt::Display for ChosenRho {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.rho.as_f64() {
            Some(rho) => write!(f, "rho of \"{}\": {rho}", self.name),
            None => write!(f, "rho of \"{}\": {}", self.name, self.rho),
        }
    }
}

/// Why there is no problem.
#[derive(Debug, thiserror::Error)]
pub enum Unread {
    /// The file has faults.
    #[error(transparent)]
    Faults(#[from] Faults),
    /// No ρ can be chosen.
    #[error("{pointer}: found no \"rho\", and none can be chosen, as {reason}; expected a number")]
    NotChosen {
        /// Where it is missing.
        pointer: String,
        /// Why.
        reason: String,
    },
}

/// Reads a problem with overrides, and chooses each ρ that its file leaves out by one simulation at the start. Tells `chosen` of
/// them. A file with all of them is read once, and nothing is simulated.
///
/// # Errors
/// Faults of the file, or a ρ that cannot be chosen.
pub fn read(
    read: &dyn Fn(&[Override]) -> Result<Problem, Faults>,
    overrides: &[Override],
    chosen: &mut dyn FnMut(&ChosenRho),
) -> Result<Problem, Unread> {
    let problem = read(overrides)?;
    let open = problem.open_aggregates();
    if open.is_empty() {
        return Ok(problem);
    }
    let with = |more: Vec<Override>| read(&[overrides, &more].concat());
    let provisional: Vec<Override> = open.iter().flat_map(OpenAggregate::provisional).collect();
    let mut start = None;
    let mut all = Vec::new();
    for own in open {
        let rho = match &own.given {
            Some(rho) => rho.clone(),
            None => {
                let (problem, at) = match start.take() {
                    Some(known) => known,
                    None => simulated(with(provisional.clone())?, &own.pointers[0])?,
                };
                let rho = near(&problem, &at, &own)?;
                start = Some((problem, at));
                Value::from(rho)
            }
        };
        all.extend(own.overrides(&rho));
        chosen(&ChosenRho {
            name: own.name,
            rho,
        });
    }
    Ok(with(all)?)
}

fn simulated(problem: Problem, pointer: &str) -> Result<(Problem, Simulated), Unread> {
    let at = Simulated::of(&problem, &problem.start()).map_err(|failure| Unread::NotChosen {
        pointer: pointer.to_owned(),
        reason: format!("the start has no values: {failure}"),
    })?;
    Ok((problem, at))
}

/// ρ for a function at a design, and what it stands for there. Of a function of several cases the sharpest.
fn of_function(at: &Simulated, own: &OpenAggregate) -> Option<(f64, f64)> {
    let f = own.function;
    match at {
        Simulated::Motion(simulation) => {
            let at = &simulation.at;
            smoothed::near(&at.scene.functions[f], &at.scene.model, &at.run)
        }
        Simulated::Statics(at) => at.near_rho(f),
        Simulated::Cases(at) if at.place(f).is_none() => at.near_rho(f),
        Simulated::Cases(at) => {
            let each = at.each().filter_map(|(case, at)| {
                let function = case.problem.named_or_first(&own.name)?;
                let own = OpenAggregate {
                    function,
                    ..own.clone()
                };
                of_function(at, &own)
            });
            each.max_by(|a, b| a.0.total_cmp(&b.0))
        }
    }
}

/// A ρ for a function at the start.
fn near(problem: &Problem, at: &Simulated, own: &OpenAggregate) -> Result<f64, Unread> {
    let f = own.function;
    let found = of_function(at, own);
    let (rho, value) = found.ok_or_else(|| Unread::NotChosen {
        pointer: own.pointers[0].clone(),
        reason: "its value at the start is zero, or its quantity has no largest value".to_owned(),
    })?;
    let limits = problem.constraints.iter().filter(|own| own.function == f);
    let limits = limits.flat_map(|own| [own.lower.abs(), own.upper.abs()]);
    let limits = limits.filter(|limit| *limit > 0.0 && limit.is_finite());
    let least = limits.fold(f64::INFINITY, f64::min);
    let is_objective = problem.objective.is_some_and(|own| own.function == f);
    let factor = match least.is_finite() && value != 0.0 {
        true => value.abs() / least,
        false if is_objective => OF_OBJECTIVE,
        false => return Ok(rho),
    };
    Ok(two_digits(rho * factor / 1.05))
}
