//! Parts and their uses, and defaults: the same scene as one that is written out, exact derivatives, faults with their place.

use super::turned_scenes::turned;
use crate::reference::documents::{extended, faults_say, values};
use flexbody_driver::check;
use flexbody_driver::evaluate::Evaluated;
use flexbody_problem::{Override, Problem};
use nalgebra::{Rotation3, Vector3};
use serde_json::Value;

/// A machine of a chassis on a rail and uses of an arm of two links.
fn machine(uses: &str, rest: &str) -> String {
    format!(
        r#"{{
  "version": 1, "name": "machine",
  "parameters": {{"L": 0.8, "rho": 3}},
  "parts": {{"arm": {{
    "parameters": {{"L": 0.5, "k": 4, "half": "= L/2"}},
    "bodies": {{
      "upper": {{"shape": {{"rod": {{"length": "= L", "radius": 0.05}}}}, "mass": 1.6, "points": {{"a": ["= -half", 0, 0], "b": ["= half", 0, 0]}},
        "place": {{"put": "a", "at": [0.1, "= rho/10", 0], "turn": {{"axis": [0, 0, 1], "angle": 0.3}}}}}},
      "lower": {{"shape": {{"box": {{"size": ["= L", 0.1, 0.1]}}}}, "mass": "= rho*L", "points": {{"a": ["= -half", 0, 0]}},
        "place": {{"put": "a", "at": "upper.b"}}, "velocity": {{"linear": [0.1, 0.2, 0]}}}},
      "weight": {{"shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 0.4}}
    }},
    "joints": {{
      "top": {{"revolute": {{"between": ["upper", "base"], "at": [0.1, "= rho/10", 0], "axis": [0, 0, 1]}}}},
      "middle": {{"revolute": {{"between": ["lower", "upper"], "at": "upper.b", "axis": [0, 0.1, 1]}}}},
      "string": {{"rod": {{"between": ["weight", "ground"], "at": [[0, 0, 0], [0.2, 1, 0]]}}}}
    }},
    "loads": {{
      "pull": {{"spring": {{"between": ["lower", "ground"], "at": {{"a": "a", "b": [0.3, -1, 0.2]}}, "rest_length": 0.2, "stiffness": "= k", "damping": 0.1}}}},
      "push": {{"force": {{"body": "lower", "direction": [0, 1, 0.5], "magnitude": 2}}}},
      "back": {{"torsion_spring": {{"joint": "middle", "stiffness": "= 2*k", "damping": 0.05}}}}
    }}
  }}}},
  "use": {{{uses}}},
  "bodies": {{"chassis": {{"shape": {{"box": {{"size": [1, 0.2, 0.5]}}}}, "mass": 9}}}},
  "joints": {{"rail": {{"prismatic": {{"between": ["chassis", "ground"], "at": [0, 0, 0], "axis": [1, 0, 0]}}}}}},
  "simulation": {{"duration": 0.4, "tolerance": 1e-10}},
  "functions": {{
    "x": {{"final": {{"position": {{"body": "left/lower", "direction": [1, 0.5, 0.2]}}}}}},
    "y": {{"final": {{"position": {{"body": "right/lower", "direction": [0.2, 1, 0.3]}}}}}},
    "energy": {{"integral": {{"energy": "kinetic"}}}},
    "mass": "mass"
  }}{rest}
}}"#
    )
}

/// One arm, written out: its name, length and stiffness, its points and directions in ground axes, and its turns
/// after its own.
struct Arm<'a> {
    name: &'a str,
    base: &'a str,
    numbers: [f64; 2],
    point: &'a dyn Fn([f64; 3]) -> [f64; 3],
    direction: &'a dyn Fn([f64; 3]) -> [f64; 3],
    turns: &'a str,
}

impl Arm<'_> {
    /// Bodies, joints and loads.
    fn written(&self) -> [String; 3] {
        let Self {
            name,
            base,
            numbers: [l, k],
            turns,
            ..
        } = self;
        let half = l / 2.0;
        let point = |own: [f64; 3]| format!("{:?}", (self.point)(own));
        let direction = |own: [f64; 3]| format!("{:?}", (self.direction)(own));
        let hook = point([0.1, 3.0 / 10.0, 0.0]);
        let list = |own: &str| match (own, *turns) {
            ("", "") => String::new(),
            (own, "") => format!(r#", "turn": {own}"#),
            ("", turns) => format!(r#", "turn": [{turns}]"#),
            (own, turns) => format!(r#", "turn": [{own}, {turns}]"#),
        };
        let bodies = format!(
            r#"
      "{name}/upper": {{"shape": {{"rod": {{"length": {l}, "radius": 0.05}}}}, "mass": 1.6, "points": {{"a": [{}, 0, 0], "b": [{half}, 0, 0]}},
        "place": {{"put": "a", "at": {hook}{}}}}},
      "{name}/lower": {{"shape": {{"box": {{"size": [{l}, 0.1, 0.1]}}}}, "mass": {}, "points": {{"a": [{}, 0, 0]}},
        "place": {{"put": "a", "at": "{name}/upper.b"{}}}, "velocity": {{"linear": {}}}}},
      "{name}/weight": {{"shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 0.4, "place": {{"at": {}{}}}}}"#,
            -half,
            list(r#"{"axis": [0, 0, 1], "angle": 0.3}"#),
            3.0 * l,
            -half,
            list(""),
            direction([0.1, 0.2, 0.0]),
            point([0.0; 3]),
            list(""),
        );
        let joints = format!(
            r#"
      "{name}/top": {{"revolute": {{"between": ["{name}/upper", "{base}"], "at": {hook}, "axis": {}}}}},
      "{name}/middle": {{"revolute": {{"between": ["{name}/lower", "{name}/upper"], "at": "{name}/upper.b", "axis": {}}}}},
      "{name}/string": {{"rod": {{"between": ["{name}/weight", "ground"], "at": [{}, {}]}}}}"#,
            direction([0.0, 0.0, 1.0]),
            direction([0.0, 0.1, 1.0]),
            point([0.0; 3]),
            point([0.2, 1.0, 0.0]),
        );
        let loads = format!(
            r#"
      "{name}/pull": {{"spring": {{"between": ["{name}/lower", "ground"], "at": {{"a": "a", "b": {}}}, "rest_length": 0.2, "stiffness": {k}, "damping": 0.1}}}},
      "{name}/push": {{"force": {{"body": "{name}/lower", "direction": {}, "magnitude": 2}}}},
      "{name}/back": {{"torsion_spring": {{"joint": "{name}/middle", "stiffness": {}, "damping": 0.05}}}}"#,
            point([0.3, -1.0, 0.2]),
            direction([0.0, 1.0, 0.5]),
            2.0 * k,
        );
        [bodies, joints, loads]
    }
}

/// The machine with its arms written out.
fn written(arms: &[Arm]) -> String {
    let text = machine("", "");
    let (before, after) = (
        text.find("  \"parts\"").expect("parts"),
        text.find("  \"bodies\": {\"chassis\"").expect("bodies"),
    );
    let mut out = text[..before].to_owned() + &text[after..];
    let all: Vec<[String; 3]> = arms.iter().map(Arm::written).collect();
    let section = |k: usize| {
        all.iter()
            .map(|arm| arm[k].clone())
            .collect::<Vec<_>>()
            .join(",")
    };
    let chassis = r#""mass": 9}"#;
    out = out.replacen(chassis, &format!("{chassis},{}", section(0)), 1);
    let rail = r#""axis": [1, 0, 0]}}"#;
    out = out.replacen(rail, &format!("{rail},{}", section(1)), 1);
    out.replacen(
        "  \"simulation\"",
        &format!("  \"loads\": {{{}}},\n  \"simulation\"", section(2)),
        1,
    )
}

fn problem(text: &str) -> Problem {
    Problem::parse(text, "machine.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

fn evaluated(problem: &Problem) -> (Vec<f64>, Vec<f64>) {
    let at = Evaluated::new(problem, &problem.start()).expect("runs");
    let values = (0..problem.function_names.len()).map(|f| at.function(f).value);
    (at.scene.parameters(), values.collect())
}

const USES: &str = r#"
    "left": {"part": "arm", "connect": {"base": "chassis"}},
    "right": {"part": "arm", "at": [0.4, 0.25, "= L/4"], "parameters": {"L": "= 0.9*L", "k": 5}, "connect": {"base": "chassis"}}"#;

fn plain<'a>(name: &'a str, numbers: [f64; 2], point: &'a dyn Fn([f64; 3]) -> [f64; 3]) -> Arm<'a> {
    Arm {
        name,
        base: "chassis",
        numbers,
        point,
        direction: &|own| own,
        turns: "",
    }
}

/// Parts that are moved are the bodies, joints and loads that stand for them, to the last bit.
#[test]
fn uses_are_what_they_stand_for() {
    let own = problem(&machine(USES, ""));
    let moved = |[x, y, z]: [f64; 3]| [x + 0.4, y + 0.25, z + 0.2];
    let by_hand = problem(&written(&[
        plain("left", [0.5, 4.0], &|own| own),
        plain("right", [0.9 * 0.8, 5.0], &moved),
    ]));
    assert_eq!(evaluated(&own), evaluated(&by_hand));
    // The document keeps its parts.
    assert_eq!(own.document["use"]["left"]["part"], "arm");
    let again = problem(&own.document.to_string());
    assert_eq!(evaluated(&again), evaluated(&own));
    assert_eq!(again.hash, own.hash);
}

/// A part that is turned is turned as a whole, in every form of a turn.
#[test]
fn turned_uses_are_turned_as_a_whole() {
    let (s, c) = 0.7_f64.sin_cos();
    let direction = |[x, y, z]: [f64; 3]| [c * x - s * y, s * x + c * y, z];
    let point = |own: [f64; 3]| {
        let [x, y, z] = direction(own);
        [x + 0.4, y - 0.2, z + 0.1]
    };
    let expected = problem(&written(&[
        plain("left", [0.5, 4.0], &|own| own),
        Arm {
            name: "right",
            base: "ground",
            numbers: [0.5, 4.0],
            point: &point,
            direction: &direction,
            turns: r#"{"axis": [0, 0, 1], "angle": 0.7}"#,
        },
    ]));
    let (scene, values) = evaluated(&expected);
    let degrees = 0.7_f64.to_degrees();
    let half = 0.35_f64;
    for turn in [
        r#"{"axis": [0, 0, 2], "angle": 0.7}"#.to_owned(),
        format!(r#"{{"axis": [0, 0, 2], "degrees": {degrees}}}"#),
        format!(r#"{{"z": {degrees}}}"#),
        r#"[{"axis": [0, 0, 1], "angle": 0.3}, {"axis": [0, 0, 1], "angle": "= 0.4 + 0*L"}]"#
            .to_owned(),
        r#"{"sequence": "zxy", "angles": [0.7, 0, "= 0*L"]}"#.to_owned(),
        format!(
            r#"{{"quaternion": [{}, 0, 0, {}]}}"#,
            half.cos(),
            half.sin()
        ),
        format!(r#"{{"quaternion": ["= cos(0.35)", 0, 0, {}]}}"#, half.sin()),
        format!(
            r#"{{"matrix": [[{c}, {}, 0], [{s}, {c}, 0], [0, 0, 1]]}}"#,
            -s
        ),
    ] {
        let uses = format!(
            r#""left": {{"part": "arm", "connect": {{"base": "chassis"}}}},
            "right": {{"part": "arm", "at": [0.4, -0.2, 0.1], "turn": {turn}, "connect": {{"base": "ground"}}}}"#
        );
        let (own, found) = evaluated(&problem(&machine(&uses, "")));
        assert_eq!(own.len(), scene.len());
        for (own, exact) in own
            .iter()
            .zip(&scene)
            .chain(found.iter().zip(&values).take(3))
        {
            let gap = (own - exact).abs();
            assert!(gap <= 1e-9 * exact.abs().max(1.0), "{turn}: {own} {exact}");
        }
        // The scene itself, to round-off.
        for (own, exact) in own.iter().zip(&scene) {
            assert!(
                (own - exact).abs() <= 1e-14 * exact.abs().max(1.0),
                "{turn}: {own} {exact}"
            );
        }
    }
}

/// Variables of parts, of uses, of places, of turns and of coordinates that are moved: every derivative is exact.
#[test]
fn derivatives_through_parts_are_exact() {
    let uses = r#"
    "left": {"part": "arm", "at": [0, 0, 0.1], "connect": {"base": "chassis"}},
    "right": {"part": "arm", "at": [0.4, "= L/2", 0.2], "turn": [{"axis": [0, 0.1, 1], "angle": 0.7}, {"x": 20}],
              "parameters": {"L": 0.6}, "connect": {"base": "ground"}}"#;
    let paths = [
        "/parameters/rho",
        "/parameters/L",
        "/parts/arm/parameters/L",
        "/parts/arm/parameters/k",
        "/parts/arm/bodies/upper/mass",
        "/parts/arm/bodies/upper/place/at/0",
        "/parts/arm/bodies/upper/place/turn/angle",
        "/parts/arm/joints/middle/revolute/axis/1",
        "/parts/arm/loads/pull/spring/at/b/0",
        "/parts/arm/loads/push/force/direction/2",
        "/use/right/parameters/L",
        "/use/right/at/0",
        "/use/right/turn/0/angle",
        "/use/right/turn/1/x",
        "/use/left/at/2",
    ];
    let variables = paths
        .iter()
        .enumerate()
        .map(|(k, path)| format!(r#""v{k}": {{"path": "{path}", "lower": 1e-3, "upper": 30}}"#));
    let variables = variables.collect::<Vec<_>>().join(", ");
    let own = problem(&machine(uses, &format!(", \"variables\": {{{variables}}}")));
    let x = own.start();
    for derivative in check(&own, &x).expect("runs") {
        let error = derivative.relative_difference();
        assert!(
            error <= 1e-10 || derivative.is_round_off(),
            "{derivative:?}"
        );
    }
    // The complex step sees the same scene: each number moves what it should.
    let value = |x: &[f64]| {
        let at = Evaluated::new(&own, x).expect("runs");
        [0, 1, 2].map(|f| at.function(f).value)
    };
    let all = check(&own, &x).expect("runs");
    for k in 0..x.len() {
        let h = 1e-5 * x[k].abs().max(1.0);
        let at = |by: f64| {
            let mut moved = x.clone();
            moved[k] += by;
            value(&moved)
        };
        let (after, before) = (at(h), at(-h));
        let mut moves = false;
        for f in 0..3 {
            let difference = (after[f] - before[f]) / (2.0 * h);
            let exact = all[f * x.len() + k].complex_step;
            moves |= exact.abs() > 1e-6;
            assert!(
                (difference - exact).abs() <= 1e-5 * exact.abs().max(1.0),
                "{}: {difference} {exact}",
                paths[k]
            );
        }
        assert!(moves, "{} moves nothing", paths[k]);
    }
    let units: Vec<&str> = own.variables.iter().map(|own| own.unit.as_str()).collect();
    assert_eq!(units[4], "kg");
    assert_eq!(units[5], "m");
    assert_eq!(units[7], "1");
    assert_eq!(units[11], "m");
    assert_eq!(units[12], "rad");
    assert_eq!(units[13], "°");
}

/// A mirrored family by a parameter of the side.
#[test]
fn a_side_mirrors_a_part() {
    let text = |parts: &str| {
        format!(
            r#"{{"version": 1, "name": "pair", "gravity": [0, 0, -9.81], {parts},
            "simulation": {{"duration": 0.3}},
            "functions": {{"y": {{"final": {{"position": {{"body": "right/bar", "direction": [0, 1, 0]}}}}}}, "energy": {{"integral": {{"energy": "kinetic"}}}}}}}}"#
        )
    };
    let by_parts = r#""parts": {"side": {"parameters": {"side": 1},
        "bodies": {"bar": {"mass": 2, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2, "xy": "= 0.01*side"},
          "points": {"a": [0, "= -0.5*side", 0]}, "place": {"put": "a", "at": [0, "= 0.2*side", 0], "turn": {"x": "= 30*side"}}}},
        "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.a", "axis": [1, 0, 0]}}}}},
        "use": {"left": {"part": "side", "at": [0.5, 0, 0]}, "right": {"part": "side", "at": [0.5, 0, 0], "parameters": {"side": -1}}}"#;
    let bar = |name: &str, side: f64| {
        format!(
            r#""{name}/bar": {{"mass": 2, "inertia": {{"xx": 0.1, "yy": 0.2, "zz": 0.2, "xy": {}}},
            "points": {{"a": [0, {}, 0]}}, "place": {{"put": "a", "at": [0.5, {}, 0], "turn": {{"x": {}}}}}}}"#,
            0.01 * side,
            -0.5 * side,
            0.2 * side,
            30.0 * side
        )
    };
    let hinge = |name: &str| {
        format!(
            r#""{name}/hinge": {{"revolute": {{"between": ["{name}/bar", "ground"], "at": "{name}/bar.a", "axis": [1, 0, 0]}}}}"#
        )
    };
    let by_hand = format!(
        r#""bodies": {{{}, {}}}, "joints": {{{}, {}}}"#,
        bar("left", 1.0),
        bar("right", -1.0),
        hinge("left"),
        hinge("right")
    );
    assert_eq!(
        evaluated(&problem(&text(by_parts))),
        evaluated(&problem(&text(&by_hand)))
    );
}

/// A part in a file of its own is the same part, and its faults are in that file.
#[test]
fn parts_may_be_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = machine(USES, "");
    let document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut short = document.clone();
    short["parts"]["arm"] = serde_json::json!({"file": "arm.json"});
    let main = folder.path().join("machine.json");
    let arm = folder.path().join("arm.json");
    std::fs::write(&main, short.to_string()).expect("writes");
    let content = serde_json::to_string_pretty(&document["parts"]["arm"]).expect("text");
    std::fs::write(&arm, &content).expect("writes");
    let load = |changes: &[Override]| Problem::load(&main, changes);
    let own = load(&[]).unwrap_or_else(|faults| panic!("{faults}"));
    let inline = problem(&text);
    assert_eq!(evaluated(&own), evaluated(&inline));
    assert_eq!(own.document, inline.document);
    assert_eq!(own.hash, inline.hash);
    // One-off changes reach into it.
    let change = Override::parse("/parts/arm/bodies/upper/mass=2").expect("a change");
    let changed = load(&[change]).unwrap_or_else(|faults| panic!("{faults}"));
    assert_ne!(evaluated(&changed).1, evaluated(&inline).1);
    let told = || load(&[]).expect_err("a fault").to_string();
    std::fs::write(&arm, content.replace("\"mass\": 1.6", "\"mass\": -1.6")).expect("writes");
    let fault = told();
    let line = content
        .lines()
        .position(|line| line.contains("\"mass\": 1.6"))
        .expect("a line")
        + 1;
    assert!(
        fault.starts_with(&format!("{}:{line}:", arm.display())),
        "{fault}"
    );
    assert!(
        fault.contains("found -1.6, expected a number of at least 0 [kg]"),
        "{fault}"
    );
    std::fs::write(&arm, content.replace("upper.b", "upper.c")).expect("writes");
    let fault = told();
    assert!(
        fault.contains(&arm.display().to_string()) && fault.contains("this is in the use \"left\""),
        "{fault}"
    );
    std::fs::write(&arm, "{\"bodies\": {}, \"bodies\": {}}").expect("writes");
    assert!(
        told().contains("the key \"bodies\" a second time"),
        "{}",
        told()
    );
    std::fs::write(&arm, "{\"bodies\": ").expect("writes");
    assert!(told().starts_with(&arm.display().to_string()), "{}", told());
    std::fs::remove_file(&arm).expect("is there");
    let fault = told();
    assert!(
        fault.contains("/parts/arm/file") && fault.contains("no file"),
        "{fault}"
    );
}

/// Keys of all bodies and joints that these do not give.
#[test]
fn defaults_are_keys_that_are_not_given() {
    let text = |defaults: &str, body: &str, joint: &str| {
        format!(
            r#"{{"version": 1, "name": "chain", {defaults}
            "bodies": {{
              "a": {{{body}"points": {{"end": [0.5, 0, 0]}}}},
              "b": {{"shape": {{"sphere": {{"radius": 0.2}}}}, "mass": 3, "place": {{"at": "a.end"}}}},
              "c": {{"beam": {{"length": 1, "section": {{"rectangle": {{"width": 0.1, "height": 0.1}}}}, "material": {{"young": 1e9, "density": 1000}},
                     "modes": {{"bending_y": 1, "bending_z": 0, "torsion": 0}}}}, "place": {{"at": "a.end"}}}}
            }},
            "joints": {{
              "top": {{"revolute": {{"between": ["a", "ground"], "at": [0, 0, 0]{joint}}}}},
              "ball": {{"spherical": {{"between": ["b", "a"], "at": "a.end"}}}},
              "end": {{"revolute": {{"between": ["c", "a"], "at": "a.end", "axis": [0, 0, 2]}}}}
            }},
            "simulation": {{"duration": 0.2}},
            "functions": {{"energy": {{"integral": {{"energy": "kinetic"}}}}}}}}"#
        )
    };
    let defaults = r#""defaults": {"bodies": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "density": 700},
        "joints": {"axis": [0, 0, 1]}},"#;
    let own = problem(&text(defaults, "", ""));
    let body = r#""shape": {"box": {"size": [1, 0.1, 0.1]}}, "density": 700, "#;
    let by_hand = problem(&text("", body, r#", "axis": [0, 0, 1]"#));
    assert_eq!(evaluated(&own), evaluated(&by_hand));
    // A variable of a default moves all that have it.
    let variables = r#""variables": {"density": {"path": "/defaults/bodies/density", "lower": 1}, "tilt": {"path": "/defaults/joints/axis/0"}},"#;
    let own = problem(&text(&format!("{variables}{defaults}"), "", ""));
    assert_eq!(own.variables[0].paths, ["/bodies/a/density"]);
    assert_eq!(own.variables[1].paths, ["/joints/top/revolute/axis/0"]);
    for (from, to, line, expected) in [
        (
            "700}",
            "-700}",
            1,
            "found -700, expected a number above 0 [kg/m³]",
        ),
        (
            "[0, 0, 1]}},",
            "[0, 0, 0]}},",
            2,
            "found the direction [0, 0, 0], expected a direction that is not zero",
        ),
        (
            "\"axis\": [0, 0, 1]}},",
            "\"axes\": [0, 0, 1]}},",
            2,
            "found the key \"axes\"",
        ),
    ] {
        assert_eq!(defaults.matches(from).count(), 1, "{from}");
        let text = text(&defaults.replace(from, to), "", "");
        let faults = Problem::parse(&text, "chain.json", &[])
            .expect_err("a fault")
            .to_string();
        assert!(faults.contains(&format!("chain.json:{line}:")), "{faults}");
        assert!(faults.contains(expected), "{faults}");
        // Once, although several have it.
        assert_eq!(faults.matches(expected).count(), 1, "{faults}");
    }
}

/// A machine of forty bodies is a short file.
#[test]
fn forty_bodies_are_a_short_file() {
    let uses = (0..20).map(|k| format!(r#""{k}": {{"part": "bar", "at": [{k}, 0, 0]}}"#));
    let text = format!(
        r#"{{"version": 1, "name": "many", "parts": {{"bar": {{
          "bodies": {{"a": {{"shape": {{"rod": {{"length": 1, "radius": 0.1}}}}, "mass": 1, "points": {{"p": [0.5, 0, 0]}}}},
                     "b": {{"shape": {{"rod": {{"length": 1, "radius": 0.1}}}}, "mass": 1, "place": {{"put": [-0.5, 0, 0], "at": "a.p"}}}}}},
          "joints": {{"p": {{"spherical": {{"between": ["b", "a"], "at": "a.p"}}}}}}}}}},
        "use": {{{}}}, "simulation": {{"duration": 0.1}}, "functions": {{"m": "mass"}}}}"#,
        uses.collect::<Vec<_>>().join(", ")
    );
    let own = problem(&text);
    assert_eq!(own.unlowered_scene(&own.start()).model.bodies.len(), 40);
    assert_eq!(evaluated(&own).1, [40.0]);
}

/// The text that a user reads: the place in the part, and the use.
#[test]
fn faults_of_parts_have_their_place() {
    let sound = machine(
        USES,
        r#", "variables": {"L": {"path": "/parts/arm/parameters/k", "lower": 1}}"#,
    );
    problem(&sound);
    let line_of = |text: &str, wanted: &str| {
        text.lines()
            .position(|line| line.contains(wanted))
            .expect(wanted)
            + 1
    };
    for (from, to, expected, hint) in [
        (
            r#""left": {"part": "arm""#,
            r#""left": {"part": "am""#,
            "found \"am\", expected the name of a part",
            "did you mean \"arm\"?",
        ),
        (
            r#""k": 5}"#,
            r#""kk": 5}"#,
            "found the parameter \"kk\", expected a parameter of the part",
            "did you mean \"k\"?",
        ),
        (
            r#""k": 5}, "connect": {"base": "chassis"}"#,
            r#""k": 5}, "connect": {"bass": "chassis"}"#,
            "found \"bass\", which the part does not mention",
            "did you mean \"base\"?",
        ),
        (
            r#""k": 5}, "connect": {"base": "chassis"}"#,
            r#""k": 5}, "connect": {"base": "chasis"}"#,
            "found \"chasis\", expected the name of a body",
            "did you mean \"chassis\"?; this is in the use \"right\"",
        ),
        (
            r#""connect": {"base": "chassis"}},"#,
            r#""connect": {"upper": "chassis"}},"#,
            "found \"upper\", which is a body of the part",
            "",
        ),
        (
            r#""stiffness": "= k""#,
            r#""stiffness": "= kk""#,
            "found the name \"kk\"",
            "this is in the use \"left\"",
        ),
        (
            r#""stiffness": "= k""#,
            r#""stiffness": "= k +""#,
            "found the end of the expression",
            "this is in the use",
        ),
        (
            r#"[0.1, "= rho/10", 0], "turn""#,
            r#"[0.1, "= rho/", 0], "turn""#,
            "found the end of the expression",
            "",
        ),
        (
            r#""stiffness": "= k""#,
            r#""stiffness": "= -k""#,
            "found -4, expected a number of at least 0",
            "",
        ),
        (
            r#""mass": 1.6"#,
            r#""mas": 1.6"#,
            "found the key \"mas\"",
            "",
        ),
        (
            r#""at": "upper.b", "axis""#,
            r#""at": "upper.c", "axis""#,
            "found \"left/upper.c\", expected the name of a point of the body; did you mean \"left/upper.a\"?",
            "this is in the use \"left\"",
        ),
        (
            r#""path": "/parts/arm/parameters/k""#,
            r#""path": "/parts/arm/parameters/kk""#,
            "found /parts/arm/parameters/kk, which no use has",
            "did you mean /parts/arm/parameters/k?",
        ),
        (
            r#""path": "/parts/arm/parameters/k""#,
            r#""path": "/parts/arm/parameters/half""#,
            "found /parameters/left~1half, which an expression gives",
            "",
        ),
        (
            r#""half": "= L/2""#,
            r#""half": "= L/2", "2k": 1"#,
            "found the name \"2k\"",
            "",
        ),
        (
            r#""k": 4,"#,
            r#""k": "= 2*half", "x": "= x","#,
            "found a circle through \"left/x\"",
            "this is in the use",
        ),
        (
            r#"    "left": {"part""#,
            r#"    "l.e": {"part""#,
            "found the name \"l.e\"",
            "",
        ),
        (
            r#""bodies": {"chassis""#,
            r#""bodies": {"left/upper": {"shape": "point", "mass": 1}, "chassis""#,
            "found \"left/upper\" of bodies a second time",
            "",
        ),
        (
            r#""at": [0.4, 0.25, "= L/4"]"#,
            r#""at": [0.4, 0.25]"#,
            "found a list of 2",
            "",
        ),
    ] {
        assert_eq!(sound.matches(from).count(), 1, "{from}");
        let text = sound.replace(from, to);
        let found = match Problem::parse(&text, "f.json", &[]) {
            Err(faults) => faults.to_string(),
            Ok(_) => panic!("no fault: {to}"),
        };
        assert!(
            found.contains(expected) && found.contains(hint),
            "{to}:\n{found}"
        );
        assert_eq!(found.matches(expected).count(), 1, "{to}:\n{found}");
        let first = to.split(',').next().unwrap_or(to);
        let line = line_of(&text, first);
        let named = expected.contains("chasis") || expected.contains("second time");
        assert!(
            named || found.starts_with(&format!("f.json:{line}:")),
            "{to} {line}:\n{found}"
        );
    }
}

/// Directions that a load or a joint gives, or has by default, turn with the part. The spatial motion of a rod on a surface, and of
/// what air and a bushing hold, has the same energies wherever the part stands, in gravity that turns with it.
#[test]
fn directions_turn_with_their_part() {
    let (axis, angle) = ([0.3, 0.8, -0.7], 2.3);
    let about = Vector3::from(axis).normalize();
    let contact = |more: Value| {
        let own = json!({
            "between": ["b", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.08, "stiffness": 3000,
            "dissipation": 0.2, "width": 0.001, "friction": {"coefficient": 0.4, "width": 0.05},
            "surface": {"plane": {"normal": [0, 1, 0]}}
        });
        json!({"l": {"contact": extended(own, &more)}})
    };
    let heights = json!({"normal": [0, 1, 0], "direction": [1, 0, 0], "along": [-1, 0, 0.5, 2],
                         "across": [-1, 0, 2], "heights": [[0, 0.1, 0, 0], [0, 0, 0.1, 0.05], [0, 0, 0, 0]]});
    let stiffness = json!({"diagonal": [10, 100, 1000, 1, 2, 3]});
    let free = |axes: Value| {
        let own = json!({"between": ["b", "ground"], "at": [0.1, 0.3, 0]});
        json!({"f": {"free": extended(own, &axes)}})
    };
    let scenes = [
        (contact(json!({"half": [0.1, 0.02, 0.05]})), json!({})),
        (
            contact(json!({"wheel": {"axis": [0.2, 0.3, 1], "radius": 0.15}})),
            json!({}),
        ),
        (
            contact(json!({"surface": {"height_field": heights}})),
            json!({}),
        ),
        (
            json!({"l": {"drag": {"body": "b", "coefficient": 0.1, "normal": [0.6, 0.8, 0], "normal_coefficient": 3, "width": 0.01}}}),
            json!({}),
        ),
        (
            json!({"l": {"bushing": {"joint": "f", "stiffness": stiffness}}}),
            free(json!({})),
        ),
        (
            json!({"l": {"bushing": {"joint": "f", "stiffness": stiffness}}}),
            free(json!({"axis": [1, 0.2, 0.1]})),
        ),
    ];
    for (loads, joints) in scenes {
        let at = |angle: f64| {
            let file = json!({
                "version": 1, "name": "turned", "gravity": turned(&Rotation3::new(about * angle), [1.0, -9.0, 2.0]),
                "simulation": {"duration": 0.3, "tolerance": 1e-10},
                "functions": {"speed": {"final": {"speed": {"body": "u/b"}}}, "energy": {"final": {"energy": "kinetic"}}},
                "parts": {"p": {
                    "bodies": {"b": {
                        "shape": {"box": {"size": [0.2, 0.1, 0.4]}}, "mass": 1,
                        "place": {"at": [0.1, 0.3, 0], "turn": {"y": 70}},
                        "velocity": {"linear": [0.5, 0, 0.2], "angular": [1, 2, 3]}
                    }},
                    "loads": loads, "joints": joints
                }},
                "use": {"u": {"part": "p", "at": [0.3, -0.4, 0.2], "turn": {"axis": axis, "angle": angle}}}
            });
            values(&file)
        };
        for (a, b) in at(0.0).into_iter().zip(at(angle)) {
            assert!((a - b).abs() < 1e-7 * a.abs(), "{a} {b}: {loads}");
        }
    }
    // The box of ground has its axes.
    let boxed = contact(json!({"surface": {"box": {"size": [1, 0.1, 1]}}}));
    let file = json!({
        "version": 1, "name": "turned", "simulation": {"duration": 0.3}, "functions": {"T": "duration"},
        "parts": {"p": {"bodies": {"b": {"shape": {"sphere": {"radius": 0.1}}, "mass": 1}}, "loads": boxed}},
        "use": {"u": {"part": "p", "turn": {"x": 30}}}
    });
    faults_say(&file, &["a box of ground", "a part that is turned"]);
}
