//! A sphere on heights over a plane: the nearest point of the surface.
//!
//! In the axes of the field the centre is at r, the surface at S = (u, v, h(u, v)) with the normal N ∝ (−h_u, −h_v, 1):
//!
//! ```text
//! (r − S)·S_u = 0,   (r − S)·S_v = 0,   d = N·(r − S),   δ = R_A − d,   z = p − R_A n
//! H (δu, δv) = (S_u·δr, S_v·δr),   H = S_iᵀS_k − (r − S)·S_ik,   δd = N·δr
//! ```
//!
//! Newton's method on the distance finds u and v from the place below the centre; its last two steps, which are in the scalar, bring the
//! derivatives.

use super::cotangent::{Cotangent, RADIUS_A, pull_direction};
use crate::math::{Scalar, Vec3, scalar::length};
use crate::model::height_field::Height;
use crate::model::{Contact, HeightField};
use crate::system::loads::Acting;
use crate::system::loads::pull::{Pulled, pull_point};

/// Most steps of Newton's method; most halvings of one.
const STEPS: usize = 60;
const HALVINGS: usize = 30;

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
    for _ in 0..STEPS {
        let (mut by, [a, b, c]) = step(field, r, at);
        if !(a > 0.0 && a * c > b * b) {
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
    }
    at
}

impl<S: Scalar> Foot<S> {
    /// The nearest point of the field, and the normal in ground axes.
    pub(super) fn of(
        (axes, field): (&[Vec3<S>; 3], &HeightField),
        at: &Acting<S>,
    ) -> (Self, Vec3<S>) {
        let from = at.a.point() - at.b.point();
        let axes = axes.each_ref().map(|own| at.b.motion.rotation * own);
        let [x, y, z] = axes.each_ref().map(|own| own.dot(&from));
        let r = Vec3::new(x, y, z);
        let mut place = nearest(field, &r.map(|x| x.re())).map(S::from);
        for _ in 0..2 {
            let (by, _) = step(field, &r, place);
            let next = [place[0] + by[0], place[1] + by[1]];
            if next.iter().all(|x| x.is_finite()) {
                place = next;
            }
        }
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

    /// Pulls the cotangents of δ, n and z back.
    pub(super) fn pull(
        &self,
        contact: &Contact<S>,
        at: &Acting<S>,
        (n, cot): (&Vec3<S>, &Cotangent<S>),
        out: &mut Pulled<S>,
    ) {
        out.scalars[RADIUS_A] += cot.penetration - n.dot(&cot.place);
        let by_normal = cot.normal - cot.place * contact.radius;
        let [x, y, z] = self.axes.each_ref().map(|own| own.dot(&by_normal));
        let by_local = Vec3::new(x, y, z);
        // N_i = (m_i − N N·m_i) / |m| with m = (−h_u, −h_v, 1).
        let [a, b, c] = self.height.curvature;
        let flat = (by_local - self.normal * self.normal.dot(&by_local)) * self.normal.z;
        let by_u = -(flat.x * a + flat.y * b);
        let by_v = -(flat.x * b + flat.y * c);
        let above = self.normal.z * self.distance;
        let [by_u, by_v] = solved(second(&self.height, above), [by_u, by_v]);
        let [tangent_u, tangent_v] = tangents(&self.height);
        let by_r = tangent_u * by_u + tangent_v * by_v - self.normal * cot.penetration;
        let mut by_from = Vec3::zeros();
        for k in 0..3 {
            let by_axis = self.from * by_r[k] + by_normal * self.normal[k];
            by_from += self.axes[k] * by_r[k];
            let direction = &contact.surface.directions()[k];
            pull_direction(&at.b, (k, direction), by_axis, out);
        }
        let none = Vec3::zeros();
        pull_point(&at.a, [by_from + cot.place, none], &mut out.a);
        pull_point(&at.b, [-by_from, none], &mut out.b);
    }
}
