//! Error against run time, one curve per method.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, INK, PALETTE, Pixel};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use crate::report::{PrecisionRow, WorkPrecision};
use plotters::style::RGBColor;

/// Width of a panel with its axis, and height of its frame \[px\].
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 460.0;
/// Margin of the picture \[px\].
const MARGIN: f64 = 14.0;
/// Room below a panel's title \[px\].
const TITLE: f64 = 24.0;
const WHITE: RGBColor = RGBColor(255, 255, 255);

/// Colours of the BDF by order; no other method has them (Tol 2021, muted, and greys).
const ORDERS: [RGBColor; 6] = [
    RGBColor(51, 34, 136),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(86, 180, 233),
    RGBColor(140, 140, 140),
    RGBColor(0, 0, 0),
];

/// The runs of one method with equal steps, or with steps that follow a tolerance.
struct Curve<'a> {
    color: RGBColor,
    /// The text in its markers.
    mark: &'static str,
    adaptive: bool,
    rows: Vec<&'a PrecisionRow>,
}

/// Error of the positions against CPU time of the simulation and, if the measurement has gradients,
/// error of the gradient against CPU time of simulation and backward march: logarithmic, one curve
/// a method, dashed where steps follow a tolerance. An SVG text.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there are no rows.
pub fn work_precision(measured: &WorkPrecision) -> Result<String, FigureError> {
    let curves = curves(&measured.rows);
    if curves.is_empty() {
        return Err(FigureError::NothingToDraw {
            figure: "work_precision",
            missing: "no method reached the end of the motion",
        });
    }
    let position = |row: &PrecisionRow| Some((row.cpu_seconds, row.error));
    let gradient = |row: &PrecisionRow| {
        let seconds = row.cpu_seconds + row.gradient_cpu_seconds?;
        // The size of a completely wrong result has no meaning.
        let error = row.gradient_error.filter(|&error| error <= 1.0)?;
        Some((seconds, error))
    };
    let mut parts: Vec<(String, &str, &str, Pick)> = vec![(
        "positions at the end".to_owned(),
        "largest distance from the reference [m]",
        "CPU time of the simulation [s]",
        &position,
    )];
    if let Some(function) = &measured.function {
        parts.push((
            format!("gradient of \"{function}\""),
            "relative error of the gradient",
            "CPU time of simulation and backward march [s]",
            &gradient,
        ));
    }
    let width = WIDTH * parts.len() as f64;
    let legend = legend(&curves, width - 2.0 * MARGIN);
    let top = MARGIN + legend.height() + TITLE + 6.0;
    let mut canvas = Canvas::new(width, top + HEIGHT + BELOW + 4.0);
    legend.draw(&mut canvas, MARGIN, MARGIN);
    for (i, (title, label_y, label_x, pick)) in parts.into_iter().enumerate() {
        let points = || measured.rows.iter().filter_map(pick).filter(drawable);
        let y = Axis::logarithmic(points().map(|point| point.1), 14, label_y);
        let x = Axis::logarithmic(points().map(|point| point.0), 10, label_x);
        let room = room_left([&y]) + 4.0;
        let left = WIDTH * i as f64 + room;
        let panel = Panel {
            left,
            top,
            width: WIDTH - room - MARGIN,
            height: HEIGHT,
            x,
            y,
        };
        canvas.title((left, top - 0.5 * TITLE), &title, Anchor::Left);
        panel.draw(&mut canvas, true, true);
        for curve in &curves {
            draw(&mut canvas, &panel, curve, pick);
        }
    }
    canvas.svg()
}

/// A point of a row, if the row has one.
type Pick<'a> = &'a dyn Fn(&PrecisionRow) -> Option<(f64, f64)>;

fn drawable(&(x, y): &(f64, f64)) -> bool {
    x.is_finite() && y.is_finite() && x > 0.0 && y > 0.0
}

fn curves(rows: &[PrecisionRow]) -> Vec<Curve<'_>> {
    let mut all: Vec<Curve> = Vec::new();
    for row in rows {
        let adaptive = row.tolerance.is_some();
        let same =
            |curve: &&mut Curve| curve.rows[0].method == row.method && curve.adaptive == adaptive;
        match all.iter_mut().find(same) {
            Some(curve) => curve.rows.push(row),
            None => {
                let (color, mark) = look(&row.method);
                all.push(Curve {
                    color,
                    mark,
                    adaptive,
                    rows: vec![row],
                });
            }
        }
    }
    all
}

/// Colour of a method, and the text in its markers.
fn look(method: &str) -> (RGBColor, &'static str) {
    match method {
        "dop853" => (PALETTE[0], ""),
        "radau3" => (PALETTE[1], ""),
        "radau2" => (PALETTE[2], ""),
        "bdf1" => (ORDERS[0], "1"),
        "bdf2" => (ORDERS[1], "2"),
        "bdf3" => (ORDERS[2], "3"),
        "bdf4" => (ORDERS[3], "4"),
        "bdf5" => (ORDERS[4], "5"),
        "bdf6" => (ORDERS[5], "6"),
        _ if method.starts_with("bdf") => (PALETTE[5], "r"),
        _ => (PALETTE[3], "α"),
    }
}

fn legend(curves: &[Curve], width: f64) -> Legend {
    let mut entries: Vec<(Key, String)> = Vec::new();
    for curve in curves {
        let method = curve.rows[0].method.as_str();
        let text = match curve.mark {
            "" => method.to_owned(),
            mark => format!("{method} ({mark})"),
        };
        let known = entries.iter().any(|(_, known)| *known == text);
        if !known {
            entries.push((Key::Line(curve.color), text));
        }
    }
    entries.push((Key::Line(INK), "equal steps".to_owned()));
    if curves.iter().any(|curve| curve.adaptive) {
        entries.push((Key::Dashes(INK), "steps by tolerance".to_owned()));
    }
    Legend::new(entries, width)
}

fn draw(canvas: &mut Canvas, panel: &Panel, curve: &Curve, pick: Pick) {
    let points: Vec<Pixel> = curve
        .rows
        .iter()
        .filter_map(|row| pick(row))
        .filter(drawable)
        .map(|(x, y)| panel.pixel(x, y.max(panel.y.low)))
        .collect();
    if curve.adaptive {
        canvas.dashes(&points, curve.color, 1.8);
    } else {
        canvas.path(&points, curve.color, 1.8, 1.0);
    }
    for &point in &points {
        if !curve.mark.is_empty() {
            canvas.disc(point, 7.0, curve.color);
            canvas.disc(point, 5.8, WHITE);
            canvas.text(point, curve.mark, Anchor::Centre);
        } else if curve.adaptive {
            canvas.disc(point, 4.2, curve.color);
            canvas.disc(point, 2.6, WHITE);
        } else {
            canvas.disc(point, 3.6, curve.color);
        }
    }
}
