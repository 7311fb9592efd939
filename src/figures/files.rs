//! The figures of a simulation and of an optimisation.

use super::connectors::connectors;
use super::constraints::of_constraints;
use super::detail::Detail;
use super::elastic_figures::{
    SEEN, colours, deflections, elastic, has_stress, keep_the_largest, limits, patches, stresses,
};
use super::error::FigureError;
use super::fits::curves;
use super::flight::release;
use super::machine_modes;
use super::outlines::{outline, scenery};
use super::phases;
use super::shells;
use super::statics::figures as of_structures;
use super::traces;
use crate::driver::Optimisation;
use crate::driver::Simulation;
use crate::driver::ends::Ends;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::plots::{
    BodyMotion, EnergyRun, History as Curves, Lapse, Motion, convergence, energy, fit, histories,
    motion,
};
use crate::problem::{Division, Drawing, Problem, Trace};
use crate::report::History;

/// Most numbers of the bodies of a design in the picture of its motion, about 1 MB: of large machines beams are drawn at fewer
/// sections and shells by their corners.
const MOST_NUMBERS: usize = 40_000;

/// The names of all figures.
pub const NAMES: [&str; 12] = [
    "convergence.svg",
    "constraints.svg",
    "fit.svg",
    "motion.svg",
    "energy.svg",
    "deflection.svg",
    "trace.svg",
    "stress.svg",
    "thickness.svg",
    "deformed.svg",
    "modes.svg",
    "campbell.svg",
];

/// A file's name and content.
pub type NamedFile = (&'static str, Vec<u8>);

/// Figures of an optimisation. Empty ones are left out.
pub fn of_optimisation(problem: &Problem, done: &Optimisation) -> Vec<NamedFile> {
    of_ends(problem, &Ends::of_optimisation(done), &done.history)
}

/// Figures of the two ends of an optimisation; those of cases are [`of_designs`].
pub fn of_ends(problem: &Problem, ends: &Ends, history: &History) -> Vec<NamedFile> {
    match (&problem.cases, &problem.statics) {
        (Some(cases), _) => {
            let mut all = drawn(vec![("convergence.svg", convergence(history))]);
            if cases.division == Division::Events {
                all.extend(of_phases(problem, ends));
            }
            all
        }
        (None, Some(_)) => of_structures::figures(problem, &ends.structures, Some(history)),
        (None, None) => figures(problem, &ends.motions, Some(history)),
    }
}

/// Figures of designs without a history, such as those of a case, which may have phases.
pub fn of_designs(problem: &Problem, ends: &Ends) -> Vec<NamedFile> {
    match (&problem.cases, &problem.statics) {
        (Some(_), _) => of_phases(problem, ends),
        (None, Some(_)) => of_structures::figures(problem, &ends.structures, None),
        (None, None) => figures(problem, &ends.motions, None),
    }
}

/// Figures of motions that events divide, each with all of its phases.
pub fn of_phases(problem: &Problem, ends: &Ends) -> Vec<NamedFile> {
    let designs = phases::designs(ends);
    let energies: Vec<EnergyRun> = (designs.iter())
        .map(|own| phases::energy(own, energies))
        .collect();
    let lapses: Vec<Motion> = (designs.iter())
        .map(|own| phases::lapse(own, |own, drawing| lapse("", own, drawing, Some(&[]), &[])))
        .collect();
    let mut all = Vec::new();
    if let Some((first, simulation)) = designs.first().and_then(|own| own.phases.first()) {
        let drawing = first.drawing(&simulation.at.x);
        all.push(("motion.svg", motion(&lapses, &scenery(&drawing))));
    }
    all.push(("energy.svg", energy(&energies)));
    let limited = phases::of_constraints(problem, &designs);
    if !limited.is_empty() {
        let rows = limited
            .iter()
            .map(|(label, curves)| (&label[..], curves.clone()));
        all.push(("constraints.svg", histories(&rows.collect::<Vec<_>>())));
    }
    drawn(all)
}

/// Figures of a simulation.
pub fn of_simulation(problem: &Problem, simulation: &Simulation) -> Vec<NamedFile> {
    figures(problem, &[("", simulation)], None)
}

fn figures(
    problem: &Problem,
    designs: &[(&str, &Simulation)],
    history: Option<&History>,
) -> Vec<NamedFile> {
    let drawings: Vec<Drawing> = designs
        .iter()
        .map(|(_, design)| problem.drawing(&design.at.x))
        .collect();
    let mut all = Vec::new();
    if let Some(history) = history {
        all.push(("convergence.svg", convergence(history)));
        let fits = curves(problem, designs);
        if !fits.is_empty() {
            all.push(("fit.svg", fit(&fits)));
        }
    }
    let pairs = || designs.iter().zip(&drawings);
    let curves = pairs().map(|((title, design), drawing)| {
        let motion = (&design.written.model, design.motion());
        stresses(title, motion, drawing)
    });
    let mut stressed: Vec<Curves> = curves.collect();
    let lapses: Vec<Motion> = designs
        .iter()
        .zip(&drawings)
        .map(|((title, design), drawing)| {
            let objective = thrown_for(problem);
            lapse(title, design, drawing, objective.as_deref(), &stressed)
        })
        .collect();
    if let Some(drawing) = drawings.last() {
        all.push(("motion.svg", motion(&lapses, &scenery(drawing))));
    }
    // At rest there is nothing over time.
    if problem.is_rest() {
        all.extend(machine_modes::figures(problem, designs, &drawings));
        return drawn(all);
    }
    let energies: Vec<EnergyRun> = designs
        .iter()
        .map(|(title, design)| energies(title, design))
        .collect();
    all.push(("energy.svg", energy(&energies)));
    let limited = of_constraints(problem, designs);
    if !limited.is_empty() {
        let rows = limited
            .iter()
            .map(|(label, curves)| (&label[..], curves.clone()));
        all.push(("constraints.svg", histories(&rows.collect::<Vec<_>>())));
    }
    let deforms = |drawing: &Drawing| !drawing.elastic_points.is_empty();
    if drawings.iter().any(deforms) {
        let curves = pairs().map(|((title, design), drawing)| deflections(title, design, drawing));
        let mut curves: Vec<Curves> = curves.collect();
        let some = keep_the_largest(&mut curves, SEEN);
        let label = format!("displacement in the body's axes [m]{some}");
        all.push(("deflection.svg", histories(&[(&label, curves)])));
    }
    let flexible = |(_, design): &(&str, &Simulation)| !design.written.model.flexible.is_empty();
    let traced = |drawing: &Drawing| !drawing.traces.is_empty();
    if designs.iter().any(flexible) && drawings.iter().any(traced) {
        let mut rows = ["x [m]", "y [m]", "z [m]"].map(|label| (label, Vec::new()));
        for ((title, design), drawing) in pairs() {
            let positions = traces::positions(title, design, drawing);
            for (row, curves) in rows.iter_mut().zip(positions) {
                row.1.push(curves);
            }
        }
        all.push(("trace.svg", histories(&rows)));
    }
    if stressed.iter().any(|own| !own.curves.is_empty()) {
        for (own, (_, design)) in stressed.iter_mut().zip(designs) {
            own.limits = limits(problem, design);
        }
        let some = keep_the_largest(&mut stressed, 0.0);
        let label = format!("largest stress [Pa]{some}");
        all.push(("stress.svg", histories(&[(&label, stressed)])));
    }
    drawn(all)
}

/// The figures that are not empty.
fn drawn(all: Vec<(&'static str, Result<String, FigureError>)>) -> Vec<NamedFile> {
    all.into_iter()
        .filter_map(|(name, svg)| Some((name, svg.ok()?.into_bytes())))
        .collect()
}

/// The functions of the scene that the objective needs, if there is one.
pub(super) fn thrown_for(problem: &Problem) -> Option<Vec<usize>> {
    let objective = problem.stated_objective()?.function;
    Some(problem.composition.of_scene(&[objective]).into_owned())
}

fn energies(title: &str, simulation: &Simulation) -> EnergyRun {
    let run = &simulation.at.run;
    EnergyRun {
        title: title.to_string(),
        time: (0..=run.last()).map(|k| simulation.time(k)).collect(),
        kinetic: simulation.observations.iter().map(|o| o.kinetic).collect(),
        potential: simulation
            .observations
            .iter()
            .map(|o| o.potential)
            .collect(),
        marks: Vec::new(),
    }
}

fn lapse(
    title: &str,
    simulation: &Simulation,
    drawing: &Drawing,
    objective: Option<&[usize]>,
    stresses: &[Curves],
) -> Motion {
    let run = simulation.motion();
    let model = &simulation.written.model;
    let release = release(simulation, drawing, objective);
    let end = release.as_ref().map_or(run.last(), |own| own.sample);
    let shown: Vec<usize> = run.shown().into_iter().filter(|&k| k <= end).collect();
    let latest = shown.len() - 1;
    let flat = |p: &Vec3<f64>| drawing.flat(p);
    let (oblique, sight) = (drawing.is_oblique(), drawing.sight());
    let snapshots = drawing.snapshots.min(latest + 1);
    let instants: Vec<usize> = (0..snapshots)
        .map(|i| match i + 1 == snapshots {
            true => end,
            false => shown[i * latest / (snapshots - 1)],
        })
        .collect();
    let seen = || (0..model.bodies.len()).filter(|body| !model.is_internal(*body));
    let outlines = seen().map(|body| &drawing.outlines[body]);
    let detail = Detail::of(outlines, MOST_NUMBERS / snapshots);
    let bodies = seen()
        .map(|body| (body, &model.bodies[body]))
        .map(|(body, rigid)| BodyMotion {
            name: rigid.name.clone(),
            outlines: instants
                .iter()
                .map(|&k| {
                    let at = Snapshot::of(model, run, k);
                    let motion = at.motion(body);
                    let q = shells::unknowns(model, body, elastic(model, &at, body));
                    outline(&drawing.outlines[body], &q, &detail, |s| {
                        flat(&motion.point(s))
                    })
                })
                .collect(),
            patches: instants
                .iter()
                .filter(|_| has_stress(model, body, drawing))
                .map(|&k| {
                    let at = Snapshot::of(model, run, k);
                    patches(&at, body, drawing, &detail)
                })
                .collect(),
            depths: instants
                .iter()
                .filter(|_| oblique)
                .map(|&k| sight.dot(&Snapshot::of(model, run, k).motion(body).position))
                .collect(),
        })
        .collect();
    let (thrown, flight) = release.map(|own| (own.projectile, own.flight)).unzip();
    let same = |a: &Trace, b: &Trace| a.body == b.body && (a.point - b.point).norm() < 1e-9;
    let others = drawing.traces.iter();
    let others = others.filter(|trace| !thrown.iter().any(|thrown| same(trace, thrown)));
    let trace = |trace: &Trace| {
        let place = |k: usize| flat(&traces::place(&Snapshot::of(model, run, k), trace));
        (0..=end).map(place).collect()
    };
    let traces = thrown.iter().chain(others).map(trace).collect();
    Motion {
        title: title.to_string(),
        lapse: Lapse::Time,
        bodies,
        connectors: connectors((model, run), drawing, &instants),
        traces,
        flight,
        coloured: colours(model, drawing, stresses),
    }
}
