//! Random scenes of flexible bodies, and structures at rest.

use crate::command::{Answer, simulate};
use crate::judge::agreement;
use crate::numbers::{Numbers, Turn, Vector};
use crate::{Judged, judge_estimates};
use serde_json::{Value, json};
use std::path::Path;

fn numbers(number: usize, family: u64) -> Numbers {
    Numbers(0xf1e8 + 104_729 * number as u64 + family)
}

/// A flexible bar on a hinge: a beam by functions, or shells.
struct Bar {
    shells: bool,
    welded: bool,
    length: f64,
    thickness: f64,
    young: f64,
    turn: Turn,
    gravity: Vector,
    rate: f64,
    damping: f64,
}

impl Bar {
    fn random(numbers: &mut Numbers) -> Self {
        let length = numbers.between(0.5, 1.5);
        let thickness = length * numbers.between(0.03, 0.08);
        Self {
            shells: numbers.chance(0.5),
            welded: numbers.chance(0.4),
            length,
            thickness,
            // Its end sags by about a hundredth of the length.
            young: numbers.between(0.5, 2.0) * 1.5 * 1000.0 * 9.81 * length.powi(3)
                / thickness.powi(2)
                * 100.0,
            turn: Turn {
                axis: numbers.direction(),
                angle: numbers.between(-3.0, 3.0),
            },
            gravity: numbers.direction().map(|x| 9.81 * x),
            rate: numbers.between(-1.0, 1.0),
            // Ratios of damping are those of the modes in held axes, so they would depend on the axes.
            damping: numbers.between(3e-4, 1e-3),
        }
    }

    fn document(&self, chord: bool, duration: f64, simulation: &Value) -> Value {
        let (h, material) = (
            self.thickness,
            json!({"young": self.young, "poisson": 0.3, "density": 1000}),
        );
        let width = 0.25 * self.length;
        let body = if self.shells {
            let frame = if chord {
                json!({"chord": ["start", "end", "x0y0"]})
            } else {
                json!({"clamped": "x0"})
            };
            json!({"elements": {
                "structure": {
                    "mesh": {"plate": {"length": self.length, "width": width, "elements": [4, 1]}},
                    "material": "stuff", "thickness": h, "damping": {"stiffness": 1e-3},
                    "sets": {"start": {"node": {"at": [0, 0.5]}}, "end": {"node": {"at": [1, 0.5]}}},
                },
                "frame": frame,
                "points": {"near": {"edge": "x0"}, "far": {"edge": "x1"}},
            }})
        } else {
            json!({"beam": {
                "length": self.length, "section": {"rectangle": {"width": width, "height": h}}, "material": material,
                "frame": if chord { "chord" } else { "clamped" },
                "modes": {"bending_y": 4, "bending_z": 4, "torsion": 2}, "damping": {"stiffness": self.damping},
                "stations": {"near": 0, "far": 1},
            }})
        };
        let mut bar = body;
        bar["place"] = json!({"put": "near", "at": [0, 0, 0], "turn": {"axis": self.turn.axis, "angle": self.turn.angle}});
        let axis = if self.shells {
            [0.0, 1.0, 0.0]
        } else {
            [0.0, 0.0, 1.0]
        };
        let mut hinge = json!({"between": ["bar", "ground"], "at": "bar.near"});
        let kind = if self.welded { "weld" } else { "revolute" };
        if !self.welded {
            hinge["axis"] = json!(self.turn.of(axis));
            hinge["start"] = json!({"turn": {"rate": self.rate}});
        }
        let place = |k: usize| {
            let mut direction = [0.0; 3];
            direction[k] = 1.0;
            json!({"final": {"position": {"body": "bar", "point": "far", "direction": direction}}})
        };
        let mut document = json!({
            "version": 1, "name": "bar", "gravity": self.gravity,
            "bodies": {"bar": bar}, "joints": {"hinge": {kind: hinge}},
            "simulation": {"duration": duration},
            "functions": {"x": place(0), "y": place(1), "z": place(2),
                "action": {"integral": {"energy": "kinetic"}}},
            "variables": {"gravity": {"path": "/gravity/1", "lower": -1e30, "upper": 1e30}},
        });
        if self.shells {
            document["materials"] = json!({"stuff": material});
        }
        for (key, value) in simulation.as_object().into_iter().flatten() {
            document["simulation"][key] = value.clone();
        }
        document
    }
}

/// The same body in chord and in clamped axes. Both are approximations of large bending: positions agree within
/// two ten-thousandths of the length, two per cent of the sag.
pub fn frames(directory: &Path, number: usize) -> Judged {
    let bar = Bar::random(&mut numbers(number, 1));
    let simulation = json!({"method": {"radau": {"stages": 3}}, "steps": 200});
    let by = |chord, name| {
        let document = bar.document(chord, 0.5, &simulation);
        values_only(simulate(directory, name, &document, &[]), 1e-5 * bar.length)
    };
    (
        agreement(&by(true, "chord"), &by(false, "clamped"), |_| 1.0, 2e-3),
        Vec::new(),
    )
}

/// Estimated against true errors of equal steps.
pub fn estimates(directory: &Path, number: usize) -> Judged {
    let mut numbers = numbers(number, 2);
    let bar = Bar::random(&mut numbers);
    let steps = 20 << numbers.below(3);
    let method = match numbers.below(4) {
        0 => json!({"bdf": {"order": 2}}),
        1 => json!({"generalised_alpha": {"radius": 0.8}}),
        stages => json!({"radau": {"stages": stages}}),
    };
    let claimed = bar.document(true, 0.2, &json!({"method": method, "steps": steps}));
    let claimed = simulate(directory, "claimed", &claimed, &["--error"]);
    // Radau IIA with three stages in twice the steps.
    let truth = json!({"method": {"radau": {"stages": 3}}, "steps": 2 * steps});
    let truth = simulate(
        directory,
        "truth",
        &bar.document(true, 0.2, &truth),
        &["--error"],
    );
    judge_estimates(&truth, &claimed, 1e-8)
}

/// The values, with this error of positions.
fn values_only(answer: Answer, of_positions: f64) -> Answer {
    match answer {
        Answer::Numbers { mut table, warned } => {
            table.retain(|name, _| !name.contains(" / "));
            let positions = table.iter_mut().filter(|(name, _)| *name != "action");
            positions.for_each(|(_, number)| number.error = of_positions);
            Answer::Numbers { table, warned }
        }
        other => other,
    }
}

/// A panel at rest, tilted, held along two edges' axes, with a pressure and a force.
fn structure(numbers: &mut Numbers, turn: Turn, reordered: bool) -> Value {
    let (length, width) = (numbers.between(0.5, 2.0), numbers.between(0.3, 1.0));
    let (rise, twist) = (numbers.between(-0.3, 0.3), numbers.between(-0.2, 0.2));
    let tilt = Turn {
        axis: numbers.direction(),
        angle: numbers.between(-3.0, 3.0),
    };
    let corner = |x: f64, y: f64, z: f64| turn.of(tilt.of([x, y, z]));
    let force = turn.of(numbers.direction().map(|x| 10.0 * x));
    let look = turn.of(numbers.direction());
    let pressure = numbers.between(100.0, 1000.0);
    let von_karman = numbers.chance(0.3);
    let unknowns = if numbers.chance(0.5) { "five" } else { "six" };
    let sides = [["x0", "x1", "y0"], ["y0", "y1", "x0"]][numbers.below(2)];
    let supports = json!({"fixed": {"nodes": [sides[0]]}, "pinned": {"nodes": [sides[1]], "held": ["x", "y", "z"]}});
    let entry = |name: &str, value: Value| (name.to_owned(), value);
    let mut loads = vec![
        entry(
            "wind",
            json!({"pressure": {"faces": "all", "pressure": pressure}}),
        ),
        entry(
            "push",
            json!({"point": {"nodes": sides[2], "force": force}}),
        ),
    ];
    let mut functions = vec![
        entry("mass", json!("mass")),
        entry("compliance", json!({"compliance": {"case": "work"}})),
        entry(
            "move",
            json!({"displacement": {"case": "work", "nodes": sides[2], "direction": look}}),
        ),
        entry(
            "hold",
            json!({"reaction": {"case": "work", "nodes": sides[0], "direction": look}}),
        ),
        entry(
            "twist",
            json!({"reaction_moment": {"case": "work", "nodes": sides[0], "axis": look, "about": [0, 0, 0]}}),
        ),
        entry("frequency", json!({"frequency": {"mode": 1}})),
        entry(
            "stress",
            json!({"von_mises": {"rho": 50, "cases": ["work"]}}),
        ),
    ];
    if reordered {
        loads.reverse();
        functions.reverse();
    }
    let map = |entries: Vec<(String, Value)>| Value::Object(entries.into_iter().collect());
    let points = [
        corner(0.0, 0.0, 0.0),
        corner(length, 0.0, rise),
        corner(0.0, width, 0.0),
        corner(length, width, rise + twist),
    ];
    json!({
        "version": 1, "name": "panel",
        "materials": {"steel": {"young": 2e11, "poisson": 0.3, "density": 7800, "yield_stress": 2e8}},
        "structures": {"panel": {
            "mesh": {"panel": {"points": points, "elements": [4, 3]}}, "material": "steel", "thickness": 0.01,
            "supports": supports,
        }},
        "load_cases": {"work": map(loads)},
        "statics": {"strains": if von_karman { "von_karman" } else { "linear" }, "node_unknowns": unknowns},
        "functions": map(functions),
        "variables": {"thickness": {"path": "/structures/panel/thickness", "lower": 1e-3, "upper": 1}},
    })
}

/// A structure, and the same one turned.
pub fn turned(directory: &Path, number: usize) -> Judged {
    let turn = {
        let mut numbers = numbers(number, 3);
        Turn {
            axis: numbers.direction(),
            angle: numbers.between(-3.0, 3.0),
        }
    };
    compared(directory, number, turn, false)
}

/// A structure, and the same one with its loads and functions in reverse order.
pub fn reordered(directory: &Path, number: usize) -> Judged {
    compared(directory, number, Turn::NONE, true)
}

fn compared(directory: &Path, number: usize, turn: Turn, reordered: bool) -> Judged {
    let by = |name, turn, reordered| {
        let document = structure(&mut numbers(number, 4), turn, reordered);
        simulate(directory, name, &document, &["--error"])
    };
    let (one, other) = (by("plain", Turn::NONE, false), by("other", turn, reordered));
    // The error of discretisation is the same in both.
    let without_errors = |answer| match answer {
        Answer::Numbers { mut table, warned } => {
            table
                .values_mut()
                .for_each(|number: &mut crate::Estimate| number.error = 0.0);
            Answer::Numbers { table, warned }
        }
        other => other,
    };
    (
        agreement(&without_errors(one), &without_errors(other), |_| 1.0, 1e-7),
        Vec::new(),
    )
}
