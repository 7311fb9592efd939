//! Supports, and the unknowns that they leave to the nodes.
//!
//! A node on a smooth surface has two unknown rotations, about tangents; a node on a fold or a
//! beam three about the global axes. If six unknowns are requested, a node on a smooth surface also has
//! one about its director D. A support fixes displacements and rotations in the global axes.
//!
//! The surface holds the rotation about D to its own, so a fixed axis f of a smooth node fixes the
//! rotation about P f, its projection on the tangent plane: a structure that is turned with its supports
//! stays the same, and what is fixed in addition makes it no softer (but for the error of directors). With
//! s the sine below which an axis counts as along D (see `along_director`):
//!
//! | fixed axes | unknown rotations about tangents | about D |
//! |---|---|---|
//! | none | t1 = D × e, t2 = D × t1 (e: the global axis least along D) | free |
//! | f, \|P f\| > s | D × f | free |
//! | f, \|P f\| ≤ s | t1, t2 | fixed |
//! | two, of which x is the third axis, \|D·x\| > s | none | free |
//! | two, \|D·x\| ≤ s | x | fixed |
//! | three | none | fixed |

use super::mesh::UnknownSet;
use super::structure::Structure;
use crate::math::{Scalar, Vec3};

/// How well the axes of an input are known \[rad\].
const ROUNDED: f64 = 1e-5;
/// Sine of the angle below which an axis counts as along a director: where a surface ends at a plane of
/// symmetry, its director lies in this plane only but for the error of the interpolated surface.
pub(super) fn along_director(error: f64) -> f64 {
    ROUNDED + error
}

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
pub enum Rotations {
    /// About these global axes.
    Global([bool; 3]),
    /// Those of a node on a smooth surface.
    Smooth(Tangents, Normal),
}

/// The unknown rotations of a smooth node about tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tangents {
    /// About t1 = D × e and t2 = D × t1, e a global axis.
    Both(usize),
    /// About D × e.
    Across(usize),
    /// None.
    Fixed,
}

/// What holds the rotation of a smooth node about its director.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// A support.
    Fixed,
    /// It is that of the surface.
    Surface,
    /// It is an unknown, with a stiffness against that of the surface.
    Unknown,
}

impl Rotations {
    fn count(self) -> usize {
        match self {
            Self::Global(free) => free.into_iter().filter(|&free| free).count(),
            Self::Smooth(tangents, normal) => {
                tangents.count() + usize::from(normal == Normal::Unknown)
            }
        }
    }

    /// The axes, which are orthogonal, and how many there are.
    pub fn axes<S: Scalar>(self, director: Option<&Vec3<S>>) -> ([Vec3<S>; 3], usize) {
        let mut axes = [Vec3::zeros(); 3];
        match self {
            Self::Global(free) => {
                for (axis, k) in axes.iter_mut().zip((0..3).filter(|&k| free[k])) {
                    *axis = unit(k);
                }
            }
            Self::Smooth(tangents, normal) => {
                let d = director.copied().unwrap_or_else(Vec3::zeros);
                match tangents {
                    Tangents::Both(k) => {
                        axes[0] = d.cross(&unit(k));
                        axes[1] = d.cross(&axes[0]);
                    }
                    Tangents::Across(k) => axes[0] = d.cross(&unit(k)),
                    Tangents::Fixed => {}
                }
                if normal == Normal::Unknown {
                    axes[tangents.count()] = d;
                }
            }
        }
        (axes, self.count())
    }

    /// Transpose of the derivative of [`Rotations::axes`] by the director.
    pub fn axes_transpose<S: Scalar>(self, d: &Vec3<S>, bars: &[Vec3<S>; 3]) -> Vec3<S> {
        let Self::Smooth(tangents, normal) = self else {
            return Vec3::zeros();
        };
        let by_tangents = match tangents {
            Tangents::Both(k) => {
                let e = unit(k);
                e.cross(&(bars[0] + bars[1].cross(d))) + d.cross(&e).cross(&bars[1])
            }
            Tangents::Across(k) => unit(k).cross(&bars[0]),
            Tangents::Fixed => Vec3::zeros(),
        };
        match normal {
            Normal::Unknown => by_tangents + bars[tangents.count()],
            Normal::Fixed | Normal::Surface => by_tangents,
        }
    }
}

impl Tangents {
    fn count(self) -> usize {
        match self {
            Self::Both(_) => 2,
            Self::Across(_) => 1,
            Self::Fixed => 0,
        }
    }
}

fn unit<S: Scalar>(k: usize) -> Vec3<S> {
    Vec3::from_fn(|i, _| if i == k { S::one() } else { S::zero() })
}

/// The unknowns of a node.
#[derive(Clone, Copy, Debug)]
pub struct AtNode {
    /// Number of each displacement that is not fixed.
    pub displacements: [Option<usize>; 3],
    pub rotations: Rotations,
    /// Number of the first unknown rotation.
    pub first_rotation: usize,
}

/// The unknowns of a structure, numbered node by node.
#[derive(Clone, Debug)]
pub struct Unknowns {
    pub nodes: Vec<AtNode>,
    pub count: usize,
}

impl Unknowns {
    /// Numbers of the unknown rotations of a node.
    pub fn rotations_of(&self, node: usize) -> std::ops::Range<usize> {
        let at = &self.nodes[node];
        at.first_rotation..at.first_rotation + at.rotations.count()
    }

    /// Numbers the unknowns that the supports leave, the nodes coming in `order`.
    pub fn new(
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
        let sheets = &topology.sheets;
        let errors = sheets.errors(&topology.mesh, &structure.nodes, &directors);
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
            let free = match node_unknowns {
                NodeUnknowns::Natural => Normal::Surface,
                NodeUnknowns::Six => Normal::Unknown,
            };
            at.rotations = match smooth_here {
                true => {
                    let along = along_director(errors[node]);
                    smooth(&directors[sheets.start], along, rotations, free)
                }
                false => Rotations::Global(rotations.map(|fixed| !fixed)),
            };
            at.first_rotation = all.count;
            all.count += at.rotations.count();
        }
        Ok(all)
    }
}

/// The rotations of a node on a smooth surface; `free` is what holds that about the director if no support
/// does.
fn smooth(director: &Vec3<f64>, along: f64, fixed: [bool; 3], free: Normal) -> Rotations {
    let off_director = |k: usize| director.cross(&unit(k)).norm();
    let least = (0..3).min_by(|&a, &b| director[a].abs().total_cmp(&director[b].abs()));
    let both = Tangents::Both(least.unwrap_or(0));
    let axes: Vec<usize> = (0..3).filter(|&k| fixed[k]).collect();
    let (tangents, normal) = match axes[..] {
        [] if free == Normal::Unknown => return Rotations::Global([true; 3]),
        [] => (both, free),
        [k] if off_director(k) > along => (Tangents::Across(k), free),
        [_] => (both, Normal::Fixed),
        [a, b] if director[3 - a - b].abs() > along => (Tangents::Fixed, free),
        // About the third axis, which is a tangent but for the error of the director.
        [_, _] => return Rotations::Global(fixed.map(|fixed| !fixed)),
        _ => (Tangents::Fixed, Normal::Fixed),
    };
    Rotations::Smooth(tangents, normal)
}
