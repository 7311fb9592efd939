//! The explicit Runge–Kutta pair DOP853 with projection.
//!
//! ```text
//! q̇ = T(q) v,     v̇ = a(q, v)  of  M a + Gᵀλ = f,  G a = γ         12 stages a step
//! W (q* − q) + G(q*)ᵀ s = 0,  Φ(q*) = 0                            then positions are projected
//! M (v* − v) + G(q*)ᵀ σ = 0,  G(q*) v* = 0                         and velocities
//! ```
//!
//! (Hairer & Wanner 1996, *Solving Ordinary Differential Equations II*, section VII.2.)

pub mod march;
pub mod step;
pub mod tableau;

pub use step::{Node, StepData, Stepper};

use super::trajectory::real;
use crate::math::Complex64;

/// What the adjoint needs: the node that each step starts from, and the stages of each step if
/// they were kept.
#[derive(Clone, Debug, Default)]
pub struct Tape<S> {
    /// Nodes 0 … N.
    pub nodes: Vec<Node<S>>,
    /// Steps 1 … N, or nothing.
    pub steps: Vec<StepData<S>>,
}

impl<S> Tape<S> {
    /// How many numbers it holds.
    pub fn numbers(&self) -> usize {
        let node = |node: &Node<S>| [&node.q, &node.v, &node.a, &node.lambda].map(Vec::len);
        let step = |step: &StepData<S>| {
            let stages = [&step.q, &step.v, &step.qdot, &step.a, &step.lambda];
            let end = [&step.q_raw, &step.v_raw, &step.s, &step.delta, &step.sigma];
            [stages, end]
                .concat()
                .into_iter()
                .map(Vec::len)
                .sum::<usize>()
        };
        let nodes = self.nodes.iter().flat_map(node);
        nodes.sum::<usize>() + self.steps.iter().map(step).sum::<usize>()
    }
}

impl Tape<Complex64> {
    /// The real part.
    pub fn real(&self) -> Tape<f64> {
        Tape {
            nodes: self.nodes.iter().map(Node::real).collect(),
            steps: self.steps.iter().map(StepData::real).collect(),
        }
    }
}

impl Node<Complex64> {
    fn real(&self) -> Node<f64> {
        Node {
            q: real(&self.q),
            v: real(&self.v),
            a: real(&self.a),
            lambda: real(&self.lambda),
        }
    }
}

impl StepData<Complex64> {
    fn real(&self) -> StepData<f64> {
        StepData {
            q: real(&self.q),
            v: real(&self.v),
            qdot: real(&self.qdot),
            a: real(&self.a),
            lambda: real(&self.lambda),
            q_raw: real(&self.q_raw),
            v_raw: real(&self.v_raw),
            s: real(&self.s),
            delta: real(&self.delta),
            sigma: real(&self.sigma),
            dense: self.dense,
        }
    }
}
