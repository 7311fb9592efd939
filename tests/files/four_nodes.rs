//! Shells of four nodes from files: at rest, from Gmsh and in motion, against the shells of nine nodes; what files may
//! not say.

use crate::gmsh::{ELEMENTS, SIZE, assert_close, at_rest, parsed as beside, plate, values};
use crate::reference::documents::{plates, problem as parsed, read, run};
use crate::reference::gradients::{
    gradients_are_exact, scaled_gradients_are_exact, thick_and_soft,
};
use flexbody_driver::Simulated;
use flexbody_problem::Problem;
use serde_json::Value;

/// A panel of the plate of [`at_rest`], turned about the x axis.
fn panel(angle: f64, elements: [usize; 2]) -> Value {
    let (sin, cos) = angle.sin_cos();
    let corner = |x: f64, y: f64| json!([x, y * cos, y * sin]);
    let [a, b] = SIZE;
    json!({"panel": {
        "points": [corner(0.0, 0.0), corner(a, 0.0), corner(0.0, b), corner(a, b)],
        "elements": elements
    }})
}

fn with_four(mut document: Value) -> Value {
    document["structures"]["plate"]["element"] = json!("mitc4");
    document
}

/// Displacements, reactions, frequencies and stresses tend to those of nine nodes on a fine mesh: errors are at most a
/// sixth after two refinements, those of stresses a quarter, as Gauss points come nearer to the edge with the size.
#[test]
fn functions_at_rest_tend_to_those_of_nine_nodes() {
    let mesh = |elements: [usize; 2]| json!({"plate": {"length": 0.6, "width": 0.3, "elements": elements}});
    let fine = values(&parsed(&at_rest(mesh([32, 16]))));
    let of = |n: usize| values(&parsed(&with_four(at_rest(mesh([2 * n, n])))));
    let [coarse, middle, finest] = [8, 16, 32].map(of);
    let names = parsed(&at_rest(mesh([2, 1]))).function_names;
    for (f, name) in names.iter().enumerate() {
        let error = |own: &[f64]| (own[f] / fine[f] - 1.0).abs();
        let all = [error(&coarse), error(&middle), error(&finest)];
        println!("{name}: {all:?}");
        let (limit, falls) = match name.as_str() {
            "mass" | "reaction" => {
                assert!(all[0] < 1e-9 && all[2] < 1e-9, "{name}: {all:?}");
                continue;
            }
            "stress" => (0.04, 4.0),
            _ => (1e-3, 6.0),
        };
        assert!(all[2] < limit && all[0] > falls * all[2], "{name}: {all:?}");
        assert!(all[0] > all[1] && all[1] > all[2], "{name}: {all:?}");
    }
}

/// A structure that is turned with its supports and loads is the same.
#[test]
fn a_turned_panel_is_the_same() {
    let at = |angle: f64| {
        let mut file = with_four(at_rest(panel(angle, [4, 3])));
        let (sin, cos) = angle.sin_cos();
        let turned = |[x, y, z]: [f64; 3]| json!([x, y * cos - z * sin, y * sin + z * cos]);
        file["load_cases"]["edge"]["edge"]["edge"]["force"] = turned([100.0, 20.0, 300.0]);
        file["functions"]["tip"]["displacement"]["direction"] = turned([0.2, 0.3, 1.0]);
        file["functions"]["side"]["displacement"]["direction"] = turned([0.0, 0.0, 1.0]);
        file["functions"]["reaction"]["reaction"]["direction"] = turned([0.0, 0.0, 1.0]);
        values(&parsed(&file))
    };
    let flat = at(0.0);
    for angle in [0.7, 2.0, -1.3] {
        assert_close(&at(angle), &flat, 1e-9, "turned");
    }
}

/// Sizes, thicknesses, material and loads, with linear and von Karman's strains, five and six unknowns a node.
#[test]
fn derivatives_at_rest_are_exact() {
    for (strains, unknowns) in [
        ("linear", "five"),
        ("linear", "six"),
        ("von_karman", "five"),
    ] {
        let mut file = with_four(at_rest(
            json!({"curved_panel": {"radius": 0.5, "length": 0.3, "angles": [0.2, 1.1], "elements": [4, 3]}}),
        ));
        file["statics"] = json!({"strains": strains, "node_unknowns": unknowns});
        if strains == "von_karman" {
            file["load_cases"]["area"]["all"]["pressure"]["pressure"] = json!(2e5);
            file["functions"]
                .as_object_mut()
                .expect("functions")
                .shift_remove("frequency");
        }
        // The panel is stiff along its axis, and carries no pressure along it.
        for (name, kind) in [("side", "displacement"), ("reaction", "reaction")] {
            file["functions"][name][kind]["direction"] = json!([1, 1, 0]);
        }
        file["load_cases"]["weight"] = json!({"g": {"gravity": {"acceleration": [1, -9, 2]}}});
        file["functions"]["sag"] =
            json!({"displacement": {"case": "weight", "nodes": "x1y1", "direction": [1, 1, 1]}});
        // With von Karman's strains the moment of the supports is a sum of terms eight times as large, and its round-off
        // beyond 1e-12 with any element.
        if strains == "linear" {
            file["functions"]["moment"] = json!({"reaction_moment": {"case": "edge", "nodes": "x0", "axis": [0, 0, 1], "about": [0, 0, 0]}});
        }
        file["structures"]["plate"]["thickness"] =
            json!({"per": "band", "along": "x", "bands": 2, "value": 0.01});
        file["variables"] = json!({
            "t": {"path": "/structures/plate/thickness/value", "lower": 0.005, "upper": 0.02},
            "radius": {"path": "/structures/plate/mesh/curved_panel/radius", "lower": 0.3, "upper": 1},
            "angle": {"path": "/structures/plate/mesh/curved_panel/angles/1", "lower": 1, "upper": 1.3},
            "young": {"path": "/materials/steel/young", "lower": 1e11, "upper": 3e11},
            "density": {"path": "/materials/steel/density", "lower": 1e3, "upper": 1e4},
            "load": {"path": "/load_cases/edge/edge/edge/force/1", "lower": 1, "upper": 100}
        });
        gradients_are_exact(&parsed(&file), &json!([strains, unknowns]));
    }
}

/// An estimate cuts every element into four, as a file with twice the elements.
#[test]
fn estimates_cut_elements_of_four_nodes() {
    let file = |elements: [usize; 2]| {
        let mut file = with_four(at_rest(
            json!({"plate": {"length": 0.6, "width": 0.3, "elements": elements}}),
        ));
        // Masses stand at the nodes of the file alone.
        file["structures"]["plate"]["sets"] = json!({"some": {"node": {"at": [0.5, 0.34]}}});
        file["functions"]["some"] =
            json!({"displacement": {"case": "edge", "nodes": "some", "direction": [0, 0, 1]}});
        parsed(&file)
    };
    let (coarse, fine) = (file([4, 3]), file([8, 6]));
    let at = Simulated::of(&coarse, &coarse.start()).expect("an analysis");
    let names = &coarse.function_names;
    // Other displacements are means over more nodes in the file with twice the elements.
    let same = ["mass", "reaction", "frequency", "some"];
    let which: Vec<usize> = (0..names.len())
        .filter(|&f| same.contains(&names[f].as_str()))
        .collect();
    assert_eq!(which.len(), same.len());
    let found = at.estimate(&coarse, &which, false).expect("errors");
    let (h, finer) = (values(&coarse), values(&fine));
    for own in found {
        let f = own.function;
        let expected = 4.0 / 3.0 * (h[f] - finer[f]).abs();
        let off = (own.value.error - expected).abs();
        assert!(
            off <= 1e-9 * h[f].abs(),
            "{}: {off:e} {expected:e}",
            names[f]
        );
    }
}

/// Every version, unit and winding of a file with quadrangles of four nodes; those of more are refused by line.
#[test]
fn quadrangles_of_gmsh_are_elements_of_four_nodes() {
    let generated = json!({"plate": {"length": 0.6, "width": 0.3, "elements": ELEMENTS}});
    let expected = values(&parsed(&with_four(at_rest(generated))));
    let file = |unit: &str| with_four(at_rest(json!({"gmsh": {"file": "a.msh", "unit": unit}})));
    for (version, turned) in [("2.2", false), ("2.2", true), ("4.1", false), ("4.1", true)] {
        for (unit, metres) in [("m", 1.0), ("mm", 0.001)] {
            let format = plate::Format {
                version,
                nodes: 4,
                unit,
                metres,
                turned,
            };
            let text = plate::plate(SIZE, ELEMENTS, format);
            let problem = beside(&file(unit), &[("a.msh", &text)]).expect("a problem");
            let what = format!("{version} {unit} {turned}");
            assert_close(&values(&problem), &expected, 1e-9, &what);
        }
    }
    for nodes in [8, 9] {
        let format = plate::Format {
            nodes,
            ..plate::PLAIN
        };
        let text = plate::plate(SIZE, ELEMENTS, format);
        let faults = beside(&file("m"), &[("a.msh", &text)]).expect_err("a fault");
        for part in [
            "a.msh:",
            "of 3 nodes",
            "as \"element\" is \"mitc4\"",
            "-order 1",
        ] {
            assert!(faults.contains(part), "{part}: {faults}");
        }
    }
}

/// Two hinged plates with elements of four nodes.
fn four_plates(elements: [usize; 2], duration: f64, steps: usize, method: &Value) -> Value {
    let mut document = plates(elements, duration, steps, method);
    for body in ["first", "second"] {
        document["bodies"][body]["elements"]["structure"]["element"] = json!("mitc4");
    }
    document
}

/// Positions after 0.1 s against an independent code of geometrically exact shells, as those of nine nodes.
#[test]
fn two_plates_follow_their_reference() {
    let reference = read("tests/data/double_plate_reference.json");
    let instants = reference["instants"].as_array().expect("a list");
    let at = instants
        .iter()
        .find(|at| at["t"] == json!(0.1))
        .expect("0.1 s");
    let document = four_plates([8, 2], 0.1, 50, &json!({"radau": {"stages": 3}}));
    let names = parsed(&document).function_names;
    let motion = run(&document);
    let points = [
        ("hinge", "hinge2"),
        ("tip", "tip"),
        ("centre 1", "centre1"),
        ("centre 2", "centre2"),
    ];
    for (own, name) in points {
        for (k, axis) in ["x", "y"].iter().enumerate() {
            let function = format!("{own} {axis}");
            let index = names.iter().position(|name| *name == function);
            let found = motion.at.function(index.expect("a function")).value;
            let exact = at[name][k].as_f64().expect("a number");
            assert!((found - exact).abs() < 5e-5, "{function}: {found} {exact}");
        }
    }
}

/// The strain energies of soft and damped plates tend to those of nine nodes with the square of the size of the
/// elements, with all nodes and with a reduced basis.
#[test]
fn strain_energies_in_motion_tend_to_those_of_nine_nodes() {
    let energies = |mut document: Value, basis: &Value| {
        for body in ["first", "second"] {
            let own = &mut document["bodies"][body]["elements"];
            own["basis"] = basis.clone();
            own["structure"]["damping"] = json!({"stiffness": 0.01});
        }
        document["materials"]["aluminium"]["young"] = json!(7e9);
        let names = parsed(&document).function_names;
        let motion = run(&document);
        ["strain energy 1", "strain energy 2"].map(|name| {
            let index = names.iter().position(|own| own == name);
            motion.at.function(index.expect("a function")).value
        })
    };
    let method = json!({"radau": {"stages": 2}});
    for basis in [json!("full"), json!({"reduced": {"modes": 8}})] {
        let exact = energies(plates([8, 2], 0.1, 40, &method), &basis);
        let errors = [[8, 2], [16, 4]].map(|elements| {
            let own = energies(four_plates(elements, 0.1, 40, &method), &basis);
            let parts = own.iter().zip(&exact).map(|(x, y)| (x / y - 1.0).abs());
            parts.fold(0.0_f64, f64::max)
        });
        println!("{basis}: {errors:?}");
        assert!(
            errors[1] < 0.007 && errors[1] < errors[0] / 3.5,
            "{basis}: {errors:?}"
        );
    }
}

/// Derivatives of motions by thickness of bands, modulus and density; with stiffeners, masses, damping and loads on the
/// elements, with all nodes and in a reduced basis.
#[test]
fn derivatives_in_motion_are_exact() {
    let methods = [
        json!({"bdf": {"order": 2}}),
        json!({"radau": {"stages": 2}}),
        json!({"generalised_alpha": {"radius": 0.8}}),
    ];
    for method in &methods {
        let mut document = four_plates([4, 2], 0.01, 4, method);
        thick_and_soft(&mut document);
        let problem = parsed(&document);
        scaled_gradients_are_exact(&problem, &problem.start(), method);
    }
    for basis in [json!("full"), json!({"reduced": {"modes": 3}})] {
        let mut document = four_plates([4, 2], 0.01, 4, &methods[1]);
        thick_and_soft(&mut document);
        let own = &mut document["bodies"]["first"]["elements"];
        own["stiffeners"] = json!({"rib": {
            "along": "x", "at": 0.5, "section": {"rectangle": {"width": 0.03, "height": 0.06}}, "offset": [0.03, 0]
        }});
        own["structure"]["masses"] = json!({"tip": {"nodes": "x1y1", "mass": 0.4}});
        own["structure"]["damping"] = json!({"mass": 0.3, "stiffness": 1e-3});
        own["basis"] = basis.clone();
        document["loads"]["wind"] =
            json!({"pressure": {"body": "first", "faces": "all", "pressure": 30}});
        document["loads"]["line"] = json!({"edge": {
            "body": "second", "edges": "x1", "direction": [0.3, 1, 0.2], "magnitude": 4
        }});
        let problem = parsed(&document);
        scaled_gradients_are_exact(&problem, &problem.start(), &basis);
    }
}

/// What cannot be combined is refused with its place.
#[test]
fn what_a_file_may_not_say() {
    let told = |document: &Value| {
        let faults = Problem::parse(&document.to_string(), "plates", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    let rib = |elements: [usize; 2]| {
        let mut document = four_plates(elements, 0.02, 8, &json!({"bdf": {"order": 2}}));
        document["bodies"]["first"]["elements"]["stiffeners"] = json!({"rib": {
            "along": "y", "at": 0.5, "section": {"rectangle": {"width": 0.03, "height": 0.06}}
        }});
        told(&document)
    };
    assert_eq!(rib([4, 2]), "");
    let text = rib([4, 3]);
    for part in [
        "stiffeners/rib/along",
        "odd number of elements of four nodes",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let mut beams = with_four(at_rest(json!({"straight_beam": {
        "from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 0, 1], "elements": 2
    }})));
    let own = beams["structures"]["plate"]
        .as_object_mut()
        .expect("a structure");
    own.shift_remove("thickness");
    own.insert(
        "section".into(),
        json!({"rectangle": {"width": 0.03, "height": 0.06}}),
    );
    let text = told(&beams);
    for part in [
        "/structures/plate/element",
        "\"element\" of a mesh of beams",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let mut other = at_rest(json!({"plate": {"length": 1, "width": 1, "elements": [2, 2]}}));
    other["structures"]["plate"]["element"] = json!("mitc8");
    assert!(told(&other).contains("mitc4"), "{}", told(&other));
}
