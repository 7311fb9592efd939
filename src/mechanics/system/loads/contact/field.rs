//! A sphere on heights over a plane: the nearest point of the surface.
//!
//! In the axes of the field the centre is at r, the surface at S = (u, v, h(u, v)) with the normal N ∝ (−h_u, −h_v, 1):
//!
//! ```text
//! (r − S)·S_u = 0,   (r − S)·S_v = 0,   d = N·(r − S),   δ = R_A − d,   z = p − R_A n
//! H (δu, δv) = (S_u·δr, S_v·δr),   H = S_iᵀS_k − (r − S)·S_ik,   δd = N·δr
//! ```
//!
//! Newton's method on the distance finds u and v from the place below the centre; its [`last_steps`], which are in the scalar, bring
//! the derivatives.

use super::cotangent::pull_direction;
use super::last_steps::last_steps;
use crate::math::{Scalar, Vec3, scalar::length};
use crate::model::height_field::Height;
use crate::model::{Contact, HeightField};
use crate::system::loads::Acting;
use crate::system::loads::pull::Pulled;

/// Most steps of Newton's method; most halvings of one.
const STEPS: usize = 60;
const HALVINGS: usize = 30;
/// A fall of the square of the distance, relative to it, that is not looked for.
const UNSEEN: f64 = 1e-13;
/// A step that is so much smaller than the one before is quadratically convergent.
const CONVERGED: f64 = 1e-4;

/// The nearest point of a surface.
pub(super) struct Foot<S> {
    /// From the field's origin to the centre, ground axes.
    from: Vec3<S>,
    /// The axes of the field, ground axes.
    axes: [Vec3<S>; 3],
    height: Height<S>,
    /// N, in the axes of the field.
    normal: Vec3<S>,
    distance: S,
}

/// S_u, S_v.
fn tangents<S: Scalar>(height: &Height<S>) -> [Vec3<S>; 2] {
    let (zero, one, [x, y]) = (S::zero(), S::one(), height.slope);
    [Vec3::new(one, zero, x), Vec3::new(zero, one, y)]
}

/// H, by its upper triangle, where r − S has the height `above`.
fn second<S: Scalar>(height: &Height<S>, above: S) -> [S; 3] {
    let [x, y] = height.slope;
    let [a, b, c] = height.curvature;
    [
        x * x + 1.0 - above * a,
        x * y - above * b,
        y * y + 1.0 - above * c,
    ]
}

/// H⁻¹ g.
fn solved<S: Scalar>([a, b, c]: [S; 3], [x, y]: [S; 2]) -> [S; 2] {
    let determinant = a * c - b * b;
    [(x * c - y * b) / determinant, (y * a - x * b) / determinant]
}

/// The step of Newton's method at (u, v).
fn step<S: Scalar>(field: &HeightField, r: &Vec3<S>, [u, v]: [S; 2]) -> ([S; 2], [S; 3]) {
    let height = field.at(u, v);
    let away = r - Vec3::new(u, v, height.value);
    let [by_u, by_v] = tangents(&height).map(|own| own.dot(&away));
    let h = second(&height, away.z);
    (solved(h, [by_u, by_v]), h)
}

/// Where the surface is nearest to a place.
fn nearest(field: &HeightField, r: &Vec3<f64>) -> [f64; 2] {
    let square = |[u, v]: [f64; 2]| {
        let z = field.at(u, v).value;
        (r - Vec3::new(u, v, z)).norm_squared()
    };
    let mut at = [r.x, r.y];
    let mut now = square(at);
    let mut last = 0.0;
    for _ in 0..STEPS {
        let (mut by, [a, b, c]) = step(field, r, at);
        let is_convex = a > 0.0 && a * c > b * b;
        let [x, y] = by;
        if is_convex && a * x * x + 2.0 * b * x * y + c * y * y <= UNSEEN * now {
            break;
        }
        if !is_convex {
            // Where the distance is not convex, the steepest way down.
            let height = field.at(at[0], at[1]);
            let away = r - Vec3::new(at[0], at[1], height.value);
            let [x, y] = height.slope;
            let scale = 1.0 + x * x + y * y;
            by = tangents(&height).map(|own| own.dot(&away) / scale);
        }
        let mut better = None;
        for _ in 0..HALVINGS {
            let next = [at[0] + by[0], at[1] + by[1]];
            let own = square(next);
            if own < now {
                better = Some((next, own));
                break;
            }
            by = by.map(|x| 0.5 * x);
        }
        let Some((next, own)) = better else {
            break;
        };
        (at, now) = (next, own);
        let moved = by[0].hypot(by[1]);
        if moved <= CONVERGED * last {
            break;
        }
        last = moved;
    }
    at
}

impl<S: Scalar> Foot<S> {
    /// The point of a field, with its axes in ground, that is nearest to the centre of a sphere, and the normal; `from` the field's
    /// origin to the centre; in ground axes.
    pub(super) fn of(
        (axes, field): ([Vec3<S>; 3], &HeightField),
        from: Vec3<S>,
    ) -> (Self, Vec3<S>) {
        let [x, y, z] = axes.each_ref().map(|own| own.dot(&from));
        let r = Vec3::new(x, y, z);
        let start = nearest(field, &r.map(|x| x.re())).map(S::from);
        let size = r.map(|x| x.re()).norm();
        let place = last_steps(start, |place| {
            let (by, _) = step(field, &r, *place);
            let next = [place[0] + by[0], place[1] + by[1]];
            let finite = next.iter().all(|x| x.is_finite());
            finite.then(|| (next, by[0].re().hypot(by[1].re()) / size))
        });
        let height = field.at(place[0], place[1]);
        let upward = Vec3::new(-height.slope[0], -height.slope[1], S::one());
        let normal = upward / length(&upward);
        let away = r - Vec3::new(place[0], place[1], height.value);
        let own = Self {
            from,
            axes,
            distance: normal.dot(&away),
            height,
            normal,
        };
        let ground = axes[0] * normal.x + axes[1] * normal.y + axes[2] * normal.z;
        (own, ground)
    }

    pub(super) fn distance(&self) -> S {
        self.distance
    }

    /// How N changes in u and v, times two coefficients; N_i = (m_i − N N·m_i) / |m| with m = (−h_u, −h_v, 1).
    fn turns(&self, [u, v]: [S; 2]) -> Vec3<S> {
        let [a, b, c] = self.height.curvature;
        let by = Vec3::new(-(a * u + b * v), -(b * u + c * v), S::zero());
        (by - self.normal * self.normal.dot(&by)) * self.normal.z
    }

    fn in_axes(&self, v: &Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.axes.each_ref().map(|own| own.dot(v));
        Vec3::new(x, y, z)
    }

    fn in_ground(&self, v: &Vec3<S>) -> Vec3<S> {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// The change of n where the centre moves by `by`, in ground axes.
    pub(super) fn turned(&self, by: &Vec3<S>) -> Vec3<S> {
        let by = self.in_axes(by);
        let by = tangents(&self.height).map(|own| own.dot(&by));
        let above = self.normal.z * self.distance;
        self.in_ground(&self.turns(solved(second(&self.height, above), by)))
    }

    /// The cotangent of the centre in the axes of the field, from those of δ and n in ground axes.
    fn by_place(&self, by_depth: S, by_normal: &Vec3<S>) -> Vec3<S> {
        let by_local = self.in_axes(by_normal);
        let by = [[S::one(), S::zero()], [S::zero(), S::one()]];
        let by = by.map(|own| self.turns(own).dot(&by_local));
        let above = self.normal.z * self.distance;
        let [by_u, by_v] = solved(second(&self.height, above), by);
        let [tangent_u, tangent_v] = tangents(&self.height);
        tangent_u * by_u + tangent_v * by_v - self.normal * by_depth
    }

    /// The cotangent of the centre, from those of δ and n, all in ground axes.
    pub(super) fn by_centre(&self, by_depth: S, by_normal: &Vec3<S>) -> Vec3<S> {
        self.in_ground(&self.by_place(by_depth, by_normal))
    }

    /// Pulls the cotangents of δ and n back to the axes. Returns that of the centre, in ground axes.
    pub(super) fn pull(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        (by_depth, by_normal): (S, &Vec3<S>),
        out: &mut Pulled<S>,
    ) -> Vec3<S> {
        let by_r = self.by_place(by_depth, by_normal);
        for k in 0..3 {
            let by_axis = self.from * by_r[k] + by_normal * self.normal[k];
            let direction = &contact.surface.directions()[k];
            pull_direction(&at.b, (k, direction), by_axis, out);
        }
        self.in_ground(&by_r)
    }
}
