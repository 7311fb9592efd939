//! What no design changes of the shells of a body.

use crate::model::finite::ElementMesh;
use crate::structures::floating::PointMotion;
use crate::structures::mesh::Mesh;
use crate::system::reduction::{ProjectedShells, ReducedBasis};
use indexmap::IndexMap;
use std::sync::Arc;

/// What no design changes of the shells of a body.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    /// The mesh in its frame.
    pub mesh: Arc<ElementMesh>,
    /// Sets of the mesh.
    pub sets: Mesh,
    /// Which thickness each shell has.
    pub slots: Vec<usize>,
    /// The named points, by the coordinates of the body.
    pub points: IndexMap<String, PointMotion>,
    /// The basis, if coordinates are not all unknowns of the nodes.
    pub reduced: Option<ReducedBody>,
}

/// Shells in a basis.
#[derive(Clone, Debug)]
pub(crate) struct ReducedBody {
    /// Their parts.
    pub shells: ProjectedShells,
    /// What the basis is made of; `None` of a rigid body.
    pub basis: Option<ReducedBasis>,
}

impl Prepared {
    /// Number of coordinates of the body.
    pub(crate) fn coordinates(&self) -> usize {
        let reduced = self.reduced.as_ref();
        reduced.map_or(self.mesh.coordinates, |own| own.shells.modes())
    }
}
