//! The text that a person reads at the end of an optimisation.

use super::certificate;
use super::fit_text;
use super::number::{grouped, significant, with_space};
use super::optimum::{
    Activity, Aggregate, BoundSide, Curvature, KktResiduals, Optimum, SecondOrder, Sense,
};
use super::table;

/// Largest number of constraints named in a sentence.
const SHOWN: usize = 3;

/// Status, objective, design, constraints, accuracy and work of an optimisation, as text.
pub fn summary(optimum: &Optimum) -> String {
    let mut text = format!("{}: {}\n\n", optimum.problem.name, optimum.message);
    text.push_str(&objective(optimum));
    text.push('\n');
    text.push_str(&design(optimum));
    if let Some(fit) = &optimum.fit {
        text.push('\n');
        text.push_str(&fit_text::lines(fit, optimum));
    }
    if !optimum.constraints.is_empty() {
        text.push('\n');
        text.push_str(&constraints(optimum));
        text.push_str(&maxima(optimum));
    }
    for (path, found) in &optimum.sensitivities {
        let slope = slope(found.derivative, 6, (&optimum.objective.unit, &found.unit));
        text.push_str(&format!("Sensitivity of the optimum to {path}: {slope}\n"));
    }
    text.push('\n');
    let KktResiduals {
        stationarity,
        feasibility,
        complementarity,
    } = optimum.kkt.scaled;
    text.push_str(&format!(
        "Optimality (scaled): stationarity {}, feasibility {}, complementarity {}\n",
        significant(stationarity, 2),
        significant(feasibility, 2),
        significant(complementarity, 2),
    ));
    if let Some(second) = &optimum.second_order {
        text.push_str(&curvature(second, optimum));
    }
    text.push_str(&work(optimum));
    if let Some(certificate) = &optimum.gradient_certificate {
        text.push_str(&certificate::lines(certificate));
    }
    for warning in &optimum.warnings {
        text.push_str(&format!("Warning: {warning}\n"));
    }
    text
}

fn objective(optimum: &Optimum) -> String {
    let objective = &optimum.objective;
    let verb = match objective.sense {
        Sense::Minimise => "Minimised",
        Sense::Maximise => "Maximised",
    };
    let unit = with_space(objective.unit.as_deref());
    let start = optimum.start_objective;
    let mut text = format!(
        "{verb} {}: {} → {}{unit}",
        objective.function,
        start.map_or_else(|| "not known".to_owned(), |start| significant(start, 8)),
        significant(objective.value, 8),
    );
    if let Some(start) = start.filter(|start| *start != 0.0) {
        let percent = 100.0 * (objective.value - start) / start.abs();
        text.push_str(&format!(" ({percent:+.1} %)"));
    }
    text.push('\n');
    text.push_str(&infeasible_start(optimum));
    if let Some(maximum) = objective.true_maximum {
        text.push_str(&format!(
            "  the true maximum is {}{unit}, the aggregate differs from it by {}{unit}\n",
            significant(maximum, 8),
            significant(objective.value - maximum, 3),
        ));
    }
    if let Some(aggregate) = &objective.aggregate {
        text.push_str(&format!("  {}\n", attained(aggregate, &unit)));
    }
    if let Some(value) = objective.true_value {
        text.push_str(&true_value("", value, objective.value, &unit));
    }
    let of_structures = optimum.problem.document.get("structures").is_some();
    let source = match (is_at_rest(optimum), of_structures) {
        (false, _) => "steps and samples",
        (true, true) => "the mesh",
        (true, false) => "Newton's method",
    };
    if let Some(error) = objective.estimated_error
        && is_rounding(error, objective.value)
    {
        text.push_str(&format!(
            "  the estimated error of {source} is below rounding\n"
        ));
    } else if let Some(error) = objective.estimated_error {
        text.push_str(&format!(
            "  accurate to about {}{unit} (estimated error of {source})\n",
            significant(error, 2),
        ));
    }
    if let Some(integration) = &optimum.integration {
        let refreshed = match integration.refreshes {
            0 => String::new(),
            1 => ", chosen anew once".into(),
            n => format!(", chosen anew {n} times"),
        };
        text.push_str(&format!(
            "  by {} in {} steps{refreshed} ({})\n",
            integration.method, integration.steps, integration.reason
        ));
    }
    text
}

/// Whether an estimated error is at most the last digit of the value.
pub fn is_rounding(error: f64, value: f64) -> bool {
    error <= f64::EPSILON * value.abs()
}

/// The constraints that the start violates, and by how much: its objective is then not comparable.
fn infeasible_start(optimum: &Optimum) -> String {
    let violated = optimum.constraints.iter().filter_map(|(name, constraint)| {
        let start = constraint.start?;
        let below = constraint.lower.map_or(0.0, |lower| lower - start);
        let above = constraint.upper.map_or(0.0, |upper| start - upper);
        // A start on its bound, to the last digits, is feasible.
        let bound = constraint
            .lower
            .filter(|_| below > above)
            .or(constraint.upper);
        let rounding = 1e-12 * bound.unwrap_or(0.0).abs();
        let by = below.max(above);
        (by > rounding).then(|| {
            let unit = with_space(constraint.unit.as_deref());
            format!("\"{name}\" by {}{unit}", significant(by, 3))
        })
    });
    let violated: Vec<String> = violated.collect();
    if violated.is_empty() {
        return String::new();
    }
    let shown = violated.iter().take(SHOWN).cloned().collect::<Vec<_>>();
    let more = match violated.len().saturating_sub(SHOWN) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    format!(
        "  the start was not feasible: it violated {}{more}\n",
        shown.join(", ")
    )
}

fn design(optimum: &Optimum) -> String {
    let rows: Vec<Vec<String>> = optimum
        .design
        .iter()
        .map(|(name, variable)| {
            vec![
                name.clone(),
                significant(variable.start, 6),
                significant(variable.value, 8),
                unit(&variable.unit),
                interval(variable.lower, variable.upper),
                match optimum.active_bounds.get(name) {
                    Some(BoundSide::Lower) => "at its lower bound".to_owned(),
                    Some(BoundSide::Upper) => "at its upper bound".to_owned(),
                    Some(BoundSide::Fixed) => "fixed".to_owned(),
                    None => String::new(),
                },
            ]
        })
        .collect();
    table::render(
        &["variable", ">start", ">optimum", "unit", "bounds", "active"],
        &rows,
    )
}

/// The unit of a table; nothing for numbers without one.
fn unit(unit: &Option<String>) -> String {
    with_space(unit.as_deref()).trim_start().to_owned()
}

fn constraints(optimum: &Optimum) -> String {
    let rows: Vec<Vec<String>> = optimum
        .constraints
        .iter()
        .map(|(name, constraint)| {
            let active = constraint.active != Activity::Inactive;
            vec![
                name.clone(),
                significant(constraint.value, 6),
                unit(&constraint.unit),
                interval(constraint.lower, constraint.upper),
                match constraint.active {
                    _ if constraint.violation().is_some() => "violated",
                    Activity::Inactive => "inactive",
                    Activity::Lower => "at its lower bound",
                    Activity::Upper => "at its upper bound",
                    Activity::Equality => "equality",
                }
                .to_owned(),
                if active {
                    let units = (&optimum.objective.unit, &constraint.unit);
                    slope(constraint.multiplier, 5, units)
                } else {
                    String::new()
                },
                match constraint.estimated_error {
                    None => String::new(),
                    Some(error) if is_rounding(error, constraint.value) => "rounding".to_owned(),
                    Some(error) => significant(error, 2),
                },
            ]
        })
        .collect();
    table::render(
        &[
            "constraint",
            ">value",
            "unit",
            "bounds",
            "active",
            "sensitivity",
            ">est. error",
        ],
        &rows,
    )
}

/// Time or place and accuracy of the largest value, and the effect of a gate on it.
fn attained(aggregate: &Aggregate, unit: &str) -> String {
    let time = aggregate.time;
    let at = time.map(|time| format!("at t = {} s", significant(time, 6)));
    let at = at.or_else(|| aggregate.place.as_ref().map(|place| format!("at {place}")));
    let mut text = format!(
        "({}, to about {}{unit}",
        at.unwrap_or_default(),
        significant(aggregate.error, 2),
    );
    if let Some(ungated) = aggregate.ungated {
        text.push_str(&format!(
            "; with the gate's factor, without it {}{unit}",
            significant(ungated, 8)
        ));
    }
    text + ")"
}

/// The true value of an aggregate that is no maximum.
fn true_value(name: &str, value: f64, aggregate: f64, unit: &str) -> String {
    format!(
        "  {name}the true value is {}{unit}, the aggregate differs from it by {}{unit}\n",
        significant(value, 8),
        significant(aggregate - value, 3),
    )
}

/// What constraints on aggregates mean for the largest values.
fn maxima(optimum: &Optimum) -> String {
    let mut text = String::new();
    for (name, constraint) in &optimum.constraints {
        let unit = with_space(constraint.unit.as_deref());
        if let Some(value) = constraint.true_value {
            let name = format!("{name}: ");
            text.push_str(&true_value(&name, value, constraint.value, &unit));
        }
        let Some(aggregate) = &constraint.aggregate else {
            continue;
        };
        let maximum = aggregate.true_maximum;
        text.push_str(&format!(
            "  {name}: the true maximum is {}{unit}, the aggregate differs from it by {}{unit}\n    {}\n",
            significant(maximum, 8),
            significant(constraint.value - maximum, 3),
            attained(aggregate, &unit),
        ));
        let above = constraint.upper.map(|upper| maximum - upper);
        if let Some(above) = above.filter(|above| *above > aggregate.error) {
            text.push_str(&format!(
                "    the true maximum is above the upper bound by {}{unit}; an aggregate with \
                 \"bound\": \"above\" keeps it below\n",
                significant(above, 3),
            ));
        }
    }
    text
}

/// A derivative with its units; the unit of a number without one is left out.
fn slope(value: f64, digits: usize, (of, by): (&Option<String>, &Option<String>)) -> String {
    let per = match with_space(by.as_deref()) {
        none if none.is_empty() => String::new(),
        unit => format!(" per{unit}"),
    };
    let value = significant(value, digits);
    format!("{value}{}{per}", with_space(of.as_deref()))
}

/// The verdict of the reduced Hessian.
fn curvature(second: &SecondOrder, optimum: &Optimum) -> String {
    let verdict = match second.curvature {
        Curvature::NoFreeDirection => "bounds and constraints leave no free direction",
        Curvature::StrictOptimum => "a strict local optimum",
        Curvature::NoOptimum => "no local optimum: it improves along a free direction",
        Curvature::Flat => "flat within the accuracy of the differences",
        Curvature::NotDecided => {
            "not decided: the curvature is negative only along directions that bounds without force block"
        }
    };
    let mut text = format!("Second order: {verdict}");
    let SecondOrder {
        eigenvalues,
        uncertainty,
        ..
    } = second;
    if let (Some(&least), Some(&most)) = (eigenvalues.first(), eigenvalues.last()) {
        text.push_str(&format!(
            "; curvature {} … {} along {} free {} (± {})",
            significant(least, 3),
            significant(most, 3),
            eigenvalues.len(),
            if eigenvalues.len() == 1 {
                "direction"
            } else {
                "directions"
            },
            significant(*uncertainty, 2),
        ));
    }
    text.push('\n');
    if let Some(descent) = &second.descent {
        let part = |(name, change): (&String, &f64)| {
            let unit = optimum.design.get(name).and_then(|d| d.unit.as_deref());
            format!("{name} {change:+.3e}{}", with_space(unit))
        };
        let parts: Vec<String> = descent.iter().map(part).collect();
        text.push_str(&format!("  it improves along {}\n", parts.join(", ")));
    }
    if !second.weakly_active.is_empty() {
        let names = second.weakly_active.join(", ");
        text.push_str(&format!("  active without force: {names}\n"));
    }
    text
}

/// Whether nothing moves: a structure without time steps.
fn is_at_rest(optimum: &Optimum) -> bool {
    optimum.integration.is_none() && optimum.counts.steps == 0
}

fn work(optimum: &Optimum) -> String {
    let counts = &optimum.counts;
    let failed = match counts.failed_evaluations {
        0 => String::new(),
        n => format!(" ({} failed)", grouped(n)),
    };
    let again = match counts.recomputed_steps {
        0 => String::new(),
        n => format!(" (and {} recomputed for gradients)", grouped(n)),
    };
    let steps = match is_at_rest(optimum) {
        true => String::new(),
        false => format!("{} time steps{again}, ", grouped(counts.steps)),
    };
    format!(
        "Work: {} iterations, {} simulations{failed}, {} gradients\n      {steps}\
         {} Newton iterations, {} factorisations, {} solves\n",
        grouped(counts.iterations),
        grouped(counts.function_evaluations),
        grouped(counts.gradient_evaluations),
        grouped(counts.newton_iterations),
        grouped(counts.factorisations),
        grouped(counts.solves),
    )
}

fn interval(lower: Option<f64>, upper: Option<f64>) -> String {
    let number = |value| significant(value, 6);
    match (lower, upper) {
        (Some(a), Some(b)) if a == b => format!("= {}", number(a)),
        (Some(a), Some(b)) => format!("{} … {}", number(a), number(b)),
        (Some(a), None) => format!("≥ {}", number(a)),
        (None, Some(b)) => format!("≤ {}", number(b)),
        (None, None) => String::new(),
    }
}
