//! Derivatives of motions at rest, against the small motions about the rest in closed form; and
//! gradients that the steps do not resolve, which are refused by name.

use crate::reference::documents::optimised;
use flexbody_driver::check;
use flexbody_driver::evaluate::Evaluated;
use flexbody_driver::resolved;
use flexbody_mechanics::integrate::{Settings, Spacing, simulate};
use flexbody_optimiser::Status;
use flexbody_problem::Problem;
use std::path::Path;

fn parse(text: &str) -> Problem {
    Problem::parse(text, "rest.json", &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// The gradients of all functions, and the number of steps.
fn gradients(problem: &Problem) -> (Vec<Vec<f64>>, usize) {
    let at = Evaluated::new(problem, &problem.start()).expect("runs");
    let all: Vec<usize> = (0..at.scene.functions.len()).collect();
    let found = at.gradients(problem, &all).expect("has gradients").0;
    (found, at.run.grid.steps())
}

/// A bob of mass m and moment of inertia J about its centre at the distance l from its pin, below
/// it, or above it if l is negative. Gravity g points along `down`, and the hinge has the axis
/// `axis`.
struct Pendulum {
    m: f64,
    inertia: f64,
    l: f64,
    g: f64,
    down: [f64; 3],
    axis: [f64; 3],
    duration: f64,
    simulation: &'static str,
}

impl Pendulum {
    fn problem(&self) -> Problem {
        let Self { m, inertia, l, .. } = *self;
        let along = |s: f64| format!("{:?}", self.down.map(|x| s * x));
        let text = format!(
            r#"{{"version": 1, "name": "pendulum", "gravity": {gravity},
            "bodies": {{"bob": {{"mass": {m}, "inertia": {{"xx": {inertia}, "yy": {inertia}, "zz": {inertia}}},
                "points": {{"pin": {pin}}}, "place": {{"put": "pin", "at": [0, 0, 0]}}}}}},
            "joints": {{"hinge": {{"revolute": {{"between": ["bob", "ground"], "at": [0, 0, 0], "axis": {axis:?},
                "start": {{"turn": {{"rate": 0}}}}}}}}}},
            "simulation": {{"duration": {duration}{simulation}}},
            "functions": {{"angle": {{"final": {{"angle": {{"joint": "hinge"}}}}}},
                "rate": {{"final": {{"angular_velocity": {{"body": "bob", "direction": {axis:?}}}}}}}}},
            "variables": {{"rate0": {{"path": "/joints/hinge/revolute/start/turn/rate", "lower": -1, "upper": 1}}}},
            "objective": {{"minimise": "angle"}}}}"#,
            gravity = along(self.g),
            pin = along(-l),
            axis = self.axis,
            duration = self.duration,
            simulation = self.simulation,
        );
        parse(&text)
    }

    /// Derivatives of angle and rate by the initial rate: φ̈ = −ω² φ with ω² = m g l / (J + m l²).
    fn exact(&self) -> [f64; 2] {
        let square = self.m * self.g * self.l / (self.inertia + self.m * self.l * self.l);
        let omega = square.abs().sqrt();
        let x = omega * self.duration;
        match square > 0.0 {
            true => [x.sin() / omega, x.cos()],
            false => [x.sinh() / omega, x.cosh()],
        }
    }
}

const RADAU: &str = r#", "method": {"radau": {"stages": 3}}"#;

/// Pendulums that hang, or stand, at rest, in other units, planes, durations and tolerances. At the
/// default tolerance their derivatives have five digits; fewer at a coarser one, more at a finer.
#[test]
fn pendulums_at_rest_have_the_derivatives_of_small_oscillations() {
    let hanging = |duration: f64, simulation: &'static str| Pendulum {
        m: 1.0,
        inertia: 0.02,
        l: 0.5,
        g: 9.81,
        down: [0.0, -1.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        duration,
        simulation,
    };
    let cases = [
        (hanging(3.1, ""), 1e-5),
        (
            // Nearly a point.
            Pendulum {
                inertia: 1e-9,
                ..hanging(2.0, "")
            },
            1e-5,
        ),
        (hanging(14.0, ""), 1e-5),
        (hanging(5.0, r#", "tolerance": 1e-6"#), 2e-3),
        (hanging(5.0, r#", "tolerance": 1e-12"#), 1e-8),
        (hanging(3.0, r#", "method": "dop853""#), 1e-5),
        (hanging(2.0, RADAU), 1e-5),
        (hanging(13.0, RADAU), 1e-5),
        (
            hanging(6.0, r#", "method": {"radau": {"stages": 2}}"#),
            1e-4,
        ),
        (
            hanging(
                4.0,
                r#", "method": {"radau": {"stages": 3}}, "tolerance": 1e-6"#,
            ),
            1e-3,
        ),
        (
            Pendulum {
                l: -0.3,
                ..hanging(1.5, "")
            },
            1e-5,
        ),
        (
            Pendulum {
                l: -0.3,
                ..hanging(1.5, RADAU)
            },
            1e-5,
        ),
        (
            // Millimetres and tonnes.
            Pendulum {
                m: 0.002,
                inertia: 30.0,
                l: 240.0,
                g: 9810.0,
                ..hanging(4.0, "")
            },
            1e-5,
        ),
        (
            Pendulum {
                down: [0.6, 0.0, 0.8],
                axis: [-0.64, 0.6, 0.48],
                ..hanging(4.4, "")
            },
            1e-5,
        ),
        (
            Pendulum {
                down: [1.0, 0.0, 0.0],
                axis: [0.0, 1.0, 0.0],
                ..hanging(2.5, "")
            },
            1e-5,
        ),
    ];
    for (k, (pendulum, tolerance)) in cases.iter().enumerate() {
        let (found, steps) = gradients(&pendulum.problem());
        let exact = pendulum.exact();
        for (f, exact) in exact.into_iter().enumerate() {
            let error = (found[f][0] - exact).abs();
            // The size of an oscillation, not its value, which may be near a zero.
            let size = match pendulum.l > 0.0 {
                true => pendulum.exact()[f].abs().max([0.2, 1.0][f]),
                false => exact.abs(),
            };
            assert!(error < tolerance * size, "case {k}: {found:?}, {exact}");
        }
        assert!(steps < 1200, "case {k}: {steps} steps");
    }
}

/// The bob of a pendulum may have hardly any inertia of its own: adjoint and complex step agree to round-off.
#[test]
fn points_on_strings_have_exact_derivatives() {
    for inertia in [1e-12, 1e-9, 1e-7, 1e-5] {
        for (down, axis) in [
            ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.6, 0.0, 0.8], [-0.64, 0.6, 0.48]),
        ] {
            let problem = Pendulum {
                m: 1.0,
                inertia,
                l: 0.5,
                g: 9.81,
                down,
                axis,
                duration: 2.0,
                simulation: "",
            }
            .problem();
            for own in check(&problem, &problem.start()).expect("runs") {
                let off = (own.adjoint - own.complex_step).abs();
                assert!(off < 1e-10 * own.complex_step.abs(), "{inertia}: {own:?}");
            }
        }
    }
}

/// A mass at rest on a spring and damper along `axis`, beside a pendulum that swings if `beside`.
fn table(
    [m, k, c]: [f64; 3],
    axis: [f64; 3],
    (duration, beside): (f64, bool),
    simulation: &str,
) -> Problem {
    let at = |s: f64| format!("{:?}", axis.map(|x| s * x));
    let (bob, hinge) = match beside {
        true => (
            r#""bob": {"mass": 1, "inertia": {"xx": 0.001, "yy": 0.001, "zz": 0.001},
                "points": {"pin": [0, 0.5, 0]}, "place": {"put": "pin", "at": [0, 0, 0]}},"#,
            r#""hinge": {"revolute": {"between": ["bob", "ground"], "at": [0, 0, 0],
                "axis": [0, 0, 1], "start": {"turn": {"angle": 1}}}},"#,
        ),
        false => ("", ""),
    };
    let text = format!(
        r#"{{"version": 1, "name": "table", "gravity": [0, {g}, 0],
        "bodies": {{{bob} "table": {{"mass": {m}, "inertia": {{"xx": 1, "yy": 1, "zz": 1}}, "place": {{"at": {here}}}}}}},
        "joints": {{{hinge} "guide": {{"prismatic": {{"between": ["table", "ground"], "at": {here}, "axis": {axis:?}}}}}}},
        "loads": {{"F": {{"force": {{"body": "table", "direction": {axis:?}, "magnitude": 0}}}},
            "k": {{"spring": {{"between": ["table", "ground"], "at": {{"a": [0, 0, 0], "b": {there}}},
                "rest_length": 1, "stiffness": {k}, "damping": {c}}}}}}},
        "simulation": {{"duration": {duration}{simulation}}},
        "functions": {{"x": {{"final": {{"slide": {{"joint": "guide"}}}}}}}},
        "variables": {{"F": {{"path": "/loads/F/force/magnitude", "lower": -1, "upper": 1}}}},
        "objective": {{"minimise": "x"}}}}"#,
        g = if beside { -9.81 } else { 0.0 },
        here = at(2.0),
        there = at(3.0),
    );
    parse(&text)
}

/// dx/dF of m ẍ + c ẋ + k x = F from rest.
fn by_force([m, k, c]: [f64; 3], t: f64) -> f64 {
    let half = 0.5 * c / m;
    let square = half * half - k / m;
    let root = square.abs().sqrt();
    let decays = match square > 0.0 {
        true => {
            let (a, b) = (-half + root, -half - root);
            (a * (b * t).exp() - b * (a * t).exp()) / (a - b)
        }
        false => (-half * t).exp() * ((root * t).cos() + half / root * (root * t).sin()),
    };
    (1.0 - decays) / k
}

/// A mass at rest on a stiff spring, on a weak one, on strong dampers, beside a moving pendulum and
/// alone: the derivative by the force on it is the response to a step.
#[test]
fn masses_at_rest_on_springs_have_the_derivative_of_the_response_to_a_step() {
    let x = [1.0, 0.0, 0.0];
    for (k, (law, axis, run, simulation)) in [
        ([1.0, 1e4, 0.0], x, (0.7, true), ""),
        ([2.0, 450.0, 0.0], [0.0, 0.0, 1.0], (1.3, true), ""),
        ([1.0, 25.0, 0.0], [0.6, 0.8, 0.0], (3.0, false), ""),
        ([1.0, 10.0, 1000.0], x, (0.5, true), ""),
        ([1.0, 50.0, 300.0], [0.0, 0.0, 1.0], (2.0, false), ""),
        ([3.0, 1e4, 5.0], x, (0.4, true), r#", "tolerance": 1e-10"#),
        ([1e-3, 4.0, 1e-4], x, (1.1, true), r#", "method": "dop853""#),
        ([1.0, 1e4, 0.0], x, (0.7, true), RADAU),
        ([1.0, 1e5, 0.0], [0.6, 0.0, 0.8], (1.7, false), RADAU),
        ([1.0, 10.0, 1000.0], x, (0.5, true), RADAU),
        // Stiff, so that an implicit method is chosen.
        ([1.0, 1e3, 1e6], x, (8.0, false), ""),
    ]
    .into_iter()
    .enumerate()
    {
        let problem = table(law, axis, run, simulation);
        let (found, _) = gradients(&problem);
        let exact = by_force(law, run.0);
        let error = (found[0][0] - exact).abs();
        assert!(error < 1e-4 / law[1], "case {k}: {found:?}, {exact}");
    }
}

/// A damper so stiff that an implicit method is chosen, and a pendulum beside it, both at rest: steps pass over the
/// damper's part and resolve the pendulum.
#[test]
fn stiff_scenes_at_rest_resolve_what_vibrates() {
    for (duration, damping) in [(8.0, 1e6), (20.0, 1e5)] {
        let problem = parse(&format!(
            r#"{{"version": 1, "name": "stiff", "gravity": [0, -9.81, 0],
            "bodies": {{"bob": {{"mass": 1, "inertia": {{"xx": 0.01, "yy": 0.01, "zz": 0.01}},
                    "points": {{"pin": [0, 0.5, 0]}}, "place": {{"put": "pin", "at": [0, 0, 0]}}}},
                "slider": {{"mass": 1, "inertia": {{"xx": 1, "yy": 1, "zz": 1}}, "place": {{"at": [3, 0, 0]}}}}}},
            "joints": {{"hinge": {{"revolute": {{"between": ["bob", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}}},
                "guide": {{"prismatic": {{"between": ["slider", "ground"], "at": [3, 0, 0], "axis": [1, 0, 0]}}}}}},
            "loads": {{"F": {{"force": {{"body": "bob", "direction": [1, 0, 0], "magnitude": 0}}}},
                "k": {{"spring": {{"between": ["slider", "ground"], "at": {{"a": [3, 0, 0], "b": [5, 0, 0]}},
                    "rest_length": 2, "stiffness": 1000, "damping": {damping}}}}}}},
            "simulation": {{"duration": {duration}}},
            "functions": {{"angle": {{"final": {{"angle": {{"joint": "hinge"}}}}}},
                "x": {{"final": {{"slide": {{"joint": "guide"}}}}}}}},
            "variables": {{"F": {{"path": "/loads/F/force/magnitude"}}}},
            "objective": {{"minimise": "angle"}}}}"#
        ));
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        assert!(
            at.run.method.name().starts_with("radau"),
            "{}",
            at.run.method.name()
        );
        let (found, _) = at.gradients(&problem, &[0, 1]).expect("differentiates");
        let (inertia, omega) = (0.26, (9.81 * 0.5 / 0.26_f64).sqrt());
        let exact = 0.5 * (1.0 - (omega * duration).cos()) / (inertia * omega * omega);
        assert!((found[0][0] - exact).abs() < 2e-5, "{found:?}, {exact}");
        assert!(at.run.grid.steps() < 2000, "{}", at.run.grid.steps());
    }
}

/// Steps that follow a motion resolve its tangent: they are the same with and without derivatives,
/// to the last bit, and cost less than 2 % more evaluations.
#[test]
fn a_moving_scene_keeps_its_steps() {
    for name in [
        "trebuchet",
        "triple_pendulum",
        "extreme/double_pendulum",
        "extreme/parallelogram",
        "extreme/tumbling_top",
        "benchmarks/simple_pendulum",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        let problem = Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
        let scene = problem.scene(&problem.start());
        let run = |derivatives: bool| {
            let settings = Settings {
                spacing: Spacing::Tolerance(1e-9),
                derivatives,
                ..Settings::steps(flexbody_mechanics::integrate::Method::Dop853, 1)
            };
            simulate(&scene.model, scene.duration, &settings).expect("runs")
        };
        let [with, without] = [true, false].map(run);
        assert_eq!(with.grid, without.grid, "{name}");
        let [more, fewer] = [&with, &without].map(|run| run.counts.evaluations);
        assert!(
            more > fewer && 50 * (more - fewer) < fewer + 1000,
            "{name}: {more}, {fewer}"
        );
    }
}

/// Given steps that are too few for the tangent are refused by name, in the check and by the
/// optimiser; enough steps, and derivatives that are zero, are not.
#[test]
fn unresolved_gradients_are_refused_by_name() {
    let hanging = |simulation: &'static str| Pendulum {
        m: 1.0,
        inertia: 0.02,
        l: 0.5,
        g: 9.81,
        down: [0.0, -1.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        duration: 10.0,
        simulation,
    };
    for few in [
        r#", "steps": 5, "method": "dop853""#,
        r#", "steps": 8, "method": {"radau": {"stages": 3}}"#,
        r#", "steps": 30, "method": {"bdf": {"order": 2}}"#,
    ] {
        let problem = hanging(few).problem();
        let found = resolved::of_design(&problem, &problem.start()).expect("runs");
        let names: Vec<(usize, usize)> = found.iter().map(|own| own.of).collect();
        assert!(names.contains(&(0, 0)), "{few}: {found:?}");
        let done = optimised(&problem);
        let Status::UndefinedStart { what } = &done.outcome.status else {
            panic!("{few}: {:?}", done.outcome.status);
        };
        let named = what.contains("\"angle\" by \"rate0\"") && what.contains("steps");
        assert!(named, "{what}");
    }
    for enough in [
        "",
        r#", "steps": 80, "method": "dop853""#,
        r#", "steps": 300, "method": {"radau": {"stages": 3}}"#,
    ] {
        let problem = hanging(enough).problem();
        let found = resolved::of_design(&problem, &problem.start()).expect("runs");
        assert!(found.is_empty(), "{enough}: {found:?}");
    }
    // The fall of a body does not depend on its mass.
    let falling = parse(
        r#"{"version": 1, "name": "fall", "gravity": [0, -9.81, 0],
        "bodies": {"a": {"shape": {"box": {"size": [1, 2, 3]}}, "mass": 2, "velocity": {"angular": [1, 2, 3]}}},
        "simulation": {"duration": 1},
        "functions": {"y": {"final": {"position": {"body": "a", "direction": [0, 1, 0]}}}},
        "variables": {"m": {"path": "/bodies/a/mass", "lower": 0.1}}}"#,
    );
    let found = resolved::of_design(&falling, &falling.start()).expect("runs");
    assert!(found.is_empty(), "{found:?}");
}

/// A mass on a spring that is made as stiff as the file allows. Its place at the end has the derivative
/// −T sin(ωT)/(2 m ω) by the stiffness. Steps that resolve it at the start may be too long at the end, which is told by
/// name.
#[test]
fn gradients_that_only_the_end_does_not_resolve_are_told() {
    let method = r#"{"generalised_alpha": {"radius": 0.8}}"#;
    let radau = r#"{"radau": {"stages": 2}}"#;
    for (method, steps, stiffest, told) in [
        (method, 60, 900.0, true),
        (method, 60, 2.0, false),
        (method, 8000, 900.0, false),
        (radau, 30, 900.0, true),
        (radau, 1000, 900.0, false),
    ] {
        let problem = parse(&format!(
            r#"{{"version": 1, "name": "spring", "gravity": [0, 0, 0],
            "bodies": {{"bob": {{"mass": 1, "inertia": {{"xx": 1, "yy": 1, "zz": 1}}, "place": {{"put": [0, 0, 0], "at": [1, 0, 0]}}}}}},
            "loads": {{"spring": {{"spring": {{"between": ["bob", "ground"], "at": {{"a": [0, 0, 0], "b": [-2, 0, 0]}}, "rest_length": 2, "stiffness": 1}}}}}},
            "simulation": {{"duration": 2, "steps": {steps}, "method": {method}}},
            "functions": {{"place": {{"final": {{"position": {{"body": "bob", "direction": [1, 0, 0]}}}}}},
                "action": {{"integral": {{"energy": "kinetic"}}}}}},
            "variables": {{"stiffness": {{"path": "/loads/spring/spring/stiffness", "lower": 0.5, "upper": {stiffest}}}}},
            "objective": {{"maximise": "action"}},
            "constraints": {{"place": {{"function": "place", "lower": -10, "upper": 10}}}}}}"#
        ));
        let found = optimised(&problem);
        assert_eq!(found.outcome.status, Status::Converged, "{method} {steps}");
        // Steps that damp the motion have their largest action before the bound.
        assert!(found.optimum.design["stiffness"].value > 0.1 * stiffest);
        let words = "at the end the steps do not resolve the gradient: ";
        let name = "the derivative of \"place\" by \"stiffness\"";
        let is_told = |text: &String| text.starts_with(words) && text.contains(name);
        let warned = found.optimum.warnings.iter().any(is_told);
        assert_eq!(
            warned, told,
            "{method} {steps} {:?}",
            found.optimum.warnings
        );
    }
}
