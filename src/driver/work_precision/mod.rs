//! Error against run time for all methods, orders and step sizes or tolerances.
//!
//! Errors are those of the centres of mass at the end, against a run at tight tolerance or a file.
//! Times are CPU times of the stepping alone, and of the backward march alone: the least of several
//! runs after one that does not count (Rackauckas & Nie 2017, *DifferentialEquations.jl*, take the
//! same measure). A method's runs end when they get too dear for its share of time, or when its
//! error does not fall any more.

mod bench;
mod clock;
mod exact;
mod reference;

use crate::integrate::choice::{self, NON_STIFF, STIFF};
use crate::integrate::{IntegrationFailure, Method, Settings, Spacing, Start, simulate};
use crate::problem::Problem;
use crate::report::positions::Positions;
use crate::report::{PrecisionRow, WorkPrecision};
use crate::system::placement;
use bench::Bench;
use clock::cpu_seconds;
use exact::Reference;

/// What is measured, and how thoroughly.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Campaign {
    /// CPU time that the runs of one method with equal steps, or with chosen ones, may take (s).
    pub seconds: f64,
    /// Runs of which the fastest counts.
    pub runs: usize,
    /// Function whose gradient is judged, by index.
    pub function: Option<usize>,
    /// Name of a file and its positions by body at the end (m), instead of those of a run.
    pub reference: Option<(String, Positions)>,
}

/// Decades of the tolerances.
const TOLERANCES: std::ops::RangeInclusive<i32> = 3..=12;
/// Most halvings of the step.
const HALVINGS: u32 = 22;
/// Fewest steps.
const FEWEST: usize = 10;
/// Tolerance of the run whose number of steps the equal steps start from half of.
const USUAL: f64 = 1e-6;
/// Part of the scene's length below which an error that does not fall is one of round-off, and the
/// part of the error before it that is no fall.
const STAGNANT: (f64, f64) = (1e-6, 0.7);
/// Factor by which the next run of a method is dearer, about.
const DEARER: f64 = 2.0;

/// All methods: those that can follow a tolerance first.
pub(crate) fn methods() -> Vec<Method> {
    let bdf = |order, start| Method::Bdf { order, start };
    let mut all = vec![
        Method::Dop853,
        Method::Radau { stages: 2 },
        Method::Radau { stages: 3 },
    ];
    all.extend((1..=6).map(|order| bdf(order, Start::Radau)));
    all.push(bdf(5, Start::RisingOrder));
    all.push(Method::GeneralisedAlpha { radius: 0.8 });
    all
}

/// Measures all methods on `problem` at the design `x`; `seen` is told of every row.
///
/// # Errors
/// If no reference run reaches the end; a method that fails is noted and left out.
pub(crate) fn work_precision(
    problem: &Problem,
    x: &[f64],
    plan: &Campaign,
    seen: &mut dyn FnMut(&PrecisionRow),
) -> Result<WorkPrecision, IntegrationFailure> {
    let function = plan.function.filter(|_| !problem.variables.is_empty());
    let plan = Campaign {
        function,
        ..plan.clone()
    };
    let bench = Bench::new(problem, x, function);
    let (stiff, usual) = usual(&bench)?;
    let reference = reference::reference(&bench, &plan, stiff)?;
    let mut measurement = Measurement {
        length: placement::length_scale(&bench.scene.model),
        plan: &plan,
        bench: &bench,
        reference: &reference,
        rows: Vec::new(),
        notes: Vec::new(),
        seen,
    };
    let fewest = fewest(problem, usual);
    for method in methods() {
        if method.is_adaptive() {
            let tolerances = TOLERANCES.map(|decade| Spacing::Tolerance(10_f64.powi(-decade)));
            measurement.series(method, tolerances);
        }
        let steps = (0..=HALVINGS).map(|halving| Spacing::Steps(fewest << halving));
        measurement.series(method, steps);
    }
    let (rows, notes) = (measurement.rows, measurement.notes);
    Ok(WorkPrecision {
        problem: problem.name.clone(),
        duration: bench.scene.duration,
        function: function.map(|f| problem.function_names[f].clone()),
        length: measurement.length,
        floor: reference.difference,
        gradient_floor: reference.gradient_difference,
        reference: reference.description,
        rows,
        notes,
    })
}

/// Whether the explicit method refuses the scene, and the steps of a usual tolerance by the method that
/// suits it.
fn usual(bench: &Bench) -> Result<(bool, usize), IntegrationFailure> {
    let (model, duration) = (&bench.scene.model, bench.scene.duration);
    let steps = |method| {
        let settings = Settings {
            spacing: Spacing::Tolerance(USUAL),
            limits: bench.limits(),
            ..Settings::steps(method, 1)
        };
        simulate(model, duration, &settings).map(|run| run.grid.steps())
    };
    match steps(NON_STIFF) {
        Err(IntegrationFailure::Stiff { .. }) => Ok((true, steps(STIFF)?)),
        found => Ok((false, found?)),
    }
}

/// The number of equal steps that halvings start from: half of those that a usual tolerance needs,
/// and a power of two part of those that the problem asks for, if it does.
fn fewest(problem: &Problem, usual: usize) -> usize {
    let half = (usual / 2).max(FEWEST);
    match problem.simulation.spacing {
        Spacing::Steps(mut steps) => {
            while steps.is_multiple_of(2) && steps >= 2 * half {
                steps /= 2;
            }
            steps
        }
        _ => FEWEST << (half / FEWEST).ilog2(),
    }
}

/// A measurement under way.
struct Measurement<'a> {
    plan: &'a Campaign,
    bench: &'a Bench<'a>,
    reference: &'a Reference,
    length: f64,
    rows: Vec<PrecisionRow>,
    notes: Vec<String>,
    seen: &'a mut dyn FnMut(&PrecisionRow),
}

impl Measurement<'_> {
    /// Adds the rows of one method with one spacing after the other.
    fn series(&mut self, method: Method, spacings: impl Iterator<Item = Spacing>) {
        let begin = cpu_seconds();
        let (mut last, mut best, mut idle) = (0.0, f64::INFINITY, 0);
        let (mut failures, mut warning) = (Vec::new(), None);
        for spacing in spacings {
            let start = cpu_seconds();
            if start - begin + DEARER * last > self.plan.seconds {
                break;
            }
            let found = self
                .bench
                .row((method, &spacing), self.reference, self.plan.runs);
            last = cpu_seconds() - start;
            let row = match found {
                Ok(row) => row,
                Err(failure) => {
                    let stiff = matches!(failure, IntegrationFailure::Stiff { .. });
                    failures.push((describe(&spacing), failure));
                    if stiff {
                        break;
                    }
                    continue;
                }
            };
            if let (Some(step), None) = (row.step, &warning) {
                warning = choice::warning(&self.bench.scene.model, method, step);
            }
            if row.error.is_nan() || row.error > self.length {
                let text = format!("{:.1e} m off at the end", row.error);
                self.notes
                    .push(format!("{}, {}: {text}", method.name(), describe(&spacing)));
                continue;
            }
            let stagnant = row.error < STAGNANT.0 * self.length && row.error > STAGNANT.1 * best;
            idle = if stagnant { idle + 1 } else { 0 };
            best = best.min(row.error);
            (self.seen)(&row);
            self.rows.push(row);
            if idle == 2 {
                break;
            }
        }
        let name = method.name();
        if let Some((first, failure)) = failures.first() {
            let others = match failures.last() {
                Some((last, _)) if last != first => format!(" to {last}"),
                _ => String::new(),
            };
            self.notes
                .push(format!("{name}, {first}{others}: {failure}"));
        }
        self.notes.extend(warning);
    }
}

fn describe(spacing: &Spacing) -> String {
    match spacing {
        Spacing::Steps(steps) => format!("{steps} steps"),
        Spacing::Tolerance(tolerance) => format!("tolerance {tolerance:.0e}"),
        Spacing::Frozen(grid) => format!("{} given steps", grid.steps()),
    }
}
