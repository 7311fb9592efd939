//! Files of Gmsh with a plate.

use std::fmt::Write;

/// Version, nodes of a quadrangle, unit and its length in metres.
#[derive(Clone, Copy)]
pub struct Format {
    pub version: &'static str,
    pub nodes: usize,
    pub unit: &'static str,
    pub metres: f64,
    /// Whether every second element lists its nodes the other way round.
    pub turned: bool,
}

pub const PLAIN: Format = Format {
    version: "4.1",
    nodes: 9,
    unit: "m",
    metres: 1.0,
    turned: false,
};

/// The file of a plate of this size and these numbers of elements, with the sets x0, x1, y0, y1 (lines), x0y0 (a
/// point), and left and right (surfaces). Numbers of nodes are neither in order nor without gaps.
pub fn plate(size: [f64; 2], [nx, ny]: [usize; 2], format: Format) -> String {
    let (columns, rows) = (2 * nx + 1, 2 * ny + 1);
    let id = |i: usize, j: usize| 3 * (columns * rows - (j * columns + i)) + 4;
    let corner = |k: usize| k.is_multiple_of(2);
    let there = |i: usize, j: usize| match format.nodes {
        4 => corner(i) && corner(j),
        8 => corner(i) || corner(j),
        _ => true,
    };
    let mut nodes = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        if there(i, j) {
            let x = size[0] * i as f64 / (2 * nx) as f64 / format.metres;
            let y = size[1] * j as f64 / (2 * ny) as f64 / format.metres;
            nodes.push((id(i, j), format!("{x} {y} 0")));
        }
    }
    // Kind, dimension, group, nodes.
    let mut elements: Vec<(usize, usize, usize, Vec<usize>)> = vec![(15, 0, 1, vec![id(0, 0)])];
    let line = |group: usize, [a, b, c]: [(usize, usize); 3]| {
        let mut nodes = vec![id(a.0, a.1), id(c.0, c.1)];
        if format.nodes > 4 {
            nodes.push(id(b.0, b.1));
        }
        let kind = if format.nodes > 4 { 8 } else { 1 };
        (kind, 1, group, nodes)
    };
    for e in 0..ny {
        elements.push(line(1, [0, 1, 2].map(|k| (0, 2 * e + k))));
        elements.push(line(2, [2, 1, 0].map(|k| (columns - 1, 2 * e + k))));
    }
    for e in 0..nx {
        elements.push(line(3, [0, 1, 2].map(|k| (2 * e + k, 0))));
        elements.push(line(4, [0, 1, 2].map(|k| (2 * e + k, rows - 1))));
    }
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let at = |dx: usize, dy: usize| id(2 * i + dx, 2 * j + dy);
        let mut own = match format.turned && !(i + j).is_multiple_of(2) {
            false => vec![
                at(0, 0),
                at(2, 0),
                at(2, 2),
                at(0, 2),
                at(1, 0),
                at(2, 1),
                at(1, 2),
                at(0, 1),
                at(1, 1),
            ],
            true => vec![
                at(0, 2),
                at(2, 2),
                at(2, 0),
                at(0, 0),
                at(1, 2),
                at(2, 1),
                at(1, 0),
                at(0, 1),
                at(1, 1),
            ],
        };
        own.truncate(format.nodes);
        let kind = match format.nodes {
            4 => 3,
            8 => 16,
            _ => 10,
        };
        elements.push((kind, 2, 1 + usize::from(2 * i >= nx), own));
    }
    let names = "$PhysicalNames\n7\n0 1 \"x0y0\"\n1 1 \"x0\"\n1 2 \"x1\"\n1 3 \"y0\"\n1 4 \"y1\"\n\
                 2 1 \"left\"\n2 2 \"right half\"\n$EndPhysicalNames\n";
    let version = format.version;
    let mut text = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n{names}");
    let words = |own: &[usize]| {
        let all: Vec<String> = own.iter().map(usize::to_string).collect();
        all.join(" ")
    };
    let count = nodes.len();
    if version == "4.1" {
        text += "$Entities\n1 4 2 0\n1 0 0 0 1 1\n";
        for (dimension, number) in [(1, 1), (1, 2), (1, 3), (1, 4), (2, 1), (2, 2)] {
            let _ = writeln!(text, "{number} 0 0 0 1 1 0 1 {number} {}", 2 - dimension);
        }
        // Lists of bounding entities are not needed.
        text += "$EndEntities\n";
        let _ = writeln!(text, "$Nodes\n1 {count} 1 100000\n2 1 0 {count}");
        nodes.iter().for_each(|(id, _)| {
            let _ = writeln!(text, "{id}");
        });
        nodes.iter().for_each(|(_, place)| {
            let _ = writeln!(text, "{place}");
        });
        let all = elements.len();
        let _ = writeln!(text, "$EndNodes\n$Elements\n{all} {all} 1 {all}");
        for (k, (kind, dimension, group, own)) in elements.iter().enumerate() {
            let _ = writeln!(
                text,
                "{dimension} {group} {kind} 1\n{} {}",
                k + 1,
                words(own)
            );
        }
    } else {
        let _ = writeln!(text, "$Nodes\n{count}");
        nodes.iter().for_each(|(id, place)| {
            let _ = writeln!(text, "{id} {place}");
        });
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", elements.len());
        for (k, (kind, _, group, own)) in elements.iter().enumerate() {
            let _ = writeln!(text, "{} {kind} 2 {group} 1 {}", k + 1, words(own));
        }
    }
    text + "$EndElements\n"
}

/// The file with one more point group.
pub fn point(text: &str, number: usize, name: &str, node: usize) -> String {
    let count = |text: &str, key: &str| -> usize {
        let rest = text.split(&format!("{key}\n")).nth(1).expect("a section");
        let first = rest.split_whitespace().next().expect("a count");
        first.parse().expect("a count")
    };
    let names = count(text, "$PhysicalNames");
    let elements = count(text, "$Elements");
    let entities = count(text, "$Entities");
    text.replace(
        &format!("$PhysicalNames\n{names}\n"),
        &format!("$PhysicalNames\n{}\n0 {number} \"{name}\"\n", names + 1),
    )
    .replace(
        &format!("$Entities\n{entities} 4 2 0\n"),
        &format!(
            "$Entities\n{} 4 2 0\n{number} 0 0 0 1 {number}\n",
            entities + 1
        ),
    )
    .replace(
        &format!("$Elements\n{elements} {elements} "),
        &format!("$Elements\n{} {} ", elements + 1, elements + 1),
    )
    .replace(
        "$EndElements",
        &format!("0 {number} 15 1\n{} {node}\n$EndElements", 900 + number),
    )
}
