//! Flexible scenes whose explicit steps stability bounds, and motions whose errors given steps do not tell.

use crate::reference::documents::problem;
use flexbody_driver::unfollowed::unfollowed;
use flexbody_driver::{Evaluated, simulate};
use serde_json::Value;

/// A soft beam that turns about its start on a hinge through the origin, from rest or with a rate.
fn beam(axis: [f64; 3], rate: f64, young: f64, simulation: &Value) -> Value {
    json!({
        "version": 1, "name": "beam", "gravity": [0, -9.81, 0],
        "bodies": {"b": {"beam": {
            "length": 1, "section": {"rectangle": {"width": 0.012, "height": 0.02}},
            "material": {"young": young, "poisson": 0.3, "density": 2700},
            "modes": {"bending_y": 3, "bending_z": 2, "torsion": 1}},
            "place": {"put": "start", "at": [0, 0, 0]}}},
        "joints": {"h": {"revolute": {"between": ["b", "ground"], "at": [0, 0, 0], "axis": axis,
            "start": {"turn": {"rate": rate}}}}},
        "simulation": simulation,
        "functions": {
            "y": {"final": {"position": {"body": "b", "point": "end", "direction": [0, 1, 0]}}},
            "U": {"final": {"strain_energy": {"body": "b"}}},
            "F": {"final": {"joint_force": {"joint": "h", "direction": [0, 1, 0]}}}
        }
    })
}

/// Free, hinged and oblique soft beams: where stability bounds explicit steps, vibrations that they feed may burst within
/// the tolerance, so the implicit method is taken, and energy is kept.
#[test]
fn soft_beams_are_stiff_where_stability_bounds_explicit_steps() {
    let z = [0.0, 0.0, 1.0];
    for (axis, rate, young) in [
        (z, 3.0, 5e7),
        (z, 0.0, 2e8),
        (z, -6.0, 1e8),
        ([0.36, 0.48, 0.8], 2.0, 5e7),
        ([1.0, 0.0, 0.0], 1.0, 1e8),
        ([0.6, 0.0, -0.8], 0.0, 2e8),
    ] {
        let problem = problem(&beam(axis, rate, young, &json!({"duration": 0.3})));
        let found = simulate(&problem, &[]).expect("runs");
        let what = format!(
            "{axis:?} {rate} {young}: {} {}",
            found.at.run.method.name(),
            found.reason
        );
        assert!(found.at.run.method.name().starts_with("radau"), "{what}");
        assert!(found.reason.contains("stiff"), "{what}");
        let exchanged =
            (found.observations.iter()).fold(0.0_f64, |most, own| most.max(own.kinetic));
        assert!(
            found.energy_drift() < 1e-3 * exchanged,
            "{what}: {}",
            found.energy_drift()
        );
    }
}

/// Errors by given steps are not known where these damp the vibrations that a sudden load excites: at any axis, by any
/// method. They are where steps follow them, and where there are none: in equilibrium, without a load, in rigid scenes.
#[test]
fn errors_of_vibrations_that_steps_do_not_follow_are_not_known() {
    let z = [0.0, 0.0, 1.0];
    let unknown = |file: &Value| {
        let problem = problem(file);
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        unfollowed(&problem, &at).is_some()
    };
    for (method, steps) in [
        (json!({"radau": {"stages": 3}}), 40),
        (json!({"radau": {"stages": 2}}), 30),
        (json!({"bdf": {"order": 1}}), 100),
        (json!({"bdf": {"order": 2}}), 50),
        (json!({"bdf": {"order": 3}}), 50),
        (json!({"generalised_alpha": {"radius": 0.5}}), 60),
    ] {
        let run = json!({"duration": 0.3, "steps": steps, "method": method});
        for axis in [z, [0.36, 0.48, 0.8]] {
            assert!(unknown(&beam(axis, 0.0, 7e10, &run)), "{run} {axis:?}");
        }
        let mut still = beam(z, 0.0, 7e10, &run);
        still["gravity"] = json!([0, 0, 0]);
        assert!(!unknown(&still), "{run}");
        let mut balanced = beam(z, 0.0, 7e10, &run);
        balanced["start"] = json!("equilibrium");
        balanced["gravity"] = json!([9.81, 0, 0]);
        assert!(!unknown(&balanced), "{run} in equilibrium");
    }
    let fine = json!({"duration": 0.001, "steps": 2000, "method": {"radau": {"stages": 3}}});
    assert!(!unknown(&beam(z, 0.0, 7e10, &fine)));
    let adaptive = json!({"duration": 0.01, "tolerance": 1e-6});
    assert!(!unknown(&beam(z, 0.0, 7e10, &adaptive)));
}

/// Vibrations that damping ends within a few steps leave errors known; those that it hardly damps do not.
#[test]
fn errors_are_known_where_damping_ends_vibrations() {
    for (method, steps, axis) in [
        (json!({"radau": {"stages": 3}}), 40, [0.0, 0.0, 1.0]),
        (json!({"radau": {"stages": 3}}), 36, [0.0, 0.6, 0.8]),
        (json!({"radau": {"stages": 2}}), 30, [0.0, 0.0, 1.0]),
        (json!({"radau": {"stages": 2}}), 40, [0.36, 0.48, 0.8]),
        (json!({"bdf": {"order": 2}}), 30, [0.0, 0.0, 1.0]),
        (
            json!({"generalised_alpha": {"radius": 0.5}}),
            60,
            [0.6, 0.0, 0.8],
        ),
    ] {
        let run = json!({"duration": 0.3, "steps": steps, "method": method});
        let known = [4e-3, 1e-7].map(|stiffness| {
            let mut file = beam(axis, 0.0, 7e10, &run);
            file["bodies"]["b"]["beam"]["damping"] = json!({"stiffness": stiffness});
            let problem = problem(&file);
            let at = Evaluated::new(&problem, &problem.start()).expect("runs");
            unfollowed(&problem, &at).is_none()
        });
        assert_eq!(known, [true, false], "{run} {axis:?}");
    }
}
