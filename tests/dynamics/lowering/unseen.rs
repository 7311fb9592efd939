//! Parts on which no requested function depends are not simulated.

use super::*;
use flexbody_driver::integration::Integration;
use flexbody_driver::{self as driver, KnownEvaluations};
use serde_json::Map;
use std::ops::ControlFlow;

/// The names that a section of a document may refer to.
fn names(document: &Value, section: &str) -> Vec<String> {
    let of = |key: &str| document[key].as_object().into_iter().flat_map(Map::keys);
    let joints = of("joints").filter(|_| section == "loads");
    of("bodies").chain(joints).cloned().collect()
}

/// A part of a document with every name and every point of a body marked.
fn marked(part: &Value, names: &[String]) -> Value {
    let own = |text: &str| names.iter().any(|name| name == text);
    match part {
        Value::String(text) => match text.split_once('.') {
            Some((body, point)) if own(body) => json!(format!("other {body}.{point}")),
            _ if own(text) => json!(format!("other {text}")),
            _ => part.clone(),
        },
        Value::Array(all) => all.iter().map(|one| marked(one, names)).collect(),
        Value::Object(all) => {
            let key = |key: &String| match own(key) {
                true => format!("other {key}"),
                false => key.clone(),
            };
            let all = all.iter().map(|(k, v)| (key(k), marked(v, names)));
            Value::Object(all.collect())
        }
        _ => part.clone(),
    }
}

/// A problem with a second copy of its machine: after the first one, before it, or between its
/// bodies and joints.
fn twice(file: &str, order: &str, more: impl FnOnce(&mut Value)) -> Problem {
    changed(file, |document| {
        for section in ["bodies", "joints", "loads"] {
            let Some(one) = document[section].as_object().cloned() else {
                continue;
            };
            let names = names(document, section);
            let other = one
                .iter()
                .map(|(k, v)| (format!("other {k}"), marked(v, &names)));
            let other: Map<String, Value> = other.collect();
            let all: Vec<(String, Value)> = match order {
                "behind" => one.into_iter().chain(other).collect(),
                "before" => other.into_iter().chain(one).collect(),
                _ => one
                    .into_iter()
                    .zip(other)
                    .flat_map(|(a, b)| [b, a])
                    .collect(),
            };
            document[section] = Value::Object(all.into_iter().collect());
        }
        more(document);
    })
}

/// A design simulated as in an optimisation, and the requested functions.
fn evaluated(problem: &Problem) -> (Evaluated, Vec<usize>) {
    let x = problem.start();
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::new(problem, &problem.scene(&x), Some(&which), true);
    let (at, _) = Evaluated::with(&mut integration, problem, &x).expect("runs");
    (at, which)
}

/// If the functions depend on one of two machines, the work is that of one, to the last step, and
/// functions and gradients agree to round-off.
#[test]
fn a_machine_that_is_not_seen_costs_nothing() {
    let files = [
        "problems/trebuchet.json",
        "problems/trebuchet_release_angle.json",
        "problems/extreme/spring_pendulum.json",
    ];
    for file in files {
        let one = load(file, &[]);
        let (alone, which) = evaluated(&one);
        let (gradients, of_gradients) = alone.gradients(&one, &which).expect("regular");
        for order in ["behind", "before", "between"] {
            let both = twice(file, order, |_| ());
            let focused = both.focused(&which).expect("a machine that is not seen");
            let (at, _) = evaluated(&focused);
            assert_eq!(at.run.counts, alone.run.counts, "{file} {order}");
            let bodies = at.scene.model.bodies.iter().map(|body| &body.name);
            assert!(bodies.eq(alone.scene.model.bodies.iter().map(|body| &body.name)));
            let (found, work) = at.gradients(&focused, &which).expect("regular");
            assert_eq!(work, of_gradients);
            for &f in &which {
                let values = [at.function(f).value, alone.function(f).value];
                assert!(relative(&values[..1], &values[1..]) < 1e-12, "{values:?}");
                assert!(relative(&found[f], &gradients[f]) < 1e-12, "{file} {order}");
            }
            // Figures show both.
            let (written, motion) = at.written(&focused);
            assert_eq!(
                written.model.bodies.len(),
                2 * alone.scene.model.bodies.len()
            );
            let shown = motion.numbering.bodies();
            assert_eq!(shown, written.model.bodies.len());
            let (whole, _) = evaluated(&both);
            let (_, whole) = whole.written(&both);
            let off = relative(motion.q(motion.last()), whole.q(whole.last()));
            assert!(off < 1e-6, "{off:e}");
        }
    }
}

/// With equal steps the functions equal those of the whole scene to round-off.
#[test]
fn equal_steps_give_the_functions_of_the_whole_scene() {
    let both = twice("problems/trebuchet.json", "between", |document| {
        document["simulation"] = json!({"duration": 1, "steps": 200});
    });
    let focused = both.for_optimisation().expect("a machine that is not seen");
    let ((a, which), (b, _)) = (evaluated(&focused), evaluated(&both));
    let (of_a, _) = a.gradients(&focused, &which).expect("regular");
    let (of_b, _) = b.gradients(&both, &which).expect("regular");
    for f in which {
        let values = [a.function(f).value, b.function(f).value];
        assert!(relative(&values[..1], &values[1..]) < 1e-12, "{values:?}");
        assert!(relative(&of_a[f], &of_b[f]) < 1e-11);
    }
}

/// Parts that a function, an event, a spring or a joint connects are simulated.
#[test]
fn what_is_reached_is_kept() {
    let file = "problems/trebuchet.json";
    let stone = json!({"position": {"body": "other stone", "direction": [1, 0, 0]}});
    let reaches: [(&str, Value); 4] = [
        ("/functions/other", json!({"final": stone})),
        ("/functions/all", json!({"final": {"energy": "kinetic"}})),
        ("/simulation/until", json!({"measure": stone, "reaches": 5})),
        (
            "/loads/thread",
            json!({"spring": {"between": ["arm", "other arm"],
                "at": {"a": "left", "b": "right"}, "stiffness": 1, "rest_length": 1}}),
        ),
    ];
    for (path, what) in reaches {
        let both = twice(file, "behind", |document| {
            let (section, name) = path[1..].split_once('/').expect("a section and a name");
            document[section][name] = what;
        });
        let all: Vec<usize> = (0..both.function_names.len()).collect();
        assert!(both.focused(&all).is_none(), "{path}");
    }
    // Without reductions no part is left out.
    let both = twice(file, "behind", |_| ());
    assert!(unlowered(&both).focused(&[0]).is_none());
}

/// A function that is neither objective nor constraint costs nothing in an optimisation. An
/// optimisation of one of two machines ends where that of one alone does.
#[test]
fn an_optimisation_sees_one_of_two_machines() {
    let limits = |document: &mut Value| document["optimiser"] = json!({"iterations": 3});
    let both = twice("problems/trebuchet.json", "between", |document| {
        limits(document);
        document["functions"]["of the other"] =
            json!({"integral": {"speed": {"body": "other stone"}}});
    });
    let one = changed("problems/trebuchet.json", limits);
    let focused = both.for_optimisation().expect("a machine that is not seen");
    assert_eq!(focused.function_names, one.function_names);
    let [a, b] = [&focused, &one].map(|problem| {
        let log = KnownEvaluations::new(Vec::new(), |_| ());
        let mut progress = |_: &flexbody_report::History| ControlFlow::Continue(());
        driver::optimise(problem, "test.json", None, log, &mut progress).expect("an objective")
    });
    assert_eq!(a.optimum.counts, b.optimum.counts);
    let design = |of: &driver::Optimisation| -> Vec<f64> {
        of.optimum.design.values().map(|own| own.value).collect()
    };
    assert!(relative(&design(&a), &design(&b)) < 1e-9);
    let values = [&a, &b].map(|of| of.optimum.objective.value);
    assert!(relative(&values[..1], &values[1..]) < 1e-9);
    let figures = flexbody_figures::of_optimisation(&focused, &a);
    assert!(figures.iter().any(|(name, _)| *name == "motion.svg"));

    let told = driver::explain(&both);
    assert_eq!((told.bodies, told.joints), (10, 10));
    assert!(
        told.left_out[0].starts_with("bodies \"other counterweight\", ")
            && told.left_out[0].contains("neither the objective nor a constraint"),
        "{:?}",
        told.left_out
    );
    assert_eq!((told.written.velocities, told.lowered.velocities), (60, 15));
    let of = |name: &str| told.functions.iter().find(|own| own.name == name);
    assert!(of("of the other").is_some_and(|own| own.variables.is_none()));
    assert!(of("range").is_some_and(|own| own.variables.is_some()));
}
