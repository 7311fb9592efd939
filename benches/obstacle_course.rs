//! Convergence of the obstacle course with elements of nine and of four nodes: a table of each on the output, and
//! `docs/obstacle_course.svg` of nine nodes.
//!
//! `cargo bench --bench obstacle_course`

use std::fmt::Write;

#[path = "../tests/structures/course.rs"]
mod course;

use course::{
    hemisphere, loss_by_distortion, pinched_cylinder, scordelis_lo, skew_plate, twisted_beam,
};
use flexbody::structures::shell::ShellKind;

/// A problem: its name, its colour, and (n, displacement by the published one) from mesh to mesh.
struct Series {
    name: &'static str,
    colour: &'static str,
    points: Vec<(usize, f64)>,
}

fn series(
    name: &'static str,
    colour: &'static str,
    sizes: &[usize],
    f: &dyn Fn(usize) -> f64,
) -> Series {
    Series {
        name,
        colour,
        points: sizes.iter().map(|&n| (n, f(n))).collect(),
    }
}

/// The largest mesh that is drawn, and the range of the displacements.
const MOST: f64 = 64.0;
const RANGE: [f64; 2] = [0.94, 1.08];

/// Ratio of displacements against the number of elements a side (logarithmic).
fn picture(all: &[Series]) -> String {
    let (left, top, width, height) = (60.0, 20.0, 460.0, 360.0);
    let x = |n: usize| left + width * (n as f64).ln() / MOST.ln();
    let y = |ratio: f64| top + height * (RANGE[1] - ratio) / (RANGE[1] - RANGE[0]);
    let mut text = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 780 440\" font-family=\"sans-serif\" \
         font-size=\"12\"><rect width=\"780\" height=\"440\" fill=\"white\"/>\n",
    );
    for n in [1, 2, 4, 8, 16, 32, 64] {
        let (x, low, high) = (x(n), top + height, top);
        let _ = writeln!(
            text,
            "<path d=\"M{x:.1} {low} V{high}\" stroke=\"#e1e1e1\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{n}</text>",
            low + 18.0
        );
    }
    for k in 0..=7 {
        let ratio = RANGE[0] + 0.02 * f64::from(k);
        let (y, right) = (y(ratio), left + width);
        let colour = if k == 3 { "#333" } else { "#e1e1e1" };
        let _ = writeln!(
            text,
            "<path d=\"M{left} {y:.1} H{right}\" stroke=\"{colour}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{ratio:.2}</text>",
            left - 8.0,
            y + 4.0
        );
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"430\" text-anchor=\"middle\">elements along a side (n)</text>\n<text \
         transform=\"translate(16 200) rotate(-90)\" text-anchor=\"middle\">displacement / published \
         displacement</text>",
        left + width / 2.0
    );
    for (k, series) in all.iter().enumerate() {
        let colour = series.colour;
        let inside = |ratio: f64| ratio.clamp(RANGE[0], RANGE[1]);
        let points = || {
            series
                .points
                .iter()
                .map(|&(n, ratio)| (x(n), y(inside(ratio))))
        };
        let path: Vec<String> = points().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            text,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
            path.join(" ")
        );
        for (x, y) in points() {
            let _ = writeln!(
                text,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{colour}\"/>"
            );
        }
        let at = top + 14.0 + 22.0 * k as f64;
        let _ = writeln!(
            text,
            "<circle cx=\"540\" cy=\"{:.1}\" r=\"4\" fill=\"{colour}\"/><text x=\"552\" y=\"{at}\">{}</text>",
            at - 4.0,
            series.name
        );
    }
    text + "</svg>\n"
}

/// The problems with elements of this kind. Meshes of four nodes have twice as many elements along a side.
fn course(kind: ShellKind) -> Vec<Series> {
    let times = 2 / kind.order();
    let sizes = |sizes: &[usize]| -> Vec<usize> { sizes.iter().map(|n| n * times).collect() };
    let (few, many) = (sizes(&[2, 4, 8, 16, 32]), sizes(&[4, 8, 16, 32, 64]));
    let beam = sizes(&[1, 2, 4, 8]);
    vec![
        series("Scordelis-Lo roof", "#4477aa", &few, &|n| {
            scordelis_lo(kind, n)
        }),
        series("pinched cylinder", "#ee6677", &few[1..], &|n| {
            pinched_cylinder(kind, n)
        }),
        series("pinched hemisphere", "#228833", &few, &|n| {
            hemisphere(kind, n)
        }),
        series("skew plate, t/L = 1e-2", "#ccbb44", &many, &|n| {
            skew_plate(kind, n, 1e-2)
        }),
        series("skew plate, t/L = 1e-3", "#66ccee", &many, &|n| {
            skew_plate(kind, n, 1e-3)
        }),
        series("twisted beam, along the width", "#aa3377", &beam, &|n| {
            twisted_beam(kind, n)[0]
        }),
        series(
            "twisted beam, along the thickness",
            "#888888",
            &beam,
            &|n| twisted_beam(kind, n)[1],
        ),
    ]
}

fn main() {
    for kind in [ShellKind::Mitc9, ShellKind::Mitc4] {
        let all = course(kind);
        println!("{kind:?}: displacement by the published one; n elements along a side");
        for series in &all {
            let cells: Vec<String> = series
                .points
                .iter()
                .map(|(n, ratio)| format!("{n}: {ratio:.5}"))
                .collect();
            println!("{:<34} {}", series.name, cells.join("  "));
        }
        println!(
            "part of the deflection that distorted elements take from a strip; n elements along a side"
        );
        for slenderness in [1e-2, 1e-3, 1e-4, 1e-5] {
            let cells = [6, 12, 24].map(|n| {
                let loss = 100.0 * loss_by_distortion(kind, n, slenderness);
                format!("{n}: {loss:.3} %")
            });
            println!("t/L = {slenderness:<28e} {}", cells.join("  "));
        }
        if kind == ShellKind::Mitc9 {
            write(&all);
        }
    }
}

/// Writes the picture.
fn write(all: &[Series]) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/obstacle_course.svg");
    match std::fs::write(path, picture(all)) {
        Ok(()) => println!("docs/obstacle_course.svg is written"),
        Err(error) => println!("{path}: {error}"),
    }
}
