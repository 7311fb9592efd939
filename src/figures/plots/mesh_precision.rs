//! Error of functions of structures against run time, one curve a function.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, PALETTE, Pixel};
use super::panel::{BELOW, Key, Legend, Panel, room_left};
use crate::FigureError;
use crate::report::PrecisionOfMesh;
use plotters::style::RGBColor;

/// Width of the picture, and height of its frame \[px\].
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
/// Margin of the picture \[px\].
const MARGIN: f64 = 14.0;
/// Room below the title \[px\].
const TITLE: f64 = 24.0;
/// Relative errors below this one are rounding.
const ROUNDING: f64 = 1e-12;

/// A function or gradient: its name, its look, and (CPU time \[s\], relative error) from mesh to mesh.
struct Curve {
    name: String,
    color: RGBColor,
    dashed: bool,
    points: Vec<(f64, f64)>,
}

/// Relative difference of every function, and of the gradient of one (dashed), from the finest mesh against
/// the CPU time of the solution, logarithmic. An SVG text. Functions that no mesh changes have no curve.
///
/// # Errors
/// [`FigureError::NothingToDraw`] if there is no difference to draw.
pub fn mesh_precision(measured: &PrecisionOfMesh) -> Result<String, FigureError> {
    let curves = curves(measured);
    if curves.is_empty() {
        return Err(FigureError::NothingToDraw {
            figure: "work_precision",
            missing: "no function changes with the mesh",
        });
    }
    let key = |curve: &Curve| match curve.dashed {
        true => Key::Dashes(curve.color),
        false => Key::Line(curve.color),
    };
    let entries = curves.iter().map(|curve| (key(curve), curve.name.clone()));
    let legend = Legend::new(entries.collect(), WIDTH - 2.0 * MARGIN);
    let top = MARGIN + legend.height() + TITLE + 6.0;
    let mut canvas = Canvas::new(WIDTH, top + HEIGHT + BELOW + 4.0);
    legend.draw(&mut canvas, MARGIN, MARGIN);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let y = points().map(|point| point.1);
    let y = Axis::logarithmic(y, 14, "relative difference from the finest mesh");
    let x = points().map(|point| point.0);
    let x = Axis::logarithmic(x, 10, "CPU time of solution and, dashed, gradient [s]");
    let room = room_left([&y]) + 4.0;
    let panel = Panel {
        left: room,
        top,
        width: WIDTH - room - MARGIN,
        height: HEIGHT,
        x,
        y,
    };
    let finest = measured.rows.last().map_or(0, |row| row.unknowns);
    let title = format!("{}, finest mesh: {finest} unknowns", measured.name);
    canvas.title((room, top - 0.5 * TITLE), &title, Anchor::Left);
    panel.draw(&mut canvas, true, true);
    for curve in &curves {
        let pixels: Vec<Pixel> = (curve.points.iter())
            .map(|&(x, y)| panel.pixel(x, y.max(panel.y.low)))
            .collect();
        match curve.dashed {
            true => canvas.dashes(&pixels, curve.color, 1.8),
            false => canvas.path(&pixels, curve.color, 1.8, 1.0),
        }
        for pixel in pixels {
            canvas.disc(pixel, 3.6, curve.color);
        }
    }
    canvas.svg()
}

fn curves(measured: &PrecisionOfMesh) -> Vec<Curve> {
    let count = measured.functions.len();
    let one = |k: usize| {
        let of_gradient = k == count;
        let f = if of_gradient { measured.chosen } else { k };
        let name = measured.functions.get(f).cloned().unwrap_or_default();
        let point = |row: &crate::report::MeshRow| {
            let error = measured.errors(row)?[k];
            let seconds = row.seconds
                + if of_gradient {
                    row.gradient_seconds
                } else {
                    0.0
                };
            let drawable = error.is_finite() && error > ROUNDING && seconds > 0.0;
            drawable.then_some((seconds, error))
        };
        Curve {
            name: match of_gradient {
                true => format!("gradient of {name}"),
                false => name,
            },
            color: PALETTE[f % PALETTE.len()],
            dashed: of_gradient,
            points: measured.rows.iter().filter_map(point).collect(),
        }
    };
    let all = (0..=count).map(one);
    all.filter(|curve| !curve.points.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::MeshRow;

    fn measured() -> PrecisionOfMesh {
        let row = |cuts: usize| {
            let n = cuts as f64;
            MeshRow {
                cuts,
                elements: cuts * cuts,
                unknowns: 40 * cuts * cuts,
                seconds: 0.01 * n * n,
                gradient_seconds: 0.02 * n * n,
                values: vec![3.0, 1.0 + 1.0 / (n * n)],
                gradient: vec![2.0 + 1.0 / n],
            }
        };
        PrecisionOfMesh {
            name: "plate".into(),
            functions: vec!["mass".into(), "sag".into()],
            chosen: 1,
            rows: [1, 2, 4].map(row).to_vec(),
        }
    }

    /// The mass does not change, the sag and its gradient have a point for each mesh but the finest.
    #[test]
    fn functions_that_change_have_curves_with_a_point_a_mesh() {
        let curves = curves(&measured());
        let names: Vec<&str> = curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["sag", "gradient of sag"]);
        assert_eq!(curves[0].points.len(), 2);
        let (seconds, error) = curves[0].points[0];
        assert!((seconds - 0.01).abs() < 1e-15);
        assert!((error - (1.0 - 1.0 / 16.0) / (1.0 + 1.0 / 16.0)).abs() < 1e-12);
        assert!((curves[1].points[0].0 - 0.03).abs() < 1e-15);
        let svg = mesh_precision(&measured()).expect("a picture");
        assert_eq!(svg.matches("<circle").count(), 4);
    }

    #[test]
    fn functions_of_no_mesh_have_no_picture() {
        let mut measured = measured();
        measured.rows.iter_mut().for_each(|row| {
            row.values[1] = 1.0;
            row.gradient[0] = 2.0;
        });
        assert!(mesh_precision(&measured).is_err());
    }
}
