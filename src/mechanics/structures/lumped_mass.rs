//! Masses at nodes.

use crate::math::{Scalar, Vec3};

/// A non-structural mass at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumpedMass<S> {
    /// Mass m \[kg\].
    pub mass: S,
    /// Inertia about the node, J = (xx, yy, zz, xy, yz, zx) in global axes [kg m²], as in the
    /// torque J ω̇. On a smooth surface rotations about the director have no part.
    pub inertia: [S; 6],
}

impl<S: Scalar> LumpedMass<S> {
    /// A mass without inertia of its own \[kg\].
    pub fn point(mass: S) -> Self {
        Self {
            mass,
            inertia: [S::zero(); 6],
        }
    }

    /// The same mass in another scalar.
    pub fn map<T>(&self, f: &mut dyn FnMut(S) -> T) -> LumpedMass<T> {
        LumpedMass {
            mass: f(self.mass),
            inertia: self.inertia.map(f),
        }
    }

    /// J ω.
    pub fn momentum(&self, w: &Vec3<S>) -> Vec3<S> {
        let [xx, yy, zz, xy, yz, zx] = self.inertia;
        Vec3::new(
            xx * w.x + xy * w.y + zx * w.z,
            xy * w.x + yy * w.y + yz * w.z,
            zx * w.x + yz * w.y + zz * w.z,
        )
    }
}
