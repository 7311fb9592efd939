//! `optimize work-precision`, as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// A bar on a hinge, released from the horizontal.
const PENDULUM: &str = r#"{
    "version": 1, "name": "pendulum", "gravity": [0, -9.81, 0],
    "bodies": {"bar": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 2,
                       "points": {"end": [-0.5, 0, 0]}, "place": {"put": "end", "at": [0, 0, 0]}}},
    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0],
                                      "axis": [0, 0, 1]}}},
    "simulation": {"duration": 2},
    "functions": {
        "width": {"final": {"position": {"body": "bar", "direction": [1, 0, 0]}}},
        "height": {"final": {"position": {"body": "bar", "direction": [0, 1, 0]}}}
    },
    "variables": {"gravity": {"path": "/gravity/1", "lower": -20, "upper": -1},
                  "depth": {"path": "/bodies/bar/shape/box/size/1", "lower": 0.05, "upper": 0.3}}
}"#;

fn measure(directory: &Path, problem: &str, arguments: &[&str]) -> Output {
    std::fs::write(directory.join("pendulum.json"), problem).expect("is written");
    Command::new(env!("CARGO_BIN_EXE_optimize"))
        .args(["work-precision", "pendulum.json"])
        .args(arguments)
        .current_dir(directory)
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("is text")
}

/// The records of a CSV file by columns.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("a file");
        let mut rows = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect());
        Self {
            header: rows.next().expect("a header"),
            rows: rows.collect(),
        }
    }

    fn cell<'a>(&self, row: &'a [String], column: &str) -> &'a str {
        let at = self
            .header
            .iter()
            .position(|name| name == column)
            .expect("a column");
        &row[at]
    }

    fn number(&self, row: &[String], column: &str) -> f64 {
        let cell = self.cell(row, column);
        cell.parse()
            .unwrap_or_else(|_| panic!("{column}: {cell:?}"))
    }
}

const METHODS: [&str; 11] = [
    "dop853",
    "radau2",
    "radau3",
    "bdf1",
    "bdf2",
    "bdf3",
    "bdf4",
    "bdf5",
    "bdf6",
    "bdf5 with rising order",
    "generalised-alpha 0.8",
];

#[test]
fn all_methods_are_measured_with_their_orders() {
    let directory = tempfile::tempdir().expect("a directory");
    let done = measure(
        directory.path(),
        PENDULUM,
        &[
            "--function",
            "height",
            "--seconds",
            "100",
            "--halvings",
            "8",
            "--runs",
            "1",
        ],
    );
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("orders of convergence"));
    let results = directory.path().join("results/work-precision/pendulum");
    let table = Table::read(&results.join("work_precision.csv"));
    assert_eq!(
        table.header[..16].join(","),
        "problem,method,order,step,tolerance,error,gradient_error,energy_drift,position_drift,\
         velocity_drift,steps,newton_iterations,factorisations,solves,cpu_seconds,\
         gradient_cpu_seconds"
    );
    for method in METHODS {
        let own = |row: &&Vec<String>| table.cell(row, "method") == method;
        let rows: Vec<_> = table.rows.iter().filter(own).collect();
        let (equal, chosen): (Vec<&Vec<String>>, Vec<&Vec<String>>) = rows
            .iter()
            .copied()
            .partition(|row| table.cell(row, "tolerance").is_empty());
        assert!(equal.len() >= 4, "{method}: {} rows", equal.len());
        assert_eq!(
            chosen.is_empty(),
            !["dop853", "radau2", "radau3"].contains(&method)
        );
        for row in &rows {
            for column in ["steps", "factorisations", "solves", "cpu_seconds"] {
                assert!(table.number(row, column) > 0.0, "{method}: {column}");
            }
            let newton = table.number(row, "newton_iterations");
            assert_eq!(newton == 0.0, method == "dop853", "{method}");
            assert!(table.number(row, "gradient_cpu_seconds") > 0.0, "{method}");
            for drift in ["energy_drift", "position_drift", "velocity_drift"] {
                assert!(table.number(row, drift) >= 0.0, "{method}: {drift}");
            }
        }
        for pair in equal.windows(2) {
            let (coarse, fine) = (pair[0], pair[1]);
            let steps = [coarse, fine].map(|row| table.number(row, "steps"));
            assert_eq!(steps[1], 2.0 * steps[0], "{method}");
            for column in ["error", "gradient_error"] {
                let errors = [coarse, fine].map(|row| table.number(row, column));
                let clear = errors[0] < 1e-2 && errors[0] > 1e-9;
                assert!(
                    !clear || errors[1] < errors[0],
                    "{method}: {column} {errors:?}"
                );
            }
        }
        let (first, last) = (equal[0], equal[equal.len() - 1]);
        let gradients = [first, last].map(|row| table.number(row, "gradient_error"));
        // With large steps, a method of low order may be accurate by chance.
        if method != "bdf1" {
            assert!(gradients[1] < 0.2 * gradients[0], "{method}: {gradients:?}");
        }
    }
    let orders = Table::read(&results.join("orders.csv"));
    for row in &orders.rows {
        let formal = orders.number(row, "formal_order");
        let method = orders.cell(row, "method");
        if method == "bdf1" {
            // With so few steps its errors stay large.
            continue;
        }
        let observed = orders.number(row, "observed_order");
        match method {
            "dop853" => assert!(observed >= 7.0, "{method}: {observed}"),
            "bdf2" | "radau2" | "generalised-alpha 0.8" | "bdf5 with rising order" => {
                assert!((observed - formal).abs() <= 0.3, "{method}: {observed}");
                let gradient = orders.number(row, "observed_gradient_order");
                assert!(
                    (gradient - formal).abs() <= 0.3,
                    "{method}: gradient {gradient}"
                );
            }
            _ => {}
        }
    }
    assert_eq!(orders.rows.len(), METHODS.len());
    let figure = std::fs::read_to_string(results.join("work_precision.svg")).expect("a figure");
    for part in [
        "positions at the end",
        "gradient of",
        "generalised-alpha 0.8",
        "radau3",
    ] {
        assert!(figure.contains(part), "{part}");
    }
}

/// A table of positions can be the reference. Without variables there is no gradient.
#[test]
fn a_file_can_be_the_reference() {
    let directory = tempfile::tempdir().expect("a directory");
    let (head, _) = PENDULUM
        .split_once(",\n    \"variables\"")
        .expect("variables");
    let problem = format!("{head}\n}}");
    let table = directory.path().join("positions.csv");
    // The hinge, half a metre from the centre of mass.
    std::fs::write(&table, "time,body,x,y,z\n1,bar,0,0,0\n2,bar,0,0,0\n").expect("is written");
    let arguments = "--reference positions.csv --output found --quiet --seconds 0.1 --runs 1";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let done = measure(directory.path(), &problem, &arguments);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(
        done.stdout.is_empty() && done.stderr.is_empty(),
        "{}",
        text(&done.stderr)
    );
    let table = Table::read(&directory.path().join("found/work_precision.csv"));
    for row in &table.rows {
        // The centre of mass stays half a metre from the hinge.
        let error = table.number(row, "error");
        assert!((error - 0.5).abs() < 0.05, "{error}");
        assert_eq!(table.cell(row, "gradient_error"), "");
        assert_eq!(table.cell(row, "gradient_cpu_seconds"), "");
    }
    let summary = std::fs::read_to_string(directory.path().join("found/summary.txt"));
    assert!(
        summary
            .expect("a summary")
            .contains("against positions.csv")
    );
}

#[test]
fn bad_input_is_refused_with_the_reason() {
    let directory = tempfile::tempdir().expect("a directory");
    let short = directory.path().join("short.csv");
    std::fs::write(&short, "time,body,x,y,z\n1,bar,0,0,0\n").expect("is written");
    for (arguments, part) in [
        (["--function", "depth"], "width, height"),
        (["--reference", "none.csv"], "cannot read none.csv"),
        (
            ["--reference", "short.csv"],
            "short.csv:2: found rows up to 1 s",
        ),
        (["--seconds", "0"], "positive"),
        (["--runs", "0"], "1..=1000"),
        (["--error", "--quiet"], "found --error"),
    ] {
        let done = measure(directory.path(), PENDULUM, &arguments);
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
    assert!(!directory.path().join("results").exists());
}

/// The gradient of an expression is that of the functions that it names; a machine at rest has no steps.
#[test]
fn expressions_are_measured_and_machines_at_rest_refused() {
    let directory = tempfile::tempdir().expect("a directory");
    let with = |from: &str, to: &str| PENDULUM.replace(from, to);
    let expression = with(
        r#""height": {"#,
        r#""sum": {"expression": "width + 2*height"}, "height": {"#,
    );
    let arguments = ["--function", "sum", "--halvings", "2", "--runs", "1"];
    let out = measure(directory.path(), &expression, &arguments);
    assert!(out.status.success(), "{}", text(&out.stderr));
    let place = "results/work-precision/pendulum/work_precision.csv";
    let table = Table::read(&directory.path().join(place));
    let errors = table
        .rows
        .iter()
        .map(|row| table.cell(row, "gradient_error"));
    assert!(errors.clone().count() > 4 && errors.clone().any(|own| !own.is_empty()));
    let rest = with(r#""simulation": {"duration": 2}"#, r#""analysis": "rest""#);
    let out = measure(directory.path(), &rest, &[]);
    assert_eq!(out.status.code(), Some(2));
    assert!(
        text(&out.stderr).contains("machine at rest"),
        "{}",
        text(&out.stderr)
    );
}
