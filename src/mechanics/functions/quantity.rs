//! Quantities over time: those of an instant, and combinations of them.

use super::instant::Instant;
use super::rate;
use super::samples::{sample_at, sample_with};
use super::snapshot::Snapshot;
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::unit::Unit;
use crate::math::{Scalar, parameters};
use crate::model::Model;
use std::ops::RangeInclusive;

/// A quantity over the motion.
#[derive(Clone, Debug)]
pub enum Quantity<S> {
    /// A quantity at an instant.
    Of(Instant<S>),
    /// A combination of quantities.
    Combined {
        /// How they are combined.
        operation: Operation,
        /// The quantities.
        of: Vec<Quantity<S>>,
    },
}

parameters!(enum Quantity {
    Of(; instant),
    Combined { operation; of },
});

/// A combination of quantities, at each instant by itself but for the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// x + y + …
    Sum,
    /// x − y.
    Difference,
    /// x y …
    Product,
    /// x / y.
    Quotient,
    /// x².
    Square,
    /// √(x² + w²) − w: |x| but for at most w, smooth at zero.
    Absolute {
        /// w, in the unit of x.
        width: f64,
    },
    /// dx/dt, of the polynomials through the samples.
    Rate,
}

impl Operation {
    /// Its value at an instant. The rate is none of an instant.
    fn at<S: Scalar>(self, x: &[S]) -> S {
        match self {
            Self::Sum => x.iter().fold(S::zero(), |sum, &x| sum + x),
            Self::Difference => x[0] - x[1],
            Self::Product => x.iter().fold(S::one(), |product, &x| product * x),
            Self::Quotient => x[0] / x[1],
            Self::Square => x[0] * x[0],
            Self::Absolute { width } => (x[0] * x[0] + width * width).sqrt() - width,
            Self::Rate => unreachable!("a rate is that of a history"),
        }
    }

    /// Its derivative in the quantity `which` at an instant.
    fn by(self, x: &[f64], which: usize) -> f64 {
        match self {
            Self::Sum => 1.0,
            Self::Difference => [1.0, -1.0][which],
            Self::Product => {
                let others = x.iter().enumerate().filter(|(i, _)| *i != which);
                others.map(|(_, x)| x).product()
            }
            Self::Quotient => [1.0 / x[1], -x[0] / (x[1] * x[1])][which],
            Self::Square => 2.0 * x[0],
            Self::Absolute { width } => x[0] / (x[0] * x[0] + width * width).sqrt(),
            Self::Rate => unreachable!("a rate is that of a history"),
        }
    }

    fn unit(self, of: &[Unit]) -> Unit {
        match self {
            Self::Sum | Self::Difference | Self::Absolute { .. } => of[0].clone(),
            Self::Product => (of.iter()).fold(Unit::default(), |all, own| all.times(own, 1.0)),
            Self::Quotient => of[0].times(&of[1], -1.0),
            Self::Square => of[0].power(2.0),
            Self::Rate => of[0].times(&Unit::second(), -1.0),
        }
    }

    fn describe(self, of: &[String]) -> String {
        match self {
            Self::Sum => of.join(" + "),
            Self::Difference => of.join(" - "),
            Self::Product => of.join(" × "),
            Self::Quotient => of.join(" / "),
            Self::Square => format!("square of {}", of[0]),
            Self::Absolute { .. } => format!("absolute {}", of[0]),
            Self::Rate => format!("rate of {}", of[0]),
        }
    }
}

impl<S: Scalar> Quantity<S> {
    /// The quantity, if it is one of an instant.
    pub fn instant(&self) -> Option<&Instant<S>> {
        match self {
            Self::Of(instant) => Some(instant),
            Self::Combined { .. } => None,
        }
    }

    /// Calls `visit` with all quantities of an instant in it, in a fixed order.
    pub fn for_each<'a>(&'a self, visit: &mut dyn FnMut(&'a Instant<S>)) {
        match self {
            Self::Of(instant) => visit(instant),
            Self::Combined { of, .. } => of.iter().for_each(|own| own.for_each(visit)),
        }
    }

    /// The same, to be changed.
    pub fn for_each_mut<'a>(&'a mut self, visit: &mut dyn FnMut(&'a mut Instant<S>)) {
        match self {
            Self::Of(instant) => visit(instant),
            Self::Combined { of, .. } => of.iter_mut().for_each(|own| own.for_each_mut(visit)),
        }
    }

    /// The quantity of an instant with the number `left`, in the order of [`Quantity::for_each`]; otherwise `left` is
    /// what remains of it after this quantity.
    pub(super) fn nth_mut(&mut self, left: &mut usize) -> Option<&mut Instant<S>> {
        match self {
            Self::Of(instant) if *left == 0 => Some(instant),
            Self::Of(_) => {
                *left -= 1;
                None
            }
            Self::Combined { of, .. } => of.iter_mut().find_map(|own| own.nth_mut(left)),
        }
    }

    /// SI unit.
    pub fn unit(&self) -> String {
        match self {
            Self::Of(instant) => instant.unit().to_owned(),
            Self::Combined { operation, of } => match operation {
                // Of equal units the text stays: N m does not become J.
                Operation::Sum | Operation::Difference | Operation::Absolute { .. } => of[0].unit(),
                _ => self.own_unit().usual(),
            },
        }
    }

    fn own_unit(&self) -> Unit {
        match self {
            Self::Of(instant) => Unit::read(instant.unit()).unwrap_or_default(),
            Self::Combined { operation, of } => {
                let of: Vec<Unit> = of.iter().map(Self::own_unit).collect();
                operation.unit(&of)
            }
        }
    }

    /// Two different units of quantities that are added or subtracted in it, if there are such.
    pub fn mismatch(&self) -> Option<[String; 2]> {
        let Self::Combined { operation, of } = self else {
            return None;
        };
        let inside = of.iter().find_map(Self::mismatch);
        if inside.is_some() || !matches!(operation, Operation::Sum | Operation::Difference) {
            return inside;
        }
        let first = of[0].own_unit();
        let other = of
            .iter()
            .map(Self::own_unit)
            .find(|own| !own.is_as(&first))?;
        Some([first.usual(), other.usual()])
    }

    /// SI unit of its integral over time.
    pub fn integral_unit(&self) -> String {
        match self {
            Self::Of(instant) => instant.integral_unit(),
            Self::Combined { operation, of } => match operation {
                Operation::Sum | Operation::Difference | Operation::Absolute { .. } => {
                    of[0].integral_unit()
                }
                _ => self.own_unit().times(&Unit::second(), 1.0).usual(),
            },
        }
    }

    /// Name for messages.
    pub fn describe(&self) -> String {
        match self {
            Self::Of(instant) => instant.describe().to_owned(),
            Self::Combined { operation, of } => {
                let of: Vec<String> = of.iter().map(Self::describe).collect();
                operation.describe(&of)
            }
        }
    }

    /// Whether it looks at more than the state of an instant: rates, and rotations whose turns are counted.
    pub fn looks_around(&self) -> bool {
        match self {
            Self::Of(instant) => instant.watched_rotation().is_some(),
            Self::Combined { operation, of } => {
                *operation == Operation::Rate || of.iter().any(Self::looks_around)
            }
        }
    }
}

/// Values of a quantity, and of the quantities that it combines.
#[derive(Clone, Debug, Default)]
pub(super) struct Sampled<S> {
    /// By instant.
    pub values: Vec<S>,
    of: Vec<Sampled<S>>,
}

impl<S: SolveScalar> Quantity<S> {
    /// Values at some instants of a run, of all quantities in it.
    pub(super) fn sampled(
        &self,
        (model, run): (&Model<S>, &Trajectory<S>),
        instants: RangeInclusive<usize>,
    ) -> Sampled<S> {
        let (operation, of) = match self {
            Self::Of(instant) => {
                return Sampled {
                    values: sample_at(instant, (model, run), instants),
                    of: Vec::new(),
                };
            }
            Self::Combined { operation, of } => (*operation, of),
        };
        let inner = match operation {
            Operation::Rate => 0..=run.last(),
            _ => instants.clone(),
        };
        let of: Vec<Sampled<S>> = of
            .iter()
            .map(|own| own.sampled((model, run), inner.clone()))
            .collect();
        let values = match operation {
            Operation::Rate => rate::rates(run, &of[0].values)[instants].to_vec(),
            _ => (0..of[0].values.len())
                .map(|k| operation.at(&values_at(&of, k)))
                .collect(),
        };
        Sampled { values, of }
    }

    /// Values at some instants of a run.
    pub(super) fn sample_in(
        &self,
        of: (&Model<S>, &Trajectory<S>),
        instants: RangeInclusive<usize>,
    ) -> Vec<S> {
        self.sampled(of, instants).values
    }

    /// Values at all instants of a run, and without aggregation over points: their largest values.
    pub(super) fn values_and_largest(
        &self,
        model: &Model<S>,
        run: &Trajectory<S>,
    ) -> (Vec<S>, Vec<S>) {
        match self {
            Self::Of(instant) => {
                let both = |at: &Snapshot<S>, turns| instant.value_and_largest(at, turns);
                let all = sample_with(instant, (model, run), 0..=run.last(), both);
                all.into_iter().unzip()
            }
            Self::Combined { .. } => {
                let values = self.sample_in((model, run), 0..=run.last());
                (values.clone(), values)
            }
        }
    }
}

impl Quantity<f64> {
    /// Values at all instants of a run.
    pub fn sample(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Vec<f64> {
        self.sample_in((model, run), 0..=run.last())
    }

    /// The weights of the quantities of an instant in it, in the order of [`Quantity::for_each`], that stand for
    /// weights of its own values at all instants. `sampled` has the values of what it combines. Adds its derivative in the
    /// duration at fixed states.
    pub(super) fn spread(
        &self,
        (run, sampled): (&Trajectory<f64>, &Sampled<f64>),
        weights: Vec<f64>,
        by_duration: &mut f64,
        out: &mut Vec<(Instant<f64>, Vec<f64>)>,
    ) {
        let (operation, of) = match self {
            Self::Of(instant) => return out.push((instant.clone(), weights)),
            Self::Combined { operation, of } => (*operation, of),
        };
        if operation == Operation::Rate {
            let inner = &sampled.of[0];
            *by_duration += rate::by_duration(run, &inner.values, &weights);
            let weights = rate::spread(run, &weights);
            return of[0].spread((run, inner), weights, by_duration, out);
        }
        for (which, (own, inner)) in of.iter().zip(&sampled.of).enumerate() {
            let by = |(k, &weight): (usize, &f64)| match weight == 0.0 {
                true => 0.0,
                false => weight * operation.by(&values_at(&sampled.of, k), which),
            };
            let weights = weights.iter().enumerate().map(by).collect();
            own.spread((run, inner), weights, by_duration, out);
        }
    }
}

fn values_at<S: Copy>(all: &[Sampled<S>], k: usize) -> Vec<S> {
    all.iter().map(|own| own.values[k]).collect()
}
