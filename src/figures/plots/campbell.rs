//! Campbell diagram: frequencies of a machine that turns against its speed.

use super::axis::Axis;
use super::canvas::{BLACK, Canvas, PALETTE};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use std::f64::consts::PI;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 320.0;

/// The sense of a mode in a Campbell diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Forward whirl, by its frequency in the fixed frame.
    Forward,
    /// Backward whirl, by its frequency in the fixed frame.
    Backward,
    /// No whirl, by the frequency that the turning frame sees.
    None,
}

impl Sense {
    const ALL: [Self; 3] = [Self::Forward, Self::Backward, Self::None];

    fn label(self) -> &'static str {
        match self {
            Self::Forward => "forward whirl",
            Self::Backward => "backward whirl",
            Self::None => "no whirl (turning frame)",
        }
    }
}

/// A mode in a Campbell diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CampbellPoint {
    /// Speed of rotation Ω \[rad/s\].
    pub speed: f64,
    /// Frequency \[Hz\].
    pub frequency: f64,
    /// Its sense.
    pub sense: Sense,
}

/// The modes of all designs over speed, side by side, with the frequency Ω / 2π of the rotation, which crosses forward whirl
/// at critical speeds. An SVG text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no finite point.
pub fn campbell(designs: &[(String, Vec<CampbellPoint>)]) -> Result<String, FigureError> {
    let all = || designs.iter().flat_map(|(_, points)| points);
    let finite = |point: &&CampbellPoint| point.speed.is_finite() && point.frequency.is_finite();
    if !all().any(|point| finite(&point)) {
        return Err(FigureError::NothingToDraw {
            figure: "Campbell diagram",
            missing: "no speed has a mode",
        });
    }
    let frequencies = || all().filter(finite).map(|point| point.frequency);
    let speeds = || all().filter(finite).map(|point| point.speed);
    let axes = || {
        let y = Axis::linear(frequencies().chain([0.0]), 8, "frequency [Hz]");
        (Axis::linear(speeds().chain([0.0]), 8, "speed [rad/s]"), y)
    };
    let left = room_left([&axes().1]);
    let count = designs.len() as f64;
    let gap = 26.0;
    let full = if designs.len() == 1 { WIDTH } else { 880.0 };
    let width = (full - left - 16.0 - (count - 1.0) * gap) / count;
    let mut entries: Vec<(Key, String)> = (Sense::ALL.iter().enumerate())
        .filter(|(_, sense)| all().any(|point| point.sense == **sense))
        .map(|(k, sense)| (Key::Disc(PALETTE[k]), sense.label().to_owned()))
        .collect();
    entries.push((Key::Dashes(BLACK), "frequency of the rotation".to_owned()));
    let legend = Legend::new(entries, full - left - 16.0);
    let titled = designs.iter().any(|(title, _)| !title.is_empty());
    let top = 8.0 + legend.height() + if titled { 24.0 } else { 4.0 };
    let mut canvas = Canvas::new(full, top + HEIGHT + BELOW);
    legend.draw(&mut canvas, left, 8.0);
    for (i, (title, points)) in designs.iter().enumerate() {
        let (x, y) = axes();
        let (last, highest) = (x.high, y.high);
        let panel = Panel {
            left: left + i as f64 * (width + gap),
            top,
            width,
            height: HEIGHT,
            x,
            y,
        };
        panel.draw(&mut canvas, true, i == 0);
        if titled {
            let middle = (panel.left + width / 2.0, top - 12.0);
            canvas.text(middle, title, super::canvas::Anchor::Centre);
        }
        let end = last.min(2.0 * PI * highest);
        let line = [panel.pixel(0.0, 0.0), panel.pixel(end, end / (2.0 * PI))];
        canvas.dashes(&line, BLACK, 1.2);
        for point in points.iter().filter(finite) {
            let k = Sense::ALL.iter().position(|own| *own == point.sense);
            let color = PALETTE[k.unwrap_or(0)];
            canvas.disc(panel.pixel(point.speed, point.frequency), 2.6, color);
        }
    }
    canvas.svg()
}
