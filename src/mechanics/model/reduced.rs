//! Shells of a flexible body in a reduced basis: all unknowns v of the nodes are combinations v = V q of the
//! vectors of a constant basis.
//!
//! Von Karman's strains are quadratic in v, so the strain energy has products of coordinates,
//!
//! ```text
//! U = ½ qᵀ K q + qᵀ C s + ½ sᵀ G s,     s_k = q_i q_j  for the pairs i ≤ j of coordinates that bend
//! ```
//!
//! exactly that of the shells for motions of the basis.

use super::finite::FiniteElements;
use crate::math::{Scalar, parameters};
use std::sync::Arc;

/// Further numbers of a body whose shapes are those of shells, besides integrals and stiffness.
#[derive(Clone, Debug)]
pub struct ReducedShells<S> {
    /// V.
    pub basis: Arc<NodalBasis>,
    /// C and G.
    pub pairs: PairEnergy<S>,
    /// The shells, for their stresses.
    pub elements: FiniteElements<S>,
}

parameters!(struct ReducedShells { basis; pairs, elements });

impl<S: Scalar> ReducedShells<S> {
    /// v = V q.
    pub fn unknowns(&self, q: &[S]) -> Vec<S> {
        let mut out = vec![S::zero(); self.elements.mesh.coordinates];
        for (vector, &q) in self.basis.vectors.iter().zip(q) {
            for (out, &v) in out.iter_mut().zip(vector) {
                *out += q * v;
            }
        }
        out
    }
}

/// Values of the unknowns of all nodes in each vector of a basis.
#[derive(Clone, Debug)]
pub struct NodalBasis {
    /// The vectors.
    pub vectors: Vec<Vec<f64>>,
}

impl NodalBasis {
    /// An unknown at the coordinates q.
    pub fn unknown<S: Scalar>(&self, unknown: usize, q: &[S]) -> S {
        let all = self.vectors.iter().zip(q);
        all.fold(S::zero(), |sum, (vector, &q)| sum + q * vector[unknown])
    }

    /// Transpose of [`NodalBasis::unknown`], added to the cotangent of the coordinates.
    pub fn add_unknown<S: Scalar>(&self, unknown: usize, by: S, out: &mut [S]) {
        for (out, vector) in out.iter_mut().zip(&self.vectors) {
            *out += by * vector[unknown];
        }
    }

    /// Adds Vᵀ x.
    pub fn add_transposed(&self, x: &[f64], out: &mut [f64]) {
        for (vector, out) in self.vectors.iter().zip(out) {
            *out += crate::math::slices::dot(vector, x);
        }
    }
}

/// Energy in products of coordinates.
#[derive(Clone, Debug)]
pub struct PairEnergy<S> {
    /// The coordinates that bend, a of them; s has n = a (a + 1) / 2 products of two, by rows of the upper
    /// triangle.
    pub of: Vec<usize>,
    /// C, m × n by rows \[N/m² for coordinates in metres\].
    pub cubic: Vec<S>,
    /// G, symmetric, n (n + 1) / 2 by rows of the upper triangle \[N/m³\].
    pub quartic: Vec<S>,
}

parameters!(struct PairEnergy { of; cubic, quartic });

impl<S> PairEnergy<S> {
    /// The pairs of coordinates.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let of = &self.of;
        (0..of.len()).flat_map(move |i| of[i..].iter().map(move |&j| (of[i], j)))
    }

    /// Number of pairs.
    pub fn count(&self) -> usize {
        self.of.len() * (self.of.len() + 1) / 2
    }
}
