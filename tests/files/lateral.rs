//! Deep beams under load in their plane with a small force across it: function beams, beams of elements in motion and
//! at rest, their gradients, when they are told to be unstable, and beams that cannot buckle.

use super::statics::solved_at;
use crate::reference::documents::{problem as parsed, run, value};
use crate::reference::gradients::gradients_are_exact;
use flexbody_driver::{Evaluated, bases, start};
use serde_json::Value;

const LENGTH: f64 = 1.0;
const YOUNG: f64 = 7e10;
const SIZES: [f64; 2] = [0.1, 0.005];

/// 4.013 √(EI GJ) / L² of a cantilever with a force at its end (Timoshenko & Gere 1961, section 6.3).
fn critical() -> f64 {
    let [height, width] = SIZES;
    let weak = YOUNG * height * width.powi(3) / 12.0;
    // J of 20 : 1, by Saint-Venant's series; G = E / 2.6.
    let torsion = YOUNG / 2.6 * height * width.powi(3) / 3.0 * (1.0 - 0.630_25 / 20.0);
    4.013 * (weak * torsion).sqrt() / LENGTH.powi(2)
}

/// A cantilever in motion, from a start in equilibrium, with `part` of the critical force and a small one across.
fn moving(body: &Value, part: f64) -> Value {
    let force = |direction: [f64; 3], magnitude: f64| json!({"force": {"body": "p", "point": "end", "direction": direction, "magnitude": magnitude}});
    let position = |direction: [f64; 3]| json!({"final": {"position": {"body": "p", "point": "end", "direction": direction}}});
    json!({
        "version": 1, "name": "lateral", "gravity": [0, 0, 0], "start": "equilibrium",
        "materials": {"m": {"young": YOUNG, "poisson": 0.3, "density": 2700}},
        "bodies": {"p": body},
        "joints": {"w": {"weld": {"between": ["p", "ground"], "at": "p.start"}}},
        "loads": {"down": force([0.0, -1.0, 0.0], part * critical()), "across": force([0.0, 0.0, 1.0], 0.1)},
        "functions": {"v": position([0.0, 1.0, 0.0]), "w": position([0.0, 0.0, 1.0])},
        "simulation": {"duration": 1e-4, "steps": 2, "method": {"radau": {"stages": 2}}}
    })
}

fn by_functions(frame: &str, modes: [u32; 3]) -> Value {
    let [height, width] = SIZES;
    json!({"beam": {
        "length": LENGTH, "section": {"rectangle": {"width": width, "height": height}},
        "material": {"young": YOUNG, "poisson": 0.3, "density": 2700}, "frame": frame,
        "modes": {"bending_y": modes[0], "bending_z": modes[1], "torsion": modes[2]}
    }, "place": {"put": "start", "at": [0, 0, 0]}})
}

/// Axis 2 of the section is y.
fn structure() -> Value {
    let [height, width] = SIZES;
    json!({
        "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [LENGTH, 0, 0], "orientation": [0, 1, 0], "elements": 6}},
        "material": "m", "section": {"rectangle": {"width": height, "height": width}}
    })
}

fn by_elements() -> Value {
    json!({"elements": {
        "structure": structure(), "frame": {"clamped": "start"},
        "points": {"start": {"node": "start"}, "end": {"node": "end"}}
    }})
}

fn at_rest(part: f64) -> f64 {
    let mut own = structure();
    own["supports"] = json!({"foot": {"nodes": ["start"]}});
    let document = json!({
        "version": 1, "name": "lateral", "statics": {"strains": "von_karman"},
        "materials": {"m": {"young": YOUNG, "poisson": 0.3, "density": 2700}},
        "structures": {"s": own},
        "load_cases": {"tip": {"f": {"point": {"nodes": "end", "force": [0, -part * critical(), 0.1]}}}},
        "functions": {"w": {"displacement": {"case": "tip", "nodes": "end", "direction": [0, 0, 1]}}}
    });
    solved_at(&parsed(&document), &[]).function(0).value
}

/// How much softer across its plane a cantilever is under `part` of the critical force: with s from its end by L and
/// k = (4.013 part)² the twist is y − 1 times a constant, y'' + k s² y = 0, y'(0) = 0, y(1) = 1, and the ratio of deflections
/// is 3 ∫ s² y ds (the equations of Timoshenko & Gere 1961, section 6.3).
fn softer(part: f64) -> f64 {
    let k = (4.013 * part).powi(2);
    let (mut term, mut y, mut integral) = (1.0, 0.0, 0.0);
    for n in 0..20 {
        let power = 4.0 * f64::from(n);
        if n > 0 {
            term *= -k / (power * (power - 1.0));
        }
        y += term;
        integral += term / (power + 3.0);
    }
    3.0 * integral / y
}

/// A force in the plane makes the beam softer across it as the closed form says, and functions, elements in motion and
/// elements at rest agree.
#[test]
fn a_force_in_the_plane_softens_the_beam_across() {
    let [height, width] = SIZES;
    let weak = YOUNG * height * width.powi(3) / 12.0;
    let free = 0.1 / (3.0 * weak);
    for part in [0.0, 0.3, 0.5, 0.7, 0.8, 0.9_f64] {
        let rest = at_rest(part);
        let ratio = rest / free / softer(part);
        println!("{part}: {} {ratio}", rest / free);
        // Near the critical load its third digit counts.
        let tolerance = 1e-3 + 4e-3 * part.powi(2) / (1.0 - part.powi(2));
        assert!((ratio - 1.0).abs() < tolerance, "{part}: {ratio}");
        // Parts of the critical load by which it differs. The bending in the plane, which is 1/400 of that across, counts from
        // here on, and in chord axes the section that is welded turns by it.
        let (clamped, chord) = (2.5e-3, 6e-3);
        for (body, apart) in [
            (by_functions("clamped", [5, 5, 4]), clamped),
            (by_functions("chord", [5, 5, 4]), chord),
            (by_functions("clamped", [2, 5, 4]), clamped),
            (by_functions("clamped", [3, 8, 4]), clamped),
            (by_functions("clamped", [4, 8, 8]), clamped),
            (by_functions("clamped", [8, 5, 4]), clamped),
            (by_functions("chord", [3, 7, 5]), chord),
            (by_elements(), clamped),
        ] {
            let moves = value(&moving(&body, part), "w");
            println!("{part}: {}", moves / rest - 1.0);
            let tolerance = 1e-6 + 2.0 * apart * part.powi(2) / (1.0 - part.powi(2));
            assert!(
                (moves / rest - 1.0).abs() < tolerance,
                "{part}: {moves} {rest}"
            );
        }
    }
}

/// Beyond the critical load a start in equilibrium is not stable and a structure carries no more, up to ten times.
#[test]
fn beams_that_buckle_sideways_are_told() {
    for body in [by_functions("clamped", [4, 4, 4]), by_elements()] {
        for part in [0.8, 1.05, 2.0, 10.0] {
            let mut document = moving(&body, part);
            document["loads"]
                .as_object_mut()
                .expect("loads")
                .remove("across");
            let problem = parsed(&document);
            let notes = start::notes(&problem, &problem.start());
            let told = notes.iter().any(|note| note.contains("is not stable"));
            assert_eq!(told, part > 1.0, "{part}: {notes:?}");
        }
    }
}

/// A beam whose twist and bending do not couple is told from half the moment of lateral buckling on, and no other.
#[test]
fn beams_that_cannot_buckle_are_told_near_it() {
    let told = |body: &Value, part: f64| {
        let warning = run(&moving(body, part)).warning.unwrap_or_default();
        warning.contains("buckles it sideways")
    };
    let mut linear = by_functions("clamped", [3, 3, 2]);
    linear["beam"]["strain"] = json!("linear");
    let no_torsion = by_functions("clamped", [3, 3, 0]);
    let in_plane = by_functions("clamped", [3, 0, 2]);
    // 4.013 / π of the moment between hinges at the critical force.
    for body in [linear, no_torsion, in_plane] {
        assert!(!told(&body, 0.2));
        assert!(told(&body, 0.5));
        assert!(told(&body, 0.9));
    }
    assert!(!told(&by_functions("clamped", [3, 3, 2]), 0.8));
}

/// Derivatives by sizes, length and modulus of a beam near lateral buckling, also of its section forces.
#[test]
fn gradients_near_lateral_buckling_are_exact() {
    for (body, name) in [
        (by_functions("clamped", [2, 2, 2]), "beam"),
        (by_elements(), "elements"),
    ] {
        let mut document = moving(&body, 0.8);
        let section = match name {
            "beam" => "/bodies/p/beam/section/rectangle",
            _ => "/bodies/p/elements/structure/section/rectangle",
        };
        document["variables"] = json!({
            "height": {"path": format!("{section}/height"), "lower": 1e-3, "upper": 0.2},
            "width": {"path": format!("{section}/width"), "lower": 1e-3, "upper": 0.2},
            "force": {"path": "/loads/down/force/magnitude", "lower": 1, "upper": 1e4},
        });
        for component in ["torsion", "bending_y", "bending_z"] {
            document["functions"][component] = json!({"final": {"section_force": {
                "body": "p", "station": 0.3, "component": component}}});
        }
        let problem = parsed(&document);
        gradients_are_exact(&problem, &document);
    }
}

/// The error of the functions of a beam is that against more of them: near the critical load the default ones, and poorer
/// ones, are far off, and the error says by how much to a factor of three.
#[test]
fn errors_of_functions_are_those_against_more() {
    for (frame, modes, part) in [
        ("clamped", [4, 4, 2], 0.85),
        ("chord", [4, 4, 2], 0.85),
        ("clamped", [4, 4, 2], 0.5),
        ("clamped", [3, 3, 2], 0.7),
        ("chord", [3, 4, 1], 0.8),
        ("clamped", [4, 4, 1], 0.9),
        ("chord", [2, 3, 2], 0.6),
    ] {
        let problem = parsed(&moving(&by_functions(frame, modes), part));
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        let found = bases::errors(&problem, &at, &[1]).expect("runs");
        let off = (found[0].value - at_rest(part)).abs();
        let ratio = off / found[0].error();
        println!(
            "{frame} {modes:?} {part}: {off:.2e} of {:.2e}, {ratio}",
            found[0].value
        );
        assert!(
            ratio > 1.0 / 3.0 && ratio < 3.0,
            "{frame} {modes:?}: {ratio}"
        );
    }
}

/// More functions leave a given start as it is: its kinetic and its strain energy, of twists so small that Wagner's strain
/// is not seen.
#[test]
fn more_functions_keep_the_start() {
    for (modes, coordinates) in [
        ([2, 2, 1], vec![1e-3, 2e-3, 3e-3, -1e-3, 0.02, 1e-6]),
        ([1, 3, 0], vec![1e-3, 2e-3, 3e-3, -1e-3, 2e-6]),
        ([0, 2, 2], vec![4e-3, 2e-3, 1e-4, 3e-4, 1e-6]),
        ([3, 0, 0], vec![1e-3, 2e-3, -5e-3, 1e-6]),
        ([2, 1, 2], vec![1e-3; 6]),
        ([0, 0, 3], vec![1e-4, -2e-4, 3e-4, 1e-6]),
    ] {
        let mut document = moving(&by_functions("clamped", modes), 0.0);
        document["start"] = json!("given");
        document["bodies"]["p"]["beam"]["modes"]["stretch"] = json!(1);
        document["bodies"]["p"]["beam"]["start"] =
            json!({"coordinates": coordinates, "rates": coordinates});
        document["simulation"] =
            json!({"duration": 1e-13, "steps": 1, "method": {"radau": {"stages": 2}}});
        document["functions"] = json!({
            "T": {"final": {"energy": "kinetic"}}, "U": {"final": {"strain_energy": {"body": "p"}}}
        });
        let problem = parsed(&document);
        let at = Evaluated::new(&problem, &problem.start()).expect("runs");
        for own in bases::errors(&problem, &at, &[0, 1]).expect("runs") {
            assert!(own.error() < 1e-5 * own.value.abs(), "{modes:?}: {own:?}");
        }
    }
}
