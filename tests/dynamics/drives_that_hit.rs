//! Notes on drives that start at speed while their bodies rest: which joint, by how much, and the energy of the impulse.

use crate::reference::documents::problem as parsed;
use flexbody_driver::start::notes;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

fn notes_of(document: &Value) -> Vec<String> {
    let problem = parsed(document);
    let notes = notes(&problem, &problem.start());
    notes
        .into_iter()
        .filter(|note| note.contains("impulse"))
        .collect()
}

/// An arm of 12 kg m² about its axle, or a beam, on a joint with a drive.
fn scene(body: &Value, joint: Value, drive: Value) -> Value {
    json!({
        "version": 1, "name": "arm", "gravity": [0, 0, 0], "bodies": {"arm": body}, "joints": {"axle": joint},
        "drives": {"motor": drive}, "simulation": {"duration": 0.01}
    })
}

fn hinge() -> Value {
    json!({"revolute": {"between": ["arm", "ground"], "at": "arm.start", "axis": [0, 0, 1]}})
}

/// J = 3 · (1 + 0.01)/12 + 3 · 0.25 about the end of the box, turned at once to 4 rad/s: 8.0 J · … of energy.
#[test]
fn impulses_of_drives_are_told() {
    let arm = json!({"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 3, "points": {"start": [-0.5, 0, 0]}});
    let turn = json!({"joint": "axle", "turn": {"polynomial": [0, 4]}});
    let told = notes_of(&scene(&arm, hinge(), turn.clone()));
    let energy = 0.5 * 16.0 * (3.0 * 1.01 / 12.0 + 0.75);
    let expected = format!("from 0 J to {energy:.4} J");
    assert!(
        told.len() == 1 && told[0].contains("\"axle\"") && told[0].contains("4.0000 rad/s"),
        "{told:?}"
    );
    assert!(told[0].contains(&expected), "{told:?} {expected}");

    // A slide by a harmonic motion, m a ω = 0.2 · 2π 3 m/s.
    let slide =
        json!({"prismatic": {"between": ["arm", "ground"], "at": [0, 0, 0], "axis": [1, 1, 0]}});
    let shake = json!({"joint": "axle", "slide": {"harmonic": {"amplitude": 0.2, "frequency": 3}}});
    let told = notes_of(&scene(&arm, slide.clone(), shake));
    assert!(
        told.len() == 1 && told[0].contains("3.7699 m/s"),
        "{told:?}"
    );

    // A drive that starts at rest, and one whose body has its velocity.
    let cosine = json!({"joint": "axle", "slide": {"polynomial": [0, 0, 2]}});
    assert!(notes_of(&scene(&arm, slide.clone(), cosine)).is_empty());
    let at_its_end = json!({"joint": "axle", "slide": {"harmonic": {"amplitude": 0.2, "frequency": 3, "phase": FRAC_PI_2}}});
    assert!(notes_of(&scene(&arm, slide.clone(), at_its_end)).is_empty());
    let mut moving = scene(&arm, hinge(), turn.clone());
    moving["bodies"]["arm"]["velocity"] = json!({"linear": [0, 2, 0], "angular": [0, 0, 4]});
    assert!(notes_of(&moving).is_empty(), "{:?}", notes_of(&moving));
    moving["bodies"]["arm"]["velocity"] = json!({"linear": [0, 1, 0], "angular": [0, 0, 2]});
    let told = notes_of(&moving);
    assert!(
        told.len() == 1 && told[0].contains("by 2.0000 rad/s"),
        "{told:?}"
    );

    // A flexible arm; in equilibrium it turns with the drive.
    let beam = json!({"beam": {"length": 1, "section": {"rectangle": {"height": 0.1, "width": 0.1}},
                               "material": {"young": 7e10, "density": 2700}}, "place": {"put": "start"}});
    let mut flexible = scene(&beam, hinge(), turn);
    let told = notes_of(&flexible);
    assert!(
        told.len() == 1 && told[0].contains("\"axle\"") && told[0].contains("4.0000 rad/s"),
        "{told:?}"
    );
    flexible["start"] = json!("equilibrium");
    assert!(notes_of(&flexible).is_empty());
}
