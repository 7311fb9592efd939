//! Contacts on height fields: planes and balls that a field stands for, energy, derivatives by every method, the same in other
//! descriptions, and faults.

use super::couplings::{OBLIQUE, close, oblique, turned};
use crate::reference::documents::{
    faults_say, in_units, methods, problem as parsed, reversed, unlowered_values, values, vary,
};
use crate::reference::gradients::gradients_are_exact;
use serde_json::Value;

fn component(quantity: &str, direction: [f64; 3]) -> Value {
    json!({"final": {quantity: {"body": "ball", "direction": direction}}})
}

/// A spinning ball above a surface of ground.
fn ball(surface: Value, at: [f64; 3], simulation: Value) -> Value {
    json!({
        "version": 1, "name": "ball", "gravity": [0, -9.81, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "place": {"at": [0.05, 0.3, 0.1]},
                            "velocity": {"linear": [1, -0.5, 0.3], "angular": [3, -2, 1]}}},
        "loads": {"ground": {"contact": {"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": at}, "radius": 0.1,
                                         "surface": surface, "stiffness": 2e4, "dissipation": 0.2, "width": 2e-3,
                                         "friction": {"coefficient": 0.3, "width": 0.02}}}},
        "simulation": simulation,
        "functions": {
            "x": component("position", [1.0, 0.0, 0.0]), "y": component("position", [0.0, 1.0, 0.0]),
            "z": component("position", [0.0, 0.0, 1.0]), "spin": component("angular_velocity", [0.3, 0.5, 1.0]),
            "depth": {"ks": {"rho": 300, "of": {"penetration": {"load": "ground"}}}},
            "force": {"integral": {"contact_force": {"load": "ground"}}},
            "loss": {"integral": {"slip_power": {"load": "ground"}}},
            "energy": {"final": {"energy": "total"}}
        }
    })
}

/// The field with the heights `of` its places.
fn field(along: &[f64], across: &[f64], of: impl Fn(f64, f64) -> f64) -> Value {
    let row = |v: &f64| along.iter().map(|u| of(*u, *v)).collect::<Vec<f64>>();
    let heights: Vec<Vec<f64>> = across.iter().map(row).collect();
    json!({"height_field": {"normal": [0, 2, 0], "direction": [3, 0.4, 0], "along": along, "across": across, "heights": heights}})
}

fn grid(from: f64, to: f64, count: i32) -> Vec<f64> {
    let at = |k: i32| from + (to - from) * f64::from(k) / f64::from(count - 1);
    (0..count).map(at).collect()
}

/// Heights of an inclined plane are the plane, also beyond the grid; the ball runs over its edge.
#[test]
fn a_plane_field_is_a_plane() {
    let simulation = json!({"duration": 0.8, "tolerance": 1e-10});
    // Across is normal × direction, −z.
    let heights = field(&[-1.0, 0.1, 0.3], &[-0.2, 0.0, 0.15], |u, v| {
        0.02 + 0.1 * u - 0.2 * v
    });
    let plane = json!({"plane": {"normal": [-0.1, 1, -0.2]}});
    let plane = values(&ball(plane, [0.0, 0.02, 0.0], simulation.clone()));
    assert!(plane[5] > 5.0, "{plane:?}");
    let found = values(&ball(heights, [0.0, 0.0, 0.0], simulation));
    for (a, b) in found.iter().zip(&plane) {
        close(*a, *b, 1e-7, "a plane");
    }
}

/// Heights of a dome converge to its sphere by the fourth power of the spacing, but for the edges, where a natural spline has no
/// curvature. Without friction the place of contact on the ball, which both have differently, does not count.
#[test]
fn a_dome_is_a_sphere() {
    let simulation = || json!({"duration": 0.6, "tolerance": 1e-11});
    let radius = 1.5_f64;
    let exact = json!({"sphere": {"radius": radius}});
    let smooth = |mut file: Value| {
        file["loads"]["ground"]["contact"]["friction"]["coefficient"] = json!(0);
        values(&file)
    };
    let exact = smooth(ball(exact, [0.1, -radius, 0.2], simulation()));
    let off = |count: i32| {
        let places = grid(-1.0, 1.0, count);
        let dome = field(&places, &places, |u, v| {
            (radius * radius - u * u - v * v).sqrt() - radius
        });
        let found = smooth(ball(dome, [0.1, 0.0, 0.2], simulation()));
        (0..3)
            .map(|k| (found[k] - exact[k]).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (off(21), off(41));
    println!("spacing 0.1 and 0.05 m: off by {coarse:.1e} and {fine:.1e} m");
    assert!(fine < 2e-6 && fine < coarse / 5.0, "{coarse} {fine}");
}

/// A point that slides without friction over hills keeps its energy, and comes to the same height with the same speed.
#[test]
fn hills_keep_energy() {
    let along = grid(-1.0, 5.0, 61);
    let hills = field(&along, &[0.0], |u, _| 0.15 * (1.0 - (3.0 * u).cos()));
    let mut file = ball(
        hills,
        [0.0, 0.0, 0.0],
        json!({"duration": 1.5, "tolerance": 1e-10}),
    );
    file["bodies"]["ball"] = json!({"shape": "point", "mass": 2, "place": {"at": [0, 0.02, 0]}, "velocity": {"linear": [3, 0, 0.5]}});
    let own = &mut file["loads"]["ground"]["contact"];
    own["friction"]["coefficient"] = json!(0);
    own["dissipation"] = json!(0);
    own["radius"] = json!(0);
    file["functions"] = json!({
        "first": {"value": {"at": 0, "of": {"energy": "total"}}}, "last": {"final": {"energy": "total"}},
        "way": component("position", [1.0, 0.0, 0.0]),
        "across": component("position", [0.0, 0.0, 1.0])
    });
    let found = values(&file);
    close(found[1], found[0], 1e-6, "energy");
    close(found[3], 0.75, 1e-12, "nothing presses across");
    assert!(found[2] > 2.5, "{found:?}");
}

/// A ball on a free plate that carries a field of hills.
fn carried(simulation: Value) -> Value {
    let hills = field(&grid(-0.5, 0.6, 8), &grid(-0.4, 0.5, 6), |u, v| {
        0.03 * (5.0 * u).sin() * (4.0 * v + 0.3).cos()
    });
    let mut file = ball(hills, [0.0, 0.0, 0.0], simulation);
    file["bodies"]["plate"] = json!({"shape": {"box": {"size": [1, 0.1, 1]}}, "mass": 3, "place": {"at": [0, 0, 0]},
                                     "velocity": {"linear": [0, 1, 0], "angular": [0.4, 0.3, -0.5]}});
    file["loads"]["ground"]["contact"]["between"] = json!(["ball", "plate"]);
    file["loads"]["ground"]["contact"]["stiffness"] = json!(2000);
    file["loads"]["ground"]["contact"]["width"] = json!(0.01);
    file
}

#[test]
fn gradients_by_every_method() {
    for simulation in methods(0.4, 200) {
        let mut file = carried(simulation.clone());
        let own = "/loads/ground/contact";
        vary(
            &mut file,
            &[
                format!("{own}/radius"),
                format!("{own}/stiffness"),
                format!("{own}/friction/coefficient"),
                format!("{own}/surface/height_field/normal/1"),
                format!("{own}/surface/height_field/direction/1"),
                "/bodies/plate/mass".into(),
            ],
        );
        for (name, path) in [("tilt", "normal/0"), ("lean", "normal/2")] {
            let path = format!("{own}/surface/height_field/{path}");
            file["variables"][name] = json!({"path": path, "lower": -0.2, "upper": 0.2});
        }
        file["variables"]["place"] =
            json!({"path": format!("{own}/at/b/0"), "lower": -0.1, "upper": 0.1});
        gradients_are_exact(&parsed(&file), &simulation);
        let wheel = json!({"wheel": {"axis": [0.3, 0.5, 1], "radius": 0.15}});
        let mut wheel = shaped(file.clone(), 0.05, &wheel);
        wheel["loads"]["ground"]["contact"]["friction"]["width"] = json!(0.2);
        let radius = format!("{own}/wheel/radius");
        wheel["variables"]["wheel"] = json!({"path": radius, "lower": 0.1, "upper": 0.2});
        let axis = format!("{own}/wheel/axis/1");
        wheel["variables"]["axis"] = json!({"path": axis, "lower": 0.1, "upper": 1});
        gradients_are_exact(&parsed(&wheel), &json!(["wheel", simulation]));
        let mut capsule = shaped(
            file,
            0.05,
            &json!({"half": [0.1, 0.03, 0.05], "spheres": 3}),
        );
        let half = format!("{own}/half/1");
        capsule["variables"]["half"] = json!({"path": half, "lower": 0.0, "upper": 0.1});
        gradients_are_exact(&parsed(&capsule), &json!(["capsule", simulation]));
    }
}

#[test]
fn the_same_in_other_descriptions() {
    let file = carried(json!({"duration": 0.4, "tolerance": 1e-10}));
    described(&file, None);
    let wheel = json!({"wheel": {"axis": [0.3, 0.5, 1], "radius": 0.15}});
    described(&shaped(file.clone(), 0.05, &wheel), Some("wheel/radius"));
    let capsule = json!({"half": [0.1, 0.03, 0.05]});
    described(&shaped(file, 0.05, &capsule), Some("half"));
}

/// Asserts that a file has the same values turned, in another order, without reductions, in other units and welded; `length` is the
/// place of the length that its shape has.
fn described(file: &Value, length: Option<&str>) {
    let reference = values(file);
    let agree = |found: &[f64], what: &str| {
        for (a, b) in found.iter().zip(&reference) {
            assert!(
                (a - b).abs() < 1e-6 * b.abs().max(0.1),
                "{what}: {found:?} {reference:?}"
            );
        }
    };
    let mut other = turned(file, &OBLIQUE);
    if length == Some("half") {
        let half = &mut other["loads"]["ground"]["contact"]["half"];
        *half = json!(oblique([0.1, 0.03, 0.05]));
    }
    for (body, velocity, spin) in [
        ("ball", [1.0, -0.5, 0.3], [3.0, -2.0, 1.0]),
        ("plate", [0.0, 1.0, 0.0], [0.4, 0.3, -0.5]),
    ] {
        other["bodies"][body]["velocity"] =
            json!({"linear": oblique(velocity), "angular": oblique(spin)});
    }
    let own = &mut other["loads"]["ground"]["contact"];
    own["at"]["a"] = json!([0, 0, 0]);
    own["surface"]["height_field"]["normal"] = json!(oblique([0.0, 2.0, 0.0]));
    own["surface"]["height_field"]["direction"] = json!(oblique([3.0, 0.4, 0.0]));
    agree(&values(&other), "turned");
    agree(&values(&reversed(file, &["bodies"])), "in another order");
    agree(&unlowered_values(file), "without reductions");
    // Millimetres and tonnes; feet and pounds.
    let of = |key: &str| &*format!("/loads/ground/contact/{key}").leak();
    let mut places = vec![
        ("/gravity", 1, 0),
        ("/bodies/ball/shape", 1, 0),
        ("/bodies/ball/mass", 0, 1),
        ("/bodies/ball/place/at", 1, 0),
        ("/bodies/ball/velocity/linear", 1, 0),
        ("/bodies/plate/shape", 1, 0),
        ("/bodies/plate/mass", 0, 1),
        ("/bodies/plate/velocity/linear", 1, 0),
        (of("radius"), 1, 0),
        (of("stiffness"), 0, 1),
        (of("dissipation"), -1, 0),
        (of("width"), 1, 0),
        (of("friction/width"), 1, 0),
        (of("surface/height_field/along"), 1, 0),
        (of("surface/height_field/across"), 1, 0),
        (of("surface/height_field/heights"), 1, 0),
        ("/functions/depth/ks/rho", -1, 0),
    ];
    places.extend(length.map(|own| (of(own), 1, 0)));
    for (metre, kilogram) in [(1e3, 1e-3), (1.0 / 0.3048, 1.0 / 0.45359237)] {
        let found = values(&in_units(file, (metre, kilogram), &places));
        let newton = metre * kilogram;
        let joule = newton * metre;
        let scales = [metre, metre, metre, 1.0, metre, newton, joule, joule];
        let found: Vec<f64> = found
            .iter()
            .zip(scales)
            .map(|(x, scale)| x / scale)
            .collect();
        agree(&found, "in other units");
    }
    let mut file = file.clone();
    file["bodies"]["case"] = json!({
        "mass": 0.1, "inertia": {"xx": 0.001, "yy": 0.001, "zz": 0.001},
        "place": {"at": [0.1, 0.05, 0.2], "turn": {"axis": [1, 2, 0.4], "angle": 0.9}},
        "velocity": {"linear": [0, 1, 0], "angular": [0.4, 0.3, -0.5]}
    });
    file["joints"] = json!({"glue": {"weld": {"between": ["plate", "case"], "at": [0, 0.05, 0]}}});
    for (a, b) in values(&file).iter().zip(unlowered_values(&file)) {
        close(*a, b, 1e-6, "welded");
    }
}

#[test]
fn bad_fields_are_told() {
    let told = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut file = carried(json!({"duration": 0.1}));
        change(&mut file["loads"]["ground"]["contact"]);
        faults_say(&file, words);
    };
    let own = "/loads/ground/contact/surface/height_field";
    let heights = format!("{own}/heights");
    told(
        &|contact| contact["surface"]["height_field"]["heights"] = json!([[0, 1]]),
        &[&heights, "1 rows", "one for each place"],
    );
    told(
        &|contact| contact["surface"]["height_field"]["along"][3] = json!(-2),
        &[&format!("{own}/along/3"), "places that increase"],
    );
    told(
        &|contact| contact["surface"]["height_field"]["direction"] = json!([0, -1, 0]),
        &[&format!("{own}/direction"), "across"],
    );
    told(
        &|contact| contact["radius"] = json!(2),
        &[&heights, "hollow", "touches at one place"],
    );
    told(
        &|contact| contact["wheel"] = json!({"axis": [0, 0, 1], "radius": 2}),
        &[&heights, "hollow", "sphere or wheel"],
    );
    told(
        &|contact| contact["spheres"] = json!(3),
        &["/loads/ground/contact/spheres", "no capsule"],
    );
    told(
        &|contact| {
            contact["half"] = json!([0.1, 0, 0]);
            contact["spheres"] = json!(1);
        },
        &["/loads/ground/contact/spheres", "2"],
    );
    // A wheel that lies on flat ground touches everywhere.
    told(
        &|contact| {
            let flat = field(&[-1.0, 1.0], &[-1.0, 1.0], |_, _| 0.0);
            contact["surface"] = flat;
            contact["wheel"] = json!({"axis": [0, 1, 0], "radius": 0.1});
        },
        &["/loads/ground/contact/wheel/axis", "a wheel that stands"],
    );
}

/// Puts a shape, and a radius, in place of the sphere of a file.
fn shaped(mut file: Value, radius: f64, shape: &Value) -> Value {
    let own = file["loads"]["ground"]["contact"]
        .as_object_mut()
        .expect("a contact");
    own.extend(shape.as_object().expect("an object").clone());
    own.insert("radius".into(), json!(radius));
    file
}

/// Capsules and leaning wheels on heights of a plane have the motions that they have on the plane.
#[test]
fn capsules_and_wheels_on_a_plane_field() {
    let simulation = || json!({"duration": 0.6, "tolerance": 1e-10});
    let heights = field(&[-1.0, 0.1, 0.3], &[-0.2, 0.0, 0.15], |u, v| {
        0.02 + 0.1 * u - 0.2 * v
    });
    let plane = json!({"plane": {"normal": [-0.1, 1, -0.2]}});
    for shape in [
        json!({"half": [0.2, 0.05, 0.1], "spheres": 2}),
        json!({"half": [0.2, 0.05, 0.1], "spheres": 5}),
        json!({"wheel": {"axis": [0.4, 0.3, 1], "radius": 0.08}}),
        json!({"wheel": {"axis": [1, 0.5, -0.3], "radius": 0.08}}),
    ] {
        let on = |surface: &Value, height: f64| {
            let file = ball(surface.clone(), [0.0, height, 0.0], simulation());
            values(&shaped(file, 0.03, &shape))
        };
        let exact = on(&plane, 0.02);
        assert!(exact[5] > 2.0, "{exact:?}");
        for (a, b) in on(&heights, 0.0).iter().zip(&exact) {
            assert!((a - b).abs() < 1e-6 * b.abs().max(0.1), "{shape}: {a} {b}");
        }
    }
}

/// An upright wheel on a road is a sphere of its whole radius; the tyre may be sharp.
#[test]
fn an_upright_wheel_on_a_road_is_a_sphere() {
    let along = grid(-1.0, 4.0, 26);
    let mut road = field(&along, &[0.0], |u, _| 0.1 * (2.0 * u + 0.3).sin());
    road["height_field"]["direction"] = json!([1, 0, 0]);
    let mut file = ball(
        road,
        [0.0, 0.0, 0.0],
        json!({"duration": 0.8, "tolerance": 1e-11}),
    );
    file["bodies"]["ball"]["velocity"] = json!({"linear": [3, -0.5, 0], "angular": [0, 0, -5]});
    let exact = values(&shaped(file.clone(), 0.2, &json!({})));
    assert!(exact[0] > 1.5 && exact[5] > 5.0, "{exact:?}");
    for radius in [0.2, 0.15] {
        let shape = json!({"wheel": {"axis": [0, 0, 1], "radius": radius}});
        let found = values(&shaped(file.clone(), 0.2 - radius, &shape));
        for (a, b) in found.iter().zip(&exact) {
            close(*a, *b, 1e-7, "a sphere");
        }
    }
}

/// A capsule on heights is as many spheres as are no further apart than its radius; two that are given are its ends.
#[test]
fn a_capsule_is_spheres() {
    let hills = || {
        field(&grid(-0.5, 1.0, 9), &grid(-0.4, 0.5, 6), |u, v| {
            0.05 * (5.0 * u).sin() * (4.0 * v + 0.3).cos()
        })
    };
    let file = ball(
        hills(),
        [0.0, 0.0, 0.0],
        json!({"duration": 0.5, "tolerance": 1e-10}),
    );
    for (spheres, radius) in [(Some(2), 0.05), (None, 0.05), (None, 0.101)] {
        let half = [0.2, 0.05, 0.1];
        let mut one = shaped(file.clone(), radius, &json!({"half": half}));
        if let Some(count) = spheres {
            one["loads"]["ground"]["contact"]["spheres"] = json!(count);
        }
        // The capsule is 0.458 m long between the centres.
        let count = spheres.unwrap_or(if radius == 0.05 { 11 } else { 6 });
        let mut many = shaped(file.clone(), radius, &json!({}));
        let contact = many["loads"]["ground"].take();
        for k in 0..count {
            let part = 1.0 - 2.0 * f64::from(k) / f64::from(count - 1);
            let name = if k == 0 {
                "ground".into()
            } else {
                format!("sphere {k}")
            };
            many["loads"][&name] = contact.clone();
            // The spheres have the stiffness of two.
            many["loads"][&name]["contact"]["stiffness"] = json!(2e4 * 2.0 / f64::from(count));
            many["loads"][&name]["contact"]["at"]["a"] = json!(half.map(|x| part * x));
        }
        let (found, exact) = (values(&one), values(&many));
        for k in [0, 1, 2, 3, 7] {
            close(found[k], exact[k], 1e-6, "spheres");
        }
        assert!(found[5] > 1.0, "{found:?}");
    }
}

/// A leaning wheel without loss that bounces over hills keeps its energy.
#[test]
fn a_wheel_on_hills_keeps_energy() {
    let hills = field(&grid(-1.5, 3.0, 31), &grid(-1.5, 1.5, 21), |u, v| {
        0.08 * (3.0 * u).sin() * (2.0 * v + 0.3).cos()
    });
    let mut file = ball(
        hills,
        [0.0, 0.0, 0.0],
        json!({"duration": 1.5, "tolerance": 1e-10}),
    );
    file["loads"]["ground"]["contact"]["friction"]["coefficient"] = json!(0);
    file["loads"]["ground"]["contact"]["dissipation"] = json!(0);
    file["functions"]["first"] = json!({"value": {"at": 0, "of": {"energy": "total"}}});
    for tyre in [0.0, 0.04] {
        let shape = json!({"wheel": {"axis": [0.3, 0.4, 1], "radius": 0.12}});
        let off = |tolerance: f64| {
            let mut file = shaped(file.clone(), tyre, &shape);
            file["simulation"]["tolerance"] = json!(tolerance);
            let found = values(&file);
            assert!(found[5] > 5.0, "{found:?}");
            found[7] / found[8] - 1.0
        };
        let off = [1e-8, 1e-9, 1e-10, 1e-11].map(off);
        println!("a tyre of {tyre} m: energy changes by {off:?}");
        assert!(off[3].abs() < 1e-6, "{off:?}");
    }
}
