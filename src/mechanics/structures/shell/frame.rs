//! The orthonormal frame at a Gauss point, and the way of covariant components into it.
//!
//! n = a_r × a_s / J, J = |a_r × a_s|; e1 is the direction of a_r at the middle of the element,
//! projected into the tangent plane; e2 = n × e1. The frames of a flat element are then one frame,
//! which the patch correction needs. T = inv [e_i·a_α], E_ij = T_αi T_βj E_αβ:
//!
//! ```text
//! T_r1 = e2·a_s / J,  T_r2 = −e1·a_s / J,  T_s1 = −e2·a_r / J,  T_s2 = e1·a_r / J
//! ```

use crate::math::{Scalar, Vec3, scalar::length};

/// Area J = |a_r × a_s| of the tangents at a point \[m²\].
pub fn area<S: Scalar>(tangents: &[Vec3<S>; 2]) -> S {
    length(&tangents[0].cross(&tangents[1]))
}

/// Transpose of the derivative of [`area`].
pub fn add_area_transpose<S: Scalar>(tangents: &[Vec3<S>; 2], bar: S, to: &mut [Vec3<S>; 2]) {
    let [ar, as_] = tangents;
    let normal = ar.cross(as_);
    let bar = normal * (bar / length(&normal));
    to[0] += as_.cross(&bar);
    to[1] += bar.cross(ar);
}

/// The frame at a point: T \[1/m\], rows r and s, columns 1 and 2, and the area J \[m²\]; or cotangents.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    pub t: [[S; 2]; 2],
    pub area: S,
}

/// The axes of a frame.
struct Axes<S> {
    n: Vec3<S>,
    e1: Vec3<S>,
    e2: Vec3<S>,
    /// Length of the projection of the reference direction.
    projection: S,
    area: S,
}

impl<S: Scalar> Axes<S> {
    fn new([ar, as_]: &[Vec3<S>; 2], reference: &Vec3<S>) -> Self {
        let normal = ar.cross(as_);
        let area = length(&normal);
        let n = normal / area;
        let projected = reference - n * n.dot(reference);
        let projection = length(&projected);
        let e1 = projected / projection;
        Self {
            e2: n.cross(&e1),
            n,
            e1,
            projection,
            area,
        }
    }
}

impl<S: Scalar> Frame<S> {
    pub fn zeros() -> Self {
        Self {
            t: [[S::zero(); 2]; 2],
            area: S::zero(),
        }
    }

    /// The frame of the tangents a_r and a_s \[m\] along a reference direction.
    #[inline]
    pub fn of(tangents: &[Vec3<S>; 2], reference: &Vec3<S>) -> Self {
        let axes = Axes::new(tangents, reference);
        let [ar, as_] = tangents;
        let by = S::one() / axes.area;
        Self {
            t: [
                [axes.e2.dot(as_) * by, -(axes.e1.dot(as_) * by)],
                [-(axes.e2.dot(ar) * by), axes.e1.dot(ar) * by],
            ],
            area: axes.area,
        }
    }

    /// Transpose of the derivative of [`Frame::of`].
    pub fn add_of_transpose(
        &self,
        bar: &Self,
        tangents: &[Vec3<S>; 2],
        reference: &Vec3<S>,
        to: &mut [Vec3<S>; 2],
        reference_to: &mut Vec3<S>,
    ) {
        let axes = Axes::new(tangents, reference);
        let [ar, as_] = tangents;
        let by = S::one() / axes.area;
        let [[r1, r2], [s1, s2]] = bar.t.map(|row| row.map(|x| x * by));
        let e2_bar = as_ * r1 - ar * s1;
        let mut e1_bar = ar * s2 - as_ * r2;
        to[0] += axes.e1 * s2 - axes.e2 * s1;
        to[1] += axes.e2 * r1 - axes.e1 * r2;
        let mut area_bar = bar.area;
        for (bar, t) in bar.t.iter().flatten().zip(self.t.iter().flatten()) {
            area_bar -= *bar * *t * by;
        }
        // e2 = n × e1, e1 = v / |v|, v = c − n (n·c), n = m / J, m = a_r × a_s.
        let mut n_bar = axes.e1.cross(&e2_bar);
        e1_bar += e2_bar.cross(&axes.n);
        let v_bar = (e1_bar - axes.e1 * axes.e1.dot(&e1_bar)) / axes.projection;
        let (along, work) = (axes.n.dot(reference), axes.n.dot(&v_bar));
        *reference_to += v_bar - axes.n * work;
        n_bar -= v_bar * along + reference * work;
        let m_bar = (n_bar - axes.n * axes.n.dot(&n_bar)) * by + axes.n * area_bar;
        to[0] += as_.cross(&m_bar);
        to[1] += m_bar.cross(ar);
    }

    /// In-plane strains (E_11, E_22, 2 E_12) of covariant components (rr, ss, rs).
    #[inline]
    pub fn strain(&self, covariant: &[S; 3]) -> [S; 3] {
        let [[a, b], [c, d]] = self.t;
        let [rr, ss, rs] = *covariant;
        [
            a * a * rr + a * c * rs * 2.0 + c * c * ss,
            b * b * rr + b * d * rs * 2.0 + d * d * ss,
            (a * b * rr + (a * d + c * b) * rs + c * d * ss) * 2.0,
        ]
    }

    /// Transpose of [`Frame::strain`] in the covariant components.
    #[inline]
    pub fn strain_transpose(&self, bar: &[S; 3]) -> [S; 3] {
        let [[a, b], [c, d]] = self.t;
        let [x, y, xy] = *bar;
        [
            a * a * x + b * b * y + a * b * xy * 2.0,
            c * c * x + d * d * y + c * d * xy * 2.0,
            (a * c * x + b * d * y + (a * d + c * b) * xy) * 2.0,
        ]
    }

    /// Transpose of the derivative of [`Frame::strain`] in the frame, added to `to`.
    pub fn add_strain_frame_transpose(&self, covariant: &[S; 3], bar: &[S; 3], to: &mut Self) {
        let [[a, b], [c, d]] = self.t;
        let [rr, ss, rs] = *covariant;
        let [x, y, xy] = *bar;
        to.t[0][0] += ((a * rr + c * rs) * x + (b * rr + d * rs) * xy) * 2.0;
        to.t[0][1] += ((b * rr + d * rs) * y + (a * rr + c * rs) * xy) * 2.0;
        to.t[1][0] += ((a * rs + c * ss) * x + (b * rs + d * ss) * xy) * 2.0;
        to.t[1][1] += ((b * rs + d * ss) * y + (a * rs + c * ss) * xy) * 2.0;
    }

    /// Transverse shear strains (γ_1, γ_2) of covariant components (r, s).
    #[inline]
    pub fn shear(&self, covariant: &[S; 2]) -> [S; 2] {
        let [[a, b], [c, d]] = self.t;
        let [r, s] = *covariant;
        [a * r + c * s, b * r + d * s]
    }

    /// Transpose of [`Frame::shear`] in the covariant components.
    #[inline]
    pub fn shear_transpose(&self, bar: &[S; 2]) -> [S; 2] {
        let [[a, b], [c, d]] = self.t;
        [a * bar[0] + b * bar[1], c * bar[0] + d * bar[1]]
    }

    /// Transpose of the derivative of [`Frame::shear`] in the frame, added to `to`.
    pub fn add_shear_frame_transpose(&self, covariant: &[S; 2], bar: &[S; 2], to: &mut Self) {
        for i in 0..2 {
            to.t[0][i] += covariant[0] * bar[i];
            to.t[1][i] += covariant[1] * bar[i];
        }
    }
}
