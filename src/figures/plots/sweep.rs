//! The optimal objective against a parameter.

use super::axis::Axis;
use super::canvas::{Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use crate::report::sweep::{Sweep, SweptOptimum};

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 280.0;

/// The objective of every run against the parameter, as an SVG text. A line joins the optima; runs
/// that did not converge are dots of another colour. Values that are not finite are left out.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if no value is finite.
pub fn sweep(found: &Sweep) -> Result<String, FigureError> {
    let of = |converged: bool| -> Vec<(f64, f64)> {
        let point = |at: &SweptOptimum| (at.value, at.objective);
        let all = found.optima.iter().filter(|at| at.converged == converged);
        all.map(point).filter(|at| at.1.is_finite()).collect()
    };
    let (optima, others) = (of(true), of(false));
    let all = || optima.iter().chain(&others);
    if all().next().is_none() {
        return Err(FigureError::NothingToDraw {
            figure: "sweep",
            missing: "no run has an objective",
        });
    }
    let label = match &found.objective.unit {
        Some(unit) => format!("{} [{unit}]", found.objective.name),
        None => found.objective.name.clone(),
    };
    let y = Axis::linear(all().map(|at| at.1), 6, &label);
    let x = Axis::linear(all().map(|at| at.0), 8, &found.parameter);
    let left = room_left([&y]);
    let width = WIDTH - left - 16.0;
    let mut entries = vec![(Key::Line(PALETTE[0]), "optimum".to_owned())];
    if !others.is_empty() {
        entries.push((Key::Line(PALETTE[1]), "not converged".to_owned()));
    }
    let legend = Legend::new(entries, width);
    let panel = Panel {
        left,
        top: 8.0 + legend.height() + 4.0,
        width,
        height: HEIGHT,
        x,
        y,
    };
    let mut canvas = Canvas::new(WIDTH, panel.top + HEIGHT + BELOW);
    panel.draw(&mut canvas, true, true);
    legend.draw(&mut canvas, left, 8.0);
    for part in panel.within(optima.iter().copied()) {
        canvas.path(&part, PALETTE[0], 1.8, 1.0);
    }
    for (points, color) in [(&optima, 0), (&others, 1)] {
        for &(x, y) in points {
            canvas.disc(panel.pixel(x, y), 2.6, PALETTE[color]);
        }
    }
    canvas.svg()
}
