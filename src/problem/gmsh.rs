//! Meshes of structures from files of Gmsh: quadrangles become shells of nine or four nodes, lines their edges or, where a
//! file has no surface, three-node beams, and physical groups sets.

use super::data_file::{DataFault, DataFiles};
use super::data_text::TextFault;
use super::fault::Faults;
use super::finding::Finding;
use super::msh::{self, Element, Msh, turn_over};
use super::pointer::join;
use super::source::Source;
use crate::math::Vec3;
use crate::schema::Document;
use crate::schema::structures::{Mesh as Written, ReadMesh, Structure};
use crate::structures::mesh::{Edge, Mesh, shell_edges};
use crate::structures::quality::faults;
use crate::structures::shell::{ShellKind, ShellNodes};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Fold at an edge of three sheets up to which one of them continues another \[rad\]. A smaller one than of a smooth sheet
/// would leave some of its elements as they are.
const CONTINUED: f64 = 0.8;

/// The place in Gmsh's order of each of our nodes of a shell.
fn order(kind: ShellKind) -> &'static [usize] {
    match kind {
        ShellKind::Mitc9 => &[0, 4, 1, 7, 8, 5, 3, 6, 2],
        ShellKind::Mitc4 => &[0, 1, 3, 2],
    }
}

/// Names of groups without a name, before their number.
const UNNAMED: [&str; 3] = ["point", "line", "surface"];
/// The set of all nodes and all elements.
const ALL: &str = "all";

/// The structures of a document with their pointers.
fn structures(document: &mut Document) -> impl Iterator<Item = (String, &mut Structure)> {
    let still = document.structures.iter_mut();
    let still = still.map(|(name, own)| (join("/structures", name), own));
    let moving = document.bodies.iter_mut().filter_map(|(name, body)| {
        let pointer = join(&join(&join("/bodies", name), "elements"), "structure");
        Some((pointer, &mut body.elements.as_mut()?.structure))
    });
    still.chain(moving)
}

/// Reads the meshes of all structures of a document in this directory. Returns their content as a text for the
/// hash of the problem.
///
/// # Errors
/// The first fault of a file.
pub(super) fn load(
    document: &mut Document,
    (file, source): (&str, &Source),
) -> Result<String, Faults> {
    let mut files = DataFiles::beside(file);
    for (pointer, structure) in structures(document) {
        let kind = structure.shell_kind();
        let Written::Gmsh(gmsh) = &mut structure.mesh else {
            continue;
        };
        let pointer = format!("{pointer}/mesh/gmsh/file");
        let read = files.bytes(&pointer, &gmsh.file).and_then(|bytes| {
            if msh::is_binary(&bytes) {
                let shown = files.directory.join(&gmsh.file);
                let found = format!("binary numbers in {}", shown.display());
                let finding = Finding::new(&pointer, found, "a mesh in ASCII");
                let hint = "save with Mesh.Binary = 0".to_owned();
                return Err(Box::new(DataFault::Document(finding.hint(Some(hint)))));
            }
            let metres = gmsh.unit.metres();
            files.text(&pointer, &gmsh.file, bytes, |text| {
                mesh(msh::read(text)?, (kind, metres))
            })
        });
        let read = read.map_err(|fault| fault.located((file, source)))?;
        gmsh.read = Some(Arc::new(read));
    }
    Ok(files.content)
}

/// Copies the meshes to the same structures of `to`.
pub(super) fn share(from: &Document, to: &mut Document) {
    let moving = from
        .bodies
        .values()
        .filter_map(|body| body.elements.as_ref());
    let moving = moving.map(|elements| &elements.structure);
    let from = from.structures.values().chain(moving);
    for (from, (_, to)) in from.zip(structures(to)) {
        if let (Written::Gmsh(from), Written::Gmsh(to)) = (&from.mesh, &mut to.mesh) {
            to.read.clone_from(&from.read);
        }
    }
}

/// The mesh of shells, or of beams, in metres.
fn mesh(mut msh: Msh, (kind, metres): (ShellKind, f64)) -> Result<ReadMesh, TextFault> {
    let names = names(&msh)?;
    let most = msh.elements.iter().map(Element::dimension).max();
    let Some(most @ 1..=2) = most else {
        let at = msh.elements.first().map_or(0..0, |first| first.at.clone());
        let fault = TextFault::new(
            at,
            "no surface and no line",
            "quadrangles, or lines of beams",
        );
        return Err(
            fault.hint("a file has the elements of physical groups alone, if there are any")
        );
    };
    let mut elements = merged(std::mem::take(&mut msh.elements), &names)?;
    match (most, kind) {
        (2, ShellKind::Mitc4) => straight(&elements)?,
        _ => complete(&mut elements, &mut msh.places)?,
    }
    if most == 2 {
        align(&mut elements, &msh.places);
    }
    let mut read = ReadMesh::default();
    let (index, of_file) = assemble(&elements, (&msh.places, metres), (most, kind), &mut read);
    if let Some(fault) = faults(&read.mesh, &read.nodes).first() {
        let own = (fault.element()).map_or(&elements[0], |k| &elements[of_file[k]]);
        let found = format!("element {}: {fault}", own.number);
        let expected = "a mesh of sound elements";
        return Err(TextFault::new(own.at.clone(), found, expected));
    }
    name_sets(&elements, &index, (&of_file, &names), &mut read.mesh)?;
    Ok(read)
}

type Names = BTreeMap<msh::Group, String>;

/// The names of the sets of all groups that have elements: one for each.
fn names(msh: &Msh) -> Result<Names, TextFault> {
    let mut all = Names::new();
    let mut taken: HashMap<&str, usize> = HashMap::new();
    for (group, (name, at)) in &msh.names {
        let other = taken.insert(name, group.0);
        if other.is_some() || name == ALL {
            let found = format!("the name \"{name}\" of group {}", group.1);
            let expected = match other {
                Some(_) => {
                    "another name than that of an earlier group, as both name a set of nodes"
                }
                None => "another name, as \"all\" is the set of everything",
            };
            return Err(TextFault::new(at.clone(), found, expected));
        }
        all.insert(*group, name.clone());
    }
    for group in msh.elements.iter().flat_map(|own| &own.groups) {
        let unnamed = || format!("{}{}", UNNAMED[group.0], group.1);
        all.entry(*group).or_insert_with(unnamed);
    }
    Ok(all)
}

/// The elements, each once: MSH 2.2 repeats one that is in several groups.
fn merged(elements: Vec<Element>, names: &Names) -> Result<Vec<Element>, TextFault> {
    let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
    let mut all: Vec<Element> = Vec::with_capacity(elements.len());
    for element in elements {
        let mut key = element.nodes.clone();
        key.sort_unstable();
        let Some(&first) = known.get(&key) else {
            known.insert(key, all.len());
            all.push(element);
            continue;
        };
        let first = &mut all[first];
        let again = element
            .groups
            .iter()
            .find(|group| first.groups.contains(group));
        if again.is_some() || element.groups.is_empty() {
            let group = again.map_or("no group", |group| names[group].as_str());
            let (a, b) = (first.number, element.number);
            let found = format!("element {b} on the nodes of element {a}, both in {group}");
            return Err(TextFault::new(element.at, found, "an element once"));
        }
        first.groups.extend(element.groups);
    }
    Ok(all)
}

/// Refuses elements that four-node shells cannot be made of.
fn straight(elements: &[Element]) -> Result<(), TextFault> {
    let curved = |own: &&Element| matches!(own.nodes.len(), 3 | 8 | 9);
    let Some(own) = elements.iter().find(curved) else {
        return Ok(());
    };
    let found = format!("element {} of {} nodes", own.number, own.nodes.len());
    let expected = "quadrangles of four nodes and lines of two, as \"element\" is \"mitc4\"";
    let fault = TextFault::new(own.at.clone(), found, expected);
    Err(fault.hint("gmsh -2 -order 1 writes such elements; \"mitc9\" takes those of this file"))
}

/// Gives elements of straight edges their middle nodes, and quadrangles of eight nodes the one inside.
fn complete(elements: &mut [Element], places: &mut Vec<Vec3<f64>>) -> Result<(), TextFault> {
    let straight = |own: &Element| matches!(own.nodes.len(), 2 | 4);
    let curved = |own: &Element| matches!(own.nodes.len(), 3 | 8 | 9);
    let first = elements.iter().find(|own| straight(own) || curved(own));
    let order = first.is_some_and(curved);
    let other = |own: &&Element| match order {
        true => straight(own),
        false => curved(own),
    };
    if let Some(own) = elements.iter().find(other) {
        let found = format!("element {} of {} nodes", own.number, own.nodes.len());
        let expected = "elements of one order";
        return Err(TextFault::new(own.at.clone(), found, expected));
    }
    let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
    let mut middle = |a: usize, b: usize, places: &mut Vec<Vec3<f64>>| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            places.push((places[a] + places[b]) * 0.5);
            places.len() - 1
        })
    };
    for element in elements {
        if let [a, b] = element.nodes[..] {
            element.nodes.push(middle(a, b, places));
        }
        if let [a, b, c, d] = element.nodes[..] {
            for [from, to] in [[a, b], [b, c], [c, d], [d, a]] {
                element.nodes.push(middle(from, to, places));
            }
        }
        if let [a, b, c, d, e, f, g, h] = element.nodes[..] {
            let sum = |all: [usize; 4]| all.iter().map(|&k| places[k]).sum::<Vec3<f64>>();
            places.push(sum([e, f, g, h]) * 0.5 - sum([a, b, c, d]) * 0.25);
            element.nodes.push(places.len() - 1);
        }
    }
    Ok(())
}

/// Turns quadrangles over so that neighbours agree on the side to which their normals point: the first of the file
/// of each connected part stays.
fn align(elements: &mut [Element], places: &[Vec3<f64>]) {
    let shells: Vec<usize> = (0..elements.len())
        .filter(|&e| elements[e].dimension() == 2)
        .collect();
    let edges = |nodes: &[usize]| [0, 1, 2, 3].map(|k| [nodes[k], nodes[(k + 1) % 4]]);
    let key = |[a, b]: [usize; 2]| [a.min(b), a.max(b)];
    let mut at_edge: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
    for &e in &shells {
        for edge in edges(&elements[e].nodes) {
            at_edge.entry(key(edge)).or_default().push(e);
        }
    }
    let mut seen = HashSet::new();
    for &first in &shells {
        let mut front = match seen.insert(first) {
            true => vec![first],
            false => continue,
        };
        while let Some(e) = front.pop() {
            for edge in edges(&elements[e].nodes) {
                let others = at_edge[&key(edge)].iter().copied().filter(|&k| k != e);
                let mut others: Vec<usize> = others.collect();
                // Of three sheets at one edge, those are turned that continue each other.
                if others.len() > 1 {
                    others.retain(|&k| continues(elements, places, (e, k), edge));
                }
                for other in others {
                    if !seen.insert(other) {
                        continue;
                    }
                    if edges(&elements[other].nodes).contains(&edge) {
                        turn_over(&mut elements[other].nodes);
                    }
                    front.push(other);
                }
            }
        }
    }
}

/// Whether one of two elements at an edge continues the other beyond it, with a fold that is not large.
fn continues(
    elements: &[Element],
    places: &[Vec3<f64>],
    (a, b): (usize, usize),
    edge: [usize; 2],
) -> bool {
    let [from, to] = edge.map(|k| places[k]);
    let inwards = |e: usize| {
        let corners = elements[e].nodes[..4].iter();
        let off = corners.filter(|k| !edge.contains(k));
        let beyond = off.map(|&k| places[k]).sum::<Vec3<f64>>() / 2.0 - (from + to) / 2.0;
        let along = (to - from).normalize();
        (beyond - along * along.dot(&beyond)).normalize()
    };
    inwards(a).dot(&inwards(b)) < -CONTINUED.cos()
}

/// Makes the shells or beams of the elements of the dimension `most`. Gives the number of each node of the file in the
/// mesh, if it has one, and the element of the file of each of its elements.
fn assemble(
    elements: &[Element],
    (places, metres): (&[Vec3<f64>], f64),
    (most, kind): (usize, ShellKind),
    to: &mut ReadMesh,
) -> (Vec<Option<usize>>, Vec<usize>) {
    let mut index: Vec<Option<usize>> = vec![None; places.len()];
    let mut of_file = Vec::new();
    let all = elements.iter().enumerate();
    for (e, element) in all.filter(|(_, own)| own.dimension() == most) {
        let mut numbered = |k: usize| {
            *index[k].get_or_insert_with(|| {
                to.nodes.push(places[k] * metres);
                to.nodes.len() - 1
            })
        };
        let own: Vec<usize> = element.nodes.iter().map(|&k| numbered(k)).collect();
        match most {
            2 => {
                let order = order(kind);
                let nodes = ShellNodes::from_fn(order.len(), |k| own[order[k]]);
                to.mesh.shells.push(nodes);
            }
            _ => to.mesh.beams.push([own[0], own[2], own[1]]),
        }
        of_file.push(e);
    }
    to.mesh.nodes = to.nodes.len();
    (index, of_file)
}

/// Gives a mesh the sets of the groups of its file.
fn name_sets(
    elements: &[Element],
    index: &[Option<usize>],
    (of_file, names): (&[usize], &Names),
    mesh: &mut Mesh,
) -> Result<(), TextFault> {
    let of_shells = !mesh.shells.is_empty();
    let (count, own_sets) = match of_shells {
        true => (mesh.shells.len(), &mut mesh.face_sets),
        false => (mesh.beams.len(), &mut mesh.beam_sets),
    };
    for (number, &e) in of_file.iter().enumerate() {
        for group in &elements[e].groups {
            let set = own_sets.entry(names[group].clone()).or_default();
            set.push(number);
        }
    }
    own_sets.insert(ALL.into(), (0..count).collect());
    let shells = mesh.shells.iter();
    let edges: HashSet<Edge> = shells.flat_map(shell_edges).map(sorted).collect();
    let mut in_sets: BTreeMap<&String, (Vec<usize>, HashSet<usize>)> = BTreeMap::new();
    for element in elements.iter().filter(|own| !own.groups.is_empty()) {
        let own: Option<Vec<usize>> = element.nodes.iter().map(|&k| index[k]).collect();
        let edge = match own.as_deref() {
            Some(&[a, b, middle]) if of_shells => Some(Edge::from([a, middle, b])),
            Some(&[a, b]) if of_shells => Some(Edge::from([a, b])),
            _ => None,
        };
        let is_off = edge.is_some_and(|edge| !edges.contains(&sorted(edge)));
        let Some(own) = own.filter(|_| !is_off) else {
            let number = element.number;
            let found = format!("element {number}, which is on no element of the mesh");
            let expected = match element.dimension() {
                1 => "lines along edges of quadrangles",
                _ => "points that are nodes of the mesh",
            };
            return Err(TextFault::new(element.at.clone(), found, expected));
        };
        for group in &element.groups {
            let name = &names[group];
            if let Some(edge) = edge {
                let edges = mesh.edge_sets.entry(name.clone()).or_default();
                edges.push(edge);
            }
            let (list, known) = in_sets.entry(name).or_default();
            list.extend(own.iter().filter(|&&node| known.insert(node)));
        }
    }
    let sets = in_sets.into_iter();
    mesh.node_sets = sets.map(|(name, (list, _))| (name.clone(), list)).collect();
    mesh.node_sets.insert(ALL.into(), (0..mesh.nodes).collect());
    Ok(())
}

fn sorted(mut nodes: Edge) -> Edge {
    nodes.sort_unstable();
    nodes
}
