//! Loads of a structure. They are dead: neither place nor direction follows the motion.
//!
//! A load case has the work W(v) = f·v at a motion v. Its derivative by v is the load vector f; with
//! dual numbers its derivatives by structure and loads are those of ψ·f.

use super::beam::BeamMotion;
use super::mesh::{Edge, UnknownSet};
use super::normal_moment;
use super::shell::{Motion, ShellKind};
use super::state::{Configuration, Cotangent, NodalMotion};
use crate::math::{Scalar, Vec3, scalar::length};
use std::collections::BTreeMap;

/// A load. Sets are named.
#[derive(Clone, Debug, PartialEq)]
pub enum Load<S> {
    /// A force \[N\] and a moment [N m] on every node of a set.
    Point {
        /// Set of nodes.
        nodes: String,
        /// Force on each node.
        force: Vec3<S>,
        /// Moment on each node. Where a node has no unknown rotation about its director, the part along it
        /// turns the surface.
        moment: Vec3<S>,
    },
    /// A force per length on edges [N/m].
    Edge {
        /// Set of edges.
        edges: String,
        /// Force per length.
        force: Vec3<S>,
    },
    /// A force per length on beams [N/m], at the centres of their sections.
    Line {
        /// Set of beams.
        beams: String,
        /// Force per length.
        force: Vec3<S>,
    },
    /// A pressure along the normals of shells \[Pa\].
    Pressure {
        /// Set of faces.
        faces: String,
        /// Pressure; positive along the normal.
        pressure: S,
    },
    /// A force per area on shells \[Pa\], in a fixed direction.
    Area {
        /// Set of faces.
        faces: String,
        /// Force per area.
        force: Vec3<S>,
    },
    /// Weight: an acceleration of all masses [m/s²].
    Gravity {
        /// Acceleration.
        acceleration: Vec3<S>,
    },
}

impl<S: Scalar> Load<S> {
    /// The numbers of the load, in the order in which [`Load::map`] takes them.
    pub fn values(&self) -> Vec<S> {
        let mut all = Vec::new();
        self.map(|x| {
            all.push(x);
            x
        });
        all
    }

    /// The load in another scalar.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Load<T> {
        match self {
            Self::Point {
                nodes,
                force,
                moment,
            } => Load::Point {
                nodes: nodes.clone(),
                force: force.map(&mut f),
                moment: moment.map(&mut f),
            },
            Self::Edge { edges, force } => Load::Edge {
                edges: edges.clone(),
                force: force.map(&mut f),
            },
            Self::Line { beams, force } => Load::Line {
                beams: beams.clone(),
                force: force.map(&mut f),
            },
            Self::Pressure { faces, pressure } => Load::Pressure {
                faces: faces.clone(),
                pressure: f(*pressure),
            },
            Self::Area { faces, force } => Load::Area {
                faces: faces.clone(),
                force: force.map(&mut f),
            },
            Self::Gravity { acceleration } => Load::Gravity {
                acceleration: acceleration.map(&mut f),
            },
        }
    }
}

/// Shape functions of an edge at Gauss points, their slopes, and weights: of three nodes, or of the first two. The tangent
/// of an edge of two nodes is constant.
fn edge_points(edge: &Edge) -> [([f64; 3], [f64; 3], f64); 3] {
    let c = 0.6_f64.sqrt();
    [(-c, 5.0 / 9.0), (0.0, 8.0 / 9.0), (c, 5.0 / 9.0)].map(|(x, weight)| match edge.len() {
        2 => {
            let n = [0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.0];
            (n, [-0.5, 0.5, 0.0], weight)
        }
        _ => {
            let n = [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)];
            (n, [x - 0.5, -2.0 * x, x + 0.5], weight)
        }
    })
}

/// ∫ N_a dl of the nodes of edges \[m\].
pub fn edge_shares(nodes: &[Vec3<f64>], edges: &[Edge]) -> BTreeMap<usize, f64> {
    let mut shares = BTreeMap::new();
    for edge in edges {
        for (n, slope, weight) in edge_points(edge) {
            let along = edge.iter().zip(&slope);
            let tangent = along.fold(Vec3::zeros(), |sum: Vec3<f64>, (&node, w)| {
                sum + nodes[node] * *w
            });
            for (&node, n) in edge.iter().zip(&n) {
                *shares.entry(node).or_default() += n * weight * tangent.norm();
            }
        }
    }
    shares
}

/// Adds the derivatives of the work of a load, whose sets exist, at a motion: by the motion to
/// `force`, by the structure to `to`, by the load to `load_to`.
pub fn add_work_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    load: &Load<S>,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
    load_to: &mut Load<S>,
) -> Result<(), UnknownSet> {
    let mesh = &configuration.structure.topology.mesh;
    match (load, load_to) {
        (
            Load::Point {
                nodes,
                force: f,
                moment: m,
            },
            Load::Point {
                force: f_to,
                moment: m_to,
                ..
            },
        ) => {
            for &node in mesh.node_set(nodes)? {
                force.displacement[node] += f;
                *f_to += motion.displacement[node];
                if let Some(director) = configuration.surface_director(node) {
                    let at = (node, director);
                    *m_to += normal_moment::add_transpose(configuration, at, m, motion, force, to);
                } else {
                    force.rotation[node] += m;
                    *m_to += motion.rotation[node];
                }
            }
        }
        (Load::Edge { edges, force: f }, Load::Edge { force: f_to, .. }) => {
            for edge in mesh.edge_set(edges)? {
                add_edge_transpose(configuration, edge, f, motion, force, to, f_to);
            }
        }
        (Load::Line { beams, force: f }, Load::Line { force: f_to, .. }) => {
            for &beam in mesh.beam_set(beams)? {
                *f_to += add_beam_transpose(configuration, beam, f, false, motion, force, to);
            }
        }
        (Load::Pressure { faces, pressure }, Load::Pressure { pressure: p_to, .. }) => {
            for &shell in mesh.face_set(faces)? {
                add_pressure_transpose(configuration, shell, *pressure, motion, force, to, p_to);
            }
        }
        (Load::Area { faces, force: f }, Load::Area { force: f_to, .. }) => {
            for &shell in mesh.face_set(faces)? {
                add_area_transpose(configuration, shell, f, motion, force, to, f_to);
            }
        }
        (Load::Gravity { acceleration }, Load::Gravity { acceleration: g_to }) => {
            for shell in 0..mesh.shells.len() {
                add_gravity_transpose(configuration, shell, acceleration, motion, force, to, g_to);
            }
            for beam in 0..mesh.beams.len() {
                *g_to +=
                    add_beam_transpose(configuration, beam, acceleration, true, motion, force, to);
            }
            let nodes = &configuration.structure.topology.mass_nodes;
            for (k, &node) in nodes.iter().enumerate() {
                let (mass, u) = (
                    configuration.structure.masses[k].mass,
                    &motion.displacement[node],
                );
                force.displacement[node] += acceleration * mass;
                *g_to += u * mass;
                to.structure.masses[k].mass += acceleration.dot(u);
            }
        }
        _ => unreachable!("a load and its cotangent are of one kind"),
    }
    Ok(())
}

/// The part of a beam in the work of a line load, or with `of_mass` of gravity; gives that by the load.
fn add_beam_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    index: usize,
    f: &Vec3<S>,
    of_mass: bool,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
) -> Vec3<S> {
    let element = &configuration.structure.topology.mesh.beams[index];
    let (beam, mut part) = (configuration.beam(index), BeamMotion::zeros());
    let (v, mut bar) = (motion.of_beam(element), beam.zeros());
    let by_f = beam.add_line_work_transpose(f, of_mass, &v, &mut part, &mut bar);
    force.add_of_beam_transpose(element, &part);
    configuration.add_beam_transpose(index, &bar, to);
    by_f
}

fn add_edge_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    edge: &Edge,
    f: &Vec3<S>,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
    f_to: &mut Vec3<S>,
) {
    let sum = |weights: &[f64; 3], list: &[Vec3<S>]| {
        edge.iter()
            .zip(weights)
            .fold(Vec3::zeros(), |sum, (&node, &w)| {
                sum + list[node] * S::from(w)
            })
    };
    for (n, slope, weight) in edge_points(edge) {
        let tangent = sum(&slope, &configuration.structure.nodes);
        let speed = length(&tangent);
        let u = sum(&n, &motion.displacement);
        let (dl, work) = (speed * weight, f.dot(&u));
        *f_to += u * dl;
        for (k, &node) in edge.iter().enumerate() {
            force.displacement[node] += f * (dl * n[k]);
            to.structure.nodes[node] += tangent * (work * weight * slope[k] / speed);
        }
    }
}

fn add_pressure_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    shell: usize,
    pressure: S,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
    p_to: &mut S,
) {
    let element = &configuration.structure.topology.mesh.shells[shell];
    let tables = ShellKind::of(element).tables();
    for (basis, &weight) in tables.gauss.iter().zip(&tables.weights) {
        let mut tangents = [Vec3::zeros(); 2];
        let mut u = Vec3::zeros();
        for (a, &node) in element.iter().enumerate() {
            let x = &configuration.structure.nodes[node];
            tangents[0] += x * S::from(basis.by[0][a]);
            tangents[1] += x * S::from(basis.by[1][a]);
            u += motion.displacement[node] * S::from(basis.n[a]);
        }
        let normal = tangents[0].cross(&tangents[1]);
        *p_to += normal.dot(&u) * weight;
        let by_normal = u * (pressure * weight);
        let by_tangents = [tangents[1].cross(&by_normal), by_normal.cross(&tangents[0])];
        for (a, &node) in element.iter().enumerate() {
            force.displacement[node] += normal * (pressure * (weight * basis.n[a]));
            to.structure.nodes[node] +=
                by_tangents[0] * S::from(basis.by[0][a]) + by_tangents[1] * S::from(basis.by[1][a]);
        }
    }
}

/// Displacement of an element of the shape functions `n` \[m\].
fn displacement<S: Scalar>(motion: &Motion<S>, n: &[f64]) -> Vec3<S> {
    let nodes = motion.displacement.iter().zip(n);
    nodes.fold(Vec3::zeros(), |u, (of_node, n)| u + of_node * S::from(*n))
}

fn add_area_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    shell: usize,
    f: &Vec3<S>,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
    f_to: &mut Vec3<S>,
) {
    let element = &configuration.structure.topology.mesh.shells[shell];
    let (shape, motion) = (configuration.shell(shell), motion.of_element(element));
    let mut bar = super::shell::ShellCotangent::zeros();
    for (k, basis) in shape.gauss() {
        let u = displacement(&motion, &basis.n);
        let area = shape.area(k);
        *f_to += u * area;
        shape.add_area_transpose(k, f.dot(&u), &mut bar.geometry);
        for (a, &node) in element.iter().enumerate() {
            force.displacement[node] += f * (area * basis.n[a]);
        }
    }
    configuration.add_shell_transpose(shell, &bar, to);
}

fn add_gravity_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    shell: usize,
    g: &Vec3<S>,
    motion: &NodalMotion<S>,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
    g_to: &mut Vec3<S>,
) {
    // The work is the bilinear form of the mass with the motion and a field that is g everywhere.
    let element = &configuration.structure.topology.mesh.shells[shell];
    let (shape, motion) = (configuration.shell(shell), motion.of_element(element));
    let mut bar = super::shell::ShellCotangent::zeros();
    for (k, basis) in shape.gauss() {
        let u = displacement(&motion, &basis.n);
        let area = shape.area(k);
        let mass = shape.mass_per_area();
        *g_to += u * (area * mass);
        let work = g.dot(&u);
        shape.add_mass_per_area_transpose(work * area, &mut bar);
        shape.add_area_transpose(k, work * mass, &mut bar.geometry);
        for (a, &node) in element.iter().enumerate() {
            force.displacement[node] += g * (area * mass * basis.n[a]);
        }
    }
    configuration.add_shell_transpose(shell, &bar, to);
}
