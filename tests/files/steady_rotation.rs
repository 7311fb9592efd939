//! Modes of machines that turn steadily: closed forms of whirl, rotating beams and governors, critical speeds, derivatives,
//! and what cannot turn.

use super::damped_modes::pairs;
use super::machines_at_rest::{fault, rod};
use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::{gradients_are_exact, gradients_are_slopes};
use flexbody_driver::check;
use flexbody_mechanics::system::equilibrium::Whirl;
use flexbody_problem::Problem;
use nalgebra::DMatrix;
use serde_json::Value;
use std::f64::consts::PI;

pub fn assert_near(found: &[f64], expected: &[f64], part: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= part * e.abs(), "{found:?} {expected:?}");
    }
}

/// Exact derivatives, and those of differences of values.
fn derivatives_are_right(file: &Value, context: &Value) {
    gradients_are_exact(&parsed(file), context);
    derivatives_are_slopes(file, context);
}

fn derivatives_are_slopes(file: &Value, context: &Value) {
    gradients_are_slopes(&parsed(file), 1e-2, context);
}

/// Two carts on a table that turns: one slides along x, and on it another along y.
pub fn table(stiffness: [f64; 2], damping: [f64; 2], masses: [f64; 2], speed: f64) -> Value {
    let cart = |mass: f64| json!({"shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": mass});
    let rail = |a: &str, b: &str, axis: [f64; 3]| json!({"prismatic": {"between": [a, b], "at": [0, 0, 0], "axis": axis}});
    let spring = |a: &str, b: &str, end: [f64; 3], k: usize| {
        json!({"spring": {
            "between": [a, b], "at": {"a": [0, 0, 0], "b": end}, "rest_length": 1,
            "stiffness": stiffness[k], "damping": damping[k]
        }})
    };
    json!({
        "version": 1, "name": "table", "analysis": "modes",
        "gravity": [0, 0, -9.81],
        "turning": {"axis": [0, 0, 2], "speed": speed},
        "bodies": {"table": cart(3.0), "one": cart(masses[0]), "two": cart(masses[1])},
        "joints": {
            "axle": {"revolute": {"between": ["table", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}},
            "first": rail("one", "table", [1.0, 0.0, 0.0]), "second": rail("two", "one", [0.0, 1.0, 0.0])
        },
        "drives": {"motor": {"joint": "axle", "turn": {"rate": 3}}},
        "loads": {"along": spring("one", "table", [1.0, 0.0, 0.0], 0), "across": spring("two", "one", [0.0, 1.0, 0.0], 1)},
        "functions": {
            "f1": {"frequency": {"mode": 1}}, "z1": {"damping_ratio": {"mode": 1}},
            "f2": {"frequency": {"mode": 2}}, "z2": {"damping_ratio": {"mode": 2}}
        },
        "variables": {
            "speed": {"path": "/turning/speed", "lower": 1, "upper": 100},
            "stiffness": {"path": "/loads/along/spring/stiffness", "lower": 1, "upper": 1e4},
            "damping": {"path": "/loads/across/spring/damping", "lower": 0, "upper": 1e2},
            "mass": {"path": "/bodies/two/mass", "lower": 0.1, "upper": 10}
        }
    })
}

/// With the masses m and n: (m + n) ẍ − 2 n Ω ẏ + c ẋ + (k − (m + n) Ω²) x = 0, and so across. Gyroscopic forces hold carts
/// that centrifugal ones would throw off.
#[test]
fn carts_on_a_table_feel_centrifugal_and_gyroscopic_forces() {
    for (stiffness, damping, masses, speed) in [
        ([300.0, 170.0], [0.0, 0.0], [0.5, 2.0], 5.0),
        ([300.0, 170.0], [2.0, 5.0], [0.5, 2.0], 5.0),
        ([40.0, 30.0], [0.2, 0.1], [0.01, 2.0], 12.0),
    ] {
        let [c, d] = damping;
        let spun = masses[1] * speed;
        let mass = DMatrix::from_row_slice(2, 2, &[masses[0] + masses[1], 0.0, 0.0, masses[1]]);
        let rate = DMatrix::from_row_slice(2, 2, &[c, -2.0 * spun, 2.0 * spun, d]);
        let held = DMatrix::from_row_slice(2, 2, &[stiffness[0], 0.0, 0.0, stiffness[1]]);
        let expected = pairs(&mass, &rate, &(held - &mass * speed * speed));
        let file = table(stiffness, damping, masses, speed);
        let found = values(&file);
        if c == 0.0 {
            for (k, own) in expected.iter().enumerate() {
                assert_near(&[found[2 * k]], &[own[0]], 1e-10);
                assert!(found[2 * k + 1].abs() < 1e-10, "{found:?}");
            }
        } else {
            assert_near(&found, &expected.concat(), 1e-10);
            derivatives_are_right(&file, &json!(speed));
        }
    }
}

/// A rod of length L in a hinge on a vertical axis that turns. With the moments of inertia I about the hinge and A about its own
/// axis it hangs at (I − A) Ω² cos θ = m g L / 2 and swings with I ω² = (I − A) Ω² sin² θ, if a drive keeps the speed; else its
/// swings change the speed of the hub of inertia J, as the angular momentum stays.
fn governor(driven: bool, turned: bool) -> Value {
    let (axis, hinge, gravity) = match turned {
        false => ([0, 1, 0], [0, 0, 1], [0.0, -9.81, 0.0]),
        true => ([0, 0, 1], [0, -1, 0], [0.0, 0.0, -9.81]),
    };
    let placed = match turned {
        false => json!({"axis": [0, 0, 1], "angle": -0.4}),
        true => json!([{"axis": [0, 0, 1], "angle": -0.4}, {"axis": [1, 0, 0], "angle": PI / 2.0}]),
    };
    let hub = json!({"mass": 1, "inertia": {"xx": 0.3, "yy": 0.3, "zz": 0.3}});
    let mut file = json!({
        "version": 1, "name": "governor", "analysis": "modes", "gravity": gravity,
        "turning": {"axis": axis, "at": [0, 0, 0], "speed": 6},
        "bodies": {"hub": hub, "arm": rod(0.8, 2.0, json!({"put": "a", "at": [0, 0, 0], "turn": placed}))},
        "joints": {
            "axle": {"revolute": {"between": ["hub", "ground"], "at": [0, 0, 0], "axis": axis}},
            "hinge": {"revolute": {"between": ["arm", "hub"], "at": [0, 0, 0], "axis": hinge}}
        },
        "drives": {"motor": {"joint": "axle", "turn": {"rate": 6}}},
        "functions": {"f": {"frequency": {"mode": 1}}},
        "variables": {
            "speed": {"path": "/turning/speed", "lower": 5, "upper": 10},
            "mass": {"path": "/bodies/arm/mass", "lower": 1, "upper": 5}
        }
    });
    if !driven {
        file.as_object_mut().expect("an object").remove("drives");
    }
    file
}

#[test]
fn a_governor_swings_about_its_relative_equilibrium() {
    let (mass, length, speed, hub) = (2.0, 0.8, 6.0_f64, 0.3);
    let about = mass * (length * length / 3.0 + 1e-4 / 4.0);
    let own = mass * 1e-4 / 2.0;
    let pull = mass * 9.81 * length / 2.0;
    let cosine = pull / ((about - own) * speed * speed);
    let sine = (1.0 - cosine * cosine).sqrt();
    let driven = (about - own) / about * (speed * sine).powi(2);
    let whole = hub + about * sine * sine + own * cosine * cosine;
    let double = 2.0 * sine * cosine;
    let free = (-speed.powi(2) * (about - own) * (cosine * cosine - sine * sine)
        + (speed * (about - own) * double).powi(2) / whole
        + pull * cosine)
        / about;
    for turned in [false, true] {
        for (is_driven, square) in [(true, driven), (false, free)] {
            let file = governor(is_driven, turned);
            assert_near(&values(&file), &[square.sqrt() / (2.0 * PI)], 1e-10);
            // A free spin magnifies round-off of the rest beyond that of the comparison with the complex step.
            match is_driven {
                true => derivatives_are_right(&file, &json!([turned, is_driven])),
                false => derivatives_are_slopes(&file, &json!(turned)),
            }
        }
    }
}

const LENGTH: f64 = 1.0;
const SIDE: f64 = 0.02;
const YOUNG: f64 = 7e10;

fn stiffness_in_bending() -> f64 {
    YOUNG * SIDE.powi(4) / 12.0
}

fn shaft(density: f64) -> Value {
    json!({
        "beam": {"length": LENGTH, "section": {"rectangle": {"width": SIDE, "height": SIDE}},
                 "material": {"young": YOUNG, "density": density, "poisson": 0.3},
                 "frame": "clamped", "shear": false,
                 "modes": {"bending_y": 6, "bending_z": 6, "torsion": 2, "stretch": 3}},
        "place": {"put": "start"}
    })
}

/// A disc of the mass m and the moments of inertia I across and P along the shaft, at the end of a shaft that a bearing clamps.
const DISC: [f64; 3] = [2.0, 0.05, 0.09];

fn rotor(speed: f64) -> Value {
    let [mass, across, along] = DISC;
    json!({
        "version": 1, "name": "rotor", "analysis": "modes", "gravity": [0, 0, 0],
        "turning": {"axis": [1, 0, 0], "speed": speed},
        "bodies": {
            "shaft": shaft(0.5),
            "disc": {"mass": mass, "inertia": {"xx": along, "yy": across, "zz": across}, "place": {"at": "shaft.end"}}
        },
        "joints": {
            "bearing": {"revolute": {"between": ["shaft", "ground"], "at": "shaft.start", "axis": [1, 0, 0]}},
            "seat": {"weld": {"between": ["disc", "shaft"], "at": "shaft.end"}}
        },
        "drives": {"motor": {"joint": "bearing", "turn": {"rate": speed}}},
        "functions": {"critical": {"critical_speed": {"number": 1}}},
        "variables": {
            "young": {"path": "/bodies/shaft/beam/material/young", "lower": 1e10, "upper": 1e11},
            "mass": {"path": "/bodies/disc/mass", "lower": 1, "upper": 5},
            "spin": {"path": "/bodies/disc/inertia/xx", "lower": 0.06, "upper": 0.099}
        }
    })
}

fn of_shaft() -> DMatrix<f64> {
    let l = LENGTH;
    DMatrix::from_row_slice(
        2,
        2,
        &[12.0 / l.powi(3), -6.0 / (l * l), -6.0 / (l * l), 4.0 / l],
    ) * stiffness_in_bending()
}

/// Frequencies ω of whirl, forward positive: (K + ω Ω diag(0, P) − ω² diag(m, I)) u = 0 for complex displacement and slope.
fn whirls(speed: f64) -> Vec<f64> {
    let [mass, across, along] = DISC;
    let inverse = DMatrix::from_row_slice(2, 2, &[1.0 / mass, 0.0, 0.0, 1.0 / across]);
    let spin = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, speed * along]);
    let mut state = DMatrix::zeros(4, 4);
    state.view_mut((0, 2), (2, 2)).fill_with_identity();
    state
        .view_mut((2, 0), (2, 2))
        .copy_from(&(&inverse * of_shaft()));
    state.view_mut((2, 2), (2, 2)).copy_from(&(&inverse * spin));
    let values = state.complex_eigenvalues();
    let mut all: Vec<f64> = values.iter().map(|x| x.re).collect();
    all.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    all
}

fn modes(problem: &Problem, count: usize) -> Vec<(f64, Option<(Whirl, f64)>)> {
    let all = problem
        .modes_of_machine(&problem.start(), (count, None))
        .expect("modes");
    assert_eq!(all.growth, None);
    all.modes
        .iter()
        .map(|mode| (mode.frequency, mode.whirl))
        .collect()
}

/// Whirl of a disc on a shaft, below and above its critical speed, in the turning frame and in the fixed one.
#[test]
fn a_disc_whirls_forward_and_backward() {
    for speed in [10.0, 30.0, 60.0, 150.0] {
        let problem = parsed(&rotor(speed));
        let found = modes(&problem, 7);
        for omega in whirls(speed) {
            let seen = (omega - speed).abs() / (2.0 * PI);
            let near = |own: &&(f64, Option<(Whirl, f64)>)| {
                own.1
                    .is_some_and(|(_, fixed)| (fixed * 2.0 * PI / omega.abs() - 1.0).abs() < 2e-3)
                    && (own.0 / seen - 1.0).abs() < 5e-3
            };
            let own = found.iter().find(near);
            let own = own.unwrap_or_else(|| panic!("{speed}: {omega} {seen} {found:?}"));
            let expected = if omega > 0.0 {
                Whirl::Forward
            } else {
                Whirl::Backward
            };
            assert_eq!(own.1.map(|own| own.0), Some(expected), "{speed}: {omega}");
        }
    }
}

/// A forward whirl turns with the machine where K − Ω² diag(m, I − P) is singular, whatever the speed in the file is.
#[test]
fn the_critical_speed_is_that_of_synchronous_whirl() {
    let [mass, across, along] = DISC;
    let k = of_shaft();
    let determinant = |square: f64| {
        (k[(0, 0)] - square * mass) * (k[(1, 1)] - square * (across - along)) - k[(0, 1)].powi(2)
    };
    let (mut low, mut high) = (0.0, k[(0, 0)] / mass);
    while high - low > 1e-12 * high {
        let middle = 0.5 * (low + high);
        if determinant(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    for speed in [10.0, 100.0] {
        let file = rotor(speed);
        assert_near(&values(&file), &[low.sqrt()], 2e-3);
        derivatives_are_right(&file, &json!(speed));
    }
    // The whirl at that speed is at rest in the turning frame.
    let critical = values(&rotor(10.0))[0];
    let just_below = modes(&parsed(&rotor(critical * (1.0 - 1e-3))), 4);
    assert!(
        just_below[0].0 < 5e-3 * critical / (2.0 * PI),
        "{just_below:?}"
    );
    // Another stiffness in one plane divides it.
    let mut file = rotor(10.0);
    file["variables"] = json!({
        "width": {"path": "/bodies/shaft/beam/section/rectangle/width", "lower": 0.01, "upper": 0.03}
    });
    for own in check(&parsed(&file), &parsed(&file).start()).expect("derivatives") {
        assert!(own.adjoint.is_nan(), "{own:?}");
    }
}

/// A cylinder on dampers and springs of ground has the decay c/2m at every speed; unequal bearings have no steady rotation.
#[test]
fn dampers_of_ground_damp_a_rotor_at_every_speed() {
    let (mass, k, c): (f64, f64, f64) = (10.0, 1e6, 800.0);
    let shaft = |speed: f64, other: f64| {
        let bearing = |joint: &str| json!({"bushing": {"joint": joint, "stiffness": {"diagonal": [k, other, k, 0, 0, 0]}, "damping": {"diagonal": [c, c, c, 0, 0, 0]}}});
        let joint = |at: f64| json!({"free": {"between": ["rotor", "ground"], "at": [0, 0, at], "axis": [0, 0, 1]}});
        json!({
            "version": 1, "name": "shaft", "analysis": "modes", "gravity": [0, 0, 0],
            "turning": {"axis": [0, 0, 1], "at": [0, 0, 0], "speed": speed},
            "bodies": {"rotor": {"mass": mass, "inertia": {"xx": 0.3, "yy": 0.3, "zz": 0.1}}},
            "joints": {"left": joint(-0.3), "right": joint(0.3)},
            "loads": {"left": bearing("left"), "right": bearing("right")},
        })
    };
    for speed in [0.0, 100.0, 1000.0] {
        let problem = parsed(&shaft(speed, k));
        let found = problem
            .modes_of_machine(&problem.start(), (5, None))
            .expect("modes");
        assert_eq!(found.growth, None, "{speed}");
        let decay = c / mass;
        let rate = (2.0 * k / mass - decay * decay).sqrt();
        for seen in [rate + speed, (rate - speed).abs()] {
            let near = found.modes.iter().any(|own| {
                let omega = 2.0 * PI * own.frequency;
                let ratio = decay / omega.hypot(decay);
                (omega - seen).abs() < 1e-7 * rate && (own.damping_ratio - ratio).abs() < 1e-8
            });
            assert!(near, "{speed}, {seen}: {:?}", found.modes);
        }
    }
    let text = fault(&shaft(300.0, 2.0 * k));
    assert!(text.contains("not the same after it has turned"), "{text}");
}

/// A pendulum hangs from a shaft that turns: above √(g/l) its rest grows as √(Ω² − g/l), which the table tells and functions refuse.
#[test]
fn rotation_that_diverges_is_told() {
    let hanging = |speed: f64| {
        let ball = json!({"xx": 1e-9, "yy": 1e-9, "zz": 1e-9});
        json!({
            "version": 1, "name": "hanging", "analysis": "modes", "gravity": [0, -9.81, 0],
            "turning": {"axis": [0, 1, 0], "speed": speed},
            "bodies": {"hub": {"mass": 1, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}},
                "bob": {"mass": 1, "inertia": ball, "place": {"at": [0, -1, 0]}}},
            "joints": {"axle": {"revolute": {"between": ["hub", "ground"], "at": [0, 0, 0], "axis": [0, 1, 0]}},
                "pin": {"revolute": {"between": ["bob", "hub"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
            "drives": {"motor": {"joint": "axle", "turn": {"rate": 1}}}
        })
    };
    for (speed, growth) in [(2.0, None), (10.0, Some((100.0_f64 - 9.81).sqrt()))] {
        let file = hanging(speed);
        let problem = parsed(&file);
        let found = problem
            .modes_of_machine(&problem.start(), (3, None))
            .expect("modes");
        match (found.growth, growth) {
            (Some(found), Some(growth)) => {
                assert!((found - growth).abs() < 1e-6 * growth, "{found}")
            }
            (found, growth) => assert_eq!(found, growth, "{speed}"),
        }
        let notes = flexbody_driver::start::notes(&problem, &problem.start());
        assert_eq!(notes.len(), usize::from(growth.is_some()), "{notes:?}");
        for function in [
            json!({"frequency": {"mode": 1}}),
            json!({"lowest_frequency": {}}),
            json!({"damping_ratio": {"mode": 1}}),
        ] {
            let mut file = file.clone();
            file["functions"] = json!({"f": function});
            if growth.is_some() {
                let text = fault(&file);
                assert!(text.contains("rotation is not stable"), "{text}");
            } else {
                values(&file);
            }
        }
    }
}

/// Damping in a shaft that turns drives forward whirl above the critical speed and damps it below.
#[test]
fn inner_damping_is_unstable_above_the_critical_speed() {
    let critical = values(&rotor(10.0))[0];
    for (part, stable) in [(0.9, true), (1.1, false)] {
        let mut file = rotor(part * critical);
        file["bodies"]["shaft"]["beam"]["damping"] = json!({"ratio": 0.01});
        let names: Vec<usize> = (1..=4).collect();
        file["functions"] = names
            .iter()
            .map(|mode| (format!("z{mode}"), json!({"damping_ratio": {"mode": mode}})))
            .collect::<serde_json::Map<_, _>>()
            .into();
        let found = values(&file);
        assert_eq!(found.iter().all(|ratio| *ratio > 0.0), stable, "{found:?}");
        // The growth is told whatever modes are.
        let problem = parsed(&file);
        let growth = |count: usize| {
            let found = problem.modes_of_machine(&problem.start(), (count, None));
            found.expect("modes").growth
        };
        let [one, many] = [1, 8].map(growth);
        assert_eq!(one.is_none(), stable, "{one:?}");
        if let (Some(one), Some(many)) = (one, many) {
            assert!((one - many).abs() < 1e-6 * many, "{one} {many}");
        }
    }
}

/// Wright, Smith, Thresher & Wang 1982 (J. Appl. Mech. 49:197), table 1: the first frequency of a cantilever that turns about an
/// axis through its root, out of the plane of rotation, in √(EI / ρA L⁴). In the plane the square is less by that of the
/// speed (Southwell).
#[test]
fn a_rotating_beam_has_the_frequencies_of_the_literature() {
    let density = 2700.0;
    let unit = (stiffness_in_bending() / (density * SIDE * SIDE * LENGTH.powi(4))).sqrt();
    for (speed, exact) in [
        (1.0, 3.6816),
        (3.0, 4.7973),
        (5.0, 6.4495),
        (8.0, 9.2568),
        (12.0, 13.1702),
    ] {
        let file = json!({
            "version": 1, "name": "blade", "analysis": "modes", "gravity": [0, 0, 0],
            "turning": {"axis": [0, 0, 1], "speed": speed * unit},
            "bodies": {"blade": shaft(density)},
            "joints": {"hub": {"revolute": {"between": ["blade", "ground"], "at": "blade.start", "axis": [0, 0, 1]}}},
            "drives": {"motor": {"joint": "hub", "turn": {"rate": speed * unit}}},
            "functions": {"in": {"frequency": {"mode": 1}}, "out": {"frequency": {"mode": 2}}},
            "variables": {
                "speed": {"path": "/turning/speed", "lower": 1, "upper": 1e4},
                "young": {"path": "/bodies/blade/beam/material/young", "lower": 1e10, "upper": 1e11},
                "density": {"path": "/bodies/blade/beam/material/density", "lower": 1e3, "upper": 1e4}
            }
        });
        let inside = (exact * exact - speed * speed).sqrt();
        let expected = [inside, exact].map(|f| f * unit / (2.0 * PI));
        assert_near(&values(&file), &expected, 1.5e-3);
        if speed == 5.0 {
            derivatives_are_right(&file, &json!(speed));
        }
    }
}

/// What cannot turn, and what has no meaning then.
#[test]
fn what_cannot_turn_is_told() {
    let table = || table([300.0, 170.0], [1.0, 1.0], [0.5, 2.0], 5.0);
    let told = |change: &dyn Fn(&mut Value), texts: &[&str]| {
        let mut file = table();
        change(&mut file);
        let text = fault(&file);
        for part in texts {
            assert!(text.contains(part), "{part}: {text}");
        }
    };
    let same = "not the same after it has turned";
    told(
        &|file| file["gravity"] = json!([0, -9.81, 0]),
        &[same, "/turning", "gravity"],
    );
    told(
        &|file| {
            file["joints"]["axle"] =
                json!({"weld": {"between": ["table", "ground"], "at": [0, 0, 0]}});
            file.as_object_mut().expect("an object").remove("drives");
        },
        &[same, "axle"],
    );
    // A spring to ground on one side, at its free length and with its end on the axis.
    told(
        &|file| {
            file["loads"]["side"] = json!({"spring": {
                "between": ["two", "ground"], "at": {"a": [0, 0, 0], "b": [0, 2, 0]}, "rest_length": 2, "stiffness": 50
            }});
        },
        &[same, "another stiffness"],
    );
    told(
        &|file| file["turning"]["axis"] = json!([0, 0, 0]),
        &["/turning/axis", "not zero"],
    );
    told(
        &|file| file["turning"]["speed"] = json!(-1),
        &["/turning/speed"],
    );
    told(
        &|file| file["analysis"] = json!("rest"),
        &["/turning", "\"analysis\": \"modes\""],
    );
    told(
        &|file| file["modes"] = json!({"speeds": [1, -2]}),
        &["/modes/speeds/1"],
    );
    told(
        &|file| {
            file["functions"]["x"] =
                json!({"final": {"position": {"body": "two", "direction": [1, 0, 0]}}})
        },
        &["a function of a state, of a machine that turns"],
    );
    told(
        &|file| file["functions"]["c"] = json!({"critical_speed": {"number": 9}}),
        &["critical speed 3 is not found", "there are 2"],
    );
    told(
        &|file| {
            file.as_object_mut().expect("an object").remove("turning");
            file["variables"] = json!({});
            file["functions"] = json!({"c": {"critical_speed": {"number": 1}}});
        },
        &["a critical speed of a machine that does not turn"],
    );
    told(
        &|file| {
            file.as_object_mut().expect("an object").remove("turning");
            file["variables"] = json!({});
            file["modes"] = json!({"speeds": [1]});
        },
        &["speeds of a machine that does not turn"],
    );
}
