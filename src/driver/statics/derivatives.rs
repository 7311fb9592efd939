//! Exact derivatives of functions of structures in the design variables.

use super::{StaticDesign, StaticsFailure, of_cases, of_modes, with_measured};
use crate::composed;
use crate::evaluate::Derivative;
use crate::integrate::WorkCounts;
use crate::problem::{Asked, MeasuredFunction, Problem};
use crate::structures::functions::Function;
use crate::structures::gradient::{By, Gradient, Solutions, gradients};
use crate::structures::loads::Load;
use crate::structures::modes::{ModalFailure, frequency_gradient};
use std::collections::BTreeMap;

/// Functions whose gradients are kept by all numbers of a structure at a time: 64 of 1800 shells take 20 MB.
const AT_ONCE: usize = 64;

impl StaticDesign {
    /// The derivatives of a function of modes by structure and loads.
    fn by_structure(&self, f: usize) -> Result<Gradient, StaticsFailure> {
        let mut workspace = self.shared();
        let (statics, structure) = (&self.statics, &self.scene.structure);
        let by_structure = match &statics.functions[f] {
            Asked::Misfit { .. } | Asked::DistanceFromStart | Asked::OfSolutions(_) => {
                unreachable!("they are no functions of modes")
            }
            Asked::LowestFrequency(_) => {
                let found = self.lowest[f].as_ref().expect("it was found before");
                found.gradient.clone()
            }
            Asked::Frequency { .. } => {
                let found = self.modes.as_ref().expect("modes were found before");
                let modal = of_modes(&mut workspace, statics, structure)?;
                frequency_gradient(modal, structure, found, self.mode_of(f))?
            }
        };
        Ok(Gradient {
            structure: by_structure,
            cases: self.scene.cases.iter().map(|case| zeros(case)).collect(),
        })
    }

    /// The derivatives of functions of solutions by structure and loads, in order.
    fn by_solutions(
        &self,
        functions: &[&Function],
        by: By,
        counts: &mut WorkCounts,
    ) -> Result<Vec<Gradient>, StaticsFailure> {
        let mut workspace = self.shared();
        let matrices = of_cases(&mut workspace, &self.statics, &self.scene.structure)?;
        let at = Solutions {
            structure: &self.scene.structure,
            cases: &self.scene.cases,
            solutions: &self.solutions,
            terms: self.statics.terms,
        };
        let found = gradients(matrices, &at, functions, by).map_err(ModalFailure::from)?;
        counts.solves += found.work.solves;
        counts.factorisations += found.work.factorisations;
        Ok(found.gradients)
    }

    /// Derivatives of the mean square of residuals r = w (g − d), with those of the functions g.
    fn by_numbers<'a>(
        &self,
        numbers: &[MeasuredFunction],
        of: impl Fn(usize) -> &'a Vec<Derivative>,
    ) -> Vec<Derivative> {
        let mut all = vec![Derivative::default(); self.x.len()];
        for own in numbers {
            let by = 2.0 * own.weight / numbers.len() as f64;
            let (r, size) = (self.residual(own), (own.value * own.weight).abs());
            for (sum, d) in all.iter_mut().zip(of(own.function)) {
                sum.value += by * r * d.value;
                // The last digits of r are those of the value.
                sum.terms += by * (r.abs() * d.terms + size * d.value.abs());
            }
        }
        all
    }

    /// Exact derivatives of the functions `which` in the design variables, and the work they took.
    ///
    /// # Errors
    /// [`StaticsFailure`] if a function has no derivative there.
    pub fn derivatives(
        &self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(Vec<Vec<Derivative>>, WorkCounts), StaticsFailure> {
        let moved = problem.moved(&self.statics, &self.x);
        let by = match moved.is_empty() && self.scene.structure.sections.is_empty() {
            true => By::Thickness,
            false => By::Everything,
        };
        let mut counts = WorkCounts::default();
        let asked = self.composition.of_scene(which);
        let distinct = with_measured(&self.statics, &asked);
        let pulled_back = |by: &Gradient| -> Vec<Derivative> {
            let found = problem.pull_back(&self.statics, &moved, (&by.structure, &by.cases));
            let pairs = found.values.into_iter().zip(found.terms);
            pairs
                .map(|(value, terms)| Derivative { value, terms })
                .collect()
        };
        let mut all: BTreeMap<usize, Vec<Derivative>> = BTreeMap::new();
        let mut of_solutions = Vec::new();
        for &f in &distinct {
            match &self.statics.functions[f] {
                Asked::DistanceFromStart => {
                    all.insert(f, distance_derivatives(problem, &self.x));
                }
                Asked::OfSolutions(function) => of_solutions.push((f, function)),
                Asked::Misfit { .. } => {}
                Asked::Frequency { .. } | Asked::LowestFrequency(_) => {
                    all.insert(f, pulled_back(&self.by_structure(f)?));
                }
            }
        }
        for some in of_solutions.chunks(AT_ONCE) {
            let functions: Vec<&Function> = some.iter().map(|(_, function)| *function).collect();
            let found = self.by_solutions(&functions, by, &mut counts)?;
            let pairs = some.iter().zip(&found);
            all.extend(pairs.map(|(&(f, _), by)| (f, pulled_back(by))));
        }
        for &f in &distinct {
            if let Asked::Misfit { numbers, .. } = &self.statics.functions[f] {
                let found = self.by_numbers(numbers, |g| &all[&g]);
                all.insert(f, found);
            }
        }
        let one = |&f: &usize| match self.composition.gives(f) {
            true => composed::derivatives(&self.partials(f), &|g| &all[&g][..]),
            false => all[&f].clone(),
        };
        Ok((which.iter().map(one).collect(), counts))
    }
}

fn zeros(case: &[Load<f64>]) -> Vec<Load<f64>> {
    case.iter().map(|load| load.map(|_| 0.0)).collect()
}

/// Derivatives of Σ ((x − x0)/scale)².
fn distance_derivatives(problem: &Problem, x: &[f64]) -> Vec<Derivative> {
    let one = |i: usize| {
        let seeded = x.iter().enumerate();
        let seeded = seeded.map(|(j, &x)| crate::math::Dual::new(x, f64::from(u8::from(i == j))));
        let value = problem.distance_from_start(&seeded.collect::<Vec<_>>()).du;
        Derivative {
            value,
            terms: value.abs(),
        }
    };
    (0..x.len()).map(one).collect()
}
