//! Verdicts over pairs of answers to one question, and the table of a family.

use crate::command::{Answer, Estimate};
use std::collections::BTreeMap;

/// How a scene came out.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// All numbers agree.
    Right,
    /// A number is off, and the program says so or refuses.
    Told(String),
    /// A number is off without a word.
    Wrong(String),
    /// The program panicked.
    Broke(String),
}

/// What a family of scenes came to.
#[derive(Default)]
pub struct Tally {
    /// Scenes by verdict, with the number of each scene.
    pub verdicts: Vec<(usize, Verdict)>,
    /// True error by estimated error of every number that is not round-off.
    pub ratios: Vec<f64>,
}

impl Tally {
    /// Row of the table: scenes, right, told, wrong, broken; estimates, below 3, below 10, largest ratio.
    pub fn row(&self, family: &str) -> String {
        let count = |is: fn(&Verdict) -> bool| self.verdicts.iter().filter(|v| is(&v.1)).count();
        let share = |limit: f64| {
            let within = self.ratios.iter().filter(|r| **r <= limit).count();
            format!("{:.1} %", 100.0 * within as f64 / self.ratios.len() as f64)
        };
        let estimates = match self.ratios.is_empty() {
            true => "| | | |".to_owned(),
            false => {
                let largest = self.ratios.iter().fold(0.0, |a: f64, b| a.max(*b));
                format!(
                    "| {} | {} | {} | {largest:.1} |",
                    self.ratios.len(),
                    share(3.0),
                    share(10.0)
                )
            }
        };
        format!(
            "| {family} | {} | {} | {} | {} | {} {estimates}",
            self.verdicts.len(),
            count(|v| *v == Verdict::Right),
            count(|v| matches!(v, Verdict::Told(_))),
            count(|v| matches!(v, Verdict::Wrong(_))),
            count(|v| matches!(v, Verdict::Broke(_))),
        )
    }
}

/// The size against which round-off of a number is judged: that of the function's value or of its
/// largest derivative, and a part of the largest number of a scene, as a force that is zero by
/// symmetry is a difference of others.
pub fn sizes(table: &BTreeMap<String, Estimate>) -> BTreeMap<String, f64> {
    const OF_LARGEST: f64 = 1e-3;
    let mut sizes: BTreeMap<String, f64> = BTreeMap::new();
    for (name, number) in table {
        let group = group(name);
        let size = sizes.entry(group).or_insert(0.0);
        *size = size.max(number.value.abs());
    }
    let values = OF_LARGEST * largest_value(table);
    let all = sizes.values().fold(0.0, |a: f64, b| a.max(*b));
    for (name, size) in &mut sizes {
        let floor = match name.ends_with('/') {
            true => OF_LARGEST * all,
            false => values,
        };
        *size = size.max(floor);
    }
    sizes
}

/// The largest value of a function.
pub fn largest_value(table: &BTreeMap<String, Estimate>) -> f64 {
    let values = table.iter().filter(|(name, _)| !name.contains(" / "));
    values.fold(0.0, |a: f64, (_, number)| a.max(number.value.abs()))
}

/// The numbers that share a size: a value, or all derivatives of one function.
pub fn group(name: &str) -> String {
    match name.split_once(" / ") {
        Some((function, _)) => format!("{function} /"),
        None => name.to_owned(),
    }
}

/// Holds two answers to one question against each other. `factor` is by how much the second's number is
/// multiplied; numbers agree within ten times their estimated errors and `relative` of their group's size.
pub fn agreement(
    one: &Answer,
    other: &Answer,
    factor: impl Fn(&str) -> f64,
    relative: f64,
) -> Verdict {
    let (table, warned) = match (one, other) {
        (Answer::Broke(why), _) | (_, Answer::Broke(why)) => return Verdict::Broke(why.clone()),
        (Answer::Refused(_), Answer::Refused(why)) => return Verdict::Told(why.clone()),
        (Answer::Refused(why), _) | (_, Answer::Refused(why)) => {
            return Verdict::Told(format!("one of two: {why}"));
        }
        (Answer::Numbers { table, warned }, Answer::Numbers { warned: also, .. }) => {
            (table, *warned || *also)
        }
    };
    let Answer::Numbers { table: seen, .. } = other else {
        return Verdict::Right;
    };
    let sizes = sizes(table);
    let mut worst: Option<(f64, String)> = None;
    for (name, right) in table {
        let Some(number) = seen.get(name) else {
            return Verdict::Wrong(format!("{name} is missing"));
        };
        let factor = factor(name);
        let (value, error) = (number.value / factor, (number.error / factor).abs());
        let bound = 10.0 * (right.error + error) + relative * (sizes[&group(name)] + 1e-6);
        let difference = (value - right.value).abs();
        let excess = difference / bound;
        if difference.is_nan() || excess > worst.as_ref().map_or(1.0, |w| w.0) {
            let words = format!(
                "{name}: {:e} and {value:e}, errors {:.1e} and {error:.1e}",
                right.value, right.error
            );
            worst = Some((
                if excess.is_nan() {
                    f64::INFINITY
                } else {
                    excess
                },
                words,
            ));
        }
    }
    match worst {
        None => Verdict::Right,
        Some((_, words)) if warned => Verdict::Told(words),
        Some((_, words)) => Verdict::Wrong(words),
    }
}

/// True errors by estimated errors, of numbers whose error is above round-off.
pub fn ratios(truth: &Answer, claimed: &Answer, round_off: f64) -> Vec<(String, f64)> {
    let (Answer::Numbers { table: truth, .. }, Answer::Numbers { table, .. }) = (truth, claimed)
    else {
        return Vec::new();
    };
    let sizes = sizes(truth);
    let of = |(name, right): (&String, &Estimate)| {
        let number = table.get(name)?;
        let floor = round_off * (sizes[&group(name)] + 1e-6);
        let error = (number.value - right.value).abs();
        (error.max(number.error) > floor).then(|| (name.clone(), error / number.error.max(floor)))
    };
    truth.iter().filter_map(of).collect()
}
