//! Pictures of structures: surfaces and lines in colour, seen obliquely, in rows and columns.

use super::canvas::{Anchor, Canvas, INK, Pixel};
use super::colours::colour;
use crate::FigureError;

/// One view of a structure.
pub struct StructureView {
    /// What it shows.
    pub title: String,
    /// Quadrilaterals: corners \[m\] and the value of their colour.
    pub faces: Vec<([[f64; 3]; 4], f64)>,
    /// Lines: points \[m\] and the value of their colour.
    pub lines: Vec<(Vec<[f64; 3]>, f64)>,
    /// Edges of elements \[m\].
    pub edges: Vec<Vec<[f64; 3]>>,
    /// What the colours mean.
    pub label: String,
    /// The values of the first and the last colour.
    pub range: [f64; 2],
}

/// From where structures are seen: the axes to the right, up, and to the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub towards: [f64; 3],
}

impl Camera {
    /// A camera that looks along an axis.
    pub fn along(right: [f64; 3], up: [f64; 3]) -> Self {
        Self {
            right,
            up,
            towards: cross(right, up),
        }
    }

    /// A camera above and beside the axis that looks at a view.
    pub fn oblique(right: [f64; 3], up: [f64; 3]) -> Self {
        let towards = cross(right, up);
        let mix = |k: usize| 0.45 * right[k] + 0.55 * up[k] + 0.7 * towards[k];
        let towards = unit([mix(0), mix(1), mix(2)]);
        let right = unit(cross(up, towards));
        Self {
            right,
            up: cross(towards, right),
            towards,
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = dot(&a, &a).sqrt();
    a.map(|x| x / size)
}

/// Sizes of a view and of its legend \[px\].
const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 250.0;
const LEGEND: f64 = 92.0;
const TITLE: f64 = 26.0;
const MARGIN: f64 = 14.0;

/// Views in rows, each seen by the same camera.
///
/// # Errors
/// If there is nothing to draw.
pub fn structure(rows: &[Vec<StructureView>], camera: &Camera) -> Result<String, FigureError> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    if columns == 0 {
        return Err(FigureError::NothingToDraw {
            figure: "structure",
            missing: "elements",
        });
    }
    let (wide, high) = (WIDTH + LEGEND + MARGIN, HEIGHT + TITLE + MARGIN);
    let mut canvas = Canvas::new(
        MARGIN + wide * columns as f64,
        MARGIN + high * rows.len() as f64,
    );
    for (j, row) in rows.iter().enumerate() {
        for (i, view) in row.iter().enumerate() {
            let corner = (MARGIN + wide * i as f64, MARGIN + high * j as f64);
            draw(&mut canvas, view, camera, corner);
        }
    }
    canvas.svg()
}

fn draw(canvas: &mut Canvas, view: &StructureView, camera: &Camera, (left, top): Pixel) {
    canvas.title((left, top + 8.0), &view.title, Anchor::Left);
    let flat = |p: &[f64; 3]| (dot(p, &camera.right), dot(p, &camera.up));
    let points = view.faces.iter().flat_map(|(corners, _)| corners);
    let points = points.chain(view.lines.iter().flat_map(|(line, _)| line));
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in points {
        let (x, y) = flat(p);
        for (k, t) in [x, y].into_iter().enumerate() {
            low[k] = low[k].min(t);
            high[k] = high[k].max(t);
        }
    }
    let size = [high[0] - low[0], high[1] - low[1]].map(|s| s.max(1e-12));
    let scale = (WIDTH / size[0]).min(HEIGHT / size[1]);
    let place = |p: &[f64; 3]| -> Pixel {
        let (x, y) = flat(p);
        let across = 0.5 * (WIDTH - scale * size[0]);
        let down = 0.5 * (HEIGHT - scale * size[1]);
        (
            left + across + scale * (x - low[0]),
            top + TITLE + down + scale * (high[1] - y),
        )
    };
    // What is far is drawn first.
    let depth = |points: &[[f64; 3]]| {
        let sum: f64 = points.iter().map(|p| dot(p, &camera.towards)).sum();
        sum / points.len() as f64
    };
    let nearer = 1e-2 * (size[0] + size[1]);
    let mut all: Vec<(f64, Drawn)> = Vec::new();
    for face in &view.faces {
        all.push((depth(&face.0), Drawn::Face(face)));
    }
    for line in &view.lines {
        all.push((depth(&line.0), Drawn::Line(line)));
    }
    for edge in &view.edges {
        all.push((depth(edge) + nearer, Drawn::Edge(edge)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, drawn) in all {
        match drawn {
            Drawn::Face((corners, value)) => {
                let outline: Vec<Pixel> = corners.iter().map(place).collect();
                let own = colour(*value, view.range);
                canvas.area(&outline, own, 1.0);
                // Closes the hairline to the neighbours.
                canvas.path(&[&outline[..], &outline[..1]].concat(), own, 0.4, 1.0);
            }
            Drawn::Line((points, value)) => {
                let path: Vec<Pixel> = points.iter().map(place).collect();
                canvas.path(&path, colour(*value, view.range), 3.0, 1.0);
            }
            Drawn::Edge(points) => {
                let path: Vec<Pixel> = points.iter().map(place).collect();
                canvas.path(&path, INK, 0.5, 0.35);
            }
        }
    }
    legend(canvas, view, (left + WIDTH + 16.0, top + TITLE + 14.0));
}

enum Drawn<'a> {
    Face(&'a ([[f64; 3]; 4], f64)),
    Line(&'a (Vec<[f64; 3]>, f64)),
    Edge(&'a Vec<[f64; 3]>),
}

fn legend(canvas: &mut Canvas, view: &StructureView, (left, top): Pixel) {
    const STEPS: usize = 48;
    const NUMBERS: usize = 4;
    let [low, high] = view.range;
    let height = HEIGHT - 60.0;
    canvas.text((left, top - 6.0), &view.label, Anchor::Left);
    let bar = top + 10.0;
    for k in 0..STEPS {
        let part = (k as f64 + 0.5) / STEPS as f64;
        let (y0, y1) = (
            bar + height * (1.0 - (k + 1) as f64 / STEPS as f64),
            bar + height * (1.0 - k as f64 / STEPS as f64) + 0.5,
        );
        let outline = [(left, y0), (left + 12.0, y0), (left + 12.0, y1), (left, y1)];
        canvas.area(&outline, colour(low + part * (high - low), view.range), 1.0);
    }
    for k in 0..=NUMBERS {
        let part = k as f64 / NUMBERS as f64;
        let y = bar + height * (1.0 - part);
        let text = crate::report::number::significant(low + part * (high - low), 3);
        canvas.text((left + 17.0, y), &text, Anchor::Left);
    }
}
