//! A scene: everything that a design determines.

use super::Function;
use crate::math::Scalar;
use crate::model::Model;

/// Model, duration and functions of interest at one design.
#[derive(Clone, Debug)]
pub struct Scene<S> {
    /// Bodies, joints, gravity.
    pub model: Model<S>,
    /// Simulated time T (s).
    pub duration: S,
    /// Functions of interest, in the order of the problem file.
    pub functions: Vec<Function<S>>,
}

impl<S: Scalar> Scene<S> {
    /// The scene with every parameter replaced by `f` of it, visited in one fixed order: model,
    /// duration, functions.
    pub fn map<T: Scalar>(&self, f: &mut impl FnMut(S) -> T) -> Scene<T> {
        Scene {
            model: self.model.map(f),
            duration: f(self.duration),
            functions: self
                .functions
                .iter()
                .map(|function| function.map(f))
                .collect(),
        }
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

    /// The cotangent of this scene: every parameter zero.
    pub fn zero_cotangent(&self) -> Scene<f64> {
        self.map(&mut |_| 0.0)
    }
}
