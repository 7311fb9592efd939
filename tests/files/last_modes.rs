//! The highest modes of small structures, and errors where frequencies are double.

use crate::reference::documents::problem;
use flexbody_driver::check;
use flexbody_driver::statics::{StaticDesign, error};
use serde_json::Value;

/// A beam of one element of 2 m, and its frequency of this mode.
fn beam(width: f64, height: f64, young: f64, length: f64, free: bool, mode: usize) -> Value {
    let mut file = json!({
        "version": 1, "name": "beam",
        "materials": {"m": {"young": young, "poisson": 0.3, "density": 7800}},
        "structures": {"p": {
            "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [length, 0, 0], "orientation": [0, 1, 0], "elements": 1}},
            "material": "m", "section": {"rectangle": {"width": width, "height": height}},
            "supports": {"a": {"nodes": ["start"]}}}},
        "load_cases": {"c": {"p": {"point": {"nodes": "end", "force": [0, 0, 1]}}}},
        "functions": {"f": {"frequency": {"mode": mode}}}
    });
    if free {
        file["structures"]["p"]["supports"] = json!({});
        file["load_cases"] = json!({});
    }
    file
}

fn found(file: &Value) -> Result<StaticDesign, String> {
    let problem = problem(file);
    let statics = problem.statics.as_ref().expect("structures");
    StaticDesign::of(&problem, statics, &[], Some(&[0])).map_err(|failure| failure.to_string())
}

fn frequency(file: &Value) -> f64 {
    found(file).expect("modes").function(0).value
}

/// As many modes as unknowns: the last one too, in order. All go with √E, and with 1/s if the beam grows by s in all
/// directions.
#[test]
fn the_last_mode_is_found() {
    for (width, height, free, count) in [
        (0.05, 0.05, false, 12),
        (0.05, 0.08, false, 12),
        (0.3, 0.1, false, 12),
    ] {
        let of = |mode, young: f64, s: f64| {
            frequency(&beam(s * width, s * height, young, s * 2.0, free, mode))
        };
        let all: Vec<f64> = (1..=count).map(|mode| of(mode, 2e11, 1.0)).collect();
        assert!(
            all.windows(2).all(|pair| pair[0] <= pair[1] * (1.0 + 1e-9)),
            "{all:?}"
        );
        for mode in [count - 1, count] {
            let f = all[mode - 1];
            assert!(
                (of(mode, 8e11, 1.0) / (2.0 * f) - 1.0).abs() < 1e-9,
                "{mode}"
            );
            assert!((of(mode, 2e11, 3.0) * 3.0 / f - 1.0).abs() < 1e-9, "{mode}");
        }
        let refused = found(&beam(width, height, 2e11, 2.0, free, count + 1)).err();
        let told = format!(
            "{} modes are requested, and the structure has {count}",
            count + 1
        );
        assert_eq!(refused, Some(told));
    }
}

/// Its derivative is that by the complex step, and f/E/2 by the modulus.
#[test]
fn the_last_mode_has_a_derivative() {
    for (width, height) in [(0.05, 0.08), (0.2, 0.03), (0.1, 0.11)] {
        let mut file = beam(width, height, 2e11, 2.0, false, 12);
        file["variables"] = json!({
            "E": {"path": "/materials/m/young", "lower": 1e11, "upper": 4e11},
            "height": {"path": "/structures/p/section/rectangle/height", "lower": 0.01, "upper": 0.5}});
        let problem = problem(&file);
        let f = frequency(&beam(width, height, 2e11, 2.0, false, 12));
        let all = check(&problem, &problem.start()).expect("a solution");
        for d in &all {
            assert!(d.is_round_off() || d.relative_difference() < 1e-10, "{d:?}");
        }
        assert!(
            (all[0].adjoint * 2.0 * 2e11 / f - 1.0).abs() < 1e-9,
            "{all:?}"
        );
    }
}

/// Where two frequencies are equal there is no derivative; the message counts modes as files do. Their errors are
/// known all the same.
#[test]
fn double_frequencies_have_errors_and_are_named_as_in_the_file() {
    for mode in [1, 2] {
        let file = beam(0.05, 0.05, 2e11, 2.0, false, mode);
        let plain = problem(&file);
        let at = found(&file).expect("modes");
        let found = error::estimate(&plain, &at, &[0], true).expect("an estimate");
        assert!(
            found[0].value.error.is_finite() && found[0].gradient.is_empty(),
            "{mode}"
        );
        let mut designed = file.clone();
        designed["variables"] =
            json!({"E": {"path": "/materials/m/young", "lower": 1e11, "upper": 4e11}});
        let problem = problem(&designed);
        let failure = check(&problem, &problem.start()).expect_err("no derivative");
        let told = format!("frequency {mode} has no derivative");
        assert!(failure.to_string().starts_with(&told), "{failure}");
    }
}
