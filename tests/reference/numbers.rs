//! The numbers of a problem file that may be designed.

use serde_json::Value;

/// Adds the paths to all numbers below `value`, which stands at `at`; the instants of tables keep their
/// order and are left out.
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
