//! Loops whose numbers are rounded, as those of CAD: rows that would lock them follow from the others within
//! the tolerance of the input, are left out, and are said with their misfit. The motion is that of the exact
//! numbers up to the rounding.

use crate::reference::documents::{benchmark, problem};

use flexbody_driver::{check, simulate};
use flexbody_problem::Problem;
use serde_json::Value;

fn rounded(x: f64, unit: f64) -> f64 {
    (x / unit).round() * unit
}

/// Misfits of the joints with redundant rows.
fn misfits(problem: &Problem) -> Vec<f64> {
    let all = problem.redundant.iter();
    all.filter_map(|own| own.misfit.map(|own| own[0])).collect()
}

fn refusal(file: &Value) -> String {
    match Problem::parse(&file.to_string(), "rounded.json", &[]) {
        Ok(_) => String::new(),
        Err(faults) => faults.to_string(),
    }
}

const CRANK: f64 = 0.3;
const ROD: f64 = 0.854_400_374_531_753_2;
const ROCKER: f64 = 0.608_276_253_029_821_9;
const GROUND: f64 = 0.9;

/// A four-bar linkage, its crank at the angle `phi`: the angle of the rocker from its foot at (0.9, 0), by the
/// intersection of two circles.
fn rocker_angle(phi: f64) -> f64 {
    let (x, y) = (CRANK * phi.cos() - GROUND, CRANK * phi.sin());
    let d = x.hypot(y);
    let inside = (d * d + ROCKER * ROCKER - ROD * ROD) / (2.0 * d * ROCKER);
    y.atan2(x) - inside.acos()
}

/// The linkage about z with its crank upright, whose joints have axes off by `tilts` and places off by
/// `shifts` across the plane.
fn four_bar(tilts: [f64; 4], shifts: [f64; 4], driven: bool) -> Value {
    let bar = |length: f64, at: [f64; 2], angle: f64| {
        json!({"shape": {"box": {"size": [length, 0.03, 0.03]}}, "mass": 1,
               "place": {"at": [at[0], at[1], 0], "turn": {"axis": [0, 0, 1], "angle": angle}}})
    };
    let hinge = |i: usize, a: &str, b: &str, at: [f64; 2]| {
        json!({"revolute": {"between": [a, b], "axis": [0.3 * tilts[i], tilts[i], 1],
                            "at": [at[0], at[1], shifts[i]]}})
    };
    let mut file = json!({
        "version": 1, "name": "four bar",
        "bodies": {
            "crank": bar(0.3, [0.0, 0.15], std::f64::consts::FRAC_PI_2),
            "coupler": bar(ROD, [0.4, 0.45], 0.6_f64.atan2(1.6)),
            "rocker": bar(ROCKER, [0.85, 0.3], 0.6_f64.atan2(-0.1))
        },
        "joints": {
            "A": hinge(0, "crank", "ground", [0.0, 0.0]), "B": hinge(1, "coupler", "crank", [0.0, 0.3]),
            "C": hinge(2, "rocker", "coupler", [0.8, 0.6]), "D": hinge(3, "rocker", "ground", [0.9, 0.0])
        },
        "simulation": {"duration": 1},
        "functions": {
            "crank": {"final": {"angle": {"joint": "A"}}},
            "rocker": {"final": {"angle": {"joint": "D"}}},
            "force": {"final": {"joint_force": {"joint": "A", "direction": [1, 0, 0]}}}
        }
    });
    match driven {
        true => file["drives"] = json!({"motor": {"joint": "A", "turn": {"rate": 5}}}),
        false => file["joints"]["A"]["revolute"]["start"] = json!({"turn": {"rate": 5}}),
    }
    file
}

/// Axes off by up to 8e-6 rad, in one joint or in all, driven or not: the rocker follows the closed form to the
/// size of the rounding.
#[test]
fn a_four_bar_linkage_with_rounded_axes_moves_as_the_exact_one() {
    for (tilts, driven) in [
        ([0.0, 0.0, 8e-6, 0.0], true),
        ([0.0, 3.7e-6, 0.0, 0.0], true),
        ([2e-6, -1e-6, 3e-6, 1e-6], true),
        ([0.0, 0.0, 0.0, 1e-8], true),
        ([0.0, 0.0, 2e-6, 0.0], false),
        ([1e-9, 0.0, 0.0, -4e-6], false),
    ] {
        let problem = problem(&four_bar(tilts, [0.0; 4], driven));
        let most = misfits(&problem).into_iter().fold(0.0, f64::max);
        assert!(most > 0.0 && most <= 1e-5, "{tilts:?}: {most:e}");
        let at = simulate(&problem, &problem.start()).expect("runs").at;
        let turned = at.function(0).value;
        if driven {
            assert!((turned - 5.0).abs() < 1e-9, "{tilts:?}: {turned}");
        }
        let start = std::f64::consts::FRAC_PI_2;
        let right = rocker_angle(start + turned) - rocker_angle(start);
        let off = (at.function(1).value - right).rem_euclid(std::f64::consts::TAU);
        let off = off.min(std::f64::consts::TAU - off);
        assert!(off < 3e-5, "{tilts:?}: {off:e}");
        let said = problem.notes_of_input().join("\n");
        assert!(said.contains("\"input_tolerance\" 1e-5"), "{said}");
    }
}

/// The tolerance is that of the file: a larger error is refused, a smaller tolerance refuses the same file, and
/// a larger one admits it.
#[test]
fn what_does_not_fit_within_the_tolerance_is_refused() {
    let mut file = four_bar([0.0, 0.0, 1e-4, 0.0], [0.0; 4], true);
    assert!(
        refusal(&file).contains("/drives/motor"),
        "{}",
        refusal(&file)
    );
    file["input_tolerance"] = json!(1e-3);
    assert_eq!(refusal(&file), "");
    let mut file = four_bar([0.0, 0.0, 3.7e-6, 0.0], [0.0; 4], true);
    assert_eq!(refusal(&file), "");
    file["input_tolerance"] = json!(1e-7);
    assert!(!refusal(&file).is_empty());
    file["input_tolerance"] = json!(0.1);
    assert!(refusal(&file).contains("/input_tolerance"));
}

/// Rows that follow exactly stay what they are: nothing is said of a tolerance.
#[test]
fn exact_loops_have_no_misfit() {
    let exact = [
        four_bar([0.0; 4], [0.0; 4], true),
        four_bar([0.0; 4], [0.0; 4], false),
    ];
    let benchmarks = ["four_bars_1", "bricard"].map(benchmark);
    for file in exact.iter().chain(&benchmarks) {
        let problem = problem(file);
        assert!(!problem.redundant.is_empty(), "{}", problem.name);
        assert!(misfits(&problem).is_empty(), "{}", problem.name);
        let mut strict = file.clone();
        strict["input_tolerance"] = json!(1e-13);
        let strict = self::problem(&strict);
        assert_eq!(strict.redundant, problem.redundant, "{}", problem.name);
    }
}

/// A door on hinges that are off its line by `off`, along x.
fn door(heights: &[f64], off: f64) -> Value {
    let hinge = |(i, y): (usize, &f64)| {
        let x = off * [0.0, 1.0, -0.6][i];
        (
            format!("hinge {i}"),
            json!({"revolute": {"between": ["door", "ground"], "at": [x, y, 0], "axis": [0.5 * x, 1, 0]}}),
        )
    };
    json!({
        "version": 1, "name": "door",
        "bodies": {"door": {"shape": {"box": {"size": [1, 2, 0.04]}}, "mass": 30, "place": {"at": [0.5, 0, 0]},
                            "velocity": {"linear": [0, 0, -1], "angular": [0, 2, 0]}}},
        "joints": heights.iter().enumerate().map(hinge).collect::<serde_json::Map<_, _>>(),
        "loads": {"closer": {"force": {"body": "door", "direction": [0, 0, 1], "axes": "body", "magnitude": 3}}},
        "simulation": {"duration": 0.5, "steps": 50},
        "functions": {"turn": {"final": {"rotation": {"body": "door", "axis": [0, 1, 0]}}}},
        "variables": {"mass": {"path": "/bodies/door/mass", "lower": 1}}
    })
}

/// A door whose hinges are off one line by micrometres turns as on one hinge, and its derivatives are exact.
#[test]
fn a_door_on_hinges_off_one_line_turns_as_on_one() {
    let one = problem(&door(&[-0.8], 0.0));
    let right = simulate(&one, &one.start())
        .expect("runs")
        .at
        .function(0)
        .value;
    for (heights, off) in [
        (vec![-0.8, 0.8], 1e-7),
        (vec![-0.8, 0.8], 4e-6),
        (vec![-0.8, 0.8, 0.1], 1e-9),
        (vec![-0.8, 0.8, 0.1], 3e-6),
    ] {
        let problem = problem(&door(&heights, off));
        assert!(!misfits(&problem).is_empty(), "{off:e}");
        let found = simulate(&problem, &problem.start())
            .expect("runs")
            .at
            .function(0)
            .value;
        assert!(
            (found - right).abs() < 20.0 * off,
            "{off:e}: {found} {right}"
        );
        for derivative in check(&problem, &problem.start()).expect("runs") {
            assert!(derivative.relative_difference() <= 1e-10, "{derivative:?}");
        }
    }
}

/// A platform on three parallel bars of one length, whose lengths and places are rounded: a planar scene that is
/// lowered. It moves as on two bars, and does not turn.
#[test]
fn a_platform_on_three_rounded_bars_moves_as_on_two() {
    let (length, angle) = (0.7, 1.0_f64);
    let on = |bars: usize, unit: f64| {
        let at = |x: f64| rounded(x, unit);
        let end = [length * angle.cos(), length * angle.sin()];
        let mut bodies = json!({"platform": {"shape": {"box": {"size": [2, 0.1, 0.1]}}, "mass": 3,
            "place": {"at": [1.0 + end[0], end[1], 0]}}});
        let mut joints = json!({});
        for i in 0..bars {
            let x = [0.0, 2.0, 0.9][i];
            let extra = if i == 2 { 0.4 * unit } else { 0.0 };
            bodies[format!("bar {i}")] = json!({"shape": {"box": {"size": [length, 0.05, 0.05]}}, "mass": 0.5,
                "place": {"at": [x + 0.5 * end[0], 0.5 * end[1], 0], "turn": {"axis": [0, 0, 1], "angle": angle}}});
            joints[format!("foot {i}")] = json!({"revolute": {"between": [format!("bar {i}"), "ground"],
                "at": [x, 0, 0], "axis": [0, 0, 1]}});
            joints[format!("head {i}")] = json!({"revolute": {"between": ["platform", format!("bar {i}")],
                "at": [at(x + end[0]) + extra, at(end[1]), 0], "axis": [0, 0, 1]}});
        }
        problem(&json!({
            "version": 1, "name": "platform", "bodies": bodies, "joints": joints,
            "simulation": {"duration": 0.4, "steps": 40},
            "functions": {"x": {"final": {"position": {"body": "platform", "direction": [1, 0, 0]}}},
                          "turn": {"final": {"rotation": {"body": "platform", "axis": [0, 0, 1]}}}}
        }))
    };
    for unit in [1e-7, 1e-6] {
        let three = on(3, unit);
        assert!(!misfits(&three).is_empty(), "{unit:e}");
        let at = simulate(&three, &three.start()).expect("runs").at;
        assert!(at.function(1).value.abs() < 10.0 * unit, "{unit:e}");
        let exact = on(3, 1e-15);
        let other = simulate(&exact, &exact.start()).expect("runs").at;
        let off = (at.function(0).value - other.function(0).value).abs();
        assert!(off < 20.0 * unit, "{unit:e}: {off:e}");
    }
}

/// Bennett's linkage, by lengths a = 0.22 and b = 0.11 on twists of 60 and 25.66 degrees: joint by joint its
/// points and axes with `digits` digits. Opposite joints turn by the same angle.
fn bennett(digits: i32) -> Value {
    let unit = 10_f64.powi(-digits);
    let vector = |x: [f64; 3]| json!(x.map(|x| rounded(x, unit)));
    let points = [
        [0.0, 0.0, 0.0],
        [0.168_265_281_2, 0.141_727_891_2, 0.0],
        [0.099_214_878_3, 0.061_328_394_3, -0.029_461_207_7],
        [-0.11, 0.0, 0.0],
    ];
    let axes = [
        [0.0, 0.0, 1.0],
        [0.557_908_882_7, -0.662_372_764_1, 0.5],
        [0.267_829_160_6, -0.525_849_612_7, 0.807_310_179_2],
        [0.0, 0.433_012_701_9, 0.901_387_818_9],
    ];
    let bodies = ["ground", "link 1", "link 2", "link 3"];
    let mut file = json!({
        "version": 1, "name": "bennett", "gravity": [0, -9.81, 0], "bodies": {}, "joints": {},
        "simulation": {"duration": 0.5}, "functions": {}
    });
    for i in 0..4 {
        let (own, next) = (points[i], points[(i + 1) % 4]);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (own[k] + next[k]));
        if i > 0 {
            file["bodies"][bodies[i]] = json!({"mass": 0.1 * i as f64,
                "inertia": {"xx": 1e-4, "yy": 2e-4, "zz": 2e-4}, "place": {"at": vector(middle)}});
        }
        // Joint i is between the links i − 1 and i.
        let between = [bodies[i], bodies[(i + 3) % 4]];
        file["joints"][format!("j{i}")] =
            json!({"revolute": {"between": between, "at": vector(own), "axis": vector(axes[i])}});
        file["functions"][format!("a{i}")] =
            json!({"final": {"angle": {"joint": format!("j{i}")}}});
    }
    file["joints"]["j1"]["revolute"]["start"] = json!({"turn": {"rate": 3}});
    file
}

#[test]
fn bennetts_linkage_moves_with_few_digits() {
    for digits in [9, 8, 7, 6] {
        let mut file = bennett(digits);
        file["simulation"]["duration"] = json!(if digits == 6 { 1.0 } else { 0.5 });
        let problem = problem(&file);
        assert_eq!(
            problem
                .redundant
                .iter()
                .map(|own| own.left_out)
                .sum::<usize>(),
            3
        );
        assert!(!misfits(&problem).is_empty());
        let at = simulate(&problem, &problem.start()).expect("runs").at;
        let angles: Vec<f64> = (0..4).map(|i| at.function(i).value.abs()).collect();
        let limit = 100.0 * 10_f64.powi(-digits);
        assert!(angles[0] > 0.3, "{angles:?}");
        for i in 0..2 {
            let off = (angles[i] - angles[i + 2]).abs();
            assert!(off < limit, "{digits} digits: {angles:?}");
        }
    }
}

/// Inertias that miss those of a solid by their rounding are used, and said; by more they are refused.
#[test]
fn rounded_inertias_are_used_and_said() {
    let top = |zz: f64, tolerance: Option<f64>| {
        let mut file = json!({
            "version": 1, "name": "top",
            "bodies": {"top": {"mass": 1, "inertia": {"xx": 0.3, "yy": 0.7, "zz": zz}}},
            "joints": {"ball": {"spherical": {"between": ["top", "ground"], "at": [0, 0.1, 0]}}},
            "simulation": {"duration": 0.1, "steps": 10},
            "functions": {"turn": {"final": {"rotation": {"body": "top", "axis": [0, 0, 1]}}}}
        });
        if let Some(tolerance) = tolerance {
            file["input_tolerance"] = json!(tolerance);
        }
        file
    };
    for (zz, tolerance, sound, said) in [
        (1.0, None, true, false),
        (1.0 + 3e-9, None, true, true),
        (1.0 + 9e-6, None, true, true),
        (1.0 + 2e-5, None, false, false),
        (1.0 + 3e-9, Some(1e-10), false, false),
        (1.0 + 5e-4, Some(1e-3), true, true),
    ] {
        let file = top(zz, tolerance);
        let told = refusal(&file);
        assert_eq!(told.is_empty(), sound, "{zz}: {told}");
        if sound {
            let problem = problem(&file);
            let notes = problem.notes_of_input().join("\n");
            assert_eq!(
                notes.contains("principal moment of inertia is above"),
                said,
                "{zz}: {notes}"
            );
            assert!(simulate(&problem, &problem.start()).is_ok());
        } else {
            assert!(
                told.contains("/bodies/top/inertia") && told.contains("input_tolerance"),
                "{told}"
            );
        }
    }
}
