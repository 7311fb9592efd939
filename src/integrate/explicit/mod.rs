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
pub mod record;
pub mod step;
pub mod stiffness;
pub mod tableau;

pub use record::{Node, NodeView, StepData, StepView, add_rows};
pub use step::Stepper;

use super::rows::Rows;
use super::settings::Samples;
use crate::math::Complex64;
use crate::system::Numbering;
use tableau::{ALL, STAGES};

/// Numbers of stages that are kept at most (256 MB in `f64`); of longer histories the stages are made
/// again.
const KEPT: usize = 1 << 25;

/// What the adjoint needs: the node that each step starts from, and the stages of each step if
/// they were kept.
#[derive(Clone, Debug)]
pub struct Tape<S> {
    nodes: Rows<S, 4>,
    steps: Rows<S, 10>,
    /// Whether the stages of the dense output of each kept step were computed.
    dense: Vec<bool>,
    /// Whether stages are still kept.
    keeping: bool,
}

impl<S: Copy> Tape<S> {
    /// An empty tape, which keeps stages if `keeping` and as far as memory allows: those of the dense
    /// output only where samples may stand inside steps.
    pub fn new(numbering: &Numbering, keeping: bool, samples: Samples) -> Self {
        let stages = match samples {
            Samples::StepEnds | Samples::Uniform(..=1) => STAGES,
            Samples::Uniform(_) | Samples::Quadrature(_) => ALL,
        };
        Self {
            nodes: Rows::new(Node::<&[S]>::lengths(numbering)),
            steps: Rows::new(StepData::<&[S]>::lengths(numbering, stages)),
            dense: Vec::new(),
            keeping,
        }
    }

    /// Makes room for so many steps, and for their stages if these are kept.
    pub fn reserve(&mut self, steps: usize) {
        self.nodes.reserve(steps);
        self.keeping &= steps * self.steps.width() <= KEPT;
        if self.keeping {
            self.steps.reserve(steps);
            self.dense.reserve(steps);
        }
    }

    /// Adds a node.
    pub fn push(&mut self, node: Node<&[S]>) {
        self.nodes.push([node.q, node.v, node.a, node.lambda]);
    }

    /// Keeps the stages of a step, if all are kept.
    pub fn keep(&mut self, step: StepData<&[S]>) {
        if self.keeping && self.steps.numbers() + self.steps.width() > KEPT {
            self.keeping = false;
            self.steps.clear();
            self.dense = Vec::new();
        }
        if self.keeping {
            let (parts, lengths) = (step.parts(), self.steps.lengths());
            self.steps
                .push(std::array::from_fn(|i| &parts[i][..lengths[i]]));
            self.dense.push(step.dense);
        }
    }

    /// Whether stages were kept.
    pub fn keeps_stages(&self) -> bool {
        self.keeping
    }

    /// Node n of 0 … N.
    pub fn node(&self, n: usize) -> Node<&[S]> {
        let [q, v, a, lambda] = self.nodes.get(n);
        Node { q, v, a, lambda }
    }

    /// The kept stages of step n of 1 … N.
    pub fn step(&self, n: usize) -> StepData<&[S]> {
        StepData::of_parts(self.steps.get(n - 1), self.dense[n - 1])
    }

    /// How many numbers it holds.
    pub fn numbers(&self) -> usize {
        self.nodes.numbers() + self.steps.numbers()
    }
}

impl Tape<Complex64> {
    /// The real part.
    pub fn real(&self) -> Tape<f64> {
        Tape {
            nodes: self.nodes.real(),
            steps: self.steps.real(),
            dense: self.dense.clone(),
            keeping: self.keeping,
        }
    }
}
