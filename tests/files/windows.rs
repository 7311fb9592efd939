//! Windows of time, combined and relative quantities in problem files: families that must agree, landmarks, faults.

use crate::reference::documents::{problem, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::Evaluated;
use flexbody_problem::Problem;
use serde_json::Value;
use std::f64::consts::PI;

/// A double pendulum on a cart with a spring, turned by `turn` about the vertical and in units of length that are
/// `unit` m. Functions are of every new kind.
fn cart(turn: f64, mirror: f64) -> Value {
    let (s, c) = turn.sin_cos();
    let along = |x: f64, y: f64| json!([x * c, y, mirror * x * s]);
    let axis = json!([-s * mirror, 0, c]);
    let at = |body: &str, x: f64| json!({"body": body, "point": [x, 0, 0]});
    let placed =
        |x: f64| json!({"at": along(x, 0.0), "turn": {"axis": [0, 1, 0], "angle": -turn * mirror}});
    let with = |mut of: Value, direction: Value| {
        of["direction"] = direction;
        of
    };
    let seen = |direction: [f64; 3]| {
        json!({"body": "second", "point": [0.2, 0, 0], "relative_to": "first",
               "from": [-0.2, 0, 0], "direction": direction})
    };
    json!({
        "version": 1, "name": "cart",
        "bodies": {
            "cart": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "place": placed(0.0)},
            "first": {"shape": {"rod": {"length": 0.4, "radius": 0.02}}, "mass": 1, "place": placed(0.2)},
            "second": {"shape": {"rod": {"length": 0.4, "radius": 0.02}}, "mass": 0.7, "place": placed(0.6)}
        },
        "joints": {
            "rail": {"prismatic": {"between": ["cart", "ground"], "at": [0, 0, 0], "axis": along(1.0, 0.0)}},
            "a": {"revolute": {"between": ["first", "cart"], "at": along(0.0, 0.0), "axis": axis}},
            "b": {"revolute": {"between": ["second", "first"], "at": along(0.4, 0.0), "axis": axis}}
        },
        "loads": {"spring": {"spring": {"between": ["cart", "ground"], "at": {"a": [0, 0, 0], "b": along(-0.5, 0.0)},
                                        "rest_length": 0.4, "stiffness": 90, "damping": 2}}},
        "simulation": {"duration": 0.8, "tolerance": 1e-11},
        "functions": {
            "rms": {"mean_square": {"of": {"velocity": with(at("second", 0.2), along(1.0, 0.0))}, "during": [0.1, 0.55]}},
            "down": {"value": {"at": 0.4, "of": {"position": with(at("second", 0.2), json!([0, 1, 0]))}}},
            "after": {"integral": {"of": {"power": {"load": "spring"}},
                      "during": {"from": {"when": {"position": {"body": "first", "direction": [0, 1, 0]}}, "falls_to": -0.05}}}},
            "seen": {"final": {"relative_position": seen([0.6, 0.8, 0.0])}},
            "seen rate": {"mean": {"relative_velocity": seen([0.6, 0.8, 0.0])}},
            "apart": {"ks": {"rho": 30, "during": [0.2, 0.8], "bound": "above",
                      "of": {"distance": {"body": "second", "relative_to": "cart"}}}},
            "sensor": {"mean_absolute": {"of": {"sensor_acceleration": with(at("second", 0.1), json!([0, 1, 0]))}, "width": 0.1}},
            "jerk": {"mean_square": {"of": {"jerk": {"body": "first", "direction": [0, 1, 0]}}, "during": [0.2, 0.6]}},
            "slide": {"mean_square": {"of": {"slide_rate": {"joint": "rail"}}, "during": {"to": 0.5}}},
            "swing": {"induced_exponential": {"rho": 0.5, "of": {"product": [
                {"square": {"angle_rate": {"joint": "b"}}}, {"spring_force": {"load": "spring"}}]}, "during": [0.1, 0.7]}},
            "ratio": {"mean": {"quotient": [{"energy": "kinetic"}, {"spring_length": {"load": "spring"}}]}}
        },
        "variables": {
            "mass": {"path": "/bodies/second/mass", "lower": 0.1, "upper": 3},
            "stiffness": {"path": "/loads/spring/spring/stiffness", "lower": 10, "upper": 200},
            "start": {"path": "/functions/rms/mean_square/during/0", "lower": 0, "upper": 0.3},
            "height": {"path": "/functions/after/integral/during/from/falls_to", "lower": -0.1, "upper": 0}
        }
    })
}

#[test]
fn turned_and_mirrored_scenes_have_the_same_values() {
    let straight = values(&cart(0.0, 1.0));
    assert!(
        straight.iter().all(|x| x.is_finite() && x.abs() > 1e-4),
        "{straight:?}"
    );
    for (turn, mirror) in [(0.7, 1.0), (PI, 1.0), (-2.1, 1.0), (PI / 2.0, 1.0)] {
        let turned = values(&cart(turn, mirror));
        for (i, (a, b)) in straight.iter().zip(&turned).enumerate() {
            let off = (a - b).abs() / a.abs().max(1.0);
            assert!(
                off < 3e-8,
                "turn {turn}, function {i}: {a} and {b}: {off:e}"
            );
        }
    }
}

#[test]
fn derivatives_are_exact_in_the_design_and_in_the_ends_of_windows() {
    let mut document = cart(0.4, 1.0);
    // A rate divides round-off by the distance of samples.
    document["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("jerk");
    let problem = problem(&document);
    gradients_are_exact(&problem, &document["simulation"]);
    let units: Vec<&str> = problem.variables.iter().map(|v| v.unit.as_str()).collect();
    assert_eq!(units, ["kg", "N/m", "s", "m"]);
}

#[test]
fn units_of_combinations_follow() {
    let problem = problem(&cart(0.0, 1.0));
    let scene = problem.unlowered_scene(&problem.start());
    let units: Vec<String> = scene.functions.iter().map(|own| own.unit()).collect();
    let wanted = [
        "m²/s²",
        "m",
        "J",
        "m",
        "m/s",
        "m",
        "m/s²",
        "m²/s⁶",
        "m²/s²",
        "kg m/s⁴",
        "N",
    ];
    assert_eq!(units, wanted);
}

/// A four-bar linkage in the plane whose crank turns at 2π rad/s from the angle `first`.
fn linkage([a, b, c, d, p]: [f64; 5], first: f64) -> Value {
    let place = |put: &str, at: Value, angle: f64| json!({"put": put, "at": at, "turn": {"axis": [0, 0, 1], "angle": angle}});
    let [ax, ay] = [a * first.cos(), a * first.sin()];
    let s = ((d - ax).powi(2) + ay * ay).sqrt();
    let coupler = (-ay).atan2(d - ax) + ((b * b + s * s - c * c) / (2.0 * b * s)).acos();
    let rocker = (ay + b * coupler.sin()).atan2(ax + b * coupler.cos() - d);
    let rod = |length: f64, points: Value, place: Value| json!({"shape": {"rod": {"length": length, "radius": 0.01}}, "mass": 1, "points": points, "place": place});
    json!({
        "version": 1, "name": "linkage", "gravity": [0, 0, 0],
        "bodies": {
            "crank": rod(a, json!({"foot": [-a / 2.0, 0, 0], "pin": [a / 2.0, 0, 0]}),
                         place("foot", json!([0, 0, 0]), first)),
            "coupler": rod(p, json!({"pin": [-p / 2.0, 0, 0], "knee": [b - p / 2.0, 0, 0], "tracer": [p / 2.0, 0, 0]}),
                           place("pin", json!("crank.pin"), coupler)),
            "rocker": rod(c, json!({"foot": [-c / 2.0, 0, 0], "knee": [c / 2.0, 0, 0]}),
                          place("foot", json!([d, 0, 0]), rocker))
        },
        "joints": {
            "motor": {"revolute": {"between": ["crank", "ground"], "at": "crank.foot", "axis": [0, 0, 1]}},
            "pin": {"revolute": {"between": ["coupler", "crank"], "at": "crank.pin", "axis": [0, 0, 1]}},
            "knee": {"revolute": {"between": ["coupler", "rocker"], "at": {"a": "knee", "b": "knee"}, "axis": [0, 0, 1]}},
            "foot": {"revolute": {"between": ["rocker", "ground"], "at": "rocker.foot", "axis": [0, 0, 1]}}
        },
        "drives": {"turn": {"joint": "motor", "turn": {"rate": 2.0 * PI}}},
        "simulation": {"duration": 1, "tolerance": 1e-11},
        "functions": {}
    })
}

/// The tracer's place at a crank angle.
fn traced([a, b, c, d, p]: [f64; 5], angle: f64) -> [f64; 2] {
    let [ax, ay] = [a * angle.cos(), a * angle.sin()];
    let s = ((d - ax).powi(2) + ay * ay).sqrt();
    let coupler = (-ay).atan2(d - ax) + ((b * b + s * s - c * c) / (2.0 * b * s)).acos();
    [ax + p * coupler.cos(), ay + p * coupler.sin()]
}

/// Hoeken's linkage (Norton, Design of Machinery, ch. 3): the crank 1, the frame 2, coupler and rocker 2.5, the tracer
/// at 5. It draws a nearly straight line over half a turn. Its closed form is that of two circles.
#[test]
fn hoekens_linkage_draws_its_line() {
    let lengths = [0.1, 0.25, 0.25, 0.2, 0.5];
    let mut document = linkage(lengths, PI / 2.0);
    let off = json!({"relative_position": {"body": "coupler", "point": "tracer", "relative_to": "ground",
                                          "from": [0, 0.4, 0], "direction": [0, 1, 0]}});
    let along = json!({"velocity": {"body": "coupler", "point": "tracer", "direction": [1, 0, 0]}});
    document["functions"] = json!({
        "square": {"mean_square": {"of": off, "during": [0, 0.5]}},
        "most": {"ks": {"rho": 1e7, "bound": "above", "of": {"absolute": {"of": off, "width": 1e-9}}, "during": [0, 0.5]}},
        "stroke": {"integral": {"of": along, "during": [0, 0.5]}},
        "middle": {"value": {"at": 0.25, "of": off}},
        "work": {"integral": {"power": {"drive": "turn"}}},
        "supplied": {"final": {"energy": "kinetic"}}
    });
    let found = values(&document);
    let count = 20000;
    let heights = (0..=count).map(|i| {
        let angle = PI / 2.0 + PI * f64::from(i) / f64::from(count);
        traced(lengths, angle)[1] - 0.4
    });
    let heights: Vec<f64> = heights.collect();
    let last = heights.len() - 1;
    let weight = |i: usize| if i == 0 || i == last { 0.5 } else { 1.0 };
    let sum: f64 = heights
        .iter()
        .enumerate()
        .map(|(i, h)| weight(i) * h * h)
        .sum();
    let most = heights.iter().fold(0.0_f64, |m, h| m.max(h.abs()));
    let stroke = traced(lengths, 1.5 * PI)[0] - traced(lengths, 0.5 * PI)[0];
    let close = |found: f64, wanted: f64, tolerance: f64| {
        assert!((found - wanted).abs() < tolerance, "{found}, not {wanted}");
    };
    close(found[0], sum / last as f64, 1e-12);
    close(found[1], most, 3e-7);
    close(found[2], stroke, 1e-9);
    // In the middle of its line the linkage is on it exactly.
    close(found[3], 0.0, 1e-10);
    // Over a whole turn the motor gives as much as it takes.
    close(found[4], 0.0, 1e-8);
    assert!(most < 0.005 * stroke.abs(), "{most} of {stroke}");
}

/// Chebyshev's linkage: the frame 4, both arms 5, the coupler 2, whose middle is at the height 4 exactly where the
/// linkage is symmetric and where an arm is upright.
#[test]
fn chebyshevs_linkage_draws_its_line() {
    // The first arm from the upright position, the second crossed.
    let document = |functions: Value| {
        let (a, b, c, d): (f64, f64, f64, f64) = (0.5, 0.2, 0.5, 0.4);
        // The arm is upright at first: its pin is (0, 0.5).
        let (x, y): (f64, f64) = (0.0, 0.5);
        let s: f64 = ((d - x) * (d - x) + y * y).sqrt();
        let to_foot = (-y).atan2(d - x);
        let bend: f64 = ((b * b + s * s - c * c) / (2.0 * b * s)).acos();
        let coupler = to_foot - bend;
        let (kx, ky) = (x + b * coupler.cos(), y + b * coupler.sin());
        let rocker = ky.atan2(kx - d);
        let rod = |length: f64, put: &str, at: Value, angle: f64| {
            json!({"shape": {"rod": {"length": length, "radius": 0.01}}, "mass": 1,
                   "points": {"foot": [-length / 2.0, 0, 0], "end": [length / 2.0, 0, 0]},
                   "place": {"put": put, "at": at, "turn": {"axis": [0, 0, 1], "angle": angle}}})
        };
        json!({
            "version": 1, "name": "chebyshev", "gravity": [0, 0, 0],
            "bodies": {
                "first": rod(a, "foot", json!([0, 0, 0]), PI / 2.0),
                "coupler": rod(b, "foot", json!("first.end"), coupler),
                "second": rod(c, "foot", json!([d, 0, 0]), rocker)
            },
            "joints": {
                "motor": {"revolute": {"between": ["first", "ground"], "at": "first.foot", "axis": [0, 0, 1]}},
                "pin": {"revolute": {"between": ["coupler", "first"], "at": "first.end", "axis": [0, 0, 1]}},
                "knee": {"revolute": {"between": ["coupler", "second"], "at": {"a": "end", "b": "end"}, "axis": [0, 0, 1]}},
                "foot": {"revolute": {"between": ["second", "ground"], "at": "second.foot", "axis": [0, 0, 1]}}
            },
            "drives": {"turn": {"joint": "motor", "turn": {"rate": -0.5}}},
            "simulation": {"duration": 1.3, "tolerance": 1e-11},
            "functions": functions
        })
    };
    let off = json!({"relative_position": {"body": "coupler", "relative_to": "ground", "from": [0, 0.4, 0], "direction": [0, 1, 0]}});
    // Symmetric: the pins are 0.2 apart on a line at 0.4 above feet that are 0.4 apart, the first at (0.3, 0.4).
    let symmetric = (PI / 2.0 - 0.4_f64.atan2(0.3)) / 0.5;
    let found = values(&document(json!({
        "first": {"value": {"at": 0, "of": off}},
        "middle": {"value": {"at": symmetric, "of": off}},
        "most": {"ks": {"rho": 1e7, "bound": "above", "of": {"absolute": {"of": off, "width": 1e-9}},
                 "during": [0, symmetric]}}
    })));
    assert!(
        found[0].abs() < 1e-10 && found[1].abs() < 1e-10,
        "{found:?}"
    );
    assert!(found[2] > 1e-5 && found[2] < 0.005, "{found:?}");
}

/// The largest value in a window is told with its error: that of a sine, at its crest, at the ends of windows and at samples.
#[test]
fn the_largest_value_in_a_window_has_an_error() {
    let turn = |t: f64| 0.3 * f64::sin(2.0 * PI * 1.5 * t + 0.4);
    let crest = (0.5 * PI - 0.4) / (3.0 * PI);
    for samples in [20, 40, 80] {
        for [from, to] in [[0.0, 1.0], [0.02, 0.3], [0.55, 0.73], [0.25, 0.45]] {
            let document = json!({
                "version": 1, "name": "sine", "gravity": [0, 0, 0],
                "bodies": {"bar": {"shape": {"rod": {"length": 1, "radius": 0.01}}, "mass": 1}},
                "joints": {"pin": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
                "drives": {"motor": {"joint": "pin", "turn": {"harmonic": {"amplitude": 0.3, "frequency": 1.5, "phase": 0.4}}}},
                "simulation": {"duration": 1, "tolerance": 1e-12, "samples": samples},
                "functions": {"most": {"ks": {"rho": 1000, "of": {"rotation": {"body": "bar", "axis": [0, 0, 1]}}, "during": [from, to]}}}
            });
            let problem = problem(&document);
            let found = Evaluated::new(&problem, &[]).expect("runs").function(0);
            let maximum = found.maximum.expect("a maximum");
            let inside = (0..2)
                .map(|k| crest + f64::from(k) / 1.5)
                .filter(|t| (from..to).contains(t));
            let exact = inside.map(turn).fold(turn(from).max(turn(to)), f64::max);
            let off = (maximum.value - exact).abs();
            let what = format!("{samples} {from} {to} {off:e} {maximum:?}");
            assert!(
                off <= maximum.error.max(1e-9) && maximum.error < 1e-2,
                "{what}"
            );
            let is_sample = (maximum.time * f64::from(samples)).fract() < 1e-9;
            assert!(maximum.error > 0.0 || is_sample, "{what}");
        }
    }
}

#[test]
fn faults_have_their_place_and_a_hint() {
    let cases = [
        (
            "/functions/rms/mean_square/during",
            json!([0.5, 0.2]),
            "a window from 0.5 to 0.2",
        ),
        (
            "/functions/rms/mean_square/during",
            json!([0.5, 1.2]),
            "1.2 s",
        ),
        (
            "/functions/rms/mean_square/during",
            json!([-0.5, 0.2]),
            "from 0 on",
        ),
        (
            "/functions/rms/mean_square/during",
            json!([0.5]),
            "a list of 1",
        ),
        ("/functions/rms/mean_square/during", json!({}), "no end"),
        (
            "/functions/rms/mean_square/during",
            json!({"form": 0.1}),
            "did you mean \"from\"",
        ),
        (
            "/functions/rms/mean_square/during",
            json!({"from": {"when": {"energy": "kinetic"}}}),
            "no value to reach",
        ),
        (
            "/functions/rms/mean_square/during",
            json!({"to": {"when": {"energy": "kinetic"}, "reaches": 1, "rises_to": 2}}),
            "more than one",
        ),
        (
            "/functions/after/integral/of",
            json!({"power": {"load": "sprung"}}),
            "did you mean \"spring\"",
        ),
        (
            "/functions/after/integral/of",
            json!({"power": {"drive": "motor"}}),
            "there is none",
        ),
        (
            "/functions/seen/final/relative_position/relative_to",
            json!("second"),
            "itself",
        ),
        (
            "/functions/seen/final/relative_position/relative_to",
            json!("third"),
            "the name of a body",
        ),
        (
            "/functions/ratio/mean",
            json!({"sum": [{"energy": "kinetic"}, {"angle": {"joint": "a"}}]}),
            "in J and one in rad",
        ),
        (
            "/functions/ratio/mean",
            json!({"sum": [{"energy": "kinetic"}]}),
            "a list of 1",
        ),
        (
            "/functions/ratio/mean",
            json!({"quotient": {"of": 1}}),
            "a list of 2",
        ),
        (
            "/functions/apart/ks/of",
            json!({"distance": {"body": "second"}}),
            "no \"relative_to\"",
        ),
        ("/functions/sensor/mean_absolute/width", json!(0), "above 0"),
        (
            "/functions/swing/induced_exponential/of",
            json!({"rate": {"speed": {"body": "nobody"}}}),
            "the name of a body",
        ),
    ];
    for (pointer, value, wanted) in cases {
        let mut document = cart(0.0, 1.0);
        document["variables"] = json!({});
        *document.pointer_mut(pointer).expect("a place") = value.clone();
        let text = serde_json::to_string_pretty(&document).expect("text");
        let found = match Problem::parse(&text, "cart.json", &[]) {
            Err(faults) => faults.to_string(),
            Ok(_) => panic!("no fault: {pointer} {value}"),
        };
        assert!(found.contains(wanted), "{pointer} {value}: {found}");
        assert!(found.contains("cart.json:"), "{found}");
    }
}

/// A window without a place in the motion has no value.
#[test]
fn a_window_that_never_starts_is_a_failed_design() {
    let mut document = cart(0.0, 1.0);
    document["functions"]["after"]["integral"]["during"]["from"]["falls_to"] = json!(-9);
    document["variables"] = json!({});
    let problem = problem(&document);
    let at = Evaluated::new(&problem, &problem.start()).expect("runs");
    let f = problem
        .function_names
        .iter()
        .position(|name| name == "after");
    assert!(at.function(f.expect("a function")).value.is_nan());
}

/// The force of a contact is zero over all the time before it, so no instant is the one at which it falls to zero.
#[test]
fn the_level_zero_of_a_contact_is_refused() {
    let window = json!({"value": {"at": {"when": {"contact_force": {"load": "floor"}}, "falls_to": 0},
                                  "of": {"velocity": {"body": "ball", "direction": [0, 1, 0]}}}});
    let file = |functions: Value, until: Value| {
        let mut simulation = json!({"duration": 1});
        if !until.is_null() {
            simulation["until"] =
                json!({"measure": {"contact_force": {"load": "floor"}}, "reaches": until});
        }
        json!({
            "version": 1, "name": "ball",
            "bodies": {"ball": {"shape": "point", "mass": 1, "place": {"at": [0, 0.1, 0]}}},
            "loads": {"floor": {"contact": {"between": ["ball", "ground"], "at": [[0, 0.1, 0], [0, 0, 0]],
                "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": 1e4, "width": 1e-4}}},
            "simulation": simulation, "functions": functions
        })
    };
    let faults = |file: Value| {
        let text = serde_json::to_string_pretty(&file).expect("text");
        Problem::parse(&text, "ball.json", &[])
            .err()
            .map(|own| own.to_string())
    };
    let none = Value::Null;
    let found = faults(file(json!({"up": window}), none.clone())).expect("a fault");
    assert!(found.contains("/functions/up/value/at/falls_to"), "{found}");
    let found = faults(file(json!({}), json!(0))).expect("a fault");
    assert!(found.contains("/simulation/until/reaches"), "{found}");
    let mut above = window.clone();
    above["value"]["at"]["falls_to"] = json!(0.01);
    assert_eq!(faults(file(json!({"up": above}), none)), None);
}
