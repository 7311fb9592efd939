//! Pictures of structures: thickness, deformed shape with stress, mode shapes.

use crate::detail::{quarters, whole};
use crate::driver::statics::StaticDesign;
use crate::math::Vec3;
use crate::plots::{Camera, StructureView, convergence, structure};
use crate::problem::{BeamFibres, Problem, larger};
use crate::report::History;
use crate::shell_fields::UNKNOWN;
use crate::structures::beam::{BEAM_NODES, Beam};
use crate::structures::functions::Solved;
use crate::structures::mesh::Mesh;
use crate::structures::shell::{STRESS_POINTS, ShellKind};
use crate::structures::state::NodalMotion;
use std::f64::consts::PI;

/// Largest displacement in a picture, relative to the size of the structure.
const SHOWN: f64 = 0.1;
/// Largest number of load cases and of modes that are drawn.
const MOST_CASES: usize = 3;
const MOST_MODES: usize = 4;
/// Largest number of shells that are drawn in quarters; of more, each has one colour, the largest of its quarters.
const MOST_IN_QUARTERS: usize = 500;

/// The figures of designs, and the history of an optimisation.
pub fn figures(
    problem: &Problem,
    designs: &[(&str, &StaticDesign)],
    history: Option<&History>,
) -> Vec<(&'static str, Vec<u8>)> {
    let mut all = Vec::new();
    if let Some(history) = history {
        all.push(("convergence.svg", convergence(history)));
    }
    let [camera, above] = cameras(problem, designs);
    let thickness: Vec<Vec<StructureView>> = designs
        .iter()
        .map(|(title, design)| thickness(title, design).into_iter().collect())
        .collect();
    if thickness.iter().any(|row: &Vec<_>| !row.is_empty()) {
        all.push(("thickness.svg", structure(&in_one_row(thickness), &above)));
    }
    let factors = factors(designs);
    let deformed: Vec<Vec<StructureView>> = designs
        .iter()
        .map(|(title, design)| deformed(title, design, &factors, 1.0))
        .collect();
    let deformed = on_one_scale(deformed);
    if deformed.iter().any(|row| !row.is_empty()) {
        all.push(("deformed.svg", structure(&deformed, &camera)));
    }
    if let Some((_, design)) = designs.last() {
        let modes = modes(design, 1.0);
        if !modes.is_empty() {
            let rows: Vec<Vec<StructureView>> = in_pairs(modes);
            all.push(("modes.svg", structure(&rows, &camera)));
        }
    }
    all.into_iter()
        .filter_map(|(name, svg)| Some((name, svg.ok()?.into_bytes())))
        .collect()
}

/// From where shapes are seen, and from where thickness is: from above where all is flat.
pub(super) fn cameras(problem: &Problem, designs: &[(&str, &StaticDesign)]) -> [Camera; 2] {
    let view = problem.view_of_structures();
    let camera = Camera::oblique(view[0], view[1]);
    let above = match designs.first().and_then(|(_, design)| flat_axes(design)) {
        Some([right, up]) => Camera::along(right, up),
        None => camera,
    };
    [camera, above]
}

/// Rows of one view each as one row.
fn in_one_row(rows: Vec<Vec<StructureView>>) -> Vec<Vec<StructureView>> {
    let mut all: Vec<StructureView> = rows.into_iter().flatten().collect();
    let low = all.iter().map(|v| v.range[0]).fold(f64::INFINITY, f64::min);
    let high = all
        .iter()
        .map(|v| v.range[1])
        .fold(f64::NEG_INFINITY, f64::max);
    all.iter_mut().for_each(|view| view.range = [low, high]);
    vec![all]
}

fn in_pairs(views: Vec<StructureView>) -> Vec<Vec<StructureView>> {
    let mut rows: Vec<Vec<StructureView>> = Vec::new();
    for view in views {
        match rows.last_mut() {
            Some(row) if row.len() < 2 => row.push(view),
            _ => rows.push(vec![view]),
        }
    }
    rows
}

/// The axes of the plane that all nodes lie in, if it is across an axis.
fn flat_axes(design: &StaticDesign) -> Option<[[f64; 3]; 2]> {
    let extents = extents(design);
    let small = 1e-9 * extents.iter().fold(0.0_f64, |m, x| m.max(*x));
    let unit = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
    let flat = (0..3).find(|&k| extents[k] <= small)?;
    Some(match flat {
        0 => [unit(1), unit(2)],
        1 => [unit(0), unit(2)],
        _ => [unit(0), unit(1)],
    })
}

/// Largest extent along an axis \[m\].
fn size(design: &StaticDesign) -> f64 {
    extents(design).into_iter().fold(0.0, f64::max)
}

/// Extents along the axes \[m\].
fn extents(design: &StaticDesign) -> [f64; 3] {
    let nodes = &design.scene.structure.nodes;
    std::array::from_fn(|k| {
        let all = nodes.iter().map(|x| x[k]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
        high - low
    })
}

/// Whether shells are drawn in quarters, each in its colour.
pub(super) fn is_in_quarters(mesh: &Mesh) -> bool {
    mesh.shells.len() <= MOST_IN_QUARTERS
}

/// Corners in the order of nodes, from that around a part.
fn row_by_row([a, b, c, d]: [usize; 4]) -> [usize; 4] {
    [a, b, d, c]
}

/// A view of a mesh with its nodes at `places`; `of_shell` gives the colour of a part of a shell with these
/// corners among its nodes or Gauss points, `of_beam` that of a beam.
fn view(
    mesh: &Mesh,
    places: &[Vec3<f64>],
    (title, label): (String, &str),
    of_shell: impl Fn(usize, [usize; 4]) -> f64,
    of_beam: impl Fn(usize) -> f64,
) -> StructureView {
    let at = |node: usize| -> [f64; 3] { places[node].into() };
    let mut faces = Vec::with_capacity(4 * mesh.shells.len());
    let mut edges = Vec::new();
    for (index, nodes) in mesh.shells.iter().enumerate() {
        let kind = ShellKind::of(nodes);
        let parts = quarters(kind).iter();
        let parts = parts.map(|corners| (corners.map(|k| at(nodes[k])), of_shell(index, *corners)));
        if !is_in_quarters(mesh) {
            let value = parts.map(|(_, value)| value);
            let value = value.fold(f64::NEG_INFINITY, larger);
            faces.push((whole(kind).map(|k| at(nodes[k])), value));
        } else {
            faces.extend(parts);
        }
        let line: &[usize] = match kind {
            ShellKind::Mitc9 => &[0, 1, 2, 5, 8, 7, 6, 3, 0],
            ShellKind::Mitc4 => &[0, 1, 3, 2, 0],
        };
        edges.push(line.iter().map(|&k| at(nodes[k])).collect());
    }
    let lines = mesh.beams.iter().enumerate();
    let lines: Vec<(Vec<[f64; 3]>, f64)> = lines
        .map(|(index, nodes)| (nodes.map(at).to_vec(), of_beam(index)))
        .collect();
    let values = faces.iter().map(|f| f.1).chain(lines.iter().map(|l| l.1));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
        (l.min(x), h.max(x))
    });
    StructureView {
        title,
        faces,
        lines,
        edges,
        label: label.to_owned(),
        range: [low, high],
    }
}

/// The thickness of the shells, if there are some.
pub(super) fn thickness(title: &str, design: &StaticDesign) -> Option<StructureView> {
    let structure = &design.scene.structure;
    let mesh = &structure.topology.mesh;
    let h = &structure.thickness;
    if mesh.shells.is_empty() {
        return None;
    }
    let text = match title.is_empty() {
        true => "thickness".to_owned(),
        false => format!("thickness, {title}"),
    };
    let least = h.iter().copied().fold(f64::INFINITY, f64::min);
    let mm = |index: usize| 1e3 * h[index];
    let mut view = view(
        mesh,
        &structure.nodes,
        (text, "h [mm]"),
        |index, _| mm(index),
        |_| 1e3 * least,
    );
    if view.range[1] - view.range[0] < 1e-9 * view.range[1] {
        view.range = [0.0, view.range[1]];
    }
    Some(view)
}

/// The factor that makes displacements visible in a picture of this size.
fn factor(size: f64, largest: f64) -> f64 {
    match largest > 0.0 {
        true => SHOWN * size / largest,
        false => 0.0,
    }
}

/// Places of the nodes with displacements times a factor.
fn moved(design: &StaticDesign, u: &[Vec3<f64>], factor: f64) -> Vec<Vec3<f64>> {
    let pairs = design.scene.structure.nodes.iter().zip(u);
    pairs.map(|(x, u)| x + u * factor).collect()
}

/// The factors that make displacements visible, by load case: the same for all designs, so that they can be compared.
pub(super) fn factors(designs: &[(&str, &StaticDesign)]) -> Vec<f64> {
    let Some((_, first)) = designs.first() else {
        return Vec::new();
    };
    let of_case = |case: usize| {
        let solved = designs
            .iter()
            .filter(|(_, own)| !own.solutions[case].is_empty());
        let largest = solved.filter_map(|(_, own)| {
            let motion = own.with_solved(|solved| {
                (solved.problem).motion(solved.structure, &solved.solutions[case])
            })?;
            let sizes = motion.displacement.iter().map(|u| u.norm());
            Some(sizes.fold(0.0, f64::max))
        });
        let largest = largest.fold(0.0, f64::max);
        let size = designs.iter().map(|(_, own)| size(own)).fold(0.0, f64::max);
        factor(size, largest)
    };
    (0..first.solutions.len()).map(of_case).collect()
}

/// Gives views of the same load case one scale of colours.
fn on_one_scale(mut rows: Vec<Vec<StructureView>>) -> Vec<Vec<StructureView>> {
    let most = rows.iter().map(Vec::len).max().unwrap_or(0);
    for column in 0..most {
        let ranges = rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|own| own.range);
        let Some(range) = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) else {
            continue;
        };
        let all = rows.iter_mut().filter_map(|row| row.get_mut(column));
        all.for_each(|own| own.range = range);
    }
    rows
}

/// The load cases that are drawn: the first that were solved.
pub(super) fn drawn_cases(design: &StaticDesign) -> impl Iterator<Item = usize> + '_ {
    let all = design.solutions.iter().enumerate();
    let solved = all.filter(|(_, x)| !x.is_empty());
    solved.map(|(case, _)| case).take(MOST_CASES)
}

/// The deformed shape of the first load cases with a part of the displacements, in colours of stress: von Mises of shells, largest along fibres of
/// beams.
pub(super) fn deformed(
    title: &str,
    design: &StaticDesign,
    factors: &[f64],
    share: f64,
) -> Vec<StructureView> {
    let mesh = &design.scene.structure.topology.mesh;
    let cases = drawn_cases(design);
    let one = |case: usize| {
        let OfCase {
            motion,
            stress,
            along,
        } = of_case(design, case)?;
        let known = along.iter().any(|&stress| stress != UNKNOWN);
        let factor = factors[case];
        let places = moved(design, &motion.displacement, factor * share);
        let yields = yield_stresses(design);
        // The larger of both faces at the four Gauss points of a quarter, in MPa.
        let of_shell = |index: usize, corners: [usize; 4]| {
            let points = row_by_row(corners).into_iter();
            let sum: f64 = points
                .map(|g| stress[index][2 * g].max(stress[index][2 * g + 1]))
                .sum();
            0.25 * sum * yields[index] * 1e-6
        };
        let name = &design.statics.cases[case];
        let own = if title.is_empty() {
            String::new()
        } else {
            format!("{title}: ")
        };
        let text = format!("{own}{name}, displacements × {factor:.3}");
        let label = match (mesh.shells.is_empty(), known) {
            (true, false) => "",
            (true, true) => "|σ| [MPa]",
            (false, false) => "σ_v [MPa]",
            (false, true) => "σ_v, |σ| [MPa]",
        };
        // Beams of unknown stress have the colour of none.
        let of_beam = |index: usize| along[index].max(0.0) * 1e-6;
        Some(view(mesh, &places, (text, label), of_shell, of_beam))
    };
    cases.filter_map(one).collect()
}

/// What a load case makes.
pub(super) struct OfCase {
    pub motion: NodalMotion<f64>,
    /// σ_v / σ_yield of each shell at its points.
    pub stress: Vec<[f64; STRESS_POINTS]>,
    /// The largest |σ| along the outer fibres of each beam \[Pa\]; [`UNKNOWN`] of sections without size.
    pub along: Vec<f64>,
}

pub(super) fn of_case(design: &StaticDesign, case: usize) -> Option<OfCase> {
    design.with_solved(|solved| OfCase {
        motion: (solved.problem).motion(solved.structure, &solved.solutions[case]),
        stress: solved.stress_field(case),
        along: beam_stresses(solved, case),
    })
}

fn beam_stresses(solved: &Solved<f64>, case: usize) -> Vec<f64> {
    let von_karman = solved.terms.von_karman;
    let one = |(beam, q): (Beam<f64>, [f64; 6 * BEAM_NODES])| {
        let fibres = BeamFibres::at_rest(beam, von_karman);
        let largest = fibres.largest(&q).into_iter().reduce(larger);
        largest.unwrap_or(UNKNOWN)
    };
    solved.beam_fields(case).into_iter().map(one).collect()
}

/// Yield stress of each shell \[Pa\], which stresses are relative to.
pub(super) fn yield_stresses(design: &StaticDesign) -> Vec<f64> {
    let structure = &design.scene.structure;
    let numbers = structure.topology.material.iter();
    numbers
        .map(|&m| structure.materials[m].yield_stress)
        .collect()
}

/// The lowest modes that were found, with a part of their displacements.
pub(super) fn modes(design: &StaticDesign, share: f64) -> Vec<StructureView> {
    let mesh = &design.scene.structure.topology.mesh;
    let Some(found) = design.some_modes() else {
        return Vec::new();
    };
    let pairs = found
        .vectors
        .iter()
        .zip(&found.eigenvalues)
        .take(MOST_MODES);
    let one = |(k, (x, lambda)): (usize, (&Vec<f64>, &f64))| {
        let motion = design.motion_of_mode(x)?;
        let largest = motion.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let factor = factor(size(design), largest);
        let places = moved(design, &motion, factor * share);
        let f = lambda.sqrt() / (2.0 * PI);
        let text = format!("mode {}, {f:.2} Hz", k + 1);
        let size = |node: usize| factor * motion[node].norm() / (SHOWN * size(design));
        let of_shell = |index: usize, corners: [usize; 4]| {
            let nodes = &mesh.shells[index];
            let corners = row_by_row(corners).into_iter();
            corners.map(|k| size(nodes[k])).sum::<f64>() * 0.25
        };
        let of_beam = |index: usize| size(mesh.beams[index][1]);
        let mut view = view(mesh, &places, (text, "|u| [-]"), of_shell, of_beam);
        view.range = [0.0, 1.0];
        Some(view)
    };
    pairs.enumerate().filter_map(one).collect()
}
