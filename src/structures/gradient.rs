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
//! derivatives of work and energy at x + ε ψ.

use super::assembly::add_energy_transpose;
use super::functions::{Function, Partial, Solved, zero_load};
use super::loads::{Load, add_work_transpose};
use super::mesh::UnknownSet;
use super::reactions::stiffness_times;
use super::shell::Terms;
use super::state::NodalMotion;
use super::statics::{StaticFailure, StaticProblem, mechanism};
use super::structure::Structure;
use crate::math::Dual;

/// Derivatives of a function: by the structure, by the loads of each case.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// By the numbers of the structure, each in its own place.
    pub structure: Structure<f64>,
    /// By the numbers of the loads, each in its own place.
    pub cases: Vec<Vec<Load<f64>>>,
}

/// The gradient of a function of a linear solution by everything, with one adjoint solve for each load
/// case that the function depends on. `problem` still has the factors of the stiffness.
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
    let one = |failure| match failure {
        StaticFailure::UnknownSet(unknown) => unknown,
        other => unreachable!("linear adjoints make no factors: {other}"),
    };
    gradient_of(
        problem,
        structure,
        cases,
        solutions,
        function,
        Terms::LINEAR,
    )
    .map_err(one)
}

/// The gradient of a function of states with von Karman's strains. The tangent of each state that the
/// function depends on is assembled and factorised again.
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
    gradient_of(
        problem,
        structure,
        cases,
        solutions,
        function,
        Terms::VON_KARMAN,
    )
}

fn gradient_of(
    problem: &mut StaticProblem,
    structure: &Structure<f64>,
    cases: &[Vec<Load<f64>>],
    solutions: &[Vec<f64>],
    function: &Function,
    terms: Terms,
) -> Result<Gradient, StaticFailure> {
    let solved = Solved {
        problem,
        structure,
        cases,
        solutions,
        terms,
    };
    let configuration = solved.configuration();
    let Partial {
        motions,
        mut to,
        cases: case_bars,
        virtual_motions,
    } = solved.partial(&configuration, function)?;
    let mut rights = Vec::with_capacity(cases.len());
    for ((motion, x), psi) in motions.iter().zip(solutions).zip(&virtual_motions) {
        // A case that no function needs has no solution.
        if x.is_empty() {
            rights.push(Vec::new());
            continue;
        }
        let mut right = vec![0.0; x.len()];
        configuration.add_spread_transpose(x, motion, &mut right, &mut to.directors);
        if let Some(psi) = psi {
            let (v, assembly) = (configuration.spread(x), &problem.assembly);
            let product = stiffness_times(structure, assembly, &v, psi, terms);
            // The part through directors is in the adjoint product.
            let mut unused = to.directors.clone();
            configuration.add_spread_transpose(x, &product, &mut right, &mut unused);
        }
        rights.push(right);
    }
    let mut all = Gradient {
        structure: configuration.finish(to),
        cases: case_bars,
    };
    for (case, right) in rights.iter().enumerate() {
        let psi = virtual_motions[case].as_ref();
        if psi.is_some() || right.iter().any(|&r| r != 0.0) {
            let x = &solutions[case];
            if terms.von_karman {
                problem
                    .factorise_at(structure, x)
                    .map_err(|failure| mechanism(&problem.assembly, structure, &failure))?;
            }
            let adjoint = problem.solve_factorised(right);
            let at = AdjointPoint { x, adjoint, psi };
            let (by_structure, by_loads) =
                adjoint_product(problem, structure, &cases[case], &at, terms)?;
            all.structure.add(&by_structure);
            for (sum, part) in all.cases[case].iter_mut().zip(by_loads) {
                add_load(sum, &part);
            }
        }
    }
    Ok(all)
}

/// A state, its adjoint, and the virtual motion of a reaction.
struct AdjointPoint<'a> {
    x: &'a [f64],
    adjoint: Vec<f64>,
    psi: Option<&'a NodalMotion<f64>>,
}

/// ψ·∂(f − F)/∂p by structure and loads, ψ being the adjoint less the virtual motion.
fn adjoint_product(
    problem: &StaticProblem,
    structure: &Structure<f64>,
    case: &[Load<f64>],
    at: &AdjointPoint,
    terms: Terms,
) -> Result<(Structure<f64>, Vec<Load<f64>>), UnknownSet> {
    let lifted = structure.map(Dual::from);
    let configuration = problem.assembly.configuration(&lifted);
    let state: Vec<Dual> =
        at.x.iter()
            .zip(&at.adjoint)
            .map(|(&x, &psi)| Dual::new(x, psi))
            .collect();
    let mut motion = configuration.spread(&state);
    if let Some(psi) = at.psi {
        motion.add_infinitesimal(psi, -1.0);
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
        terms,
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
