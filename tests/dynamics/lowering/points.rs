//! Bodies that do not rotate.

use super::*;
use flexbody_driver as driver;
use flexbody_mechanics::model::Mobility;

/// A ball at the end of a spatial double pendulum.
fn ball_on_a_double_pendulum(at: Value, function: Value) -> Value {
    json!({
        "version": 1, "name": "ball",
        "bodies": {
            "first": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": [0, 0, 0]}},
            "second": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 2,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": "first.end"}},
            "ball": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 0.5,
                "points": {"held": at},
                "place": {"put": "held", "at": "second.end"}}
        },
        "joints": {
            "pin": {"revolute": {"between": ["first", "ground"], "at": "first.pin", "axis": [0, 0, 1]}},
            "hinge": {"revolute": {"between": ["second", "first"], "at": "first.end", "axis": [0, 1, 1]}},
            "holder": {"spherical": {"between": ["ball", "second"], "at": "second.end"}}
        },
        "simulation": {"duration": 1},
        "functions": {"asked": function},
        "variables": {
            "mass": {"path": "/bodies/ball/mass", "lower": 0.1, "upper": 1},
            "length": {"path": "/bodies/second/points/end/0", "lower": 0.3, "upper": 0.6}
        }
    })
}

#[test]
fn a_ball_held_at_its_centre_is_a_point() {
    let height =
        json!({"ks": {"rho": 5, "of": {"position": {"body": "ball", "direction": [0, 1, 0]}}}});
    let turn = json!({"final": {"rotation": {"body": "ball", "axis": [0, 0, 1]}}});
    let point = |problem: &Problem| {
        let scene = problem.scene::<f64>(&problem.start());
        scene.model.bodies[2].mobility == Mobility::point()
    };
    let problem = parse(&ball_on_a_double_pendulum(json!([0, 0, 0]), height.clone()));
    assert!(!is_planar(&problem) && point(&problem));
    for method in [Method::Dop853, RADAU, BDF] {
        let found = differences(&problem, &settings(method, Spacing::Steps(200)));
        assert!(
            found.iter().all(|&x| x <= 1e-11),
            "{}: {found:?}",
            method.name()
        );
    }
    let derivatives = driver::check(&problem, &problem.start()).expect("a run");
    for derivative in derivatives {
        assert!(derivative.relative_difference() <= 1e-12, "{derivative:?}");
    }
    assert!(!point(&parse(&ball_on_a_double_pendulum(
        json!([0, 0, 0]),
        turn
    ))));
    assert!(!point(&parse(&ball_on_a_double_pendulum(
        json!([0, 0.01, 0]),
        height
    ))));
}

/// A cart slides along an oblique axis and carries a second cart. A ball joint joins a bar to the
/// second cart.
fn carts() -> Problem {
    parse(&json!({
        "version": 1, "name": "carts", "gravity": [0, -9.81, 0.1],
        "bodies": {
            "cart": {"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1,
                "points": {"corner": [0.5, 0.1, 0.15]},
                "place": {"at": [0.1, 0.2, 0], "turn": {"axis": [1, 0, 2], "angle": 0.3}}},
            "slide": {"shape": {"box": {"size": [0.3, 0.2, 0.3]}}, "mass": 2,
                "place": {"at": [0.1, 0.4, 0]}},
            "bar": {"shape": {"box": {"size": [1, 0.1, 0.2]}}, "mass": 1,
                "points": {"pin": [-0.5, 0, 0], "end": [0.5, 0, 0]},
                "place": {"put": "pin", "at": "cart.corner"}}
        },
        "joints": {
            "rail": {"prismatic": {"between": ["cart", "ground"], "at": [0, 0, 0], "axis": [1, 1, 1]}},
            "guide": {"prismatic": {"between": ["cart", "slide"], "at": [0, 0.4, 0], "axis": [0, 0, 1]}},
            "ball": {"spherical": {"between": ["bar", "cart"], "at": "cart.corner"}}
        },
        "loads": {
            "twist": {"torque": {"body": "cart", "direction": [0, 1, 0], "magnitude": 2}},
            "spring": {"spring": {"between": ["slide", "ground"], "at": {"a": [0.1, 0.1, 0], "b": [1, 1, 1]},
                "stiffness": 30, "rest_length": 1}}
        },
        "simulation": {"duration": 1},
        "functions": {
            "corner": {"final": {"position": {"body": "cart", "point": "corner", "direction": [1, 2, 3]}}},
            "turned": {"final": {"rotation": {"body": "cart", "axis": [0, 0, 1]}}},
            "end": {"ks": {"rho": 2, "of": {"speed": {"body": "bar", "point": "end"}}}}
        },
        "variables": {
            "angle": {"path": "/bodies/cart/place/turn/angle", "lower": -0.5, "upper": 0.5},
            "mass": {"path": "/bodies/cart/mass", "lower": 0.5, "upper": 2},
            "corner": {"path": "/bodies/cart/points/corner/1", "lower": 0.1, "upper": 0.2}
        }
    }))
}

/// Bodies whose rotation ground holds have three unknowns and no rows for it. A variable may rotate
/// them at the start, and functions may observe the rotation.
#[test]
fn a_cart_on_a_rail_does_not_turn() {
    let problem = carts();
    assert_eq!(size(&unlowered(&problem)), (18, 13));
    assert_eq!(size(&problem), (12, 7));
    assert_the_same(&problem);
}

/// In the plane they have two unknowns, with and without a drive, inside a loop and outside.
#[test]
fn sliders_in_a_plane_do_not_turn() {
    for (file, written, lowered) in [
        ("tests/data/driven_slider_crank.json", (30, 29), (13, 12)),
        (
            "problems/benchmarks/balanced_slider_crank.json",
            (24, 22),
            (10, 8),
        ),
    ] {
        let problem = load(file, &[]);
        assert!(is_planar(&problem));
        assert_eq!(size(&unlowered(&problem)), written, "{file}");
        assert_eq!(size(&problem), lowered, "{file}");
        assert_the_same(&problem);
    }
}

/// Asserts that motion, gradients and reactions are those without reductions.
fn assert_the_same(problem: &Problem) {
    for method in [Method::Dop853, RADAU, BDF] {
        let found = differences(problem, &settings(method, Spacing::Steps(200)));
        assert!(
            found.iter().all(|&x| x <= 1e-11),
            "{}: {found:?}",
            method.name()
        );
    }
    let derivatives = driver::check(problem, &problem.start()).expect("a run");
    for derivative in derivatives {
        // Some derivatives vanish as sums of non-zero terms.
        let off = (derivative.adjoint - derivative.complex_step).abs();
        let size = derivative.adjoint.abs() + 1e-3 * derivative.terms;
        assert!(off <= 1e-10 * size, "{derivative:?}");
    }
    let reactions = |problem: &Problem| {
        let seen = driver::simulate(problem, &problem.start()).expect("a run");
        seen.reactions(400)
    };
    for (a, b) in reactions(problem)
        .iter()
        .zip(&reactions(&unlowered(problem)))
    {
        let size = b.force_ground.norm() + b.torque_ground.norm();
        let off =
            (a.force_ground - b.force_ground).norm() + (a.torque_ground - b.torque_ground).norm();
        assert!(off <= 1e-7 * size, "{off:e} of {size}");
    }
}
