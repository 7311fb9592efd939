//! Shells in reduced bases, from files: against all nodes, with exact derivatives; what files may not say.

use crate::reference::documents::{problem as parsed, read, values};
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody_driver::{accuracy, bases, explain, simulate};
use flexbody_problem::{Override, Problem};
use serde_json::Value;

/// The double plate with this mesh and basis, simulated by BDF.
fn plates(elements: [usize; 2], basis: &Value, duration: f64, steps: usize) -> Value {
    let mut document = read("problems/flexible/double_plate.json");
    for body in ["first", "second"] {
        let own = &mut document["bodies"][body]["elements"];
        own["structure"]["mesh"]["plate"]["elements"] = json!(elements);
        own["basis"] = basis.clone();
    }
    let method = json!({"bdf": {"order": 2}});
    document["simulation"] = json!({"duration": duration, "steps": steps, "method": method});
    document
}

fn interfaces(first: &str) -> Value {
    json!([first, "hinge"])
}

/// Positions of the reduced plates against all nodes of the same mesh; and of rigid ones.
#[test]
fn reduced_plates_follow_the_full_ones() {
    let run = |basis: Value| {
        let mut document = plates([4, 1], &basis, 0.1, 50);
        if basis["reduced"].is_object() {
            for (body, first) in [("first", "root"), ("second", "tip")] {
                document["bodies"][body]["elements"]["basis"]["reduced"]["interfaces"] =
                    interfaces(first);
            }
        }
        values(&document)
    };
    let full = run(json!("full"));
    let off = |basis: Value| {
        let found = run(basis);
        let positions = full[..8].iter().zip(&found[..8]);
        positions.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let (reduced, rigid) = (off(json!({"reduced": {"modes": 6}})), off(json!("rigid")));
    assert!(
        reduced < 1e-5 && reduced < 0.05 * rigid,
        "{reduced:e} {rigid:e}"
    );
}

/// Derivatives of positions, energies and stresses by thickness of bands, modulus and density. The basis is that
/// of the file, so that derivatives are exact.
#[test]
fn derivatives_are_exact() {
    let basis = json!({"reduced": {"modes": 2, "interfaces": ["hinge"], "deflection": 0}});
    let mut document = plates([2, 1], &basis, 0.02, 8);
    thick_and_soft(&mut document);
    let problem = parsed(&document);
    assert_eq!(problem.variables.len(), 5);
    // Not the design of the basis.
    let mut x = problem.start();
    x[0] *= 1.2;
    scaled_gradients_are_exact(&problem, &x, &basis);
}

/// The error of a basis is the difference from all nodes, be it poor or good. Richer bases change a function in
/// the order of magnitude of the error.
#[test]
fn errors_of_bases_are_those_against_all_nodes() {
    let full = values(&plates([2, 1], &json!("full"), 0.1, 50));
    let which: Vec<usize> = (0..4).collect();
    for basis in [
        json!("rigid"),
        json!({"reduced": {"modes": 1, "tolerance": 0.3}}),
    ] {
        let problem = parsed(&plates([2, 1], &basis, 0.1, 50));
        let motion = simulate(&problem, &problem.start()).expect("runs");
        let errors = bases::errors(&problem, &motion.at, &which).expect("runs");
        let mut most = 0.0_f64;
        for (own, exact) in errors.iter().zip(&full) {
            assert!((own.other - exact).abs() < 1e-9 * exact.abs(), "{own:?}");
            most = most.max(own.error());
        }
        let changes = bases::changes(&problem, &motion.at, &which).expect("runs");
        let change = changes.iter().fold(0.0_f64, |most, c| most.max(c.error()));
        assert!(most > 0.0 && most < 10.0 * change && change < 10.0 * most);
    }
    let problem = parsed(&plates([2, 1], &json!("full"), 0.1, 50));
    let motion = simulate(&problem, &problem.start()).expect("runs");
    let none = bases::errors(&problem, &motion.at, &[0]).expect("none");
    assert!(none.is_empty());
}

/// `--accuracy` adds vectors to a poor basis until it agrees with all nodes, and takes all nodes if none does.
#[test]
fn an_accuracy_makes_bases_rich_enough() {
    let basis = json!({"reduced": {"modes": 1, "tolerance": 0.3}});
    let document = plates([2, 1], &basis, 0.1, 50);
    let exact = values(&plates([2, 1], &json!("full"), 0.1, 50))[0];
    let before = (values(&document)[0] - exact).abs();
    for part in [0.3, 0.0] {
        let mut problem = parsed(&document);
        let accuracy = part * before / exact.abs();
        let reached = accuracy::reach_bases(&mut problem, &[accuracy::Judged::alone(0)], accuracy)
            .expect("runs");
        let x = problem.start();
        let value = bases::run(&problem, &x, &[0])
            .expect("runs")
            .function(0)
            .value;
        let error = (value - exact).abs() / exact.abs();
        assert!(error <= accuracy.max(1e-10), "{error:e} {accuracy:e}");
        assert!((reached.0 - error).abs() < 1e-9, "{} {error}", reached.0);
        assert!(reached.1);
        let changes = problem.basis_overrides(&parsed(&document));
        let all = changes.iter().all(|change| change.ends_with("=\"full\""));
        assert_eq!(all, part == 0.0, "{changes:?}");
    }
}

/// A shell of aluminium, welded at an edge, under pressure: two steps, the side of its other edge and its strain energy.
fn cantilever(
    (mesh, axes): (&Value, &Value),
    basis: &Value,
    (method, start): (&Value, &str),
) -> Value {
    let corner = |x: f64| json!({"node": {"at": [x, 0.5]}});
    let structure = json!({
        "mesh": mesh, "material": "aluminium", "thickness": 0.005,
        "sets": {"start": corner(0.0), "end": corner(1.0)}
    });
    let points = json!({"root": {"edge": "x0"}, "tip": {"edge": "x1"}});
    let side = json!({"body": "plate", "point": "tip", "direction": [0, 1, 0]});
    json!({
        "version": 1, "name": "cantilever", "gravity": [0, 0, 0],
        "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}},
        "bodies": {"plate": {
            "elements": {"structure": structure, "frame": axes, "points": points, "basis": basis},
            "place": {"put": "root", "at": [0, 0, 0]}
        }},
        "joints": {"root": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
        "loads": {"wind": {"pressure": {"body": "plate", "faces": "all", "pressure": 200}}},
        "start": start,
        "simulation": {"duration": 0.001, "steps": 2, "method": method},
        "functions": {
            "side": {"final": {"position": side}},
            "energy": {"final": {"strain_energy": {"body": "plate"}}}
        }
    })
}

/// A function that is round-off has no accuracy relative to itself: steps are not refined for it.
#[test]
fn an_accuracy_of_round_off_ends() {
    let mesh = json!({"plate": {"length": 1, "width": 0.25, "elements": [2, 1]}});
    let (axes, basis) = (json!({"clamped": "x0"}), json!({"reduced": {}}));
    let method = json!({"bdf": {"order": 2}});
    let document = cantilever((&mesh, &axes), &basis, (&method, "given"));
    let mut problem = parsed(&document);
    let reached = accuracy::reach(&mut problem, &[accuracy::Judged::alone(0)], 1e-2).expect("runs");
    assert_eq!(reached.steps, 2);
    assert!(reached.overrides().is_empty(), "{:?}", reached.overrides());
}

/// The motion does not change a mass. Its accuracy is that of the constraints, relative to their bounds.
#[test]
fn an_accuracy_of_a_mass_is_that_of_the_constraints() {
    let mut document = plates(
        [2, 1],
        &json!({"reduced": {"modes": 1, "tolerance": 0.3}}),
        0.1,
        10,
    );
    document["functions"]["mass"] = json!("mass");
    document["variables"] = json!({"h": {
        "path": "/bodies/first/elements/structure/thickness", "lower": 0.002, "upper": 0.02
    }});
    document["objective"] = json!({"minimise": "mass"});
    document["constraints"] = json!({"height": {"function": "hinge y", "lower": -2.0}});
    let mut problem = parsed(&document);
    let objective = problem.stated_objective().expect("one").function;
    let (which, of) = accuracy::judged(&problem, objective);
    assert_eq!((which.len(), which[0].bound, of), (1, 2.0, "constraints"));
    let asked = 1e-5;
    let reached = accuracy::reach(&mut problem, &which, asked).expect("runs");
    assert!(reached.error <= asked, "{:e}", reached.error);
    assert!(reached.steps > 10 && !reached.overrides().is_empty());
}

/// The text of `explain` says what a basis is made of, and what richer ones change.
#[test]
fn a_basis_is_explained() {
    let basis = json!({"reduced": {"modes": 2, "interfaces": ["hinge"], "deflection": 0.01}});
    let text = explain(&parsed(&plates([2, 1], &basis, 0.02, 5))).text();
    for expected in [
        "6 boundary modes, 2 fixed-interface modes",
        "companions",
        "with richer",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let text = explain(&parsed(&plates([2, 1], &json!("rigid"), 0.02, 5))).text();
    assert!(text.contains("as a rigid body"), "{text}");
}

/// A warped panel that hangs from a corner, with a body welded to its rigid edge. The edge does not move in the axes: six
/// motions of each corner are boundary modes, and no round-off is one.
#[test]
fn the_basis_of_a_warped_panel_has_no_round_off() {
    let panel = |lift: f64| {
        let points = json!([
            [0, 0, 0],
            [0.5, 0, 0],
            [1, 0, lift],
            [0, 0.15, 0],
            [0.5, 0.15, 0.025],
            [1, 0.15, 0.05],
            [0, 0.3, 0],
            [0.5, 0.3, 0.05],
            [1, 0.3, 0.1]
        ]);
        json!({
            "version": 1, "name": "panel", "gravity": [1, 2, -5],
            "materials": {"m": {"young": 5e8, "poisson": 0.3, "density": 1000}},
            "bodies": {
                "A": {"elements": {
                    "structure": {"mesh": {"panel": {"points": points, "elements": [4, 1]}}, "material": "m",
                        "thickness": 0.01, "element": "mitc9"},
                    "frame": {"chord": ["x0y0", "x1y0", "x0y1"]},
                    "points": {"root": {"node": "x0y0"}, "end": {"edge": "x1"}, "q": {"node": "x0y1"}},
                    "basis": {"reduced": {}}
                }},
                "B": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1, "place": {"at": "A.end"}}
            },
            "joints": {
                "root": {"spherical": {"between": ["A", "ground"], "at": "A.root"}},
                "end": {"weld": {"between": ["B", "A"], "at": "A.end"}}
            },
            "simulation": {"duration": 0.1, "steps": 25, "method": {"radau": {"stages": 3}}},
            "functions": {
                "velocity": {"final": {"velocity": {"body": "A", "point": "q", "direction": [1, 1, 1]}}},
                "energy": {"final": {"strain_energy": {"body": "A"}}}
            }
        })
    };
    let text = explain(&parsed(&panel(0.0))).text();
    assert!(text.contains("12 boundary modes"), "{text}");
    let flat = values(&panel(0.0));
    for lift in [1e-13, 1e-10] {
        for (found, expected) in values(&panel(lift)).iter().zip(&flat) {
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{lift}: {found} {expected}"
            );
        }
    }
}

/// The changes of the file that `--accuracy` gives make the richer bases.
#[test]
fn richer_bases_are_changes_of_the_file() {
    let basis = json!({"reduced": {"modes": 1, "tolerance": 0.5, "deflection": 0}});
    let document = plates([2, 1], &basis, 0.04, 20);
    let problem = parsed(&document);
    let richer = problem
        .with_richer_bases(&problem.start())
        .expect("has bases");
    let described = |problem: &Problem| problem.flexible_bodies(&problem.start());
    assert_ne!(described(&richer), described(&problem));
    let changes = richer.basis_overrides(&problem);
    assert!(changes[0].starts_with("/bodies/first/elements/basis="));
    let changes = changes
        .iter()
        .map(|change| Override::parse(change).expect("sound"));
    let changes: Vec<Override> = changes.collect();
    let again = Problem::parse(&document.to_string(), "plates", &changes).expect("sound");
    assert_eq!(described(&again), described(&richer));
}

#[test]
fn what_a_file_may_not_say() {
    let cases = [
        (
            json!({"reduced": {"modes": 4, "highest_frequency": 100.0}}),
            "one of them",
        ),
        (json!({"reduced": {"interfaces": ["hing"]}}), "did you mean"),
        (json!({"reduced": {"tolerance": 0}}), "tolerance"),
        (json!({"reduced": {"mode": 4}}), "mode"),
        (json!("reduce"), "reduce"),
    ];
    for (basis, expected) in cases {
        let document = plates([2, 1], &basis, 0.1, 10);
        let faults = Problem::parse(&document.to_string(), "plates", &[]).err();
        let text = faults.map_or_else(String::new, |faults| faults.to_string());
        assert!(text.contains(expected), "{expected}: {text}");
    }
}

/// A cantilever under pressure whose basis locks in chord axes and does not in clamped ones. The warning names a part
/// of the strain energy; all nodes show that it is wrong.
#[test]
fn bases_that_lock_are_told() {
    let flat = json!({"plate": {"length": 1, "width": 0.25, "elements": [6, 2]}});
    let curved = json!({
        "curved_panel": {"radius": 1, "length": 0.5, "angles": [0, 1.0], "elements": [4, 2]}
    });
    let radau = json!({"radau": {"stages": 2}});
    let bent = |mesh: &Value, axes: Value, basis: Value, method: &Value| {
        let mut document = cantilever((mesh, &axes), &basis, (method, "equilibrium"));
        if axes.get("chord").is_some() {
            // With a rigid edge the axes would be clamped there.
            document["bodies"]["plate"]["elements"]["points"]["root"] = json!({"mean": "x0"});
        }
        let problem = parsed(&document);
        let motion = simulate(&problem, &problem.start()).expect("a motion");
        (values(&document)[1], motion.warning.unwrap_or_default())
    };
    let (chord, clamped) = (
        json!({"chord": ["start", "end", "x0y0"]}),
        json!({"clamped": "x0"}),
    );
    let reduced = json!({"reduced": {}});
    let (all, told) = bent(&flat, chord.clone(), json!("full"), &radau);
    assert!(!told.contains("locks"), "{told}");
    let (value, told) = bent(&flat, chord.clone(), reduced.clone(), &radau);
    assert!(!told.contains("locks"), "{told}");
    assert!((value - all).abs() < 0.01 * all.abs(), "{value} {all}");
    let coarse = json!({"reduced": {"tolerance": 0.03}});
    let (value, told) = bent(&flat, chord.clone(), coarse.clone(), &radau);
    let locks = "the reduced basis of \"plate\" locks";
    assert!(told.contains(locks), "{told}");
    assert!((value - all).abs() > 0.05 * all.abs(), "{value} {all}");
    // Beside a warning of the method.
    let (_, told) = bent(&flat, chord, coarse, &json!({"bdf": {"order": 3}}));
    assert!(told.contains(locks) && told.contains("amplifies"), "{told}");
    let few = json!({"reduced": {"modes": 0}});
    for (mesh, basis) in [(&flat, &reduced), (&curved, &few), (&curved, &reduced)] {
        let (all, _) = bent(mesh, clamped.clone(), json!("full"), &radau);
        let (value, told) = bent(mesh, clamped.clone(), basis.clone(), &radau);
        assert!(!told.contains("locks"), "{told}");
        assert!((value - all).abs() < 0.01 * all.abs(), "{value} {all}");
    }
}

/// A basis does not depend on units: it has no vectors of round-off.
#[test]
fn units_of_mass_do_not_change_a_basis() {
    for (frame, points) in [
        (json!({"clamped": "x0"}), 1),
        (json!({"clamped": "x0"}), 3),
        (json!({"chord": ["x0y0", "x1y0", "x0y1"]}), 2),
    ] {
        let all = [
            ("root", "edge", "x0"),
            ("tip", "edge", "x1"),
            ("corner", "node", "x1y1"),
        ];
        let points: serde_json::Map<_, _> = all[..points]
            .iter()
            .map(|(name, kind, place)| ((*name).to_owned(), json!({(kind): place})))
            .collect();
        let explained = |kilogram: f64| {
            let problem = parsed(&json!({
                "version": 1, "name": "plate", "gravity": [0, 0, 0],
                "materials": {"soft": {"young": 1e8 * kilogram, "poisson": 0.3, "density": 1e3 * kilogram}},
                "bodies": {"plate": {"elements": {
                    "structure": {"mesh": {"plate": {"length": 0.65, "width": 0.45, "elements": [3, 2]}},
                                  "material": "soft", "thickness": 0.04},
                    "frame": frame, "points": points, "basis": {"reduced": {"modes": 4}},
                }}},
                "simulation": {"duration": 0.01, "steps": 4, "method": {"bdf": {"order": 2}}},
                "functions": {"energy": {"final": {"strain_energy": {"body": "plate"}}}},
            }));
            problem.flexible_bodies(&[]).join("\n")
        };
        let known = explained(1.0);
        assert!(known.contains(" coordinates of 35 nodes"), "{known}");
        for kilogram in [0.5, 3.0, 1e-3] {
            assert_eq!(explained(kilogram), known);
        }
    }
}

/// The edge at which the frame is clamped holds the axes, in whatever order the points are written.
#[test]
fn the_frame_names_the_edge_that_holds_the_axes() {
    let file = |order: [&str; 2]| {
        let mut points = serde_json::Map::new();
        for name in order {
            let edge = if name == "root" { "x0" } else { "x1" };
            points.insert(name.to_owned(), json!({"rigid": edge}));
        }
        json!({
            "version": 1, "name": "arm", "materials": {"m": {"young": 7e9, "poisson": 0.3, "density": 2700}},
            "bodies": {
                "A": {
                    "elements": {
                        "structure": {"mesh": {"plate": {"length": 1, "width": 0.1, "elements": [4, 1]}}, "material": "m", "thickness": 0.02},
                        "frame": {"clamped": "x0"}, "points": points, "basis": {"reduced": {"modes": 3}}
                    },
                    "place": {"put": "root", "at": [0, 0, 0], "turn": {"x": 90}}
                },
                "W": {"shape": {"box": {"size": [0.1, 0.15, 0.2]}}, "mass": 0.8, "place": {"at": [1, 0, 0]}}
            },
            "joints": {
                "h": {"revolute": {"between": ["A", "ground"], "at": "A.root", "axis": [0, 0, 1]}},
                "k": {"weld": {"between": ["W", "A"], "at": "A.tip"}}
            },
            "simulation": {"duration": 0.05, "steps": 50, "method": {"radau": {"stages": 3}}},
            "functions": {"v": {"final": {"velocity": {"body": "W", "direction": [0.3, 1, 0.2]}}}}
        })
    };
    let [a, b] = [["root", "tip"], ["tip", "root"]].map(|order| values(&file(order))[0]);
    assert!((a - b).abs() < 1e-10 * a.abs(), "{a} {b}");
}

/// A beam in a reduced basis bends as with all nodes, at every size: motions that twist it move no node of its axis.
#[test]
fn reduced_beams_bend_as_full_ones() {
    let file = |l: f64, basis: &Value| {
        json!({
            "version": 1, "name": "beam", "analysis": "rest", "gravity": [0, 0, 0],
            "materials": {"m": {"young": 1e9, "poisson": 0.3, "density": 1000}},
            "bodies": {"beam": {"elements": {
                "structure": {
                    "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [l, 0, 0], "orientation": [0, 1, 0], "elements": 4}},
                    "material": "m", "section": {"rectangle": {"width": 0.03 * l, "height": 0.03 * l}}
                },
                "frame": {"clamped": "start"}, "points": {"root": {"node": "start"}, "tip": {"node": "end"}}, "basis": basis
            }}},
            "joints": {"root": {"weld": {"between": ["beam", "ground"], "at": "beam.root"}}},
            "loads": {"tip": {"force": {"body": "beam", "point": "tip", "direction": [0, 0, 1], "magnitude": 5.0 * l * l}}},
            "functions": {"z": {"final": {"position": {"body": "beam", "point": "tip", "direction": [0, 0, 1]}}}}
        })
    };
    for l in [1.0, 1e-3] {
        let [reduced, full] =
            [json!({"reduced": {}}), json!("full")].map(|basis| values(&file(l, &basis))[0] / l);
        assert!(
            (reduced - full).abs() < 1e-5 * full,
            "{l}: {reduced} {full}"
        );
    }
}
