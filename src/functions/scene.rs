//! A scene: everything that a design determines.

use super::Function;
use crate::math::Scalar;
use crate::model::Model;

/// Model, duration and functions of interest at one design.
#[derive(Clone, Debug)]
pub struct Scene<S> {
    /// Bodies, joints, gravity.
    pub model: Model<S>,
    /// Simulated time T [s].
    pub duration: S,
    /// Functions of interest, in the order of the problem file.
    pub functions: Vec<Function<S>>,
}

impl<S: Scalar> Scene<S> {
    /// All parameters in one fixed order: model, duration, functions.
    pub fn parameters(&self) -> Vec<S> {
        let mut all = self.model.parameters();
        all.push(self.duration);
        for function in &self.functions {
            function.parameters(&mut all);
        }
        all
    }

    /// The cotangent of this scene: every parameter zero.
    pub fn zero_cotangent(&self) -> Scene<f64> {
        Scene {
            model: self.model.zero_cotangent(),
            duration: 0.0,
            functions: self
                .functions
                .iter()
                .map(Function::zero_cotangent)
                .collect(),
        }
    }
}
