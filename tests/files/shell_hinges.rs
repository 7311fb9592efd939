//! Torsion springs in hinges along the edges of shells: energy, the limit of rigid plates, derivatives.

use crate::reference::documents::plates;
use crate::reference::documents::{problem as parsed, value};
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use serde_json::Value;

/// Two plates with torsion springs in both hinges.
fn sprung(
    elements: [usize; 2],
    (duration, steps): (f64, usize),
    method: &Value,
    damping: f64,
) -> Value {
    let mut document = plates(elements, duration, steps, method);
    document["loads"] = json!({
        "root": {"torsion_spring": {"joint": "root", "stiffness": 300, "rest_angle": 0.2, "damping": damping}},
        "knee": {"torsion_spring": {"joint": "hinge", "stiffness": 200, "rest_angle": -0.4, "damping": damping}},
    });
    document["functions"]["torque"] = json!({"final": {"spring_torque": {"load": "knee"}}});
    document["functions"]["energy"] = json!({"final": {"energy": "total"}});
    document
}

/// Energy is kept, that of the springs included, but for vibrations that the steps do not resolve and damp; dampers
/// take some.
#[test]
fn springs_in_hinges_keep_energy() {
    let method = json!({"radau": {"stages": 3}});
    let energy = |steps: usize, damping: f64| {
        let mut document = sprung([2, 1], (0.1, steps), &method, damping);
        thick_and_soft(&mut document);
        value(&document, "energy")
    };
    let [coarse, fine, exact] = [20, 40, 160].map(|steps| energy(steps, 0.0));
    let (coarse, fine) = ((coarse - exact).abs(), (fine - exact).abs());
    assert!(
        coarse > 1.5 * fine && fine < 1e-3 * exact.abs(),
        "{coarse:e} {fine:e} {exact}"
    );
    assert!(energy(40, 3.0) < exact - 1.0);
}

/// Stiff plates swing on their springs as rigid ones: the difference falls as 1/E.
#[test]
fn stiff_plates_on_springs_are_rigid() {
    let tip = |young: f64, basis: &str| {
        let method = json!({"radau": {"stages": 3}});
        let mut document = sprung([1, 1], (0.2, 100), &method, 2.0);
        document["materials"]["aluminium"]["young"] = json!(young);
        for body in ["first", "second"] {
            let own = &mut document["bodies"][body]["elements"];
            own["basis"] = json!(basis);
            own["structure"]["damping"] = json!({"stiffness": 1e-3});
        }
        ["tip x", "tip y", "torque"].map(|name| value(&document, name))
    };
    let rigid = tip(7e10, "rigid");
    let off = |young: f64| {
        let found = tip(young, "full");
        let apart = found.iter().zip(&rigid);
        apart.fold(0.0_f64, |sum, (x, y)| sum.hypot((x - y) / y.abs().max(1.0)))
    };
    let (soft, stiff) = (off(7e11), off(7e12));
    assert!(
        stiff < 0.01 && (soft / stiff - 10.0).abs() < 2.0,
        "{soft:e} {stiff:e}"
    );
}

/// Derivatives by stiffness, rest angle and damping of a hinge, and by the plates beside it.
#[test]
fn derivatives_are_exact() {
    for method in [
        json!({"bdf": {"order": 2}}),
        json!({"radau": {"stages": 3}}),
    ] {
        let mut document = sprung([2, 1], (0.02, 6), &method, 2.0);
        thick_and_soft(&mut document);
        let own = |key: &str, lower: f64, upper: f64| json!({"path": format!("/loads/knee/torsion_spring/{key}"), "lower": lower, "upper": upper});
        document["variables"] = json!({
            "stiffness": own("stiffness", 100.0, 500.0),
            "rest": own("rest_angle", -1.0, 1.0),
            "damping": own("damping", 0.5, 5.0),
            "bands": {"path": "/bodies/second/elements/structure/thickness/value", "lower": 0.01, "upper": 0.1},
        });
        let problem = parsed(&document);
        scaled_gradients_are_exact(&problem, &problem.start(), &method);
    }
}
