//! Mass properties of bodies from the files of their surfaces.

mod solid;
mod stl;

use super::data_file::{DataFault, DataFiles};
use super::fault::Faults;
use super::finding::Finding;
use super::pointer::join;
use super::source::Source;
use crate::schema::Document;
use crate::schema::mechanics::{Solid, Surface};
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
    let mut files = DataFiles::beside(file);
    for (name, body) in &mut document.bodies {
        let Some(surface) = &mut body.mass_properties else {
            continue;
        };
        let pointer = join(&join(&join("/bodies", name), "mass_properties"), "stl");
        let solid = read(&mut files, &pointer, surface);
        let solid = solid.map_err(|fault| fault.located((file, source)))?;
        surface.solid = Some(Arc::new(solid));
    }
    Ok(files.content)
}

/// Copies the data of the files to the same bodies of `to`.
pub(super) fn share(from: &Document, to: &mut Document) {
    for (from, to) in from.bodies.values().zip(to.bodies.values_mut()) {
        if let (Some(from), Some(to)) = (&from.mass_properties, &mut to.mass_properties) {
            to.solid.clone_from(&from.solid);
        }
    }
}

/// The solid inside the surface that the entry at `pointer` names.
fn read(files: &mut DataFiles, pointer: &str, surface: &Surface) -> Result<Solid, Box<DataFault>> {
    let bytes = files.bytes(pointer, &surface.stl)?;
    let in_file = |(found, expected): (String, &'static str)| {
        let shown = files.directory.join(&surface.stl);
        let found = format!("{found} in {}", shown.display());
        Box::new(DataFault::Document(Finding::new(pointer, found, expected)))
    };
    let triangles = stl::triangles(&bytes).map_err(in_file)?;
    solid::inside(&triangles, surface.unit.metres()).map_err(in_file)
}
