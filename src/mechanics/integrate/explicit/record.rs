//! The results of a step of DOP853: its end, its stages, and the motion inside it.

use super::tableau::{ALL, dense_weights};
use crate::linalg::SolveScalar;
use crate::math::Scalar;
use crate::system::Numbering;

/// State at the end of a step with its accelerations. V is a vector or a slice.
#[derive(Clone, Copy, Debug)]
pub struct Node<V> {
    /// Positions.
    pub q: V,
    /// Velocities.
    pub v: V,
    /// Accelerations.
    pub a: V,
    /// Multipliers λ.
    pub lambda: V,
}

/// A view of a node.
pub type NodeView<'a, S> = Node<&'a [S]>;
/// A view of a step.
pub type StepView<'a, S> = StepData<&'a [S]>;

impl<V> Node<V> {
    /// Lengths of its vectors.
    pub fn lengths(numbering: &Numbering) -> [usize; 4] {
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        [nq, nv, nv, numbering.constraints()]
    }
}

impl<S> Node<Vec<S>> {
    /// A view of it.
    pub fn view(&self) -> Node<&[S]> {
        Node {
            q: &self.q,
            v: &self.v,
            a: &self.a,
            lambda: &self.lambda,
        }
    }
}

/// All results of a step. Row i of `q`, `v`, `qdot`, `a`, `lambda` belongs to stage i. V is a
/// vector or a slice.
#[derive(Clone, Copy, Debug)]
pub struct StepData<V> {
    /// Positions of the stages; their Euler parameters do not have unit length.
    pub q: V,
    /// Velocities of the stages.
    pub v: V,
    /// Rates q̇ = T(q) v.
    pub qdot: V,
    /// Accelerations.
    pub a: V,
    /// Multipliers λ.
    pub lambda: V,
    /// Positions before the projection.
    pub q_raw: V,
    /// Velocities before the projection.
    pub v_raw: V,
    /// Multipliers s of the position projection.
    pub s: V,
    /// Correction of the velocities.
    pub delta: V,
    /// Multipliers σ of the velocity projection.
    pub sigma: V,
    /// Whether the stages of the dense output were computed.
    pub dense: bool,
}

impl<V> StepData<V> {
    /// Lengths of its vectors for a number of stages.
    pub fn lengths(numbering: &Numbering, stages: usize) -> [usize; 10] {
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nc = numbering.constraints();
        let rows = [nq, nv, nq, nv, nc].map(|n| stages * n);
        let [a, b, c, d, e] = rows;
        [a, b, c, d, e, nq, nv, nc, nv, nc]
    }

    /// The step with these vectors.
    pub fn of_parts(parts: [V; 10], dense: bool) -> Self {
        let [q, v, qdot, a, lambda, q_raw, v_raw, s, delta, sigma] = parts;
        Self {
            q,
            v,
            qdot,
            a,
            lambda,
            q_raw,
            v_raw,
            s,
            delta,
            sigma,
            dense,
        }
    }

    /// Its vectors.
    pub fn parts(self) -> [V; 10] {
        [
            self.q,
            self.v,
            self.qdot,
            self.a,
            self.lambda,
            self.q_raw,
            self.v_raw,
            self.s,
            self.delta,
            self.sigma,
        ]
    }
}

impl<S: SolveScalar> StepData<Vec<S>> {
    /// A step of zeros.
    pub(super) fn new(numbering: &Numbering) -> Self {
        let parts = Self::lengths(numbering, ALL).map(|n| vec![S::zero(); n]);
        Self::of_parts(parts, false)
    }

    /// Takes the stages of another, which may be without those of the dense output.
    pub(super) fn set(&mut self, other: StepData<&[S]>) {
        self.dense = other.dense;
        let own = [
            &mut self.q,
            &mut self.v,
            &mut self.qdot,
            &mut self.a,
            &mut self.lambda,
            &mut self.q_raw,
            &mut self.v_raw,
            &mut self.s,
            &mut self.delta,
            &mut self.sigma,
        ];
        for (own, other) in own.into_iter().zip(other.parts()) {
            own[..other.len()].copy_from_slice(other);
        }
    }

    /// A view of it.
    pub fn view(&self) -> StepData<&[S]> {
        StepData {
            q: &self.q,
            v: &self.v,
            qdot: &self.qdot,
            a: &self.a,
            lambda: &self.lambda,
            q_raw: &self.q_raw,
            v_raw: &self.v_raw,
            s: &self.s,
            delta: &self.delta,
            sigma: &self.sigma,
            dense: self.dense,
        }
    }
}

impl<S: SolveScalar> StepData<&[S]> {
    /// State and derivative at the fraction θ of a step of size h from `node`: q before its Euler
    /// parameters are normalised, v, and the derivative of v.
    pub(super) fn dense(self, node: Node<&[S]>, h: S, theta: f64, [q, v, a]: [&mut [S]; 3]) {
        let (w, rate) = dense_weights(theta);
        q.copy_from_slice(node.q);
        v.copy_from_slice(node.v);
        a.fill(S::zero());
        add_rows(q, h, &w, self.qdot, (node.q.len(), 0));
        add_rows(v, h, &w, self.a, (node.v.len(), 0));
        add_rows(a, S::one(), &rate, self.a, (node.v.len(), 0));
    }
}

/// Adds `scale` · Σ w_i · (row i of `rows`) to `out`. `out` corresponds to the part of every row
/// that starts at `at`; rows have length `width`.
pub fn add_rows<S: Scalar>(
    out: &mut [S],
    scale: S,
    weights: &[(usize, f64)],
    rows: &[S],
    (width, at): (usize, usize),
) {
    // As many sums at a time as fit into registers.
    let mut done = 0;
    while let Some(left) = out.len().checked_sub(done).filter(|&left| left > 0) {
        let (out, from) = (&mut out[done..], (width, at + done));
        done += match left {
            8.. => add_block::<S, 8>(out, scale, weights, rows, from),
            4.. => add_block::<S, 4>(out, scale, weights, rows, from),
            2.. => add_block::<S, 2>(out, scale, weights, rows, from),
            _ => add_block::<S, 1>(out, scale, weights, rows, from),
        };
    }
}

/// The first N numbers of [`add_rows`]; returns N.
fn add_block<S: Scalar, const N: usize>(
    out: &mut [S],
    scale: S,
    weights: &[(usize, f64)],
    rows: &[S],
    (width, at): (usize, usize),
) -> usize {
    let mut sum = [S::zero(); N];
    for &(i, weight) in weights {
        let row = &rows[i * width + at..][..N];
        for k in 0..N {
            sum[k] += row[k] * weight;
        }
    }
    for (out, sum) in out.iter_mut().zip(sum) {
        *out += scale * sum;
    }
    N
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_any_length_are_added() {
        let width = 31;
        let rows: Vec<f64> = (0..3 * width).map(|k| (k * k % 17) as f64).collect();
        let weights = [(0, 0.5), (2, -2.0)];
        for (at, length) in [(0, width), (3, 15), (5, 8), (7, 1), (9, 0), (17, 14)] {
            let mut out: Vec<f64> = (0..length).map(|k| k as f64).collect();
            add_rows(&mut out, 4.0, &weights, &rows, (width, at));
            for (k, out) in out.into_iter().enumerate() {
                let sum = 0.5 * rows[at + k] - 2.0 * rows[2 * width + at + k];
                assert_eq!(out, k as f64 + 4.0 * sum, "{k} of {length} from {at}");
            }
        }
    }
}
