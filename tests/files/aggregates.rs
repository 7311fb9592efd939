//! Aggregates choose ρ where a file leaves it out: near what they stand for, or near a limit, in any unit.

use crate::reference::documents::run;
use flexbody_driver::aggregates::{self, Unread};
use flexbody_driver::{Simulated, check};
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::cell::Cell;

/// The problem, how often the document was read, and what was chosen.
type Chosen = (Problem, usize, Vec<(String, f64)>);

fn read(document: &Value) -> Result<Chosen, Unread> {
    let text = document.to_string();
    let count = Cell::new(0);
    let once = |overrides: &[Override]| {
        count.set(count.get() + 1);
        Problem::parse(&text, "aggregates.json", overrides)
    };
    let mut all = Vec::new();
    let problem = aggregates::read(&once, &[], &mut |chosen| {
        all.push((chosen.name.clone(), chosen.rho.as_f64().expect("a number")));
    })?;
    Ok((problem, count.get(), all))
}

/// A swinging bar of this size, in a gravity that keeps its period.
fn pendulum(size: f64, functions: &Value) -> Value {
    json!({
        "version": 1, "name": "pendulum", "gravity": [0, -9.81 * size, 0],
        "bodies": {"bar": {"shape": {"rod": {"length": size, "radius": 0.02 * size}}, "mass": 2,
            "points": {"pin": [-0.4 * size, 0, 0], "end": [0.5 * size, 0, 0]},
            "place": {"put": "pin", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": -0.5}}}},
        "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}}},
        "simulation": {"duration": 3, "tolerance": 1e-9},
        "functions": functions,
        "variables": {"mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 3},
                      "angle": {"path": "/bodies/bar/place/turn/angle", "lower": -1.5, "upper": 0}}
    })
}

fn speed() -> Value {
    json!({"speed": {"body": "bar", "point": "end"}})
}

/// Of both bounds of the maximum, of a window and of a smooth mean: within 1 % of the maximum, and not nearer than a third of that.
#[test]
fn aggregates_are_near_what_they_stand_for() {
    let functions = json!({
        "below": {"ks": {"of": speed()}},
        "above": {"ks": {"of": speed(), "bound": "above"}},
        "mean": {"induced_exponential": {"of": speed()}},
        "early": {"ks": {"of": speed(), "during": [0, 0.3]}},
        "least": {"ks": {"of": {"position": {"body": "bar", "point": "end", "direction": [0, -1, 0]}}, "bound": "above"}},
        "given": {"ks": {"rho": 7, "of": speed()}}
    });
    let mut former: Option<Vec<(String, f64)>> = None;
    for size in [1e-3, 1.0, 1e4] {
        let (problem, reads, chosen) = read(&pendulum(size, &functions)).expect("chosen");
        assert_eq!((reads, chosen.len()), (3, 5));
        let at = Simulated::of(&problem, &problem.start()).expect("runs");
        for (f, name) in problem.function_names.iter().enumerate() {
            let smoothed = at.smoothed(f).expect("an aggregate");
            if name == "given" {
                continue;
            }
            let part = (at.value(f) / smoothed.value - 1.0).abs();
            assert!(
                smoothed.far.is_none() && part < 0.01,
                "{name} {size}: {part}"
            );
            assert!(
                part > 0.003 || name == "above" || name == "least",
                "{name} {size}: {part}"
            );
        }
        // In other units ρ is in the unit of the quantity.
        for (i, (name, rho)) in chosen.iter().enumerate() {
            let expected = former.as_ref().map_or(rho * size, |former| former[i].1);
            assert!(
                (rho * size / expected - 1.0).abs() < 0.06,
                "{name} {size}: {rho}"
            );
        }
        former = former.or(Some(
            chosen
                .iter()
                .map(|(name, rho)| (name.clone(), rho * size))
                .collect(),
        ));
        for derivative in check(&problem, &problem.start()).expect("runs") {
            let exact = derivative.relative_difference() < 1e-11;
            assert!(exact || derivative.differs_by_round_off(), "{derivative:?}");
        }
    }
}

/// A file that gives each ρ is read once and nothing is chosen; the chosen ρ in its place gives the same problem.
#[test]
fn a_given_parameter_is_kept() {
    let open = pendulum(1.0, &json!({"peak": {"ks": {"of": speed()}}}));
    let (problem, _, chosen) = read(&open).expect("chosen");
    let mut closed = open.clone();
    closed["functions"]["peak"]["ks"]["rho"] = json!(chosen[0].1);
    let (same, reads, chosen) = read(&closed).expect("no faults");
    assert_eq!((reads, chosen.len()), (1, 0));
    assert_eq!(
        (&same.hash, &same.document),
        (&problem.hash, &problem.document)
    );
}

/// A limit is what the aggregate shall be near to, where the start is far from it.
#[test]
fn a_limit_gives_the_size() {
    let mut document = pendulum(1.0, &json!({"peak": {"ks": {"of": speed()}}}));
    let (_, _, free) = read(&document).expect("chosen");
    document["constraints"] = json!({"slow": {"function": "peak", "upper": 30}, "fast": {"function": "peak", "lower": 25}});
    let (problem, _, limited) = read(&document).expect("chosen");
    let at = Simulated::of(&problem, &problem.start()).expect("runs");
    let value = at.smoothed(0).expect("an aggregate").value;
    let expected = free[0].1 * value / 25.0;
    assert!(
        (limited[0].1 / expected - 1.0).abs() < 0.1,
        "{limited:?} {expected}"
    );
}

/// Where a function has another ρ, over time or over points, it is one function of both.
#[test]
fn one_parameter_is_for_time_and_points() {
    let beam = |over_time: Value, over_sections: Value| {
        let mut sections =
            json!({"body": "beam", "component": "bending_z", "sign": "both", "stations": 5});
        let mut ks = json!({});
        if over_sections.is_number() {
            sections["rho"] = over_sections;
        }
        if over_time.is_number() {
            ks["rho"] = over_time;
        }
        ks["of"] = json!({"largest_section_force": sections});
        json!({
            "version": 1, "name": "beam", "gravity": [0, -9.81, 0],
            "bodies": {"beam": {"beam": {"length": 1,
                "material": {"young": 7e10, "poisson": 0.3, "density": 2700},
                "section": {"rectangle": {"height": 0.01, "width": 0.02}},
                "modes": {"bending_y": 1, "bending_z": 0, "torsion": 0}}, "place": {"put": "start", "at": [0, 0, 0]}}},
            "joints": {"root": {"revolute": {"between": ["beam", "ground"], "at": "beam.start", "axis": [0, 0, 1]}}},
            "simulation": {"duration": 0.2, "tolerance": 1e-7},
            "functions": {"moment": {"ks": ks}},
            "variables": {"width": {"path": "/bodies/beam/beam/section/rectangle/width", "lower": 0.01, "upper": 0.1}}
        })
    };
    let rhos = |document: &Value| {
        let (problem, reads, chosen) = read(document).expect("chosen");
        let ks = &problem.document["functions"]["moment"]["ks"];
        let own = [&ks["rho"], &ks["of"]["largest_section_force"]["rho"]];
        (
            own.map(|rho| rho.as_f64().expect("a number")),
            reads,
            chosen,
        )
    };
    let (own, reads, chosen) = rhos(&beam(json!(3), Value::Null));
    assert_eq!((own, reads, chosen.len()), ([3.0, 3.0], 2, 1));
    assert_eq!(rhos(&beam(Value::Null, json!(4))).0, [4.0, 4.0]);
    let open = beam(Value::Null, Value::Null);
    let (own, _, chosen) = rhos(&open);
    assert_eq!((own[0], own[0], chosen.len()), (own[1], chosen[0].1, 1));
    let (problem, _, _) = read(&open).expect("chosen");
    let at = Simulated::of(&problem, &problem.start()).expect("runs");
    assert!(at.smoothed(0).expect("an aggregate").far.is_none());
}

/// Stresses and lowest frequencies of structures.
#[test]
fn structures_choose_too() {
    let mut document: Value =
        serde_json::from_str(include_str!("../../problems/plate_stress.json")).expect("a document");
    let functions = document["functions"].as_object_mut().expect("functions");
    let stress = functions
        .values_mut()
        .find(|own| own.get("von_mises").is_some())
        .expect("a stress");
    stress["von_mises"]
        .as_object_mut()
        .expect("entries")
        .shift_remove("rho");
    functions.insert("lowest".into(), json!({"lowest_frequency": {}}));
    let (problem, reads, chosen) = read(&document).expect("chosen");
    assert_eq!((reads, chosen.len()), (3, 2));
    let at = Simulated::of(&problem, &problem.start()).expect("runs");
    let f = problem
        .function_names
        .iter()
        .position(|name| name == "lowest")
        .expect("a function");
    let smoothed = at.smoothed(f).expect("an aggregate");
    assert!(
        smoothed.far.is_none() && at.value(f) <= smoothed.value,
        "{smoothed:?}"
    );
    let rho = chosen
        .iter()
        .find(|(name, _)| name == "lowest")
        .expect("chosen")
        .1;
    assert!((100.0..110.0).contains(&(rho * smoothed.value)), "{rho}");
}

/// Where none can be chosen, this is told with the place.
#[test]
fn what_cannot_be_chosen_is_told() {
    let still = json!({"still": {"ks": {"of": {"position": {"body": "bar", "point": "end", "direction": [0, 0, 1]}}}}});
    let error = read(&pendulum(1.0, &still)).expect_err("zero").to_string();
    assert!(
        error.starts_with("/functions/still/ks: found no \"rho\"") && error.contains("zero"),
        "{error}"
    );
    let mut document = pendulum(1.0, &json!({"peak": {"ks": {"of": speed()}}}));
    document["bodies"]["bar"]["place"]["turn"]["angle"] = json!("= 0/0");
    assert!(matches!(read(&document), Err(Unread::Faults(_))));
    let section =
        json!({"largest_section_force": {"body": "bar", "component": "bending_z", "stations": 3}});
    let mut document = pendulum(1.0, &json!({"peak": {"ks": {"rho": 3, "of": speed()}}}));
    document["simulation"]["until"] = json!({"measure": section, "value": 1});
    let error = read(&document).expect_err("a fault").to_string();
    assert!(error.contains("rho"), "{error}");
}

/// A sharp aggregate of a wave sees all of its equal peaks, also those between the ends of steps: closed forms of narrow peaks.
#[test]
fn sharp_aggregates_see_every_peak() {
    let (rho, duration): (f64, f64) = (1e5, 2.0);
    let sliders = |frequency: f64| {
        json!({
            "version": 1, "name": "sliders", "gravity": [0, 0, 0],
            "bodies": {
                "wave": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2},
                "ramp": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1, "place": {"at": [0, 5, 0]}}
            },
            "joints": {
                "wave": {"prismatic": {"between": ["wave", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}},
                "ramp": {"prismatic": {"between": ["ramp", "ground"], "at": [0, 5, 0], "axis": [1, 0, 0]}}
            },
            "drives": {
                "wave": {"joint": "wave", "slide": {"harmonic": {"amplitude": 1, "frequency": frequency, "phase": 0.3, "mean": 0.3}}},
                "ramp": {"joint": "ramp", "slide": {"polynomial": [0, 0]}}
            },
            "simulation": {"duration": duration, "tolerance": 1e-9},
            "functions": {"peak": {"ks": {"rho": rho, "of": {"sum": [
                {"position": {"body": "wave", "direction": [1, 0, 0]}}, {"position": {"body": "ramp", "direction": [1, 0, 0]}}
            ]}}}},
            "variables": {"slope": {"path": "/drives/ramp/slide/polynomial/1", "lower": -1, "upper": 1}}
        })
    };
    for frequency in [1.0, 2.0] {
        let (problem, ..) = read(&sliders(frequency)).expect("a problem");
        let x = problem.start();
        let found = Simulated::of(&problem, &x).expect("a motion").value(0);
        let omega = 2.0 * std::f64::consts::PI * frequency;
        let count = frequency * duration;
        // The mean of e^(ρ (x − 1.3)) over peaks 1.3 − ω² t² / 2.
        let width = (2.0 * std::f64::consts::PI / (rho * omega * omega)).sqrt();
        let expected = 1.3 + (count * width / duration).ln() / rho;
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        let first = (0.5 * std::f64::consts::PI - 0.3) / omega;
        let mean = first + 0.5 * (count - 1.0) / frequency;
        let slope = check(&problem, &x).expect("derivatives")[0].adjoint;
        assert!((slope - mean).abs() < 1e-3, "{slope} {mean}");
    }
}

/// ∫ v² / x over a motion through x = 0 has no value, and no samples find it. Beyond the pole it is ln 2.
#[test]
fn an_integral_across_a_pole_is_told() {
    let quotient = json!({"quotient": [
        {"speed_squared": {"body": "b"}},
        {"position": {"body": "b", "direction": [1, 0, 0]}}
    ]});
    let mut file = json!({
        "version": 1, "name": "pole", "gravity": [0, 0, 0],
        "bodies": {"b": {
            "mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1},
            "place": {"at": [-1, 0, 0]}, "velocity": {"linear": [1, 0, 0]}}},
        "simulation": {"duration": 3},
        "functions": {"across": {"integral": quotient.clone()}}
    });
    let warning = run(&file).warning.expect("a warning");
    assert!(warning.contains("\"across\" by"), "{warning}");
    file["bodies"]["b"]["place"]["at"] = json!([1, 0, 0]);
    file["simulation"]["duration"] = json!(1);
    let beyond = run(&file);
    assert!(beyond.warning.is_none(), "{:?}", beyond.warning);
    let value = beyond.at.function(0).value;
    assert!((value - 2.0_f64.ln()).abs() < 1e-10, "{value}");
}
