//! Structures on a page: thickness, shapes under load, modes.

use super::figures::{cameras, deformed, factors, is_in_quarters, modes, thickness};
use crate::driver::statics::StaticDesign;
use crate::page::{Body, Shape, Stage, rounded};
use crate::plots::{Camera, StructureView};
use crate::problem::Problem;

/// The stages of designs.
pub fn stages(problem: &Problem, designs: &[(&str, &StaticDesign)]) -> Vec<Stage> {
    let [camera, above] = cameras(problem, designs);
    let axes = |camera: Camera| [camera.right, camera.up];
    let view = axes(camera);
    let each = || designs.iter();
    let still = each().filter_map(|(title, design)| thickness(title, design));
    let still = still.map(|shown| stage(&[shown], axes(above), false));
    let mut all: Vec<Stage> = still.collect();
    let pairs = |from: Vec<StructureView>, to: Vec<StructureView>, swings: bool| {
        let pairs = from.into_iter().zip(to);
        let stages = pairs.map(|(from, to)| stage(&[from, to], view, swings));
        stages.collect::<Vec<Stage>>()
    };
    let factors = factors(designs);
    for (title, design) in each() {
        let both = [0.0, 1.0].map(|share| deformed(title, design, &factors, share));
        let [from, to] = both;
        all.extend(pairs(from, to, false));
    }
    if let Some((_, design)) = designs.last() {
        let [from, to] = [0.0, 1.0].map(|share| modes(design, share));
        all.extend(pairs(from, to, true));
    }
    all
}

/// What the stages of designs leave out.
pub fn left_out(designs: &[(&str, &StaticDesign)]) -> Option<String> {
    let coarse = |own: &(&str, &StaticDesign)| !is_in_quarters(own.1.statics.mesh());
    let note = "Each shell has one colour, the largest of its quarters: there are too many.";
    designs.iter().any(coarse).then(|| note.to_owned())
}

/// A view, or two between which it moves.
fn stage(views: &[StructureView], view: [[f64; 3]; 2], swings: bool) -> Stage {
    let first = &views[0];
    let mut faces = Vec::new();
    let mut count = 0;
    let sizes = first.faces.iter().map(|_| 4);
    for size in sizes.chain(first.lines.iter().map(|line| line.0.len())) {
        faces.push((count..count + size).collect());
        count += size;
    }
    let places = |own: &StructureView| {
        let corners = own.faces.iter().flat_map(|face| face.0.iter());
        let points = corners.chain(own.lines.iter().flat_map(|line| line.0.iter()));
        points.flatten().map(|&x| rounded(x)).collect()
    };
    let values = |own: &StructureView| {
        let faces = own.faces.iter().map(|face| rounded(face.1));
        let lines = own.lines.iter().map(|line| rounded(line.1));
        faces.chain(lines).collect()
    };
    let last = views.last().unwrap_or(first);
    Stage {
        title: last.title.clone(),
        times: (0..views.len()).map(|k| k as f64).collect(),
        swings,
        clock: match views.len() {
            1 => "",
            _ => "part of the displacement",
        },
        bodies: vec![Body {
            name: String::new(),
            shape: Shape::Mesh {
                faces,
                places: views.iter().map(places).collect(),
                values: views.iter().map(values).collect(),
            },
        }],
        links: Vec::new(),
        arrows: Vec::new(),
        paths: Vec::new(),
        view,
        ground: None,
        barrier: None,
        flight: Vec::new(),
        range: (last.range[1] > last.range[0]).then_some(last.range),
        label: last.label.clone(),
    }
}
