//! Rotations in their forms, angles in degrees, and points between others: the same scene, exact derivatives, faults.

use flexbody_driver::check;
use flexbody_driver::evaluate::Evaluated;
use flexbody_problem::Problem;

/// A box that hangs at a corner, turned.
fn hung(turn: &str, rest: &str) -> String {
    format!(
        r#"{{
  "version": 1, "name": "hung",
  "bodies": {{
    "box": {{"shape": {{"box": {{"size": [1, 0.4, 0.2]}}}}, "mass": 3,
      "points": {{"a": [-0.5, 0.2, 0.1], "b": [0.5, -0.1, 0], "c": {{"between": ["a", "b"], "fraction": 0.25}}}},
      "place": {{"put": "a", "turn": {turn}}}}}
  }},
  "joints": {{"pin": {{"spherical": {{"between": ["box", "ground"], "at": "box.a"}}}}}},
  "simulation": {{"duration": 0.3, "tolerance": 1e-11}},
  "functions": {{"x": {{"final": {{"position": {{"body": "box", "point": "c", "direction": [0.3, 0.5, 1]}}}}}}}}{rest}
}}"#
    )
}

fn problem(text: &str) -> Problem {
    Problem::parse(text, "f.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

fn evaluated(text: &str) -> (Vec<f64>, f64) {
    let own = problem(text);
    let at = Evaluated::new(&own, &own.start()).expect("runs");
    (at.scene.parameters(), at.function(0).value)
}

/// Each form is the list of rotations that it stands for.
#[test]
fn forms_of_a_turn_are_the_same_rotation() {
    let about = |axis: [f64; 3], degrees: f64| {
        format!(r#"{{"axis": {axis:?}, "angle": {}}}"#, degrees.to_radians())
    };
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let (s, c) = 20_f64.to_radians().sin_cos();
    for (form, expected) in [
        (r#"{"x": 20}"#.to_owned(), about(x, 20.0)),
        (r#"{"y": 20}"#.to_owned(), about(y, 20.0)),
        (r#"{"z": "= 2*10"}"#.to_owned(), about(z, 20.0)),
        (
            r#"{"axis": [0, 3, 4], "degrees": -50}"#.to_owned(),
            about([0.0, 3.0, 4.0], -50.0),
        ),
        // About the body's own axes: the last is the first about those of ground.
        (
            r#"{"sequence": "zyx", "degrees": [30, -20, 10]}"#.to_owned(),
            format!(
                "[{}, {}, {}]",
                about(x, 10.0),
                about(y, -20.0),
                about(z, 30.0)
            ),
        ),
        (
            r#"{"sequence": "zxz", "angles": [0.5, "= 20*deg", 0.1]}"#.to_owned(),
            format!(
                "[{}, {}, {}]",
                about(z, 0.1_f64.to_degrees()),
                about(x, 20.0),
                about(z, 0.5_f64.to_degrees())
            ),
        ),
        (
            format!(
                r#"{{"quaternion": [{}, 0, {}, 0]}}"#,
                10_f64.to_radians().cos(),
                10_f64.to_radians().sin()
            ),
            about(y, 20.0),
        ),
        (
            r#"{"quaternion": [-0.5, 0.5, 0.5, 0.5]}"#.to_owned(),
            about([-1.0, -1.0, -1.0], 120.0),
        ),
        (
            format!(
                r#"{{"matrix": [[{c}, 0, {s}], [0, 1, 0], [{}, 0, {c}]]}}"#,
                -s
            ),
            about(y, 20.0),
        ),
        (
            r#"{"matrix": [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]}"#.to_owned(),
            about(z, 180.0),
        ),
        (
            r#"[{"x": 20}, {"quaternion": [0, 0, 0, 1]}]"#.to_owned(),
            format!("[{}, {}]", about(x, 20.0), about(z, 180.0)),
        ),
    ] {
        let ((scene, value), (exact, expected)) =
            (evaluated(&hung(&form, "")), evaluated(&hung(&expected, "")));
        for (own, exact) in scene.iter().zip(&exact) {
            // A quaternion and its negative are one rotation.
            assert!(
                (own.abs() - exact.abs()).abs() <= 1e-14,
                "{form}: {own} {exact}"
            );
        }
        assert!(
            (value - expected).abs() <= 1e-10,
            "{form}: {value} {expected}"
        );
    }
    // Rounded numbers are those of the nearest rotation.
    let rounded = evaluated(&hung(
        r#"{"matrix": [[0.9397, 0, 0.342], [0, 1, 0], [-0.342, 0, 0.9397]]}"#,
        "",
    ))
    .1;
    let exact = evaluated(&hung(r#"{"y": 20}"#, "")).1;
    assert!((rounded - exact).abs() < 1e-4, "{rounded} {exact}");
}

/// Variables of angles in degrees, sequences, quaternions, ends and fractions have exact derivatives in their own unit.
#[test]
fn derivatives_of_turns_and_points_are_exact() {
    for (turn, below) in [
        (r#"{"x": 20}"#, "x"),
        (r#"{"axis": [0, 3, 4], "degrees": -50}"#, "degrees"),
        (
            r#"{"sequence": "zyx", "degrees": [30, -20, 10]}"#,
            "degrees/1",
        ),
        (
            r#"{"sequence": "zxz", "angles": [0.5, 0.2, 0.1]}"#,
            "angles/2",
        ),
        (r#"{"quaternion": [-0.5, 0.5, 0.5, 0.5]}"#, "quaternion/2"),
    ] {
        let rest = format!(
            r#", "variables": {{"turn": {{"path": "/bodies/box/place/turn/{below}"}},
              "fraction": {{"path": "/bodies/box/points/c/fraction", "lower": 0, "upper": 1}},
              "end": {{"path": "/bodies/box/points/b/1"}}}}"#
        );
        let own = problem(&hung(turn, &rest));
        let all = check(&own, &own.start()).expect("runs");
        assert_eq!(all.len(), 3);
        for (k, derivative) in all.iter().enumerate() {
            let error = derivative.relative_difference();
            assert!(error <= 1e-11, "{turn}: {derivative:?}");
            let h = 1e-5;
            let at = |by: f64| {
                let mut x = own.start();
                x[k] += by;
                Evaluated::new(&own, &x).expect("runs").function(0).value
            };
            let difference = (at(h) - at(-h)) / (2.0 * h);
            assert!(
                (derivative.complex_step - difference).abs() < 1e-7,
                "{turn}: {derivative:?} {difference}"
            );
        }
    }
}

/// Starts of joints in degrees.
#[test]
fn joints_start_in_degrees() {
    let text = |start: &str, rest: &str| {
        format!(
            r#"{{"version": 1, "name": "arm",
            "bodies": {{"arm": {{"shape": {{"rod": {{"length": 1, "radius": 0.1}}}}, "mass": 2, "points": {{"a": [-0.5, 0, 0]}}, "place": {{"put": "a"}}}}}},
            "joints": {{"pin": {{"revolute": {{"between": ["arm", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1], "start": {{"turn": {start}}}}}}}}},
            "simulation": {{"duration": 0.2}},
            "functions": {{"angle": {{"final": {{"angle": {{"joint": "pin"}}}}}}}}{rest}}}"#
        )
    };
    let radians = evaluated(&text(r#"{"angle": "= 40*deg", "rate": "= -90*deg"}"#, ""));
    assert_eq!(
        evaluated(&text(r#"{"degrees": 40, "degrees_per_second": -90}"#, "")),
        radians
    );
    let rest = r#", "variables": {"start": {"path": "/joints/pin/revolute/start/turn/degrees"}, "rate": {"path": "/joints/pin/revolute/start/turn/degrees_per_second"}}"#;
    let own = problem(&text(r#"{"degrees": 40, "degrees_per_second": -90}"#, rest));
    assert_eq!(
        (
            own.variables[0].unit.as_str(),
            own.variables[1].unit.as_str()
        ),
        ("°", "°/s")
    );
    for derivative in check(&own, &own.start()).expect("runs") {
        assert!(derivative.relative_difference() <= 1e-11, "{derivative:?}");
    }
    let faults = Problem::parse(&text(r#"{"degrees": 40, "angle": 1}"#, ""), "f.json", &[])
        .expect_err("a fault");
    assert!(
        faults
            .to_string()
            .contains("found \"degrees\" beside \"angle\", expected one of them"),
        "{faults}"
    );
}

/// A point between others follows them, also along a beam and from point to point.
#[test]
fn points_between_others_are_their_coordinates() {
    let text = |points: &str| {
        format!(
            r#"{{"version": 1, "name": "beam",
            "bodies": {{"arm": {{"beam": {{"length": 2, "section": {{"rectangle": {{"width": 0.05, "height": 0.05}}}}, "material": {{"young": 7e10, "density": 2700}},
              "modes": {{"bending_y": 2, "bending_z": 0, "torsion": 0}}, "stations": {{"mid": 0.5}}}}, "points": {points}, "place": {{"put": "start"}}}}}},
            "joints": {{"pin": {{"revolute": {{"between": ["arm", "ground"], "at": "arm.p", "axis": [0, 0, 1]}}}}}},
            "simulation": {{"duration": 0.1}},
            "functions": {{"x": {{"final": {{"position": {{"body": "arm", "point": "q", "direction": [0, 1, 0]}}}}}}}}}}"#
        )
    };
    let between = r#"{"p": {"between": ["start", "mid"], "fraction": 0.5}, "q": {"between": ["p", "end"], "fraction": 0.5}}"#;
    assert_eq!(
        evaluated(&text(between)),
        evaluated(&text(r#"{"p": [0.5, 0, 0], "q": [1.25, 0, 0]}"#))
    );
    for (points, expected) in [
        (
            r#"{"p": {"between": ["start", "midd"], "fraction": 0.5}, "q": [1, 0, 0]}"#,
            "found \"midd\", expected the name of a point of the body; did you mean \"mid\"?",
        ),
        (
            r#"{"p": {"between": ["q", "mid"], "fraction": 0.5}, "q": {"between": ["p", "mid"], "fraction": 0.5}}"#,
            "found a circle through \"p\", expected points that do not depend on themselves",
        ),
        (
            r#"{"p": {"between": ["start", "mid"]}, "q": [1, 0, 0]}"#,
            "found no \"fraction\", expected \"fraction\": a number",
        ),
        (
            r#"{"p": {"between": ["start"], "fraction": 1}, "q": [1, 0, 0]}"#,
            "found a list of 1, expected a list of 2 texts",
        ),
    ] {
        let faults = Problem::parse(&text(points), "f.json", &[])
            .expect_err("a fault")
            .to_string();
        assert!(faults.contains(expected), "{points}:\n{faults}");
        assert!(faults.starts_with("f.json:3:"), "{faults}");
    }
}

/// What is no rotation is refused, with its place.
#[test]
fn faults_of_turns_have_their_place() {
    for (turn, expected) in [
        (
            r#"{"quaternion": [0, 0, 0, 0]}"#,
            "found a quaternion of length 0, expected one of length 1 to within 0.001; the order is w, x, y, z",
        ),
        (
            r#"{"quaternion": [1, 1, 0, 0]}"#,
            "found a quaternion of length 1.414",
        ),
        (
            r#"{"quaternion": [1, 0, 0]}"#,
            "found a list of 3, expected a list of 4 numbers",
        ),
        (
            r#"{"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}"#,
            "found a matrix of determinant -1, expected a rotation, whose determinant is 1; a left-handed matrix mirrors",
        ),
        (
            r#"{"matrix": [[1, 0.01, 0], [0, 1, 0], [0, 0, 1]]}"#,
            "found rows that miss those of a rotation by 1.000e-2, expected rows of length 1 at right angles",
        ),
        (
            r#"{"axis": [0, 0, 1]}"#,
            "found a turn with axis, expected \"axis\" with \"angle\" or \"degrees\"",
        ),
        (
            r#"{"axis": [0, 0, 0], "degrees": 3}"#,
            "found the direction [0, 0, 0], expected a direction that is not zero",
        ),
        (
            r#"{"axis": [0, 0, 1], "degrees": 3, "angle": 1}"#,
            "found a turn with axis, angle, degrees",
        ),
        (
            r#"{"axis": [0, 0, 1], "degrees": [3, 2, 1]}"#,
            "found three angles about one axis",
        ),
        (r#"{"x": 3, "z": 20}"#, "found a turn with x, z, expected"),
        (
            r#"{"x": 3, "z": 20}"#,
            "write a turn for each in a list, in the order of the rotations",
        ),
        (
            r#"{"sequence": "zyx", "degrees": 3}"#,
            "found one angle of three",
        ),
        (
            r#"{"sequence": "zzx", "degrees": [3, 1, 2]}"#,
            "found \"zzx\", expected three of x, y and z, the same not twice in a row",
        ),
        (
            r#"{"sequence": "abc", "degrees": [3, 1, 2]}"#,
            "found \"abc\", expected three of x, y and z",
        ),
        (r#"{}"#, "found a turn without keys, expected"),
        (
            r#"[{"x": 3}, {"w": 20}]"#,
            "found the key \"w\", expected a key of the format",
        ),
    ] {
        let faults = Problem::parse(&hung(turn, ""), "f.json", &[])
            .expect_err("a fault")
            .to_string();
        assert!(faults.contains(expected), "{turn}:\n{faults}");
        assert!(faults.starts_with("f.json:6:"), "{faults}");
    }
    let variable = r#", "variables": {"m": {"path": "/bodies/box/place/turn/matrix/0/0"}}"#;
    let faults = Problem::parse(
        &hung(r#"{"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}"#, variable),
        "f.json",
        &[],
    );
    let faults = faults.expect_err("a fault").to_string();
    assert!(
        faults.contains("the entries of a rotation matrix depend on each other; design an angle"),
        "{faults}"
    );
}
