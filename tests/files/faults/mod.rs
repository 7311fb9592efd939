//! Malformed problem files: the exact text that a user reads, with all faults of a file at once.

use crate::reference::documents::children;
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::path::Path;

/// A valid file. Every test changes it in its own way.
const PENDULUM: &str = r#"{
  "version": 1,
  "name": "pendulum",
  "gravity": [0, -9.81, 0],
  "bodies": {
    "rod": {
      "shape": {"box": {"size": [2, 0.1, 0.1]}}, "mass": 3,
      "points": {"pin": [-1, 0, 0], "tip": [1, 0, 0]},
      "place": {"put": "pin", "turn": {"axis": [0, 0, 1], "angle": 0.5}}
    },
    "con_rod": {
      "mass": 2, "inertia": {"xx": 1, "yy": 2, "zz": 2},
      "place": {"at": "rod.tip"}
    }
  },
  "joints": {
    "pin": {"spherical": {"between": ["rod", "ground"], "at": "rod.pin"}},
    "crank": {"revolute": {"between": ["con_rod", "rod"], "at": "rod.tip", "axis": [0, 0, 1]}}
  },
  "simulation": {"duration": 2, "steps": 100},
  "functions": {
    "range": {"ks": {"rho": 0.3, "of": {"range": {"body": "con_rod", "gate": {"body": "rod", "axis": [0, 0, 1], "above": -3, "width": 0.1}}}}},
    "clearance": {"clearance": {"release": "range", "barrier": {"distance": 5, "top": 1}}},
    "swing": {"final": {"rotation": {"body": "rod", "axis": [0, 0, 1]}}}
  },
  "variables": {
    "rod mass": {"path": "/bodies/rod/mass", "lower": 1, "upper": 5},
    "angle": {"path": "/bodies/rod/place/turn/angle", "lower": -1, "upper": 1}
  },
  "objective": {"maximise": "range"},
  "constraints": {"over the wall": {"function": "clearance", "lower": 0}}
}
"#;

/// The faults of a text, as printed.
fn faults(text: &str) -> String {
    match Problem::parse(text, "pendulum.json", &[]) {
        Err(faults) => faults.to_string(),
        Ok(problem) => panic!("{} is sound", problem.name),
    }
}

/// The pendulum with each first text, which occurs once, replaced by the second.
fn spoilt(changes: &[(&str, &str)]) -> String {
    let mut text = PENDULUM.to_owned();
    for (sound, wrong) in changes {
        assert_eq!(text.matches(sound).count(), 1, "{sound}");
        text = text.replace(sound, wrong);
    }
    text
}

/// Asserts the faults of the changed pendulum: those in `tests/data/faults/NAME.txt`. The
/// environment variable UPDATE_GOLDEN rewrites this file.
fn expect(name: &str, changes: &[(&str, &str)]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/faults/{name}.txt"));
    let found = faults(&spoilt(changes)) + "\n";
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &found).expect("the file of the expected text");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, expected, "\n{found}");
}

/// A test for each name: the valid text, and its replacement.
macro_rules! faults {
    ($($name:ident: $($sound:literal => $wrong:literal),+;)+) => {
        $(
            #[test]
            fn $name() {
                expect(stringify!($name), &[$(($sound, $wrong)),+]);
            }
        )+
    };
}

mod beams;
mod couplings;
mod elements;
mod loads;
mod modal;
mod mutations;
mod places;
mod rods;
mod starts;

faults! {
    a_misspelt_key: r#""mass": 3,"# => r#""masss": 3,"#;
    a_key_of_another_kind: r#""steps": 100"# => r#""steps": 100, "colour": "red""#;
    an_unknown_section: r#""objective""# => r#""objectives""#;
    an_unknown_body: r#""between": ["con_rod", "rod"]"# => r#""between": ["conrod", "rod"]"#;
    a_joint_of_a_body_to_itself: r#"["con_rod", "rod"]"# => r#"["rod", "rod"]"#;
    a_joint_of_ground_to_itself: r#"["rod", "ground"]"# => r#"["ground", "ground"]"#;
    an_unknown_point: r#""at": "rod.pin""# => r#""at": "rod.pni""#;
    an_unknown_point_of_a_body_without_points:
        r#""place": {"at": "rod.tip"}"# => r#""place": {"put": "top", "at": "rod.tip"}"#;
    an_unknown_joint: r#"{"revolute":"# => r#"{"revolut":"#;
    two_kinds_of_joint_in_one: r#""at": "rod.pin"}}"# => r#""at": "rod.pin"}, "planar": {}}"#;
    a_negative_mass: r#""mass": 3,"# => r#""mass": -3,"#;
    a_mass_in_quotes: r#""mass": 3,"# => r#""mass": "3 kg","#;
    a_mass_of_null: r#""mass": 3,"# => r#""mass": null,"#;
    a_mass_missing: r#", "mass": 3,"# => ",";
    a_mass_and_a_density: r#""mass": 3,"# => r#""mass": 3, "density": 5,"#;
    a_body_of_nothing: r#""mass": 2, "inertia": {"xx": 1, "yy": 2, "zz": 2},"# => "";
    an_inertia_beside_a_shape:
        r#""mass": 3,"# => r#""mass": 3, "inertia": {"xx": 1, "yy": 1, "zz": 1},"#;
    a_zero_axis_of_a_joint:
        r#""at": "rod.tip", "axis": [0, 0, 1]"# => r#""at": "rod.tip", "axis": [0, 0, 0]"#;
    a_zero_axis_of_a_turn:
        r#"{"axis": [0, 0, 1], "angle": 0.5}"# => r#"{"axis": [0, 0, 0], "angle": 0.5}"#;
    an_axis_of_two_numbers:
        r#""at": "rod.tip", "axis": [0, 0, 1]"# => r#""at": "rod.tip", "axis": [0, 1]"#;
    an_inertia_of_no_solid: r#""xx": 1, "yy": 2, "zz": 2"# => r#""xx": 1, "yy": 2, "zz": 4"#;
    an_inertia_with_a_negative_moment: r#""zz": 2}"# => r#""zz": 2, "xy": 3}"#;
    bodies_placed_in_a_circle:
        r#""put": "pin", "turn""# => r#""put": "pin", "at": "con_rod", "turn""#;
    a_body_placed_by_itself: r#""place": {"at": "rod.tip"}"# => r#""place": {"at": "con_rod"}"#;
    a_body_of_a_forbidden_name:
        r#""con_rod": {"# => r#""con.rod": {"#,
        r#"["con_rod", "rod"]"# => r#"["rod", "ground"]"#,
        r#""range": {"body": "con_rod""# => r#""range": {"body": "rod""#;
    an_impossible_assembly:
        r#""joints": {"# =>
        r#""joints": {"far": {"spherical": {"between": ["con_rod", "ground"], "at": {"a": [0, 0, 0], "b": [9, 0, 0]}}},"#;
    a_body_without_inertia_about_itself:
        r#"{"box": {"size": [2, 0.1, 0.1]}}"# => r#"{"rod": {"length": 2}}"#,
        r#"{"revolute": {"between": ["con_rod", "rod"], "at": "rod.tip", "axis": [0, 0, 1]}}"# =>
        r#"{"spherical": {"between": ["con_rod", "rod"], "at": "rod.tip"}}"#;
    crossed_bounds: r#""lower": 1, "upper": 5"# => r#""lower": 5, "upper": 1"#;
    a_start_outside_its_bounds: r#""lower": 1, "upper": 5"# => r#""lower": 4, "upper": 5"#;
    a_lower_bound_that_lets_a_mass_vanish:
        r#""lower": 1, "upper": 5"# => r#""lower": 0, "upper": 5"#;
    a_mass_without_a_lower_bound: r#""lower": 1, "upper": 5"# => r#""upper": 5"#;
    a_variable_that_is_nowhere: r#""/bodies/rod/mass""# => r#""/bodies/rod/mas""#;
    a_variable_that_is_far_from_anything: r#""/bodies/rod/mass""# => r#""/motors/left/torque""#;
    a_variable_that_is_a_count:
        r#""/bodies/rod/mass", "lower": 1"# => r#""/simulation/steps", "lower": 1"#;
    a_variable_that_is_an_aggregation_parameter:
        r#""/bodies/rod/mass", "lower": 1, "upper": 5"# => r#""/functions/range/ks/rho""#;
    a_variable_that_is_a_gate:
        r#""/bodies/rod/mass", "lower": 1, "upper": 5"# => r#""/functions/range/ks/of/range/gate/width""#;
    a_variable_that_is_a_name: r#""/bodies/rod/mass""# => r#""/name""#;
    a_variable_that_is_a_list: r#""/bodies/rod/mass""# => r#""/gravity""#;
    a_variable_that_is_the_version: r#""/bodies/rod/mass""# => r#""/version""#;
    two_variables_of_one_number:
        r#""/bodies/rod/place/turn/angle", "lower": -1, "upper": 1"# => r#""/bodies/rod/mass", "lower": 1"#;
    numbers_of_one_variable_that_differ:
        r#""path": "/bodies/rod/mass""# => r#""paths": ["/bodies/rod/mass", "/bodies/con_rod/mass"]"#;
    numbers_of_one_variable_in_different_units:
        r#""path": "/bodies/rod/mass""# => r#""paths": ["/bodies/rod/mass", "/simulation/duration"]"#;
    a_variable_without_a_path: r#""path": "/bodies/rod/mass", "# => "";
    a_function_of_an_unknown_body:
        r#""rotation": {"body": "rod""# => r#""rotation": {"body": "wheel""#;
    a_function_of_ground: r#""rotation": {"body": "rod""# => r#""rotation": {"body": "ground""#;
    a_missing_objective_function: r#""maximise": "range""# => r#""maximise": "rnge""#;
    a_missing_constraint_function: r#""function": "clearance""# => r#""function": "height""#;
    a_constraint_without_bounds:
        r#""function": "clearance", "lower": 0"# => r#""function": "clearance""#;
    a_constraint_with_crossed_bounds:
        r#""function": "clearance", "lower": 0"# => r#""function": "clearance", "lower": 0, "upper": -1"#;
    a_clearance_of_no_range: r#""release": "range""# => r#""release": "swing""#;
    a_range_without_gravity: "[0, -9.81, 0]" => "[0, 0, 0]";
    a_throw_that_is_not_horizontal:
        r#"{"body": "con_rod", "gate""# => r#"{"body": "con_rod", "direction": [1, 1, 0], "gate""#;
    a_gate_without_width: r#""width": 0.1"# => r#""width": 0"#;
    a_gate_open_on_both_sides: r#""above": -3"# => r#""above": -3, "below": 1"#;
    an_aggregation_parameter_of_zero: r#""rho": 0.3"# => r#""rho": 0"#;
    no_steps: r#""steps": 100"# => r#""steps": 0"#;
    half_a_step: r#""steps": 100"# => r#""steps": 10.5"#;
    no_time: r#""duration": 2"# => r#""duration": 0"#;
    an_order_that_is_not_offered:
        r#""steps": 100"# => r#""steps": 100, "method": {"bdf": {"order": 7}}"#;
    an_unknown_energy:
        r#"{"rotation": {"body": "rod", "axis": [0, 0, 1]}}"# => r#"{"energy": "kinetik"}"#;
    a_name_that_leaves_its_directory: r#""name": "pendulum""# => r#""name": "../pendulum""#;
    another_version: r#""version": 1"# => r#""version": 2"#;
    no_version: "  \"version\": 1,\n" => "";
    a_key_that_stands_twice: r#""mass": 2,"# => r#""mass": 2, "mass": 3,"#;
    two_bodies_of_one_name:
        r#""con_rod": {"# => r#""rod": {"#,
        r#"["con_rod", "rod"]"# => r#"["rod", "ground"]"#,
        r#""range": {"body": "con_rod""# => r#""range": {"body": "rod""#,
        r#""place": {"at": "rod.tip"}"# => r#""points": {"pin": [0, 0, 0], "tip": [0, 0, 0]}, "place": {"turn": {"axis": [0, 0, 1], "angle": 0}}"#;
    not_a_number: r#""mass": 3,"# => r#""mass": NaN,"#;
    an_infinite_number: r#""mass": 3,"# => r#""mass": -Infinity,"#;
    a_number_beyond_all_others: r#""mass": 3,"# => r#""mass": 1e400,"#;
    a_trailing_comma: r#""angle": 0.5}"# => r#""angle": 0.5,}"#;
    a_missing_comma: r#""mass": 3,"# => r#""mass": 3"#;
    a_comment: r#""mass": 3,"# => r#""mass": 3, // kg"#;
    single_quotes: r#""mass": 3,"# => "'mass': 3,";
    a_key_without_quotes: r#""mass": 3,"# => "mass: 3,";
    a_file_that_ends_early:
        "\"constraints\": {\"over the wall\": {\"function\": \"clearance\", \"lower\": 0}}\n}\n" => r#""constraints": {"#;
    text_after_the_end: "\"lower\": 0}}\n}" => "\"lower\": 0}}\n}\n}";
    several_faults_in_the_order_of_the_file:
        r#""mass": 3,"# => r#""mass": -3,"#,
        r#""at": "rod.pin""# => r#""at": "rod.pni""#,
        r#"["con_rod", "rod"]"# => r#"["conrod", "rod"]"#,
        r#""maximise""# => r#""maximize""#,
        r#""upper": 1}"# => r#""upper": 0}"#,
        r#""function": "clearance""# => r#""function": "clarance""#;
    a_misspelt_key_in_a_long_line: r#""above": -3, "width": 0.1"# => r#""above": -3, "widht": 0.1"#;
}

#[test]
fn an_empty_file() {
    assert_eq!(
        faults(" \n"),
        "pendulum.json\n  found an empty file, expected a JSON object"
    );
}

#[test]
fn a_list_instead_of_a_document() {
    assert_eq!(
        faults("[]"),
        "pendulum.json:1:1\n  1 | []\n    | ^ found a list of 0, \
         expected an object with version, name, bodies, simulation"
    );
}

#[test]
fn deep_nesting() {
    let expected = format!(
        "pendulum.json:1:128\n  1 | …{}…\n    | {}^ found more than 127 brackets inside each \
         other, expected a shallower document",
        "[".repeat(96),
        " ".repeat(33)
    );
    assert_eq!(faults(&"[".repeat(100_000)), expected);
}

#[test]
fn a_directory() {
    let directory = tempfile::tempdir().expect("a directory");
    let found = Problem::load(directory.path(), &[])
        .expect_err("a directory")
        .to_string();
    let place = directory.path().display();
    assert_eq!(
        found,
        format!("{place}\n  found a directory, expected a problem file")
    );
}

#[test]
fn a_missing_file() {
    let found = Problem::load(Path::new("no/such/file.json"), &[])
        .expect_err("no file")
        .to_string();
    assert_eq!(
        found,
        "no/such/file.json\n  found no file, expected a problem file"
    );
}

#[test]
fn a_file_that_is_not_utf8() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("latin.json");
    std::fs::write(&path, b"{\n  \"name\": \"tr\xe9buchet\"\n}").expect("a file");
    let faults = Problem::load(&path, &[]).expect_err("a malformed file");
    let expected = format!(
        "{}:2:14\n  2 | \"name\": \"tr\u{fffd}buchet\"\n    |            \
         ^ found a byte that is not UTF-8, expected a text in UTF-8",
        path.display()
    );
    assert_eq!(faults.to_string(), expected);
    assert_eq!((faults.list[0].line, faults.list[0].column), (2, 14));
}

#[test]
fn a_byte_order_mark_is_no_fault() {
    let text = format!("\u{feff}{PENDULUM}");
    assert!(Problem::parse(&text, "pendulum.json", &[]).is_ok());
}

#[test]
fn fields_of_a_fault() {
    let text = spoilt(&[(r#"["con_rod", "rod"]"#, r#"["conrod", "rod"]"#)]);
    let faults = Problem::parse(&text, "pendulum.json", &[]).expect_err("an unknown body");
    assert_eq!(faults.list.len(), 1);
    let fault = &faults.list[0];
    assert_eq!(fault.path, "/joints/crank/revolute/between/0");
    assert_eq!((fault.line, fault.column), (18, 40));
    assert_eq!(fault.found, "\"conrod\"");
    assert_eq!(fault.expected, "the name of a body");
    assert_eq!(fault.hint.as_deref(), Some("did you mean \"con_rod\"?"));
}

/// Asserts the faults of the valid pendulum with an override.
fn expect_override(change: &str, expected: &str) {
    let change = Override::parse(change).expect("an override");
    let faults = Problem::parse(PENDULUM, "pendulum.json", &[change]).expect_err("a fault");
    assert_eq!(faults.to_string(), expected);
}

#[test]
fn an_override_of_nothing() {
    expect_override(
        "/bodies/rod/mas=3",
        "--set /bodies/rod/mas=3  /bodies/rod/mas\n  found the key \"mas\", \
         expected a key of the format; did you mean \"mass\"?",
    );
    expect_override(
        "/bodies/wheel/mass=3",
        "--set /bodies/wheel/mass=3  /bodies/wheel/mass\n  found nothing at this path, \
         expected the path of a value of the file; keys of /bodies are: rod, con_rod",
    );
}

#[test]
fn an_override_that_does_not_fit() {
    expect_override(
        "/bodies/con_rod/mass=-3",
        "--set /bodies/con_rod/mass=-3  /bodies/con_rod/mass\n  found -3, \
         expected a number of at least 0 [kg]",
    );
}

#[test]
fn an_override_that_leaves_its_bounds() {
    expect_override(
        "/bodies/rod/mass=9",
        r#"pendulum.json:27:67  /variables/rod mass/upper
  27 | "rod mass": {"path": "/bodies/rod/mass", "lower": 1, "upper": 5},
     |                                                               ^ found the upper bound 5, expected at least the start 9 kg, the value of /bodies/rod/mass"#,
    );
}

/// The pointers of all values of a document.
fn pointers(value: &Value, at: &str, list: &mut Vec<String>) {
    for (key, value) in children(value) {
        let pointer = format!("{at}/{}", key.replace('/', "~1"));
        list.push(pointer.clone());
        pointers(value, &pointer, list);
    }
}

#[test]
fn every_value_replaced_by_any_other_is_a_fault_or_a_finite_scene() {
    let document: Value = serde_json::from_str(PENDULUM).expect("JSON");
    let mut list = Vec::new();
    pointers(&document, "", &mut list);
    let (mut sound, mut wrong) = (0, 0);
    let others = [
        "null",
        "true",
        "0",
        "-1",
        "1e9",
        "1e300",
        "x",
        "rod",
        "[]",
        "{}",
        "[0, 0, 0]",
        r#"{"x": 1}"#,
    ];
    for pointer in &list {
        for other in others {
            let change = Override::parse(&format!("{pointer}={other}")).expect("an override");
            match Problem::parse(PENDULUM, "pendulum.json", &[change]) {
                Ok(problem) => {
                    let scene = problem.scene(&problem.start());
                    let finite = scene.parameters().iter().all(|x| x.is_finite());
                    assert!(finite, "{pointer} = {other}");
                    sound += 1;
                }
                Err(faults) => {
                    assert!(!faults.list.is_empty(), "{pointer} = {other}");
                    wrong += 1;
                }
            }
        }
    }
    assert!(sound > 50 && wrong > 500, "{sound} {wrong}");
}

#[test]
fn every_entry_left_out_is_a_fault_or_a_finite_scene() {
    let document: Value = serde_json::from_str(PENDULUM).expect("JSON");
    let mut list = Vec::new();
    pointers(&document, "", &mut list);
    for pointer in &list {
        let (above, key) = pointer.rsplit_once('/').expect("a pointer has a slash");
        let mut document = document.clone();
        match document
            .pointer_mut(above)
            .expect("the entry is in something")
        {
            Value::Object(object) => object.remove(key),
            Value::Array(items) => Some(items.remove(key.parse().expect("an index"))),
            _ => None,
        };
        match Problem::parse(&document.to_string(), "pendulum.json", &[]) {
            Ok(problem) => {
                let scene = problem.scene(&problem.start());
                assert!(
                    scene.parameters().iter().all(|x| x.is_finite()),
                    "{pointer}"
                );
            }
            Err(faults) => assert!(
                faults.list.iter().all(|f| f.line == 1),
                "{pointer}: {faults}"
            ),
        }
    }
}

#[test]
fn every_beginning_of_a_file_is_one_fault() {
    for length in 0..PENDULUM.trim_end().len() {
        let faults = Problem::parse(&PENDULUM[..length], "pendulum.json", &[]).expect_err("a part");
        assert_eq!(faults.list.len(), 1, "{length}: {faults}");
    }
}

/// A misspelt key is reported once: not also as a missing key or part.
#[test]
fn a_misspelt_key_is_told_once() {
    let only = r#"{"version": 1, "name": "only", "simulation": {"duration": 1}, "bodies": {
        "ball": {"shape": {"sphere": {"radius": 1}}, "masss": 1}}}"#;
    let mut files = vec![
        only.to_owned(),
        only.replace("masss", "mass").replace("radius", "radus"),
    ];
    for (sound, wrong) in [
        (r#""joints": {"#, r#""joint": {"#),
        (r#""functions": {"#, r#""function": {"#),
        (r#""simulation": {"#, r#""simulaton": {"#),
        (r#""duration": 2"#, r#""durtion": 2"#),
        (r#"{"spherical": {"between""#, r#"{"spherical": {"betwen""#),
        (r#""top": 1"#, r#""topp": 1"#),
    ] {
        files.push(spoilt(&[(sound, wrong)]));
    }
    for file in files {
        let told = faults(&file);
        assert_eq!(told.matches(" found ").count(), 1, "{told}");
    }
}
