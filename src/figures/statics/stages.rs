//! Structures on a page: thickness, shapes under load, modes.

use super::figures::{cameras, deformed, drawn_cases, factors, is_in_quarters, modes, thickness};
use crate::driver::statics::StaticDesign;
use crate::page::{Arrow, Body, Shape, Stage, rounded};
use crate::plots::{Camera, StructureView};
use crate::problem::Problem;
use crate::structures::resultants::Resultant;

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
        let mut shown = pairs(from, to, false);
        for (stage, case) in shown.iter_mut().zip(drawn_cases(design)) {
            stage.arrows = arrows(problem, design, case).unwrap_or_default();
        }
        all.extend(shown);
    }
    if let Some((_, design)) = designs.last() {
        let [from, to] = [0.0, 1.0].map(|share| modes(design, share));
        all.extend(pairs(from, to, true));
    }
    all
}

/// The resultants of loads and of supports in a load case, which grow with the load; none of too many.
fn arrows(problem: &Problem, design: &StaticDesign, case: usize) -> Option<Vec<Arrow>> {
    const MOST: usize = 24;
    let sets = design.statics.supports.iter();
    let sets: Vec<&str> = sets.map(|own| own.nodes.as_str()).collect();
    let name = &design.statics.cases[case];
    let loads = problem.document["load_cases"][name].as_object()?;
    if sets.len() + loads.len() > MOST {
        return None;
    }
    let found = design.with_solved(|solved| {
        let loads = solved.of_loads(case).ok()?;
        Some((loads, solved.of_supports(case, &sets).ok()?))
    });
    let (of_loads, of_supports) = found??;
    let arrow = |name: &str, applied: bool, own: Resultant| {
        let ends = |share: f64| {
            let (p, f) = (own.point, share * own.force);
            [p.x, p.y, p.z, f.x, f.y, f.z].map(rounded)
        };
        Arrow {
            name: name.to_owned(),
            applied,
            forces: vec![ends(0.0), ends(1.0)],
        }
    };
    let applied = loads.keys().zip(of_loads);
    let held = sets.iter().zip(of_supports);
    let all = applied.map(|(name, own)| arrow(name, true, own));
    Some(
        all.chain(held.map(|(set, own)| arrow(set, false, own)))
            .collect(),
    )
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
