//! Records are read back exactly, and differences between them are reported.

use crate::reference::documents::optimised;
use flexbody_problem::Problem;
use flexbody_report::compare::Comparison;
use flexbody_report::history::Column;
use flexbody_report::optimum::*;
use flexbody_report::{
    History, HistoryRow, Optimum, ReportError, Tolerances, atomic_write, compare, read_text,
    summary, write_all,
};

fn history() -> History {
    let row = |iteration: usize, objective: f64, barrier: f64| HistoryRow {
        iteration,
        evaluations: iteration + 1,
        objective,
        infeasibility: 2.76,
        optimality: 0.1 + 0.2,
        barrier,
        step_norm: f64::MIN_POSITIVE,
        dual_step: 1.0,
        primal_step: 0.995,
        regularisation: 0.0,
        line_search_trials: 1,
        phase: "normal".into(),
        steps: Some(158),
        refreshes: Some(1),
        design: vec![400.0, -0.0],
        constraints: vec![-2.76],
    };
    History {
        objective: Column::new("range", Some("m")),
        variables: vec![
            Column::new("mass, \"heavy\" part", Some("kg")),
            Column::new("angle [rad]", None),
        ],
        constraints: vec![Column::new("clear the\nbarrier", Some("m"))],
        rows: vec![row(0, 546.507, 0.1), row(1, 1.0 / 3.0, 1e-300)],
    }
}

fn optimum() -> Optimum {
    let variable = |value, start, lower, upper, unit: &str| DesignValue {
        value,
        start,
        lower: Some(lower),
        upper: Some(upper),
        unit: Some(unit.into()),
    };
    let residuals = KktResiduals {
        stationarity: 3.2e-8,
        feasibility: 1e-12,
        complementarity: 1e-9,
    };
    Optimum {
        sensitivities: Default::default(),
        status: "converged".into(),
        message: "Converged to the tolerance 1e-6.".into(),
        objective: Objective {
            function: "range".into(),
            sense: Sense::Maximise,
            value: 849.8985,
            unit: Some("m".into()),
            true_maximum: Some(867.7),
            aggregate: None,
            true_value: None,
            estimated_error: Some(0.003),
        },
        start_objective: Some(546.507),
        design: [
            (
                "counterweight".to_owned(),
                variable(500.0, 400.0, 300.0, 500.0, "kg"),
            ),
            (
                "angle".to_owned(),
                variable(-0.0071602468, 0.0, -0.3, 0.5, "rad"),
            ),
        ]
        .into(),
        constraints: [(
            "clear the barrier".to_owned(),
            ConstraintValue {
                value: 1e-9,
                start: None,
                lower: Some(0.0),
                upper: None,
                unit: Some("m".into()),
                multiplier: -3.5014,
                active: Activity::Lower,
                aggregate: None,
                estimated_error: None,
                true_value: None,
            },
        )]
        .into(),
        multipliers: Multipliers {
            constraints: [("clear the barrier".to_owned(), 3.5014)].into(),
            lower_bounds: Default::default(),
            upper_bounds: [("counterweight".to_owned(), 0.9)].into(),
        },
        active_bounds: [("counterweight".to_owned(), BoundSide::Upper)].into(),
        kkt: Kkt {
            scaled: residuals,
            unscaled: residuals,
        },
        scaling: Scaling::default(),
        second_order: None,
        gradient_certificate: None,
        fit: None,
        integration: None,
        counts: Counts {
            iterations: 21,
            function_evaluations: 25,
            gradient_evaluations: 22,
            failed_evaluations: 1,
            steps: 50_000,
            recomputed_steps: 0,
            newton_iterations: 140_000,
            factorisations: 180_000,
            quadratic_programs: 0,
            solves: 230_000,
        },
        warnings: vec!["the aggregate is coarse".into()],
        version: "0.1.0".into(),
        problem: ProblemRecord {
            name: "trebuchet".into(),
            file: "trebuchet.json".into(),
            directory: None,
            sha256: "ab".repeat(32),
            document: json!({"version": 1, "description": null}),
        },
    }
}

fn moved(comparison: &Comparison) -> Vec<(&str, &str)> {
    let moved = |row: &&flexbody_report::compare::Row| {
        row.verdict == flexbody_report::compare::Verdict::Moved
    };
    let rows = comparison.rows.iter().filter(moved);
    rows.map(|row| (row.kind, row.name.as_str())).collect()
}

#[test]
fn history_reads_back_exactly() {
    let history = history();
    let back = History::from_csv(&history.to_csv().expect("is valid")).expect("is valid");
    assert_eq!(back, history);
    assert!(back.rows[0].design[1].is_sign_negative());
}

#[test]
fn history_heading_names_units() {
    let text = history().to_csv().expect("is valid");
    let start = "iteration,evaluations,objective: range [m],infeasibility,optimality,barrier,\
                 step norm,dual step,primal step,regularisation,line search trials,phase,\
                 time steps,times chosen anew,\
                 \"variable: mass, \"\"heavy\"\" part [kg]\",variable: angle [rad] [],\
                 \"constraint: clear the\nbarrier [m]\"\n0,1,546.507,2.76,";
    assert!(text.starts_with(start), "{text}");
}

#[test]
fn numbers_that_are_not_finite_are_empty_fields() {
    let mut history = history();
    history.rows[1].optimality = f64::INFINITY;
    history.rows[1].constraints[0] = f64::NAN;
    history.rows[1].steps = None;
    let text = history.to_csv().expect("is valid");
    assert!(
        text.lines()
            .last()
            .expect("is valid")
            .ends_with(",normal,,1,400.0,-0.0,")
    );
    let back = History::from_csv(&text).expect("is valid");
    assert_eq!(
        (back.rows[1].steps, back.rows[1].refreshes),
        (None, Some(1))
    );
    assert!(back.rows[1].optimality.is_nan() && back.rows[1].constraints[0].is_nan());
}

#[test]
fn faults_of_a_history_name_the_line() {
    let good = history().to_csv().expect("is valid");
    let cases = [
        (
            String::new(),
            "history, line 1: found an empty file, expected a header",
        ),
        (
            good.replace("546.507", "5x"),
            "history, line 3: found \"5x\", expected a finite number or nothing",
        ),
        (
            good.replace("546.507", "inf"),
            "history, line 3: found \"inf\", expected a finite number or nothing",
        ),
        (
            good.replace("158,1,400.0,-0.0,-2.76\n1", "158,1,400.0,-0.0\n1"),
            "history, line 3: found 16 fields, expected 17 as in the header",
        ),
        (
            good.replace("dual step", "double step"),
            "history, line 1: found column \"double step\", expected column \"dual step\"",
        ),
        (
            "iteration,evaluations".into(),
            "history, line 1: found 2 columns, expected at least 14",
        ),
    ];
    for (text, message) in cases {
        assert_eq!(
            History::from_csv(&text)
                .expect_err("must be refused")
                .to_string(),
            message
        );
    }
    let mut short = history();
    short.rows[1].design.pop();
    assert_eq!(
        short.to_csv().expect_err("must be refused").to_string(),
        "history, line 3: found 1 design and 1 constraint values, \
         expected 2 design and 1 constraint values"
    );
}

#[test]
fn optimum_reads_back_exactly_and_has_the_fixed_keys() {
    let text = optimum().to_json().expect("is valid");
    assert_eq!(Optimum::from_json(&text).expect("is valid"), optimum());
    assert_eq!(
        Optimum::from_json(&text)
            .expect("is valid")
            .to_json()
            .expect("is valid"),
        text
    );
    let value: serde_json::Value = serde_json::from_str(&text).expect("is valid");
    for key in [
        "status",
        "objective",
        "design",
        "constraints",
        "multipliers",
        "active_bounds",
        "kkt",
        "counts",
        "version",
        "problem",
    ] {
        assert!(value.get(key).is_some(), "{key}");
    }
    assert_eq!(value["active_bounds"]["counterweight"], "upper");
    assert_eq!(value["objective"]["sense"], "maximise");
    assert!(
        value["constraints"]["clear the barrier"]
            .get("upper")
            .is_none()
    );
}

#[test]
fn a_number_that_is_not_finite_is_refused_by_name() {
    let refused = |change: fn(&mut Optimum), pointer: &str| {
        let mut optimum = optimum();
        change(&mut optimum);
        match optimum.to_json() {
            Err(ReportError::NotFinite { pointer: found }) => assert_eq!(found, pointer),
            other => panic!("{other:?}"),
        }
    };
    refused(|o| o.objective.value = f64::NAN, "/objective/value");
    refused(
        |o| o.objective.true_maximum = Some(f64::NAN),
        "/objective/true_maximum",
    );
    refused(
        |o| o.design[1].lower = Some(f64::NEG_INFINITY),
        "/design/angle/lower",
    );
    refused(
        |o| o.kkt.unscaled.feasibility = f64::INFINITY,
        "/kkt/unscaled/feasibility",
    );
}

/// An objective worse than at the start is no loss if the start was infeasible; the summary says
/// so.
#[test]
fn a_start_that_is_not_feasible_is_told() {
    let told = |lower: Option<f64>, upper: Option<f64>, start: Option<f64>| {
        let mut optimum = optimum();
        let constraint = &mut optimum.constraints[0];
        (constraint.lower, constraint.upper, constraint.start) = (lower, upper, start);
        let text = summary(&optimum);
        let line = text.lines().find(|line| line.contains("feasible: it"));
        line.map(|line| line.trim().to_owned())
    };
    let by = |by: &str| {
        let told = "the start was not feasible: it violated \"clear the barrier\" by";
        Some(format!("{told} {by} m"))
    };
    assert_eq!(told(Some(2.0), None, Some(-1.5)), by("3.5"));
    assert_eq!(told(None, Some(2.0), Some(2.25)), by("0.25"));
    assert_eq!(told(Some(2.0), Some(2.0), Some(2.25)), by("0.25"));
    assert_eq!(told(Some(2.0), Some(2.0), Some(1.0)), by("1"));
    for start in [None, Some(2.0), Some(2.0 * (1.0 - 1e-14)), Some(7.0)] {
        assert_eq!(told(Some(2.0), None, start), None);
    }
}

#[test]
fn an_error_of_nothing_is_below_rounding() {
    let told = |error: f64| {
        let mut optimum = optimum();
        optimum.objective.estimated_error = Some(error);
        summary(&optimum)
    };
    for error in [0.0, 1e-16 * 849.8985] {
        let text = told(error);
        assert!(text.contains("samples is below rounding"), "{text}");
        assert!(!text.contains("accurate to"), "{text}");
    }
    assert!(told(1e-12).contains("accurate to about 1e-12 m"));
}

/// A ball flies for a second at v without gravity: x = v, and the energy is E = v² for 2 kg. The
/// multipliers are the derivatives of the optimum in the bounds: of a constraint in the user's
/// sense, of the bounds of v without sign.
#[test]
fn multipliers_are_sensitivities_with_their_signs() {
    let solved = |objective: &str, constraint: &str, bounds: (f64, f64), start: f64| {
        let text = format!(
            r#"{{"version": 1, "name": "ball", "gravity": [0, 0, 0],
            "bodies": {{"ball": {{"shape": "point", "mass": 2,
                                  "velocity": {{"linear": [{start}, 0, 0]}}}}}},
            "simulation": {{"duration": 1, "steps": 4}},
            "functions": {{"x": {{"final": {{"position": {{"body": "ball", "direction": [1, 0, 0]}}}}}},
                           "E": {{"final": {{"energy": "kinetic"}}}}}},
            "variables": {{"v": {{"path": "/bodies/ball/velocity/linear/0",
                                 "lower": {}, "upper": {}}}}},
            "constraints": {{{constraint}}},
            "objective": {{{objective}}}}}"#,
            bounds.0, bounds.1
        );
        let problem = Problem::parse(&text, "ball.json", &[]);
        let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
        optimised(&problem).optimum
    };
    let limits = |function: &str, side: &str, bound: f64| {
        format!(r#""limit": {{"function": "{function}", "{side}": {bound}}}"#)
    };
    let (minimise, maximise) = (r#""minimise": "#, r#""maximise": "#);
    // Objective, constraint, its side and bound, start, d optimum / d bound.
    let cases = [
        (minimise, "E", "x", "lower", 3.0, 5.0, 6.0),
        (minimise, "E", "x", "upper", -3.0, -5.0, -6.0),
        (maximise, "x", "E", "upper", 9.0, 1.0, 1.0 / 6.0),
        (minimise, "x", "E", "upper", 9.0, 1.0, -1.0 / 6.0),
        (maximise, "E", "x", "upper", 3.0, 1.0, 6.0),
    ];
    for (sense, objective, function, side, bound, start, expected) in cases {
        let objective = format!("{sense}\"{objective}\"");
        let bounds = if sense == maximise && function == "x" {
            (0.5, 9.0)
        } else {
            (-9.0, 9.0)
        };
        let optimum = solved(&objective, &limits(function, side, bound), bounds, start);
        let case = format!("{objective}, {function} {side} {bound}");
        let limit = &optimum.constraints["limit"];
        let error = (limit.multiplier - expected).abs();
        assert!(error < 1e-4 * expected.abs(), "{case}: {limit:?}");
        // L = ± f + y c: raising the bound by one changes the minimised objective by −y.
        let sign = if sense == minimise { -1.0 } else { 1.0 };
        let y = optimum.multipliers.constraints["limit"];
        assert!(
            (sign * y - expected).abs() < 1e-4 * expected.abs(),
            "{case}: {y}"
        );
        let text = summary(&optimum);
        let row = text.lines().find(|line| line.contains(" per "));
        let told = row
            .and_then(|row| row.split("  ").find(|cell| cell.contains(" per ")))
            .unwrap_or_default()
            .trim();
        let told: f64 = told
            .split(' ')
            .next()
            .and_then(|x| x.parse().ok())
            .expect("a number");
        assert!(
            (told - expected).abs() < 1e-3 * expected.abs(),
            "{case}: {text}"
        );
    }
    // With an inactive constraint: objective, bounds of v, start, side, multiplier, d objective / d
    // bound.
    let cases = [
        (maximise, "x", (-4.0, 4.0), BoundSide::Upper, 1.0),
        (minimise, "x", (-4.0, 4.0), BoundSide::Lower, 1.0),
        (minimise, "E", (2.0, 4.0), BoundSide::Lower, 4.0),
        (minimise, "E", (-4.0, -2.0), BoundSide::Upper, 4.0),
    ];
    for (sense, objective, bounds, side, expected) in cases {
        let objective = format!("{sense}\"{objective}\"");
        let start = 0.5 * (bounds.0 + bounds.1) + 0.1;
        let optimum = solved(&objective, &limits("x", "upper", 99.0), bounds, start);
        assert_eq!(optimum.active_bounds["v"], side, "{objective}");
        let (lower, upper) = (
            optimum.multipliers.lower_bounds["v"],
            optimum.multipliers.upper_bounds["v"],
        );
        let (force, other) = match side {
            BoundSide::Lower => (lower, upper),
            BoundSide::Upper => (upper, lower),
            BoundSide::Fixed => unreachable!("the bounds differ"),
        };
        assert!(
            (force - expected).abs() < 1e-4 * expected,
            "{objective}: {force}"
        );
        assert!((0.0..1e-4).contains(&other), "{objective}: {other}");
        assert!(optimum.constraints["limit"].multiplier.abs() < 1e-4);
    }
}

#[test]
fn an_optimum_agrees_with_itself() {
    let comparison = compare(&optimum(), &optimum(), &Tolerances::default());
    assert!(comparison.passed());
    let count = comparison.rows.len();
    assert_eq!(
        comparison.text(),
        format!("same optimum: {count} quantities within tolerance\n")
    );
}

/// Runs without an optimum, other units, bounds, multipliers of bounds, and gradients that were not confirmed.
#[test]
fn what_is_no_optimum_or_another_problem_is_a_difference() {
    type Change = fn(&mut Optimum);
    let cases: [(Change, &[(&str, &str)]); 9] = [
        (|o| o.status = "iteration_limit".into(), &[("status", "")]),
        (|o| o.status = "infeasible".into(), &[("status", "")]),
        (
            |o| o.objective.unit = Some("km".into()),
            &[("unit", "range")],
        ),
        (|o| o.design[0].unit = None, &[("unit", "counterweight")]),
        (
            |o| o.design[1].upper = Some(0.6),
            &[("upper bound", "angle")],
        ),
        (|o| o.design[1].lower = None, &[("lower bound", "angle")]),
        (
            |o| o.constraints[0].lower = Some(1e-3),
            &[("lower bound", "clear the barrier")],
        ),
        (
            |o| o.multipliers.upper_bounds[0] *= 1.01,
            &[("multiplier", "upper bound of counterweight")],
        ),
        (
            |o| o.gradient_certificate = certificate(false),
            &[("gradients", "certificate")],
        ),
    ];
    for (change, expected) in cases {
        let mut new = optimum();
        change(&mut new);
        for (a, b) in [(&new, &optimum()), (&optimum(), &new)] {
            let comparison = compare(a, b, &Tolerances::default());
            assert_eq!(moved(&comparison), expected);
        }
    }
    // Both at their limit.
    let mut limited = optimum();
    limited.status = "iteration_limit".into();
    let text = compare(&limited, &limited, &Tolerances::default()).text();
    let told =
        "no two optima: the new run ended as iteration_limit, the baseline as iteration_limit";
    assert!(text.starts_with(told), "{text}");
    // A certificate that only one of them has is noted.
    let mut certified = optimum();
    certified.gradient_certificate = certificate(true);
    let comparison = compare(&certified, &optimum(), &Tolerances::default());
    assert!(comparison.passed() && comparison.text().contains("note  gradients"));
}

fn certificate(passed: bool) -> Option<GradientCertificate> {
    Some(GradientCertificate {
        seed: 1,
        direction: Default::default(),
        tolerance: 1e-10,
        passed,
        start: Default::default(),
        optimum: Default::default(),
        cost: Default::default(),
    })
}

/// An objective that falls to zero is compared beside its start, not beside its last digits: 1e-6 of 1e-6 of it.
#[test]
fn objectives_of_zero_are_compared_by_their_own_scale() {
    for start in [1e-9, 1.0, 1e9] {
        let with = |value: f64| {
            let mut own = optimum();
            own.start_objective = Some(start);
            own.objective.value = value * start;
            own.objective.true_maximum = None;
            own.constraints[0].multiplier = 0.0;
            own.multipliers.upper_bounds[0] = 0.0;
            own
        };
        let same = |a: f64, b: f64| compare(&with(a), &with(b), &Tolerances::default()).passed();
        assert!(
            same(2e-15, 2e-20) && same(2e-20, 2e-15) && same(0.0, -1e-13),
            "{start}"
        );
        assert!(
            !same(2e-12, 0.0) && !same(0.0, 2e-12) && !same(1.0, 1.0 + 2e-6),
            "{start}"
        );
    }
}

#[test]
fn what_moved_is_told_and_what_is_within_tolerance_is_not() {
    let tolerances = Tolerances::default();
    let mut new = optimum();
    new.objective.value *= 1.0 + 0.9e-6;
    new.design[0].value -= 0.9e-4 * 200.0;
    new.constraints[0].value = 0.9e-5;
    new.counts.solves = 280_000;
    new.counts.iterations = 10;
    new.problem.sha256 = "cd".repeat(32);
    let comparison = compare(&new, &optimum(), &tolerances);
    assert!(comparison.passed());
    assert!(
        comparison.text().contains("note  work     iterations"),
        "{}",
        comparison.text()
    );
    let strict = Tolerances {
        same_problem: true,
        ..tolerances
    };
    assert_eq!(
        moved(&compare(&new, &optimum(), &strict)),
        [("problem", "sha256")]
    );

    new.status = "iteration limit".into();
    new.objective.value = optimum().objective.value * (1.0 - 1.1e-6);
    new.design[1].value += 1.1e-4 * 0.8;
    new.constraints[0].value = 1.1e-5;
    new.constraints[0].active = Activity::Inactive;
    new.constraints[0].multiplier = 0.0;
    new.active_bounds.clear();
    new.counts.solves = 290_000;
    let comparison = compare(&new, &optimum(), &tolerances);
    assert!(!comparison.passed());
    assert_eq!(
        moved(&comparison),
        [
            ("status", ""),
            ("objective", "value"),
            ("design", "angle"),
            ("constraint", "clear the barrier"),
            ("active", "clear the barrier"),
            ("sensitivity", "clear the barrier"),
            ("active", "counterweight"),
            ("work", "solves"),
        ]
    );
}

#[test]
fn missing_and_extra_names_and_nan_are_differences() {
    let mut new = optimum();
    new.design.shift_remove("angle");
    new.design
        .insert("length".into(), optimum().design[0].clone());
    new.constraints.clear();
    new.objective.true_maximum = None;
    new.start_objective = Some(f64::NAN);
    let comparison = compare(&new, &optimum(), &Tolerances::default());
    assert_eq!(
        moved(&comparison),
        [
            ("objective", "at the start"),
            ("objective", "true maximum"),
            ("design", "length"),
            ("design", "angle"),
            ("constraint", "clear the barrier"),
        ]
    );
    assert!(comparison.text().contains("missing"));
}

#[test]
fn summary_tells_what_changed_and_what_is_active() {
    let expected = "\
trebuchet: Converged to the tolerance 1e-6.

Maximised range: 546.507 → 849.8985 m (+55.5 %)
  the true maximum is 867.7 m, the aggregate differs from it by -17.8 m
  accurate to about 0.003 m (estimated error of steps and samples)

  variable       start      optimum  unit  bounds      active
  counterweight    400          500  kg    300 … 500   at its upper bound
  angle              0  -0.0071602468  rad   -0.3 … 0.5
";
    let text = summary(&optimum());
    for line in expected
        .lines()
        .filter(|line| !line.starts_with("  variable"))
    {
        let squeezed = line.split_whitespace().collect::<Vec<_>>().join(" ");
        let found = text
            .lines()
            .any(|l| l.split_whitespace().collect::<Vec<_>>().join(" ") == squeezed);
        assert!(found, "{line}\n---\n{text}");
    }
    assert!(text.contains("-3.5014 m per m"), "{text}");
    assert!(text.contains("25 simulations (1 failed)"), "{text}");
    assert!(text.contains("Warning: the aggregate is coarse"), "{text}");
}

/// The summary reports an upper bound that the aggregate satisfies and the true maximum violates.
#[test]
fn summary_tells_the_true_maximum_behind_an_aggregate() {
    let mut optimum = optimum();
    let constraint = &mut optimum.constraints[0];
    (constraint.value, constraint.lower, constraint.upper) = (0.9, None, Some(0.9));
    let mut aggregate = Aggregate {
        lies: Lies::Below,
        true_maximum: 0.90644,
        time: Some(0.25),
        place: None,
        error: 1e-9,
        ungated: None,
    };
    constraint.aggregate = Some(aggregate.clone());
    let back = Optimum::from_json(&optimum.to_json().expect("finite")).expect("is a record");
    assert_eq!(back, optimum);
    let text = summary(&optimum);
    assert!(
        text.contains("clear the barrier: the true maximum is 0.90644 m"),
        "{text}"
    );
    assert!(
        text.contains("above the upper bound by 0.00644 m"),
        "{text}"
    );
    aggregate.true_maximum = 0.89;
    aggregate.ungated = Some(0.895);
    optimum.constraints[0].aggregate = Some(aggregate);
    let text = summary(&optimum);
    assert!(!text.contains("above the upper bound"), "{text}");
    assert!(text.contains("without it 0.895 m"), "{text}");
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let directory = tempfile::tempdir().expect("is valid");
    let path = directory.path().join("a.txt");
    atomic_write(&path, b"first").expect("is valid");
    atomic_write(&path, b"second").expect("is valid");
    assert_eq!(read_text(&path).expect("is valid"), "second");

    // The second file of the group cannot be written, so the first one is not changed.
    let blocked = directory.path().join("blocked");
    std::fs::create_dir(&blocked).expect("is valid");
    let group = [
        (path.clone(), b"third".to_vec()),
        (blocked.clone(), b"x".to_vec()),
    ];
    let error = write_all(&group).expect_err("must be refused").to_string();
    assert!(
        error.starts_with(&format!("cannot write {}: ", blocked.display())),
        "{error}"
    );
    assert_eq!(read_text(&path).expect("is valid"), "second");
    let left: Vec<_> = std::fs::read_dir(directory.path())
        .expect("is valid")
        .collect();
    assert_eq!(left.len(), 2, "no temporary file is left: {left:?}");
}

#[test]
fn a_directory_that_cannot_take_a_file_is_named() {
    let directory = tempfile::tempdir().expect("is valid");
    let file = directory.path().join("file");
    atomic_write(&file, b"x").expect("is valid");
    let inside = file.join("inside.txt");
    let error = atomic_write(&inside, b"y")
        .expect_err("must be refused")
        .to_string();
    assert!(
        error.starts_with(&format!("cannot write {}: ", inside.display())),
        "{error}"
    );
    let error = write_all(&[(inside, b"y".to_vec())])
        .expect_err("must be refused")
        .to_string();
    assert!(
        error.starts_with(&format!("cannot write {}: ", file.display())),
        "{error}"
    );
    let error = read_text(&directory.path().join("none")).expect_err("must be refused");
    assert!(matches!(error, ReportError::Read { .. }));
}
