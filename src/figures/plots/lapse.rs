//! Bodies in a picture of the motion: outlines and coloured parts at the instants of a time lapse, paths, release.

use super::axis::range;
use super::canvas::{BLACK, Canvas, INK, MORE, PALETTE};
use super::colours::colour;
use super::connectors::{self, Connector, Point};
use super::panel::{Key, Legend, Panel};
use crate::report::number::significant;
use plotters::style::RGBColor;

/// A body at the instants of a time lapse.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMotion {
    /// Name of the body.
    pub name: String,
    /// Its outline at each instant, early to late: a polygon, or a line of two points.
    pub outlines: Vec<Vec<Point>>,
    /// Coloured patches of a body that deforms, at each instant; else empty.
    pub patches: Vec<Vec<Patch>>,
    /// How near it is to the viewer at each instant; empty if all bodies are drawn in their order.
    pub depths: Vec<f64>,
}

/// A polygon, or a line of two points, with the colour of a value, a stress \[Pa\].
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Its corners.
    pub corners: Vec<Point>,
    /// The value.
    pub value: f64,
}

/// A projectile at the instant of its release; from here it falls freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Place of the release \[m\].
    pub position: Point,
    /// Velocity at the release \[m/s\].
    pub velocity: Point,
    /// Gravity, downwards positive \[m/s²\].
    pub gravity: f64,
}

/// What the outlines of a body show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lapse {
    /// Instants of a motion.
    Time,
    /// Rest, and a mode of vibration.
    Mode,
}

/// One design in motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// What it is, such as `optimal design`.
    pub title: String,
    /// What the outlines of its bodies show.
    pub lapse: Lapse,
    /// Bodies in the order of the problem file; the same for all designs.
    pub bodies: Vec<BodyMotion>,
    /// Joints, rods, springs and arms.
    pub connectors: Vec<Connector>,
    /// Paths of the points of interest (until the release, if there is one); may be empty.
    pub traces: Vec<Vec<Point>>,
    /// Release of the projectile, if there is one.
    pub flight: Option<Flight>,
    /// What the colours of its patches mean, if it has some.
    pub coloured: Option<Coloured>,
}

/// What colours of patches mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Coloured {
    /// The largest stress of the whole run \[Pa\], which the scale covers.
    pub largest: f64,
    /// The kinds of stress.
    pub notes: Vec<String>,
}

/// The least end of a scale of stress \[Pa\]: below it are the round-off of stiff bodies that nothing loads.
const LEAST_STRESS: f64 = 1e-3;

/// Points of a drawn flight.
const FLIGHT_POINTS: usize = 200;

impl Flight {
    /// The path until the projectile reaches the ground. `None` if it starts below it or gravity
    /// does not point down.
    ///
    /// r(t) = r₀ + v₀ t − ½ g t² e_y for t from 0 to (v_y + √(v_y² + 2 g (y − y_g))) / g.
    pub fn path(&self, ground: f64) -> Option<Vec<Point>> {
        let ([x, y], [vx, vy], g) = (self.position, self.velocity, self.gravity);
        let landing = (vy + (vy * vy + 2.0 * g * (y - ground)).sqrt()) / g;
        if !(g > 0.0 && y >= ground && landing.is_finite()) {
            return None;
        }
        let at = |i: usize| {
            let t = landing * i as f64 / FLIGHT_POINTS as f64;
            [x + vx * t, y + vy * t - 0.5 * g * t * t]
        };
        Some((0..=FLIGHT_POINTS).map(at).collect())
    }
}

fn body_color(index: usize) -> RGBColor {
    let index = index % (PALETTE.len() + MORE.len());
    let more = || MORE[index - PALETTE.len()];
    PALETTE.get(index).copied().unwrap_or_else(more)
}

/// The lowest value of all patches and the largest of all runs, if there are any.
pub(super) fn stress_range(designs: &[Motion]) -> Option<[f64; 2]> {
    let bodies = designs.iter().flat_map(|design| &design.bodies);
    let patches = bodies.flat_map(|body| body.patches.iter().flatten());
    let mut values = patches.map(|patch| patch.value).peekable();
    values.peek()?;
    let coloured = designs.iter().filter_map(|design| design.coloured.as_ref());
    let (low, high) = range(values.chain(coloured.map(|own| own.largest)));
    Some(match high < LEAST_STRESS {
        true => [0.0, LEAST_STRESS],
        false => [low, high],
    })
}

pub(super) fn lapse_legend(designs: &[Motion], width: f64, values: Option<[f64; 2]>) -> Legend {
    let mut entries = Vec::new();
    for (i, body) in designs[0].bodies.iter().enumerate() {
        if body.patches.is_empty() {
            entries.push((Key::Area(body_color(i)), body.name.clone()));
        }
    }
    if let Some(values) = values {
        let coloured = designs[0].bodies.iter();
        let coloured = coloured.filter(|body| !body.patches.is_empty());
        let names: Vec<&str> = coloured.map(|body| body.name.as_str()).collect();
        let [low, high] = values.map(|value| significant(value, 3));
        let text = format!("{}: stress from {low} to {high} Pa", names.join(", "));
        entries.push((Key::Scale, text));
        let notes = designs[0].coloured.iter().flat_map(|own| &own.notes);
        entries.extend(notes.map(|note| (Key::Note, format!("({note})"))));
    }
    entries.extend(connectors::legend(&designs[0].connectors));
    let long = |design: &Motion| design.traces.iter().any(|trace| trace.len() > 1);
    if designs.iter().any(long) {
        entries.push((Key::Line(INK), "path".to_owned()));
    }
    if designs.iter().any(|design| design.flight.is_some()) {
        entries.push((Key::Disc(BLACK), "release".to_owned()));
    }
    let moves = designs[0].bodies.iter().any(|body| body.outlines.len() > 1);
    if moves {
        let note = match designs[0].lapse {
            Lapse::Time => "(pale: early, full: late)",
            Lapse::Mode => "(pale: at rest, full: deflected)",
        };
        entries.push((Key::Note, note.to_owned()));
    }
    Legend::new(entries, width)
}

/// Draws a design: its bodies early to late, its paths and its release.
pub(super) fn draw_lapse(
    canvas: &mut Canvas,
    panel: &Panel,
    design: &Motion,
    values: Option<[f64; 2]>,
) {
    let frames = design.bodies.iter().map(|body| body.outlines.len()).max();
    let frames = frames.unwrap_or(0);
    for frame in 0..frames {
        let late = (frame + 1) as f64 / frames as f64;
        // What is far is drawn first.
        let depth = |body: &BodyMotion| body.depths.get(frame).copied().unwrap_or(0.0);
        let mut order: Vec<(usize, &BodyMotion)> = design.bodies.iter().enumerate().collect();
        order.sort_by(|a, b| depth(a.1).total_cmp(&depth(b.1)));
        for (i, body) in order {
            let Some(outline) = body.outlines.get(frame) else {
                continue;
            };
            let finite = outline.iter().all(|[x, y]| x.is_finite() && y.is_finite());
            if !finite {
                continue;
            }
            let place = |&[x, y]: &Point| panel.pixel(x, y);
            let mut pixels: Vec<_> = outline.iter().map(place).collect();
            if let (Some(patches), Some(values)) = (body.patches.get(frame), values) {
                let lines = patches.iter().all(|patch| patch.corners.len() == 2);
                pixels.extend(pixels.first().copied());
                let border = |canvas: &mut Canvas| {
                    canvas.path(&pixels, INK, 0.5, 0.2 + 0.5 * late);
                };
                if lines {
                    border(canvas);
                }
                for patch in patches {
                    let corners: Vec<_> = patch.corners.iter().map(place).collect();
                    let (own, alpha) = (colour(patch.value, values), 0.2 + 0.8 * late);
                    match corners.len() {
                        2 => canvas.path(&corners, own, 3.0, alpha),
                        _ => canvas.area(&corners, own, alpha),
                    }
                }
                if !lines {
                    border(canvas);
                }
                continue;
            }
            if pixels.len() > 2 {
                canvas.area(&pixels, body_color(i), 0.06 + 0.44 * late * late);
                pixels.extend(pixels.first().copied());
            }
            canvas.path(&pixels, body_color(i), 1.2, 0.25 + 0.75 * late);
        }
        for connector in &design.connectors {
            connectors::draw(canvas, panel, connector, (frame, late), body_color);
        }
    }
    for trace in &design.traces {
        for part in panel.within(trace.iter().map(|&[x, y]| (x, y))) {
            canvas.path(&part, INK, 1.2, 1.0);
        }
    }
    if let Some(flight) = &design.flight {
        let [x, y] = flight.position;
        for point in panel.within([(x, y)].into_iter()) {
            canvas.disc(point[0], 4.0, BLACK);
        }
    }
}
