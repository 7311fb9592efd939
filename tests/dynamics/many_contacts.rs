//! Scenes of many contacts: the same as a scene in which all pairs are looked at, spheres that stay in their box, and derivatives.

use crate::reference::documents::{problem as parsed, run, values, vary};
use crate::reference::gradients::gradients_are_exact;
use crate::reference::models::Numbers;
use serde_json::{Map, Value};

const RADIUS: f64 = 0.05;

/// Spheres in a box without lid, each with a contact to every other and to five walls.
fn spheres(count: usize, simulation: Value) -> Value {
    let mut numbers = Numbers(7);
    let side = (count as f64).cbrt().ceil() as usize;
    let half = 0.055 * side as f64 + 0.06;
    let (mut bodies, mut loads) = (Map::new(), Map::new());
    let contact = |between: [&str; 2], at: [f64; 3], surface: Value| {
        json!({"contact": {"between": between, "at": {"a": [0, 0, 0], "b": at}, "radius": RADIUS, "surface": surface,
                           "stiffness": 5e3, "dissipation": 0.3, "width": 1e-3, "friction": {"coefficient": 0.3, "width": 0.05}}})
    };
    let walls = [
        ([0.0, 0.0, 0.0], [0, 1, 0]),
        ([-half, 0.0, 0.0], [1, 0, 0]),
        ([half, 0.0, 0.0], [-1, 0, 0]),
        ([0.0, 0.0, -half], [0, 0, 1]),
        ([0.0, 0.0, half], [0, 0, -1]),
    ];
    let name = |i: usize| format!("s{i}");
    for i in 0..count {
        let at = |k: usize| 0.11 * (k as f64 - 0.5 * (side - 1) as f64);
        let place = [
            at(i % side),
            0.06 + 0.11 * (i / side % side) as f64,
            at(i / side / side),
        ];
        let place: Vec<f64> = place.iter().map(|x| x + 0.002 * numbers.next()).collect();
        let velocity = numbers.vector();
        bodies.insert(
            name(i),
            json!({"shape": {"sphere": {"radius": RADIUS}}, "mass": 0.1, "place": {"at": place},
                                      "velocity": {"linear": velocity.as_slice()}}),
        );
        for (k, (at, normal)) in walls.iter().enumerate() {
            let wall = contact(
                [&name(i), "ground"],
                *at,
                json!({"plane": {"normal": normal}}),
            );
            loads.insert(format!("{} wall {k}", name(i)), wall);
        }
        for k in 0..i {
            let other = contact(
                [&name(i), &name(k)],
                [0.0; 3],
                json!({"sphere": {"radius": RADIUS}}),
            );
            loads.insert(format!("{} {}", name(i), name(k)), other);
        }
    }
    json!({
        "version": 1, "name": "spheres", "gravity": [0, -9.81, 0], "bodies": bodies, "loads": loads, "simulation": simulation,
        "functions": {
            "energy": {"final": {"energy": "total"}},
            "first": {"final": {"position": {"body": "s0", "direction": [0.3, 1, 0.2]}}},
            "last": {"final": {"position": {"body": name(count - 1), "direction": [0.3, 1, 0.2]}}}
        }
    })
}

/// The 45 pairs of 10 spheres are all looked at. With 21 pairs more, of spheres that are far away, most are left out: the same motion,
/// to the last bit.
#[test]
fn what_is_left_out_changes_nothing() {
    let mut few = spheres(
        10,
        json!({"duration": 0.25, "steps": 1200, "method": "dop853"}),
    );
    few["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("energy");
    let mut more = few.clone();
    let law = few["loads"]["s1 s0"]["contact"].clone();
    for (k, name) in ["a", "b", "c"].into_iter().enumerate() {
        more["bodies"][name] = json!({"shape": {"sphere": {"radius": RADIUS}}, "mass": 0.1, "place": {"at": [40.0 * (k as f64 + 1.0), 0, 0]}});
        for other in 0..7 {
            let mut own = law.clone();
            own["between"] = json!([name, format!("s{other}")]);
            more["loads"][format!("{name} {other}")] = json!({"contact": own});
        }
    }
    assert_eq!(values(&more), values(&few));
}

/// 200 spheres, 20,900 pairs: none leaves the box, and energy only falls.
#[test]
fn spheres_stay_in_their_box() {
    let motion = run(&spheres(200, json!({"duration": 0.15, "tolerance": 1e-5})));
    let of = &motion.at.run;
    let half = 0.055 * 6.0 + 0.06;
    let last = of.q(of.last());
    for body in last.chunks(7) {
        assert!(body[1] > 0.5 * RADIUS, "{body:?}");
        assert!(body[0].abs().max(body[2].abs()) < half, "{body:?}");
    }
    let energies = &motion.observations;
    let total = |k: usize| energies[k].kinetic + energies[k].potential;
    assert!(total(energies.len() - 1) < total(0) - 1.0);
    assert_eq!(
        motion.at.run.counts.newton_iterations, 0,
        "it stays explicit"
    );
}

#[test]
fn gradients() {
    let simulation = json!({"duration": 0.1, "tolerance": 1e-7});
    let mut file = spheres(12, simulation.clone());
    file["functions"]
        .as_object_mut()
        .expect("functions")
        .remove("energy");
    vary(
        &mut file,
        &[
            "/loads/s1 s0/contact/stiffness".into(),
            "/loads/s5 s4/contact/radius".into(),
            "/loads/s0 wall 0/contact/stiffness".into(),
            "/bodies/s11/mass".into(),
        ],
    );
    gradients_are_exact(&parsed(&file), &simulation);
}
