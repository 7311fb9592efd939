//! What no design changes of the shells of a body.

use crate::model::finite::ElementMesh;
use crate::structures::floating::PointMotion;
use crate::structures::mesh::Mesh;
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
    /// The named points.
    pub points: IndexMap<String, PointMotion>,
}
