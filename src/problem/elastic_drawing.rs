//! Drawing of bodies that deform: their outlines, and displacements of their points.

use super::elements::prepared;
use super::fibres::SLICES;
use super::holds::nodes_of;
use super::placement::{Assembly, split_location};
use crate::math::Vec3;
use crate::model::finite::{ElementMesh, NODES, ShellElement};
use crate::schema::Document;
use crate::schema::modal::Modal;
use crate::structures::mesh::{Edge, shell_edges};
use crate::structures::modal::{BeamFrame, FlexibleBeam};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Nodes along the edges of an element, counter-clockwise.
fn edges(element: &ShellElement) -> [Edge; 4] {
    let mut all = shell_edges(&element.nodes);
    all[2..].iter_mut().for_each(|edge| edge.reverse());
    all
}

/// The ends of an edge.
fn ends(edge: &Edge) -> [usize; 2] {
    [edge[0], edge[edge.len() - 1]]
}

/// A closed line of points that move on their body.
#[derive(Clone, Debug)]
pub struct DeformedLine {
    /// Its points: where they are in the undeformed body \[m\], and their displacements by each coordinate. Of a
    /// beam those of one side come first, those of the other side follow in opposite order.
    pub points: Vec<(Vec3<f64>, Vec<Vec3<f64>>)>,
}

impl DeformedLine {
    /// The number of elastic coordinates.
    pub fn coordinates(&self) -> usize {
        self.points.first().map_or(0, |(_, modes)| modes.len())
    }
}

/// A displacement of a point of a flexible body against its axes, in its axes \[m\].
#[derive(Clone, Debug)]
pub struct ElasticPoint {
    /// Name of the body, the point and the direction.
    pub name: String,
    /// The body.
    pub body: usize,
    /// Coordinates that move it, and the displacement by each.
    pub by: Vec<(usize, f64)>,
}

/// A point whose path is drawn.
#[derive(Clone, Debug)]
pub struct Trace {
    /// As the file names it.
    pub name: String,
    /// The body.
    pub body: usize,
    /// Where it is in the undeformed body, from its centre of mass in its axes \[m\].
    pub point: Vec3<f64>,
    /// Elastic coordinates that move it, and the displacement by each in the axes of the body.
    pub by: Vec<(usize, Vec3<f64>)>,
}

/// A closed line of nodes of shells.
#[derive(Clone, Debug)]
pub struct ShellLine {
    /// The mesh.
    pub mesh: Arc<ElementMesh>,
    /// The nodes, in their order along the line.
    pub nodes: Vec<usize>,
    /// Thickness of each shell \[m\].
    pub thickness: Vec<f64>,
}

/// The free edges of shells, one after the other, with the beams that start from them, there and back.
pub(super) fn shell_line(mesh: &Arc<ElementMesh>, thickness: Vec<f64>) -> ShellLine {
    let key = |edge: &Edge| {
        let [a, b] = ends(edge);
        [a.min(b), a.max(b)]
    };
    let mut uses: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for edge in mesh.elements.iter().flat_map(edges) {
        *uses.entry(key(&edge)).or_default() += 1;
    }
    let all = mesh.elements.iter().flat_map(edges);
    let mut next: BTreeMap<usize, Edge> = (all.filter(|edge| uses[&key(edge)] == 1))
        .map(|edge| (edge[0], edge))
        .collect();
    let mut beams = Beams::new(&mesh.beams);
    let mut nodes = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut at = start;
        while let Some(edge) = next.remove(&at) {
            nodes.push(at);
            beams.visit(at, &mut nodes);
            nodes.extend(&edge[1..edge.len() - 1]);
            [_, at] = ends(&edge);
        }
        nodes.push(at);
    }
    if let (true, Some([start, ..])) = (mesh.elements.is_empty(), mesh.beams.first()) {
        nodes.push(*start);
        beams.visit(*start, &mut nodes);
    }
    ShellLine {
        mesh: mesh.clone(),
        nodes,
        thickness,
    }
}

/// Beams that a line has not visited yet, by the nodes at their ends.
struct Beams {
    at: BTreeMap<usize, Vec<[usize; 3]>>,
}

impl Beams {
    fn new(beams: &[[usize; 3]]) -> Self {
        let mut at: BTreeMap<usize, Vec<[usize; 3]>> = BTreeMap::new();
        for &[start, middle, end] in beams {
            at.entry(start).or_default().push([start, middle, end]);
            at.entry(end).or_default().push([end, middle, start]);
        }
        Self { at }
    }

    /// A beam from a node; it counts as visited afterwards.
    fn next(&mut self, node: usize) -> Option<[usize; 3]> {
        let [start, middle, end] = self.at.get_mut(&node)?.pop()?;
        if let Some(back) = self.at.get_mut(&end) {
            back.retain(|own| own[1] != middle);
        }
        Some([start, middle, end])
    }

    /// Adds the way along all beams connected with a node, and back to it.
    fn visit(&mut self, node: usize, line: &mut Vec<usize>) {
        let mut way: Vec<[usize; 3]> = Vec::new();
        let mut at = node;
        loop {
            if let Some(beam) = self.next(at) {
                line.extend([beam[1], beam[2]]);
                at = beam[2];
                way.push(beam);
            } else if let Some([start, middle, _]) = way.pop() {
                line.extend([middle, start]);
                at = start;
            } else {
                return;
            }
        }
    }
}

/// Displacements of the named points of shells along the axis of the body that is nearest to their normal, of
/// those of beams along the two axes across the beam.
pub(super) fn shell_points(document: &Document) -> Vec<ElasticPoint> {
    let mut all = Vec::new();
    for (body, (name, written)) in document.bodies.iter().enumerate() {
        let Some(elements) = &written.elements else {
            continue;
        };
        let known = prepared(document, elements);
        for (point, held) in &elements.points {
            let set = held.set();
            let nodes = nodes_of(&known.sets, set).unwrap_or_default();
            let mesh = &known.mesh;
            let of = |element: &ShellElement| {
                let local = element.nodes.iter().position(|node| nodes.contains(node))?;
                Some(vec![element.points[NODES + local].iamax()])
            };
            let of_beam = |beam: &[usize; 3]| {
                beam.iter().find(|node| nodes.contains(node))?;
                let along = (mesh.nodes[beam[2]] - mesh.nodes[beam[0]]).iamax();
                Some((0..3).filter(|axis| *axis != along).collect())
            };
            let axes = mesh.elements.iter().find_map(of);
            let axes = axes.or_else(|| mesh.beams.iter().find_map(of_beam));
            for axis in axes.unwrap_or_default() {
                let motion = &known.points[point];
                let by = motion.coordinates.iter().zip(&motion.displacement);
                let by = by.map(|(coordinate, n)| (*coordinate, n[axis]));
                let by: Vec<(usize, f64)> = by.filter(|(_, n)| *n != 0.0).collect();
                if !by.is_empty() {
                    let name = format!("{name}: {point} along {}", ["x", "y", "z"][axis]);
                    all.push(ElasticPoint { name, body, by });
                }
            }
        }
    }
    all
}

/// The sides of a beam that is seen along `sight`, in its own axes.
pub(super) fn beam_outline(beam: &FlexibleBeam<f64>, sight: &Vec3<f64>) -> DeformedLine {
    // The side that is seen best: along y or z.
    let along_y = sight.z.abs() >= sight.y.abs();
    let [y, z] = beam.half_sizes().unwrap_or([0.0; 2]);
    let side = if along_y { [y, 0.0] } else { [0.0, z] };
    let at = |k: usize, sign: f64| {
        let modes = beam.point(k as f64 / SLICES as f64, side.map(|x| x * sign));
        (modes.position, modes.displacement)
    };
    let there = (0..=SLICES).map(|k| at(k, 1.0));
    let back = (0..=SLICES).rev().map(|k| at(k, -1.0));
    DeformedLine {
        points: there.chain(back).collect(),
    }
}

/// The free end of beams whose start holds their axes, the middle of those on their chord, in each direction
/// in which they bend.
pub(super) fn beam_points(document: &Document, x: &[f64]) -> Vec<ElasticPoint> {
    let mut all = Vec::new();
    for (body, (name, written)) in document.bodies.iter().enumerate() {
        let Some(written) = &written.beam else {
            continue;
        };
        let beam = super::beam::beam(written, x);
        let (place, at) = match beam.frame {
            BeamFrame::Clamped => ("end", 1.0),
            BeamFrame::Chord => ("middle", 0.5),
        };
        let modes = beam.point(at, [0.0; 2]);
        for (k, direction) in [(1, "y"), (2, "z")] {
            let by = modes.displacement.iter().map(|n| n[k]).enumerate();
            let by: Vec<(usize, f64)> = by.filter(|(_, n)| *n != 0.0).collect();
            if !by.is_empty() {
                let name = format!("{name}: {place} along {direction}");
                all.push(ElasticPoint { name, body, by });
            }
        }
    }
    all
}

/// The points whose paths are drawn.
pub(super) fn traces(document: &Document, assembly: &Assembly<f64>, x: &[f64]) -> Vec<Trace> {
    let of = |text: &String| {
        let (name, named) = split_location(text);
        let body = assembly.index(name)?;
        let point = assembly.named_in_body(text) - assembly.poses[body].centre;
        let written = &document.bodies[body];
        let by: Vec<(usize, Vec3<f64>)> = match (&written.beam, &written.elements, &written.modal) {
            (Some(beam), _, _) => {
                let beam = super::beam::beam(beam, x);
                let modes = beam.point(point.x / beam.length, [point.y, point.z]);
                modes.displacement.into_iter().enumerate().collect()
            }
            (None, Some(elements), _) => {
                let known = prepared(document, elements);
                let motion = named.and_then(|named| known.points.get(named));
                motion.map_or_else(Vec::new, |motion| {
                    let all = motion.coordinates.iter().copied();
                    all.zip(motion.displacement.iter().copied()).collect()
                })
            }
            (None, None, Some(modal)) => {
                let modes = modal.body().point(&point, super::modal::scale(modal, x));
                modes.displacement.into_iter().enumerate().collect()
            }
            (None, None, None) => Vec::new(),
        };
        Some(Trace {
            name: text.clone(),
            body,
            point,
            by,
        })
    };
    document.plot.trace.iter().filter_map(of).collect()
}

/// Lines between the points of a body of files, in their order and back.
pub(super) fn line_of_points(modal: &Modal, x: &[f64]) -> DeformedLine {
    let scale = super::modal::scale(modal, x);
    let points = modal.body().points.iter();
    let mut points: Vec<_> = points
        .map(|point| (point.position * scale, point.displacement.clone()))
        .collect();
    let back: Vec<_> = points.iter().rev().skip(1).cloned().collect();
    points.extend(back);
    DeformedLine { points }
}
