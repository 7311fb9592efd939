//! Problems of structures that do not move: gradients, estimated errors, optima, faults, fields.

use flexbody_driver::statics::{StaticDesign, error};
use flexbody_driver::{
    CheckedDerivative, KnownEvaluations, Optimisation, Verdict, check, optimise,
};
use flexbody_figures::statics::fields;
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;

pub(super) fn shipped(name: &str, changes: &[&str]) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let changes: Vec<Override> = changes
        .iter()
        .map(|text| Override::parse(text).expect("an override"))
        .collect();
    Problem::load(&path, &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

fn parsed(document: &Value) -> Problem {
    Problem::parse(&document.to_string(), "structures.json", &[])
        .unwrap_or_else(|faults| panic!("{faults}\n{document}"))
}

fn solved(problem: &Problem) -> StaticDesign {
    solved_at(problem, &problem.start())
}

pub(super) fn solved_at(problem: &Problem, design: &[f64]) -> StaticDesign {
    let statics = problem.statics.as_ref().expect("structures");
    StaticDesign::of(problem, statics, design, None).unwrap_or_else(|failure| panic!("{failure}"))
}

/// Asserts that all derivatives agree with the complex step, beside the gradient in scaled variables.
pub(super) fn assert_gradients(name: &str, problem: &Problem) {
    let found = check(problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(
        found.len(),
        problem.function_names.len() * problem.variables.len()
    );
    let scaled = |d: &CheckedDerivative, x: f64| x * problem.variables[d.variable].scale;
    for f in 0..problem.function_names.len() {
        let own = || found.iter().filter(|d| d.function == f);
        let gradient = own().fold(0.0_f64, |m, d| m.hypot(scaled(d, d.complex_step)));
        let largest = own()
            .map(|d| scaled(d, d.adjoint - d.complex_step).abs())
            .fold(0.0, f64::max);
        let function = &problem.function_names[f];
        println!(
            "{name}, {function}: {:.1e} of the gradient",
            largest / gradient
        );
        assert!(gradient > 0.0, "{name}, {function} depends on nothing");
        // The moment of one support is a small rest of the forces of its element.
        let tolerance = if function == "moment" { 1e-11 } else { 1e-12 };
        assert!(
            largest <= tolerance * gradient,
            "{name}, {function}: {largest:e} of {gradient:e}"
        );
    }
}

/// A support of one set names it by a text or by a list.
#[test]
fn one_set_is_a_text_or_a_list() {
    let set = "/structures/plate/supports/clamped edges/nodes";
    let of = |changes: &[&str]| solved(&shipped("plate_patches", changes)).function(1).value;
    let [text, list] = ["\"x0\"", "[\"x0\"]"].map(|value| of(&[&format!("{set}={value}")]));
    assert_eq!(text, list);
    assert!(text != of(&[]));
}

#[test]
fn gradients_of_the_shipped_problems_agree_with_the_complex_step() {
    assert_gradients("plate_patches", &shipped("plate_patches", &[]));
    assert_gradients("scordelis_lo", &shipped("scordelis_lo", &[]));
    let coarse = ["/structures/plate/mesh/plate/elements=[8,8]"];
    assert_gradients("plate_stress", &shipped("plate_stress", &coarse));
}

/// A derivative that is zero is no fault, however small the unit of its variable: reactions of a cantilever and stresses by
/// Young's modulus, centres of mass by thickness.
#[test]
fn derivatives_that_are_zero_pass_the_check() {
    let steel = json!({"young": 2e9, "poisson": 0.3, "density": 1500, "yield_stress": 3e7});
    let plate = json!({"mesh": {"plate": {"length": 1.3, "width": 0.4, "elements": [3, 1]}}, "material": "steel",
        "thickness": 0.02, "supports": {"held": {"nodes": "x0"}}});
    let reaction = |direction: [i32; 3]| json!({"reaction": {"case": "a", "nodes": "x0", "direction": direction}});
    let centre = |direction: [i32; 3]| json!({"centre_of_mass": {"direction": direction}});
    let problem = parsed(&json!({
        "version": 1, "name": "plate", "materials": {"steel": steel}, "structures": {"plate": plate},
        "load_cases": {"a": {"edge": {"edge": {"edges": "x1", "force": [3, -7, 11]}}}},
        "functions": {"x": reaction([1, 0, 0]), "y": reaction([0, 1, 0]), "z": reaction([0, 0, 1]),
            "along": centre([1, 0, 0]), "across": centre([0, 0, 1]),
            "stress": {"von_mises": {"rho": 50}}},
        "variables": {"modulus": {"path": "/materials/steel/young", "lower": 1e6, "upper": 1e12},
            "thickness": {"path": "/structures/plate/thickness", "lower": 0.001, "upper": 0.1}}
    }));
    let of = |name: &str| problem.function_names.iter().position(|own| own == name);
    let found = check(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(found.len(), 12);
    for d in &found {
        let expected: &[Verdict] = match (Some(d.function) == of("stress"), d.variable) {
            (false, _) => &[Verdict::Nothing],
            // Digits of the factors.
            (true, 0) => &[Verdict::Nothing, Verdict::RoundOff],
            (true, _) => &[Verdict::Agree],
        };
        assert!(expected.contains(&d.verdict(1e-10)), "{d:?}");
        // A hundred and fifty times the round-off is a fault.
        let adjoint = d.adjoint + 1e4 * f64::EPSILON * d.terms;
        let wrong = CheckedDerivative {
            adjoint,
            ..d.clone()
        };
        // What is zero exactly is compared by its size.
        if d.complex_step != 0.0 {
            assert_eq!(wrong.verdict(1e-13), Verdict::Differ, "{wrong:?}");
        }
    }
}

/// Reactions to dead loads do not depend on the modulus: what is left of larger terms passes, on any mesh.
#[test]
fn reactions_that_a_modulus_does_not_change_pass_the_check() {
    for (elements, unknowns, young) in [
        ([2, 2], "five", 6.840409416e9),
        ([2, 2], "six", 7e10),
        ([4, 3], "five", 2.1e11),
        ([5, 5], "six", 3e6),
    ] {
        let problem = parsed(&json!({
            "version": 1, "name": "table", "statics": {"node_unknowns": unknowns},
            "materials": {"a": {"young": young, "poisson": 0.3, "density": 570}},
            "structures": {"s": {
                "mesh": {"plate": {"length": 1, "width": 0.7, "elements": elements}}, "material": "a", "thickness": 0.0335,
                "supports": {"s": {"nodes": ["x0", "x1"], "held": ["x", "y", "z"]}}
            }},
            "load_cases": {"c": {"g": {"gravity": {"acceleration": [3, 5, -9.81]}}}},
            "functions": {
                "moment": {"reaction_moment": {"case": "c", "nodes": "x0", "axis": [0, 1, 0], "about": [0.1, 0.2, 0.3]}},
                "force": {"reaction": {"case": "c", "nodes": "x0", "direction": [1, 0, 0]}}
            },
            "variables": {"E": {"path": "/materials/a/young", "lower": 1e5, "upper": 1e13}}
        }));
        for d in check(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}")) {
            let verdict = d.verdict(1e-10);
            assert!(
                [Verdict::Nothing, Verdict::RoundOff].contains(&verdict),
                "{elements:?} {unknowns}: {verdict:?} {d:?}"
            );
        }
    }
}

/// The memory of an estimate follows from the entries of the factor.
#[test]
fn a_solution_knows_the_entries_of_its_factor() {
    let problem = parsed(&json!({
        "version": 1, "name": "plate", "materials": material(),
        "structures": {"plate": {
            "mesh": {"plate": {"length": 1, "width": 1, "elements": [4, 3]}}, "material": "metal", "thickness": 0.01,
            "supports": {"edges": {"nodes": ["x0"]}}
        }},
        "load_cases": {"pressure": {"p": {"pressure": {"faces": "all", "pressure": 10}}}},
        "functions": {"compliance": {"compliance": {"case": "pressure"}}}
    }));
    let entries = solved(&problem).factor_entries().expect("a factor");
    assert!(entries > 1000, "{entries}");
}

fn material() -> Value {
    json!({"metal": {"young": 70e9, "poisson": 0.3, "density": 2700, "yield_stress": 270e6}})
}

/// A panel by one of the generators, with its sizes as variables.
fn panels() -> Vec<(&'static str, Value, Vec<&'static str>)> {
    let bent = json!({"panel": {"elements": [3, 2], "points": [
        [0, 0, 0], [0.5, 0.02, 0.11], [1, 0, 0.03], [0.01, 0.3, 0.02], [0.52, 0.3, 0.13],
        [1.02, 0.31, 0.05], [0, 0.6, 0], [0.5, 0.61, 0.1], [1, 0.6, 0.02]
    ]}});
    vec![
        (
            "plate",
            json!({"plate": {"length": 1, "width": 0.6, "elements": [3, 2]}}),
            vec!["plate/length", "plate/width"],
        ),
        ("panel", bent, vec!["panel/points/4/2", "panel/points/5/0"]),
        (
            "curved panel",
            json!({"curved_panel": {"radius": 1.2, "length": 0.8, "angles": [0.3, 1.2],
                                    "elements": [3, 2]}}),
            vec![
                "curved_panel/radius",
                "curved_panel/length",
                "curved_panel/angles/1",
            ],
        ),
        (
            "cylinder",
            json!({"cylinder": {"radius": 0.5, "length": 0.7, "elements": [6, 2]}}),
            vec!["cylinder/radius", "cylinder/length"],
        ),
    ]
}

fn variables_of(structure: &str, mesh: &Value, sizes: &[&str]) -> Value {
    let mut variables = json!({});
    for size in sizes {
        let at = mesh
            .pointer(&format!("/{size}"))
            .and_then(Value::as_f64)
            .expect("a size");
        variables[*size] = json!({
            "path": format!("/structures/{structure}/mesh/{size}"),
            "lower": at - 0.3, "upper": at + 0.3, "scale": 0.1
        });
    }
    variables
}

/// Sizes, thicknesses of every kind, material, loads and masses, in linear statics and with von Karman's
/// strains, five and six unknowns a node.
#[test]
fn gradients_of_panels_of_every_kind_agree_with_the_complex_step() {
    let thicknesses = [
        json!({"per": "element", "value": 0.05}),
        json!({"per": "band", "along": "x", "value": 0.05}),
        json!({"per": "patch", "patches": [3, 1], "value": 0.05}),
        json!({"per": "group", "groups": ["one", "other"], "value": 0.05}),
    ];
    let kinds = [
        ("linear", "five"),
        ("von_karman", "five"),
        ("linear", "six"),
        ("von_karman", "six"),
    ];
    for (k, (name, mesh, sizes)) in panels().into_iter().enumerate() {
        let (strains, unknowns) = kinds[k];
        let mut variables = variables_of("s", &mesh, &sizes);
        let mut add = |name: &str, path: &str, bounds: [f64; 2]| {
            variables[name] = json!({"path": path, "lower": bounds[0], "upper": bounds[1]});
        };
        add("thickness", "/structures/s/thickness/value", [0.01, 0.2]);
        add("young", "/materials/metal/young", [1e9, 1e11]);
        add("poisson", "/materials/metal/poisson", [0.0, 0.45]);
        add("density", "/materials/metal/density", [100.0, 9000.0]);
        add("yield", "/materials/metal/yield_stress", [1e6, 1e9]);
        add("pressure", "/load_cases/a/p/pressure/pressure", [1e3, 1e6]);
        add("pull", "/load_cases/b/e/edge/force/1", [-1e5, 1e5]);
        add("tip", "/structures/s/masses/m/mass", [0.0, 9.0]);
        add("coat", "/structures/s/surface_mass", [0.0, 9.0]);
        let document = json!({
            "version": 1, "name": name, "materials": material(),
            "statics": {"strains": strains, "node_unknowns": unknowns},
            "structures": {"s": {
                "mesh": mesh, "material": "metal", "thickness": thicknesses[k], "surface_mass": 2,
                "sets": {"one": {"elements": {"from": [0, 0], "to": [0.5, 1]}},
                         "other": {"elements": {"from": [0, 0], "to": [1, 1]}},
                         "tip": {"node": {"at": [0.5, 1]}}},
                "supports": {"foot": {"nodes": ["y0"]}},
                "masses": {"m": {"nodes": "tip", "mass": 3}}
            }},
            "load_cases": {
                "a": {"p": {"pressure": {"faces": "all", "pressure": 3e4}}},
                "b": {"e": {"edge": {"edges": "y1", "force": [1e3, 2e4, 3e3]}},
                      "f": {"point": {"nodes": "tip", "force": [1e3, 2e3, -3e3]}},
                      "w": {"gravity": {"acceleration": [0, -9.81, 3]}},
                      "q": {"area": {"faces": "one", "force": [1e3, 0, 2e3]}}}
            },
            "functions": {
                "mass": "mass",
                "centre": {"centre_of_mass": {"direction": [1, 2, 1]}},
                "inertia": {"moment_of_inertia": {"axis": [0, 1, 0]}},
                "energy": {"strain_energy": {"case": "a"}},
                "compliance": {"compliance": {"case": "b"}},
                "tip": {"displacement": {"case": "b", "nodes": "tip", "direction": [1, -1, 2]}},
                "reaction": {"reaction": {"case": "a", "nodes": "y0", "direction": [0.2, 0, 1]}},
                "stress": {"von_mises": {"rho": 30}},
                "induced": {"von_mises": {"rho": 20, "aggregate": "induced_exponential", "cases": ["b"]}},
                "lowest": {"lowest_frequency": {"rho": 0.05}},
                "first": {"frequency": {"mode": 1}}
            },
            "variables": variables
        });
        let mut document = document;
        if name == "cylinder" {
            // Its frequencies come in pairs, and single ones have no derivative.
            let functions = document["functions"].as_object_mut().expect("functions");
            functions.shift_remove("first");
            // Nothing pulls a whole cylinder sideways.
            functions.shift_remove("reaction");
        }
        assert_gradients(name, &parsed(&document));
    }
}

#[test]
fn gradients_of_beams_agree_with_the_complex_step() {
    let frame = json!({"frame": {
        "points": {"a": [0, 0, 0], "b": [0, 0, 1], "c": [1, 0.2, 1.1], "d": [1, 0, 0]},
        "members": {
            "left": {"between": ["a", "b"], "orientation": [0, 1, 0], "elements": 2},
            "beam": {"between": ["b", "c"], "orientation": [0, 1, 0], "elements": 3},
            "right": {"between": ["c", "d"], "orientation": [0, 1, 0], "elements": 2}
        }
    }});
    let arc = json!({"curved_beam": {"radius": 0.8, "angles": [0.2, 1.7], "elements": 4}});
    let bar = json!({"straight_beam": {"from": [0, 0, 0], "to": [1, 0.2, 0.1], "orientation": [0, 0, 1],
                                       "elements": 3}});
    let cases = [
        (
            "frame",
            frame,
            "a",
            "c",
            json!({"sections": {"per": "group", "groups": ["left", "beam", "right"],
                                "value": {"rectangle": {"width": 0.04, "height": 0.06}}}}),
            vec!["frame/points/c/2", "frame/points/b/0"],
            "sections/value/rectangle/height",
        ),
        (
            "arc",
            arc,
            "start",
            "end",
            json!({"sections": {"per": "element", "value": {"tube": {"radius": 0.03, "wall": 0.005}}},
                   "line_mass": 0.3}),
            vec!["curved_beam/radius", "curved_beam/angles/1"],
            "sections/value/tube/wall",
        ),
        (
            "bar",
            bar,
            "start",
            "end",
            json!({"section": {"i": {"width": 0.05, "height": 0.08, "flange": 0.006, "web": 0.004}},
                   "offset": [0.01, -0.02]}),
            vec!["straight_beam/to/0", "straight_beam/to/2"],
            "section/i/web",
        ),
    ];
    for (name, mesh, foot, tip, section, sizes, wall) in cases {
        let mut variables = variables_of("s", &mesh, &sizes);
        variables["wall"] =
            json!({"path": format!("/structures/s/{wall}"), "lower": 0.001, "upper": 0.2});
        variables["young"] = json!({"path": "/materials/metal/young", "lower": 1e9, "upper": 1e11});
        let mut structure = json!({
            "mesh": mesh, "material": "metal", "supports": {"foot": {"nodes": [foot]}}
        });
        for (key, value) in section.as_object().expect("keys") {
            structure[key] = value.clone();
        }
        let document = json!({
            "version": 1, "name": name, "materials": material(), "structures": {"s": structure},
            "load_cases": {
                "pull": {"tip": {"point": {"nodes": tip, "force": [100, 200, -300], "moment": [3, 2, 1]}}},
                "weight": {"own": {"gravity": {"acceleration": [0, 0, -9.81]}},
                           "wind": {"line": {"beams": "all", "force": [30, 20, 0]}}}
            },
            "functions": {
                "mass": "mass",
                "sag": {"displacement": {"case": "weight", "nodes": tip, "direction": [1, 1, 1]}},
                "compliance": {"compliance": {"case": "pull"}},
                "moment": {"reaction_moment": {"case": "pull", "nodes": foot, "axis": [1, 1, 0]}},
                "lowest": {"lowest_frequency": {"rho": 0.2}}
            },
            "variables": variables
        });
        assert_gradients(name, &parsed(&document));
    }
}

/// Errors that are estimated beside those against a mesh six times as fine.
#[test]
fn estimated_errors_are_those_against_a_converged_mesh() {
    let coarse = |n: usize, structure: &str, mesh: &str| {
        format!("/structures/{structure}/mesh/{mesh}/elements=[{n},{n}]")
    };
    for (name, changes) in [
        ("plate_patches", coarse(8, "plate", "plate")),
        ("scordelis_lo", coarse(8, "roof", "curved_panel")),
    ] {
        let problem = shipped(name, &[&changes]);
        let at = solved(&problem);
        let all: Vec<usize> = (0..problem.function_names.len()).collect();
        let found = error::estimate(&problem, &at, &all, false).expect("a finer mesh");
        let reference = error::refined(&problem, &at.x, 6, &all).expect("a fine mesh");
        for estimate in found {
            let f = estimate.function;
            let value = error::comparable(&at, &reference, f).value;
            let error = (at.function(f).value - value).abs();
            let function = &problem.function_names[f];
            println!(
                "{name}, {function}: error {error:.2e}, estimated {:.2e}",
                estimate.value.error
            );
            if error <= 1e-9 * value.abs() {
                assert!(estimate.value.error <= 1e-8 * value.abs());
                continue;
            }
            let ratio = estimate.value.error / error;
            assert!((0.4..4.0).contains(&ratio), "{name}, {function}: {ratio}");
        }
    }
}

pub(super) fn solve(problem: &Problem) -> Optimisation {
    optimise(problem, "", None, KnownEvaluations::default(), &mut |_| {
        ControlFlow::Continue(())
    })
    .expect("an objective and variables")
}

/// The thicknesses of the 4 × 4 patches, row by row, as a change of the file.
fn patches([corners, edges, middle]: [f64; 3]) -> String {
    let of = |k: usize| match ([0, 3].contains(&(k % 4)), [0, 3].contains(&(k / 4))) {
        (true, true) => corners,
        (false, false) => middle,
        _ => edges,
    };
    let all: Vec<f64> = (0..16).map(of).collect();
    format!("/structures/plate/thickness/values={all:?}")
}

/// The sizing of a plate by an independent code, whose energy does not tie curvatures: the only difference.
/// Its stresses are those of the motion, as here.
#[test]
fn the_plate_of_patches_agrees_with_another_code() {
    let text = include_str!("../data/structures/shell_plate.json");
    let reference: Value = serde_json::from_str(text).expect("JSON");
    let sizing = &reference["sizing"];
    let number = |value: &Value| value.as_f64().expect("a number");
    let thickness: Vec<f64> = (sizing["thickness_mm"].as_array().expect("a list").iter())
        .map(|h| 1e-3 * number(h))
        .collect();
    let near = |what: &str, found: f64, expected: f64, tolerance: f64| {
        println!("{what}: {found}, {expected} expected");
        let off = (found / expected - 1.0).abs();
        assert!(off < tolerance, "{what}: {found}, {expected} expected");
    };
    let mass = number(&sizing["mass_kg"]);
    let there = shipped(
        "plate_patches",
        &[&patches([0, 1, 5].map(|k| thickness[k]))],
    );
    let at = solved(&there);
    let value = |name: &str| {
        let f = there.function_names.iter().position(|own| own == name);
        at.function(f.expect("a function")).value
    };
    near("mass", value("mass"), mass, 1e-6);
    near(
        "deflection",
        value("deflection"),
        number(&sizing["centre_deflection_m"]),
        1e-3,
    );
    near("stress", value("stress"), 1.0, 2.1e-3);
    // The record of the problem is the optimum from the start of the file.
    let start = [0.004, 0.015, 0.009];
    let done = solve(&shipped("plate_patches", &[&patches(start)]));
    let optimum = &done.optimum;
    assert_eq!(
        optimum.status, "converged",
        "{start:?}: {}",
        optimum.message
    );
    let found = optimum.objective.value;
    near("mass", found, mass, 1e-3);
    let multiplier = optimum.constraints["yield"].multiplier.abs();
    near(
        "multiplier",
        multiplier,
        number(&sizing["multiplier_kg"]),
        1e-3,
    );
    for (patch, k) in [("corners", 0), ("edges", 1), ("middle", 5)] {
        near(patch, optimum.design[patch].value, thickness[k], 1e-2);
    }
    // A prototype of the same element in another language.
    near("mass from all starts", found, 22.482_408_1, 1e-6);
}

/// Cells of a file of fields name their nodes as VTK has them: corners, middles of edges, centre.
#[test]
fn files_of_fields_have_cells_whose_middles_are_in_the_middle() {
    let problem = shipped(
        "scordelis_lo",
        &["/structures/roof/mesh/curved_panel/elements=[8,3]"],
    );
    let text = fields::fields(&solved(&problem));
    let array = |name: &str| -> Vec<f64> {
        let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).expect(name);
        let (_, rest) = rest.split_once('>').expect("the end of the tag");
        let (numbers, _) = rest.split_once("</DataArray>").expect("its closing tag");
        let numbers = numbers.split_whitespace();
        numbers.map(|x| x.parse().expect("a number")).collect()
    };
    let points: Vec<[f64; 3]> = array("Points")
        .chunks(3)
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    let cells = array("connectivity");
    assert_eq!((points.len(), cells.len()), (17 * 7, 24 * 9));
    assert!(array("types").iter().all(|&kind| kind == 28.0));
    assert_eq!(array("offsets").last(), Some(&216.0));
    assert_eq!(array("displacement, dead load [m]").len(), 3 * points.len());
    assert_eq!(array("thickness [m]"), vec![0.25; 24]);
    let distance = |a: &[f64; 3], b: &[f64; 3]| -> f64 {
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    for cell in cells.chunks(9) {
        let node = |k: usize| &points[cell[k] as usize];
        for (middle, ends) in [
            (4, [0, 1]),
            (5, [1, 2]),
            (6, [2, 3]),
            (7, [3, 0]),
            (8, [0, 2]),
        ] {
            let [a, b] = ends.map(|k| distance(node(middle), node(k)));
            assert!((a / b - 1.0).abs() < 1e-9, "node {middle} of {cell:?}");
        }
    }
}
