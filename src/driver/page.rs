//! The page of a result: what moves, and the curves of its functions.

use super::connectors::{Joined, joined};
use super::elastic_figures::{colours, deflections, displaced, elastic, has_stress, stresses};
use super::ends::Ends;
use super::optimise::asked;
use super::shells;
use super::simulate::Simulation;
use super::statics::stages as of_structures;
use super::traces;
use crate::functions::Function;
use crate::functions::evaluate::sample;
use crate::functions::snapshot::Snapshot;
use crate::functions::turning::turns;
use crate::math::Vec3;
use crate::problem::{Drawing, Outline, Problem, larger};
use crate::report::page::{Body, Chart, Curve, Link, Shape, Stage, convergence, rounded};
use crate::report::plots::{ConnectorKind, History as Curves};
use crate::report::{History, Optimum, page};

/// Most frames of a motion.
const MOST_FRAMES: usize = 240;
/// Most coordinates in all frames of the bodies of a design that deform: about 1 MB.
const MOST_NUMBERS: usize = 120_000;

/// The page of designs, and of the optimisation that led to the last.
///
/// # Errors
/// If a number of the record is not finite.
pub(crate) fn page(
    problem: &Problem,
    summary: String,
    ends: &Ends,
    of_run: Option<(&Optimum, &History)>,
) -> Result<String, serde_json::Error> {
    let motions = &ends.motions;
    let mut notes = Vec::new();
    let mut stages = of_structures::stages(problem, &ends.structures);
    stages.extend(motions.iter().map(|own| stage(problem, own, &mut notes)));
    share_scales(&mut stages);
    let mut charts = of_run.map_or_else(Vec::new, |(_, history)| convergence(history));
    charts.extend(curves(problem, motions));
    page::html(&page::Page {
        name: &problem.name,
        description: problem.document["description"].as_str().unwrap_or(""),
        summary,
        stages,
        charts,
        optimum: of_run.map(|(optimum, _)| optimum),
        notes,
        version: env!("CARGO_PKG_VERSION"),
    })
}

/// Gives all stages whose colours mean the same one scale, so that designs can be compared.
fn share_scales(stages: &mut [Stage]) {
    for k in 0..stages.len() {
        let alike = |own: &&Stage| own.label == stages[k].label && own.swings == stages[k].swings;
        let ranges = stages.iter().filter(alike).filter_map(|own| own.range);
        stages[k].range = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    }
}

/// Curves of a motion against time: functions of interest, energies, stresses, displacements.
fn curves(problem: &Problem, motions: &[(&str, &Simulation)]) -> Vec<Chart> {
    if motions.is_empty() {
        return Vec::new();
    }
    let chart = |title: &str, up: &str, curves: Vec<Curve>| Chart {
        title: title.to_owned(),
        across: "t [s]".to_owned(),
        up: up.to_owned(),
        logarithmic: false,
        curves,
        limits: Vec::new(),
    };
    let named = |title: &str, name: &str| match (title, name) {
        ("", "") => "value".to_owned(),
        ("", name) => name.to_owned(),
        (title, "") => title.to_owned(),
        (title, name) => format!("{name}, {title}"),
    };
    let mut all = Vec::new();
    let mut shown: Vec<usize> = asked(problem).collect();
    if shown.is_empty() {
        shown = (0..problem.function_names.len()).collect();
    }
    shown.sort_unstable();
    shown.dedup();
    for f in shown {
        let of = |(title, own): &(&str, &Simulation)| {
            let (written, run) = (&own.written, own.motion());
            let Function::Reduced { instant, .. } = written.functions.get(f)? else {
                return None;
            };
            let values = sample(
                instant,
                &turns(instant.watched_rotation(), run),
                &written.model,
                run,
            );
            let points = values.iter().enumerate().map(|(k, &v)| [run.time(k), v]);
            Some((Curve::new(named(title, ""), points), instant.unit()))
        };
        let found: Vec<(Curve, &str)> = motions.iter().filter_map(of).collect();
        let Some(unit) = found.first().map(|(_, unit)| *unit) else {
            continue;
        };
        let unit = if unit.is_empty() { "1" } else { unit };
        let curves = found.into_iter().map(|(curve, _)| curve).collect();
        let name = &problem.function_names[f];
        let mut own = chart(name, &format!("at an instant [{unit}]"), curves);
        let limits = problem.constraints.iter().filter(|c| c.function == f);
        let sides = limits.flat_map(|c| [(&c.name, c.lower), (&c.name, c.upper)]);
        let finite = sides.filter(|(_, value)| value.is_finite());
        own.limits = finite.map(|(name, value)| (name.clone(), value)).collect();
        all.push(own);
    }
    let mut energies = Vec::new();
    for (title, own) in motions {
        let run = &own.at.run;
        let times = || (0..=run.last()).map(|k| run.time(k));
        let both = || times().zip(&own.observations);
        let kinetic = both().map(|(t, o)| [t, o.kinetic]);
        let potential = both().map(|(t, o)| [t, o.potential]);
        let total = both().map(|(t, o)| [t, o.kinetic + o.potential]);
        energies.push(Curve::new(named(title, "kinetic"), kinetic));
        energies.push(Curve::new(named(title, "potential"), potential));
        energies.push(Curve::new(named(title, "total"), total));
    }
    all.push(chart("Energy", "J", energies));
    let drawn: Vec<Drawing> = motions
        .iter()
        .map(|(_, own)| problem.drawing(&own.at.x))
        .collect();
    let of = |curves: &dyn Fn(&str, &Simulation, &Drawing) -> Curves| {
        let pairs = motions.iter().zip(&drawn);
        let each = pairs.flat_map(|((title, own), drawing)| {
            let found = curves(title, own, drawing);
            let time = found.time;
            found.curves.into_iter().map(move |(name, values)| {
                let points = time.iter().zip(values).map(|(&t, v)| [t, v]);
                Curve::new(named(title, &name), points)
            })
        });
        each.collect::<Vec<Curve>>()
    };
    for (title, up, curves) in [
        ("Largest stress", "Pa", of(&stresses)),
        ("Displacement in the body's axes", "m", of(&deflections)),
    ] {
        if !curves.is_empty() {
            all.push(chart(title, up, curves));
        }
    }
    all
}

/// A design in motion.
fn stage(
    problem: &Problem,
    (title, simulation): &(&str, &Simulation),
    notes: &mut Vec<String>,
) -> Stage {
    let drawing = problem.drawing(&simulation.at.x);
    let (model, run) = (&simulation.written.model, simulation.motion());
    let bodies = || (0..model.bodies.len()).filter(|body| !model.is_internal(*body));
    let points: usize = bodies()
        .map(|body| points_of(&drawing.outlines[body]))
        .sum();
    let frames = frames(run.shown(), (3 * points).max(1));
    if frames.len() < run.shown().len().min(MOST_FRAMES) {
        let (some, all) = (frames.len(), run.shown().len());
        let of = if title.is_empty() { "motion" } else { title };
        notes.push(format!("Of the {of}, {some} of {all} instants are shown."));
    }
    let all: Vec<Body> = bodies()
        .map(|body| Body {
            name: model.bodies[body].name.clone(),
            shape: shape((simulation, &drawing), body, &frames),
        })
        .collect();
    let list = |v: &Vec3<f64>| -> [f64; 3] { [v.x, v.y, v.z].map(rounded) };
    let link = |own: Joined| Link {
        kind: match own.kind {
            ConnectorKind::Hinge => "hinge",
            ConnectorKind::Slider => "slider",
            ConnectorKind::Rod => "rod",
            ConnectorKind::Spring => "spring",
            ConnectorKind::Arm { .. } => "arm",
        },
        grounded: own.to_ground,
        ends: (own.ends.iter())
            .map(|[a, b]| [a.x, a.y, a.z, b.x, b.y, b.z].map(rounded))
            .collect(),
    };
    let path = |trace| {
        let each = frames.iter();
        each.map(|&k| list(&traces::place(&Snapshot::of(model, run, k), trace)))
            .collect()
    };
    let stressed = [stresses(title, simulation, &drawing)];
    let coloured = colours(model, &drawing, &stressed);
    Stage {
        title: (*title).to_owned(),
        times: frames.iter().map(|&k| run.time(k)).collect(),
        swings: false,
        clock: "t [s]",
        bodies: all,
        links: (joined((model, run), &drawing, &frames).into_iter())
            .map(link)
            .collect(),
        paths: drawing.traces.iter().map(path).collect(),
        view: [list(&drawing.right), list(&drawing.up)],
        ground: drawing.ground,
        barrier: drawing.barrier.map(|own| [own.distance, own.top]),
        range: coloured.as_ref().map(|own| [0.0, own.largest]),
        label: match &coloured {
            Some(own) => format!("stress [Pa] {}", own.notes.join(", ")),
            None => String::new(),
        },
    }
}

/// Instants that are shown, fewer of bodies that take many numbers each.
fn frames(shown: Vec<usize>, numbers: usize) -> Vec<usize> {
    let most = (MOST_NUMBERS / numbers).clamp(12, MOST_FRAMES);
    if shown.len() <= most {
        return shown;
    }
    let last = shown.len() - 1;
    (0..most).map(|i| shown[i * last / (most - 1)]).collect()
}

/// Number of points of a body that deforms.
fn points_of(outline: &Outline) -> usize {
    match outline {
        Outline::Deformed(line) => line.points.len(),
        Outline::Shells(line) => line.mesh.nodes.len(),
        Outline::Hull(_) | Outline::Sphere(_) | Outline::Spokes(_) => 0,
    }
}

fn shape((simulation, drawing): (&Simulation, &Drawing), body: usize, frames: &[usize]) -> Shape {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let at = |k: &usize| Snapshot::of(model, run, *k);
    let poses = || {
        let pose = |k: &usize| {
            let motion = at(k).motion(body);
            let (origin, turned) = (motion.position, motion.rotation);
            let mut all = [0.0; 9];
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
        points
            .iter()
            .map(|p| [p.x, p.y, p.z].map(rounded))
            .collect()
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
            let last = line.points.len() - 1;
            let slices = line.points.len() / 2 - 1;
            let slice = |k: usize| vec![k, k + 1, last - k - 1, last - k];
            let places = |k: &usize| {
                let (at, q) = (at(k), elastic(model, &at(k), body));
                let motion = at.motion(body);
                let points = line.points.iter();
                let moved = points.map(|(point, modes)| motion.point(&displaced(point, modes, &q)));
                moved.flat_map(|p| [p.x, p.y, p.z].map(rounded)).collect()
            };
            let values = |k: &usize| match fibres {
                Some(beam) => {
                    let largest = beam.largest(&elastic(model, &at(k), body));
                    let ends = largest.windows(2);
                    ends.map(|ends| rounded(larger(ends[0], ends[1]))).collect()
                }
                None => Vec::new(),
            };
            Shape::Mesh {
                faces: (0..slices).map(slice).collect(),
                places: frames.iter().map(places).collect(),
                values: frames.iter().map(values).collect(),
            }
        }
        Outline::Shells(line) => of_shells((simulation, drawing), body, &line.mesh, frames),
    }
}

/// Shells by four faces each, beams by their halves.
fn of_shells(
    (simulation, drawing): (&Simulation, &Drawing),
    body: usize,
    mesh: &crate::model::finite::ElementMesh,
    frames: &[usize],
) -> Shape {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let mut faces = Vec::new();
    for element in &mesh.elements {
        for at in [0, 1, 3, 4] {
            faces.push(
                [at, at + 1, at + 4, at + 3]
                    .map(|local| element.nodes[local])
                    .to_vec(),
            );
        }
    }
    for ends in &mesh.beams {
        faces.extend(ends.windows(2).map(|half| half.to_vec()));
    }
    let unknowns = |k: &usize| {
        let at = Snapshot::of(model, run, *k);
        (
            at.motion(body),
            shells::unknowns(model, body, elastic(model, &at, body)),
        )
    };
    let places = |k: &usize| {
        let (motion, q) = unknowns(k);
        let nodes = shells::places(mesh, &q);
        let moved = nodes.iter().map(|p| motion.point(p));
        moved.flat_map(|p| [p.x, p.y, p.z].map(rounded)).collect()
    };
    let known = has_stress(model, body, drawing);
    let values = |k: &usize| {
        let (_, q) = unknowns(k);
        let Some(finite) = shells::of(model, body).filter(|_| known) else {
            return Vec::new();
        };
        let mut all = Vec::new();
        for stress in shells::stresses(finite, &q) {
            for at in [0, 1, 3, 4] {
                let corners = [at, at + 1, at + 4, at + 3];
                all.push(rounded(
                    corners.iter().map(|&g| stress[g]).sum::<f64>() / 4.0,
                ));
            }
        }
        for beam in &drawing.fibres[body] {
            let largest = beam.largest(&q);
            all.extend(
                largest
                    .windows(2)
                    .map(|ends| rounded(larger(ends[0], ends[1]))),
            );
        }
        all
    };
    Shape::Mesh {
        faces,
        places: frames.iter().map(places).collect(),
        values: frames.iter().map(values).collect(),
    }
}
