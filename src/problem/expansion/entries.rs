//! The bodies, joints, loads, drives and couplings of a use: their names and places in the machine.

use super::used::Used;
use super::writer::Writer;
use crate::derived::parameter_of;
use crate::finding::Finding;
use crate::joints::farthest;
use crate::placement::GROUND;
use crate::pointer::join;
use serde_json::{Map, Value};

/// Directions in ground axes of loads, beside `direction`, which may have others.
const DIRECTIONS: &[&[&str]] = &[
    &["normal"],
    &["half"],
    &["wheel", "axis"],
    &["surface", "plane", "normal"],
    &["surface", "capsule", "half"],
    &["surface", "height_field", "normal"],
    &["surface", "height_field", "direction"],
];

impl Writer<'_> {
    /// Moves a vector of the part: a point, or a direction.
    fn moved(&mut self, used: &Used, value: Option<&mut Value>, pointer: &str, is_point: bool) {
        let Some(value) = value.filter(|value| value.is_array()) else {
            return;
        };
        if used.frame.is_ground() || (!is_point && used.frame.rotation.is_none()) {
            return;
        }
        let from = self.origins.resolve(pointer);
        if let Some(own) = self.triple(value, &from, Some(used.name)) {
            let moved = match is_point {
                true => used.frame.point(own),
                false => used.frame.direction(own),
            };
            *value = self.put(pointer, moved);
        }
    }

    /// Writes one entry of a part.
    pub fn entry(&mut self, used: &mut Used, section: &str, key: &str, entry: &Value) {
        let full = parameter_of(used.name, key);
        let pointer = join(&format!("/{section}"), &full);
        if self.section(section).contains_key(&full) {
            let found = format!("\"{full}\" of {section} a second time");
            let expected = "a use whose names the machine does not have";
            self.findings
                .push(Finding::new(&used.at, found, expected).of_key());
            return;
        }
        let from = join(&join(&used.from, section), key);
        self.origin(pointer.clone(), from, used.name, Some(used.name));
        let mut entry = entry.clone();
        match section {
            "bodies" => self.body(used, &mut entry, &pointer),
            "drives" => used.rename_joint(entry.get_mut("joint")),
            "couplings" => {
                for (kind, inner) in entry.as_object_mut().into_iter().flatten() {
                    self.coupling(used, inner, &join(&pointer, kind));
                }
            }
            _ => {
                for (kind, inner) in entry.as_object_mut().into_iter().flatten() {
                    let pointer = join(&pointer, kind);
                    self.joint_or_load(used, inner, &pointer);
                }
            }
        }
        self.section(section).insert(full, entry);
    }

    /// Places a body.
    fn body(&mut self, used: &mut Used, body: &mut Value, pointer: &str) {
        let velocity = join(pointer, "velocity");
        for key in ["linear", "angular"] {
            let own = body.get_mut("velocity").and_then(|own| own.get_mut(key));
            self.moved(used, own, &join(&velocity, key), false);
        }
        let at = join(pointer, "place");
        let Value::Object(body) = body else { return };
        let place = body
            .entry("place")
            .or_insert_with(|| Value::Object(Map::new()));
        let Value::Object(place) = place else { return };
        match place.get_mut("at") {
            None => {
                if let Some(origin) = used.frame.place.clone() {
                    let pointer = join(&at, "at");
                    self.origin(pointer.clone(), join(&used.at, "at"), used.name, None);
                    let value = self.put(&pointer, origin);
                    place.insert("at".to_owned(), value);
                }
            }
            Some(Value::String(_)) => used.rename_location(place.get_mut("at")),
            own => self.moved(used, own, &join(&at, "at"), true),
        }
        used.rename_body(place.get_mut("relative_to").filter(|own| *own != GROUND));
        let from_ground = place.get("relative_to").is_none_or(|own| own == GROUND);
        if !from_ground || used.frame.turns.is_empty() {
            return;
        }
        let turn = join(&at, "turn");
        let mut turns = match place.shift_remove("turn") {
            Some(Value::Array(list)) => list,
            Some(one) => {
                let from = self.origins.resolve(&turn);
                self.origin(join(&turn, 0), from, used.name, Some(used.name));
                vec![one]
            }
            None => Vec::new(),
        };
        for (own, from) in used.frame.turns.clone() {
            self.origin(join(&turn, turns.len()), from, used.name, None);
            turns.push(own);
        }
        place.insert("turn".to_owned(), Value::Array(turns));
    }

    /// Renames what a coupling names, and moves the place where teeth meet.
    fn coupling(&mut self, used: &mut Used, entry: &mut Value, pointer: &str) {
        for key in ["gears", "pulleys"] {
            let bodies = entry.get_mut(key).and_then(Value::as_array_mut);
            for body in bodies.into_iter().flatten() {
                used.rename_body(Some(body));
            }
        }
        for key in ["rack", "pinion"] {
            used.rename_body(entry.get_mut(key));
        }
        used.rename_body(entry.get_mut("carrier").filter(|own| *own != GROUND));
        used.rename_joint(entry.get_mut("joint"));
        let terms = entry.get_mut("terms").and_then(Value::as_array_mut);
        for term in terms.into_iter().flatten() {
            used.rename_joint(term.get_mut("joint"));
        }
        for key in ["cam", "follower"] {
            let motions = entry.get_mut(key).and_then(Value::as_object_mut);
            for joint in motions.into_iter().flat_map(|own| own.values_mut()) {
                used.rename_joint(Some(joint));
            }
        }
        match entry.get_mut("at") {
            own @ Some(Value::String(_)) => used.rename_location(own),
            own => self.moved(used, own, &join(pointer, "at"), true),
        }
    }

    /// Renames and moves what a joint or a load names.
    fn joint_or_load(&mut self, used: &mut Used, entry: &mut Value, pointer: &str) {
        let mut on_ground = [false; 2];
        let between = entry.get_mut("between").and_then(Value::as_array_mut);
        for (k, name) in between.into_iter().flatten().enumerate() {
            used.rename_body(Some(&mut *name));
            if let Some(side) = on_ground.get_mut(k) {
                *side = name == GROUND;
            }
        }
        used.rename_body(entry.get_mut("body"));
        used.rename_joint(entry.get_mut("joint"));
        let of_controller = ["feedback", "gravity_compensation"].map(|key| {
            let list = entry.get(key).and_then(Value::as_array);
            list.map_or(0, Vec::len)
        });
        for k in 0..of_controller[0] {
            used.rename_joint(entry["feedback"][k].get_mut("joint"));
        }
        for k in 0..of_controller[1] {
            used.rename_body(entry["gravity_compensation"][k].get_mut("body"));
        }
        let points = entry.get_mut("points").and_then(Value::as_array_mut);
        for (k, point) in points.into_iter().flatten().enumerate() {
            used.rename_body(point.get_mut("body"));
            if point.get("body").is_some_and(|body| body == GROUND) {
                let place = join(&join(&join(pointer, "points"), k), "point");
                self.moved(used, point.get_mut("point"), &place, true);
            }
        }
        let at = join(pointer, "at");
        match entry.get_mut("at") {
            own @ Some(Value::String(_)) => used.rename_location(own),
            Some(Value::Object(pair)) => {
                for (k, side) in ["a", "b"].into_iter().enumerate() {
                    if on_ground[k] {
                        self.moved(used, pair.get_mut(side), &join(&at, side), true);
                    }
                }
            }
            Some(Value::Array(items)) if items.iter().all(Value::is_array) => {
                for (k, item) in items.iter_mut().enumerate() {
                    self.moved(used, Some(item), &join(&at, k), true);
                }
            }
            own => self.moved(used, own, &at, true),
        }
        if pointer.ends_with("/free") && used.frame.rotation.is_some() {
            write_axes(entry);
        }
        for key in ["axis", "cross"] {
            match entry.get_mut(key) {
                Some(Value::Object(of_body)) => used.rename_body(of_body.get_mut("body")),
                own => self.moved(used, own, &join(pointer, key), false),
            }
        }
        let is_box = (entry.get("surface")).is_some_and(|own| own.get("box").is_some());
        if is_box && on_ground[1] && used.frame.rotation.is_some() {
            let found = "a box of ground, which has its axes, in a part that is turned";
            let finding = Finding::new(join(pointer, "surface"), found, "a box of a body");
            self.findings.push(finding);
        }
        for path in DIRECTIONS {
            let mut own = Some(&mut *entry);
            let mut place = pointer.to_owned();
            for key in *path {
                own = own.and_then(|own| own.get_mut(key));
                place = join(&place, key);
            }
            self.moved(used, own, &place, false);
        }
        if entry.get("axes").is_none_or(|axes| axes == GROUND) {
            let direction = join(pointer, "direction");
            self.moved(used, entry.get_mut("direction"), &direction, false);
        }
    }
}

/// Writes the axes that a free joint has by default, so that they turn with it: the third ground axis, and the one that is
/// farthest from its axis.
fn write_axes(joint: &mut Value) {
    let Value::Object(joint) = joint else { return };
    let axis = joint
        .entry("axis")
        .or_insert_with(|| [0.0, 0.0, 1.0].into());
    let numbers = axis.as_array().into_iter().flatten();
    let numbers: Vec<f64> = numbers.filter_map(Value::as_f64).collect();
    let [x, y, z] = numbers[..] else { return };
    let mut cross = [0.0; 3];
    cross[farthest([x, y, z])] = 1.0;
    joint.entry("cross").or_insert_with(|| cross.into());
}
