//! Malformed files with bodies of finite elements: every value replaced by others, and what such bodies may not be.

use super::pointers;
use crate::element_parts::stiffened;
use crate::reference::documents::plates;
use crate::reference::documents::read;
use flexbody_problem::Problem;
use serde_json::Value;

fn two_plates() -> Value {
    plates([2, 1], 0.1, 10, &json!({"bdf": {"order": 2}}))
}

/// Plates with stiffeners, masses and damping, one in a reduced basis, and a beam of elements.
fn parts() -> Value {
    let mut file = stiffened([2, 1], 0.1, 10, &json!({"bdf": {"order": 2}}));
    file["bodies"]["second"]["elements"]["basis"] = json!({"reduced": {"modes": 2}});
    file["bodies"]["beam"] = json!({
        "elements": {
            "structure": {
                "mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 0, 1], "elements": 2}},
                "material": "aluminium",
                "section": {"rectangle": {"width": 0.02, "height": 0.01}},
                "masses": {"tip": {"nodes": "end", "mass": 0.2}},
            },
            "frame": {"clamped": "start"},
            "points": {"root": {"node": "start"}, "tip": {"node": "end"}},
        },
        "place": {"put": "root", "at": [0, 0, 3]},
    });
    file
}

/// Number of sound and of refused files after replacing every value of a file by others.
fn replaced(file: &Value) -> [usize; 2] {
    let mut list = Vec::new();
    pointers(file, "", &mut list);
    let others = [
        json!(null),
        json!(-1),
        json!(0),
        json!(1e300),
        json!("x0"),
        json!([]),
        json!({}),
    ];
    let mut count = [0; 2];
    for pointer in &list {
        for other in &others {
            let mut changed = file.clone();
            *changed.pointer_mut(pointer).expect("a value") = other.clone();
            match Problem::parse(&changed.to_string(), "plates.json", &[]) {
                Ok(problem) => {
                    let scene = problem.scene(&problem.start());
                    let finite = scene.parameters().iter().all(|x| x.is_finite());
                    assert!(finite, "{pointer} = {other}");
                    count[0] += 1;
                }
                Err(faults) => {
                    assert!(!faults.list.is_empty(), "{pointer} = {other}");
                    count[1] += 1;
                }
            }
        }
    }
    count
}

#[test]
fn every_value_of_plates_replaced_is_a_fault_or_a_finite_scene() {
    let [sound, wrong] = replaced(&two_plates());
    assert!(sound > 50 && wrong > 500, "{sound} {wrong}");
}

#[test]
fn every_value_of_beams_and_stiffeners_replaced_is_a_fault_or_a_finite_scene() {
    let [sound, wrong] = replaced(&parts());
    assert!(sound > 50 && wrong > 500, "{sound} {wrong}");
}

#[test]
fn every_value_of_a_panel_that_deploys_replaced_is_a_fault_or_a_finite_scene() {
    let mut file = read("problems/flexible/solar_panel.json");
    for (_, body) in file["bodies"].as_object_mut().expect("bodies") {
        if let Some(plate) = body.pointer_mut("/elements/structure/mesh/plate") {
            plate["elements"] = json!([2, 1]);
        }
    }
    let [sound, wrong] = replaced(&file);
    assert!(sound > 50 && wrong > 500, "{sound} {wrong}");
}

/// The message about a file, of one line.
fn told(file: &Value) -> String {
    match Problem::parse(&file.to_string(), "plates.json", &[]) {
        Ok(_) => "sound".into(),
        Err(faults) => faults.to_string(),
    }
}

#[test]
fn a_faulty_material_is_told_once() {
    for (key, value) in [
        ("poisson", json!(0.7)),
        ("young", json!(-1)),
        ("density", json!(-3)),
        ("yung", json!(1)),
    ] {
        let mut file = two_plates();
        file["materials"]["aluminium"][key] = value;
        let told = told(&file);
        assert_eq!(told.matches("found").count(), 1, "{told}");
        assert!(
            told.contains(&format!("/materials/aluminium/{key}")),
            "{told}"
        );
    }
}

#[test]
fn a_frame_holds_some_nodes_and_not_all() {
    let frame = |set: &str, frame: &str| {
        let mut file = two_plates();
        let own = &mut file["bodies"]["second"]["elements"];
        own["frame"] = json!({frame: set});
        told(&file)
    };
    let one = frame("start", "clamped");
    assert!(
        one.contains("one node of a shell, about whose normal the body turns"),
        "{one}"
    );
    let all = frame("all", "clamped");
    assert!(all.contains("a set of all nodes"), "{all}");
    assert_eq!(frame("x0", "clamped"), "sound");
}

#[test]
fn the_stress_of_a_rigid_body_limits_nothing() {
    let mut file = two_plates();
    file["bodies"]["first"]["elements"]["basis"] = json!("rigid");
    assert_eq!(told(&file), "sound");
    file["objective"] = json!({"minimise": "tip x"});
    assert_eq!(told(&file), "sound");
    file["constraints"] = json!({"strong": {"function": "stress 1", "upper": 1}});
    let told = told(&file);
    assert!(
        told.contains("\"first\", whose \"basis\" is \"rigid\""),
        "{told}"
    );
}
