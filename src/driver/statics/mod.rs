//! Structures under load cases at a design: solutions, modes, functions, exact gradients.

pub mod check;
mod derivatives;
pub mod error;
mod inspect;
mod lifted;
mod limits;
mod modes;
pub mod precision;

use crate::composed;
use crate::integrate::WorkCounts;
use crate::math::soft_max::{self, Smoothed, smoothed, two_digits};
use crate::problem::{
    Asked, Composition, MeasuredFunction, Partials, Problem, StaticScene, Statics, Workspace,
};
use crate::structures::functions::{Function, Peak, Solved};
use crate::structures::modes::{LowestFrequency, ModalFailure, ModalProblem, Modes, lowest_of};
use crate::structures::properties::PropertyFault;
use crate::structures::quality::{MeshFault, faults};
use crate::structures::statics::{StaticFailure, StaticProblem};
use crate::structures::structure::Structure;
use crate::structures::von_karman::LoadSteps;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// ρ times the lowest frequency: where two of them meet, the aggregate is less than 1 % below.
const OF_FREQUENCY: f64 = 100.0;

/// Why structures have no solution or no gradient at a design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StaticsFailure {
    /// The mesh of this design.
    #[error("the mesh is not sound at this design: {0}")]
    Mesh(#[from] MeshFault),
    /// Sections or inertias of this design.
    #[error("the design cannot be built: {0}")]
    Properties(#[from] PropertyFault),
    /// A signal.
    #[error("the analysis was interrupted")]
    Interrupted,
    /// A number is not defined.
    #[error("{what}")]
    Undefined {
        /// Which, and its value.
        what: String,
    },
    /// A load case.
    #[error("load case \"{case}\": {failure}")]
    Case {
        /// Its name.
        case: String,
        /// What is wrong.
        failure: StaticFailure,
    },
    /// Modes.
    #[error(transparent)]
    Modal(#[from] ModalFailure),
    /// A value that is not a number.
    #[error("load case \"{case}\": the displacements are not finite")]
    NotFinite {
        /// The case.
        case: String,
    },
    /// A finer mesh for an estimate of errors.
    #[error(
        "a mesh of {elements} elements needs about {needed} of memory, of which {available} is available"
    )]
    Memory {
        /// Elements of the finer mesh.
        elements: usize,
        /// Memory needed.
        needed: String,
        /// Memory available.
        available: String,
    },
}

/// The value of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticValue {
    /// The value.
    pub value: f64,
    /// The largest stress ratio and where it is, of an aggregate of stresses.
    pub peak: Option<Peak>,
}

/// Structures at a design with their solutions.
pub struct StaticDesign {
    /// The design.
    pub x: Vec<f64>,
    /// Structures and loads there.
    pub scene: StaticScene<f64>,
    /// Data that no design changes.
    pub statics: Arc<Statics>,
    /// The solution of each load case; empty if no function needs them.
    pub solutions: Vec<Vec<f64>>,
    /// The lowest modes, if single frequencies are requested.
    pub modes: Option<Modes>,
    /// Functions that expressions of others give.
    pub composition: Arc<Composition>,
    lowest: Vec<Option<LowestFrequency>>,
    /// By function: its mode among them, if it is followed by its shape.
    places: Vec<Option<usize>>,
    values: Vec<Option<StaticValue>>,
    workspace: Mutex<Workspace>,
    /// The work of the solutions.
    pub counts: WorkCounts,
}

impl Drop for StaticDesign {
    fn drop(&mut self) {
        let own = std::mem::take(self.workspace());
        self.statics.workspaces.give(own);
    }
}

/// The matrices of load cases, analysed when they are needed first.
fn of_cases<'w>(
    workspace: &'w mut Workspace,
    statics: &Statics,
    structure: &Structure<f64>,
) -> Result<&'w mut StaticProblem, ModalFailure> {
    if workspace.statics.is_none() {
        let (supports, unknowns) = (&statics.supports, statics.node_unknowns);
        workspace.statics = Some(StaticProblem::new(structure, supports, unknowns)?);
    }
    Ok(workspace.statics.as_mut().expect("it was made"))
}

/// The matrices of modes, likewise.
fn of_modes<'w>(
    workspace: &'w mut Workspace,
    statics: &Statics,
    structure: &Structure<f64>,
) -> Result<&'w mut ModalProblem, ModalFailure> {
    if workspace.modal.is_none() {
        let (supports, unknowns) = (&statics.supports, statics.node_unknowns);
        workspace.modal = Some(ModalProblem::new(structure, supports, unknowns)?);
    }
    Ok(workspace.modal.as_mut().expect("it was made"))
}

/// The load cases that a function needs.
fn cases_of(function: &Asked) -> &[usize] {
    match function {
        Asked::OfSolutions(function) => match function {
            Function::Mass
            | Function::Centre(_)
            | Function::SecondMoment(..)
            | Function::Inertia(..) => &[],
            Function::Reaction { case, .. }
            | Function::ReactionMoment { case, .. }
            | Function::StrainEnergy { case }
            | Function::Compliance { case }
            | Function::Displacement { case, .. } => std::slice::from_ref(case),
            Function::Stress { cases, .. } => cases,
        },
        Asked::Frequency { .. }
        | Asked::LowestFrequency(_)
        | Asked::Misfit { .. }
        | Asked::DistanceFromStart => &[],
    }
}

/// Functions and those that they are of, each once, those first.
fn with_measured(statics: &Statics, which: &[usize]) -> Vec<usize> {
    let measured = which.iter().flat_map(|&f| match &statics.functions[f] {
        Asked::Misfit { numbers, .. } => &numbers[..],
        _ => &[],
    });
    let mut all: Vec<usize> = measured.map(|own| own.function).collect();
    let is_misfit = |f: &usize| matches!(statics.functions[*f], Asked::Misfit { .. });
    all.extend(which.iter().copied().filter(|f| !is_misfit(f)));
    all.sort_unstable();
    all.dedup();
    let mut misfits: Vec<usize> = which.iter().copied().filter(is_misfit).collect();
    misfits.sort_unstable();
    misfits.dedup();
    all.extend(misfits);
    all
}

impl StaticDesign {
    /// Solves the design `x` for the functions `asked`, or for all load cases and functions.
    ///
    /// # Errors
    /// [`StaticsFailure`] if the mesh is not sound, a load is not carried, or modes are not found.
    pub fn of(
        problem: &Problem,
        statics: &Arc<Statics>,
        x: &[f64],
        asked: Option<&[usize]>,
    ) -> Result<Self, StaticsFailure> {
        if problem.simulation.limits.is_over() {
            return Err(StaticsFailure::Interrupted);
        }
        if let Some(what) = problem.undefined_expression(x) {
            return Err(StaticsFailure::Undefined { what });
        }
        let scene: StaticScene<f64> = problem.static_scene(statics, x);
        if problem.moves_meshes()
            && let Some(fault) = faults(statics.mesh(), &scene.structure.nodes)
                .into_iter()
                .next()
        {
            return Err(fault.into());
        }
        if let Some(fault) = scene.structure.property_fault() {
            return Err(fault.into());
        }
        let all: Vec<usize> = (0..problem.function_names.len()).collect();
        let (asked_of, composition) = (asked.unwrap_or(&all), &problem.composition);
        let which = &with_measured(statics, &composition.of_scene(asked_of))[..];
        let needed = which.iter().flat_map(|&f| cases_of(&statics.functions[f]));
        let mut needed: Vec<usize> = match asked {
            Some(_) => needed.copied().collect(),
            None => (0..statics.cases.len()).collect(),
        };
        needed.sort_unstable();
        needed.dedup();
        let mut design = Self {
            x: x.to_vec(),
            solutions: vec![Vec::new(); statics.cases.len()],
            modes: None,
            composition: composition.clone(),
            lowest: vec![None; statics.functions.len()],
            places: vec![None; statics.functions.len()],
            values: vec![None; statics.functions.len()],
            workspace: Mutex::new(statics.workspaces.take()),
            counts: WorkCounts::default(),
            statics: statics.clone(),
            scene,
        };
        design.solve(&needed)?;
        design.find_modes(problem, which)?;
        for &f in which {
            design.values[f] = Some(design.value_of(problem, f)?);
        }
        Ok(design)
    }

    /// The workspace, which threads share.
    fn shared(&self) -> MutexGuard<'_, Workspace> {
        self.workspace
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn workspace(&mut self) -> &mut Workspace {
        self.workspace
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn solve(&mut self, needed: &[usize]) -> Result<(), StaticsFailure> {
        let mut workspace = std::mem::take(self.workspace());
        let found = self.solve_in(&mut workspace, needed);
        *self.workspace() = workspace;
        found
    }

    fn solve_in(
        &mut self,
        workspace: &mut Workspace,
        needed: &[usize],
    ) -> Result<(), StaticsFailure> {
        let (statics, structure) = (&self.statics, &self.scene.structure);
        let matrices = of_cases(workspace, statics, structure)?;
        let name = |case: usize| statics.cases[case].clone();
        if let (Some(&first), false) = (needed.first(), statics.terms.von_karman) {
            matrices
                .factorise(structure)
                .map_err(|failure| StaticsFailure::Case {
                    case: name(first),
                    failure,
                })?;
            self.counts.factorisations += 1;
        }
        for &case in needed {
            let loads = &self.scene.cases[case];
            let found = match statics.terms.von_karman {
                true => {
                    let found = matrices.solve_von_karman(structure, loads, &LoadSteps::default());
                    found.map(|found| {
                        self.counts.factorisations += found.work.tangents;
                        self.counts.newton_iterations += found.work.tangents;
                        self.counts.solves += found.work.tangents;
                        found.x
                    })
                }
                false => {
                    self.counts.solves += 3;
                    let found = matrices.solve_linear(structure, loads);
                    found.map_err(StaticFailure::from)
                }
            };
            let x = found.map_err(|failure| StaticsFailure::Case {
                case: name(case),
                failure,
            })?;
            if x.iter().any(|x| !x.is_finite()) {
                return Err(StaticsFailure::NotFinite { case: name(case) });
            }
            self.solutions[case] = x;
        }
        Ok(())
    }

    /// Calls `with` with the solutions, as structures know them.
    pub fn with_solved<T>(&self, with: impl FnOnce(&Solved<f64>) -> T) -> Option<T> {
        let workspace = self.shared();
        Some(with(&Solved {
            problem: workspace.statics.as_ref()?,
            structure: &self.scene.structure,
            cases: &self.scene.cases,
            solutions: &self.solutions,
            terms: self.statics.terms,
        }))
    }

    fn value_of(&self, problem: &Problem, f: usize) -> Result<StaticValue, StaticsFailure> {
        let plain = |value| StaticValue { value, peak: None };
        Ok(match &self.statics.functions[f] {
            Asked::DistanceFromStart => plain(problem.distance_from_start(&self.x)),
            Asked::Misfit { numbers, .. } => {
                let square = |own: &MeasuredFunction| self.residual(own).powi(2);
                plain(numbers.iter().map(square).sum::<f64>() / numbers.len() as f64)
            }
            Asked::LowestFrequency(_) => {
                let found = self.lowest[f].as_ref();
                plain(found.expect("it was found before").value)
            }
            Asked::Frequency { .. } => {
                let found = self.modes.as_ref().expect("modes were found before");
                plain(found.frequencies()[self.mode_of(f)])
            }
            Asked::OfSolutions(function) => {
                let found = self.with_solved(|solved| {
                    let value = solved.value(function)?;
                    let peak = match function {
                        Function::Stress { cases, faces, .. } => Some(solved.peak(cases, faces)?),
                        _ => None,
                    };
                    Ok(StaticValue { value, peak })
                });
                let found = found.expect("the matrices were made before");
                found.map_err(|unknown| ModalFailure::from(StaticFailure::UnknownSet(unknown)))?
            }
        })
    }

    /// The distance of a requested function from its measured value, in standard deviations.
    ///
    /// # Panics
    /// If the function was not requested.
    pub fn residual(&self, own: &MeasuredFunction) -> f64 {
        (self.function(own.function).value - own.value) * own.weight
    }

    /// The value of a requested function.
    ///
    /// # Panics
    /// If it was not requested.
    pub fn function(&self, f: usize) -> StaticValue {
        let of = |g: usize| self.values[g].expect("the function was asked for");
        match self.composition.gives(f) {
            false => of(f),
            true => StaticValue {
                value: self.composition.value(f, &self.x, &|g| of(g).value),
                peak: None,
            },
        }
    }

    /// Derivatives of an expression by the functions and numbers that it names.
    pub fn partials(&self, f: usize) -> Partials {
        let of = |g: usize| self.function(g).value;
        self.composition.partials(f, &self.x, &of)
    }

    /// The value of a stress with another ρ.
    fn stress(&self, function: &Function, sharpness: f64) -> f64 {
        let mut other = function.clone();
        if let Function::Stress { rho, .. } = &mut other {
            *rho = sharpness;
        }
        let value = self.with_solved(|solved| solved.value(&other).ok());
        value.flatten().unwrap_or(f64::NAN)
    }

    /// A ρ that keeps a requested aggregate within 1 % of what it stands for, and that value. The present ρ does not matter.
    pub(super) fn near_rho(&self, f: usize) -> Option<(f64, f64)> {
        match &self.statics.functions[f] {
            Asked::LowestFrequency(_) => {
                let frequencies = self.lowest[f].as_ref()?.modes.frequencies();
                let lowest = *frequencies.first()?;
                Some((two_digits(OF_FREQUENCY / lowest), lowest))
            }
            Asked::OfSolutions(function @ Function::Stress { .. }) => {
                let largest = self.values[f]?.peak?.ratio;
                let with = |rho: f64| self.stress(function, rho);
                Some((soft_max::near((largest, largest), with)?, largest))
            }
            Asked::OfSolutions(_)
            | Asked::Frequency { .. }
            | Asked::Misfit { .. }
            | Asked::DistanceFromStart => None,
        }
    }

    /// What a requested function stands for, if it is an aggregate.
    pub fn smoothed(&self, f: usize) -> Option<Smoothed> {
        if self.composition.gives(f) {
            let one = |g: usize| (self.smoothed(g), self.function(g).value);
            return composed::smoothed(&self.composition, f, &self.x, &one);
        }
        let found = self.values[f]?;
        match &self.statics.functions[f] {
            Asked::LowestFrequency(rho) => {
                let frequencies = self.lowest[f].as_ref()?.modes.frequencies();
                let lowest = *frequencies.first()?;
                // Sharper aggregates need no more modes.
                let with = |factor: f64| lowest_of(&frequencies, rho * factor);
                Some(smoothed(found.value, (lowest, lowest), vec![*rho], with))
            }
            Asked::OfSolutions(function @ Function::Stress { rho, .. }) => {
                let largest = found.peak?.ratio;
                let with = |factor: f64| self.stress(function, rho * factor);
                Some(smoothed(found.value, (largest, largest), vec![*rho], with))
            }
            Asked::OfSolutions(_)
            | Asked::Frequency { .. }
            | Asked::Misfit { .. }
            | Asked::DistanceFromStart => None,
        }
    }
}
