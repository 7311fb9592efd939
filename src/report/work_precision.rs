//! Error against run time: the rows of a measurement, and their orders of convergence.

use super::csv;
use super::number::significant;
use super::table::render;
use crate::integrate::WorkCounts;

/// Result of one method with one step size or tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionRow {
    /// Name of the method.
    pub method: String,
    /// Its formal order.
    pub order: usize,
    /// Size of its steps if all are equal \[s\].
    pub step: Option<f64>,
    /// Tolerance of its adaptive steps.
    pub tolerance: Option<f64>,
    /// Largest distance of a centre of mass from the reference at the end \[m\].
    pub error: f64,
    /// Largest error of a gradient's component relative to the largest component.
    pub gradient_error: Option<f64>,
    /// Largest |E(t) − E(0)| of kinetic and potential energy \[J\].
    pub energy_drift: f64,
    /// Largest |Φ| \[m or 1\].
    pub position_drift: f64,
    /// Largest |G v| \[m/s or 1/s\].
    pub velocity_drift: f64,
    /// Work of the simulation.
    pub counts: WorkCounts,
    /// CPU time of the simulation \[s\].
    pub cpu_seconds: f64,
    /// CPU time of the backward march \[s\].
    pub gradient_cpu_seconds: Option<f64>,
}

/// A measurement of all methods on a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkPrecision {
    /// Name of the problem.
    pub problem: String,
    /// Length of the motion \[s\].
    pub duration: f64,
    /// Function whose gradient is judged.
    pub function: Option<String>,
    /// Reference of the errors.
    pub reference: String,
    /// Uncertainty of the reference \[m\]; NaN if unknown.
    pub floor: f64,
    /// Relative uncertainty of the reference's gradient; NaN if unknown.
    pub gradient_floor: f64,
    /// Length of the scene \[m\]; rows with a larger error are left out.
    pub length: f64,
    /// Rows by method, from large steps to small ones.
    pub rows: Vec<PrecisionRow>,
    /// Runs that failed or have no row, and warnings.
    pub notes: Vec<String>,
}

/// Order of convergence of a method with equal steps.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodOrder {
    /// Name of the method.
    pub method: String,
    /// Formal order.
    pub formal: usize,
    /// Median of the observed orders of the positions, and the number of halvings behind it.
    pub position: Option<(f64, usize)>,
    /// The same for the gradient.
    pub gradient: Option<(f64, usize)>,
}

const COLUMNS: [&str; 18] = [
    "problem",
    "method",
    "order",
    "step",
    "tolerance",
    "error",
    "gradient_error",
    "energy_drift",
    "position_drift",
    "velocity_drift",
    "steps",
    "newton_iterations",
    "factorisations",
    "solves",
    "cpu_seconds",
    "gradient_cpu_seconds",
    "evaluations",
    "rejected",
];

/// Errors for which the summary gives run times \[m\].
const GOALS: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10];
/// Part of the scene's length, or of the gradient, below which errors decrease by the order of the
/// method.
const ASYMPTOTIC: f64 = 3e-3;
/// An error shows an order if it exceeds round-off and the reference's error by this factor.
const CLEAR: f64 = 10.0;
/// An error is constant if its ratio to the one before is larger.
const IDLE: f64 = 0.7;
/// Part of the asymptotic range in which a constant error is round-off.
const STAGNANT: f64 = 1e-3;
/// Number of the finest halvings whose median is an order.
const HALVINGS: usize = 3;

impl WorkPrecision {
    /// The rows as CSV.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        csv::write_record(&mut text, COLUMNS.into_iter());
        let plain = |x: f64| format!("{x:.6e}");
        let optional = |x: Option<f64>| x.map_or_else(String::new, plain);
        for row in &self.rows {
            let counts = &row.counts;
            let fields = [
                self.problem.clone(),
                row.method.clone(),
                row.order.to_string(),
                optional(row.step),
                optional(row.tolerance),
                plain(row.error),
                optional(row.gradient_error),
                plain(row.energy_drift),
                plain(row.position_drift),
                plain(row.velocity_drift),
                counts.steps.to_string(),
                counts.newton_iterations.to_string(),
                counts.factorisations.to_string(),
                counts.solves.to_string(),
                plain(row.cpu_seconds),
                optional(row.gradient_cpu_seconds),
                counts.evaluations.to_string(),
                counts.rejected.to_string(),
            ];
            csv::write_record(&mut text, fields.iter().map(String::as_str));
        }
        text
    }

    /// Orders of all methods with equal steps: the median over the finest halvings whose errors are
    /// small relative to the scene and above round-off.
    pub fn orders(&self) -> Vec<MethodOrder> {
        let mut names: Vec<&str> = Vec::new();
        for row in self.rows.iter().filter(|row| row.step.is_some()) {
            if !names.contains(&row.method.as_str()) {
                names.push(&row.method);
            }
        }
        let order = |name: &str| {
            let rows: Vec<_> = self
                .rows
                .iter()
                .filter(|row| row.method == name && row.step.is_some())
                .collect();
            let errors = |pick: fn(&PrecisionRow) -> Option<f64>| -> Vec<(f64, f64)> {
                let pair = |row: &&PrecisionRow| Some((row.step?, pick(row)?));
                rows.iter().filter_map(pair).collect()
            };
            MethodOrder {
                method: name.to_owned(),
                formal: rows[0].order,
                position: observed(&errors(|row| Some(row.error)), self.length, self.floor),
                gradient: observed(&errors(|row| row.gradient_error), 1.0, self.gradient_floor),
            }
        };
        names.into_iter().map(order).collect()
    }

    /// The orders as CSV.
    pub fn orders_csv(&self) -> String {
        let mut text = String::new();
        let columns = [
            "problem",
            "method",
            "formal_order",
            "observed_order",
            "halvings",
            "observed_gradient_order",
            "gradient_halvings",
        ];
        csv::write_record(&mut text, columns.into_iter());
        for order in self.orders() {
            let [position, halvings] = cells(order.position);
            let [gradient, gradient_halvings] = cells(order.gradient);
            let fields = [
                self.problem.clone(),
                order.method,
                order.formal.to_string(),
                position,
                halvings,
                gradient,
                gradient_halvings,
            ];
            csv::write_record(&mut text, fields.iter().map(String::as_str));
        }
        text
    }

    /// The text for the user: reference, time to an error by method, orders, notes.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} s, errors at the end against {}\n",
            self.problem,
            significant(self.duration, 6),
            self.reference
        );
        if let Some(function) = &self.function {
            text += &format!("gradient of \"{function}\"\n");
        }
        text += "\nCPU time (ms) of the cheapest run within an error (m)\n";
        let goals: Vec<String> = GOALS.iter().map(|goal| format!(">{goal:.0e}")).collect();
        let mut headings = vec!["method", "steps"];
        headings.extend(goals.iter().map(String::as_str));
        let mut kinds: Vec<(&str, bool)> = Vec::new();
        for row in &self.rows {
            let kind = (row.method.as_str(), row.tolerance.is_some());
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        let line = |&(method, adaptive): &(&str, bool)| -> Vec<String> {
            let steps = if adaptive { "by tolerance" } else { "equal" };
            let own = self.rows.iter().filter(|row| row.method == method);
            let own = own.filter(|row| row.tolerance.is_some() == adaptive);
            let cheapest = |goal: &f64| {
                let good = own.clone().filter(|row| row.error <= *goal);
                let least = good
                    .map(|row| row.cpu_seconds)
                    .fold(f64::INFINITY, f64::min);
                match least.is_finite() {
                    true => significant(1e3 * least, 3),
                    false => "-".into(),
                }
            };
            let mut cells = vec![method.to_owned(), steps.to_owned()];
            cells.extend(GOALS.iter().map(cheapest));
            cells
        };
        text += &render(&headings, &kinds.iter().map(line).collect::<Vec<_>>());
        text += "\norders of convergence with equal steps\n";
        let headings = [
            "method",
            ">formal",
            ">observed",
            ">halvings",
            ">gradient",
            ">halvings",
        ];
        let line = |order: MethodOrder| {
            let [position, halvings] = cells(order.position);
            let [gradient, more] = cells(order.gradient);
            let formal = order.formal.to_string();
            vec![order.method, formal, position, halvings, gradient, more]
        };
        text += &render(
            &headings,
            &self.orders().into_iter().map(line).collect::<Vec<_>>(),
        );
        if !self.notes.is_empty() {
            text += "\nnotes\n";
        }
        for note in &self.notes {
            text += &format!("  {note}\n");
        }
        text
    }
}

fn cells(order: Option<(f64, usize)>) -> [String; 2] {
    match order {
        Some((order, halvings)) => [format!("{order:.2}"), halvings.to_string()],
        None => [String::new(), String::new()],
    }
}

/// Median of log(e_k / e_{k+1}) / log(h_k / h_{k+1}) over the finest halvings whose errors are
/// small relative to `size`, above `floor`, and not constant; the finest one if there are not
/// enough for a median.
fn observed(errors: &[(f64, f64)], size: f64, floor: f64) -> Option<(f64, usize)> {
    let idle = |pair: &[(f64, f64)]| {
        pair[1].1 > IDLE * pair[0].1 && pair[1].1 < STAGNANT * ASYMPTOTIC * size
    };
    let falls = errors.windows(2).position(idle).unwrap_or(errors.len());
    let least = match errors.get(falls) {
        Some((_, error)) => *error,
        None => 0.0,
    };
    // NaN, for an unchecked reference, is no floor.
    let floor = CLEAR * least.max(floor);
    let mut orders: Vec<f64> = errors
        .windows(2)
        .take(falls)
        .filter(|pair| pair[0].1 < ASYMPTOTIC * size && pair[1].1 > floor)
        .map(|pair| (pair[0].1 / pair[1].1).ln() / (pair[0].0 / pair[1].0).ln())
        .collect();
    orders.drain(..orders.len().saturating_sub(HALVINGS));
    let (n, last) = (orders.len(), *orders.last()?);
    orders.sort_by(f64::total_cmp);
    Some((if n < HALVINGS { last } else { orders[n / 2] }, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_leave_out_large_errors_and_round_off() {
        let errors = [0.5, 2e-3, 1.25e-4, 7.8125e-6, 1e-11, 2e-11];
        let pairs: Vec<(f64, f64)> = errors
            .iter()
            .enumerate()
            .map(|(i, &e)| (0.5_f64.powi(i as i32), e))
            .collect();
        let (order, halvings) = observed(&pairs, 1.0, 0.0).expect("some halvings are clear");
        assert_eq!(halvings, 2);
        assert!((order - 4.0).abs() < 1e-12, "{order}");
        assert_eq!(observed(&pairs[4..], 1.0, 0.0), None);
    }
}
