//! Parameters and expressions: the same scene as by numbers, exact derivatives, faults with their place.

use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::integration::Integration;
use flexbody_driver::{Analysed, Simulated, check, simulate};
use flexbody_problem::{Override, Problem};
use serde_json::Value;

/// Two links of a length that carries their ends, masses, places and inertia, and whatever else may follow from it.
fn links(parameters: &str, half: &str, length: &str, start: &str) -> String {
    format!(
        r#"{{
  "version": 1, "name": "links", {parameters}
  "bodies": {{
    "upper": {{"shape": {{"rod": {{"length": {length}, "radius": 0.05}}}}, "mass": 1.6, "points": {{"a": [{half}, 0, 0], "b": ["= -L/2", 0, 0]}},
      "place": {{"put": "a", "turn": {{"axis": [0, 0, 1], "angle": {start}}}}}}},
    "lower": {{"shape": {{"box": {{"size": ["= 1.5*L", 0.1, "= 0.1"]}}}}, "mass": "= rho*L^2", "points": {{"a": ["= -0.75*L", 0, 0]}},
      "place": {{"put": "a", "at": "upper.b"}}}}
  }},
  "joints": {{
    "top": {{"revolute": {{"between": ["upper", "ground"], "at": "upper.a", "axis": [0, 0, 1]}}}},
    "middle": {{"revolute": {{"between": ["lower", "upper"], "at": "upper.b", "axis": [0, 0, 1]}}}}
  }},
  "loads": {{"push": {{"force": {{"body": "lower", "direction": [0, 1, 0], "magnitude": {{"table": {{"times": [0, "= 1/4", 1], "values": [0, "= 3*L", "= sqrt(L)"]}}}}}}}}}},
  "simulation": {{"duration": "= 0.3 + L/10", "tolerance": 1e-10}},
  "functions": {{
    "x": {{"final": {{"position": {{"body": "lower", "direction": [1, 0, 0]}}}}}},
    "energy": {{"integral": {{"energy": "kinetic"}}}},
    "mass": "mass"
  }},
  "variables": {{"length": {{"path": "/parameters/L", "lower": "= 0.2 + 0.1", "upper": 2}}, "rho": {{"path": "/parameters/rho", "lower": 1, "upper": 9}}}}
}}"#
    )
}

fn problem(text: &str) -> Problem {
    Problem::parse(text, "links.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

const PARAMETERS: &str =
    r#""parameters": {"half": "= L/2", "L": 0.8, "rho": 3, "quarter": "= half/2"},"#;

/// The text with L = 0.8 and rho = 3 written as numbers, without variables of parameters.
fn by_numbers() -> String {
    let mut text = links("", "0.4", "0.8", "0.5235987755982988");
    for (expression, number) in [
        ("\"= -L/2\"", "-0.4"),
        ("\"= 1.5*L\"", "1.2000000000000002"),
        ("\"= 0.1\"", "0.1"),
        ("\"= rho*L^2\"", "1.9200000000000004"),
        ("\"= -0.75*L\"", "-0.6000000000000001"),
        ("\"= 1/4\"", "0.25"),
        ("\"= 3*L\"", "2.4000000000000004"),
        ("\"= sqrt(L)\"", "0.8944271909999159"),
        ("\"= 0.3 + L/10\"", "0.38"),
    ] {
        assert_eq!(text.matches(expression).count(), 1, "{expression}");
        text = text.replace(expression, number);
    }
    let variables = text.find(",\n  \"variables\"").expect("variables");
    text.truncate(variables);
    text + "\n}"
}

/// Expressions in any order of the parameters are the numbers that they give, to the last bit.
#[test]
fn expressions_are_their_numbers() {
    let number = problem(&by_numbers());
    let expected = Evaluated::new(&number, &[]).expect("runs");
    let other_order =
        r#""parameters": {"quarter": "=half / 2", "rho": "= 6/2", "half": "= L/2", "L": 0.8},"#;
    for parameters in [PARAMETERS, other_order] {
        let own = problem(
            &links(parameters, "\"= half\"", "\"=L\"", "\"= 30*deg\"").replace(
                r#", "rho": {"path": "/parameters/rho", "lower": 1, "upper": 9}"#,
                "",
            ),
        );
        let found = Evaluated::new(&own, &own.start()).expect("runs");
        let run = |at: &Evaluated| (at.scene.parameters(), at.run.duration);
        assert_eq!(run(&found), run(&expected));
        assert_eq!(own.start(), [0.8]);
    }
}

/// A parameter carries ends, masses, loads, tables and the duration of both links: every derivative is exact.
#[test]
fn derivatives_by_parameters_are_exact() {
    for [half, start] in [
        ["\"= half\"", "\"= 30*deg\""],
        ["\"= 2*quarter\"", "\"= atan2(L, 1 + L)\""],
    ] {
        let own = problem(&links(PARAMETERS, half, "\"= L\"", start));
        let all = check(&own, &own.start()).expect("runs");
        assert_eq!(all.len(), 6);
        for derivative in &all {
            let error = derivative.relative_difference();
            assert!(
                error <= 1e-11 || derivative.is_round_off(),
                "{derivative:?}"
            );
        }
        // Of the whole scene, against a difference.
        let x = own.start();
        let h = 1e-5;
        let at = |by: f64| {
            Evaluated::new(&own, &[x[0] + by, x[1]])
                .expect("runs")
                .function(0)
                .value
        };
        let difference = (at(h) - at(-h)) / (2.0 * h);
        assert!(
            (all[0].complex_step / difference - 1.0).abs() < 1e-5,
            "{difference}"
        );
    }
}

/// A plate whose thickness, width, load and material follow from parameters.
const PLATE: &str = r#"{
  "version": 1, "name": "plate",
  "parameters": {"t": 0.01, "width": "= 40*t + side", "side": 0.6},
  "structures": {"plate": {
    "mesh": {"plate": {"length": "= width", "width": 1, "elements": [3, 3]}},
    "thickness": "= 2*t", "material": "metal",
    "supports": {"wall": {"nodes": ["x0"]}}
  }},
  "materials": {"metal": {"young": "= 7e10*(1 + t)", "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
  "load_cases": {"push": {"p": {"pressure": {"faces": "all", "pressure": "= 1000*side"}}}},
  "functions": {"mass": "mass", "work": {"compliance": {"case": "push"}}},
  "variables": {"t": {"path": "/parameters/t", "lower": 0.001, "upper": 0.1}, "side": {"path": "/parameters/side", "lower": 0.1, "upper": 1}}
}"#;

/// Thickness and material of structures at rest follow parameters too, by the path of thousands of thicknesses.
#[test]
fn structures_follow_parameters() {
    let own = problem(PLATE);
    for derivative in check(&own, &own.start()).expect("solves") {
        let error = derivative.relative_difference();
        assert!(error <= 1e-11, "{derivative:?}");
    }
}

/// The one value of a thickness that varies by band stands for all of them, also as an expression.
#[test]
fn the_value_of_a_varied_thickness_follows_a_parameter() {
    let varied = r#""thickness": {"per": "band", "bands": 3, "value": "= 2*t"}"#;
    assert_eq!(PLATE.matches(r#""thickness": "= 2*t""#).count(), 1);
    let own = problem(&PLATE.replace(r#""thickness": "= 2*t""#, varied));
    let plain = problem(PLATE);
    let gradients = |problem: &Problem| -> Vec<f64> {
        let all = check(problem, &problem.start()).expect("solves");
        all.iter()
            .map(|derivative| {
                let error = derivative.relative_difference();
                assert!(error <= 1e-11, "{derivative:?}");
                derivative.adjoint
            })
            .collect()
    };
    for (own, plain) in gradients(&own).iter().zip(gradients(&plain)) {
        assert!(
            (own / plain - 1.0).abs() < 1e-12 && plain != 0.0,
            "{own} {plain}"
        );
    }
}

/// A mesh that a parameter turns inside out is a failed design, as one by a variable of its own.
#[test]
fn a_mesh_that_a_parameter_spoils_is_a_failed_design() {
    let panel = r#"{"curved_panel": {"radius": 1, "length": 1, "angles": ["= open", 1.5], "elements": [3, 3]}}"#;
    let mesh = r#"{"plate": {"length": "= width", "width": 1, "elements": [3, 3]}}"#;
    assert_eq!(PLATE.matches(mesh).count(), 1);
    let text = PLATE
        .replace(mesh, panel)
        .replace(r#""side": 0.6}"#, r#""side": 0.6, "open": "= side + 0.1"}"#);
    let own = problem(&text.replace(r#""upper": 1}}"#, r#""upper": 2}}"#));
    assert!(Simulated::of(&own, &[0.01, 0.6]).is_ok());
    let failure = Simulated::of(&own, &[0.01, 1.4]).err().expect("fails");
    assert!(failure.to_string().contains("mesh"), "{failure}");
}

/// A variable of a parameter has the unit of the number that is proportional to it.
#[test]
fn a_parameter_has_the_unit_of_its_numbers() {
    let own = problem(&links(PARAMETERS, "\"= half\"", "\"= L\"", "0"));
    assert_eq!(own.variables[0].unit, "m");
    // Also of one that is zero.
    let text = links(PARAMETERS, "\"= half\"", "\"= L\"", "\"= turn\"");
    let text = text
        .replace(r#""rho": 3,"#, r#""rho": 3, "turn": 0,"#)
        .replace(
            r#""rho": {"path": "/parameters/rho", "lower": 1, "upper": 9}"#,
            r#""turn": {"path": "/parameters/turn", "lower": -1, "upper": 1}"#,
        );
    assert_eq!(problem(&text).variables[1].unit, "rad");
    let own = problem(PLATE);
    let units: Vec<&str> = own.variables.iter().map(|own| own.unit.as_str()).collect();
    assert_eq!(units, ["m", "m"]);
    // Terms of a sum have its unit; numbers without one have none.
    for (point, unit) in [
        ("= rho/9 - half", "m"),
        ("= 0*rho + half", ""),
        ("= rho*half", ""),
        ("= rho - half + 0.1", ""),
    ] {
        let own = problem(&links(PARAMETERS, &format!("\"{point}\""), "\"= L\"", "0"));
        assert_eq!(own.variables[1].unit, unit, "{point}");
    }
}

/// A design at which an expression is not defined fails by name, and others do not.
#[test]
fn an_undefined_expression_is_a_failed_design() {
    let own = problem(&links(
        PARAMETERS,
        "\"= half\"",
        "\"= L\"",
        "\"= sqrt(L - 0.3)\"",
    ));
    assert!(simulate(&own, &[0.5, 3.0]).is_ok());
    let failure = simulate(&own, &[0.2, 3.0])
        .err()
        .expect("fails")
        .to_string();
    assert_eq!(
        failure,
        "the expression at /bodies/upper/place/turn/angle has the value NaN"
    );
}

/// One-off changes replace numbers by expressions, and parameters by numbers.
#[test]
fn changes_may_be_expressions() {
    let text = links(PARAMETERS, "\"= half\"", "\"= L\"", "0");
    let change = |change: &str| {
        let change = Override::parse(change).expect("a change");
        Problem::parse(&text, "links.json", &[change]).unwrap_or_else(|faults| panic!("{faults}"))
    };
    assert_eq!(change("/parameters/L=1.25").start()[0], 1.25);
    let own = change("/bodies/lower/mass== 2*rho");
    let found = Evaluated::new(&own, &own.start()).expect("runs");
    let value = found.function(2).value;
    assert!((value - (1.6 + 6.0)).abs() < 1e-12, "{value}");
    // The document keeps its expressions, so the record of a design can be read again.
    let again = Problem::parse(&own.document.to_string(), "links.json", &[]).expect("sound");
    assert_eq!(again.start(), own.start());
}

/// The text that a user reads: what, where in the expression, and a hint.
#[test]
fn faults_of_expressions_have_their_place() {
    let sound = |half: &str| links(PARAMETERS, half, "\"= L\"", "0");
    let told = |text: &str| match Problem::parse(text, "f.json", &[]) {
        Err(faults) => faults.to_string(),
        Ok(_) => panic!("no fault: {text}"),
    };
    for (half, expected) in [
        (
            "\"= L/\"",
            "found the end of the expression, expected a number, a name or '('",
        ),
        (
            "\"= (L + 1\"",
            "found the end of the expression, expected an operator or ')'",
        ),
        (
            "\"= LL/2\"",
            "found the name \"LL\", expected a name of \"parameters\", pi, deg or a function; did you mean \"L\"?",
        ),
        (
            "\"= sine(L)\"",
            "found the function \"sine\", expected sin, cos, tan, asin, acos, atan, atan2, sqrt, exp or log",
        ),
        ("\"= L L\"", "found 'L', expected an operator or the end"),
        (
            "\"= 1/(L - 0.8)\"",
            "found an expression whose value is inf, expected a finite number",
        ),
        ("\"L/2\"", "found \"L/2\", expected a number [m]"),
        ("[\"= L\"]", "found a list of 1, expected a number [m]"),
    ] {
        let found = told(&sound(half));
        assert!(found.contains(expected), "{half}:\n{found}");
        assert!(found.starts_with("f.json:4:"), "{found}");
    }
    // The marks stand under the place in the expression.
    let found = told(&sound("\"= L ? 2\""));
    let lines: Vec<&str> = found.lines().collect();
    let mark = lines[2].chars().position(|c| c == '^').expect("marks");
    assert_eq!(lines[1].chars().nth(mark), Some('?'), "{found}");
    for (from, to, expected) in [
        (
            r#""L": 0.8"#,
            r#""L": "= 4*quarter""#,
            "found a circle through",
        ),
        (
            r#""rho": 3"#,
            r#""2rho": 3"#,
            "found the name \"2rho\", expected letters, digits and underscores, and no digit first",
        ),
        (
            r#""rho": 3"#,
            r#""pi": 3"#,
            "found the name \"pi\", expected a name that has no meaning yet",
        ),
        (
            r#""lower": "= 0.2 + 0.1""#,
            r#""lower": -1"#,
            "found the bound -1, at which /bodies/upper/shape/rod/length is -1",
        ),
        (
            r#""path": "/parameters/L""#,
            r#""path": "/bodies/lower/mass""#,
            "found /bodies/lower/mass, which an expression gives",
        ),
        (
            r#""times": [0, "= 1/4", 1]"#,
            r#""times": [0, "= L/4", 1]"#,
            "found an expression that changes with a design variable, expected one of fixed parameters",
        ),
        (
            r#""tolerance": 1e-10"#,
            r#""steps": "= 100*rho""#,
            "found an expression that changes with a design variable",
        ),
        (
            r#""tolerance": 1e-10"#,
            r#""steps": "= 100/3""#,
            "found 33.333333333333336, expected a whole number",
        ),
        (PARAMETERS, "", "the file has no \"parameters\""),
    ] {
        let text = sound("\"= half\"");
        assert_eq!(text.matches(from).count(), 1, "{from}");
        let found = told(&text.replace(from, to));
        assert!(found.contains(expected), "{to}:\n{found}");
    }
}

/// Texts that begin like expressions are texts where texts are wanted.
#[test]
fn texts_are_no_expressions() {
    let text = links(PARAMETERS, "\"= half\"", "\"= L\"", "0");
    let text = text.replacen(
        r#""name": "links","#,
        r#""name": "links", "description": "= a remark","#,
        1,
    );
    assert_eq!(problem(&text).name, "links");
}

/// The document with every number of a variable given by a parameter, and the variable of the parameter.
fn by_parameters(document: &Value) -> Value {
    let mut other = document.clone();
    let variables = document["variables"].as_object().expect("variables");
    other["parameters"] = serde_json::json!({});
    for (k, (name, variable)) in variables.iter().enumerate() {
        let one = variable["path"].as_str().into_iter();
        let several = variable["paths"].as_array().into_iter().flatten();
        let paths: Vec<&str> = one.chain(several.filter_map(Value::as_str)).collect();
        let parameter = format!("p{k}");
        other["parameters"][&parameter] = document.pointer(paths[0]).expect("a number").clone();
        for path in paths {
            *other.pointer_mut(path).expect("a number") =
                serde_json::json!(format!("= {parameter}"));
        }
        let own = &mut other["variables"][name];
        own["path"] = serde_json::json!(format!("/parameters/{parameter}"));
        own.as_object_mut().expect("an object").remove("paths");
    }
    other
}

/// Shipped problems whose variables move parameters instead of numbers: the same values, gradients and units.
#[test]
fn shipped_problems_are_the_same_by_parameters() {
    for name in [
        "trebuchet",
        "trebuchet_release_angle",
        "triple_pendulum",
        "plate_patches",
        "scordelis_lo",
        "extreme/damped_oscillator",
        "extreme/spring_pendulum",
        "extreme/turning_bar",
        "extreme/flexible_pendulum",
        "extreme/door",
        "extreme/open_joint",
    ] {
        let path = format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).expect("a problem");
        let document: Value = serde_json::from_str(&text).expect("JSON");
        let own = problem(&by_parameters(&document).to_string());
        let plain = problem(&text);
        let found = |problem: &Problem| {
            let which: Vec<usize> = (0..problem.function_names.len()).collect();
            let mut integration = Integration::of(problem, Some(&which), true);
            let x = problem.start();
            let at = Analysed::with(&mut integration, problem, &x, &which)
                .expect("runs")
                .0;
            let gradients = at.gradients(problem, &which).expect("differentiates").0;
            (
                at.finite_values(problem, &which).expect("finite"),
                gradients,
            )
        };
        let ((values, gradients), (expected, exact)) = (found(&own), found(&plain));
        assert_eq!(values, expected, "{name}");
        // The one variable of a varied thickness stands for several when it is no parameter.
        let same = own.variables.len() == plain.variables.len();
        for (row, exact) in gradients.iter().zip(&exact) {
            let sum = |row: &[f64]| -> f64 { row.iter().sum() };
            let pairs: Vec<(f64, f64)> = match same {
                true => row.iter().copied().zip(exact.iter().copied()).collect(),
                false => vec![(sum(row), sum(exact))],
            };
            for (own, exact) in pairs {
                assert!(
                    (own - exact).abs() <= 1e-11 * exact.abs(),
                    "{name}: {own} {exact}"
                );
            }
        }
        if same {
            let units = |problem: &Problem| -> Vec<String> {
                problem
                    .variables
                    .iter()
                    .map(|own| own.unit.clone())
                    .collect()
            };
            assert_eq!(units(&own), units(&plain), "{name}");
        }
    }
}
