//! Workspace of a branch of an elimination, or of its trunk.

use crate::math::Scalar;

/// Memory that eliminations and solutions use again.
pub(super) struct Workspace<S> {
    /// Memory of remainders that are used up.
    pub free: Vec<Vec<S>>,
    /// Right-hand sides of the unknowns and of the short rows.
    pub x: Vec<Vec<S>>,
    pub short: Vec<Vec<S>>,
    /// Part of a right-hand side that a front touches.
    pub beside: Vec<S>,
}

impl<S: Scalar> Workspace<S> {
    /// For fronts that touch up to `widest` unknowns beside their own.
    pub(super) fn new(widest: usize) -> Self {
        Self {
            free: Vec::new(),
            x: Vec::new(),
            short: Vec::new(),
            beside: vec![S::zero(); widest],
        }
    }

    /// Makes room for right-hand sides of these lengths.
    pub(super) fn resize(&mut self, count: usize, (unknowns, short): (usize, usize)) {
        self.x.resize_with(count, || vec![S::zero(); unknowns]);
        self.short.resize_with(count, || vec![S::zero(); short]);
    }
}
