//! Faults of files with structures: each is reported with its place.

use flexbody_driver::analysed::AnalysisFailure;
use flexbody_driver::statics::{StaticDesign, StaticsFailure};
use flexbody_mechanics::structures::properties::PropertyFault;
use flexbody_problem::Problem;
use serde_json::Value;

fn material() -> Value {
    json!({"metal": {"young": 70e9, "poisson": 0.3, "density": 2700, "yield_stress": 270e6}})
}

fn plate() -> Value {
    json!({
        "version": 1, "name": "plate", "materials": material(),
        "structures": {"plate": {
            "mesh": {"plate": {"length": 1, "width": 1, "elements": [2, 2]}},
            "material": "metal", "thickness": 0.01,
            "supports": {"edge": {"nodes": ["x0"]}}
        }},
        "load_cases": {"push": {"p": {"pressure": {"faces": "all", "pressure": 1e3}}}},
        "functions": {"mass": "mass", "stress": {"von_mises": {"rho": 50}}}
    })
}

/// A portal of two members.
fn portal() -> Value {
    let member =
        |between: [&str; 2]| json!({"between": between, "orientation": [0, 1, 0], "elements": 2});
    json!({
        "version": 1, "name": "portal", "materials": material(),
        "structures": {"portal": {
            "mesh": {"frame": {
                "points": {"foot": [0, 0, 0], "knee": [0, 0, 1], "tip": [1, 0, 1]},
                "members": {"post": member(["foot", "knee"]), "arm": member(["knee", "tip"])}
            }},
            "material": "metal",
            "section": {"tube": {"radius": 0.05, "wall": 0.01}},
            "supports": {"foot": {"nodes": ["foot"]}},
            "masses": {"lamp": {"nodes": "tip", "mass": 3}}
        }},
        "load_cases": {"push": {"p": {"point": {"nodes": "tip", "force": [0, 0, -9]}}}},
        "functions": {
            "mass": "mass",
            "sag": {"displacement": {"case": "push", "nodes": "tip", "direction": [0, 0, -1]}}
        }
    })
}

/// A fault: the place in the file, the value put there, and the message in two parts.
type Case = (&'static str, Value, &'static str, &'static str);

/// Replaces the value at a pointer, or takes its key away if the value is null.
fn change(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    let own = document.pointer_mut(parent).expect("a parent");
    match (own, value.is_null()) {
        (Value::Object(object), true) => {
            object.shift_remove(key);
        }
        (own @ Value::Array(_), false) => own[key.parse::<usize>().expect("an index")] = value,
        (own, _) => own[key] = value,
    }
}

fn assert_told(base: fn() -> Value, cases: Vec<Case>) {
    let text = base().to_string();
    Problem::parse(&text, "file.json", &[]).unwrap_or_else(|faults| panic!("{faults}"));
    for (pointer, value, found, expected) in cases {
        let mut document = base();
        change(&mut document, pointer, value);
        let text = serde_json::to_string_pretty(&document).expect("JSON");
        let faults = Problem::parse(&text, "file.json", &[])
            .expect_err(pointer)
            .to_string();
        println!("{faults}");
        assert!(
            faults.contains(found) && faults.contains(expected),
            "{pointer}: {faults}"
        );
        assert!(faults.starts_with("file.json:"), "{faults}");
    }
}

#[test]
fn faults_of_shells_are_told_with_their_places() {
    let cases = vec![
        (
            "/structures/plate/supports/edge/nodes/0",
            json!("x2"),
            "\"x2\"",
            "the name of a set of nodes",
        ),
        (
            "/structures/plate/supports/edge/nodes",
            json!("x2"),
            "\"x2\"",
            "the name of a set of nodes",
        ),
        (
            "/structures/plate/supports/edge/nodes",
            json!(3),
            "3",
            "a text or a list of texts",
        ),
        (
            "/load_cases/push/p/pressure/faces",
            json!(["all"]),
            "a list of 1",
            "write \"all\" without brackets",
        ),
        (
            "/structures/plate/material",
            json!("metall"),
            "\"metall\"",
            "did you mean \"metal\"?",
        ),
        (
            "/load_cases/push/p/pressure/faces",
            json!("al"),
            "\"al\"",
            "did you mean \"all\"?",
        ),
        (
            "/structures/plate/supports",
            json!({}),
            "mechanism",
            "hold every part",
        ),
        (
            "/structures/plate/supports/edge/held",
            json!(["x", "y", "z"]),
            "mechanism",
            "hold every part",
        ),
        (
            "/materials/metal/yield_stress",
            Value::Null,
            "no \"yield_stress\"",
            "a stress needs it",
        ),
        (
            "/materials/metal/density",
            Value::Null,
            "no \"density\"",
            "the mass needs it",
        ),
        (
            "/structures/plate/thickness",
            Value::Null,
            "no \"thickness\"",
            "a thickness of the shells",
        ),
        (
            "/structures/plate/section",
            json!({"tube": {"radius": 1, "wall": 0.1}}),
            "\"section\" of a mesh",
            "",
        ),
        (
            "/structures/plate/thickness",
            json!({"per": "patch", "patches": [2, 3], "value": 1}),
            "2 × 3 patches of 2 × 2 elements",
            "divide",
        ),
        (
            "/structures/plate/thickness",
            json!({"per": "element", "values": [1, 2]}),
            "2 values",
            "4 values",
        ),
        (
            "/structures/plate/thickness",
            json!({"per": "group", "groups": ["x"], "value": 1}),
            "\"x\"",
            "a set of elements",
        ),
        (
            "/structures/plate/mesh",
            json!({"panel": {"elements": [2, 2], "points": [
                [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}}),
            "inverted or folded",
            "sound elements",
        ),
        (
            "/functions/stress",
            json!("duration"),
            "a function of a motion",
            "a function of structures",
        ),
        (
            "/functions/stress",
            json!({"compliance": {"case": "pull"}}),
            "\"pull\"",
            "a load case",
        ),
        (
            "/simulation",
            json!({"duration": 1}),
            "\"structures\" beside a motion",
            "without \"simulation\"",
        ),
        (
            "/bodies",
            json!({"a": {"shape": "point", "mass": 1}}),
            "\"bodies\" beside structures",
            "",
        ),
        (
            "/structures/plate/sets",
            json!({"s": {"node": {"at": [0.5, 1.5]}}}),
            "[0.5, 1.5]",
            "from 0 to 1",
        ),
        (
            "/structures/plate/sets",
            json!({"x0": {"node": {"at": [0.5, 0.5]}}}),
            "/structures/plate/sets/x0",
            "another name",
        ),
        (
            "/structures/plate/sets",
            json!({"x1y1": {"elements": {"from": [0, 0], "to": [1, 1]}}}),
            "the name of a set that the mesh has anyway",
            "another name",
        ),
        (
            "/structures/plate/sets",
            json!({"all": {"node": {"at": [0, 0]}}}),
            "the name of a set that the mesh has anyway",
            "another name",
        ),
        (
            "/structures/plate/sets",
            json!({"s": {"elements": {"from": [0.3, 0], "to": [0.7, 1]}}}),
            "no element between [0.3, 0.0] and [0.7, 1.0]",
            "the middle of an element",
        ),
        (
            "/structures/plate/masses",
            json!({"m": {"nodes": "x1y1", "mass": 1, "inertia": [-1e9, 1, 1, 0, 0, 0]}}),
            "/structures/plate/masses/m/inertia",
            "those of a solid",
        ),
        (
            "/structures/plate/masses",
            json!({"m": {"nodes": "x1y1", "mass": 1, "inertia": [1, 1, 1, 0, 0, 2]}}),
            "principal moments of inertia -1, 1, 3",
            "those of a solid",
        ),
        (
            "/materials/metal/poisson",
            json!(0.51),
            "0.51",
            "at most 0.5",
        ),
        ("/materials/metal/poisson", json!(-1), "-1", "above -1"),
        (
            "/functions/stress",
            json!({"von_mises": {"rho": 50, "cases": ["push", "push"]}}),
            "\"push\" a second time",
            "a load case once",
        ),
        (
            "/structures/plate/mesh",
            json!({"curved_panel": {"radius": 1, "length": 1, "angles": [0, 6.3], "elements": [8, 2]}}),
            "an arc of 6.3 rad",
            "at most a whole turn",
        ),
        (
            "/functions/stress",
            json!({"reaction": {"case": "push", "nodes": "x1", "direction": [0, 0, 1]}}),
            "nodes that no support holds",
            "nodes that a support holds",
        ),
        (
            "/structures/plate/damping",
            json!({"ratio": 0.02}),
            "\"damping\" of a structure that does not move",
            "no damping",
        ),
        (
            "/variables",
            json!({"nu": {"path": "/materials/metal/poisson", "lower": 0, "upper": 0.6}}),
            "the upper bound 0.6",
            "at most 0.5",
        ),
        (
            "/variables",
            json!({"nu": {"path": "/materials/metal/poisson", "lower": -1, "upper": 0.4}}),
            "the lower bound -1",
            "above -1",
        ),
    ];
    assert_told(plate, cases);
}

#[test]
fn faults_of_beams_are_told_with_their_places() {
    let i = |flange: f64, web: f64| json!({"i": {"width": 0.06, "height": 0.1, "flange": flange, "web": web}});
    let tube = |wall: f64| json!({"tube": {"radius": 0.05, "wall": wall}});
    let all = || json!({"between": ["foot", "tip"], "orientation": [0, 1, 0], "elements": 1});
    let cases = vec![
        (
            "/structures/portal/section",
            tube(0.051),
            "/structures/portal/section/tube/wall",
            "not above the radius, 0.05 m",
        ),
        (
            "/structures/portal/section",
            i(0.051, 0.01),
            "a flange of 0.051 m",
            "not above half the height, 0.05 m",
        ),
        (
            "/structures/portal/section",
            i(0.01, 0.061),
            "a web of 0.061 m",
            "not above the width, 0.06 m",
        ),
        (
            "/structures/portal/mesh/frame/members/all",
            all(),
            "/structures/portal/mesh/frame/members/all",
            "another name",
        ),
        (
            "/structures/portal/mesh/frame/points/all",
            json!([2, 0, 0]),
            "/structures/portal/mesh/frame/points/all",
            "another name",
        ),
        (
            "/structures/portal/sets",
            json!({"post": {"elements": {"from": [0, 0], "to": [1, 1]}}}),
            "the name of a set that the mesh has anyway",
            "another name",
        ),
        (
            "/structures/portal/masses/lamp/inertia",
            json!([1, 1, 3, 0, 0, 0]),
            "principal moments of inertia 1, 1, 3",
            "those of a solid",
        ),
        (
            "/functions/sag",
            json!({"reaction_moment": {"case": "push", "nodes": "tip", "axis": [0, 1, 0]}}),
            "nodes that no support holds",
            "nodes that a support holds",
        ),
    ];
    assert_told(portal, cases);
    for (key, values) in [
        ("value", tube(0.06)),
        (
            "values",
            json!([tube(0.01), tube(0.01), tube(0.06), tube(0.01)]),
        ),
    ] {
        let mut document = portal();
        change(&mut document, "/structures/portal/section", Value::Null);
        document["structures"]["portal"]["sections"] = json!({"per": "element"});
        document["structures"]["portal"]["sections"][key] = values;
        let faults = Problem::parse(&document.to_string(), "file.json", &[]).expect_err(key);
        let text = faults.to_string();
        assert!(text.contains("a wall of 0.06 m"), "{text}");
    }
}

/// Names of structures and members may not be confused with one another.
#[test]
fn names_lead_to_one_set() {
    let mut document = portal();
    let other = document["structures"]["portal"].clone();
    document["structures"]["portal.x"] = other;
    document["load_cases"]["push"]["p"]["point"]["nodes"] = json!("portal.tip");
    let faults = Problem::parse(&document.to_string(), "file.json", &[]).expect_err("a dot");
    assert!(
        faults.to_string().contains("a name without a dot"),
        "{faults}"
    );
    // Members whose names are those of the generator.
    let mut document = portal();
    let frame = &mut document["structures"]["portal"]["mesh"]["frame"];
    let members = frame["members"].take();
    frame["members"] = json!({"member1": members["post"], "member0": members["arm"]});
    let problem = Problem::parse(&document.to_string(), "file.json", &[]);
    let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
    let mesh = problem.statics.as_ref().expect("structures").mesh();
    assert_eq!(mesh.beam_sets["member1"], [0, 1]);
    assert_eq!(mesh.beam_sets["member0"], [2, 3]);
}

/// Designs that the bounds of variables admit, and that cannot be built, have no values.
#[test]
fn designs_that_cannot_be_built_have_no_values() {
    let mut document = portal();
    document["structures"]["portal"]["masses"]["lamp"]["inertia"] = json!([1, 1, 1.5, 0, 0, 0]);
    document["variables"] = json!({
        "wall": {"path": "/structures/portal/section/tube/wall", "lower": 0.001, "upper": 0.2},
        "turn": {"path": "/structures/portal/masses/lamp/inertia/2", "lower": 0, "upper": 9}
    });
    let problem = Problem::parse(&document.to_string(), "file.json", &[]);
    let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
    let statics = problem.statics.as_ref().expect("structures");
    let at = |x: [f64; 2]| {
        StaticDesign::of(&problem, statics, &x, None)
            .map(|_| ())
            .err()
    };
    assert_eq!(at([0.01, 1.5]), None);
    assert_eq!(at([0.05, 1.5]), None, "a solid bar");
    let section = at([0.06, 1.5]);
    assert!(
        matches!(
            section,
            Some(StaticsFailure::Properties(PropertyFault::Section {
                beam: 0,
                ..
            }))
        ),
        "{section:?}"
    );
    let text = AnalysisFailure::from(section.expect("a failure")).to_string();
    assert!(
        text.contains("a wall of 0.06 m, above the radius, 0.05 m"),
        "{text}"
    );
    let inertia = at([0.01, 2.5]);
    assert!(
        matches!(
            inertia,
            Some(StaticsFailure::Properties(PropertyFault::Inertia { .. }))
        ),
        "{inertia:?}"
    );
}

/// A moment along the normal of a smooth shell is refused with five unknowns a node, about a tangent it is not, nor
/// with six, nor on a fold or a held edge.
#[test]
fn moments_along_normals_are_refused() {
    let told = |nodes: &str, moment: [f64; 3], unknowns: &str, mesh: Option<Value>| {
        let mut document = plate();
        document["load_cases"]["push"] =
            json!({"m": {"point": {"nodes": nodes, "moment": moment}}});
        document["statics"] = json!({"node_unknowns": unknowns});
        document["functions"] = json!({"mass": "mass", "C": {"compliance": {"case": "push"}}});
        if let Some(mesh) = mesh {
            document["structures"]["plate"]["mesh"] = mesh;
        }
        match Problem::parse(&document.to_string(), "plate.json", &[]) {
            Ok(_) => String::new(),
            Err(faults) => faults.to_string(),
        }
    };
    for moment in [[0.0, 0.0, 1.0], [0.0, 1.0, -1e-4], [5.0, 0.0, 0.1]] {
        let text = told("x1y0", moment, "five", None);
        assert!(
            text.contains("along the normal") && text.contains("/load_cases/push/m/point/moment"),
            "{text}"
        );
        assert!(text.contains("\"six\""), "{text}");
        assert_eq!(told("x1y0", moment, "six", None), "");
        assert_eq!(told("x0", moment, "five", None), "", "a support has it");
    }
    assert_eq!(told("x1", [1.0, -2.0, 0.0], "five", None), "");
    // A tilted panel: about its tangent (1, 0, 1), and about its normal.
    let panel = json!({"panel": {"points": [[0, 0, 0], [1, 0, 1], [0, 1, 0], [1, 1, 1]], "elements": [2, 2]}});
    assert_eq!(
        told("x1y0", [1.0, 3.0, 1.0], "five", Some(panel.clone())),
        ""
    );
    assert!(told("x1y0", [1.0, 3.0, 1.01], "five", Some(panel)).contains("along the normal"));
}

/// Where the supports hold every node, of shells or beams, for load cases or frequencies, it is said.
#[test]
fn structures_without_a_free_node_are_told() {
    for (base, name) in [(plate as fn() -> Value, "plate"), (portal, "portal")] {
        let mut document = base();
        let structures = document["structures"].as_object_mut().expect("structures");
        for own in structures.values_mut() {
            own["supports"] = json!({"all": {"nodes": ["all"]}});
        }
        let found = match Problem::parse(&document.to_string(), "held.json", &[]) {
            Ok(problem) => match StaticDesign::of(
                &problem,
                problem.statics.as_ref().expect("structures"),
                &problem.start(),
                None,
            ) {
                Ok(_) => "sound".to_owned(),
                Err(failure) => failure.to_string(),
            },
            Err(faults) => faults.to_string(),
        };
        assert!(found.contains("hold every node"), "{name}: {found}");
    }
}
