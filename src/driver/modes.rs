//! The modes that a file asks for, at one speed of rotation and over several.

use crate::problem::Problem;
use crate::system::equilibrium::MachineModes;
use crate::system::failure::AssemblyFailure;

/// The modes of a machine that are told and drawn.
#[derive(Clone, Debug)]
pub struct ToldModes {
    /// Speed of rotation \[rad/s\], if the machine turns.
    pub speed: Option<f64>,
    /// The modes there, the lowest first.
    pub modes: MachineModes,
    /// Speeds of rotation with their modes, as a Campbell diagram shows.
    pub diagram: Vec<(f64, MachineModes)>,
}

/// The modes that the file asks for at the design `x`; `None` if it asks for none.
///
/// # Errors
/// The machine has no rest, or none that is stable.
pub fn told(problem: &Problem, x: &[f64]) -> Result<Option<ToldModes>, AssemblyFailure> {
    let Some(wanted) = problem.told_modes() else {
        return Ok(None);
    };
    let at = |speed: Option<f64>| problem.modes_of_machine(x, (wanted.count, speed));
    let modes = at(None)?;
    let diagram = (wanted.speeds.iter())
        .map(|&speed| at(Some(speed)).map(|modes| (speed, modes)))
        .collect::<Result<_, _>>()?;
    Ok(Some(ToldModes {
        speed: problem.speed(x),
        modes,
        diagram,
    }))
}
