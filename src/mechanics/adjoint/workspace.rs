//! Vectors for temporary use. They are given back, so a backward march allocates only in its first
//! step.

/// Unused vectors.
#[derive(Default)]
pub(super) struct Workspace(Vec<Vec<f64>>);

impl Workspace {
    /// A vector of n zeros.
    pub fn zeros(&mut self, n: usize) -> Vec<f64> {
        let mut x = self.0.pop().unwrap_or_default();
        x.clear();
        x.resize(n, 0.0);
        x
    }

    /// A copy of `x`.
    pub fn copy(&mut self, x: &[f64]) -> Vec<f64> {
        let mut y = self.0.pop().unwrap_or_default();
        y.clear();
        y.extend_from_slice(x);
        y
    }

    /// Returns vectors to the workspace.
    pub fn back<const N: usize>(&mut self, all: [Vec<f64>; N]) {
        self.0.extend(all);
    }
}
