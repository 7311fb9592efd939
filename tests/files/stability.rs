//! The stability suite: a fast part is run and compared with the committed table. The table
//! satisfies the claims of `docs/stability.md`.

use flexbody_driver::stability::{names, stability};
use flexbody_problem::Problem;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Largest difference of a derivative by the adjoint from the complex step, relative to the largest
/// derivative of the scene.
const GRADIENT: f64 = 1e-10;

/// Cases with a larger difference by round-off, and its bound; `docs/stability.md` gives the
/// reasons.
const SPOILT: [(&str, f64); 30] = [
    // ε k l / (m g): the force of a spring of l = 1 m has the round-off ε k l.
    ("stiffness/10/", 2.3e-9),
    ("stiffness/100/", 2.3e-7),
    ("stiffness/1e3/", 2.3e-5),
    ("stiffness/1e4/", 2.3e-3),
    ("stiffness/1e5/", 2.3e-1),
    // No bound is known for these.
    ("stiffness/1e6/", f64::INFINITY),
    // The direction of the line between two ball joints at this distance.
    ("hinge-distance/1e-2/", 1e-9),
    ("hinge-distance/1e-4/", 1e-6),
    ("hinge-distance/1e-5/", 1e-8),
    ("hinge-distance/1e-6/", 1e-7),
    ("hinge-distance/1e-7/", 1e-7),
    // A singular position at 1e-4 of the length.
    ("locking/2.0999/", 1e-9),
    // Ends and steps at this distance from a singular position, where round-off matters; `optimize
    // check` estimates it.
    ("passage/1e-4 before the first/radau", 1e-5),
    ("passage/1e-3 before the first/radau", 1e-7),
    ("passage/1e-2 before the first/radau", 1e-9),
    ("passage/1e-4 after the first/radau", 1e-5),
    ("passage/1e-2 after the first/radau", 1e-8),
    ("tolerance/2 to 1e-5/", 1e-8),
    ("tolerance/2 to 1e-6/", 1e-9),
    // Stretch of thin shells is stiffer than their bending by the square of length by thickness; plates under loads
    // have 1/100. These start in equilibrium.
    ("thickness/1e-4/", 1e-8),
    ("thickness/1e-3/", 1e-9),
    ("thickness/1e-2/", 1e-9),
    ("load/", 1e-9),
    ("bend/", 1e-9),
    ("cover/", 1e-9),
    // The same round-off over thousands of steps: 5e-12 after 10 s, 3e-9 after 100 s.
    ("shell-undamped/100/", 1e-8),
    // Of a plate of 1/100 thickness; near the load at which it buckles and beyond it errors grow with the deflection.
    ("shell-buckling/", 1e-8),
    // Near the speed at which the stretch has no bound, and beyond it. At 1.3 the round-off of the motion moves
    // derivatives by 1.7e-8.
    ("spin/1.3/", 2e-8),
    ("spin/1.5/", 1e-7),
    ("spin/3/", 1e-9),
];

fn gradient_bound(case: &str) -> f64 {
    let spoilt = SPOILT.iter().find(|(name, _)| case.starts_with(name));
    spoilt.map_or(GRADIENT, |(_, bound)| *bound)
}

/// Whether an error is above its bound, or NaN.
fn is_large(error: f64, bound: f64) -> bool {
    error.is_nan() || error > bound
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A row of the committed table.
struct Committed {
    case: String,
    scene: String,
    outcome: String,
    gradient_error: Option<f64>,
    no_gradient: bool,
}

/// The committed rows. No field up to the error of the gradient contains a comma.
fn committed() -> Vec<Committed> {
    let path = root().join("results/stability/stability.csv");
    let text = std::fs::read_to_string(path).expect("a committed table");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| {
        let at = header.iter().position(|own| *own == name);
        at.unwrap_or_else(|| panic!("no column {name}"))
    };
    let [case, scene, outcome, gradient, none] =
        ["case", "scene", "outcome", "gradient_error", "no_gradient"].map(column);
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        Committed {
            case: fields[case].into(),
            scene: fields[scene].into(),
            outcome: fields[outcome].into(),
            gradient_error: fields[gradient].parse().ok(),
            no_gradient: !fields[none].is_empty(),
        }
    };
    lines.map(row).collect()
}

/// The part of the suite that is fast enough for a test: the default method, all methods if cheap,
/// and all optimisations.
fn is_fast(case: &str) -> bool {
    let families = [
        "damping/",
        "optimum/",
        "rho/",
        "speed/1e6",
        "thickness/1e-2/",
        "load/0.1/",
        "chain/10/bdf",
        "bend/0.1/",
        "cover/3/",
        "across/1.1/",
        "sideways/1e-2/",
        "shell-elasticity/1e12/",
        "shell-undamped/1/",
        "shell-spin/0.1/bdf",
        "shell-buckling/0.9/",
        "shell-chain/10/bdf",
    ];
    case.contains("/chosen to") || families.iter().any(|family| case.starts_with(family))
}

fn fast() -> Vec<String> {
    let all: Vec<String> = names(true)
        .into_iter()
        .filter(|case| is_fast(case))
        .collect();
    assert!(all.len() > 100, "{}", all.len());
    all
}

/// The first case of every family, and a sample of the others.
#[test]
fn few_extreme_scenes_of_every_family_are_not_wrong_without_a_word() {
    let mut families = BTreeSet::new();
    // Of shells in motion the method with the cheapest steps.
    let is_cheap = |case: &String| !case.starts_with("shell-") || case.contains("/bdf");
    let all = fast().into_iter().filter(is_cheap).enumerate();
    let some = all.filter(|(k, case)| {
        let family = case.split('/').next().unwrap_or_default().to_owned();
        families.insert(family) || k % 20 == 0
    });
    let some: BTreeSet<String> = some.map(|(_, case)| case).collect();
    assert!(some.len() > 20, "{}", some.len());
    are_told(&some);
}

#[test]
#[ignore = "three minutes of one core"]
fn no_extreme_scene_is_wrong_without_a_word() {
    are_told(&fast().into_iter().collect());
}

/// These cases end as the committed table says, within its bounds.
fn are_told(fast: &BTreeSet<String>) {
    let expected: BTreeMap<String, String> = committed()
        .into_iter()
        .map(|row| (row.case, row.outcome))
        .collect();
    let table = stability(|case| fast.contains(case), 300.0, &|_| {});
    assert_eq!(table.rows.len(), fast.len());
    let mut wrong = Vec::new();
    for row in &table.rows {
        let (name, class) = (row.name(), row.outcome.class());
        if row.outcome.is_failure() {
            wrong.push(format!("{name}: {class}, error {:?}", row.error));
        }
        if expected.get(&name).map(String::as_str) != Some(class) {
            wrong.push(format!(
                "{name}: {class}, in the table {:?}",
                expected.get(&name)
            ));
        }
        if row
            .gradient_error
            .is_some_and(|error| is_large(error, gradient_bound(&name)))
        {
            wrong.push(format!("{name}: gradient {:?}", row.gradient_error));
        }
        if class == "accurate" && row.error.is_none_or(|error| is_large(error, row.bound)) {
            wrong.push(format!("{name}: accurate without a judge"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn the_committed_table_is_whole_and_has_no_silent_error() {
    let rows = committed();
    let cases: Vec<&str> = rows.iter().map(|row| row.case.as_str()).collect();
    assert_eq!(cases, names(false));
    let mut wrong = Vec::new();
    for row in &rows {
        if !["accurate", "degraded", "refused"].contains(&row.outcome.as_str()) {
            wrong.push(format!("{}: {}", row.case, row.outcome));
        }
        let bound = gradient_bound(&row.case);
        if row
            .gradient_error
            .is_some_and(|error| is_large(error, bound))
        {
            wrong.push(format!("{}: gradient {:?}", row.case, row.gradient_error));
        }
        let motion = row.outcome == "accurate" && !row.case.starts_with("optimum/");
        if motion && row.gradient_error.is_none() && !row.no_gradient {
            wrong.push(format!("{}: no gradient, and no reason", row.case));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_scene_is_a_problem_file_that_a_case_uses() {
    let mut used: BTreeSet<String> = committed().into_iter().map(|row| row.scene).collect();
    used.retain(|name| !root().join("problems/benchmarks").join(name).is_file());
    let folder = root().join("problems/extreme");
    let there: BTreeSet<String> = std::fs::read_dir(&folder)
        .expect("scenes")
        .map(|entry| entry.expect("a file").file_name().to_string_lossy().into())
        .collect();
    assert_eq!(there, used);
    for name in &there {
        let problem = Problem::load(&folder.join(name), &[]).unwrap_or_else(|f| panic!("{f}"));
        assert_eq!(format!("{}.json", problem.name), *name);
    }
}
