//! One page for a browser: the machine in motion, tables and curves of a result. It needs no network and no other file.

mod stage;

pub use stage::{Arrow, Body, Link, Shape, Stage};

use crate::report::history::Column;
use crate::report::{History, HistoryRow, Optimum};
use serde::Serialize;

const FRAME: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The programs of the page, in their order.
const PROGRAMS: [&str; 4] = [
    include_str!("scene.js"),
    include_str!("chart.js"),
    include_str!("tables.js"),
    include_str!("page.js"),
];

/// What a page shows.
#[derive(Clone, Debug, Serialize)]
pub struct Page<'a> {
    /// Name of the problem.
    pub name: &'a str,
    /// The description in its file.
    pub description: &'a str,
    /// What a terminal shows at the end.
    pub summary: String,
    /// Machines in motion, structures under load, modes.
    pub stages: Vec<Stage>,
    /// Curves.
    pub charts: Vec<Chart>,
    /// The record of an optimum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optimum: Option<&'a Optimum>,
    /// The functions of a simulation.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub functions: Vec<Value>,
    /// The problem of a simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub document: Option<&'a serde_json::Value>,
    /// What the page leaves out.
    pub notes: Vec<String>,
    /// By what and when it was made.
    pub made: String,
    /// Whether the run goes on, so that the browser reads the file again every two seconds.
    #[serde(skip)]
    pub goes_on: bool,
    /// The version of the program.
    pub version: &'static str,
}

/// A function of a simulation.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// The largest value of what it aggregates, if it is an aggregate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_maximum: Option<f64>,
}

/// Curves over one axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Label of the horizontal axis.
    pub across: String,
    /// Label of the vertical axis.
    pub up: String,
    /// Whether the vertical axis is logarithmic.
    pub logarithmic: bool,
    /// Its curves.
    pub curves: Vec<Curve>,
    /// Names and values of limits, drawn across.
    pub limits: Vec<(String, f64)>,
}

/// A curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Points; those that are not finite are left out.
    pub points: Vec<[f64; 2]>,
}

/// Most points of a curve: a wide screen shows no more.
const MOST_POINTS: usize = 600;

impl Curve {
    /// A curve through at most 600 of the points: of each part of the others, the lowest and the highest.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let finite = points
            .into_iter()
            .filter(|p| p.iter().all(|x| x.is_finite()));
        let all: Vec<[f64; 2]> = finite.collect();
        let kept: Vec<[f64; 2]> = match all.len() > MOST_POINTS {
            false => all,
            true => {
                let part = all.len().div_ceil(MOST_POINTS / 2);
                let ends = |part: &[[f64; 2]]| {
                    let order = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
                    let both = [part.iter().min_by(order), part.iter().max_by(order)];
                    let mut both: Vec<[f64; 2]> = both.into_iter().flatten().copied().collect();
                    both.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    both
                };
                all.chunks(part).flat_map(ends).collect()
            }
        };
        Self {
            name: name.into(),
            points: kept.into_iter().map(|p| p.map(rounded)).collect(),
        }
    }
}

/// A number to six digits: pictures show no more.
pub fn rounded(x: f64) -> f64 {
    to_digits(x, 6)
}

/// A place \[m\] to five digits, and zero where only round-off is left.
pub fn place(x: f64) -> f64 {
    match x.abs() < 1e-13 {
        true => 0.0,
        false => to_digits(x, 5),
    }
}

/// A number to so many digits; zero if it is not finite.
fn to_digits(x: f64, count: i32) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 0.0;
    }
    let digits = count - 1 - x.abs().log10().floor() as i32;
    if !(-300..=300).contains(&digits) {
        return x;
    }
    let scale = 10f64.powi(digits.abs());
    match digits >= 0 {
        true => (x * scale).round() / scale,
        false => (x / scale).round() * scale,
    }
}

/// The curves of the convergence of an optimisation.
pub fn convergence(history: &History) -> Vec<Chart> {
    let label = |name: &str, unit: &Option<String>| match unit.as_deref() {
        None | Some("" | "1") => name.to_owned(),
        Some(unit) => format!("{name} [{unit}]"),
    };
    let rows = &history.rows;
    let along = |of: &dyn Fn(&HistoryRow) -> f64| -> Vec<[f64; 2]> {
        rows.iter()
            .map(|row| [row.iteration as f64, of(row)])
            .collect()
    };
    let positive = |points: Vec<[f64; 2]>| points.into_iter().filter(|p| p[1] > 0.0);
    let chart = |title: &str, up: String, logarithmic, curves| Chart {
        title: title.to_owned(),
        across: "iteration".to_owned(),
        up,
        logarithmic,
        curves,
        limits: Vec::new(),
    };
    let mut all = vec![
        chart(
            "Objective",
            label(&history.objective.name, &history.objective.unit),
            false,
            vec![Curve::new(
                &history.objective.name,
                along(&|row| row.objective),
            )],
        ),
        chart(
            "Residuals of the optimality conditions",
            "scaled".to_owned(),
            true,
            vec![
                Curve::new("optimality", positive(along(&|row| row.optimality))),
                Curve::new(
                    "infeasibility, where it is not zero",
                    positive(along(&|row| row.infeasibility)),
                ),
            ],
        ),
    ];
    const MOST_CURVES: usize = 12;
    // Constraints of one unit share an axis.
    let columns = || history.constraints.iter().enumerate().take(MOST_CURVES);
    let mut units: Vec<&str> = Vec::new();
    for (_, column) in columns() {
        let unit = column.unit.as_deref().unwrap_or("");
        if !units.contains(&unit) {
            units.push(unit);
        }
    }
    for unit in units {
        let own = columns().filter(|(_, column)| column.unit.as_deref().unwrap_or("") == unit);
        let curve = |(k, column): (usize, &Column)| {
            let value = |row: &HistoryRow| row.constraints.get(k).copied().unwrap_or(f64::NAN);
            Curve::new(&column.name, along(&value))
        };
        let up = if matches!(unit, "" | "1") {
            String::new()
        } else {
            format!("[{unit}]")
        };
        all.push(chart("Constraints", up, false, own.map(curve).collect()));
    }
    let start = |k: usize| rows.first().and_then(|row| row.design.get(k)).copied();
    let each = history.variables.iter().enumerate().take(MOST_CURVES);
    let curves: Vec<Curve> = each
        .map(|(k, column)| {
            let size = start(k).map_or(1.0, |x| if x == 0.0 { 1.0 } else { x });
            let ratio = |row: &HistoryRow| row.design.get(k).map_or(f64::NAN, |x| x / size);
            Curve::new(&column.name, along(&ratio))
        })
        .collect();
    if !curves.is_empty() {
        all.push(chart("Variables", "value / start".into(), false, curves));
    }
    all
}

/// The page as one HTML file.
///
/// # Errors
/// If a number of the record is not finite.
pub fn html(page: &Page) -> Result<String, serde_json::Error> {
    // No text of a problem may end the element that it stands in.
    let data = serde_json::to_string(page)?.replace('<', "\\u003c");
    let title = page.name.replace('&', "&amp;").replace('<', "&lt;");
    let refresh = match page.goes_on {
        true => "\n<meta http-equiv=\"refresh\" content=\"2\">",
        false => "",
    };
    let parts = [
        ("{{title}}", title),
        ("{{refresh}}", refresh.to_owned()),
        ("{{style}}", STYLE.to_owned()),
        ("{{programs}}", PROGRAMS.concat()),
        ("{{data}}", data),
    ];
    let mut text = FRAME.to_owned();
    for (mark, part) in parts {
        text = text.replacen(mark, &part, 1);
    }
    Ok(text)
}
