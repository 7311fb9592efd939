//! The command `optimize`: exit codes, output, written files, and files that must not change.
//!
//! Every test runs the program in its own scratch directory, on a hammer of two bodies and two
//! design variables (`tests/data/hammer.json`, 100 steps).

use crate::program::{HAMMER, changed, every, expect, files, json, names, read, scratch};
use std::path::Path;

#[test]
fn help_and_version() {
    let at = scratch();
    let help = expect(0, at.path(), &["--help"]);
    for word in [
        "simulate", "check", "compare", "plot", "schema", "--output", "--quiet", "--set",
    ] {
        assert!(help.out.contains(word), "{word}\n{}", help.out);
    }
    assert!(help.out.contains("Exit codes: 0 done; 1 not converged"));
    // One screen, the same by both options; the manual has the rest.
    let lines = help.out.lines();
    assert!(lines.clone().count() <= 50 && lines.clone().all(|line| line.chars().count() <= 112));
    let first = lines.skip(1).find(|line| line.contains("optimize"));
    assert!(first.is_some_and(|line| line.contains("optimize new")));
    assert_eq!(help.out, expect(0, at.path(), &["-h"]).out);
    let manual = expect(0, at.path(), &["manual"]).out.replace("\\-", "-");
    for option in [
        "--memory",
        "--sensitivity",
        "--no-certificate",
        "--accuracy",
    ] {
        assert!(
            !help.out.contains(option) && manual.contains(option),
            "{option}"
        );
    }
    let version = expect(0, at.path(), &["--version"]);
    assert_eq!(
        version.out,
        concat!("optimize ", env!("CARGO_PKG_VERSION"), "\n")
    );
    for bad in [&[][..], &["simulate"], &["--colour", HAMMER], &["a", "b"]] {
        let ran = expect(2, at.path(), bad);
        assert!(ran.out.is_empty() && ran.err.contains("Usage"), "{ran:?}");
    }
    assert!(files(at.path()).is_empty());
}

/// A word that is no file is answered by what it may have meant.
#[test]
fn a_word_that_is_no_file_has_a_hint() {
    let at = scratch();
    std::fs::write(at.path().join("crane.json"), "{}").expect("written");
    for (word, hint) in [
        ("simulat", "did you mean the command `optimize simulate`?"),
        ("crane", "did you mean crane.json?"),
        (
            "linkage",
            "`optimize new NAME --from linkage` writes such a problem",
        ),
    ] {
        let ran = expect(2, at.path(), &[word]);
        assert!(ran.err.contains(hint), "{}", ran.err);
    }
    let ran = expect(2, at.path(), &["simulat", "crane.json"]);
    let hint = "did you mean the command `optimize simulate`?";
    assert!(ran.err.contains(hint), "{}", ran.err);
    expect(0, at.path(), &[HAMMER, "--output", "out"]);
    let ran = expect(2, at.path(), &["out"]);
    assert!(ran.err.contains("`optimize report out`"), "{}", ran.err);
    std::fs::remove_file(at.path().join("out/optimum.json")).expect("removed");
    let ran = expect(2, at.path(), &["report", "out"]);
    assert!(
        ran.err.contains("--resume out goes on with it"),
        "{}",
        ran.err
    );
    let ran = expect(2, at.path(), &["nothing/like/it.json"]);
    assert!(!ran.err.contains("did you mean"), "{}", ran.err);
}

#[test]
fn schema_describes_the_problem_file() {
    let at = scratch();
    let schema = json(&expect(0, at.path(), &["schema"]).out);
    assert!(
        schema["$schema"]
            .as_str()
            .expect("text")
            .contains("json-schema.org")
    );
    assert_eq!(schema["type"], "object");
    assert_eq!(schema["additionalProperties"], false);
    let properties = schema["properties"].as_object().expect("an object");
    let document = json(&read(Path::new(HAMMER)));
    for key in document.as_object().expect("an object").keys() {
        assert!(properties.contains_key(key), "{key}");
        let property = &properties[key];
        assert!(property["description"].is_string(), "{key}: {property}");
    }
    for key in schema["required"].as_array().expect("a list") {
        let key = key.as_str().expect("text");
        assert!(!document[key].is_null(), "{key}");
    }
    // Every reference has a target.
    every(&schema, &mut |value| {
        if let Some(reference) = value["$ref"].as_str() {
            let pointer = reference.strip_prefix('#').expect("inside the schema");
            assert!(schema.pointer(pointer).is_some(), "{reference}");
        }
    });
}

#[test]
fn simulate_prints_and_writes_only_where_it_is_told_to() {
    let at = scratch();
    let ran = expect(0, at.path(), &["simulate", HAMMER]);
    for word in [
        "hammer: 0.6 s by dop853 in 100 steps",
        "strike",
        "effort",
        "energy",
        "constraints:",
    ] {
        assert!(ran.out.contains(word), "{word}\n{}", ran.out);
    }
    assert!(files(at.path()).is_empty());
    expect(0, at.path(), &["simulate", HAMMER, "--output", "made/here"]);
    let made = at.path().join("made/here");
    let all = [
        "constraints.svg",
        "energy.svg",
        "functions.csv",
        "motion.csv",
        "motion.svg",
        "simulation.csv",
    ];
    assert_eq!(names(&made), all);
    for file in all.into_iter().filter(|file| file.ends_with(".csv")) {
        let table = read(&made.join(file));
        assert_eq!(
            table.lines().count(),
            102,
            "{file}: a head and 101 instants"
        );
        let width = table.lines().next().expect("a head").split(',').count();
        assert!(
            table.lines().all(|line| line.split(',').count() == width),
            "{file}"
        );
    }
    let motion = read(&made.join("motion.csv"));
    assert!(
        motion.starts_with("time [s],handle: position x [m],"),
        "{motion}"
    );
    let head = read(&made.join("functions.csv"));
    assert!(
        head.starts_with("time [s],strike: speed [m/s],effort: energy [J]\n"),
        "{head}"
    );
    let head = read(&made.join("simulation.csv"));
    assert!(head.contains(",pin: force x [N],"), "{head}");
    let arguments = [
        "simulate",
        HAMMER,
        "--output",
        "joint",
        "--joint-axes",
        "--json",
    ];
    let ran = expect(0, at.path(), &arguments);
    let table = read(&at.path().join("joint/simulation.csv"));
    assert!(table.contains(",pin: force e1 [N],"), "{table}");
    let told: serde_json::Value = serde_json::from_str(&ran.out).expect("JSON");
    assert!(
        told["functions"]["strike"]["value"]
            .as_f64()
            .expect("a number")
            > 1.0
    );
    assert_eq!(told["functions"]["effort"]["unit"], "J s");
    assert_eq!(told["work"]["steps"], 100);
    let quiet = expect(0, at.path(), &["simulate", HAMMER, "--quiet"]);
    assert!(quiet.out.is_empty() && quiet.err.is_empty(), "{quiet:?}");
}

#[test]
fn check_passes_or_fails_by_its_tolerance() {
    let at = scratch();
    let ran = expect(0, at.path(), &["check", HAMMER, "--tolerance", "1e-12"]);
    assert!(ran.out.contains("4 derivatives"), "{}", ran.out);
    for name in ["strike", "effort", "head mass", "reach"] {
        assert!(ran.out.contains(name), "{name}\n{}", ran.out);
    }
    let ran = expect(1, at.path(), &["check", HAMMER, "--tolerance", "1e-300"]);
    assert!(ran.out.contains("exceeds the tolerance"), "{}", ran.out);
    let ran = expect(
        1,
        at.path(),
        &["check", HAMMER, "-q", "--tolerance", "1e-300"],
    );
    assert!(ran.out.contains("exceeds the tolerance"), "{}", ran.out);
    for wrong in ["0", "-1", "NaN", "inf", "tiny"] {
        let tolerance = format!("--tolerance={wrong}");
        expect(2, at.path(), &["check", HAMMER, &tolerance]);
    }
    let bare = changed(at.path(), "bare.json", |document| {
        let object = document.as_object_mut().expect("an object");
        for key in ["variables", "objective", "constraints"] {
            object.remove(key);
        }
    });
    let ran = expect(2, at.path(), &["check", &bare]);
    assert!(
        ran.err
            .contains("nothing to check: the problem has no variables")
    );
    let ran = expect(2, at.path(), &[&bare]);
    assert!(
        ran.err
            .contains("nothing to optimise: the problem has no \"objective\"")
    );
}

#[test]
fn optimising_writes_a_record_and_figures() {
    let at = scratch();
    let ran = expect(0, at.path(), &[HAMMER]);
    assert!(
        ran.out
            .starts_with("hammer: the optimality conditions hold\n"),
        "{}",
        ran.out
    );
    assert!(
        ran.err.starts_with("iter      objective    inf_pr"),
        "{}",
        ran.err
    );
    let results = at.path().join("results/hammer");
    let expected = [
        "constraints.svg",
        "convergence.svg",
        "energy.svg",
        "evaluations.jsonl",
        "history.csv",
        "motion.svg",
        "optimum.json",
        "state.json",
    ];
    assert_eq!(names(&results), expected);
    assert_eq!(names(at.path()).len(), expected.len(), "nothing else");
    let text = read(&results.join("optimum.json"));
    let optimum = json(&text);
    assert_eq!(optimum["status"], "converged");
    assert_eq!(optimum["active_bounds"]["head mass"], "lower");
    assert_eq!(optimum["active_bounds"]["reach"], "upper");
    assert_eq!(optimum["problem"]["file"], "hammer.json");
    assert_eq!(optimum["version"], env!("CARGO_PKG_VERSION"));
    // A number that is not finite would be written as null.
    every(&optimum, &mut |value| assert!(!value.is_null(), "{text}"));
    assert!(!text.contains("NaN") && !text.contains("inf,"), "{text}");
    for name in ["convergence.svg", "energy.svg", "motion.svg"] {
        let figure = read(&results.join(name));
        assert!(
            figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"),
            "{name}"
        );
        assert!(!figure.contains("NaN"), "{name}");
    }
    let history = read(&results.join("history.csv"));
    assert!(
        history.starts_with("iteration,evaluations,objective: strike"),
        "{history}"
    );
    let last: Vec<&str> = history.lines().last().expect("a row").split(',').collect();
    assert_eq!(last[12..14], ["100", "0"], "steps, times chosen anew");
    let iterations = optimum["counts"]["iterations"].as_u64().expect("a count");
    assert_eq!(history.lines().count() as u64, iterations + 2);
}

/// A reaction that the motion does not determine has no derivatives: `check` says what `simulate` says.
#[test]
fn values_that_are_not_finite_are_not_checked() {
    let at = scratch();
    let bar = |place: serde_json::Value, own: [f64; 3]| {
        serde_json::json!({"mass": 2, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}, "place": place,
               "points": {"l": [-0.2, 0, 0], "r": [0.2, 0, 0], "t": own}})
    };
    let file = serde_json::json!({
        "version": 1, "name": "welded",
        "bodies": {
            "a": bar(serde_json::json!({"put": "l"}), [0.1, 0.05, 0.0]),
            "b": bar(serde_json::json!({"put": "l", "at": "a.r"}), [-0.1, 0.05, 0.03])
        },
        "joints": {
            "pin": {"revolute": {"between": ["a", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "weld": {"weld": {"between": ["b", "a"], "at": "a.r"}},
            "rod": {"rod": {"between": ["a", "b"], "at": {"a": "t", "b": "t"}}}
        },
        "simulation": {"duration": 0.3},
        "functions": {"F": {"final": {"joint_force": {"joint": "weld", "direction": [0, 1, 0]}}}},
        "variables": {"m": {"path": "/bodies/b/mass", "lower": 1, "upper": 3}}
    });
    std::fs::write(at.path().join("welded.json"), file.to_string()).expect("is written");
    for command in ["simulate", "check"] {
        let ran = expect(3, at.path(), &[command, "welded.json"]);
        assert!(ran.err.contains("\"F\" is NaN"), "{command}: {}", ran.err);
        assert!(
            !ran.out.contains("largest relative"),
            "{command}: {}",
            ran.out
        );
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let at = scratch();
    for directory in ["first", "second"] {
        let ran = expect(0, at.path(), &[HAMMER, "--quiet", "--output", directory]);
        assert!(ran.out.is_empty() && ran.err.is_empty(), "{ran:?}");
    }
    for name in names(&at.path().join("first")) {
        let [first, second] = ["first", "second"].map(|d| read(&at.path().join(d).join(&name)));
        assert!(first == second, "{name}");
    }
}

#[test]
fn compare_tells_what_moved() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "-q", "-o", "new"]);
    let ran = expect(0, at.path(), &["compare", "new", "new/optimum.json"]);
    assert!(ran.out.starts_with("same optimum: "), "{}", ran.out);
    let mut optimum = json(&read(&at.path().join("new/optimum.json")));
    let mass = &mut optimum["design"]["head mass"]["value"];
    *mass = (mass.as_f64().expect("a number") + 0.01).into();
    std::fs::write(at.path().join("edited.json"), optimum.to_string()).expect("is written");
    let ran = expect(1, at.path(), &["compare", "new", "edited.json"]);
    let row = ran.out.lines().find(|line| line.contains("head mass"));
    assert!(row.is_some_and(|row| row.contains("design")), "{}", ran.out);
    assert!(!ran.out.contains("reach"), "{}", ran.out);
    let ran = expect(2, at.path(), &["compare", "new", "none.json"]);
    assert!(
        ran.err.starts_with("cannot read none.json: "),
        "{}",
        ran.err
    );
    std::fs::write(at.path().join("broken.json"), "{\"status\": 1}").expect("is written");
    let ran = expect(2, at.path(), &["compare", "broken.json", "new"]);
    assert!(ran.err.starts_with("broken.json: "), "{}", ran.err);
}

#[test]
fn plot_redraws_the_same_figures() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "-q", "-o", "drawn"]);
    let drawn = at.path().join("drawn");
    let before = files(&drawn);
    for name in ["convergence.svg", "energy.svg", "motion.svg"] {
        std::fs::remove_file(drawn.join(name)).expect("is removed");
    }
    expect(0, at.path(), &["plot", "drawn"]);
    let after = files(&drawn);
    assert_eq!(after.len(), before.len());
    for (path, content) in &before {
        assert!(after[path] == *content, "{path}");
    }
    std::fs::remove_file(drawn.join("history.csv")).expect("is removed");
    let ran = expect(2, at.path(), &["plot", "drawn"]);
    assert!(
        ran.err.starts_with("cannot read drawn/history.csv: "),
        "{}",
        ran.err
    );
}

/// Files of bodies lie beside the problem file: a record knows the way to them, wherever the command runs.
#[test]
fn plot_finds_the_files_of_bodies() {
    let at = scratch();
    let path = |name: &str| at.path().join(name);
    std::fs::create_dir_all(path("case")).expect("is made");
    std::fs::create_dir_all(path("elsewhere")).expect("is made");
    let along = |x: f64| serde_json::json!([[x, 0, 0], [0, 0, 0], [0, 0, 0]]);
    let rod = serde_json::json!({
        "version": 1, "mass": 5, "centre_of_mass": [0.6, 0, 0],
        "inertia": [[0.1, 0, 0], [0, 3, 0], [0, 0, 3]],
        "static_moments": [[3, 0, 0]], "with_position": [along(3.0)], "products": [[along(3.0)]],
        "stiffness": [[500]],
        "points": {"end": {"position": [1, 0, 0], "displacement": [[1, 0, 0]]}}
    });
    let problem = serde_json::json!({
        "version": 1, "name": "rod", "gravity": [0, 0, 0],
        "bodies": {"rod": {"modal": {"source": {"standard_input": "rod.json"}, "young_factor": 1,
                                     "start": {"coordinates": [0.01]}}}},
        "simulation": {"duration": 0.1, "steps": 20, "method": {"radau": {"stages": 3}}},
        "functions": {"length": {"final": {"elastic_displacement":
            {"body": "rod", "point": "end", "direction": [1, 0, 0]}}}},
        "variables": {"stiffness": {"path": "/bodies/rod/modal/young_factor", "lower": 0.9, "upper": 1.1}},
        "objective": {"minimise": "length"}
    });
    std::fs::write(path("case/rod.json"), rod.to_string()).expect("written");
    std::fs::write(path("case/problem.json"), problem.to_string()).expect("written");
    expect(
        0,
        at.path(),
        &["case/problem.json", "-q", "-o", "out/drawn"],
    );
    let record = json(&read(&path("out/drawn/optimum.json")));
    assert_eq!(record["problem"]["directory"], "../../case");
    let figure = path("out/drawn/motion.svg");
    let before = read(&figure);
    std::fs::remove_file(&figure).expect("is removed");
    expect(0, &path("elsewhere"), &["plot", "../out/drawn"]);
    assert_eq!(read(&figure), before);
}

#[test]
fn set_changes_one_value_for_this_run() {
    let at = scratch();
    let heavier = [
        "simulate",
        HAMMER,
        "--set",
        "/bodies/head/mass=3",
        "--set",
        "/simulation/steps=50",
    ];
    let ran = expect(0, at.path(), &heavier);
    assert!(ran.out.contains("in 50 steps"), "{}", ran.out);
    let file = changed(at.path(), "heavier.json", |document| {
        document["bodies"]["head"]["mass"] = 3.into();
        document["simulation"]["steps"] = 50.into();
    });
    assert_eq!(ran.out, expect(0, at.path(), &["simulate", &file]).out);
    let ran = expect(
        2,
        at.path(),
        &["simulate", HAMMER, "--set", "/bodies/haed/mass=3"],
    );
    assert!(
        ran.err.contains("found nothing at this path"),
        "{}",
        ran.err
    );
    assert!(
        ran.err.contains("did you mean /bodies/head/mass?"),
        "{}",
        ran.err
    );
    let ran = expect(
        2,
        at.path(),
        &["simulate", HAMMER, "--set", "/bodies/head/mass=heavy"],
    );
    assert!(ran.err.contains("\"heavy\""), "{}", ran.err);
    let ran = expect(
        2,
        at.path(),
        &["simulate", HAMMER, "--set", "/bodies/head/mass"],
    );
    assert!(ran.err.contains("expected PATH=VALUE"), "{}", ran.err);
}

/// One iteration is not enough: the exit code is 1, and the record has this status.
#[test]
fn a_run_that_does_not_converge_is_recorded_as_such() {
    let at = scratch();
    let few = ["--set", "/optimiser/iterations=1", "-o", "out", "-q"];
    let ran = expect(1, at.path(), &[&[HAMMER], &few[..]].concat());
    assert_eq!(ran.err, "hammer: the iteration limit was reached\n");
    let optimum = json(&read(&at.path().join("out/optimum.json")));
    assert_eq!(optimum["status"], "iteration_limit");
    every(&optimum, &mut |value| assert!(!value.is_null()));
}

/// Results of an earlier run stay if the problem cannot be read.
#[test]
fn a_bad_problem_leaves_results_untouched() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "-q"]);
    let before = files(at.path());
    let bad = [
        "/bodies/head/mass=-1",
        "/variables/reach/upper=0.1",
        "/name=3",
    ];
    for change in bad {
        let ran = expect(2, at.path(), &[HAMMER, "--set", change]);
        assert!(ran.out.is_empty() && !ran.err.is_empty(), "{ran:?}");
    }
    let ran = expect(2, at.path(), &["missing.json"]);
    assert!(ran.err.contains("missing.json"), "{}", ran.err);
    assert_eq!(files(at.path()), before);
}

#[test]
fn paths_are_taken_from_the_working_directory() {
    let at = scratch();
    let inner = at.path().join("inner");
    std::fs::create_dir(&inner).expect("is made");
    std::fs::copy(HAMMER, at.path().join("hammer.json")).expect("is copied");
    let ran = expect(0, &inner, &["../hammer.json"]);
    assert!(ran.err.contains("results in results/hammer"), "{}", ran.err);
    assert_eq!(names(&inner).len(), 8);
    assert!(inner.join("results/hammer/optimum.json").is_file());
    assert_eq!(names(at.path()).len(), 9, "eight results and the problem");
}

#[test]
fn results_that_cannot_be_written_are_told_before_the_work() {
    let at = scratch();
    std::fs::write(at.path().join("file"), "mine").expect("is written");
    let measured = ["work-precision", HAMMER];
    for job in [&[HAMMER][..], &["simulate", HAMMER], &measured] {
        for output in ["file", "file/below"] {
            let ran = expect(4, at.path(), &[job, &["--output", output]].concat());
            assert!(ran.err.contains("file"), "{}", ran.err);
            // The fault is found before the work: each run prints one line.
            assert_eq!(ran.err.lines().count(), 1, "{}", ran.err);
        }
    }
    assert_eq!(read(&at.path().join("file")), "mine");
    assert_eq!(names(at.path()), ["file"]);
}

/// The steps are much too long for the spin: exit code 3, with the time and the body.
#[test]
fn a_simulation_that_fails_is_told_with_time_and_body() {
    let at = scratch();
    let wild = [
        "--set",
        "/initial_velocity/angular/2=5000",
        "--set",
        "/simulation/steps=5",
    ];
    for job in [
        &["simulate", HAMMER][..],
        &["check", HAMMER],
        &[HAMMER, "-o", "out"],
    ] {
        let ran = expect(3, at.path(), &[job, &wild].concat());
        assert!(
            ran.err.contains("at t = 1.200000e-1 s (step 1)"),
            "{}",
            ran.err
        );
        let named = [
            "body \"head\"",
            "body \"handle\"",
            "joint \"pin\"",
            "joint \"seat\"",
        ];
        assert!(
            named.iter().any(|name| ran.err.contains(name)),
            "{}",
            ran.err
        );
    }
    assert!(!at.path().join("out/optimum.json").exists());
}

/// A handle is shorter than the distance of its two pins: exit code 3, with the joint.
#[test]
fn an_assembly_that_cannot_be_closed_is_told_with_its_joint() {
    let at = scratch();
    let file = changed(at.path(), "apart.json", |document| {
        let joint = r#"{"spherical": {"between": ["head", "ground"],
                        "at": {"a": [0, 0, 0], "b": [1.2, 0.3, 0]}}}"#;
        document["joints"]["wall"] = json(joint);
    });
    let ran = expect(2, at.path(), &["simulate", &file]);
    assert!(ran.err.contains("/joints/wall"), "{}", ran.err);
}

/// Products are told where the Krylov solver makes some; rigid scenes say nothing of it.
#[test]
fn the_solver_of_finite_elements_is_told() {
    let at = scratch();
    let plates = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/flexible/double_plate.json"
    );
    let all = |command: &'static str, solver: &str| {
        let sets = [
            "/bodies/first/elements/structure/mesh/plate/elements=[2,1]".to_owned(),
            "/bodies/second/elements/structure/mesh/plate/elements=[2,1]".to_owned(),
            "/simulation/steps=8".to_owned(),
            "/simulation/duration=0.008".to_owned(),
            format!("/simulation/linear_solver=\"{solver}\""),
        ];
        let mut arguments = vec![command, plates];
        for set in &sets {
            arguments.extend(["--set", set]);
        }
        let text = expect(0, at.path(), &arguments).out;
        arguments.push("--json");
        (text, json(&expect(0, at.path(), &arguments).out))
    };
    let (text, found) = all("explain", "krylov");
    assert!(
        text.contains("linear systems: Krylov with kept factors: as the problem says"),
        "{text}"
    );
    assert!(text.contains(" products for "), "{text}");
    assert!(
        found["linear"]["krylov_products"].as_u64() > Some(8),
        "{found}"
    );
    let (text, found) = all("explain", "direct");
    assert!(
        text.contains("linear systems: direct: new factors cost about 6 Krylov products"),
        "{text}"
    );
    assert_eq!(found["linear"]["krylov_products"], 0);
    for key in ["unknowns", "entries", "factors", "operations"] {
        assert!(found["linear"][key].as_u64() > Some(100), "{found}");
    }
    let (text, found) = all("simulate", "krylov");
    assert!(text.contains(" Krylov products)"), "{text}");
    assert!(
        found["work"]["krylov_products"].as_u64() > Some(8),
        "{found}"
    );
    let (text, found) = all("simulate", "direct");
    assert!(
        !text.contains("Krylov") && found["work"]["krylov_products"].is_null(),
        "{text}"
    );
    let rigid = expect(0, at.path(), &["explain", HAMMER, "--json"]).out;
    assert!(json(&rigid)["linear"].is_null(), "{rigid}");
}

#[test]
fn explain_says_what_is_left_out_and_what_is_not() {
    let at = scratch();
    let ran = expect(0, at.path(), &["explain", HAMMER]);
    for part in [
        "left out\n",
        "unknowns of the accelerations",
        "elimination:",
        "memory:",
    ] {
        assert!(ran.out.contains(part), "{part}\n{}", ran.out);
    }
    let found = json(&expect(0, at.path(), &["explain", HAMMER, "--json"]).out);
    assert_eq!(found["written"]["velocities"], 12);
    assert_eq!(found["lowered"]["velocities"], 6);
    let ran = expect(
        0,
        at.path(),
        &["explain", HAMMER, "--no-lowering", "--json"],
    );
    let found = json(&ran.out);
    assert_eq!(found["written"], found["lowered"]);
    assert_eq!(found["kept"][0], "anything, as --no-lowering asks");
    expect(2, at.path(), &["explain", HAMMER, "--output", "here"]);
    expect(2, at.path(), &["explain", "nothing.json"]);
    assert!(files(at.path()).is_empty());
}

/// Commands and options in a document exist in the program, in cargo or in another tool.
#[test]
fn the_documents_name_commands_and_options_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let at = scratch();
    let help = |arguments: &[&str]| expect(0, at.path(), arguments).out;
    let plain = help(&["--help"]);
    let listed = plain.split("Commands:\n").nth(1).expect("commands");
    let listed = listed.lines().take_while(|line| line.starts_with("  "));
    let commands: Vec<&str> = listed
        .filter_map(|line| line.split_whitespace().next())
        .filter(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
        .collect();
    assert!(commands.contains(&"work-precision"), "{commands:?}");
    let mut known = plain.clone() + &help(&["manual"]).replace("\\-", "-");
    for command in commands.iter().filter(|command| **command != "help") {
        known += &help(&[command, "--help"]);
    }
    // Options of cargo, git, the linter, mpirun and Slurm.
    known += "--release --all-targets --no-deps --bench --test --lib --check --stat --locked --open \
              --path --tool --threshold --auto --call-graph --nocapture --include-ignored --ignored --all --timings \
              --no-run --features --bin --oversubscribe --map-by --bind-to --mca --nodes --ntasks-per-node \
              --cpus-per-task --mpi --cpu-bind";
    let options: Vec<&str> = known
        .split(|c: char| !(c.is_ascii_lowercase() || c == '-'))
        .collect();
    let mut paths: Vec<_> = ["README.md", "CONTRIBUTING.md"]
        .map(|name| root.join(name))
        .into();
    for folder in ["docs", "docs/tutorials"] {
        let docs = std::fs::read_dir(root.join(folder)).expect("a directory");
        paths.extend(docs.flatten().map(|entry| entry.path()));
    }
    let (mut wrong, mut count) = (Vec::new(), 0);
    for path in paths
        .iter()
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
    {
        let text = read(path);
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        for (k, line) in text.lines().enumerate() {
            let mut words = line
                .split(|c: char| c.is_whitespace() || "`|()[],;".contains(c))
                .peekable();
            while let Some(word) = words.next() {
                let option = word
                    .split('=')
                    .next()
                    .unwrap_or_default()
                    .trim_end_matches('.');
                let is_option =
                    option.starts_with("--") && option[2..].starts_with(char::is_alphabetic);
                if is_option {
                    count += 1;
                    if !options.contains(&option) {
                        wrong.push(format!("{name}:{}: {option}", k + 1));
                    }
                }
                let called = word == "optimize" && line.contains("`optimize ");
                let command = words.peek().copied().unwrap_or_default();
                let is_word = command.chars().all(|c| c.is_ascii_lowercase() || c == '-');
                if called && is_word && !command.is_empty() && !command.starts_with('-') {
                    count += 1;
                    let is_command = commands.contains(&command);
                    if !is_command && line.contains(&format!("`optimize {command}")) {
                        wrong.push(format!("{name}:{}: optimize {command}", k + 1));
                    }
                }
            }
        }
    }
    assert!(count > 50, "{count}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The program names redundant joints on standard error, unless it is quiet.
#[test]
fn the_program_names_redundant_joints() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/benchmarks/four_bars_1.json"
    );
    let short = ["simulate", file, "--set", "/simulation/duration=0.01"];
    for (more, expected) in [
        (
            None,
            "joint \"C0\": 3 of 5 rows follow from the others to 1e-11",
        ),
        (Some("--quiet"), ""),
    ] {
        let arguments: Vec<&str> = short.into_iter().chain(more).collect();
        let told = expect(0, scratch().path(), &arguments).err;
        assert!(told.starts_with(expected), "{told}");
        assert_eq!(told.is_empty(), more.is_some(), "{told}");
    }
}

/// Joints that lose equally many rows are named in one line.
#[test]
fn the_program_names_many_redundant_joints_in_one_line() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/benchmarks/four_bars_10.json"
    );
    let arguments = ["simulate", file, "--set", "/simulation/duration=0.001"];
    let told = expect(0, scratch().path(), &arguments).err;
    let line = "joints \"C0\", \"C1\", \"C2\" and 7 more: 3 of 5 rows each follow from the others to 1e-11";
    assert!(told.contains(line), "{told}");
    assert_eq!(told.matches("follow from").count(), 1, "{told}");
    let explained = expect(0, scratch().path(), &["explain", file]).out;
    assert!(explained.matches("rows of").count() <= 6, "{explained}");
}

/// The speed of a pendulum is zero at its turning points.
#[test]
fn an_aggregate_of_a_speed_that_passes_zero_is_warned_of() {
    let at = scratch();
    let swing = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/swing.json");
    let warned = |quantity: &str| {
        let function = format!(
            r#"/functions/swept angle={{"ks": {{"rho": 1, "of": {{"{quantity}": {{"body": "bar"}}}}}}}}"#
        );
        let long = "/simulation/duration=2";
        let arguments = ["simulate", swing, "--set", long, "--set", &function];
        let out = expect(0, at.path(), &arguments).out;
        out.contains("the speed of \"swept angle\" passes zero at t = 0.92")
            && out.contains("take \"speed_squared\"")
    };
    assert!(warned("speed"));
    assert!(!warned("speed_squared"));
}
