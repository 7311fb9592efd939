//! Random changes of files with structures and flexible bodies.

use crate::reference::mutations::{Outcome, Random, mutated, sound, tried};
use flexbody_problem::Problem;

/// The files are sound before they are changed; then each change is refused with a text, fails with a text, or is
/// analysed. Nothing panics.
#[test]
fn changes_of_structures_are_refused_or_analysed() {
    let files = sound();
    for file in &files {
        assert_eq!(tried(file), Outcome::Analysed, "{}", file["name"]);
    }
    let mut random = Random(0x1234_5678_9ABC_DEF1);
    let mut counts = [0; 3];
    for k in 0..300 {
        let document = mutated(&files[k % files.len()], &mut random);
        counts[tried(&document) as usize] += 1;
    }
    assert!(counts[0] > 100 && counts[2] > 20, "{counts:?}");
}

/// A body of elements whose parts have faults, while a function looks into its mesh: the fault is told, and it alone.
#[test]
fn functions_of_faulty_elements_do_not_look_into_them() {
    let sound = r#"{"version": 1, "name": "bar", "materials": {"al": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
      "bodies": {"b": {"elements": {"structure": {"mesh": MESH, "material": "al", SIZE}, "frame": {"clamped": "EDGE"}, "points": {"a": {"node": "NODE"}}},
        "place": {"put": "a", "at": [0, 0, 1]}}},
      "joints": {"w": {"spherical": {"between": ["b", "ground"], "at": "b.a"}}},
      "simulation": {"duration": 0.02, "steps": 8, "method": {"bdf": {"order": 2}}},
      "functions": {"f": {"final": FUNCTION}}}"#;
    let fill = |parts: [&str; 5]| {
        let keys = ["MESH", "SIZE", "EDGE", "NODE", "FUNCTION"];
        let pairs = keys.into_iter().zip(parts);
        pairs.fold(sound.to_owned(), |text, (key, part)| {
            text.replace(key, part)
        })
    };
    let beam = |function: &str| {
        let mesh = r#"{"straight_beam": {"from": [0, 0, 0], "to": [0.6, 0, 0], "orientation": [0, 0, 1], "elements": 3}}"#;
        fill([
            mesh,
            r#""section": {"tube": {"radius": 0.01, "wall": 0.002}}"#,
            "start",
            "start",
            function,
        ])
    };
    let plate = |function: &str| {
        let mesh = r#"{"plate": {"length": 1, "width": 0.5, "elements": [2, 1]}}"#;
        fill([mesh, r#""thickness": 0.01"#, "x0", "x0y0", function])
    };
    let force =
        r#"{"section_force": {"body": "b", "beams": "all", "station": 0.5, "component": "axial"}}"#;
    let stress = r#"{"fibre_stress": {"body": "b", "station": 0.5, "fibre": [1, 1]}}"#;
    let largest = r#"{"largest_section_force": {"body": "b", "stations": 3, "component": "axial", "rho": 1}}"#;
    let ratio = r#"{"von_mises": {"body": "b", "rho": 30, "elements": "all"}}"#;
    let cases = [
        (
            beam(force),
            r#""poisson": 0.3"#,
            r#""poisson": 1.3"#,
            "/materials/al/poisson",
        ),
        (
            beam(stress),
            r#""young": 7e10"#,
            r#""young": -7e10"#,
            "/materials/al/young",
        ),
        (
            beam(largest),
            r#""density": 2700"#,
            r#""density": "heavy""#,
            "/materials/al/density",
        ),
        (beam(force), r#""poisson": 0.3, "#, "", "/materials/al"),
        (
            beam(largest),
            r#""radius": 0.01"#,
            r#""radius": 0"#,
            "/bodies/b",
        ),
        (
            beam(force),
            r#""elements": 3"#,
            r#""elements": 0"#,
            "/bodies/b",
        ),
        (
            plate(ratio),
            r#""poisson": 0.3"#,
            r#""poisson": 0.6"#,
            "/materials/al/poisson",
        ),
        (
            plate(ratio),
            r#""yield_stress": 2e8"#,
            r#""yield_stress": 0"#,
            "/materials/al/yield_stress",
        ),
        (
            plate(ratio),
            r#""elements": [2, 1]"#,
            r#""elements": [2]"#,
            "/bodies/b",
        ),
    ];
    for (text, right, wrong, path) in cases {
        if let Err(faults) = Problem::parse(&text, "bar.json", &[]) {
            panic!("{faults}");
        }
        assert_eq!(text.matches(right).count(), 1, "{right}");
        let found = Problem::parse(&text.replace(right, wrong), "bar.json", &[]);
        let faults = found.expect_err("a fault");
        assert_eq!(faults.list.len(), 1, "{wrong}: {faults}");
        assert!(faults.list[0].path.starts_with(path), "{wrong}: {faults}");
    }
}
