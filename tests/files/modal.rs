//! Bodies from files of other codes: the beam of tests/data/modal (20 cubic elements, written by another program)
//! against the beam of the problem format, similar bodies, free motions, derivatives, and faults of files.

use crate::reference::documents::{problem as parsed, values};
use crate::reference::gradients::gradients_are_exact;
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::Path;

pub(super) const YOUNG: f64 = 70e9;
const DENSITY: f64 = 2700.0;
/// Width (z), height (y), G J.
const SECTION: (f64, f64, f64) = (0.03, 0.02, 807.692_307_692_307_7);

pub(super) fn data(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/modal");
    path.join(file).display().to_string()
}

fn matrices() -> Value {
    json!({"matrix_market": {"nodes": data("beam.nodes"), "stiffness": data("beam_k.mtx"),
                             "mass": data("beam_m.mtx")}})
}

/// The beam of the files.
pub(super) fn modal(frame: Value) -> Value {
    json!({"source": matrices(), "interfaces": {"start": 1, "middle": 12, "end": 21}, "frame": frame, "modes": 8})
}

/// The same beam by assumed modes.
pub(super) fn beam(frame: &str, young: f64) -> Value {
    let (width, height, gj) = SECTION;
    let area = width * height;
    json!({
        "length": 1, "frame": frame, "strain": "linear", "stations": {"middle": 0.55},
        "section": {"given": {
            "ea": young * area, "ei_y": young * width * height.powi(3) / 12.0,
            "ei_z": young * height * width.powi(3) / 12.0, "gj": gj * young / YOUNG,
            "mass_per_length": DENSITY * area,
            "inertia_y": DENSITY * height * width.powi(3) / 12.0,
            "inertia_z": DENSITY * width * height.powi(3) / 12.0}},
        "modes": {"bending_y": 5, "bending_z": 5, "torsion": 3, "stretch": 3}
    })
}

/// A pendulum in space: the beam turns about an axis that is not its own, with a weight beside its end.
pub(super) fn pendulum(key: &str, body: Value) -> Value {
    json!({
        "version": 1, "name": "pendulum",
        "bodies": {
            "arm": {key: body, "place": {"put": "start", "at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": 0.2}}},
            "weight": {"shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "mass": 0.4,
                       "place": {"at": "arm.end", "turn": {"axis": [0, 0, 1], "angle": 0.2}}}
        },
        "joints": {
            "root": {"revolute": {"between": ["arm", "ground"], "at": "arm.start", "axis": [0.1, 0.2, 1]}},
            "end": {"weld": {"between": ["weight", "arm"], "at": "arm.end"}}
        },
        "loads": {"push": {"force": {"body": "arm", "point": "middle", "direction": [0, 0, 1], "magnitude": 5}}},
        "simulation": {"duration": 0.2, "tolerance": 1e-6, "method": {"radau": {"stages": 3}}},
        "functions": {
            "end": {"final": {"position": {"body": "arm", "point": "end", "direction": [0, 1, 0]}}},
            "bend": {"final": {"elastic_displacement": {"body": "arm", "point": "end", "direction": [0, 1, 0]}}},
            "side": {"final": {"elastic_displacement": {"body": "arm", "point": "middle", "direction": [0, 0, 1]}}},
            "energy": {"integral": {"strain_energy": {"body": "arm"}}},
            "all": {"final": {"energy": "total"}}
        }
    })
}

/// With a tenth of the stiffness the arm bends by centimetres; the files and the beam say the same, of
/// displacements as part of the largest.
#[test]
fn a_beam_of_files_moves_as_the_beam_of_the_format() {
    for (frame, own) in [
        (json!({"clamped": "start"}), "clamped"),
        (json!({"chord": ["start", "end"]}), "chord"),
    ] {
        let reference = values(&pendulum("beam", beam(own, YOUNG / 10.0)));
        let mut files = modal(frame);
        files["young_factor"] = json!(0.1);
        let found = values(&pendulum("modal", files));
        println!("{own}: {found:?}\n{reference:?}");
        let largest = reference[1].abs().max(reference[2].abs());
        assert!(largest > 1e-4, "{largest}");
        for k in [1, 2] {
            let off = (found[k] - reference[k]).abs();
            assert!(off < 0.02 * largest, "{off:e} of {largest:e}");
        }
        assert!((found[0] - reference[0]).abs() < 2e-4);
        assert!((found[3] / reference[3] - 1.0).abs() < 0.01);
    }
}

/// A free beam that spins and vibrates between two boxes; all is `scale` times as large and `density` times as
/// dense.
fn free(frame: Value, (velocity, spin): ([f64; 3], [f64; 3]), [scale, density]: [f64; 2]) -> Value {
    let mut body = modal(frame);
    body["modes"] = json!(2);
    body["interfaces"] = json!({"start": 1, "end": 21});
    body["young_factor"] = json!(0.01);
    body["scale"] = json!(scale);
    body["density_factor"] = json!(density);
    let weight = |at: &str| {
        let size = [0.1, 0.2, 0.3].map(|x| x * scale);
        json!({"shape": {"box": {"size": size}}, "mass": 0.4 * density * scale.powi(3),
               "place": {"at": format!("arm.{at}"), "turn": {"axis": [1, 2, 0], "angle": 0.4}}})
    };
    let weld = |body: &str, at: &str| json!({"weld": {"between": [body, "arm"], "at": format!("arm.{at}")}});
    json!({
        "version": 1, "name": "free", "gravity": [0, 0, 0],
        "initial_velocity": {"linear": velocity, "angular": spin},
        "bodies": {"arm": {"modal": body}, "first": weight("start"), "last": weight("end")},
        "joints": {"start": weld("first", "start"), "end": weld("last", "end")},
        "simulation": {"duration": 0.1, "steps": 150, "method": {"radau": {"stages": 3}}},
        "functions": {
            "bend": {"final": {"elastic_displacement": {"body": "arm", "point": "end", "direction": [1, 2, 3]}}},
            "energy": {"integral": {"strain_energy": {"body": "arm"}}},
            "momentum": {"final": {"momentum": {"direction": [1, 0, 0]}}}
        }
    })
}

/// 10 m/s more change nothing of the vibration, and momentum stays.
#[test]
fn a_velocity_of_the_whole_changes_no_vibration() {
    for frame in [
        json!({"clamped": "start"}),
        json!({"chord": ["start", "end"]}),
    ] {
        let pair = [[0.0, 0.0, 0.0], [10.0, -4.0, 2.0]]
            .map(|v| free(frame.clone(), (v, [1.0, 2.0, 3.0]), [1.0, 1.0]));
        let [rest, moved] = [values(&pair[0]), values(&pair[1])];
        println!("{rest:?} {moved:?}");
        assert!(rest[0].abs() > 1e-6, "{rest:?}");
        assert!((rest[0] - moved[0]).abs() < 1e-11, "{rest:?} {moved:?}");
        assert!((rest[1] / moved[1] - 1.0).abs() < 1e-8);
        let mut early = pair[1].clone();
        early["simulation"]["duration"] = json!(0.04);
        early["simulation"]["steps"] = json!(60);
        assert!((values(&early)[2] / moved[2] - 1.0).abs() < 1e-9);
    }
}

/// A similar body of another size, stiffness and density: scale s makes times longer by s √(ρ/E) and lengths
/// by s, without gravity.
#[test]
fn similar_bodies_move_alike() {
    let (scale, young, density) = (1.7_f64, 0.6_f64, 1.3_f64);
    let slower = scale * (density / young).sqrt();
    let spin = [1.0, 2.0, 3.0];
    let clamped = || json!({"clamped": "start"});
    let base = free(clamped(), ([0.0; 3], spin), [1.0, 1.0]);
    let spin = spin.map(|w| w / slower);
    let mut similar = free(clamped(), ([0.0; 3], spin), [scale, density]);
    similar["bodies"]["arm"]["modal"]["young_factor"] = json!(0.01 * young);
    similar["simulation"]["duration"] = json!(0.1 * slower);
    let [base, similar] = [values(&base), values(&similar)];
    println!("{base:?} {similar:?}");
    assert!(
        (similar[0] / base[0] / scale - 1.0).abs() < 1e-6,
        "{base:?} {similar:?}"
    );
}

/// The same matrices as DMIG text give the same motion. Small fields have too few digits for a beam: its bending
/// is what remains where entries cancel.
#[test]
fn punched_matrices_are_the_same_body() {
    let directory = tempfile::tempdir().expect("a directory");
    let expected = values(&pendulum("modal", modal(json!({"clamped": "start"}))));
    for large in [true, false] {
        let path = directory.path().join(format!("{large}.pch"));
        std::fs::write(&path, punched(large)).expect("written");
        let mut body = modal(json!({"clamped": "start"}));
        body["source"] = json!({"dmig": {"nodes": data("beam.nodes"), "file": path, "stiffness": "K1", "mass": "m1"}});
        let document = pendulum("modal", body);
        if !large {
            let faults = Problem::parse(&document.to_string(), "modal", &[]).expect_err("rounded");
            let told = faults.to_string();
            assert!(told.contains("numbers of so few digits"), "{told}");
            assert!(told.contains("numbers with more digits"), "{told}");
            continue;
        }
        let found = values(&document);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() <= 1e-6 * b.abs(), "{found:?} {expected:?}");
        }
    }
}

/// Three masses joined by springs, as a general matrix of three components a node, and in small fields with
/// two entries on a line: the same motion, which in its first frequency is that of the eigenvalues by hand.
#[test]
fn small_fields_and_general_matrices_are_the_same_body() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = |name: &str| directory.path().join(name);
    let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mut stiffness = [[0.0_f64; 9]; 9];
    for (a, b, k) in [(0, 1, 100.0), (0, 2, 100.0), (1, 2, 200.0)] {
        let [x, y] = [0, 1].map(|i| places[b][i] - places[a][i]);
        let square = x * x + y * y;
        for (i, d) in [x, y].into_iter().enumerate() {
            for (j, e) in [x, y].into_iter().enumerate() {
                let value = k * d * e / square;
                for (p, q, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    stiffness[3 * p + i][3 * q + j] += sign * value;
                }
            }
        }
    }
    let mut mass = [[0.0; 9]; 9];
    for (k, row) in mass.iter_mut().enumerate() {
        row[k] = 2.0;
    }
    let mut small = String::new();
    for (name, file, matrix) in [("KAAX", "k.mtx", &stiffness), ("MAAX", "m.mtx", &mass)] {
        let mut general = String::new();
        let mut count = 0;
        small += &format!("DMIG    {name:<8}{:>8}{:>8}{:>8}\n", 0, 6, 1);
        for (i, row) in matrix.iter().enumerate() {
            let there: Vec<usize> = (0..9).filter(|&j| row[j] != 0.0).collect();
            for &j in &there {
                general += &format!("{} {} {}\n", i + 1, j + 1, row[j]);
                count += 1;
            }
            // Row i above the diagonal is column i below it.
            let below: Vec<String> = (there.iter().filter(|&&j| j >= i))
                .map(|&j| {
                    format!(
                        "{:>8}{:>8}{:>8}{:>8}",
                        j / 3 + 1,
                        j % 3 + 1,
                        format!("{:.3}", row[j]),
                        ""
                    )
                })
                .collect();
            let Some((first, rest)) = below.split_first() else {
                continue;
            };
            small += &format!(
                "DMIG    {name:<8}{:>8}{:>8}{:>8}{first}\n",
                i / 3 + 1,
                i % 3 + 1,
                ""
            );
            for pair in rest.chunks(2) {
                small += &format!("+       {}\n", pair.concat());
            }
        }
        let text = format!("%%MatrixMarket matrix coordinate real general\n9 9 {count}\n{general}");
        std::fs::write(path(file), text).expect("written");
    }
    std::fs::write(path("all.pch"), small).expect("written");
    let nodes = "1, 0, 0, 0\n2, 1, 0, 0\n\n3, 0, 1.0D0, 0\n";
    std::fs::write(path("nodes"), nodes).expect("written");
    let sources = [
        json!({"matrix_market": {"nodes": path("nodes"), "stiffness": path("k.mtx"), "mass": path("m.mtx")}}),
        json!({"dmig": {"nodes": path("nodes"), "file": path("all.pch")}}),
    ];
    let mut told = Vec::new();
    for source in sources {
        let document = json!({
            "version": 1, "name": "triangle", "gravity": [0, 0, 0],
            "bodies": {"triangle": {"modal": {
                "source": source, "interfaces": {"a": 1, "b": 2, "c": 3}, "frame": {"chord": ["a", "b", "c"]},
                "start": {"coordinates": [0.01, 0, 0.02]}}}},
            "simulation": {"duration": 0.2, "steps": 100, "method": {"radau": {"stages": 3}}},
            "functions": {"bend": {"final": {"elastic_displacement":
                {"body": "triangle", "point": "c", "direction": [1, 2, 0]}}}}
        });
        let words = parsed(&document).flexible_bodies(&[]).concat();
        assert!(words.contains("3 boundary modes"), "{words}");
        told.push((values(&document)[0], words));
    }
    assert!((told[0].0 / told[1].0 - 1.0).abs() < 1e-10, "{told:?}");
    assert_eq!(told[0].1, told[1].1);
    // Free vibrations by hand: trace K/m = Σ ω² of the three modes.
    let trace: f64 = (0..9).map(|k| stiffness[k][k] / 2.0).sum();
    let free = told[0].1.split("free ").nth(1).expect("free frequencies");
    let free = free.split(" Hz").next().expect("a list");
    let sum: f64 = (free.split(", "))
        .map(|f| f.parse::<f64>().expect("a number") * std::f64::consts::TAU)
        .map(|w| w * w)
        .sum();
    assert!((sum / trace - 1.0).abs() < 1e-3, "{sum} {trace}");
}

/// The files of Matrix Market as DMIG text, with Fortran's exponents.
pub(super) fn punched(large: bool) -> String {
    let mut text = String::from("$ a beam\n");
    for (name, file) in [("K1", "beam_k.mtx"), ("M1", "beam_m.mtx")] {
        let written = std::fs::read_to_string(data(file)).expect("a matrix");
        text += &format!("DMIG    {name:<8}{:>8}{:>8}{:>8}\n", 0, 6, 2);
        let rows = written.lines().skip(3);
        for line in rows {
            let parts: Vec<&str> = line.split(' ').collect();
            let place = |k: usize| {
                let n: usize = parts[k].parse().expect("a number");
                ((n - 1) / 6 + 1, (n - 1) % 6 + 1)
            };
            let (row, column) = (place(0), place(1));
            let value: f64 = parts[2].parse().expect("a number");
            let (digits, width) = if large { (9, 16) } else { (2, 8) };
            let number = format!("{value:.digits$e}");
            let (mantissa, exponent) = number.split_once('e').expect("an exponent");
            let exponent: i32 = exponent.parse().expect("a number");
            // Large: 1.5D+03, small: 1.5+3.
            let number = match large {
                true => format!("{mantissa}D{exponent:+}"),
                false => format!("{mantissa}{exponent:+}"),
            };
            if large {
                text += &format!("DMIG*   {name:<16}{:>16}{:>16}\n", column.0, column.1);
                text += &format!("*       {:>16}{:>16}{number:>width$}\n", row.0, row.1);
            } else {
                text += &format!(
                    "DMIG    {name:<8}{:>8}{:>8}{:>8}{:>8}{:>8}{number:>width$}\n",
                    column.0, column.1, "", row.0, row.1
                );
            }
        }
    }
    text + "ENDDATA\n"
}

/// Millimetres, tonnes and seconds; the rotations of the files are none of length.
#[test]
fn units_of_files_are_converted() {
    let directory = tempfile::tempdir().expect("a directory");
    let read = |file: &str| std::fs::read_to_string(data(file)).expect("a file");
    let nodes: String = (read("beam.nodes").lines().skip(1))
        .map(|line| {
            let x: Vec<f64> = line
                .split(' ')
                .map(|x| x.parse().expect("a number"))
                .collect();
            format!("{} {} {} {}\n", x[0], 1e3 * x[1], 1e3 * x[2], 1e3 * x[3])
        })
        .collect();
    let scaled = |file: &str, unit: f64| {
        let text = read(file);
        let mut lines = text.lines();
        let head: Vec<&str> = lines.by_ref().take(3).collect();
        let mut out = head.join("\n") + "\n";
        for line in lines {
            let parts: Vec<&str> = line.split(' ').collect();
            let turns = |k: usize| {
                let n: usize = parts[k].parse().expect("a number");
                i32::from((n - 1) % 6 >= 3)
            };
            let value: f64 = parts[2].parse().expect("a number");
            let value = value / unit * 1e3_f64.powi(turns(0) + turns(1));
            out += &format!("{} {} {value:e}\n", parts[0], parts[1]);
        }
        out
    };
    // N/mm = t/s².
    let files = [
        ("beam.nodes", nodes),
        ("k.mtx", scaled("beam_k.mtx", 1e3)),
        ("m.mtx", scaled("beam_m.mtx", 1e3)),
    ];
    for (name, text) in files {
        std::fs::write(directory.path().join(name), text).expect("written");
    }
    let path = |name: &str| directory.path().join(name);
    let mut body = modal(json!({"chord": ["start", "end"]}));
    let expected = values(&pendulum("modal", body.clone()));
    body["source"] = json!({"matrix_market": {"nodes": path("beam.nodes"), "stiffness": path("k.mtx"),
        "mass": path("m.mtx"), "units": {"length": 1e-3, "mass": 1e3}}});
    let found = values(&pendulum("modal", body));
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() <= 1e-6 * b.abs(), "{found:?} {expected:?}");
    }
}

/// Derivatives by every number of the body against the complex step.
#[test]
fn every_number_of_a_body_of_files_has_an_exact_derivative() {
    let methods = [
        json!({"duration": 0.1, "steps": 60, "method": {"radau": {"stages": 3}}}),
        json!({"duration": 0.1, "steps": 150, "method": {"bdf": {"order": 2}}}),
        json!({"duration": 0.1, "tolerance": 1e-6, "method": "dop853"}),
    ];
    let frames = [
        json!({"clamped": "start"}),
        json!({"chord": ["start", "end"]}),
        json!({"clamped": "start"}),
    ];
    for (simulation, frame) in methods.into_iter().zip(frames) {
        let chord = frame["chord"].is_array();
        let mut body = modal(frame);
        body["modes"] = json!(2);
        body["young_factor"] = json!(0.02);
        body["density_factor"] = json!(1.2);
        body["scale"] = json!(0.9);
        body["damping"] = json!({"ratio": 0.02, "mass": 0.3, "stiffness": 1e-5});
        // A chord runs through both ends, so that the end has no displacement but its stretch, 1e-5 of what
        // bends: round-off of the rest is more than 1e-12 of it. The middle bends.
        let (bends, interfaces) = match chord {
            true => ("middle", json!({"start": 1, "middle": 12, "end": 21})),
            false => ("end", json!({"start": 1, "end": 21})),
        };
        body["interfaces"] = interfaces;
        let mut document = pendulum("modal", body);
        document["loads"]["push"]["force"]["point"] = json!(bends);
        document["functions"]["bend"] = json!({"integral": {"elastic_displacement":
            {"body": "arm", "point": bends, "direction": [1, 1, 1]}}});
        let functions = document["functions"].as_object_mut().expect("functions");
        functions.shift_remove("side");
        document["simulation"] = simulation.clone();
        let mut variables = serde_json::Map::new();
        let damping = ["damping/ratio", "damping/mass", "damping/stiffness"];
        for number in ["young_factor", "density_factor", "scale"]
            .iter()
            .chain(&damping)
        {
            let path = format!("/bodies/arm/modal/{number}");
            variables.insert((*number).into(), json!({"path": path, "lower": 1e-9}));
        }
        variables.insert(
            "weight".into(),
            json!({"path": "/bodies/weight/mass", "lower": 0.1}),
        );
        document["variables"] = Value::Object(variables);
        let problem = parsed(&document);
        assert_eq!(problem.variables.len(), 7);
        gradients_are_exact(&problem, &simulation);
    }
}

/// Standard input data of a rod of two masses on a spring, against its closed form: ω² = k (1/m1 + 1/m2).
#[test]
fn standard_input_data_move_as_they_say() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("rod.json");
    // The frame is on the first mass; the mode moves the second along x.
    let (m1, m2, k) = (2.0, 3.0, 500.0);
    let zero = [[0.0; 3]; 3];
    let square = |x: f64| [[x, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    let good = json!({
        "version": 1, "mass": m1 + m2, "centre_of_mass": [m2 / (m1 + m2), 0, 0],
        "inertia": [[0.1, 0, 0], [0, m2, 0], [0, 0, m2]],
        "static_moments": [[m2, 0, 0]], "with_position": [square(m2)], "products": [[square(m2)]],
        "stiffness": [[k]],
        "points": {"first": {"position": [0, 0, 0], "displacement": [[0, 0, 0]], "rotation": [[0, 0, 0]]},
                   "second": {"position": [1, 0, 0], "displacement": [[1, 0, 0]]}}
    });
    std::fs::write(&path, good.to_string()).expect("written");
    let q = 0.01;
    let document = json!({
        "version": 1, "name": "rod", "gravity": [0, 0, 0],
        "bodies": {"rod": {"modal": {"source": {"standard_input": path}, "start": {"coordinates": [q]}}}},
        "simulation": {"duration": 0.3, "tolerance": 1e-10, "method": {"radau": {"stages": 3}}},
        "functions": {
            "length": {"final": {"elastic_displacement": {"body": "rod", "point": "second", "direction": [1, 0, 0]}}},
            "first": {"final": {"position": {"body": "rod", "point": "first", "direction": [1, 0, 0]}}}}
    });
    let found = values(&document);
    let omega = (k * (1.0 / m1 + 1.0 / m2)).sqrt();
    let length = q * (omega * 0.3).cos();
    assert!((found[0] - length).abs() < 1e-8, "{found:?} {length}");
    assert!((found[1] - (q - length) * m2 / (m1 + m2)).abs() < 1e-8);
    // A mode whose rotation is not known admits no hinge.
    let mut hinged = document.clone();
    hinged["joints"] = json!({"hinge": {"revolute": {"between": ["rod", "ground"], "at": "rod.second", "axis": [0, 0, 1]}}});
    let faults = Problem::parse(&hinged.to_string(), "rod", &[]).expect_err("no rotation");
    assert!(
        faults.to_string().contains("rotation is not known"),
        "{faults}"
    );
    // Faults, each with its place.
    for (pointer, value, wanted) in [
        ("/stiffness", json!([[-k]]), "not positive definite"),
        ("/stiffness", json!([[k, 0]]), "a list of 1"),
        ("/with_position", json!([zero, zero]), "a list of 1"),
        ("/products", json!([[zero]]), "positive definite mass"),
        ("/products", json!([[zero, zero]]), "a list of 1"),
        ("/mass", json!(-1), "above 0"),
        ("/mass", json!("heavy"), "a number"),
        (
            "/inertia",
            json!([[1, 2, 3], [0, 1, 0], [0, 0, 1]]),
            "no inertia",
        ),
        ("/points/second/displacement", json!([]), "a list of 1"),
        ("/points/first/rotation", json!([[0, 0]]), "a list of 3"),
        ("/version", json!(2), "1"),
        ("/static_moments", json!([]), "at least one mode"),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).expect("there") = value;
        std::fs::write(&path, serde_json::to_string_pretty(&bad).expect("text")).expect("written");
        let faults = Problem::parse(&document.to_string(), "rod", &[]).expect_err(pointer);
        let fault = &faults.list[0];
        assert!(fault.line > 1 || pointer.is_empty(), "{faults}");
        let text = faults.to_string();
        assert!(
            text.contains(wanted) && text.contains("rod.json:"),
            "{pointer}: {text}"
        );
    }
    std::fs::write(&path, "{\"version\": 1,").expect("written");
    let faults = Problem::parse(&document.to_string(), "rod", &[]).expect_err("no JSON");
    assert!(faults.to_string().contains("rod.json:1:"), "{faults}");
}

/// What `explain` prints of a body: boundary modes by number, and frequencies beside the full ones.
#[test]
fn the_origin_of_coordinates_is_told() {
    let problem = parsed(&pendulum("modal", modal(json!({"clamped": "start"}))));
    let [told] = &problem.flexible_bodies(&[])[..] else {
        panic!("one body")
    };
    println!("{told}");
    assert!(told.contains("126 unknowns of 21 nodes"));
    assert!(
        told.contains(
            "12 boundary modes (\"start\" none, \"middle\" 6, \"end\" 6), which are the 18"
        )
    );
    assert!(told.contains("8 fixed-interface modes"));
    let percent = told
        .rsplit("differ by up to ")
        .next()
        .expect("a difference");
    let percent: f64 = percent
        .split(' ')
        .next()
        .and_then(|x| x.parse().ok())
        .expect("a number");
    assert!(percent < 1.0, "{told}");
}
