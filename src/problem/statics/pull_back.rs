//! From derivatives by the numbers of a structure to those by the design variables.
//!
//! Thickness and sections take their numbers from the file as they are, so their derivatives go straight to
//! the variables, however many. The others are moved by few variables: the map from the design is
//! differentiated in each of those, with dual numbers.

use super::properties::{quantities, section, thickness};
use super::{StaticScene, Statics};
use crate::derived::Derived;
use crate::math::{Dual, Scalar};
use crate::schema::Document;
use crate::structures::loads::Load;
use crate::structures::structure::Structure;

/// Derivatives by the design variables, and the sums of the sizes of their terms.
#[derive(Clone, Debug, PartialEq)]
pub struct PulledBack {
    pub values: Vec<f64>,
    pub terms: Vec<f64>,
}

impl PulledBack {
    fn add(&mut self, variable: usize, term: f64) {
        self.values[variable] += term;
        self.terms[variable] += term.abs();
    }
}

/// Derivatives in some variables: of the numbers except thickness and sections, and of numbers that expressions
/// give.
pub struct Moved(Vec<(usize, [Vec<f64>; 2])>);

impl Moved {
    /// Whether thickness and sections are all that a design moves.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// All numbers except thickness and sections, in one order.
fn others<S: Scalar>(structure: &Structure<S>, cases: &[Vec<Load<S>>]) -> Vec<S> {
    let mut all: Vec<S> = structure.nodes.iter().flatten_xyz().collect();
    all.extend(structure.surface_mass.iter().copied());
    all.extend(structure.orientations.iter().flatten_xyz());
    all.extend(structure.offsets.iter().flatten().copied());
    all.extend(structure.line_mass.iter().copied());
    for mass in &structure.masses {
        all.push(mass.mass);
        all.extend(mass.inertia);
    }
    for m in &structure.materials {
        all.extend([m.young, m.poisson, m.density, m.yield_stress]);
    }
    for load in cases.iter().flatten() {
        all.extend(load.values());
    }
    all
}

trait FlattenXyz<S> {
    fn flatten_xyz(self) -> impl Iterator<Item = S>;
}

impl<'a, S: Scalar, I: Iterator<Item = &'a crate::math::Vec3<S>>> FlattenXyz<S> for I {
    fn flatten_xyz(self) -> impl Iterator<Item = S> {
        self.flat_map(|v| [v.x, v.y, v.z])
    }
}

impl Statics {
    /// Derivatives of the numbers except thickness and sections in the variables `which`.
    pub fn moved(
        &self,
        document: &Document,
        x: &[f64],
        derived: &Derived,
        which: &[usize],
    ) -> Moved {
        let one = |&i: &usize| {
            let seeded = x.iter().enumerate();
            let seeded = seeded.map(|(j, &x)| Dual::new(x, f64::from(u8::from(i == j))));
            let seeded: Vec<Dual> = seeded.collect();
            let StaticScene { structure, cases } = self.scene(document, &derived.extend(&seeded));
            let all = others(&structure, &cases);
            let numbers = all.into_iter().map(|number| number.du).collect();
            (i, [numbers, derived.by_variable(x, i)])
        };
        Moved(which.iter().map(one).collect())
    }

    /// Derivatives by the design variables, from those by the structure and the loads.
    pub fn pull_back(
        &self,
        document: &Document,
        (variables, derived): (usize, usize),
        moved: &Moved,
        gradient: (&Structure<f64>, &[Vec<Load<f64>>]),
    ) -> PulledBack {
        // Thickness and sections may be numbers that expressions give, which stand behind the variables.
        let mut all = PulledBack {
            values: vec![0.0; variables + derived],
            terms: vec![0.0; variables + derived],
        };
        for (&(s, slot), &by) in self.shells.iter().zip(&gradient.0.thickness) {
            if let Some(variable) = thickness(&document.structures[s], slot).variable {
                all.add(variable, by);
            }
        }
        for (&(s, slot), by) in self.beams.iter().zip(&gradient.0.sections) {
            let Some(section) = section(&document.structures[s], slot) else {
                continue;
            };
            let mut numbers = Vec::new();
            by.map(&mut |x| numbers.push(x));
            for (quantity, by) in quantities(section).iter().zip(numbers) {
                if let Some(variable) = quantity.variable {
                    all.add(variable, by);
                }
            }
        }
        let by = others(gradient.0, gradient.1);
        let by_derived = all.values.split_off(variables);
        all.terms.truncate(variables);
        for (variable, [numbers, derived]) in &moved.0 {
            for (a, b) in by.iter().zip(numbers).chain(by_derived.iter().zip(derived)) {
                all.add(*variable, a * b);
            }
        }
        all
    }
}
