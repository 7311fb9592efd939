//! Random scenes of rigid bodies, and the same scene seen otherwise: turned, in other units, in another order.

use crate::numbers::{Numbers, Turn, Vector};
use serde_json::{Map, Value, json};

/// How a scene is written. All views of a scene move alike.
pub struct View {
    /// Rotation of the whole scene.
    pub turn: Turn,
    /// Units of length, mass and time, as numbers of the file for one m, kg, s.
    pub units: [f64; 3],
    /// Order of bodies, joints, loads and functions: a seed, or as they were made.
    pub order: Option<u64>,
    /// Whether the second body of each joint comes first.
    pub swapped: bool,
}

impl View {
    /// The scene as it was made.
    pub const PLAIN: Self = Self {
        turn: Turn::NONE,
        units: [1.0; 3],
        order: None,
        swapped: false,
    };
}

/// Exponents of length, mass and time of a quantity.
type Unit = [i32; 3];

const LENGTH: Unit = [1, 0, 0];
const MASS: Unit = [0, 1, 0];
const NUMBER: Unit = [0, 0, 0];
const RATE: Unit = [0, 0, -1];
const SPEED: Unit = [1, 0, -1];
const ACCELERATION: Unit = [1, 0, -2];
const FORCE: Unit = [1, 1, -2];
const MOMENT: Unit = [2, 1, -2];
const TIME: Unit = [0, 0, 1];

/// What a scene is like.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Any joints and loads in space.
    Space,
    /// Hinges and slides in one plane, which is any.
    Plane,
    /// A chain that hangs at rest, and feels no force but its weight.
    Rest,
}

#[derive(Clone)]
struct Body {
    size: Vector,
    mass: f64,
    turn: Turn,
    joint: &'static str,
    axis: Vector,
    rate: f64,
    /// Torsion spring and damping of the joint, where it has them.
    spring: Option<[f64; 2]>,
    damping: Option<f64>,
}

/// A chain of boxes with joints, springs, forces and functions.
#[derive(Clone)]
pub struct Scene {
    bodies: Vec<Body>,
    gravity: Vector,
    duration: f64,
    /// Frequency, magnitude and direction of a force on the last body.
    force: Option<(f64, f64, Vector)>,
    /// Stiffness, damping and ground point of a spring from the last body.
    spring: Option<(f64, f64, Vector)>,
    /// Rate of a motor of the first joint.
    motor: Option<f64>,
    look: Vector,
}

/// A function of a scene: its name, unit, whether a joint's angle measures it, and itself.
struct Function {
    name: &'static str,
    unit: Unit,
    value: Value,
}

impl Scene {
    /// A scene of this kind.
    pub fn random(numbers: &mut Numbers, kind: Kind) -> Self {
        let normal = numbers.direction();
        let in_plane = |v: Vector| {
            let along = crate::numbers::dot(v, normal);
            std::array::from_fn(|k| v[k] - along * normal[k])
        };
        let gravity = numbers.direction().map(|x| 9.81 * x);
        let count = 1 + numbers.below(3);
        let bodies = (0..count)
            .map(|_| Body::random(numbers, kind, normal))
            .collect();
        let mut scene = Self {
            bodies,
            gravity,
            duration: numbers.between(0.3, 1.2),
            force: numbers.chance(0.5).then(|| {
                (
                    numbers.between(0.2, 2.0),
                    numbers.between(-5.0, 5.0),
                    numbers.direction(),
                )
            }),
            spring: numbers.chance(0.4).then(|| {
                let place = numbers.direction().map(|x| 3.0 * x);
                (numbers.between(5.0, 80.0), numbers.between(0.0, 1.0), place)
            }),
            motor: numbers.chance(0.2).then(|| numbers.between(-3.0, 3.0)),
            look: numbers.direction(),
        };
        match kind {
            Kind::Space => {}
            Kind::Plane => {
                scene.gravity = in_plane(scene.gravity);
                scene.force = scene
                    .force
                    .map(|(f, size, along)| (f, size, in_plane(along)));
                scene.spring = scene.spring.map(|(k, c, at)| (k, c, in_plane(at)));
            }
            Kind::Rest => {
                scene.gravity = in_plane(scene.gravity);
                (scene.spring, scene.motor) = (None, None);
                scene.force = Some((0.0, 0.0, in_plane(scene.look)));
                // A box hangs from its near end, its first axis along gravity.
                let down = scene
                    .gravity
                    .map(|g| g / crate::numbers::dot(scene.gravity, scene.gravity).sqrt());
                let axis = crate::numbers::cross([1.0, 0.0, 0.0], down);
                let sine = crate::numbers::dot(axis, axis).sqrt();
                let turn = Turn {
                    axis: axis.map(|x| x / sine),
                    angle: sine.atan2(down[0]),
                };
                for body in &mut scene.bodies {
                    body.turn = turn;
                    body.rate = 0.0;
                    body.spring = None;
                    body.axis = normal;
                }
            }
        }
        if !scene.bodies[0].turns() {
            scene.motor = None;
        }
        scene
    }

    /// The problem file of this view with this entry of `simulation` beside the duration.
    pub fn document(&self, view: &View, simulation: &Value) -> Value {
        let scale = |unit: Unit| scale(view, unit);
        let turned = |v: Vector, unit: Unit| view.turn.of(v).map(|x| x * scale(unit));
        let (mut bodies, mut joints, mut loads) = (Vec::new(), Vec::new(), Vec::new());
        for (i, body) in self.bodies.iter().enumerate() {
            // Ground counts as the second body on either side.
            let sign = if view.swapped && i > 0 { -1.0 } else { 1.0 };
            let name = format!("b{i}");
            let (parent, at) = match i {
                0 => ("ground".to_owned(), json!(turned([0.3, -0.2, 0.1], LENGTH))),
                _ => (format!("b{}", i - 1), json!(format!("b{}.far", i - 1))),
            };
            let half = 0.5 * body.size[0] * scale(LENGTH);
            let turns = [&body.turn, &view.turn]
                .map(|turn| json!({"axis": turn.axis, "angle": turn.angle}));
            bodies.push((
                name.clone(),
                json!({
                    "shape": {"box": {"size": body.size.map(|x| x * scale(LENGTH))}},
                    "mass": body.mass * scale(MASS),
                    "points": {"near": [-half, 0, 0], "far": [half, 0, 0]},
                    "place": {"put": "near", "at": at, "turn": turns},
                }),
            ));
            let between = if view.swapped {
                [&parent, &name]
            } else {
                [&name, &parent]
            };
            let mut keys = Map::new();
            keys.insert("between".into(), json!(between));
            keys.insert("at".into(), json!(format!("{name}.near")));
            if body.joint != "spherical" {
                keys.insert("axis".into(), json!(view.turn.of(body.axis)));
            }
            if body.joint == "universal" {
                // The axis is that of the first body, the cross axis that of the second.
                let cross = view
                    .turn
                    .of(crate::numbers::cross(body.axis, [0.36, 0.48, 0.8]));
                let axis = view.turn.of(body.axis);
                let (axis, cross) = if view.swapped {
                    (cross, axis)
                } else {
                    (axis, cross)
                };
                keys.insert("axis".into(), json!(axis));
                keys.insert("cross".into(), json!(cross));
            }
            let driven = i == 0 && self.motor.is_some();
            if body.turns() && !driven {
                let rate = sign * body.rate * scale(RATE);
                keys.insert("start".into(), json!({"turn": {"rate": rate}}));
            }
            joints.push((format!("j{i}"), json!({body.joint: keys})));
            if let Some([stiffness, rest]) = body.spring {
                loads.push((format!("k{i}"), json!({"torsion_spring": {
                    "joint": format!("j{i}"), "stiffness": stiffness * scale(MOMENT), "rest_angle": sign * rest,
                }})));
            }
            if let Some(damping) = body.damping {
                loads.push((
                    format!("c{i}"),
                    json!({"damping": {
                        "joint": format!("j{i}"), "coefficient": damping * scale([2, 1, -1]),
                    }}),
                ));
            }
        }
        let last = format!("b{}", self.bodies.len() - 1);
        if let Some((frequency, size, direction)) = self.force {
            let magnitude = match frequency {
                0.0 => json!(size * scale(FORCE)),
                _ => {
                    json!({"harmonic": {"amplitude": size * scale(FORCE), "frequency": frequency * scale(RATE)}})
                }
            };
            loads.push(("force".into(), json!({"force": {
                "body": last, "point": "far", "direction": view.turn.of(direction), "magnitude": magnitude,
            }})));
        }
        if let Some((stiffness, damping, place)) = self.spring {
            loads.push((
                "spring".into(),
                json!({"spring": {
                    "between": [last, "ground"], "at": {"a": "far", "b": turned(place, LENGTH)},
                    "rest_length": scale(LENGTH), "stiffness": stiffness * scale([0, 1, -2]),
                    "damping": damping * scale([0, 1, -1]),
                }}),
            ));
        }
        let functions = self
            .functions(view)
            .into_iter()
            .map(|f| (f.name.to_owned(), f.value));
        let functions: Vec<_> = functions.collect();
        let mut document = json!({
            "version": 1, "name": "random",
            "gravity": turned(self.gravity, ACCELERATION),
            "bodies": ordered(bodies, view), "joints": ordered(joints, view), "loads": ordered(loads, view),
            "functions": ordered(functions, view),
            "variables": self.variables().into_iter().map(|(name, path, _)| {
                (name.to_owned(), json!({"path": path, "lower": -1e30, "upper": 1e30}))
            }).collect::<Map<_, _>>(),
            "simulation": {"duration": self.duration * scale(TIME)},
        });
        for variable in ["mass", "length"] {
            if let Some(entry) = document["variables"].get_mut(variable) {
                entry["lower"] = json!(1e-30);
            }
        }
        if let Some(rate) = self.motor {
            document["drives"] =
                json!({"motor": {"joint": "j0", "turn": {"rate": rate * scale(RATE)}}});
        }
        for (key, value) in simulation.as_object().into_iter().flatten() {
            document["simulation"][key] = value.clone();
        }
        document
    }

    /// Name, path and unit of every variable.
    pub fn variables(&self) -> Vec<(&'static str, &'static str, Unit)> {
        let mut variables = vec![
            ("mass", "/bodies/b0/mass", MASS),
            ("length", "/bodies/b0/points/far/0", LENGTH),
            ("place", "/bodies/b0/place/turn/0/angle", NUMBER),
        ];
        if self.bodies[0].turns() && self.motor.is_none() {
            variables.push(("rate", "/joints/j0/KIND/start/turn/rate", RATE));
        }
        if self.force.is_some_and(|(frequency, ..)| frequency == 0.0) {
            variables.push(("force", "/loads/force/force/magnitude", FORCE));
        }
        for entry in &mut variables {
            if entry.0 == "rate" {
                entry.1 = match self.bodies[0].joint {
                    "revolute" => "/joints/j0/revolute/start/turn/rate",
                    "planar" => "/joints/j0/planar/start/turn/rate",
                    _ => "/joints/j0/cylindrical/start/turn/rate",
                };
            }
        }
        variables
    }

    /// By how much this view multiplies a value or derivative, by its name in the table of results.
    pub fn factor(&self, view: &View, name: &str) -> f64 {
        let (function, variable) = name.split_once(" / ").unwrap_or((name, ""));
        let function = self
            .functions(view)
            .into_iter()
            .find(|f| f.name == function);
        let variable = self.variables().into_iter().find(|v| v.0 == variable);
        let of = |unit: Option<Unit>| unit.map_or(1.0, |unit| scale(view, unit));
        of(function.map(|f| f.unit)) / of(variable.map(|v| v.2))
    }

    fn functions(&self, view: &View) -> Vec<Function> {
        let last = format!("b{}", self.bodies.len() - 1);
        let look = view.turn.of(self.look);
        let of_point = json!({"body": last, "point": "far", "direction": look});
        let reaction = json!({"joint": "j0", "direction": look, "on": "b0"});
        let function = |name, unit, value| Function { name, unit, value };
        let mut all = vec![
            function("place", LENGTH, json!({"final": {"position": of_point}})),
            function("velocity", SPEED, json!({"final": {"velocity": of_point}})),
            function(
                "acceleration",
                ACCELERATION,
                json!({"final": {"acceleration": of_point}}),
            ),
            function(
                "spin",
                RATE,
                json!({"final": {"angular_velocity": {"body": last, "direction": look}}}),
            ),
            function("force", FORCE, json!({"final": {"joint_force": reaction}})),
            function(
                "moment",
                MOMENT,
                json!({"final": {"joint_moment": reaction}}),
            ),
            function(
                "action",
                [2, 1, -1],
                json!({"integral": {"energy": "kinetic"}}),
            ),
            function(
                "high",
                LENGTH,
                json!({"ks": {"rho": 20.0 / scale(view, LENGTH), "of": {"position": of_point}}}),
            ),
        ];
        if self.bodies[0].turns() {
            all.push(function(
                "angle",
                NUMBER,
                json!({"final": {"angle": {"joint": "j0"}}}),
            ));
        }
        all
    }
}

impl Body {
    fn random(numbers: &mut Numbers, kind: Kind, normal: Vector) -> Self {
        let joint = match kind {
            Kind::Space => [
                "revolute",
                "revolute",
                "spherical",
                "universal",
                "cylindrical",
            ][numbers.below(5)],
            Kind::Plane => ["revolute", "revolute", "planar"][numbers.below(3)],
            Kind::Rest => ["revolute", "spherical"][numbers.below(2)],
        };
        let axis = if kind == Kind::Plane {
            normal
        } else {
            numbers.direction()
        };
        let turns = !matches!(joint, "spherical" | "universal");
        Self {
            size: [
                numbers.between(0.3, 1.5),
                numbers.between(0.05, 0.3),
                numbers.between(0.05, 0.3),
            ],
            mass: numbers.between(0.2, 4.0),
            turn: Turn {
                axis: if kind == Kind::Plane {
                    normal
                } else {
                    numbers.direction()
                },
                angle: numbers.between(-3.0, 3.0),
            },
            joint,
            axis,
            rate: numbers.between(-4.0, 4.0),
            spring: (turns && numbers.chance(0.3))
                .then(|| [numbers.between(0.5, 20.0), numbers.between(-1.0, 1.0)]),
            damping: (joint == "revolute" && numbers.chance(0.3))
                .then(|| numbers.between(0.01, 0.5)),
        }
    }

    fn turns(&self) -> bool {
        matches!(self.joint, "revolute" | "planar" | "cylindrical")
    }
}

/// The number of the file for one SI unit of a quantity.
fn scale(view: &View, unit: Unit) -> f64 {
    view.units
        .iter()
        .zip(unit)
        .map(|(size, power)| size.powi(power))
        .product()
}

/// A map in the view's order.
fn ordered(entries: Vec<(String, Value)>, view: &View) -> Value {
    let order = match view.order {
        Some(seed) => Numbers(seed).order(entries.len()),
        None => (0..entries.len()).collect(),
    };
    Value::Object(order.into_iter().map(|i| entries[i].clone()).collect())
}
