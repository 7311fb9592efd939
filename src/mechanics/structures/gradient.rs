//! Exact gradients of functions of static solutions.
//!
//! J(x_1 …, p) of the solutions x_c of the load cases and the numbers p of the structure. One adjoint
//! solve a case, K ψ = ∂J/∂x with the tangent K at x_c, gives
//!
//! ```text
//! dJ/dp = ∂J/∂p + ψ·∂f/∂p − ψ·∂F/∂p
//! ```
//!
//! (f the loads, F the internal forces). The products with ψ are the infinitesimal parts of the
//! derivatives of work and energy at x + ε ψ. By thickness alone, ∂F/∂h of each shell is found once for all
//! functions.

use super::assembly::add_energy_transpose;
use super::functions::{Function, Partial, Solved, zero_load};
use super::loads::{Load, add_work_transpose};
use super::mesh::UnknownSet;
use super::reactions::stiffness_times;
use super::shell::{Motion, NODES, ShellCotangent, Terms};
use super::state::NodalMotion;
use super::statics::{StaticFailure, StaticProblem, mechanism};
use super::structure::Structure;
use crate::math::{Dual, Vec3};
use rayon::prelude::*;

/// Derivatives of a function: by the structure, by the loads of each case.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// By the numbers of the structure, each in its own place.
    pub structure: Structure<f64>,
    /// By the numbers of the loads, each in its own place.
    pub cases: Vec<Vec<Load<f64>>>,
}

/// By which numbers of a structure a function is derived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// All of them.
    Everything,
    /// The thickness of the shells. The others may be left out, which makes many functions cheap: the derivatives of
    /// the internal forces by the thickness are found once.
    Thickness,
}

/// The gradient of a function of a linear solution by everything. `problem` still has the factors of the
/// stiffness.
///
/// # Errors
/// [`UnknownSet`] if function or loads name no set of the mesh.
pub fn gradient(
    problem: &mut StaticProblem,
    structure: &Structure<f64>,
    cases: &[Vec<Load<f64>>],
    solutions: &[Vec<f64>],
    function: &Function,
) -> Result<Gradient, UnknownSet> {
    let at = Solutions {
        structure,
        cases,
        solutions,
        terms: Terms::LINEAR,
    };
    match gradients(problem, &at, &[function], By::Everything) {
        Ok(mut found) => Ok(found.gradients.remove(0)),
        Err(StaticFailure::UnknownSet(unknown)) => Err(unknown),
        Err(other) => unreachable!("linear adjoints make no factors: {other}"),
    }
}

/// The gradient of a function of states with von Karman's strains by everything.
///
/// # Errors
/// [`StaticFailure`] if a state is not stable, or if function or loads name no set of the mesh.
pub fn gradient_von_karman(
    problem: &mut StaticProblem,
    structure: &Structure<f64>,
    cases: &[Vec<Load<f64>>],
    solutions: &[Vec<f64>],
    function: &Function,
) -> Result<Gradient, StaticFailure> {
    let at = Solutions {
        structure,
        cases,
        solutions,
        terms: Terms::VON_KARMAN,
    };
    gradients(problem, &at, &[function], By::Everything).map(|mut found| found.gradients.remove(0))
}

/// Solutions of load cases.
pub struct Solutions<'a> {
    /// The structure.
    pub structure: &'a Structure<f64>,
    /// The loads of each case.
    pub cases: &'a [Vec<Load<f64>>],
    /// The solution of each case; empty if no function needs it.
    pub solutions: &'a [Vec<f64>],
    /// The terms of the strain that were taken.
    pub terms: Terms,
}

/// Gradients of functions, in order, and the work that they took.
pub struct Gradients {
    pub gradients: Vec<Gradient>,
    pub work: Work,
}

/// What adjoint solutions took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Factorisations.
    pub factorisations: usize,
    /// Solutions with the factors.
    pub solves: usize,
}

/// The gradients of functions, with one adjoint solution for each load case that a function depends on. With
/// von Karman's strains the tangent of each case is factorised again, once for all functions.
///
/// # Errors
/// [`StaticFailure`] if a state is not stable, or if functions or loads name no set of the mesh.
pub fn gradients(
    problem: &mut StaticProblem,
    at: &Solutions,
    functions: &[&Function],
    by: By,
) -> Result<Gradients, StaticFailure> {
    let mut work = Work::default();
    let mut all = Vec::with_capacity(functions.len());
    let mut seeds = Vec::with_capacity(functions.len());
    for function in functions {
        let (partial, rights) = partial_gradient(problem, at, function, by)?;
        all.push(partial);
        seeds.push(rights);
    }
    for (case, x) in at.solutions.iter().enumerate() {
        if seeds.iter().all(|seeds| seeds[case].is_none()) {
            continue;
        }
        if at.terms.von_karman {
            work.factorisations += 1;
            problem
                .factorise_at(at.structure, x)
                .map_err(|failure| mechanism(&problem.assembly, at.structure, &failure))?;
        }
        let by_thickness = match by {
            By::Everything => None,
            By::Thickness => Some(forces_by_thickness(problem, at.structure, x, at.terms)),
        };
        for (gradient, seeds) in all.iter_mut().zip(&mut seeds) {
            let Some(seed) = seeds[case].take() else {
                continue;
            };
            work.solves += 1;
            let point = AdjointPoint {
                x,
                adjoint: problem.solve_factorised(&seed.right),
                psi: seed.psi,
            };
            if let Some(forces) = &by_thickness {
                let by = product_by_thickness(problem, at, case, &point, forces)?;
                let pairs = gradient.structure.thickness.iter_mut().zip(by);
                pairs.for_each(|(sum, part)| *sum += part);
                continue;
            }
            let (by_structure, by_loads) = adjoint_product(problem, at, case, &point)?;
            gradient.structure.add(&by_structure);
            for (sum, part) in gradient.cases[case].iter_mut().zip(by_loads) {
                add_load(sum, &part);
            }
        }
    }
    Ok(Gradients {
        gradients: all,
        work,
    })
}

/// The right-hand side ∂J/∂x of an adjoint solution, and the virtual motion of a reaction.
struct Seed {
    right: Vec<f64>,
    psi: Option<NodalMotion<f64>>,
}

/// The partial derivatives ∂J/∂p of a function, and a seed for each case that it depends on.
fn partial_gradient(
    problem: &StaticProblem,
    at: &Solutions,
    function: &Function,
    by: By,
) -> Result<(Gradient, Vec<Option<Seed>>), UnknownSet> {
    let solved = Solved {
        problem,
        structure: at.structure,
        cases: at.cases,
        solutions: at.solutions,
        terms: at.terms,
    };
    let configuration = solved.configuration();
    let Partial {
        motions,
        mut to,
        cases,
        virtual_motions,
    } = solved.partial(&configuration, function)?;
    let mut seeds = Vec::with_capacity(cases.len());
    for ((motion, x), psi) in motions.iter().zip(at.solutions).zip(virtual_motions) {
        // A case that no function needs has no solution.
        if x.is_empty() {
            seeds.push(None);
            continue;
        }
        let mut right = vec![0.0; x.len()];
        configuration.add_spread_transpose(x, motion, &mut right, &mut to.directors);
        if let Some(psi) = &psi {
            let (v, assembly) = (configuration.spread(x), &problem.assembly);
            let product = stiffness_times(at.structure, assembly, &v, psi, at.terms);
            // The part through directors is in the adjoint product.
            let mut unused = to.directors.clone();
            configuration.add_spread_transpose(x, &product, &mut right, &mut unused);
        }
        let depends = psi.is_some() || right.iter().any(|&r| r != 0.0);
        seeds.push(depends.then_some(Seed { right, psi }));
    }
    let structure = match by {
        By::Everything => configuration.finish(to),
        By::Thickness => to.structure,
    };
    Ok((Gradient { structure, cases }, seeds))
}

/// ∂F/∂h of each shell, h its thickness, at its nodes.
fn forces_by_thickness(
    problem: &StaticProblem,
    structure: &Structure<f64>,
    x: &[f64],
    terms: Terms,
) -> Vec<Motion<f64>> {
    let mut lifted = structure.map(Dual::from);
    for thickness in &mut lifted.thickness {
        *thickness += Dual::new(0.0, 1.0);
    }
    let configuration = problem.assembly.configuration(&lifted);
    let still: Vec<Dual> = x.iter().map(|&x| Dual::from(x)).collect();
    let motion = configuration.spread(&still);
    let shells = structure.topology.mesh.shells.par_iter().enumerate();
    let one = |(index, element)| {
        let (mut force, mut unused) = (Motion::zeros(), ShellCotangent::zeros());
        let v = motion.of_element(element);
        let shell = configuration.shell(index);
        shell.add_energy_transpose(&v, terms, &mut force, &mut unused);
        let part = |nodes: &[Vec3<Dual>; NODES]| nodes.map(|v| v.map(|x| x.du));
        Motion {
            displacement: part(&force.displacement),
            rotation: part(&force.rotation),
        }
    };
    shells.map(one).collect()
}

/// A state, its adjoint, and the virtual motion of a reaction.
struct AdjointPoint<'a> {
    x: &'a [f64],
    adjoint: Vec<f64>,
    psi: Option<NodalMotion<f64>>,
}

/// ψ·∂(f − F)/∂h by the thickness of each shell, with the derivatives `forces` of the internal forces.
fn product_by_thickness(
    problem: &StaticProblem,
    solved: &Solutions,
    case: usize,
    at: &AdjointPoint,
    forces: &[Motion<f64>],
) -> Result<Vec<f64>, UnknownSet> {
    let configuration = problem.assembly.configuration(solved.structure);
    let mut motion = configuration.spread(&at.adjoint);
    if let Some(psi) = &at.psi {
        motion.add_scaled(psi, -1.0);
    }
    let shells = solved.structure.topology.mesh.shells.iter().zip(forces);
    let mut all: Vec<f64> = shells
        .map(|(element, force)| -motion.of_element(element).dot(force))
        .collect();
    // Of all loads, gravity alone depends on the thickness.
    let weights = solved.cases[case].iter();
    for load in weights.filter(|load| matches!(load, Load::Gravity { .. })) {
        let mut unused = (
            NodalMotion::zeros(solved.structure.nodes.len()),
            zero_load(load),
        );
        let mut to = configuration.cotangent();
        add_work_transpose(
            &configuration,
            load,
            &motion,
            &mut unused.0,
            &mut to,
            &mut unused.1,
        )?;
        let pairs = all.iter_mut().zip(&to.structure.thickness);
        pairs.for_each(|(sum, part)| *sum += part);
    }
    Ok(all)
}

/// ψ·∂(f − F)/∂p by structure and loads, ψ being the adjoint less the virtual motion.
fn adjoint_product(
    problem: &StaticProblem,
    solved: &Solutions,
    case: usize,
    at: &AdjointPoint,
) -> Result<(Structure<f64>, Vec<Load<f64>>), UnknownSet> {
    let (structure, case) = (solved.structure, &solved.cases[case]);
    let lifted = structure.map(Dual::from);
    let configuration = problem.assembly.configuration(&lifted);
    let state: Vec<Dual> =
        at.x.iter()
            .zip(&at.adjoint)
            .map(|(&x, &psi)| Dual::new(x, psi))
            .collect();
    let mut motion = configuration.spread(&state);
    if let Some(psi) = &at.psi {
        motion.add_scaled(&psi.map(Dual::from), Dual::new(0.0, -1.0));
    }
    // Derivatives of the energy less the work, with the opposite sign at the end.
    let mut force = NodalMotion::zeros(structure.nodes.len());
    let mut to = configuration.cotangent();
    let mut loads = Vec::with_capacity(case.len());
    for load in case {
        let lifted: Load<Dual> = load.map(Dual::from);
        let mut load_to = zero_load(&lifted);
        add_work_transpose(
            &configuration,
            &lifted,
            &motion,
            &mut force,
            &mut to,
            &mut load_to,
        )?;
        loads.push(load_to.map(|x| x.du));
    }
    let mut internal = NodalMotion::zeros(structure.nodes.len());
    let mut internal_to = configuration.cotangent();
    add_energy_transpose(
        &configuration,
        &motion,
        solved.terms,
        &mut internal,
        &mut internal_to,
    );
    let mut unused = vec![Dual::from(0.0); state.len()];
    configuration.add_spread_transpose(&state, &force, &mut unused, &mut to.directors);
    configuration.add_spread_transpose(&state, &internal, &mut unused, &mut internal_to.directors);
    let mut all = configuration.finish(to).map(|x| x.du);
    all.add(&configuration.finish(internal_to).map(|x| -x.du));
    Ok((all, loads))
}

fn add_load(sum: &mut Load<f64>, part: &Load<f64>) {
    let mut next = part.values().into_iter();
    *sum = sum.map(|x| x + next.next().unwrap_or(0.0));
}
