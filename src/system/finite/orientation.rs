//! Elements that are turned inside out.

use crate::math::{Scalar, Vec3, scalar::lift3};
use crate::model::finite::{FiniteElements, NODES};
use crate::structures::shell::basis::{Basis, TABLES};

/// The first element whose surface is turned inside out at a Gauss point, for values `q` of the unknowns of nodes:
///
/// ```text
/// (x,r × x,s) · (X,r × X,s) ≤ 0
/// ```
///
/// X are the places of the nodes without deformation, x with it, both in the axes of the frame.
pub(crate) fn inside_out<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> Option<usize> {
    let mesh = &finite.mesh;
    let displacement = |node: usize| {
        let unknowns = mesh.displacements[node];
        Vec3::from_fn(|k, _| unknowns[k].map_or(S::zero(), |i| q[i]))
    };
    let turned = |nodes: &[usize; NODES], basis: &Basis| {
        let mut tangents = [[Vec3::<S>::zeros(); 2]; 2];
        for (along, by) in basis.by.iter().enumerate() {
            for (&node, &slope) in nodes.iter().zip(by) {
                let before = lift3::<S>(&mesh.nodes[node]);
                tangents[0][along] += before * S::from(slope);
                tangents[1][along] += (before + displacement(node)) * S::from(slope);
            }
        }
        let [before, after] = tangents.map(|[r, s]| r.cross(&s));
        before.dot(&after).re() <= 0.0
    };
    (mesh.elements.iter()).position(|own| TABLES.gauss.iter().any(|g| turned(&own.nodes, g)))
}
