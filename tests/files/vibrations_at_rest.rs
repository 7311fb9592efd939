//! Natural frequencies of machines about their rest: closed forms, independent eigenvalues, families, derivatives, and
//! what has none.

use super::machines_at_rest::{fault, hinge, machine, rod};
use crate::reference::documents::{problem as parsed, value, values, vary};
use crate::reference::gradients::{gradients_are_exact, gradients_are_slopes};
use flexbody_driver::{Simulated, check};
use nalgebra::{DMatrix, SymmetricEigen};
use serde_json::Value;
use std::f64::consts::PI;

const GRAVITY: f64 = 9.81;

fn frequencies(count: usize) -> Value {
    let one = |mode: usize| (format!("f{mode}"), json!({"frequency": {"mode": mode}}));
    (1..=count)
        .map(one)
        .collect::<serde_json::Map<_, _>>()
        .into()
}

fn assert_near(found: &[f64], expected: &[f64], part: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= part * e.abs(), "{found:?} {expected:?}");
    }
}

/// Links of length L and mass m that hang from each other.
fn chain(n: usize, length: f64, mass: f64) -> Value {
    let (mut bodies, mut joints) = (serde_json::Map::new(), serde_json::Map::new());
    for k in 0..n {
        let (name, before) = (format!("l{k}"), format!("l{}", k.wrapping_sub(1)));
        let at = match k {
            0 => json!([0, 0, 0]),
            _ => json!(format!("{before}.b")),
        };
        let other = if k == 0 { "ground" } else { &before };
        // Placed askew.
        let turn = json!({"axis": [0, 0, 1], "angle": -1.2 + 0.1 * k as f64});
        let place = json!({"put": "a", "at": at, "turn": turn});
        bodies.insert(name.clone(), rod(length, mass, place));
        joints.insert(
            format!("j{k}"),
            hinge([&name, other], json!(format!("{name}.a"))),
        );
    }
    json!({
        "version": 1, "name": "chain", "analysis": "rest",
        "bodies": bodies, "joints": joints, "functions": frequencies(n)
    })
}

/// M_ij = m L² (n − 1 − max(i, j) + ½), with ⅓ on the diagonal, and K_ii = m g L (n − 1 − i + ½). Two links have ω² = 3 (1 ± 2 / √7)
/// g / L.
#[test]
fn a_hanging_chain_has_the_frequencies_of_its_angles() {
    let (length, mass) = (0.7, 1.3);
    for n in [1, 2, 3, 5] {
        let inertia = DMatrix::from_fn(n, n, |i, j| {
            let below = (n - 1 - i.max(j)) as f64;
            mass * length * length * (below + if i == j { 1.0 / 3.0 } else { 0.5 })
        });
        let lower = inertia.cholesky().expect("inertia").l();
        let stiffness = DMatrix::from_fn(n, n, |i, j| match i == j {
            true => mass * GRAVITY * length * ((n - 1 - i) as f64 + 0.5),
            false => 0.0,
        });
        let inverse = lower.try_inverse().expect("regular");
        let eigen = SymmetricEigen::new(&inverse * stiffness * inverse.transpose());
        let mut expected: Vec<f64> = eigen
            .eigenvalues
            .iter()
            .map(|x| x.sqrt() / (2.0 * PI))
            .collect();
        expected.sort_by(f64::total_cmp);
        if n == 2 {
            let of =
                |sign: f64| (3.0 * (1.0 + sign * 2.0 / 7.0_f64.sqrt()) * GRAVITY / length).sqrt();
            assert_near(
                &expected,
                &[of(-1.0) / (2.0 * PI), of(1.0) / (2.0 * PI)],
                1e-12,
            );
        }
        // Rods have a radius.
        let found = values(&chain(n, length, mass));
        assert_near(&found, &expected, 1e-3);
    }
}

/// Two carts between three springs.
fn carts(stiffness: [f64; 3], masses: [f64; 2]) -> Value {
    let cart = |x: f64, mass: f64| json!({"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": mass, "place": {"at": [x, 0, 0]}});
    let rail = |body: &str| json!({"prismatic": {"between": [body, "ground"], "at": body, "axis": [1, 0, 0]}});
    let spring = |a: &str, b: &str, at: Value, stiffness: f64| json!({"spring": {"between": [a, b], "at": at, "rest_length": 1, "stiffness": stiffness}});
    json!({
        "version": 1, "name": "carts", "analysis": "rest",
        "bodies": {"one": cart(1.0, masses[0]), "two": cart(2.0, masses[1])},
        "joints": {"first": rail("one"), "second": rail("two")},
        "loads": {
            "left": spring("one", "ground", json!({"a": [0, 0, 0], "b": [0, 0, 0]}), stiffness[0]),
            "middle": spring("two", "one", json!({"a": [0, 0, 0], "b": [0, 0, 0]}), stiffness[1]),
            "right": spring("two", "ground", json!({"a": [0, 0, 0], "b": [3, 0, 0]}), stiffness[2])
        },
        "functions": frequencies(2)
    })
}

#[test]
fn two_carts_have_the_frequencies_of_their_springs() {
    let ([a, b, c], [m, n]) = ([300.0, 170.0, 90.0], [2.0, 0.7]);
    let found = values(&carts([a, b, c], [m, n]));
    let mut swapped = carts([a, b, c], [m, n]);
    swapped["joints"]["first"]["prismatic"]["between"] = json!(["ground", "one"]);
    assert_near(&values(&swapped), &found, 1e-12);
    let (half, product) = (
        ((a + b) / m + (b + c) / n) / 2.0,
        ((a + b) * (b + c) - b * b) / (m * n),
    );
    let root = (half * half - product).sqrt();
    let expected = [half - root, half + root].map(|x: f64| x.sqrt() / (2.0 * PI));
    assert_near(&found, &expected, 1e-12);
}

/// A cantilever with a mass at its tip, of r times its own: 1 + cos β cosh β = r β (sin β cosh β − cos β sinh β), ω = β² √(EI / m L³).
fn cantilever(ratio: f64) -> Value {
    let section = json!({"rectangle": {"width": 0.02, "height": 0.01}});
    let beam = json!({
        "beam": {"length": 1, "section": section,
                 "material": {"young": 7e10, "density": 2700, "poisson": 0.3},
                 "modes": {"bending_y": 6, "bending_z": 6, "torsion": 2, "stretch": 2}},
        "place": {"put": "start"}
    });
    json!({
        "version": 1, "name": "cantilever", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {
            "beam": beam,
            "tip": {"shape": "point", "mass": ratio * 2700.0 * 0.02 * 0.01, "place": {"at": "beam.end"}}
        },
        "joints": {
            "wall": {"weld": {"between": ["beam", "ground"], "at": "beam.start"}},
            "seat": {"spherical": {"between": ["tip", "beam"], "at": "beam.end"}}
        },
        "functions": frequencies(2),
        "variables": {
            "young": {"path": "/bodies/beam/beam/material/young", "lower": 1e10, "upper": 1e11},
            "height": {"path": "/bodies/beam/beam/section/rectangle/height", "lower": 0.005, "upper": 0.018},
            "tip": {"path": "/bodies/tip/mass", "lower": 0.01, "upper": 10}
        }
    })
}

#[test]
fn a_cantilever_with_a_mass_at_its_tip() {
    for ratio in [0.2, 1.0, 5.0] {
        let found = values(&cantilever(ratio));
        let off = |b: f64| {
            1.0 + b.cos() * b.cosh() - ratio * b * (b.sin() * b.cosh() - b.cos() * b.sinh())
        };
        let (mut low, mut high) = (0.1, 1.8751041);
        while high - low > 1e-14 {
            let middle = 0.5 * (low + high);
            if off(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        // Both directions of bending, of inertia height³ width / 12 and width³ height / 12.
        let (ei, mass) = (7e10 * 0.02_f64 * 0.01_f64 / 12.0, 2700.0 * 0.02 * 0.01);
        let one = |h: f64| low * low * (ei * h * h / mass).sqrt() / (2.0 * PI);
        assert_near(&found, &[one(0.01), one(0.02)], 1e-3);
        gradients_are_exact(&parsed(&cantilever(ratio)), &json!(ratio));
    }
}

/// A plate that is welded at an edge vibrates as the same mesh with a support.
#[test]
fn a_welded_plate_vibrates_as_a_supported_one() {
    let structure = json!({
        "mesh": {"plate": {"length": 1, "width": 0.5, "elements": [4, 2]}},
        "material": "aluminium", "thickness": 0.01
    });
    let materials = json!({"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}});
    let moving = json!({
        "version": 1, "name": "plate", "analysis": "rest", "gravity": [0, 0, 0], "materials": materials,
        "bodies": {"plate": {"elements": {
            "structure": structure, "frame": {"clamped": "x0"}, "points": {"root": {"rigid": "x0"}}
        }}},
        "joints": {"wall": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
        "functions": frequencies(4)
    });
    let mut still = json!({
        "version": 1, "name": "plate", "materials": materials, "structures": {"plate": structure},
        "functions": frequencies(4)
    });
    still["structures"]["plate"]["supports"] = json!({"root": {"nodes": "x0"}});
    let problem = parsed(&still);
    let at = Simulated::of(&problem, &problem.start()).expect("frequencies");
    let expected: Vec<f64> = (0..4).map(|f| at.value(f)).collect();
    assert_near(&values(&moving), &expected, 1e-9);
}

/// The same machine in another order, turned, in another unit of mass. (A cross whose bodies change places is another
/// machine: its axes are those of other bodies.)
#[test]
fn equal_machines_vibrate_alike() {
    let of = |mut file: Value| {
        file["functions"] = frequencies(4);
        values(&file)
    };
    let expected = of(machine(false, false, 0.0, 1.0));
    for other in [
        machine(true, false, 0.0, 1.0),
        machine(true, false, 0.8, 1.0),
        machine(false, false, -2.0, 1e3),
        machine(false, false, 0.0, 1e-4),
    ] {
        assert_near(&of(other), &expected, 1e-7);
    }
}

/// Derivatives go through the rest, which moves with the design: against differences.
#[test]
fn derivatives_follow_the_rest() {
    let mut file = machine(false, false, 0.3, 1.0);
    file["functions"] = json!({
        "f1": {"frequency": {"mode": 1}}, "f3": {"frequency": {"mode": 3}},
        "lowest": {"lowest_frequency": {"rho": 5}}
    });
    file["variables"] = json!({
        "stiffness": {"path": "/loads/middle/spring/stiffness", "lower": 10, "upper": 100},
        "length": {"path": "/loads/near/spring/rest_length", "lower": 0.1, "upper": 1},
        "mass": {"path": "/bodies/first/mass", "lower": 1, "upper": 5},
        "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1}
    });
    file["gravity"] = json!([0, -9.81, 0]);
    let problem = parsed(&file);
    gradients_are_exact(&problem, &json!("machine"));
    gradients_are_slopes(&problem, 0.0, &json!("machine"));
}

/// Where two frequencies meet, each has no derivative, and their aggregate has one.
#[test]
fn an_aggregate_has_derivatives_where_frequencies_meet() {
    let mut file = carts([200.0, 0.0, 200.0], [1.0, 1.0]);
    file["functions"] = json!({"lowest": {"lowest_frequency": {"rho": 3}}});
    file["variables"] = json!({
        "left": {"path": "/loads/left/spring/stiffness", "lower": 100, "upper": 300},
        "mass": {"path": "/bodies/two/mass", "lower": 0.5, "upper": 2}
    });
    let problem = parsed(&file);
    let f = 200.0_f64.sqrt() / (2.0 * PI);
    let at = Simulated::of(&problem, &problem.start()).expect("a rest");
    assert!((at.value(0) - (f - 2.0_f64.ln() / 3.0)).abs() < 1e-12);
    assert!((at.smoothed(0).expect("an aggregate").value - f).abs() < 1e-12);
    let found = check(&problem, &problem.start()).expect("derivatives");
    assert!(
        (found[0].adjoint - f / (4.0 * 200.0)).abs() < 1e-12,
        "{found:?}"
    );
    assert!((found[1].adjoint + f / 4.0).abs() < 1e-12, "{found:?}");
    // The other function keeps its derivatives.
    file["functions"]["first"] = json!({"frequency": {"mode": 1}});
    let problem = parsed(&file);
    let names = &problem.function_names;
    let of = |name: &str| {
        names
            .iter()
            .position(|own| own == name)
            .expect("a function")
    };
    assert!((values(&file)[of("first")] - f).abs() < 1e-12);
    for own in check(&problem, &problem.start()).expect("derivatives") {
        assert_eq!(
            own.adjoint.is_finite(),
            own.function == of("lowest"),
            "{own:?}"
        );
    }
}

/// A machine whose bodies can move in as many ways as modes are asked for, or fewer than the search would take; some of
/// them free.
#[test]
fn machines_of_few_motions_have_their_modes_alone() {
    let body = |at: Value| {
        let turn = json!({"axis": [1, 2, 3], "angle": 0.7});
        rod(1.0, 2.0, json!({"put": "a", "at": at, "turn": turn}))
    };
    let file = json!({
        "version": 1, "name": "few", "analysis": "rest",
        "bodies": {"one": body(json!([0, 0, 0])), "two": body(json!("one.b")), "three": body(json!("two.b"))},
        "joints": {
            "ball": {"spherical": {"between": ["one", "ground"], "at": "one.a"}},
            "cross": {"universal": {"between": ["two", "one"], "at": "two.a",
                                    "axis": [1, 0, 0], "cross": [0, 1, 0]}},
            "seat": {"weld": {"between": ["three", "two"], "at": "three.a"}}
        },
        "functions": {"f": {"frequency": {"mode": 4}}, "lowest": {"lowest_frequency": {"rho": 3}}}
    });
    // Five motions, of which the turn about the vertical is free; swings in two planes by two frequencies each.
    let found = values(&file);
    assert!(found.iter().all(|f| f.is_finite() && *f > 0.0), "{found:?}");
    let mut more = file.clone();
    more["functions"]["f"]["frequency"]["mode"] = json!(5);
    let text = fault(&more);
    assert!(
        text.contains("mode 5 is asked for, and there are 4"),
        "{text}"
    );
}

/// Seven equal pendulums beside each other have one frequency seven times.
#[test]
fn all_copies_of_a_frequency_are_found() {
    let (mut bodies, mut joints) = (serde_json::Map::new(), serde_json::Map::new());
    for k in 0..7 {
        let name = format!("l{k}");
        let place = json!({"put": "a", "at": [2 * k, 0, 0]});
        bodies.insert(name.clone(), rod(1.0, 2.0, place));
        let at = json!(format!("{name}.a"));
        joints.insert(format!("j{k}"), hinge([&name, "ground"], at));
    }
    let mut file = json!({
        "version": 1, "name": "row", "analysis": "rest", "bodies": bodies, "joints": joints,
        "functions": {"lowest": {"lowest_frequency": {"rho": 10}}, "last": {"frequency": {"mode": 7}}}
    });
    let found = values(&file);
    let expected = found[1] - 7.0_f64.ln() / 10.0;
    assert!((found[0] - expected).abs() < 1e-9, "{found:?} {expected}");
    file["functions"] = frequencies(8);
    let text = fault(&file);
    assert!(
        text.contains("mode 8 is asked for, and there are 7"),
        "{text}"
    );
}

/// What has no such frequencies.
#[test]
fn what_has_no_frequencies_is_told() {
    // A bar that stands upright.
    let upright = json!({"put": "a", "turn": {"axis": [0, 0, 1], "angle": PI / 2.0}});
    let bar = |place: Value| {
        json!({
            "version": 1, "name": "bar", "analysis": "rest",
            "bodies": {"bar": rod(1.0, 2.0, place)},
            "joints": {"pin": hinge(["bar", "ground"], json!([0, 0, 0]))},
            "functions": frequencies(1)
        })
    };
    let text = fault(&bar(upright));
    assert!(
        text.contains("not stable") && text.contains("/functions"),
        "{text}"
    );
    let mut many = bar(json!({"put": "a"}));
    many["functions"] = frequencies(2);
    let text = fault(&many);
    assert!(
        text.contains("mode 2 is asked for, and there are 1"),
        "{text}"
    );
    // Nothing moves.
    let mut fixed = bar(json!({"put": "a"}));
    fixed["joints"]["pin"] = json!({"weld": {"between": ["bar", "ground"], "at": "bar.a"}});
    fixed["functions"] = json!({"f": {"lowest_frequency": {"rho": 1}}});
    let text = fault(&fixed);
    assert!(
        text.contains("mode 1 is asked for, and there are 0"),
        "{text}"
    );
    let mut moving = bar(json!({"put": "a"}));
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

/// Two beams that are welded, bent by their weight; `damped` puts a hinge with a spring and a damper between them.
fn two_beams(damped: bool, functions: Value) -> Value {
    let beam = |length: f64,
                height: f64,
                young: f64,
                density: f64,
                modes: [u32; 3],
                degrees: f64,
                at: &str| {
        let place = match at {
            "" => json!([0, 0, 0]),
            at => json!(at),
        };
        json!({
            "beam": {
                "length": length, "section": {"rectangle": {"width": 0.02, "height": height}},
                "material": {"young": young, "poisson": 0.3, "density": density},
                "modes": {"bending_y": modes[0], "bending_z": modes[1], "torsion": modes[2]}
            },
            "place": {"put": "start", "at": place, "turn": {"axis": [0, 0, 1], "degrees": degrees}}
        })
    };
    let mut file = json!({
        "version": 1, "name": "two beams", "analysis": "rest",
        "bodies": {
            "b0": beam(0.455, 0.0105, 70e9, 2700.0, [4, 4, 0], -30.0, ""),
            "b1": beam(0.384, 0.0168, 200e9, 7800.0, [6, 0, 2], -70.0, "b0.end")
        },
        "joints": {
            "root": {"weld": {"between": ["b0", "ground"], "at": "b0.start"}},
            "middle": {"weld": {"between": ["b0", "b1"], "at": "b1.start"}}
        },
        "functions": functions,
        "variables": {
            "height": {"path": "/bodies/b0/beam/section/rectangle/height", "lower": 0.005, "upper": 0.02},
            "young": {"path": "/bodies/b1/beam/material/young", "lower": 100e9, "upper": 300e9},
            "length": {"path": "/bodies/b1/beam/length", "lower": 0.2, "upper": 0.6}
        }
    });
    if damped {
        file["joints"]["middle"] =
            json!({"revolute": {"between": ["b0", "b1"], "at": "b1.start", "axis": [0, 0, 1]}});
        file["loads"] = json!({"spring": {
            "torsion_spring": {"joint": "middle", "stiffness": 40, "damping": 0.05}
        }});
    }
    file
}

/// The modes of low and of high frequencies at once.
#[test]
fn derivatives_of_many_modes_are_exact() {
    let mut functions = json!({});
    for mode in 1..=18 {
        functions[format!("f{mode}")] =
            json!({"frequency": {"mode": mode, "follow": mode % 2 == 0}});
    }
    gradients_are_exact(
        &parsed(&two_beams(false, functions)),
        &json!("without damping"),
    );
    let mut functions = json!({});
    for mode in 1..=9 {
        functions[format!("f{mode}")] = json!({"frequency": {"mode": mode, "damped": true}});
    }
    gradients_are_exact(&parsed(&two_beams(true, functions)), &json!("damped"));
}

/// A small damping ratio is the small part of a rate: its derivatives are exact to round-off of that.
#[test]
fn derivatives_of_small_damping_ratios_are_exact() {
    let functions =
        json!({"z1": {"damping_ratio": {"mode": 1}}, "z5": {"damping_ratio": {"mode": 5}}});
    let problem = parsed(&two_beams(true, functions));
    let x = problem.start();
    for own in check(&problem, &x).expect("derivatives") {
        let off = (own.adjoint - own.complex_step).abs() * x[own.variable];
        assert!(off < 1e-13, "{own:?}");
    }
}

/// A plate of twice its width that is welded at an edge, of this length and thickness.
fn thin_plate([length, thickness]: [f64; 2], functions: Value) -> Value {
    json!({
        "version": 1, "name": "plate", "analysis": "rest", "gravity": [0, 0, 0],
        "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700}},
        "bodies": {"plate": {"elements": {
            "structure": {
                "mesh": {"plate": {"length": length, "width": 0.5 * length, "elements": [8, 4]}},
                "material": "aluminium", "thickness": thickness
            },
            "frame": {"clamped": "x0"}, "points": {"root": {"rigid": "x0"}}
        }}},
        "joints": {"wall": {"weld": {"between": ["plate", "ground"], "at": "plate.root"}}},
        "functions": functions,
        "variables": {
            "E": {"path": "/materials/aluminium/young", "lower": 1e10, "upper": 1e12},
            "rho": {"path": "/materials/aluminium/density", "lower": 1e2, "upper": 1e4},
            "h": {"path": "/bodies/plate/elements/structure/thickness", "lower": thickness / 2.0, "upper": thickness * 2.0}
        }
    })
}

/// A frequency is proportional to √(E / ρ) / L. A thin plate is much stiffer in shear than in bending, by up to 10⁸ here.
#[test]
fn thin_plates_have_exact_frequencies() {
    for part in [1e-2, 1e-3, 1e-4] {
        let mut of_a_metre = Vec::new();
        for length in [1.0, 1e-3] {
            let problem = parsed(&thin_plate([length, part * length], frequencies(2)));
            let x = problem.start();
            let at = Simulated::of(&problem, &x).expect("frequencies");
            let found: Vec<f64> = (0..2).map(|f| at.value(f) * length).collect();
            if of_a_metre.is_empty() {
                of_a_metre = found.clone();
            }
            assert_near(&found, &of_a_metre, 1e-9);
            for own in check(&problem, &x).expect("derivatives") {
                let [f, x] = [at.value(own.function), x[own.variable]];
                let off = (own.adjoint - own.complex_step) / own.complex_step;
                assert!(off.abs() < 1e-12, "{part} {length}: {own:?}");
                if own.variable < 2 {
                    let expected = [0.5, -0.5][own.variable] * f / x;
                    let off = own.adjoint / expected - 1.0;
                    assert!(off.abs() < 1e-12, "{part} {length}: {own:?} {off}");
                }
            }
        }
    }
}

/// Damping in proportion to mass and stiffness: 2 ζ ω = α + β ω².
#[test]
fn damped_thin_plates_have_their_ratios() {
    let functions = json!({"f": {"frequency": {"mode": 1}}, "z": {"damping_ratio": {"mode": 1}}});
    for part in [1e-2, 1e-3] {
        for k in 0..2 {
            let thickness = part * (1.0 + 0.013 * f64::from(k));
            let mut document = thin_plate([1.0, thickness], functions.clone());
            let (alpha, beta) = (200.0 * part, 1e-6 / part);
            document["bodies"]["plate"]["elements"]["structure"]["damping"] =
                json!({"mass": alpha, "stiffness": beta});
            let problem = parsed(&document);
            let x = problem.start();
            let at = Simulated::of(&problem, &x).expect("vibrations");
            let omega = 2.0 * PI * at.value(0);
            let expected = (alpha / omega + beta * omega) / 2.0;
            let off = at.value(1) / expected - 1.0;
            assert!(off.abs() < 1e-9, "{thickness}: {off}");
            if k > 0 {
                continue;
            }
            // ω ∂ζ/∂ω, and ω is proportional to √(E / ρ).
            let along = (beta * omega - alpha / omega) / 2.0;
            for own in check(&problem, &x).expect("derivatives") {
                let off = (own.adjoint - own.complex_step) / own.complex_step;
                assert!(off.abs() < 1e-12, "{thickness}: {own:?}");
                if own.function == 1 && own.variable < 2 {
                    let expected = [0.5, -0.5][own.variable] * along / x[own.variable];
                    let off = own.adjoint / expected - 1.0;
                    assert!(off.abs() < 1e-9, "{thickness}: {own:?} {off}");
                }
            }
        }
    }
}

/// A thin square plate that is clamped all around, with damping by the mass alone: ζ = α / 2 ω. Its second and third vibrations
/// are one pair, of which none is lost.
#[test]
fn no_vibration_of_a_thin_plate_is_lost() {
    for thickness in [1e-3, 1e-2] {
        let mut document = thin_plate([1.0, thickness], frequencies(4));
        let (mut points, mut joints) = (json!({}), json!({}));
        for edge in ["x0", "x1", "y0", "y1"] {
            points[edge] = json!({"rigid": edge});
            joints[edge] =
                json!({"weld": {"between": ["plate", "ground"], "at": format!("plate.{edge}")}});
        }
        let plate = &mut document["bodies"]["plate"]["elements"];
        plate["structure"]["mesh"]["plate"] = json!({"length": 1, "width": 1, "elements": [4, 4]});
        plate["structure"]["damping"] = json!({"mass": 1e3 * thickness, "stiffness": 0});
        plate["points"] = points;
        document["joints"] = joints;
        for mode in 1..=4 {
            document["functions"][format!("z{mode}")] = json!({"damping_ratio": {"mode": mode}});
        }
        let found = values(&document);
        assert!((found[1] / found[2] - 1.0).abs() < 1e-9, "{found:?}");
        for (f, zeta) in found[..4].iter().zip(&found[4..]) {
            let expected = 1e3 * thickness / (4.0 * PI * f);
            assert!(
                (zeta / expected - 1.0).abs() < 1e-6,
                "{thickness}: {found:?}"
            );
        }
    }
}

/// A force that turns with its body has no potential, and the stiffness is not symmetric.
#[test]
fn frequencies_under_a_following_force_are_those_with_damping() {
    for mode in [1, 4, 5, 7] {
        let function = |damped: bool| json!({"f": {"frequency": {"mode": mode, "damped": damped}}});
        let file = |functions: Value| {
            json!({
                "version": 1, "name": "plate", "analysis": "rest", "gravity": [0, 0, 0],
                "materials": {"m": {"young": 5e9, "poisson": 0.3, "density": 6200}},
                "bodies": {"b": {"elements": {
                    "structure": {
                        "mesh": {"plate": {"length": 0.7, "width": 0.2, "elements": [4, 2]}},
                        "material": "m", "thickness": 0.015
                    },
                    "frame": {"clamped": "x0"},
                    "points": {"start": {"edge": "x0"}, "end": {"edge": "x1"}}
                }}},
                "joints": {"j": {"weld": {"between": ["b", "ground"], "at": "b.start"}}},
                "loads": {"p": {"force": {
                    "body": "b", "point": "end", "direction": [0, 0, 1], "axes": "body", "magnitude": 17.1
                }}},
                "functions": functions
            })
        };
        let [plain, damped] = [false, true].map(|own| value(&file(function(own)), "f"));
        assert!(
            (plain - damped).abs() < 1e-9 * damped,
            "{mode}: {plain} {damped}"
        );
    }
}

/// A torque and a force that follows the body have a potential about a hinge, though not in space: 10 φ + 5 φ³ = m + 0.8 F.
#[test]
fn frequencies_under_loads_that_follow_have_exact_derivatives() {
    let document = json!({
        "version": 1, "name": "follower", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {"bar": {
            "shape": {"box": {"size": [0.3, 0.1, 0.1]}}, "mass": 1,
            "points": {"a": [-0.4, 0, 0], "e": [0.4, 0, 0]}, "place": {"put": "a", "at": [0, 0, 0]}
        }},
        "joints": {"hinge": hinge(["bar", "ground"], json!("bar.a"))},
        "loads": {
            "spring": {"torsion_spring": {"joint": "hinge", "stiffness": 10, "cubic": 5}},
            "torque": {"torque": {"body": "bar", "direction": [0, 0, 1], "magnitude": 3}},
            "force": {"force": {"body": "bar", "point": "e", "direction": [0, 1, 0], "magnitude": 3, "axes": "body"}}
        },
        "functions": {
            "f": {"frequency": {"mode": 1}},
            "damped": {"frequency": {"mode": 1, "damped": true}},
            "low": {"lowest_frequency": {"rho": 10}},
            "angle": {"final": {"angle": {"joint": "hinge"}}}
        },
        "variables": {"m": {"path": "/loads/torque/torque/magnitude", "lower": 0.1, "upper": 6}}
    });
    let problem = parsed(&document);
    let values = values(&document);
    let angle = values[3];
    let stiffness = 10.0 + 15.0 * angle * angle;
    let inertia = (0.3 * 0.3 + 0.1 * 0.1) / 12.0 + 0.16;
    let frequency = (stiffness / inertia).sqrt() / (2.0 * PI);
    assert_near(&values[..3], &[frequency; 3], 1e-12);
    let slope = frequency * 15.0 * angle / (stiffness * stiffness);
    for derivative in &check(&problem, &problem.start()).expect("derivatives")[..3] {
        assert_near(&[derivative.adjoint], &[slope], 1e-11);
    }
}

/// Two links about oblique axes without such loads and under weak and strong ones: derivatives are slopes.
#[test]
fn frequencies_of_spatial_machines_under_loads_that_follow() {
    for part in [0.0, 1.0, 4.0] {
        let mut document = json!({
            "version": 1, "name": "links", "analysis": "rest", "gravity": [1, -2, 0.5],
            "bodies": {
                "a": {"shape": {"box": {"size": [0.3, 0.2, 0.1]}}, "mass": 1, "points": {"e": [0.4, 0.1, 0]}, "place": {"at": [0.4, 0, 0]}},
                "b": {"shape": {"box": {"size": [0.2, 0.1, 0.3]}}, "mass": 2, "points": {"e": [0.1, 0.3, 0.2]}, "place": {"at": [1, 0.1, 0]}}
            },
            "joints": {
                "first": {"universal": {"between": ["a", "ground"], "at": [0, 0, 0], "axis": [0, 0.3, 1], "cross": [0, 1, -0.3]}},
                "second": {"revolute": {"between": ["b", "a"], "at": "a.e", "axis": [0.5, -1, 0.7]}}
            },
            "loads": {
                "b1": {"bushing": {"joint": "first", "stiffness": {"diagonal": [0, 0, 0, 30, 40, 50]}}},
                "s2": {"torsion_spring": {"joint": "second", "stiffness": 20}},
                "torque": {"torque": {"body": "b", "direction": [1, 0.4, -0.6], "magnitude": part}},
                "force": {"force": {"body": "b", "point": "e", "direction": [0.2, 1, 0.3], "magnitude": part, "axes": "body"}}
            },
            "functions": {"f1": {"frequency": {"mode": 1}}, "f2": {"frequency": {"mode": 2}}, "f3": {"frequency": {"mode": 3}}}
        });
        let mut paths = vec!["/bodies/b/mass", "/loads/s2/torsion_spring/stiffness"];
        if part > 0.0 {
            paths.extend([
                "/loads/torque/torque/magnitude",
                "/loads/force/force/magnitude",
            ]);
        }
        let paths: Vec<String> = paths.into_iter().map(str::to_owned).collect();
        vary(&mut document, &paths);
        gradients_are_slopes(&parsed(&document), 0.0, &document);
    }
}

/// A beam on a soft spring has the same frequencies at every size and place.
#[test]
fn soft_machines_have_the_same_frequencies_at_every_size_and_place() {
    let file = |l: f64, at: f64| {
        json!({
            "version": 1, "name": "beam", "analysis": "rest", "gravity": [0, 0, 0],
            "bodies": {"beam": {
                "beam": {
                    "length": l, "section": {"rectangle": {"width": 0.02 * l, "height": 0.016 * l}},
                    "material": {"young": 1e9, "density": 1000}, "strain": "linear"
                },
                "place": {"put": "start", "at": [at, 0, 0]}
            }},
            "joints": {"hinge": hinge(["beam", "ground"], json!("beam.start"))},
            "loads": {"spring": {"torsion_spring": {"joint": "hinge", "stiffness": 3e-4 * l.powi(3)}}},
            "functions": {"f1": {"frequency": {"mode": 1}}, "f2": {"frequency": {"mode": 2}}}
        })
    };
    let of_metre = values(&file(1.0, 0.0));
    let inertia = 1000.0 * 0.02 * 0.016 * (1.0 / 3.0 + 0.02 * 0.02 / 12.0);
    assert_near(
        &of_metre[..1],
        &[(3e-4_f64 / inertia).sqrt() / (2.0 * PI)],
        1e-3,
    );
    for (l, at) in [
        (1e3, 0.0),
        (1e-2, 0.0),
        (1e-4, 0.0),
        (1e-5, 0.0),
        (1e-3, 1.0),
        (1.0, 1e3),
        (1e-3, 1e3),
    ] {
        let found: Vec<f64> = values(&file(l, at)).into_iter().map(|f| f * l).collect();
        assert_near(&found, &of_metre, 1e-6);
    }
    let l = 1e-3;
    // With another one far away, whose spring is four times as stiff.
    let [mut both, mut far] = [0.0, 1e3].map(|at| file(l, at));
    both["bodies"]["far beam"] = far["bodies"]["beam"].take();
    both["joints"]["far hinge"] = hinge(["far beam", "ground"], json!("far beam.start"));
    both["loads"]["far spring"] = json!({
        "torsion_spring": {"joint": "far hinge", "stiffness": 4.0 * 3e-4 * l.powi(3)}
    });
    let found: Vec<f64> = values(&both).into_iter().map(|f| f * l).collect();
    assert_near(&found, &[of_metre[0], 2.0 * of_metre[0]], 1e-3);
}
