//! Convergence of an optimisation: objective, residuals and barrier parameter.

use super::axis::{Axis, Scale};
use super::canvas::{Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use crate::report::{History, HistoryRow};
use plotters::style::RGBColor;

const WIDTH: f64 = 640.0;
/// Room between a panel and the legend of the next one \[px\].
const SPACE: f64 = 12.0;
/// Up to this many iterations each one is marked by a dot.
const DOTS: usize = 60;

struct Curve<'a> {
    name: &'a str,
    color: RGBColor,
    values: Vec<f64>,
}

/// Three panels above each other against the iteration: the objective (linear), infeasibility
/// and optimality (logarithmic), the barrier parameter (logarithmic), as an SVG text.
///
/// Zeros and values more than 24 decades below the largest lie on the floor of a logarithmic
/// axis and are marked; values that are not finite leave a gap.
///
/// # Errors
/// [`FigureError::NothingToDraw`] for a history without rows.
pub fn convergence(history: &History) -> Result<String, FigureError> {
    let Some(last) = history.rows.iter().map(|row| row.iteration).max() else {
        return Err(FigureError::NothingToDraw {
            figure: "convergence",
            missing: "the history has no iterations",
        });
    };
    let objective = match &history.objective.unit {
        Some(unit) => format!("objective [{unit}]"),
        None => "objective".to_owned(),
    };
    let curve = |name, color: usize, value: fn(&HistoryRow) -> f64| Curve {
        name,
        color: PALETTE[color],
        values: history.rows.iter().map(value).collect(),
    };
    let stack = [
        (
            vec![curve(&history.objective.name, 0, |row| row.objective)],
            Scale::Linear,
            objective.as_str(),
            150.0,
        ),
        (
            vec![
                curve("infeasibility", 1, |row| row.infeasibility),
                curve("optimality", 2, |row| row.optimality),
            ],
            Scale::Logarithmic,
            "residual",
            170.0,
        ),
        (
            vec![curve("barrier parameter", 3, |row| row.barrier)],
            Scale::Logarithmic,
            "barrier parameter",
            130.0,
        ),
    ];
    let axes: Vec<Axis> = stack
        .iter()
        .map(|(curves, scale, label, _)| {
            let values = curves.iter().flat_map(|curve| curve.values.iter().copied());
            match scale {
                Scale::Linear => Axis::linear(values, 5, label),
                Scale::Logarithmic => Axis::logarithmic(values, 6, label),
            }
        })
        .collect();
    let left = room_left(&axes);
    let width = WIDTH - left - 16.0;
    let iterations = Axis::counts(last, 10, "iteration");

    let mut top = 8.0;
    let mut panels = Vec::new();
    for ((curves, _, _, height), y) in stack.into_iter().zip(axes) {
        let legend = legend(&curves, &y, width);
        let panel = Panel {
            left,
            top: top + legend.height() + 4.0,
            width,
            height,
            x: iterations.clone(),
            y,
        };
        top = panel.top + height + SPACE;
        panels.push((panel, legend, curves));
    }
    let mut canvas = Canvas::new(WIDTH, top - SPACE + BELOW);
    let lowest = panels.len() - 1;
    for (i, (panel, legend, curves)) in panels.iter().enumerate() {
        panel.draw(&mut canvas, i == lowest, true);
        legend.draw(&mut canvas, left, panel.top - legend.height() - 4.0);
        for curve in curves {
            draw(&mut canvas, panel, curve, &history.rows);
        }
    }
    canvas.svg()
}

fn legend(curves: &[Curve], axis: &Axis, width: f64) -> Legend {
    let entry = |curve: &Curve| (Key::Line(curve.color), curve.name.to_owned());
    let mut entries: Vec<_> = curves.iter().map(entry).collect();
    let below = |curve: &&Curve| curve.values.iter().any(|&value| is_below(axis, value));
    if let Some(curve) = curves.iter().find(below) {
        let text = "zero or below the axis".to_owned();
        entries.push((Key::Below(curve.color), text));
    }
    Legend::new(entries, width)
}

fn is_below(axis: &Axis, value: f64) -> bool {
    axis.scale == Scale::Logarithmic && value < axis.low
}

fn draw(canvas: &mut Canvas, panel: &Panel, curve: &Curve, rows: &[HistoryRow]) {
    let points = || {
        let values = curve.values.iter().copied();
        rows.iter().map(|row| row.iteration as f64).zip(values)
    };
    for part in panel.within(points()) {
        canvas.path(&part, curve.color, 1.8, 1.0);
    }
    let mut free = panel.left - 10.0;
    for (x, y) in points().filter(|(_, y)| y.is_finite()) {
        if is_below(&panel.y, y) {
            let floor = panel.pixel(x, panel.y.low);
            if floor.0 >= free {
                canvas.below_mark(floor, curve.color);
                free = floor.0 + 9.0;
            }
        } else if rows.len() <= DOTS {
            canvas.disc(panel.pixel(x, y), 2.6, curve.color);
        }
    }
}
