//! Changes of a document by `--set PATH=VALUE`.

use super::finding::Finding;
use super::pointer::{advice, all, is_below, join, nearest, nearest_pointer};
use serde_json::Value;
use std::fmt;

/// A value that replaces one in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// JSON Pointer to the value.
    pub path: String,
    /// The new value.
    pub value: Value,
}

/// The reason why a text is not an override.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OverrideError {
    /// There is no equals sign.
    #[error("found {0:?}, expected PATH=VALUE such as /bodies/arm/mass=35")]
    NoValue(String),
    /// The path is not a JSON Pointer.
    #[error("found the path {0:?}, expected a JSON Pointer such as /bodies/arm/mass")]
    NoPointer(String),
}

impl Override {
    /// Reads `PATH=VALUE`: a JSON Pointer, and JSON. Text that is not JSON is taken as a string.
    ///
    /// # Errors
    /// The text has no equals sign, or its path does not begin with a slash.
    pub fn parse(text: &str) -> Result<Self, OverrideError> {
        let (path, value) = text
            .split_once('=')
            .ok_or_else(|| OverrideError::NoValue(text.to_owned()))?;
        if !path.starts_with('/') {
            return Err(OverrideError::NoPointer(path.to_owned()));
        }
        Ok(Self {
            path: path.to_owned(),
            value: serde_json::from_str(value).unwrap_or_else(|_| Value::from(value)),
        })
    }

    /// True if the value at `pointer` comes from this override.
    pub(super) fn holds(&self, pointer: &str) -> bool {
        is_below(pointer, &self.path)
    }

    /// Replaces the value in `document`.
    pub(super) fn apply(&self, document: &mut Value) -> Result<(), Finding> {
        if let Some(place) = document.pointer_mut(&self.path) {
            *place = self.value.clone();
            return Ok(());
        }
        // A key with a default may be missing. The schema decides whether the key exists.
        if let Some((above, key)) = self.path.rsplit_once('/')
            && let Some(Value::Object(object)) = document.pointer_mut(above)
        {
            let key = key.replace("~1", "/").replace("~0", "~");
            object.insert(key, self.value.clone());
            return Ok(());
        }
        let hint = nearest_path(&self.path, document);
        Err(Finding::new(
            &self.path,
            "nothing at this path",
            "the path of a value of the file",
        )
        .hint(hint))
    }
}

/// Advice about a path that does not exist: the nearest path, or the keys at its last valid part.
pub(super) fn nearest_path(path: &str, document: &Value) -> Option<String> {
    let paths = all(document);
    if let Some(near) = nearest_pointer(path, paths.iter().map(String::as_str)) {
        return Some(format!("did you mean {near}?"));
    }
    let mut above = path;
    while let Some((shorter, wrong)) = above.rsplit_once('/') {
        if let Some(Value::Object(object)) = document.pointer(shorter) {
            let place = if shorter.is_empty() {
                "the file"
            } else {
                shorter
            };
            let keys = object.keys().map(String::as_str);
            return match nearest(wrong, keys.clone()) {
                Some(key) => Some(format!("did you mean {}?", join(shorter, key))),
                None => advice(wrong, &format!("keys of {place}"), keys),
            };
        }
        above = shorter;
    }
    None
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.path, self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_are_read() {
        let change = Override::parse("/bodies/arm/mass=35").expect("an override");
        assert_eq!(
            (change.path.as_str(), &change.value),
            ("/bodies/arm/mass", &Value::from(35))
        );
        let text = Override::parse("/name=light arm").expect("an override");
        assert_eq!(text.value, Value::from("light arm"));
        assert_eq!(
            Override::parse("/bodies/arm/mass")
                .expect_err("no value")
                .to_string(),
            "found \"/bodies/arm/mass\", expected PATH=VALUE such as /bodies/arm/mass=35"
        );
        assert_eq!(
            Override::parse("mass=3")
                .expect_err("no pointer")
                .to_string(),
            "found the path \"mass\", expected a JSON Pointer such as /bodies/arm/mass"
        );
    }
}
