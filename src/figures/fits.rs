//! The fit of an optimisation, as a figure.

use crate::driver::Simulation;
use crate::driver::fit::{fitted, series_name, series_of};
use crate::functions::series::Series;
use crate::plots::FittedCurve;
use crate::problem::Problem;

/// The series of the objective at the start and at the end of a fit, beside their data; empty if the objective is no
/// misfit.
pub(super) fn curves(problem: &Problem, designs: &[(&str, &Simulation)]) -> Vec<FittedCurve> {
    let Some(misfits) = fitted(problem) else {
        return Vec::new();
    };
    let of = |simulation: &Simulation, (f, s): (usize, usize)| {
        let at = &simulation.at;
        let own: &Series<f64> = series_of(&at.scene, f).get(s)?;
        let values = own.of.sample(&at.scene.model, &at.run);
        let shown = at.run.shown().into_iter();
        let points: Vec<(f64, f64)> = shown.map(|k| (at.run.time(k), values[k])).collect();
        Some((own.clone(), points))
    };
    let Some((_, end)) = designs.last() else {
        return Vec::new();
    };
    let first = designs.first().filter(|_| designs.len() > 1);
    let one = |which: (usize, usize)| {
        let (own, curve) = of(end, which)?;
        let at = &end.at;
        let fitted = own.values(&at.scene.model, &at.run)?;
        let data = &own.data;
        let datum = |(i, y): (usize, f64)| {
            let residual = (y - data.values[i]) * data.weights[i];
            [data.times[i] + own.offset, data.values[i], residual]
        };
        let start = first.and_then(|(_, start)| of(start, which));
        Some(FittedCurve {
            name: series_name(problem, &misfits, (which.0, data)),
            unit: own.of.unit(),
            curve,
            start: start.map_or_else(Vec::new, |(_, points)| points),
            data: fitted.into_iter().enumerate().map(datum).collect(),
        })
    };
    let all = misfits
        .iter()
        .flat_map(|&(f, _)| (0..).map_while(move |s| one((f, s))));
    all.collect()
}
