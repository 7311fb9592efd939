//! What no design changes of the shells of a body.

use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::model::finite::ElementMesh;
use flexbody_mechanics::structures::floating::{NodeMotion, PointMotion};
use flexbody_mechanics::structures::mesh::Mesh;
use flexbody_mechanics::system::reduction::{ProjectedShells, ReducedBasis};
use indexmap::IndexMap;
use std::sync::Arc;

/// What no design changes of the shells of a body.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The mesh in its frame.
    pub mesh: Arc<ElementMesh>,
    /// Sets of the mesh.
    pub sets: Mesh,
    /// Which thickness each shell has.
    pub slots: Vec<usize>,
    /// Beams, then lumped masses.
    pub parts: Vec<WrittenPart>,
    /// The named points, by the coordinates of the body.
    pub points: IndexMap<String, PointMotion>,
    /// The nodes of each point all of whose nodes follow, as unknowns of the body; none if the vectors of a basis
    /// follow.
    pub ties: IndexMap<String, Vec<NodeMotion>>,
    /// The basis, if coordinates are not all unknowns of the nodes.
    pub reduced: Option<ReducedBody>,
}

/// A beam or a lumped mass of a body.
#[derive(Clone, Debug)]
pub struct WrittenPart {
    /// Where the file has its numbers.
    pub source: PartSource,
    /// Its nodes: three of a beam, one of a mass.
    pub nodes: Vec<NodeMotion>,
    /// Of a beam: a vector in the plane of it and axis 2 of its section.
    pub orientation: Vec3<f64>,
}

/// Where a file has the numbers of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartSource {
    /// A beam of the mesh, with the section of this number.
    Beam(usize),
    /// A beam of the stiffener of this number.
    Stiffener(usize),
    /// The mass of this number.
    Mass(usize),
}

/// Shells in a basis.
#[derive(Clone, Debug)]
pub struct ReducedBody {
    /// Their parts.
    pub shells: ProjectedShells,
    /// The vectors of the basis; `None` for a rigid body.
    pub basis: Option<ReducedBasis>,
}

impl Prepared {
    /// Number of coordinates of the body.
    pub fn coordinates(&self) -> usize {
        let reduced = self.reduced.as_ref();
        reduced.map_or(self.mesh.coordinates, |own| own.shells.modes())
    }
}
