//! The page of a result: what moves, and the curves of its functions.

use super::connectors::{Joined, joined};
use super::constraints::{growth, is_integral, window};
use super::detail::Detail;
use super::elastic_figures::{SEEN, colours, deflections, keep_the_largest, stresses};
use super::files::thrown_for;
use super::flight::release;
use super::forces::arrows;
use super::shapes::{shape, thickness};
use super::statics::stages as of_structures;
use super::traces;
use crate::driver::Simulation;
use crate::driver::ends::Ends;
use crate::driver::optimise::requested;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::page;
use crate::page::{Body, Chart, Curve, Link, Stage, Value, convergence, rounded};
use crate::plots::{ConnectorKind, History as Curves};
use crate::problem::{Case, Drawing, Outline, Problem};
use crate::report::{History, Optimum};

/// Most frames of a motion.
const MOST_FRAMES: usize = 240;
/// Most numbers in all frames of a design, unless twelve frames have more: about 1 MB.
const MOST_NUMBERS: usize = 120_000;
/// Fewest frames of a long motion.
const LEAST_FRAMES: usize = 12;
/// Numbers of a joint or load at an instant.
const OF_LINK: usize = 6;

/// A design in motion, with its drawing and its stresses.
struct Shown<'a> {
    title: &'a str,
    simulation: &'a Simulation,
    drawing: Drawing,
    stresses: Curves,
    objective: Option<Vec<usize>>,
}

impl<'a> Shown<'a> {
    fn new(problem: &Problem, title: &'a str, simulation: &'a Simulation) -> Self {
        let drawing = problem.drawing(&simulation.at.x);
        Self {
            title,
            simulation,
            stresses: stresses(
                title,
                (&simulation.written.model, simulation.motion()),
                &drawing,
            ),
            drawing,
            objective: thrown_for(problem),
        }
    }
}

/// The page of designs, and of the optimisation that led to the last; `made` says by what and when it is made.
///
/// # Errors
/// If a number of the record is not finite.
pub fn page(
    problem: &Problem,
    summary: String,
    ends: &Ends,
    (of_run, made): (Option<(&Optimum, &History)>, String),
) -> Result<String, serde_json::Error> {
    let mut charts = of_run.map_or_else(Vec::new, |(_, history)| convergence(history));
    let (mut stages, mut notes) = (Vec::new(), Vec::new());
    let mut add = |mut seen: Seen, case: &str| {
        if !case.is_empty() {
            let titled = |title: &String| match title.is_empty() {
                true => case.to_owned(),
                false => format!("{case}: {title}"),
            };
            let stages = seen.stages.iter_mut().map(|own| &mut own.title);
            let all = stages.chain(seen.charts.iter_mut().map(|own| &mut own.title));
            all.for_each(|title| *title = titled(title));
        }
        stages.extend(seen.stages);
        charts.extend(seen.charts);
        notes.extend(seen.notes);
    };
    match ends.cases.is_empty() {
        true => add(seen(problem, ends), ""),
        false => {
            for (name, problem, ends) in parts(ends) {
                add(seen(problem, ends), &name);
            }
        }
    }
    let mut once: Vec<String> = Vec::new();
    notes.retain(|note| {
        let is_new = !once.contains(note);
        if is_new {
            once.push(note.clone());
        }
        is_new
    });
    share_scales(&mut stages);
    page::html(&page::Page {
        name: &problem.name,
        description: problem.document["description"].as_str().unwrap_or(""),
        summary,
        stages,
        charts,
        optimum: of_run.map(|(optimum, _)| optimum),
        functions: match of_run {
            Some(_) => Vec::new(),
            None => functions(problem, ends),
        },
        document: of_run.is_none().then_some(&problem.document),
        notes,
        made,
        goes_on: false,
        version: env!("CARGO_PKG_VERSION"),
    })
}

/// The cases and phases of designs, with their names.
fn parts<'a>(ends: &'a Ends) -> Vec<(String, &'a Problem, &'a Ends<'a>)> {
    let of_case = |(case, own): &'a (&Case, Ends<'a>)| match own.cases.is_empty() {
        true => vec![(case.name.clone(), &case.problem, own)],
        false => {
            let named = |(phase, problem, ends)| (format!("{}, {phase}", case.name), problem, ends);
            parts(own).into_iter().map(named).collect()
        }
    };
    ends.cases.iter().flat_map(of_case).collect()
}

/// What a page shows of designs of one scene.
struct Seen {
    stages: Vec<Stage>,
    charts: Vec<Chart>,
    notes: Vec<String>,
}

fn seen(problem: &Problem, ends: &Ends) -> Seen {
    let motions: Vec<Shown> = (ends.motions.iter())
        .map(|(title, simulation)| Shown::new(problem, title, simulation))
        .collect();
    let mut notes = problem.notes_of_input();
    let mut stages = of_structures::stages(problem, &ends.structures);
    notes.extend(of_structures::left_out(&ends.structures));
    let shown = motions.iter().map(|own| stage(own, &mut notes));
    let (still, moving): (Vec<Option<Stage>>, Vec<Stage>) = shown.unzip();
    stages.extend(moving);
    stages.extend(still.into_iter().flatten());
    Seen {
        stages,
        charts: curves(problem, &motions),
        notes,
    }
}

/// The page of an optimisation that goes on: its convergence so far.
///
/// # Errors
/// Not for finite numbers.
pub fn so_far(problem: &Problem, history: &History) -> Result<String, serde_json::Error> {
    let iteration = history.rows.last().map_or(0, |row| row.iteration);
    page::html(&page::Page {
        name: &problem.name,
        description: problem.document["description"].as_str().unwrap_or(""),
        summary: format!("Running: iteration {iteration}."),
        stages: Vec::new(),
        charts: convergence(history),
        optimum: None,
        functions: Vec::new(),
        document: None,
        notes: Vec::new(),
        made: String::new(),
        goes_on: true,
        version: env!("CARGO_PKG_VERSION"),
    })
}

/// The functions of a design.
fn functions(problem: &Problem, ends: &Ends) -> Vec<Value> {
    let of = |f: usize| -> Option<(f64, Option<f64>)> {
        if let Some(all) = ends.in_cases {
            let truth = || Some(all.smoothed(f)?.value);
            return Some((all.value(f), all.maximum(f).or_else(truth)));
        }
        if let Some((_, own)) = ends.motions.first() {
            let found = own.at.function(f);
            return Some((found.value, found.maximum.map(|own| own.value)));
        }
        let found = ends.structures.first()?.1.function(f);
        Some((found.value, found.peak.map(|peak| peak.ratio)))
    };
    let all = problem.function_names.iter().enumerate();
    all.filter_map(|(f, name)| {
        let (value, true_maximum) = of(f)?;
        Some(Value {
            name: name.clone(),
            value,
            unit: problem.function_unit(f),
            true_maximum,
        })
    })
    .collect()
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
fn curves(problem: &Problem, motions: &[Shown]) -> Vec<Chart> {
    if motions.is_empty() || problem.is_rest() {
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
    let mut shown: Vec<usize> = requested(problem).collect();
    // Functions over cases need those of a case.
    if problem.objective.is_none() {
        shown = (0..problem.function_names.len()).collect();
    }
    let mut shown = problem.composition.of_scene(&shown).into_owned();
    shown.sort_unstable();
    shown.dedup();
    for f in shown {
        let is_limited = problem.constraints.iter().any(|c| c.function == f);
        let of = |Shown {
                      title, simulation, ..
                  }: &Shown| {
            let (written, run) = (&simulation.written, simulation.motion());
            let function = written.functions.get(f)?;
            let quantity = function.quantity()?;
            let values = quantity.sample(&written.model, run);
            let time: Vec<f64> = (0..values.len()).map(|k| simulation.time(k)).collect();
            // A limit is one of the integral.
            let grows = is_integral(function) && is_limited;
            let (values, unit) = match grows {
                true => {
                    let ends = window(function, written, run);
                    (growth(&time, &values, ends), function.unit())
                }
                false => (values, quantity.unit()),
            };
            let points = time.iter().zip(values).map(|(&t, v)| [t, v]);
            Some((Curve::new(named(title, ""), points), (grows, unit)))
        };
        let found: Vec<(Curve, (bool, String))> = motions.iter().filter_map(of).collect();
        let Some((grows, unit)) = found.first().map(|own| own.1.clone()) else {
            continue;
        };
        let unit = if unit.is_empty() { "1" } else { &unit };
        let curves = found.into_iter().map(|(curve, _)| curve).collect();
        let name = &problem.function_names[f];
        let what = if grows {
            "integral up to t"
        } else {
            "at an instant"
        };
        let mut own = chart(name, &format!("{what} [{unit}]"), curves);
        let limits = problem.constraints.iter().filter(|c| c.function == f);
        let sides = limits.flat_map(|c| [(&c.name, c.lower), (&c.name, c.upper)]);
        let finite = sides.filter(|(_, value)| value.is_finite());
        own.limits = finite.map(|(name, value)| (name.clone(), value)).collect();
        all.push(own);
    }
    let mut energies = Vec::new();
    for Shown {
        title, simulation, ..
    } in motions
    {
        let run = &simulation.at.run;
        let times = || (0..=run.last()).map(|k| simulation.time(k));
        let both = || times().zip(&simulation.observations);
        let kinetic = both().map(|(t, o)| [t, o.kinetic]);
        let potential = both().map(|(t, o)| [t, o.potential]);
        let total = both().map(|(t, o)| [t, o.kinetic + o.potential]);
        energies.push(Curve::new(named(title, "kinetic"), kinetic));
        energies.push(Curve::new(named(title, "potential"), potential));
        energies.push(Curve::new(named(title, "total"), total));
    }
    all.push(chart("Energy", "J", energies));
    let stressed = motions.iter().map(|own| own.stresses.clone()).collect();
    let deflected = |own: &Shown| deflections(own.title, own.simulation, &own.drawing);
    let deflected = motions.iter().map(deflected).collect();
    for (title, up, mut designs) in [
        ("Largest stress", "Pa", stressed),
        ("Displacement in the body's axes", "m", deflected),
    ] {
        let designs: &mut Vec<Curves> = &mut designs;
        let some = keep_the_largest(designs, SEEN);
        let curves = designs.iter().flat_map(|own| {
            own.curves.iter().map(|(name, values)| {
                let points = own.time.iter().zip(values).map(|(&t, &v)| [t, v]);
                Curve::new(named(&own.title, name), points)
            })
        });
        let curves: Vec<Curve> = curves.collect();
        if !curves.is_empty() {
            all.push(chart(&format!("{title}{some}"), up, curves));
        }
    }
    all
}

/// The thickness of the shells of a design if they differ, and the design in motion.
fn stage(shown: &Shown, notes: &mut Vec<String>) -> (Option<Stage>, Stage) {
    let Shown {
        title,
        simulation,
        drawing,
        stresses,
        objective,
    } = shown;
    let (model, run) = (&simulation.written.model, simulation.motion());
    let bodies = || (0..model.bodies.len()).filter(|body| !model.is_internal(*body));
    let outlines = || bodies().map(|body| &drawing.outlines[body]);
    let links = OF_LINK * (model.joints.len() + model.loads.len());
    let detail = Detail::of(outlines(), MOST_NUMBERS / LEAST_FRAMES);
    let frames = frames(run.shown(), detail.numbers(outlines()) + links);
    let of = if title.is_empty() { "motion" } else { title };
    if frames.len() < run.shown().len().min(MOST_FRAMES) {
        let (some, all) = (frames.len(), run.shown().len());
        notes.push(format!("Of the {of}, {some} of {all} instants are shown."));
    }
    if detail.is_thinned() {
        notes.push(format!(
            "Of the {of}, beams are shown at fewer sections and shells by their corners: all would be too many numbers."
        ));
    }
    let all: Vec<Body> = bodies()
        .map(|body| Body {
            name: model.bodies[body].name.clone(),
            shape: shape((simulation, drawing), body, &frames, &detail),
        })
        .collect();
    let still = || {
        let shapes = bodies().filter_map(|body| {
            let shape = thickness((simulation, drawing), body, &frames, &detail)?;
            let name = model.bodies[body].name.clone();
            Some(Body { name, shape })
        });
        shapes.collect::<Vec<Body>>()
    };
    let list = |v: &Vec3<f64>| -> [f64; 3] { [v.x, v.y, v.z].map(rounded) };
    let link = |own: Joined| Link {
        kind: match own.kind {
            ConnectorKind::Hinge => "hinge",
            ConnectorKind::Slider => "slider",
            ConnectorKind::Rod => "rod",
            ConnectorKind::Spring => "spring",
            ConnectorKind::Arm { .. } => "arm",
            ConnectorKind::Force => "force",
        },
        body: match own.kind {
            ConnectorKind::Arm { body } => bodies().position(|shown| shown == body),
            _ => None,
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
    let (arrows, too_many) = arrows(simulation, &frames);
    if too_many {
        notes.push(format!(
            "Of the {of}, no forces are shown: there are too many joints."
        ));
    }
    let coloured = colours(model, drawing, std::slice::from_ref(stresses));
    let release = release(simulation, drawing, objective.as_deref());
    if let Some(own) = release.as_ref().filter(|own| own.sample < run.last()) {
        notes.push(format!(
            "The {of}: the projectile is let go at t = {:.4} s. Its flight begins there; the machine is shown as if it kept it.",
            run.time(own.sample)
        ));
    }
    let flight = release
        .zip(drawing.ground)
        .and_then(|(own, ground)| own.flight.path(ground))
        .map(|path| path.into_iter().map(|p| p.map(rounded)).collect());
    let moving = Stage {
        title: (*title).to_owned(),
        times: frames.iter().map(|&k| run.time(k)).collect(),
        swings: false,
        clock: "t [s]",
        bodies: all,
        links: (joined((model, run), drawing, &frames).into_iter())
            .map(link)
            .collect(),
        arrows,
        paths: drawing.traces.iter().map(path).collect(),
        view: [list(&drawing.right), list(&drawing.up)],
        ground: drawing.ground,
        barrier: drawing.barrier.map(|own| [own.distance, own.top]),
        flight: flight.unwrap_or_default(),
        range: coloured.as_ref().map(|own| [0.0, own.largest]),
        label: match &coloured {
            Some(own) => format!("{} [Pa]", own.notes.join(", ")),
            None => String::new(),
        },
    };
    (of_thickness(&moving, drawing, still), moving)
}

/// The machine at its start in the colours of the thickness of its shells; `None` if all have one.
fn of_thickness(
    moving: &Stage,
    drawing: &Drawing,
    bodies: impl Fn() -> Vec<Body>,
) -> Option<Stage> {
    let lines = drawing.outlines.iter().filter_map(|outline| match outline {
        Outline::Shells(line) => Some(line.thickness.iter()),
        _ => None,
    });
    let [least, most] = lines.flatten().fold([f64::INFINITY, 0.0], |[a, b], &h| {
        [a.min(h), f64::max(b, h)]
    });
    let differ = most > least * (1.0 + 1e-9);
    differ.then(|| Stage {
        title: match moving.title.is_empty() {
            true => "thickness".to_owned(),
            false => format!("thickness, {}", moving.title),
        },
        times: vec![0.0],
        swings: false,
        clock: "",
        bodies: bodies(),
        links: Vec::new(),
        arrows: Vec::new(),
        paths: Vec::new(),
        view: moving.view,
        ground: None,
        barrier: None,
        flight: Vec::new(),
        range: Some([1e3 * least, 1e3 * most]),
        label: "h [mm]".to_owned(),
    })
}

/// Instants that are shown, fewer where each takes many numbers.
fn frames(shown: Vec<usize>, numbers: usize) -> Vec<usize> {
    let most = (MOST_NUMBERS / numbers.max(1)).clamp(LEAST_FRAMES, MOST_FRAMES);
    if shown.len() <= most {
        return shown;
    }
    let last = shown.len() - 1;
    (0..most).map(|i| shown[i * last / (most - 1)]).collect()
}
