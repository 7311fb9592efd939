//! Vibrations of machines with damping and under loads without potential: closed forms, independent eigenvalues, families,
//! derivatives, and what has none.

use super::machines_at_rest::{fault, hinge, machine, rod};
use crate::reference::documents::{faults_say, problem as parsed, read, values};
use crate::reference::gradients::{gradients_are_exact, gradients_are_slopes};
use flexbody_driver::{check, simulate};
use nalgebra::DMatrix;
use serde_json::Value;
use std::f64::consts::PI;

/// Frequency |Im s| / 2π and damping ratio of the pairs of M s² + D s + K, the lowest |s| first.
pub fn pairs(
    mass: &DMatrix<f64>,
    damping: &DMatrix<f64>,
    stiffness: &DMatrix<f64>,
) -> Vec<[f64; 2]> {
    let n = mass.nrows();
    let inverse = mass.clone().try_inverse().expect("regular");
    let mut state = DMatrix::zeros(2 * n, 2 * n);
    state.view_mut((0, n), (n, n)).fill_with_identity();
    state
        .view_mut((n, 0), (n, n))
        .copy_from(&(-&inverse * stiffness));
    state
        .view_mut((n, n), (n, n))
        .copy_from(&(-&inverse * damping));
    let values = state.complex_eigenvalues();
    let mut all: Vec<_> = values.iter().filter(|s| s.im > 0.0).collect();
    all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    all.iter()
        .map(|s| [s.im / (2.0 * PI), -s.re / s.norm()])
        .collect()
}

/// Functions of the damped modes: frequency and damping ratio of each.
fn damped(count: usize) -> Value {
    let mut all = serde_json::Map::new();
    for mode in 1..=count {
        all.insert(
            format!("f{mode}"),
            json!({"frequency": {"mode": mode, "damped": true}}),
        );
        all.insert(format!("z{mode}"), json!({"damping_ratio": {"mode": mode}}));
    }
    all.into()
}

/// Size below which numbers are compared absolutely.
const SMALL: f64 = 1e-2;

fn assert_near(found: &[f64], expected: &[f64], part: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        // Small damping ratios are known as parts of one.
        let size = e.abs().max(SMALL);
        assert!((f - e).abs() <= part * size, "{found:?} {expected:?}");
    }
}

/// Two carts between three springs with dampers.
fn carts(stiffness: [f64; 3], damping: [f64; 3], masses: [f64; 2]) -> Value {
    let cart = |x: f64, mass: f64| json!({"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": mass, "place": {"at": [x, 0, 0]}});
    let rail = |body: &str| json!({"prismatic": {"between": [body, "ground"], "at": body, "axis": [1, 0, 0]}});
    let spring = |a: &str, b: &str, end: f64, k: usize| {
        json!({"spring": {
            "between": [a, b], "at": {"a": [0, 0, 0], "b": [end, 0, 0]}, "rest_length": 1,
            "stiffness": stiffness[k], "damping": damping[k]
        }})
    };
    json!({
        "version": 1, "name": "carts", "analysis": "rest",
        "bodies": {"one": cart(1.0, masses[0]), "two": cart(2.0, masses[1])},
        "joints": {"first": rail("one"), "second": rail("two")},
        "loads": {
            "left": spring("one", "ground", 0.0, 0),
            "middle": spring("two", "one", 0.0, 1),
            "right": spring("two", "ground", 3.0, 2)
        },
        "functions": damped(2),
        "variables": {
            "stiffness": {"path": "/loads/left/spring/stiffness", "lower": 1, "upper": 1e4},
            "damping": {"path": "/loads/middle/spring/damping", "lower": 0, "upper": 1e2},
            "mass": {"path": "/bodies/two/mass", "lower": 0.1, "upper": 10}
        }
    })
}

fn of_carts([a, b, c]: [f64; 3]) -> DMatrix<f64> {
    DMatrix::from_row_slice(2, 2, &[a + b, -b, -b, b + c])
}

/// A cart alone, too: ζ = c / 2√(k m), f = f_0 √(1 − ζ²).
#[test]
fn damped_carts_have_the_rates_of_their_matrices() {
    for (stiffness, damping, masses) in [
        ([300.0, 170.0, 90.0], [2.0, 5.0, 0.5], [2.0, 0.7]),
        ([300.0, 0.0, 90.0], [2.0, 0.0, 0.5], [2.0, 0.7]),
        ([200.0, 0.1, 201.0], [1.0, 0.4, 1.0], [1.0, 1.0]),
        ([300.0, 170.0, 90.0], [0.0, 40.0, 0.0], [2.0, 0.7]),
    ] {
        let mass = DMatrix::from_diagonal(&nalgebra::DVector::from_row_slice(&masses));
        let expected = pairs(&mass, &of_carts(damping), &of_carts(stiffness));
        let mut file = carts(stiffness, damping, masses);
        file["functions"] = damped(expected.len());
        let found = values(&file);
        assert_near(&found, &expected.concat(), 1e-11);
        if damping[1] > 0.0 {
            gradients_are_exact(&parsed(&file), &json!([stiffness, damping]));
        }
        if stiffness[1] == 0.0 {
            let one = |k: usize, m: usize| {
                let own = (stiffness[k] / masses[m]).sqrt();
                let ratio = damping[k] / (2.0 * (stiffness[k] * masses[m]).sqrt());
                [own * (1.0 - ratio * ratio).sqrt() / (2.0 * PI), ratio]
            };
            let mut closed = [one(0, 0), one(2, 1)];
            closed.sort_by(|a, b| a[0].total_cmp(&b[0]));
            assert_near(&found, &closed.concat(), 1e-11);
        }
        // Without damping there is another frequency.
        file["functions"] = json!({"f": {"frequency": {"mode": 1}}});
        let none = DMatrix::zeros(2, 2);
        let expected = pairs(&mass, &none, &of_carts(stiffness))[0][0];
        assert_near(&values(&file), &[expected], 1e-11);
    }
}

/// Derivatives against differences of independent eigenvalues, also where two modes are close.
#[test]
fn derivatives_are_those_of_the_rates() {
    let masses = [1.0, 1.0];
    for (stiffness, damping) in [
        ([300.0, 170.0, 90.0], [2.0, 5.0, 0.5]),
        ([200.0, 0.2, 200.1], [1.0, 0.01, 1.1]),
    ] {
        let problem = parsed(&carts(stiffness, damping, masses));
        gradients_are_exact(&problem, &json!(stiffness));
        let x = problem.start();
        let at = |x: &[f64]| {
            let (mut k, mut c) = (stiffness, damping);
            (k[0], c[1]) = (x[0], x[1]);
            let mass = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, x[2]]);
            pairs(&mass, &of_carts(c), &of_carts(k)).concat()
        };
        let order = [0, 1, 2, 3];
        let value = |f: usize, x: &[f64]| at(x)[order[f]];
        for derivative in check(&problem, &x).expect("derivatives") {
            let (f, i) = (derivative.function, derivative.variable);
            let step = 1e-5 * x[i];
            let moved = |by: f64| {
                let mut x = x.clone();
                x[i] += by;
                value(f, &x)
            };
            let difference = (8.0 * (moved(step) - moved(-step)) - moved(2.0 * step)
                + moved(-2.0 * step))
                / (12.0 * step);
            let off = (derivative.adjoint - difference).abs() * x[i];
            assert!(
                off < 1e-8 * value(f, &x).abs().max(1.0),
                "{derivative:?} {difference}"
            );
        }
    }
}

/// Ziegler's column: links in hinges with springs, and a push P along the last that turns with it. With the mass matrix of rods,
/// K = c [2, −1; −1, 1] + P L [−1, 1; 0, 0] in absolute angles.
fn ziegler(push: f64, damping: f64) -> Value {
    let link = |name: &str, at: Value| {
        (
            name.to_owned(),
            rod(1.0, 2.0, json!({"put": "a", "at": at})),
        )
    };
    let bodies: serde_json::Map<_, _> =
        [link("one", json!([0, 0, 0])), link("two", json!("one.b"))]
            .into_iter()
            .collect();
    let spring = |joint: &str| json!({"torsion_spring": {"joint": joint, "stiffness": 30, "damping": damping}});
    json!({
        "version": 1, "name": "column", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": bodies,
        "joints": {"foot": hinge(["one", "ground"], json!("one.a")), "knee": hinge(["two", "one"], json!("two.a"))},
        "loads": {
            "foot": spring("foot"), "knee": spring("knee"),
            "push": {"force": {"body": "two", "point": "b", "direction": [-1, 0, 0], "axes": "body", "magnitude": push}}
        },
        "functions": {"f1": {"frequency": {"mode": 1}}, "f2": {"frequency": {"mode": 2}}},
        "variables": {
            "push": {"path": "/loads/push/force/magnitude", "lower": 1, "upper": 100},
            "spring": {"path": "/loads/knee/torsion_spring/stiffness", "lower": 1, "upper": 100},
            "mass": {"path": "/bodies/two/mass", "lower": 0.1, "upper": 10}
        }
    })
}

fn of_ziegler(push: f64, damping: f64) -> Vec<[f64; 2]> {
    let inertia = 1.0 / 12.0 * 2.0 + 2.0 * 1e-4 / 4.0;
    let mass = DMatrix::from_row_slice(2, 2, &[inertia + 2.5, 1.0, 1.0, inertia + 0.5]);
    let chain = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 1.0]);
    let follower = DMatrix::from_row_slice(2, 2, &[-1.0, 1.0, 0.0, 0.0]);
    pairs(
        &mass,
        &(&chain * damping),
        &(&chain * 30.0 + follower * push),
    )
}

#[test]
fn a_column_under_a_following_push_flutters() {
    for push in [10.0, 25.0] {
        let file = ziegler(push, 0.0);
        let expected: Vec<f64> = of_ziegler(push, 0.0).iter().map(|own| own[0]).collect();
        assert_near(&values(&file), &expected, 1e-10);
        gradients_are_exact(&parsed(&file), &json!(push));
        let mut lowest = file.clone();
        lowest["functions"] = json!({"lowest": {"lowest_frequency": {"rho": 2}}});
        let sum: f64 = expected.iter().map(|f| (-2.0 * f).exp()).sum();
        assert_near(&values(&lowest), &[-0.5 * sum.ln()], 1e-10);
        gradients_are_exact(&parsed(&lowest), &json!(push));
    }
    // The frequencies have met, and one oscillation grows.
    let push = 90.0;
    let expected = of_ziegler(push, 0.0);
    assert!(expected[0][1].abs() > 0.01, "{expected:?}");
    let text = fault(&ziegler(push, 0.0));
    assert!(
        text.contains("flutter") && text.contains("/functions"),
        "{text}"
    );
    for damping in [0.0, 0.3] {
        let mut file = ziegler(push, damping);
        file["functions"] = damped(2);
        // Without damping |s| is the same of both: the order is not defined.
        let mut expected = of_ziegler(push, damping);
        let mut found: Vec<[f64; 2]> = values(&file)
            .chunks(2)
            .map(|own| [own[0], own[1]])
            .collect();
        for own in [&mut expected, &mut found] {
            own.sort_by(|a, b| a[1].total_cmp(&b[1]));
        }
        assert_near(&found.concat(), &expected.concat(), 1e-9);
        assert!(found[0][1] < 0.0);
        gradients_are_exact(&parsed(&file), &json!(damping));
    }
}

/// The same machine in another order, turned, in another unit of mass.
#[test]
fn equal_machines_are_damped_alike() {
    let of = |mut file: Value, mass: f64| {
        for spring in ["middle", "near"] {
            file["loads"][spring]["spring"]["damping"] = json!(1.5 * mass);
        }
        file["functions"] = damped(4);
        values(&file)
    };
    let expected = of(machine(false, false, 0.0, 1.0), 1.0);
    assert!(
        expected.iter().all(|x| x.is_finite() && *x > 0.0),
        "{expected:?}"
    );
    for (reversed, angle, mass) in [
        (true, 0.0, 1.0),
        (true, 0.8, 1.0),
        (false, -2.0, 1e3),
        (false, 0.0, 1e-4),
    ] {
        assert_near(
            &of(machine(reversed, false, angle, mass), mass),
            &expected,
            1e-7,
        );
    }
}

/// Derivatives go through the rest, which moves with the design: against differences.
#[test]
fn derivatives_follow_the_rest() {
    let mut file = machine(false, false, 0.3, 1.0);
    for spring in ["middle", "near"] {
        file["loads"][spring]["spring"]["damping"] = json!(1.5);
    }
    // The spin of rods is hardly damped.
    file["functions"] = json!({
        "f2": {"frequency": {"mode": 2, "damped": true}}, "z2": {"damping_ratio": {"mode": 2}},
        "f4": {"frequency": {"mode": 4, "damped": true}}, "z4": {"damping_ratio": {"mode": 4}}
    });
    file["variables"] = json!({
        "stiffness": {"path": "/loads/middle/spring/stiffness", "lower": 10, "upper": 100},
        "damping": {"path": "/loads/middle/spring/damping", "lower": 0.1, "upper": 100},
        "length": {"path": "/loads/near/spring/rest_length", "lower": 0.1, "upper": 1},
        "mass": {"path": "/bodies/first/mass", "lower": 1, "upper": 5},
        "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1}
    });
    file["gravity"] = json!([0, -9.81, 0]);
    let problem = parsed(&file);
    gradients_are_exact(&problem, &json!("machine"));
    gradients_are_slopes(&problem, 1e-2, &json!("machine"));
}

/// A machine with many coordinates: a chain of links with damped hinges, against its matrices in absolute angles.
#[test]
fn a_long_chain_has_the_rates_of_its_angles() {
    let (n, length, mass, damping) = (60, 0.1, 0.3, 0.002);
    let (mut bodies, mut joints, mut loads) = (
        serde_json::Map::new(),
        serde_json::Map::new(),
        serde_json::Map::new(),
    );
    for k in 0..n {
        let (name, before) = (format!("l{k}"), format!("l{}", k.max(1) - 1));
        let (at, other) = match k {
            0 => (json!([0, 0, 0]), "ground"),
            _ => (json!(format!("{before}.b")), &before[..]),
        };
        let turn = json!({"axis": [0, 0, 1], "angle": -PI / 2.0});
        bodies.insert(
            name.clone(),
            rod(length, mass, json!({"put": "a", "at": at, "turn": turn})),
        );
        joints.insert(
            format!("j{k}"),
            hinge([&name, other], json!(format!("{name}.a"))),
        );
        let damper = json!({"damping": {"joint": format!("j{k}"), "coefficient": damping}});
        loads.insert(format!("d{k}"), damper);
    }
    let file = json!({
        "version": 1, "name": "chain", "analysis": "rest",
        "bodies": bodies, "joints": joints, "loads": loads, "functions": damped(5)
    });
    let thin = 1e-4 / 4.0 / (length * length);
    let inertia = DMatrix::from_fn(n, n, |i, j| {
        let below = (n - 1 - i.max(j)) as f64;
        mass * length * length * (below + if i == j { 1.0 / 3.0 + thin } else { 0.5 })
    });
    let stiffness = DMatrix::from_fn(n, n, |i, j| match i == j {
        true => mass * 9.81 * length * ((n - 1 - i) as f64 + 0.5),
        false => 0.0,
    });
    let dampers = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i + 1 < n => 2.0 * damping,
        0 => damping,
        1 => -damping,
        _ => 0.0,
    });
    let expected = &pairs(&inertia, &dampers, &stiffness)[..5];
    assert_near(&values(&file), &expected.concat(), 1e-8);
}

/// What has no such modes.
#[test]
fn what_has_no_damped_modes_is_told() {
    // Beyond critical damping nothing oscillates.
    let mut file = carts([100.0, 0.0, 100.0], [500.0, 0.0, 1.0], [1.0, 1.0]);
    file["functions"] = damped(2);
    let text = fault(&file);
    assert!(
        text.contains("mode 2 is asked for, and there are 1"),
        "{text}"
    );
    // Equal rates have no derivatives.
    let mut file = carts([100.0, 0.0, 100.0], [1.0, 0.0, 1.0], [1.0, 1.0]);
    file["variables"]["damping"]["path"] = json!("/loads/left/spring/damping");
    for own in check(&parsed(&file), &parsed(&file).start()).expect("derivatives") {
        assert!(own.adjoint.is_nan(), "{own:?}");
    }
    let text = fault(&json!({
        "version": 1, "name": "plate", "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}},
        "structures": {"plate": {
            "mesh": {"plate": {"length": 1, "width": 0.5, "elements": [2, 1]}}, "material": "aluminium", "thickness": 0.01
        }},
        "functions": {"f": {"frequency": {"mode": 1, "damped": true}}}
    }));
    assert!(text.contains("damped frequency of structures"), "{text}");
    let mut moving = carts([1.0; 3], [1.0; 3], [1.0; 2]);
    moving
        .as_object_mut()
        .expect("an object")
        .remove("analysis");
    moving["simulation"] = json!({"duration": 1});
    let text = fault(&moving);
    assert!(
        text.contains("a natural frequency of a machine in motion"),
        "{text}"
    );
}

/// A clamped plate with damping by its stiffness: frequencies and damping ratios of its bending.
fn thin_plate(thickness: f64, damping: f64) -> Value {
    json!({
        "version": 1, "name": "plate", "analysis": "modes", "gravity": [0, 0, 0],
        "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}},
        "bodies": {"plate": {
            "elements": {
                "structure": {
                    "mesh": {"plate": {"length": 1, "width": 0.5, "elements": [6, 3]}},
                    "material": "aluminium", "thickness": thickness,
                    "damping": {"stiffness": damping}
                },
                "frame": {"clamped": "x0"}, "points": {"root": {"rigid": "x0"}}
            },
            "place": {"put": "root"}
        }},
        "joints": {"clamp": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
        "functions": {
            "first": {"frequency": {"mode": 1}},
            "of first": {"damping_ratio": {"mode": 1}},
            "fifth": {"frequency": {"mode": 5}},
            "of fifth": {"damping_ratio": {"mode": 5}},
            "damped": {"frequency": {"mode": 5, "damped": true}}
        }
    })
}

/// Damping by stiffness gives each mode ζ = π f β, however thin the plate is: its stretch is stiffer than its bending by the square of
/// length by thickness.
#[test]
fn thin_plates_have_the_damping_of_their_bending() {
    let damping = 1e-4;
    let mut first = None;
    for thickness in [1e-2, 1e-3, 1e-4] {
        let file = thin_plate(thickness, damping);
        let found = values(&file);
        for k in [0, 2] {
            let expected = PI * found[k] * damping;
            let off = found[k + 1] / expected - 1.0;
            assert!(off.abs() < 1e-9, "{thickness}: {} {expected}", found[k + 1]);
        }
        let damped = found[2] * (1.0 - found[3] * found[3]).sqrt();
        assert!(
            (found[4] / damped - 1.0).abs() < 1e-9,
            "{thickness}: {damped}"
        );
        // Bending of thin plates: f ∝ h.
        let by_thickness = found[0] / thickness;
        let before = *first.get_or_insert(by_thickness);
        assert!(
            (by_thickness / before - 1.0).abs() < 1e-3,
            "{by_thickness} {before}"
        );
    }
}

/// Thinner plates are refused: round-off of the stretch hides their bending.
#[test]
fn plates_whose_bending_is_hidden_are_refused() {
    let damped = ["of first", "of fifth", "damped"];
    for thickness in [1e-6, 1e-7, 1e-8] {
        let mut file = thin_plate(thickness, 1e-4);
        faults_say(&file, &["round-off of the stiffest motions hides"]);
        // Beside free motions too.
        let mut free = file.clone();
        free.as_object_mut().expect("an object").remove("joints");
        faults_say(&free, &["round-off of the stiffest motions hides"]);
        let functions = file["functions"].as_object_mut().expect("functions");
        functions.retain(|name, _| !damped.contains(&name.as_str()));
        faults_say(&file, &["round-off of the stiffest motions hides"]);
    }
}

/// The modes of the lamp move its arms as far as can be seen, and no farther.
#[test]
fn pictures_show_the_shapes() {
    let mut file = read("problems/desk_lamp.json");
    file["analysis"] = json!("modes");
    let problem = parsed(&file);
    let shown = simulate(&problem, &problem.start()).expect("a rest");
    let all = flexbody_figures::of_simulation(&problem, &shown);
    let svg = all
        .iter()
        .find(|(name, _)| *name == "modes.svg")
        .expect("a picture");
    let text = std::str::from_utf8(&svg.1).expect("UTF-8");
    let outline = |element: &str| -> [f64; 4] {
        let (_, points) = element.split_once("points=\"").expect("points");
        let (points, _) = points.split_once('"').expect("an end");
        let mut found = [
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        for point in points.split_whitespace() {
            let (x, y) = point.split_once(',').expect("two numbers");
            for (k, text) in [x, y].into_iter().enumerate() {
                let value: f64 = text.parse().expect("a number");
                found[2 * k] = found[2 * k].min(value);
                found[2 * k + 1] = found[2 * k + 1].max(value);
            }
        }
        found
    };
    let all: Vec<[f64; 4]> = text.split("<polygon").skip(1).map(outline).collect();
    // The legend, then for each of two modes three bodies at rest and displaced.
    let bodies = &all[3..];
    assert_eq!(bodies.len(), 12);
    for mode in bodies.chunks_exact(6) {
        let (rest, moved) = mode.split_at(3);
        let size = [0, 2].map(|k| {
            let low = rest.iter().map(|own| own[k]).fold(f64::INFINITY, f64::min);
            rest.iter()
                .map(|own| own[k + 1])
                .fold(f64::NEG_INFINITY, f64::max)
                - low
        });
        let size = size[0].max(size[1]);
        let pairs = rest.iter().flatten().zip(moved.iter().flatten());
        let largest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(
            (0.03..0.25).contains(&(largest / size)),
            "{largest} of {size}"
        );
    }
}
