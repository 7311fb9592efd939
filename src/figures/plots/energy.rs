//! Energies of simulations against time, and the drift of their sum.

use super::axis::Axis;
use super::canvas::{Anchor, BLACK, Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use plotters::style::RGBColor;

/// Energies of one simulation, one entry an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyRun {
    /// What was simulated, such as `initial design`; may be empty for a single run.
    pub title: String,
    /// Instants \[s\].
    pub time: Vec<f64>,
    /// Kinetic energy \[J\].
    pub kinetic: Vec<f64>,
    /// Potential energy \[J\].
    pub potential: Vec<f64>,
    /// Times of events, drawn as lines from below to above \[s\].
    pub marks: Vec<f64>,
}

/// Kinetic, potential and total energy against time and, below, the drift of the total from its
/// start on a separate axis. The runs are side by side with the same axes. An SVG text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no run, or if a run has no instants or not one
/// energy of each kind for every instant.
pub fn energy(runs: &[EnergyRun]) -> Result<String, FigureError> {
    let nothing = |missing| FigureError::NothingToDraw {
        figure: "energy",
        missing,
    };
    if runs.is_empty() {
        return Err(nothing("there is no simulation"));
    }
    let complete = |run: &EnergyRun| {
        let count = run.time.len();
        count > 0 && run.kinetic.len() == count && run.potential.len() == count
    };
    if !runs.iter().all(complete) {
        return Err(nothing("a simulation has not one energy for each instant"));
    }
    let total = |run: &EnergyRun| -> Vec<f64> {
        let pairs = run.kinetic.iter().zip(&run.potential);
        pairs
            .map(|(kinetic, potential)| kinetic + potential)
            .collect()
    };
    let totals: Vec<Vec<f64>> = runs.iter().map(total).collect();
    let drifts: Vec<Vec<f64>> = totals
        .iter()
        .map(|total| total.iter().map(|energy| energy - total[0]).collect())
        .collect();

    let all = runs
        .iter()
        .zip(&totals)
        .flat_map(|(run, total)| run.kinetic.iter().chain(&run.potential).chain(total));
    let upper = Axis::linear(all.copied(), 5, "energy [J]");
    let lower = drift_axis(&drifts);
    let left = room_left([&upper, &lower]);
    let width = if runs.len() == 1 { 540.0 } else { 360.0 };
    let gap = 26.0;
    let column = |i: usize| left + i as f64 * (width + gap);
    let full = column(runs.len()) - gap + 18.0;

    let legend = Legend::new(
        ["kinetic", "potential", "total"]
            .into_iter()
            .zip(STYLES)
            .map(|(name, (color, dashed))| match dashed {
                true => (Key::Dashes(color), name.to_owned()),
                false => (Key::Line(color), name.to_owned()),
            })
            .collect(),
        full - left,
    );
    let titled = runs.iter().any(|run| !run.title.is_empty());
    let title = if titled { 24.0 } else { 6.0 };
    let top = 6.0 + legend.height() + title;
    let (tall, low) = (250.0, 120.0);
    let second = top + tall + 22.0;
    let mut canvas = Canvas::new(full, second + low + BELOW);
    legend.draw(&mut canvas, left, 6.0);
    for (i, run) in runs.iter().enumerate() {
        let time = time_axis(runs, width);
        let energies = Panel {
            left: column(i),
            top,
            width,
            height: tall,
            x: time.clone(),
            y: upper.clone(),
        };
        let drift = Panel {
            top: second,
            height: low,
            left: column(i),
            width,
            x: time,
            y: lower.clone(),
        };
        energies.draw(&mut canvas, false, i == 0);
        drift.draw(&mut canvas, true, i == 0);
        let middle = (column(i) + width / 2.0, top - 12.0);
        canvas.title(middle, &run.title, Anchor::Centre);
        energies.mark(&mut canvas, &run.marks);
        drift.mark(&mut canvas, &run.marks);
        let curves = [&run.kinetic, &run.potential, &totals[i]];
        for (values, (color, dashed)) in curves.into_iter().zip(STYLES) {
            draw(&mut canvas, &energies, &run.time, values, color, dashed);
        }
        draw(&mut canvas, &drift, &run.time, &drifts[i], BLACK, false);
    }
    canvas.svg()
}

/// Colour of the kinetic, potential and total energy, and whether its line is dashed.
const STYLES: [(RGBColor, bool); 3] = [(PALETTE[1], false), (PALETTE[0], false), (BLACK, true)];

fn time_axis(runs: &[EnergyRun], width: f64) -> Axis {
    let instants = runs.iter().flat_map(|run| run.time.iter().copied());
    let (first, last) = super::axis::range(instants);
    let last = if last > first { last } else { first + 1.0 };
    Axis::exact(first, last, (width / 70.0) as usize, "time [s]")
}

/// The axis of the drift; one around zero if the energies are conserved to the last bit.
fn drift_axis(drifts: &[Vec<f64>]) -> Axis {
    let label = "total − start [J]";
    if drifts.iter().flatten().all(|&drift| drift == 0.0) {
        Axis::exact(-1e-12, 1e-12, 4, label)
    } else {
        Axis::linear(drifts.iter().flatten().copied(), 5, label)
    }
}

fn draw(
    canvas: &mut Canvas,
    panel: &Panel,
    time: &[f64],
    values: &[f64],
    color: RGBColor,
    dashed: bool,
) {
    let points = time.iter().copied().zip(values.iter().copied());
    for part in panel.within(points) {
        if dashed {
            canvas.dashes(&part, color, 1.8);
        } else {
            canvas.path(&part, color, 1.8, 1.0);
        }
    }
}
