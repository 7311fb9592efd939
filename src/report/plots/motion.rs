//! Designs in motion: time lapses side by side, and flights of projectiles.

use super::axis::{Axis, range};
use super::canvas::{Anchor, BLACK, Canvas, GROUND, INK, PALETTE};
use super::colours::colour;
use super::connectors::{self, Connector, ConnectorKind, Point};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::report::ReportError;
use crate::report::number::significant;
use plotters::style::RGBColor;

/// A body at the instants of a time lapse.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyMotion {
    /// Name of the body.
    pub name: String,
    /// Its outline at each instant, early to late: a polygon, or a line of two points.
    pub outlines: Vec<Vec<Point>>,
    /// Coloured patches of a body that deforms, at each instant; else empty.
    pub patches: Vec<Vec<Patch>>,
    /// How near it is to the viewer at each instant; empty if all bodies are drawn in their order.
    pub depths: Vec<f64>,
}

/// A polygon with the colour of a value, a stress \[Pa\].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Its corners.
    pub corners: Vec<Point>,
    /// The value.
    pub value: f64,
}

/// A projectile at the instant of its release; from here it falls freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flight {
    /// Place of the release \[m\].
    pub position: Point,
    /// Velocity at the release \[m/s\].
    pub velocity: Point,
    /// Gravity, downwards positive \[m/s²\].
    pub gravity: f64,
}

/// One design in motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    /// What it is, such as `optimal design`.
    pub title: String,
    /// Bodies in the order of the problem file; the same for all designs.
    pub bodies: Vec<BodyMotion>,
    /// Joints, rods, springs and arms.
    pub connectors: Vec<Connector>,
    /// Paths of the points of interest (until the release, if there is one); may be empty.
    pub traces: Vec<Vec<Point>>,
    /// Release of the projectile, if there is one.
    pub flight: Option<Flight>,
}

/// A barrier that the projectile must clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Barrier {
    /// Horizontal coordinate \[m\].
    pub distance: f64,
    /// Vertical coordinate of its top \[m\].
    pub top: f64,
}

/// The fixed scenery, and the names of the directions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scenery {
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
/// Points of a drawn flight.
const FLIGHT_POINTS: usize = 200;

impl Flight {
    /// The path until the projectile reaches the ground. `None` if it starts below it or gravity
    /// does not point down.
    ///
    /// r(t) = r₀ + v₀ t − ½ g t² e_y for t from 0 to (v_y + √(v_y² + 2 g (y − y_g))) / g.
    pub(crate) fn path(&self, ground: f64) -> Option<Vec<Point>> {
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

/// Time lapses of all designs side by side at one scale, early instants pale and late ones full,
/// and below, if anything is thrown, the flights until they land with barrier and ground. An SVG
/// text.
///
/// # Errors
/// [`ReportError::NothingToDraw`] if there is no outline with a finite point.
pub(crate) fn motion(designs: &[Motion], scenery: &Scenery) -> Result<String, ReportError> {
    let outlines = |design: &Motion| {
        let bodies = design.bodies.iter().flat_map(|body| &body.outlines);
        bodies.flatten().copied().collect::<Vec<Point>>()
    };
    let mut points: Vec<Point> = designs.iter().flat_map(outlines).collect();
    if !points.iter().any(|[x, y]| x.is_finite() && y.is_finite()) {
        return Err(ReportError::NothingToDraw {
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

fn body_color(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}

fn flight_color(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}

/// The lowest and highest value of all patches, if there are any.
fn stress_range(designs: &[Motion]) -> Option<[f64; 2]> {
    let bodies = designs.iter().flat_map(|design| &design.bodies);
    let patches = bodies.flat_map(|body| body.patches.iter().flatten());
    let mut values = patches.map(|patch| patch.value).peekable();
    values.peek()?;
    let (low, high) = range(values);
    Some([low, high])
}

fn lapse_legend(designs: &[Motion], width: f64, values: Option<[f64; 2]>) -> Legend {
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
        entries.push((Key::Note, "(pale: early, full: late)".to_owned()));
    }
    Legend::new(entries, width)
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

fn draw_lapse(canvas: &mut Canvas, panel: &Panel, design: &Motion, values: Option<[f64; 2]>) {
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
                for patch in patches {
                    let corners: Vec<_> = patch.corners.iter().map(place).collect();
                    let own = colour(patch.value, values);
                    canvas.area(&corners, own, 0.2 + 0.8 * late);
                }
                pixels.extend(pixels.first().copied());
                canvas.path(&pixels, INK, 0.5, 0.2 + 0.5 * late);
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
