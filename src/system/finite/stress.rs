//! Von Mises stresses of a body of finite elements.

use super::element::{gather, lift, motion, motion_transpose, scatter};
use crate::math::Scalar;
use crate::model::finite::{FiniteElements, NODES, POINTS};
use crate::structures::material::Material;
use crate::structures::shell::{Field, STRESS_POINTS, Shell, ShellCotangent, Terms};

fn field<S: Scalar>(points: &[crate::math::Vec3<S>; POINTS]) -> Field<S> {
    Field {
        points: std::array::from_fn(|a| points[a]),
        directors: std::array::from_fn(|a| points[NODES + a]),
    }
}

fn shell<S: Scalar>(finite: &FiniteElements<S>, i: usize) -> Shell<S> {
    let element = &finite.mesh.elements[i];
    Shell {
        geometry: field(&element.points.map(|p| lift(&p))),
        thickness: finite.thickness[i],
        material: Material {
            young: finite.young[i],
            poisson: S::from(element.poisson),
            density: finite.density[i],
            yield_stress: S::from(element.yield_stress),
        },
        surface_mass: finite.surface_mass[i],
        drilling: false,
    }
}

/// Von Mises stress by yield stress at all points of some elements.
pub(crate) fn stress_ratios<S: Scalar>(
    finite: &FiniteElements<S>,
    q: &[S],
    elements: &[usize],
) -> Vec<S> {
    let of = |&i: &usize| {
        let element = &finite.mesh.elements[i];
        let moved = field(&motion(element, &gather(element, q)));
        shell(finite, i).field_stress_ratios(&moved, Terms::VON_KARMAN)
    };
    elements.iter().flat_map(of).collect()
}

/// Transpose of the derivative of [`stress_ratios`].
pub(crate) fn pull_stress_ratios(
    finite: &FiniteElements<f64>,
    (q, elements): (&[f64], &[usize]),
    bar: &[f64],
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    for (&i, bar) in elements.iter().zip(bar.as_chunks::<STRESS_POINTS>().0) {
        let element = &finite.mesh.elements[i];
        let moved = field(&motion(element, &gather(element, q)));
        let (mut by, mut to) = (Field::zeros(), ShellCotangent::zeros());
        let own = shell(finite, i);
        own.add_field_stress_ratios_transpose(&moved, Terms::VON_KARMAN, bar, &mut by, &mut to);
        cot.thickness[i] += to.thickness;
        cot.young[i] += to.material.young;
        let mut points = [crate::math::Vec3::zeros(); POINTS];
        points[..NODES].copy_from_slice(&by.points);
        points[NODES..].copy_from_slice(&by.directors);
        scatter(element, &motion_transpose(element, &points), by_q);
    }
}
