//! Shells that move, from files: two hinged plates against an independent code of geometrically exact shells;
//! derivatives of all functions by the complex step; what files may not say.

use crate::reference::documents::{plates, problem as parsed, read, run};
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody_driver::simulate;
use flexbody_driver::start::notes;
use flexbody_mechanics::system::flexible::strain_energy;
use flexbody_mechanics::system::nearest::nearest;
use flexbody_mechanics::system::{BodyMotion, Numbering};
use flexbody_problem::Problem;
use serde_json::Value;

/// Positions after 0.1 s. The plates hardly bend, so a coarse mesh suffices.
#[test]
fn two_plates_follow_their_reference() {
    let reference = read("tests/data/double_plate_reference.json");
    let instants = reference["instants"].as_array().expect("a list");
    let at = instants
        .iter()
        .find(|at| at["t"] == json!(0.1))
        .expect("0.1 s");
    let method = json!({"radau": {"stages": 3}});
    let problem = parsed(&plates([4, 1], 0.1, 50, &method));
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let points = [
        ("hinge", "hinge2"),
        ("tip", "tip"),
        ("centre 1", "centre1"),
        ("centre 2", "centre2"),
    ];
    for (own, name) in points {
        for (k, axis) in ["x", "y"].iter().enumerate() {
            let function = format!("{own} {axis}");
            let mut names = problem.function_names.iter();
            let index = names
                .position(|name| *name == function)
                .expect("a function");
            let (found, exact) = (
                motion.at.function(index).value,
                at[name][k].as_f64().expect("a number"),
            );
            assert!((found - exact).abs() < 5e-5, "{function}: {found} {exact}");
        }
    }
}

/// Two hinged plates of 5 mm that turn with 8 rad/s, BDF2 with 1 ms: the factors of one step serve several, and
/// no iteration changes round-off alone.
#[test]
fn kept_factors_serve_plates_that_turn() {
    let steps = 100;
    let problem = parsed(&plates([4, 1], 0.1, steps, &json!({"bdf": {"order": 2}})));
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let counts = motion.at.run.counts;
    assert!(counts.factorisations <= 30, "{}", counts.factorisations);
    let iterations = counts.newton_iterations;
    assert!(10 * iterations <= 52 * steps, "{iterations}");
}

/// A strip of thin shells bends far. Its forces have more round-off than Newton's method asks of other scenes:
/// it ends there with few iterations.
#[test]
fn iterations_of_thin_shells_end_at_round_off() {
    let mut document = read("problems/flexible/spin_up_shells.json");
    document["simulation"]["duration"] = json!(4);
    document["simulation"]["steps"] = json!(400);
    let problem = parsed(&document);
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let iterations = motion.at.run.counts.newton_iterations;
    assert!(iterations <= 3 * 400, "{iterations}");
}

/// Derivatives of positions, energies and stresses by thickness of bands, modulus and density, by the methods
/// that serve shells. The plates are thick and soft, so that positions depend on them; those of thin metal plates
/// move by 1e-4 m only, and round-off of positions of 1 m is 1e-11 of that.
#[test]
fn derivatives_are_exact() {
    let methods = [
        json!({"bdf": {"order": 2}}),
        json!({"radau": {"stages": 2}}),
        json!({"radau": {"stages": 3}}),
        json!({"generalised_alpha": {"radius": 0.8}}),
    ];
    for method in methods {
        let mut document = plates([2, 1], 0.02, 8, &method);
        thick_and_soft(&mut document);
        let problem = parsed(&document);
        assert_eq!(problem.variables.len(), 5);
        scaled_gradients_are_exact(&problem, &problem.start(), &method);
    }
}

/// A change of a document.
type Change = dyn Fn(&mut Value);

#[test]
fn what_a_file_may_not_say() {
    let faulty = |change: &Change| {
        let mut document = plates([2, 1], 0.1, 10, &json!({"bdf": {"order": 2}}));
        change(&mut document);
        let faults = Problem::parse(&document.to_string(), "plates", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    assert_eq!(faulty(&|_| {}), "");
    let cases: [(&Change, &str); 13] = [
        (
            &|d| {
                d["simulation"]["linear_solver"] = json!("krylov");
                d["simulation"]["method"] = json!({"radau": {"stages": 3}});
            },
            "/simulation/linear_solver\n",
        ),
        (
            &|d| {
                d["simulation"]["linear_solver"] = json!("krylov");
                d["simulation"]
                    .as_object_mut()
                    .expect("an object")
                    .remove("method");
            },
            "the Krylov solver without bdf or generalised_alpha",
        ),
        (
            &|d| {
                d["simulation"]["linear_solver"] = json!("krylov");
                for body in ["first", "second"] {
                    d["bodies"][body]["elements"]["basis"] = json!("rigid");
                }
            },
            "the Krylov solver without a body of finite elements",
        ),
        (
            &|d| d["simulation"]["linear_solver"] = json!("multigrid"),
            "direct",
        ),
        (
            &|d| d["simulation"]["method"] = json!("dop853"),
            "finite elements are stiff",
        ),
        (
            &|d| {
                d["bodies"]["first"]["elements"]["frame"] =
                    json!({"chord": ["start", "end", "middle"]})
            },
            "three nodes on a line",
        ),
        (
            &|d| d["bodies"]["first"]["elements"]["frame"] = json!({"clamped": "x2"}),
            "the name of a set of nodes or of an edge",
        ),
        (
            &|d| d["bodies"]["first"]["elements"]["points"]["other"] = json!({"node": "end"}),
            "points at different places",
        ),
        (
            &|d| d["joints"]["root"]["revolute"]["at"] = json!([0.1, 0, 0]),
            "a point that the \"elements\" of the body name",
        ),
        (
            &|d| d["bodies"]["first"]["mass"] = json!(3),
            "beside \"elements\"",
        ),
        (
            &|d| {
                d["bodies"]["first"]["elements"]["structure"]["supports"] =
                    json!({"a": {"nodes": ["x0"]}})
            },
            "joints, which hold bodies that move",
        ),
        (
            &|d| d["materials"]["aluminium"] = json!({"young": 7e10, "poisson": 0.3}),
            "density",
        ),
        (
            &|d| d["variables"] = json!({"length": {"path": "/bodies/first/elements/structure/mesh/plate/length", "lower": 0.5, "upper": 2}}),
            "a design variable in the mesh or material of shells that move",
        ),
    ];
    for (change, expected) in cases {
        let text = faulty(change);
        assert!(text.contains(expected), "{expected}: {text}");
    }
}

/// The largest stress beside an aggregate depends neither on its ρ nor on the number of points: bodies without stress
/// have none.
#[test]
fn the_largest_stress_is_not_aggregated() {
    let largest = |rho: f64, basis: &str| {
        let mut document = plates([2, 1], 0.02, 10, &json!({"bdf": {"order": 2}}));
        document["functions"]["stress 1"]["ks"]["of"]["von_mises"]["rho"] = json!(rho);
        document["bodies"]["first"]["elements"]["basis"] = json!(basis);
        let motion = run(&document);
        let names = parsed(&document).function_names;
        let f = names.iter().position(|name| name == "stress 1");
        let maximum = motion.at.function(f.expect("a function")).maximum;
        maximum.expect("an aggregate").value
    };
    let [soft, hard] = [50.0, 2e5].map(|rho| largest(rho, "full"));
    assert!(hard > 0.005 && (soft - hard).abs() < 1e-14, "{soft} {hard}");
    assert_eq!(largest(200.0, "rigid"), 0.0);
}

/// Parts of a mesh that share no node would fly apart; edges may be curved.
#[test]
fn loose_parts_are_refused_and_curved_edges_held() {
    let faults = |mesh: &Value, sets: &Value, elements: &Value| {
        let mut body = json!({"elements": {
            "structure": {"mesh": mesh, "material": "aluminium", "thickness": 0.005, "sets": sets}}});
        for (key, value) in elements.as_object().expect("keys") {
            body["elements"][key] = value.clone();
        }
        if mesh.get("frame").is_some() {
            let structure = &mut body["elements"]["structure"];
            structure.as_object_mut().expect("keys").remove("thickness");
            structure["section"] = json!({"rectangle": {"width": 0.02, "height": 0.01}});
        }
        let document = json!({
            "version": 1, "name": "one", "bodies": {"body": body},
            "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}},
            "simulation": {"duration": 0.01, "steps": 10, "method": {"bdf": {"order": 2}}},
            "functions": {"energy": {"final": {"energy": "total"}}}
        });
        let faults = Problem::parse(&document.to_string(), "one", &[]).err();
        faults.map_or_else(String::new, |faults| faults.to_string())
    };
    let frame = |to: [i32; 3]| {
        let member = |between: [&str; 2]| json!({"between": between, "orientation": [0, 0, 1], "elements": 2});
        json!({"frame": {
            "points": {"a": [0, 0, 0], "b": [1, 0, 0], "c": [1, 1, 0], "d": to},
            "members": {"u": member(["a", "b"]), "v": member(["c", "d"])}
        }})
    };
    let clamped = json!({"frame": {"clamped": "a"}, "points": {"p": {"node": "b"}}});
    let mut one = frame([5, 5, 0]);
    one["frame"]["members"]["w"] = one["frame"]["members"]["u"].clone();
    one["frame"]["members"]["w"]["between"] = json!(["b", "c"]);
    assert_eq!(faults(&one, &json!({}), &clamped), "");
    let text = faults(&frame([5, 5, 0]), &json!({}), &clamped);
    assert!(text.contains("2 parts that share no node"), "{text}");
    let panel =
        json!({"curved_panel": {"radius": 1, "length": 1, "angles": [0, 1], "elements": [2, 2]}});
    let corners = json!({
        "p": {"node": {"at": [0, 0]}}, "q": {"node": {"at": [1, 0]}}, "r": {"node": {"at": [0, 1]}}});
    let at =
        |edge: &str| json!({"frame": {"chord": ["p", "q", "r"]}, "points": {"a": {"edge": edge}}});
    for edge in ["x0", "x1", "y0", "y1"] {
        assert_eq!(faults(&panel, &corners, &at(edge)), "");
    }
}

/// Bodies whose start in equilibrium is that of the file are not said to be moved by starts of joints.
#[test]
fn a_start_in_equilibrium_is_no_start_of_a_joint() {
    let mut document = plates([2, 1], 0.02, 10, &json!({"bdf": {"order": 2}}));
    document["start"] = json!("equilibrium");
    let problem = parsed(&document);
    let told = notes(&problem, &problem.start());
    assert!(
        told.iter().all(|note| !note.contains("starts of joints")),
        "{told:?}"
    );
}

/// A gap between plates is closed by moving them, without deformation, at rest and turned; also in a basis with short
/// waves, whose mass is small beside the rotation of their edges.
#[test]
fn gaps_are_closed_by_motions_of_bodies() {
    let many = json!({"reduced": {"modes": 12, "tolerance": 0.003}});
    let full = json!("full");
    let gaps = [(&full, 1e-4, 0.0), (&full, 1e-2, 0.0), (&full, 1e-3, 2e-3)];
    for (basis, gap, shift) in gaps.into_iter().chain([(&many, 1e-2, 2e-3)]) {
        let mut document = plates([2, 1], 0.02, 10, &json!({"bdf": {"order": 2}}));
        for body in ["first", "second"] {
            document["bodies"][body]["elements"]["basis"] = basis.clone();
        }
        document["bodies"]["second"]["place"]["at"] = json!([1.0 + gap, shift, 0]);
        document["joints"]["hinge"]["revolute"]["at"] = json!({"a": "hinge", "b": "hinge"});
        let problem = parsed(&document);
        let all = notes(&problem, &problem.start());
        assert!(
            all.iter().any(|note| note.contains("was moved by")),
            "{all:?}"
        );
        assert!(all.iter().all(|note| !note.contains("deforms")), "{all:?}");
        let start = nearest(&problem.scene(&problem.start()).model).expect("closes");
        let model = problem.scene(&problem.start()).model;
        let mut motions = Vec::new();
        BodyMotion::all(&Numbering::new(&model), &start.q, &start.v, &mut motions);
        for body in &model.flexible {
            let energy = strain_energy(body, &motions);
            assert!(energy < 1e-3 * gap * gap, "{basis} {gap}: {energy:e} J");
        }
    }
}

/// Plates between two supports that are too far apart have to stretch: the strain energy of that is told.
#[test]
fn plates_that_are_bent_to_fit_are_told() {
    let told = |gap: f64, start: &str| {
        let mut document = plates([2, 1], 0.02, 10, &json!({"bdf": {"order": 2}}));
        document["bodies"]["second"]["place"]["at"] = json!([1.0 + gap, 0, 0]);
        document["joints"]["hinge"]["revolute"]["at"] = json!({"a": "hinge", "b": "hinge"});
        document["joints"]["end"] = json!({"revolute": {
            "between": ["second", "ground"], "at": "second.tip", "axis": [0, 0, 1]
        }});
        document["start"] = json!(start);
        let problem = parsed(&document);
        let all = notes(&problem, &problem.start());
        all.iter().filter(|note| note.contains("deforms")).count()
    };
    for start in ["given", "equilibrium"] {
        assert_eq!(told(0.0, start), 0);
        assert!(told(1e-4, start) > 0);
    }
}

/// A plate that is pushed by more than its stiffness is refused, and is a failure that an optimiser backs off from.
#[test]
fn elements_that_are_turned_inside_out_are_refused() {
    let text = include_str!("../../problems/extreme/cantilever_plate.json");
    let mut document: Value = serde_json::from_str(text).expect("valid JSON");
    document["bodies"]["plate"]["elements"]["structure"]["thickness"] = json!(1);
    document["loads"]["push"]["force"]["direction"] = json!([-1, 0, 0]);
    for (strain, refused) in [(0.5, false), (1.5, true)] {
        document["loads"]["push"]["force"]["magnitude"] = json!(strain * 1e9 * 0.25);
        let problem = parsed(&document);
        let told = match simulate(&problem, &problem.start()) {
            Ok(motion) => motion.warning.expect("a warning"),
            Err(failure) => failure.to_string(),
        };
        assert_eq!(told.contains("turned inside out"), refused, "{told}");
    }
    // A push of a moment in a long run.
    let plate = &mut document["bodies"]["plate"]["elements"]["structure"];
    plate["mesh"]["plate"]["elements"] = json!([3, 1]);
    plate["damping"] = json!({"mass": 50, "stiffness": 0.01});
    document["materials"]["soft"]["young"] = json!(1e6);
    document["variables"]["young"]["lower"] = json!(1e5);
    document["start"] = json!("given");
    document["simulation"] = json!({"duration": 8, "steps": 400, "method": {"bdf": {"order": 2}}});
    document["loads"]["push"]["force"]["magnitude"] = json!({"table": {
        "times": [0, 0.1, 0.2, 0.4, 0.5, 4], "values": [0, 0, 6e5, 6e5, 0, 0]
    }});
    let problem = parsed(&document);
    let failure = simulate(&problem, &problem.start())
        .err()
        .expect("is turned inside out");
    assert!(
        failure.to_string().contains("turned inside out"),
        "{failure}"
    );
}
