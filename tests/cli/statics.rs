//! Problems of structures, run as a user runs them.

use super::program::{expect, scratch};
use serde_json::Value;
use std::path::Path;

/// A clamped plate of 4 × 4 elements whose thickness differs from patch to patch.
const PLATE: &str = r#"{
    "version": 1, "name": "plate",
    "materials": {"metal": {"young": 70e9, "poisson": 0.3, "density": 2700, "yield_stress": 270e6}},
    "structures": {"plate": {
        "mesh": {"plate": {"length": 1, "width": 1, "elements": [4, 4]}},
        "material": "metal", "thickness": {"per": "patch", "patches": [2, 2], "value": 0.012},
        "sets": {"middle": {"node": {"at": [0.5, 0.5]}}},
        "supports": {"edges": {"nodes": ["x0", "x1", "y0", "y1"]}}
    }},
    "load_cases": {"pressure": {"p": {"pressure": {"faces": "all", "pressure": 1e5}}}},
    "functions": {
        "mass": "mass", "stress": {"von_mises": {"rho": 100}},
        "deflection": {"displacement": {"case": "pressure", "nodes": "middle", "direction": [0, 0, 1]}},
        "lowest": {"lowest_frequency": {"rho": 0.5}}
    },
    "variables": {"h": {"path": "/structures/plate/thickness/value", "lower": 0.002, "upper": 0.03}},
    "objective": {"minimise": "mass"},
    "constraints": {"yield": {"function": "stress", "upper": 1}}
}"#;

pub fn written(directory: &Path) {
    std::fs::write(directory.join("plate.json"), PLATE).expect("is written");
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn a_simulation_tells_functions_errors_and_places() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    let ran = expect(
        0,
        directory,
        &["simulate", "plate.json", "--json", "--error"],
    );
    let found = json(&ran.out);
    assert_eq!(found["mesh"]["shells"], 16);
    let mass = found["functions"]["mass"]["value"]
        .as_f64()
        .expect("a number");
    assert!((mass - 32.4).abs() < 1e-9, "{mass}");
    let stress = &found["functions"]["stress"];
    let place = stress["true_maximum"]["place"].as_str().expect("a place");
    assert!(place.contains("load case \"pressure\""), "{place}");
    assert!(stress["error"].as_f64().expect("a number") > 0.0);
    assert!(
        stress["gradient"]["h[3]"]["value"]
            .as_f64()
            .expect("a number")
            < 0.0
    );
    let text = expect(
        0,
        directory,
        &["simulate", "plate.json", "--output", "out", "--vtu"],
    );
    assert!(
        text.out.contains("true maximum") && text.out.contains("Hz"),
        "{}",
        text.out
    );
    for file in ["thickness.svg", "deformed.svg", "modes.svg", "fields.vtu"] {
        assert!(directory.join("out").join(file).exists(), "{file}");
    }
}

#[test]
fn gradients_are_checked_and_dependences_explained() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    let ran = expect(
        0,
        directory,
        &["check", "plate.json", "--tolerance", "1e-9"],
    );
    assert!(
        ran.out.contains("16 derivatives") && ran.out.contains("0 above"),
        "{}",
        ran.out
    );
    let ran = expect(0, directory, &["explain", "plate.json"]);
    assert!(
        ran.out.contains("stress depends on all 4 variables"),
        "{}",
        ran.out
    );
    let ran = expect(0, directory, &["explain", "plate.json", "--json"]);
    assert_eq!(json(&ran.out)["mesh"]["nodes"], 81);
}

/// An optimisation leaves what others leave, goes on where it was stopped, and repeats itself to the bit.
#[test]
fn an_optimisation_has_records_and_figures_and_goes_on() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    expect(
        0,
        directory,
        &["plate.json", "--output", "whole", "--error"],
    );
    let optimum = std::fs::read_to_string(directory.join("whole/optimum.json")).expect("a record");
    let record = json(&optimum);
    assert_eq!(record["status"], "converged");
    assert_eq!(record["gradient_certificate"]["passed"], true);
    let aggregate = &record["constraints"]["yield"]["aggregate"];
    assert!(
        aggregate["place"]
            .as_str()
            .is_some_and(|place| place.contains("face")),
        "{aggregate}"
    );
    for file in [
        "history.csv",
        "evaluations.jsonl",
        "state.json",
        "convergence.svg",
        "thickness.svg",
    ] {
        assert!(directory.join("whole").join(file).exists(), "{file}");
    }
    let part = [
        "plate.json",
        "--output",
        "part",
        "--set",
        "/optimiser={\"iterations\": 3}",
    ];
    expect(1, directory, &part);
    expect(0, directory, &["plate.json", "--resume", "part"]);
    expect(0, directory, &["compare", "part", "whole"]);
    let design = |of: &str| {
        let text = std::fs::read_to_string(directory.join(of).join("optimum.json"));
        json(&text.expect("a record"))["design"].clone()
    };
    assert_eq!(design("part"), design("whole"));
    std::fs::remove_file(directory.join("whole/thickness.svg")).expect("a figure");
    expect(0, directory, &["plot", "whole"]);
    assert!(directory.join("whole/thickness.svg").exists());
    let several = expect(
        0,
        directory,
        &["plate.json", "--starts", "3", "--output", "several"],
    );
    assert!(
        several.out.contains("3 of 3 starts converged"),
        "{}",
        several.out
    );
    assert!(directory.join("several/optima.csv").exists());
}

#[test]
fn error_is_measured_against_time_and_mesh() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    let ran = expect(
        0,
        directory,
        &[
            "work-precision",
            "plate.json",
            "--runs",
            "1",
            "--function",
            "deflection",
            "--output",
            "wp",
        ],
    );
    assert!(ran.out.contains("error of stress"), "{}", ran.out);
    let figure =
        std::fs::read_to_string(directory.join("wp/work_precision.svg")).expect("a figure");
    assert!(figure.contains("gradient of deflection"), "{figure}");
    assert!(
        !figure.contains("mass"),
        "its differences are rounding: {figure}"
    );
    let table = std::fs::read_to_string(directory.join("wp/work_precision.csv")).expect("a table");
    let column = |line: &str, k: usize| line.split(',').nth(k).and_then(|x| x.parse::<f64>().ok());
    let names: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let at = names
        .iter()
        .position(|name| *name == "error of deflection")
        .expect("a column");
    let errors: Vec<f64> = table
        .lines()
        .skip(1)
        .filter_map(|line| column(line, at))
        .collect();
    assert!(
        errors.len() >= 3 && errors.windows(2).all(|pair| pair[1] < pair[0]),
        "{errors:?}"
    );
}

#[test]
fn options_and_failures_of_structures_are_told() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    let ran = expect(
        2,
        directory,
        &["simulate", "plate.json", "--accuracy", "1e-3"],
    );
    assert!(ran.err.contains("no time steps"), "{}", ran.err);
    let ran = expect(2, directory, &["simulate", "plate.json", "--vtu"]);
    assert!(ran.err.contains("--output"), "{}", ran.err);
    let misspelt = [
        "simulate",
        "plate.json",
        "--set",
        "/structures/plate/supports/edges/nodes/0=\"x9\"",
    ];
    let ran = expect(2, directory, &misspelt);
    assert!(
        ran.err.contains("\"x9\"") && ran.err.contains("did you mean"),
        "{}",
        ran.err
    );
    // A wide plate under a pressure in its plane buckles.
    let buckled = [
        "simulate",
        "plate.json",
        "--set",
        "/statics={\"strains\": \"von_karman\"}",
        "--set",
        "/structures/plate/supports/edges/nodes=[\"x0\"]",
        "--set",
        "/load_cases/pressure/p={\"edge\": {\"edges\": \"x1\", \"force\": [-1e7, 0, 0]}}",
    ];
    let ran = expect(3, directory, &buckled);
    assert!(
        ran.err.contains("load case \"pressure\"") && ran.err.contains("of the load"),
        "{}",
        ran.err
    );
}

/// A load case that neither objective nor constraints use has no part in an optimisation.
#[test]
fn a_load_case_that_nothing_needs_changes_nothing() {
    let scratch = scratch();
    let directory = scratch.path();
    written(directory);
    let mut file = json(PLATE);
    file["functions"]["stress"]["von_mises"]["cases"] = Value::from(vec!["pressure"]);
    file["load_cases"]["idle"] = json(r#"{"p": {"pressure": {"faces": "all", "pressure": 5e5}}}"#);
    std::fs::write(directory.join("idle.json"), file.to_string()).expect("is written");
    let optimum = |name: &str| {
        let file = format!("{name}.json");
        expect(0, directory, &[&file, "--output", name, "--error"]);
        let path = directory.join(name).join("optimum.json");
        json(&std::fs::read_to_string(path).expect("a record"))["objective"]["value"].clone()
    };
    assert_eq!(optimum("plate"), optimum("idle"));
}

/// The bounds of a variable admit webs beyond the width of the section. The best beam that can be built is kept,
/// and the run says why others have no values.
#[test]
fn a_run_that_stalls_says_why_designs_have_no_values() {
    let scratch = scratch();
    let directory = scratch.path();
    let problem = r#"{
        "version": 1, "name": "arm", "materials": {"metal": {"young": 70e9, "poisson": 0.3}},
        "structures": {"arm": {
            "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 1, 0],
                                       "elements": 2}},
            "material": "metal",
            "section": {"i": {"width": 0.06, "height": 0.1, "flange": 0.01, "web": 0.01}},
            "supports": {"root": {"nodes": ["start"]}}
        }},
        "load_cases": {"push": {"p": {"point": {"nodes": "end", "force": [0, 0, -1000]}}}},
        "functions": {
            "sag": {"displacement": {"case": "push", "nodes": "end", "direction": [0, 0, -1]}}
        },
        "variables": {"web": {"path": "/structures/arm/section/i/web", "lower": 0.001, "upper": 0.2}},
        "objective": {"minimise": "sag"}
    }"#;
    std::fs::write(directory.join("arm.json"), problem).expect("is written");
    let ran = expect(1, directory, &["arm.json", "--output", "out"]);
    for told in [
        "no further progress",
        "designs had no values, the latest because: the design cannot be built",
        "above the width, 0.06 m",
    ] {
        assert!(ran.out.contains(told), "{}", ran.out);
    }
    let record = std::fs::read_to_string(directory.join("out/optimum.json")).expect("a record");
    let web = json(&record)["design"]["web"]["value"]
        .as_f64()
        .expect("a number");
    assert!((web - 0.06).abs() < 1e-6, "{web}");
}

/// The root of a cantilever has 6 F L/(b h²), which files of fields say; sections without size have no stress.
#[test]
fn fields_have_the_stress_of_beams() {
    let scratch = scratch();
    let directory = scratch.path();
    let rectangle = r#"{"rectangle": {"width": 0.05, "height": 0.1}}"#;
    let given = r#"{"given": {"axial_and_shear": [1e8, 4e7, 4e7], "torsion_and_bending": [1e5, 1e5, 2e5],
                             "mass": 10, "inertia": [0.1, 0.1]}}"#;
    let of = |section: &str| {
        let problem = format!(
            r#"{{"version": 1, "name": "arm", "materials": {{"metal": {{"young": 70e9, "poisson": 0.3}}}},
            "structures": {{"arm": {{
                "mesh": {{"straight_beam": {{"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 1, 0],
                                           "elements": 4}}}},
                "material": "metal", "section": {section},
                "supports": {{"root": {{"nodes": ["start"]}}}}
            }}}},
            "load_cases": {{"push": {{"p": {{"point": {{"nodes": "end", "force": [0, 0, -1000]}}}}}}}},
            "functions": {{
                "sag": {{"displacement": {{"case": "push", "nodes": "end", "direction": [0, 0, -1]}}}}
            }}}}"#
        );
        std::fs::write(directory.join("arm.json"), problem).expect("is written");
        let arguments = ["simulate", "arm.json", "--output", "out", "--vtu"];
        expect(0, directory, &arguments);
        let text = std::fs::read_to_string(directory.join("out/fields.vtu")).expect("fields");
        let (_, rest) = text
            .split_once("stress along fibres, push")
            .expect("a field");
        let (_, rest) = rest.split_once('\n').expect("numbers");
        let lines = rest.lines().map_while(|line| line.parse::<f64>().ok());
        lines.collect::<Vec<f64>>()
    };
    let found = of(rectangle);
    assert_eq!(found.len(), 4);
    let root = found[0];
    assert!((root / 1.2e7 - 1.0).abs() < 1e-6, "{root:e}");
    assert!(of(given).iter().all(|&stress| stress == -1.0));
}

/// The same of a beam in motion, whose momentum grows with its mass.
#[test]
fn beams_in_motion_that_cannot_be_built_have_no_values() {
    let scratch = scratch();
    let directory = scratch.path();
    let problem = r#"{
        "version": 1, "name": "swing", "gravity": [0, -9.81, 0],
        "bodies": {"bar": {"beam": {
            "length": 1, "section": {"i": {"width": 0.06, "height": 0.1, "flange": 0.01, "web": 0.01}},
            "material": {"young": 1e9, "density": 1000},
            "modes": {"bending_y": 1, "bending_z": 0, "torsion": 0}
        }}},
        "joints": {"root": {"revolute": {"between": ["bar", "ground"], "at": "bar.start", "axis": [0, 0, 1]}}},
        "simulation": {"duration": 0.05, "steps": 20, "method": {"radau": {"stages": 3}}},
        "functions": {"momentum": {"final": {"momentum": {"direction": [0, -1, 0]}}}},
        "variables": {"web": {"path": "/bodies/bar/beam/section/i/web", "lower": 0.001, "upper": 0.2}},
        "objective": {"maximise": "momentum"}
    }"#;
    std::fs::write(directory.join("swing.json"), problem).expect("is written");
    let ran = expect(1, directory, &["swing.json", "--output", "out"]);
    for told in [
        "body \"bar\" has a section with a web of",
        "above the width, 0.06 m",
    ] {
        assert!(ran.out.contains(told), "{}", ran.out);
    }
}

/// A load at one node has no limit on a shell: functions of its case have no estimate to rely on, others do.
#[test]
fn estimates_of_loads_at_one_node_are_told_to_be_unreliable() {
    let scratch = scratch();
    let directory = scratch.path();
    let mut problem = json(PLATE);
    problem["load_cases"]["poke"] =
        serde_json::json!({"p": {"point": {"nodes": "middle", "force": [0, 0, 9]}}});
    problem["functions"]["give"] = serde_json::json!({"compliance": {"case": "poke"}});
    std::fs::write(directory.join("plate.json"), problem.to_string()).expect("is written");
    let ran = expect(0, directory, &["simulate", "plate.json", "--error"]);
    // The stress is that of all load cases.
    let told = "the estimated errors of \"stress\", \"give\" are not reliable";
    assert!(ran.out.contains(told), "{}", ran.out);
    let ran = expect(
        0,
        directory,
        &["simulate", "plate.json", "--error", "--json"],
    );
    let warning = json(&ran.out)["warning"].clone();
    assert!(
        warning
            .as_str()
            .is_some_and(|text| text.contains("\"give\"")),
        "{warning}"
    );
    let ran = expect(0, directory, &["simulate", "plate.json"]);
    assert!(!ran.out.contains("not reliable"), "{}", ran.out);
    written(directory);
    let ran = expect(0, directory, &["simulate", "plate.json", "--error"]);
    assert!(!ran.out.contains("not reliable"), "{}", ran.out);
}
