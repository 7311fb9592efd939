//! Error against run time for all methods, orders and step sizes or tolerances.
//!
//! Errors are those of the centres of mass at the end, relative to a run with a tight tolerance or
//! to a file. Times are CPU times of stepping, and of the backward march: the least of several runs
//! after one that does not count (as in Rackauckas & Nie 2017, *DifferentialEquations.jl*). The
//! runs of a method end when they become too expensive for its share of time, or when its error no
//! longer decreases.

mod bench;
pub mod clock;
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

/// Settings of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// CPU time of the runs of one method with equal or with adaptive steps \[s\].
    pub seconds: f64,
    /// Largest number of halvings of the equal step of one method.
    pub halvings: u32,
    /// Number of runs of which the fastest counts.
    pub runs: usize,
    /// Index of the function whose gradient is measured.
    pub function: Option<usize>,
    /// Name of a file and its final positions by body \[m\], instead of those of a run.
    pub reference: Option<(String, Positions)>,
}

/// Decades of the tolerances.
const TOLERANCES: std::ops::RangeInclusive<i32> = 3..=12;
/// Number of halvings of the equal step where the time alone is to bound it.
pub const HALVINGS: u32 = 22;
/// Smallest number of steps.
const FEWEST: usize = 10;
/// Equal steps start at half the number of steps with this tolerance.
const USUAL: f64 = 1e-6;
/// Below this part of the scene's length, a constant error is round-off; and the ratio of errors
/// above which an error is constant.
const STAGNANT: (f64, f64) = (1e-6, 0.7);
/// Approximate ratio of the costs of consecutive runs of a method.
const DEARER: f64 = 2.0;

/// All methods, adaptive ones first.
pub fn methods() -> Vec<Method> {
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

/// Measures all methods on `problem` at the design `x`. Calls `seen` for every row.
///
/// # Errors
/// No reference run reaches the end. A method that fails is noted and omitted.
pub fn work_precision(
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
        let steps = (0..=plan.halvings).map(|halving| Spacing::Steps(fewest << halving));
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

/// Whether the explicit method rejects the scene; and the number of steps with the usual tolerance
/// by the method that suits it.
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

/// The number of equal steps before halving: half of those with the usual tolerance, or the number
/// in the problem divided by a power of two.
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

/// A measurement in progress.
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
    /// Adds the rows of one method with consecutive spacings.
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
