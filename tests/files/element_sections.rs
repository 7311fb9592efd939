//! Section forces and fibre stresses of beams among the elements of a body: against the reaction at their end, against
//! beams by functions, gradients, and what files may not say.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;
use std::collections::BTreeMap;

/// The values of all functions at the start, by name.
fn values(document: &Value) -> BTreeMap<String, f64> {
    let problem = parsed(document);
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let names = problem.function_names.iter().cloned().enumerate();
    names
        .map(|(f, name)| (name, motion.at.function(f).value))
        .collect()
}

const COMPONENTS: [&str; 6] = [
    "axial",
    "shear_y",
    "shear_z",
    "torsion",
    "bending_y",
    "bending_z",
];

/// A cantilever of four elements with a force on an arm at its end, in equilibrium.
fn cantilever() -> Value {
    let mut functions = serde_json::Map::new();
    for component in COMPONENTS {
        for station in ["start", "middle"] {
            let place = match station {
                "start" => json!("start"),
                _ => json!(0.5),
            };
            functions.insert(
                format!("{component} {station}"),
                json!({"final": {"section_force": {"body": "beam", "station": place, "component": component}}}),
            );
        }
    }
    for (k, axis) in [[1, 0, 0], [0, 1, 0], [0, 0, 1]].iter().enumerate() {
        functions.insert(
            format!("force {k}"),
            json!({"final": {"joint_force": {"joint": "wall", "on": "beam", "direction": axis}}}),
        );
        functions.insert(
            format!("moment {k}"),
            json!({"final": {"joint_moment": {"joint": "wall", "on": "beam", "direction": axis}}}),
        );
    }
    for fibre in [[1.0, 0.0], [0.0, 1.0], [-0.5, 0.25]] {
        functions.insert(
            format!("stress {fibre:?}"),
            json!({"final": {"fibre_stress": {"body": "beam", "station": 0.5, "fibre": fibre}}}),
        );
    }
    json!({
        "version": 1, "name": "cantilever", "gravity": [0, 0, 0], "start": "equilibrium",
        "materials": {"steel": {"young": 2e11, "poisson": 0.3, "density": 7800}},
        "bodies": {
            "beam": {"elements": {
                "structure": {
                    "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [2, 0, 0], "orientation": [0, 0, 1], "elements": 4}},
                    "material": "steel", "section": {"rectangle": {"width": 0.03, "height": 0.05}},
                },
                "frame": {"clamped": "start"}, "points": {"start": {"node": "start"}, "end": {"node": "end"}},
            }},
            "arm": {"mass": 0.1, "inertia": {"xx": 1e-3, "yy": 1e-3, "zz": 1e-3}, "points": {"tip": [0, 0.3, 0.1]},
                    "place": {"at": "beam.end"}},
        },
        "joints": {
            "wall": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}},
            "end": {"weld": {"between": ["arm", "beam"], "at": "beam.end"}},
        },
        "loads": {"pull": {"force": {"body": "arm", "point": "tip", "direction": [2, 1, -2], "magnitude": 0.3}}},
        "simulation": {"duration": 0.01, "steps": 4, "method": {"bdf": {"order": 2}}},
        "functions": functions,
    })
}

/// At the wall the section carries what the wall gives; fibre stresses are N/A − y M3/I3 + z M2/I2. The deflection of
/// 1e-5 m changes levers in proportion.
#[test]
fn sections_carry_the_reaction() {
    let found = values(&cantilever());
    // The axes of the section: t, e2 along the orientation, e3 = t × e2.
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    for (what, names) in [("force", &COMPONENTS[..3]), ("moment", &COMPONENTS[3..])] {
        for (axis, name) in axes.iter().zip(names) {
            let along = |k: usize| axis[k] * found[&format!("{what} {k}")];
            let exact = -(along(0) + along(1) + along(2));
            let own = found[&format!("{name} start")];
            assert!(exact.abs() > 0.02, "{name} {exact}");
            assert!((own - exact).abs() < 2e-5, "{name} {own} {exact}");
        }
    }
    // Between end and wall moments vary as the forces say.
    let at = |name: &str| {
        [
            found[&format!("{name} start")],
            found[&format!("{name} middle")],
        ]
    };
    assert!((at("bending_z")[0] - at("bending_z")[1] - at("shear_y")[0]).abs() < 2e-5);
    assert!((at("bending_y")[0] - at("bending_y")[1] + at("shear_z")[0]).abs() < 2e-5);
    let (b, h) = (0.03, 0.05);
    let (area, i2, i3) = (b * h, b * h * h * h / 12.0, h * b * b * b / 12.0);
    for fibre in [[1.0, 0.0], [0.0, 1.0], [-0.5, 0.25]] {
        let (y, z) = (fibre[0] * b / 2.0, fibre[1] * h / 2.0);
        let middle = |name: &str| at(name)[1];
        let exact =
            middle("axial") / area - y * middle("bending_z") / i3 + z * middle("bending_y") / i2;
        let own = found[&format!("stress {fibre:?}")];
        assert!((own / exact - 1.0).abs() < 1e-10, "{fibre:?} {own} {exact}");
    }
}

/// The largest stress of a beam that is spun up is that of a beam by functions.
#[test]
fn stresses_are_those_of_beams_by_functions() {
    let section = json!({"rectangle": {"width": 0.03, "height": 0.05}});
    let largest = |body: &Value| {
        let document = json!({
            "version": 1, "name": "spun beam", "gravity": [0, 0, 0], "bodies": {"beam": body},
            "materials": {"soft": {"young": 1e8, "poisson": 0.0, "density": 1000}},
            "joints": {"root": {"revolute": {"between": ["beam", "ground"], "at": "beam.start", "axis": [0, 0, 1]}}},
            "drives": {"turn": {"joint": "root", "turn": {"polynomial": [0, 0, 0, 2]}}},
            "simulation": {"duration": 0.5, "steps": 100, "method": {"bdf": {"order": 2}}},
            "functions": {
                "root": {"final": {"largest_fibre_stress": {"body": "beam", "stations": [0], "rho": 1e-3, "sign": "both"}}},
                "tension": {"final": {"section_force": {"body": "beam", "station": 0.3, "component": "axial"}}},
                "all": {"ks": {"rho": 1e-3, "of": {"largest_fibre_stress": {"body": "beam", "stations": 9, "rho": 1e-3, "sign": "both"}}}},
            },
        });
        values(&document)
    };
    let elements = largest(&json!({"elements": {
        "structure": {
            "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 0, 1], "elements": 8}},
            "material": "soft", "section": section,
        },
        "frame": {"clamped": "start"}, "points": {"start": {"node": "start"}, "end": {"node": "end"}},
    }}));
    let functions = largest(&json!({"beam": {
        "length": 1, "section": section, "material": {"young": 1e8, "poisson": 0.0, "density": 1000},
        "frame": "clamped", "modes": {"bending_y": 5, "bending_z": 1},
    }}));
    for (name, exact) in &functions {
        let own = elements[name];
        assert!(
            exact.abs() > 1.0 && (own / exact - 1.0).abs() < 0.01,
            "{name} {own} {exact}"
        );
    }
}

/// Derivatives of section forces and stresses of stiffeners by sections, offsets, modulus and thickness, of plates by
/// all nodes and in a basis.
#[test]
fn derivatives_are_exact() {
    for (method, basis) in [
        (json!({"bdf": {"order": 2}}), json!("full")),
        (
            json!({"radau": {"stages": 2}}),
            json!({"reduced": {"modes": 1, "tolerance": 0.3}}),
        ),
    ] {
        let mut document = plates([2, 1], 0.02, 6, &method);
        thick_and_soft(&mut document);
        let first = &mut document["bodies"]["first"]["elements"];
        first["basis"] = basis.clone();
        first["stiffeners"] = json!({
            "rib": {"along": "x", "at": 0, "section": {"rectangle": {"width": 0.06, "height": 0.03}}, "offset": [0.05, 0]},
            "cross": {"along": "y", "at": 1, "section": {"tube": {"radius": 0.03, "wall": 0.01}}},
        });
        let of = |beams: &str, component: &str| json!({"final": {"section_force": {"body": "first", "beams": beams, "station": 0.3, "component": component}}});
        document["functions"] = json!({
            "tension": of("rib", "axial"),
            "shear": of("rib", "shear_y"),
            "moment": of("rib", "bending_z"),
            "torsion": of("cross", "torsion"),
            "fibre": {"integral": {"fibre_stress": {"body": "first", "beams": "rib", "station": "end", "fibre": [1, -1]}}},
            "largest force": {"ks": {"rho": 0.1, "of": {"largest_section_force":
                {"body": "first", "beams": "rib", "stations": 3, "component": "bending_z", "sign": "both", "rho": 0.1}}}},
            "largest stress": {"ks": {"rho": 1e-4, "bound": "above", "of": {"largest_fibre_stress":
                {"body": "first", "beams": "rib", "stations": ["start", 0.7], "rho": 1e-4, "bound": "above"}}}},
        });
        let own = |path: &str, lower: f64, upper: f64| json!({"path": format!("/bodies/first/elements/{path}"), "lower": lower, "upper": upper});
        document["variables"] = json!({
            "width": own("stiffeners/rib/section/rectangle/width", 0.01, 0.1),
            "offset": own("stiffeners/rib/offset/0", 0.0, 0.1),
            "wall": own("stiffeners/cross/section/tube/wall", 0.001, 0.02),
            "thickness": own("structure/thickness", 0.01, 0.1),
            "modulus": {"path": "/materials/aluminium/young", "lower": 1e7, "upper": 1e8},
            "place": {"path": "/functions/tension/final/section_force/station", "lower": 0.1, "upper": 0.4},
        });
        let problem = parsed(&document);
        scaled_gradients_are_exact(&problem, &problem.start(), &json!([method, basis]));
    }
}

#[test]
fn what_a_file_may_not_say() {
    let faulty = |function: &Value, change: &dyn Fn(&mut Value)| {
        let mut document = cantilever();
        document["functions"] = json!({"own": {"final": function}});
        change(&mut document);
        let faults = Problem::parse(&document.to_string(), "beam", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    let force = |extra: (&str, Value)| {
        let mut of = json!({"body": "beam", "station": 0.5, "component": "axial"});
        of[extra.0] = extra.1;
        json!({"section_force": of})
    };
    let same: &dyn Fn(&mut Value) = &|_| {};
    for (function, change, expected) in [
        (force(("body", json!("arm"))), same, "the name of a beam"),
        (force(("beams", json!("al"))), same, "did you mean \"all\"?"),
        (
            force(("station", json!("strat"))),
            same,
            "did you mean \"start\"?",
        ),
        (
            force(("station", json!(1.5))),
            same,
            "a fraction of the length",
        ),
        (
            json!({"fibre_stress": {"body": "beam", "station": 0, "fibre": [1, 0]}}),
            &|d: &mut Value| {
                let given = json!({"given": {"axial_and_shear": [1e6, 1e6, 1e6], "torsion_and_bending": [1e3, 1e3, 1e3], "mass": 1, "inertia": [1e-3, 1e-3]}});
                d["bodies"]["beam"]["elements"]["structure"]["section"] = given;
            },
            "a beam whose section has sizes",
        ),
    ] {
        let text = faulty(&function, change);
        assert!(text.contains(expected), "{expected}: {text}");
    }
}
