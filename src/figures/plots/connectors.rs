//! Connectors of the bodies in a picture of the motion: joints, rods, springs, and arms to points
//! outside their bodies.

use super::canvas::{BLACK, Canvas, INK, Pixel};
use super::panel::{Key, Panel};
use plotters::style::RGBColor;

/// A point of the plane that is drawn: horizontal and vertical coordinate \[m\].
pub type Point = [f64; 2];

/// Kind of connector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConnectorKind {
    /// A joint that rotates, at the first of its points.
    Hinge,
    /// A joint that slides, at its first point along the line to the second.
    Slider,
    /// A rod without mass between its points.
    Rod,
    /// A spring between its points.
    Spring,
    /// The force of a contact from its place, as an arrow.
    Force,
    /// From a body's centre to a point outside its outline.
    Arm {
        /// Number of the body.
        body: usize,
    },
}

/// A connector at the instants of a time lapse.
#[derive(Clone, Debug, PartialEq)]
pub struct Connector {
    /// What it is.
    pub kind: ConnectorKind,
    /// Whether it joins a body to ground.
    pub to_ground: bool,
    /// Its two points at each instant \[m\].
    pub ends: Vec<[Point; 2]>,
}

const WHITE: RGBColor = RGBColor(255, 255, 255);
const ROD: RGBColor = RGBColor(120, 60, 20);
const SPRING: RGBColor = RGBColor(150, 0, 100);
const FORCE: RGBColor = RGBColor(200, 30, 30);
/// Shortest arrow, and length of its head \[px\].
const SHORTEST: f64 = 2.0;
const HEAD: f64 = 6.0;
/// Windings and amplitude of a drawn spring \[px\].
const WINDINGS: usize = 6;
const AMPLITUDE: f64 = 4.5;

/// Entries of the legend for the connectors of a picture.
pub(super) fn legend(connectors: &[Connector]) -> Vec<(Key, String)> {
    let any = |wanted: &dyn Fn(ConnectorKind) -> bool| connectors.iter().any(|c| wanted(c.kind));
    let entry = |there: bool, key: Key, text: &str| there.then(|| (key, text.to_owned()));
    use ConnectorKind::{Force, Hinge, Rod, Slider, Spring};
    let joint = any(&|kind| kind == Hinge || kind == Slider);
    [
        entry(joint, Key::Disc(INK), "joint"),
        entry(any(&|kind| kind == Rod), Key::Line(ROD), "rod"),
        entry(any(&|kind| kind == Spring), Key::Line(SPRING), "spring"),
        entry(
            any(&|kind| kind == Force),
            Key::Line(FORCE),
            "contact force",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Draws one frame of a connector, `late` in (0, 1]; joints only in the last frame. `color` is the
/// colour of each body.
pub(super) fn draw(
    canvas: &mut Canvas,
    panel: &Panel,
    connector: &Connector,
    (frame, late): (usize, f64),
    color: impl Fn(usize) -> RGBColor,
) {
    let Some(ends) = connector.ends.get(frame) else {
        return;
    };
    if !ends.iter().flatten().all(|x| x.is_finite()) {
        return;
    }
    let [a, b] = ends.map(|[x, y]| panel.pixel(x, y));
    let alpha = 0.2 + 0.8 * late * late;
    match connector.kind {
        ConnectorKind::Rod => canvas.path(&[a, b], ROD, 2.2, alpha),
        ConnectorKind::Spring => canvas.path(&coil(a, b), SPRING, 1.2, alpha),
        ConnectorKind::Force => {
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            if length < SHORTEST {
                return;
            }
            let (along, across) = axes(a, b);
            let head = HEAD.min(length);
            let barb = |side: f64| {
                (
                    b.0 - head * along.0 + side * head * across.0,
                    b.1 - head * along.1 + side * head * across.1,
                )
            };
            canvas.path(&[a, b], FORCE, 1.4, alpha);
            canvas.path(&[barb(0.4), b, barb(-0.4)], FORCE, 1.4, alpha);
        }
        ConnectorKind::Arm { body } => canvas.path(&[a, b], color(body), 1.2, alpha),
        ConnectorKind::Hinge | ConnectorKind::Slider if late < 1.0 => {}
        ConnectorKind::Hinge => {
            if connector.to_ground {
                support(canvas, a);
            }
            canvas.disc(a, 3.4, INK);
            canvas.disc(a, 1.7, WHITE);
        }
        ConnectorKind::Slider => {
            let (along, across) = axes(a, b);
            let at = |x: f64, y: f64| {
                (
                    a.0 + x * along.0 + y * across.0,
                    a.1 + x * along.1 + y * across.1,
                )
            };
            if connector.to_ground {
                canvas.path(&[at(-16.0, 5.5), at(16.0, 5.5)], BLACK, 1.4, 1.0);
                canvas.path(&[at(-16.0, -5.5), at(16.0, -5.5)], BLACK, 1.4, 1.0);
            }
            let block = [at(-6.0, -3.5), at(6.0, -3.5), at(6.0, 3.5), at(-6.0, 3.5)];
            canvas.area(&block, WHITE, 1.0);
            let outline = [block[0], block[1], block[2], block[3], block[0]];
            canvas.path(&outline, INK, 1.3, 1.0);
        }
    }
}

/// The foot of a joint to ground.
fn support(canvas: &mut Canvas, (x, y): Pixel) {
    let foot = y + 11.0;
    let triangle = [(x, y), (x - 6.5, foot), (x + 6.5, foot), (x, y)];
    canvas.path(&triangle, BLACK, 1.2, 1.0);
    canvas.path(&[(x - 9.5, foot), (x + 9.5, foot)], BLACK, 1.4, 1.0);
    for k in 0..4 {
        let start = x - 7.0 + 5.0 * f64::from(k);
        canvas.path(&[(start, foot), (start - 3.5, foot + 4.0)], BLACK, 0.8, 1.0);
    }
}

/// Unit vectors along and across a line; along the picture where it has no length.
fn axes((ax, ay): Pixel, (bx, by): Pixel) -> (Pixel, Pixel) {
    let (dx, dy) = (bx - ax, by - ay);
    let length = dx.hypot(dy);
    if length < 1e-6 {
        return ((1.0, 0.0), (0.0, 1.0));
    }
    let along = (dx / length, dy / length);
    (along, (-along.1, along.0))
}

/// A zigzag between two points, straight at both ends.
fn coil(a: Pixel, b: Pixel) -> Vec<Pixel> {
    let length = (b.0 - a.0).hypot(b.1 - a.1);
    let (along, across) = axes(a, b);
    let at = |part: f64, side: f64| {
        let x = part * length;
        (
            a.0 + x * along.0 + side * across.0,
            a.1 + x * along.1 + side * across.1,
        )
    };
    let lead = 0.15;
    let mut points = vec![a, at(lead, 0.0)];
    let count = 2 * WINDINGS;
    points.extend((0..count).map(|k| {
        let side = if k % 2 == 0 { AMPLITUDE } else { -AMPLITUDE };
        at(
            lead + (1.0 - 2.0 * lead) * (k as f64 + 0.5) / count as f64,
            side,
        )
    }));
    points.extend([at(1.0 - lead, 0.0), b]);
    points
}
