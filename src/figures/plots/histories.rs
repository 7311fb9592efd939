//! Quantities against time: one curve each, rows of panels with one axis each, designs side by side.

use super::axis::Axis;
use super::canvas::{Anchor, BLACK, Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use crate::report::number::significant;
use plotters::style::RGBColor;

/// Quantities of one design, one value an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// What was simulated, such as `initial design`; may be empty for a single run.
    pub title: String,
    /// Instants \[s\].
    pub time: Vec<f64>,
    /// Name and values of each quantity; the same names for all designs.
    pub curves: Vec<(String, Vec<f64>)>,
    /// Limits on them.
    pub limits: Vec<Limit>,
    /// Times of events, drawn as lines from below to above \[s\].
    pub marks: Vec<f64>,
}

/// A limit, drawn as a line across the panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Its value.
    pub value: f64,
    /// The unit of the value.
    pub unit: &'static str,
    /// Whose limit it is.
    pub of: Vec<String>,
}

/// A row of panels: the label of its axis, and the designs.
pub type Row<'a> = (&'a str, Vec<History>);

/// Gap between panels, side by side and one below the other \[px\].
const GAP: f64 = 26.0;
const BETWEEN: f64 = 18.0;

/// The curves of all designs. All rows have the same designs and curves. An SVG text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no curve, or if a curve has not one value for each instant.
pub fn histories(rows: &[Row]) -> Result<String, FigureError> {
    let nothing = |missing| FigureError::NothingToDraw {
        figure: "history",
        missing,
    };
    let designs = rows.first().map_or(&[][..], |(_, designs)| designs);
    let Some(first) = designs.first().filter(|design| !design.curves.is_empty()) else {
        return Err(nothing("there is no curve"));
    };
    let complete = |design: &History| {
        let count = design.time.len();
        count > 0
            && design
                .curves
                .iter()
                .all(|(_, values)| values.len() == count)
    };
    if !rows.iter().flat_map(|(_, designs)| designs).all(complete) {
        return Err(nothing("a curve has not one value for each instant"));
    }
    let height = if rows.len() == 1 { 260.0 } else { 150.0 };
    let axes: Vec<Axis> = rows.iter().map(axis).collect();
    let instants = designs
        .iter()
        .flat_map(|design| design.time.iter().copied());
    let (from, to) = super::axis::range(instants);
    let to = if to > from { to } else { from + 1.0 };
    let width = if designs.len() == 1 { 540.0 } else { 360.0 };
    let x = Axis::exact(from, to, (width / 70.0) as usize, "time [s]");
    let left = room_left(&axes);
    let column = |i: usize| left + i as f64 * (width + GAP);
    let full = column(designs.len()) - GAP + 18.0;
    let legend = Legend::new(entries(first, rows.len()), full - left - 18.0);
    let titled = designs.iter().any(|design| !design.title.is_empty());
    let top = 6.0 + legend.height() + if titled { 24.0 } else { 6.0 };
    let below = rows.len() as f64 * (height + BETWEEN) - BETWEEN;
    let mut canvas = Canvas::new(full, top + below + BELOW);
    legend.draw(&mut canvas, left, 6.0);
    for (j, ((_, designs), y)) in rows.iter().zip(&axes).enumerate() {
        for (i, design) in designs.iter().enumerate() {
            let panel = Panel {
                left: column(i),
                top: top + j as f64 * (height + BETWEEN),
                width,
                height,
                x: x.clone(),
                y: y.clone(),
            };
            panel.draw(&mut canvas, j + 1 == rows.len(), i == 0);
            if j == 0 {
                let middle = (column(i) + width / 2.0, top - 12.0);
                canvas.title(middle, &design.title, Anchor::Centre);
            }
            draw(&mut canvas, &panel, design);
        }
    }
    canvas.svg()
}

/// The axis of a row, over all curves and limits of its designs.
fn axis((label, designs): &Row) -> Axis {
    let values = designs.iter().flat_map(|design| {
        let limits = design.limits.iter().map(|limit| limit.value);
        let curves = design.curves.iter().flat_map(|(_, values)| values);
        curves.copied().chain(limits)
    });
    Axis::linear(values, 6, label)
}

/// Colour and pattern of a curve.
fn look(curve: usize) -> (RGBColor, usize) {
    (PALETTE[curve % PALETTE.len()], curve / PALETTE.len())
}

/// Colour and pattern of a limit.
fn look_of_limit(limit: usize) -> (RGBColor, usize) {
    (BLACK, limit + 1)
}

/// The keys of the curves and limits. The limits of several rows have their values at their axes.
fn entries(design: &History, rows: usize) -> Vec<(Key, String)> {
    let key = |(color, pattern): (RGBColor, usize)| Key::Pattern(color, pattern);
    let curves = design.curves.iter().enumerate();
    let mut all: Vec<(Key, String)> = curves
        .map(|(k, (name, _))| (key(look(k)), name.clone()))
        .collect();
    if rows > 1 && !design.limits.is_empty() {
        all.push((key(look_of_limit(0)), "limits".to_owned()));
        return all;
    }
    for (k, limit) in design.limits.iter().enumerate() {
        let value = significant(limit.value, 4);
        let text = match limit.unit {
            "" => format!("limit of {value}"),
            unit => format!("limit of {value} {unit}:"),
        };
        all.push((key(look_of_limit(k)), text));
        all.extend(limit.of.iter().map(|of| (Key::Note, of.clone())));
    }
    all
}

fn draw(canvas: &mut Canvas, panel: &Panel, design: &History) {
    panel.mark(canvas, &design.marks);
    let ends = [panel.x.low, panel.x.high];
    for (k, limit) in design.limits.iter().enumerate() {
        let (color, pattern) = look_of_limit(k);
        for part in panel.within(ends.into_iter().map(|x| (x, limit.value))) {
            canvas.pattern(&part, color, 1.4, pattern);
        }
    }
    for (k, (_, values)) in design.curves.iter().enumerate() {
        let points = design.time.iter().copied().zip(values.iter().copied());
        let (color, pattern) = look(k);
        for part in panel.within(points) {
            canvas.pattern(&part, color, 1.8, pattern);
        }
    }
}
