//! Windows of time: the part of the motion that a function looks at.

use super::peak::{Crossing, first_crossing};
use super::quantity::Quantity;
use crate::integrate::Trajectory;
use crate::linalg::SolveScalar;
use crate::math::{Dual, Scalar, parameters};
use crate::model::Model;

/// Instants beyond the end by less than this part of the duration are the end.
const SAME: f64 = 1e-12;

/// A window of time.
#[derive(Clone, Debug)]
pub struct Window<S> {
    /// Its start.
    pub from: Edge<S>,
    /// Its end.
    pub to: Edge<S>,
}

/// An end of a window.
#[derive(Clone, Debug)]
pub enum Edge<S> {
    /// The start of the motion.
    Start,
    /// The end of the motion.
    End,
    /// A time \[s\].
    At(S),
    /// The first time at which a quantity reaches a value.
    When(Reach<S>),
}

/// A quantity reaches a value for the first time.
#[derive(Clone, Debug)]
pub struct Reach<S> {
    /// The quantity.
    pub of: Quantity<S>,
    /// The value, in its unit.
    pub value: S,
    /// Whether it must rise (`true`) or fall (`false`) through the value; `None` for both.
    pub rises: Option<bool>,
}

parameters!(struct Window {; from, to });
parameters!(enum Edge { Start, End, At(; time), When(; reach) });
parameters!(struct Reach { rises; of, value });

/// An end of a window in a run, as a fraction τ of the duration, and its derivatives.
#[derive(Clone, Debug)]
pub(super) struct Placed<S> {
    /// τ.
    pub at: S,
    /// Of τ, in the values of the quantity that reaches a value, by instant; empty for other ends.
    pub by_values: Vec<(usize, f64)>,
    /// In the time of the end, or in the value that is reached.
    pub by_own: f64,
    /// In the duration.
    pub by_duration: f64,
}

impl<S> Window<S> {
    /// The whole motion.
    pub fn whole() -> Self {
        Self {
            from: Edge::Start,
            to: Edge::End,
        }
    }
}

impl<S: Scalar> Edge<S> {
    /// The quantity that reaches a value, if there is one.
    pub fn quantity(&self) -> Option<&Quantity<S>> {
        match self {
            Self::When(reach) => Some(&reach.of),
            Self::Start | Self::End | Self::At(_) => None,
        }
    }

    /// The same, to be changed.
    pub fn quantity_mut(&mut self) -> Option<&mut Quantity<S>> {
        match self {
            Self::When(reach) => Some(&mut reach.of),
            Self::Start | Self::End | Self::At(_) => None,
        }
    }
}

impl<S: SolveScalar> Edge<S> {
    /// Its place in a run; `None` if it is beyond the motion, or the value is not reached.
    pub(super) fn place(&self, model: &Model<S>, run: &Trajectory<S>) -> Option<Placed<S>> {
        let fixed = |at: f64| Placed {
            at: S::from(at),
            by_values: Vec::new(),
            by_own: 0.0,
            by_duration: 0.0,
        };
        match self {
            Self::Start => Some(fixed(0.0)),
            Self::End => Some(fixed(1.0)),
            Self::At(time) => {
                let at = fraction(run, run.duration, *time);
                let (t, duration) = (time.re(), run.duration.re());
                let [t1, d1] = [t, duration].map(|x| Dual::new(x, 1.0));
                let [t0, d0] = [t, duration].map(Dual::from);
                let inside = (-SAME..=1.0 + SAME).contains(&at.re());
                inside.then_some(Placed {
                    at,
                    by_values: Vec::new(),
                    by_own: fraction(run, d0, t1).infinitesimal(),
                    by_duration: fraction(run, d1, t0).infinitesimal(),
                })
            }
            Self::When(reach) => {
                let all = reach.of.sample_in((model, run), 0..=run.last());
                let away: Vec<S> = all.into_iter().map(|x| x - reach.value).collect();
                let Crossing { at, of, slope } = first_crossing(run, &away, reach.rises)?;
                let beyond = of.iter().fold(S::zero(), |sum, &(k, w)| sum + away[k] * w);
                Some(Placed {
                    at: S::from(at) - beyond / slope,
                    by_values: of.iter().map(|&(k, w)| (k, -w / slope)).collect(),
                    by_own: 1.0 / slope,
                    by_duration: 0.0,
                })
            }
        }
    }
}

impl<S: SolveScalar> Window<S> {
    /// The places of both ends in a run; `None` if the window is not inside the motion, or empty.
    pub(super) fn place(&self, model: &Model<S>, run: &Trajectory<S>) -> Option<[Placed<S>; 2]> {
        let ends = [self.from.place(model, run)?, self.to.place(model, run)?];
        (ends[0].at.re() <= ends[1].at.re()).then_some(ends)
    }
}

impl Window<f64> {
    /// Why it has no place in a run, in words.
    pub fn missed(&self, model: &Model<f64>, run: &Trajectory<f64>) -> String {
        let ends = [("starts", &self.from), ("ends", &self.to)];
        let missing = ends
            .into_iter()
            .find(|(_, edge)| edge.place(model, run).is_none());
        match missing {
            Some((verb, Edge::At(time))) => format!(
                "its window {verb} at {time} s, and the motion lasts {} s",
                run.duration
            ),
            Some((verb, Edge::When(reach))) => {
                let (what, value) = (reach.of.describe(), reach.value);
                let how = match reach.rises {
                    Some(true) => "never rises through",
                    Some(false) => "never falls through",
                    None => "never crosses",
                };
                format!("its window {verb} when a {what} reaches {value}, and that {how} it")
            }
            Some((_, Edge::Start | Edge::End)) | None => {
                "its window starts after its end".to_owned()
            }
        }
    }

    /// Start and end in a run \[s\]; `None` if the window is not inside the motion, or empty.
    pub fn times(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Option<[f64; 2]> {
        let ends = self.place(model, run)?;
        Some(ends.map(|end| end.at * run.duration))
    }
}

/// The fraction τ of the duration T at which the time is t: t = T0 τ before the last kink κ, whose time is
/// fixed, and t = T0 κ + (T − T0 κ)(τ − κ)/(1 − κ) after it, with the real part T0 of T.
fn fraction<T: Scalar, S: Scalar>(run: &Trajectory<T>, duration: S, time: S) -> S {
    let real = duration.re();
    let kink = run.grid.fixed();
    let fixed = S::from(real * kink);
    match time.re() <= fixed.re() && kink > 0.0 {
        true => time / real,
        false => (time - fixed) / (duration - fixed) * (1.0 - kink) + kink,
    }
}
