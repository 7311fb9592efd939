//! Fits beside their data, and the residuals below: a column for each series.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;

/// A fitted series.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedCurve {
    /// Its name.
    pub name: String,
    /// Unit of its values; may be empty.
    pub unit: String,
    /// The fitted quantity: time \[s\] and value.
    pub curve: Vec<(f64, f64)>,
    /// The quantity at the start of the fit; may be empty.
    pub start: Vec<(f64, f64)>,
    /// Data: time of the motion \[s\], value, and residual in standard deviations.
    pub data: Vec<[f64; 3]>,
}

/// Size of the panels and gaps \[px\].
const WIDTH: f64 = 380.0;
const HEIGHT: f64 = 230.0;
const RESIDUALS: f64 = 110.0;
const GAP: f64 = 26.0;
const BETWEEN: f64 = 18.0;

/// Radius of a datum \[px\], and of each of many.
const DATUM: f64 = 2.6;
const MANY: usize = 200;
const SMALL: f64 = 1.5;

/// The fits of all series. An SVG text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no datum.
pub fn fit(series: &[FittedCurve]) -> Result<String, FigureError> {
    if series.iter().all(|own| own.data.is_empty()) {
        return Err(FigureError::NothingToDraw {
            figure: "fit",
            missing: "there are no data",
        });
    }
    let columns: Vec<[Axis; 3]> = series.iter().map(axes).collect();
    let left = |axes: &[Axis; 3]| room_left(&axes[1..]);
    let mut places = Vec::new();
    let mut right = 0.0;
    for axes in &columns {
        places.push(right + left(axes));
        right += left(axes) + WIDTH + GAP;
    }
    let full = right - GAP + 18.0;
    let legend = Legend::new(
        vec![
            (Key::Disc(PALETTE[1]), "data".into()),
            (Key::Line(PALETTE[0]), "fit".into()),
            (Key::Dashes(PALETTE[2]), "start".into()),
        ],
        full - places[0] - 18.0,
    );
    let top = 6.0 + legend.height() + 24.0;
    let below = top + HEIGHT + BETWEEN;
    let mut canvas = Canvas::new(full, below + RESIDUALS + BELOW);
    legend.draw(&mut canvas, places[0], 6.0);
    for ((own, [x, y, r]), left) in series.iter().zip(columns).zip(places) {
        let panel = |top: f64, height: f64, y: Axis| Panel {
            left,
            top,
            width: WIDTH,
            height,
            x: x.clone(),
            y,
        };
        let (upper, lower) = (panel(top, HEIGHT, y), panel(below, RESIDUALS, r));
        upper.draw(&mut canvas, false, true);
        lower.draw(&mut canvas, true, true);
        canvas.title((left + WIDTH / 2.0, top - 12.0), &own.name, Anchor::Centre);
        for part in upper.within(own.start.iter().copied()) {
            canvas.dashes(&part, PALETTE[2], 1.4);
        }
        let radius = if own.data.len() > MANY { SMALL } else { DATUM };
        for &[time, value, residual] in &own.data {
            canvas.disc(upper.pixel(time, value), radius, PALETTE[1]);
            canvas.disc(lower.pixel(time, residual), radius, PALETTE[1]);
        }
        for part in upper.within(own.curve.iter().copied()) {
            canvas.path(&part, PALETTE[0], 1.8, 1.0);
        }
        let zero = [x.low, x.high].into_iter().map(|time| (time, 0.0));
        for part in lower.within(zero) {
            canvas.path(&part, PALETTE[0], 1.2, 1.0);
        }
    }
    canvas.svg()
}

/// Axes of time, values and residuals.
fn axes(own: &FittedCurve) -> [Axis; 3] {
    let curves = own.curve.iter().chain(&own.start);
    let times = curves.clone().map(|point| point.0);
    let times = times.chain(own.data.iter().map(|datum| datum[0]));
    let (from, to) = super::axis::range(times);
    let to = if to > from { to } else { from + 1.0 };
    let label = match own.unit.as_str() {
        "" | "1" => own.name.clone(),
        unit => format!("{} [{unit}]", own.name),
    };
    let values = curves.map(|point| point.1);
    let values = values.chain(own.data.iter().map(|datum| datum[1]));
    let residuals = own.data.iter().map(|datum| datum[2]);
    [
        Axis::exact(from, to, 6, "time [s]"),
        Axis::linear(values, 6, &label),
        Axis::linear(residuals.chain([0.0]), 4, "residual"),
    ]
}
