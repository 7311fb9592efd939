//! JSON Pointers (RFC 6901), and the nearest of several names.

use serde_json::Value;

/// The pointer to `key` below `pointer`.
pub fn join(pointer: &str, key: impl std::fmt::Display) -> String {
    let key = key.to_string().replace('~', "~0").replace('/', "~1");
    format!("{pointer}/{key}")
}

/// The keys along a pointer.
pub fn keys(pointer: &str) -> Vec<String> {
    pointer
        .split('/')
        .skip(1)
        .map(|key| key.replace("~1", "/").replace("~0", "~"))
        .collect()
}

/// True if `pointer` is `above` or below it.
pub fn is_below(pointer: &str, above: &str) -> bool {
    pointer
        .strip_prefix(above)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Pointers to every value of a document except its root.
pub fn all(value: &Value) -> Vec<String> {
    fn collect(value: &Value, pointer: &str, list: &mut Vec<String>) {
        if !pointer.is_empty() {
            list.push(pointer.to_owned());
        }
        match value {
            Value::Object(object) => {
                for (key, inner) in object {
                    collect(inner, &join(pointer, key), list);
                }
            }
            Value::Array(items) => {
                for (k, inner) in items.iter().enumerate() {
                    collect(inner, &join(pointer, k), list);
                }
            }
            _ => {}
        }
    }
    let mut list = Vec::new();
    collect(value, "", &mut list);
    list
}

/// Pointer to a parameter.
pub fn of_parameter(name: &str) -> String {
    join("/parameters", name)
}

/// Edit distance of two names, without case and separators; `None` if it exceeds a third of the
/// characters of `wanted`.
fn distance(wanted: &str, name: &str) -> Option<usize> {
    let plain = |name: &str| name.to_lowercase().replace(['_', '-', ' '], "");
    let (wanted, name) = (plain(wanted), plain(name));
    let limit = (wanted.chars().count() / 3).max(1);
    Some(strsim::damerau_levenshtein(&wanted, &name)).filter(|distance| *distance <= limit)
}

/// The name nearest to `wanted`, if one is near.
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names
        .into_iter()
        .filter_map(|name| Some((distance(wanted, name)?, name)))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// The pointer nearest to `wanted`, if one is near: each key is near its counterpart, or keys in
/// between are missing.
pub fn nearest_pointer<'a>(
    wanted: &str,
    pointers: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    let wanted = keys(wanted);
    let apart = |pointer: &str| {
        let keys = keys(pointer);
        let pairs = wanted.iter().zip(&keys);
        let sum = pairs
            .map(|(wanted, key)| distance(wanted, key))
            .sum::<Option<usize>>()?;
        (keys.len() == wanted.len()).then_some(sum)
    };
    let leaves_out = |pointer: &str| {
        let keys = keys(pointer);
        let mut rest = keys.iter();
        wanted.iter().all(|wanted| rest.any(|key| key == wanted)) && wanted.last() == keys.last()
    };
    let near = pointers
        .clone()
        .filter_map(|pointer| Some((apart(pointer)?, pointer)));
    near.min_by_key(|(distance, _)| *distance)
        .map(|(_, pointer)| pointer)
        .or_else(|| pointers.clone().find(|pointer| leaves_out(pointer)))
}

/// Advice about a wrong name: the nearest valid one, or all; `what` is their kind.
pub fn advice<'a>(
    wanted: &str,
    what: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    let names: Vec<&str> = names.into_iter().collect();
    Some(match nearest(wanted, names.iter().copied()) {
        Some(name) => format!("did you mean \"{name}\"?"),
        None if names.is_empty() => format!("there are no {what}"),
        None => format!("{what} are: {}", names.join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_escaped_and_read_back() {
        let pointer = join(&join("", "a/b"), "c~d");
        assert_eq!(pointer, "/a~1b/c~0d");
        assert_eq!(keys(&pointer), ["a/b", "c~d"]);
        assert!(is_below("/arm/mass", "/arm") && !is_below("/arms", "/arm"));
    }

    #[test]
    fn pointers_are_near_by_each_of_their_keys() {
        let pointers = [
            "/bodies/con_rod/mass",
            "/bodies/rod/mass",
            "/bodies/rod/place/turn/angle",
        ];
        let near = |wanted| nearest_pointer(wanted, pointers.iter().copied());
        assert_eq!(near("/bodies/rod/mas"), Some("/bodies/rod/mass"));
        assert_eq!(near("/bodie/conrod/mass"), Some("/bodies/con_rod/mass"));
        assert_eq!(
            near("/bodies/rod/turn/angle"),
            Some("/bodies/rod/place/turn/angle")
        );
        assert_eq!(near("/bodies/wheel/mass"), None);
    }

    #[test]
    fn advice_names_the_nearest_or_all() {
        let names = ["crank", "con_rod", "piston"];
        let say = |wanted| advice(wanted, "bodies", names);
        assert_eq!(say("conrod").as_deref(), Some("did you mean \"con_rod\"?"));
        assert_eq!(
            say("flywheel").as_deref(),
            Some("bodies are: crank, con_rod, piston")
        );
        assert_eq!(
            advice("x", "bodies", []).as_deref(),
            Some("there are no bodies")
        );
    }
}
