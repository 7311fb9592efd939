//! Vibrations of linkages and of free bodies against independent eigenvalues: a four-bar linkage of beams whose crank is held
//! against finite elements of this test, and the textbook cases of rigid and elastic bodies.

use crate::reference::documents::values;
use nalgebra::{DMatrix, SMatrix, SVector, SymmetricEigen};
use serde_json::Value;
use std::f64::consts::PI;

const YOUNG: f64 = 2.07e11;
const DENSITY: f64 = 7800.0;

/// A bar of an Euler–Bernoulli frame in the plane: its ends, height and width.
struct Bar {
    from: [f64; 2],
    to: [f64; 2],
    height: f64,
    width: f64,
}

/// Elements of a bar.
const ELEMENTS: usize = 24;

/// Stiffness and mass of an element with the unknowns (u, v, θ) of both ends along and across it.
fn element(length: f64, bar: &Bar) -> [SMatrix<f64, 6, 6>; 2] {
    let area = bar.height * bar.width;
    let bending = YOUNG * bar.width * bar.height.powi(3) / 12.0;
    let (l, along) = (length, YOUNG * area / length);
    let mut stiffness = SMatrix::<f64, 6, 6>::zeros();
    let mut mass = stiffness;
    let heavy = DENSITY * area * l;
    for (i, j, k, m) in [
        (0, 0, along, heavy / 3.0),
        (0, 3, -along, heavy / 6.0),
        (3, 3, along, heavy / 3.0),
        (1, 1, 12.0, 156.0),
        (1, 2, 6.0 * l, 22.0 * l),
        (1, 4, -12.0, 54.0),
        (1, 5, 6.0 * l, -13.0 * l),
        (2, 2, 4.0 * l * l, 4.0 * l * l),
        (2, 4, -6.0 * l, 13.0 * l),
        (2, 5, 2.0 * l * l, -3.0 * l * l),
        (4, 4, 12.0, 156.0),
        (4, 5, -6.0 * l, -22.0 * l),
        (5, 5, 4.0 * l * l, 4.0 * l * l),
    ] {
        let of_length = i % 3 == 0;
        let k = if of_length {
            k
        } else {
            k * bending / l.powi(3)
        };
        let m = if of_length { m } else { m * heavy / 420.0 };
        (stiffness[(i, j)], stiffness[(j, i)]) = (k, k);
        (mass[(i, j)], mass[(j, i)]) = (m, m);
    }
    [stiffness, mass]
}

/// Frequencies \[Hz\] of a chain of bars that hinges join: the first is clamped where it begins, the last is hinged to ground.
fn frame(bars: &[Bar]) -> Vec<f64> {
    // Displacements of places, then rotations of the nodes of each bar.
    let places = bars.len() * ELEMENTS + 1;
    let rotation = |bar: usize, node: usize| 2 * places + bar * (ELEMENTS + 1) + node;
    let count = 2 * places + bars.len() * (ELEMENTS + 1);
    let (mut k, mut m) = (DMatrix::zeros(count, count), DMatrix::zeros(count, count));
    for (b, bar) in bars.iter().enumerate() {
        let way = SVector::<f64, 2>::new(bar.to[0] - bar.from[0], bar.to[1] - bar.from[1]);
        let length = way.norm() / ELEMENTS as f64;
        let [c, s] = [way[0] / way.norm(), way[1] / way.norm()];
        let mut turn = SMatrix::<f64, 6, 6>::identity();
        for o in [0, 3] {
            (turn[(o, o)], turn[(o, o + 1)]) = (c, s);
            (turn[(o + 1, o)], turn[(o + 1, o + 1)]) = (-s, c);
        }
        let [stiffness, mass] = element(length, bar).map(|own| turn.transpose() * own * turn);
        for e in 0..ELEMENTS {
            let place = b * ELEMENTS + e;
            let at = [
                2 * place,
                2 * place + 1,
                rotation(b, e),
                2 * place + 2,
                2 * place + 3,
                rotation(b, e + 1),
            ];
            for (i, &row) in at.iter().enumerate() {
                for (j, &column) in at.iter().enumerate() {
                    k[(row, column)] += stiffness[(i, j)];
                    m[(row, column)] += mass[(i, j)];
                }
            }
        }
    }
    let held = [0, 1, rotation(0, 0), 2 * places - 2, 2 * places - 1];
    let free: Vec<usize> = (0..count).filter(|i| !held.contains(i)).collect();
    let of =
        |a: &DMatrix<f64>| DMatrix::from_fn(free.len(), free.len(), |i, j| a[(free[i], free[j])]);
    let (k, m) = (of(&k), of(&m));
    let root = m.cholesky().expect("positive").l();
    let inverse = root.try_inverse().expect("regular");
    let squares = SymmetricEigen::new(&inverse * k * inverse.transpose()).eigenvalues;
    let mut all: Vec<f64> = squares
        .iter()
        .map(|x| x.max(0.0).sqrt() / (2.0 * PI))
        .collect();
    all.sort_by(f64::total_cmp);
    all
}

fn frequencies(count: usize) -> Value {
    let one = |mode| (format!("f{mode}"), json!({"frequency": {"mode": mode}}));
    Value::Object((1..=count).map(one).collect())
}

/// The same linkage of beams with functions of bending in the plane.
fn four_bar(bars: &[Bar], modes: usize) -> Value {
    let names = ["crank", "coupler", "rocker"];
    let mut file = json!({
        "version": 1, "name": "four bar", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {}, "joints": {},
        "drives": {"motor": {"joint": "A", "turn": {"polynomial": [0]}}},
        "functions": frequencies(4)
    });
    for (name, bar) in names.iter().zip(bars) {
        let [x, y] = [bar.to[0] - bar.from[0], bar.to[1] - bar.from[1]];
        file["bodies"][name] = json!({
            "beam": {
                "length": x.hypot(y), "section": {"rectangle": {"width": bar.width, "height": bar.height}},
                "material": {"young": YOUNG, "poisson": 0.3, "density": DENSITY},
                "modes": {"bending_y": modes, "bending_z": 0, "torsion": 0, "stretch": 3}
            },
            "place": {"put": "start", "at": [bar.from[0], bar.from[1], 0], "turn": {"axis": [0, 0, 1], "angle": y.atan2(x)}}
        });
    }
    let hinge = |a: &str, b: &str, at: [f64; 2]| json!({"revolute": {"between": [a, b], "at": [at[0], at[1], 0], "axis": [0, 0, 1]}});
    file["joints"] = json!({
        "A": hinge("crank", "ground", bars[0].from),
        "B": hinge("coupler", "crank", bars[1].from),
        "C": {"spherical": {"between": ["rocker", "coupler"], "at": [bars[2].from[0], bars[2].from[1], 0]}},
        "D": hinge("rocker", "ground", bars[2].to)
    });
    file
}

#[test]
fn a_four_bar_linkage_of_beams_vibrates_as_a_frame_with_hinges() {
    let bar = |from: [f64; 2], to: [f64; 2], height: f64| Bar {
        from,
        to,
        height,
        width: 0.03,
    };
    for angle in [0.6_f64, 1.4, 2.3] {
        let b = [0.12 * angle.cos(), 0.12 * angle.sin()];
        let c = [0.25, 0.15];
        let bars = [
            bar([0.0, 0.0], b, 0.003),
            bar(b, c, 0.002),
            bar(c, [0.24, 0.0], 0.002),
        ];
        let expected = frame(&bars);
        let found = values(&four_bar(&bars, 6));
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{angle}: {found} {expected}"
            );
        }
    }
}

/// A bar on two springs: bounce and pitch.
#[test]
fn a_bar_on_two_springs_bounces_and_pitches() {
    let (mass, length, stiffness) = (3.0, 1.2, [400.0, 900.0]);
    let spring = |x: f64, k: f64| json!({"spring": {"between": ["bar", "ground"], "at": {"a": [x, 0, 0], "b": [x, -0.5, 0]}, "rest_length": 0.5, "stiffness": k}});
    let file = json!({
        "version": 1, "name": "bar", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": {"bar": {"mass": mass, "inertia": {"xx": 0.01, "yy": 0.36, "zz": mass * length * length / 12.0}},
            "guide": {"mass": 1e-9, "inertia": {"xx": 1e-12, "yy": 1e-12, "zz": 1e-12}}},
        "joints": {
            "slot": {"prismatic": {"between": ["guide", "ground"], "at": [0, 0, 0], "axis": [0, 1, 0]}},
            "pin": {"revolute": {"between": ["bar", "guide"], "at": [0, 0, 0], "axis": [0, 0, 1]}}
        },
        "loads": {"left": spring(-0.6, stiffness[0]), "right": spring(0.6, stiffness[1])},
        "functions": frequencies(2)
    });
    let [a, b] = stiffness;
    let (x, inertia) = (0.6, mass * length * length / 12.0);
    // [k, m] of (height, angle): det(K − ω² M) = 0.
    let (k11, k12, k22) = (a + b, (b - a) * x, (a + b) * x * x);
    let (p, q) = (
        k11 / mass + k22 / inertia,
        (k11 * k22 - k12 * k12) / (mass * inertia),
    );
    let root = (p * p / 4.0 - q).sqrt();
    let expected = [p / 2.0 - root, p / 2.0 + root].map(|x: f64| x.sqrt() / (2.0 * PI));
    for (found, expected) in values(&file).iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
}

/// A square plate that nothing holds: √(12 (1 − ν²) ρ / E) ω a² / h = 13.47, 19.60 and 24.27 for ν = 0.3 (Leissa 1973,
/// J. Sound Vib. 31, 257), after six free motions that do not count.
#[test]
fn a_free_plate_has_the_modes_of_the_literature() {
    let (a, h, young, poisson, density) = (1.0, 0.01, 7e10_f64, 0.3, 2700.0);
    let file = json!({
        "version": 1, "name": "plate", "analysis": "rest", "gravity": [0, 0, 0],
        "materials": {"m": {"young": young, "poisson": poisson, "density": density}},
        "bodies": {"plate": {"elements": {"structure": {
            "mesh": {"plate": {"length": a, "width": a, "elements": [6, 6]}}, "material": "m", "thickness": h
        }, "frame": {"chord": ["x0y0", "x1y0", "x0y1"]}}}},
        "functions": frequencies(3)
    });
    let scale = (young / (12.0 * (1.0 - poisson * poisson) * density)).sqrt() * h / (a * a);
    for (found, expected) in values(&file).iter().zip([13.47, 19.60, 24.27]) {
        let expected = expected * scale / (2.0 * PI);
        assert!((found / expected - 1.0).abs() < 1e-2, "{found} {expected}");
    }
}

/// Two bodies that a guide and a spring join, and a pair of chains of them: bodies that float have many free motions, and
/// none of them is a vibration.
#[test]
fn bodies_that_float_vibrate_against_each_other() {
    let (a, b, stiffness) = (1.0, 2.0, 100.0);
    let floating = |name: &str, mass: f64, at: [f64; 3]| {
        (
            name.to_owned(),
            json!({"shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "mass": mass, "place": {"at": at}}),
        )
    };
    let file = json!({
        "version": 1, "name": "pair", "analysis": "rest", "gravity": [0, 0, 0],
        "bodies": Value::Object([
            floating("a", a, [0.0; 3]), floating("b", b, [0.6, 0.8, 0.0]),
            floating("c", a, [0.0, 0.0, 3.0]), floating("d", 4.0 * b, [0.6, 0.8, 3.0])
        ].into_iter().collect()),
        "joints": {
            "first": {"prismatic": {"between": ["a", "b"], "at": [0, 0, 0], "axis": [3, 4, 0]}},
            "second": {"prismatic": {"between": ["c", "d"], "at": [0, 0, 3], "axis": [3, 4, 0]}}
        },
        "loads": {
            "one": {"spring": {"between": ["a", "b"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": stiffness}},
            "two": {"spring": {"between": ["c", "d"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]}, "rest_length": 1, "stiffness": stiffness}}
        },
        "functions": frequencies(2)
    });
    let expected = |a: f64, b: f64| (stiffness * (1.0 / a + 1.0 / b)).sqrt() / (2.0 * PI);
    for (found, expected) in values(&file)
        .iter()
        .zip([expected(a, 4.0 * b), expected(a, b)])
    {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}
