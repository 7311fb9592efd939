//! Figures of bodies that deform: coloured parts, displacements and stresses against time.

use super::shells;
use super::simulate::Simulation;
use crate::functions::instant::DeformationKind;
use crate::functions::snapshot::Snapshot;
use crate::functions::{Function, Instant, Reduction};
use crate::math::Vec3;
use crate::model::Model;
use crate::problem::{DeformedLine, Drawing, ElasticPoint, Outline, Problem};
use crate::report::plots::{History as Curves, Patch};

/// Layers across a beam in which its stress is drawn.
const LAYERS: usize = 6;
/// Curves that stay below this part of the largest value are not drawn.
const SEEN: f64 = 1e-2;

/// Elastic coordinates of a body; none of a rigid one.
pub(super) fn elastic(model: &Model<f64>, at: &Snapshot<f64>, body: usize) -> Vec<f64> {
    let own = model
        .flexible
        .iter()
        .filter(|flexible| flexible.frame == body);
    let places = own.flat_map(|flexible| flexible.places());
    places
        .map(|(carrier, k)| at.motion(carrier).point(&Vec3::zeros())[k])
        .collect()
}

/// Whether stresses of a body are known.
pub(super) fn has_stress(outline: &Outline) -> bool {
    match outline {
        Outline::Deformed(line) => !line.stresses.is_empty(),
        Outline::Shells(_) => true,
        Outline::Hull(_) | Outline::Sphere(_) | Outline::Spokes(_) => false,
    }
}

/// Coloured parts of a body; none of a body whose stresses are not known.
pub(super) fn patches(at: &Snapshot<f64>, body: usize, drawing: &Drawing) -> Vec<Patch> {
    let motion = at.motion(body);
    let place = |p: &Vec3<f64>| motion.point(p);
    match &drawing.outlines[body] {
        Outline::Deformed(line) if !line.stresses.is_empty() => {
            bent(line, &elastic(at.model, at, body), |p| {
                drawing.flat(&place(p))
            })
        }
        Outline::Shells(_) => match shells::of(at.model, body) {
            Some(finite) => {
                let q = shells::unknowns(at.model, body, elastic(at.model, at, body));
                shells::patches(finite, &q, place, drawing)
            }
            None => Vec::new(),
        },
        Outline::Deformed(_) | Outline::Hull(_) | Outline::Sphere(_) | Outline::Spokes(_) => {
            Vec::new()
        }
    }
}

/// Coloured parts of a bent beam: slices along it, in layers across it.
fn bent(line: &DeformedLine, q: &[f64], place: impl Fn(&Vec3<f64>) -> [f64; 2]) -> Vec<Patch> {
    let moved = |(point, modes): &(Vec3<f64>, Vec<Vec3<f64>>)| {
        let moved = modes.iter().zip(q).fold(*point, |sum, (n, &q)| sum + n * q);
        place(&moved)
    };
    let border: Vec<[f64; 2]> = line.points.iter().map(moved).collect();
    let last = border.len() - 1;
    let between = |k: usize, part: f64| {
        let (a, b) = (border[k], border[last - k]);
        [0, 1].map(|i| a[i] + part * (b[i] - a[i]))
    };
    let mut all = Vec::new();
    for (k, stresses) in line.stresses.iter().enumerate() {
        let [first, second] = stresses.each_ref().map(|form| form.value(q));
        for layer in 0..LAYERS {
            let [from, to] = [layer, layer + 1].map(|i| i as f64 / LAYERS as f64);
            let middle = 0.5 * (from + to);
            all.push(Patch {
                corners: vec![
                    between(k, from),
                    between(k + 1, from),
                    between(k + 1, to),
                    between(k, to),
                ],
                value: first + middle * (second - first),
            });
        }
    }
    all
}

/// The displacements of points of flexible bodies against time.
pub(crate) fn deflections(title: &str, simulation: &Simulation, drawing: &Drawing) -> Curves {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let mut curves: Vec<(String, Vec<f64>)> = (drawing.elastic_points.iter())
        .map(|point| (point.name.clone(), Vec::new()))
        .collect();
    for k in 0..=run.last() {
        let at = Snapshot::of(model, run, k);
        let mut of: Option<(usize, Vec<f64>)> = None;
        for (ElasticPoint { body, by, .. }, curve) in drawing.elastic_points.iter().zip(&mut curves)
        {
            let q = match of.take() {
                Some((known, q)) if known == *body => q,
                _ => elastic(model, &at, *body),
            };
            curve.1.push(by.iter().map(|(i, n)| n * q[*i]).sum());
            of = Some((*body, q));
        }
    }
    Curves {
        title: title.to_string(),
        time: (0..=run.last()).map(|k| run.time(k)).collect(),
        curves: seen(curves),
    }
}

/// The curves whose largest value is not far below that of the others.
fn seen(mut curves: Vec<(String, Vec<f64>)>) -> Vec<(String, Vec<f64>)> {
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let largest = curves
        .iter()
        .map(|curve| peak(&curve.1))
        .fold(0.0, f64::max);
    curves.retain(|curve| peak(&curve.1) >= SEEN * largest);
    curves
}

/// The largest stress of each body whose stresses are known against time: von Mises stress of shells, the
/// size of that along the fibres of beams.
pub(crate) fn stresses(title: &str, simulation: &Simulation, drawing: &Drawing) -> Curves {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let largest = |body: usize, k: usize| {
        let q = elastic(model, &Snapshot::of(model, run, k), body);
        let q = shells::unknowns(model, body, q);
        match (&drawing.outlines[body], shells::of(model, body)) {
            (Outline::Deformed(line), _) => {
                let both = line.stresses.iter().flatten();
                both.map(|form| form.value(&q).abs()).fold(0.0, f64::max)
            }
            (_, Some(finite)) => shells::stresses(finite, &q).flatten().fold(0.0, f64::max),
            _ => 0.0,
        }
    };
    let bodies = drawing.outlines.iter().enumerate();
    let known = bodies.filter(|(_, outline)| has_stress(outline));
    let curve = |(body, _): (usize, &Outline)| {
        let values = (0..=run.last()).map(|k| largest(body, k));
        (model.bodies[body].name.clone(), values.collect())
    };
    Curves {
        title: title.to_string(),
        time: (0..=run.last()).map(|k| run.time(k)).collect(),
        curves: known.map(curve).collect(),
    }
}

/// The limits that constraints put on stresses of bodies, as constant curves \[Pa\].
pub(crate) fn limits(problem: &Problem, simulation: &Simulation) -> Vec<(String, Vec<f64>)> {
    let scene = &simulation.at.scene;
    let count = simulation.motion().last() + 1;
    let limit = |function: &Function<f64>, upper: f64| {
        let Function::Reduced {
            instant,
            reduction: Reduction::Ks { .. },
        } = function
        else {
            return None;
        };
        match instant {
            Instant::ShellStress { flexible, .. } => {
                let shells = scene.model.flexible.get(*flexible)?.form.shells()?;
                Some(upper * shells.mesh.elements.first()?.yield_stress)
            }
            Instant::Deformation {
                kind: DeformationKind::Stress,
                ..
            }
            | Instant::LargestDeformation {
                kind: DeformationKind::Stress,
                ..
            } => Some(upper),
            _ => None,
        }
    };
    let of = |constraint: &crate::problem::Constraint| {
        let upper = Some(constraint.upper).filter(|upper| upper.is_finite())?;
        let value = limit(scene.functions.get(constraint.function)?, upper)?;
        Some((
            format!("limit of \"{}\"", constraint.name),
            vec![value; count],
        ))
    };
    problem.constraints.iter().filter_map(of).collect()
}
