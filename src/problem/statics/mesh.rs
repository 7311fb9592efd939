//! The mesh of one structure of a file, and the sets that it names.

use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::quantity::{Quantity, vector};
use crate::schema::structures::{GmshMesh, Mesh as Written, Set, Structure};
use crate::structures::generate::{self, Generated, GeneratedBeams};
use crate::structures::mesh::Mesh;
use crate::structures::refined::{Refined, refined};
use crate::structures::shell::ShellKind;
use indexmap::IndexMap;

/// A mesh with its nodes \[m\]. Every element of the file may be cut into `cuts` along each direction.
pub struct Part<S> {
    pub mesh: Mesh,
    pub nodes: Vec<Vec3<S>>,
    /// A vector for each beam.
    pub orientations: Vec<Vec3<S>>,
    /// The element of the file that each element was cut from.
    pub parent: Vec<usize>,
    /// Whether each node is one of the file's own mesh.
    pub of_file: Vec<bool>,
}

/// Number of elements of a structure in the file.
pub fn element_count(mesh: &Written) -> usize {
    match mesh {
        Written::StraightBeam { elements, .. } | Written::CurvedBeam { elements, .. } => *elements,
        Written::Frame { members, .. } => members.values().map(|member| member.elements).sum(),
        Written::Gmsh(gmsh) => (gmsh.read.as_ref()).map_or(0, |own| own.mesh.elements().count()),
        panel => panel.panel_elements().map_or(0, |[nx, ny]| nx * ny),
    }
}

/// The mesh of a structure at the design `x`.
pub fn part<S: Scalar>(structure: &Structure, x: &[S], cuts: usize) -> Part<S> {
    let kind = structure.shell_kind();
    let mut part = generated(&structure.mesh, kind, x, cuts);
    if let Some(at) = &structure.at {
        let at = vector(at, x);
        part.nodes.iter_mut().for_each(|node| *node += at);
    }
    for (name, set) in &structure.sets {
        add_set(&mut part, structure, name, set, cuts);
    }
    part
}

/// The mesh of a generator, without sets of the file.
pub fn generated<S: Scalar>(mesh: &Written, kind: ShellKind, x: &[S], cuts: usize) -> Part<S> {
    let finer = |elements: &[usize; 2]| elements.map(|n| n * cuts);
    let angles = |angles: &[Quantity; 2]| angles.map(|angle| angle.get(x));
    match mesh {
        Written::Plate {
            length,
            width,
            elements,
        } => {
            let size = [length.get(x), width.get(x)];
            let plate = generate::plate_of(kind, size, finer(elements));
            of_panel(plate, (kind, elements), false, cuts)
        }
        Written::Panel { points, elements } => {
            let points: Vec<Vec3<S>> = points.iter().map(|p| vector(p, x)).collect();
            let place = |r: f64, s: f64| between(&points, r, s);
            let panel = generate::panel_of(kind, finer(elements), false, place);
            of_panel(panel, (kind, elements), false, cuts)
        }
        Written::CurvedPanel {
            radius,
            length,
            angles: ends,
            elements,
        } => {
            let sizes = (radius.get(x), length.get(x), angles(ends));
            let panel = generate::curved_panel_of(kind, sizes, finer(elements));
            of_panel(panel, (kind, elements), false, cuts)
        }
        Written::Cylinder {
            radius,
            length,
            elements,
        } => {
            let sizes = (radius.get(x), length.get(x));
            let panel = generate::cylinder_of(kind, sizes, finer(elements));
            of_panel(panel, (kind, elements), true, cuts)
        }
        Written::StraightBeam {
            from,
            to,
            orientation,
            elements,
        } => {
            let ends = [vector(from, x), vector(to, x)];
            let line = generate::straight_beam(ends, vector(orientation, x), elements * cuts);
            of_line(line, cuts)
        }
        Written::CurvedBeam {
            radius,
            angles: ends,
            elements,
        } => {
            let line = generate::curved_beam(radius.get(x), angles(ends), elements * cuts);
            of_line(line, cuts)
        }
        Written::Frame { points, members } => frame(points, members, x, cuts),
        Written::Gmsh(gmsh) => of_gmsh(gmsh, x, cuts),
    }
}

/// The mesh that was read; one without nodes if its file is still to be read.
fn of_gmsh<S: Scalar>(gmsh: &GmshMesh, x: &[S], cuts: usize) -> Part<S> {
    let (mesh, nodes) = match &gmsh.read {
        Some(read) => (read.mesh.clone(), read.nodes.clone()),
        None => Default::default(),
    };
    let own = mesh.nodes;
    let Refined {
        mesh,
        nodes,
        parents,
    } = match cuts {
        1 => Refined {
            parents: (0..mesh.elements().count()).collect(),
            mesh,
            nodes,
        },
        _ => refined(&mesh, &nodes, cuts),
    };
    let orientation = gmsh.orientation.as_ref().map(|own| vector(own, x));
    Part {
        of_file: (0..nodes.len()).map(|node| node < own).collect(),
        orientations: vec![orientation.unwrap_or_else(Vec3::zeros); mesh.beams.len()],
        nodes: nodes.iter().map(lift3).collect(),
        parent: parents,
        mesh,
    }
}

/// A place among 4 points (bilinear) or 9 (biquadratic).
fn between<S: Scalar>(points: &[Vec3<S>], r: f64, s: f64) -> Vec3<S> {
    let along = |t: f64| match points.len() {
        4 => vec![1.0 - t, t],
        _ => vec![
            (1.0 - t) * (1.0 - 2.0 * t),
            4.0 * t * (1.0 - t),
            t * (2.0 * t - 1.0),
        ],
    };
    let (columns, rows) = (along(r), along(s));
    let mut sum = Vec3::zeros();
    for (j, row) in rows.iter().enumerate() {
        for (i, column) in columns.iter().enumerate() {
            sum += points[j * columns.len() + i] * S::from(row * column);
        }
    }
    sum
}

fn of_panel<S: Scalar>(
    panel: Generated<S>,
    (kind, &[nx, ny]): (ShellKind, &[usize; 2]),
    closed: bool,
    cuts: usize,
) -> Part<S> {
    let columns = kind.order() * nx * cuts + usize::from(!closed);
    let wide = nx * cuts;
    let elements = 0..wide * ny * cuts;
    let of_file =
        |k: usize| (k % columns).is_multiple_of(cuts) && (k / columns).is_multiple_of(cuts);
    Part {
        of_file: (0..panel.nodes.len()).map(of_file).collect(),
        parent: elements
            .map(|e| (e / wide / cuts) * nx + (e % wide) / cuts)
            .collect(),
        mesh: panel.mesh,
        nodes: panel.nodes,
        orientations: Vec::new(),
    }
}

fn of_line<S: Scalar>(line: GeneratedBeams<S>, cuts: usize) -> Part<S> {
    Part {
        of_file: (0..line.nodes.len())
            .map(|k| k.is_multiple_of(cuts))
            .collect(),
        parent: (0..line.mesh.beams.len()).map(|e| e / cuts).collect(),
        mesh: line.mesh,
        nodes: line.nodes,
        orientations: line.orientations,
    }
}

fn frame<S: Scalar>(
    points: &IndexMap<String, crate::quantity::Vector>,
    members: &IndexMap<String, crate::schema::structures::Member>,
    x: &[S],
    cuts: usize,
) -> Part<S> {
    let index = |name: &String| points.get_index_of(name).expect("names are checked before");
    let places: Vec<Vec3<S>> = points.values().map(|p| vector(p, x)).collect();
    let all: Vec<generate::Member<S>> = members
        .values()
        .map(|member| generate::Member {
            ends: member.between.each_ref().map(index),
            elements: member.elements * cuts,
            orientation: vector(&member.orientation, x),
        })
        .collect();
    let GeneratedBeams {
        mut mesh,
        nodes,
        orientations,
    } = generate::frame(&places, &all);
    let mut of_file = vec![true; places.len()];
    let mut parent = Vec::new();
    let mut first = 0;
    let mut named = Vec::new();
    for (k, (name, member)) in members.iter().enumerate() {
        let inner = 2 * member.elements * cuts - 1;
        of_file.extend((1..=inner).map(|i| i.is_multiple_of(cuts)));
        parent.extend((0..member.elements * cuts).map(|e| first + e / cuts));
        first += member.elements;
        if let Some(beams) = mesh.beam_sets.remove(&format!("member{k}")) {
            named.push((name.clone(), beams));
        }
    }
    mesh.beam_sets.extend(named);
    for k in 0..places.len() {
        mesh.node_sets.remove(&format!("point{k}"));
    }
    for (k, name) in points.keys().enumerate() {
        mesh.node_sets.insert(name.clone(), vec![k]);
    }
    Part {
        mesh,
        nodes,
        orientations,
        parent,
        of_file,
    }
}

fn add_set<S: Scalar>(
    part: &mut Part<S>,
    structure: &Structure,
    name: &str,
    set: &Set,
    cuts: usize,
) {
    let mesh = &structure.mesh;
    let panel = mesh.panel_elements();
    let count = element_count(mesh);
    match set {
        Set::Node { at: [r, s] } => {
            let order = match panel {
                Some(_) => structure.shell_kind().order(),
                None => 2,
            };
            let place = |t: f64, n: usize| (t * (order * n) as f64).round() as usize * cuts;
            let node = match panel {
                Some([nx, ny]) => {
                    let closed = matches!(mesh, Written::Cylinder { .. });
                    let columns = order * nx * cuts + usize::from(!closed);
                    place(*s, ny) * columns + place(*r, nx) % columns
                }
                None => place(*r, count),
            };
            part.mesh.node_sets.insert(name.to_owned(), vec![node]);
        }
        Set::Elements { from, to } => {
            let inside = |e: usize| {
                let [nx, ny] = panel.unwrap_or([count, 1]);
                let middle = [(e % nx) as f64, (e / nx) as f64].map(|k| k + 0.5);
                let middle = [middle[0] / nx as f64, middle[1] / ny as f64];
                (0..2).all(|k| (from[k]..=to[k]).contains(&middle[k]))
            };
            let all = (0..part.parent.len())
                .filter(|&e| inside(part.parent[e]))
                .collect();
            let sets = match panel {
                Some(_) => &mut part.mesh.face_sets,
                None => &mut part.mesh.beam_sets,
            };
            sets.insert(name.to_owned(), all);
        }
    }
}

/// Name of the set of those nodes of a set that are in the mesh of the file.
pub(super) fn of_file(set: &str, cuts: usize) -> String {
    match cuts {
        1 => set.to_owned(),
        _ => format!("{set} (nodes of the file)"),
    }
}

/// Adds the mesh of a structure to that of all.
pub(super) fn append(
    whole: &mut Mesh,
    first_node: usize,
    part: Mesh,
    of_own: &[bool],
    name: impl Fn(&str) -> String,
    cuts: usize,
) {
    let (first_shell, first_beam) = (whole.shells.len(), whole.beams.len());
    whole.nodes += part.nodes;
    let shells = part.shells.iter();
    whole
        .shells
        .extend(shells.map(|shell| shell.map(|k| k + first_node)));
    let beams = part.beams.iter();
    whole
        .beams
        .extend(beams.map(|beam| beam.map(|k| k + first_node)));
    for (set, nodes) in part.node_sets {
        if cuts > 1 {
            let own = nodes.iter().filter(|&&k| of_own[k]).map(|k| k + first_node);
            let own = own.collect();
            whole.node_sets.insert(of_file(&name(&set), cuts), own);
        }
        let all = nodes.iter().map(|k| k + first_node).collect();
        whole.node_sets.insert(name(&set), all);
    }
    for (set, edges) in part.edge_sets {
        let all = edges.iter().map(|edge| edge.map(|k| k + first_node));
        whole.edge_sets.insert(name(&set), all.collect());
    }
    for (set, faces) in part.face_sets {
        let all = faces.iter().map(|k| k + first_shell).collect();
        whole.face_sets.insert(name(&set), all);
    }
    for (set, beams) in part.beam_sets {
        let all = beams.iter().map(|k| k + first_beam).collect();
        whole.beam_sets.insert(name(&set), all);
    }
}

/// Names all nodes and elements.
pub(super) fn name_whole(mesh: &mut Mesh) {
    let all = |count: usize| (0..count).collect::<Vec<usize>>();
    mesh.node_sets.insert("all".into(), all(mesh.nodes));
    mesh.face_sets.insert("all".into(), all(mesh.shells.len()));
    mesh.beam_sets.insert("all".into(), all(mesh.beams.len()));
}
