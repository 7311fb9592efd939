//! Scenes with beams from files: torques at their points, starts of joints, pictures.

use crate::reference::documents::{problem as parsed, run, values};
use flexbody_driver::{check, simulate};
use flexbody_figures::of_simulation;
use serde_json::Value;

/// A torque at the end of a cantilever turns it there by T L / EI and moves it by T L² / 2 EI; one at a
/// part a of the length by T a L / EI and T a L² (1 − a / 2) / EI. So in each plane, turned by any angle.
#[test]
fn a_torque_bends_a_cantilever() {
    let (length, young, height, width) = (2.0_f64, 1e9, 0.04_f64, 0.06_f64);
    for (part, axis, ground_angle) in [(1.0, 2, 0.0), (1.0, 1, 0.7), (0.5, 2, -1.1)] {
        let stiffness = match axis {
            2 => young * width * height.powi(3) / 12.0,
            _ => young * height * width.powi(3) / 12.0,
        };
        let torque = 0.02;
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        let moves = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]][2 - axis];
        let document = json!({
            "version": 1, "name": "cantilever", "gravity": [0, 0, 0],
            "bodies": {"bar": {
                "beam": {
                    "length": length, "section": {"rectangle": {"width": width, "height": height}},
                    "material": {"young": young, "density": 10}, "frame": "clamped", "shear": false,
                    "modes": {"bending_y": 8, "bending_z": 8, "torsion": 0}, "strain": "linear",
                    "stations": {"here": part}, "damping": {"ratio": 0.7}
                },
                "place": {"put": "start", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": ground_angle}}
            }},
            "joints": {"wall": {"weld": {"between": ["bar", "ground"], "at": "bar.start"}}},
            "loads": {"turn": {"torque": {"body": "bar", "point": "here", "direction": direction, "axes": "body",
                                          "magnitude": torque}}},
            "simulation": {"duration": 3, "tolerance": 1e-7, "method": {"radau": {"stages": 3}}},
            "functions": {
                "tip": {"final": {"elastic_displacement": {"body": "bar", "point": "end", "direction": moves}}},
                "wall": {"final": {"joint_moment": {"joint": "wall", "direction": direction, "axes": "joint"}}}
            }
        });
        let motion = run(&document);
        let expected = torque * part * length * length * (1.0 - 0.5 * part) / stiffness;
        let found = motion.at.function(0).value;
        // Polynomials follow the corner of the slope at the half less well.
        let close = if part < 1.0 { 2e-3 } else { 1e-5 };
        assert!((found / expected - 1.0).abs() < close, "{found} {expected}");
        // The wall bears the torque.
        let held = motion.at.function(1).value;
        assert!(held.abs() <= torque * 1.001, "{held}");
    }
}

/// A double pendulum of beams; `angles` of the elbow and its rate, by the start of the joint or by placement.
fn elbow(angle: f64, rate: f64, by_joint: bool) -> Value {
    let beam = json!({
        "length": 1, "section": {"rectangle": {"width": 0.05, "height": 0.02}},
        "material": {"young": 1e9, "density": 500},
        "modes": {"bending_y": 2, "bending_z": 1, "torsion": 1}, "damping": {"ratio": 0.02}
    });
    let turn = |angle: f64| json!({"axis": [0, 0, 1], "angle": angle});
    let placed = if by_joint { 0.0 } else { angle };
    let mut document = json!({
        "version": 1, "name": "elbow",
        "bodies": {
            "upper": {"beam": beam, "place": {"put": "start", "at": [0, 0, 0]}},
            "lower": {"beam": beam, "place": {"put": "start", "at": "upper.end", "turn": turn(placed)}}
        },
        "joints": {
            "shoulder": {"revolute": {"between": ["upper", "ground"], "at": "upper.start", "axis": [0, 0, 1]}},
            "elbow": {"revolute": {"between": ["lower", "upper"], "at": "lower.start", "axis": [0, 0, 1]}}
        },
        "simulation": {"duration": 0.1, "steps": 40, "method": {"radau": {"stages": 2}}},
        "functions": {
            "x": {"final": {"position": {"body": "lower", "point": "end", "direction": [1, 0, 0]}}},
            "y": {"final": {"position": {"body": "lower", "point": "end", "direction": [0, 1, 0]}}},
            "speed": {"integral": {"velocity": {"body": "lower", "point": "end", "direction": [0, 1, 0]}}},
            "energy": {"integral": {"energy": "kinetic"}}
        }
    });
    match by_joint {
        true => {
            document["joints"]["elbow"]["revolute"]["start"] =
                json!({"turn": {"angle": angle, "rate": rate}});
        }
        false => document["bodies"]["lower"]["velocity"] = json!({"angular": [0, 0, rate]}),
    }
    document
}

/// Beams follow the start of a joint as straight bodies: the motion is that of the placed scene.
#[test]
fn joints_of_beams_start_where_they_are_told() {
    for (angle, rate) in [(0.4, 0.0), (-1.2, 0.0), (0.0, 2.0), (2.5, -3.0)] {
        let [told, placed] = [true, false].map(|by_joint| run(&elbow(angle, rate, by_joint)));
        for f in 0..4 {
            let (a, b) = (told.at.function(f).value, placed.at.function(f).value);
            assert!(
                (a - b).abs() < 1e-8 * b.abs().max(1.0),
                "{angle} {rate} {f}: {a} {b}"
            );
        }
    }
}

/// Exact derivatives in the start of a joint that beams follow.
#[test]
fn starts_with_beams_have_exact_derivatives() {
    let mut tree = elbow(0.4, 2.0, true);
    tree["simulation"] = json!({"duration": 0.1, "steps": 20, "method": {"radau": {"stages": 2}}});
    let start = "/joints/elbow/revolute/start/turn";
    tree["variables"] = json!({
        "angle": {"path": format!("{start}/angle")},
        "rate": {"path": format!("{start}/rate")},
        "length": {"path": "/bodies/upper/beam/length", "lower": 0.1},
        "young": {"path": "/bodies/lower/beam/material/young", "lower": 1e6}
    });
    let problem = parsed(&tree);
    let found = check(&problem, &problem.start()).expect("runs");
    assert_eq!(found.len(), 16);
    for d in found {
        let off = (d.adjoint - d.complex_step).abs();
        assert!(off <= 1e-12 * d.terms.max(d.complex_step.abs()), "{d:?}");
    }
}

/// Pictures have the bent beam in colours of one scale, and the displacement of its end.
#[test]
fn beams_are_drawn_bent_and_coloured() {
    let document = elbow(0.4, 3.0, true);
    let problem = parsed(&document);
    let motion = simulate(&problem, &problem.start()).expect("runs");
    let figures = of_simulation(&problem, &motion);
    let text = |wanted: &str| {
        let found = figures.iter().find(|(name, _)| *name == wanted);
        let (_, bytes) = found.unwrap_or_else(|| panic!("{wanted} is drawn"));
        String::from_utf8(bytes.clone()).expect("text")
    };
    let (motion, deflection) = (text("motion.svg"), text("deflection.svg"));
    assert!(motion.contains("upper, lower: stress from"));
    assert!(motion.contains("largest along the fibres of a beam"));
    // The scale starts at the lowest stress, and ends at the largest of the run.
    assert!(motion.contains("#440154"));
    assert!(deflection.contains("lower: middle along y"));
    assert!(deflection.contains("axes [m]"), "the unit is cut");
    if let Some(folder) = std::env::var_os("PICTURES") {
        for (name, bytes) in &figures {
            std::fs::write(std::path::Path::new(&folder).join(name), bytes).expect("written");
        }
    }
    // A rigid scene has no such picture.
    let mut rigid = document;
    rigid["bodies"] = json!({"upper": {"shape": {"box": {"size": [1, 1, 1]}}, "mass": 1,
        "points": {"start": [-0.5, 0, 0]}, "place": {"put": "start", "at": [0, 0, 0]}}});
    rigid["joints"]
        .as_object_mut()
        .expect("joints")
        .remove("elbow");
    rigid["functions"] = json!({});
    let motion = run(&rigid);
    let figures = of_simulation(&parsed(&rigid), &motion);
    assert!(figures.iter().all(|(name, _)| *name != "deflection.svg"));
}

/// Bodies that are bent far are told where no point is observed that turns: a plate under a load on its area, and a
/// beam under its weight. Ends turn by p / 6, p = q L³ / EI.
#[test]
fn bodies_that_turn_far_inside_are_told() {
    let bent = |document: &Value, turn: f64| {
        let warning = run(document).warning.unwrap_or_default();
        let told = warning.contains("turns by") && warning.contains("divide the body");
        assert_eq!(told, turn > 0.16, "{turn}: {warning}");
    };
    let text = include_str!("../../problems/extreme/covered_plate.json");
    let mut plate: Value = serde_json::from_str(text).expect("valid JSON");
    let mut beam = json!({
        "version": 1, "name": "beam", "start": "equilibrium",
        "bodies": {"beam": {
            "beam": {
                "length": 1, "section": {"rectangle": {"width": 0.25, "height": 0.01}},
                "material": {"young": 1e9, "density": 1000}, "frame": "clamped",
                "modes": {"bending_y": 4, "bending_z": 0, "torsion": 0}
            },
            "place": {"put": "start", "at": [0, 0, 0]}
        }},
        "joints": {"wall": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}}},
        "simulation": {"duration": 0.1, "steps": 10, "method": {"radau": {"stages": 3}}},
        "functions": {"strain energy": {"final": {"strain_energy": {"body": "beam"}}}},
        "variables": {"young": {"path": "/bodies/beam/beam/material/young", "lower": 1e6}}
    });
    // Linear strain, without functions at points.
    let mut linear = beam.clone();
    linear["bodies"]["beam"]["beam"]["strain"] = json!("linear");
    for turn in [0.1, 0.13, 0.18, 0.4] {
        let stiffness = 1e9 * 0.01_f64.powi(3) / 12.0;
        plate["loads"]["push"]["area"]["magnitude"] = json!(6.0 * turn * stiffness);
        bent(&plate, turn);
        let weight = 6.0 * turn * stiffness / (1000.0 * 0.01);
        beam["gravity"] = json!([0, -weight, 0]);
        bent(&beam, turn);
        linear["gravity"] = json!([0, -weight, 0]);
        bent(&linear, turn);
    }
}

/// A joint at the end of a beam by coordinates is a place of its own where the design moves the end.
#[test]
fn places_of_a_beam_may_part_with_the_design() {
    let document = json!({
        "version": 1, "name": "beam", "gravity": [0, 0, 0],
        "bodies": {
            "beam": {"beam": {
                "length": 1, "section": {"rectangle": {"width": 0.03, "height": 0.03}}, "material": {"young": 1e9, "density": 1000}
            }},
            "box": {"shape": {"box": {"size": [0.3, 0.1, 0.1]}}, "mass": 1, "place": {"at": [1, 0, 0]}}
        },
        "joints": {
            "root": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}},
            "box": {"weld": {"between": ["box", "beam"], "at": [1, 0, 0]}}
        },
        "loads": {"tip": {"force": {"body": "beam", "point": "end", "direction": [0, 0, 1], "magnitude": 0.1}}},
        "functions": {"mass": "mass", "y": {"final": {"position": {"body": "box", "direction": [0, 0, 1]}}}},
        "simulation": {"duration": 0.01},
        "variables": {"length": {"path": "/bodies/beam/beam/length", "lower": 0.5, "upper": 2}}
    });
    let mut plain = document.clone();
    plain["variables"] = json!({});
    assert_eq!(values(&document), values(&plain));
    plain["bodies"]["beam"]["beam"]["length"] = json!(1.5);
    let longer = values(&plain);
    let at = simulate(&parsed(&document), &[1.5]).expect("a motion").at;
    for (f, value) in longer.into_iter().enumerate() {
        let off = (at.function(f).value - value).abs();
        assert!(off <= 1e-9 * value.abs(), "{f}: {off:e}");
    }
}
