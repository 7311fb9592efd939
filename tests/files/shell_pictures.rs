//! What is drawn and written of shells that move: colours and histories of stress, displacements of points, files for
//! ParaView; and the mass of a scene as a function.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use flexbody_driver::{check, simulate};
use flexbody_figures::elastic_figures::{deflections, limits, stresses};
use flexbody_figures::of_simulation;
use flexbody_figures::shell_fields;
use serde_json::Value;
use std::path::Path;

/// A short run of two soft plates, with a limit of stress.
fn short() -> Value {
    let mut document = plates([2, 1], 0.02, 8, &json!({"bdf": {"order": 2}}));
    document["materials"]["aluminium"]["young"] = json!(7e7);
    document["functions"]["last stress"] =
        json!({"final": {"von_mises": {"body": "first", "rho": 1e6}}});
    document["variables"] = json!({
        "thickness": {"path": "/bodies/first/elements/structure/thickness", "lower": 0.001, "upper": 0.1},
        "density": {"path": "/materials/aluminium/density", "lower": 2000, "upper": 3000},
    });
    document["functions"]["mass"] = json!("mass");
    document["objective"] = json!({"minimise": "mass"});
    document["constraints"] = json!({"strong": {"function": "stress 1", "upper": 0.5}});
    document
}

/// The history ends at the aggregate, which is above the largest stress by ln(points)/rho at most.
#[test]
fn histories_are_those_of_the_functions() {
    let problem = parsed(&short());
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let drawing = problem.drawing(&problem.start());
    let found = stresses("", (&motion.written.model, motion.motion()), &drawing);
    assert_eq!(found.curves.len(), 2);
    let value = |name: &str| {
        let names = &mut problem.function_names.iter();
        motion
            .at
            .function(names.position(|own| own == name).expect("a function"))
            .value
    };
    let last = *found.curves[0].1.last().expect("instants");
    let (aggregate, slack) = (2e8 * value("last stress"), 2e8 * 36_f64.ln() / 1e6);
    assert!(
        last > 0.0 && (last..=last + slack).contains(&aggregate),
        "{last} {aggregate}"
    );
    let limit = limits(&problem, &motion);
    assert_eq!(limit.len(), 1);
    assert_eq!(limit[0].of, ["first (\"strong\")"]);
    assert!((limit[0].value - 1e8).abs() < 1e-3);
    let bent = deflections("", &motion, &drawing);
    assert!(
        bent.curves
            .iter()
            .any(|(name, _)| name == "first: centre along z")
    );
    // The middle bends by the strain energy's measure: more than rounding, less than the thickness.
    let centre = bent
        .curves
        .iter()
        .find(|(name, _)| name == "second: centre along z");
    let peak = centre
        .expect("a curve")
        .1
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    assert!((1e-9..5e-3).contains(&peak), "{peak}");
}

#[test]
fn pictures_are_coloured() {
    let problem = parsed(&short());
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let pictures = of_simulation(&problem, &motion);
    let names: Vec<&str> = pictures.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        names,
        [
            "motion.svg",
            "energy.svg",
            "constraints.svg",
            "deflection.svg",
            "trace.svg",
            "stress.svg"
        ]
    );
    let lapse = std::str::from_utf8(&pictures[0].1).expect("text");
    // Two bodies of two elements in four parts at nine instants; the legend has more polygons.
    assert!(lapse.matches("<polygon").count() >= 2 * 2 * 4 * 9);
    assert!(lapse.contains("first, second: stress from"), "no scale");
}

/// The files have every node where the functions say it is, and the list names every file.
#[test]
fn shells_are_written_for_paraview() {
    let problem = parsed(&short());
    let motion = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let files = shell_fields::series(Path::new("out"), &problem, &motion);
    assert_eq!(files.len(), 9 + 1);
    let text = |k: usize| String::from_utf8(files[k].1.clone()).expect("text");
    let list = text(9);
    for (path, _) in &files[..9] {
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .expect("a name");
        assert!(list.contains(&format!("file=\"{name}\"")), "{name}");
    }
    let last = text(8);
    assert!(
        last.contains("NumberOfPoints=\"30\" NumberOfCells=\"4\""),
        "{}",
        &last[..300]
    );
    let points = last.split("Name=\"Points\"").nth(1).expect("points");
    let points: Vec<Vec<f64>> = (points.lines().skip(1).take(30))
        .map(|line| {
            line.split(' ')
                .map(|x| x.parse().expect("a number"))
                .collect()
        })
        .collect();
    let at = |name: &str| {
        let index = problem.function_names.iter().position(|own| own == name);
        motion.at.function(index.expect("a function")).value
    };
    // The middle node of the second plate is the eighth of its fifteen.
    for (axis, name) in ["centre 2 x", "centre 2 y"].iter().enumerate() {
        let found = points[15 + 7][axis];
        assert!((found - at(name)).abs() < 1e-12, "{name}: {found}");
    }
}

/// The mass of two plates of 1 x 0.25 m, and its derivatives.
#[test]
fn mass_of_a_motion() {
    let problem = parsed(&short());
    let (area, h, density) = (0.25, 0.005, 2700.0);
    let found = check(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let index = problem
        .function_names
        .iter()
        .position(|name| name == "mass");
    let of_mass: Vec<f64> = (found.iter().filter(|d| Some(d.function) == index))
        .map(|d| {
            assert!(d.relative_difference() < 1e-14);
            d.adjoint
        })
        .collect();
    let expected = [density * area, 2.0 * area * h];
    for (found, expected) in of_mass.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    assert_eq!(of_mass.len(), 2);
}
