//! Structures of a file: from a design to meshes, properties and loads, and back.

pub mod expand;
mod functions;
pub mod mesh;
pub mod per_thickness;
pub mod properties;
mod pull_back;
mod workspace;

pub use functions::{Asked, MeasuredFunction};
pub use pull_back::{Moved, PulledBack};
pub use workspace::{Workspace, Workspaces};

use crate::math::{Scalar, Vec3};
use crate::quantity::{Quantity, vector};
use crate::schema::Document;
use crate::schema::statics::{CaseLoad, Strains, Unknowns};
use crate::schema::structures::{self as written, Held};
use crate::structures::functions::Function;
use crate::structures::loads::Load;
use crate::structures::lumped_mass::LumpedMass;
use crate::structures::material::Material;
use crate::structures::mesh::Mesh;
use crate::structures::modes::loose_part;
use crate::structures::normal_moment::along_normal;
use crate::structures::quality::{MeshFault, faults, orientation_faults};
use crate::structures::shell::Terms;
use crate::structures::statics::{StaticFailure, StaticProblem};
use crate::structures::structure::{Structure, Topology};
use crate::structures::supports::{NodeUnknowns, Support};
use mesh::{append, name_whole, of_file};
use properties::{section, section_at, slots, thickness};
use std::collections::HashSet;
use std::sync::{Arc, OnceLock};

/// Structures and load cases at a design.
#[derive(Clone, Debug)]
pub struct StaticScene<S> {
    /// All structures as one.
    pub structure: Structure<S>,
    /// The loads of each case.
    pub cases: Vec<Vec<Load<S>>>,
}

/// Data of the structures of a file that no design changes.
#[derive(Clone, Debug)]
pub struct Statics {
    topology: Arc<Topology>,
    /// Number of cuts of each element of the file along each direction.
    pub cuts: usize,
    /// The structure of each shell and beam, and which of its values they have.
    shells: Vec<(usize, usize)>,
    beams: Vec<(usize, usize)>,
    /// The mass of the file at each node with one: structure and number.
    masses: Vec<(usize, usize)>,
    /// All supports.
    pub supports: Vec<Support>,
    /// Five or six unknowns on smooth surfaces.
    pub node_unknowns: NodeUnknowns,
    /// The terms of the strains.
    pub terms: Terms,
    /// Names of the load cases.
    pub cases: Vec<String>,
    /// The functions.
    pub functions: Vec<Asked>,
    /// Analysed problems, for the next designs.
    pub workspaces: Workspaces,
    /// Modes at the start, by number, if some are followed by their shapes.
    pub first_shapes: OnceLock<Vec<Vec<f64>>>,
}

/// The name of a set in the mesh of all structures.
fn in_whole(document: &Document, structure: &str, set: &str) -> String {
    match document.structures.len() {
        1 => set.to_owned(),
        _ => format!("{structure}.{set}"),
    }
}

impl Statics {
    /// The structures of a checked document at its own design, every element cut `cuts` times.
    ///
    /// # Errors
    /// The faults of the meshes, with the names of their structures.
    pub fn new(
        document: &Document,
        x: &[f64],
        cuts: usize,
    ) -> Result<Self, Vec<(String, MeshFault)>> {
        let mut mesh = Mesh::default();
        let mut nodes = Vec::new();
        let (mut shells, mut beams, mut mass_nodes, mut masses) = (vec![], vec![], vec![], vec![]);
        let (mut material, mut beam_material) = (Vec::new(), Vec::new());
        let (mut supports, mut wrong) = (Vec::new(), Vec::new());
        let per_thickness = per_thickness::is_used(document);
        for (s, (name, structure)) in document.structures.iter().enumerate() {
            let part = mesh::part(structure, x, cuts);
            let mut found = faults(&part.mesh, &part.nodes);
            if found.is_empty() {
                found = orientation_faults(&part.mesh, &part.nodes, &part.orientations);
            }
            wrong.extend(found.into_iter().map(|fault| (name.clone(), fault)));
            let number = document.materials.get_index_of(&structure.material);
            let number = number.expect("names are checked before");
            material.extend(std::iter::repeat_n(number, part.mesh.shells.len()));
            beam_material.extend(std::iter::repeat_n(number, part.mesh.beams.len()));
            let slots = slots(structure, &part);
            if per_thickness {
                for (shell, &slot) in slots.iter().take(part.mesh.shells.len()).enumerate() {
                    let set = mesh.face_sets.entry(per_thickness::set(name, slot));
                    set.or_default().push(shells.len() + shell);
                }
            }
            match part.mesh.shells.is_empty() {
                false => shells.extend(slots.into_iter().map(|slot| (s, slot))),
                true => beams.extend(slots.into_iter().map(|slot| (s, slot))),
            }
            for (m, mass) in structure.masses.values().enumerate() {
                let set = part.mesh.node_sets.get(&mass.nodes);
                let own = set
                    .into_iter()
                    .flatten()
                    .filter(|&&node| part.of_file[node]);
                for &node in own {
                    mass_nodes.push(nodes.len() + node);
                    masses.push((s, m));
                }
            }
            for support in structure.supports.values() {
                for set in &support.nodes.all {
                    supports.push(support_of(support, in_whole(document, name, set)));
                }
            }
            append(
                &mut mesh,
                nodes.len(),
                part.mesh,
                &part.of_file,
                |set| in_whole(document, name, set),
                cuts,
            );
            nodes.extend(part.nodes);
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        name_whole(&mut mesh);
        let study = document.statics.clone().unwrap_or_default();
        Ok(Self {
            topology: Arc::new(Topology::new(
                mesh,
                &nodes,
                [material, beam_material],
                mass_nodes,
            )),
            cuts,
            shells,
            beams,
            masses,
            supports,
            node_unknowns: match study.node_unknowns {
                Unknowns::Five => NodeUnknowns::Natural,
                Unknowns::Six => NodeUnknowns::Six,
            },
            terms: match study.strains {
                Strains::Linear => Terms::LINEAR,
                Strains::VonKarman => Terms::VON_KARMAN,
            },
            cases: document.load_cases.keys().cloned().collect(),
            functions: functions::asked(document, cuts),
            workspaces: Workspaces::default(),
            first_shapes: OnceLock::new(),
        })
    }

    /// The mesh of all structures.
    pub fn mesh(&self) -> &Mesh {
        &self.topology.mesh
    }

    /// The structure with load cases of which a part can move without strain, and the node that
    /// moves.
    pub fn mechanism(&self, document: &Document, x: &[f64]) -> Option<(String, StaticFailure)> {
        if self.cases.is_empty() {
            return None;
        }
        let structure = self.scene(document, x).structure;
        let problem = StaticProblem::new(&structure, &self.supports, self.node_unknowns).ok()?;
        let failure = loose_part(&problem, &structure);
        self.workspaces.give(Workspace {
            statics: Some(problem),
            modal: None,
        });
        let failure = failure?;
        let StaticFailure::Mechanism { node, .. } = &failure else {
            return None;
        };
        let elements = structure
            .topology
            .mesh
            .shells
            .iter()
            .position(|e| e.contains(node));
        let beams = || {
            structure
                .topology
                .mesh
                .beams
                .iter()
                .position(|e| e.contains(node))
        };
        let of = match elements {
            Some(shell) => self.shells[shell].0,
            None => self.beams[beams()?].0,
        };
        let (name, _) = document.structures.get_index(of)?;
        Some((name.clone(), failure))
    }

    /// The functions of reactions of nodes that no support holds in their direction: these are zero
    /// at all designs.
    pub fn unsupported(&self) -> Vec<usize> {
        let sets = &self.mesh().node_sets;
        let nodes_of = |set: &String| sets.get(set).map_or(&[][..], Vec::as_slice);
        let holds = |set: &String, held: &dyn Fn(&Support) -> bool| {
            let asked: HashSet<usize> = nodes_of(set).iter().copied().collect();
            let supports = self.supports.iter().filter(|support| held(support));
            supports
                .flat_map(|support| nodes_of(&support.nodes))
                .any(|node| asked.contains(node))
        };
        let is_zero = |function: &Asked| match function {
            Asked::OfSolutions(Function::Reaction {
                nodes, direction, ..
            }) => {
                let along = |support: &Support| {
                    (0..3).any(|k| support.displacements[k] && direction[k] != 0.0)
                };
                !holds(nodes, &along)
            }
            Asked::OfSolutions(Function::ReactionMoment { nodes, .. }) => !holds(nodes, &|_| true),
            _ => false,
        };
        let all = self.functions.iter().enumerate();
        all.filter(|(_, function)| is_zero(function))
            .map(|(f, _)| f)
            .collect()
    }

    /// The first moment on a shell, by load case and load, of which a part is along the normal at a node without a
    /// rotation about it, and where this node is. Designs that tilt the shell later have it turn the surface.
    pub fn moment_along_normal(
        &self,
        document: &Document,
        x: &[f64],
    ) -> Option<(usize, usize, Vec3<f64>)> {
        let scene = self.scene(document, x);
        let held = (&self.supports[..], self.node_unknowns);
        let cases = scene.cases.iter().enumerate();
        let mut all = cases
            .flat_map(|(c, case)| (case.iter().enumerate()).map(move |(l, load)| (c, l, load)));
        all.find_map(|(case, number, load)| {
            let Load::Point { nodes, moment, .. } = load else {
                return None;
            };
            let node = along_normal(&scene.structure, held, (nodes.as_str(), moment)).ok()??;
            Some((case, number, scene.structure.nodes[node]))
        })
    }

    /// The structures at the design `x`.
    pub fn scene<S: Scalar>(&self, document: &Document, x: &[S]) -> StaticScene<S> {
        let (mut nodes, mut orientations) = (Vec::new(), Vec::new());
        for structure in document.structures.values() {
            let part = mesh::part(structure, x, self.cuts);
            nodes.extend(part.nodes);
            orientations.extend(part.orientations);
        }
        let of = |s: usize| &document.structures[s];
        let zero = Quantity::fixed(0.0);
        let get = |q: Option<Quantity>| q.unwrap_or(zero).get(x);
        let structure = Structure {
            topology: self.topology.clone(),
            nodes,
            orientations,
            thickness: (self.shells.iter())
                .map(|&(s, slot)| thickness(of(s), slot).get(x))
                .collect(),
            surface_mass: (self.shells.iter())
                .map(|&(s, _)| get(of(s).surface_mass))
                .collect(),
            sections: (self.beams.iter())
                .map(|&(s, slot)| section_at(section(of(s), slot), x))
                .collect(),
            offsets: (self.beams.iter())
                .map(|&(s, _)| of(s).offset.map_or([S::zero(); 2], |o| o.map(|q| q.get(x))))
                .collect(),
            line_mass: (self.beams.iter())
                .map(|&(s, _)| get(of(s).line_mass))
                .collect(),
            masses: (self.masses.iter())
                .map(|&(s, m)| {
                    let mass = &of(s).masses[m];
                    LumpedMass {
                        mass: mass.mass.get(x),
                        inertia: mass.inertia.map_or([S::zero(); 6], |j| j.map(|q| q.get(x))),
                    }
                })
                .collect(),
            materials: document
                .materials
                .values()
                .map(|m| Material {
                    young: m.young.get(x),
                    poisson: m.poisson.get(x),
                    density: get(m.density),
                    yield_stress: m.yield_stress.unwrap_or(Quantity::fixed(1.0)).get(x),
                })
                .collect(),
        };
        let cases = document.load_cases.values();
        let cases = cases.map(|case| case.values().map(|load| self.load(load, x)).collect());
        StaticScene {
            structure,
            cases: cases.collect(),
        }
    }

    fn load<S: Scalar>(&self, load: &CaseLoad, x: &[S]) -> Load<S> {
        let some = |v: &Option<crate::quantity::Vector>| {
            v.as_ref().map_or(Vec3::zeros(), |v| vector(v, x))
        };
        match load {
            CaseLoad::Point {
                nodes,
                force,
                moment,
            } => Load::Point {
                nodes: of_file(nodes, self.cuts),
                force: some(force),
                moment: some(moment),
            },
            CaseLoad::Edge { edges, force } => Load::Edge {
                edges: edges.clone(),
                force: vector(force, x),
            },
            CaseLoad::Line { beams, force } => Load::Line {
                beams: beams.clone(),
                force: vector(force, x),
            },
            CaseLoad::Pressure { faces, pressure } => Load::Pressure {
                faces: faces.clone(),
                pressure: pressure.get(x),
            },
            CaseLoad::Area { faces, force } => Load::Area {
                faces: faces.clone(),
                force: vector(force, x),
            },
            CaseLoad::Gravity { acceleration } => Load::Gravity {
                acceleration: vector(acceleration, x),
            },
        }
    }
}

fn support_of(support: &written::Support, nodes: String) -> Support {
    let held = |which: Held| {
        let held = support.held.as_ref();
        held.is_none_or(|held| held.contains(&which))
    };
    Support {
        nodes,
        displacements: [Held::X, Held::Y, Held::Z].map(held),
        rotations: [Held::Rx, Held::Ry, Held::Rz].map(held),
    }
}
