//! Shapes of bodies on a page: rigid ones by their poses, those that deform as meshes.

use super::detail::{Detail, OF_BODY, OF_POINTS, quarters};
use super::elastic_figures::{between, displaced, elastic, has_stress};
use super::shells;
use crate::driver::Simulation;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::model::finite::ElementMesh;
use crate::page::{Shape, place, rounded};
use crate::problem::{Drawing, Outline, larger};
use std::collections::BTreeMap;

/// The shape of a body in the frames.
pub(super) fn shape(
    (simulation, drawing): (&Simulation, &Drawing),
    body: usize,
    frames: &[usize],
    detail: &Detail,
) -> Shape {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let at = |k: &usize| Snapshot::of(model, run, *k);
    let poses = || {
        let pose = |k: &usize| {
            let motion = at(k).motion(body);
            let (origin, turned) = (motion.position, motion.rotation);
            let mut all = [0.0; OF_BODY];
            for i in 0..3 {
                all[i] = origin[i];
                all[3 + i] = turned[(i, 0)];
                all[6 + i] = turned[(i, 1)];
            }
            all.map(rounded)
        };
        frames.iter().map(pose).collect()
    };
    let list = |points: &[Vec3<f64>]| -> Vec<[f64; 3]> {
        let points = points.iter();
        points.map(|p| [p.x, p.y, p.z].map(rounded)).collect()
    };
    match &drawing.outlines[body] {
        Outline::Hull(points) => Shape::Hull {
            points: list(points),
            poses: poses(),
        },
        Outline::Sphere(radius) => Shape::Sphere {
            radius: *radius,
            poses: poses(),
        },
        Outline::Spokes(points) => Shape::Spokes {
            points: list(points),
            poses: poses(),
        },
        Outline::Deformed(line) => {
            let fibres = match &drawing.fibres[body][..] {
                [beam] if beam.are_known() => Some(beam),
                _ => None,
            };
            let sections = detail.sections(line.points.len() / 2);
            let count = sections.len();
            let sides = detail.sides(line.points.len()).into_iter();
            let points: Vec<_> = sides.map(|k| &line.points[k]).collect();
            let last = points.len().saturating_sub(1);
            let slice = |k: usize| vec![k, k + 1, last - k - 1, last - k];
            let faces = (0..count.saturating_sub(1)).map(slice).collect();
            let elastic_of = |k: &usize| elastic(model, &at(k), body);
            let values = |k: &usize| match fibres {
                Some(beam) => {
                    let largest = beam.largest(&elastic_of(k));
                    between(&largest, &sections).map(rounded).collect()
                }
                None => Vec::new(),
            };
            let values = frames.iter().map(values).collect();
            // The basis once and few numbers a frame, or all points in each.
            let (of_points, coordinates) = (OF_POINTS * count, line.coordinates());
            if coordinates * of_points + (OF_BODY + coordinates) * frames.len()
                < of_points * frames.len()
            {
                let shape = |i: usize| {
                    let of_points = points.iter().map(|(_, modes)| &modes[i]);
                    let flat = of_points.flat_map(|n| [n.x, n.y, n.z].map(rounded));
                    flat.collect()
                };
                let undeformed: Vec<_> = points.iter().map(|(point, _)| *point).collect();
                let elastic = |k: &usize| elastic_of(k).into_iter().map(rounded).collect();
                return Shape::Modal {
                    faces,
                    points: list(&undeformed),
                    basis: (0..coordinates).map(shape).collect(),
                    poses: poses(),
                    coordinates: frames.iter().map(elastic).collect(),
                    values,
                };
            }
            let places = |k: &usize| {
                let (motion, q) = (at(k).motion(body), elastic_of(k));
                let moved = points.iter();
                let moved = moved.map(|(point, modes)| motion.point(&displaced(point, modes, &q)));
                moved.flat_map(|p| [p.x, p.y, p.z].map(place)).collect()
            };
            Shape::Mesh {
                faces,
                places: frames.iter().map(places).collect(),
                values,
            }
        }
        Outline::Shells(line) => {
            of_shells((simulation, drawing), body, &line.mesh, (frames, detail))
        }
    }
}

/// The faces of shells and the halves of beams, by the nodes that are shown, and where these are in the frames.
fn moving_faces(
    simulation: &Simulation,
    body: usize,
    mesh: &ElementMesh,
    (frames, detail): (&[usize], &Detail),
) -> (Vec<Vec<usize>>, Vec<Vec<f64>>) {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let nodes = detail.nodes(mesh);
    let number: BTreeMap<usize, usize> = nodes.iter().enumerate().map(|(k, &n)| (n, k)).collect();
    let faces = detail.faces(mesh).into_iter();
    let numbered = |face: Vec<usize>| face.iter().map(|node| number[node]).collect();
    let places = |k: &usize| {
        let at = Snapshot::of(model, run, *k);
        let q = shells::unknowns(model, body, elastic(model, &at, body));
        let (motion, all) = (at.motion(body), shells::places(mesh, &q));
        let moved = nodes.iter().map(|&node| motion.point(&all[node]));
        moved.flat_map(|p| [p.x, p.y, p.z].map(place)).collect()
    };
    (
        faces.map(numbered).collect(),
        frames.iter().map(places).collect(),
    )
}

/// Shells, and beams by their halves.
fn of_shells(
    (simulation, drawing): (&Simulation, &Drawing),
    body: usize,
    mesh: &ElementMesh,
    (frames, detail): (&[usize], &Detail),
) -> Shape {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let (faces, places) = moving_faces(simulation, body, mesh, (frames, detail));
    let known = has_stress(model, body, drawing);
    let mean = |values: &[f64]| rounded(values.iter().sum::<f64>() / values.len() as f64);
    let values = |k: &usize| {
        let Some(finite) = shells::of(model, body).filter(|_| known) else {
            return Vec::new();
        };
        let at = Snapshot::of(model, run, *k);
        let q = shells::unknowns(model, body, elastic(model, &at, body));
        let mut all = Vec::new();
        for (element, stress) in finite
            .mesh
            .elements
            .iter()
            .zip(shells::stresses(finite, &q))
        {
            if detail.is_thinned() {
                all.push(mean(&stress));
                continue;
            }
            for corners in quarters(element.kind()) {
                all.push(mean(&corners.map(|g| stress[g])));
            }
        }
        for beam in &drawing.fibres[body] {
            let largest = beam.largest(&q);
            let halves = largest.windows(2);
            all.extend(halves.map(|ends| rounded(larger(ends[0], ends[1]))));
        }
        all
    };
    Shape::Mesh {
        faces,
        places,
        values: frames.iter().map(values).collect(),
    }
}

/// The shells of a body at the first of the frames, in the values of their thickness \[mm\]; `None` without shells.
pub(super) fn thickness(
    (simulation, drawing): (&Simulation, &Drawing),
    body: usize,
    frames: &[usize],
    detail: &Detail,
) -> Option<Shape> {
    let Outline::Shells(line) = &drawing.outlines[body] else {
        return None;
    };
    let first = &frames[..frames.len().min(1)];
    let (faces, places) = moving_faces(simulation, body, &line.mesh, (first, detail));
    let elements = line.mesh.elements.iter();
    let faces_of = elements.map(|element| detail.corners(element.kind()).len());
    let shells = faces_of.clone().sum();
    let each = (line.thickness.iter().zip(faces_of))
        .flat_map(|(h, count)| std::iter::repeat_n(rounded(1e3 * h), count));
    Some(Shape::Mesh {
        faces: faces.into_iter().take(shells).collect(),
        places,
        values: vec![each.collect()],
    })
}
