//! Figures of bodies that deform: coloured parts, displacements and stresses against time.

use super::detail::Detail;
use super::shells;
use crate::driver::Simulation;
use crate::functions::instant::DeformationKind;
use crate::functions::snapshot::Snapshot;
use crate::functions::{Function, Instant, Quantity, Reduction};
use crate::integrate::Trajectory;
use crate::math::Vec3;
use crate::model::Model;
use crate::plots::{Coloured, History as Curves, Limit, Patch};
use crate::problem::{BeamFibres, DeformedLine, Drawing, ElasticPoint, Outline, Problem, larger};

/// Curves that stay below this part of the largest value are not drawn.
pub(super) const SEEN: f64 = 1e-2;
/// Most curves of a figure.
const MOST_CURVES: usize = 24;
/// Limits are the same up to this part.
const SAME: f64 = 1e-9;

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

/// Whether stresses of a body are known: of its shells, and of its beams.
fn known(model: &Model<f64>, body: usize, drawing: &Drawing) -> [bool; 2] {
    let finite = shells::of(model, body);
    [
        finite.is_some_and(|finite| !finite.mesh.elements.is_empty()),
        drawing.fibres[body].iter().any(BeamFibres::are_known),
    ]
}

/// Whether stresses of a body are known.
pub(super) fn has_stress(model: &Model<f64>, body: usize, drawing: &Drawing) -> bool {
    known(model, body, drawing).contains(&true)
}

/// Coloured parts of a body; none of a body whose stresses are not known.
pub(super) fn patches(
    at: &Snapshot<f64>,
    body: usize,
    drawing: &Drawing,
    detail: &Detail,
) -> Vec<Patch> {
    let motion = at.motion(body);
    let place = |p: &Vec3<f64>| motion.point(p);
    match (&drawing.outlines[body], &drawing.fibres[body][..]) {
        (Outline::Deformed(line), [beam]) if beam.are_known() => {
            let q = elastic(at.model, at, body);
            bent((line, beam), &q, detail, |p| drawing.flat(&place(p)))
        }
        (Outline::Shells(_), fibres) => match shells::of(at.model, body) {
            Some(finite) => {
                let q = shells::unknowns(at.model, body, elastic(at.model, at, body));
                shells::patches((finite, fibres), &q, place, (drawing, detail))
            }
            None => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Coloured parts of a bent beam: slices along it, with the larger stress of the sections at their ends.
fn bent(
    (line, beam): (&DeformedLine, &BeamFibres),
    q: &[f64],
    detail: &Detail,
    place: impl Fn(&Vec3<f64>) -> [f64; 2],
) -> Vec<Patch> {
    let moved = |k: usize| {
        let (point, modes) = &line.points[k];
        place(&displaced(point, modes, q))
    };
    let sides = detail.sides(line.points.len()).into_iter();
    let border: Vec<[f64; 2]> = sides.map(moved).collect();
    let last = border.len() - 1;
    let (largest, sections) = (beam.largest(q), detail.sections(line.points.len() / 2));
    let patch = |(k, value): (usize, f64)| Patch {
        corners: [k, k + 1, last - k - 1, last - k]
            .map(|i| border[i])
            .to_vec(),
        value,
    };
    between(&largest, &sections)
        .enumerate()
        .map(patch)
        .collect()
}

/// The largest of `values` from each of the sections to the next.
pub(super) fn between<'a>(
    values: &'a [f64],
    sections: &'a [usize],
) -> impl Iterator<Item = f64> + 'a {
    let of = |ends: &[usize]| {
        let own = values[ends[0]..=ends[1]].iter().copied();
        own.reduce(larger).unwrap_or(0.0)
    };
    sections.windows(2).map(of)
}

/// Where a point is at elastic coordinates `q`.
pub(super) fn displaced(point: &Vec3<f64>, modes: &[Vec3<f64>], q: &[f64]) -> Vec3<f64> {
    modes.iter().zip(q).fold(*point, |sum, (n, &q)| sum + n * q)
}

/// The displacements of points of flexible bodies against time.
pub fn deflections(title: &str, simulation: &Simulation, drawing: &Drawing) -> Curves {
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
    curves_of(title, run, curves)
}

/// Curves with a value for each sample of a run.
pub(super) fn curves_of(
    title: &str,
    run: &Trajectory<f64>,
    curves: Vec<(String, Vec<f64>)>,
) -> Curves {
    Curves {
        title: title.to_string(),
        time: (0..=run.last()).map(|k| run.time(k)).collect(),
        curves,
        limits: Vec::new(),
        marks: Vec::new(),
    }
}

/// Keeps the curves whose largest value in all designs is at least the part `seen` of that of the others, and of these the
/// largest that a figure has room for. Returns what a label adds if some are left out for want of room.
pub(super) fn keep_the_largest(designs: &mut [Curves], seen: f64) -> String {
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let count = designs.iter().map(|design| design.curves.len()).min();
    let peaks = (0..count.unwrap_or(0)).map(|i| {
        let own = designs.iter().map(|design| peak(&design.curves[i].1));
        own.fold(0.0, f64::max)
    });
    let peaks: Vec<f64> = peaks.collect();
    let largest = peaks.iter().copied().fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..peaks.len())
        .filter(|&i| peaks[i] >= seen * largest)
        .collect();
    let all = order.len();
    order.sort_by(|&a, &b| peaks[b].total_cmp(&peaks[a]));
    order.truncate(MOST_CURVES);
    for design in designs {
        let mut i = 0;
        design.curves.retain(|_| {
            i += 1;
            order.contains(&(i - 1))
        });
    }
    match all > MOST_CURVES {
        true => format!(", the {MOST_CURVES} largest of {all}"),
        false => String::new(),
    }
}

/// The largest stress of each body whose stresses are known against time \[Pa\]: von Mises stress of shells at
/// their Gauss points, size of the stress along all outer fibres of beams. A body of shells and beams has both.
pub fn stresses(
    title: &str,
    (model, run): (&Model<f64>, &Trajectory<f64>),
    drawing: &Drawing,
) -> Curves {
    let mut curves = Vec::new();
    for (body, rigid) in model.bodies.iter().enumerate() {
        let known = known(model, body, drawing);
        if known == [false; 2] {
            continue;
        }
        let mut both = [Vec::new(), Vec::new()];
        for k in 0..=run.last() {
            let q = elastic(model, &Snapshot::of(model, run, k), body);
            let q = shells::unknowns(model, body, q);
            if let (true, Some(finite)) = (known[0], shells::of(model, body)) {
                let all = shells::stresses(finite, &q).flatten();
                both[0].push(all.fold(0.0, larger));
            }
            let beams = drawing.fibres[body].iter();
            let all = beams.flat_map(|beam| beam.largest(&q));
            both[1].push(all.fold(0.0, larger));
        }
        let names = match known {
            [true, true] => ["shells", "beams"].map(|kind| format!("{}: {kind}", rigid.name)),
            _ => [0, 1].map(|_| rigid.name.clone()),
        };
        let curve = names.into_iter().zip(both).zip(known);
        curves.extend(curve.filter_map(|(curve, known)| known.then_some(curve)));
    }
    curves_of(title, run, curves)
}

/// What the colours of bodies mean: the largest of `stresses`, and the kinds of stress.
pub(super) fn colours(
    model: &Model<f64>,
    drawing: &Drawing,
    stresses: &[Curves],
) -> Option<Coloured> {
    let all = stresses.iter().flat_map(|design| &design.curves);
    let values = all.flat_map(|(_, values)| values).copied();
    let largest = values.filter(|value| value.is_finite()).reduce(f64::max)?;
    let each = (0..model.bodies.len()).map(|body| known(model, body, drawing));
    let any = each.fold([false; 2], |any, own| [0, 1].map(|k| any[k] || own[k]));
    let notes = [
        "von Mises stress of shells",
        "largest along the fibres of a beam's section",
    ];
    let kinds = notes.into_iter().zip(any);
    Some(Coloured {
        largest,
        notes: kinds
            .filter(|(_, any)| *any)
            .map(|(note, _)| note.to_string())
            .collect(),
    })
}

/// The limits that constraints put on stresses of bodies \[Pa\]: one for each value, with all whose limit it is.
pub fn limits(problem: &Problem, simulation: &Simulation) -> Vec<Limit> {
    let scene = &simulation.at.scene;
    let model = &scene.model;
    let limit = |function: &Function<f64>, upper: f64| {
        let Function::Reduced {
            of: Quantity::Of(instant),
            reduction: Reduction::Ks { .. },
            ..
        } = function
        else {
            return None;
        };
        match instant {
            Instant::ShellStress { flexible, .. } => {
                let shells = model.flexible.get(*flexible)?.form.shells()?;
                Some((
                    *flexible,
                    upper * shells.mesh.elements.first()?.yield_stress,
                ))
            }
            Instant::Deformation {
                flexible,
                kind: DeformationKind::Stress,
                ..
            }
            | Instant::LargestDeformation {
                flexible,
                kind: DeformationKind::Stress,
                ..
            } => Some((*flexible, upper)),
            _ => None,
        }
    };
    let mut all: Vec<Limit> = Vec::new();
    for constraint in &problem.constraints {
        let function = scene.functions.get(constraint.function);
        let upper = Some(constraint.upper).filter(|upper| upper.is_finite());
        let found = function.zip(upper);
        let Some((flexible, value)) = found.and_then(|(function, upper)| limit(function, upper))
        else {
            continue;
        };
        let body = &model.bodies[model.flexible[flexible].frame].name;
        let of = format!("{body} (\"{}\")", constraint.name);
        let same = |known: &&mut Limit| (known.value - value).abs() <= SAME * value.abs();
        match all.iter_mut().find(same) {
            Some(known) => known.of.push(of),
            None => all.push(Limit {
                value,
                unit: "Pa",
                of: vec![of],
            }),
        }
    }
    all
}
