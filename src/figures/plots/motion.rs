//! Designs in motion: time lapses side by side, and flights of projectiles.

use super::axis::{Axis, range};
use super::canvas::{Anchor, BLACK, Canvas, GROUND, PALETTE};
use super::connectors::{ConnectorKind, Point};
use super::lapse::{Motion, draw_lapse, lapse_legend, stress_range};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use plotters::style::RGBColor;

/// A barrier that the projectile must clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// Horizontal coordinate \[m\].
    pub distance: f64,
    /// Vertical coordinate of its top \[m\].
    pub top: f64,
}

/// The fixed scenery, and the names of the directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenery {
    /// Height of the ground \[m\], if a projectile lands on it.
    pub ground: Option<f64>,
    /// The barrier, if there is one.
    pub barrier: Option<Barrier>,
    /// Label of the horizontal axis, such as `x (m)`.
    pub horizontal: String,
    /// Label of the vertical axis.
    pub vertical: String,
}

const WIDTH: f64 = 880.0;
const RIGHT: f64 = 16.0;
const GAP: f64 = 20.0;

/// Time lapses of all designs side by side at one scale, early instants pale and late ones full,
/// and below, if anything is thrown, the flights until they land with barrier and ground. An SVG
/// text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no outline with a finite point.
pub fn motion(designs: &[Motion], scenery: &Scenery) -> Result<String, FigureError> {
    let outlines = |design: &Motion| {
        let bodies = design.bodies.iter().flat_map(|body| &body.outlines);
        bodies.flatten().copied().collect::<Vec<Point>>()
    };
    let mut points: Vec<Point> = designs.iter().flat_map(outlines).collect();
    if !points.iter().any(|[x, y]| x.is_finite() && y.is_finite()) {
        return Err(FigureError::NothingToDraw {
            figure: "motion",
            missing: "no body has an outline",
        });
    }
    points.extend(
        designs
            .iter()
            .flat_map(|design| design.traces.iter().flatten()),
    );
    let connected = designs.iter().flat_map(|design| &design.connectors);
    points.extend(connected.flat_map(|connector| {
        // The second point of a slider is a direction.
        let count = if connector.kind == ConnectorKind::Slider {
            1
        } else {
            2
        };
        connector
            .ends
            .iter()
            .flat_map(move |ends| ends[..count].to_vec())
            .filter(|point| point.iter().all(|x| x.is_finite()))
    }));
    let flights: Vec<Option<Vec<Point>>> = designs
        .iter()
        .map(|design| design.flight.as_ref()?.path(scenery.ground?))
        .collect();

    let count = designs.len() as f64;
    let lapse = |left: f64| {
        let width = (WIDTH - left - RIGHT - (count - 1.0) * GAP) / count;
        equal_axes(
            &points,
            scenery,
            [280.0_f64.min(width), width],
            [160.0, 500.0],
        )
    };
    let flown: Vec<Point> = flights.iter().flatten().flatten().copied().collect();
    let flight = |left: f64| {
        let mut points = flown.clone();
        points.extend(
            scenery
                .barrier
                .map(|barrier| [barrier.distance, barrier.top]),
        );
        let width = WIDTH - left - RIGHT;
        equal_axes(&points, scenery, [width, width], [150.0, 320.0])
    };
    // The room for numbers depends on the axes, whose ticks hardly depend on the room.
    let guess = 60.0;
    let mut left = room_left([&lapse(guess).y]);
    if !flown.is_empty() {
        left = left.max(room_left([&flight(guess).y]));
    }

    let first = lapse(left);
    let used = count * (first.width + GAP) - GAP;
    let (full, indent) = if flown.is_empty() {
        (left + used + RIGHT, 0.0)
    } else {
        (WIDTH, (WIDTH - left - RIGHT - used) / 2.0)
    };
    let values = stress_range(designs);
    let legend = lapse_legend(designs, full - left - RIGHT, values);
    let top = 8.0 + legend.height() + 24.0;
    let mut bottom = top + first.height + BELOW;
    let below = (!flown.is_empty()).then(|| {
        let mut panel = flight(left);
        let legend = flight_legend(designs, &flights, scenery, panel.width);
        panel.left = left;
        panel.top = bottom + 10.0 + legend.height() + 4.0;
        bottom = panel.top + panel.height + BELOW;
        (panel, legend)
    });
    let mut canvas = Canvas::new(full, bottom);
    legend.draw(&mut canvas, left, 6.0);
    for (i, design) in designs.iter().enumerate() {
        let panel = Panel {
            left: left + indent + i as f64 * (first.width + GAP),
            top,
            x: first.x.clone(),
            y: first.y.clone(),
            ..first
        };
        let middle = (panel.left + panel.width / 2.0, top - 12.0);
        panel.draw(&mut canvas, true, i == 0);
        canvas.title(middle, &design.title, Anchor::Centre);
        draw_scenery(&mut canvas, &panel, scenery);
        draw_lapse(&mut canvas, &panel, design, values);
    }
    if let Some((panel, legend)) = below {
        legend.draw(&mut canvas, left, panel.top - legend.height() - 4.0);
        panel.draw(&mut canvas, true, true);
        draw_scenery(&mut canvas, &panel, scenery);
        for (i, path) in flights.iter().enumerate() {
            let points = path.iter().flatten().map(|&[x, y]| (x, y));
            for part in panel.within(points) {
                canvas.path(&part, flight_color(i), 2.0, 1.0);
            }
        }
    }
    canvas.svg()
}

/// A panel that shows all points, and the ground if it is near, with the same scale in both
/// directions. Width and height \[px\] have limits. It is as wide as possible, and narrower if it
/// would be too high. If that does not suffice, more is shown in one direction.
fn equal_axes(points: &[Point], scenery: &Scenery, widths: [f64; 2], heights: [f64; 2]) -> Panel {
    let (mut west, mut east) = range(points.iter().map(|point| point[0]));
    let (mut south, mut north) = range(points.iter().map(|point| point[1]));
    let size = (east - west).max(north - south).max(1e-9);
    if let Some(ground) = scenery.ground
        && (south - 0.35 * size..=north).contains(&ground)
    {
        south = south.min(ground);
    }
    let margin = 0.04 * size;
    (west, east) = (west - margin, east + margin);
    // The margin of a flat scene follows its height, not its length.
    let margin = margin.min(0.1 * (north - south).max(0.2 * margin));
    (south, north) = (south - margin, north + margin);
    let aspect = (north - south) / (east - west);
    let width = (heights[1] / aspect).clamp(widths[0], widths[1]);
    let height = (aspect * width).clamp(heights[0], heights[1]);
    // Free height is added above: objects rest on the ground.
    north += ((height / width) * (east - west) - (north - south)).max(0.0);
    let missing = ((north - south) * width / height - (east - west)).max(0.0);
    (west, east) = (west - missing / 2.0, east + missing / 2.0);
    Panel {
        left: 0.0,
        top: 0.0,
        width,
        height,
        x: Axis::exact(west, east, (width / 62.0) as usize, &scenery.horizontal),
        y: Axis::exact(south, north, (height / 36.0) as usize, &scenery.vertical),
    }
}

fn flight_color(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}

fn flight_legend(
    designs: &[Motion],
    flights: &[Option<Vec<Point>>],
    scenery: &Scenery,
    width: f64,
) -> Legend {
    let mut entries = Vec::new();
    for (i, (design, path)) in designs.iter().zip(flights).enumerate() {
        if let Some([distance, _]) = path.as_ref().and_then(|path| path.last()) {
            // Adding zero makes a negative zero positive.
            let distance = (distance * 10.0).round() / 10.0 + 0.0;
            let lands = format!("lands at {distance:.1} m");
            let text = match design.title.as_str() {
                "" => lands,
                title => format!("{title}: {lands}"),
            };
            entries.push((Key::Line(flight_color(i)), text));
        }
    }
    if let Some(Barrier { distance, top }) = scenery.barrier {
        let text = format!("barrier at {distance} m, top {top} m");
        entries.push((Key::Line(BLACK), text));
    }
    if scenery.ground.is_some() {
        entries.push((Key::Area(GROUND), "ground".to_owned()));
    }
    Legend::new(entries, width)
}

/// Ground and barrier, where they lie within the panel.
fn draw_scenery(canvas: &mut Canvas, panel: &Panel, scenery: &Scenery) {
    let (x, y) = (&panel.x, &panel.y);
    let mut foot = y.low;
    if let Some(ground) = scenery.ground
        && (y.low..=y.high).contains(&ground)
    {
        foot = ground;
        let earth = [
            panel.pixel(x.low, ground),
            panel.pixel(x.high, ground),
            panel.pixel(x.high, y.low),
            panel.pixel(x.low, y.low),
        ];
        canvas.area(&earth, GROUND, 0.35);
        canvas.path(&earth[..2], GROUND, 1.5, 1.0);
    }
    if let Some(barrier) = scenery.barrier {
        let wall = [(barrier.distance, foot), (barrier.distance, barrier.top)];
        for part in panel.within(wall.into_iter()) {
            canvas.path(&part, BLACK, 3.0, 1.0);
        }
    }
}
