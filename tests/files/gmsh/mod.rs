//! Meshes from files of Gmsh: against the generators in every format, order, unit and winding, a plate with a hole
//! against Howland, moving bodies, and files with faults.

use crate::reference::documents::{plates, run};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::Simulated;
use flexbody_problem::Problem;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

mod faults;
pub mod plate;

use plate::{Format, PLAIN, plate, point};

/// A problem beside files of these texts, or its faults.
pub fn parsed(document: &Value, files: &[(&str, &str)]) -> Result<Problem, String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let file = folder.path().join("scene.json").display().to_string();
    Problem::parse(&document.to_string(), &file, &[]).map_err(|faults| faults.to_string())
}

pub fn at_rest(mesh: Value) -> Value {
    json!({
        "version": 1, "name": "plate",
        "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850, "yield_stress": 2e8}},
        "structures": {"plate": {
            "mesh": mesh, "material": "steel", "thickness": 0.01,
            "supports": {"edge": {"nodes": "x0"}},
            "masses": {"tip": {"nodes": "x0y0", "mass": 0.3}}
        }},
        "load_cases": {
            "edge": {"edge": {"edge": {"edges": "x1", "force": [100, 20, 300]}}},
            "area": {"all": {"pressure": {"faces": "all", "pressure": 5000}}}
        },
        "functions": {
            "mass": "mass",
            "stress": {"von_mises": {"rho": 50}},
            "tip": {"displacement": {"case": "edge", "nodes": "x1", "direction": [0.2, 0.3, 1]}},
            "side": {"displacement": {"case": "area", "nodes": "y1", "direction": [0, 0, 1]}},
            "reaction": {"reaction": {"case": "area", "nodes": "x0", "direction": [0, 0, 1]}},
            "frequency": {"frequency": {"mode": 2}}
        },
        "variables": {"t": {"path": "/structures/plate/thickness", "lower": 0.005, "upper": 0.02}}
    })
}

pub fn values(problem: &Problem) -> Vec<f64> {
    let at = Simulated::of(problem, &problem.start()).expect("an analysis");
    (0..problem.function_names.len())
        .map(|f| at.value(f))
        .collect()
}

pub fn assert_close(found: &[f64], expected: &[f64], part: f64, what: &str) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!(
            (f - e).abs() <= part * e.abs(),
            "{what}: {found:?} {expected:?}"
        );
    }
}

pub const SIZE: [f64; 2] = [0.6, 0.3];
pub const ELEMENTS: [usize; 2] = [4, 3];

#[test]
fn every_format_gives_the_plate_of_the_generator() {
    let generated = json!({"plate": {"length": 0.6, "width": 0.3, "elements": ELEMENTS}});
    let expected = values(&parsed(&at_rest(generated), &[]).expect("a problem"));
    for version in ["2.2", "4.1"] {
        for nodes in [4, 8, 9] {
            for (unit, metres) in [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("inch", 0.0254)] {
                for turned in [false, true] {
                    let format = Format {
                        version,
                        nodes,
                        unit,
                        metres,
                        turned,
                    };
                    let text = plate(SIZE, ELEMENTS, format);
                    let file = at_rest(json!({"gmsh": {"file": "a.msh", "unit": format.unit}}));
                    let problem = parsed(&file, &[("a.msh", &text)]).expect("a problem");
                    let what = format!("{version} {nodes} {unit} {turned}");
                    assert_close(&values(&problem), &expected, 1e-9, &what);
                }
            }
        }
    }
}

/// Error estimates cut every element: the cut mesh has the sets, and the functions those of the generator.
#[test]
fn a_mesh_from_a_file_is_cut_as_that_of_the_generator() {
    let generated = json!({"plate": {"length": 0.6, "width": 0.3, "elements": ELEMENTS}});
    let error = |problem: &Problem| -> Vec<f64> {
        let at = Simulated::of(problem, &problem.start()).expect("an analysis");
        let all: Vec<usize> = (0..5).collect();
        let found = at.estimate(problem, &all, false).expect("errors");
        found.iter().map(|own| own.value.error).collect()
    };
    let expected = error(&parsed(&at_rest(generated), &[]).expect("a problem"));
    let text = plate(SIZE, ELEMENTS, PLAIN);
    let file = at_rest(json!({"gmsh": {"file": "a.msh"}}));
    let found = error(&parsed(&file, &[("a.msh", &text)]).expect("a problem"));
    for (found, expected) in found.iter().zip(&expected) {
        assert!(
            (found - expected).abs() <= 1e-6 * expected.abs() + 1e-12,
            "{found} {expected}"
        );
    }
}

#[test]
fn surfaces_are_groups_with_a_thickness_each() {
    let text = plate(
        SIZE,
        ELEMENTS,
        Format {
            turned: true,
            ..PLAIN
        },
    );
    let mut file = at_rest(json!({"gmsh": {"file": "a.msh"}}));
    // The reaction depends on no thickness.
    file["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("reaction");
    file["structures"]["plate"]["thickness"] =
        json!({"per": "group", "groups": ["left", "right half"], "values": [0.01, 0.02]});
    file["variables"] = json!({
        "left": {"path": "/structures/plate/thickness/values/0", "lower": 0.005, "upper": 0.03},
        "right": {"path": "/structures/plate/thickness/values/1", "lower": 0.005, "upper": 0.03}
    });
    let problem = parsed(&file, &[("a.msh", &text)]).expect("a problem");
    let mass = values(&problem)[0];
    assert!(
        (mass - 7850.0 * 0.3 * 0.3 * (0.01 + 0.02) - 0.3).abs() < 1e-9,
        "{mass}"
    );
    gradients_are_exact(&problem, &json!("groups of a file"));
    // One value stands for as many elements as the file has.
    file["structures"]["plate"]["thickness"] = json!({"per": "element", "value": 0.01});
    file["variables"] =
        json!({"t": {"path": "/structures/plate/thickness/value", "lower": 0.005, "upper": 0.03}});
    let problem = parsed(&file, &[("a.msh", &text)]).expect("a problem");
    assert_eq!(problem.variables().len(), ELEMENTS[0] * ELEMENTS[1]);
}

/// An element that is in two groups is one element, which MSH 2.2 writes twice.
#[test]
fn an_element_in_two_groups_is_one() {
    let text = plate(
        SIZE,
        [2, 1],
        Format {
            version: "2.2",
            ..PLAIN
        },
    );
    let quads: Vec<String> = (text.lines().filter(|line| line.contains(" 10 2 ")))
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            let number: usize = words[0].parse().expect("a number");
            format!("{} 10 2 9 1 {}", number + 100, words[5..].join(" "))
        })
        .collect();
    let elements = text.split("$Elements\n").nth(1).expect("elements");
    let count: usize = elements
        .lines()
        .next()
        .expect("a count")
        .parse()
        .expect("a count");
    let more = format!("$Elements\n{}\n", count + quads.len());
    let text = text
        .replace(&format!("$Elements\n{count}\n"), &more)
        .replace(
            "$EndElements",
            &format!("{}\n$EndElements", quads.join("\n")),
        );
    let mut file = at_rest(json!({"gmsh": {"file": "a.msh"}}));
    file["load_cases"]["area"]["all"]["pressure"]["faces"] = json!("surface9");
    let problem = parsed(&file, &[("a.msh", &text)]).expect("a problem");
    assert!((values(&problem)[0] - 7850.0 * 0.18 * 0.01 - 0.3).abs() < 1e-9);
    assert!(
        (values(&problem)[4] + 5000.0 * 0.18).abs() < 1e-6,
        "{:?}",
        values(&problem)
    );
}

fn data(name: &str, document: &Value) -> Problem {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gmsh");
    let file = folder.join(name).display().to_string();
    Problem::parse(&document.to_string(), &file, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A strip under tension with a hole of 0.4 of its width: the stress at the hole is 3.74 times that far away (Howland
/// 1930).
#[test]
fn the_stress_beside_a_hole_is_that_of_howland() {
    let problem = data(
        "hole.json",
        &json!({
            "version": 1, "name": "hole",
            "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850, "yield_stress": 1e6}},
            "structures": {"plate": {
                "mesh": {"gmsh": {"file": "plate_hole.msh", "unit": "mm"}},
                "material": "steel", "thickness": 0.002,
                "supports": {
                    "end": {"nodes": "left", "held": ["x", "z", "ry"]},
                    "corner": {"nodes": "corner", "held": ["y"]}
                }
            }},
            "load_cases": {"pull": {"end": {"edge": {"edges": "right", "force": [2000, 0, 0]}}}},
            "functions": {"mass": "mass", "stress": {"von_mises": {"rho": 100}}},
            "variables": {"t": {"path": "/structures/plate/thickness", "lower": 0.001, "upper": 0.003}}
        }),
    );
    let at = Simulated::of(&problem, &problem.start()).expect("an analysis");
    let area = 0.3 * 0.1 - std::f64::consts::PI * 0.02_f64.powi(2);
    // Parabolas instead of circles.
    assert!((at.value(0) / (7850.0 * 0.002 * area) - 1.0).abs() < 1e-5);
    let peak = at.maximum(1).expect("a maximum");
    assert!((peak / 3.74 - 1.0).abs() < 0.03, "{peak}");
    gradients_are_exact(&problem, &json!("plate with a hole"));
}

/// A plate that moves, from a file and from the generator.
#[test]
fn a_moving_body_from_a_file_is_that_of_the_generator() {
    let generated = plates([4, 2], 0.02, 8, &json!({"radau": {"stages": 2}}));
    let expected = run(&generated);
    let mesh = &generated["bodies"]["first"]["elements"]["structure"]["mesh"]["plate"];
    let size = ["length", "width"].map(|key| mesh[key].as_f64().expect("a size"));
    let mut file = generated.clone();
    file["bodies"]["first"]["elements"]["structure"]["mesh"] =
        json!({"gmsh": {"file": "a.msh", "unit": "mm"}});
    let format = Format {
        unit: "mm",
        metres: 0.001,
        ..PLAIN
    };
    let mut text = plate(size, [4, 2], format);
    // The nodes that the axes name.
    let structure = &mut file["bodies"]["first"]["elements"]["structure"];
    structure
        .as_object_mut()
        .expect("a structure")
        .remove("sets");
    for (number, name, column) in [(2, "start", 0), (3, "end", 8), (4, "middle", 4)] {
        let node = 3 * (9 * 5 - (2 * 9 + column)) + 4;
        text = point(&text, number, name, node);
    }
    let problem = parsed(&file, &[("a.msh", &text)]).unwrap_or_else(|faults| panic!("{faults}"));
    let found = flexbody_driver::simulate(&problem, &problem.start()).expect("a motion");
    for f in 0..problem.function_names.len() {
        let (found, expected) = (found.at.function(f).value, expected.at.function(f).value);
        assert!(
            (found - expected).abs() <= 1e-8 * expected.abs().max(1e-3),
            "{found} {expected}"
        );
    }
}

/// The plate with a hole as a body that is held at the rim.
fn held_at_the_rim(frame: &str, basis: Value, point: Value) -> Value {
    json!({
        "version": 1, "name": "rim", "gravity": [0.3, -9.81, 2.0],
        "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850}},
        "bodies": {"plate": {
            "elements": {
                "structure": {
                    "mesh": {"gmsh": {"file": "plate_hole.msh", "unit": "mm"}},
                    "material": "steel", "thickness": 0.002
                },
                "frame": {"clamped": frame},
                "basis": basis,
                "points": {"rim": point, "corner": {"node": "corner"}}
            },
            "place": {"put": "rim", "at": [0.1, 0.2, 0.3]}
        }},
        "functions": {"mass": "mass"}
    })
}

/// Axes that are clamped elsewhere see how the whole rim moves: a stiff plate on a pin through its hole swings as the
/// rigid one.
#[test]
fn a_plate_on_a_pin_swings_as_the_rigid_one() {
    let swing = |basis: Value, point: Value| {
        let mut file = held_at_the_rim("right", basis, point);
        file["joints"] = json!({"pin": {"revolute": {
            "between": ["plate", "ground"], "at": "plate.rim", "axis": [0, 0, 1]
        }}});
        file["loads"] = json!({"push": {"force": {
            "body": "plate", "point": "corner", "direction": [0, 1, 0], "magnitude": 2
        }}});
        file["simulation"] =
            json!({"duration": 0.15, "steps": 40, "method": {"radau": {"stages": 2}}});
        file["functions"] = json!({
            "x": {"final": {"position": {"body": "plate", "point": "corner", "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": "plate", "point": "corner", "direction": [0, 1, 0]}}}
        });
        let problem = data("rim.json", &file);
        let at = Simulated::of(&problem, &problem.start()).expect("a motion");
        [at.value(0), at.value(1)]
    };
    let rigid = swing(json!("rigid"), json!({"mean": "hole"}));
    let turned = (rigid[1] - 0.15) / 0.05;
    assert!(turned.abs() > 0.3, "{rigid:?}");
    let reduced = json!({"reduced": {"modes": 3}});
    for point in [json!({"mean": "hole"}), json!({"rigid": "hole"})] {
        let found = swing(reduced.clone(), point.clone());
        for k in 0..2 {
            assert!(
                (found[k] - rigid[k]).abs() < 2e-5,
                "{point}: {found:?} {rigid:?}"
            );
        }
    }
}

/// A rim that a weld holds is clamped, as by a support at rest.
#[test]
fn a_welded_rim_is_that_of_a_support() {
    let mut file = held_at_the_rim("hole", json!("full"), json!({"edge": "hole"}));
    file["joints"] = json!({"wall": {"weld": {"between": ["plate", "ground"], "at": "plate.rim"}}});
    file["analysis"] = json!("rest");
    file["gravity"] = json!([0, 0, -2]);
    file["functions"] = json!({
        "sag": {"final": {"position": {"body": "plate", "point": "corner", "direction": [0, 0, 1]}}}
    });
    file["variables"] = json!({"t": {
        "path": "/bodies/plate/elements/structure/thickness", "lower": 0.001, "upper": 0.003
    }});
    let problem = data("rim.json", &file);
    let at = Simulated::of(&problem, &problem.start()).expect("a rest");
    let sag = at.value(0) - 0.3;
    gradients_are_exact(&problem, &json!("a welded rim"));
    let mut still = json!({
        "version": 1, "name": "rim", "materials": file["materials"],
        "structures": {"plate": file["bodies"]["plate"]["elements"]["structure"]},
        "load_cases": {"weight": {"own": {"gravity": {"acceleration": [0, 0, -2]}}}},
        "functions": {"sag": {"displacement": {
            "case": "weight", "nodes": "corner", "direction": [0, 0, 1]
        }}},
        "variables": {"t": {"path": "/structures/plate/thickness", "lower": 0.001, "upper": 0.003}}
    });
    still["structures"]["plate"]["supports"] = json!({"rim": {"nodes": "hole"}});
    let problem = data("still.json", &still);
    let expected = Simulated::of(&problem, &problem.start())
        .expect("a rest")
        .value(0);
    assert!((sag / expected - 1.0).abs() < 1e-3, "{sag} {expected}");
}

/// The same plate as a moving body that a weld holds at one end, with the pull at the other set on slowly: the stress beside the hole
/// is Howland's, of all nodes and of a few modes with the static solution of the pull.
#[test]
fn the_stress_beside_the_hole_of_a_moving_body_is_that_of_howland() {
    let mut file = held_at_the_rim("left", json!("full"), json!({"edge": "left"}));
    file["gravity"] = json!([0, 0, 0]);
    // 20 kN/m on 2 mm.
    file["materials"]["steel"]["yield_stress"] = json!(1e7);
    file["joints"] = json!({"wall": {"weld": {"between": ["plate", "ground"], "at": "plate.rim"}}});
    // The lowest vibration along the strip takes 0.23 ms.
    file["loads"] = json!({"pull": {"edge": {
        "body": "plate", "edges": "right", "direction": [1, 0, 0],
        "magnitude": {"table": {"times": [0, 0.01, 0.02], "values": [0, 20000, 20000], "interpolation": "spline"}}
    }}});
    file["simulation"] = json!({"duration": 0.02, "steps": 30, "method": {"bdf": {"order": 2}}});
    file["functions"] = json!({"stress": {"final": {"von_mises": {"body": "plate", "rho": 100}}}});
    let peak = |file: &Value| {
        let problem = data("rim.json", file);
        let at = Simulated::of(&problem, &problem.start()).expect("a motion");
        at.smoothed(0).expect("a true value").value
    };
    let full = peak(&file);
    assert!((full / 3.74 - 1.0).abs() < 0.03, "{full}");
    file["bodies"]["plate"]["elements"]["basis"] = json!({"reduced": {"modes": 3}});
    let reduced = peak(&file);
    assert!((reduced / full - 1.0).abs() < 2e-3, "{reduced} {full}");
}

/// Lines without surfaces are beams.
#[test]
fn lines_alone_are_beams() {
    let mut text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n0 1 \"start\"\n0 2 \"end\"\n\
                    1 1 \"arm\"\n$EndPhysicalNames\n$Nodes\n5\n"
            .to_owned();
    (0..5).for_each(|k| {
        let _ = writeln!(text, "{} {} 0 0", k + 1, 250 * k);
    });
    text += "$EndNodes\n$Elements\n6\n1 15 2 1 1 1\n2 15 2 2 1 5\n";
    (0..4).for_each(|k| {
        let _ = writeln!(text, "{} 1 2 1 1 {} {}", k + 3, k + 1, k + 2);
    });
    text += "$EndElements\n";
    let file = |mesh: Value, line: &str| {
        json!({
            "version": 1, "name": "arm",
            "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850}},
            "structures": {"arm": {
                "mesh": mesh, "material": "steel",
                "section": {"rectangle": {"width": 0.02, "height": 0.03}},
                "supports": {"wall": {"nodes": "start"}}
            }},
            "load_cases": {
                "tip": {"tip": {"point": {"nodes": "end", "force": [10, 20, 30]}}},
                "line": {"line": {"line": {"beams": line, "force": [0, 5, 7]}}}
            },
            "functions": {
                "tip": {"displacement": {"case": "tip", "nodes": "end", "direction": [0, 1, 1]}},
                "line": {"displacement": {"case": "line", "nodes": "end", "direction": [0, 1, 1]}}
            },
            "variables": {"b": {"path": "/structures/arm/section/rectangle/width", "lower": 0.01, "upper": 0.04}}
        })
    };
    let generated = json!({"straight_beam": {
        "from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 1, 0], "elements": 4
    }});
    let expected = values(&parsed(&file(generated, "all"), &[]).expect("a problem"));
    let read = json!({"gmsh": {"file": "a.msh", "unit": "mm", "orientation": [0, 1, 0]}});
    let problem = parsed(&file(read, "arm"), &[("a.msh", &text)]).expect("a problem");
    assert_close(&values(&problem), &expected, 1e-9, "beams");
    gradients_are_exact(&problem, &json!("beams of a file"));
    let without = json!({"gmsh": {"file": "a.msh", "unit": "mm"}});
    let faults = parsed(&file(without, "arm"), &[("a.msh", &text)]).expect_err("no orientation");
    assert!(faults.contains("no \"orientation\" of beams"), "{faults}");
}

/// A strip of three elements of four nodes, twisted by an angle \[rad\] in all.
fn twisted(angle: f64) -> String {
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_string();
    text += "$PhysicalNames\n2\n1 1 \"root\"\n2 2 \"strip\"\n$EndPhysicalNames\n$Nodes\n8\n";
    for k in 0..8 {
        let (i, side) = (f64::from(k / 2), f64::from(k % 2) - 0.5);
        let (sine, cosine) = (angle * i / 3.0).sin_cos();
        let _ = writeln!(text, "{} {i} {} {}", k + 1, side * cosine, side * sine);
    }
    text += "$EndNodes\n$Elements\n4\n4 1 2 1 1 1 2\n";
    for i in 0..3 {
        let first = 2 * i + 1;
        let _ = writeln!(
            text,
            "{} 3 2 2 1 {first} {} {} {}",
            i + 1,
            first + 2,
            first + 3,
            first + 1
        );
    }
    text + "$EndElements\n"
}

#[test]
fn warped_elements_are_told() {
    for (angle, is_told) in [(0.3, false), (1.5, true)] {
        let mut document = at_rest(json!({"gmsh": {"file": "strip.msh", "unit": "m"}}));
        document["structures"]["plate"]["supports"] = json!({"edge": {"nodes": "root"}});
        for key in ["load_cases", "functions", "variables"] {
            document[key] = json!({});
        }
        document["structures"]["plate"]["masses"] = json!({});
        document["structures"]["plate"]["element"] = json!("mitc4");
        let read = parsed(&document, &[("strip.msh", &twisted(angle))]).expect("a problem");
        let told = read.notes_of_input().join("\n");
        assert_eq!(told.contains("is warped"), is_told, "{angle}: {told}");
    }
}

/// A base of two elements and a web on their common edge, or one element and two that branch from it, each `turned_over`
/// or not.
fn three_sheets(branches: bool, turned_over: [bool; 3]) -> String {
    let (right, third) = match branches {
        true => ([1, 2], [1, -2]),
        false => ([1, 0], [0, 10]),
    };
    let edge = |[x, z]: [i32; 2]| [[x, 0, z], [x, 10, z]];
    let places = [edge([-1, 1]), edge([0, 0]), edge(right), edge(third)].concat();
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_string();
    text += "$PhysicalNames\n3\n1 1 \"root\"\n1 2 \"tip\"\n2 3 \"tee\"\n$EndPhysicalNames\n";
    text += "$Nodes\n8\n";
    for (k, [x, y, z]) in places.iter().enumerate() {
        let _ = writeln!(text, "{} {} {}e-1 {}e-1", k + 1, x, y, z);
    }
    text += "$EndNodes\n$Elements\n5\n1 1 2 1 1 1 2\n2 1 2 2 2 7 8\n";
    let elements = [[1, 3, 4, 2], [3, 5, 6, 4], [3, 4, 8, 7]];
    for (k, (mut nodes, over)) in elements.into_iter().zip(turned_over).enumerate() {
        if over {
            nodes.reverse();
        }
        let nodes = nodes.map(|k| k.to_string()).join(" ");
        let _ = writeln!(text, "{} 3 2 3 1 {nodes}", k + 3);
    }
    text + "$EndElements\n"
}

/// Where a web meets a base, both halves of the base are one sheet, however their elements are wound; and each branch is one
/// with what it branches from.
#[test]
fn windings_do_not_matter_where_three_sheets_meet() {
    let mut document = at_rest(json!({"gmsh": {"file": "tee.msh", "unit": "m"}}));
    let plate = &mut document["structures"]["plate"];
    plate["supports"] = json!({"edge": {"nodes": "root"}});
    plate["masses"] = json!({});
    document["load_cases"] = json!({"a": {"f": {"edge": {"edges": "tip", "force": [1, 2, 3]}}}});
    document["functions"] = json!({
        "x": {"displacement": {"case": "a", "nodes": "tip", "direction": [1, 0, 0]}},
        "y": {"displacement": {"case": "a", "nodes": "tip", "direction": [0, 1, 0]}},
        "z": {"displacement": {"case": "a", "nodes": "tip", "direction": [0, 0, 1]}}
    });
    let of = |branches: bool, turned_over: [bool; 3]| {
        let text = three_sheets(branches, turned_over);
        let read = parsed(&document, &[("tee.msh", &text)]);
        values(&read.unwrap_or_else(|faults| panic!("{faults}")))
    };
    let expected = [false, true].map(|branches| of(branches, [false; 3]));
    for turned_over in [
        [true, false, false],
        [false, true, true],
        [false, false, true],
    ] {
        for (branches, expected) in [false, true].into_iter().zip(&expected) {
            let what = format!("{branches} {turned_over:?}");
            assert_close(&of(branches, turned_over), expected, 1e-10, &what);
        }
    }
}
