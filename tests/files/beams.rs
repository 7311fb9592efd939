//! Problems with beams: spin-up (Simo & Vu-Quoc 1986) against a planar geometrically exact model; slider-crank
//! with an elastic rod (Simeon 1996; crank.f of the IVP test set); beams that are nearly rigid; derivatives in
//! every parameter; what files may not say.

use super::gmsh::values as static_values;
use crate::reference::documents::{faults_say, problem as parsed, run, value};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::Path;

fn document(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/flexible/{name}.json"));
    let text = std::fs::read_to_string(path).expect("a problem");
    serde_json::from_str(&text).expect("valid JSON")
}

/// Tip displacement in the turning axes: an independent Reissner beam of finite elements, converged to 3e-5 m.
/// The steady extension is ρA ω² L³ / 3EA = 5.1429e-4 m.
#[test]
fn a_beam_lags_behind_its_spin_up_and_is_straightened() {
    let mut document = document("spin_up");
    for (duration, lag) in [(3.0, -0.217267), (6.0, -0.543599), (7.0, -0.571317)] {
        document["simulation"]["duration"] = json!(duration);
        let found = value(&document, "lag");
        assert!((found / lag - 1.0).abs() < 5e-3, "{duration} s: {found}");
    }
    document["simulation"]["duration"] = json!(15);
    let motion = run(&document);
    let deepest = motion.at.function(2).maximum.expect("an aggregate").value;
    assert!((deepest / 0.57383 - 1.0).abs() < 5e-3, "{deepest}");
    let extension = motion.at.function(1).value;
    assert!((extension / 5.1429e-4 - 1.0).abs() < 5e-3, "{extension}");
}

/// Without von Karman's terms rotation softens a beam: at √(EI/ρA L⁴) 3.516 = 3.8 rad/s it gives way.
#[test]
fn a_beam_with_linear_strain_fails_to_spin_up() {
    let mut document = document("spin_up");
    document["bodies"]["beam"]["beam"]["strain"] = json!("linear");
    document["simulation"] =
        json!({"duration": 12, "steps": 2400, "method": {"radau": {"stages": 2}}});
    let problem = parsed(&document);
    // The bent beam flies off, or the run ends in failure.
    if let Ok(motion) = simulate(&problem, &problem.start()) {
        let lag = motion.at.function(0).value;
        assert!(lag.abs() > 5.0, "{lag}");
    }
}

/// Values after 0.1 s of the test set's reference. Their rod adds the rotary inertia of its section, 1.8e-4 of
/// the whole, to its rigid rotation and not to its bending, which a file cannot say.
#[test]
fn a_slider_crank_bends_its_rod_as_in_the_test_set() {
    let motion = run(&document("slider_crank_flexible"));
    for (function, exact, tolerance) in [
        (0, -0.331_173_498_825_626, 1e-6),
        (1, 0.169_737_332_842_786, 1e-6),
        (2, 1.893_192_899_613_509e-4, 2e-4),
    ] {
        let found = motion.at.function(function).value;
        assert!(
            (found / exact - 1.0).abs() < tolerance,
            "{function}: {found}"
        );
    }
}

/// A pendulum of a stiff beam: (stiffness, position of its end). The rigid one is a box of the same mass.
fn pendulum(young: Option<f64>) -> f64 {
    let bar = match young {
        Some(young) => json!({
            "beam": {
                "length": 1, "section": {"rectangle": {"width": 0.1, "height": 0.05}},
                "material": {"young": young, "density": 200},
                "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0}, "damping": {"ratio": 0.2}
            },
            "place": {"put": "start", "at": [0, 0, 0]}
        }),
        None => json!({
            "shape": {"box": {"size": [1, 0.05, 0.1]}}, "mass": 1,
            "points": {"start": [-0.5, 0, 0], "end": [0.5, 0, 0]},
            "place": {"put": "start", "at": [0, 0, 0]}
        }),
    };
    let document = json!({
        "version": 1, "name": "pendulum", "bodies": {"bar": bar},
        "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.start", "axis": [0, 0, 1]}}},
        "simulation": {"duration": 1, "tolerance": 1e-9, "method": {"radau": {"stages": 3}}},
        "functions": {"end": {"final": {"position": {"body": "bar", "point": "end", "direction": [1, 0, 0]}}}}
    });
    value(&document, "end")
}

/// The difference from the rigid motion falls as 1/E.
#[test]
fn a_stiff_beam_moves_as_a_rigid_body() {
    let rigid = pendulum(None);
    let [soft, stiff] = [1e9, 1e10].map(|young| (pendulum(Some(young)) - rigid).abs());
    println!("{soft:e} {stiff:e}");
    assert!(soft < 1e-4, "{soft:e}");
    let order = (soft / stiff).log10();
    assert!(
        (order - 1.0).abs() < 0.2,
        "{soft:e} {stiff:e}: order {order}"
    );
}

/// A free pair of beams in space, with every kind of number of the format as a variable.
fn pair(section: Value, frame: &str, simulation: Value) -> Value {
    let beam = |young: f64| {
        json!({
            "length": 1.2, "section": section, "frame": frame,
            "material": {"young": young, "poisson": 0.3, "density": 1500},
            "modes": {"bending_y": 2, "bending_z": 1, "torsion": 1},
            "damping": {"ratio": 0.01, "torsion_ratio": 0.02, "stretch_ratio": 0.05, "mass": 0.3, "stiffness": 1e-4},
            "stations": {"middle": 0.45}
        })
    };
    let mut document = json!({
        "version": 1, "name": "pair",
        "bodies": {
            "first": {"beam": beam(3e7), "place": {"put": "start", "at": [0, 0, 0],
                      "turn": {"axis": [0, 0, 1], "angle": 0.3}}, "velocity": {"angular": [0.1, 0.2, 2]}},
            "second": {"beam": beam(5e7), "place": {"put": "start", "at": "first.end",
                       "turn": {"axis": [1, 2, 3], "angle": 0.7}}},
            "weight": {"shape": "point", "mass": 0.7, "place": {"at": "second.end"}}
        },
        "joints": {
            "root": {"revolute": {"between": ["first", "ground"], "at": "first.start", "axis": [0, 0, 1]}},
            "elbow": {"universal": {"between": ["second", "first"], "at": "first.end", "axis": [0, 0, 1],
                      "cross": [1, 0, 0]}},
            "tip": {"spherical": {"between": ["weight", "second"], "at": "second.end"}}
        },
        "loads": {
            "spring": {"spring": {"between": ["second", "ground"], "at": {"a": "middle", "b": [1, 1, 1]},
                       "rest_length": 0.5, "stiffness": 40, "damping": 0.1}},
            "push": {"force": {"body": "first", "point": "middle", "direction": [0, 1, 1],
                     "magnitude": {"harmonic": {"amplitude": 3, "frequency": 2}}}},
            "twist": {"torque": {"body": "second", "point": "middle", "direction": [0, 1, 1], "magnitude": 0.5}}
        },
        "functions": {
            "weight": {"final": {"position": {"body": "weight", "direction": [1, 2, 3]}}},
            "bend": {"integral": {"elastic_displacement": {"body": "second", "point": "middle", "direction": [0, 1, 1]}}},
            "moment": {"ks": {"rho": 1, "of": {"section_force": {"body": "first", "station": 0.3, "component": "bending_z"}}}},
            "axial": {"final": {"section_force": {"body": "second", "station": "middle", "component": "axial"}}},
            "stress": {"induced_exponential": {"rho": 1e-5, "of": {"fibre_stress": {"body": "first", "station": 0.1, "fibre": [1, -1]}}}},
            "strain energy": {"final": {"strain_energy": {"body": "first"}}},
            "root force": {"ks": {"rho": 0.1, "bound": "above", "of": {"joint_force": {"joint": "root",
                           "direction": [1, 2, 0.5], "on": "ground", "axes": "joint"}}}},
            "elbow moment": {"induced_exponential": {"rho": 1, "of": {"joint_moment": {"joint": "elbow",
                             "direction": [0.3, 1, 0.2], "on": "first", "axes": "joint"}}}},
            "largest stress": {"ks": {"rho": 1e-5, "of": {"largest_fibre_stress": {"body": "first",
                               "stations": 5, "rho": 1e-5}}}},
            "largest moment": {"integral": {"largest_section_force": {"body": "second", "sign": "both",
                               "stations": ["start", "middle", 0.8], "component": "bending_y", "rho": 1,
                               "bound": "above"}}},
            "tension": {"final": {"spring_force": {"load": "spring"}}},
            "spin": {"final": {"angular_momentum": {"direction": [1, 2, 3], "about": [0.5, 0, 1]}}}
        }
    });
    document["simulation"] = simulation;
    let mut variables = serde_json::Map::new();
    let mut numbers = vec![
        "length".to_owned(),
        "material/young".into(),
        "material/poisson".into(),
        "material/density".into(),
        "stations/middle".into(),
    ];
    for key in [
        "ratio",
        "torsion_ratio",
        "stretch_ratio",
        "mass",
        "stiffness",
    ] {
        numbers.push(format!("damping/{key}"));
    }
    let kind = section
        .as_object()
        .expect("one kind")
        .iter()
        .next()
        .expect("one kind");
    let sizes = kind.1.as_object().expect("sizes").keys();
    numbers.extend(sizes.map(|size| format!("section/{}/{size}", kind.0)));
    for number in numbers {
        let path = format!("/bodies/first/beam/{number}");
        let mut variable = json!({"path": path, "lower": 1e-6});
        if number.ends_with("poisson") {
            variable["upper"] = json!(0.5);
        }
        variables.insert(number, variable);
    }
    document["variables"] = Value::Object(variables);
    document
}

#[test]
fn every_number_of_a_beam_has_an_exact_derivative() {
    let sections = [
        json!({"rectangle": {"width": 0.04, "height": 0.03}}),
        json!({"tube": {"radius": 0.02, "wall": 0.005}}),
        json!({"i": {"width": 0.04, "height": 0.05, "flange": 0.006, "web": 0.005}}),
    ];
    let methods = [
        json!({"duration": 0.15, "steps": 30, "method": {"radau": {"stages": 3}}}),
        json!({"duration": 0.15, "steps": 100, "method": {"bdf": {"order": 2}}}),
        json!({"duration": 0.15, "steps": 75, "method": {"generalised_alpha": {"radius": 0.8}}}),
    ];
    for ((section, simulation), frame) in sections
        .into_iter()
        .zip(methods)
        .zip(["chord", "clamped", "chord"])
    {
        let problem = parsed(&pair(section, frame, simulation.clone()));
        gradients_are_exact(&problem, &simulation);
    }
}

/// Change of the file, and a part of the message of its fault.
#[test]
fn files_are_told_what_a_beam_cannot_be() {
    let base = || {
        pair(
            json!({"rectangle": {"width": 0.04, "height": 0.03}}),
            "chord",
            json!({"duration": 0.1}),
        )
    };
    let told = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut document = base();
        document["variables"] = json!({});
        change(&mut document);
        let faults = Problem::parse(&document.to_string(), "beams", &[]).err();
        let text = faults.map(|faults| faults.to_string()).unwrap_or_default();
        assert!(
            text.contains(expected),
            "{text:?} says nothing of {expected:?}"
        );
    };
    let beam = "first";
    told(
        &|d| d["bodies"][beam]["mass"] = json!(3),
        "\"mass\" beside \"beam\"",
    );
    told(
        &|d| {
            d["bodies"][beam]["beam"]
                .as_object_mut()
                .expect("a beam")
                .remove("material");
        },
        "a beam without material",
    );
    told(
        &|d| {
            d["bodies"][beam]["beam"]["material"]
                .as_object_mut()
                .expect("one")
                .remove("density");
        },
        "a material without density",
    );
    told(
        &|d| d["bodies"][beam]["beam"]["functions"] = json!("sine"),
        "sines with von Karman's strain",
    );
    told(
        &|d| d["bodies"][beam]["beam"]["stations"]["far"] = json!(1.5),
        "a fraction of the length, 0 to 1",
    );
    told(
        &|d| d["bodies"][beam]["points"] = json!({"off": [2, 0, 0]}),
        "a point at x = 2 m",
    );
    told(
        &|d| d["bodies"][beam]["beam"]["start"] = json!({"coordinates": [0, 1]}),
        "a list of 9 numbers",
    );
    told(
        &|d| {
            d["bodies"][beam]["beam"]["section"] =
                json!({"given": {"ea": 1e5, "mass_per_length": 1}})
        },
        "a given section without \"ei_y\"",
    );
    told(
        &|d| d["bodies"][beam]["beam"]["section"] = json!({"tube": {"radius": 0.1, "wall": 0.2}}),
        "a wall of 0.2 m",
    );
    told(
        &|d| d["bodies"][beam]["beam"]["section"]["rectangle"]["width"] = json!(-1),
        "-1",
    );
    told(
        &|d| {
            d["bodies"][beam]["beam"]["modes"] =
                json!({"bending_y": 0, "bending_z": 0, "torsion": 0, "stretch": 0})
        },
        "without elastic coordinates",
    );
    told(
        &|d| d["functions"]["weight"] = json!({"final": {"strain_energy": {"body": "weight"}}}),
        "the name of a beam",
    );
    told(
        &|d| d["functions"]["axial"]["final"]["section_force"]["station"] = json!("midle"),
        "middle",
    );
    told(
        &|d| {
            d["functions"]["stress"]["induced_exponential"]["of"]["fibre_stress"]["fibre"] =
                json!([2, 0])
        },
        "from -1 to 1",
    );
    told(
        &|d| d["joints"]["root"]["revolute"]["at"] = json!([3, 0, 0]),
        "places on the beam",
    );
    told(
        &|d| {
            d["joints"]["root"]["revolute"]["start"] = json!({"turn": {"angle": 0.1}});
            d["bodies"][beam]["beam"]["start"] =
                json!({"coordinates": [0, 0, 0, 0, 0, 0, 0, 0, 0]});
        },
        "beside that of the coordinates",
    );
    told(
        &|d| {
            d["loads"]["push"] =
                json!({"torque": {"body": "first", "direction": [0, 0, 1], "magnitude": 1}})
        },
        "a torque on the beam",
    );
}

/// A slender cantilever: one element bends exactly under a force at its end, and errors of frequencies fall with h⁴. The table of
/// docs/structures.md compares these with elements of two nodes.
#[test]
fn a_cantilever_needs_few_elements() {
    let (young, side, force) = (2.1e11, 0.01_f64, 10.0);
    let values = |elements: usize| {
        static_values(&parsed(&json!({
            "version": 1, "name": "cantilever",
            "materials": {"steel": {"young": young, "poisson": 0.3, "density": 7850}},
            "structures": {"bar": {
                "mesh": {"frame": {"points": {"a": [0, 0, 0], "b": [1, 0, 0]}, "members": {
                    "ab": {"between": ["a", "b"], "orientation": [0, 1, 0], "elements": elements}}}},
                "material": "steel", "section": {"rectangle": {"width": side, "height": side}},
                "supports": {"foot": {"nodes": "a"}}}},
            "load_cases": {"push": {"end": {"point": {"nodes": "b", "force": [0, 0, force]}}}},
            "functions": {
                "sinking": {"displacement": {"case": "push", "nodes": "b", "direction": [0, 0, 1]}},
                "first": {"frequency": {"mode": 1}}, "second": {"frequency": {"mode": 3}}}
        })))
    };
    let shear = young / 2.6 * side * side * 5.0 / 6.0;
    let bending = young * side.powi(4) / 12.0;
    let exact = force / (3.0 * bending) + force / shear;
    assert!((values(1)[0] / exact - 1.0).abs() < 1e-12);
    let fine = values(64);
    for (elements, errors) in [
        (2, [1.61e-3, 5.90e-2]),
        (4, [1.00e-4, 3.76e-3]),
        (8, [6.28e-6, 2.43e-4]),
        (16, [3.89e-7, 1.53e-5]),
    ] {
        let found = values(elements);
        for (k, error) in errors.into_iter().enumerate() {
            let own = found[1 + k] / fine[1 + k] - 1.0;
            assert!((own / error - 1.0).abs() < 0.02, "{elements} {k}: {own}");
        }
    }
}

/// A load without a point acts in the middle of a beam: a free one does not turn, and a compensation bears its weight. Other
/// flexible bodies have no point there.
#[test]
fn loads_without_a_point_act_in_the_middle() {
    let beam = json!({"beam": {
        "length": 1, "section": {"rectangle": {"width": 0.1, "height": 0.1}}, "material": {"young": 7e10, "density": 1000},
        "damping": {"ratio": 0.5}
    }});
    let file = |bodies: &Value, loads: Value, joints: Value, function: Value| {
        json!({
            "version": 1, "name": "middle", "gravity": if joints.is_null() { json!([0, 0, 0]) } else { json!([0, -9.81, 0]) },
            "bodies": {"A": bodies}, "loads": loads, "joints": if joints.is_null() { json!({}) } else { joints },
            "simulation": {"duration": 0.1, "tolerance": 1e-8}, "functions": {"f": function}
        })
    };
    let turns = json!({"final": {"angular_velocity": {"body": "A", "direction": [0, 0, 1]}}});
    let pushed = json!({"l": {"force": {"body": "A", "direction": [0, 1, 0], "magnitude": 1}}});
    let mut placed = beam.clone();
    placed["place"] = json!({"put": "start", "at": [0, 0, 0]});
    let found = value(
        &file(&beam, pushed.clone(), Value::Null, turns.clone()),
        "f",
    );
    assert!(found.abs() < 1e-9, "{found}");
    let joints = json!({"j": {"revolute": {"between": ["A", "ground"], "at": "A.start", "axis": [0, 0, 1]}}});
    let balanced = json!({"c": {"controller": {"joint": "j", "proportional": 1, "gravity_compensation": [{"body": "A", "mass": 10}]}}});
    let effort = json!({"final": {"effort": {"load": "c"}}});
    let found = value(&file(&placed, balanced, joints, effort), "f");
    assert!((found - 10.0 * 9.81 * 0.5).abs() < 1e-3, "{found}");
    let plate = json!({"elements": {
        "structure": {"mesh": {"plate": {"length": 1, "width": 0.1, "elements": [2, 1]}}, "material": "m", "thickness": 0.01},
        "frame": {"clamped": "x0"}, "points": {"root": {"edge": "x0"}}
    }});
    let mut shells = file(&plate, pushed, Value::Null, turns);
    shells["materials"] = json!({"m": {"young": 7e10, "poisson": 0.3, "density": 2700}});
    faults_say(&shells, &["no \"point\" on the flexible body \"A\""]);
}
