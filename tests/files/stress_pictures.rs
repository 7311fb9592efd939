//! Stresses of beams in figures and fields are those of the functions; limits, looks of curves, and positions of points.

use crate::reference::documents::problem as parsed;
use flexbody_driver::Simulation;
use flexbody_driver::simulate;
use flexbody_figures::elastic_figures::{limits, stresses};
use flexbody_figures::of_simulation;
use flexbody_figures::plots::{History, Limit, histories};
use flexbody_figures::shell_fields;
use flexbody_figures::traces::positions;
use flexbody_mechanics::functions::Function;
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::Path;

/// A soft maximum of n values is below the maximum by ln(n)/rho at most; n is here below a thousand.
const RHO: f64 = 1.0;
const SLACK: f64 = 7.0 / RHO;

fn moved(problem: &Problem) -> Simulation {
    simulate(problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"))
}

/// A function of a motion at every sample.
fn sampled(problem: &Problem, motion: &Simulation, name: &str) -> Vec<f64> {
    let found = problem.function_names.iter().position(|own| own == name);
    match &motion.written.functions[found.expect("a function")] {
        Function::Reduced { of, .. } => of.sample(&motion.written.model, motion.motion()),
        other => panic!("{other:?}"),
    }
}

fn largest(body: &str, rest: Value) -> Value {
    let mut of = json!({"body": body, "stations": 25, "sign": "both", "rho": RHO});
    for (key, value) in rest.as_object().expect("an object") {
        of[key] = value.clone();
    }
    json!({"ks": {"rho": RHO, "of": {"largest_fibre_stress": of}}})
}

/// The start of the four-bar, whose bars bend out of the plane that is drawn.
fn four_bar() -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/flexible/four_bar.json");
    let text = std::fs::read_to_string(file).expect("the file is there");
    let mut document: Value = serde_json::from_str(&text).expect("is valid");
    document["simulation"] = json!({"duration": 1, "steps": 100, "method": {"bdf": {"order": 2}}});
    for body in ["AB", "BC", "CD"] {
        document["functions"][format!("all of {body}")] = largest(body, json!({}));
    }
    document["plot"]["trace"] = json!(["BC.middle", "BC.start", "CD.end"]);
    document["functions"]["middle"] = json!({"final": {"position": {"body": "BC", "point": "middle",
        "direction": [0, 0, 1]}}});
    parsed(&document)
}

/// The drawn history is the function of the same sections, at every sample.
#[test]
fn drawn_stresses_of_beams_are_those_of_the_function() {
    let problem = four_bar();
    let motion = moved(&problem);
    let drawn = stresses(
        "",
        (&motion.written.model, motion.motion()),
        &problem.drawing(&problem.start()),
    );
    assert_eq!(drawn.curves.len(), 3);
    for (name, values) in &drawn.curves {
        let expected = sampled(&problem, &motion, &format!("all of {name}"));
        assert_eq!(values.len(), expected.len());
        for (drawn, expected) in values.iter().zip(&expected) {
            assert!(
                (drawn - expected).abs() <= SLACK,
                "{name}: {drawn} {expected}"
            );
        }
        // Fewer sections cannot have a larger stress.
        let few = sampled(&problem, &motion, &format!("stress {name}"));
        let peak = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
        assert!(
            peak(values) > 1e6 && peak(&few) <= peak(values) + SLACK,
            "{name}"
        );
    }
}

/// Constraints with one value have one line, which names all of their bodies.
#[test]
fn equal_limits_are_one_line() {
    let problem = four_bar();
    let motion = moved(&problem);
    let found = limits(&problem, &motion);
    let of = ["AB", "BC", "CD"].map(|body| format!("{body} (\"stress {body}\")"));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].value, &found[0].of[..]), (648e6, &of[..]));
    let figures = of_simulation(&problem, &motion);
    let text = |wanted: &str| {
        let found = figures.iter().find(|(name, _)| *name == wanted);
        String::from_utf8(found.expect("is drawn").1.clone()).expect("text")
    };
    assert!(text("stress.svg").contains("limit of 6.48e8 Pa:"));
    for name in ["BC.middle", "BC.start", "CD.end", "x [m]", "y [m]", "z [m]"] {
        assert!(text("trace.svg").contains(name), "{name}");
    }
}

/// The positions are those of the deformed bodies.
#[test]
fn positions_are_those_of_the_function() {
    let problem = four_bar();
    let motion = moved(&problem);
    let [_, _, z] = positions("", &motion, &problem.drawing(&problem.start()));
    let expected = sampled(&problem, &motion, "middle");
    assert_eq!(z.curves[0].0, "BC.middle");
    let peak = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    assert!(peak > 1e-5, "{peak}");
    for (drawn, expected) in z.curves[0].1.iter().zip(&expected) {
        assert!(
            (drawn - expected).abs() <= 1e-6 * peak,
            "{drawn} {expected}"
        );
    }
}

/// A cantilever of beams of elements that falls.
fn cantilever() -> Value {
    json!({
        "version": 1, "name": "cantilever", "gravity": [0, 0, -9.81],
        "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
        "bodies": {"strip": {
            "elements": {
                "structure": {
                    "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 1, 0],
                        "elements": 8}},
                    "material": "aluminium", "section": {"rectangle": {"width": 0.25, "height": 0.005}}
                },
                "frame": {"clamped": "start"},
                "points": {"root": {"node": "start"}, "tip": {"node": "end"}}
            },
            "place": {"put": "root", "at": [0, 0, 0]}
        }},
        "joints": {"root": {"weld": {"between": ["strip", "ground"], "at": "strip.root"}}},
        "simulation": {"duration": 0.12, "steps": 60, "method": {"bdf": {"order": 2}}},
        "functions": {"all": largest("strip", json!({"beams": "all", "stations": 9}))},
        "plot": {"view": "xz", "trace": ["strip.tip"]}
    })
}

/// Beams of elements have all figures, and their fields the stress of the function.
#[test]
fn beams_of_elements_have_their_stresses() {
    let problem = parsed(&cantilever());
    let motion = moved(&problem);
    let figures = of_simulation(&problem, &motion);
    let names: Vec<&str> = figures.iter().map(|(name, _)| *name).collect();
    let expected = [
        "motion.svg",
        "energy.svg",
        "deflection.svg",
        "trace.svg",
        "stress.svg",
    ];
    assert_eq!(names, expected);
    let text = |k: usize| std::str::from_utf8(&figures[k].1).expect("text");
    assert!(text(0).contains("strip: stress from"));
    assert!(text(2).contains("strip: tip along z"));
    let drawn = stresses(
        "",
        (&motion.written.model, motion.motion()),
        &problem.drawing(&problem.start()),
    );
    let expected = sampled(&problem, &motion, "all");
    for (drawn, expected) in drawn.curves[0].1.iter().zip(&expected) {
        assert!((drawn - expected).abs() <= SLACK, "{drawn} {expected}");
    }
    let last = *expected.last().expect("samples");
    assert!(last > 1e6, "{last}");
    let files = shell_fields::series(Path::new("out"), &problem, &motion);
    let field = String::from_utf8(files[files.len() - 2].1.clone()).expect("text");
    let (_, field) = field
        .split_once("Name=\"largest stress along fibres [Pa]\"")
        .expect("the field");
    let values: Vec<f64> = (field.lines().skip(1).take(8))
        .map(|line| line.parse().expect("a number"))
        .collect();
    assert!(values.iter().all(|value| *value > 0.0), "{values:?}");
    let peak = values.iter().copied().fold(0.0, f64::max);
    assert!((peak - last).abs() <= SLACK, "{peak} {last}");
}

/// More curves than colours differ by their dashes, and limits are drawn across the panel.
#[test]
fn curves_of_one_colour_have_other_dashes() {
    let draw = |count: usize, limits: Vec<Limit>| {
        let curve = |k: usize| (format!("curve {k}"), vec![0.0, k as f64]);
        let design = History {
            title: String::new(),
            time: vec![0.0, 1.0],
            curves: (0..count).map(curve).collect(),
            limits,
            marks: Vec::new(),
        };
        histories(&[("y [m]", vec![design])]).expect("is drawn")
    };
    let blue = |svg: &str| svg.matches("stroke=\"#0072B2\"").count();
    assert_eq!(blue(&draw(7, Vec::new())), 2);
    // The eighth is blue too: many dashes.
    assert!(blue(&draw(8, Vec::new())) > 20);
    let limit = |value: f64, of: &str| Limit {
        value,
        unit: "m",
        of: vec![of.to_string()],
    };
    let svg = draw(1, vec![limit(2.0, "one"), limit(3.0, "other")]);
    for text in ["limit of 2 m:", "limit of 3 m:", "one", "other"] {
        assert!(svg.contains(text), "{text}");
    }
}
