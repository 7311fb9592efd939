//! Supports, and the unknowns that they leave to the nodes.
//!
//! A node on a smooth surface has two unknown rotations, about tangents; a node on a fold or a
//! beam, or any node if six unknowns are requested, three about the global axes. A support fixes
//! displacements and rotations in the global axes. The rotation about a director has no unknown on
//! a smooth surface, so a fixed axis f within 0.1 rad of the director D fixes nothing there; else
//!
//! | fixed axes | unknown rotations |
//! |---|---|
//! | none | t1 = D × e, t2 = D × t1 (e: the global axis least along D) |
//! | f | D × f |
//! | two | about the third axis x, if it is not within 0.1 rad of D |
//! | three | none |

use super::mesh::UnknownSet;
use super::structure::Structure;
use crate::math::{Scalar, Vec3};

/// Sine of the angle below which an axis counts as that of the director.
const ALONG_DIRECTOR: f64 = 0.1;

/// A support of the nodes of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// Name of the set of nodes.
    pub nodes: String,
    /// Which displacements are fixed.
    pub displacements: [bool; 3],
    /// Which rotations are fixed.
    pub rotations: [bool; 3],
}

impl Support {
    /// A clamp: nothing moves.
    pub fn clamp(nodes: &str) -> Self {
        Self::of(nodes, [true; 3], [true; 3])
    }

    /// A support of some displacements and rotations.
    pub fn of(nodes: &str, displacements: [bool; 3], rotations: [bool; 3]) -> Self {
        Self {
            nodes: nodes.to_owned(),
            displacements,
            rotations,
        }
    }
}

/// How many unknowns a node has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeUnknowns {
    /// Five on smooth surfaces, six on folds and beams.
    Natural,
    /// Six everywhere, with a drilling stiffness.
    Six,
}

/// The axes of the unknown rotations of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rotations {
    /// About these global axes.
    Global([bool; 3]),
    /// About t1 = D × e and t2 = D × t1, e a global axis.
    Tangents(usize),
    /// About D × e.
    Across(usize),
}

impl Rotations {
    fn count(self) -> usize {
        match self {
            Self::Global(free) => free.into_iter().filter(|&free| free).count(),
            Self::Tangents(_) => 2,
            Self::Across(_) => 1,
        }
    }

    /// The axes, and how many there are.
    pub(crate) fn axes<S: Scalar>(self, director: Option<&Vec3<S>>) -> ([Vec3<S>; 3], usize) {
        let mut axes = [Vec3::zeros(); 3];
        let d = director.copied().unwrap_or_else(Vec3::zeros);
        match self {
            Self::Global(free) => {
                for (axis, k) in axes.iter_mut().zip((0..3).filter(|&k| free[k])) {
                    *axis = unit(k);
                }
            }
            Self::Tangents(k) => {
                axes[0] = d.cross(&unit(k));
                axes[1] = d.cross(&axes[0]);
            }
            Self::Across(k) => axes[0] = d.cross(&unit(k)),
        }
        (axes, self.count())
    }

    /// Transpose of the derivative of Σ axis_k φ_k by the director, for the cotangent `bar`.
    pub(crate) fn director_transpose<S: Scalar>(
        self,
        d: &Vec3<S>,
        phi: &[S],
        bar: &Vec3<S>,
    ) -> Vec3<S> {
        match self {
            Self::Global(_) => Vec3::zeros(),
            Self::Tangents(k) => {
                let e = unit(k);
                let second = bar * phi[1];
                // θ = (D × e) φ1 + D × (D × e) φ2.
                let first = bar * phi[0] + second.cross(d);
                e.cross(&first) + d.cross(&e).cross(&second)
            }
            Self::Across(k) => unit(k).cross(&(bar * phi[0])),
        }
    }
}

fn unit<S: Scalar>(k: usize) -> Vec3<S> {
    Vec3::from_fn(|i, _| if i == k { S::one() } else { S::zero() })
}

/// The unknowns of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtNode {
    /// Number of each displacement that is not fixed.
    pub displacements: [Option<usize>; 3],
    pub rotations: Rotations,
    /// Number of the first unknown rotation.
    pub first_rotation: usize,
}

/// The unknowns of a structure, numbered node by node.
#[derive(Clone, Debug)]
pub(crate) struct Unknowns {
    pub nodes: Vec<AtNode>,
    pub count: usize,
}

impl Unknowns {
    /// Numbers of the unknown rotations of a node.
    pub(crate) fn rotations_of(&self, node: usize) -> std::ops::Range<usize> {
        let at = &self.nodes[node];
        at.first_rotation..at.first_rotation + at.rotations.count()
    }

    /// Numbers the unknowns that the supports leave, the nodes coming in `order`.
    pub(crate) fn new(
        structure: &Structure<f64>,
        supports: &[Support],
        node_unknowns: NodeUnknowns,
        order: &[usize],
    ) -> Result<Self, UnknownSet> {
        let topology = &structure.topology;
        let mut fixed = vec![([false; 3], [false; 3]); topology.mesh.nodes];
        for support in supports {
            for &node in topology.mesh.node_set(&support.nodes)? {
                for k in 0..3 {
                    fixed[node].0[k] |= support.displacements[k];
                    fixed[node].1[k] |= support.rotations[k];
                }
            }
        }
        let on_beams = topology.mesh.on_beams();
        let directors = topology.sheets.directors(&topology.mesh, &structure.nodes);
        let mut all = Self {
            nodes: vec![
                AtNode {
                    displacements: [None; 3],
                    rotations: Rotations::Global([false; 3]),
                    first_rotation: 0,
                };
                topology.mesh.nodes
            ],
            count: 0,
        };
        for &node in order {
            let (displacements, rotations) = fixed[node];
            let sheets = topology.sheets.of_node[node].clone();
            let at = &mut all.nodes[node];
            for k in 0..3 {
                if !displacements[k] {
                    at.displacements[k] = Some(all.count);
                    all.count += 1;
                }
            }
            let smooth_here = sheets.len() == 1 && !on_beams[node];
            at.rotations = if smooth_here && node_unknowns == NodeUnknowns::Natural {
                smooth(&directors[sheets.start], rotations)
            } else {
                Rotations::Global(rotations.map(|fixed| !fixed))
            };
            at.first_rotation = all.count;
            all.count += at.rotations.count();
        }
        Ok(all)
    }
}

/// The rotations of a node on a smooth surface.
fn smooth(director: &Vec3<f64>, fixed: [bool; 3]) -> Rotations {
    let across = |k: usize| director.cross(&unit(k)).norm();
    let count = fixed.into_iter().filter(|&fixed| fixed).count();
    let least = (0..3).min_by(|&a, &b| director[a].abs().total_cmp(&director[b].abs()));
    let tangents = Rotations::Tangents(least.unwrap_or(0));
    let none = Rotations::Global([false; 3]);
    let only = |value: bool| (0..3).find(|&k| fixed[k] == value).unwrap_or(0);
    match count {
        0 => tangents,
        1 if across(only(true)) > ALONG_DIRECTOR => Rotations::Across(only(true)),
        1 => tangents,
        2 if across(only(false)) > ALONG_DIRECTOR => Rotations::Global(fixed.map(|fixed| !fixed)),
        _ => none,
    }
}
