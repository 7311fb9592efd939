//! Fields of structures for files.

use super::figures::{OfCase, of_case, yield_stresses};
use crate::driver::statics::StaticDesign;
use crate::math::Vec3;
use crate::shell_fields::{UNKNOWN, name_of_stress, name_of_thickness};
use crate::structures::shell::STRESS_POINTS;
use crate::vtu::{Fields, vtu};
use std::f64::consts::PI;

/// Fields of a design: displacements of each load case, modes, thickness, stresses.
pub fn fields(design: &StaticDesign) -> String {
    let structure = &design.scene.structure;
    let mesh = &structure.topology.mesh;
    let list = |all: &[Vec3<f64>]| all.iter().map(|v| (*v).into()).collect::<Vec<[f64; 3]>>();
    let mut fields = Fields {
        nodes: list(&structure.nodes),
        shells: mesh.shells.clone(),
        beams: mesh.beams.clone(),
        ..Fields::default()
    };
    let mut thickness = structure.thickness.clone();
    thickness.resize(mesh.shells.len() + mesh.beams.len(), 0.0);
    let name = name_of_thickness(mesh.beams.is_empty());
    fields.of_elements.push((name.to_owned(), thickness));
    for (case, name) in design.statics.cases.iter().enumerate() {
        if design.solutions[case].is_empty() {
            continue;
        }
        let Some(OfCase {
            motion,
            stress,
            along,
        }) = of_case(design, case)
        else {
            continue;
        };
        let displacement = list(&motion.displacement);
        fields
            .vectors
            .push((format!("displacement, {name} [m]"), displacement));
        let rotation = list(&motion.rotation);
        fields
            .vectors
            .push((format!("rotation, {name} [rad]"), rotation));
        let largest = largest_of_shells(design, &stress);
        let of = format!(", {name}");
        let name = name_of_stress(mesh.shells.is_empty(), &along, &of);
        fields
            .of_elements
            .push((name, largest.into_iter().chain(along).collect()));
    }
    if let Some(found) = design.some_modes() {
        for (k, x) in found.vectors.iter().enumerate() {
            let f = found.eigenvalues[k].sqrt() / (2.0 * PI);
            if let Some(motion) = design.motion_of_mode(x) {
                fields
                    .vectors
                    .push((format!("mode {}, {f:.6} Hz", k + 1), list(&motion)));
            }
        }
    }
    vtu(&fields)
}

/// The largest von Mises stress of each shell, and the largest stress along the outer fibres of each beam,
/// NaN where its section has no size \[Pa\]; `None` if the case is not solved.
pub fn stresses(design: &StaticDesign, case: usize) -> Option<[Vec<f64>; 2]> {
    let found = of_case(design, case)?;
    let known = |stress: f64| if stress == UNKNOWN { f64::NAN } else { stress };
    let along = found.along.into_iter().map(known).collect();
    Some([largest_of_shells(design, &found.stress), along])
}

fn largest_of_shells(design: &StaticDesign, ratios: &[[f64; STRESS_POINTS]]) -> Vec<f64> {
    let pairs = ratios.iter().zip(yield_stresses(design));
    pairs
        .map(|(all, y)| y * all.iter().copied().fold(0.0, f64::max))
        .collect()
}
