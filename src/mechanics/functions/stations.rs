//! The largest of several section forces or stresses of a flexible body: a soft maximum over
//! stations, fibres and signs. With the same ρ as a Kreisselmeier–Steinhauser function over time,
//! both are one such function.

use crate::math::soft_max::{Bound, SoftMax};
use crate::math::{Scalar, parameters};
use crate::model::flexible::Quadratic;

/// A soft maximum over quadratic forms in the elastic coordinates, each times its sign.
#[derive(Clone, Debug)]
pub struct Largest<S> {
    /// The forms.
    pub forms: Vec<Quadratic<S>>,
    /// The sign of each.
    pub signs: Vec<f64>,
    /// Aggregation parameter ρ, in 1/unit of the forms.
    pub rho: f64,
    /// Side of the maximum on which it lies: of the mean of exponentials, or of their sum.
    pub bound: Bound,
}

parameters!(struct Largest { signs, rho, bound; forms });

impl<S: Scalar> Largest<S> {
    fn soft(&self, q: &[S]) -> SoftMax<S> {
        let forms = self.forms.iter().zip(&self.signs);
        let values: Vec<S> = forms.map(|(form, &sign)| form.value(q) * sign).collect();
        let weight = match self.bound {
            Bound::Below => 1.0 / values.len() as f64,
            Bound::Above => 1.0,
        };
        SoftMax::new(&values, |_| S::from(weight), self.rho)
    }

    /// Its value at elastic coordinates.
    pub fn value(&self, q: &[S]) -> S {
        self.soft(q).ks
    }

    /// Its value, and the largest one of all forms.
    pub fn value_and_largest(&self, q: &[S]) -> (S, S) {
        let soft = self.soft(q);
        (soft.ks, S::from(soft.maximum))
    }
}

impl Largest<f64> {
    /// Adds `weight` times the derivative of [`Largest::value`] to the cotangents of the coordinates and of
    /// the forms.
    pub fn pull_back(&self, q: &[f64], weight: f64, by_q: &mut [f64], own: &mut Self) {
        let soft = self.soft(q);
        let parts = soft.weights.iter().zip(&self.signs);
        let forms = self.forms.iter().zip(&mut own.forms);
        for ((form, own), (&part, &sign)) in forms.zip(parts) {
            let weight = weight * part * sign;
            form.add_gradient(q, weight, by_q);
            form.pull_value(q, weight, own);
        }
    }
}
