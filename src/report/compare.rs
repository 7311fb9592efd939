//! An optimum against a baseline: what moved beyond tolerance.

use super::number::significant;
use super::optimum::{DesignValue, Optimum};
use super::table;
use indexmap::IndexMap;

/// How far each kind of number may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Objective, start objective and true maximum: relative to the baseline's magnitude or, if that
    /// is larger, to 1e-6 of the objective at the start. Default 1e-6: an optimum is flat, so the
    /// objective is as exact as the stopping tolerance, and a square that vanishes as its square.
    pub objective: f64,
    /// Design variables: relative to the width between the bounds, or, where a bound is missing,
    /// to the larger magnitude of the baseline's value and start. Default 1e-4: along a flat
    /// direction a variable is only as exact as the square root of the objective.
    pub design: f64,
    /// Constraint values: relative to the largest magnitude of value, start and bounds. Default 1e-5. What
    /// the optimiser may violate by default, 1e-6 or 1e-4 of this magnitude, passes as well.
    pub constraint: f64,
    /// Sensitivities of constraints and multipliers of bounds: relative to their magnitude, at least
    /// the objective by the size of the constraint or by the range of the variable, or what convergence
    /// leaves. Default 1e-3: they are first derivatives at an approximate optimum.
    pub multiplier: f64,
    /// Counts of work, relative. A smaller count is only a remark; small counts may move by two.
    /// Default 0.25: another machine rounds differently.
    pub work: f64,
    /// Whether a different problem is a difference or only a warning. Default false.
    pub same_problem: bool,
}

impl Default for Tolerances {
    fn default() -> Tolerances {
        Tolerances {
            objective: 1e-6,
            design: 1e-4,
            constraint: 1e-5,
            multiplier: 1e-3,
            work: 0.25,
            same_problem: false,
        }
    }
}

/// What a row of a comparison means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within tolerance.
    Same,
    /// Worth knowing, not a failure.
    Warning,
    /// Beyond tolerance: the comparison fails.
    Moved,
}

/// One quantity of two records.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Kind of quantity: `design`, `constraint`, `work`, ...
    pub kind: &'static str,
    /// Name of the quantity.
    pub name: String,
    /// New value, or `missing`.
    pub new: String,
    /// Value of the baseline, or `missing`.
    pub baseline: String,
    /// Difference and its tolerance in the same measure, for numbers.
    pub moved: Option<(f64, f64)>,
    /// What it means.
    pub verdict: Verdict,
}

/// All quantities of two records, side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Rows in the order of the record.
    pub rows: Vec<Row>,
}

/// Compares a new optimum with a baseline.
///
/// Compared are status, problem, gradient certificate, objective, design, constraints, units, bounds, active
/// bounds, their multipliers, sensitivities and work; a variable or constraint that only one of them has is
/// a difference. Runs that did not converge have no optimum that could be the same. A number that is not finite
/// never agrees.
pub fn compare(new: &Optimum, baseline: &Optimum, tolerances: &Tolerances) -> Comparison {
    let mut rows = Vec::new();
    let mut status = text_row("status", "", &new.status, &baseline.status);
    if [new, baseline].iter().any(|own| own.status != CONVERGED) {
        status.verdict = Verdict::Moved;
    }
    rows.push(status);
    let mut problem = text_row(
        "problem",
        "sha256",
        &new.problem.sha256,
        &baseline.problem.sha256,
    );
    if problem.verdict == Verdict::Moved && !tolerances.same_problem {
        problem.verdict = Verdict::Warning;
    }
    rows.push(problem);
    rows.push(certificate_row(new, baseline));
    objective_rows(&mut rows, new, baseline, tolerances);
    for (name, pair) in pairs(&new.design, &baseline.design) {
        let row = match pair {
            (Some(a), Some(b)) => {
                rows.extend(unit_row(name, &a.unit, &b.unit));
                bounds_rows(&mut rows, name, [a.lower, b.lower], [a.upper, b.upper]);
                let unit = design_unit(b);
                number_row("design", name, a.value, b.value, unit, tolerances.design)
            }
            (a, b) => lone_row("design", name, a.map(|v| v.value), b.map(|v| v.value)),
        };
        rows.push(row);
    }
    for (name, pair) in pairs(&new.constraints, &baseline.constraints) {
        let (Some(a), Some(b)) = pair else {
            let value = |v: Option<&super::optimum::ConstraintValue>| v.map(|v| v.value);
            rows.push(lone_row("constraint", name, value(pair.0), value(pair.1)));
            continue;
        };
        rows.extend(unit_row(name, &a.unit, &b.unit));
        bounds_rows(&mut rows, name, [a.lower, b.lower], [a.upper, b.upper]);
        let others = [b.lower, b.upper].into_iter().flatten();
        let first = b.start.unwrap_or(1.0).abs().max(b.value.abs());
        let size = others.fold(first, |size, bound| size.max(bound.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        let allowed = VIOLATION.min(PART_OF_ROW * size);
        let tolerance = tolerances.constraint;
        let unit = size.max(allowed / tolerance);
        rows.push(number_row(
            "constraint",
            name,
            a.value,
            b.value,
            unit,
            tolerance,
        ));
        let (word_a, word_b) = (format!("{:?}", a.active), format!("{:?}", b.active));
        rows.push(text_row(
            "active",
            name,
            &word_a.to_lowercase(),
            &word_b.to_lowercase(),
        ));
        let slope = baseline
            .scaling
            .constraints
            .get(name)
            .map(|row| row.gradient);
        let size = (b.multiplier.abs())
            .max(objective_unit(baseline) / size)
            .max(rest_of_force(baseline, slope));
        let tolerance = tolerances.multiplier;
        rows.push(number_row(
            "sensitivity",
            name,
            a.multiplier,
            b.multiplier,
            size,
            tolerance,
        ));
    }
    for (name, (a, b)) in pairs(&new.active_bounds, &baseline.active_bounds) {
        let word = |side: Option<&super::optimum::BoundSide>| match side {
            Some(side) => format!("{side:?}").to_lowercase(),
            None => "inactive".to_owned(),
        };
        rows.push(text_row("active", name, &word(a), &word(b)));
    }
    let sides = [
        (
            "lower bound",
            &new.multipliers.lower_bounds,
            &baseline.multipliers.lower_bounds,
        ),
        (
            "upper bound",
            &new.multipliers.upper_bounds,
            &baseline.multipliers.upper_bounds,
        ),
    ];
    for (side, a, b) in sides {
        for (name, variable) in &baseline.design {
            // A variable that only one of the records has is a difference already.
            let (Some(&a), Some(&b)) = (a.get(name), b.get(name)) else {
                continue;
            };
            let length = baseline.scaling.variables.get(name).copied();
            let size = (b.abs())
                .max(objective_unit(baseline) / design_unit(variable))
                .max(rest_of_force(baseline, length));
            let name = format!("{side} of {name}");
            rows.push(number_row(
                "multiplier",
                &name,
                a,
                b,
                size,
                tolerances.multiplier,
            ));
        }
    }
    for ((name, a), (_, b)) in new.counts.named().into_iter().zip(baseline.counts.named()) {
        rows.push(work_row(name, a, b, tolerances.work));
    }
    Comparison { rows }
}

impl Comparison {
    /// Whether all quantities agree within tolerance; warnings do not count.
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.verdict != Verdict::Moved)
    }

    /// The verdict in a sentence, and a table of the differences and warnings.
    pub fn text(&self) -> String {
        let count = |verdict| {
            self.rows
                .iter()
                .filter(|row| row.verdict == verdict)
                .count()
        };
        let (moved, warnings) = (count(Verdict::Moved), count(Verdict::Warning));
        let unfinished = self.rows.iter().find(|row| {
            row.kind == "status" && (row.new != CONVERGED || row.baseline != CONVERGED)
        });
        let mut text = if let Some(row) = unfinished {
            format!(
                "no two optima: the new run ended as {}, the baseline as {}; {moved} of {} quantities moved",
                row.new,
                row.baseline,
                self.rows.len()
            )
        } else if moved == 0 {
            format!(
                "same optimum: {} quantities within tolerance",
                count(Verdict::Same)
            )
        } else {
            format!(
                "different optimum: {moved} of {} quantities moved",
                self.rows.len()
            )
        };
        if warnings > 0 {
            text.push_str(&format!(", {warnings} to be noted"));
        }
        text.push('\n');
        if moved + warnings == 0 {
            return text;
        }
        let cells = |row: &Row| {
            let (difference, tolerance) = match row.moved {
                Some((difference, tolerance)) => {
                    (significant(difference, 2), significant(tolerance, 2))
                }
                None => (String::new(), String::new()),
            };
            vec![
                match row.verdict {
                    Verdict::Moved => "moved".to_owned(),
                    _ => "note".to_owned(),
                },
                row.kind.to_owned(),
                row.name.clone(),
                row.new.clone(),
                row.baseline.clone(),
                difference,
                tolerance,
            ]
        };
        let shown = self.rows.iter().filter(|row| row.verdict != Verdict::Same);
        let headings = [
            "",
            "kind",
            "name",
            ">new",
            ">baseline",
            ">difference",
            ">tolerance",
        ];
        text + &table::render(&headings, &shown.map(cells).collect::<Vec<_>>())
    }
}

fn objective_rows(rows: &mut Vec<Row>, new: &Optimum, baseline: &Optimum, tolerances: &Tolerances) {
    let (a, b) = (&new.objective, &baseline.objective);
    rows.push(text_row("objective", "function", &a.function, &b.function));
    let word = |sense| format!("{sense:?}").to_lowercase();
    rows.push(text_row(
        "objective",
        "sense",
        &word(a.sense),
        &word(b.sense),
    ));
    let tolerance = tolerances.objective;
    let least = objective_unit(baseline);
    let number = |name: &str, a: f64, b: f64| {
        number_row("objective", name, a, b, b.abs().max(least), tolerance)
    };
    rows.extend(unit_row(&b.function, &a.unit, &b.unit));
    rows.push(number("value", a.value, b.value));
    match (new.start_objective, baseline.start_objective) {
        (Some(a), Some(b)) => {
            let mut row = number("at the start", a, b);
            // The same optimum may be found from another start.
            if row.verdict == Verdict::Moved && !starts_alike(new, baseline) {
                row.verdict = Verdict::Warning;
            }
            rows.push(row);
        }
        (None, None) => {}
        (a, b) => rows.push(lone_row("objective", "at the start", a, b)),
    }
    match (a.true_maximum, b.true_maximum) {
        (Some(a), Some(b)) => rows.push(number("true maximum", a, b)),
        (None, None) => {}
        (a, b) => rows.push(lone_row("objective", "true maximum", a, b)),
    }
}

/// Whether both runs started from the same design.
fn starts_alike(new: &Optimum, baseline: &Optimum) -> bool {
    let pairs =
        (baseline.design.iter()).filter_map(|(name, own)| Some((new.design.get(name)?, own)));
    pairs
        .into_iter()
        .all(|(new, own)| (new.start - own.start).abs() <= SAME_BOUND * design_unit(own))
}

/// Status of a run that found an optimum.
const CONVERGED: &str = "converged";
/// Part of the objective at the start below which a value counts as zero.
const OF_START: f64 = 1e-6;
/// What the optimiser may violate by default: in the constraint's unit, and relative to its size.
const VIOLATION: f64 = 1e-6;
const PART_OF_ROW: f64 = 1e-4;
/// Bounds are the same up to this relative difference.
const SAME_BOUND: f64 = 1e-12;

/// Size of an objective that may vanish at the optimum.
fn objective_unit(optimum: &Optimum) -> f64 {
    let start = optimum.start_objective.map_or(0.0, f64::abs);
    let value = optimum.objective.value.abs();
    value.max(OF_START * start).max(f64::MIN_POSITIVE)
}

/// Part of the gradient at the start up to which multipliers are what convergence leaves, relative to their
/// tolerance: a thousandth of a thousandth.
const REST: f64 = 1e-3;

/// Size of such a rest for a bound or row, by the length of its variable or by its own slope.
fn rest_of_force(optimum: &Optimum, by: Option<f64>) -> f64 {
    let rest = REST * optimum.scaling.objective.gradient;
    by.filter(|by| *by > 0.0).map_or(0.0, |by| rest / by)
}

/// Whether the gradients were confirmed. A record without a certificate is only noted.
fn certificate_row(new: &Optimum, baseline: &Optimum) -> Row {
    let word = |own: &Optimum| match own.gradient_certificate.as_ref().map(|c| c.passed) {
        Some(true) => "confirmed",
        Some(false) => "not confirmed",
        None => "none",
    };
    let (a, b) = (word(new), word(baseline));
    let mut row = text_row("gradients", "certificate", a, b);
    row.verdict = match [a, b] {
        [a, b] if a == "not confirmed" || b == "not confirmed" => Verdict::Moved,
        [a, b] if a == b => Verdict::Same,
        _ => Verdict::Warning,
    };
    row
}

/// Units, if one of the two has one.
fn unit_row(name: &str, new: &Option<String>, baseline: &Option<String>) -> Option<Row> {
    let text = |unit: &Option<String>| unit.clone().unwrap_or_default();
    (new.is_some() || baseline.is_some())
        .then(|| text_row("unit", name, &text(new), &text(baseline)))
}

/// Bounds that at least one of the two has, each pair as [new, baseline].
fn bounds_rows(rows: &mut Vec<Row>, name: &str, lower: [Option<f64>; 2], upper: [Option<f64>; 2]) {
    for (kind, pair) in [("lower bound", lower), ("upper bound", upper)] {
        rows.extend(match pair {
            [None, None] => None,
            [Some(a), Some(b)] => {
                let unit = b.abs().max(f64::MIN_POSITIVE);
                Some(number_row(kind, name, a, b, unit, SAME_BOUND))
            }
            [a, b] => Some(lone_row(kind, name, a, b)),
        });
    }
}

/// Unit of a design variable's change: the width between its bounds, or its magnitude.
fn design_unit(variable: &DesignValue) -> f64 {
    match (variable.lower, variable.upper) {
        (Some(lower), Some(upper)) if upper > lower => upper - lower,
        _ => variable.value.abs().max(variable.start.abs()).max(1e-12),
    }
}

fn text_row(kind: &'static str, name: &str, new: &str, baseline: &str) -> Row {
    Row {
        kind,
        name: name.to_owned(),
        new: shortened(new),
        baseline: shortened(baseline),
        moved: None,
        verdict: if new == baseline {
            Verdict::Same
        } else {
            Verdict::Moved
        },
    }
}

/// The first digits of a hash, enough to see a difference.
fn shortened(text: &str) -> String {
    if text.chars().count() > 24 {
        text.chars().take(12).collect::<String>() + "…"
    } else {
        text.to_owned()
    }
}

fn number_row(
    kind: &'static str,
    name: &str,
    new: f64,
    baseline: f64,
    unit: f64,
    tolerance: f64,
) -> Row {
    let difference = (new - baseline).abs() / unit;
    Row {
        kind,
        name: name.to_owned(),
        new: significant(new, 10),
        baseline: significant(baseline, 10),
        moved: Some((difference, tolerance)),
        // A NaN is within no tolerance.
        verdict: if difference <= tolerance {
            Verdict::Same
        } else {
            Verdict::Moved
        },
    }
}

fn lone_row(kind: &'static str, name: &str, new: Option<f64>, baseline: Option<f64>) -> Row {
    let text = |value: Option<f64>| match value {
        Some(value) => significant(value, 10),
        None => "missing".to_owned(),
    };
    Row {
        kind,
        name: name.to_owned(),
        new: text(new),
        baseline: text(baseline),
        moved: None,
        verdict: Verdict::Moved,
    }
}

fn work_row(name: &str, new: u64, baseline: u64, tolerance: f64) -> Row {
    let difference = new.abs_diff(baseline) as f64 / baseline.max(1) as f64;
    let verdict = if new.abs_diff(baseline) <= 2 || difference <= tolerance {
        Verdict::Same
    } else if new < baseline {
        Verdict::Warning
    } else {
        Verdict::Moved
    };
    Row {
        kind: "work",
        name: name.to_owned(),
        new: new.to_string(),
        baseline: baseline.to_string(),
        moved: Some((difference, tolerance)),
        verdict,
    }
}

type Pair<'a, T> = (Option<&'a T>, Option<&'a T>);

/// Entries of both maps by name, in the order of the first, then those of the second only.
fn pairs<'a, T>(
    first: &'a IndexMap<String, T>,
    second: &'a IndexMap<String, T>,
) -> Vec<(&'a str, Pair<'a, T>)> {
    let mut all: Vec<(&str, Pair<T>)> = first
        .iter()
        .map(|(name, value)| (name.as_str(), (Some(value), second.get(name))))
        .collect();
    for (name, value) in second {
        if !first.contains_key(name) {
            all.push((name, (None, Some(value))));
        }
    }
    all
}
