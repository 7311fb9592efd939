//! Quantities that constraints limit, against time, with their limits.

use crate::driver::Simulation;
use crate::functions::histories::history;
use crate::functions::{Function, Reduction, Scene};
use crate::integrate::Trajectory;
use crate::plots::{History as Curves, Limit};
use crate::problem::{Constraint, Problem};

/// Most panels of the picture: those of the constraints nearest to their limits.
const MOST: usize = 8;
/// Most characters of a name beside a panel.
const LONGEST: usize = 18;

/// A panel: its label, and the curves of every design.
pub(super) type Labelled = (String, Vec<Curves>);

/// For each constraint on a quantity that is reduced over the motion: the quantity against time in every design, and its
/// limits. Of an integral its growth is shown, as it is what has a limit. Constraints on one function share a panel.
pub(super) fn of_constraints(problem: &Problem, designs: &[(&str, &Simulation)]) -> Vec<Labelled> {
    let mut functions: Vec<(f64, usize)> = Vec::new();
    for constraint in &problem.constraints {
        let margin = designs.last().map_or(0.0, |(_, end)| {
            margin(constraint, end.at.value(constraint.function))
        });
        match (functions.iter_mut()).find(|(_, f)| *f == constraint.function) {
            Some((least, _)) => *least = least.min(margin),
            None => functions.push((margin, constraint.function)),
        }
    }
    let mut nearest = functions.clone();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest: Vec<usize> = (nearest.into_iter().map(|own| own.1))
        .filter(|&f| designs.iter().all(|(_, own)| is_reduced(own, f)))
        .take(MOST)
        .collect();
    let grows = |f: &usize| {
        designs
            .iter()
            .any(|(_, own)| is_integral(&own.written.functions[*f]))
    };
    let what = match nearest.iter().any(grows) {
        true => "quantity, or its integral up to this time",
        false => "quantity",
    };
    (functions.into_iter().map(|own| own.1))
        .filter(|f| nearest.contains(f))
        .map(|f| panel(problem, designs, f, what))
        .collect()
}

/// How far inside its limits a constraint is, relative to them.
fn margin(constraint: &Constraint, value: f64) -> f64 {
    let one = |distance: f64, limit: f64| match limit.is_finite() {
        true => distance / limit.abs().max(value.abs()).max(f64::MIN_POSITIVE),
        false => f64::INFINITY,
    };
    let below = one(constraint.upper - value, constraint.upper);
    below.min(one(value - constraint.lower, constraint.lower))
}

/// Whether a function of the scene reduces a quantity over the motion.
fn is_reduced(design: &Simulation, f: usize) -> bool {
    let function = design.written.functions.get(f);
    function.is_some_and(|own| own.quantity().is_some())
}

/// Whether a function is an integral over the motion.
pub(super) fn is_integral(function: &Function<f64>) -> bool {
    matches!(
        function,
        Function::Reduced {
            reduction: Reduction::Integral,
            ..
        }
    )
}

fn panel(problem: &Problem, designs: &[(&str, &Simulation)], f: usize, what: &str) -> Labelled {
    let own: Vec<&Constraint> = (problem.constraints.iter())
        .filter(|constraint| constraint.function == f)
        .collect();
    let unit = problem.function_unit(f);
    let limits = own.iter().flat_map(|own| [own.lower, own.upper]);
    let mut limits: Vec<f64> = limits.filter(|limit| limit.is_finite()).collect();
    limits.dedup();
    let name = own.first().map_or("", |own| &own.name);
    let short: String = match name.chars().count() <= LONGEST {
        true => name.to_owned(),
        false => name.chars().take(LONGEST - 1).chain(['…']).collect(),
    };
    let curves = designs.iter().map(|(title, design)| {
        let (scene, run) = (&design.written, design.motion());
        let function = &scene.functions[f];
        let shown = run.shown();
        let values = history(function, &scene.model, run).unwrap_or_default();
        let time: Vec<f64> = shown.iter().map(|&k| design.time(k)).collect();
        let mut values: Vec<f64> = shown.iter().map(|&k| values[k]).collect();
        if is_integral(function) {
            values = growth(&time, &values, window(function, scene, run));
        }
        Curves {
            title: (*title).to_owned(),
            time,
            curves: vec![(what.to_owned(), values)],
            marks: Vec::new(),
            limits: (limits.iter())
                .map(|&value| Limit {
                    value,
                    unit: "",
                    of: Vec::new(),
                })
                .collect(),
        }
    });
    (format!("{short} [{unit}]"), curves.collect())
}

/// Start and end of the window of a function \[s\]; those of the motion without one.
pub(super) fn window(
    function: &Function<f64>,
    scene: &Scene<f64>,
    run: &Trajectory<f64>,
) -> [f64; 2] {
    let whole = [0.0, run.duration];
    match function {
        Function::Reduced {
            during: Some(window),
            ..
        } => window.times(&scene.model, run).unwrap_or(whole),
        _ => whole,
    }
}

/// The integral over a window up to each instant by the trapezoidal rule.
pub(super) fn growth(time: &[f64], values: &[f64], [start, end]: [f64; 2]) -> Vec<f64> {
    let mut sum = 0.0;
    let first = values.first().map(|_| 0.0);
    let rest = time.windows(2).zip(values.windows(2)).map(|(t, v)| {
        let within = (t[1].min(end) - t[0].max(start)).max(0.0);
        sum += 0.5 * within * (v[0] + v[1]);
        sum
    });
    let rest: Vec<f64> = rest.collect();
    first.into_iter().chain(rest).collect()
}
