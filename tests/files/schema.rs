//! The schema of problem files.

use flexbody_problem::schema;
use serde_json::Value;

/// Calls `judge` with the pointer and the schema of every property below `schema`.
fn properties(schema: &Value, at: &str, judge: &mut impl FnMut(&str, &Value)) {
    let properties_of = schema["properties"].as_object();
    for (key, property) in properties_of.into_iter().flatten() {
        judge(&format!("{at}/{key}"), property);
    }
    let object = schema.as_object().into_iter().flatten();
    for (key, value) in object {
        properties(value, &format!("{at}/{key}"), judge);
    }
    let list = schema.as_array().into_iter().flatten();
    for (k, value) in list.enumerate() {
        properties(value, &format!("{at}/{k}"), judge);
    }
}

#[test]
fn the_schema_describes_every_key_and_says_of_every_number_what_it_is() {
    let mut numbers = 0;
    properties(schema(), "", &mut |at, property| {
        // The single key of an alternative is described with the alternative.
        let described = property["description"].is_string();
        assert!(described || at.contains("oneOf"), "{at} has no description");
        let mut number = property;
        for inner in ["additionalProperties", "items"] {
            if number[inner].is_object() {
                number = &number[inner];
            }
        }
        if number["type"] == "number" || number["type"] == "integer" {
            numbers += 1;
            let open = &number["design_variable"];
            assert!(*open == true || open.is_string(), "{at}: {number}");
            assert!(
                *open != true || number["unit"].is_string(),
                "{at} has no unit"
            );
        }
    });
    assert!(numbers > 40, "{numbers}");
    assert!(!schema().to_string().contains("\"null\""));
}
