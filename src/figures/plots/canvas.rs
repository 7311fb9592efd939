//! A drawing surface in pixels that becomes an SVG text, by plotters.

use crate::FigureError;
use crate::problem::visible;
use plotters::drawing::{DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoFont, RGBColor, ShapeStyle};

/// plotters' coordinates are whole pixels: this many of them make one pixel of the picture, so
/// that curves are smooth.
const FINE: f64 = 10.0;
/// plotters divides font sizes by this number.
const FONT_SHRINK: f64 = 1.24;

/// Size of ordinary text \[px\].
pub(super) const TEXT: f64 = 12.0;

/// Width of a text of ordinary size \[px\], estimated on the generous side: fonts differ.
pub(super) fn text_width(text: &str) -> f64 {
    let width = |character: char| match character {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' => 0.34,
        'f' | 'r' | 't' | 'I' | ' ' | '(' | ')' | '[' | ']' | '-' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' => 0.98,
        'A'..='Z' | '−' | '…' => 0.80,
        _ => 0.64,
    };
    TEXT * text.chars().map(width).sum::<f64>()
}

pub(super) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(super) const INK: RGBColor = RGBColor(51, 51, 51);
pub(super) const GRID: RGBColor = RGBColor(225, 225, 225);
pub(super) const GROUND: RGBColor = RGBColor(140, 120, 90);
/// Colours that people with any colour vision tell apart (Okabe and Ito, 2008).
pub(super) const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(110, 110, 110),
];

/// More colours, for what is not told apart by dashes (Tol 2021, muted).
pub(super) const MORE: [RGBColor; 5] = [
    RGBColor(51, 34, 136),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(68, 170, 153),
    RGBColor(221, 204, 119),
];
/// Length and distance of the dashes of patterns \[px\]: dashes, dots, long dashes.
const DASHES: [[f64; 2]; 3] = [[6.0, 3.5], [1.0, 3.5], [14.0, 5.0]];

/// A point of the picture \[px\], y downwards.
pub(super) type Pixel = (f64, f64);

/// Where the given point of a text lies within it.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
    /// Centred, read from below.
    Upwards,
}

enum Shape {
    Path(Vec<Pixel>, f64),
    Area(Vec<Pixel>),
    Disc(Pixel, f64),
    Text(Pixel, String, Anchor, bool),
}

/// Shapes in the order of drawing.
pub(super) struct Canvas {
    width: f64,
    height: f64,
    shapes: Vec<(Shape, RGBColor, f64)>,
}

impl Canvas {
    pub fn new(width: f64, height: f64) -> Canvas {
        Canvas {
            width: width.ceil(),
            height: height.ceil(),
            shapes: Vec::new(),
        }
    }

    /// A line through points, of a width in pixels.
    pub fn path(&mut self, points: &[Pixel], color: RGBColor, width: f64, alpha: f64) {
        let points = thinned(points);
        if points.len() > 1 {
            self.shapes.push((Shape::Path(points, width), color, alpha));
        }
    }

    /// A line of dashes.
    pub fn dashes(&mut self, points: &[Pixel], color: RGBColor, width: f64) {
        for dash in dashes(points, 6.0, 3.5) {
            self.path(&dash, color, width, 1.0);
        }
    }

    /// A line of one of several patterns; the first is solid.
    pub fn pattern(&mut self, points: &[Pixel], color: RGBColor, width: f64, number: usize) {
        match number % (DASHES.len() + 1) {
            0 => self.path(points, color, width, 1.0),
            k => {
                let [length, gap] = DASHES[k - 1];
                for dash in dashes(points, length, gap) {
                    self.path(&dash, color, width, 1.0);
                }
            }
        }
    }

    /// A filled polygon.
    pub fn area(&mut self, points: &[Pixel], color: RGBColor, alpha: f64) {
        self.shapes
            .push((Shape::Area(points.to_vec()), color, alpha));
    }

    /// A filled circle.
    pub fn disc(&mut self, centre: Pixel, radius: f64, color: RGBColor) {
        self.shapes.push((Shape::Disc(centre, radius), color, 1.0));
    }

    /// A triangle that points downwards: the value lies below the axis.
    pub fn below_mark(&mut self, (x, y): Pixel, color: RGBColor) {
        let triangle = [(x - 4.0, y - 7.0), (x + 4.0, y - 7.0), (x, y)];
        self.area(&triangle, color, 1.0);
    }

    /// Text of ordinary size, centred vertically on the point.
    pub fn text(&mut self, at: Pixel, text: &str, anchor: Anchor) {
        let shape = Shape::Text(at, visible(text), anchor, false);
        self.shapes.push((shape, INK, 1.0));
    }

    /// Bold text, centred vertically on the point.
    pub fn title(&mut self, at: Pixel, text: &str, anchor: Anchor) {
        let shape = Shape::Text(at, visible(text), anchor, true);
        self.shapes.push((shape, BLACK, 1.0));
    }

    /// The picture as SVG.
    pub fn svg(&self) -> Result<String, FigureError> {
        let fine = |length: f64| (length * FINE).round() as i32;
        let mut svg = String::new();
        let size = (
            fine(self.width).unsigned_abs(),
            fine(self.height).unsigned_abs(),
        );
        {
            let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            area.fill(&RGBColor(255, 255, 255))?;
            for (shape, color, alpha) in &self.shapes {
                draw(&area, shape, color.mix(*alpha).into(), &fine)?;
            }
            area.present()?;
        }
        // The view box stays in fine units while the picture has its own size; round line ends
        // are inherited by every shape.
        let head = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
        let new = format!(
            "width=\"{}\" height=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"",
            self.width, self.height
        );
        Ok(svg.replacen(&head, &new, 1))
    }
}

type Area<'a> = plotters::drawing::DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(
    area: &Area,
    shape: &Shape,
    style: ShapeStyle,
    fine: &dyn Fn(f64) -> i32,
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let point = |&(x, y): &Pixel| (fine(x), fine(y));
    let points = |all: &[Pixel]| all.iter().map(point).collect::<Vec<_>>();
    match shape {
        Shape::Path(path, width) => {
            let style = style.stroke_width(fine(*width).unsigned_abs());
            area.draw(&PathElement::new(points(path), style))
        }
        Shape::Area(outline) => area.draw(&Polygon::new(points(outline), style.filled())),
        Shape::Disc(centre, radius) => {
            area.draw(&Circle::new(point(centre), fine(*radius), style.filled()))
        }
        Shape::Text(at, text, anchor, bold) => {
            let (horizontal, transform) = match anchor {
                Anchor::Left => (HPos::Left, FontTransform::None),
                Anchor::Centre => (HPos::Center, FontTransform::None),
                Anchor::Right => (HPos::Right, FontTransform::None),
                Anchor::Upwards => (HPos::Center, FontTransform::Rotate270),
            };
            let weight = if *bold {
                FontStyle::Bold
            } else {
                FontStyle::Normal
            };
            let style = ("sans-serif", TEXT * FINE * FONT_SHRINK)
                .into_font()
                .style(weight)
                .transform(transform)
                .color(&style.color)
                .pos(Pos::new(horizontal, VPos::Center));
            area.draw(&Text::new(text.clone(), point(at), style))
        }
    }
}

/// The points without those that lie within a fraction of a pixel of the last one kept.
fn thinned(points: &[Pixel]) -> Vec<Pixel> {
    let mut kept: Vec<Pixel> = Vec::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let near = kept
            .last()
            .is_some_and(|&(u, v)| (x - u).abs().max((y - v).abs()) < 0.4);
        if !near || i + 1 == points.len() {
            kept.push((x, y));
        }
    }
    kept
}

/// Cuts a path into dashes of the given length and distance.
fn dashes(points: &[Pixel], length: f64, gap: f64) -> Vec<Vec<Pixel>> {
    let mut all = Vec::new();
    let mut dash: Vec<Pixel> = points.first().copied().into_iter().collect();
    let (mut inked, mut left) = (true, length);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let distance = dx.hypot(dy);
            if distance <= left {
                left -= distance;
                dash.push(to);
                break;
            }
            from = (from.0 + dx * left / distance, from.1 + dy * left / distance);
            dash.push(from);
            if inked {
                all.push(std::mem::take(&mut dash));
            }
            dash = vec![from];
            inked = !inked;
            left = if inked { length } else { gap };
        }
    }
    if inked {
        all.push(dash);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_have_their_length_across_corners() {
        let corner = [(0.0, 0.0), (4.0, 0.0), (4.0, 10.0)];
        let all = dashes(&corner, 6.0, 3.0);
        assert_eq!(
            all,
            [
                vec![(0.0, 0.0), (4.0, 0.0), (4.0, 2.0)],
                vec![(4.0, 5.0), (4.0, 10.0)],
            ]
        );
    }

    #[test]
    fn text_is_escaped_and_the_view_box_is_finer_than_the_picture() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.text((10.0, 10.0), "a < b & \"c\"", Anchor::Left);
        let svg = canvas.svg().expect("is valid");
        assert!(svg.contains("a &lt; b &amp; "), "{svg}");
        assert!(svg.contains("width=\"100\" height=\"50\""), "{svg}");
        assert!(svg.contains("viewBox=\"0 0 1000 500\""), "{svg}");
    }
}
