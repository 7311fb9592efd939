//! A flexible body bends alike in whatever axes its mesh is written.

use super::turned_scenes::{rows_of, turned};
use crate::reference::documents::values;
use nalgebra::{Rotation3, Vector3};
use serde_json::Value;

/// A bracket of two tubes welded to ground, a weight at its tip, at rest under an oblique gravity. The mesh is written in
/// axes turned by `axes`, and placed turned back.
fn bracket(axes: &Rotation3<f64>) -> Value {
    let turned = |x: [f64; 3]| turned(axes, x);
    let member = |ends: [&str; 2]| json!({"between": ends, "orientation": turned([0.0, 1.0, 0.0]), "elements": 6});
    let frame = json!({
        "points": {
            "root": turned([0.0, 0.0, 0.0]), "c": turned([0.0, 0.0, 0.4]), "tip": turned([0.7, 0.0, 0.5])
        },
        "members": {"m1": member(["root", "c"]), "m2": member(["c", "tip"])}
    });
    let rotation = |axis: [i32; 3]| json!({"final": {"rotation": {"body": "W", "axis": axis}}});
    json!({
        "version": 1, "name": "bracket", "analysis": "rest", "gravity": [3, 4, -5],
        "materials": {"m": {"young": 7e9, "poisson": 0.3, "density": 2700}},
        "bodies": {
            "A": {
                "elements": {
                    "structure": {"mesh": {"frame": frame}, "material": "m",
                        "section": {"tube": {"radius": 0.015, "wall": 0.002}}},
                    "frame": {"clamped": "root"},
                    "points": {"root": {"node": "root"}, "tip": {"node": "tip"}}
                },
                "place": {"turn": {"matrix": rows_of(&axes.inverse())}}
            },
            "W": {"shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1,
                "place": {"put": [-0.4, 0.3, 0.1], "at": "A.tip"}}
        },
        "joints": {
            "r": {"weld": {"between": ["A", "ground"], "at": "A.root"}},
            "w": {"weld": {"between": ["W", "A"], "at": "A.tip"}}
        },
        "functions": {
            "rx": rotation([1, 0, 0]), "ry": rotation([0, 1, 0]), "rz": rotation([0, 0, 1]),
            "energy": {"final": {"strain_energy": {"body": "A"}}}
        }
    })
}

/// The rotations of the weight are those of the same tubes divided into 24 welded bodies, but for half a percent.
#[test]
fn sections_turn_alike_in_all_axes_of_the_mesh() {
    let written = values(&bracket(&Rotation3::identity()));
    let divided = [0.014293, 0.04461, 0.048224];
    for (found, divided) in written.iter().zip(divided) {
        assert!(
            (found / divided - 1.0).abs() < 6e-3,
            "{written:?} {divided}"
        );
    }
    for k in 1..8_u32 {
        let angle = 0.7 * f64::from(k);
        let axis = Vector3::new(1.0, angle.cos(), 1.3 * angle.sin()).normalize();
        let turned = values(&bracket(&Rotation3::new(axis * angle)));
        for (found, expected) in turned.iter().zip(&written) {
            assert!(
                (found / expected - 1.0).abs() < 1e-10,
                "{k}: {turned:?} {written:?}"
            );
        }
    }
}
