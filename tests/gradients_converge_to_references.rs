//! Gradients of the trebuchet converge with the step size to those of an independent code.

use flexbody::driver::evaluate::Evaluated;
use flexbody::problem::Problem;
use serde_json::{Value, json};

/// A file of the package as JSON.
fn json_file(path: &str) -> Value {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("valid JSON")
}

/// The trebuchet with its seven variables (the sixth is the arm's angle, the last the duration)
/// and one function.
fn problem(function: Value, duration: f64, steps: usize) -> Problem {
    let mut document = json_file("problems/trebuchet_release_time.json");
    document["functions"] = json!({ "f": function });
    document["simulation"] = json!({"duration": duration, "steps": steps});
    let object = document.as_object_mut().expect("an object");
    object.remove("objective");
    object.remove("constraints");
    Problem::parse(&document.to_string(), "trebuchet", &[]).expect("no faults")
}

fn value_and_gradient(function: &Value, duration: f64, steps: usize) -> (f64, Vec<f64>) {
    let problem = problem(function.clone(), duration, steps);
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let (gradients, _) = at.gradients(&problem, &[0]).expect("differentiates");
    (at.function(0).value, gradients[0].clone())
}
#[test]
fn probe() {
    let reference = json_file("tests/data/trebuchet_sensitivities.json");
    let range = json!({"final": {"range": {"body": "stone", "ground": -10}}});
    let speed = json!({"final": {"speed": {"body": "stone"}}});
    let ks = json!({"ks": {"rho": 0.1, "of": {"velocity": {"body": "stone", "direction": [1,0,0]}}}});
    let t = |k: &str| reference["t_star"][k].as_f64().unwrap();
    for (i, (f, t)) in [(speed.clone(), t("max_v2")), (ks, 2.0), (range.clone(), 1.165), (range, t("max_range")), (speed, 2.0)].iter().enumerate() {
        let known = &reference["functions"][i];
        let mut value = known["value"].as_f64().unwrap();
        let mut g: Vec<f64> = serde_json::from_value(known["gradient_complex_step"].clone()).unwrap();
        if i == 0 || i == 4 { value = value.sqrt(); g.iter_mut().for_each(|x| *x /= 2.0 * value); }
        g.insert(0, value);
        let runs: Vec<Vec<f64>> = [500, 1000, 2000, 4000].iter().map(|n| { let (v, mut h) = value_and_gradient(f, *t, *n); h.insert(0, v); h}).collect();
        println!("{i} {}", known["name"]);
        for j in 0..7 {
            let e: Vec<f64> = runs.iter().map(|r| (r[j] - g[j]) / g[j]).collect();
            let x: Vec<f64> = runs.windows(2).map(|r| ((4.0 * r[1][j] - r[0][j]) / 3.0 - g[j]) / g[j]).collect();
            let s = |e: &[f64]| e.iter().map(|e| format!("{e:.2e}")).collect::<Vec<_>>().join(" "); println!("{j} {:.3e} errors {} orders {:.2?} extrapolated {}", g[j], s(&e), e.windows(2).map(|e| (e[0]/e[1]).abs().log2()).collect::<Vec<_>>(), s(&x));
        }
        println!("T {:.3?}", runs.iter().map(|r| r[7]).collect::<Vec<_>>());
    }
}
