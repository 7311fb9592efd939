//! The velocities that a body can have in its scene.

use crate::math::scalar::along;
use crate::math::{Mat3, Scalar, Vec3};

/// Velocities of a body, (ṙ in ground axes, ω in body axes) = B u, with a constant basis B of
/// orthonormal columns: directions of translation, then of rotation. The equations of a body that
/// cannot leave this subspace are solved in u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobility {
    /// Directions of ṙ, ground axes.
    pub translation: Directions,
    /// Directions of ω, body axes.
    pub rotation: Directions,
}

/// Orthonormal axes of space; the first ones are free. If all are free, they are the unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions {
    axes: [Vec3<f64>; 3],
    free: usize,
}

impl Mobility {
    /// Any velocity: six unknowns.
    pub fn spatial() -> Self {
        Self {
            translation: Directions::all(),
            rotation: Directions::all(),
        }
    }

    /// Three unknowns: translation along two orthonormal directions of a plane (ground axes), and
    /// rotation about its unit normal (body axes), which a planar motion does not change.
    pub fn planar([t1, t2]: [Vec3<f64>; 2], normal: Vec3<f64>) -> Self {
        let mut farthest = Vec3::zeros();
        farthest[normal.iamin()] = 1.0;
        let first = normal.cross(&farthest).normalize();
        Self {
            translation: Directions {
                axes: [t1, t2, t1.cross(&t2)],
                free: 2,
            },
            rotation: Directions {
                axes: [normal, first, normal.cross(&first)],
                free: 1,
            },
        }
    }

    /// Three unknowns: any translation, no rotation.
    pub fn point() -> Self {
        Self::spatial().without_rotation()
    }

    /// Translation alone along the first `count` axes: that of a body that carries elastic coordinates,
    /// three or one.
    pub fn carrier(count: usize) -> Self {
        let mut some = Self::point();
        some.translation.free = count;
        some
    }

    /// No unknowns.
    pub fn fixed() -> Self {
        let mut none = Self::point();
        none.translation.free = 0;
        none
    }

    /// This mobility without rotation.
    pub fn without_rotation(mut self) -> Self {
        self.rotation.free = 0;
        self
    }

    /// Number of unknowns u.
    pub fn unknowns(&self) -> usize {
        self.translation.free + self.rotation.free
    }

    /// Whether the body can rotate.
    pub fn has_rotation(&self) -> bool {
        self.rotation.free > 0
    }

    /// If the body moves in a plane: axes of translation, of which the first two are free, and of
    /// rotation, of which at most the first is free. The normal of the plane is the third of the
    /// former and the first of the latter.
    pub fn plane(&self) -> Option<[[Vec3<f64>; 3]; 2]> {
        let planar = self.translation.free == 2 && self.rotation.free <= 1;
        planar.then_some([self.translation.axes, self.rotation.axes])
    }

    /// Writes u = Bᵀ (x, y) of a linear and an angular part to the first entries of `out`.
    #[inline]
    pub fn reduce<S: Scalar>(&self, linear: &Vec3<S>, angular: &Vec3<S>, out: &mut [S]) {
        if let Some([t1, t2, normal]) = self.planar_axes() {
            let u = [along(linear, t1), along(linear, t2), along(angular, normal)];
            out[..3].copy_from_slice(&u);
            return;
        }
        self.translation.components(linear, out);
        let out = &mut out[self.translation.free..];
        self.rotation.components(angular, out);
    }

    /// The linear and angular parts of B u; u are the first entries of `u`.
    #[inline]
    pub fn expand<S: Scalar>(&self, u: &[S]) -> (Vec3<S>, Vec3<S>) {
        if let Some([t1, t2, normal]) = self.planar_axes() {
            let u = [u[0], u[1], u[2]];
            let linear = Vec3::from_fn(|k, _| u[0] * t1[k] + u[1] * t2[k]);
            return (linear, Vec3::from_fn(|k, _| u[2] * normal[k]));
        }
        let linear = self.translation.combine(u);
        (linear, self.rotation.combine(&u[self.translation.free..]))
    }

    /// The columns of B of a planar body. Most bodies are planar, so the formulas above have a
    /// branch for them.
    #[inline]
    fn planar_axes(&self) -> Option<[&Vec3<f64>; 3]> {
        let planar = self.translation.free == 2 && self.rotation.free == 1;
        let [t1, t2, _] = &self.translation.axes;
        planar.then_some([t1, t2, &self.rotation.axes[0]])
    }

    /// Row k of B: pairs of an index in u and an entry. A zero entry is a filler.
    pub fn row(&self, k: usize) -> [(usize, f64); 2] {
        match k {
            0..3 => self.translation.row(k, 0),
            _ => self.rotation.row(k - 3, self.translation.free),
        }
    }
}

impl Directions {
    fn all() -> Self {
        Self {
            axes: [Vec3::x(), Vec3::y(), Vec3::z()],
            free: 3,
        }
    }

    /// Number of free axes.
    pub fn free(&self) -> usize {
        self.free
    }

    /// Axis i, free or not.
    pub fn axis(&self, i: usize) -> &Vec3<f64> {
        &self.axes[i]
    }

    /// Writes the components of `x` in the free directions to the first entries of `out`.
    #[inline]
    pub fn components<S: Scalar>(&self, x: &Vec3<S>, out: &mut [S]) {
        match self.free {
            3 => out[..3].copy_from_slice(x.as_slice()),
            2 => {
                let [t1, t2, _] = &self.axes;
                out[..2].copy_from_slice(&[along(x, t1), along(x, t2)]);
            }
            1 => out[0] = along(x, &self.axes[0]),
            _ => {}
        }
    }

    /// The vector whose components in the free directions are the first entries of `u`.
    #[inline]
    pub fn combine<S: Scalar>(&self, u: &[S]) -> Vec3<S> {
        match self.free {
            3 => Vec3::new(u[0], u[1], u[2]),
            2 => {
                let [t1, t2, _] = &self.axes;
                Vec3::from_fn(|k, _| u[0] * t1[k] + u[1] * t2[k])
            }
            1 => Vec3::from_fn(|k, _| u[0] * self.axes[0][k]),
            _ => Vec3::zeros(),
        }
    }

    /// The part of `x` in the free directions.
    pub fn project<S: Scalar>(&self, x: &Vec3<S>) -> Vec3<S> {
        let mut u = [S::zero(); 3];
        self.components(x, &mut u);
        self.combine(&u)
    }

    /// dᵢᵀ A dₖ of the free directions i and k.
    #[inline]
    pub fn quadratic<S: Scalar>(&self, a: &Mat3<S>, i: usize, k: usize) -> S {
        match self.free {
            3 => a[(i, k)],
            _ => along(&(a * self.axes[k].map(S::from)), &self.axes[i]),
        }
    }

    /// Component k of the free directions; their first unknown is `at`. At most two entries are not
    /// zero, since three free directions are unit vectors.
    fn row(&self, k: usize, at: usize) -> [(usize, f64); 2] {
        match self.free {
            3 => [(at + k, 1.0), (0, 0.0)],
            2 => [(at, self.axes[0][k]), (at + 1, self.axes[1][k])],
            1 => [(at, self.axes[0][k]), (0, 0.0)],
            _ => [(0, 0.0); 2],
        }
    }
}
