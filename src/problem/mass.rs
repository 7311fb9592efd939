//! Mass properties of bodies.

use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3};
use crate::quantity::{Quantity, vector};
use crate::schema::mechanics::{Body, Inertia, Shape};
use std::f64::consts::PI;

/// Mass, centre of mass and inertia of a body.
pub struct MassProperties<S> {
    /// Mass \[kg\].
    pub mass: S,
    /// Centre of mass from the origin of the body's axes \[m\].
    pub centre: Vec3<S>,
    /// Inertia about the centre of mass, body axes \[kg m²\].
    pub inertia: Mat3<S>,
}

/// Mass properties at the design `x`. Missing entries of a checked file are zero.
pub fn mass_properties<S: Scalar>(body: &Body, x: &[S]) -> MassProperties<S> {
    let number = |quantity: &Option<Quantity>| quantity.map_or(S::zero(), |q| q.get(x));
    if body.is_flexible() {
        // Those of a flexible body follow from its shapes; its places are from its origin.
        return MassProperties {
            mass: S::zero(),
            centre: Vec3::zeros(),
            inertia: Mat3::zeros(),
        };
    }
    if let Some(surface) = &body.mass_properties {
        let density = surface.density.get(x);
        let of = surface.solid.as_ref();
        return MassProperties {
            mass: density * of.map_or(0.0, |solid| solid.volume),
            centre: of.map_or(Vec3::zeros(), |solid| lift3(&solid.centre)),
            inertia: of.map_or(Mat3::zeros(), |solid| {
                solid.inertia.map(|own| density * own)
            }),
        };
    }
    let mass = match (&body.shape, &body.density) {
        (Some(shape), Some(density)) => density.get(x) * volume(shape, x),
        _ => number(&body.mass),
    };
    let inertia = match (&body.shape, &body.inertia) {
        (Some(shape), _) => Mat3::from_diagonal(&(gyration(shape, x) * mass)),
        (None, Some(inertia)) => matrix(inertia, x),
        (None, None) => Mat3::zeros(),
    };
    MassProperties {
        mass,
        centre: body
            .centre_of_mass
            .map_or(Vec3::zeros(), |centre| vector(&centre, x)),
        inertia,
    }
}

/// The symmetric inertia matrix \[kg m²\].
fn matrix<S: Scalar>(inertia: &Inertia, x: &[S]) -> Mat3<S> {
    let [xx, yy, zz] = [inertia.xx, inertia.yy, inertia.zz].map(|q| q.get(x));
    let [xy, xz, yz] = [inertia.xy, inertia.xz, inertia.yz].map(|q| q.get(x));
    Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Volume of a shape \[m³\].
pub fn volume<S: Scalar>(shape: &Shape, x: &[S]) -> S {
    match shape {
        Shape::Box { size } => size[0].get(x) * size[1].get(x) * size[2].get(x),
        Shape::Cylinder { radius, length } | Shape::Rod { length, radius } => {
            let r = radius.get(x);
            r * r * length.get(x) * PI
        }
        Shape::Sphere { radius } => {
            let r = radius.get(x);
            r * r * r * (4.0 * PI / 3.0)
        }
        Shape::Point => S::zero(),
    }
}

/// Principal moments of inertia per mass of a homogeneous shape about its centre \[m²\]. Those of a
/// point are arbitrary positive values, because a point does not rotate.
fn gyration<S: Scalar>(shape: &Shape, x: &[S]) -> Vec3<S> {
    let about = |r: S, l: S| (r * r * 0.5, (r * r * 3.0 + l * l) / 12.0);
    match shape {
        Shape::Box { size } => {
            let [a, b, c] = size.map(|edge| edge.get(x)).map(|edge| edge * edge);
            Vec3::new(b + c, a + c, a + b).map(|sum| sum / 12.0)
        }
        Shape::Cylinder { radius, length } => {
            let (along, across) = about(radius.get(x), length.get(x));
            Vec3::new(across, across, along)
        }
        Shape::Sphere { radius } => {
            let r = radius.get(x);
            Vec3::repeat(r * r * 0.4)
        }
        Shape::Rod { length, radius } => {
            let (along, across) = about(radius.get(x), length.get(x));
            Vec3::new(along, across, across)
        }
        Shape::Point => Vec3::repeat(S::one()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inertia(shape: &str) -> [f64; 3] {
        let body = format!(r#"{{"shape": {shape}, "density": 2}}"#);
        let body: Body = serde_json::from_str(&body).expect("a body");
        let inertia = mass_properties::<f64>(&body, &[]).inertia;
        [inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]]
    }

    /// ∫ (y² + z², x² + z², x² + y²) dm by the midpoint rule on a grid over the bounding box.
    fn integrated(half: [f64; 3], inside: impl Fn([f64; 3]) -> bool) -> [f64; 3] {
        let n = 80;
        let at = |i: usize, k: usize| half[k] * ((2 * i + 1) as f64 / n as f64 - 1.0);
        let cell: f64 = half.iter().map(|h| 2.0 * h / n as f64).product();
        let mut sum = [0.0; 3];
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    let p = [at(i, 0), at(j, 1), at(k, 2)];
                    if inside(p) {
                        let [a, b, c] = p.map(|x| 2.0 * cell * x * x);
                        sum = [sum[0] + b + c, sum[1] + a + c, sum[2] + a + b];
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn moments_of_inertia_are_the_integrals_over_the_shapes() {
        let disc = |a: f64, b: f64, r: f64| a * a + b * b <= r * r;
        let cases = [
            (
                inertia(r#"{"box": {"size": [1, 2, 3]}}"#),
                integrated([0.5, 1.0, 1.5], |_| true),
            ),
            (
                inertia(r#"{"cylinder": {"radius": 0.7, "length": 3}}"#),
                integrated([0.7, 0.7, 1.5], |p| disc(p[0], p[1], 0.7)),
            ),
            (
                inertia(r#"{"rod": {"radius": 0.7, "length": 3}}"#),
                integrated([1.5, 0.7, 0.7], |p| disc(p[1], p[2], 0.7)),
            ),
            (
                inertia(r#"{"sphere": {"radius": 0.7}}"#),
                integrated([0.7; 3], |p| {
                    disc(p[0], p[1], (0.49 - p[2] * p[2]).max(0.0).sqrt())
                }),
            ),
        ];
        for (exact, sum) in cases {
            for (a, b) in exact.iter().zip(sum) {
                assert!((a - b).abs() < 3e-3 * a, "{exact:?} {sum:?}");
            }
        }
    }
}
