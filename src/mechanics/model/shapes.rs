//! Numbers of bodies whose points move with factors of shapes: integrals over the mass, and strain energy as a
//! quartic polynomial (equations in [`super::flexible`]).

use crate::math::slices::{add_scaled, dot};
use crate::math::{Mat3, Scalar, Vec3, parameters};

/// Integrals of the shapes over the mass.
#[derive(Clone, Debug)]
pub struct ModalInertia<S> {
    /// p_0 = ∫ X dm \[kg m\].
    pub centre: Vec3<S>,
    /// p_I \[kg m, for shapes without unit\].
    pub static_moments: Vec<Vec3<S>>,
    /// S_0I = ∫ X X_Iᵀ dm \[kg m²\].
    pub with_position: Vec<Mat3<S>>,
    /// S_IJ for J ≥ I, by rows of the upper triangle; S_JI = S_IJᵀ \[kg m²\].
    pub products: Vec<Mat3<S>>,
}

/// Strain energy as a quartic polynomial.
#[derive(Clone, Debug)]
pub struct ModalStiffness<S> {
    /// K, symmetric, m × m by rows \[N/m for coordinates in metres\].
    pub linear: Vec<S>,
    /// Strains e_p with their weights k_p.
    pub strains: Vec<Strain<S>>,
}

/// A strain with its weight in the energy.
#[derive(Clone, Debug)]
pub struct Strain<S> {
    /// k_p, for example E A times the weight of the quadrature.
    pub weight: S,
    /// Whether it is that of a beam along its axis.
    pub axial: bool,
    /// e_p.
    pub strain: Quadratic<S>,
}

/// A quadratic form without constant term, e = b · q + ½ Σ c_s (g_s · q)²: a strain, a section force or
/// a stress.
#[derive(Clone, Debug)]
pub struct Quadratic<S> {
    /// b.
    pub linear: Vec<S>,
    /// (c_s, g_s).
    pub squares: Vec<(S, Vec<S>)>,
}

parameters!(struct ModalInertia {; centre, static_moments, with_position, products });

parameters!(struct ModalStiffness {; linear, strains });

parameters!(struct Strain { axial; weight, strain });

parameters!(struct Quadratic {; linear, squares });

impl<S: Scalar> ModalInertia<S> {
    /// Index of S_IJ among the products, and whether it is transposed.
    pub fn place(&self, i: usize, j: usize) -> (usize, bool) {
        let m = self.static_moments.len();
        let (low, high) = (i.min(j), i.max(j));
        (low * m - low * (low + 1) / 2 + high, j < i)
    }
}

impl<S: Scalar> Quadratic<S> {
    /// Its value.
    pub fn value(&self, q: &[S]) -> S {
        let half = S::from(0.5);
        let squares = self.squares.iter().map(|(c, g)| {
            let w = dot(g, q);
            *c * w * w * half
        });
        squares.fold(dot(&self.linear, q), |sum, x| sum + x)
    }

    /// Root of the sum of its squares Σ c_s (g_s · q)²: of a strain along an axis, the slope of the axis.
    pub fn slope(&self, q: &[S]) -> f64 {
        let squares = self.squares.iter().map(|(c, g)| {
            let w = dot(g, q);
            (*c * w * w).re()
        });
        squares.sum::<f64>().sqrt()
    }

    /// Adds `scale` times its gradient b + Σ c_s (g_s · q) g_s to `out`.
    pub fn add_gradient(&self, q: &[S], scale: S, out: &mut [S]) {
        add_scaled(out, scale, &self.linear);
        for (c, g) in &self.squares {
            add_scaled(out, scale * *c * dot(g, q), g);
        }
    }

    /// Adds the derivative of scale · value by the parameters to `cot`.
    pub fn pull_value(&self, q: &[S], scale: S, cot: &mut Self) {
        add_scaled(&mut cot.linear, scale, q);
        for ((c, g), (by_c, by_g)) in self.squares.iter().zip(&mut cot.squares) {
            let w = dot(g, q);
            *by_c += scale * w * w * S::from(0.5);
            add_scaled(by_g, scale * *c * w, q);
        }
    }

    /// Adds the derivative of scale · ψ · gradient by the parameters to `cot`.
    pub fn pull_gradient(&self, q: &[S], psi: &[S], scale: S, cot: &mut Self) {
        add_scaled(&mut cot.linear, scale, psi);
        for ((c, g), (by_c, by_g)) in self.squares.iter().zip(&mut cot.squares) {
            let (w, along) = (dot(g, q), dot(g, psi));
            *by_c += scale * w * along;
            add_scaled(by_g, scale * *c * along, q);
            add_scaled(by_g, scale * *c * w, psi);
        }
    }
}
