//! Mass properties from STL files: bodies of known integrals, both forms of the file, and surfaces that are refused.

use flexbody_driver::check;
use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_problem::Problem;
use std::f64::consts::PI;
use std::path::Path;

type Triangle = [Vec3<f64>; 3];

fn text_of(triangles: &[Triangle]) -> Vec<u8> {
    let facets = triangles.iter().map(|own| {
        let vertices = own
            .iter()
            .map(|v| format!("      vertex {:e} {:e} {:e}\n", v.x, v.y, v.z));
        let vertices: String = vertices.collect();
        format!("  facet normal 0 0 0\n    outer loop\n{vertices}    endloop\n  endfacet\n")
    });
    format!("solid own\n{}endsolid own\n", facets.collect::<String>()).into_bytes()
}

fn binary_of(triangles: &[Triangle]) -> Vec<u8> {
    // Some writers begin the header of a binary file like that of a text.
    let mut bytes = b"solid, but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for own in triangles {
        bytes.extend([0; 12]);
        for x in own.iter().flat_map(|v| v.iter()) {
            bytes.extend((*x as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// A box with a corner at the origin.
fn block(size: [f64; 3]) -> Vec<Triangle> {
    let corner =
        |k: usize| Vec3::from([0, 1, 2].map(|i| if k >> i & 1 == 1 { size[i] } else { 0.0 }));
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]].map(|own| own.map(corner));
    faces.into_iter().flat_map(halves).collect()
}

/// A sphere of triangles whose vertices lie on it: an octahedron, divided several times.
fn sphere(radius: f64, times: usize) -> Vec<Triangle> {
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    let mut all: Vec<Triangle> = Vec::new();
    for (a, b) in [(x, y), (y, -x), (-x, -y), (-y, x)] {
        all.extend([[a, b, z], [b, a, -z]]);
    }
    for _ in 0..times {
        let divided = |[a, b, c]: Triangle| {
            let [d, e, f] = [
                (a + b).normalize(),
                (b + c).normalize(),
                (c + a).normalize(),
            ];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        all = all.into_iter().flat_map(divided).collect();
    }
    all.into_iter().map(|own| own.map(|v| v * radius)).collect()
}

fn moved(triangles: &[Triangle], by: impl Fn(Vec3<f64>) -> Vec3<f64>) -> Vec<Triangle> {
    triangles.iter().map(|own| own.map(&by)).collect()
}

fn problem_text(properties: &str, rest: &str) -> String {
    format!(
        r#"{{"version": 1, "name": "hull",
  "bodies": {{"hull": {{"mass_properties": {{"stl": "hull.stl", {properties}}}}}}},
  "joints": {{"pin": {{"revolute": {{"between": ["hull", "ground"], "at": [0.5, -1, 0.3], "axis": [0, 0.2, 1]}}}}}},
  "simulation": {{"duration": 0.3}},
  "functions": {{"mass": "mass", "energy": {{"integral": {{"energy": "kinetic"}}}}}}{rest}}}"#
    )
}

fn load(folder: &Path, bytes: &[u8], text: &str) -> Result<Problem, String> {
    std::fs::write(folder.join("hull.stl"), bytes).expect("writes");
    let file = folder.join("hull.json");
    std::fs::write(&file, text).expect("writes");
    Problem::load(&file, &[]).map_err(|faults| faults.to_string())
}

/// Mass, centre and inertia about it.
fn properties(bytes: &[u8], unit: &str) -> (f64, Vec3<f64>, Mat3<f64>) {
    let folder = tempfile::tempdir().expect("a folder");
    let text = problem_text(&format!(r#""density": 2700, "unit": "{unit}""#), "");
    let own = load(folder.path(), bytes, &text).unwrap_or_else(|faults| panic!("{faults}"));
    let body = own.unlowered_scene::<f64>(&[]).model.bodies[0].clone();
    (body.mass, body.position, body.inertia)
}

fn of_block([a, b, c]: [f64; 3]) -> (f64, Vec3<f64>, Mat3<f64>) {
    let mass = 2700.0 * a * b * c;
    let inertia = Vec3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (mass / 12.0);
    (
        mass,
        Vec3::new(a, b, c) * 0.5,
        Mat3::from_diagonal(&inertia),
    )
}

#[track_caller]
fn same(own: &(f64, Vec3<f64>, Mat3<f64>), exact: &(f64, Vec3<f64>, Mat3<f64>), error: f64) {
    assert!(
        (own.0 / exact.0 - 1.0).abs() <= error,
        "{} {}",
        own.0,
        exact.0
    );
    let size = exact.1.norm().max((exact.2.norm() / exact.0).sqrt());
    assert!(
        (own.1 - exact.1).norm() <= error * size,
        "{} {}",
        own.1,
        exact.1
    );
    assert!(
        (own.2 - exact.2).norm() <= error * exact.2.norm(),
        "{} {}",
        own.2,
        exact.2
    );
}

/// A box in both forms, in several units, moved far away, turned, and seen from inside.
#[test]
fn a_box_has_the_integrals_of_a_box() {
    let size = [0.5, 0.25, 2.0];
    let (own, exact) = (block(size), of_block(size));
    same(&properties(&text_of(&own), "m"), &exact, 1e-14);
    same(&properties(&binary_of(&own), "m"), &exact, 1e-14);
    for (unit, metres) in [("mm", 1e-3), ("cm", 1e-2), ("inch", 0.0254)] {
        same(
            &properties(&text_of(&own), unit),
            &of_block(size.map(|x| x * metres)),
            1e-13,
        );
    }
    let by = Vec3::new(100.0, -50.0, 7.0);
    let far = properties(&text_of(&moved(&own, |v| v + by)), "m");
    same(&far, &(exact.0, exact.1 + by, exact.2), 1e-12);
    let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -0.7, 1.1).matrix();
    let turned = properties(&text_of(&moved(&own, |v| turn * v)), "m");
    same(
        &turned,
        &(exact.0, turn * exact.1, turn * exact.2 * turn.transpose()),
        1e-13,
    );
    let inside: Vec<Triangle> = own.iter().map(|&[a, b, c]| [a, c, b]).collect();
    same(&properties(&text_of(&inside), "m"), &exact, 1e-14);
    let folder = tempfile::tempdir().expect("a folder");
    let read = load(
        folder.path(),
        &text_of(&inside),
        &problem_text(r#""density": 2700"#, ""),
    )
    .expect("is read");
    let notes = read.notes_of_input();
    assert!(
        notes
            .iter()
            .any(|note| note.contains("ordered as seen from inside")),
        "{notes:?}"
    );
}

/// A tetrahedron at the axes: the integrals of x², y², z² are V a²/10, of x y V a b/20.
#[test]
fn a_tetrahedron_has_its_integrals() {
    let (a, b, c) = (1.0, 0.5, 0.8);
    let [o, x, y, z] = [
        Vec3::zeros(),
        Vec3::new(a, 0.0, 0.0),
        Vec3::new(0.0, b, 0.0),
        Vec3::new(0.0, 0.0, c),
    ];
    let own = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]];
    let mass = 2700.0 * a * b * c / 6.0;
    let centre = Vec3::new(a, b, c) / 4.0;
    let corner = Vec3::new(a, b, c);
    let about_origin =
        Mat3::from_fn(|i, j| corner[i] * corner[j] * if i == j { 2.0 } else { 1.0 } * mass / 20.0);
    let second = about_origin - centre * centre.transpose() * mass;
    let inertia = Mat3::from_diagonal_element(second.trace()) - second;
    same(
        &properties(&text_of(&own), "m"),
        &(mass, centre, inertia),
        1e-14,
    );
}

/// The error of a sphere of triangles falls with the square of their size.
#[test]
fn a_sphere_has_the_integrals_of_a_sphere_but_for_its_mesh() {
    let radius = 0.3;
    let mass = 2700.0 * 4.0 / 3.0 * PI * radius * radius * radius;
    let exact: (f64, Vec3<f64>, Mat3<f64>) = (
        mass,
        Vec3::zeros(),
        Mat3::from_diagonal_element(0.4 * mass * radius * radius),
    );
    let error = |times: usize| {
        let own = properties(&text_of(&sphere(radius, times)), "m");
        assert!(own.1.norm() < 1e-15 && own.0 < exact.0);
        let of_inertia = (own.2 - exact.2).norm() / exact.2.norm();
        (1.0 - own.0 / exact.0).max(of_inertia)
    };
    let (coarse, fine) = (error(4), error(5));
    assert!(
        fine < 3e-3 && (3.9..4.1).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}

/// The density is a design variable.
#[test]
fn derivatives_by_the_density_are_exact() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = r#", "variables": {"density": {"path": "/bodies/hull/mass_properties/density", "lower": 1, "upper": 9000}}"#;
    let text = problem_text(r#""density": 2700, "unit": "m""#, rest);
    let own = load(folder.path(), &binary_of(&block([0.5, 0.25, 2.0])), &text).expect("is read");
    assert_eq!(own.variables[0].unit, "kg/m³");
    let all = check(&own, &own.start()).expect("runs");
    assert!((all[0].complex_step - 0.25).abs() < 1e-15);
    for derivative in &all {
        assert!(derivative.relative_difference() <= 1e-11, "{derivative:?}");
    }
    // Another surface is another problem.
    let other = load(folder.path(), &binary_of(&block([0.5, 0.25, 1.0])), &text).expect("is read");
    assert_ne!(own.hash, other.hash);
}

/// Surfaces that are none of a solid, files that are none of surfaces, and keys beside them.
#[test]
fn what_is_no_solid_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let sound = block([1.0, 1.0, 1.0]);
    let text = problem_text(r#""density": 2700"#, "");
    let refused =
        |bytes: &[u8], text: &str| load(folder.path(), bytes, text).err().expect("a fault");
    let open = &sound[1..];
    let mut swapped = sound.clone();
    swapped[3].swap(0, 1);
    let mut endless = sound.clone();
    endless[5][1].y = f64::NAN;
    let flat = [
        [sound[0][0], sound[0][1], sound[0][2]],
        [sound[0][0], sound[0][2], sound[0][1]],
    ];
    let words = |own: &[Triangle], from: &str, to: &str| {
        let text = String::from_utf8(text_of(own)).expect("text");
        text.replacen(from, to, 1).into_bytes()
    };
    let mut short = binary_of(&sound);
    short.pop();
    for (bytes, expected) in [
        (text_of(open), "where the surface is open in "),
        (
            text_of(open),
            "found the edge from (0, 0, 0) to (1, 1, 0) of triangle 1",
        ),
        (text_of(&swapped), "in the same direction"),
        (
            text_of(&endless),
            "found a coordinate that is not finite, of triangle 6",
        ),
        (
            binary_of(&endless),
            "found a coordinate that is not finite, of triangle 6",
        ),
        (text_of(&[]), "found no triangle"),
        (binary_of(&[]), "found no triangle"),
        (text_of(&flat), "found a surface around a volume of 0e0 m³"),
        (Vec::new(), "found 0 bytes in "),
        (short, "bytes for 12 triangles in "),
        (
            words(&sound, "vertex", "vortex"),
            "found \"vortex 0e0 0e0 0e0\" on line 4",
        ),
        (
            words(&sound, "vertex 0e0", "vertex"),
            "expected \"vertex\" and three numbers",
        ),
        (
            words(&sound, "    endloop\n  endfacet\n", ""),
            "expected \"endfacet\" before another facet",
        ),
    ] {
        let faults = refused(&bytes, &text);
        assert!(faults.contains(expected), "{expected}:\n{faults}");
        assert!(faults.contains("hull.json:2:"), "{faults}");
        assert!(
            faults.contains("/bodies/hull/mass_properties/stl"),
            "{faults}"
        );
    }
    for (properties, expected) in [
        (
            r#""density": 0"#,
            "found 0, expected a number above 0 [kg/m³]",
        ),
        (r#""unit": "mm""#, "found no \"density\""),
        (
            r#""density": 1, "unit": "km""#,
            "found \"km\", expected one of \"m\", \"cm\", \"mm\", \"inch\"",
        ),
        (
            r#""density": 1}, "mass": 3, "points": {"#,
            "found \"mass\" beside \"mass_properties\", expected one of them",
        ),
    ] {
        let faults = refused(&binary_of(&sound), &problem_text(properties, ""));
        assert!(faults.contains(expected), "{expected}:\n{faults}");
    }
    std::fs::remove_file(folder.path().join("hull.stl")).expect("is there");
    let faults = Problem::load(&folder.path().join("hull.json"), &[])
        .expect_err("a fault")
        .to_string();
    assert!(
        faults.contains("found no \"density\"") || faults.contains("no file"),
        "{faults}"
    );
}
