//! Mass properties of bodies from the files of their surfaces.

mod solid;
mod stl;

use super::bounds;
use super::fault::Faults;
use super::finding::Finding;
use super::pointer::join;
use super::source::Source;
use crate::schema::Document;
use crate::schema::mechanics::{Solid, Surface};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;

/// Reads the surfaces of all bodies of a document in this directory. Returns their content as a text for the hash
/// of the problem.
///
/// # Errors
/// The first surface that is none of a solid.
pub(super) fn load(
    document: &mut Document,
    (file, source): (&str, &Source),
) -> Result<String, Faults> {
    let directory = Path::new(file).parent().unwrap_or(Path::new(""));
    let mut content = String::new();
    for (name, body) in &mut document.bodies {
        let Some(surface) = &mut body.mass_properties else {
            continue;
        };
        let found = read(&directory.join(&surface.stl), surface, &mut content);
        let solid = found.map_err(|(found, expected)| {
            let pointer = join(&join(&join("/bodies", name), "mass_properties"), "stl");
            let finding = Finding::new(pointer, found, expected);
            Faults::locate(vec![finding], file, source, &[])
        })?;
        surface.solid = Some(Arc::new(solid));
    }
    Ok(content)
}

/// Copies the data of the files to the same bodies of `to`.
pub(super) fn share(from: &Document, to: &mut Document) {
    for (from, to) in from.bodies.values().zip(to.bodies.values_mut()) {
        if let (Some(from), Some(to)) = (&from.mass_properties, &mut to.mass_properties) {
            to.solid.clone_from(&from.solid);
        }
    }
}

/// The solid inside the surface of a file, or what was found and expected.
fn read(
    path: &Path,
    surface: &Surface,
    content: &mut String,
) -> Result<Solid, (String, &'static str)> {
    let shown = path.display();
    let expected = "a file that can be read; its path is relative to the problem file";
    let bytes = bounds::read(path).map_err(|error| {
        let found = match error.kind() {
            _ if path.is_dir() => format!("the directory {shown}"),
            std::io::ErrorKind::NotFound => format!("no file {shown}"),
            _ => format!("{error} of {shown}"),
        };
        (found, expected)
    })?;
    if bytes.len() > bounds::LARGEST {
        let found = format!("a file of more than {} MB, {shown}", bounds::LARGEST >> 20);
        return Err((found, expected));
    }
    let hash = Sha256::digest(&bytes);
    content.extend(hash.iter().map(|byte| format!("{byte:02x}")));
    let in_file =
        |(found, expected): (String, &'static str)| (format!("{found} in {shown}"), expected);
    let triangles = stl::triangles(&bytes).map_err(in_file)?;
    solid::inside(&triangles, surface.unit.metres()).map_err(in_file)
}
