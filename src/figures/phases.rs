//! Pictures of motions that events divide: their phases one after the other, with a mark at each event.

use crate::driver::Simulation;
use crate::driver::ends::Ends;
use crate::functions::histories::history;
use crate::plots::{EnergyRun, History as Curves, Lapse, Limit, Motion};
use crate::problem::{Drawing, Problem};

/// A design in all phases.
pub(super) struct Design<'a> {
    /// What it is, such as `optimal design`.
    pub title: &'a str,
    pub phases: Vec<(&'a Problem, &'a Simulation)>,
}

impl Design<'_> {
    /// When the events come \[s\].
    fn marks(&self) -> Vec<f64> {
        let later = self.phases.iter().skip(1);
        later.map(|(_, own)| own.begin).collect()
    }
}

/// The designs of a motion in phases.
pub(super) fn designs<'a>(ends: &'a Ends) -> Vec<Design<'a>> {
    let first = ends.cases.first();
    let titles = first.iter().flat_map(|(_, own)| &own.motions).enumerate();
    let design = |(i, (title, _)): (usize, &(&'a str, &Simulation))| Design {
        title,
        phases: (ends.cases.iter())
            .filter_map(|(case, own)| Some((&case.problem, own.motions.get(i)?.1)))
            .collect(),
    };
    titles.map(design).collect()
}

/// The energies of all phases.
pub(super) fn energy(design: &Design, of: impl Fn(&str, &Simulation) -> EnergyRun) -> EnergyRun {
    let mut all = EnergyRun {
        title: design.title.to_owned(),
        time: Vec::new(),
        kinetic: Vec::new(),
        potential: Vec::new(),
        marks: design.marks(),
    };
    for (_, simulation) in &design.phases {
        let own = of("", simulation);
        all.time.extend(own.time);
        all.kinetic.extend(own.kinetic);
        all.potential.extend(own.potential);
    }
    all
}

/// The bodies of all phases, and in each what joins them then: as many snapshots as of one motion, spread over the whole.
pub(super) fn lapse(design: &Design, of: impl Fn(&Simulation, &Drawing) -> Motion) -> Motion {
    let duration = |own: &Simulation| own.motion().duration;
    let whole: f64 = design.phases.iter().map(|(_, own)| duration(own)).sum();
    let mut all = Motion {
        title: design.title.to_owned(),
        lapse: Lapse::Time,
        bodies: Vec::new(),
        connectors: Vec::new(),
        traces: Vec::new(),
        flight: None,
        coloured: None,
    };
    for (p, (problem, simulation)) in design.phases.iter().enumerate() {
        let mut drawing = problem.drawing(&simulation.at.x);
        let part = drawing.snapshots as f64 * duration(simulation) / whole;
        drawing.snapshots = (part.round() as usize).max(if p == 0 { 2 } else { 1 });
        let own = of(simulation, &drawing);
        // It is nowhere in the snapshots of the phases before.
        let before = all.bodies.first().map_or(0, |body| body.outlines.len());
        all.connectors
            .extend(own.connectors.into_iter().map(|mut connector| {
                let nowhere = std::iter::repeat_n([[f64::NAN; 2]; 2], before);
                connector.ends = nowhere.chain(connector.ends).collect();
                connector
            }));
        if p == 0 {
            (all.bodies, all.traces) = (own.bodies, own.traces);
            // Colours of stress have no common scale.
            all.bodies.iter_mut().for_each(|body| body.patches.clear());
            continue;
        }
        for (body, more) in all.bodies.iter_mut().zip(own.bodies) {
            body.outlines.extend(more.outlines);
            body.depths.extend(more.depths);
        }
        for (trace, more) in all.traces.iter_mut().zip(own.traces) {
            trace.extend(more);
        }
    }
    all
}

/// For each constraint on a quantity: the quantity against time in every design, and its limits.
pub(super) fn of_constraints(problem: &Problem, designs: &[Design]) -> Vec<(String, Vec<Curves>)> {
    let panel = |own: &crate::problem::Constraint| {
        let name = &problem.function_names[own.function];
        let curves = designs.iter().map(|design| {
            let (mut time, mut values) = (Vec::new(), Vec::new());
            for (phase, simulation) in &design.phases {
                let f = phase.function_names.iter().position(|own| own == name)?;
                let (scene, run) = (&simulation.written, simulation.motion());
                let all = history(&scene.functions[f], &scene.model, run)?;
                let shown = run.shown();
                time.extend(shown.iter().map(|&k| simulation.time(k)));
                values.extend(shown.iter().map(|&k| all[k]));
            }
            let limits = [own.lower, own.upper].into_iter();
            let limit = |value: f64| Limit {
                value,
                unit: "",
                of: Vec::new(),
            };
            Some(Curves {
                title: design.title.to_owned(),
                time,
                curves: vec![("quantity".to_owned(), values)],
                limits: limits.filter(|x| x.is_finite()).map(limit).collect(),
                marks: design.marks(),
            })
        });
        let unit = problem.function_unit(own.function);
        Some((
            format!("{name} [{unit}]"),
            curves.collect::<Option<Vec<_>>>()?,
        ))
    };
    problem.constraints.iter().filter_map(panel).collect()
}
