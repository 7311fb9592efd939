//! Parts in files of their own.

use crate::fault::Faults;
use crate::file_text::{Unread, json, read as read_text};
use crate::finding::{Finding, Part};
use crate::pointer::join;
use crate::source::{Duplicate, Source};
use serde_json::Value;
use std::path::Path;

/// Puts the parts of a document that are files of their own in its place; `file` is the problem file.
///
/// # Errors
/// The first file that cannot be read.
pub fn read(document: &mut Value, file: &str, source: &mut Source) -> Result<(), Faults> {
    let directory = Path::new(file).parent().unwrap_or(Path::new(""));
    let parts = document.get_mut("parts").and_then(Value::as_object_mut);
    for (name, part) in parts.into_iter().flatten() {
        let Some(own) = part.get("file").and_then(Value::as_str) else {
            continue;
        };
        let pointer = join("/parts", name);
        let refused = |key: &str, found: String, expected: &str| {
            let finding = Finding::new(join(&pointer, key), found, expected);
            Err(Faults::locate(vec![finding], file, source, &[]))
        };
        let other = part.as_object().into_iter().flat_map(|part| part.keys());
        if let Some(other) = other
            .into_iter()
            .find(|key| !["file", "description"].contains(&key.as_str()))
        {
            let found = format!("\"{other}\" beside \"file\"");
            return refused(
                other,
                found,
                "one of them, as the file has the keys of the part",
            );
        }
        let path = directory.join(own);
        let shown = path.display().to_string();
        let text = match read_text(&path) {
            Ok(text) => text,
            Err(Unread::Faulty(faults)) => return Err(faults),
            Err(Unread::Missing(found)) => {
                let expected = "a file that can be read; its path is relative to the problem file";
                return refused("file", format!("{found} {shown}"), expected);
            }
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let content = json(text, &shown)?;
        let inner = Source::index(text);
        let mut findings: Vec<Finding> = inner.duplicates.iter().map(twice).collect();
        let expected = "an object with bodies, joints, loads, drives and couplings";
        match &content {
            Value::Object(_) if content.get("file").is_none() => {}
            Value::Object(_) => findings
                .push(Finding::new("/file", "another file", "the keys of the part").of_key()),
            _ => findings.push(Finding::new("", "no object", expected)),
        }
        if !findings.is_empty() {
            return Err(Faults::locate(findings, &shown, &inner, &[]));
        }
        *part = content;
        source.files.push((pointer, shown, inner));
    }
    Ok(())
}

/// The fault of a key that occurs twice.
pub fn twice(duplicate: &Duplicate) -> Finding {
    let Duplicate {
        key, first_line, ..
    } = duplicate;
    let found = format!("the key \"{key}\" a second time");
    let expected = format!("each key once, and it is on line {first_line}");
    Finding {
        part: Part::Bytes(duplicate.bytes.clone()),
        ..Finding::new(&duplicate.pointer, found, expected)
    }
}
