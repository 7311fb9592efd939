//! Starts in static equilibrium: cantilevers against closed forms, mechanisms whose elastic coordinates do not
//! accelerate, derivatives, and faults.

use super::modal::modal;
use crate::reference::documents::plates;
use crate::reference::documents::{problem as parsed, read, run};
use crate::reference::gradients::{
    gradients_are_exact, scaled_gradients_are_exact, thick_and_soft,
};
use flexbody_driver::check;
use flexbody_mathematics::math::{Dual, Scalar};
use flexbody_mechanics::system::Numbering;
use flexbody_mechanics::system::initial;
use flexbody_mechanics::system::kkt::SaddlePoint;
use flexbody_problem::Problem;
use serde_json::Value;

const LENGTH: f64 = 1.5;
const YOUNG: f64 = 7e9;

fn beam(frame: &str) -> Value {
    json!({
        "length": LENGTH, "section": {"rectangle": {"width": 0.03, "height": 0.02}},
        "material": {"young": YOUNG, "density": 2000}, "frame": frame,
        "modes": {"bending_y": 3, "bending_z": 2, "torsion": 1}, "damping": {"ratio": 0.01}
    })
}

/// A cantilever under its weight and a force at its end stands at w L⁴ / 8EI + F L³ / 3EI with shear, and stays
/// there, by each frame.
#[test]
fn a_cantilever_stands_still() {
    let force = 1.5;
    let (width, height) = (0.03_f64, 0.02_f64);
    let area = width * height;
    // So stiff that linear theory holds.
    let young = 10.0 * YOUNG;
    let bending = young * width * height.powi(3) / 12.0;
    let weight = 2000.0 * area * 9.81;
    let shear = 5.0 / 6.0 * young / 2.6 * area;
    let by_bending =
        weight * LENGTH.powi(4) / 8.0 / bending + force * LENGTH.powi(3) / 3.0 / bending;
    let expected = by_bending + (0.5 * weight * LENGTH + force) * LENGTH / shear;
    for frame in ["clamped", "chord"] {
        let mut document = json!({
            "version": 1, "name": "cantilever", "start": "equilibrium",
            "bodies": {"bar": {"beam": beam(frame), "place": {"put": "start"}}},
            "joints": {"wall": {"weld": {"between": ["bar", "ground"], "at": "bar.start"}}},
            "loads": {"end": {"force": {"body": "bar", "point": "end", "direction": [0, -1, 0], "magnitude": force}}},
            "simulation": {"duration": 0.05, "steps": 20, "method": {"radau": {"stages": 3}}},
            "functions": {
                "tip": {"final": {"position": {"body": "bar", "point": "end", "direction": [0, -1, 0]}}},
                "speed": {"integral": {"speed_squared": {"body": "bar", "point": "end"}}},
                "kinetic": {"final": {"energy": "kinetic"}},
                "wall": {"final": {"joint_force": {"joint": "wall", "on": "bar", "direction": [0, 1, 0]}}}
            }
        });
        document["bodies"]["bar"]["beam"]["material"]["young"] = json!(young);
        let motion = run(&document);
        let value = |k: usize| motion.at.function(k).value;
        assert!(
            (value(0) / expected - 1.0).abs() < 1e-3,
            "{frame} {} {expected}",
            value(0)
        );
        assert!(
            value(1) < 1e-20 && value(2) < 1e-18,
            "{frame} {} {}",
            value(1),
            value(2)
        );
        assert!((value(3) / (weight * LENGTH + force) - 1.0).abs() < 1e-9);
        // By the other method too.
        let mut explicit = document.clone();
        explicit["simulation"] = json!({"duration": 5e-4, "steps": 400, "method": "dop853"});
        assert!((run(&explicit).at.function(0).value / value(0) - 1.0).abs() < 1e-8);
    }
}

/// Two beams and a weight that swing in space, and a spring to ground.
fn swing(start: &str) -> Value {
    json!({
        "version": 1, "name": "swing", "start": start, "gravity": [1, -9.81, 2],
        "bodies": {
            "first": {"beam": beam("clamped"), "place": {"put": "start"}},
            "second": {"beam": beam("chord"), "place": {"put": "start", "at": "first.end",
                       "turn": {"axis": [0, 0, 1], "angle": 0.6}}},
            "weight": {"shape": {"box": {"size": [0.1, 0.2, 0.1]}}, "mass": 0.5, "place": {"at": "second.end"}}
        },
        "joints": {
            "root": {"revolute": {"between": ["first", "ground"], "at": "first.start", "axis": [0, 0, 1]}},
            "elbow": {"revolute": {"between": ["second", "first"], "at": "first.end", "axis": [0.2, 0, 1]}},
            "end": {"weld": {"between": ["weight", "second"], "at": "second.end"}}
        },
        "loads": {
            "spring": {"spring": {"between": ["second", "ground"], "at": {"a": "end", "b": [2, 2, 0.3]},
                                  "rest_length": 1, "stiffness": 3}},
            "push": {"force": {"body": "first", "point": "end", "direction": [0, 1, 1],
                               "magnitude": {"harmonic": {"amplitude": 2, "frequency": 1, "phase": 0.5}}}}
        },
        "simulation": {"duration": 0.05, "steps": 25, "method": {"radau": {"stages": 3}}},
        "functions": {
            "tip": {"final": {"position": {"body": "second", "point": "end", "direction": [0, 1, 0]}}},
            "bend": {"integral": {"elastic_displacement": {"body": "first", "point": "end", "direction": [0, 1, 1]}}},
            "strain": {"integral": {"strain_energy": {"body": "second"}}}
        }
    })
}

/// Largest acceleration of an elastic coordinate at the start, and of other bodies; and the gap of the first joint
/// from where its bodies are placed.
fn accelerations(document: &Value) -> [f64; 2] {
    let problem = parsed(document);
    let model = problem.scene(&problem.start()).model;
    let numbering = Numbering::new(&model);
    let mut saddle = SaddlePoint::new(&model, &numbering);
    let state = initial::solve(&model, &numbering, &mut saddle).expect("a start");
    let largest = |carriers: bool| {
        let bodies = (0..model.bodies.len()).filter(|&body| model.is_carrier(body) == carriers);
        let linear = bodies.flat_map(|body| &state.a[numbering.velocity(body)..][..3]);
        linear.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    [largest(true), largest(false)]
}

/// No elastic coordinate accelerates when the bodies are let go, while an undeformed start shakes them. The bodies
/// fall as rigid ones do, and stay where they are placed.
#[test]
fn deformations_of_mechanisms_do_not_accelerate() {
    let [shaken, _] = accelerations(&swing("given"));
    let [still, falls] = accelerations(&swing("equilibrium"));
    assert!(shaken > 1.0 && falls > 1.0, "{shaken} {falls}");
    assert!(still < 1e-8 * falls, "{still} {falls}");
}

/// Derivatives by numbers of bodies, loads, places and gravity against the complex step.
#[test]
fn starts_in_equilibrium_have_exact_derivatives() {
    let variables = [
        "/bodies/first/beam/material/young",
        "/bodies/first/beam/length",
        "/bodies/second/beam/section/rectangle/height",
        "/bodies/second/place/turn/angle",
        "/bodies/weight/mass",
        "/loads/spring/spring/stiffness",
        "/loads/push/force/magnitude/harmonic/phase",
        "/gravity/1",
    ];
    let designed = |mut document: Value, variables: &[&str]| {
        let named = |path: &&str| {
            (
                (*path).to_owned(),
                json!({"path": path, "lower": -1e12, "upper": 1e12}),
            )
        };
        let mut all: serde_json::Map<String, Value> = variables.iter().map(named).collect();
        for (path, variable) in &mut all {
            if !path.contains("/angle") && !path.contains("phase") && !path.contains("gravity") {
                variable["lower"] = json!(1e-6);
            }
        }
        document["variables"] = Value::Object(all);
        document
    };
    let document = designed(swing("equilibrium"), &variables);
    gradients_are_exact(&parsed(&document), &document["simulation"]);
    let mut other = document.clone();
    other["simulation"]["method"] = json!({"bdf": {"order": 2}});
    gradients_are_exact(&parsed(&other), &other["simulation"]);
    // A body of files that hangs on two hinges: a loop.
    let mut body = modal(json!({"clamped": "start"}));
    body["modes"] = json!(1);
    body["interfaces"] = json!({"start": 1, "end": 21});
    body["young_factor"] = json!(0.01);
    let hung = json!({
        "version": 1, "name": "hung", "start": "equilibrium",
        "bodies": {"bar": {"modal": body, "place": {"put": "start"}}},
        "joints": {
            "first": {"revolute": {"between": ["bar", "ground"], "at": "bar.start", "axis": [0, 0, 1]}},
            "last": {"rod": {"between": ["bar", "ground"], "at": {"a": "end", "b": [1, 1, 0]}}}
        },
        "simulation": {"duration": 0.02, "steps": 10, "method": {"radau": {"stages": 3}}},
        "functions": {"strain": {"integral": {"strain_energy": {"body": "bar"}}}}
    });
    let hung = designed(
        hung,
        &[
            "/bodies/bar/modal/young_factor",
            "/bodies/bar/modal/density_factor",
        ],
    );
    let mut hung = hung;
    hung["bodies"]["bar"]["modal"]["density_factor"] = json!(1.1);
    gradients_are_exact(&parsed(&hung), &hung["simulation"]);
}

/// Shells that turn at the start are stretched by centrifugal forces: a plate of length L about its edge by
/// ρ ω² L³ / 3E. It stays so, while an undeformed one vibrates.
#[test]
fn plates_that_turn_start_stretched() {
    let document = |start: &str| {
        json!({
            "version": 1, "name": "turning plate", "start": start, "gravity": [0, 0, 0],
            "bodies": {"plate": {
                "elements": {
                    "structure": {"mesh": {"plate": {"length": 1, "width": 0.2, "elements": [3, 1]}},
                                  "material": "soft", "thickness": 0.02,
                                  "sets": {"end": {"node": {"at": [1, 0.5]}}}},
                    "frame": {"clamped": "x0"}, "points": {"root": {"edge": "x0"}, "end": {"node": "end"}}
                },
                "place": {"put": "root"}
            }},
            "materials": {"soft": {"young": 1e8, "poisson": 0, "density": 1000}},
            "initial_velocity": {"angular": [0, 0, 30]},
            "joints": {"hinge": {"revolute": {"between": ["plate", "ground"], "at": "plate.root", "axis": [0, 0, 1]}}},
            "simulation": {"duration": 0.05, "steps": 100, "method": {"radau": {"stages": 3}}},
            "functions": {
                "end": {"final": {"elastic_displacement": {"body": "plate", "point": "end", "direction": [1, 0, 0]}}},
                "most": {"ks": {"of": {"strain_energy": {"body": "plate"}}, "rho": 1e6}},
                "mean": {"integral": {"strain_energy": {"body": "plate"}}}
            }
        })
    };
    let of = |start: &str| {
        let motion = run(&document(start));
        [0, 1, 2].map(|k| motion.at.function(k).value)
    };
    let [end, most, mean] = of("equilibrium");
    let exact = 1000.0 * 30.0_f64.powi(2) / (3.0 * 1e8);
    assert!((end / exact - 1.0).abs() < 0.01, "{end} {exact}");
    assert!((most / (mean / 0.05) - 1.0).abs() < 1e-6, "{most} {mean}");
    let [_, most, mean] = of("given");
    assert!(most > 1.5 * mean / 0.05, "{most} {mean}");
}

/// A bar that turns with √(E/ρ) / L is strained by 1 / cos 1 - 1 at its hinge: more than small strains allow, which
/// the run says.
#[test]
fn large_strains_are_told() {
    let document = json!({
        "version": 1, "name": "turning bar", "start": "equilibrium", "gravity": [0, 0, 0],
        "bodies": {"bar": {
            "beam": {
                "length": 1, "section": {"rectangle": {"width": 0.05, "height": 0.05}},
                "material": {"young": 1e5, "density": 1000}, "frame": "clamped",
                "modes": {"bending_y": 1, "bending_z": 0, "torsion": 0, "stretch": 8}
            },
            "place": {"put": "start", "at": [0, 0, 0]}
        }},
        "initial_velocity": {"angular": [0, 0, 10]},
        "joints": {"hub": {"revolute": {"between": ["bar", "ground"], "at": "bar.start", "axis": [0, 0, 1]}}},
        "simulation": {"duration": 0.1, "steps": 100, "method": {"bdf": {"order": 2}}},
        "functions": {"x": {"final": {"position": {"body": "bar", "point": "end", "direction": [1, 0, 0]}}}}
    });
    let warning = run(&document).warning.unwrap_or_default();
    assert!(warning.contains("\"bar\" is strained by 0.8"), "{warning}");
}

/// Derivatives of two hinged plates that turn and fall, by thickness of bands, modulus and density.
#[test]
fn starts_of_shells_have_exact_derivatives() {
    let method = json!({"radau": {"stages": 3}});
    let mut document = plates([2, 1], 0.02, 8, &method);
    thick_and_soft(&mut document);
    document["start"] = json!("equilibrium");
    let problem = parsed(&document);
    scaled_gradients_are_exact(&problem, &problem.start(), &method);
}

/// Derivatives of a start are the same to the last bit, whatever other starts are known: so threads do not change them.
#[test]
fn derivatives_of_starts_do_not_depend_on_other_designs() {
    let mut document = plates([2, 1], 0.02, 8, &json!({"bdf": {"order": 2}}));
    thick_and_soft(&mut document);
    document["start"] = json!("equilibrium");
    let problem = parsed(&document);
    let derivatives = |x: &[f64]| -> Vec<f64> {
        let seeded = x.iter().enumerate();
        let seeded: Vec<Dual> = seeded
            .map(|(i, &x)| Dual::new(x, if i == 0 { 1.0 } else { 0.0 }))
            .collect();
        let bodies = problem.scene::<Dual>(&seeded).model.bodies;
        let places = bodies.iter().flat_map(|body| &body.position);
        places.map(|x| x.infinitesimal()).collect()
    };
    let x = problem.start();
    let first = derivatives(&x);
    assert!(first.iter().any(|&x| x != 0.0));
    let other: Vec<f64> = x.iter().map(|x| 1.01 * x).collect();
    assert_ne!(derivatives(&other), first);
    assert_eq!(derivatives(&x), first);
}

/// Plates of 2 mm: round-off of their stiffness against shear is relative to what deforms the elements.
#[test]
fn starts_of_thin_shells_have_derivatives_of_ten_digits() {
    let mut document = read("problems/flexible/double_plate_mass.json");
    for body in ["first", "second"] {
        let structure = &mut document["bodies"][body]["elements"]["structure"];
        structure["mesh"]["plate"]["elements"] = json!([3, 1]);
        structure["thickness"]["value"] = json!(0.002);
    }
    document["simulation"]["duration"] = json!(0.004);
    document["simulation"]["steps"] = json!(1);
    let problem = parsed(&document);
    let found = check(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(found.len(), 18);
    for derivative in found {
        let off = derivative.relative_difference();
        assert!(off < 1e-10, "{derivative:?}: {off:e}");
    }
}

/// The message names what cannot start in equilibrium.
#[test]
fn starts_without_equilibrium_are_told() {
    let told = |document: &Value| {
        let faults = Problem::parse(&document.to_string(), "rest", &[]).expect_err("a fault");
        faults.to_string()
    };
    let mut rigid = swing("equilibrium");
    for body in ["first", "second"] {
        rigid["bodies"][body] = json!({"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
            "points": {"start": [-0.5, 0, 0], "end": [0.5, 0, 0]}, "place": rigid["bodies"][body]["place"]});
    }
    rigid
        .as_object_mut()
        .expect("a document")
        .shift_remove("functions");
    let text = told(&rigid);
    assert!(
        text.contains("a start in equilibrium without a flexible body"),
        "{text}"
    );
    let mut twice = swing("equilibrium");
    twice["bodies"]["first"]["beam"]["start"] = json!({"coordinates": vec![0.0; 13]});
    let text = told(&twice);
    assert!(
        text.contains("a start of coordinates beside that in equilibrium"),
        "{text}"
    );
    let text = told(&swing("rest"));
    assert!(
        text.contains("\"given\"") && text.contains("\"equilibrium\""),
        "{text}"
    );
    let mut crushed = swing("equilibrium");
    crushed["loads"]["push"]["force"]["magnitude"] = json!(1e12);
    let text = told(&crushed);
    assert!(text.contains("no start in equilibrium"), "{text}");
}
