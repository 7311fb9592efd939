//! A use of a part, and the names that its entries have in the machine.

use super::frame::Frame;
use crate::derived::parameter_of;
use crate::placement::{GROUND, split_location};
use serde_json::{Map, Value};
use std::collections::HashSet;

/// A use while it is written.
pub struct Used<'a> {
    pub name: &'a str,
    pub part: &'a Value,
    /// Pointers to the use and its part.
    pub at: String,
    pub from: String,
    pub connect: Map<String, Value>,
    pub frame: Frame,
    /// Names of bodies that the part mentions.
    pub mentioned: HashSet<String>,
}

impl Used<'_> {
    /// Whether the part has an entry of this name.
    pub fn has(&self, section: &str, name: &str) -> bool {
        self.part[section].get(name).is_some()
    }

    /// A body in the machine by its name in the part.
    pub fn body(&mut self, name: &str) -> String {
        if self.has("bodies", name) {
            return parameter_of(self.name, name);
        }
        if name == GROUND {
            return name.to_owned();
        }
        self.mentioned.insert(name.to_owned());
        let connected = self.connect.get(name).and_then(Value::as_str);
        connected.unwrap_or(name).to_owned()
    }

    /// Renames a body.
    pub fn rename_body(&mut self, value: Option<&mut Value>) {
        if let Some(Value::String(name)) = value {
            *name = self.body(name);
        }
    }

    /// Renames the body of `"body.point"`.
    pub fn rename_location(&mut self, value: Option<&mut Value>) {
        if let Some(Value::String(text)) = value {
            let (body, point) = split_location(text);
            let body = self.body(body);
            *text = point.map_or(body.clone(), |point| format!("{body}.{point}"));
        }
    }

    /// Renames a joint.
    pub fn rename_joint(&self, value: Option<&mut Value>) {
        if let Some(Value::String(name)) = value
            && self.has("joints", name)
        {
            *name = parameter_of(self.name, name);
        }
    }
}
