//! The fit of an optimum as text for people.

use super::fit::{Fit, VarianceFrom};
use super::number::{grouped, significant, with_space};
use super::optimum::Optimum;
use super::table;

/// Correlation from which two numbers are named.
const STRONG: f64 = 0.9;

/// Largest number of correlations named.
const SHOWN: usize = 5;

/// Reduced χ² beyond which given standard deviations are doubted.
const DOUBTFUL: [f64; 2] = [0.25, 4.0];

/// The fit of an optimum as text for people.
pub(super) fn lines(fit: &Fit, optimum: &Optimum) -> String {
    let mut text = format!(
        "Fit of {} to {} measured values by least squares\n",
        numbers(fit.standard_deviations.len()),
        grouped(fit.data),
    );
    let scale = match fit.variance {
        VarianceFrom::Given => "standard deviations of the data as given",
        VarianceFrom::Estimated => "standard deviation of the data from the residuals",
    };
    if let Some(reduced) = fit.reduced_chi_square {
        let chi = significant(reduced, 3);
        text.push_str(&format!(
            "  reduced chi square {chi} with {} degrees of freedom; {scale}\n",
            grouped(fit.freedom)
        ));
        if fit.variance == VarianceFrom::Given && !(DOUBTFUL[0]..=DOUBTFUL[1]).contains(&reduced) {
            let so = match reduced > 1.0 {
                true => {
                    "the model misses more than the noise of the data, or their standard deviations are too small"
                }
                false => "the standard deviations of the data are too large",
            };
            text.push_str(&format!("  one is expected: {so}\n"));
        }
    } else {
        text.push_str("  as many numbers as measured values: nothing is known of their errors\n");
    }
    let rows: Vec<Vec<String>> = (fit.standard_deviations.iter())
        .map(|(name, deviation)| {
            let own = optimum.design.get(name);
            let value = own.map_or(f64::NAN, |own| own.value);
            let unit = with_space(own.and_then(|own| own.unit.as_deref()));
            let (deviation, part) = match deviation {
                Some(0.0) => ("held".to_owned(), String::new()),
                Some(deviation) if value != 0.0 => {
                    let percent = significant(100.0 * (deviation / value).abs(), 2);
                    (significant(*deviation, 3), format!("{percent} %"))
                }
                Some(deviation) => (significant(*deviation, 3), String::new()),
                None if fit.reduced_chi_square.is_none() => ("not known".to_owned(), String::new()),
                None => ("not determined".to_owned(), String::new()),
            };
            let unit = unit.trim_start().to_owned();
            vec![name.clone(), significant(value, 8), deviation, part, unit]
        })
        .collect();
    let header = ["number", ">value", ">standard deviation", ">part", "unit"];
    text.push_str(&table::render(&header, &rows));
    for (name, own) in &fit.numbers {
        text.push_str(&format!(
            "  {name}: measured {} ± {}, fitted {}{}\n",
            significant(own.measured, 6),
            significant(own.standard_deviation, 2),
            significant(own.fitted, 6),
            with_space(own.unit.as_deref()),
        ));
    }
    for direction in &fit.undetermined {
        let part = |(name, change): (&String, &f64)| {
            let unit = optimum.design.get(name).and_then(|own| own.unit.as_deref());
            format!("{name} {change:+.3e}{}", with_space(unit))
        };
        let parts: Vec<String> = direction.iter().map(part).collect();
        match &parts[..] {
            [_] => {
                let name = direction.keys().next().map_or("", String::as_str);
                text.push_str(&format!("The data do not determine {name}\n"));
            }
            _ => text.push_str(&format!(
                "The data do not see the change {}\n",
                parts.join(", ")
            )),
        }
    }
    text + &correlations(fit)
}

fn numbers(count: usize) -> String {
    match count {
        1 => "one number".to_owned(),
        n => format!("{n} numbers"),
    }
}

fn correlations(fit: &Fit) -> String {
    let mut strong: Vec<(f64, &String, &String)> = Vec::new();
    for (i, (a, row)) in fit.correlation.iter().enumerate() {
        let others = row.iter().skip(i + 1);
        strong.extend(
            others
                .filter(|(_, r)| r.abs() >= STRONG)
                .map(|(b, r)| (*r, a, b)),
        );
    }
    strong.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let one =
        |(r, a, b): &(f64, &String, &String)| format!("{a} and {b} by {}", significant(*r, 3));
    let shown: Vec<String> = strong.iter().take(SHOWN).map(one).collect();
    match shown.is_empty() {
        true => String::new(),
        false => format!("Strongly correlated: {}\n", shown.join("; ")),
    }
}
