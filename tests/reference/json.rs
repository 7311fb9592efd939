//! JSON documents in the tests. The macro of `serde_json` builds nested maps in place: each of their parts must be
//! dropped if a later one panics, which made a quarter of the code of the tests. This one calls one plain function a
//! token.

use serde::Serialize;
use serde_json::{Map, Value};

/// Builds a value from its tokens, in their order.
#[derive(Default)]
pub(crate) struct Writer {
    /// The open arrays and objects, outermost first, and the key that each has in its parent.
    open: Vec<(Option<String>, Value)>,
    /// The key of the next value.
    key: Option<String>,
    done: Value,
}

impl Writer {
    pub(crate) fn array(&mut self) {
        self.open.push((self.key.take(), Value::Array(Vec::new())));
    }

    pub(crate) fn object(&mut self) {
        self.open.push((self.key.take(), Value::Object(Map::new())));
    }

    pub(crate) fn key(&mut self, key: &(impl AsRef<str> + ?Sized)) {
        self.key = Some(key.as_ref().to_owned());
    }

    pub(crate) fn value(&mut self, value: &(impl Serialize + ?Sized)) {
        self.push(serde_json::to_value(value).expect("is JSON"));
    }

    /// Ends the innermost array or object.
    pub(crate) fn end(&mut self) {
        let (key, value) = self.open.pop().expect("is open");
        self.key = key;
        self.push(value);
    }

    fn push(&mut self, value: Value) {
        match self.open.last_mut() {
            Some((_, Value::Array(values))) => values.push(value),
            Some((_, Value::Object(values))) => {
                values.insert(self.key.take().expect("a key"), value);
            }
            _ => self.done = value,
        }
    }

    pub(crate) fn finish(self) -> Value {
        self.done
    }
}

/// A [`serde_json::Value`] from JSON with Rust expressions as values and, in parentheses, as keys.
macro_rules! json {
    ($($tokens:tt)+) => {{
        let mut writer = $crate::json::Writer::default();
        write_json!(writer $($tokens)+);
        writer.finish()
    }};
}

/// One value: `write_json!(writer value)`.
macro_rules! write_json {
    ($writer:ident null) => {
        $writer.value(&())
    };
    ($writer:ident [ $($tokens:tt)* ]) => {
        $writer.array();
        write_items!($writer $($tokens)*);
        $writer.end();
    };
    ($writer:ident { $($tokens:tt)* }) => {
        $writer.object();
        write_entries!($writer $($tokens)*);
        $writer.end();
    };
    ($writer:ident $value:expr) => {
        $writer.value(&$value)
    };
}

/// The values of an array, with commas between them: JSON is one token, an expression may be several.
macro_rules! write_items {
    ($writer:ident) => {};
    ($writer:ident $value:tt $(, $($rest:tt)*)?) => {
        write_json!($writer $value);
        $(write_items!($writer $($rest)*);)?
    };
    ($writer:ident $value:expr $(, $($rest:tt)*)?) => {
        write_json!($writer $value);
        $(write_items!($writer $($rest)*);)?
    };
}

/// The entries `key: value` of an object, with commas between them.
macro_rules! write_entries {
    ($writer:ident) => {};
    ($writer:ident $key:tt : $value:tt $(, $($rest:tt)*)?) => {
        $writer.key(&$key);
        write_json!($writer $value);
        $(write_entries!($writer $($rest)*);)?
    };
    ($writer:ident $key:tt : $value:expr $(, $($rest:tt)*)?) => {
        $writer.key(&$key);
        write_json!($writer $value);
        $(write_entries!($writer $($rest)*);)?
    };
}
