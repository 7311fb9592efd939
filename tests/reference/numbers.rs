//! Numbers of a problem file that can be design variables.

use serde_json::Value;

/// Adds the paths of all numbers below `value`, which is at `at`. Instants of tables keep their
/// order and are omitted.
pub fn numbers(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Number(_) => out.push(at.to_owned()),
        Value::Array(items) => {
            for (k, item) in items.iter().enumerate() {
                numbers(item, &format!("{at}/{k}"), out);
            }
        }
        Value::Object(entries) => {
            for (key, item) in entries {
                if key != "times" {
                    numbers(item, &format!("{at}/{key}"), out);
                }
            }
        }
        _ => {}
    }
}
