//! Euler parameters: rotation matrix, rate maps, and their retraction.
//!
//! p = (p0, e), pᵀp = 1; R(p) = (p0² − eᵀe) I + 2 e eᵀ + 2 p0 ẽ takes body axes to ground;
//! L(p) = [−e, p0 I − ẽ]; ω = 2 L(p) ṗ in body axes; ṗ = ½ L(p)ᵀ ω
//! (Nikravesh 1988, *Computer-Aided Analysis of Mechanical Systems*, ch. 6).

use super::scalar::{Mat3, Scalar, Vec3, length};

/// Euler parameters (p0, e1, e2, e3).
pub type Quat<S> = [S; 4];

/// Vector part e of the Euler parameters.
fn vector<S: Scalar>(p: &Quat<S>) -> Vec3<S> {
    Vec3::new(p[1], p[2], p[3])
}

/// Rotation matrix R(p), body axes to ground.
pub fn matrix<S: Scalar>(p: &Quat<S>) -> Mat3<S> {
    let [a, b, c, d] = *p;
    let (aa, bb, cc, dd) = (a * a, b * b, c * c, d * d);
    let two = |x: S| x * 2.0;
    Mat3::new(
        aa + bb - cc - dd,
        two(b * c - a * d),
        two(b * d + a * c),
        two(b * c + a * d),
        aa - bb + cc - dd,
        two(c * d - a * b),
        two(b * d - a * c),
        two(c * d + a * b),
        aa - bb - cc + dd,
    )
}

/// The product L(p) w of a four-vector, L(p) = [−e, p0 I − ẽ]; bilinear in (p, w), and
/// L(p) w = −L(w) p.
pub fn rate_product<S: Scalar>(p: &Quat<S>, w: &Quat<S>) -> Vec3<S> {
    let (e, u) = (vector(p), vector(w));
    u * p[0] - e * w[0] - e.cross(&u)
}

/// The transposed product L(p)ᵀ a.
pub fn rate_transposed<S: Scalar>(p: &Quat<S>, a: &Vec3<S>) -> Quat<S> {
    let e = vector(p);
    let w = a * p[0] + e.cross(a);
    [-e.dot(a), w.x, w.y, w.z]
}

/// Pulls a cotangent of the rotation matrix back to the Euler parameters, taken as independent: the
/// derivatives of Σ by_ij R_ij(p).
pub fn pull_matrix<S: Scalar>(p: &Quat<S>, by: &Mat3<S>) -> Quat<S> {
    let e = vector(p);
    // Σ by_ij ẽ_ij = e · w.
    let w = Vec3::new(
        by[(2, 1)] - by[(1, 2)],
        by[(0, 2)] - by[(2, 0)],
        by[(1, 0)] - by[(0, 1)],
    );
    let trace = by.trace();
    let two = S::from(2.0);
    let by_e = ((by + by.transpose()) * e - e * trace + w * p[0]) * two;
    [(p[0] * trace + e.dot(&w)) * two, by_e.x, by_e.y, by_e.z]
}

/// Rate of the Euler parameters, ṗ = ½ L(p)ᵀ ω, ω in body axes \[rad/s\].
pub fn rates<S: Scalar>(p: &Quat<S>, omega: &Vec3<S>) -> Quat<S> {
    rate_transposed(p, omega).map(|x| x * 0.5)
}

/// Angular velocity in body axes, ω = 2 L(p) ṗ \[rad/s\].
pub fn angular_velocity<S: Scalar>(p: &Quat<S>, pdot: &Quat<S>) -> Vec3<S> {
    rate_product(p, pdot) * S::from(2.0)
}

/// Change of p by the small body-axes rotation δθ: p moves by ½ L(p)ᵀ δθ and is normalised. It
/// equals the rotation up to third order. Its relative accuracy does not depend on the size of δθ.
pub fn retraction<S: Scalar>(p: &Quat<S>, dtheta: &Vec3<S>) -> Quat<S> {
    let step = rates(p, dtheta);
    let square = step.iter().fold(S::zero(), |sum, &x| sum + x * x);
    // (p + step) / root − p with root = √(1 + square), step ⟂ p.
    let root = (square + 1.0).sqrt();
    let shrink = square / (root * (root + 1.0));
    std::array::from_fn(|i| step[i] / root - p[i] * shrink)
}

/// Change that brings p back to unit length.
pub fn normalisation<S: Scalar>(p: &Quat<S>) -> Quat<S> {
    let square = p.iter().fold(S::zero(), |sum, &x| sum + x * x);
    let excess = S::one() / square.sqrt() - 1.0;
    p.map(|x| x * excess)
}

/// p / |p|.
pub fn unit<S: Scalar>(p: &Quat<S>) -> Quat<S> {
    let square = p.iter().fold(S::zero(), |sum, &x| sum + x * x);
    let inverse = S::one() / square.sqrt();
    p.map(|x| x * inverse)
}

/// Cotangent of p from that of the tangent rotation δθ of u = p / |p|: 2 L(u)ᵀ θ̄ / |p|.
pub fn unit_pull_back(p: &Quat<f64>, theta: &Vec3<f64>) -> Quat<f64> {
    let square = p.iter().map(|x| x * x).sum::<f64>();
    rate_transposed(p, theta).map(|x| x * (2.0 / square))
}

/// Euler parameters of the rotation by `angle` \[rad\] about `axis` (any length but zero).
pub fn from_axis_angle<S: Scalar>(axis: &Vec3<S>, angle: S) -> Quat<S> {
    let (s, c) = (angle * 0.5).sin_cos();
    let e = axis * (s / length(axis));
    [c, e.x, e.y, e.z]
}

/// Euler parameters of the rotation R: the products 4 p_k p_j are sums of its entries, and the largest p_k is positive.
pub fn of_matrix<S: Scalar>(r: &Mat3<S>) -> Quat<S> {
    let trace = r[(0, 0)] + r[(1, 1)] + r[(2, 2)];
    let square = |k: usize| match k {
        0 => trace + 1.0,
        _ => r[(k - 1, k - 1)] * 2.0 - trace + 1.0,
    };
    let largest = |a: usize, b: usize| {
        if square(b).re() > square(a).re() {
            b
        } else {
            a
        }
    };
    let k = (1..4).fold(0, largest);
    let product = |j: usize| match (k.min(j), k.max(j)) {
        (a, b) if a == b => square(a),
        (0, 1) => r[(2, 1)] - r[(1, 2)],
        (0, 2) => r[(0, 2)] - r[(2, 0)],
        (0, 3) => r[(1, 0)] - r[(0, 1)],
        (a, b) => r[(a - 1, b - 1)] + r[(b - 1, a - 1)],
    };
    let scale = S::one() / (square(k).sqrt() * 2.0);
    std::array::from_fn(|j| product(j) * scale)
}

/// Euler parameters of the rotation `second` after `first`: R = R(second) R(first).
pub fn compose<S: Scalar>(second: &Quat<S>, first: &Quat<S>) -> Quat<S> {
    let (a, b) = (vector(second), vector(first));
    let e = b * second[0] + a * first[0] + a.cross(&b);
    [second[0] * first[0] - a.dot(&b), e.x, e.y, e.z]
}

/// Euler parameters of the inverse rotation (their quaternion's conjugate).
pub fn conjugate<S: Scalar>(p: &Quat<S>) -> Quat<S> {
    [p[0], -p[1], -p[2], -p[3]]
}

/// Rotation angle about the unit axis n (its twist), 2 atan2(eᵀn, p0), in (−2π, 2π] \[rad\].
pub fn twist<S: Scalar>(p: &Quat<S>, n: &Vec3<S>) -> S {
    vector(p).dot(n).atan2(p[0]) * 2.0
}

/// Derivative of [`twist`] in p and in n.
pub fn twist_derivative(p: &Quat<f64>, n: &Vec3<f64>) -> (Quat<f64>, Vec3<f64>) {
    let e = vector(p);
    let y = e.dot(n);
    let scale = 2.0 / (y * y + p[0] * p[0]);
    let w = n * (scale * p[0]);
    ([-scale * y, w.x, w.y, w.z], e * (scale * p[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::{COMPLEX_STEP, Complex64, lift3};

    fn sample() -> Quat<f64> {
        let p: Quat<f64> = [0.3, -0.5, 0.7, 0.2];
        let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| x / norm)
    }

    #[test]
    fn rotation_matrix_is_orthogonal_and_right_handed() {
        let r = matrix(&sample());
        assert!((r * r.transpose() - Mat3::identity()).abs().max() < 1e-15);
        assert!((r.determinant() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn rates_differentiate_the_rotation_matrix() {
        // d/dt R(p) = R(p) ω̃ for ṗ = ½ Lᵀ ω.
        let p = sample();
        let omega = Vec3::new(0.4, -1.1, 0.8);
        let pdot = rates(&p, &omega);
        let mut pc = p.map(Complex64::from);
        for i in 0..4 {
            pc[i].im = COMPLEX_STEP * pdot[i];
        }
        let rdot = matrix(&pc).map(|z| z.im / COMPLEX_STEP);
        assert!((rdot - matrix(&p) * omega.cross_matrix()).abs().max() < 1e-15);
        assert!((angular_velocity(&p, &pdot) - omega).abs().max() < 1e-15);
    }

    #[test]
    fn rate_products_are_transposed_and_antisymmetric() {
        let (p, w) = (sample(), [0.1, 0.9, -0.4, 0.6]);
        let a = Vec3::new(0.7, 0.2, -0.3);
        let left = a.dot(&rate_product(&p, &w));
        let right: f64 = rate_transposed(&p, &a)
            .iter()
            .zip(&w)
            .map(|(x, y)| x * y)
            .sum();
        assert!((left - right).abs() < 1e-15);
        assert!((rate_product(&p, &w) + rate_product(&w, &p)).abs().max() < 1e-15);
    }

    #[test]
    fn composition_multiplies_matrices() {
        let first = from_axis_angle(&Vec3::new(1.0, 2.0, -1.0), 0.7);
        let second = from_axis_angle(&Vec3::new(0.0, 0.5, 2.0), -1.9);
        let product = matrix(&second) * matrix(&first);
        assert!((matrix(&compose(&second, &first)) - product).abs().max() < 1e-15);
    }

    #[test]
    fn retraction_stays_on_the_sphere_and_follows_the_rotation() {
        let p = sample();
        let small = Vec3::new(1e-4, -2e-4, 3e-4);
        let change = retraction(&p, &small);
        let moved: Quat<f64> = std::array::from_fn(|i| p[i] + change[i]);
        let exact = compose(&p, &from_axis_angle(&small, length(&small)));
        let norm: f64 = moved.iter().map(|x| x * x).sum();
        assert!((norm - 1.0).abs() < 1e-15);
        assert!(moved.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-11));
    }

    #[test]
    fn twist_and_its_derivative() {
        let n = Vec3::new(0.0, 0.0, 1.0);
        for angle in [-2.3, 0.4, 1.57, 5.0] {
            assert!((twist(&from_axis_angle(&n, angle), &n) - angle).abs() < 1e-14);
        }
        let p = sample();
        let n = Vec3::new(0.36, 0.48, 0.8);
        let (by_p, by_n) = twist_derivative(&p, &n);
        for i in 0..4 {
            let mut pc = p.map(Complex64::from);
            pc[i].im = COMPLEX_STEP;
            let exact = twist(&pc, &lift3(&n)).im / COMPLEX_STEP;
            assert!((by_p[i] - exact).abs() < 1e-13 * (1.0 + exact.abs()));
        }
        for i in 0..3 {
            let mut nc: Vec3<Complex64> = lift3(&n);
            nc[i].im = COMPLEX_STEP;
            let exact = twist(&p.map(Complex64::from), &nc).im / COMPLEX_STEP;
            assert!((by_n[i] - exact).abs() < 1e-13 * (1.0 + exact.abs()));
        }
    }
}
