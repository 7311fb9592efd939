//! How far elements are turned: inside out, or relative to the frame of their body.

use super::parts::{all, gather};
use super::stiffness::split_energy;
use crate::math::{Scalar, Vec3, scalar::lift3};
use crate::model::finite::{FiniteElements, ShellElement};
use crate::structures::shell::basis::Basis;
use crate::structures::turned::{Turned, at_points, surface_turn, turned_line, turned_shell};

/// Tangents of the surface of an element at a point without deformation, and how displacements change them.
type Tangents<S> = [[Vec3<S>; 2]; 2];

/// X,r and X,s, then u,r and u,s at a point of an element, for values `q` of the unknowns of nodes.
fn tangents<S: Scalar>(
    finite: &FiniteElements<S>,
    own: &ShellElement,
    q: &[S],
    basis: &Basis,
) -> Tangents<S> {
    let mesh = &finite.mesh;
    let mut out = [[Vec3::<S>::zeros(); 2]; 2];
    for (along, by) in basis.by.iter().enumerate() {
        for (&node, &slope) in own.nodes.iter().zip(by) {
            let unknowns = mesh.displacements[node];
            let moved = Vec3::from_fn(|k, _| unknowns[k].map_or(S::zero(), |i| q[i]));
            out[0][along] += lift3::<S>(&mesh.nodes[node]) * S::from(slope);
            out[1][along] += moved * S::from(slope);
        }
    }
    out
}

/// The first element whose surface is turned inside out at a Gauss point, for values `q` of the unknowns of nodes:
///
/// ```text
/// (x,r × x,s) · (X,r × X,s) ≤ 0
/// ```
///
/// X are the places of the nodes without deformation, x with it, both in the axes of the frame.
pub fn inside_out<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> Option<usize> {
    let turned = |own: &ShellElement, basis: &Basis| {
        let [[r, s], [by_r, by_s]] = tangents(finite, own, q, basis);
        let after = (r + by_r).cross(&(s + by_s));
        r.cross(&s).dot(&after).re() <= 0.0
    };
    let points = |own: &ShellElement| &own.kind().tables().gauss;
    (finite.mesh.elements.iter()).position(|own| points(own).iter().any(|g| turned(own, g)))
}

/// How far the elements of a body are turned, for values `q` of the unknowns of nodes. Beams come after shells.
pub fn turned(finite: &FiniteElements<f64>, q: &[f64]) -> Turned {
    let mut sum = Turned::default();
    for (i, own) in finite.mesh.elements.iter().enumerate() {
        let squares = at_points(own.kind(), |basis| {
            let [along, by] = tangents(finite, own, q, basis);
            surface_turn(&along, &by)
        });
        let area = own.shares.iter().flatten().sum();
        sum.add(i, &turned_shell(area, split_energy(finite, i, q), squares));
    }
    let shells = finite.mesh.elements.len();
    for (i, (part, coordinates)) in all(finite).enumerate() {
        let own = gather(coordinates, q);
        for strains in part.stiffness.strains.chunk_by(|_, next| !next.axial) {
            let of = |k: usize| {
                let strain = strains.get(k);
                strain.map_or(0.0, |own_strain| {
                    0.5 * own_strain.weight * own_strain.strain.value(&own).powi(2)
                })
            };
            let slope = strains
                .first()
                .map_or(0.0, |strain| strain.strain.slope(&own));
            let energies = [of(0), of(1) + of(2) + of(4) + of(5), of(3)];
            let size = if shells == 0 { 1.0 } else { 0.0 };
            let part = turned_line(size, [slope * slope, 0.0], energies);
            sum.add(shells + i, &part);
        }
    }
    sum
}
