//! Beams, lumped masses and damping of bodies of elements, from files.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody_driver::simulate;
use flexbody_problem::Problem;
use serde_json::Value;

/// Two soft plates, the first with two stiffeners and masses, both damped.
pub fn stiffened(elements: [usize; 2], duration: f64, steps: usize, method: &Value) -> Value {
    let mut document = plates(elements, duration, steps, method);
    thick_and_soft(&mut document);
    let first = &mut document["bodies"]["first"]["elements"];
    first["stiffeners"] = json!({
        "rib": {"along": "x", "at": 0, "section": {"rectangle": {"width": 0.06, "height": 0.03}}, "offset": [0.05, 0]},
        "cross": {"along": "y", "at": 1, "section": {"tube": {"radius": 0.03, "wall": 0.01}}, "line_mass": 0.5},
    });
    first["structure"]["masses"] = json!({
        "corners": {"nodes": "x1", "mass": 0.2, "inertia": [1e-3, 2e-3, 2e-3, 0, 0, 1e-4]},
    });
    for body in ["first", "second"] {
        document["bodies"][body]["elements"]["structure"]["damping"] =
            json!({"mass": 0.5, "stiffness": 1e-3});
    }
    let own = |path: &str, lower: f64, upper: f64| json!({"path": format!("/bodies/first/elements/{path}"), "lower": lower, "upper": upper});
    document["variables"] = json!({
        "width": own("stiffeners/rib/section/rectangle/width", 0.01, 0.1),
        "offset": own("stiffeners/rib/offset/0", 0.0, 0.1),
        "wall": own("stiffeners/cross/section/tube/wall", 0.001, 0.02),
        "line mass": own("stiffeners/cross/line_mass", 0.1, 1.0),
        "mass": own("structure/masses/corners/mass", 0.1, 1.0),
        "inertia": own("structure/masses/corners/inertia/0", 5e-4, 2e-3),
        "alpha": own("structure/damping/mass", 0.1, 1.0),
        "beta": own("structure/damping/stiffness", 1e-4, 1e-2),
        "modulus": {"path": "/materials/aluminium/young", "lower": 1e7, "upper": 1e8},
        "thickness": own("structure/thickness", 0.01, 0.1),
    });
    document
}

#[test]
fn derivatives_are_exact() {
    for (method, basis) in [
        (json!({"bdf": {"order": 2}}), json!("full")),
        (json!({"radau": {"stages": 3}}), json!("full")),
        (
            json!({"bdf": {"order": 2}}),
            json!({"reduced": {"modes": 1, "tolerance": 0.3}}),
        ),
    ] {
        let mut document = stiffened([2, 1], 0.02, 6, &method);
        document["bodies"]["first"]["elements"]["basis"] = basis.clone();
        let problem = parsed(&document);
        assert_eq!(problem.variables.len(), 10);
        scaled_gradients_are_exact(&problem, &problem.start(), &json!([method, basis]));
    }
}

/// A reduced basis of a plate with stiffeners, masses and damping moves as all nodes do.
#[test]
fn a_basis_moves_as_all_nodes_do() {
    let method = json!({"bdf": {"order": 2}});
    let tip = |basis: &Value| {
        let mut document = stiffened([2, 1], 0.1, 40, &method);
        for body in ["first", "second"] {
            document["bodies"][body]["elements"]["basis"] = basis.clone();
        }
        let problem = parsed(&document);
        let motion = simulate(&problem, &problem.start()).expect("runs");
        let index = problem
            .function_names
            .iter()
            .position(|name| name == "tip y");
        motion.at.function(index.expect("a function")).value
    };
    let (full, reduced) = (tip(&json!("full")), tip(&json!({"reduced": {"modes": 4}})));
    let rigid = tip(&json!("rigid"));
    assert!((full - rigid).abs() > 2e-4, "{full} {rigid}");
    assert!(
        (full - reduced).abs() < 0.02 * (full - rigid).abs(),
        "{full} {reduced} {rigid}"
    );
}

/// A straight line of beams that is spun up lags as a beam by functions does; a mass at its end and damping too.
#[test]
fn beams_of_elements_move_as_beams_by_functions() {
    let document = |body: Value| {
        json!({
            "version": 1,
            "name": "spun beam",
            "gravity": [0, 0, 0],
            "bodies": {"beam": body},
            "materials": {"soft": {"young": 1e8, "poisson": 0.0, "density": 1000}},
            "joints": {"root": {"revolute": {"between": ["beam", "ground"], "at": "beam.start", "axis": [0, 0, 1]}}},
            "drives": {"turn": {"joint": "root", "turn": {"polynomial": [0, 0, 0, 2]}}},
            "simulation": {"duration": 0.5, "steps": 100, "method": {"bdf": {"order": 2}}},
            "functions": {
                "lag": {"final": {"elastic_displacement": {"body": "beam", "point": "end", "direction": [0, 1, 0]}}},
                "energy": {"final": {"strain_energy": {"body": "beam"}}},
            },
        })
    };
    let values = |document: &Value| {
        let problem = parsed(document);
        let motion = simulate(&problem, &problem.start()).expect("runs");
        [0, 1].map(|f| motion.at.function(f).value)
    };
    let section = json!({"rectangle": {"width": 0.03, "height": 0.05}});
    let elements = json!({"elements": {
        "structure": {
            "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 0, 1], "elements": 8}},
            "material": "soft",
            "section": section,
        },
        "frame": {"clamped": "start"},
        "points": {"start": {"node": "start"}, "end": {"node": "end"}},
    }});
    let by_functions = json!({"beam": {
        "length": 1, "section": section, "material": {"young": 1e8, "poisson": 0.0, "density": 1000},
        "frame": "clamped", "modes": {"bending_y": 4}, "shear": true,
    }});
    let found = values(&document(elements.clone()));
    let exact = values(&document(by_functions));
    assert!(exact[0].abs() > 0.01, "{exact:?}");
    for (found, exact) in found.iter().zip(exact) {
        assert!(
            (found - exact).abs() < 2e-3 * exact.abs(),
            "{found} {exact}"
        );
    }
    // A mass at the end makes it lag more, in proportion to its share.
    let mut heavy = elements;
    heavy["elements"]["structure"]["masses"] = json!({"tip": {"nodes": "end", "mass": 0.5}});
    let more = values(&document(heavy.clone()));
    assert!(more[0].abs() > 1.5 * found[0].abs(), "{more:?} {found:?}");
    heavy["elements"]["structure"]["damping"] = json!({"stiffness": 0.1});
    let damped = values(&document(heavy));
    assert!(damped[0].abs() < 0.9 * more[0].abs(), "{damped:?} {more:?}");
}

/// A change of a document.
type Change = dyn Fn(&mut Value);

#[test]
fn what_a_file_may_not_say() {
    let faulty = |change: &Change| {
        let mut document = stiffened([2, 1], 0.1, 10, &json!({"bdf": {"order": 2}}));
        change(&mut document["bodies"]["first"]["elements"]);
        document["variables"] = json!({});
        let faults = Problem::parse(&document.to_string(), "plates", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    assert_eq!(faulty(&|_| {}), "");
    let cases: [(&Change, &str); 6] = [
        (
            &|e| e["structure"]["damping"] = json!({"ratio": 0.01}),
            "\"mass\" and \"stiffness\"",
        ),
        (
            &|e| e["structure"]["damping"] = json!({}),
            "no factor of damping",
        ),
        (
            &|e| e["structure"]["masses"]["corners"]["nodes"] = json!("x9"),
            "the name of a set of nodes",
        ),
        (
            &|e| e["structure"]["masses"]["corners"]["inertia"] = json!([1, 1, 5, 0, 0, 0]),
            "those of a solid",
        ),
        (&|e| e["stiffeners"]["rib"]["at"] = json!(1.5), "at most 1"),
        (
            &|e| e["stiffeners"]["cross"]["section"]["tube"]["wall"] = json!(0.04),
            "not above the radius",
        ),
    ];
    for (change, expected) in cases {
        let text = faulty(change);
        assert!(text.contains(expected), "{expected}: {text}");
    }
}
