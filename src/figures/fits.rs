//! The fit of an optimisation, as a figure.

use crate::driver::Simulation;
use crate::driver::fit::fitted;
use crate::functions::Function;
use crate::functions::series::Series;
use crate::plots::FittedCurve;
use crate::problem::Problem;

/// The series of the objective at the start and at the end of a fit, beside their data; empty if the objective is no
/// misfit.
pub(super) fn curves(problem: &Problem, designs: &[(&str, &Simulation)]) -> Vec<FittedCurve> {
    let Some(f) = fitted(problem) else {
        return Vec::new();
    };
    let of = |simulation: &Simulation, s: usize| -> Option<(Series<f64>, Vec<(f64, f64)>)> {
        let at = &simulation.at;
        let Function::Misfit { series } = at.scene.functions.get(f)? else {
            return None;
        };
        let own = series.get(s)?;
        let values = own.of.sample(&at.scene.model, &at.run);
        let shown = at.run.shown().into_iter();
        let points = shown.map(|k| (at.run.time(k), values[k])).collect();
        Some((own.clone(), points))
    };
    let Some((_, end)) = designs.last() else {
        return Vec::new();
    };
    let first = designs.first().filter(|_| designs.len() > 1);
    let one = |s: usize| {
        let (own, curve) = of(end, s)?;
        let at = &end.at;
        let fitted = own.values(&at.scene.model, &at.run)?;
        let data = &own.data;
        let datum = |(i, y): (usize, f64)| {
            let residual = (y - data.values[i]) * data.weights[i];
            [data.times[i] + own.offset, data.values[i], residual]
        };
        let start = first.and_then(|(_, start)| of(start, s));
        Some(FittedCurve {
            name: data.name.clone(),
            unit: own.of.unit(),
            curve,
            start: start.map_or_else(Vec::new, |(_, points)| points),
            data: fitted.into_iter().enumerate().map(datum).collect(),
        })
    };
    (0..).map_while(one).collect()
}
