//! A stress for each thickness: its values, gradients, faults, and how fast a plate is sized by it.

use super::statics::{assert_gradients, solve, solved_at};
use crate::reference::documents::problem as parsed;
use flexbody_problem::Problem;
use serde_json::Value;

/// A quarter of a clamped plate under pressure with this thickness and these functions.
fn plate(thickness: &Value, functions: &Value) -> Value {
    json!({
        "version": 1, "name": "sized",
        "materials": {"aluminium": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 270e6}},
        "structures": {"plate": {
            "mesh": {"plate": {"length": 0.5, "width": 0.5, "elements": [8, 8]}},
            "material": "aluminium", "thickness": thickness,
            "sets": {
                "left": {"elements": {"from": [0, 0], "to": [0.5, 1]}},
                "right": {"elements": {"from": [0.5, 0], "to": [1, 1]}}
            },
            "supports": {
                "clamped": {"nodes": ["x0", "y0"]},
                "along y": {"nodes": ["x1"], "held": ["x", "ry", "rz"]},
                "along x": {"nodes": ["y1"], "held": ["y", "rx", "rz"]}
            }
        }},
        "load_cases": {"pressure": {"p": {"pressure": {"faces": "all", "pressure": 1e5}}}},
        "functions": functions,
        "variables": {"t": {"path": "/structures/plate/thickness/value", "lower": 0.002, "upper": 0.03}}
    })
}

fn stresses(per: bool) -> Value {
    let mut stress = json!({"rho": 100});
    if per {
        stress["per"] = json!("thickness");
    }
    json!({"mass": "mass", "stress": {"von_mises": stress}})
}

/// Element, band, patch and group: a stress of this name and number each, whose largest true value is that of all; and of
/// patches that are a set it is the stress of the set. All gradients are exact.
#[test]
fn every_thickness_has_its_stress() {
    let half = |set: &str| json!({"von_mises": {"rho": 100, "elements": set}});
    for (thickness, count) in [
        (json!({"per": "element", "value": 0.01}), 64),
        (json!({"per": "band", "value": 0.01}), 8),
        (
            json!({"per": "band", "along": "x", "bands": 2, "value": 0.012}),
            2,
        ),
        (
            json!({"per": "patch", "patches": [2, 4], "value": 0.009}),
            8,
        ),
        (json!({"per": "patch", "patches": [2, 1], "value": 0.01}), 2),
        (
            json!({"per": "group", "groups": ["left", "right"], "value": 0.011}),
            2,
        ),
    ] {
        let each = parsed(&plate(&thickness, &stresses(true)));
        assert_eq!(each.function_names.len(), count + 1, "{thickness}");
        assert_eq!(each.function_names[count], format!("stress[{}]", count - 1));
        let at = solved_at(&each, &each.start());
        let largest = (1..=count).filter_map(|f| at.smoothed(f));
        let largest = largest.map(|own| own.value).fold(0.0, f64::max);
        let mut functions = stresses(false);
        functions["left"] = half("left");
        functions["right"] = half("right");
        let whole = parsed(&plate(&thickness, &functions));
        let whole = solved_at(&whole, &whole.start());
        let exact = whole.smoothed(1).expect("an aggregate").value;
        assert!(
            (largest / exact - 1.0).abs() < 1e-12,
            "{thickness}: {largest} {exact}"
        );
        if count == 2 {
            for k in 0..2 {
                let [own, set] = [at.function(1 + k).value, whole.function(2 + k).value];
                assert!(
                    (own / set - 1.0).abs() < 1e-12,
                    "{thickness} {k}: {own} {set}"
                );
            }
            assert_gradients("stress per thickness", &each);
        }
    }
}

/// Where thickness alone is designed, all functions share the derivatives of the internal forces. A further variable
/// changes no derivative, whether the strains are linear or von Karman's, and whatever the function; the tangent of
/// von Karman's is factorised once for all functions.
#[test]
fn many_functions_share_their_derivatives() {
    let thickness = json!({"per": "patch", "patches": [2, 4], "value": 0.004});
    let mut functions = stresses(true);
    functions["energy"] = json!({"strain_energy": {"case": "pressure"}});
    functions["weight"] =
        json!({"reaction": {"nodes": "x0", "direction": [0, 0, 1], "case": "pressure"}});
    for strains in ["linear", "von_karman"] {
        let mut file = plate(&thickness, &functions);
        file["statics"] = json!({"strains": strains});
        file["load_cases"]["pressure"]["weight"] =
            json!({"gravity": {"acceleration": [0, 0, -900]}});
        let alone = parsed(&file);
        file["variables"]["modulus"] =
            json!({"path": "/materials/aluminium/young", "lower": 6e10, "upper": 8e10});
        let beside = parsed(&file);
        let all: Vec<usize> = (0..alone.function_names.len()).collect();
        let gradients = |problem: &Problem| {
            let found = solved_at(problem, &problem.start());
            found.derivatives(problem, &all).expect("derivatives")
        };
        let ((own, counts), (other, _)) = (gradients(&alone), gradients(&beside));
        // Nothing is solved for the mass.
        assert_eq!(counts.solves, all.len() - 1, "{strains}");
        let factorisations = usize::from(strains == "von_karman");
        assert_eq!(counts.factorisations, factorisations, "{strains}");
        for (f, (own, other)) in own.iter().zip(&other).enumerate() {
            let size = own.iter().fold(0.0f64, |m, d| m.max(d.value.abs()));
            for (a, b) in own.iter().zip(other) {
                let difference = (a.value - b.value).abs();
                assert!(
                    difference <= 1e-12 * size,
                    "{strains} {f}: {} {}",
                    a.value,
                    b.value
                );
            }
        }
        assert_gradients(strains, &alone);
    }
}

/// A thickness, a change of the file, and the place and some words of its fault.
type Case<'a> = (&'a Value, &'a dyn Fn(&mut Value), &'a str, &'a str);

/// What does not go with it, by place and message.
#[test]
fn faults_name_the_place() {
    let patches = json!({"per": "patch", "patches": [2, 2], "value": 0.01});
    let with = |thickness: &Value, change: &dyn Fn(&mut Value)| {
        let mut file = plate(thickness, &stresses(true));
        change(&mut file);
        Problem::parse(&file.to_string(), "scene.json", &[])
            .map(|_| ())
            .expect_err("a fault")
            .to_string()
    };
    let variable = |file: &mut Value| file["variables"] = json!({});
    let cases: [Case<'_>; 6] = [
        (
            &json!(0.01),
            &variable,
            "/functions/stress/von_mises/per",
            "structures of one thickness each",
        ),
        (
            &patches,
            &|file| file["functions"]["stress"]["von_mises"]["elements"] = json!("left"),
            "/functions/stress/von_mises/per",
            "\"per\" or \"elements\"",
        ),
        (
            &patches,
            &|file| file["objective"] = json!({"minimise": "stress"}),
            "/objective/minimise",
            "one value",
        ),
        (
            &patches,
            &|file| file["functions"]["stress[2]"] = json!("mass"),
            "/functions/stress[2]",
            "another name",
        ),
        (
            &patches,
            &|file| {
                file["constraints"] = json!({
                "c": {"function": "stress", "upper": 1}, "c[0]": {"function": "mass", "upper": 9}});
            },
            "/constraints/c[0]",
            "another name",
        ),
        (
            &patches,
            &|file| file["functions"]["stress"]["von_mises"]["per"] = json!("thicknes"),
            "/functions/stress/von_mises/per",
            "thickness",
        ),
    ];
    for (thickness, change, place, words) in cases {
        let text = with(thickness, change);
        assert!(
            text.contains(place) && text.contains(words),
            "{place} {words}: {text}"
        );
    }
}

/// A quarter of a plate in 4 × 4 patches: with a limit for each patch at most 60 simulations lead to an optimum, where one
/// limit for all takes more than twice as many, and the plate weighs at most 2 % more.
#[test]
fn patches_are_sized_in_few_simulations() {
    let sized = |per: bool, start: f64| {
        let thickness = json!({"per": "patch", "patches": [4, 4], "value": start});
        let mut file = plate(&thickness, &stresses(per));
        file["objective"] = json!({"minimise": "mass"});
        file["constraints"] = json!({"yield": {"function": "stress", "upper": 1}});
        let optimum = solve(&parsed(&file)).optimum;
        println!(
            "{per} {start}: {} {} {}",
            optimum.status, optimum.objective.value, optimum.counts.function_evaluations
        );
        assert_eq!(optimum.status, "converged");
        (optimum.objective.value, optimum.counts.function_evaluations)
    };
    let [each, one] = [(true, 0.025), (false, 0.025)].map(|(per, start)| sized(per, start));
    assert!(each.1 <= 60 && 2 * each.1 < one.1, "{each:?} {one:?}");
    assert!(each.0 < 1.02 * one.0, "{each:?} {one:?}");
}
