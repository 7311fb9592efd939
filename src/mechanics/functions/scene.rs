//! A scene: all that a design determines.

use super::{Function, Quantity, Reduction};
use crate::integrate::{IntegrationFailure, Trajectory};
use crate::math::{Complex64, Parameters, Scalar, parameters};
use crate::model::Model;
use crate::system::failure::AssemblyFailure;

/// Model, duration and functions of interest at one design.
#[derive(Clone, Debug)]
pub struct Scene<S> {
    /// Bodies, joints, gravity.
    pub model: Model<S>,
    /// Simulated time T \[s\]; with an event, the longest time to wait for it until T is known.
    pub duration: S,
    /// The event that ends the run, if any.
    pub until: Option<TerminalEvent<S>>,
    /// Functions of interest, in the order of the problem file.
    pub functions: Vec<Function<S>>,
    /// Why the joints cannot start as given. Then the bodies are as placed, and the scene is not
    /// simulated.
    pub unstarted: Option<AssemblyFailure>,
}

/// An event: an instant quantity g reaches a value c for the first time. It makes the duration a
/// function of the design, g(T) = c.
#[derive(Clone, Debug)]
pub struct TerminalEvent<S> {
    /// g at the end of the run.
    pub measure: Function<S>,
    /// c.
    pub value: S,
}

parameters!(struct TerminalEvent {; measure, value });

impl<S: Scalar> TerminalEvent<S> {
    /// The event that a quantity reaches `value`.
    pub fn new(of: Quantity<S>, value: S) -> Self {
        Self {
            measure: Function::Reduced {
                of,
                during: None,
                reduction: Reduction::Final,
            },
            value,
        }
    }
}

impl TerminalEvent<Complex64> {
    /// g − c at the end of a run.
    pub fn gap(&self, model: &Model<Complex64>, run: &Trajectory<Complex64>) -> Complex64 {
        self.measure.evaluate(model, run).value - self.value
    }
}

impl TerminalEvent<f64> {
    /// Name of the quantity for messages.
    pub fn describe(&self) -> String {
        match &self.measure {
            Function::Reduced { of, .. } => of.describe(),
            Function::Clearance { .. } => "clearance".into(),
            Function::Misfit { .. } => "misfit".into(),
            Function::Duration => "duration".into(),
            Function::LowestFrequency { .. } => "lowest frequency".into(),
            Function::OfDesign { .. } => "design".into(),
        }
    }

    /// g − c at all instants of a run.
    pub fn gaps(&self, model: &Model<f64>, run: &Trajectory<f64>) -> Vec<f64> {
        let Function::Reduced { of, .. } = &self.measure else {
            unreachable!("an event is an instant quantity");
        };
        let all = of.sample(model, run);
        all.into_iter().map(|g| g - self.value).collect()
    }
}

// Visited in this order: model, duration, event, functions.
parameters!(struct Scene { unstarted; model, duration, until, functions });

impl<S: Scalar> Scene<S> {
    /// Refuses a scene that cannot start.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn admit_start(&self) -> Result<(), IntegrationFailure> {
        match &self.unstarted {
            Some(failure) => Err(IntegrationFailure::Assembly(failure.clone())),
            None => Ok(()),
        }
    }

    /// Number of the event's quantity: one past the last function.
    pub fn event(&self) -> usize {
        self.functions.len()
    }

    /// A function of interest by number; includes the event's quantity.
    ///
    /// # Panics
    /// There is no such function.
    pub fn function(&self, number: usize) -> &Function<S> {
        match &self.until {
            Some(until) if number == self.event() => &until.measure,
            _ => &self.functions[number],
        }
    }

    /// The model and a function, mutable; see [`Scene::function`].
    ///
    /// # Panics
    /// There is no such function.
    pub fn model_and_function(&mut self, number: usize) -> (&mut Model<S>, &mut Function<S>) {
        let event = self.event();
        let function = match &mut self.until {
            Some(until) if number == event => &mut until.measure,
            _ => &mut self.functions[number],
        };
        (&mut self.model, function)
    }

    /// All parameters in the order of [`Scene::map`].
    pub fn parameters(&self) -> Vec<S> {
        let mut all = Vec::new();
        self.map(&mut |x| {
            all.push(x);
            x
        });
        all
    }

    /// A cotangent of this scene: every parameter is zero.
    pub fn zero_cotangent(&self) -> Scene<f64> {
        self.map(&mut |_| 0.0)
    }
}
