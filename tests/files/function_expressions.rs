//! Functions that expressions of others give: values, derivatives, units, work and faults, in motion and at rest.

use crate::reference::documents::optimised;
use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::integration::Integration;
use flexbody_driver::{Analysed, Simulated, check};
use flexbody_figures as figures;
use flexbody_problem::{Override, Problem};

/// A pendulum of two links whose length and density are parameters.
fn links(simulation: &str, functions: &str, study: &str) -> String {
    format!(
        r#"{{
  "version": 1, "name": "links", "parameters": {{"L": 0.8, "rho": 3, "half": "= L/2", "offset": 0.25}},
  "bodies": {{
    "upper": {{"shape": {{"rod": {{"length": "= L", "radius": 0.05}}}}, "mass": 1.6, "points": {{"a": ["= half", 0, 0], "b": ["= -half", 0, 0]}},
      "place": {{"put": "a", "turn": {{"axis": [0, 0, 1], "angle": 0.5}}}}}},
    "lower": {{"shape": {{"box": {{"size": [1.2, 0.1, 0.1]}}}}, "mass": "= rho*L^2", "points": {{"a": [-0.6, 0, 0]}},
      "place": {{"put": "a", "at": "upper.b"}}}}
  }},
  "joints": {{
    "top": {{"revolute": {{"between": ["upper", "ground"], "at": "upper.a", "axis": [0, 0, 1]}}}},
    "middle": {{"revolute": {{"between": ["lower", "upper"], "at": "upper.b", "axis": [0, 0, 1]}}}}
  }},
  "simulation": {{"duration": 0.4, {simulation}}},
  "functions": {{
    {functions}
    "the reach": {{"final": {{"position": {{"body": "lower", "direction": [1, 0, 0]}}}}}},
    "work": {{"integral": {{"energy": "kinetic"}}}},
    "mass": "mass",
    "time": "duration",
    "peak": {{"ks": {{"rho": 20, "of": {{"velocity": {{"body": "lower", "direction": [0, -1, 0]}}}}}}}}
  }},
  "variables": {{"length": {{"path": "/parameters/L", "lower": 0.3, "upper": 2}}, "rho": {{"path": "/parameters/rho", "lower": 1, "upper": 9}}}}{study}
}}"#
    )
}

const EXPRESSIONS: &str = r#"
    "cost": {"expression": "mass*2.5 + power/3"},
    "power": {"expression": "work / time"},
    "twice": {"expression": "2*mass"},
    "shape": {"expression": "= ('the reach' - half)^2 / (rho*mass) + offset"},
    "far": {"expression": "atan2(`the reach`, rho*mass) + log(mass/1)"},
    "mix": {"expression": "sqrt(mass)^3 * exp(-time/2) / (1 + work^2) * peak^1.5"},"#;

fn problem(text: &str) -> Problem {
    Problem::parse(text, "links.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

fn index(problem: &Problem, name: &str) -> usize {
    let found = problem.functions().iter().position(|own| own == name);
    found.unwrap_or_else(|| panic!("{name}"))
}

/// By explicit and implicit methods, expressions are what they say, and every derivative is that of the complex step.
#[test]
fn expressions_of_a_motion_are_exact() {
    for simulation in [
        r#""tolerance": 1e-10"#,
        r#""method": {"radau": {"stages": 3}}, "tolerance": 1e-8"#,
        r#""method": {"bdf": {"order": 2}}, "steps": 200"#,
        r#""method": {"generalised_alpha": {"radius": 0.8}}, "steps": 200"#,
    ] {
        let own = problem(&links(simulation, EXPRESSIONS, ""));
        // In an order in which each is after those that it names; the others are as in the file.
        let names = ["the reach", "work", "mass", "time", "peak"];
        assert_eq!(own.functions()[..5], names);
        assert_eq!(own.functions().len(), 11);
        let x = own.start();
        let at = Evaluated::new(&own, &x).expect("runs");
        let value = |name: &str| at.value(index(&own, name));
        let [reach, work, mass, time, peak] = names.map(value);
        let [length, rho] = [x[0], x[1]];
        for (name, expected) in [
            ("power", work / time),
            ("cost", mass * 2.5 + work / time / 3.0),
            ("twice", 2.0 * mass),
            (
                "shape",
                (reach - length / 2.0).powi(2) / (rho * mass) + 0.25,
            ),
            ("far", reach.atan2(rho * mass) + mass.ln()),
            (
                "mix",
                mass.powf(1.5) * (-time / 2.0).exp() / (1.0 + work * work) * peak.powf(1.5),
            ),
        ] {
            let error = (value(name) - expected).abs();
            assert!(error <= 1e-14 * expected.abs(), "{name}: {error:e}");
        }
        let all = check(&own, &x).expect("runs");
        assert_eq!(all.len(), 22);
        for derivative in &all {
            let error = derivative.relative_difference();
            assert!(
                error <= 1e-11 || derivative.is_round_off(),
                "{} {derivative:?}",
                own.functions()[derivative.function]
            );
        }
        // The chain rule by hand, to round-off.
        let which: Vec<usize> = (0..own.functions().len()).collect();
        let (gradients, _) = at.gradients(&own, &which).expect("a gradient");
        let of = |name: &str, i: usize| gradients[index(&own, name)][i];
        for i in 0..2 {
            let moved = [reach - length / 2.0, f64::from(u8::from(i == 0)) / 2.0];
            let by_shape = 2.0 * moved[0] * (of("the reach", i) - moved[1]) / (rho * mass)
                - moved[0].powi(2) / (rho * mass) * of("mass", i) / mass
                - f64::from(u8::from(i == 1)) * moved[0].powi(2) / (rho * rho * mass);
            for (name, expected) in [
                ("twice", 2.0 * of("mass", i)),
                (
                    "cost",
                    2.5 * of("mass", i)
                        + (of("work", i) - work / time * of("time", i)) / (3.0 * time),
                ),
                ("shape", by_shape),
            ] {
                let error = (of(name, i) - expected).abs();
                assert!(
                    error <= 1e-12 * expected.abs().max(1e-3),
                    "{name}: {error:e}"
                );
            }
        }
    }
}

/// An expression costs the simulation and the backward march of the functions that it names, and nothing of the others.
#[test]
fn an_expression_costs_what_its_functions_cost() {
    let own = problem(&links(r#""tolerance": 1e-9"#, EXPRESSIONS, ""));
    let at = Evaluated::new(&own, &own.start()).expect("runs");
    let [work, time, mass] = ["work", "time", "mass"].map(|name| index(&own, name));
    let cost = index(&own, "cost");
    let counted = |which: &[usize]| at.gradients(&own, which).expect("a gradient").1;
    assert_eq!(counted(&[cost]), counted(&[work, time, mass]));
    assert_eq!(counted(&[cost, work, mass]), counted(&[work, time, mass]));
    // What an optimisation evaluates: functions that nothing needs are dropped, and the bodies with them.
    let study = r#", "objective": {"minimise": "cost"}, "constraints": {"c": {"function": "twice", "lower": 2}}"#;
    let own = problem(&links(r#""tolerance": 1e-9"#, EXPRESSIONS, study));
    let focused = own.for_optimisation().expect("something is dropped");
    let kept = ["work", "mass", "time", "power", "twice", "cost"];
    let mut names = focused.functions().to_vec();
    names.sort();
    let mut expected = kept.map(str::to_owned);
    expected.sort();
    assert_eq!(names, expected);
    let whole = Evaluated::new(&own, &own.start()).expect("runs");
    let part = Evaluated::new(&focused, &focused.start()).expect("runs");
    let objective = focused.objective.expect("an objective").function;
    assert_eq!(focused.functions()[objective], "cost");
    let [a, b] = [whole.value(index(&own, "cost")), part.value(objective)];
    assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
}

/// A file without expressions has no composition, and `2*mass` is twice the mass to the last bit.
#[test]
fn nothing_else_changes() {
    let plain = problem(&links(r#""tolerance": 1e-9"#, "", ""));
    assert!(plain.composition.list.is_empty());
    let own = problem(&links(r#""tolerance": 1e-9"#, EXPRESSIONS, ""));
    let [at, by] = [&own, &plain].map(|of| Evaluated::new(of, &of.start()).expect("runs"));
    for f in 0..5 {
        assert_eq!(at.value(f), by.value(f));
    }
    let which = [index(&own, "mass"), index(&own, "twice")];
    let (found, _) = at.gradients(&own, &which).expect("a gradient");
    assert!((0..2).all(|i| found[1][i] == 2.0 * found[0][i]));
    let (other, _) = by.gradients(&plain, &[2]).expect("a gradient");
    assert_eq!(found[0], other[0]);
}

/// Expressions in the place of a name are the same as named ones, in the objective and in constraints.
#[test]
fn expressions_stand_in_the_place_of_a_name() {
    let study = |objective: &str, constraint: &str| {
        format!(
            r#", "objective": {{"minimise": {objective}}}, "constraints": {{"light": {{"function": {constraint}, "upper": 3}}}}"#
        )
    };
    let steps = r#""method": {"bdf": {"order": 2}}, "steps": 100"#;
    let sum = r#"{"expression": "(1*'the reach' - 0.1)^2 + work/100"}"#;
    let light = r#"{"expression": "mass - 0.1*rho"}"#;
    let named = format!(r#""sum": {sum}, "light": {light},"#);
    let texts = [
        links(steps, &named, &study("\"sum\"", "\"light\"")),
        links(steps, "", &study(sum, light)),
        // The text of an expression that is a name is that function.
        links(
            steps,
            &named,
            &study(r#"{"expression": " sum "}"#, r#"{"expression": "'light'"}"#),
        ),
    ];
    let mut optima = Vec::new();
    for text in &texts {
        let own = problem(text);
        let done = optimised(&own);
        assert!(done.outcome.converged(), "{:?}", done.outcome.status);
        let optimum = &done.optimum;
        let design: Vec<f64> = optimum.design.values().map(|own| own.value).collect();
        optima.push((design, optimum.objective.value));
        let light = &optimum.constraints["light"];
        assert!(light.value <= 3.0 + 1e-6, "{}", light.value);
        assert_eq!(light.unit.as_deref(), Some("kg"));
    }
    assert_eq!(optima[0], optima[1]);
    assert_eq!(optima[0], optima[2]);
    let inline = problem(&texts[1]);
    let objective = inline.objective.expect("an objective").function;
    assert_eq!(
        inline.functions()[objective],
        "(1*'the reach' - 0.1)^2 + work/100"
    );
    // Changes on the command line replace expressions too.
    let change = Override::parse(r#"/objective/minimise/expression="mass""#).expect("a change");
    let own = Problem::parse(&texts[1], "links.json", &[change]).expect("sound");
    let objective = own.objective.expect("an objective").function;
    assert_eq!(own.functions()[objective], "mass");
}

/// Units follow those of the functions; where numbers may carry some, nothing is claimed.
#[test]
fn units_are_printed_right() {
    let own = problem(&links(r#""tolerance": 1e-9"#, EXPRESSIONS, ""));
    let unit = |name: &str| own.function_unit(index(&own, name));
    assert_eq!(unit("power"), "J");
    assert_eq!(unit("twice"), "kg");
    assert_eq!(unit("cost"), "");
    assert_eq!(unit("far"), "rad");
    let functions = r#""momentum": {"expression": "mass*peak"}, "ratio": {"expression": "work/(mass*peak^2*time)"}, "rate": {"expression": "peak/time"},"#;
    let own = problem(&links(r#""tolerance": 1e-9"#, functions, ""));
    let unit = |name: &str| own.function_unit(index(&own, name));
    assert_eq!(unit("momentum"), "kg m/s");
    assert_eq!(unit("rate"), "m/s²");
}

const PLATE: &str = r#"{
  "version": 1, "name": "plate",
  "parameters": {"t": 0.01, "width": "= 40*t + side", "side": 0.6, "price": 2},
  "structures": {"plate": {
    "mesh": {"plate": {"length": "= width", "width": 1, "elements": [4, 3]}},
    "thickness": "= 2*t", "material": "metal",
    "supports": {"wall": {"nodes": ["x0"]}}
  }},
  "materials": {"metal": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
  "load_cases": {"push": {"p": {"pressure": {"faces": "all", "pressure": 1000}}}, "pull": {"p": {"pressure": {"faces": "all", "pressure": -400}}}},
  "functions": {
    "worth": {"expression": "price*mass*width + 3*soft^0.5 - log(strong)/4"},
    "soft": {"expression": "work/stiff"},
    "mass": "mass", "work": {"compliance": {"case": "push"}},
    "stiff": {"frequency": {"mode": 1}},
    "strong": {"von_mises": {"rho": 20, "cases": ["push"]}},
    "other": {"compliance": {"case": "pull"}}
  },
  "statics": {},
  "variables": {"t": {"path": "/parameters/t", "lower": 0.001, "upper": 0.1}, "side": {"path": "/parameters/side", "lower": 0.1, "upper": 1}},
  "objective": {"minimise": "worth"}, "constraints": {"soft enough": {"function": {"expression": "1/soft"}, "lower": 0.1}}
}"#;

/// Structures at rest, with linear strains and von Karman's.
#[test]
fn expressions_of_structures_are_exact() {
    for statics in [
        r#""statics": {}"#,
        r#""statics": {"strains": "von_karman"}"#,
    ] {
        let own = problem(&PLATE.replace(r#""statics": {}"#, statics));
        let x = own.start();
        let Simulated::Statics(at) = Simulated::of(&own, &x).expect("solves") else {
            panic!("structures")
        };
        let value = |name: &str| at.function(index(&own, name)).value;
        let soft = value("work") / value("stiff");
        let expected = 2.0 * value("mass") * 1.0 + 3.0 * soft.sqrt() - value("strong").ln() / 4.0;
        assert!((value("worth") / expected - 1.0).abs() < 1e-14);
        assert!((value("1/soft") * soft - 1.0).abs() < 1e-15);
        for derivative in check(&own, &x).expect("solves") {
            let error = derivative.relative_difference();
            assert!(
                error <= 1e-11 || derivative.is_round_off(),
                "{derivative:?}"
            );
        }
        assert_eq!(own.function_unit(index(&own, "soft")), "J/Hz");
        assert_eq!(own.function_unit(index(&own, "1/soft")), "Hz/J");
        // A load case that nothing needs is not solved.
        let asked = [index(&own, "worth"), index(&own, "1/soft")];
        let mut integration = Integration::of(&own, Some(&asked), true);
        let (found, _) = Analysed::with(&mut integration, &own, &x, &asked).expect("solves");
        let Analysed::Statics(part) = &found else {
            panic!("structures")
        };
        assert!(!part.solutions[0].is_empty() && part.solutions[1].is_empty());
        assert_eq!(found.value(asked[0]), value("worth"));
        // One solution for all: no more than the functions themselves.
        let named = ["mass", "work", "stiff", "strong"].map(|name| index(&own, name));
        let counted = |which: &[usize]| found.gradients(&own, which).expect("a gradient").1;
        assert_eq!(counted(&asked), counted(&named));
    }
}

/// The error of an expression follows from those of its functions, in motion and at rest.
#[test]
fn errors_are_propagated() {
    let moving = problem(&links(
        r#""method": {"bdf": {"order": 2}}, "steps": 50"#,
        EXPRESSIONS,
        "",
    ));
    for (own, name, [f, g]) in [
        (moving, "power", ["work", "time"]),
        (problem(PLATE), "soft", ["work", "stiff"]),
    ] {
        let at = Simulated::of(&own, &own.start()).expect("runs");
        let which = [name, f, g].map(|name| index(&own, name));
        let found = at.estimate(&own, &which, true).expect("estimates");
        let [e, f, g] = [0, 1, 2].map(|k| found[k].value);
        let expected = (f.error / g.value).abs() + (f.value / g.value.powi(2) * g.error).abs();
        let off = (e.error - expected).abs();
        assert!(
            off <= 1e-12 * expected && expected > 0.0,
            "{e:?} {expected}"
        );
        assert_eq!(e.value, f.value / g.value);
        assert_eq!(found[0].gradient.len(), 2);
        for (i, d) in found[0].gradient.iter().enumerate() {
            let [f1, g1] = [1, 2].map(|k| found[k].gradient[i]);
            let exact = f1.value / g.value - f.value * g1.value / g.value.powi(2);
            assert!(
                (d.value - exact).abs() <= 1e-12 * exact.abs().max(1e-12),
                "{d:?}"
            );
            assert!(d.error >= (f1.error / g.value).abs() && d.error.is_finite());
        }
    }
}

/// An expression of an aggregate says what it would be of the true maximum.
#[test]
fn true_values_pass_through_expressions() {
    let functions = r#""square": {"expression": "peak^2 + time*0"},"#;
    let own = problem(&links(r#""tolerance": 1e-9"#, functions, ""));
    let at = Evaluated::new(&own, &own.start()).expect("runs");
    let truth = at
        .smoothed(index(&own, "peak"))
        .expect("an aggregate")
        .value;
    let found = at.smoothed(index(&own, "square")).expect("of an aggregate");
    assert!((found.value - truth * truth).abs() <= 1e-14 * truth * truth);
}

/// A design at which an expression is not defined is a failed evaluation, which names the values.
#[test]
fn an_undefined_value_is_a_failed_evaluation() {
    let functions = r#""lost": {"expression": "log(-mass/1)"},"#;
    let own = problem(&links(r#""tolerance": 1e-9"#, functions, ""));
    let mut integration = Integration::of(&own, None, true);
    let which = [index(&own, "lost")];
    let (at, _) = Analysed::with(&mut integration, &own, &own.start(), &which).expect("runs");
    let failure = at.finite_values(&own, &which).expect_err("is not finite");
    assert_eq!(
        failure.to_string(),
        "the expression of the function \"lost\" is NaN where \"mass\" is 3.520000e0"
    );
    // An optimisation backs off from it: the root ends where the mass is 2.
    let study = r#", "objective": {"minimise": {"expression": "mass + 0.05*sqrt(mass - 2)"}}"#;
    let steps = r#""method": {"bdf": {"order": 2}}, "steps": 20"#;
    let done = optimised(&problem(&links(steps, "", study)));
    let value = done.optimum.objective.value;
    assert!((2.0..2.1).contains(&value), "{value}");
}

/// Figures and the page of an optimisation with expressions, and the picture of its constraints.
#[test]
fn pictures_show_constraints_against_time() {
    let study = r#", "objective": {"minimise": {"expression": "mass/1 + work/3"}}, "constraints": {
        "slow": {"function": "peak", "upper": 2}, "lazy": {"function": "work", "lower": 0.1, "upper": 9},
        "here": {"function": "the reach", "lower": -3}, "light": {"function": "mass", "upper": 9}}"#;
    let steps = r#""method": {"bdf": {"order": 2}}, "steps": 60"#;
    let own = problem(&links(steps, "", study));
    let done = optimised(&own);
    let files = figures::of_optimisation(&own, &done);
    let (_, svg) = files
        .iter()
        .find(|(name, _)| *name == "constraints.svg")
        .expect("a picture");
    let svg = String::from_utf8(svg.clone()).expect("text");
    for text in ["slow [m/s]", "lazy [J s]", "here [m]", "limits"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("light"));
    if let Ok(directory) = std::env::var("PICTURES") {
        std::fs::write(format!("{directory}/constraints.svg"), &svg).expect("writes");
    }
}

/// The text that a user reads: what, where in the expression, and a hint.
#[test]
fn faults_have_their_place() {
    let told = |text: &str| match Problem::parse(text, "f.json", &[]) {
        Err(faults) => faults.to_string(),
        Ok(_) => panic!("no fault: {text}"),
    };
    let steps = r#""tolerance": 1e-9"#;
    for (expression, mark, expected) in [
        (
            "2*mas + 1",
            "mas",
            "found the name \"mas\", expected the name of a function or parameter, pi or deg; did you mean \"mass\"?",
        ),
        (
            "2*'the beach'",
            "'the beach'",
            "did you mean \"the reach\"?",
        ),
        (
            "2*duration",
            "duration",
            "\"functions\": {\"duration\": \"duration\"} gives it",
        ),
        (
            "mass +",
            "",
            "found the end of the expression, expected a number, a name or '('",
        ),
        (
            "mass ? 2",
            "?",
            "found '?', expected an operator or the end",
        ),
        (
            "'mass + 2",
            "'mass + 2",
            "found a name after ' without an end",
        ),
        (
            "mean(mass)",
            "mean(mass)",
            "found the function \"mean\", expected sin",
        ),
        (
            "2 + mass - work",
            "mass - work",
            "found terms in kg and in J s, expected terms of one unit; a factor that is a number",
        ),
        (
            "exp(work)",
            "work",
            "found an argument in J s, expected an argument without unit",
        ),
        (
            "2*a",
            "",
            "found a circle: \"a\" names \"a\", expected functions that do not depend on themselves",
        ),
    ] {
        let functions = format!("\"a\": {{\"expression\": \"{expression}\"}},");
        let found = told(&links(steps, &functions, ""));
        assert!(found.contains(expected), "{expression}:\n{found}");
        let lines: Vec<&str> = found.lines().collect();
        let at = lines[2].chars().position(|c| c == '^').expect("marks");
        let under: String = lines[1].chars().skip(at).collect();
        assert!(under.starts_with(mark), "{expression}:\n{found}");
    }
    let circle =
        r#""a": {"expression": "b + 1"}, "b": {"expression": "c"}, "c": {"expression": "2*b"},"#;
    let found = told(&links(steps, circle, ""));
    assert!(
        found.contains("found a circle: \"b\" names \"c\" names \"b\""),
        "{found}"
    );
    // Several faults at once, in the places of names too.
    let study = r#", "objective": {"minimise": {"expression": "mas"}}, "constraints": {"c": {"function": {"expression": "wok"}, "upper": 1}}"#;
    let found = told(&links(steps, r#""a": {"expression": "tim"},"#, study));
    for name in ["mas", "wok", "tim"] {
        assert!(found.contains(&format!("the name \"{name}\"")), "{found}");
    }
    for (from, to, expected) in [
        (
            r#""offset": 0.25"#,
            r#""mass": 0.25"#,
            "found \"mass\", a function and a parameter, expected names that mean one thing",
        ),
        (
            r#"{"expression": "2*mass"}"#,
            r#"{"expression": 2}"#,
            "found 2, expected a text",
        ),
        (
            r#"{"expression": "2*mass"}"#,
            r#"{"expression": "2*mass", "unit": "kg"}"#,
            "expected",
        ),
    ] {
        let text = links(steps, EXPRESSIONS, "");
        assert_eq!(text.matches(from).count(), 1, "{from}");
        let found = told(&text.replace(from, to));
        assert!(found.contains(expected), "{to}:\n{found}");
    }
    let several = PLATE
        .replace(r#""cases": ["push"]"#, r#""per": "thickness""#)
        .replace("\"statics\": {},", "");
    assert!(told(&several).contains(
        "found \"strong\", a stress for each thickness, expected a function of one value"
    ));
}
