//! Functions of the trebuchet and their gradients converge with the step size to those of an
//! independent code.
//!
//! `tests/data/trebuchet_sensitivities.json` has values and gradients in the five masses and the
//! arm's initial angle. They come from minimal coordinates by the complex step, and differences
//! confirm them to 1e-11. At a maximum the derivative in time vanishes, so its gradient is that of
//! the value at its instant t*. Errors are relative, each component to its own size.

use flexbody_driver::evaluate::Evaluated;
use flexbody_problem::Problem;
use serde_json::Value;

/// A file of the package as JSON.
fn json_file(path: &str) -> Value {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("valid JSON")
}

/// The trebuchet with its seven variables (the sixth is the arm's angle, the last the duration)
/// and one function.
fn problem(function: &Value, duration: f64, steps: usize) -> Problem {
    let mut document = json_file("problems/trebuchet_release_time.json");
    document["functions"] = json!({ "f": function });
    document["simulation"] = json!({
        "duration": duration, "steps": steps, "method": {"bdf": {"order": 2}}
    });
    document["variables"]["release time"]["upper"] = json!(3);
    let object = document.as_object_mut().expect("an object");
    object.remove("objective");
    object.remove("constraints");
    Problem::parse(&document.to_string(), "trebuchet", &[]).expect("no faults")
}

/// The value, then the derivatives in the seven variables.
fn value_and_gradient(function: &Value, duration: f64, steps: usize) -> Vec<f64> {
    let problem = problem(function, duration, steps);
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let (gradients, _) = at.gradients(&problem, &[0]).expect("differentiates");
    let value = at.function(0).value;
    std::iter::once(value).chain(gradients[0].clone()).collect()
}

/// Value and gradient of function `number` of the reference; for a speed, from those of its square.
fn reference(number: usize, squared: bool) -> Vec<f64> {
    let file = json_file("tests/data/trebuchet_sensitivities.json");
    let known = &file["functions"][number];
    let mut value = known["value"].as_f64().expect("a number");
    let mut gradient: Vec<f64> =
        serde_json::from_value(known["gradient_complex_step"].clone()).expect("six numbers");
    if squared {
        value = value.sqrt();
        gradient.iter_mut().for_each(|g| *g /= 2.0 * value);
    }
    gradient.insert(0, value);
    gradient
}

/// Instant of the maximum `name` of the reference [s].
fn instant(name: &str) -> f64 {
    let file = json_file("tests/data/trebuchet_sensitivities.json");
    file["t_star"][name].as_f64().expect("a number")
}

struct Claim {
    function: Value,
    duration: f64,
    exact: Vec<f64>,
    /// Steps of the finer of two runs; the other has half as many.
    steps: usize,
    /// Largest error of the finer run.
    tolerance: f64,
    /// Largest distance of the observed order from 2.
    order_within: f64,
}

impl Claim {
    /// Asserts error and order of every component, and that extrapolation to h = 0 (Richardson)
    /// leaves at most a fifth of the error. Returns the derivatives in the duration of both runs.
    fn assert(&self) -> [f64; 2] {
        let [coarse, fine] = [self.steps / 2, self.steps]
            .map(|steps| value_and_gradient(&self.function, self.duration, steps));
        for (i, &exact) in self.exact.iter().enumerate() {
            let error = |x: f64| (x / exact - 1.0).abs();
            let extrapolated = error((4.0 * fine[i] - coarse[i]) / 3.0);
            let (coarse, fine) = (error(coarse[i]), error(fine[i]));
            let order = (coarse / fine).log2();
            let told = format!(
                "component {i} of {}: errors {coarse:.3e}, {fine:.3e}, order {order:.3}, \
                 extrapolated {extrapolated:.3e}",
                self.function
            );
            assert!(fine <= self.tolerance, "{told}");
            assert!((order - 2.0).abs() <= self.order_within, "{told}");
            assert!(extrapolated <= 0.2 * fine, "{told}");
        }
        [coarse[7], fine[7]]
    }
}

fn range() -> Value {
    json!({"final": {"range": {"body": "stone", "ground": -10}}})
}

fn speed() -> Value {
    json!({"final": {"speed": {"body": "stone"}}})
}

/// Steps of 0.29 ms: errors up to 3.2e-4 (arm angle).
#[test]
fn range_at_a_fixed_release() {
    Claim {
        function: range(),
        duration: 1.165,
        exact: reference(2, false),
        steps: 4000,
        tolerance: 3.3e-4,
        order_within: 0.1,
    }
    .assert();
}

/// Steps of 0.29 ms: errors up to 3.7e-3 (arm angle, whose derivative almost vanishes). The
/// derivative in the duration converges to zero with order 2, within 0.1.
#[test]
fn largest_range() {
    let [coarse, fine] = Claim {
        function: range(),
        duration: instant("max_range"),
        exact: reference(3, false),
        steps: 4000,
        tolerance: 3.9e-3,
        order_within: 0.1,
    }
    .assert();
    assert!(fine.abs() <= 0.1, "{fine} m/s");
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() <= 0.1, "{coarse}, {fine}: {order:.3}");
}

/// Steps of 0.31 ms: errors up to 3.5e-4.
#[test]
fn largest_speed_of_the_first_throw() {
    let [coarse, fine] = Claim {
        function: speed(),
        duration: instant("max_v2"),
        exact: reference(0, true),
        steps: 4000,
        tolerance: 3.7e-4,
        order_within: 0.1,
    }
    .assert();
    assert!(fine.abs() <= 0.01, "{fine} m/s²");
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() <= 0.1, "{coarse}, {fine}: {order:.3}");
}

/// Steps of 0.5 ms: errors up to 4.6e-2 (mass of the stone, whose derivative almost vanishes).
#[test]
fn speed_at_the_end_of_the_second_whirl() {
    Claim {
        function: speed(),
        duration: 2.0,
        exact: reference(4, true),
        steps: 4000,
        tolerance: 4.8e-2,
        order_within: 0.1,
    }
    .assert();
}

/// KS of the stone's forward velocity, ρ = 0.1 s/m, over 2 s. The derivatives in the masses of
/// sling and stone reach the asymptotic range late, because their errors change sign at steps of 2
/// ms. Steps of 0.25 ms: errors up to 2.0e-4.
#[test]
fn aggregate_of_the_forward_velocity() {
    let velocity = json!({"velocity": {"body": "stone", "direction": [1, 0, 0]}});
    Claim {
        function: json!({"ks": {"rho": 0.1, "of": velocity}}),
        duration: 2.0,
        exact: reference(1, false),
        steps: 8000,
        tolerance: 2.1e-4,
        order_within: 0.2,
    }
    .assert();
}
