//! Pressures and dead loads on bodies of elements, from files: against statics, in other axes and units, gradients, and
//! what files may not say.

use crate::reference::documents::plates;
use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use crate::reference::models::Numbers;
use flexbody::Analysis;
use flexbody_mathematics::math::rotation::matrix;
use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_problem::Problem;
use serde_json::Value;

const LOADS: [&str; 3] = ["pressure", "edge", "area"];

/// A load of each kind on a plate that is clamped at one edge: of a motion, and of a load case.
fn load(kind: &str, size: f64) -> [Value; 2] {
    match kind {
        "pressure" => [
            json!({"pressure": {"body": "plate", "faces": "all", "pressure": size}}),
            json!({"pressure": {"faces": "all", "pressure": size}}),
        ],
        "edge" => [
            json!({"edge": {"body": "plate", "edges": "x1", "direction": [0, 3, 4], "magnitude": size}}),
            json!({"edge": {"edges": "x1", "force": [0, 0.6 * size, 0.8 * size]}}),
        ],
        _ => [
            json!({"area": {"body": "plate", "faces": "all", "direction": [0, 0, -2], "magnitude": size}}),
            json!({"area": {"faces": "all", "force": [0, 0, -size]}}),
        ],
    }
}

/// Plates in equilibrium are deflected as the structures of statics are. There a pressure keeps its direction, so both
/// agree for small rotations: to first order in them.
#[test]
fn plates_in_equilibrium_are_those_of_statics() {
    let structure = json!({
        "mesh": {"plate": {"length": 1, "width": 0.4, "elements": [3, 2]}},
        "material": "soft", "thickness": 0.02,
    });
    let materials = json!({"soft": {"young": 1e9, "poisson": 0.3, "density": 1000}});
    for kind in LOADS {
        let tip = |size: f64, basis: &Value| {
            let [moving, still] = load(kind, size);
            let motion = json!({
                "version": 1, "name": "plate", "start": "equilibrium", "gravity": [0, 0, 0], "materials": materials,
                "bodies": {"plate": {"elements": {
                    "structure": structure, "frame": {"clamped": "x0"}, "basis": basis,
                    "points": {"root": {"edge": "x0"}, "tip": {"node": "x1y1"}},
                }}},
                "joints": {"wall": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
                "loads": {"load": moving},
                "simulation": {"duration": 0.01, "steps": 4, "method": {"radau": {"stages": 2}}},
                "functions": {"tip": {"final": {"position": {"body": "plate", "point": "tip", "direction": [0, 0, 1]}}}},
            });
            let mut held = structure.clone();
            held["supports"] = json!({"wall": {"nodes": ["x0"]}});
            let statics = json!({
                "version": 1, "name": "plate", "materials": materials, "structures": {"plate": held},
                "statics": {"strains": "von_karman"},
                "load_cases": {"case": {"load": still}},
                "functions": {"tip": {"displacement": {"case": "case", "nodes": "x1y1", "direction": [0, 0, 1]}}},
            });
            let problem = parsed(&statics);
            let mut analysis = Analysis::new(&problem);
            let exact = analysis.at(&problem.start()).expect("a solution").values()[0];
            [values(&motion)[0], exact]
        };
        let off = |size: f64| {
            let [found, exact] = tip(size, &json!("full"));
            assert!(exact.abs() > 1e-6, "{kind} {exact}");
            (found / exact - 1.0).abs()
        };
        // A dead load is the same at any size, a pressure that follows to the square of the rotation.
        match kind {
            "pressure" => {
                let (small, large) = (off(0.4), off(40.0));
                assert!(
                    small < 1e-6 && large < 0.02 && large > 100.0 * small,
                    "{small:e} {large:e}"
                );
            }
            _ => assert!(off(20.0) < 1e-7, "{kind} {:e}", off(20.0)),
        }
    }
}

/// A damped plate that swings under all loads, with axes turned by `turn` and lengths, masses and times in other units:
/// what a metre and a kilogram are.
fn swing(turn: Mat3<f64>, (metre, kilogram): (f64, f64), basis: &str) -> Value {
    let turned = |x: [f64; 3], by: f64| {
        let x = turn * Vec3::from(x) * by;
        json!([x.x, x.y, x.z])
    };
    let angle = ((turn.trace() - 1.0) / 2.0).acos();
    let axis = Vec3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    let place = match angle > 0.0 {
        true => json!({"put": "root", "turn": {"axis": [axis.x, axis.y, axis.z], "angle": angle}}),
        false => json!({"put": "root"}),
    };
    let pascal = kilogram / metre;
    json!({
        "version": 1, "name": "swing", "gravity": turned([0.5, -9.81, 2.0], metre),
        "materials": {"soft": {"young": 2e7 * pascal, "poisson": 0.3, "density": 1000.0 * kilogram / metre.powi(3)}},
        "bodies": {"plate": {
            "place": place,
            "elements": {
                "structure": {
                    "mesh": {"plate": {"length": metre, "width": 0.5 * metre, "elements": [2, 1]}},
                    "material": "soft", "thickness": 0.04 * metre, "damping": {"mass": 0.2, "stiffness": 1e-3},
                },
                "frame": {"clamped": "x0"}, "basis": basis, "points": {"root": {"edge": "x0"}, "tip": {"node": "x1y1"}},
            },
        }},
        "joints": {"root": {"revolute": {"between": ["plate", "ground"], "at": [0, 0, 0], "axis": turned([0.0, 1.0, 0.0], 1.0)}}},
        "loads": {
            "wind": {"pressure": {"body": "plate", "faces": "all",
                                  "pressure": {"harmonic": {"amplitude": 300.0 * pascal, "frequency": 2, "phase": 0.4}}}},
            "lift": {"edge": {"body": "plate", "edges": "x1", "direction": [0, 0, 1], "axes": "body",
                              "magnitude": 20.0 * kilogram}},
            "rope": {"edge": {"body": "plate", "edges": "y0", "direction": turned([1.0, 0.5, -1.0], 1.0),
                              "magnitude": 10.0 * kilogram}},
            "snow": {"area": {"body": "plate", "faces": "all", "direction": turned([0.0, 0.2, -1.0], 1.0),
                              "magnitude": 50.0 * pascal}},
            "air": {"drag": {"body": "plate", "faces": "all", "coefficient": 3.0 * kilogram / metre.powi(3),
                             "normal_coefficient": 8.0 * kilogram / metre.powi(3), "width": 0.1 * metre}},
        },
        "simulation": {"duration": 0.2, "steps": 40, "method": {"radau": {"stages": 3}}},
        "functions": {
            "energy": {"integral": {"strain_energy": {"body": "plate"}}},
            "tip": {"final": {"position": {"body": "plate", "point": "tip", "direction": turned([0.3, 0.4, 1.0], 1.0)}}},
        },
    })
}

/// A scene that is turned as a whole moves as it did; so does one in other units. Rigid plates take the resultants.
#[test]
fn axes_and_units_change_nothing() {
    let mut numbers = Numbers(12);
    for basis in ["full", "rigid"] {
        let same = (Mat3::identity(), (1.0, 1.0));
        let own = values(&swing(same.0, same.1, basis));
        if basis == "full" {
            assert!(own[0] > 1e-3, "{own:?}");
        }
        let turn = matrix(&numbers.orientation());
        // Metres and kilograms; millimetres and tonnes; feet and pounds.
        for (turn, units) in [
            (turn, (1.0, 1.0)),
            (turn, (1e3, 1e-3)),
            (Mat3::identity(), (1.0 / 0.3048, 1.0 / 0.45359237)),
        ] {
            let other = values(&swing(turn, units, basis));
            let (metre, kilogram) = units;
            let joule = kilogram * metre * metre;
            for (k, scale) in [joule, metre].into_iter().enumerate() {
                let size = own[k].abs().max(1e-6);
                let off = (other[k] / scale - own[k]).abs() / size;
                assert!(off < 1e-8, "{basis} {units:?} {k} {off:e} {own:?}");
            }
        }
    }
}

/// The work of all loads is the energy that an undamped plate gains, by all nodes and rigid, whatever the axes and units.
#[test]
fn works_are_the_gain_of_energy() {
    let turn = matrix(&Numbers(3).orientation());
    for (turn, units, basis) in [
        (Mat3::identity(), (1.0, 1.0), "full"),
        (turn, (1e3, 1e-3), "full"),
        (turn, (1.0, 1.0), "rigid"),
    ] {
        let mut document = swing(turn, units, basis);
        document["bodies"]["plate"]["elements"]["structure"]["damping"] = json!({"stiffness": 0});
        document["simulation"] =
            json!({"duration": 0.2, "steps": 400, "method": {"radau": {"stages": 3}}});
        let mut functions = json!({
            "start": {"value": {"at": 0, "of": {"energy": "total"}}},
            "end": {"final": {"energy": "total"}},
        });
        for load in ["wind", "lift", "rope", "snow", "air"] {
            functions[load] = json!({"integral": {"power": {"load": load}}});
        }
        document["functions"] = functions;
        let [start, end, works @ ..] = &values(&document)[..] else {
            panic!("seven values");
        };
        let (work, size) = works
            .iter()
            .fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()));
        let off = (end - start - work).abs();
        assert!(works.iter().all(|x| x.abs() > 0.01 * size), "{works:?}");
        assert!(
            off < 1e-6 * size,
            "{basis} {units:?} {start} {end} {works:?}"
        );
    }
}

/// Derivatives by sizes, values of a table, directions, thickness and duration, of plates by all nodes, in a basis and
/// rigid.
#[test]
fn derivatives_are_exact() {
    for (method, basis) in [
        (json!({"bdf": {"order": 2}}), json!("full")),
        (json!({"radau": {"stages": 3}}), json!("full")),
        (
            json!({"bdf": {"order": 2}}),
            json!({"reduced": {"modes": 1, "tolerance": 0.3}}),
        ),
        (json!({"radau": {"stages": 2}}), json!("rigid")),
    ] {
        let mut document = plates([2, 1], 0.02, 6, &method);
        thick_and_soft(&mut document);
        document["bodies"]["first"]["elements"]["basis"] = basis.clone();
        if basis == "rigid" {
            // What is rigid has no strains.
            let functions = document["functions"].as_object_mut().expect("functions");
            functions.retain(|name, _| name != "strain energy 1" && name != "stress 1");
        }
        document["functions"]["work"] = json!({"integral": {"power": {"load": "wind"}}});
        document["functions"]["power"] = json!({"final": {"power": {"load": "lift"}}});
        document["loads"] = json!({
            "wind": {"pressure": {"body": "first", "faces": "all",
                                  "pressure": {"table": {"times": [0, 0.01, 0.02], "values": [1000, 3000, 2000]}}}},
            "gust": {"pressure": {"body": "second", "faces": "all",
                                  "pressure": {"harmonic": {"amplitude": 2000, "frequency": 20}}}},
            "rope": {"edge": {"body": "first", "edges": "y0", "direction": [1, 0.5, -1], "magnitude": 300}},
            "lift": {"area": {"body": "second", "faces": "all", "direction": [0.2, 0.3, 1], "axes": "body", "magnitude": 800}},
            "air": {"drag": {"body": "first", "faces": "all", "coefficient": 300, "normal_coefficient": 900, "width": 0.5}},
        });
        document["functions"]["drag"] = json!({"integral": {"power": {"load": "air"}}});
        document["variables"] = json!({
            "value": {"path": "/loads/wind/pressure/pressure/table/values/1", "lower": 1000, "upper": 5000},
            "amplitude": {"path": "/loads/gust/pressure/pressure/harmonic/amplitude", "lower": 1000, "upper": 5000},
            "frequency": {"path": "/loads/gust/pressure/pressure/harmonic/frequency", "lower": 10, "upper": 30},
            "rope": {"path": "/loads/rope/edge/magnitude", "lower": 100, "upper": 500},
            "drag": {"path": "/loads/air/drag/coefficient", "lower": 100, "upper": 500},
            "normal": {"path": "/loads/air/drag/normal_coefficient", "lower": 100, "upper": 2000},
            "width": {"path": "/loads/air/drag/width", "lower": 0.1, "upper": 2},
            "direction": {"path": "/loads/lift/area/direction/0", "lower": 0.1, "upper": 0.5},
            "thickness": {"path": "/bodies/second/elements/structure/thickness/value", "lower": 0.01, "upper": 0.1},
            "duration": {"path": "/simulation/duration", "lower": 0.01, "upper": 0.03},
        });
        let problem = parsed(&document);
        scaled_gradients_are_exact(&problem, &problem.start(), &json!([method, basis]));
    }
}

/// Line loads on beams: derivatives, and what files may not say.
#[test]
fn line_loads_act_on_beams() {
    let document = |offset: bool, load: Value| {
        let mut document = json!({
            "version": 1, "name": "beam", "gravity": [0, 0, 0],
            "materials": {"soft": {"young": 1e11, "poisson": 0.3, "density": 1000}},
            "bodies": {"beam": {"elements": {
                "structure": {
                    "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [2, 0, 0], "orientation": [0, 0, 1], "elements": 4}},
                    "material": "soft", "section": {"rectangle": {"width": 0.03, "height": 0.05}},
                },
                "frame": {"clamped": "start"}, "points": {"start": {"node": "start"}, "end": {"node": "end"}},
            }}},
            "start": "equilibrium",
            "joints": {"wall": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}}},
            "loads": {"load": load},
            "simulation": {"duration": 0.01, "steps": 4, "method": {"bdf": {"order": 2}}},
            "functions": {"wall": {"final": {"joint_force": {"joint": "wall", "on": "beam", "direction": [0, 0, 1]}}},
                          "moment": {"final": {"joint_moment": {"joint": "wall", "on": "beam", "direction": [0, 1, 0]}}}},
        });
        if offset {
            document["bodies"]["beam"]["elements"]["structure"]["offset"] = json!([0.01, 0]);
        }
        document
    };
    let line =
        json!({"line": {"body": "beam", "beams": "all", "direction": [0, 0, -1], "magnitude": 3}});
    let found = values(&document(false, line.clone()));
    // 3 N/m over 2 m at 1 m. The beam bends by 5e-4 m, so that the lever of the moment is shorter by the square of that.
    assert!((found[0] - 6.0).abs() < 1e-9, "{found:?}");
    assert!((found[1] + 6.0).abs() < 1e-6, "{found:?}");
    let fault = |document: &Value| {
        let faults = Problem::parse(&document.to_string(), "beam", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    for (document, expected) in [
        (document(true, line), "beams without an offset"),
        (
            document(
                false,
                json!({"line": {"body": "beam", "beams": "al", "direction": [0, 0, 1], "magnitude": 3}}),
            ),
            "did you mean \"all\"?",
        ),
        (
            document(
                false,
                json!({"pressure": {"body": "beam", "faces": "all", "pressure": 3}}),
            ),
            "there are no sets of faces",
        ),
        (
            document(
                false,
                json!({"edge": {"body": "beem", "edges": "x0", "direction": [0, 0, 1], "magnitude": 3}}),
            ),
            "did you mean \"beam\"?",
        ),
        (
            document(
                false,
                json!({"pressure": {"body": "beam", "faces": "all", "pressure": {"table": {"times": [0, 0], "values": [1, 2]}}}}),
            ),
            "times that increase",
        ),
    ] {
        let text = fault(&document);
        assert!(text.contains(expected), "{expected}: {text}");
    }
}
