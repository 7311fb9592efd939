//! Errors of the steps in which contacts begin and let go.

use crate::reference::documents::problem as parsed;
use flexbody_driver::simulate;

/// A ball that meets a free box without losses keeps the energy, whatever part of the step is behind the place where the contact lets
/// go. An error that two formulas estimate by chance as nothing there was up to 1e5 tolerances.
#[test]
fn steps_that_leave_a_contact_keep_the_energy() {
    let surface = json!({"capsule": {"half": [0.2, 0.05, 0.1], "radius": 0.2}});
    let turn = json!({"axis": [3, -2, 1], "angle": 0.7});
    let mut document = json!({
        "version": 1, "name": "lets go",
        "bodies": {
            "ball": {"shape": {"box": {"size": [0.1, 0.15, 0.2]}}, "mass": 1.2,
                     "place": {"at": [0.09, 0.67, 0.12], "turn": turn},
                     "velocity": {"linear": [0.5, -1.9, -0.6], "angular": [1.1, 3.9, 0.2]}},
            "box": {"shape": {"box": {"size": [0.5, 0.3, 0.4]}}, "mass": 4,
                    "velocity": {"linear": [0, 0.3, 0], "angular": [-0.5, 1, 0.5]}}
        },
        "loads": {"contact": {"contact": {"between": ["ball", "box"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "radius": 0.09,
                                          "stiffness": 3e4, "exponent": 1.5, "width": 0.001, "dissipation": 0, "surface": surface}}},
        "simulation": {"duration": 0.4, "tolerance": 1e-9},
        "functions": {"depth": {"ks": {"rho": 1000, "of": {"penetration": {"load": "contact"}}}}}
    });
    let mut largest = 0.0_f64;
    for k in 0..40 {
        let tolerance = 1e-8 * 10.0_f64.powf(-0.08 * k as f64);
        document["simulation"]["tolerance"] = tolerance.into();
        let problem = parsed(&document);
        let motion = simulate(&problem, &problem.start()).expect("a motion");
        let seen = &motion.observations;
        let energy = |k: usize| seen[k].kinetic + seen[k].potential;
        assert!(motion.at.function(0).value > 0.01, "the ball touches");
        largest = largest.max((energy(seen.len() - 1) - energy(0)).abs() / tolerance);
    }
    assert!(largest < 1e3, "{largest}");
}
