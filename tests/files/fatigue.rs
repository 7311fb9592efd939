//! Damage of a quantity over time: closed forms, families, and rainflow counting.

use crate::reference::documents::{problem, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::TAU;

const SLOPE: f64 = 5.0;

/// A mass that a drive moves by sines (amplitude, frequency) along an axis; its displacement does damage.
fn shaken(size: f64, axis: [f64; 3], sines: &[[f64; 2]], damage: &Value) -> Value {
    let mut bodies = json!({});
    let (mut joints, mut drives) = (json!({}), json!({}));
    let mut below = "ground".to_owned();
    for (k, [amplitude, frequency]) in sines.iter().enumerate() {
        let name = format!("body {k}");
        bodies[&name] = json!({"shape": {"sphere": {"radius": 0.1 * size}}, "mass": 1, "place": {"at": [0, 0, 0]}});
        joints[&name] =
            json!({"prismatic": {"between": [name, below], "at": [0, 0, 0], "axis": axis}});
        drives[&name] = json!({"joint": name, "slide": {"harmonic":
            {"mean": 0, "amplitude": amplitude * size, "frequency": frequency, "phase": 0}}});
        below = name;
    }
    let of = json!({"position": {"body": below, "direction": axis}});
    let mut own = json!({"slope": SLOPE, "strength": 0.3 * size, "of": of});
    for (key, value) in damage.as_object().expect("entries") {
        own[key] = value.clone();
    }
    json!({
        "version": 1, "name": "shaken", "bodies": bodies, "joints": joints, "drives": drives,
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {"damage": {"fatigue_damage": own}, "history": {"final": of}},
        "variables": {"amplitude": {"path": "/drives/body 0/slide/harmonic/amplitude", "lower": 0.01 * size, "upper": size}}
    })
}

fn damage(document: &Value) -> f64 {
    values(document)[0]
}

/// n whole cycles of amplitude a do n (a/s)^m, wherever they begin; by D = n a^m, D changes by m D/a.
#[test]
fn cycles_of_one_amplitude_have_a_closed_form() {
    let whole = json!({});
    for (size, axis, during, cycles) in [
        (1.0, [1.0, 0.0, 0.0], whole.clone(), 6.0),
        (1e3, [0.0, -0.6, 0.8], whole, 6.0),
        (1.0, [0.0, 1.0, 0.0], json!({"during": [0.31, 1.31]}), 3.0),
        (1e-3, [-1.0, 0.0, 0.0], json!({"during": [0.25, 1.25]}), 3.0),
        (1.0, [0.0, 1.0, 0.0], json!({"during": {"from": 0.5}}), 4.5),
    ] {
        let document = shaken(size, axis, &[[0.2, 3.0]], &during);
        let exact = cycles * (2.0_f64 / 3.0).powf(SLOPE);
        let found = damage(&document);
        assert!(
            (found / exact - 1.0).abs() < 2e-4,
            "{size} {during}: {found} {exact}"
        );
        gradients_are_exact(&problem(&document), &document);
    }
}

/// Rainflow counting of turning points (Downing & Socie 1982), half cycles of the rest.
fn rainflow(turning: &[f64], strength: f64) -> f64 {
    let mut stack: Vec<f64> = Vec::new();
    let mut damage = 0.0;
    let one = |range: f64| (0.5 * range / strength).powf(SLOPE);
    for &x in turning {
        stack.push(x);
        while stack.len() >= 3 {
            let n = stack.len();
            let (last, before) = (
                (stack[n - 1] - stack[n - 2]).abs(),
                (stack[n - 2] - stack[n - 3]).abs(),
            );
            if last < before {
                break;
            }
            if n == 3 {
                damage += 0.5 * one(before);
                stack.remove(0);
            } else {
                damage += one(before);
                stack.drain(n - 3..n - 1);
            }
        }
    }
    damage
        + stack
            .windows(2)
            .map(|two| 0.5 * one((two[1] - two[0]).abs()))
            .sum::<f64>()
}

/// Beats about zero: not less than rainflow counting, and less than twice that.
#[test]
fn irregular_cycles_are_bounded_below_by_rainflow_counting() {
    let sines = [[0.15, 3.0], [0.1, 7.0]];
    let count = 200_000;
    let at = |k: usize| {
        let t = 2.0 * k as f64 / count as f64;
        sines
            .iter()
            .map(|[a, f]| a * (TAU * f * t).sin())
            .sum::<f64>()
    };
    let history: Vec<f64> = (0..=count).map(at).collect();
    let inner = history
        .windows(3)
        .filter(|x| (x[1] - x[0]) * (x[2] - x[1]) < 0.0)
        .map(|x| x[1]);
    let ends = [history[0], history[count]];
    let turning: Vec<f64> = { [ends[0]] }
        .into_iter()
        .chain(inner)
        .chain([ends[1]])
        .collect();
    let exact = turning.windows(2).map(|two| {
        let power = |x: f64| x.signum() * (x.abs() / 0.3).powf(SLOPE);
        0.25 * (power(two[1]) - power(two[0])).abs()
    });
    let exact: f64 = exact.sum();
    let document = shaken(1.0, [1.0, 0.0, 0.0], &sines, &json!({}));
    let found = damage(&document);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    let counted = rainflow(&turning, 0.3);
    assert!(
        found >= counted * (1.0 - 1e-3) && found < 2.0 * counted,
        "{found} {counted}"
    );
    gradients_are_exact(&problem(&document), &document);
}

/// A slope below two, a strength of zero, and one as a design variable are faults with their place.
#[test]
fn faults_have_their_place() {
    let document = shaken(1.0, [1.0, 0.0, 0.0], &[[0.2, 3.0]], &json!({}));
    for (key, value, expected) in [("slope", 1.0, "2"), ("strength", 0.0, "0")] {
        let mut wrong = document.clone();
        wrong["functions"]["damage"]["fatigue_damage"][key] = json!(value);
        let faults = Problem::parse(&wrong.to_string(), "fatigue.json", &[]).expect_err("a fault");
        let path = format!("/functions/damage/fatigue_damage/{key}");
        assert!(
            faults.list[0].path == path && faults.list[0].expected.contains(expected),
            "{faults}"
        );
    }
    let mut wrong = document;
    wrong["variables"]["slope"] =
        json!({"path": "/functions/damage/fatigue_damage/slope", "lower": 2, "upper": 9});
    let faults = Problem::parse(&wrong.to_string(), "fatigue.json", &[]).expect_err("a fault");
    assert!(
        faults.to_string().contains("says what is asked"),
        "{faults}"
    );
}
