//! Takes values and exact gradients at two designs, and checks them against the complex step:
//! `cargo run --release --example gradients`.

use flexbody::{Analysis, Problem, check};
use std::error::Error;

const SWING: &str = r#"{
    "version": 1, "name": "swing",
    "bodies": {"bar": {
        "shape": {"rod": {"length": 1}}, "mass": 2,
        "points": {"pin": [-0.4, 0, 0]}, "place": {"put": "pin", "at": [0, 0, 0]}
    }},
    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": "bar.pin", "axis": [0, 0, 1]}}},
    "simulation": {"duration": 0.4},
    "functions": {
        "swept angle": {"final": {"angle": {"joint": "hinge"}}},
        "top speed": {"ks": {"rho": 5, "of": {"speed": {"body": "bar"}}}}
    },
    "variables": {
        "pin": {"path": "/bodies/bar/points/pin/0", "lower": -0.5, "upper": -0.1},
        "mass": {"path": "/bodies/bar/mass", "lower": 1, "upper": 3}
    }
}"#;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let problem = Problem::parse(SWING, "swing.json", &[])?;
    let mut analysis = Analysis::new(&problem);
    for x in [problem.start(), vec![-0.3, 2.5]] {
        let design = analysis.at(&x)?;
        let (values, gradients) = (design.values(), design.gradients(&[0, 1])?);
        for ((name, value), gradient) in problem.functions().iter().zip(values).zip(gradients) {
            println!("{name} at {x:?}: {value:.6}, gradient {gradient:.6?}");
        }
    }
    for derivative in check(&problem, &problem.start())? {
        assert!(derivative.relative_difference() < 1e-11 || derivative.differs_by_round_off());
    }
    Ok(())
}
