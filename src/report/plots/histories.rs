//! Quantities against time: one curve each, designs side by side with the same axes.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::report::ReportError;

/// Quantities of one design, one value an instant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History {
    /// What was simulated, such as `initial design`; may be empty for a single run.
    pub title: String,
    /// Instants \[s\].
    pub time: Vec<f64>,
    /// Name and values of each quantity; the same names for all designs.
    pub curves: Vec<(String, Vec<f64>)>,
}

/// The curves of all designs. An SVG text.
///
/// # Errors
/// [`ReportError::NothingToDraw`] if there is no curve, or if a curve has not one value for each instant.
pub(crate) fn histories(designs: &[History], label: &str) -> Result<String, ReportError> {
    let nothing = |missing| ReportError::NothingToDraw {
        figure: "history",
        missing,
    };
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
    if !designs.iter().all(complete) {
        return Err(nothing("a curve has not one value for each instant"));
    }
    let all = designs.iter().flat_map(|design| &design.curves);
    let y = Axis::linear(all.flat_map(|(_, values)| values).copied(), 6, label);
    let instants = designs
        .iter()
        .flat_map(|design| design.time.iter().copied());
    let (from, to) = super::axis::range(instants);
    let to = if to > from { to } else { from + 1.0 };
    let width = if designs.len() == 1 { 540.0 } else { 360.0 };
    let x = Axis::exact(from, to, (width / 70.0) as usize, "time [s]");
    let (left, gap, height) = (room_left([&y]), 26.0, 260.0);
    let column = |i: usize| left + i as f64 * (width + gap);
    let full = column(designs.len()) - gap + 18.0;
    let names = first.curves.iter().enumerate();
    let names = names.map(|(i, (name, _))| (Key::Line(PALETTE[i % PALETTE.len()]), name.clone()));
    let legend = Legend::new(names.collect(), full - left);
    let titled = designs.iter().any(|design| !design.title.is_empty());
    let top = 6.0 + legend.height() + if titled { 24.0 } else { 6.0 };
    let mut canvas = Canvas::new(full, top + height + BELOW);
    legend.draw(&mut canvas, left, 6.0);
    for (i, design) in designs.iter().enumerate() {
        let panel = Panel {
            left: column(i),
            top,
            width,
            height,
            x: x.clone(),
            y: y.clone(),
        };
        panel.draw(&mut canvas, true, i == 0);
        let middle = (column(i) + width / 2.0, top - 12.0);
        canvas.title(middle, &design.title, Anchor::Centre);
        for (k, (_, values)) in design.curves.iter().enumerate() {
            let points = design.time.iter().copied().zip(values.iter().copied());
            for part in panel.within(points) {
                canvas.path(&part, PALETTE[k % PALETTE.len()], 1.8, 1.0);
            }
        }
    }
    canvas.svg()
}
