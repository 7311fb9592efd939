//! The discretisation error of functions of structures, by cutting every element into four (a beam into two).
//!
//! With values f_h on the mesh of the file and f_{h/2} on the finer one, of order m,
//!
//! ```text
//! f_h − f ≈ (f_h − f_{h/2}) 2ᵐ / (2ᵐ − 1)
//! ```
//!
//! m = 1 for stresses, whose Gauss points come nearer to the edges with the size of the elements,
//! and m = 2 for all else. Both are the smallest observed orders, at clamped edges, so an estimate
//! is rather large. A KS function over more points is larger by ln(points) / ρ; this is no error
//! and is subtracted.

use super::{StaticDesign, StaticValue, StaticsFailure};
use crate::estimate::{Estimate, FunctionError, with_expressions};
use crate::problem::{Asked, Problem, available_memory};
use crate::report::size;
use crate::structures::functions::{Aggregate, Function};
use crate::structures::loads::Load;
use std::collections::HashSet;
use std::sync::Arc;

/// Estimates the errors of the functions `which` at a solved design, and of their gradients if `gradients`.
///
/// # Errors
/// [`StaticsFailure`] if the finer mesh has no solution.
pub fn estimate(
    problem: &Problem,
    at: &StaticDesign,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, StaticsFailure> {
    with_expressions((problem, &at.x), which, |which| {
        of_structures(problem, at, which, gradients)
    })
}

/// Those of functions of the structures.
fn of_structures(
    problem: &Problem,
    at: &StaticDesign,
    which: &[usize],
    gradients: bool,
) -> Result<Vec<FunctionError>, StaticsFailure> {
    let mesh = (at.statics.mesh().shells.len(), at.factor_entries());
    admit((mesh.0, mesh.1.unwrap_or(0)), available_memory())?;
    let fine = refined(problem, &at.x, 2 * at.statics.cuts, which)?;
    let slopes = |of: &StaticDesign| -> Result<Vec<Vec<f64>>, StaticsFailure> {
        if !gradients || problem.variables.is_empty() {
            return Ok(vec![Vec::new(); which.len()]);
        }
        let (found, _) = of.derivatives(problem, which)?;
        let values = found.into_iter();
        Ok(values
            .map(|row| row.into_iter().map(|d| d.value).collect())
            .collect())
    };
    let (coarse_slopes, fine_slopes) = (slopes(at)?, slopes(&fine)?);
    let mut all = Vec::with_capacity(which.len());
    for (k, &f) in which.iter().enumerate() {
        let gain = gain(&at.statics.functions[f]);
        let estimate = |h: f64, finer: f64| {
            let of_mesh = (h - finer) * gain;
            Estimate {
                value: h,
                error: of_mesh.abs(),
                of_steps: of_mesh,
                of_samples: 0.0,
            }
        };
        let (coarse, finer) = (at.function(f), comparable(at, &fine, f));
        let maximum = coarse.peak.zip(finer.peak);
        let pairs = coarse_slopes[k].iter().zip(&fine_slopes[k]);
        all.push(FunctionError {
            function: f,
            value: estimate(coarse.value, finer.value),
            maximum: maximum.map(|(coarse, fine)| estimate(coarse.ratio, fine.ratio)),
            gradient: pairs.map(|(&h, &finer)| estimate(h, finer)).collect(),
        });
    }
    Ok(all)
}

/// Memory of a solution with every element cut into four, by an entry of the factor of the present mesh
/// \[bytes\]. The factor gets five times as many entries; assembly and ordering take as much again. Measured:
/// 84 and 87 bytes with 5000 and 20,000 elements.
const BY_ENTRY: usize = 100;

/// Rejects an estimate that needs more memory than available \[bytes\], if that is known; by the shells of the mesh and the
/// entries of its factor.
///
/// # Errors
/// [`StaticsFailure::Memory`].
fn admit(
    (elements, entries): (usize, usize),
    available: Option<usize>,
) -> Result<(), StaticsFailure> {
    let needed = entries.saturating_mul(BY_ENTRY);
    match available {
        Some(available) if needed > available => Err(StaticsFailure::Memory {
            elements: 4 * elements,
            needed: size(needed),
            available: size(available),
        }),
        _ => Ok(()),
    }
}

/// Functions whose estimate is unreliable: a force or moment at a point of a shell makes
/// displacements there grow with the logarithm of the mesh (Naghdi's shells have no finite limit),
/// and stresses with its inverse.
pub fn doubts(problem: &Problem, at: &StaticDesign, which: &[usize]) -> Option<String> {
    let mesh = at.statics.mesh();
    let of_shells: HashSet<usize> = mesh.shells.iter().flatten().copied().collect();
    let at_point = |load: &Load<f64>| match load {
        Load::Point { nodes, .. } => {
            let set = mesh.node_set(nodes).unwrap_or(&[]);
            set.len() == 1 && of_shells.contains(&set[0])
        }
        _ => false,
    };
    let singular: Vec<bool> = (at.scene.cases.iter())
        .map(|case| case.iter().any(at_point))
        .collect();
    let doubtful = |&&f: &&usize| {
        let needed = at
            .composition
            .of_scene(std::slice::from_ref(&f))
            .into_owned();
        let functions = needed.into_iter().map(|g| &at.statics.functions[g]);
        let mut cases = functions.flat_map(super::cases_of);
        cases.any(|&case| singular[case])
    };
    let names: Vec<String> = (which.iter().filter(doubtful))
        .map(|&f| format!("\"{}\"", problem.function_names[f]))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "the estimated errors of {} are not reliable: a load at one node of a shell has no limit as the \
             mesh is refined",
            names.join(", ")
        )
    })
}

/// The design on a mesh with every element cut.
///
/// # Errors
/// [`StaticsFailure`] if that mesh has no solution.
pub fn refined(
    problem: &Problem,
    x: &[f64],
    cuts: usize,
    which: &[usize],
) -> Result<StaticDesign, StaticsFailure> {
    let mut cut = problem.cut_statics(cuts).map_err(|found| {
        let first = found.into_iter().next();
        StaticsFailure::Mesh(first.expect("a fault was found").1)
    })?;
    if problem
        .statics
        .as_ref()
        .is_some_and(|own| own.functions.len() > cut.functions.len())
    {
        cut.functions.push(Asked::DistanceFromStart);
    }
    StaticDesign::of(problem, &Arc::new(cut), x, Some(which))
}

/// The value on a finer mesh as it would be with as many Gauss points as on the coarse one.
pub fn comparable(coarse: &StaticDesign, fine: &StaticDesign, f: usize) -> StaticValue {
    let mut value = fine.function(f);
    if fine.composition.gives(f) {
        let of = |g: usize| comparable(coarse, fine, g).value;
        value.value = fine.composition.value(f, &fine.x, &of);
        return value;
    }
    if let Asked::OfSolutions(Function::Stress {
        faces,
        rho,
        aggregate: Aggregate::Ks,
        ..
    }) = &fine.statics.functions[f]
    {
        let count = |of: &StaticDesign| of.statics.mesh().face_set(faces).map_or(1, <[usize]>::len);
        value.value -= (count(fine) as f64 / count(coarse) as f64).ln() / rho;
    }
    value
}

/// 2ᵐ / (2ᵐ − 1).
fn gain(function: &Asked) -> f64 {
    match function {
        Asked::OfSolutions(Function::Stress { .. }) => 2.0,
        Asked::OfSolutions(_)
        | Asked::Frequency { .. }
        | Asked::LowestFrequency(_)
        | Asked::Misfit { .. }
        | Asked::DistanceFromStart => 4.0 / 3.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An estimate cuts every shell into four. Where that needs more memory than there is, it is refused, with numbers
    /// that say how much is missing.
    #[test]
    fn an_estimate_beyond_memory_is_refused() {
        let (mesh, needed) = ((12, 2000), 2000 * BY_ENTRY);
        assert_eq!(admit(mesh, None), Ok(()));
        assert_eq!(admit(mesh, Some(needed)), Ok(()));
        let refused = admit(mesh, Some(needed - 1)).expect_err("too little");
        let told = refused.to_string();
        assert!(
            told.starts_with("a mesh of 48 elements needs about"),
            "{told}"
        );
    }
}
