//! Functions over windows of time, and combined and relative quantities: exact derivatives by every method, and
//! closed forms.

use crate::gradients_match_complex_step::{compare_to, explicit, implicit};
use crate::kinks::{exact, pushed, triangle};
use crate::reference;
use crate::reference::documents::{problem, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::functions::seen::{Seen, SeenPart};
use flexbody_mechanics::functions::{
    Bound, Edge, Function, Instant, Operation, Quantity, Reach, Reduction, Scene, Window,
};
use flexbody_mechanics::model::load::{Load, LoadKind};
use flexbody_mechanics::model::{Axes, DegreeOfFreedom, Model, TimeFunction};
use flexbody_mechanics::system::measures::{End, Wrench, WrenchPart};
use serde_json::Value;

fn combined(operation: Operation, of: Vec<Quantity<f64>>) -> Quantity<f64> {
    Quantity::Combined { operation, of }
}

/// Quantities of the last body, of the first joint and of the first loads.
fn quantities(model: &Model<f64>) -> Vec<Quantity<f64>> {
    let body = model.bodies.len() - 1;
    let (point, eye) = (Vec3::new(0.1, 0.4, -0.2), Vec3::new(-0.3, 0.2, 0.1));
    let direction = Vec3::new(0.6, 0.64, -0.48);
    let position = || {
        Quantity::Of(Instant::Position {
            body,
            point,
            direction,
        })
    };
    let seen = |part, from| {
        Quantity::Of(Instant::Seen(Seen {
            part,
            body,
            point,
            from,
            eye,
            direction,
        }))
    };
    let reaction = |joint, part| {
        Quantity::Of(Instant::Reaction(Wrench {
            joint,
            on: End::A,
            part,
            axes: Axes::Body,
            direction,
        }))
    };
    let acceleration = Quantity::Of(Instant::Acceleration {
        body,
        point,
        direction,
    });
    let rate = |dof| Quantity::Of(Instant::JointRate { joint: 0, dof });
    let loads = 0..model.loads.len();
    let mut all = vec![
        position(),
        Quantity::Of(Instant::Felt {
            body,
            point,
            direction,
        }),
        seen(SeenPart::Position, Some(0)),
        seen(SeenPart::Velocity, Some(0)),
        seen(SeenPart::Distance, Some(0)),
        seen(SeenPart::Position, None),
        seen(SeenPart::Velocity, None),
        seen(SeenPart::Distance, None),
        rate(DegreeOfFreedom::Rotation),
        combined(Operation::Rate, vec![acceleration]),
        combined(
            Operation::Product,
            vec![
                reaction(0, WrenchPart::Moment),
                reaction(1, WrenchPart::Force),
                rate(DegreeOfFreedom::Rotation),
            ],
        ),
        combined(
            Operation::Quotient,
            vec![position(), seen(SeenPart::Distance, None)],
        ),
        combined(
            Operation::Difference,
            vec![
                combined(Operation::Square, vec![position()]),
                combined(Operation::Rate, vec![position()]),
            ],
        ),
        combined(Operation::Absolute { width: 0.1 }, vec![position()]),
    ];
    all.extend(loads.map(|load| Quantity::Of(Instant::Power(Some(load)))));
    all
}

/// Every reduction over every kind of window, each of another quantity in turn.
fn functions(model: &Model<f64>, duration: f64, first: usize) -> Vec<Function<f64>> {
    let all = quantities(model);
    let height = || {
        Quantity::Of(Instant::Position {
            body: model.bodies.len() - 1,
            point: Vec3::zeros(),
            direction: Vec3::y(),
        })
    };
    let start = model.bodies[model.bodies.len() - 1].position.y;
    let reach = |below, rises| {
        Edge::When(Reach {
            of: height(),
            value: start - below,
            rises,
        })
    };
    let window = |from, to| Some(Window { from, to });
    let windows = [
        window(Edge::At(0.23 * duration), Edge::At(0.71 * duration)),
        window(Edge::Start, Edge::At(0.51 * duration)),
        window(Edge::At(0.91 * duration), Edge::End),
        window(reach(0.01, Some(false)), Edge::End),
        window(Edge::Start, reach(0.02, None)),
        None,
    ];
    // Jerks are of the order of a thousand.
    let rho = 0.01;
    let reductions = [
        Reduction::Final,
        Reduction::Integral,
        Reduction::Mean,
        Reduction::Ks {
            rho,
            bound: Bound::Below,
        },
        Reduction::Ks {
            rho,
            bound: Bound::Above,
        },
        Reduction::InducedExponential { rho },
        Reduction::Damage {
            slope: 3.3,
            strength: 5.0,
        },
    ];
    let count = all.len();
    let mut functions = Vec::new();
    for (w, during) in windows.iter().enumerate() {
        for (r, &reduction) in reductions.iter().enumerate() {
            functions.push(Function::Reduced {
                of: all[(first + 7 * w + r) % count].clone(),
                during: during.clone(),
                reduction,
            });
        }
    }
    functions
}

/// A pendulum of three bodies in space, with one load of each kind.
fn loaded() -> Model<f64> {
    let (mut model, _) = reference::load("triple_pendulum");
    let kinds = [
        LoadKind::Force {
            body: 1,
            point: Vec3::new(0.1, -0.1, 0.2),
            direction: Vec3::new(0.3, 1.0, -0.4),
            axes: Axes::Ground,
            magnitude: TimeFunction::Polynomial(vec![0.4, 0.3, -0.7]),
        },
        LoadKind::Force {
            body: 2,
            point: Vec3::new(0.1, -0.1, 0.2),
            direction: Vec3::new(0.3, 1.0, -0.4),
            axes: Axes::Body,
            magnitude: TimeFunction::Harmonic {
                mean: 0.1,
                amplitude: 0.4,
                frequency: 3.0,
                phase: 0.3,
            },
        },
        LoadKind::Torque {
            body: 1,
            direction: Vec3::new(0.3, 0.2, -0.4),
            axes: Axes::Ground,
            magnitude: TimeFunction::constant(0.2),
        },
        LoadKind::Spring {
            body_a: 2,
            body_b: Some(0),
            point_a: Vec3::new(0.1, 0.2, 0.3),
            point_b: Vec3::new(-0.3, 0.1, -0.2),
            rest_length: 0.2,
            stiffness: 5.0,
            cubic: 0.7,
            damping: 0.3,
            tables: [None, None],
        },
        LoadKind::Damping {
            joint: 0,
            dof: DegreeOfFreedom::Rotation,
            coefficient: 0.2,
            table: None,
        },
        LoadKind::BallDamping {
            joint: 1,
            coefficient: 0.1,
        },
        LoadKind::Friction {
            joint: 0,
            dof: DegreeOfFreedom::Rotation,
            size: 0.2,
            width: 0.5,
        },
    ];
    let loads = kinds.into_iter().enumerate();
    model.loads.extend(loads.map(|(i, kind)| Load {
        name: format!("load {i}"),
        kind,
    }));
    model
}

fn scene(model: &Model<f64>, duration: f64, first: usize) -> Scene<f64> {
    Scene {
        model: model.clone(),
        duration,
        until: None,
        functions: functions(model, duration, first),
        unstarted: None,
    }
}

fn has_rate(of: &Quantity<f64>) -> bool {
    match of {
        Quantity::Of(_) => false,
        Quantity::Combined { operation, of } => {
            *operation == Operation::Rate || of.iter().any(has_rate)
        }
    }
}

/// Size and tolerance of derivatives. A rate divides round-off by the distance of samples, here 1e-3 … 1e-2 s: that of powers
/// is then up to 1.2e-10. Powers and reactions that cancel to zero have the round-off of their terms, of the order of ten.
fn size_and_tolerance(function: &Function<f64>, value: f64) -> (f64, f64) {
    let tolerance = match function.quantity().is_some_and(has_rate) {
        true => 3e-10,
        false => 1e-11,
    };
    (value.abs().max(1.0), tolerance)
}

/// Three directions that change all parameters, in proportion to their size.
fn directions(scene: &Scene<f64>) -> Vec<Vec<f64>> {
    let parameters = scene.parameters();
    let golden = |i: usize| ((i as f64 + 1.0) * 0.618_033_988_75).fract() - 0.5;
    let along = |d: usize| {
        let all = parameters.iter().enumerate();
        all.map(|(i, p)| golden(i * 3 + d) * p.abs().max(0.1))
            .collect()
    };
    (0..3).map(along).collect()
}

#[test]
fn derivatives_are_exact_by_every_method() {
    let model = loaded();
    let explicit = explicit(&model, 0.4, 10);
    let implicit = implicit(&model, 0.4, 40);
    for (i, settings) in explicit.iter().chain(&implicit).enumerate() {
        let scene = scene(&model, 0.4, 5 * i);
        compare_to(&scene, settings, &directions(&scene), size_and_tolerance);
    }
}

#[test]
fn derivatives_are_exact_for_every_quantity_and_window() {
    let model = loaded();
    let settings = &explicit(&model, 0.4, 10)[1];
    for first in 0..quantities(&model).len() {
        let scene = scene(&model, 0.4, first);
        compare_to(
            &scene,
            settings,
            &directions(&scene)[..1],
            size_and_tolerance,
        );
    }
}

/// A mass on a slide, pushed by a force that rises to 1 N at 1 s and falls to zero at 2 s.
fn with_functions(functions: Value, simulation: Value) -> Value {
    let mut document = pushed(triangle(), simulation);
    document["functions"] = functions;
    document["variables"] = json!({
        "mass": {"path": "/bodies/m/mass", "lower": 0.1, "upper": 10},
        "T": {"path": "/simulation/duration", "lower": 2.5, "upper": 5}
    });
    document
}

/// Windows that end on samples, between them and at kinks, by methods of high order on their own and on equal
/// steps.
#[test]
fn windows_of_a_pushed_mass_have_closed_forms() {
    let x = json!({"position": {"body": "m", "direction": [1, 0, 0]}});
    let v = json!({"velocity": {"body": "m", "direction": [1, 0, 0]}});
    let within = |of: &Value, ends: [f64; 2]| json!({"of": of, "during": ends});
    let at = |of: &Value, t: f64| json!({"value": {"at": t, "of": of}});
    let crossing = json!({"when": x, "rises_to": 0.5});
    let settings = [
        json!({"duration": 3, "tolerance": 1e-11}),
        json!({"duration": 3, "steps": 30}),
        json!({"duration": 3, "steps": 31, "method": {"radau": {"stages": 3}}}),
        json!({"duration": 3, "tolerance": 1e-10, "method": {"radau": {"stages": 3}}}),
    ];
    let place = |t: f64| exact(t)[1];
    let speed = |t: f64| exact(t)[0];
    // The time at which x = 0.5, by bisection of the closed form.
    let (mut low, mut high) = (0.0, 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match place(middle) < 0.5 {
            true => low = middle,
            false => high = middle,
        }
    }
    for simulation in settings {
        for [from, to] in [
            [0.0, 1.0],
            [0.5, 1.3],
            [1.0, 2.0],
            [0.123, 2.77],
            [1.7, 3.0],
            [0.0, 3.0],
        ] {
            let document = with_functions(
                json!({
                    "way": {"integral": within(&v, [from, to])},
                    "speed": {"mean": within(&v, [from, to])},
                    "end": {"final": within(&x, [from, to])},
                    "at": at(&x, to),
                    "energy": {"integral": {"of": {"power": {"load": "F"}}, "during": [from, to]}},
                    "after": {"integral": {"of": v, "during": {"from": crossing}}},
                    "there": {"value": {"at": crossing, "of": v}},
                    "acceleration": {"value": {"at": to, "of": {"rate": x}}},
                    "largest": {"ks": {"rho": 1e4, "of": v, "bound": "above", "during": [from, to]}}
                }),
                simulation.clone(),
            );
            let found = values(&document);
            let way = place(to) - place(from);
            let work = 0.5 * (speed(to).powi(2) - speed(from).powi(2));
            let wanted = [
                way,
                way / (to - from),
                place(to),
                place(to),
                work,
                place(3.0) - 0.5,
                speed(low),
                speed(to),
                speed(to),
            ];
            for (i, (found, wanted)) in found.iter().zip(wanted).enumerate() {
                let off = (found - wanted).abs();
                assert!(
                    off < 2e-9,
                    "{simulation} [{from}, {to}]: function {i} is {found}, not {wanted}: {off:e}"
                );
            }
            gradients_are_exact(&problem(&document), &json!([simulation, from, to]));
        }
    }
}
