//! Where the strains of structures are no longer accurate.

use super::StaticDesign;
use crate::structures::statics::StaticProblem;
use crate::structures::turned::{LARGE_ERROR, Turned, turned};

impl StaticDesign {
    /// A warning of the load case whose large rotations spoil its displacements most, if they spoil them much.
    pub fn large_rotation(&self) -> Option<String> {
        let all = self.with_solved(|solved| {
            let of = |(case, x): (usize, &Vec<f64>)| -> Option<(f64, Turned, usize)> {
                if x.is_empty() {
                    return None;
                }
                let (problem, structure): (&StaticProblem, _) = (solved.problem, solved.structure);
                let load = problem.load_vector(structure, &solved.cases[case]).ok()?;
                let found = turned(problem, structure, (x, &load), solved.terms);
                Some((found.error(&found), found, case))
            };
            let all = solved.solutions.iter().enumerate().filter_map(of);
            all.max_by(|a, b| a.0.total_cmp(&b.0))
        });
        let (error, found, case) = all.flatten()?;
        (error > LARGE_ERROR).then(|| {
            let (angle, element) = found.most;
            let shells = self.statics.mesh().shells.len();
            let element = match element.checked_sub(shells) {
                Some(beam) => format!("beam {beam}"),
                None => format!("shell {element}"),
            };
            format!(
                "load case \"{}\": {element} turns by {angle:.2} rad, and displacements err by about {:.1} %, since strains \
                 hold for small rotations: divide the structure into bodies that move (\"start\": \"equilibrium\"), each of \
                 which turns less in its own axes",
                self.statics.cases[case],
                100.0 * error
            )
        })
    }
}
