//! Structures at rest under load cases, their modes, and the start of a motion in equilibrium.

use super::SimulationError;
use super::response::has_one_motion;
use super::states::BodyState;
use crate::driver::statics::StaticDesign;
use crate::driver::{AnalysisFailure, Simulated};
use crate::figures::statics::fields::stresses;
use crate::integrate::IntegrationFailure;
use crate::math::Vec3;
use crate::model::FlexibleBody;
use crate::problem::Problem;
use crate::system::initial::consistent;
use crate::system::{BodyMotion, Numbering};
use std::f64::consts::PI;

/// Structures of a design under load cases.
#[derive(Clone, Debug, Default)]
pub struct Rest {
    /// Places of the nodes \[m\].
    pub nodes: Vec<[f64; 3]>,
    /// The load cases in the order of the file.
    pub cases: Vec<CaseAtRest>,
    /// Value of every function.
    pub values: Vec<f64>,
}

/// A solved load case.
#[derive(Clone, Debug, Default)]
pub struct CaseAtRest {
    /// Its name.
    pub name: String,
    /// Displacement of each node \[m\].
    pub displacement: Vec<[f64; 3]>,
    /// Rotation of each node \[rad\]; on a smooth surface without its part about the normal.
    pub rotation: Vec<[f64; 3]>,
    /// The largest von Mises stress of each shell \[Pa\].
    pub shell_stress: Vec<f64>,
    /// The largest stress along the outer fibres of each beam \[Pa\]; NaN for sections without size.
    pub beam_stress: Vec<f64>,
}

/// A mode of structures.
#[derive(Clone, Debug, Default)]
pub struct Mode {
    /// Natural frequency \[Hz\].
    pub frequency: f64,
    /// Displacement of each node, for a modal mass of one \[m\].
    pub displacement: Vec<[f64; 3]>,
}

fn list(all: &[Vec3<f64>]) -> Vec<[f64; 3]> {
    all.iter().map(|v| (*v).into()).collect()
}

fn structures(problem: &Problem, x: &[f64]) -> Result<StaticDesign, SimulationError> {
    if problem.cases.is_some() {
        return Err(AnalysisFailure::SeveralCases.into());
    }
    match Simulated::of_statics(problem, x)? {
        Some(design) => Ok(design),
        None => Err(AnalysisFailure::Undefined(
            "the problem is one of a motion, so it has no structures under load cases".to_owned(),
        )
        .into()),
    }
}

/// Solves the load cases of structures at the design `x`.
///
/// # Errors
/// A load case has no solution, or the problem is one of a motion.
pub fn rest(problem: &Problem, x: &[f64]) -> Result<Rest, SimulationError> {
    let design = structures(problem, x)?;
    let case = |(case, name): (usize, &String)| {
        let solution = design.solutions.get(case).filter(|own| !own.is_empty())?;
        let motion =
            design.with_solved(|solved| (solved.problem).motion(solved.structure, solution))?;
        let [shell_stress, beam_stress] = stresses(&design, case)?;
        Some(CaseAtRest {
            name: name.clone(),
            displacement: list(&motion.displacement),
            rotation: list(&motion.rotation),
            shell_stress,
            beam_stress,
        })
    };
    let count = problem.functions().len();
    Ok(Rest {
        nodes: list(&design.scene.structure.nodes),
        cases: (design.statics.cases.iter().enumerate())
            .filter_map(case)
            .collect(),
        values: (0..count).map(|f| design.function(f).value).collect(),
    })
}

/// The `count` lowest modes of structures at the design `x`, or all if there are fewer, and the number of
/// rigid motions, which have none.
///
/// # Errors
/// Modes are not found, or the problem is one of a motion.
pub fn modes(
    problem: &Problem,
    x: &[f64],
    count: usize,
) -> Result<(Vec<Mode>, usize), SimulationError> {
    let mut design = structures(problem, x)?;
    let found = design.lowest_modes(count).map_err(AnalysisFailure::from)?;
    let pairs = found.eigenvalues.iter().zip(&found.vectors).take(count);
    let mode = |(eigenvalue, vector): (&f64, &Vec<f64>)| Mode {
        frequency: eigenvalue.sqrt() / (2.0 * PI),
        displacement: (design.motion_of_mode(vector)).map_or_else(Vec::new, |all| list(&all)),
    };
    Ok((pairs.map(mode).collect(), found.rigid))
}

/// States of the bodies of the file and the elastic coordinates of flexible ones at the start of the motion at the
/// design `x`: with `"start": "equilibrium"` the equilibrium.
///
/// # Errors
/// The joints cannot be closed, no equilibrium is found, or the problem is one of structures.
pub fn start_states(
    problem: &Problem,
    x: &[f64],
) -> Result<Vec<(String, BodyState, Vec<f64>)>, SimulationError> {
    has_one_motion(problem)?;
    let scene = problem.unlowered_scene::<f64>(x);
    let assembly = |failure| AnalysisFailure::from(IntegrationFailure::Assembly(failure));
    scene.admit_start().map_err(AnalysisFailure::from)?;
    let (model, numbering) = (&scene.model, Numbering::new(&scene.model));
    let start = consistent(model, &numbering).map_err(assembly)?;
    let mut motions = Vec::new();
    BodyMotion::all(&numbering, &start.q, &start.v, &mut motions);
    let state = |body: usize| {
        let motion: &BodyMotion<f64> = &motions[body];
        let state = BodyState {
            position: motion.position.into(),
            orientation: motion.orientation,
            velocity: motion.velocity.into(),
            angular_velocity: (motion.rotation * motion.omega).into(),
        };
        let own = model.flexible.iter().find(|own| own.frame == body);
        let places = own.into_iter().flat_map(FlexibleBody::places);
        let elastic = places.map(|(carrier, axis)| motions[carrier].position[axis]);
        (model.bodies[body].name.clone(), state, elastic.collect())
    };
    let own = (0..model.bodies.len()).filter(|&body| !model.is_internal(body));
    Ok(own.map(state).collect())
}
