//! The kinds of shell elements.

use crate::math::ArrayVec;

/// Nodes of a shell element at most.
pub const SHELL_NODES: usize = 9;

/// A value of each node of a shell element.
pub type PerNode<T> = ArrayVec<T, SHELL_NODES>;
/// The nodes of a shell element, row by row.
pub type ShellNodes = PerNode<usize>;

/// The kind of a shell element, which its number of nodes tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShellKind {
    /// Nine nodes: MITC9 (Bucalem & Bathe 1993).
    #[default]
    Mitc9,
    /// Four nodes: MITC4 (Dvorkin & Bathe 1984).
    Mitc4,
}

impl ShellKind {
    /// The kind of an element with these nodes.
    pub fn of(nodes: &ShellNodes) -> Self {
        match nodes.len() {
            4 => Self::Mitc4,
            _ => Self::Mitc9,
        }
    }

    /// Order of the polynomials along an edge: steps between its nodes.
    pub fn order(self) -> usize {
        match self {
            Self::Mitc9 => 2,
            Self::Mitc4 => 1,
        }
    }
}
