//! Misfits: how far quantities are from measured values.
//!
//! ```text
//! r_i = √w_i (y(t_i + τ) − d_i),     f = Σ r_i² / N
//! ```
//!
//! Values between samples are those of the polynomials through the samples, so they are linear in them.

use super::interpolation;
use super::peak::stretches;
use super::series::Series;
use super::window::Edge;
use super::windowed::{reading, stretch_at};
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::{Complex64, Dual, Scalar};
use crate::model::Model;

/// Derivatives of a misfit through one of its series.
pub(super) struct Pulled {
    /// In the values of the quantity, by instant.
    pub by_values: Vec<f64>,
    /// In the offset.
    pub by_offset: f64,
    /// In the duration, at fixed values.
    pub by_duration: f64,
}

impl<S: SolveScalar> Series<S> {
    /// The place of datum i in a run, as an end of a window.
    fn edge(&self, i: usize) -> Edge<S> {
        Edge::At(self.offset + self.data.times[i])
    }

    /// Values of the quantity at the times of the data; `None` if one is outside of the motion.
    fn values_in(&self, (model, run): (&Model<S>, &Trajectory<S>)) -> Option<Vec<S>> {
        let samples = self.of.sample_in((model, run), 0..=run.last());
        let all = stretches(run);
        let value = |i: usize| {
            let at = self.edge(i).place(model, run)?.at;
            let of = interpolation::value(run, &stretch_at(run, &all, at.re()).samples, at);
            Some(reading(&of, &samples))
        };
        (0..self.data.times.len()).map(value).collect()
    }

    /// The residuals r_i; `None` if a time is outside of the motion.
    pub(super) fn residuals_in(&self, at: (&Model<S>, &Trajectory<S>)) -> Option<Vec<S>> {
        let values = self.values_in(at)?.into_iter().enumerate();
        let residual = |(i, y): (usize, S)| (y - self.data.values[i]) * self.data.weights[i];
        Some(values.map(residual).collect())
    }
}

impl Series<f64> {
    /// Values of the quantity at the times of the data; `None` if one is outside of the motion.
    pub fn values(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Option<Vec<f64>> {
        self.values_in((model, run))
    }

    /// The first time of the data that is outside of the motion.
    pub fn missed(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Option<f64> {
        let outside = |&i: &usize| self.edge(i).place(model, run).is_none();
        let i = (0..self.data.times.len()).find(outside)?;
        Some(self.data.times[i] + self.offset)
    }

    /// Derivatives of Σ c r_i² through this series. Nothing, if a time is outside of the motion.
    pub(super) fn pull(
        &self,
        (model, run): (&Model<f64>, &Trajectory<f64>),
        c: f64,
    ) -> Option<Pulled> {
        let samples = self.of.sample(model, run);
        let lifted: Vec<Dual> = samples.iter().map(|&y| Dual::from(y)).collect();
        let all = stretches(run);
        let mut pulled = Pulled {
            by_values: vec![0.0; samples.len()],
            by_offset: 0.0,
            by_duration: 0.0,
        };
        for i in 0..self.data.times.len() {
            let placed = self.edge(i).place(model, run)?;
            let nodes = &stretch_at(run, &all, placed.at).samples;
            let of = interpolation::value(run, nodes, Dual::new(placed.at, 1.0));
            let y = reading(&of, &lifted);
            let weight = self.data.weights[i];
            let by = 2.0 * c * weight * weight * (y.re() - self.data.values[i]);
            for (k, part) in of {
                pulled.by_values[k] += by * part.re();
            }
            pulled.by_offset += by * y.du * placed.by_own;
            pulled.by_duration += by * y.du * placed.by_duration;
        }
        Some(pulled)
    }
}

/// Number of all data.
pub fn count<S>(series: &[Series<S>]) -> usize {
    series.iter().map(|own| own.data.times.len()).sum()
}

/// The mean square Σ r_i² / N; NaN if a time is outside of the motion.
pub(super) fn mean_square<S: SolveScalar>(
    series: &[Series<S>],
    (model, run): (&Model<S>, &Trajectory<S>),
) -> S {
    match residuals(series, model, run) {
        Some(all) => {
            let squares = all.into_iter().fold(S::zero(), |sum, r| sum + r * r);
            squares / count(series) as f64
        }
        None => S::from(f64::NAN),
    }
}

/// Residuals of all series; `None` if a time is outside of the motion.
pub fn residuals<S: SolveScalar>(
    series: &[Series<S>],
    model: &Model<S>,
    run: &Trajectory<S>,
) -> Option<Vec<S>> {
    let own = series.iter().map(|own| own.residuals_in((model, run)));
    let all: Option<Vec<Vec<S>>> = own.collect();
    Some(all?.concat())
}

/// Σ |∂f| of the terms along a complex step: their sizes, with the values as large as the measured ones.
pub(super) fn terms(
    series: &[Series<Complex64>],
    at: (&Model<Complex64>, &Trajectory<Complex64>),
) -> f64 {
    let size = |own: &Series<Complex64>| -> Option<f64> {
        let values = own.values_in(at)?.into_iter().enumerate();
        let term = |(i, y): (usize, Complex64)| {
            let (d, weight) = (own.data.values[i], own.data.weights[i]);
            2.0 * weight * weight * (y.re.abs() + d.abs()) * y.im.abs()
        };
        Some(values.map(term).sum())
    };
    let all: f64 = series.iter().filter_map(size).sum();
    all / count(series).max(1) as f64
}
