//! Fields of structures, at rest and in motion, as VTK files for unstructured grids (`.vtu`), which ParaView and meshio read.
//!
//! Nine-node shells are cells of type 28 (biquadratic quadrilateral): corners, middles of edges, centre. Four-node
//! shells are cells of type 9 (quadrilateral).
//! Three-node beams are cells of type 21 (quadratic edge): ends, middle.

use crate::structures::shell::{ShellKind, ShellNodes};
use std::fmt::Write;

/// Local node of a shell for each node of a cell, and the type of this.
fn of_shell(kind: ShellKind) -> (&'static [usize], usize) {
    match kind {
        ShellKind::Mitc9 => (&[0, 2, 8, 6, 1, 5, 7, 3, 4], BIQUADRATIC_QUAD),
        ShellKind::Mitc4 => (&[0, 1, 3, 2], QUAD),
    }
}

/// Local node of a beam for each node of a quadratic edge.
const OF_BEAM: [usize; 3] = [0, 2, 1];
/// Types of cells.
const QUAD: usize = 9;
const BIQUADRATIC_QUAD: usize = 28;
const QUADRATIC_EDGE: usize = 21;

/// A mesh with its fields.
#[derive(Clone, Debug, Default)]
pub struct Fields {
    /// Places of the nodes \[m\].
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of the shells, row by row.
    pub shells: Vec<ShellNodes>,
    /// Nodes of the beams: an end, the middle, the other end.
    pub beams: Vec<[usize; 3]>,
    /// Vectors at the nodes, by name.
    pub vectors: Vec<(String, Vec<[f64; 3]>)>,
    /// Numbers of the elements, shells first, by name.
    pub of_elements: Vec<(String, Vec<f64>)>,
}

/// The file.
pub fn vtu(fields: &Fields) -> String {
    let cells = fields.shells.len() + fields.beams.len();
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n",
    );
    let _ = writeln!(
        text,
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">",
        fields.nodes.len()
    );
    text.push_str("<Points>\n");
    vectors(&mut text, "Points", &fields.nodes);
    text.push_str("</Points>\n<Cells>\n");
    let shells = fields.shells.iter().map(|nodes| {
        of_shell(ShellKind::of(nodes))
            .0
            .iter()
            .map(|&k| nodes[k])
            .collect()
    });
    let beams = fields
        .beams
        .iter()
        .map(|nodes| OF_BEAM.map(|k| nodes[k]).to_vec());
    let all: Vec<Vec<usize>> = shells.chain(beams).collect();
    integers(
        &mut text,
        ("Int64", "connectivity"),
        all.iter().map(Vec::as_slice),
    );
    let mut end = 0;
    let ends: Vec<[usize; 1]> = all
        .iter()
        .map(|nodes| {
            end += nodes.len();
            [end]
        })
        .collect();
    integers(
        &mut text,
        ("Int64", "offsets"),
        ends.iter().map(<[usize; 1]>::as_slice),
    );
    let types: Vec<[usize; 1]> = (0..cells)
        .map(|k| match fields.shells.get(k) {
            Some(nodes) => [of_shell(ShellKind::of(nodes)).1],
            None => [QUADRATIC_EDGE],
        })
        .collect();
    integers(
        &mut text,
        ("UInt8", "types"),
        types.iter().map(<[usize; 1]>::as_slice),
    );
    text.push_str("</Cells>\n<PointData>\n");
    for (name, field) in &fields.vectors {
        vectors(&mut text, name, field);
    }
    text.push_str("</PointData>\n<CellData>\n");
    for (name, field) in &fields.of_elements {
        let _ = writeln!(
            text,
            "<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">",
            escaped(name)
        );
        for x in field {
            let _ = writeln!(text, "{x:e}");
        }
        text.push_str("</DataArray>\n");
    }
    text.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    text
}

/// A collection of files for the instants of a motion (`.pvd`), which ParaView opens: time \[s\] and name.
pub fn pvd(files: &[(f64, String)]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, name) in files {
        let _ = writeln!(
            text,
            "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{}\"/>",
            escaped(name)
        );
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

fn vectors(text: &mut String, name: &str, field: &[[f64; 3]]) {
    let _ = writeln!(
        text,
        "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"3\" format=\"ascii\">",
        escaped(name)
    );
    for [x, y, z] in field {
        let _ = writeln!(text, "{x:e} {y:e} {z:e}");
    }
    text.push_str("</DataArray>\n");
}

fn integers<'a>(
    text: &mut String,
    (kind, name): (&str, &str),
    rows: impl Iterator<Item = &'a [usize]>,
) {
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">"
    );
    for row in rows {
        let numbers: Vec<String> = row.iter().map(usize::to_string).collect();
        let _ = writeln!(text, "{}", numbers.join(" "));
    }
    text.push_str("</DataArray>\n");
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
