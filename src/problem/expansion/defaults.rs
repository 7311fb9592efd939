//! Keys that bodies and joints have unless they give their own.

use crate::origins::{Origin, Origins};
use crate::pointer::join;
use serde_json::{Map, Value};

/// What a body is made of.
const MADE_OF: [&str; 9] = [
    "shape",
    "density",
    "mass",
    "centre_of_mass",
    "inertia",
    "mass_properties",
    "beam",
    "elements",
    "modal",
];

/// By key of a body: defaults that it rules out.
fn ruled_out(key: &str) -> &'static [&'static str] {
    match key {
        "beam" | "elements" | "modal" | "mass_properties" => &MADE_OF,
        "inertia" => &[
            "shape",
            "density",
            "mass_properties",
            "beam",
            "elements",
            "modal",
        ],
        "shape" => &[
            "inertia",
            "centre_of_mass",
            "mass_properties",
            "beam",
            "elements",
            "modal",
        ],
        "mass" => &["density"],
        "density" => &["mass", "inertia"],
        _ => &[],
    }
}

/// The keys that a kind of joint has in the schema.
fn keys_of_joint<'a>(schema: &'a Value, kind: &str) -> Option<&'a Map<String, Value>> {
    let follow = |own: &'a Value| match own["$ref"].as_str().and_then(|own| own.strip_prefix('#')) {
        Some(pointer) => schema.pointer(pointer).unwrap_or(&Value::Null),
        None => own,
    };
    let joint = follow(schema.pointer("/properties/joints/additionalProperties")?);
    let choices = joint["oneOf"].as_array()?.iter();
    let own = choices.map(|choice| &choice["properties"][kind]);
    follow(own.into_iter().find(|own| own.is_object())?)["properties"].as_object()
}

/// Adds defaults to the bodies and joints of the entries at `pointer`.
fn add(
    entries: &mut Value,
    pointer: &str,
    (defaults, schema): (&Value, &Value),
    origins: &mut Origins,
) {
    let mut put =
        |object: &mut Map<String, Value>, at: &str, key: &String, value: &Value, section: &str| {
            object.insert(key.clone(), value.clone());
            let from = join(&format!("/defaults/{section}"), key);
            let origin = Origin {
                pointer: from,
                used: None,
                scope: None,
            };
            origins.add(join(at, key), origin);
        };
    let none = Map::new();
    let of = |section: &str| defaults[section].as_object().unwrap_or(&none);
    let bodies = entries.get_mut("bodies").and_then(Value::as_object_mut);
    for (name, body) in bodies.into_iter().flatten() {
        let at = join(&join(pointer, "bodies"), name);
        let Value::Object(body) = body else { continue };
        let out: Vec<&str> = body
            .keys()
            .flat_map(|key| ruled_out(key))
            .copied()
            .collect();
        for (key, value) in of("bodies") {
            if !body.contains_key(key) && !out.contains(&key.as_str()) {
                put(body, &at, key, value, "bodies");
            }
        }
    }
    let joints = entries.get_mut("joints").and_then(Value::as_object_mut);
    for (name, joint) in joints.into_iter().flatten() {
        for (kind, joint) in joint.as_object_mut().into_iter().flatten() {
            let at = join(&join(&join(pointer, "joints"), name), kind);
            let (Value::Object(joint), Some(keys)) = (joint, keys_of_joint(schema, kind)) else {
                continue;
            };
            for (key, value) in of("joints") {
                if !joint.contains_key(key) && keys.contains_key(key) {
                    put(joint, &at, key, value, "joints");
                }
            }
        }
    }
}

/// Adds the defaults of a document to its bodies and joints, and to those of its parts.
pub fn apply(document: &mut Value, schema: &Value, origins: &mut Origins) {
    let Some(defaults) = document.get("defaults").cloned() else {
        return;
    };
    let from = (&defaults, schema);
    add(document, "", from, origins);
    let parts = document.get_mut("parts").and_then(Value::as_object_mut);
    for (name, part) in parts.into_iter().flatten() {
        add(part, &join("/parts", name), from, origins);
    }
}
