//! The axes of a beam are a choice of its author: what holds them does not change how it moves.

use crate::reference::documents::{problem, run};
use flexbody_driver::check::check;
use serde_json::Value;

/// A bar of 1 m on a hinge or a weld that falls by its weight, in these axes. Its functions are the integral of its
/// kinetic energy and the place of its end.
fn bar(joint: &str, gravity: [f64; 3], thick: f64, damping: &Value, frame: &str) -> Value {
    let place = |direction: [i32; 3]| json!({"final": {"position": {"body": "bar", "point": "end", "direction": direction}}});
    let mut hinge = json!({"between": ["bar", "ground"], "at": "bar.start"});
    if joint == "revolute" {
        hinge["axis"] = json!([0, 0, 1]);
    }
    json!({
        "version": 1, "name": "bar", "gravity": gravity,
        "bodies": {"bar": {
            "beam": {
                "length": 1, "section": {"rectangle": {"width": 0.1, "height": thick}}, "damping": damping,
                "material": {"young": 1.5 * 9.81e5 / (thick * thick), "poisson": 0.3, "density": 1000}, "frame": frame,
            },
            "place": {"put": "start", "at": [0, 0, 0], "turn": {"axis": [0, 1, 0], "angle": 0.3}}
        }},
        "joints": {"hinge": {joint: hinge}},
        "simulation": {"duration": 0.5, "steps": 200, "method": {"radau": {"stages": 3}}},
        "functions": {"action": {"integral": {"energy": "kinetic"}}, "x": place([1, 0, 0]), "y": place([0, 1, 0]), "z": place([0, 0, 1])},
    })
}

/// Its end sags by a hundredth of the length, so that the beam shortens by 1e-4 of it. Damping of the stiffness sees
/// no strain in that, in any axes: actions agree within 1e-3, places within half a per cent of the sag.
#[test]
fn a_damped_beam_moves_alike_in_all_axes() {
    let damped = |beta: f64| json!({"stiffness": beta});
    let members = [
        ("weld", [0.0, -9.81, 0.0], 0.04, damped(1e-3)),
        ("weld", [3.0, 5.0, -8.0], 0.07, damped(1e-3)),
        ("weld", [-2.0, 0.0, 9.0], 0.02, damped(3e-4)),
        ("revolute", [0.0, -9.81, 0.0], 0.04, damped(1e-3)),
        ("revolute", [1.0, 7.0, 6.0], 0.05, damped(5e-4)),
        (
            "revolute",
            [1.0, 7.0, 6.0],
            0.05,
            json!({"mass": 0.5, "stiffness": 5e-4}),
        ),
    ];
    for (joint, gravity, thick, damping) in members {
        let [chord, clamped] = ["chord", "clamped"].map(|frame| {
            let motion = run(&bar(joint, gravity, thick, &damping, frame));
            [0, 1, 2, 3].map(|k| motion.at.function(k).value)
        });
        let context = format!("{joint} {gravity:?} {damping}: {chord:?} {clamped:?}");
        assert!((chord[0] / clamped[0] - 1.0).abs() < 1e-3, "{context}");
        for k in 1..4 {
            assert!((chord[k] - clamped[k]).abs() < 5e-5, "{context}");
        }
    }
}

/// The damping of strains has exact derivatives, also where it is zero.
#[test]
fn derivatives_of_damped_strains_are_exact() {
    for (frame, beta) in [("chord", 5e-4), ("clamped", 5e-4), ("clamped", 0.0)] {
        let damping = json!({"mass": 0.5, "stiffness": beta});
        let mut document = bar("revolute", [1.0, 7.0, 6.0], 0.05, &damping, frame);
        document["simulation"]["duration"] = json!(0.05);
        document["simulation"]["steps"] = json!(20);
        let variable = |key: &str, lower: f64| json!({"path": format!("/bodies/bar/beam/{key}"), "lower": lower, "upper": 1e12});
        document["variables"] = json!({
            "beta": variable("damping/stiffness", 0.0), "alpha": variable("damping/mass", 0.0),
            "length": variable("length", 0.1), "height": variable("section/rectangle/height", 1e-3),
            "young": variable("material/young", 1e6),
        });
        let problem = problem(&document);
        let found = check(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
        assert_eq!(found.len(), 20);
        for derivative in &found {
            let off = (derivative.adjoint - derivative.complex_step).abs();
            assert!(
                off <= 1e-12 * derivative.terms,
                "{frame} {derivative:?}: {off:e}"
            );
        }
        let by_beta = found.iter().filter(|d| d.variable == 0);
        assert!(by_beta.filter(|d| d.adjoint != 0.0).count() >= 3);
    }
}
