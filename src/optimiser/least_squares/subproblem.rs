//! The step of a sum of squares in its region of trust.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::model::SquaresModel;
use crate::program::{Derivatives, Program};
use crate::quadratic::data::{Hessian, QpData, QpStep};
use crate::quadratic::elastic::ElasticQp;

/// A subproblem at the point x with the values c of the rows.
pub(crate) struct Fitting<'a> {
    pub squares: &'a SquaresModel,
    pub slopes: &'a Derivatives,
    pub x: &'a DVector<f64>,
    pub c: &'a DVector<f64>,
    pub penalty: &'a DVector<f64>,
    pub radius: f64,
    /// The curvature that leads a step of the rows alone, if the objective is left out.
    pub of_rows_alone: Option<f64>,
}

impl Fitting<'_> {
    /// The step: that in the ball if no row and no bound matters, or else that of the quadratic program in
    /// the box around the ball.
    pub(crate) fn solve(&self, program: &mut Program<'_>, qp: &mut ElasticQp) -> Option<QpStep> {
        let n = self.x.len();
        let units = self.squares.units();
        let room = |bound: &DVector<f64>| (bound - self.x).component_div(&units);
        let lower = room(&program.lower).map(|v| v.min(0.0));
        let upper = room(&program.upper).map(|v| v.max(0.0));
        let (g, h) = match self.of_rows_alone {
            Some(steering) => (
                DVector::zeros(n),
                DMatrix::from_diagonal_element(n, n, steering),
            ),
            None => {
                let spectrum = self.squares.spectrum(&self.slopes.g)?;
                let t = spectrum.step(self.radius);
                let inside = (0..n).all(|i| lower[i] <= t[i] && t[i] <= upper[i]);
                if self.c.is_empty() && inside {
                    return Some(QpStep {
                        d: t.component_mul(&units),
                        y: DVector::zeros(0),
                    });
                }
                (self.slopes.g.component_mul(&units), spectrum.convex())
            }
        };
        let mut a = self.slopes.a.clone();
        a.scale_columns(&units);
        let data = QpData {
            g: &g,
            b: &Hessian::Dense(Cow::Borrowed(&h)),
            a: &a,
            above: &(&program.row_upper - self.c),
            below: &(self.c - &program.row_lower),
            penalty: self.penalty,
            lower: &lower.map(|v| v.max(-self.radius)),
            upper: &upper.map(|v| v.min(self.radius)),
        };
        let mut step = qp.solve(&data, &mut program.counts)?;
        step.d.component_mul_assign(&units);
        Some(step)
    }
}
