//! Points whose paths are drawn: where they are, and their positions against time.

use super::elastic_figures::{curves_of, elastic};
use crate::driver::Simulation;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::plots::History as Curves;
use crate::problem::{Drawing, Trace};

/// Motions below this part of the size of all motions are round-off.
const ROUND_OFF: f64 = 1e-9;

/// Where a point is, on the deformed body \[m\].
pub(super) fn place(at: &Snapshot<f64>, trace: &Trace) -> Vec3<f64> {
    let mut point = trace.point;
    if !trace.by.is_empty() {
        let q = elastic(at.model, at, trace.body);
        for (coordinate, n) in &trace.by {
            point += n * q[*coordinate];
        }
    }
    at.motion(trace.body).point(&point)
}

/// The coordinates x, y and z of the points in ground axes against time \[m\].
pub fn positions(title: &str, simulation: &Simulation, drawing: &Drawing) -> [Curves; 3] {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let mut paths: Vec<Vec<Vec3<f64>>> = vec![Vec::new(); drawing.traces.len()];
    for k in 0..=run.last() {
        let at = Snapshot::of(model, run, k);
        for (path, trace) in paths.iter_mut().zip(&drawing.traces) {
            path.push(place(&at, trace));
        }
    }
    let sizes = paths.iter().flatten().map(|point| point.amax());
    let size = sizes.fold(0.0, f64::max);
    [0, 1, 2].map(|axis| {
        let of = |(trace, path): (&Trace, &Vec<Vec3<f64>>)| {
            let values = path.iter().map(|point| point[axis]).collect();
            (trace.name.clone(), steadied(values, ROUND_OFF * size))
        };
        let curves = drawing.traces.iter().zip(&paths).map(of);
        curves_of(title, run, curves.collect())
    })
}

/// The first value throughout, if no other is farther from it than `least`; zero if it is not farther from zero.
fn steadied(mut values: Vec<f64>, least: f64) -> Vec<f64> {
    let Some(&first) = values.first() else {
        return values;
    };
    if values.iter().all(|value| (value - first).abs() <= least) {
        values.fill(if first.abs() <= least { 0.0 } else { first });
    }
    values
}
