//! Contacts: rebounds, blocks that creep and slip, spheres that roll and slip, energy, families, derivatives in every state,
//! and random drops of which none is lost.

use super::stops::rebound;
use crate::reference::documents::{faults_say, methods, problem as parsed, values, vary};
use crate::reference::gradients::gradients_are_exact;
use crate::reference::models::Numbers;
use flexbody_driver::simulate;
use serde_json::Value;

const GRAVITY: f64 = 9.81;

fn point(at: [f64; 3], velocity: [f64; 3]) -> Value {
    json!({"shape": "point", "mass": 2, "place": {"at": at}, "velocity": {"linear": velocity}})
}

fn plane(normal: [f64; 3]) -> Value {
    json!({"plane": {"normal": normal}})
}

fn component(quantity: &str, body: &str, direction: [f64; 3]) -> Value {
    json!({"final": {quantity: {"body": body, "direction": direction}}})
}

/// A ball without weight that flies to a surface obliquely bounces off by the implicit formula and keeps its tangential
/// velocity.
#[test]
fn balls_rebound_by_the_implicit_formula() {
    let surfaces = [
        plane([0.0, 3.0, 0.0]),
        json!({"sphere": {"radius": 0.5}}),
        json!({"capsule": {"half": [2, 0, 0], "radius": 0.5}}),
    ];
    for (surface, centre) in surfaces.iter().zip([0.0, -0.5, -0.5]) {
        for (radius, exponent, dissipation) in [(0.0, 1.0, 0.0), (0.2, 1.5, 0.3), (0.2, 1.0, 0.8)] {
            // Spheres are hit along the line of their centres.
            let slide = if surface.get("sphere").is_some() {
                0.0
            } else {
                0.7
            };
            let found = values(&json!({
                "version": 1, "name": "ball", "gravity": [0, 0, 0],
                "bodies": {"ball": point([0.0, 1.0, 0.0], [slide, -2.0, 0.0])},
                "loads": {"floor": {"contact": {
                    "between": ["ball", "ground"], "at": [[0, 1, 0], [0, centre, 0]], "radius": radius,
                    "surface": surface, "stiffness": 1e5, "dissipation": dissipation, "width": 1e-3,
                    "exponent": exponent}}},
                "simulation": {"duration": 1.5, "tolerance": 1e-10},
                "functions": {"up": component("velocity", "ball", [0.0, 1.0, 0.0]),
                              "along": component("velocity", "ball", [1.0, 0.0, 0.0])}
            }));
            let exact = rebound(2.0, dissipation);
            assert!(
                (found[0] - exact).abs() < 1e-6,
                "{surface} {found:?} {exact}"
            );
            assert!((found[1] - slide).abs() < 1e-9, "{surface} {found:?}");
        }
    }
}

/// A sphere that hits a plane by Hertz's law, exponent 3/2, without loss: the deepest place (5 m v²/4 k)^⅖, the largest force k δ^{3/2}, and
/// the rebound after 2.9432 δ/v (Hertz 1882; Johnson, *Contact Mechanics*, section 11.4).
#[test]
fn a_hertzian_impact() {
    let (mass, speed) = (0.3, 2.0);
    // Steel, 20 mm: k = 4/3 E' √R.
    let stiffness = 4.0 / 3.0 * (2.1e11 / (2.0 * (1.0 - 0.09))) * 0.01_f64.sqrt();
    let depth = (1.25 * mass * speed * speed / stiffness).powf(0.4);
    let lasts = 2.9432 * depth / speed;
    let width = 1e-3 * depth;
    let start = 0.01 + 0.1 * depth;
    let (before, after) = (0.1 * depth / speed, 0.2 * depth / speed);
    let found = values(&json!({
        "version": 1, "name": "hertz", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.01}}, "mass": mass, "place": {"at": [0, start, 0]},
                            "velocity": {"linear": [0, -speed, 0]}}},
        "loads": {"plate": {"contact": {"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.01,
                                        "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": stiffness, "exponent": 1.5,
                                        "width": width}}},
        "simulation": {"duration": before + lasts + after, "tolerance": 1e-11},
        "functions": {
            "depth": {"value": {"at": before + 0.5 * lasts, "of": {"penetration": {"load": "plate"}}}},
            "force": {"value": {"at": before + 0.5 * lasts, "of": {"contact_force": {"load": "plate"}}}},
            "place": component("position", "ball", [0.0, 1.0, 0.0]),
            "back": component("velocity", "ball", [0.0, 1.0, 0.0])
        }
    }));
    let close = |found: f64, exact: f64, part: f64| {
        assert!((found / exact - 1.0).abs() < part, "{found} {exact}");
    };
    close(found[0], depth, 1e-5);
    close(found[1], stiffness * depth.powf(1.5), 1e-5);
    close(found[3], speed, 1e-6);
    // Where it is then says when it came back.
    close((found[2] - 0.01) / speed, after, 1e-3);
}

/// Materials in place of a stiffness: Hertz's, of two spheres and of a sphere on a plane, with the derivatives by the moduli and radii.
#[test]
fn materials_give_the_stiffness_of_hertz() {
    let file = |law: Value, surface: Value, simulation: &Value| {
        let mut contact = json!({"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, -0.02, 0]}, "radius": 0.01,
                                 "surface": surface, "dissipation": 0.1});
        let own = contact.as_object_mut().expect("an object");
        own.extend(law.as_object().expect("a law").clone());
        json!({
            "version": 1, "name": "hertz", "gravity": [0, 0, 0],
            "materials": {"steel": {"young": 2.1e11, "poisson": 0.3}, "rubber": {"young": 5e6, "poisson": 0.49}},
            "bodies": {"ball": {"shape": {"sphere": {"radius": 0.01}}, "mass": 0.03, "place": {"at": [0.002, 0.0109, 0]},
                                "velocity": {"linear": [0, -2, 0]}}},
            "loads": {"plate": {"contact": contact}},
            "simulation": simulation,
            "functions": {"back": component("velocity", "ball", [0.0, 1.0, 0.0]), "side": component("velocity", "ball", [1.0, 0.0, 0.0]),
                          "push": {"integral": {"contact_force": {"load": "plate"}}}}
        })
    };
    let modulus = 1.0 / ((1.0 - 0.09) / 2.1e11 + (1.0 - 0.49 * 0.49) / 5e6);
    let materials = json!({"materials": ["steel", "rubber"]});
    let plane = json!({"plane": {"normal": [0, 1, 0]}});
    let sphere = json!({"sphere": {"radius": 0.02}});
    let simulation = json!({"duration": 0.02, "tolerance": 1e-10});
    for (surface, radius) in [(plane, 0.01), (sphere.clone(), 0.02 / 3.0)] {
        let mut by_name = file(materials.clone(), surface.clone(), &simulation);
        let law = json!({"stiffness": 4.0 / 3.0 * modulus * f64::sqrt(radius), "exponent": 1.5, "width": 1e-5 * radius});
        let mut by_number = file(law, surface, &simulation);
        for file in [&mut by_name, &mut by_number] {
            if radius == 0.01 {
                file["loads"]["plate"]["contact"]["at"]["b"] = json!([0, 0, 0]);
            }
        }
        for (a, b) in values(&by_name).iter().zip(values(&by_number)) {
            assert!((a - b).abs() <= 1e-9 * b.abs().max(0.1), "{a} {b}");
        }
    }
    for simulation in methods(0.004, 400) {
        let mut law = materials.clone();
        law["width"] = json!(1e-3);
        let mut file = file(law, sphere.clone(), &simulation);
        let own = "/loads/plate/contact";
        vary(
            &mut file,
            &[
                "/materials/steel/young".into(),
                "/materials/rubber/young".into(),
                format!("{own}/radius"),
                format!("{own}/surface/sphere/radius"),
            ],
        );
        let functions = file["functions"].as_object_mut().expect("functions");
        functions.remove("push");
        let ratio = "/materials/rubber/poisson";
        file["variables"]["ratio"] = json!({"path": ratio, "lower": 0.3, "upper": 0.5});
        gradients_are_exact(&parsed(&file), &simulation);
    }
    let told = |law: Value, surface: &Value, words: &[&str]| {
        faults_say(&file(law, surface.clone(), &simulation), words);
    };
    let own = "/loads/plate/contact";
    told(
        json!({"width": 1e-4}),
        &sphere,
        &[own, "no \"stiffness\"", "\"materials\" give"],
    );
    told(json!({"stiffness": 1e4}), &sphere, &[own, "no \"width\""]);
    told(
        json!({"materials": ["steel", "ruber"]}),
        &sphere,
        &["/loads/plate/contact/materials/1", "ruber", "rubber"],
    );
    told(
        json!({"materials": ["steel", "rubber"], "stiffness": 1e4}),
        &sphere,
        &["/loads/plate/contact/stiffness", "one of them"],
    );
    told(
        json!({"materials": ["steel", "rubber"], "exponent": 1}),
        &sphere,
        &["/loads/plate/contact/exponent", "1.5, that of Hertz"],
    );
    told(
        materials.clone(),
        &json!({"box": {"size": [1, 1, 1]}}),
        &[
            "/loads/plate/contact/materials",
            "no sphere on a plane or sphere",
        ],
    );
}

/// Two balls of masses m, M with the velocities v, 0 along the line of their centres: the velocity of separation is the
/// rebound of that of approach, and the momentum is kept.
#[test]
fn balls_meet_balls() {
    let mut bodies = json!({"first": point([0.0, 0.0, 0.0], [3.0, 0.0, 0.0]), "second": point([1.0, 0.0, 0.0], [0.0, 0.0, 0.0])});
    bodies["second"]["mass"] = json!(5);
    let found = values(&json!({
        "version": 1, "name": "balls", "gravity": [0, 0, 0], "bodies": bodies,
        "loads": {"meet": {"contact": {
            "between": ["first", "second"], "at": [[0, 0, 0], [1, 0, 0]], "radius": 0.1,
            "surface": {"sphere": {"radius": 0.2}}, "stiffness": 1e5, "dissipation": 0.2, "width": 1e-3,
            "exponent": 1.5}}},
        "simulation": {"duration": 1, "tolerance": 1e-10},
        "functions": {"first": component("velocity", "first", [1.0, 0.0, 0.0]),
                      "second": component("velocity", "second", [1.0, 0.0, 0.0])}
    }));
    assert!(
        (found[1] - found[0] - rebound(3.0, 0.2)).abs() < 1e-6,
        "{found:?}"
    );
    assert!(
        (2.0 * found[0] + 5.0 * found[1] - 6.0).abs() < 1e-9,
        "{found:?}"
    );
}

/// A block on an incline of the angle α: it slips with g (sin α − μ cos α), or creeps at the velocity v that carries it,
/// v / √(v² + w²) = tan α / μ.
fn incline(angle: f64, friction: f64, width: f64) -> Value {
    let normal = [-angle.sin(), angle.cos(), 0.0];
    json!({
        "version": 1, "name": "incline",
        "bodies": {"block": point([0.0; 3], [0.0; 3])},
        "loads": {"ground": {"contact": {
            "between": ["block", "ground"], "at": [[0, 0, 0], [0, 0, 0]], "surface": plane(normal),
            "stiffness": 1e4, "dissipation": 1, "width": 1e-3, "friction": {"coefficient": friction, "width": width}}}},
        "simulation": {"duration": 2, "tolerance": 1e-10},
        "functions": {"down": component("velocity", "block", [-angle.cos(), -angle.sin(), 0.0]),
                      "friction": {"final": {"contact_friction": {"load": "ground"}}},
                      "normal": {"final": {"contact_force": {"load": "ground"}}}}
    })
}

#[test]
fn a_block_slips_or_creeps_on_an_incline() {
    let (angle, width) = (0.4_f64, 1e-3);
    let weight = 2.0 * GRAVITY;
    let mut creeping = incline(angle, 0.6, width);
    // Until the vibration on the contact has died out.
    creeping["simulation"]["duration"] = json!(5);
    let creeping = values(&creeping);
    let part = angle.tan() / 0.6;
    let creep = width * part / (1.0 - part * part).sqrt();
    assert!(
        (creeping[0] - creep).abs() < 1e-5 * width,
        "{creeping:?} {creep}"
    );
    assert!(
        (creeping[1] - weight * angle.sin()).abs() < 1e-6,
        "{creeping:?}"
    );
    assert!(
        (creeping[2] - weight * angle.cos()).abs() < 1e-6,
        "{creeping:?}"
    );
    let slipping = values(&incline(angle, 0.2, width));
    let exact = 2.0 * GRAVITY * (angle.sin() - 0.2 * angle.cos());
    // The block sinks in at first, when the normal force is another.
    assert!(
        (slipping[0] - exact).abs() < 0.01 * exact,
        "{slipping:?} {exact}"
    );
    assert!(
        (slipping[1] - 0.2 * weight * angle.cos()).abs() < 1e-3,
        "{slipping:?}"
    );
}

/// A sphere of radius r that is set down with the velocity v and without spin slips until it rolls with 5/7 v.
#[test]
fn a_sphere_slips_until_it_rolls() {
    let (v, r, mu) = (2.0, 0.1, 0.3);
    let depth = 3.0 * GRAVITY / 1e5;
    let document = json!({
        "version": 1, "name": "rolling",
        "bodies": {"ball": {"shape": {"sphere": {"radius": r}}, "mass": 3, "place": {"at": [0, r - depth, 0]},
                            "velocity": {"linear": [v, 0, 0]}}},
        "loads": {"ground": {"contact": {
            "between": ["ball", "ground"], "at": [[0, r - depth, 0], [0, 0, 0]], "radius": r, "surface": plane([0.0, 1.0, 0.0]),
            "stiffness": 1e5, "dissipation": 1, "width": 1e-6, "friction": {"coefficient": mu, "width": 1e-3}}}},
        "simulation": {"duration": 0.1, "tolerance": 1e-9},
        "functions": {"v": component("velocity", "ball", [1.0, 0.0, 0.0]),
                      "w": component("angular_velocity", "ball", [0.0, 0.0, 1.0])}
    });
    // It slips for 2/7 v / (μ g) = 0.194 s.
    let slipping = values(&document);
    assert!(
        (slipping[0] - (v - mu * GRAVITY * 0.1)).abs() < 1e-4,
        "{slipping:?}"
    );
    assert!(
        (slipping[1] + 2.5 * mu * GRAVITY * 0.1 / r).abs() < 1e-2,
        "{slipping:?}"
    );
    let mut later = document.clone();
    later["simulation"]["duration"] = json!(1);
    let rolling = values(&later);
    assert!((rolling[0] - 5.0 / 7.0 * v).abs() < 1e-3, "{rolling:?}");
    assert!((rolling[0] + rolling[1] * r).abs() < 1e-6, "{rolling:?}");
    // The same in space and in the plane.
    let mut full = parsed(&later);
    assert!(
        full.lowering
            .as_ref()
            .is_some_and(|lowering| lowering.plane.is_ok())
    );
    full.lowering = None;
    let motion = simulate(&full, &full.start()).expect("a motion");
    for (f, reduced) in rolling.iter().enumerate() {
        assert!((motion.at.function(f).value - reduced).abs() < 1e-7 * reduced.abs());
    }
}

/// A box whose corners fall on a floor, a ball on the box, and a post in its way.
fn tumbling(simulation: Value) -> Value {
    let corner = |body: &str, at: [f64; 3], friction: f64| {
        json!({"contact": {"between": [body, "ground"], "at": {"a": at, "b": [0, 0, 0]}, "surface": plane([0.1, 1.0, 0.05]),
                           "stiffness": 2000, "dissipation": 0.4, "width": 0.02,
                           "friction": {"coefficient": friction, "width": 0.05}}})
    };
    json!({
        "version": 1, "name": "tumbling",
        "bodies": {
            "box": {"shape": {"box": {"size": [0.6, 0.3, 0.4]}}, "mass": 2,
                    "place": {"at": [0, 0.5, 0], "turn": {"axis": [0.3, 0.2, 1], "angle": 0.5}},
                    "velocity": {"linear": [0.8, -1, 0.2], "angular": [0.5, 0.3, -1]}},
            "ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 0.7, "place": {"at": [0.05, 0.85, 0.02]},
                     "velocity": {"angular": [1, -2, 3]}}
        },
        "loads": {
            "a": corner("box", [0.3, -0.15, 0.2], 0.3), "b": corner("box", [0.3, -0.15, -0.2], 0.3),
            "c": corner("box", [-0.3, -0.15, 0.2], 0.4), "d": corner("box", [-0.3, -0.15, -0.2], 0.2),
            "ball": {"contact": {"between": ["ball", "box"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.1,
                                 "surface": {"capsule": {"half": [0.2, 0.1, 0], "radius": 0.2}}, "stiffness": 1500,
                                 "dissipation": 0.2, "width": 0.02, "exponent": 1.2,
                                 "friction": {"coefficient": 0.5, "width": 0.1}}},
            "post": {"contact": {"between": ["box", "ground"], "at": {"a": [0.3, 0.1, 0], "b": [0.5, 0.35, 0.1]}, "radius": 0.05,
                                 "surface": {"sphere": {"radius": 0.15}}, "stiffness": 1500, "width": 0.02}}
        },
        "simulation": simulation,
        "functions": {
            "place": {"final": {"position": {"body": "box", "point": [0.3, 0, 0.1], "direction": [0.6, 0.7, 0.4]}}},
            "ball": component("position", "ball", [0.6, 0.7, 0.4]),
            "energy": {"integral": {"energy": "total"}},
            "force": {"integral": {"contact_force": {"load": "ball"}}},
            "depth": {"ks": {"rho": 30, "of": {"penetration": {"load": "post"}}}},
            "friction": {"integral": {"contact_friction": {"load": "a"}}},
            "work": {"integral": {"power": {"load": "c"}}}
        }
    })
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.5, 300) {
        let mut document = tumbling(simulation.clone());
        let paths = [
            "/loads/a/contact/stiffness",
            "/loads/a/contact/friction/coefficient",
            "/loads/a/contact/friction/width",
            "/loads/a/contact/surface/plane/normal/0",
            "/loads/a/contact/at/a/1",
            "/loads/c/contact/dissipation",
            "/loads/ball/contact/radius",
            "/loads/ball/contact/width",
            "/loads/ball/contact/surface/capsule/half/1",
            "/loads/ball/contact/surface/capsule/radius",
            "/loads/post/contact/surface/sphere/radius",
            "/loads/post/contact/at/b/1",
            "/bodies/box/mass",
        ];
        vary(&mut document, &paths.map(String::from));
        gradients_are_exact(&parsed(&document), &simulation);
    }
}

/// Kinetic energy and weight change by the work of the contacts; the total energy, with what the contacts store, only falls.
#[test]
fn energy_is_in_balance() {
    let mut document = tumbling(json!({"duration": 0.5, "tolerance": 1e-9}));
    let loads = ["a", "b", "c", "d", "ball", "post"];
    let mut functions = serde_json::Map::new();
    for load in loads {
        let work = json!({"integral": {"power": {"load": load}}});
        functions.insert(format!("work of {load}"), work);
    }
    functions.insert("kinetic".into(), json!({"final": {"energy": "kinetic"}}));
    for (body, mass) in [("box", 2.0), ("ball", 0.7)] {
        let weight = component("position", body, [0.0, mass * GRAVITY, 0.0]);
        functions.insert(format!("weight of {body}"), weight);
    }
    document["functions"] = functions.into();
    let problem = parsed(&document);
    let motion = simulate(&problem, &problem.start()).expect("a motion");
    let of = |f: usize| motion.at.function(f).value;
    let work: f64 = (0..loads.len()).map(of).sum();
    let seen = &motion.observations;
    let first = seen[0].kinetic + GRAVITY * (2.0 * 0.5 + 0.7 * 0.85);
    let last = of(6) + of(7) + of(8);
    let total = |k: usize| seen[k].kinetic + seen[k].potential;
    let size = seen[0].kinetic;
    assert!(
        (last - first - work).abs() < 1e-6 * size,
        "{last} {first} {work}"
    );
    for k in 1..seen.len() {
        assert!(
            total(k) <= total(k - 1) + 1e-8 * size,
            "{k}: {} {}",
            total(k),
            total(k - 1)
        );
    }
    assert!(total(seen.len() - 1) < total(0) - 0.01 * size);
}

/// The scene turned as a whole, and with its bodies in another order.
#[test]
fn the_same_in_other_descriptions() {
    let document = tumbling(json!({"duration": 0.5, "tolerance": 1e-10}));
    let reference = values(&document);
    let agree = |found: &[f64], scales: &[f64], what: &str| {
        for (k, (a, b)) in found.iter().zip(&reference).enumerate() {
            let b = b * scales[k];
            assert!(
                (a - b).abs() < 1e-5 * b.abs().max(0.01 * scales[k]),
                "{what} {k}: {a} {b}"
            );
        }
    };
    let ones = [1.0; 7];
    let mut reversed = document.clone();
    for key in ["bodies", "loads"] {
        let all = reversed[key].as_object().expect("an object").clone();
        reversed[key] = all
            .into_iter()
            .rev()
            .collect::<serde_json::Map<_, _>>()
            .into();
    }
    agree(&values(&reversed), &ones, "in another order");
    // x → y → z → x: a turn of the whole about (1, 1, 1).
    let mut turned = document.clone();
    turned["gravity"] = json!([0, 0, -GRAVITY]);
    let turn = json!([{"axis": [0.3, 0.2, 1], "angle": 0.5}, {"axis": [1, 1, 1], "angle": 2.0 * std::f64::consts::PI / 3.0}]);
    turned["bodies"]["box"]["place"] = json!({"at": [0, 0, 0.5], "turn": turn});
    turned["bodies"]["box"]["velocity"] =
        json!({"linear": [0.2, 0.8, -1], "angular": [-1, 0.5, 0.3]});
    turned["bodies"]["ball"]["place"] = json!({"at": [0.02, 0.05, 0.85]});
    turned["bodies"]["ball"]["velocity"] = json!({"angular": [3, 1, -2]});
    for load in ["a", "b", "c", "d"] {
        turned["loads"][load]["contact"]["surface"] = plane([0.05, 0.1, 1.0]);
    }
    // The half axis is given in ground axes at the start.
    turned["loads"]["ball"]["contact"]["surface"]["capsule"]["half"] = json!([0, 0.2, 0.1]);
    turned["loads"]["post"]["contact"]["at"]["b"] = json!([0.1, 0.5, 0.35]);
    for f in ["place", "ball"] {
        turned["functions"][f]["final"]["position"]["direction"] = json!([0.4, 0.6, 0.7]);
    }
    agree(&values(&turned), &ones, "turned");
}

/// Balls, points and boxes dropped at random on a floor and on posts: none is below the floor, and none gains energy.
#[test]
fn nothing_falls_through_the_floor() {
    let mut numbers = Numbers(2024);
    let (mut touched, mut failed) = (0, 0);
    for case in 0..60 {
        let mut next = |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + numbers.next());
        let (mass, radius) = (10.0_f64.powf(next(-2.0, 2.0)), next(0.0, 0.2).max(0.01));
        let stiffness = 10.0_f64.powf(next(3.0, 7.0)) * mass;
        let (height, width) = (next(0.3, 5.0), 10.0_f64.powf(next(-4.0, -2.0)));
        let dissipation = [0.0, 0.1, 0.6][case % 3];
        let (friction, exponent) = ([0.0, 0.3][case % 2], [1.0, 1.5][case / 2 % 2]);
        let document = json!({
            "version": 1, "name": "drop",
            "bodies": {"ball": {"shape": {"sphere": {"radius": radius}}, "mass": mass,
                                "place": {"at": [0, height + radius, 0]},
                                "velocity": {"linear": [next(-3.0, 3.0), next(-5.0, 2.0), 0.5],
                                             "angular": [next(-9.0, 9.0), 1, 2]}}},
            "loads": {"floor": {"contact": {
                "between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": radius,
                "surface": plane([0.0, 1.0, 0.0]), "stiffness": stiffness, "dissipation": dissipation, "width": width,
                "exponent": exponent, "friction": {"coefficient": friction, "width": 0.01}}}},
            "simulation": {"duration": 2, "tolerance": 1e-7},
            "functions": {"height": component("position", "ball", [0.0, 1.0, 0.0]),
                          "force": {"integral": {"contact_force": {"load": "floor"}}}}
        });
        let problem = parsed(&document);
        let motion = match simulate(&problem, &problem.start()) {
            Ok(motion) => motion,
            Err(failure) => {
                failed += 1;
                eprintln!("{case}: {failure}");
                continue;
            }
        };
        touched += usize::from(motion.at.function(1).value > 0.0);
        let seen = &motion.observations;
        let total = |k: usize| seen[k].kinetic + seen[k].potential;
        // V = k δⁿ⁺¹ / (n + 1) holds no more than all energy, with that of the weight on the way down.
        let power = exponent + 1.0;
        let deepest = (power * 2.0 * total(0) / stiffness).powf(1.0 / power) + width;
        let height = motion.at.function(0).value;
        assert!(height > radius - deepest, "{document}: {height} {deepest}");
        for k in 1..seen.len() {
            assert!(
                total(k) <= total(0) * (1.0 + 1e-4),
                "{document}: {} {}",
                total(k),
                total(0)
            );
        }
    }
    assert!(failed == 0, "{failed} failed");
    assert!(touched > 55, "{touched}");
}

/// A cantilever whose tip lies on a support by a contact carries 3/8 of its weight there, and with the stiffness k of the
/// support 3/8 q L / (1 + 3 E I / (k L³)). Its derivatives are exact in motion, too.
#[test]
fn the_tip_of_a_beam_touches() {
    let (young, density, width, height) = (7e10, 2700.0, 0.02, 0.01);
    let stiffness = 2e4;
    let mut document = json!({
        "version": 1, "name": "cantilever", "analysis": "rest",
        "bodies": {"beam": {
            "beam": {"length": 1, "section": {"rectangle": {"width": width, "height": height}},
                     "material": {"young": young, "density": density, "poisson": 0.3},
                     "modes": {"bending_y": 6, "bending_z": 6, "torsion": 2, "stretch": 2}},
            "place": {"put": "start"}}},
        "joints": {"wall": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}}},
        "loads": {"support": {"contact": {
            "between": ["beam", "ground"], "at": {"a": "end", "b": [0, 0, 0]}, "surface": plane([0.0, 1.0, 0.0]),
            "stiffness": stiffness, "dissipation": 0.5, "width": 1e-6, "friction": {"coefficient": 0.3, "width": 0.1}}}},
        "functions": {"force": {"final": {"contact_force": {"load": "support"}}}}
    });
    // The beam bends in the plane where the height of its section is along y or z.
    let weight = density * width * height * GRAVITY;
    let found = values(&document)[0];
    let exact = [width * height.powi(3), height * width.powi(3)].map(|inertia| {
        let bending = 3.0 * young * inertia / 12.0 / stiffness;
        0.375 * weight / (1.0 + bending)
    });
    let off = exact.map(|exact| (found / exact - 1.0).abs());
    assert!(off[0].min(off[1]) < 1e-3, "{found} {exact:?}");
    document
        .as_object_mut()
        .expect("an object")
        .remove("analysis");
    document["bodies"]["beam"]["beam"]["modes"] =
        json!({"bending_y": 2, "bending_z": 2, "torsion": 0, "stretch": 0});
    document["loads"]["support"]["contact"]["at"]["b"] = json!([0, -0.002, 0]);
    document["loads"]["support"]["contact"]["width"] = json!(1e-3);
    document["simulation"] = json!({"duration": 0.1, "tolerance": 1e-5});
    document["functions"] = json!({
        "force": {"integral": {"contact_force": {"load": "support"}}},
        "tip": component("position", "beam", [0.0, 1.0, 0.0])
    });
    document["functions"]["tip"]["final"]["position"]["point"] = json!("end");
    let paths = [
        "/loads/support/contact/stiffness",
        "/loads/support/contact/at/b/1",
        "/bodies/beam/beam/material/young",
    ];
    vary(&mut document, &paths.map(String::from));
    assert!(values(&document)[0] > 0.01);
    gradients_are_exact(&parsed(&document), &json!("a beam"));
}

/// A rod of 1 m that turns freely about its centre by 15.57 rad/s, whose tip meets a thin post in its way: with any tolerance it is
/// hit, and its momentum is the impulse of the contact. The steps before it turn the rod by 1 rad and more.
#[test]
fn a_turning_rod_meets_a_thin_post() {
    for k in 0..24 {
        let angle = 0.3 + 0.17 * f64::from(k);
        let (sin, cos) = angle.sin_cos();
        let tolerance = 10.0_f64.powi(-(3 + k % 7));
        let file = json!({
            "version": 1, "name": "rod", "gravity": [0, 0, 0],
            "bodies": {"rod": {"shape": {"box": {"size": [1, 0.1, 0.05]}}, "mass": 1.5,
                "velocity": {"angular": [0, 0, 15.57]}, "points": {"tip": [0.5, 0, 0]}}},
            "loads": {"post": {"contact": {
                "between": ["rod", "ground"], "at": {"a": "tip", "b": [0.5 * cos, 0.5 * sin, 0]},
                "surface": {"sphere": {"radius": 0.005}}, "stiffness": 4e6, "width": 4e-4}}},
            "simulation": {"duration": 0.35, "tolerance": tolerance},
            "functions": {
                "x": {"final": {"momentum": {"direction": [1, 0, 0]}}},
                "y": {"final": {"momentum": {"direction": [0, 1, 0]}}},
                "impulse": {"integral": {"contact_force": {"load": "post"}}}}
        });
        let found = values(&file);
        let (momentum, impulse) = (found[0].hypot(found[1]), found[2]);
        assert!(momentum > 5.5, "{angle} {tolerance}: {found:?}");
        let felt = (momentum / impulse - 1.0).abs() < 0.01;
        assert!(felt || tolerance > 5e-5, "{angle} {tolerance}: {found:?}");
    }
}

/// Equal steps in which a ball goes through a sphere, or touches and is on its way back at their end, fail by every method; those that
/// follow the impact do not.
#[test]
fn equal_steps_do_not_pass_through() {
    let (mut failed, mut all, mut warned) = (0, 0, 0);
    for steps in (4..60).chain([100, 200, 400]) {
        for dissipation in [0.0, 0.1] {
            let methods = [
                json!("dop853"),
                json!({"radau": {"stages": 3}}),
                json!({"bdf": {"order": 2}}),
                json!({"generalised_alpha": {"radius": 0.8}}),
            ];
            for method in methods {
                let file = json!({
                    "version": 1, "name": "balls", "gravity": [0, 0, 0],
                    "bodies": {"ball": point([0.0, 1.0, 0.0], [0.0, -4.0, 0.0])},
                    "loads": {"post": {"contact": {"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0.1, 0]}, "radius": 0.1,
                                                   "surface": {"sphere": {"radius": 0.1}}, "stiffness": 2e5, "width": 1e-3,
                                                   "dissipation": dissipation}}},
                    "simulation": {"duration": 0.5, "steps": steps, "method": method},
                    "functions": {"place": component("position", "ball", [0.0, 1.0, 0.0]), "energy": {"final": {"energy": "total"}}}
                });
                let problem = parsed(&file);
                all += 1;
                match simulate(&problem, &problem.start()) {
                    Ok(found) => {
                        let place = found.at.function(0).value;
                        assert!(place > 0.1, "{steps} steps by {method} go through: {place}");
                        // 16 J before.
                        let rises = found.at.function(1).value > 16.5;
                        assert!(found.warning.is_some() || !rises, "{steps} {method}");
                        warned += usize::from(rises);
                    }
                    Err(failure) => {
                        failed += 1;
                        assert!(steps < 60, "{steps} {method}: {failure}");
                    }
                }
            }
        }
    }
    println!("{failed} of {all} fail, {warned} have a warning");
    assert!(
        failed > 10 && failed < all && warned > 0,
        "{failed} {all} {warned}"
    );
}

/// What is at the axis of a capsule at the start has no normal there.
#[test]
fn a_start_on_the_axis_of_a_capsule_is_told() {
    let file = json!({
        "version": 1, "name": "ball", "gravity": [0, 0, 0],
        "bodies": {"ball": point([0.7, 0.0, 0.0], [0.0, 1.0, 0.0])},
        "loads": {"bar": {"contact": {"between": ["ball", "ground"], "at": [[0.7, 0, 0], [0, 0, 0]],
            "surface": {"capsule": {"half": [1, 0, 0], "radius": 0.2}}, "stiffness": 1e5, "width": 1e-3}}},
        "simulation": {"duration": 0.1},
        "functions": {"up": component("velocity", "ball", [0.0, 1.0, 0.0])}
    });
    let text = serde_json::to_string_pretty(&file).expect("text");
    let faults = flexbody_problem::Problem::parse(&text, "ball.json", &[]);
    let faults = faults.expect_err("a fault").to_string();
    assert!(faults.contains("ends at the same place"), "{faults}");
}
