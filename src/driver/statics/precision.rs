//! Error of every function against run time, from mesh to finer mesh.

use super::error::{comparable, refined};
use super::{StaticDesign, StaticsFailure};
use crate::problem::Problem;
use crate::report::{MeshRow, PrecisionOfMesh};
use crate::work_precision::clock::cpu_seconds;

/// Largest number of unknowns of the finest mesh.
const MOST_UNKNOWNS: usize = 60_000;
/// Numbers of cuts that are tried.
const CUTS: [usize; 5] = [1, 2, 3, 4, 6];

/// Values of all functions and the gradient of one on meshes with every element cut, and the time of both.
/// The finest mesh is the reference.
///
/// # Errors
/// [`StaticsFailure`] if a mesh has no solution.
pub fn measure(
    problem: &Problem,
    chosen: usize,
    runs: u32,
    seen: &mut dyn FnMut(&str),
) -> Result<PrecisionOfMesh, StaticsFailure> {
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let x = problem.start();
    let mut first: Option<StaticDesign> = None;
    let mut rows: Vec<MeshRow> = Vec::new();
    for cuts in CUTS {
        if let Some(first) = &first
            && first.unknowns() * cuts * cuts > MOST_UNKNOWNS
        {
            break;
        }
        let mut best = [f64::INFINITY; 2];
        let mut found = None;
        // The analysis of the matrix is done once, with the first run.
        let design = refined(problem, &x, cuts, &which)?;
        let statics = design.statics.clone();
        drop(design);
        for _ in 0..runs {
            let begun = cpu_seconds();
            let design = StaticDesign::of(problem, &statics, &x, Some(&which))?;
            let solved = cpu_seconds();
            let (gradients, _) = design.derivatives(problem, &[chosen])?;
            let derived = cpu_seconds();
            best[0] = best[0].min(solved - begun);
            best[1] = best[1].min(derived - solved);
            found = Some((design, gradients));
        }
        let Some((design, gradients)) = found else {
            break;
        };
        let of = first.as_ref().unwrap_or(&design);
        let values = which
            .iter()
            .map(|&f| comparable(of, &design, f).value)
            .collect();
        let row = MeshRow {
            cuts,
            elements: design.statics.mesh().elements().count(),
            unknowns: design.unknowns(),
            seconds: best[0],
            gradient_seconds: best[1],
            values,
            gradient: gradients[0].iter().map(|d| d.value).collect(),
        };
        seen(&format!(
            "{} elements, {} unknowns: {:.4} s, gradient {:.4} s\n",
            row.elements, row.unknowns, row.seconds, row.gradient_seconds
        ));
        rows.push(row);
        first.get_or_insert(design);
    }
    Ok(PrecisionOfMesh {
        name: problem.name.clone(),
        functions: problem.function_names.clone(),
        chosen,
        rows,
    })
}
