//! How far elements are turned: inside out, or relative to the frame of their body.

use crate::math::{Scalar, Vec3, scalar::lift3};
use crate::model::finite::{FiniteElements, ShellElement};
use crate::structures::shell::basis::{Basis, TABLES};

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
pub(crate) fn inside_out<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> Option<usize> {
    let turned = |own: &ShellElement, basis: &Basis| {
        let [[r, s], [by_r, by_s]] = tangents(finite, own, q, basis);
        let after = (r + by_r).cross(&(s + by_s));
        r.cross(&s).dot(&after).re() <= 0.0
    };
    (finite.mesh.elements.iter()).position(|own| TABLES.gauss.iter().any(|g| turned(own, g)))
}

/// The largest rotation of the surface at a Gauss point of an element \[rad\], to first order in the displacements u,
/// with the number of the element:
///
/// ```text
/// t = a^r × u,r + a^s × u,s,   θ = t − ½ (n · t) n
/// ```
///
/// a^r and a^s are the reciprocal tangents, n is the normal.
pub(crate) fn turn<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> (f64, usize) {
    let angle = |own: &ShellElement, basis: &Basis| {
        let [[r, s], [by_r, by_s]] = tangents(finite, own, q, basis);
        let normal = r.cross(&s);
        let square = normal.dot(&normal);
        let along = [s.cross(&normal), normal.cross(&r)];
        let turned = (along[0].cross(&by_r) + along[1].cross(&by_s)) * (S::one() / square);
        let twice = normal * (turned.dot(&normal) / square);
        let theta = turned - twice * S::from(0.5);
        theta.dot(&theta).re().sqrt()
    };
    let mut most = (0.0, 0);
    for (i, own) in finite.mesh.elements.iter().enumerate() {
        for basis in &TABLES.gauss {
            let own = angle(own, basis);
            if own > most.0 {
                most = (own, i);
            }
        }
    }
    most
}
