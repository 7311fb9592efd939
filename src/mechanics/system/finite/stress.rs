//! Von Mises stresses of a body of finite elements.
//!
//! Strains of the middle surface at the Gauss points are products of the strains e_p, and curvatures are products of
//! the unknowns, so that an element with stresses keeps both matrices.

use super::each::each_over;
use super::element::{Deformed, motion, scatter};
use super::stiffness::Strained;
use crate::math::Scalar;
use crate::model::element_operators::Columns;
use crate::model::finite::{
    AT_GAUSS_POINTS, FiniteElements, NODES, POINTS, QUADRATIC, STRAINS, ShellElement,
    StressOperator, UNKNOWNS,
};
use crate::structures::material::Material;
use crate::structures::shell::{
    Field, STRESS_POINTS, curvatures, membrane_strains, pull_stress_ratios_of, stress_ratios_of,
};

fn field(points: &[crate::math::Vec3<f64>; POINTS]) -> Field<f64> {
    Field {
        points: std::array::from_fn(|a| points[a]),
        directors: std::array::from_fn(|a| points[NODES + a]),
    }
}

/// The matrices of an element, made at their first use.
fn operator(element: &ShellElement) -> &StressOperator {
    element.stress.get_or_init(|| {
        let geometry = field(&element.points);
        let unit = |l: usize| {
            let mut x = [0.0; UNKNOWNS];
            x[l] = 1.0;
            x
        };
        let of_unknown = |l: usize| {
            let moved = field(&motion(element, &unit(l)));
            curvatures((element.kind(), &geometry), &moved)
        };
        let of_strain = |p: usize| {
            let (mut tied, mut mean) = ([0.0; QUADRATIC], [0.0; STRAINS - QUADRATIC]);
            match p.checked_sub(QUADRATIC) {
                Some(c) => mean[c] = 1.0,
                None => tied[p] = 1.0,
            }
            membrane_strains((element.kind(), &geometry), &tied, &mean)
        };
        Box::new(StressOperator {
            membrane: Columns::of((0..STRAINS).map(of_strain)),
            curvature: Columns::of((0..element.moves.len()).map(of_unknown)),
        })
    })
}

/// Strains of the middle surface and curvatures at the Gauss points, with what the strains are made of.
struct Measured<'a, S> {
    operator: &'a StressOperator,
    strained: Strained<S>,
    membrane: [S; AT_GAUSS_POINTS],
    curvature: [S; AT_GAUSS_POINTS],
}

impl<'a, S: Scalar> Measured<'a, S> {
    fn of(element: &'a ShellElement, q: &[S]) -> Self {
        let (operator, x) = (operator(element), Deformed::of(element, q));
        let strained = Strained::of(element, &x);
        Self {
            membrane: operator.membrane.times(&strained.strain),
            curvature: operator.curvature.times(&x.all),
            operator,
            strained,
        }
    }
}

fn material<S: Scalar>(finite: &FiniteElements<S>, i: usize) -> Material<S> {
    let element = &finite.mesh.elements[i];
    Material {
        young: finite.young[i],
        poisson: S::from(element.poisson),
        density: finite.density[i],
        yield_stress: S::from(element.yield_stress),
    }
}

/// Von Mises stress by yield stress at all points of some elements.
pub fn stress_ratios<S: Scalar>(finite: &FiniteElements<S>, q: &[S], elements: &[usize]) -> Vec<S> {
    let mut out = Vec::with_capacity(elements.len() * STRESS_POINTS);
    let work = |k: usize| {
        let i = elements[k];
        let own = Measured::of(&finite.mesh.elements[i], q);
        let of = (&own.membrane, &own.curvature);
        stress_ratios_of(&material(finite, i), finite.thickness[i], of)
    };
    each_over(&finite.team, elements.len(), work, |k, ratios| {
        let count = finite.mesh.elements[elements[k]].kind().stress_points();
        out.extend(&ratios[..count]);
    });
    out
}

/// Transpose of the derivative of [`stress_ratios`].
pub fn pull_stress_ratios(
    finite: &FiniteElements<f64>,
    (q, elements): (&[f64], &[usize]),
    bar: &[f64],
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    let mut first = 0;
    let counts = elements.iter().map(|&i| {
        let count = finite.mesh.elements[i].kind().stress_points();
        first += count;
        first - count..first
    });
    let ranges: Vec<std::ops::Range<usize>> = counts.collect();
    let work = |k: usize| {
        let i = elements[k];
        let element = &finite.mesh.elements[i];
        let own = Measured::of(element, q);
        let of = (&own.membrane, &own.curvature);
        let mut own_bar = [0.0; STRESS_POINTS];
        let given = &bar[ranges[k].clone()];
        own_bar[..given.len()].copy_from_slice(given);
        let by = pull_stress_ratios_of(&material(finite, i), finite.thickness[i], of, &own_bar);
        let (mut by_strain, mut force) = ([0.0; STRAINS], [0.0; UNKNOWNS]);
        own.operator
            .membrane
            .add_transposed(&by.membrane, &mut by_strain);
        own.strained.add_transpose(element, &by_strain, &mut force);
        own.operator
            .curvature
            .add_transposed(&by.curvature, &mut force);
        (by.thickness, by.material.young, force)
    };
    each_over(
        &finite.team,
        elements.len(),
        work,
        |k, (thickness, young, force)| {
            let i = elements[k];
            cot.thickness[i] += thickness;
            cot.young[i] += young;
            scatter(&finite.mesh.elements[i], &force, by_q);
        },
    );
}
